r"""The asymptotes of steady sliding of a power law h = slope |x|^n/(n L^(n-1)), or of a wedge, n = 1.

For l_r << a nothing peels, mu -> (delta/a) l n (n + 1)/(2 n - 1); for l_r >> a the outlet side has peeled
completely, W -> C V delta and mu -> (delta/a) n^2/(2 n - 1) (derivations "F19-low" and "F19-high"). Under a
weight the second falls as V^(-(1 - 1/n)). The relative errors are closed forms that fall monotonically
towards either limit (derivations "F19-error-..."). The names are those of
`kvtheory.models.steady.asymptotes`.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import closed_forms as cf
from kvtheory.models.steady.asymptotes import Row
from kvtheory.models.steady.power_law_contact import root, shape_of, trailing_edge
from kvtheory.results import SteadyState

Array = NDArray[np.float64]

PROVED = "F19-error-L1, F19-error-L2, F19-error-monotonic and others"
"""The derivations of the errors."""

SMALL = 0.5
"""Up to this z = n l Q the peeled parts follow from z, beyond from q and Q themselves."""
TERMS = tuple(1.0 / float(np.prod(np.arange(1, k + 3))) for k in range(16))
"""Coefficients of phi_2(x) = sum x^k/(k + 2)!; for |x| <= ln 2 the next is below rounding."""
PEAK_BRACKET = 0.5, 4.0
"""The maximum of a dead weight is at l between 1 (n -> 1) and 2 (n -> oo)."""


@dataclass(frozen=True)
class Limits:
    """What the asymptotes take of a scene, in SI, all of one shape, with V >= 0.

    `static_depth`, `static_half_length` and `static_load` belong to V = 0. `lift_load` is the load for
    V -> oo: under a spring the indenter is lifted by its whole static depth.
    """

    slope: Array
    length: Array
    exponent: Array
    stiffness: Array
    retardation_length: Array
    static_depth: Array
    static_half_length: Array
    static_load: Array
    lift_load: Array
    fixed: bool

    def half_length(self, depth: Array) -> Array:
        """Return a, where h(a) is the depth."""
        ratio = self.exponent * depth / (self.slope * self.length)
        return self.length * root(ratio, self.exponent)


def limits(values: Mapping[str, Array]) -> Limits:
    """Collect the limits of a scene, given its values by dotted key."""
    slope, L, n = shape_of(values)
    K = values["foundation.stiffness"]
    l_r = np.abs(values["drive.velocity"]) * values["foundation.retardation_time"]
    if "support.depth" in values:
        depth = values["support.depth"]
        a = L * root(n * depth / (slope * L), n)
        load = K * depth * a * cf.power_law_static_load(n)
        return Limits(slope, L, n, K, l_r, depth, a, load, load, fixed=True)
    weight = values["support.weight"]
    a_0 = L * root((n + 1.0) * (weight / K) / (2.0 * slope * L * L), n + 1.0)
    delta_0 = weight / (K * a_0 * cf.power_law_static_load(n))
    lift = weight + values.get("support.stiffness", 0.0) * delta_0
    return Limits(slope, L, n, K, l_r, delta_0, a_0, weight, lift, fixed=False)


def critical_velocity(scene: Limits, retardation_time: Array) -> Array:
    """Return V*, where the two asymptotes of the friction coefficient meet, exactly.

    V* tau = a n/(n + 1) for a fixed indenter, a_0 2^((n-1)/(2n-1)) n/(n + 1) for a dead weight
    (derivations "F19-crossing" and "F19-crossing-weight").
    """
    n, a_0 = scene.exponent, scene.static_half_length
    if scene.fixed:
        return a_0 * cf.power_law_crossing(n) / retardation_time
    kappa = scene.lift_load / scene.static_load - 1.0
    return a_0 * cf.power_law_crossing_at_load(n, kappa) / retardation_time


def peak(scene: Limits, retardation_time: Array) -> tuple[Array, Array]:
    """Return velocity and friction coefficient at the one maximum of a dead weight.

    A wedge has none: from l_r = a on its friction coefficient is its slope. The values are NaN.
    """
    from scipy.optimize import elementwise  # it takes a while to import

    n = scene.exponent

    def rise(l: Array, n: Array) -> Array:
        return cf.power_law_friction_rise(n, l, *trailing_edge(n, l))

    ends = tuple(np.full_like(n, end) for end in PEAK_BRACKET)
    l = np.where(n > 1.0, elementwise.find_root(rise, ends, args=(n,)).x, np.nan)
    q, Q = trailing_edge(n, l)
    ratio = cf.power_law_static_load(n) / cf.power_law_load(n, l, q, Q)
    s = ratio ** (1.0 / (n + 1.0))  # s^(n+1) w = w at rest
    velocity = l * s * scene.static_half_length / retardation_time
    slope = scene.static_depth / scene.static_half_length * s ** (n - 1.0)
    return velocity, slope * cf.power_law_friction_coefficient(n, l, q, Q)


def low(scene: Limits) -> dict[str, Array]:
    """Return the asymptotes for l_r << a."""
    n, a_0 = scene.exponent, scene.static_half_length
    slope = scene.static_depth / a_0
    mu = slope * (scene.retardation_length / a_0) * cf.power_law_low(n)
    return {
        "depth": scene.static_depth,
        "load": scene.static_load,
        "friction_coefficient": mu,
        "friction_force": scene.static_load * mu,
    }


def high(scene: Limits) -> dict[str, Array]:
    """Return the asymptotes for l_r >> a; infinite or zero at V = 0."""
    viscous = scene.stiffness * scene.retardation_length  # C V
    if scene.fixed:
        depth, load = scene.static_depth, viscous * scene.static_depth
    else:
        depth, load = scene.lift_load / viscous, scene.lift_load
    mu = depth / scene.half_length(depth) * cf.power_law_high(scene.exponent)
    return {"depth": depth, "load": load, "friction_coefficient": mu, "friction_force": load * mu}


def quantities(scene: Limits, regime: str, side: Array | float = 1.0) -> dict[str, Array]:
    """Return the asymptote of every quantity of steady sliding, by `regime`: ``"low"`` or ``"high"``.

    `side` is -1 for a reversed drive. At V = 0 those for high velocity are infinite or zero.
    """
    slow = regime == "low"
    found = low(scene) if slow else high(scene)
    depth, l_r = found["depth"], scene.retardation_length
    a = scene.half_length(depth)
    pressure = scene.stiffness * depth
    return {
        "depth": depth,
        "half_length": a,
        "retardation_length": l_r,
        "leading_edge": -side * a,
        "trailing_edge": side * a if slow else 0.0 * a,
        "load": found["load"],
        "friction_force": side * found["friction_force"] + 0.0,  # no negative zero
        "friction_coefficient": side * found["friction_coefficient"] + 0.0,
        "peak_pressure": pressure if slow else pressure * (scene.exponent * l_r / a),
        "dissipated_in_contact": np.ones_like(a),
    }


def low_errors(scene: Limits, state: SteadyState) -> dict[str, Array]:
    """Return asymptote/exact - 1 of each quantity for l_r << a, given the exact state."""
    n, l, q, Q = _contact(scene, state)
    peeled, drop, bend = _peeled(n, l, q, Q)
    mu = cf.power_law_error_l1(n, l, q, Q, drop)
    if scene.fixed:
        depth = np.zeros_like(l)
        load = cf.power_law_error_load_low(l, q, Q, bend)
        friction = cf.power_law_error_friction_low(n, l, q, Q, peeled, drop)
    else:
        depth = scene.static_depth / state.depth - 1
        load = scene.static_load / state.load - 1
        mu = _compound(mu, _power(depth, 1.0 - 2.0 / n))
        friction = _compound(load, mu)
    length = _power(depth, 1.0 / n)
    return {
        **_shared(depth, length, load, friction, mu),
        "trailing_edge": _compound(length, peeled / q),
        "peak_pressure": _compound(depth, 1 / cf.power_law_peak_pressure(n, l) - 1),
        "dissipated_in_contact": 1 / cf.power_law_dissipated_in_contact(n, l, q, Q) - 1,
    }


def high_errors(scene: Limits, state: SteadyState) -> dict[str, Array]:
    """Return asymptote/exact - 1 of each quantity for l_r >> a, given the exact state at V > 0."""
    n, l, q, Q = _contact(scene, state)
    mu = cf.power_law_error_l2(n, l, q, Q)
    if scene.fixed:
        depth, load = np.zeros_like(l), cf.power_law_error_load_high(n, l, q, Q)
        friction = cf.power_law_error_friction_high(n, l, q, Q)
    else:
        # The spring has not yet let go of k_s delta: lift_load - W = k_s delta.
        lifted = state.depth / scene.static_depth
        load = (scene.lift_load - scene.static_load) * lifted / state.load
        depth = _compound(cf.power_law_error_depth_high(n, l, q, Q), load)
        mu = _compound(mu, _power(depth, 1.0 - 1.0 / n))
        friction = _compound(load, mu)
    peak = n * l / cf.power_law_peak_pressure(n, l) - 1
    return {
        **_shared(depth, _power(depth, 1.0 / n), load, friction, mu),
        # The asymptote is the tip, where that of a wedge is from l = 1 on.
        "trailing_edge": np.where((q == 0.0) & (n == 1.0), 0.0, -1.0),
        "peak_pressure": _compound(_power(depth, 1.0 - 1.0 / n), peak),
        "dissipated_in_contact": 1 / cf.power_law_dissipated_in_contact(n, l, q, Q) - 1,
    }


def _shared(
    depth: Array, length: Array, load: Array, friction: Array, mu: Array
) -> dict[str, Array]:
    return {
        "depth": depth,
        "half_length": length,
        "retardation_length": np.zeros_like(mu),
        "leading_edge": length,
        "load": load,
        "friction_force": friction,
        "friction_coefficient": mu,
    }


def _contact(scene: Limits, state: SteadyState) -> tuple[Array, Array, Array, Array]:
    """Return n, l, q and Q."""
    half = np.asarray(state.half_length)
    l = state.retardation_length / half
    q = np.abs(state.trailing_edge) / half
    return scene.exponent, l, q, 1.0 / (q + scene.exponent * l)


def _peeled(n: Array, l: Array, q: Array, Q: Array) -> tuple[Array, Array, Array]:
    """Return 1 - q, 1 - Q and l - (1 - q) without a difference where they are small."""
    small = n * l * Q <= SMALL
    z = np.where(small, n * l * Q, 0.0)
    y = -np.log1p(-z) / n
    bend = cf.power_law_bend(n, y, _phi_2((n - 1.0) * y), _phi_2(-y))
    return (
        np.where(small, cf.power_law_peeled(n, z), 1.0 - q),
        np.where(small, cf.power_law_slope_drop(n, z), 1.0 - Q),
        np.where(small, bend, l - (1.0 - q)),
    )


def _phi_2(x: Array) -> Array:
    """Return (e^x - 1 - x)/x^2 for |x| <= ln 2."""
    return np.asarray(np.polyval(TERMS[::-1], x))


def _power(error: Array, power: Array) -> Array:
    """Return the relative error of a power: (1 + error)^power - 1."""
    return np.expm1(power * np.log1p(error))


def _compound(first: Array, second: Array) -> Array:
    """Return the relative error of a product: (1 + first)(1 + second) - 1."""
    return first + second + first * second


def _rows(*rows: tuple[str, str, str, str]) -> tuple[Row, ...]:
    return tuple(
        Row(name, quantity, regime, None, formula) for name, quantity, regime, formula in rows
    )


L1_FORMULA = "n (n+1)/(2n-1) delta_0 C V/(K a_0^2)"
ROWS = {
    "fixed": _rows(
        ("L1", "friction_coefficient", "low", "n (n+1)/(2n-1) delta C V/(K a^2)"),
        ("L2", "friction_coefficient", "high", "n^2/(2n-1) delta/a"),
        ("load, low V", "load", "low", "2n/(n+1) K delta a"),
        ("load, high V", "load", "high", "C V delta"),
        ("friction, low V", "friction_force", "low", "2n^2/(2n-1) C V delta^2/a"),
        ("friction, high V", "friction_force", "high", "n^2/(2n-1) C V delta^2/a"),
    ),
    "dead-weight": _rows(
        ("L1", "friction_coefficient", "low", L1_FORMULA),
        ("L2", "friction_coefficient", "high", "n^2/(2n-1) delta/a, delta = W/(C V)"),
        ("depth, low V", "depth", "low", "delta_0 = (n+1)/(2n) W/(K a_0)"),
        ("depth, high V", "depth", "high", "W/(C V)"),
    ),
    "suspended": _rows(
        ("L1", "friction_coefficient", "low", L1_FORMULA),
        ("L2", "friction_coefficient", "high", "n^2/(2n-1) delta/a, delta as below"),
        ("depth, low V", "depth", "low", "delta_0 = (n+1)/(2n) M g/(K a_0)"),
        ("depth, high V", "depth", "high", "(M g + k_s delta_0)/(C V)"),
        ("load, low V", "load", "low", "M g"),
        ("load, high V", "load", "high", "M g + k_s delta_0"),
    ),
}
"""What is listed for each support; n = 1 for a wedge, W = M g is the load of a dead weight."""
