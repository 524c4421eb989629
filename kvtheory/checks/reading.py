"""A time series from anybody's program: a CSV, a result with our names, or a mapping of arrays."""

import csv
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.columns import SHOWN, SI_UNITS, recognise

Array = NDArray[np.float64]

SHORTEST = 8
"""Rows: fewer cannot show a jump, a transient of two time constants and a limit."""
MOST_ROWS = 2000
"""Longer series are thinned to about this many rows: more of them would not change a verdict."""
MAY_BE_ABSENT = ("leading_edge", "trailing_edge", "peak_pressure")
"""What does not exist in flight, so that some of its cells may be empty or NaN."""
JUDGED = ("depth", "normal_force", "friction_force")
"""One of these there must be."""
SEPARATORS = "\t;,"


@dataclass(frozen=True)
class Series:
    """A time series in SI; what is known of the simulation behind it is set, the rest is None."""

    columns: Mapping[str, Array]
    source: str
    per_length: float | None = None
    time_step: float | None = None
    scheme: str | None = None

    @property
    def time(self) -> Array:
        """The times in s."""
        return self.columns["time"]


def read(data: Any) -> Series:
    """Return the series that `data` holds: a path to a CSV, a result, or a mapping of arrays.

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
    if isinstance(data, (str, PathLike)):
        return _from_file(Path(data))
    if isinstance(data, Mapping):
        return _from_mapping(data)
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


def _from_mapping(data: Mapping[str, Any]) -> Series:
    """Read arrays by our names, in SI, or by names with bracketed units."""
    columns: dict[str, Array] = {}
    headers: dict[str, str] = {}
    problems: list[str] = []
    for key, values in data.items():
        try:
            column = recognise(f"{key} [{SI_UNITS[key]}]" if key in SI_UNITS else str(key))
            array = np.asarray(values, dtype=float)
        except (TypeError, ValueError) as error:
            problems.append(f"`data`: {error}")
            continue
        problems += _twice(column.quantity, column.header, headers)
        columns[column.quantity], headers[column.quantity] = column.factor * array, str(key)
    if problems:
        raise ValueError("\n".join(problems))
    return _checked(columns, headers, "arrays")


def _from_file(path: Path) -> Series:
    """Read a CSV: ``#`` begins a comment, then a header with names and units, then numbers."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path}: not a text file in UTF-8; expected a CSV") from None
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip(" \t\r;,") and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise ValueError(
            f"{path}: holds no header and no rows; expected a line such as t [ms],z_A [mm]"
        )
    bare = re.sub(r"[\[(].*?[\])]", "", lines[0][1])
    separator = max(SEPARATORS, key=bare.count)
    rows = list(csv.reader((line for _, line in lines), delimiter=separator))
    if len(rows) != len(lines):
        raise ValueError(f"{path}: a quotation mark is opened and not closed on the same line")
    table = [
        (number, [cell.strip() for cell in row])
        for (number, _), row in zip(lines, rows, strict=True)
    ]
    return _from_table(path, table)


def _from_table(path: Path, table: Sequence[tuple[int, list[str]]]) -> Series:
    number, heads = table[0]
    if all(_number(cell) is not None for cell in heads if cell):
        raise ValueError(
            f"{path}: line {number} holds numbers where the names and units of the columns are expected, "
            "such as t [ms],z_A [mm],F_z [N/mm],F_x [N/mm]"
        )
    while heads and not heads[-1]:
        heads = heads[:-1]
    columns, problems = [], []
    headers: dict[str, str] = {}
    for head in heads:
        try:
            columns.append(recognise(head))
        except ValueError as error:
            problems.append(f"{path}: {error}")
            continue
        twice = _twice(columns[-1].quantity, head, headers)
        problems += [f"{path}: {problem}" for problem in twice]
        headers[columns[-1].quantity] = head
    if problems:
        raise ValueError("\n".join(problems))
    if len(table) == 1:
        raise ValueError(f"{path}: holds a header and no rows")
    values = [_row(path, line, cells, heads) for line, cells in table[1:]]
    arrays = np.array(values, dtype=float).T
    found = {c.quantity: c.factor * array for c, array in zip(columns, arrays, strict=True)}
    lines = [line for line, _ in table[1:]]
    return _checked(found, headers, str(path), lines=lines)


def _row(path: Path, line: int, cells: list[str], heads: Sequence[str]) -> list[float]:
    """Return the numbers of one line; an empty cell is NaN."""
    while len(cells) > len(heads) and not cells[-1]:
        cells = cells[:-1]
    if len(cells) != len(heads):
        raise ValueError(f"{path}: line {line} has {len(cells)} cells, the header has {len(heads)}")
    numbers = []
    for cell, head in zip(cells, heads, strict=True):
        number = np.nan if not cell else _number(cell)
        if number is None:
            hint = "; write the decimal mark as a point" if "," in cell else ""
            raise ValueError(
                f'{path}: line {line}, column "{head}": "{cell}" is not a number{hint}'
            )
        numbers.append(number)
    return numbers


def _number(cell: str) -> float | None:
    try:
        return float(cell) if "_" not in cell else None
    except ValueError:
        return None


def _twice(quantity: str, header: str, seen: Mapping[str, str]) -> list[str]:
    if quantity not in seen:
        return []
    return [f'columns "{seen[quantity]}" and "{header}" are both the {quantity}; keep one of them']


def _checked(
    columns: Mapping[str, Any],
    headers: Mapping[str, str],
    source: str,
    *,
    lines: Sequence[int] | None = None,
    **known: Any,
) -> Series:
    """Return the series, or raise with every reason why it cannot be judged."""
    arrays = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in columns.items()}
    problems = []
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
    if np.count_nonzero(steps) < SHORTEST - 1 or time[-1] <= 0.0:
        return [f"the times do not span a transient: {time[0]:.9g} s to {time[-1]:.9g} s"]
    return []
