"""Which asymptote holds for a scene, how wrong it is, and over which velocities."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady.asymptotes import Row
from kvtheory.models.steady.methods import plain, solve_exact
from kvtheory.results import AsymptoteLine, AsymptoteReport, Certificate
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
Values = Mapping[str, Array]

DECADES = 30.0
"""How far from the critical velocity, in powers of ten, the range of an asymptote is looked for."""

STATEMENT = "the relative errors are closed forms (derivations {}), monotonic in V, evaluated to about 1e-14"


def report(scene: Scene, values: Values, tolerance: float) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes`, which documents it."""
    V, tau = values["drive.velocity"], values["foundation.retardation_time"]
    limits = asymptotes.limits(values)
    critical = asymptotes.critical_velocity(limits, tau)
    truth, side = solve_exact(scene, values), np.where(V < 0.0, -1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):  # no high asymptote at V = 0
        found = {name: asymptotes.quantities(limits, name, side) for name in ("low", "high")}
        errors = {name: asymptotes.errors(limits, name, truth) for name in found}
    lines = []
    for row in asymptotes.rows(scene.indenter.shape, scene.support.kind):
        error = errors[row.regime][row.quantity]
        edge = _range_edge(scene, values, critical, row, tolerance)
        lines.append(
            AsymptoteLine(
                *row,
                value=_finite(found[row.regime][row.quantity]),
                exact=getattr(truth, row.quantity),
                relative_error=_finite(error),
                velocity_min=plain(edge if row.regime == "high" else np.zeros_like(edge)),
                velocity_max=plain(edge if row.regime == "low" else np.full_like(edge, np.inf)),
            )
        )
    nothing = np.full_like(critical, np.nan)
    dead = scene.support.kind == "dead-weight"
    peak_velocity, peak_friction = asymptotes.peak(limits, tau) if dead else (nothing, nothing)
    l1, l2 = (np.abs(line.relative_error) <= tolerance for line in lines[:2])
    return AsymptoteReport(
        velocity=plain(V),
        critical_velocity=plain(critical),
        peak_velocity=plain(peak_velocity),
        peak_friction_coefficient=plain(peak_friction),
        regime=plain(np.where(np.abs(V) <= critical, "low", "high")),
        use=plain(np.where(l1, "L1", np.where(l2, "L2", "exact"))),
        tolerance=tolerance,
        lines=tuple(lines),
        model="asymptote",
        certificate=Certificate("proved", STATEMENT.format(asymptotes.PROVED), {}),
    )


def _range_edge(scene: Scene, values: Values, critical: Array, row: Row, tolerance: float) -> Array:
    """Return the velocity at which the error of an asymptote passes the tolerance.

    The error is monotonic in V: a sign change within `DECADES` of V* is the edge; without one the
    asymptote is good at every velocity (a dead weight's load, say).
    """
    keys = list(values)

    def excess(decades: Array, *arrays: Array) -> Array:
        point = dict(zip(keys, arrays[:-1], strict=True))
        point["drive.velocity"] = arrays[-1] * 10.0**decades
        truth, limits = solve_exact(scene, point), asymptotes.limits(point)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = asymptotes.errors(limits, row.regime, truth)
        return np.abs(found[row.quantity]) - tolerance

    args = (*values.values(), critical)
    bracket = (np.full_like(critical, -DECADES), np.full_like(critical, DECADES))
    found = elementwise.find_root(excess, bracket, args=args)
    everywhere = np.inf if row.regime == "low" else 0.0
    return np.where(found.success, critical * 10.0**found.x, everywhere)


def _finite(array: Array) -> Any:
    return plain(np.where(np.isfinite(array), array, np.nan))
