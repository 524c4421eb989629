"""Text files, and tables of numbers in them, as programs and spreadsheets write them.

Separators are commas, semicolons, tabs or as given by a ``sep=`` line; a decimal comma is read where the
comma is not the separator; ``#`` begins a comment; a column header holds a name and a unit.
"""

import codecs
import csv
import errno
import os
import re
import stat
from pathlib import Path
from typing import NamedTuple

from kvtheory.scene.drives import history_points
from kvtheory.scene.mistakes import mistake, shown
from kvtheory.scene.units import to_si

MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""Byte order marks, and the encodings that they indicate."""
MOST = 2**28
"""Largest size of a file in bytes; a million rows of ten columns are smaller."""
SEPARATORS = "\t;,"
SEPARATED = re.compile(r"^\s*\"?sep=(.)\"?\s*$", re.IGNORECASE)
"""The line that tells a spreadsheet the separator."""
_HEADS = (
    re.compile(r"^(?P<name>.*?)\s*\[(?P<unit>[^\]]*)\]$"),
    re.compile(r"^(?P<name>.*?)\s*\((?P<unit>.*)\)$"),
    re.compile(r"^(?P<name>.*?)\s+in\s+(?P<unit>.+)$"),
    re.compile(r"^(?P<name>[^/]*?)\s*/\s*(?P<unit>.+)$"),
)
"""A name and a unit: in brackets, after "in", or, as in ISO 80000, after a slash."""


class Table(NamedTuple):
    """The headers of the columns, the cells of each line with its number, and the decimal mark."""

    heads: list[str]
    rows: list[tuple[int, list[str]]]
    decimal: str


def read_table(path: Path) -> Table:
    """Return the table that a file holds.

    It raises ValueError if there is none; the message begins with the name of the file. It raises OSError if
    the file cannot be read.
    """
    try:
        text = read_text(path)
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise ValueError(f"{path}: not a text file in UTF-8 or UTF-16; expected a CSV")
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip(" \t\r;,") and not line.lstrip().startswith("#")
    ]
    separator = None
    if lines and (match := SEPARATED.match(lines[0][1])):
        separator, lines = match[1], lines[1:]
    if not lines:
        told = "holds no header and no rows; expected a line such as t [ms],z_A [mm]"
        raise ValueError(f"{path}: {told}")
    bare = re.sub(r"[\[(].*?[\])]", "", lines[0][1])
    separator = separator or max(SEPARATORS, key=bare.count)
    if any(line.count('"') % 2 for _, line in lines):
        raise ValueError(f"{path}: a quotation mark is opened and not closed on the same line")
    try:
        rows = list(csv.reader((line for _, line in lines), delimiter=separator))
    except csv.Error as error:
        raise ValueError(f"{path}: not a table of numbers: {error}") from None
    decimal = "," if separator != "," else "."
    heads, *cells = ([cell.strip() for cell in row] for row in rows)
    if all(number(cell, decimal) is not None for cell in heads if cell):
        raise ValueError(
            f"{path}: line {lines[0][0]} holds numbers where the names and units of the columns are "
            "expected, such as t [ms],z_A [mm],F_z [N/mm],F_x [N/mm]"
        )
    while heads and not heads[-1]:
        heads = heads[:-1]
    return Table(heads, [(at, row) for (at, _), row in zip(lines[1:], cells, strict=True)], decimal)


def numbers(path: Path, table: Table, line: int, cells: list[str], used: list[bool]) -> list[float]:
    """Return the numbers of one line; an empty cell, or one of a column that is not used, is NaN.

    It raises ValueError if a cell is not a number, or there are more or fewer cells than columns.
    """
    while len(cells) > len(table.heads) and not cells[-1]:
        cells = cells[:-1]
    if len(cells) != len(table.heads):
        told = f"line {line} has {len(cells)} cells, the header has {len(table.heads)}"
        raise ValueError(f"{path}: {told}")
    found = []
    for cell, head, wanted in zip(cells, table.heads, used, strict=True):
        value = number(cell, table.decimal) if cell and wanted else float("nan")
        if value is None:
            hint = "; write the decimal mark as a point" if "," in cell else ""
            told = f'column "{shown(head)}": "{shown(cell)}" is not a number{hint}'
            raise ValueError(f"{path}: line {line}, {told}")
        found.append(value)
    return found


def number(cell: str, decimal: str) -> float | None:
    """Return a number, or None; a decimal comma is read where the comma is not the separator."""
    if decimal == "," and cell.count(",") == 1 and "." not in cell:
        cell = cell.replace(",", ".")
    try:
        return float(cell) if "_" not in cell else None
    except ValueError:
        return None


def plain(name: str) -> str:
    """Return a name without its case, spaces, underscores and TeX marks, to compare it."""
    return re.sub(r"[\s_{}$\\^-]", "", name).casefold()


def parts(head: str) -> tuple[str, str]:
    """Return the name and the unit of a column.

    >>> parts("t/ms"), parts("F_z (N/mm)"), parts("z_A")
    (('t', 'ms'), ('F_z', 'N/mm'), ('z_A', ''))
    """
    for pattern in _HEADS:
        if match := pattern.match(head):
            return match["name"].rstrip(" /"), match["unit"].strip(" ()[]")
    return head, ""


def read_text(path: Path) -> str:
    r"""Return the text of a file in UTF-8, UTF-16 (of a Windows shell) or Windows-1252 (of Excel).

    UTF-16 is recognised by its byte order mark or by the zeros between its letters. Text that is not UTF-8 is
    read as Windows-1252, in which the letters of units have the same codes as in Latin-1. Other bytes raise
    UnicodeDecodeError; a device, or a file of more than `MOST` bytes, raises OSError.

    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "scene.toml"
    >>> _ = path.write_text('radius = "5 µm"', encoding="utf-16-le")
    >>> read_text(path)
    'radius = "5 µm"'
    """
    with path.open("rb") as file:
        if stat.S_ISCHR(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "is a device; expected a file", str(path))
        data = file.read(MOST + 1)
    if len(data) > MOST:
        told = f"holds more than {MOST / 1e6:.0f} MB, the most that is read"
        raise OSError(errno.EFBIG, told, str(path))
    encodings = [name for mark, name in MARKS.items() if data.startswith(mark)]
    if not encodings and b"\0" in data[:2]:
        encodings = ["utf-16-be" if data.startswith(b"\0") else "utf-16-le"]
    try:
        text = data.decode(encodings[0] if encodings else "utf-8")
    except UnicodeDecodeError:
        if encodings:
            raise
        text = data.decode("cp1252")
    return text.replace("\r\n", "\n")


KEY = "drive.file"
EXPECTED = 'expected a first line such as "t [ms],V [mm/s]", and then numbers'
NAMES = {
    "s": ("t", "time", "zeit"),
    "m/s": ("v", "velocity", "speed", "drivevelocity", "vdrive", "geschwindigkeit"),
}
"""Possible names of the columns of time and velocity, by their units."""


def history_from(path: Path) -> tuple[tuple[float, float], ...]:
    """Return the points (t, V) in SI of a CSV whose header names the units; other columns are ignored.

    It raises SceneError if the file cannot be read; the message says in which line.
    """
    try:
        table = read_table(path)
        heads = [parts(head) for head in table.heads]
        at, factors = [], []
        for unit, names in NAMES.items():
            found = [i for i, (name, _) in enumerate(heads) if plain(name) in names]
            if len(found) != 1:
                told = "no column" if not found else "more than one column"
                raise ValueError(f"{told} is named {' or '.join(names[:2])}")
            at += found
            factors.append(to_si(f"1 {heads[found[0]][1]}", unit))
        used = [i in at for i in range(len(heads))]
        rows = [numbers(path, table, line, cells, used) for line, cells in table.rows]
    except OSError as error:
        raise mistake(KEY, str(path), f"cannot be read: {error.strerror}") from None
    except ValueError as error:
        told = str(error).removeprefix(f"{path}: ")
        raise mistake(KEY, str(path), f"{told}; {EXPECTED}") from None
    points = [tuple(row[i] * factor for i, factor in zip(at, factors, strict=True)) for row in rows]
    return history_points(points, f"{KEY} ({path.name})")
