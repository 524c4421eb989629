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
from difflib import get_close_matches
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.drives import history_points
from kvtheory.scene.mistakes import mistake, shown
from kvtheory.scene.tables import SEPARATED, SEPARATORS, number, parts, plain, read_text
from kvtheory.scene.units import bare, to_si

Array = NDArray[np.float64]

STARTS = re.compile(r"[\s,;\"]*(?:[-+.]*\d|nan\b)", re.IGNORECASE)
"""The beginning of a row of numbers; its first cells may be empty."""
UNITLESS = "", "-", "1"
INCH = re.compile(r'(?<=[EG])"(?=\s*[\[(/])')
"""A double prime written as a quotation mark, before a unit."""
MISSPELT = 0.8
"""Similarity to a known name from which a name counts as misspelt."""
SPELLINGS = {
    "time": "time, t, Zeit",
    "velocity": "velocity, V, v, speed, drive velocity, drive.velocity, v_drive, Geschwindigkeit",
    "sliding_velocity": "sliding_velocity, v_s, v_slide, slip velocity, Gleitgeschwindigkeit",
    "depth": "depth, delta, δ, indentation, indentation depth, penetration, Tiefe, Eindringtiefe",
    "-depth": "z_A, z, position, indenter position, height, Höhe, Hoehe, Lage",
    "depth_rate": "depth_rate, delta_dot, ddelta/dt, depth velocity",
    "-depth_rate": "v_z, vz_A, dz_A/dt, z_A_dot, vertical velocity",
    "load": "load, W, Last",
    "normal_force": "normal_force, F_z, F_n, normal load, vertical force, Normalkraft, Vertikalkraft",
    "friction_force": "friction_force, F_x, F_t, F, friction, tangential force, horizontal force, "
    "Reibkraft, Reibungskraft, Tangentialkraft",
    "spring_force": "spring_force, F_s, F_spring, drive force, pulling force, Federkraft, Zugkraft",
    "friction_coefficient": "friction_coefficient, mu, μ, µ, coefficient of friction, COF, Reibungszahl, "
    "Reibwert, Reibungskoeffizient",
    "leading_edge": "leading_edge, x_LE, Vorderkante",
    "trailing_edge": "trailing_edge, x_TE, Hinterkante",
    "peak_pressure": "peak_pressure, p_max, maximum pressure, pressure maximum, Druckmaximum, Maximaldruck",
    "radius": "radius, R",
    "temperature": "temperature, T, temp, temp., Temperatur",
}
"""Names of quantities in tables, case, spaces and underscores aside; a minus sign points the other way."""
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

    def error(self, quantity: str, message: str, row: int | None = None) -> ValueError:
        """Return an error about a column, and a row of it."""
        line = "" if row is None else f"line {self.lines[row]}, "
        return ValueError(
            f'{self.source}: {line}column "{shown(self.columns[quantity].head)}": {message}'
        )

    def si(self, quantity: str, *units: str) -> tuple[Array, str]:
        """Return a column in the first of some SI units that fits its own, and that unit."""
        column = self.columns[quantity]
        if not column.unit:
            raise self.error(
                quantity, f'has no unit; expected "{column.head} [{units[0]}]" or the like'
            )
        message = ""
        for unit in units:
            try:
                scale, zero = (to_si(f"{x} {_spelt(column.unit, unit)}", unit) for x in ("1", "0"))
                return column.values * (scale - zero) + zero, unit
            except ValueError as error:
                message = message or str(error)
        raise self.error(quantity, message)

    def number(self, quantity: str) -> Array:
        """Return a column of dimensionless numbers."""
        column = self.columns[quantity]
        if column.unit not in UNITLESS:
            raise self.error(quantity, f'has the unit "{column.unit}"; expected none')
        return column.values

    def require(self, quantity: str, good: NDArray[np.bool_], message: str) -> None:
        """Raise unless all values of a column are good; name the first line that is not."""
        bad = np.flatnonzero(~good)
        if bad.size:
            value = self.columns[quantity].values[bad[0]]
            more = f", and {bad.size - 1} more" if bad.size > 1 else ""
            raise self.error(quantity, f"{value:g} {message}{more}", int(bad[0]))


def _key(name: str) -> str:
    for mark, prime in (("″", "''"), ('"', "''"), ("′", "'"), ("’", "'"), ("´", "'")):
        name = name.replace(mark, prime)
    return name.strip() if len(name.strip()) == 1 else plain(name)


def _spelt(unit: str, si: str) -> str:
    """Return a unit as `kvtheory.scene.units` reads it: instruments write C for degrees Celsius."""
    return {"C": "degC", "F": "degF"}.get(unit, unit) if si == "K" else unit


Known = dict[int, tuple[str, str, str]]
"""Quantity, header and unit of the known columns of a row, by their place."""


@dataclass(frozen=True)
class Reader:
    """Reads the tables of a subject by the names of its columns.

    `spellings` are the names of each quantity, separated by commas; only names of one letter must have the
    case that is listed: T is a temperature, t a time. `needed` tells from the quantities of a row whether it
    is a header; `example` is one, for messages. Cells of the quantities in `partial` may be empty or not
    finite; an empty one is NaN.
    """

    spellings: Mapping[str, str]
    needed: Callable[[set[str]], bool]
    example: str
    partial: Container[str] = ()

    @cached_property
    def known(self) -> dict[str, tuple[str, str]]:
        """Quantity and spelling of each name, as it is compared."""
        pairs = (
            (name, each) for name, every in self.spellings.items() for each in every.split(", ")
        )
        return {_key(each): (name, each) for name, each in pairs}

    def meant(self, head: str) -> str | None:
        """Return the known name that a header misspells, or None."""
        near = get_close_matches(_key(parts(head)[0]), self.known, n=1, cutoff=MISSPELT)
        return self.known[near[0]][1] if near else None

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
            message = f"expected a path or a mapping of arrays; got {type(data).__name__}"
            raise TypeError(f"`data`: {message}")
        for name, column in table.columns.items():
            if name not in self.partial:
                table.require(name, np.isfinite(column.values), "is not a finite number")
        return table

    def _of_arrays(self, data: Any) -> Table:
        heads = list(map(str, data))
        found = self._known(heads, "`data`")
        if not self.needed({name for name, _, _ in found.values()}):
            raise ValueError(f"`data`: {self._lacking(heads)}")
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
            message = " and ".join(map(str, sorted(sizes)))
            raise ValueError(f"`data`: the columns differ in length: {message}")
        rows = np.arange(1, sizes.pop() + 1)
        return Table("`data`", columns, rows, self._others(heads, found))

    def _of_file(self, path: Path) -> Table:
        try:
            text = read_text(path)
        except UnicodeDecodeError:
            text = "\0"
        if "\0" in text:
            message = "not a text file; export a table as text or CSV"
            raise ValueError(f"{path}: {message}; expected {self.example}")
        lines, at, header = text.splitlines(), 0, None
        skipped = -1
        tables: list[tuple[Known, dict[str, Array], list[int], tuple[str, ...]]] = []
        while at < len(lines):
            found_here = None if _blank(lines[at]) else self._header(lines[at], lines[0])
            if found_here is None:
                if not _blank(lines[at]):
                    if STARTS.match(lines[at]):
                        raise ValueError(f"{path}: {self._headless(lines, skipped, at)}")
                    skipped = at
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
        if not tables:
            message = (
                "holds a header and no rows" if header else self._headless(lines, skipped, None)
            )
            raise ValueError(f"{path}: {message}")
        kinds = {
            tuple(sorted((name, unit) for name, _, unit in found.values())) for found, *_ in tables
        }
        if len(kinds) > 1:
            message = " and ".join(", ".join(map(" ".join, kind)) for kind in sorted(kinds))
            raise ValueError(f"{path}: its tables differ in their columns or units: {message}")
        columns = {
            name: Column(head, unit, np.concatenate([values[name] for _, values, *_ in tables]))
            for name, head, unit in tables[0][0].values()
        }
        numbers = np.concatenate([np.array(rows) + 1 for _, _, rows, _ in tables])
        return Table(str(path), columns, numbers, tables[0][3])

    def _header(self, line: str, first: str) -> tuple[list[str], str] | None:
        """Return the cells and the separator, that of ``sep=;`` or the best, of a row that is a header."""
        named, best, most = SEPARATED.match(first), None, 0
        for separator in named[1] if named else SEPARATORS:
            cells = _split(line, separator)
            known = {self._quantity(cell)[0] for cell in cells if cell} - {None}
            if len(known) > most and self.needed({name for name in known if name}):
                best, most = (cells, separator), len(known)
        return best

    def _quantity(self, cell: str) -> tuple[str | None, str]:
        """Return the quantity that a header names, and its unit; "G(t)" and "tan(delta)" are names."""
        whole = self._name(cell)
        name, unit = (cell, "") if whole else parts(cell)
        return whole or self._name(name), unit

    def _name(self, head: str) -> str | None:
        return self.known.get(_key(head), (None, ""))[0]

    def _known(self, cells: Sequence[str], source: str, units: Sequence[str] = ()) -> Known:
        found: Known = {}
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
                message = f'has the unit "{unit}" in its name and "{below}" below it'
                raise ValueError(f'{source}: column "{shown(cell)}": {message}')
            seen[name] = cell
            found[i] = name, cell, unit or below
        return found

    def _others(self, cells: Sequence[str], found: Known) -> tuple[str, ...]:
        return tuple(shown(cell) for i, cell in enumerate(cells) if cell and i not in found)

    def _headless(self, lines: Sequence[str], text: int, numbers: int | None) -> str:
        """Return that no header precedes a row of numbers, or the end; a row of text may be meant as one."""
        if text >= 0:
            cells = max((_split(lines[text], each) for each in SEPARATORS), key=len)
            words = [cell for cell in cells if number(cell, ",") is None]
            message = self._lacking(cells)
            if 0 < len(words) < len(cells):  # a row of numbers with a mistake; no header has any
                message = f'"{shown(words[0])}" is not a number'
            return f'line {text + 1}, "{shown(lines[text])}": {message}'
        message = "is empty"
        if numbers is not None:
            message = f"line {numbers + 1} holds numbers, and no row above it names the columns"
        return f"{message}; expected {self.example}"

    def _lacking(self, heads: Sequence[str]) -> str:
        """Return what columns lack to be those of a table."""
        found = dict.fromkeys(name for head in heads if (name := self._quantity(head)[0]))
        message = f"has only {', '.join(found)}" if found else "has no column that is known"
        unknown = [head for head in heads if head and not self._quantity(head)[0]]
        hints = [
            f'"{shown(head)}" may be "{near}"' for head in unknown if (near := self.meant(head))
        ]
        return "; ".join([message, *hints, f"expected {self.example}"])


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
    path: Path, lines: Sequence[str], rows: Sequence[int], header: tuple[list[str], str], found: Known,
    partial: Container[str],
) -> dict[str, Array]:  # fmt: skip
    """Return the known columns; if the fast reader fails, find the cell that is no number."""
    names = [name for name, _, _ in found.values()]
    (heads, separator), decimal = header, "." if header[1] == "," else ","
    texts = [lines[k].replace(",", ".") if decimal == "," else lines[k] for k in rows]
    mixed = (
        decimal == "," and any("," in lines[k] for k in rows) and any("." in lines[k] for k in rows)
    )
    if not mixed and all(text.count(separator) < len(heads) for text in texts):
        with suppress(ValueError):
            options: Any = {"delimiter": separator, "usecols": list(found), "quotechar": '"'}
            return dict(zip(names, np.loadtxt(texts, ndmin=2, **options).T, strict=True))
    values: list[list[float]] = []
    marks: dict[str, int] = {}
    for k in rows:
        cells = _split(lines[k], separator)
        while len(cells) > len(heads) and not cells[-1]:
            del cells[-1]
        if len(cells) > len(heads):
            message = f"line {k + 1} has {len(cells)} cells, the header has {len(heads)}"
            message += "; are there decimal commas? Then separate by semicolons" * (
                separator == ","
            )
            raise ValueError(f"{path}: {message}")
        row = []
        for i, (name, head, _) in found.items():
            cell = cells[i] if i < len(cells) else ""
            value = math.nan if not cell and name in partial else number(cell, decimal)
            if value is None:
                hint = "; write the decimal mark as a point" if "," in cell else ""
                hint += ", and no thousands separator" if "," in cell and "." in cell else ""
                message = f'"{shown(cell)}" is not a number{hint}' if cell else "the cell is empty"
                raise ValueError(f'{path}: line {k + 1}, column "{shown(head)}": {message}')
            marks |= {mark: k + 1 for mark in ",." if mark in cell}
            if len(marks) > 1:
                where = f"a comma in line {marks[',']} and a point in line {marks['.']}"
                raise ValueError(f"{path}: the decimal mark is {where}; expected one of them")
            row.append(value)
        values.append(row)
    return dict(zip(names, np.array(values).T, strict=True))


KEY = "drive.file"
HISTORY = Reader(
    {name: SPELLINGS[name] for name in ("time", "velocity")},
    {"time", "velocity"}.issubset,
    'a first line such as "t [ms],V [mm/s]", and then numbers',
)


def history_from(path: Path) -> tuple[tuple[float, float], ...]:
    """Return the points (t, V) in SI of a table of time and velocity, or raise SceneError with the line."""
    try:
        table = HISTORY.read(path)
        t, V = table.si("time", "s")[0], table.si("velocity", "m/s")[0]
    except OSError as error:
        raise mistake(KEY, str(path), f"cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise mistake(KEY, str(path), str(error).removeprefix(f"{path}: ")) from None
    points = zip(t.tolist(), V.tolist(), strict=True)
    return history_points(list(points), f"{KEY} ({path.name})")
