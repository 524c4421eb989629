"""Tables of numbers in text, as programs and spreadsheets write them.

Separators are commas, semicolons, tabs or as given by a ``sep=`` line; a decimal comma is read where the
comma is not the separator; ``#`` begins a comment; a column header holds a name and a unit.
"""

import csv
import re
from pathlib import Path
from typing import NamedTuple

from kvtheory.scene.quantities import shown
from kvtheory.scene.texts import read_text

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
    """The headers of the columns, and the cells of each line below, with the number of the line."""

    heads: list[str]
    rows: list[tuple[int, list[str]]]
    decimal: str


def read_table(path: Path) -> Table:
    """Return the table that a file holds.

    Raises
    ------
    ValueError
        If it is not text, holds no header, or is no table; the message begins with the name of the file.
    OSError
        If it cannot be read.
    """
    lines = [
        (number, line)
        for number, line in enumerate(_text(path).splitlines(), start=1)
        if line.strip(" \t\r;,") and not line.lstrip().startswith("#")
    ]
    separator = None
    if lines and (match := SEPARATED.match(lines[0][1])):  # as spreadsheets write it
        separator, lines = match[1], lines[1:]
    if not lines:
        raise ValueError(
            f"{path}: holds no header and no rows; expected a line such as t [ms],z_A [mm]"
        )
    bare = re.sub(r"[\[(].*?[\])]", "", lines[0][1])
    separator = separator or max(SEPARATORS, key=bare.count)
    if any(line.count('"') % 2 for _, line in lines):
        raise ValueError(f"{path}: a quotation mark is opened and not closed on the same line")
    try:
        rows = list(csv.reader((line for _, line in lines), delimiter=separator))
    except csv.Error as error:
        raise ValueError(f"{path}: not a table of numbers: {error}") from None
    decimal = "," if separator != "," else "."
    cells = [[cell.strip() for cell in row] for row in rows]
    heads = cells[0]
    if all(number(cell, decimal) is not None for cell in heads if cell):
        raise ValueError(
            f"{path}: line {lines[0][0]} holds numbers where the names and units of the columns are "
            "expected, such as t [ms],z_A [mm],F_z [N/mm],F_x [N/mm]"
        )
    while heads and not heads[-1]:
        heads = heads[:-1]
    return Table(
        heads, [(at, row) for (at, _), row in zip(lines[1:], cells[1:], strict=True)], decimal
    )


def _text(path: Path) -> str:
    try:
        text = read_text(path)
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise ValueError(f"{path}: not a text file in UTF-8 or UTF-16; expected a CSV")
    return text


def numbers(path: Path, table: Table, line: int, cells: list[str], used: list[bool]) -> list[float]:
    """Return the numbers of one line; an empty cell, or one of a column that is not used, is NaN.

    Raises
    ------
    ValueError
        If a cell is not a number, or there are more or fewer cells than columns.
    """
    while len(cells) > len(table.heads) and not cells[-1]:
        cells = cells[:-1]
    if len(cells) != len(table.heads):
        raise ValueError(
            f"{path}: line {line} has {len(cells)} cells, the header has {len(table.heads)}"
        )
    found = []
    for cell, head, wanted in zip(cells, table.heads, used, strict=True):
        value = number(cell, table.decimal) if cell and wanted else float("nan")
        if value is None:
            hint = "; write the decimal mark as a point" if "," in cell else ""
            raise ValueError(
                f'{path}: line {line}, column "{shown(head)}": "{shown(cell)}" is not a number{hint}'
            )
        found.append(value)
    return found


def number(cell: str, decimal: str) -> float | None:
    """Return a number; a decimal comma is read where the comma is not the separator."""
    if decimal == "," and cell.count(",") == 1 and "." not in cell:
        cell = cell.replace(",", ".")
    try:
        return float(cell) if "_" not in cell else None
    except ValueError:
        return None


def plain(name: str) -> str:
    """Return a name without differences of spelling: case, spaces, underscores, TeX."""
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
