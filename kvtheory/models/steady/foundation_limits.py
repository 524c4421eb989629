"""The common part of asymptote reports on foundations beyond Kelvin-Voigt: lines, ranges, the choice."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from kvtheory.models.steady.methods import plain, solve_exact
from kvtheory.results import AsymptoteLine, AsymptoteReport, Certificate
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
Values = Mapping[str, Array]
At = Callable[[Values, Array], Array]
"""A formula: its value at velocities |V|, from the other values of a scene."""


class Line(NamedTuple):
    """A formula of the friction coefficient, and where it is within the tolerance of the exact state."""

    name: str
    regime: str
    equation: int | None
    formula: str
    at: At
    edge: Array
    """Velocity at which its error passes the tolerance."""
    proved: Array
    """Velocity up to which, or from which on, a theorem guarantees that it does not."""


def exact_friction(scene: Scene, values: Values, V: Array) -> Array:
    """Return the friction coefficient at velocities |V|."""
    state = solve_exact(scene, {**values, "drive.velocity": V})
    return np.asarray(state.friction_coefficient)


def crossing(
    excess: At, values: Values, critical: Array, bracket: tuple[Array, Array], otherwise: float
) -> Array:
    """Return the velocity at which `excess` vanishes, between powers of ten away from V*."""
    keys = list(values)

    def at(decades: Array, *arrays: Array) -> Array:
        point = dict(zip(keys, arrays[:-1], strict=True))
        return excess(point, arrays[-1] * 10.0**decades)

    found = elementwise.find_root(at, bracket, args=(*values.values(), critical))
    return np.where(found.success, critical * 10.0**found.x, otherwise)


def report(
    scene: Scene,
    values: Values,
    tolerance: float,
    critical: Array,
    lines: Sequence[Line],
    certificate: Certificate,
) -> AsymptoteReport:
    """Evaluate the lines, and choose the first that is within the tolerance."""
    signed = values["drive.velocity"]
    V, side = np.abs(signed), np.where(signed < 0.0, -1.0, 1.0)
    truth = exact_friction(scene, values, V)
    use = np.full(V.shape, "exact", dtype=object)
    told = []
    for line in reversed(lines):
        value, low = line.at(values, V), line.regime == "low"
        with np.errstate(divide="ignore", invalid="ignore"):
            error = np.where(truth > 0.0, value / truth - 1.0, np.nan)
        use = np.where(np.abs(error) <= tolerance, line.name, use)
        told.append(
            AsymptoteLine(
                line.name, "friction_coefficient", line.regime, line.equation, line.formula,
                value=plain(np.where(np.isfinite(value), side * value, np.nan)),
                exact=plain(side * truth),
                relative_error=plain(error),
                velocity_min=plain(np.zeros_like(V) if low else line.edge),
                velocity_max=plain(line.edge if low else np.full_like(V, np.inf)),
                velocity_proved=plain(line.proved),
            )
        )  # fmt: skip
    nothing = plain(np.full_like(critical, np.nan))
    return AsymptoteReport(
        velocity=plain(signed),
        critical_velocity=plain(critical),
        peak_velocity=nothing,
        peak_friction_coefficient=nothing,
        regime=plain(np.where(critical >= V, "low", "high")),
        use=plain(use),
        tolerance=tolerance,
        lines=tuple(reversed(told)),
        model="asymptote",
        certificate=certificate,
    )
