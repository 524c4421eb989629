"""The request of a sweep: scene, axes, columns and method, and how large the result is.

A column NAME is a steady quantity, or with times a series. NAME.steady is always the steady value. NAME.end,
NAME.max, NAME.min and NAME.time_of_max belong to a transient, as do the columns in `WHOLE` and `CYCLE`.
"""

import json
import math
import os
import shutil
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from kvtheory.results import SERIES_UNITS, STEADY_UNITS, TRANSIENT_UNITS, units_for
from kvtheory.results.cycles import CYCLE
from kvtheory.results.sweep import Axis
from kvtheory.results.table import LANDMARKS
from kvtheory.scene.files import to_toml
from kvtheory.scene.foundations import BEYOND, EXTRAPOLATED
from kvtheory.scene.indenters import Indenter, Parabola
from kvtheory.scene.mistakes import Problems, SceneError, nearest, problem
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import listed, quantities

Array = NDArray[np.float64]
Table = dict[str, NDArray[Any]]
"""An array over points for each column, of a series with the times as second axis."""

FAILS = (ValueError, ArithmeticError, RuntimeError)
"""Errors that mean a scene has no solution; any other is a bug."""

VECTORISED = "exact", "asymptote"
"""Methods of steady sliding that solve a block as fast as a few scenes."""
MEASURES = ("end", "max", "min", "time_of_max")
OF_ELEMENTS = ("steady", "series", "end", "max", "min", "peak_to_steady_friction", *CYCLE)
"""Measures that elements can give. Times of maxima and short losses of contact need more resolution."""
AGAINST_STEADY = ("peak_to_steady_friction", "settling_time")
"""Measures that need the steady friction force."""
STABLE = "stable"
"""Whether steady sliding is stable on the spring in the drive: 1 or 0."""
EVENTS = "events"
"""The only column of text (JSON)."""
WHOLE = {
    "peak_to_steady_friction": "1", "settling_time": "s", "hops": "1", **LANDMARKS, EVENTS: "",
}  # fmt: skip
"""Single values of a transient, and their units."""
UNSETTLED = (
    "in some scenes friction had not settled within 1 % when the run ended: settling_time is missing there, "
    "and peak_to_steady_friction is that of the run"
)
NO_CYCLE = (
    "in some scenes no cycle is known, as the run ended too soon, or elements are too coarse near the onset "
    "of instability: stick_slip_settles is 0 there, and the other values of the cycle are missing"
)
REMARKS = (
    f"in some scenes V/c is {EXTRAPOLATED}", f"in some scenes T is {BEYOND}", UNSETTLED, NO_CYCLE,
)  # fmt: skip
"""What a certificate says of some scenes, for those who do not read it."""
OF_LAYER = ".layer"
"""Ends the name of a number from which notes on a layer follow, among the errors of a block."""

EXAMPLE = '{"drive.velocity": "1 mm/s:10 m/s:200:log"}'
CELL = 21
"""Bytes of a number in a CSV, with its comma or end of line."""
SIZES = {"GB": 1e9, "MB": 1e6, "kB": 1e3}


class Column(NamedTuple):
    """A column of the result: a `measure` of the quantity `base`."""

    name: str
    unit: str
    base: str
    measure: str

    @property
    def missing(self) -> Any:
        """What stands for a missing value: NaN, or no text."""
        return math.nan if self.unit else ""

    @property
    def kind(self) -> type:
        """The type of its values: numbers, or texts."""
        return float if self.unit else object


def columns_of(
    names: Sequence[str] | str | None, *, series: bool, indenter: Indenter = Parabola(1.0)
) -> tuple[Column, ...]:
    """Return columns by name, or report every wrong one; None is all steady quantities, or all series."""
    rows = [Column(STABLE, "1", STABLE, "steady")]
    for name, unit in STEADY_UNITS.items():
        rows += [Column(each, unit, name, "steady") for each in (name, f"{name}.steady")]
    for name, unit in SERIES_UNITS.items():
        rows += [Column(name, unit, name, "series")] * series
        of = {**dict.fromkeys(MEASURES, unit), "time_of_max": "s"}
        rows += [Column(f"{name}.{each}", of[each], name, each) for each in MEASURES]
    rows += [Column(name, unit, "", name) for name, unit in (WHOLE | CYCLE).items()]
    known = {row.name: row for row in rows if row.base != "time"}
    if names is None:
        names = [name for name in (TRANSIENT_UNITS if series else STEADY_UNITS) if name != "time"]
    names = [names] if isinstance(names, str) else names
    names = sorted(dict.fromkeys(names), key=EVENTS.__eq__)  # the text last
    if not names:
        raise SceneError(["`quantities` is empty: expected names such as friction_coefficient"])
    if unknown := [name for name in names if name not in known]:
        message = " (see the help of sweep)"
        raise SceneError(
            [problem("`quantities`", name, nearest(name, known) + message) for name in unknown]
        )
    units = units_for(indenter, {name: known[name].unit for name in names})
    return tuple(known[name]._replace(unit=unit) for name, unit in units.items())


def axes_of(scene: Scene, over: Mapping[Any, Any]) -> tuple[Axis, ...]:
    """Return the axes of a sweep, or report every mistake; `kvtheory.sweep` describes `over`."""
    if not over:
        raise SceneError([f"`over` is empty: expected a key and its values, such as {EXAMPLE}"])
    specs, problems = scene.replaceable, Problems()
    swept: dict[str, Array] = {}
    axes: list[dict[str, Array]] = []
    for given, values in over.items():
        keys, lists = (given, values) if isinstance(given, tuple) else ((given,), (values,))
        if not isinstance(lists, (tuple, list, np.ndarray)) or len(keys) != len(lists):
            problems.add(f"`over` {given}", values, "expected a list for each key")
            continue
        arrays: dict[str, Array] = {}
        for key, value in zip(keys, lists, strict=True):
            with problems.catching(f"`over` {key}", value):
                if key in swept:
                    raise SceneError([f"`over` {key} is swept twice"])
                if key not in specs:
                    raise ValueError(scene.not_replaceable(str(key)))
                swept[key] = arrays[key] = listed(value, specs[key])
        if len({array.size for array in arrays.values()}) > 1:
            sizes = ", ".join(f"{key} {array.size}" for key, array in arrays.items())
            problems.append(f"`over`: values that vary together must be equally many, got {sizes}")
        axes.append(arrays)
    problems.report()
    waveform = scene.drive.waveform
    own = {f"drive.{name}" for name in (quantities(waveform) if waveform else ())} & swept.keys()
    if own and "drive.velocity" in swept.keys() - own:
        why = f"it replaces the waveform, of which {', '.join(sorted(own))} is swept"
        raise SceneError([f"`over` drive.velocity: {why}"])
    joint = sum(len(arrays) > 1 for arrays in axes)
    names = iter(["point"] if joint == 1 else [f"point_{i + 1}" for i in range(joint)])
    return tuple(Axis(next(names if len(each) > 1 else iter(each)), each) for each in axes)


def spread(scene: Scene, over: Mapping[Any, Any] | None) -> tuple[Scene, dict[Any, Any]]:
    """Return one of the scenes that arrays stand for, and `over` with these arrays as its first axis.

    They vary together, as they broadcast; an array of a key that `over` sweeps is replaced by it.
    """
    over = dict(over or {})
    swept = {key for keys in over for key in (keys if isinstance(keys, tuple) else (keys,))}
    arrays = {
        key: np.broadcast_to(array, scene.shape).reshape(-1)
        for key, array in scene.arrays().items()
    }
    if not arrays:
        return scene, over
    problems = Problems()
    for key, array in scene.arrays().items():
        if not array.size:
            problems.add(key, [], "is empty; expected at least one value")
    problems.report()
    one = scene.replace({key: array[0] for key, array in arrays.items()})
    own = {key: array for key, array in arrays.items() if key not in swept}
    return one, ({tuple(own): tuple(own.values())} if own else {}) | over


@dataclass(frozen=True)
class Plan:
    """A scene, what varies, the columns, and how it is solved."""

    scene: Scene
    axes: tuple[Axis, ...]
    columns: tuple[Column, ...]
    times: tuple[float, ...] | None
    method: str
    rtol: float
    layer_numbers: Callable[..., Mapping[str, float]] | None = None
    """The largest numbers of scenes, by name, from which notes on their layer follow."""

    @cached_property
    def points(self) -> int:
        """The number of scenes."""
        return math.prod(axis.size for axis in self.axes)

    @property
    def numeric(self) -> list[Column]:
        """The columns of numbers: all except `events`."""
        return [column for column in self.columns if column.name != EVENTS]

    @property
    def texts(self) -> bool:
        """Whether the column of text is requested."""
        return len(self.numeric) < len(self.columns)

    @property
    def series(self) -> bool:
        """Whether any column is a series, with one value for each time."""
        return any(column.measure == "series" for column in self.columns)

    @property
    def transient(self) -> bool:
        """Whether any column belongs to a transient."""
        return any(column.measure != "steady" for column in self.columns)

    @property
    def of_elements(self) -> bool:
        """Whether elements can give every column."""
        return all(column.measure in OF_ELEMENTS for column in self.columns)

    @property
    def vectorised(self) -> bool:
        """Whether a block is one call on arrays."""
        return not self.transient and self.method in VECTORISED

    def needed(self, *, steady: bool) -> list[str]:
        """Return the quantities that are needed of steady sliding, or of transients."""
        bases = {c.base for c in self.columns if c.base and (c.measure == "steady") == steady}
        bases |= {c.name for c in self.columns if c.measure in CYCLE and not steady}
        against = any(c.measure in AGAINST_STEADY for c in self.columns)
        return sorted(bases | ({"friction_force"} if against else set()))

    def values_at(self, start: int, stop: int) -> dict[str, Array]:
        """Return the swept values of the points from `start` to `stop`, in C order."""
        places = np.unravel_index(np.arange(start, stop), [axis.size for axis in self.axes])
        return {
            key: array[place]
            for axis, place in zip(self.axes, places, strict=True)
            for key, array in axis.values.items()
        }

    def blank(self, points: int) -> Table:
        """Return a table of missing values."""
        return {c.name: np.full(self.shape(c, points), c.missing, c.kind) for c in self.columns}

    def shape(self, column: Column, points: int) -> tuple[int, ...]:
        """Return the shape of a column of a table."""
        return (points, len(self.times or ())) if column.measure == "series" else (points,)

    @property
    def units(self) -> Mapping[str, str]:
        """The unit of each swept key and of each column; that of text is empty."""
        specs = self.scene.replaceable
        swept = {key: specs[key].unit for axis in self.axes for key in axis.values}
        return swept | {column.name: column.unit for column in self.columns}

    @cached_property
    def record(self) -> dict[str, Any]:
        """The identity of the sweep, ready for JSON: equal records mean equal numbers."""

        def outline(array: Array) -> dict[str, Any]:
            ends = {"first": float(array[0]), "last": float(array[-1])}
            return {"count": int(array.size), **ends, "crc": crc32(array.astype("<f8").tobytes())}

        swept = [{key: outline(each) for key, each in axis.values.items()} for axis in self.axes]
        return {
            "kvtheory": version("kvtheory"),
            "scene": to_toml(self.scene),
            "over": swept,
            "quantities": [column.name for column in self.columns],
            "at": None if self.times is None else list(self.times),
            "method": self.method,
            "rtol": self.rtol if self.transient else None,
        }

    def differences(self, found: str | bytes) -> list[str]:
        """Return the parts in which the record of a file, as JSON, differs from that of this sweep."""
        try:
            theirs = json.loads(found)
            return [key for key, ours in self.record.items() if theirs[key] != ours]
        except (ValueError, TypeError, KeyError):
            return list(self.record)


@dataclass
class Measured:
    """Values by name over the scenes of a block, their errors, the reasons of failures, and statements."""

    values: Table = field(default_factory=dict)
    errors: dict[str, Any] = field(default_factory=dict)
    reasons: dict[int, Exception] = field(default_factory=dict)
    statements: set[str] = field(default_factory=set)

    def replace(self, indices: Iterable[int], other: "Measured") -> None:
        """Take some scenes from another model."""
        for index in indices:
            del self.reasons[index]
            for own, theirs in ((self.values, other.values), (self.errors, other.errors)):
                for name, array in theirs.items():
                    own[name][index] = array[index]
        self.reasons |= other.reasons
        self.statements |= other.statements


def is_csv(path: Path) -> bool:
    """Whether a file of this name is a CSV, and not NetCDF."""
    return path.suffix.lower() == ".csv"


def refuse_what_cannot_fit(plan: Plan, path: Path | None) -> None:
    """Raise `ValueError` if a sweep needs more than memory or disk hold."""
    needed, limits = 2.0 * plan.points * sum(each.nbytes for each in plan.blank(1).values()), {}
    if path is not None and is_csv(path):
        rows = plan.points * (len(plan.times or ()) if plan.series else 1)
        needed = 0.5 * needed + rows * (len(plan.units) + plan.series) * CELL
    else:
        with suppress(AttributeError, OSError, ValueError):  # unknown on some systems
            memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
            limits["of memory; choose fewer points, or write to a CSV file (`output`)"] = memory
    if path is not None and path.parent.is_dir():
        limits[f'free beside "{path}"; choose fewer points'] = shutil.disk_usage(path.parent).free
    for where, limit in limits.items():
        if needed > limit:
            message = f"{plan.points:,} points need about {_size(needed)}"
            raise ValueError(f"{message}; there are {_size(limit)} {where}")


def _size(count: float) -> str:
    """Return a number of bytes in words.

    >>> _size(2.5e9), _size(40960.0), _size(0.0)
    ('2.5 GB', '41 kB', '0 kB')
    """
    unit, scale = next(((u, s) for u, s in SIZES.items() if count >= s), ("kB", 1e3))
    return f"{count / scale:,.1f} {unit}" if unit == "GB" else f"{count / scale:.0f} {unit}"
