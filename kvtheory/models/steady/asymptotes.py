r"""The asymptotes of steady sliding of h = slope |x|^n/(n L^(n-1)): parabola, power law and wedge.

For l_r << a nothing peels and the foundation is a spring, mu -> (delta/a) l n (n + 1)/(2 n - 1); for
l_r >> a the outlet side has peeled completely and it is a damper, W -> C V delta and
mu -> (delta/a) n^2/(2 n - 1) (derivations "F19-low" and "F19-high"). With n = 2 these are the paper's
(Eqs. 38-49). The relative errors are closed forms in l = l_r/a and q = x_TE/a that fall monotonically
towards either limit (derivations "F19-error-..."): "within a tolerance" is a half-line of velocities.
"""

from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.steady.power_law_contact import root, shape_of, trailing_edge
from kvtheory.results import SteadyState
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf

Value = Any
"""An array, or a float."""

PROVED = "F19-error-L1, F19-error-L2, F19-error-monotonic and others"
"""The derivations of the errors."""

SMALL = 0.5
"""Up to this z = n l Q the peeled parts follow from z, beyond from q and Q themselves."""
TERMS = tuple(1.0 / float(np.prod(np.arange(1, k + 3))) for k in range(16))
"""Coefficients of phi_2(x) = sum x^k/(k + 2)!; for |x| <= ln 2 the next is below rounding."""
PEAK_BRACKET = 0.5, 4.0
"""The maximum of a dead weight is at l between 1 (n -> 1) and 2 (n -> oo)."""


class Limits(NamedTuple):
    """The input of the asymptotes from a scene, in SI, all arrays of one shape, with V >= 0.

    `static_depth`, `static_half_length` and `static_load` belong to V = 0. `lift_load` is the load for
    V -> oo: under a spring the indenter is lifted by its whole static depth, W -> M g + k_s delta_0.
    """

    slope: Value
    length: Value
    exponent: Value
    stiffness: Value
    retardation_length: Value
    static_depth: Value
    static_half_length: Value
    static_load: Value
    lift_load: Value
    fixed: bool


def limits(scene: Scene) -> Limits:
    """Collect the limits of a scene."""
    slope, L, n = shape = shape_of(scene.indenter)
    K, support = scene.foundation.stiffness, scene.support
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    if scene.held:
        a = _half_length(*shape, support.depth)
        load = K * support.depth * a * cf.power_law_static_load(n)  # Eq. 40
        return Limits(*shape, K, l_r, support.depth, a, load, load, fixed=True)
    a_0 = L * root((n + 1.0) * (support.weight / K) / (2.0 * slope * L * L), n + 1.0)
    delta_0 = support.weight / (K * a_0 * cf.power_law_static_load(n))
    lift = support.weight + support.spring * delta_0
    return Limits(*shape, K, l_r, delta_0, a_0, support.weight, lift, fixed=False)


def _half_length(slope: Value, length: Value, exponent: Value, depth: Value) -> Value:
    return length * root(exponent * depth / (slope * length), exponent)


def critical_velocity(scene: Limits, retardation_time: Value) -> Value:
    """Return V*, where the two asymptotes of the friction coefficient meet, exactly.

    V* tau = a n/(n + 1) for a fixed indenter, a_0 2^((n-1)/(2n-1)) n/(n + 1) for a dead weight
    (derivations "F19-crossing" and "F19-crossing-weight"; Eqs. 47, 48 with their coefficients).
    """
    n, a_0 = scene.exponent, scene.static_half_length
    if scene.fixed:
        return a_0 * cf.power_law_crossing(n) / retardation_time
    kappa = scene.lift_load / scene.static_load - 1.0
    return a_0 * cf.power_law_crossing_at_load(n, kappa) / retardation_time


def peak(scene: Limits, retardation_time: Value) -> tuple[Value, Value]:
    """Return velocity and friction coefficient at the one maximum of a dead weight.

    A wedge has none: from l_r = a on its friction coefficient is its slope. The values are NaN.
    """
    from scipy.optimize import elementwise  # it takes a while to import

    n = scene.exponent + 0.0 * scene.static_depth

    def rise(l: Value, n: Value) -> Value:
        return cf.power_law_friction_rise(n, l, *trailing_edge(n, l))

    ends = tuple(np.full_like(n, end) for end in PEAK_BRACKET)
    l = np.where(n > 1.0, elementwise.find_root(rise, ends, args=(n,)).x, np.nan)
    q, Q = trailing_edge(n, l)
    ratio = cf.power_law_static_load(n) / cf.power_law_load(n, l, q, Q)
    s = ratio ** (1.0 / (n + 1.0))  # s^(n+1) w = w at rest
    velocity = l * s * scene.static_half_length / retardation_time
    slope = scene.static_depth / scene.static_half_length * s ** (n - 1.0)
    return velocity, slope * cf.power_law_friction_coefficient(n, l, q, Q)


def quantities(scene: Limits, regime: str, side: Value = 1.0) -> dict[str, Value]:
    """Return the asymptote of every quantity of steady sliding, by `regime`: ``"low"`` or ``"high"``.

    `side` is -1 for a reversed drive. At V = 0 those for high velocity are infinite or zero.
    """
    n, l_r, slow = scene.exponent, scene.retardation_length, regime == "low"
    viscous = scene.stiffness * l_r  # C V
    if slow:
        depth, load, a = scene.static_depth, scene.static_load, scene.static_half_length
        mu = depth / a * (l_r / a) * cf.power_law_low(n)  # Eq. 42
    else:
        if scene.fixed:
            depth, load = scene.static_depth, viscous * scene.static_depth  # Eq. 43
        else:
            depth, load = scene.lift_load / viscous, scene.lift_load  # Eq. 49
        a = _half_length(scene.slope, scene.length, n, depth)
        mu = depth / a * cf.power_law_high(n)  # Eqs. 45, 46
    pressure = scene.stiffness * depth
    return {
        "depth": depth,
        "half_length": a,
        "retardation_length": l_r,
        "leading_edge": -side * a,
        "trailing_edge": side * a if slow else 0.0 * a,  # Eqs. 38, 39
        "load": load,
        "friction_force": side * (load * mu) + 0.0,  # no negative zero
        "friction_coefficient": side * mu + 0.0,
        "peak_pressure": pressure if slow else pressure * (n * l_r / a),
        "dissipated_in_contact": np.ones_like(a),
    }


def errors(scene: Limits, regime: str, state: SteadyState) -> dict[str, Value]:
    """Return asymptote/exact - 1 of each quantity, given the exact state; V > 0 if `regime` is high.

    Ratios multiply by their logarithms: products of relative errors lose all digits where one nears -1.
    """
    n, half = scene.exponent, np.asarray(state.half_length)
    l, q = state.retardation_length / half, np.abs(state.trailing_edge) / half
    contact = n, l, q, 1.0 / (q + n * l)
    found = (_low_errors if regime == "low" else _high_errors)(scene, state, *contact)
    return {
        **found,
        "retardation_length": np.zeros_like(l),
        "leading_edge": found["half_length"],
        "dissipated_in_contact": 1 / cf.power_law_dissipated_in_contact(*contact) - 1,
    }


def _low_errors(
    scene: Limits, state: SteadyState, n: Value, l: Value, q: Value, Q: Value
) -> dict[str, Value]:
    peeled, drop, bend = _peeled(n, l, q, Q)
    depth = np.log(scene.static_depth / state.depth)
    mu = np.log1p(cf.power_law_error_l1(n, l, q, Q, drop)) + (1.0 - 2.0 / n) * depth
    if scene.fixed:
        load = cf.power_law_error_load_low(l, q, Q, bend)
        friction = cf.power_law_error_friction_low(n, l, q, Q, peeled, drop)
    else:
        load = scene.static_load / state.load - 1
        friction = np.expm1(np.log(scene.static_load / state.load) + mu)
    with np.errstate(divide="ignore", over="ignore"):  # a sharp tip has x_TE = 0, or nearly
        trailing = np.expm1(depth / n + np.log1p(peeled / q))
    return {
        "depth": np.expm1(depth),
        "half_length": np.expm1(depth / n),
        "trailing_edge": trailing,
        "load": load,
        "friction_force": friction,
        "friction_coefficient": np.expm1(mu),
        "peak_pressure": np.expm1(depth - np.log(cf.power_law_peak_pressure(n, l))),
    }


def _high_errors(
    scene: Limits, state: SteadyState, n: Value, l: Value, q: Value, Q: Value
) -> dict[str, Value]:
    mu = np.log1p(cf.power_law_error_l2(n, l, q, Q))
    if scene.fixed:
        depth, load = np.zeros_like(l), cf.power_law_error_load_high(n, l, q, Q)
        friction = cf.power_law_error_friction_high(n, l, q, Q)
    else:
        # The spring still carries k_s delta: lift_load - W = k_s delta.
        lifted = state.depth / scene.static_depth
        load = (scene.lift_load - scene.static_load) * lifted / state.load
        depth = np.log1p(cf.power_law_error_depth_high(n, l, q, Q)) + np.log1p(load)
        mu = mu + (1.0 - 1.0 / n) * depth
        friction = np.expm1(np.log1p(load) + mu)
    peak = np.log(n * l / cf.power_law_peak_pressure(n, l))
    return {
        "depth": np.expm1(depth),
        "half_length": np.expm1(depth / n),
        # The asymptote is the tip, where that of a wedge is from l = 1 on.
        "trailing_edge": np.where((q == 0.0) & (n == 1.0), 0.0, -1.0),
        "load": load,
        "friction_force": friction,
        "friction_coefficient": np.expm1(mu),
        "peak_pressure": np.expm1((1.0 - 1.0 / n) * depth + peak),
    }


def _peeled(n: Value, l: Value, q: Value, Q: Value) -> tuple[Value, Value, Value]:
    """Return 1 - q, 1 - Q and l - (1 - q) without cancellation where they are small."""
    small = n * l * Q <= SMALL
    z = np.where(small, n * l * Q, 0.0)
    y = -np.log1p(-z) / n
    rise, fall = (np.polyval(TERMS[::-1], x) for x in ((n - 1.0) * y, -y))
    return (
        np.where(small, cf.power_law_peeled(n, z), 1.0 - q),
        np.where(small, cf.power_law_slope_drop(n, z), 1.0 - Q),
        np.where(small, cf.power_law_bend(n, y, rise, fall), l - (1.0 - q)),
    )
