"""Measured tables as instruments export them: columns by name and unit, each value with its line.

A header is the first row that names what is needed. Units are in the header (``E' [MPa]``, ``f/Hz``) or in
the row below it (``Hz, MPa``; ``[Hz] [MPa]``). Rows above a header and rows of text between tables (the
steps of TRIOS, the intervals of RheoCompass) are skipped; the tables of one file form one. What cannot be
read, or could be read in two ways, raises ValueError with the column and the line.
"""

import csv
import math
import re
from collections.abc import Callable, Container, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.mistakes import shown
from kvtheory.scene.tables import SEPARATED, SEPARATORS, number, parts, plain, read_text
from kvtheory.scene.units import bare, to_si

Array = NDArray[np.float64]

STARTS = re.compile(r"[\s,;\"]*(?:[-+.]*\d|nan\b)", re.IGNORECASE)
"""The beginning of a row of numbers; its first cells may be empty."""
UNITLESS = "", "-", "1"
INCH = re.compile(r'(?<=[EG])"(?=\s*[\[(/])')
"""A double prime written as a quotation mark, before a unit."""
BEFORE_UNITS = 2
"""Most blank rows between a header and its row of units."""


class Column(NamedTuple):
    """A column of a table: its values as they stand in the file, its header and its unit."""

    head: str
    unit: str
    values: Array


@dataclass(frozen=True)
class Table:
    """The known columns by quantity, the line of each row, and the headers of other columns."""

    source: str
    columns: Mapping[str, Column]
    lines: NDArray[np.int_]
    ignored: tuple[str, ...]

    def __contains__(self, quantity: str) -> bool:
        return quantity in self.columns

    def error(self, quantity: str, told: str, row: int | None = None) -> ValueError:
        """Return an error about a column, and a row of it."""
        line = "" if row is None else f"line {self.lines[row]}, "
        return ValueError(
            f'{self.source}: {line}column "{shown(self.columns[quantity].head)}": {told}'
        )

    def si(self, quantity: str, *units: str) -> tuple[Array, str]:
        """Return a column in the first of some SI units that fits its own, and that unit."""
        column = self.columns[quantity]
        if not column.unit:
            raise self.error(
                quantity, f'has no unit; expected "{column.head} [{units[0]}]" or the like'
            )
        for unit in units:
            try:
                scale, zero = (to_si(f"{x} {_spelt(column.unit, unit)}", unit) for x in ("1", "0"))
                return column.values * (scale - zero) + zero, unit
            except ValueError as error:
                told = str(error)
        raise self.error(quantity, told)

    def number(self, quantity: str) -> Array:
        """Return a column of dimensionless numbers."""
        column = self.columns[quantity]
        if column.unit not in UNITLESS:
            raise self.error(quantity, f'has the unit "{column.unit}"; expected none')
        return column.values

    def require(self, quantity: str, good: NDArray[np.bool_], told: str) -> None:
        """Raise unless all values of a column are good; name the first line that is not."""
        bad = np.flatnonzero(~good)
        if bad.size:
            value = self.columns[quantity].values[bad[0]]
            more = f", and {bad.size - 1} more" if bad.size > 1 else ""
            raise self.error(quantity, f"{value:g} {told}{more}", int(bad[0]))


Names = Callable[[str], str | None]
"""Returns the quantity that the name of a column stands for, or None."""


def named(spellings: Mapping[str, str]) -> Names:
    """Return a function that finds names among spellings, separated by commas, of each quantity.

    Only names of one letter must have the case that is listed: T is a temperature, t a time.
    """
    known = {_key(each): name for name, all_ in spellings.items() for each in all_.split(", ")}
    return lambda head: known.get(_key(head))


def _key(name: str) -> str:
    for mark, prime in (("″", "''"), ('"', "''"), ("′", "'"), ("’", "'"), ("´", "'")):
        name = name.replace(mark, prime)
    return name.strip() if len(name.strip()) == 1 else plain(name)


def _spelt(unit: str, si: str) -> str:
    """Return a unit as `kvtheory.scene.units` reads it: instruments write C for degrees Celsius."""
    return {"C": "degC", "F": "degF"}.get(unit, unit) if si == "K" else unit


Found = dict[int, tuple[str, str, str]]
"""Quantity, header and unit of the known columns of a row, by their place."""


@dataclass(frozen=True)
class Reader:
    """Reads the tables of a subject by the names of its columns.

    `needed` tells from the quantities of a row whether it is a header; `example` is one, for messages. Cells
    of the quantities in `partial` may be empty or not finite; an empty one is NaN.
    """

    names: Names
    needed: Callable[[set[str]], bool]
    example: str
    partial: Container[str] = ()

    def read(self, data: Any) -> Table:
        """Return the table that a file, or a mapping of arrays by header, holds."""
        if isinstance(data, (str, PathLike)):
            try:
                table = self._of_file(Path(data))
            except csv.Error as error:
                raise ValueError(f"{data}: not a table of numbers: {error}") from None
        elif isinstance(data, Mapping) or hasattr(data, "columns"):
            table = self._of_arrays(data)
        else:
            told = f"expected a path or a mapping of arrays; got {type(data).__name__}"
            raise TypeError(f"`data`: {told}")
        for name, column in table.columns.items():
            if name not in self.partial:
                table.require(name, np.isfinite(column.values), "is not a finite number")
        return table

    def _of_arrays(self, data: Any) -> Table:
        heads = list(map(str, data))
        found = self._known(heads, "`data`")
        if not self.needed({name for name, _, _ in found.values()}):
            raise ValueError(f"`data`: {self._unknown(heads)}")
        columns, keys = {}, list(data)
        for i, (name, head, unit) in found.items():
            try:
                values, written = bare(data[keys[i]])
                array = np.asarray(values, dtype=float).ravel()
            except (TypeError, ValueError) as error:
                raise ValueError(f'`data`: column "{shown(head)}": {error}') from None
            columns[name] = Column(head, written or unit, array)
        sizes = {column.values.size for column in columns.values()}
        if len(sizes) > 1:
            told = " and ".join(map(str, sorted(sizes)))
            raise ValueError(f"`data`: the columns differ in length: {told}")
        rows = np.arange(1, sizes.pop() + 1)
        return Table("`data`", columns, rows, self._others(heads, found))

    def _of_file(self, path: Path) -> Table:
        try:
            text = read_text(path)
        except UnicodeDecodeError:
            text = "\0"
        if "\0" in text:
            raise ValueError(f"{path}: not a text file in UTF-8 or UTF-16; expected {self.example}")
        lines, at, header = text.splitlines(), 0, None
        skipped: list[str] = []
        tables: list[tuple[Found, list[Array], list[int], tuple[str, ...]]] = []
        while at < len(lines):
            found_here = None if _blank(lines[at]) else self._header(lines[at], lines[0])
            if found_here is None:
                if STARTS.match(lines[at]) and not _blank(lines[at]):
                    told = f"line {at + 1} holds numbers that no row of names precedes"
                    told += f'; "{shown(skipped[-1])}" names none that is known' if skipped else ""
                    raise ValueError(f"{path}: {told}; expected {self.example}")
                skipped += [] if _blank(lines[at]) else [lines[at]]
                at += 1
                continue
            cells, separator = header = found_here
            units, at = _units_below(lines, at + 1, separator, len(cells))
            found = self._known(cells, str(path), units)
            rows = []
            while at < len(lines):
                if STARTS.match(lines[at]):
                    rows.append(at)
                elif not _blank(lines[at]):
                    break
                at += 1
            if rows:
                values = _numbers(path, lines, rows, header, found, self.partial)
                tables.append((found, values, rows, self._others(cells, found)))
        if header and not tables:
            raise ValueError(f"{path}: holds a header and no rows")
        if not tables:
            raise ValueError(f"{path}: {self._unknown(skipped)}")
        kinds = {
            tuple(sorted((name, unit) for name, _, unit in found.values())) for found, *_ in tables
        }
        if len(kinds) > 1:
            told = " and ".join(
                ", ".join(" ".join(each) for each in kind) for kind in sorted(kinds)
            )
            raise ValueError(f"{path}: its tables differ in their columns or units: {told}")
        by_name = [
            dict(zip((name for name, _, _ in found.values()), values, strict=True))
            for found, values, _, _ in tables
        ]
        columns = {
            name: Column(head, unit, np.concatenate([each[name] for each in by_name]))
            for name, head, unit in tables[0][0].values()
        }
        numbers = np.concatenate([np.array(rows) + 1 for _, _, rows, _ in tables])
        return Table(str(path), columns, numbers, tables[0][3])

    def _header(self, line: str, first: str) -> tuple[list[str], str] | None:
        """Return the cells and the separator of a row of text that names what is needed.

        The separator is that of a first line such as ``sep=;``, or the one by which most names are known.
        """
        told, best, most = SEPARATED.match(first), None, 0
        for separator in told[1] if told else SEPARATORS:
            cells = _split(line, separator)
            known = {self._quantity(cell)[0] for cell in cells if cell} - {None}
            if len(known) > most and self.needed({name for name in known if name}):
                best, most = (cells, separator), len(known)
        return best

    def _quantity(self, cell: str) -> tuple[str | None, str]:
        """Return the quantity that a header names, and its unit; "G(t)" and "tan(delta)" are names."""
        whole = self.names(cell)
        name, unit = (cell, "") if whole else parts(cell)
        return whole or self.names(name), unit

    def _known(self, cells: Sequence[str], source: str, units: Sequence[str] = ()) -> Found:
        found: Found = {}
        seen: dict[str, str] = {}
        for i, cell in enumerate(cells):
            name, unit = self._quantity(cell)
            if name is None:
                continue
            if name in seen:
                both = f'columns "{shown(seen[name])}" and "{shown(cell)}"'
                raise ValueError(f"{source}: {both} are both the {name}; keep one of them")
            below = units[i] if i < len(units) else ""
            if unit and below and unit != below:
                told = f'has the unit "{unit}" in its name and "{below}" below it'
                raise ValueError(f'{source}: column "{shown(cell)}": {told}')
            seen[name] = cell
            found[i] = name, cell, unit or below
        return found

    def _others(self, cells: Sequence[str], found: Found) -> tuple[str, ...]:
        return tuple(shown(cell) for i, cell in enumerate(cells) if cell and i not in found)

    def _unknown(self, rows: Sequence[str]) -> str:
        seen = f' in "{shown(" | ".join(rows))}"' if rows else ""
        return f"no row names the columns that are needed{seen}; expected {self.example}"


def _blank(line: str) -> bool:
    """Whether a line is empty or a comment."""
    return not line.strip(' \t\r;,"') or line.lstrip().startswith("#")


def _split(line: str, separator: str) -> list[str]:
    if '"' not in line and len(line) < csv.field_size_limit():
        return [cell.strip() for cell in line.split(separator)]
    quoted = INCH.sub("''", line)
    if quoted.count('"') % 2:
        quoted = quoted.replace('"', "''")
    return [cell.strip() for cell in next(csv.reader([quoted], delimiter=separator))]


def _units_below(
    lines: Sequence[str], at: int, separator: str, count: int
) -> tuple[list[str], int]:
    """Return the units in the row below a header, if there is one, and where the rows of numbers begin."""
    below = at
    while below < min(at + BEFORE_UNITS, len(lines) - 1) and _blank(lines[below]):
        below += 1
    if below >= len(lines) or _blank(lines[below]):
        return [], at
    cells = [cell.strip("[]() ") for cell in _split(lines[below], separator)]
    texts = [cell for cell in cells if cell]
    is_number = [number(cell, ",") is not None for cell in texts if cell not in UNITLESS]
    if not is_number or any(is_number) or len(cells) > count + 1:
        return [], at
    return cells, below + 1


def _numbers(
    path: Path, lines: Sequence[str], rows: Sequence[int], header: tuple[list[str], str], found: Found,
    partial: Container[str],
) -> list[Array]:  # fmt: skip
    """Return the known columns; if the fast reader fails, find the cell that is no number."""
    (heads, separator), decimal = header, "." if header[1] == "," else ","
    texts = [lines[k].replace(",", ".") if decimal == "," else lines[k] for k in rows]
    if all(text.count(separator) < len(heads) for text in texts):
        with suppress(ValueError):
            options: Any = {"delimiter": separator, "usecols": list(found), "quotechar": '"'}
            return list(np.loadtxt(texts, ndmin=2, **options).T)
    values = []
    for k in rows:
        cells = _split(lines[k], separator)
        while len(cells) > len(heads) and not cells[-1]:
            del cells[-1]
        if len(cells) > len(heads):
            told = f"line {k + 1} has {len(cells)} cells, the header has {len(heads)}"
            raise ValueError(f"{path}: {told}")
        row = []
        for i, (name, head, _) in found.items():
            cell = cells[i] if i < len(cells) else ""
            value = math.nan if not cell and name in partial else number(cell, decimal)
            if value is None:
                hint = "; write the decimal mark as a point" if "," in cell else ""
                told = f'"{shown(cell)}" is not a number{hint}' if cell else "the cell is empty"
                raise ValueError(f'{path}: line {k + 1}, column "{shown(head)}": {told}')
            row.append(value)
        values.append(row)
    return list(np.array(values).T)
