"""A time series from anybody's program: a CSV, a result with our names, or a mapping of arrays."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.checks.columns import PRESSURE, SHOWN, SI_UNITS, Column, recognise
from kvtheory.checks.theory import Array
from kvtheory.scene.quantities import shown
from kvtheory.scene.tables import numbers, read_table
from kvtheory.scene.units import bare

SHORTEST = 8
"""Rows: fewer cannot show a jump, a transient of two time constants and a limit."""
BRIEFEST = 1e-30
"""Seconds: no contact changes in a shorter time, of which squares and cubes would be zero."""
MOST_ROWS = 2000
"""Longer series are thinned to about this many rows: more of them would not change a verdict."""
MAY_BE_ABSENT = ("leading_edge", "trailing_edge", "peak_pressure")
"""What does not exist in flight, so that some of its cells may be empty or NaN."""
JUDGED = ("depth", "normal_force", "friction_force", "spring_force")
"""One of these there must be."""


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

    @property
    def time(self) -> Array:
        """The times in s."""
        return self.columns["time"]


def read(data: Any, units: Mapping[str, str] = SI_UNITS) -> Series:
    """Return the series that `data` holds: a path to a CSV, a result, or a mapping of arrays.

    `units` are those of the quantities of the scene, in SI.

    Raises
    ------
    ValueError
        Saying what cannot be recognised or used: a column, a unit, a cell, the order of the times.
    TypeError
        If `data` is nothing that can hold a series.

    Examples
    --------
    >>> series = read({"t [ms]": range(8), "z_A [mm]": [-0.3] * 8})
    >>> series.columns["depth"].tolist()[0], series.time.tolist()[-1]
    (0.0003, 0.007)
    """
    units = {**units, **PRESSURE}
    if isinstance(data, (str, PathLike)):
        return _from_file(Path(data), units)
    source, known = "arrays", {}
    if not (isinstance(data, Mapping) or (hasattr(data, "columns") and not isinstance(data, type))):
        known = {key: getattr(data, key, None) for key in ("per_length", "time_step", "scheme")}
        source = str(known["scheme"] or getattr(data, "model", None) or type(data).__name__)
        found = {name: getattr(data, name, None) for name in SI_UNITS}
        if found["time"] is None:
            raise TypeError(
                "`data`: expected a path to a CSV, a mapping of arrays, or a result with "
                f"time, depth, ...; got {type(data).__name__}"
            )
        data = {name: values for name, values in found.items() if values is not None}
    heads: list[str] = []
    arrays: list[Array] = []
    problems: list[str] = []
    for key in data:
        array, unit = None, None
        try:
            array, unit = bare(data[key])
            arrays.append(np.atleast_1d(np.asarray(array, dtype=float)))
        except (TypeError, ValueError) as error:
            problems.append(f'column "{shown(key)}": {error}')
        unit = unit or (units.get(key, "") if isinstance(key, str) else "")
        heads.append(f"{key} [{unit}]" if unit else str(key))
    columns = _recognised(heads, units, problems, "`data`")
    return _checked(columns, heads, arrays, source, **known)


def _from_file(path: Path, units: Mapping[str, str]) -> Series:
    """Read a CSV: ``#`` begins a comment, then a header with names and units, then numbers."""
    table = read_table(path)
    columns = _recognised(table.heads, units, [], str(path))
    if not table.rows:
        raise ValueError(f"{path}: holds a header and no rows")
    used = [column is not None for column in columns]
    values = [numbers(path, table, line, cells, used) for line, cells in table.rows]
    arrays = np.array(values, dtype=float).T
    return _checked(columns, table.heads, arrays, str(path), [line for line, _ in table.rows])


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
        if column is not None and column.quantity in seen:
            both = f'columns "{seen[column.quantity]}" and "{head}"'
            problems.append(f"{both} are both the {column.quantity}; keep one of them")
        if column is not None:
            seen[column.quantity] = head
    _raise(source, problems)
    return columns


def _raise(source: str, problems: Sequence[str]) -> None:
    """Raise with all problems, if there are any."""
    if problems:
        raise ValueError("\n".join(f"{source}: {problem}" for problem in problems))


def _checked(
    columns: Sequence[Column | None],
    heads: Sequence[str],
    arrays: Iterable[Array],
    source: str,
    lines: Sequence[int] | None = None,
    **known: Any,
) -> Series:
    """Return the series of the columns that are known, or raise with every reason why it cannot be judged."""
    pairs = [(c, array) for c, array in zip(columns, arrays, strict=True) if c is not None]
    if not pairs:
        names = shown(", ".join(heads))
        raise ValueError(f"{source}: no column is known: {names}; expected {SHOWN}")
    values = {column.quantity: column.factor * array for column, array in pairs}
    problems: list[str] = []
    if "time" not in values:
        problems.append(f"no column is the time; expected t [ms] or time [s] beside {SHOWN}")
    if not any(name in values for name in JUDGED):
        problems.append(f"nothing to judge: expected one of {', '.join(JUDGED)}")
    sizes = {array.shape for array in values.values()}
    if len(sizes) > 1 or any(len(size) != 1 for size in sizes):
        shapes = ", ".join(f"{name} {array.shape}" for name, array in values.items())
        problems.append(f"the columns differ in length: {shapes}")
    _raise(source, problems)
    problems = [p for column, _ in pairs for p in _missing(column, values[column.quantity], lines)]
    _raise(source, problems or _order(values["time"], lines))
    step = -(-values["time"].size // MOST_ROWS)
    thinned = {name: values[name][::step] for name in SI_UNITS if name in values}
    ignored = (shown(head) for head, c in zip(heads, columns, strict=True) if c is None)
    return Series(thinned, source, **known, ignored=tuple(ignored))


def _missing(column: Column, array: Array, lines: Sequence[int] | None) -> list[str]:
    """Say where values are missing that must be there."""
    bad = np.flatnonzero(~np.isfinite(array))
    if not bad.size or (column.quantity in MAY_BE_ABSENT and bad.size < array.size):
        return []
    where = f"row {bad[0] + 1}" if lines is None else f"line {lines[bad[0]]}"
    return [
        f'column "{column.header}": {bad.size} of {array.size} values are missing, NaN or infinite, the '
        f"first in {where}; a simulation that diverges ends like this"
    ]


def _order(time: Array, lines: Sequence[int] | None) -> list[str]:
    """Say why the times cannot be used."""
    if time.size < SHORTEST:
        return [f"holds {time.size} rows; at least {SHORTEST} are needed to judge a transient"]
    steps = np.diff(time)
    back = np.flatnonzero(steps < 0.0)
    if back.size:
        k = int(back[0]) + 1
        where = f"row {k + 1}" if lines is None else f"line {lines[k]}"
        return [
            f"the time must increase, but {time[k]:.9g} s in {where} follows {time[k - 1]:.9g} s"
        ]
    if np.count_nonzero(steps) < SHORTEST - 1 or time[-1] < BRIEFEST:
        return [f"the times do not span a transient: {time[0]:.9g} s to {time[-1]:.9g} s"]
    return []
