"""Reads a time series from any program: a CSV, a result with our names, or a mapping of arrays.

Columns are recognised by name and unit, as people write them: ``t [ms]``, ``Time (s)``, ``t/ms``,
``z_A [mm]``, ``F_z in N/mm``, ``Zeit [ms]``; a height of the indenter, z_A = -depth (Eq. 18), becomes a
depth.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np

from kvtheory.results.table import SERIES_UNITS
from kvtheory.scene.columns import SPELLINGS, Array, Reader, Table

PRESSURE = {"peak_pressure": "N/m^2"}
"""The unit as `kvtheory.scene.units` spells it."""
CURVE = {"friction_coefficient": "1", **PRESSURE}
"""Units beside those of a series, of a curve over the velocity too."""
SI_UNITS: Mapping[str, str] = {**SERIES_UNITS, **CURVE}
"""The units of the series of a line contact, in that spelling."""

NAMES = ("-depth", "-depth_rate", *SI_UNITS)
"""What is read; a minus sign marks a quantity that points the other way."""
SHOWN = (
    "time, depth (or z_A), normal_force, friction_force, spring_force, leading_edge, trailing_edge"
)
SHORTEST, FEWEST_POINTS, MOST_ROWS = 8, 5, 2000
"""Fewest rows that show a jump, a transient of two time constants and a limit; fewest velocities of a curve;
and about how many rows of longer data are kept, as more would not change a verdict."""
BRIEFEST = 1e-30
"""Shortest span in s; powers of a shorter one would underflow."""
MAY_BE_ABSENT = "leading_edge", "trailing_edge", "peak_pressure"
"""Quantities that do not exist in flight: some of their cells may be empty or NaN."""
JUDGED = ("depth", "normal_force", "friction_force", "spring_force")
"""At least one of these is needed."""
READER = Reader({name: SPELLINGS[name] for name in NAMES}, bool, SHOWN, NAMES)
"""Reads columns by these names; `_checked` reports what is missing or not finite."""


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
    """Whether the rows are steady states at velocities, which then take the place of the times."""

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
    known: dict[str, Any] = {}
    if not isinstance(data, (str, PathLike)):
        data, known = _arrays(data, units)
    table = READER.read(data)
    values: dict[str, Array] = {}
    heads: dict[str, str] = {}
    problems = list(_misspelt(table.ignored))
    for name, column in table.columns.items():
        quantity = name.lstrip("-")
        if quantity in values:
            both = f'columns "{heads[quantity]}" and "{column.head}"'
            problems.append(f"{both} are both the {quantity}; keep one of them")
        try:
            unit = units[quantity]
            array = table.number(name) if unit == "1" else table.si(name, unit)[0]
        except ValueError as error:
            problems.append(str(error).removeprefix(f"{table.source}: "))
            continue
        values[quantity], heads[quantity] = -array if name != quantity else array, column.head
    _raise(table.source, problems)
    if not {"time", "velocity"} & values.keys() and "sliding_velocity" in values:  # of a curve
        values["velocity"] = values.pop("sliding_velocity")
        heads["velocity"] = heads.pop("sliding_velocity")
    return _checked(values, heads, table, known)


def _arrays(data: Any, units: Mapping[str, str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return columns by header, with our units for our names, and what is known of a simulation."""
    known = {}
    if not (isinstance(data, Mapping) or (hasattr(data, "columns") and not isinstance(data, type))):
        known = {key: getattr(data, key, None) for key in ("per_length", "time_step", "scheme")}
        known["source"] = str(
            known["scheme"] or getattr(data, "model", None) or type(data).__name__
        )
        found = {name: getattr(data, name, None) for name in SI_UNITS}
        if found["time"] is None and found["velocity"] is None:
            what = "a path to a CSV, a mapping of arrays, or a result with time, depth, ..."
            raise TypeError(f"`data`: expected {what}; got {type(data).__name__}")
        data = {name: values for name, values in found.items() if values is not None}
    ours = {key: f"{key} [{units[key]}]" for key in data if isinstance(key, str) and key in units}
    return {ours.get(key, str(key)): data[key] for key in data}, known


def _misspelt(heads: Iterable[str]) -> Iterator[str]:
    """Yield the headers that are similar to a known name."""
    for head in heads:
        if near := READER.meant(head):
            message = f'column "{head}": unknown name, did you mean "{near}"?'
            yield f"{message} Rename a column that is something else"


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


def _checked(
    values: dict[str, Array], heads: Mapping[str, str], table: Table, known: Mapping[str, Any]
) -> Series:
    """Return the series of columns in SI, or raise with every reason why it cannot be judged."""
    problems, curve = [], "time" not in values and "velocity" in values
    if curve:  # the velocity stands in the place of the time
        order = np.argsort(values["velocity"], kind="stable")
        values = {name: array[order] for name, array in values.items()}
        values["time"] = values["velocity"]
    else:
        order = np.arange(table.lines.size)
        values.pop("friction_coefficient", None)
    if "time" not in values:
        problems.append(f"no column is the time; expected t [ms] or time [s] beside {SHOWN}")
    if not values.keys() & {*JUDGED, *("friction_coefficient",) * curve}:
        problems.append(f"nothing to judge: expected one of {', '.join(JUDGED)}")
    _raise(table.source, problems)
    place = "row" if table.source == "`data`" else "line"
    places = [f"{place} {line}" for line in table.lines[order]]
    for name in values.keys() & heads.keys():
        bad = np.flatnonzero(~np.isfinite(values[name]))
        if bad.size and not (name in MAY_BE_ABSENT and bad.size < order.size):
            count = f"{bad.size} of {order.size} values are missing, NaN or infinite"
            first = f"the first in {places[bad[0]]}; a simulation that diverges ends like this"
            problems.append(f'column "{heads[name]}": {count}, {first}')
    _raise(table.source, problems)
    _raise(table.source, list(_unusable(values["time"], curve, places)))
    step = -(-order.size // MOST_ROWS)
    thinned = {name: values[name][::step] for name in SI_UNITS if name in values}
    source = "arrays" if table.source == "`data`" else table.source
    return Series(thinned, **{"source": source, **known}, ignored=table.ignored, curve=curve)
