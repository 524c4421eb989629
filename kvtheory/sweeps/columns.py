"""What is asked of each scene: the quantities by name, with their units and where they come from.

NAME is a steady quantity, or with times a series; NAME.steady is always the steady one; NAME.end,
NAME.max, NAME.min and NAME.time_of_max are of the transient; then there are those of `WHOLE`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from kvtheory.results import SPRING_UNITS, STEADY_UNITS, TRANSIENT_UNITS, units_for
from kvtheory.scene.indenters import Indenter
from kvtheory.scene.quantities import SceneError, nearest, problem

SERIES = {name: unit for name, unit in TRANSIENT_UNITS.items() if name != "time"}
"""What a transient is asked for, by its measures or on a grid of times."""
MEASURES = ("end", "max", "min", "time_of_max")
OF_ELEMENTS = ("steady", "series", "end", "max", "min", "peak_to_steady_friction")
"""What is asked of transients that elements follow. When a value is largest, or whether the contact is lost
for a moment, they know no better than what passes between two instants."""

STABLE = "stable"
"""Whether steady sliding lasts: 1, or 0 where it is unstable on the spring in the drive."""
WHOLE = {"peak_to_steady_friction": "1", "settling_time": "s", "hops": "1", "events": ""}
"""Single values of a whole transient, and their units; `events` is text."""
CYCLE = {
    "stick_slip_settles": "1",
    "stick_slip_amplitude": "m",
    "stick_slip_period": "s",
    "sliding_velocity.cycle_max": "m/s",
    "sliding_velocity.cycle_min": "m/s",
    "friction_force.cycle_max": "N/m",
    "friction_force.cycle_min": "N/m",
}
"""Single values of the cycle in which an indenter on a spring ends, in the order of `cycles.Cycle`."""


@dataclass(frozen=True)
class Column:
    """A quantity asked for: `measure` says what is taken of the quantity `base`."""

    name: str
    unit: str
    base: str
    measure: str

    @property
    def steady(self) -> bool:
        """Whether steady sliding alone answers it."""
        return self.measure == "steady"

    @property
    def sprung(self) -> bool:
        """Whether only a drive with a spring has it."""
        return self.measure in CYCLE or self.base in SPRING_UNITS

    @property
    def text(self) -> bool:
        """Whether it is text."""
        return not self.unit


def columns_of(
    names: Sequence[str] | str | None, *, series: bool, indenter: Indenter | None = None
) -> tuple[Column, ...]:
    """Return the columns by name; None is every steady quantity, or every series.

    Their units are those of line contacts, unless the `indenter` is a ball.

    Raises
    ------
    SceneError
        Listing every name that does not exist, with the nearest that does.

    Examples
    --------
    >>> [column.unit for column in columns_of(["load", "depth.time_of_max", "hops"], series=False)]
    ['N/m', 's', '1']
    """
    known = _known(series)
    if indenter is not None:
        units = units_for(indenter, {name: column.unit for name, column in known.items()})
        known = {name: replace(column, unit=units[name]) for name, column in known.items()}
    if names is None:
        names = list(SERIES if series else STEADY_UNITS)
    names = list(dict.fromkeys([names] if isinstance(names, str) else names))
    problems = [
        problem("`quantities`", name, nearest(str(name), known))
        for name in names
        if name not in known
    ]
    if not names:
        problems = ["`quantities` is empty: expected names such as friction_coefficient"]
    if problems:
        raise SceneError(problems)
    return tuple(known[name] for name in names)


def _known(series: bool) -> dict[str, Column]:
    found = {name: Column(name, unit, name, "steady") for name, unit in STEADY_UNITS.items()}
    found[STABLE] = Column(STABLE, "1", STABLE, "steady")
    over_time = SERIES | SPRING_UNITS
    if series:
        found |= {name: Column(name, unit, name, "series") for name, unit in over_time.items()}
    found |= {
        f"{name}.steady": Column(f"{name}.steady", unit, name, "steady")
        for name, unit in STEADY_UNITS.items()
    }
    found |= {
        f"{name}.{measure}": Column(
            f"{name}.{measure}", "s" if measure == "time_of_max" else unit, name, measure
        )
        for name, unit in over_time.items()
        for measure in MEASURES
    }
    return found | {name: Column(name, unit, "", name) for name, unit in (WHOLE | CYCLE).items()}
