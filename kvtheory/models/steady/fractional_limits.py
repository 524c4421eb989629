r"""The limits of steady sliding of a parabola on a fractional Kelvin-Voigt foundation.

With the order alpha (theorem F18-springpot)

    V -> 0:   mu -> (a/R) 6 alpha/((4 - alpha) Gamma(3 - alpha)) (V tau/(2 a))^alpha,
    V -> oo:  mu -> (a/R) alpha (3 - alpha)/(4 - alpha),
              W -> (K/R) ((2 - alpha)^(2 - alpha)/Gamma(4 - alpha)) (V tau)^alpha a^(3 - alpha),

with a that of the depth, or of the load, which is carried by the spring alone for V -> 0, by the springpot
for V -> oo. For alpha = 1 they are the paper's Eqs. 42, 45 and 46. Their errors are monotonic in V on every
support, so that a range has one end.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np

from kvtheory.models.steady.foundation_limits import (
    Array,
    At,
    Line,
    crossing,
    exact_friction,
)
from kvtheory.models.steady.foundation_limits import report as _report
from kvtheory.results import AsymptoteReport, Certificate
from kvtheory.scene.model import Scene

DECADES, MOST_DECADES = 30.0, 200.0
"""How far from V* the end of a range is sought, in powers of ten: for an order alpha, 1/alpha times as
far."""
STATEMENT = (
    "closed forms against the exact state, which is known to about 5e-15; the errors are monotonic in V "
    "(derivation F18-springpot)"
)


def report(scene: Scene, tolerance: float, maxima: Mapping[str, Any]) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes` for a parabola on a fractional foundation."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        critical = np.broadcast_to(critical_velocity(scene), scene.shape)
        lines = []
        for name, regime, at, formula in (
            ("L1", "low", low, "6 A/((4-A) Gamma(3-A)) (a/R) (V tau/(2 a))^A, A = order"),
            ("L2", "high", high, "A (3-A)/(4-A) a/R"),
        ):
            edge = _edge(scene, at, regime, critical, tolerance)
            lines.append(Line(name, regime, None, formula, at, edge, edge))
        certificate = Certificate("proved", STATEMENT, {})
        return _report(scene, tolerance, critical, lines, certificate, maxima)


def low(scene: Scene, V: Array) -> Any:
    """Return the limit of the friction coefficient for V -> 0."""
    from scipy.special import rgamma

    a, alpha = _at_rest(scene)[0], scene.foundation.order
    share = 6.0 * alpha * rgamma(3.0 - alpha) / (4.0 - alpha)
    slowness = V * scene.foundation.retardation_time / (2.0 * a)
    return share * (a / scene.indenter.radius) * slowness**alpha


def high(scene: Scene, V: Array) -> Any:
    """Return the limit of the friction coefficient for V -> oo."""
    from scipy.special import gamma

    foundation, R = scene.foundation, scene.indenter.radius
    alpha = foundation.order
    a, load = _at_rest(scene)
    if not scene.held:
        rest = 2.0 - alpha
        cubed = load * R * gamma(4.0 - alpha) / (foundation.stiffness * rest**rest)
        a = (cubed / (V * foundation.retardation_time) ** alpha) ** (1.0 / (3.0 - alpha))
    return alpha * (3.0 - alpha) / (4.0 - alpha) * (a / R) + 0.0 * V


def critical_velocity(scene: Scene) -> Any:
    """Return V*, where both limits meet: each is a power of V."""
    alpha, unit = scene.foundation.order, _at_rest(scene)[0] / scene.foundation.retardation_time
    slope = alpha if scene.held else alpha + alpha / (3.0 - alpha)
    return unit * (high(scene, unit) / low(scene, unit)) ** (1.0 / slope)


def _at_rest(scene: Scene) -> tuple[Any, Any]:
    """Return the half length at rest, and the load for V -> oo, where a spring has risen by the depth."""
    R, support = scene.indenter.radius, scene.support
    if scene.held:
        return np.sqrt(2.0 * R * support.depth), np.nan
    a = np.cbrt(1.5 * R * (support.weight / scene.foundation.stiffness))
    return a, support.weight + support.spring * (a * a / (2.0 * R))


def _edge(scene: Scene, at: At, regime: str, critical: Array, tolerance: float) -> Array:
    """Return the velocity at which the error of a limit passes the tolerance."""

    def excess(scene: Scene, V: Array) -> Array:
        return np.abs(at(scene, V) / exact_friction(scene, V) - 1.0) - tolerance

    far = np.minimum(DECADES / scene.foundation.order, MOST_DECADES)
    return crossing(excess, scene, critical, (-far, far), 0.0 if regime == "low" else np.inf)
