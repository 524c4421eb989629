"""Which asymptote holds for a scene, its error, and over which velocities it holds."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady.foundation_limits import sought
from kvtheory.models.steady.methods import ROUNDING, asymptotes_of, plain, solve_exact
from kvtheory.results import (
    STEADY_UNITS,
    AsymptoteLine,
    AsymptoteReport,
    Certificate,
    units_for,
)
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]

DECADES = 30.0
"""How far from V*, in powers of ten, the end of a range is sought."""

STATEMENT = (
    "the relative errors e are closed forms (derivations {}), monotonic in V, "
    "evaluated to 2e-14 (1 + |e|)"
)


LISTED = {
    "fixed": ("friction_coefficient", "load", "friction_force"),
    "dead-weight": ("friction_coefficient", "depth"),
    "suspended": ("friction_coefficient", "depth", "load"),
}
"""The quantities listed for each support, each at low and then at high velocity."""
EQUATIONS = {
    "fixed": (42, 45, 40, 43, 41, 44),
    "dead-weight": (42, 46, None, 49),
    "suspended": (42, None, None, None, None, None),
}
"""Their equation numbers in the paper."""
OF_PARABOLA = {
    "fixed": (
        "C V/(R K)",
        "alpha sqrt(delta/R)",
        "2 alpha R^(1/2) K delta^(3/2)",
        "C V delta",
        "2 alpha R^(-1/2) C V delta^(3/2)",
        "alpha R^(-1/2) C V delta^(3/2)",
    ),
    "dead-weight": (
        "C V/(R K)",
        "alpha sqrt(W/(R C V))",
        "delta_0 = (3 W/(4 K sqrt(2 R)))^(2/3)",
        "W/(C V)",
    ),
    "suspended": (
        "C V/(R K)",
        "alpha sqrt((M g + k_s delta_0)/(R C V))",
        "delta_0 = (3 M g/(4 K sqrt(2 R)))^(2/3)",
        "(M g + k_s delta_0)/(C V)",
        "M g",
        "M g + k_s delta_0",
    ),
}
OF_POWER_LAW = {
    "fixed": (
        "n (n+1)/(2n-1) delta C V/(K a^2)",
        "n^2/(2n-1) delta/a",
        "2n/(n+1) K delta a",
        "C V delta",
        "2n^2/(2n-1) C V delta^2/a",
        "n^2/(2n-1) C V delta^2/a",
    ),
    "dead-weight": (
        "n (n+1)/(2n-1) delta_0 C V/(K a_0^2)",
        "n^2/(2n-1) delta/a, delta = W/(C V)",
        "delta_0 = (n+1)/(2n) W/(K a_0)",
        "W/(C V)",
    ),
    "suspended": (
        "n (n+1)/(2n-1) delta_0 C V/(K a_0^2)",
        "n^2/(2n-1) delta/a, delta as below",
        "delta_0 = (n+1)/(2n) M g/(K a_0)",
        *OF_PARABOLA["suspended"][3:],
    ),
}
"""Their formulas; n = 1 for a wedge, W = M g is the load of a dead weight."""
OF_BALL = {
    "fixed": (
        "C V/(R K)",
        "(3 pi/16) a/R",
        "pi K R delta^2",
        "(4/3) C V delta a",
        "pi C V delta^2",
        "(pi/4) C V delta a^2/R",
    ),
    "dead-weight": (
        "C V/(R K)",
        "(3 pi/16) a/R, a^3 = 3 R W/(2 C V)",
        "delta_0 = (W/(pi K R))^(1/2)",
        "a^2/(2 R), a as above",
    ),
    "suspended": (
        "C V/(R K)",
        "(3 pi/16) a/R, a^3 = 3 R (M g + k_s delta_0)/(2 C V)",
        "delta_0 = (M g/(pi K R))^(1/2)",
        "a^2/(2 R), a as above",
        "M g",
        "M g + k_s delta_0",
    ),
}
"""With a radius R' across, K and C are multiplied by sqrt(R'/R) in formulas that contain W or give W or F."""


class Row(NamedTuple):
    """One asymptote of one quantity, as it is listed for a support."""

    name: str
    quantity: str
    regime: str
    equation: int | None
    formula: str


def rows(shape: str, support: str) -> list[Row]:
    """Return what is listed for a shape and a support, the friction coefficient first.

    >>> rows("parabola", "dead-weight")[3]
    Row(name='depth, high V', quantity='depth', regime='high', equation=49, formula='W/(C V)')
    """
    places = [(quantity, regime) for quantity in LISTED[support] for regime in ("low", "high")]
    names = ["L1", "L2"]
    names += [f"{name.removesuffix('_force')}, {regime} V" for name, regime in places[2:]]
    parabola = shape == "parabola"
    formulas = {"parabola": OF_PARABOLA, "sphere": OF_BALL}.get(shape, OF_POWER_LAW)[support]
    equations = EQUATIONS[support] if parabola else [None] * len(formulas)
    return [
        Row(name, *place, equation, formula)
        for name, place, equation, formula in zip(names, places, equations, formulas, strict=True)
    ]


def report(scene: Scene, tolerance: float, maxima: Mapping[str, Any]) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes`, which documents it."""
    V, tau = np.asarray(scene.drive.final_velocity), scene.foundation.retardation_time
    asymptotes = asymptotes_of(scene)
    limits = asymptotes.limits(scene)
    critical = np.broadcast_to(asymptotes.critical_velocity(limits, tau), scene.shape)
    truth, side = solve_exact(scene), np.where(V < 0.0, -1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):  # no high asymptote at V = 0
        found = {name: asymptotes.quantities(limits, name, side) for name in ("low", "high")}
        errors = {name: asymptotes.errors(limits, name, truth) for name in found}
    lines = []
    for row in rows(scene.indenter.shape, scene.support.kind):
        error = errors[row.regime][row.quantity]
        edge = _range_edge(scene, critical, row, tolerance)
        lines.append(
            AsymptoteLine(
                *row,
                value=_finite(found[row.regime][row.quantity]),
                exact=getattr(truth, row.quantity),
                relative_error=_finite(error),
                velocity_min=plain(edge if row.regime == "high" else np.zeros_like(edge)),
                velocity_max=plain(edge if row.regime == "low" else np.full_like(edge, np.inf)),
                velocity_proved=plain(edge),
            )
        )
    l1, l2 = (np.abs(line.relative_error) <= tolerance for line in lines[:2])
    return AsymptoteReport(
        velocity=plain(V),
        critical_velocity=plain(critical),
        **maxima,
        regime=plain(np.where(np.abs(V) <= critical, "low", "high")),
        use=plain(np.where(l1, "L1", np.where(l2, "L2", "exact"))),
        tolerance=tolerance,
        lines=tuple(lines),
        model="asymptote",
        certificate=Certificate("proved", STATEMENT.format(asymptotes.PROVED), {}),
        units=units_for(scene.indenter, STEADY_UNITS),
    )


def _range_edge(scene: Scene, critical: Array, row: Row, tolerance: float) -> Array:
    """Return the velocity at which the error of an asymptote passes the tolerance.

    The error is monotonic in V: a sign change within `DECADES` of V* is the edge. If the error is within
    the tolerance at the far end too, where it has reached its limit, the asymptote holds at every velocity
    (such as the load on a soft spring). Otherwise nothing is claimed.
    """
    asymptotes = asymptotes_of(scene)

    def excess(scene: Scene, V: Array) -> Array:
        point = scene.at(V)
        truth, limits = solve_exact(point), asymptotes.limits(point)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = asymptotes.errors(limits, row.regime, truth)
        error = np.broadcast_to(np.abs(found[row.quantity]), V.shape)
        return error + ROUNDING * (1.0 + error) - tolerance

    bracket = (np.full_like(critical, -DECADES), np.full_like(critical, DECADES))
    found = sought(excess, scene, critical, bracket)
    nowhere, everywhere, far = (0.0, np.inf, 1) if row.regime == "low" else (np.inf, 0.0, 0)
    without = np.where(found.f_bracket[far] <= 0.0, everywhere, nowhere)
    return np.where(found.success, critical * 10.0**found.x, without)


def _finite(array: Array) -> Any:
    return plain(np.where(np.isfinite(array), array, np.nan))
