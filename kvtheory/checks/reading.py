"""Reads a time series from any program: a CSV, a result with our names, or a mapping of arrays.

Columns are recognised by name and unit, as people write them: ``t [ms]``, ``Time (s)``, ``t/ms``,
``z_A [mm]``, ``F_z in N/mm``, ``Zeit [ms]``; a height of the indenter, z_A = -depth (Eq. 18), becomes a
depth.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from kvtheory.checks.theory import Array
from kvtheory.results.table import SERIES_UNITS
from kvtheory.scene.mistakes import shown
from kvtheory.scene.tables import numbers, parts, plain, read_table
from kvtheory.scene.units import bare, to_si

PRESSURE = {"peak_pressure": "N/m^2"}
"""The unit as `kvtheory.scene.units` spells it."""
CURVE = {"friction_coefficient": "1", **PRESSURE}
"""Units beside those of a series, of a curve over the velocity too."""
SI_UNITS: Mapping[str, str] = {**SERIES_UNITS, **CURVE}
"""The units of the series of a line contact, in that spelling."""

SPELLINGS = {
    "time": "time, t, Zeit",
    "velocity": "velocity, V, drive velocity, drive.velocity, v_drive, Geschwindigkeit",
    "sliding_velocity": "sliding_velocity, sliding velocity, v_s, v_slide, slip velocity, "
    "Gleitgeschwindigkeit",
    "depth": "depth, delta, δ, indentation, indentation depth, penetration, Tiefe, Eindringtiefe",
    "-depth": "z_A, z, position, indenter position, height, Höhe, Hoehe, Lage",
    "depth_rate": "depth_rate, delta_dot, ddelta/dt, depth velocity",
    "-depth_rate": "v_z, vz_A, dz_A/dt, z_A_dot, vertical velocity",
    "normal_force": "normal_force, F_z, F_n, normal load, vertical force, Normalkraft, Vertikalkraft",
    "friction_force": "friction_force, F_x, F_t, F, friction, tangential force, horizontal force, "
    "Reibkraft, Reibungskraft, Tangentialkraft",
    "spring_force": "spring_force, spring force, F_s, F_spring, drive force, pulling force, Federkraft, "
    "Zugkraft",
    "friction_coefficient": "friction_coefficient, mu, µ, friction coefficient, coefficient of friction, "
    "COF, "
    "Reibungszahl, Reibwert, Reibungskoeffizient",
    "leading_edge": "leading_edge, x_LE, Vorderkante",
    "trailing_edge": "trailing_edge, x_TE, Hinterkante",
    "peak_pressure": "peak_pressure, p_max, maximum pressure, pressure maximum, Druckmaximum, Maximaldruck",
}
"""How each quantity may be named; a minus sign marks those that point the other way."""
KNOWN = {
    plain(spelling): (quantity, spelling)
    for quantity, spellings in SPELLINGS.items()
    for spelling in spellings.split(", ")
}
"""The quantity and the spelling of each name, in lower case and without marks."""
SHOWN = (
    "time, depth (or z_A), normal_force, friction_force, spring_force, leading_edge, trailing_edge"
)
MISSPELT = 0.8
"""Similarity to a known name from which a name counts as misspelt, not as something else."""
SHORTEST, FEWEST_POINTS, MOST_ROWS = 8, 5, 2000
"""Fewest rows that can show a jump, a transient of two time constants and a limit; fewest velocities of a
curve;
and about how many rows are kept of longer data, as more would not change a verdict."""
BRIEFEST = 1e-30
"""Shortest span in s: no contact changes in a shorter time, whose powers would underflow."""
MAY_BE_ABSENT = "leading_edge", "trailing_edge", "peak_pressure"
"""Quantities that do not exist in flight: some of their cells may be empty or NaN."""
JUDGED = ("depth", "normal_force", "friction_force", "spring_force")
"""At least one of these is needed."""


class Column(NamedTuple):
    """What a column of a file holds: `quantity` = `factor` times its numbers, in SI."""

    header: str
    quantity: str
    factor: float


def recognise(header: str, units: Mapping[str, str] = SI_UNITS) -> Column | None:
    """Return what a column holds; None if its name is not similar to that of any quantity.

    `units` are those of the scene: the forces of a ball are totals. `ValueError` names the column, what it
    lacks or which unit is expected, and the nearest known name.
    """
    header = header.strip()
    name, unit = (header, "") if plain(header) in KNOWN else parts(header)  # "dz_A/dt" is a name
    if plain(name) not in KNOWN:
        near = get_close_matches(plain(name), KNOWN, n=1, cutoff=MISSPELT)
        if not near:
            return None
        known = "; ".join(f"{q.lstrip('-')}: {names}" for q, names in SPELLINGS.items())
        told = f'column "{header}": unknown name, did you mean "{KNOWN[near[0]][1]}"?'
        raise ValueError(f"{told}; known names are {known}; rename a column that is something else")
    quantity = KNOWN[plain(name)][0]
    sign, quantity = (-1.0, quantity[1:]) if quantity[0] == "-" else (1.0, quantity)
    si = units[quantity]
    if si == "1" and unit in ("", "-", "%"):
        return Column(header, quantity, 0.01 if unit == "%" else 1.0)
    if not unit:
        raise ValueError(f'column "{header}": has no unit; expected "{name} [{si}]" or the like')
    try:
        return Column(header, quantity, sign * (1.0 if unit == si else to_si(f"1 {unit}", si)))
    except ValueError as error:
        raise ValueError(f'column "{header}": {error}') from None


@dataclass(frozen=True)
class Series:
    """A time series in SI; what is known of the simulation behind it is set, the rest is None."""

    columns: Mapping[str, Array]
    source: str
    per_length: float | None = None
    time_step: float | None = None
    scheme: str | None = None
    ignored: tuple[str, ...] = ()
    """Columns of no known name."""
    curve: bool = False
    """Whether the rows are steady states at velocities, which then stand in the place of the times."""

    @property
    def time(self) -> Array:
        """The times in s."""
        return self.columns["time"]


def read(data: Any, units: Mapping[str, str] = SI_UNITS) -> Series:
    """Return the series that `data` holds: a path to a CSV, a result, or a mapping of arrays.

    In a CSV ``#`` begins a comment, then comes a header with names and units, then numbers. `units` are
    those of the quantities of the scene, in SI. `ValueError` says what cannot be recognised or used: a
    column, a unit, a cell, the order of the times; `TypeError`, that `data` cannot hold a series.

    Examples
    --------
    >>> series = read({"t [ms]": range(8), "z_A [mm]": [-0.3] * 8})
    >>> series.columns["depth"].tolist()[0], series.time.tolist()[-1]
    (0.0003, 0.007)
    """
    units = {**units, **CURVE}
    if isinstance(data, (str, PathLike)):
        path = Path(data)
        table = read_table(path)
        columns = _recognised(table.heads, units, [], str(path))
        if not table.rows:
            raise ValueError(f"{path}: holds a header and no rows")
        used = [column is not None for column in columns]
        values = [numbers(path, table, line, cells, used) for line, cells in table.rows]
        lines = [f"line {line}" for line, _ in table.rows]
        return _checked(columns, table.heads, np.array(values, dtype=float).T, str(path), lines)
    source, known = "arrays", {}
    if not (isinstance(data, Mapping) or (hasattr(data, "columns") and not isinstance(data, type))):
        known = {key: getattr(data, key, None) for key in ("per_length", "time_step", "scheme")}
        source = str(known["scheme"] or getattr(data, "model", None) or type(data).__name__)
        found = {name: getattr(data, name, None) for name in SI_UNITS}
        if found["time"] is None and found["velocity"] is None:
            what = "a path to a CSV, a mapping of arrays, or a result with time, depth, ..."
            raise TypeError(f"`data`: expected {what}; got {type(data).__name__}")
        data = {name: values for name, values in found.items() if values is not None}
    heads: list[str] = []
    arrays: list[Array] = []
    problems: list[str] = []
    for key in data:
        unit = None
        try:
            array, unit = bare(data[key])
            arrays.append(np.atleast_1d(np.asarray(array, dtype=float)))
        except (TypeError, ValueError) as error:
            problems.append(f'column "{shown(key)}": {error}')
        unit = unit or (units.get(key, "") if isinstance(key, str) else "")
        heads.append(f"{key} [{unit}]" if unit else str(key))
    columns = _recognised(heads, units, problems, "`data`")
    rows = [f"row {k + 1}" for k in range(max(map(len, arrays), default=0))]
    return _checked(columns, heads, arrays, source, rows, **known)


def _recognised(
    heads: Sequence[str], units: Mapping[str, str], problems: list[str], source: str
) -> list[Column | None]:
    """Return what the columns hold, None for those of no known name; report what is wrong with any."""
    columns: list[Column | None] = []
    seen: dict[str, str] = {}
    for head in heads:
        try:
            column = recognise(head, units)
        except ValueError as error:
            problems.append(str(error))
            continue
        columns.append(column)
        if column is not None:
            if column.quantity in seen:
                both = f'columns "{seen[column.quantity]}" and "{head}"'
                problems.append(f"{both} are both the {column.quantity}; keep one of them")
            seen[column.quantity] = head
    _raise(source, problems)
    return columns


def _raise(source: str, problems: Sequence[str]) -> None:
    if problems:
        raise ValueError("\n".join(f"{source}: {problem}" for problem in problems))


def _unusable(time: Array, curve: bool, places: Sequence[str]) -> Iterator[str]:
    """Yield why times, or the velocities of a curve, cannot be judged."""
    steps, distinct = np.diff(time), np.unique(time).size
    if curve:
        if distinct < FEWEST_POINTS:
            yield f"holds {distinct} velocities; at least {FEWEST_POINTS} show a curve and its scatter"
    elif time.size < SHORTEST:
        yield f"holds {time.size} rows; at least {SHORTEST} are needed to judge a transient"
    elif steps.min() < 0.0:
        k = int(np.argmax(steps < 0.0)) + 1
        follows = f"{time[k]:.9g} s in {places[k]} follows {time[k - 1]:.9g} s"
        yield f"the time must increase, but {follows}"
    elif np.count_nonzero(steps) < SHORTEST - 1 or time[-1] < BRIEFEST:
        yield f"the times do not span a transient: {time[0]:.9g} s to {time[-1]:.9g} s"


def _without(values: Mapping[str, Array], name: str) -> dict[str, Array]:
    return {other: array for other, array in values.items() if other != name}


def _by_velocity(values: Mapping[str, Array]) -> dict[str, Array]:
    """Return columns in the order of the velocity, which stands in the place of the time."""
    order = np.argsort(values["velocity"], kind="stable")
    columns = {n: x[order] if x.shape == order.shape else x for n, x in values.items()}
    return {**columns, "time": columns["velocity"]}


def _checked(
    columns: Sequence[Column | None], heads: Sequence[str], arrays: Iterable[Array], source: str,
    places: Sequence[str], **known: Any,
) -> Series:  # fmt: skip
    """Return the series of the columns that are known, or raise with every reason why it cannot be judged."""
    pairs = [(c, array) for c, array in zip(columns, arrays, strict=True) if c is not None]
    if not pairs:
        names = shown(", ".join(heads))
        raise ValueError(f"{source}: no column is known: {names}; expected {SHOWN}")
    values = {column.quantity: column.factor * array for column, array in pairs}
    problems: list[str] = []
    curve = "time" not in values and "velocity" in values
    if curve:
        order = np.argsort(values["velocity"], kind="stable")
        values = {
            name: array[order] if array.shape == order.shape else array
            for name, array in values.items()
        }
        values["time"] = values["velocity"]
    else:
        values.pop("friction_coefficient", None)
    if "time" not in values:
        problems.append(f"no column is the time; expected t [ms] or time [s] beside {SHOWN}")
    if not any(name in values for name in (*JUDGED, *("friction_coefficient",) * curve)):
        problems.append(f"nothing to judge: expected one of {', '.join(JUDGED)}")
    sizes = {array.shape for array in values.values()}
    if len(sizes) > 1 or any(len(size) != 1 for size in sizes):
        shapes = ", ".join(f"{name} {array.shape}" for name, array in values.items())
        problems.append(f"the columns differ in length: {shapes}")
    _raise(source, problems)
    for column in (column for column, _ in pairs if column.quantity in values):
        array = values[column.quantity]
        bad = np.flatnonzero(~np.isfinite(array))
        if bad.size and not (column.quantity in MAY_BE_ABSENT and bad.size < array.size):
            count = f"{bad.size} of {array.size} values are missing, NaN or infinite"
            first = f"the first in {places[bad[0]]}; a simulation that diverges ends like this"
            problems.append(f'column "{column.header}": {count}, {first}')
    _raise(source, problems)
    time = values["time"]
    _raise(source, list(_unusable(time, curve, places)))
    step = -(-time.size // MOST_ROWS)
    thinned = {name: values[name][::step] for name in SI_UNITS if name in values}
    ignored = (shown(head) for head, c in zip(heads, columns, strict=True) if c is None)
    return Series(thinned, source, **known, ignored=tuple(ignored), curve=curve)
