"""What is asked of a sweep: its columns, and with scene, axes and method the plan that decides every number.

A column NAME is a steady quantity, or with times a series; NAME.steady is always the steady one; NAME.end,
NAME.max, NAME.min and NAME.time_of_max belong to a transient; so do those of `WHOLE` and `CYCLE`.
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.results import SERIES_UNITS, STEADY_UNITS, TRANSIENT_UNITS, units_for
from kvtheory.results.sweep import Axis
from kvtheory.scene.capabilities import lacks_paper_model
from kvtheory.scene.files import to_toml
from kvtheory.scene.indenters import Indenter, Parabola
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import SceneError, nearest, problem

Table = NDArray[np.void]

FAILS = (ValueError, ArithmeticError, RuntimeError)
"""What a scene without an answer raises; anything else is a defect of the program."""

MEASURES = ("end", "max", "min", "time_of_max")
OF_ELEMENTS = ("steady", "series", "end", "max", "min", "peak_to_steady_friction")
"""What elements can measure. The time of a maximum and short losses of contact need more resolution."""
STABLE = "stable"
"""Whether steady sliding is stable on the spring in the drive: 1 or 0."""
WHOLE = {"peak_to_steady_friction": "1", "settling_time": "s", "hops": "1", "events": ""}
"""Single values of a whole transient, and their units; `events` is text."""
EVENTS = "events"
CYCLE = {
    "stick_slip_settles": "1",
    "stick_slip_amplitude": "m",
    "stick_slip_period": "s",
    "sliding_velocity.cycle_max": "m/s",
    "sliding_velocity.cycle_min": "m/s",
    "friction_force.cycle_max": "N/m",
    "friction_force.cycle_min": "N/m",
}
"""Single values of the limit cycle of an indenter on a spring, in the order of `cycles.Cycle`."""


class Column(NamedTuple):
    """A quantity of the result: `measure` says what is taken of the quantity `base`."""

    name: str
    unit: str
    base: str
    measure: str


def columns_of(
    names: Sequence[str] | str | None, *, series: bool, indenter: Indenter = Parabola(1.0)
) -> tuple[Column, ...]:
    """Return the columns by name; None stands for all steady quantities, or all series.

    Raises
    ------
    SceneError
        Listing every name that does not exist, with the nearest that does.
    """
    over_time = {name: unit for name, unit in SERIES_UNITS.items() if name != "time"}
    rows = [(name, unit, name, "steady") for name, unit in {**STEADY_UNITS, STABLE: "1"}.items()]
    rows += [(name, unit, name, "series") for name, unit in over_time.items()] * series
    rows += [(f"{name}.steady", unit, name, "steady") for name, unit in STEADY_UNITS.items()]
    rows += [
        (f"{name}.{measure}", "s" if measure == "time_of_max" else unit, name, measure)
        for name, unit in over_time.items()
        for measure in MEASURES
    ]
    rows += [(name, unit, "", name) for name, unit in (WHOLE | CYCLE).items()]
    units = units_for(indenter, {name: unit for name, unit, *_ in rows})
    known = {name: Column(name, units[name], *how) for name, _, *how in rows}
    if names is None:
        names = [name for name in (TRANSIENT_UNITS if series else STEADY_UNITS) if name != "time"]
    names = list(dict.fromkeys([names] if isinstance(names, str) else names))
    if not names:
        raise SceneError(["`quantities` is empty: expected names such as friction_coefficient"])
    if unknown := [name for name in names if name not in known]:
        told = [problem("`quantities`", name, nearest(str(name), known)) for name in unknown]
        raise SceneError(told)
    return tuple(known[name] for name in names)


@dataclass(frozen=True)
class Plan:
    """A scene, what varies, what is asked, and how it is solved."""

    scene: Scene
    axes: tuple[Axis, ...]
    columns: tuple[Column, ...]
    times: tuple[float, ...] | None
    method: str
    rtol: float

    @cached_property
    def grid(self) -> tuple[int, ...]:
        """The lengths of the axes."""
        return tuple(axis.size for axis in self.axes)

    @property
    def points(self) -> int:
        """The number of scenes."""
        return math.prod(self.grid)

    @property
    def numeric(self) -> list[Column]:
        """The columns of numbers: all except `events`."""
        return [column for column in self.columns if column.name != EVENTS]

    @property
    def texts(self) -> bool:
        """Whether the column of texts, `events`, is asked for."""
        return any(column.name == EVENTS for column in self.columns)

    @property
    def series(self) -> bool:
        """Whether any column is a series, with one value for each time."""
        return any(column.measure == "series" for column in self.columns)

    def blank(self, points: int) -> Table:
        """Return a table of missing values, NaN or no text: a row for each point, a field for each column."""
        times = (len(self.times or ()),)
        table = np.empty(
            points,
            [
                (c.name, "<f8" if c.unit else object, times if c.measure == "series" else ())
                for c in self.columns
            ],
        )
        for column in self.columns:
            table[column.name] = np.nan if column.unit else ""
        return table

    @property
    def transient(self) -> bool:
        """Whether any column belongs to a transient."""
        return any(column.measure != "steady" for column in self.columns)

    @property
    def compared(self) -> set[str]:
        """The steady quantities with which a transient is compared."""
        against = ("peak_to_steady_friction", "settling_time")
        return {"friction_force"} if any(c.measure in against for c in self.columns) else set()

    @property
    def steady(self) -> list[str]:
        """The quantities of steady sliding that are needed."""
        return sorted({c.base for c in self.columns if c.measure == "steady"} | self.compared)

    @property
    def followed(self) -> list[str]:
        """The quantities of transients that are needed."""
        asked = {c.base for c in self.columns if c.base and c.measure != "steady"}
        return sorted(asked | self.compared)

    @property
    def by_elements(self) -> bool:
        """Whether transients are simulated by elements, as the solver does not hold for the scene."""
        return bool(lacks_paper_model(self.scene))

    @property
    def vectorised(self) -> bool:
        """Whether a block is one call on arrays."""
        return not self.transient and self.method != "quadrature"

    @property
    def units(self) -> Mapping[str, str]:
        """The unit of each swept key and of each quantity; that of a text is empty."""
        specs = self.scene.replaceable
        swept = {key: specs[key].unit for axis in self.axes for key in axis.values}
        return swept | {column.name: column.unit for column in self.columns}

    @cached_property
    def version(self) -> str:
        """Of the package that computes the numbers."""
        return version("kvtheory")

    @cached_property
    def record(self) -> dict[str, Any]:
        """The identity of the sweep, ready for JSON: equal records mean equal numbers."""
        return {
            "kvtheory": self.version,
            "scene": to_toml(self.scene),
            "over": [
                {key: _digest(array) for key, array in axis.values.items()} for axis in self.axes
            ],
            "quantities": [column.name for column in self.columns],
            "at": None if self.times is None else list(self.times),
            "method": self.method,
            "rtol": self.rtol if self.transient else None,
        }

    def differences(self, found: str) -> list[str]:
        """Return the parts in which the record of a file, as JSON, differs from that of this sweep."""
        try:
            theirs = json.loads(found)
            return [key for key, ours in self.record.items() if theirs[key] != ours]
        except (ValueError, TypeError, KeyError):
            return list(self.record)


@dataclass
class Measured:
    """Values and errors by name, over the scenes of a block; why scenes have none; and statements."""

    values: dict[str, Any] = field(default_factory=dict)
    errors: dict[str, NDArray[np.float64]] = field(default_factory=dict)
    reasons: dict[int, Exception] = field(default_factory=dict)
    statements: set[str] = field(default_factory=set)


def _digest(array: NDArray[np.float64]) -> dict[str, Any]:
    return {
        "count": int(array.size),
        "first": float(array[0]),
        "last": float(array[-1]),
        "sha256": hashlib.sha256(array.astype("<f8").tobytes()).hexdigest(),
    }
