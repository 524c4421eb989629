r"""The asymptotes of steady sliding of a ball: of a spring for l_r << a, of a damper for l_r >> a.

For l_r << a the load is pi K R delta^2 sqrt(R'/R) and mu -> V tau/R, as for a cylinder; for l_r >> a the load
is (4/3) C V delta a sqrt(R'/R) and mu -> (3 pi/16) a/R (derivations "F20-low" and "F20-high"). The relative
errors are closed forms in l = l_r/a and the tail T that fall monotonically towards either limit (derivations
"F20-error-..."). The names are those of `kvtheory.models.steady.asymptotes`, for the ball.
"""

from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.steady.ball import angle_and_tail
from kvtheory.results import SteadyState
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import ball_stiffness
from kvtheory.theory import closed_forms as cf

Value = Any
"""An array, or a float."""

PROVED = "F20-error-L1, F20-error-L2, F20-balance and others"
"""The derivations of the errors."""

PEAK_BRACKET = 1.0, 3.0
"""The maximum of a dead weight is at l = 1.842345."""


class Limits(NamedTuple):
    """What the asymptotes take of a scene, in SI, all of one shape, with V >= 0.

    `static_depth`, `static_half_length` and `static_load` belong to V = 0; `lift_load` is the load for
    V -> oo, where a spring has lifted the ball by its whole static depth.
    """

    radius: Value
    stretch: Value
    stiffness: Value
    retardation_length: Value
    static_depth: Value
    static_half_length: Value
    static_load: Value
    lift_load: Value
    fixed: bool


def limits(scene: Scene) -> Limits:
    """Collect the limits of a scene."""
    R, c, K = scene.indenter.radius, scene.indenter.stretch, scene.foundation.stiffness
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    spring = ball_stiffness(K, R, c)
    if scene.held:
        depth = scene.support.depth
        load = lift = spring * depth * depth
    else:
        load = scene.support.weight
        depth = np.sqrt(load / spring)
        lift = load + scene.support.spring * depth
    a = np.sqrt(2.0 * R * depth)
    return Limits(R, c, K, l_r, depth, a, load, lift, fixed=scene.held)


def critical_velocity(scene: Limits, retardation_time: Value) -> Value:
    """Return V*, where the two asymptotes of the friction coefficient meet (derivation "F20-crossing")."""
    a_0 = scene.static_half_length
    if scene.fixed:
        return a_0 * cf.BALL_CROSSING / retardation_time
    kappa = scene.lift_load / scene.static_load - 1.0
    return a_0 * cf.ball_crossing_at_load(kappa) / retardation_time


def peak(scene: Limits, retardation_time: Value) -> tuple[Value, Value]:
    """Return velocity and friction coefficient at the maximum of a dead weight."""
    from scipy.optimize import brentq  # it takes a while to import

    def rise(l: float) -> float:
        return float(cf.ball_friction_rise(l, float(angle_and_tail(np.array([l]))[1][0])))

    l = np.array([brentq(rise, *PEAK_BRACKET, xtol=1e-15)])
    _, tail = angle_and_tail(l)
    s = np.sqrt(np.sqrt(0.5 * np.pi / cf.ball_load_factor(l, tail)))[0]  # s^4 w = w at rest
    a = s * scene.static_half_length
    top = cf.ball_friction_coefficient_factor(l, tail)[0]
    return a * l[0] / retardation_time, top * a / scene.radius


def quantities(scene: Limits, regime: str, side: Value = 1.0) -> dict[str, Value]:
    """Return the asymptote of every quantity of steady sliding, by `regime`: ``"low"`` or ``"high"``.

    `side` is -1 for a reversed drive. At V = 0 those for high velocity are infinite or zero.
    """
    R, l_r, slow = scene.radius, scene.retardation_length, regime == "low"
    viscous = 4.0 / 3.0 * scene.stiffness * l_r * scene.stretch  # W = viscous delta a
    if slow or scene.fixed:
        depth, a = scene.static_depth, scene.static_half_length
        load = scene.static_load if slow else viscous * depth * a
    else:
        load = scene.lift_load
        a = np.cbrt(2.0 * R * load / viscous)
        depth = a * (a / (2.0 * R))
    mu = l_r / R if slow else cf.BALL_CROSSING * a / R
    pressure = scene.stiffness * depth
    return {
        "depth": depth,
        "half_length": a,
        "retardation_length": l_r,
        "leading_edge": -side * a,
        "trailing_edge": side * a if slow else 0.0 * a,
        "load": load,
        "friction_force": side * (load * mu) + 0.0,  # no negative zero
        "friction_coefficient": side * mu + 0.0,
        "peak_pressure": pressure if slow else pressure * (2.0 * l_r / a),
        "dissipated_in_contact": np.ones_like(a),
    }


def errors(scene: Limits, regime: str, state: SteadyState) -> dict[str, Value]:
    """Return asymptote/exact - 1 of each quantity, given the exact state; V > 0 if `regime` is high."""
    slow = regime == "low"
    l = state.retardation_length / np.asarray(state.half_length)
    _, T = angle_and_tail(np.atleast_1d(l))
    T = T.reshape(np.shape(l))
    q, peak = cf.trailing_edge_ratio(l), cf.peak_pressure_factor(l)
    mu = np.log1p((cf.ball_error_l1 if slow else cf.ball_error_l2)(l, T))
    length = 0.5 * np.log(
        scene.static_depth / state.depth
    )  # ln(asymptote/exact): ratios multiply by their logarithms
    if scene.fixed:
        load = (cf.ball_error_load_low if slow else cf.ball_error_load_high)(l, T)
        friction = (cf.ball_error_friction_low if slow else cf.ball_error_friction_high)(l, T)
    elif slow:
        load = scene.static_load / state.load - 1.0
        friction = np.expm1(np.log(scene.static_load / state.load) + mu)
    else:
        # The spring still carries k_s delta: lift_load - W = k_s delta.
        lifted = state.depth / scene.static_depth
        load = (scene.lift_load - scene.static_load) * lifted / state.load
        viscous = 4.0 / 3.0 * l / cf.ball_load_factor(l, T)  # C V delta a 4/3 over W
        length = (np.log1p(load) - np.log(viscous)) / 3.0
        mu = mu + length
        friction = np.expm1(np.log1p(load) + mu)
    own = 2.0 * length - np.log(peak) if slow else length + np.log(2.0 * l / peak)
    return {
        "depth": np.expm1(2.0 * length),
        "half_length": np.expm1(length),
        "retardation_length": np.zeros_like(l),
        "leading_edge": np.expm1(length),
        "trailing_edge": np.expm1(length - np.log(q)) if slow else -np.ones_like(l),
        "load": load,
        "friction_force": friction,
        "friction_coefficient": np.expm1(mu),
        "peak_pressure": np.expm1(own),
        "dissipated_in_contact": 1.0 / cf.ball_dissipated_in_contact(l, T) - 1.0,
    }
