"""A time series from anybody's program: a CSV, a result with our names, or a mapping of arrays."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.columns import PRESSURE, SHOWN, SI_UNITS, Column, recognise
from kvtheory.scene.quantities import shown
from kvtheory.scene.tables import numbers, read_table
from kvtheory.scene.units import bare

Array = NDArray[np.float64]

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
    if isinstance(data, Mapping) or (hasattr(data, "columns") and not isinstance(data, type)):
        return _from_mapping(data, units)  # a table of pandas, too
    names = [name for name in SI_UNITS if getattr(data, name, None) is not None]
    if "time" not in names:
        raise TypeError(
            "`data`: expected a path to a CSV, a mapping of arrays, or a result with "
            f"time, depth, ...; got {type(data).__name__}"
        )
    known = {
        key: getattr(data, key, None) for key in ("per_length", "time_step", "scheme", "model")
    }
    source = str(known["scheme"] or known["model"] or type(data).__name__)
    return _checked(
        {name: getattr(data, name) for name in names}, {}, source,
        per_length=known["per_length"], time_step=known["time_step"], scheme=known["scheme"],
    )  # fmt: skip


def _from_mapping(data: Mapping[str, Any], units: Mapping[str, str]) -> Series:
    """Read arrays by our names, in SI, or by names with units."""
    heads: list[str] = []
    arrays: list[Array] = []
    problems: list[str] = []
    for key in data:
        array, unit = _numbers(str(key), data[key], problems)
        unit = unit or (units.get(key, "") if isinstance(key, str) else "")
        heads.append(f"{key} [{unit}]" if unit else str(key))
        arrays.append(array)
    columns, found = _recognised(heads, units)
    problems += [f"`data`: {problem}" for problem in found]
    if problems:
        raise ValueError("\n".join(problems))
    return _named(columns, heads, arrays, "arrays")


def _numbers(name: str, values: Any, problems: list[str]) -> tuple[Array, str | None]:
    """Return a column as an array, and its unit if it carries one; append what is wrong to `problems`."""
    try:
        numbers, unit = bare(values)
        return np.asarray(numbers, dtype=float), unit
    except (TypeError, ValueError) as error:
        problems.append(f'`data`: column "{shown(name)}": {error}')
        return np.empty(0), None


def _recognised(
    heads: Sequence[str], units: Mapping[str, str]
) -> tuple[list[Column | None], list[str]]:
    """Return what the columns hold, None for those of no known name, and what is wrong with them."""
    columns: list[Column | None] = []
    problems: list[str] = []
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
    return columns, problems


def _named(
    columns: Sequence[Column | None],
    heads: Sequence[str],
    arrays: Iterable[Array],
    source: str,
    lines: Sequence[int] | None = None,
) -> Series:
    """Return the series of the columns that are known, and name the others."""
    pairs = [(c, array) for c, array in zip(columns, arrays, strict=True) if c is not None]
    ignored = tuple(
        shown(head) for head, column in zip(heads, columns, strict=True) if column is None
    )
    if not pairs:
        raise ValueError(
            f"{source}: no column is known: {shown(', '.join(heads))}; expected {SHOWN}"
        )
    values = {column.quantity: column.factor * array for column, array in pairs}
    headers = {column.quantity: column.header for column, _ in pairs}
    return _checked(values, headers, source, lines=lines, ignored=ignored)


def _from_file(path: Path, units: Mapping[str, str]) -> Series:
    """Read a CSV: ``#`` begins a comment, then a header with names and units, then numbers."""
    table = read_table(path)
    columns, problems = _recognised(table.heads, units)
    if problems:
        raise ValueError("\n".join(f"{path}: {problem}" for problem in problems))
    if not table.rows:
        raise ValueError(f"{path}: holds a header and no rows")
    used = [column is not None for column in columns]
    values = [numbers(path, table, line, cells, used) for line, cells in table.rows]
    arrays = np.array(values, dtype=float).T
    return _named(columns, table.heads, arrays, str(path), [line for line, _ in table.rows])


def _checked(
    columns: Mapping[str, Any],
    headers: Mapping[str, str],
    source: str,
    *,
    lines: Sequence[int] | None = None,
    **known: Any,
) -> Series:
    """Return the series, or raise with every reason why it cannot be judged."""
    problems: list[str] = []
    arrays = {name: np.atleast_1d(_numbers(name, v, problems)[0]) for name, v in columns.items()}
    if problems:
        raise ValueError("\n".join(problems))
    if "time" not in arrays:
        problems.append(f"no column is the time; expected t [ms] or time [s] beside {SHOWN}")
    if not any(name in arrays for name in JUDGED):
        problems.append(f"nothing to judge: expected one of {', '.join(JUDGED)}")
    sizes = {array.shape for array in arrays.values()}
    if len(sizes) > 1 or any(len(size) != 1 for size in sizes):
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        problems.append(f"the columns differ in length: {shapes}")
    if problems:
        raise ValueError("\n".join(f"{source}: {problem}" for problem in problems))
    for name, array in arrays.items():
        problems += _gaps(name, headers.get(name, name), array, lines)
    if not problems:
        problems += _order(arrays["time"], lines)
    if problems:
        raise ValueError("\n".join(f"{source}: {problem}" for problem in problems))
    step = -(-arrays["time"].size // MOST_ROWS)
    named = {name: arrays[name][::step] for name in SI_UNITS if name in arrays}
    return Series(named, source, **known)


def _gaps(name: str, header: str, array: Array, lines: Sequence[int] | None) -> Iterable[str]:
    """Say where values are missing that must be there."""
    bad = np.flatnonzero(~np.isfinite(array))
    if not bad.size or (name in MAY_BE_ABSENT and bad.size < array.size):
        return []
    where = f"row {bad[0] + 1}" if lines is None else f"line {lines[bad[0]]}"
    return [
        f'column "{header}": {bad.size} of {array.size} values are missing, NaN or infinite, the first '
        f"in {where}; a simulation that diverges ends like this"
    ]


def _order(time: Array, lines: Sequence[int] | None) -> Iterable[str]:
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
