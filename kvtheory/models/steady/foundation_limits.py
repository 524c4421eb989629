"""The common part of asymptote reports on foundations beyond Kelvin-Voigt: lines, ranges, the choice."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from kvtheory.models.steady.methods import plain, solve_exact
from kvtheory.results import AsymptoteLine, AsymptoteReport, Certificate
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
At = Callable[[Scene, Array], Array]
"""A formula: its value for a scene at velocities |V|."""


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


def exact_friction(scene: Scene, V: Array) -> Array:
    """Return the friction coefficient at velocities |V|."""
    return np.asarray(solve_exact(scene.at(V)).friction_coefficient)


def sought(excess: At, scene: Scene, critical: Array, bracket: tuple[Array, Array]) -> Any:
    """Return what SciPy finds of the zero of `excess`, in powers of ten away from V*."""
    flat = scene.flat()

    def at(decades: Array, index: Array, critical: Array) -> Array:
        return excess(flat.rows(index) if scene.shape else flat, critical * 10.0**decades)

    index = np.arange(critical.size).reshape(critical.shape)
    return elementwise.find_root(at, bracket, args=(index, critical))


def crossing(
    excess: At, scene: Scene, critical: Array, bracket: tuple[Array, Array], otherwise: float
) -> Array:
    """Return the velocity at which `excess` vanishes, between powers of ten away from V*."""
    found = sought(excess, scene, critical, bracket)
    return np.where(found.success, critical * 10.0**found.x, otherwise)


def report(
    scene: Scene,
    tolerance: float,
    critical: Array,
    lines: Sequence[Line],
    certificate: Certificate,
    maxima: Mapping[str, Any],
) -> AsymptoteReport:
    """Evaluate the lines, and choose the first that is within the tolerance."""
    signed = np.broadcast_to(scene.drive.final_velocity, scene.shape)
    V, side = np.abs(signed), np.where(signed < 0.0, -1.0, 1.0)
    truth = exact_friction(scene, V)
    use = np.full(V.shape, "exact", dtype=object)
    told = []
    for line in reversed(lines):
        value, low = line.at(scene, V), line.regime == "low"
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
    return AsymptoteReport(
        velocity=plain(signed),
        critical_velocity=plain(critical),
        **maxima,
        regime=plain(np.where(critical >= V, "low", "high")),
        use=plain(use),
        tolerance=tolerance,
        lines=tuple(reversed(told)),
        model="asymptote",
        certificate=certificate,
    )


NOTE = (
    "The limits of friction at low and high velocity are known for a parabola on any foundation, and for a "
    "power law, a wedge and a ball on Kelvin-Voigt; of this scene only the maxima are."
)


def unknown(
    scene: Scene, tolerance: float, maxima: Mapping[str, Any], method: str
) -> AsymptoteReport:
    """Return the report of a scene whose limits are not known: its maxima, and a note."""

    def each(value: Any) -> Any:
        return plain(np.full(scene.shape, value))

    return AsymptoteReport(
        velocity=plain(np.broadcast_to(scene.drive.final_velocity, scene.shape)),
        critical_velocity=each(np.nan),
        **maxima,
        regime=each(None),
        use=each("exact"),
        tolerance=tolerance,
        lines=(),
        model=method,
        certificate=Certificate("none", "the limits of friction are not known", {}),
        notes=(NOTE,),
    )
