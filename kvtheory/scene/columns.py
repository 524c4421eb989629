"""Measured tables as instruments export them: columns by name and unit, each value with its line.

Where the tables of a file are, `layouts` finds; those of one file form one. A temperature that is in the
head of each table is a column. What cannot be read, or could be read in two ways, raises ValueError with
the column and the line.
"""

import csv
import math
import re
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.drives import history_points
from kvtheory.scene.layouts import (
    MARKS,
    SPACES,
    STARTS,
    UNITLESS,
    Layout,
    best_row,
    blank,
    tables,
    undrawn,
)
from kvtheory.scene.mistakes import Problems, SceneError, mistake, problem, shown
from kvtheory.scene.tables import EXCEL, number, parts, plain, read_text, sheets, suffixed
from kvtheory.scene.units import bare, to_si

Array = NDArray[np.float64]

NAMED = {"\t": "tabs", ";": "semicolons", ",": "commas"}

MISSPELT = 0.8
"""Similarity to a known name from which a name counts as misspelt."""
SPELLINGS = {
    "time": "time, t, elapsed time, test time, timestamp, Zeit, Versuchszeit",
    "velocity": "velocity, V, v, V1, V_x, speed, drive velocity, drive.velocity, v_drive, "
    "Geschwindigkeit",
    "sliding_velocity": "sliding_velocity, v_s, v_slide, slip velocity, sliding speed, linear speed, "
    "linear velocity, relative velocity, relative speed, Gleitgeschwindigkeit",
    "depth": "depth, delta, δ, indentation, indentation depth, penetration, Tiefe, Eindringtiefe",
    "-depth": "z_A, z, position, indenter position, height, Höhe, Hoehe, Lage",
    "depth_rate": "depth_rate, delta_dot, ddelta/dt, depth velocity",
    "-depth_rate": "v_z, vz_A, dz_A/dt, z_A_dot, vertical velocity",
    "load": "load, W, Last",
    "normal_force": "normal_force, F_z, F_n, normal load, vertical force, vertical load, applied load, "
    "Normalkraft, Vertikalkraft",
    "friction_force": "friction_force, F_x, F_t, F, friction, lateral force, tangential force, "
    "horizontal force, Reibkraft, Reibungskraft, Tangentialkraft",
    "spring_force": "spring_force, F_s, F_spring, drive force, pulling force, Federkraft, Zugkraft",
    "friction_coefficient": "friction_coefficient, mu, μ, µ, coefficient of friction, CoF, friction coeff, "
    "friction coeff., friction factor, Reibungszahl, Reibwert, Reibungskoeffizient",
    "leading_edge": "leading_edge, x_LE, Vorderkante",
    "trailing_edge": "trailing_edge, x_TE, Hinterkante",
    "peak_pressure": "peak_pressure, p_max, maximum pressure, pressure maximum, Druckmaximum, Maximaldruck",
    "radius": "radius, R",
    "temperature": "temperature, T, temp, temp., Temperatur",
}
"""Names of quantities in tables, case, spaces and underscores aside; a minus sign points the other way."""
BY_UNIT = {"T": ("t", "s"), "t": ("T", "K")}
"""Letters that mean the other where their unit is of its dimension: T [s] is a time."""
SYMBOL = re.compile(r"[^\W\d_]_(?![xyz]$)\w{1,3}", re.IGNORECASE)
"""A symbol behind the words of a name, which tell the quantity; those of directions do not."""
IN_BRACKETS = re.compile(r"(.*\S)\s*\(([^()]+)\)$")
"""A symbol in brackets behind the words of a name."""
LOGARITHM = re.compile(r"(?:log|lg)(?:_?10)?[\s_(]+", re.IGNORECASE)
IN_HEAD = re.compile(
    r"(?P<value>[-+]?\d+(?:[.,]\d+)?)[\s;\"]*(?P<unit>°\s?C|℃|deg\.? ?C|degC|K)(?![\w/])"
)
"""A temperature in the head of a table."""


class Column(NamedTuple):
    """A column of a table: its values as they stand in the file, its header and its unit."""

    head: str
    unit: str
    values: Array


@dataclass(frozen=True)
class Table:
    """The known columns by quantity, the line of each row, the headers of other columns, and remarks."""

    source: str
    columns: Mapping[str, Column]
    lines: NDArray[np.int_]
    ignored: tuple[str, ...]
    notes: tuple[str, ...] = ()
    parts: NDArray[np.int_] | None = None
    """The number of the table of each row, where a file holds several."""
    header: int = 0
    """The line of the first header, in a file."""

    def __contains__(self, quantity: str) -> bool:
        return quantity in self.columns

    def error(self, quantity: str, message: str, row: int | None = None) -> ValueError:
        """Return an error about a column, and a row of it."""
        line = self.header if row is None else self.lines[row]
        line = f"line {line}, " if line else ""
        head = shown(self.columns[quantity].head)
        return ValueError(f'{self.source}: {line}column "{head}": {message}')

    def si(self, quantity: str, *units: str) -> tuple[Array, str]:
        """Return a column in the first of some SI units that fits its own, and that unit."""
        column = self.columns[quantity]
        if not column.unit:
            raise self.error(
                quantity,
                f'has no unit; expected "{column.head} [{units[0]}]" or the like, or a row of units',
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
        """Return a column of dimensionless numbers; they may be given in percent."""
        column = self.columns[quantity]
        if column.unit not in (*UNITLESS, "%"):
            raise self.error(quantity, f'has the unit "{column.unit}"; expected none, or %')
        return column.values * (0.01 if column.unit == "%" else 1.0)

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


FORCES = {"g": "gf", "kg": "kgf", "lb": "lbf", "gram": "gf", "grams": "gf"}
"""Units of mass that stand for the weight of it, where a force is meant."""


def _spelt(unit: str, si: str) -> str:
    """Return a unit as `kvtheory.scene.units` reads it: C is Celsius, and g the weight of a gram."""
    if si == "K":
        return {"C": "degC", "F": "degF", "ºC": "degC", "° C": "degC", "deg C": "degC"}.get(
            unit, unit
        )
    unit = unit.replace("⁻¹", "^-1").replace("sec", "s")
    if si in ("N", "N/m"):
        weight, slash, width = unit.partition("/")
        return f"{FORCES.get(weight, weight)}{slash}{width}"
    return unit


Known = dict[int, tuple[str, str, str]]
"""Quantity, header and unit of the known columns of a row, by their place."""


@dataclass(frozen=True)
class Reader:
    """Reads the tables of a subject by the names of its columns.

    `spellings` are the names of each quantity, separated by commas; only names of one letter must have the
    case that is listed: T is a temperature, t a time. `needed` tells from the quantities of a row whether it
    is a header; `example` is one, for messages. Cells of the quantities in `partial` may be empty or not
    finite; an empty one is NaN. With `in_head`, a temperature may stand in the head of each table. Cells of
    the quantities in `words` are text, and every line below the header is a row then.
    """

    spellings: Mapping[str, str]
    needed: Callable[[set[str]], bool]
    example: str
    partial: Container[str] = ()
    in_head: bool = False
    words: Container[str] = ()

    @cached_property
    def known(self) -> dict[str, tuple[str, str]]:
        """Quantity and spelling of each name, as it is compared."""
        pairs = ((name, each) for name, row in self.spellings.items() for each in row.split(", "))
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
        problems = Problems()
        for name, column in table.columns.items():
            if name not in self.partial and name not in self.words:
                with problems.catching():
                    table.require(name, np.isfinite(column.values), "is not a finite number")
        problems.report()
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
        if path.suffix.lower() in EXCEL:
            return self._of_sheets(path)
        try:
            text = read_text(path)
        except UnicodeDecodeError:
            text = "\0"
        if "\0" in text or text.lstrip()[:1] in ("<", "{"):
            kind = "a text file" if "\0" in text else "a table but a page of HTML, XML or JSON"
            message = f"not {kind}; export a table as text or CSV"
            raise ValueError(f"{path}: {message}; expected {self.example}")
        return self._of_lines(text.splitlines(), str(path))

    def _of_sheets(self, path: Path) -> Table:
        """Return the table of the sheets of an Excel file that hold one; their names are above it."""
        every = sheets(path)
        used = {name: rows for name, rows in every.items() if tables(rows, self._named)[0]} or every
        lines = [line for name, rows in used.items() for line in (*[name] * (len(used) > 1), *rows)]
        source = str(path)
        if len(used) > 1:
            source += f" (lines of the sheets {', '.join(used)} one after the other, with names)"
        table = self._of_lines(lines, source)
        others = ", ".join(name for name in every if name not in used)
        notes = (f"Of the file, these sheets are not used: {others}.",) if others else ()
        return replace(table, notes=(*table.notes, *notes))

    def _of_lines(self, lines: Sequence[str], path: str) -> Table:
        lines = undrawn(lines)
        layouts, nameless = tables(lines, self._named, words=bool(self.words))
        if nameless is not None:
            message = f"line {nameless + 1} holds numbers, and no row above it names the columns"
            raise ValueError(f"{path}: {message}; expected {self.example}")
        if not layouts:
            raise ValueError(f"{path}: {self._headless(lines, path)}")
        read, notes = [], self._unread(lines, layouts[0])
        for each in layouts:
            found = self._known(each.heads, path, each.units)
            values, own = self._cells(path, lines, each, found)
            notes += own
            read.append((found, values))
        kinds = {tuple(sorted((n, unit) for n, _, unit in found.values())) for found, _ in read}
        if len(kinds) > 1:
            message = " and ".join(", ".join(map(" ".join, kind)) for kind in sorted(kinds))
            raise ValueError(f"{path}: its tables differ in their columns or units: {message}")
        columns = {
            name: Column(head, unit, np.concatenate([values[name] for _, values in read]))
            for name, head, unit in read[0][0].values()
        }
        sizes = [len(each.rows) for each in layouts]
        if self.in_head and "temperature" not in columns:
            heads = [self._temperature(each.above) for each in layouts]
            if any(head is not None for head in heads):
                missing = [each.line for each, T in zip(layouts, heads, strict=True) if T is None]
                if missing:
                    message = "the head of this table names no temperature, as that of others does"
                    raise ValueError(f"{path}: line {missing[0] + 1}: {message}")
                T = np.repeat(np.array(heads, dtype=float), sizes)
                columns["temperature"] = Column("temperature in the head of a table", "K", T)
                notes.append("The temperature is that in the head of each table.")
        numbers = np.concatenate([np.array(each.rows) + 1 for each in layouts])
        others = self._others(
            [""] * layouts[0].shift + layouts[0].heads[max(layouts[0].shift, 0) :], read[0][0]
        )
        return Table(
            path, columns, numbers, others, tuple(dict.fromkeys(notes)),
            np.repeat(np.arange(len(sizes)), sizes), layouts[0].line + 1,
        )  # fmt: skip

    def _cells(
        self, path: str, lines: Sequence[str], own: Layout, found: Known
    ) -> tuple[dict[str, Any], list[str]]:
        """Return the known columns, and notes; if the fast reader fails, find every cell without a number."""
        names, decimal = [name for name, _, _ in found.values()], own.decimal
        texts = [lines[k].replace(",", ".") if decimal == "," else lines[k] for k in own.rows]
        mixed = decimal == "," and any("," in lines[k] and "." in lines[k] for k in own.rows)
        marks = {m for k in own.rows for m in ",." if m in lines[k]} if decimal == "," else set()
        if not mixed and len(marks) < 2 and own.separator not in SPACES and not self.words:
            count = len(own.heads) - own.shift
            if all(text.count(own.separator) < count for text in texts):
                with suppress(ValueError):
                    places = [i - own.shift for i in found]
                    options: Any = {"delimiter": own.separator, "usecols": places, "quotechar": '"'}
                    columns = np.loadtxt(texts, ndmin=2, **options).T
                    return dict(zip(names, columns, strict=True)), []
        notes = [] if self.words else _footer(lines, own, found)
        values: list[list[Any]] = []
        seen: dict[str, int] = {}
        problems = Problems()
        for k in own.rows:
            cells = own.cells(lines[k])
            while len(cells) > len(own.heads) and not cells[-1]:
                del cells[-1]
            if len(cells) > len(own.heads):
                message = f"line {k + 1} has {len(cells)} cells, the header has {len(own.heads)}"
                message += f", separated by {NAMED.get(own.separator, 'spaces')}"
                message += "; are there decimal commas? Then use semicolons" * (
                    own.separator == ","
                )
                problems.append(f"{path}: {message}")
                continue
            row: list[Any] = []
            for i, (name, head, _) in found.items():
                cell = cells[i] if i < len(cells) else ""
                row.append(cell if name in self.words else number(cell, decimal))
                if row[-1] is None and not cell and name in self.partial:
                    row[-1] = math.nan
                elif row[-1] is None:
                    hint = "; write the decimal mark as a point" if "," in cell else ""
                    hint += ", and no thousands separator" if "," in cell and "." in cell else ""
                    message = (
                        f'"{shown(cell)}" is not a number{hint}' if cell else "the cell is empty"
                    )
                    problems.append(f'{path}: line {k + 1}, column "{shown(head)}": {message}')
                elif name not in self.words:
                    seen = {mark: k + 1 for mark in ",." if mark in cell} | seen
            values.append(row)
        if len(seen) > 1:
            where = f"a comma in line {seen[',']} and a point in line {seen['.']}"
            problems.append(f"{path}: the decimal mark is {where}; expected one of them")
        problems.report()
        return dict(zip(names, map(np.array, zip(*values, strict=True)), strict=True)), notes

    def _unread(self, lines: Sequence[str], first: Layout) -> list[str]:
        """Return a note on rows of numbers above the first header."""
        rows = [k for k in range(first.line) if STARTS.match(lines[k]) and not blank(lines[k])]
        several = [k for k in rows if len(re.findall(r"\d[\s;,]+[-+.]?\d", lines[k])) > 0]
        if len(several) < 3:
            return []
        where = f"Lines {several[0] + 1} to {several[-1] + 1}, above the header"
        return [f"{where} in line {first.line + 1}, are not used."]

    def _temperature(self, above: Sequence[str]) -> float | None:
        """Return the temperature (K) in the head of a table: of a line with its name, or the only one."""
        named: list[float] = []
        others: list[float] = []
        for line in above:
            matches = [
                to_si(
                    f"{m['value'].replace(',', '.')} {_spelt(m['unit'].replace(' ', ''), 'K')}", "K"
                )
                for m in IN_HEAD.finditer(line)
            ]
            first = re.split(r"[:=\t;,]", line.lstrip("#% \t"), maxsplit=1)[0]
            (named if self._name(first) == "temperature" else others).extend(matches)
        if named:
            return named[-1]
        return others[0] if len(set(others)) == 1 else None

    def _count(self, cells: Sequence[str], units: Sequence[str] = ()) -> set[str]:
        """Return the quantities that cells name, with the units below them."""
        found = set()
        for i, cell in enumerate(cells):
            name = self._quantity(cell, units[i] if i < len(units) else "")[0]
            found |= {name} if name else set()
        return found

    def _named(self, cells: Sequence[str], units: Sequence[str]) -> int:
        """Return how many quantities a header names; 0 where it is none."""
        found = self._count(cells, units)
        return len(found) if found and self.needed(found) else 0

    def _quantity(self, cell: str, below: str = "") -> tuple[str | None, str]:
        """Return the quantity that a header names, and its unit; "G(t)" and "tan(delta)" are names."""
        name, unit = self._name(cell), ""
        for split in () if name else (parts, suffixed):
            stem, unit = split(cell)
            if name := self._name(stem):
                break
            unit = ""
        stem, own = parts(cell)
        letter, si = BY_UNIT.get(stem, ("", ""))
        if letter and _fits(own or below, si) and (other := self._name(letter)):
            name, unit = other, own
        return name, unit

    def _name(self, head: str) -> str | None:
        """Return the quantity of a name, or of a symbol behind words, or of these: Friction force F_R."""
        symbol = IN_BRACKETS.match(head)
        words, last = symbol.groups() if symbol else head.rpartition(" ")[::2]
        tried = [head]
        if words and not LOGARITHM.match(head):
            both = [self.known.get(_key(each), [None])[0] for each in (words, last)]
            if not last.isalnum() or both[0] == both[1]:
                tried += [last, words] if SYMBOL.fullmatch(last) else [last]
        return next((self.known[_key(each)][0] for each in tried if _key(each) in self.known), None)

    def _known(self, cells: Sequence[str], source: str, units: Sequence[str] = ()) -> Known:
        found: Known = {}
        seen: dict[str, str] = {}
        for i, cell in enumerate(cells):
            below = units[i] if i < len(units) else ""
            name, unit = self._quantity(cell, below)
            if name is None:
                continue
            if name in seen:
                both = f'columns "{shown(seen[name])}" and "{shown(cell)}"'
                raise ValueError(f"{source}: {both} are both the {name}; keep one of them")
            if unit and below and unit != below:
                message = f'has the unit "{unit}" in its name and "{below}" below it'
                raise ValueError(f'{source}: column "{shown(cell)}": {message}')
            seen[name] = cell
            found[i] = name, cell, unit or below
        return found

    def _others(self, cells: Sequence[str], found: Known) -> tuple[str, ...]:
        return tuple(shown(cell) for i, cell in enumerate(cells) if cell and i not in found)

    def _headless(self, lines: Sequence[str], path: str) -> str:
        """Return why a file holds no table: of the row that names most, or of the one above numbers."""
        numbers = next(
            (k for k, line in enumerate(lines) if STARTS.match(line) and not blank(line)), None
        )
        text = [
            k
            for k, line in enumerate(lines[:numbers])
            if not STARTS.match(line) and not blank(line)
        ]
        at, cells = best_row(lines, lambda cells, units: len(self._count(cells, units)))
        if at < 0 and text:
            at, cells = text[-1], max((split(lines[text[-1]]) for split in MARKS.values()), key=len)
        if at < 0:
            message = "is empty"
            if numbers is not None:
                message = f"line {numbers + 1} holds numbers, and no row above it names the columns"
            return f"{message}; expected {self.example}"
        if self._named(cells, ()):
            self._known(cells, path)
            return f'holds a header and no rows: no numbers stand below line {at + 1}, "{shown(lines[at])}"'
        words = [cell for cell in cells if number(cell, ",") is None]
        message = self._lacking(cells)
        if 0 < len(words) < len(cells):  # a row of numbers with a mistake; no header has any
            message = f'"{shown(words[0])}" is not a number'
            if len(words) == 1 and cells[0] == words[0] and self._quantity(words[0])[0]:
                message = "holds the values of one quantity; expected a column for each, not a row"
        return f'line {at + 1}, "{shown(lines[at])}": {message}'

    def _lacking(self, heads: Sequence[str]) -> str:
        """Return what columns lack to be those of a table."""
        found = dict.fromkeys(name for head in heads if (name := self._quantity(head)[0]))
        message = f"has only {', '.join(found)}" if found else "has no column that is known"
        unknown = [head for head in heads if head and not self._quantity(head)[0]]
        hints = [
            f'"{shown(each)}" may be "{near}"' for each in unknown if (near := self.meant(each))
        ]
        hints += [
            f'"{shown(head)}" is a logarithm, expected the values themselves'
            for head in unknown
            if (log := LOGARITHM.match(head)) and self._quantity(head[log.end() :])[0]
        ]
        return "; ".join([message, *hints, f"expected {self.example}"])


def _fits(unit: str, si: str) -> bool:
    """Whether a unit is of a dimension."""
    with suppress(ValueError):
        return bool(unit) and to_si(f"1 {_spelt(unit, si)}", si) is not None
    return False


def _footer(lines: Sequence[str], own: Layout, found: Known) -> list[str]:
    """Leave out the last rows of a table that begin with a word in place of a number, and return notes."""
    notes: list[str] = []
    while len(own.rows) > 1 and 0 in found and own.cells(lines[own.rows[-1]])[0][:1].isalpha():
        last = own.rows.pop()
        notes.insert(0, f'Line {last + 1}, "{shown(lines[last])}", is not used.')
    return notes


KEY = "drive.file"
HISTORY = Reader(
    {
        **{name: SPELLINGS[name] for name in ("time", "velocity")},
        "position": "X, x, position, displacement, stage position, travel, Weg, Position X, x_pos",
    },
    lambda found: "time" in found and len(found) > 1,
    'a first line such as "t [ms],V [mm/s]" or "t [ms],X [mm]", and then numbers',
)
DEPTHS = Reader(
    {name: SPELLINGS[name] for name in ("time", "depth", "-depth")},
    lambda found: "time" in found and len(found) > 1,
    'a first line such as "t [s],depth [mm]" or "t [s],z [mm]", and then numbers',
)


@contextmanager
def _of_key(key: str, path: Path) -> Iterator[None]:
    """Report what is wrong with a file under the key of a scene that names it."""
    try:
        yield
    except OSError as error:
        raise mistake(key, str(path), f"cannot be read: {error.strerror}") from None
    except ValueError as error:
        found = (each.removeprefix(f"{path}: ") for each in str(error).split("\n"))
        raise SceneError([problem(key, str(path), each) for each in found]) from None


def depths_from(path: Path) -> tuple[tuple[float, float], ...]:
    """Return the points (t, depth) in SI of a table of time and depth, or height, or raise SceneError."""
    with _of_key("support.file", path):
        table = DEPTHS.read(path)
        name = "depth" if "depth" in table else "-depth"
        depth = table.si(name, "m")[0] * (1.0 if name == "depth" else -1.0)
        return tuple(zip(table.si("time", "s")[0].tolist(), depth.tolist(), strict=True))


def history_from(path: Path) -> tuple[tuple[float, float], ...]:
    """Return the points (t, V) in SI of a table of time and velocity, or raise SceneError with the line.

    Of a table of time and position, V is the derivative of the parabola through three neighbouring rows.
    """
    with _of_key(KEY, path):
        table = HISTORY.read(path)
        t = table.si("time", "s")[0]
        if "velocity" in table:
            V = table.si("velocity", "m/s")[0]
        else:
            message = "does not follow the time before; positions need times that increase"
            table.require("time", np.append(True, np.diff(t) > 0.0), message)
            if t.size < 3:
                raise table.error("position", f"{t.size} rows; at least 3 tell a velocity")
            V = np.gradient(table.si("position", "m")[0], t, edge_order=2)
    points = zip(t.tolist(), V.tolist(), strict=True)
    return history_points(list(points), f"{KEY} ({path.name})")
