r"""The limits of steady sliding of a parabola on a fractional Kelvin-Voigt foundation.

With the order alpha (theorem F18-springpot)

    V -> 0:   mu -> (a/R) 6 alpha/((4 - alpha) Gamma(3 - alpha)) (V tau/(2 a))^alpha,
    V -> oo:  mu -> (a/R) alpha (3 - alpha)/(4 - alpha),
              W -> (K/R) ((2 - alpha)^(2 - alpha)/Gamma(4 - alpha)) (V tau)^alpha a^(3 - alpha),

with a that of the depth, or of the load, which is carried by the spring alone for V -> 0, by the springpot
for V -> oo. For alpha = 1 they are the paper's Eqs. 42, 45 and 46. Their errors are monotonic in V on every
support, so that a range has one end.
"""

from functools import partial

import numpy as np

from kvtheory.models.steady.foundation_limits import (
    Array,
    At,
    Line,
    Values,
    crossing,
    exact_friction,
)
from kvtheory.models.steady.foundation_limits import report as _report
from kvtheory.models.steady.methods import TIME
from kvtheory.results import AsymptoteReport, Certificate
from kvtheory.scene.model import Scene

DECADES, MOST_DECADES = 30.0, 200.0
"""How far from V* the end of a range is sought, in powers of ten: for an order alpha, 1/alpha times as
far."""
STATEMENT = (
    "closed forms against the exact state, which is known to about 5e-15; the errors are monotonic in V "
    "(derivation F18-springpot)"
)
ORDER = "foundation.order"


def report(scene: Scene, values: Values, tolerance: float) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes` for a parabola on a fractional foundation."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        critical = critical_velocity(values)
        lines = []
        for name, regime, at, formula in (
            ("L1", "low", low, "6 A/((4-A) Gamma(3-A)) (a/R) (V tau/(2 a))^A, A = order"),
            ("L2", "high", high, "A (3-A)/(4-A) a/R"),
        ):
            edge = _edge(scene, values, at, regime, critical, tolerance)
            lines.append(Line(name, regime, None, formula, at, edge, edge))
        certificate = Certificate("proved", STATEMENT, {})
        return _report(scene, values, tolerance, critical, lines, certificate)


def low(values: Values, V: Array) -> Array:
    """Return the limit of the friction coefficient for V -> 0."""
    from scipy.special import rgamma

    a, alpha = _at_rest(values)[0], values[ORDER]
    share = 6.0 * alpha * rgamma(3.0 - alpha) / (4.0 - alpha)
    return share * (a / values["indenter.radius"]) * (V * values[TIME] / (2.0 * a)) ** alpha


def high(values: Values, V: Array) -> Array:
    """Return the limit of the friction coefficient for V -> oo."""
    from scipy.special import gamma

    alpha, R = values[ORDER], values["indenter.radius"]
    a, load = _at_rest(values)
    if "support.depth" not in values:
        rest = 2.0 - alpha
        cubed = load * R * gamma(4.0 - alpha) / (values["foundation.stiffness"] * rest**rest)
        a = (cubed / (V * values[TIME]) ** alpha) ** (1.0 / (3.0 - alpha))
    return alpha * (3.0 - alpha) / (4.0 - alpha) * (a / R)


def critical_velocity(values: Values) -> Array:
    """Return V*, where both limits meet: each is a power of V."""
    alpha, unit = values[ORDER], _at_rest(values)[0] / values[TIME]
    slope = alpha if "support.depth" in values else alpha + alpha / (3.0 - alpha)
    return unit * (high(values, unit) / low(values, unit)) ** (1.0 / slope)


def _at_rest(values: Values) -> tuple[Array, Array]:
    """Return the half length at rest, and the load for V -> oo, where a spring has risen by the depth."""
    R, K = values["indenter.radius"], values["foundation.stiffness"]
    if "support.depth" in values:
        a = np.sqrt(2.0 * R * values["support.depth"])
        return a, np.full_like(a, np.nan)
    weight = values["support.weight"]
    a = np.cbrt(1.5 * R * (weight / K))
    return a, weight + values.get("support.stiffness", 0.0 * a) * (a * a / (2.0 * R))


def _edge(
    scene: Scene, values: Values, at: At, regime: str, critical: Array, tolerance: float
) -> Array:
    """Return the velocity at which the error of a limit passes the tolerance."""

    def excess(point: Values, V: Array) -> Array:
        return np.abs(at(point, V) / exact_friction(scene, point, V) - 1.0) - tolerance

    far = np.minimum(DECADES / values[ORDER], MOST_DECADES)
    found = partial(crossing, excess, values, critical, (-far, far))
    return found(0.0 if regime == "low" else np.inf)
