"""Files as programs and spreadsheets write them, and the numbers, names and units in their cells."""

import codecs
import errno
import os
import re
import stat
import warnings
from importlib import import_module
from pathlib import Path

MARKS = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
"""Byte order marks, and the encodings that they indicate."""
MOST = 2**28
"""Largest size of a file in bytes; a million rows of ten columns are smaller."""
EXCEL = ".xlsx", ".xlsm"
SEPARATED = re.compile(r"^\s*\"?sep=(.)\"?\s*$", re.IGNORECASE)
"""The line that tells a spreadsheet the separator."""
_HEADS = (
    re.compile(r"^(?P<name>.*\S)\s*[\[{<](?P<unit>[^\]}>]*)[\]}>]$"),
    re.compile(r"^(?P<name>.*\S)\s*\((?P<unit>(?:[^()]|\([^()]*\))*)\)$"),
    re.compile(r"^(?P<name>.*?)\s+in\s+(?P<unit>.+)$"),
    re.compile(r"^(?P<name>[^,]*?),\s*(?P<unit>\S+)$"),
    re.compile(r"^(?P<name>[^/]*?)\s*/\s*(?P<unit>.+)$"),
)
"""A name and a unit: in brackets, after "in" or a comma, or, as in ISO 80000, after a slash."""
SUFFIXES = {
    **{each.casefold(): each for each in ("Hz", "kHz", "mHz", "Pa", "kPa", "MPa", "GPa", "s", "ms", "min",
                                          "m", "mm", "um", "N", "kN", "C", "degC", "K")},
    "rads": "rad/s", "rad_s": "rad/s", "mm_s": "mm/s", "m_s": "m/s", "um_s": "um/s", "n_mm": "N/mm",
    "n_m": "N/m", "sec": "s",
}  # fmt: skip
"""Units behind an underscore, as names in programs have them; "per" may stand between."""


EXPONENT = re.compile(r"(?<=[0-9.])[dD](?=[-+]?[0-9]+$)")
"""The exponent of a double in Fortran."""


def number(cell: str, decimal: str) -> float | None:
    """Return a number, or None; a decimal comma is read where the comma is not the separator."""
    if decimal == "," and cell.count(",") == 1 and "." not in cell:
        cell = cell.replace(",", ".")
    cell = cell.replace("\N{MINUS SIGN}", "-")
    if EXPONENT.search(cell):
        cell = EXPONENT.sub("e", cell)
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


def suffixed(head: str) -> tuple[str, str]:
    """Return the name and the unit of a column whose unit stands behind an underscore.

    >>> suffixed("freq_hz"), suffixed("F_x_N_per_mm"), suffixed("mu")
    (('freq', 'Hz'), ('F_x', 'N/mm'), ('mu', ''))
    """
    words = re.sub("_per_", "_", head, flags=re.IGNORECASE).split("_")
    for count in (2, 1):
        if len(words) > count and (unit := SUFFIXES.get("_".join(words[-count:]).casefold())):
            return "_".join(words[:-count]), unit
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
        message = f"holds more than {MOST / 1e6:.0f} MB, the most that is read"
        raise OSError(errno.EFBIG, message, str(path))
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


def sheets(path: Path) -> dict[str, list[str]]:
    """Return the rows of the sheets of an Excel file as lines of cells with tabs between, by their names."""
    try:
        load = import_module("openpyxl").load_workbook
    except ImportError:
        message = (
            'Excel files need openpyxl: pip install ".[data]" in the checkout, or save it as CSV'
        )
        raise ValueError(f"{path}: {message}") from None
    with warnings.catch_warnings(), path.open("rb") as file:
        warnings.simplefilter("ignore")  # about styles and charts
        try:
            book = load(file, read_only=True, data_only=True)
        except Exception:  # the library has no error of its own
            raise ValueError(f"{path}: not an Excel file, or one with a password") from None
        found = {}
        for sheet in book.worksheets:
            sheet.reset_dimensions()  # which some programs write wrongly
            rows = ([_cell(each) for each in row] for row in sheet.iter_rows(values_only=True))
            found[sheet.title] = ["\t".join(row).rstrip("\t") for row in rows]
    return found


def _cell(value: object) -> str:
    return "" if value is None else " ".join(str(value).split())
