r"""Steady sliding far from the critical velocity: the paper's asymptotes (Eqs. 40-49).

For l_r << a nothing peels and the foundation is a spring; for l_r >> a the outlet side has
peeled completely and the foundation is a damper. The relative error of each asymptote is known
exactly as a function of l = l_r/a and q = x_TE/a (derivations "error-..."); it falls monotonically
towards its limit, so that "within a tolerance" is a half-line of velocities.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import closed_forms as cf
from kvtheory.results import SteadyState

Array = NDArray[np.float64]

PROVED = "error-L1, error-L2-fixed, error-L2-dead-weight and others"
"""The derivations of the errors."""


@dataclass(frozen=True)
class Limits:
    """What the asymptotes take of a scene, in SI, all of one shape, with V >= 0.

    `static_depth` and `static_load` belong to V = 0. `lift_load` is the load for V -> oo: under a
    spring the indenter is lifted by its whole static depth, W -> M g + k_s delta_0.
    """

    radius: Array
    stiffness: Array
    retardation_length: Array
    static_depth: Array
    static_load: Array
    lift_load: Array
    fixed: bool


def limits(values: Mapping[str, Array]) -> Limits:
    """Collect the limits of a scene, given its values by dotted key."""
    R, K = values["indenter.radius"], values["foundation.stiffness"]
    l_r = np.abs(values["drive.velocity"]) * values["foundation.retardation_time"]
    if "support.depth" in values:
        depth = values["support.depth"]
        load = 2 * cf.ALPHA * np.sqrt(R * depth) * K * depth  # Eq. 40
        return Limits(R, K, l_r, depth, load, load, fixed=True)
    weight = values["support.weight"]
    a_0 = np.cbrt(1.5 * R * (weight / K))
    delta_0 = a_0 * (a_0 / (2 * R))
    lift = weight + values.get("support.stiffness", 0.0) * delta_0
    return Limits(R, K, l_r, delta_0, weight, lift, fixed=False)


def critical_velocity(scene: Limits, retardation_time: Array) -> Array:
    """Return V*, where the two asymptotes of the friction coefficient meet, exactly (theorem F5).

    V* = alpha K sqrt(R delta)/C for a fixed indenter, alpha^(2/3) (R K^2 W)^(1/3)/C otherwise, with
    alpha = 2 sqrt(2)/3 (Eqs. 47, 48 with their coefficients).
    """
    if scene.fixed:
        return cf.ALPHA * np.sqrt(scene.radius * scene.static_depth) / retardation_time
    length = np.cbrt(scene.radius * (scene.lift_load / scene.stiffness))
    return cf.CRITICAL_DRIVE_NUMBER * length / retardation_time


def peak(scene: Limits, retardation_time: Array) -> tuple[Array, Array]:
    """Return velocity and friction coefficient at the maximum of a dead weight (theorem F3)."""
    length = np.cbrt(scene.radius * (scene.static_load / scene.stiffness))  # (R W/K)^(1/3)
    velocity = cf.PEAK_DRIVE_NUMBER * length / retardation_time
    return velocity, cf.PEAK_FRICTION * length / scene.radius


def low(scene: Limits) -> dict[str, Array]:
    """Return the asymptotes for l_r << a: Eqs. 38, 40-42."""
    mu = scene.retardation_length / scene.radius  # Eq. 42: C V/(R K)
    return {
        "depth": scene.static_depth,
        "load": scene.static_load,
        "friction_coefficient": mu,
        "friction_force": scene.static_load * mu,  # Eq. 41 where the load is Eq. 40
    }


def high(scene: Limits) -> dict[str, Array]:
    """Return the asymptotes for l_r >> a: Eqs. 39, 43-46, 49; infinite or zero at V = 0."""
    viscous = scene.stiffness * scene.retardation_length  # C V
    if scene.fixed:
        depth, load = scene.static_depth, viscous * scene.static_depth  # Eq. 43
    else:
        depth, load = scene.lift_load / viscous, scene.lift_load  # Eq. 49
    mu = cf.ALPHA * np.sqrt(depth / scene.radius)  # Eqs. 45, 46
    return {"depth": depth, "load": load, "friction_coefficient": mu, "friction_force": load * mu}


def quantities(scene: Limits, regime: str, side: Array | float = 1.0) -> dict[str, Array]:
    """Return the asymptote of every quantity of steady sliding, by `regime`: ``"low"`` or ``"high"``.

    `side` is -1 for a reversed drive. At V = 0 those for high velocity are infinite or zero.
    """
    slow = regime == "low"
    found = low(scene) if slow else high(scene)
    depth, l_r = found["depth"], scene.retardation_length
    a = np.sqrt(2.0 * scene.radius * depth)
    pressure = scene.stiffness * depth
    return {
        "depth": depth,
        "half_length": a,
        "retardation_length": l_r,
        "leading_edge": -side * a,
        "trailing_edge": side * a if slow else 0.0 * a,  # Eqs. 38, 39
        "load": found["load"],
        "friction_force": side * found["friction_force"] + 0.0,  # no negative zero
        "friction_coefficient": side * found["friction_coefficient"] + 0.0,
        "peak_pressure": pressure if slow else pressure * (2.0 * l_r / a),
        "dissipated_in_contact": np.ones_like(a),
    }


def low_errors(scene: Limits, state: SteadyState) -> dict[str, Array]:
    """Return asymptote/exact - 1 of each quantity for l_r << a, given the exact state."""
    l, q = _ratios(state)
    mu = cf.error_l1(l, q)
    if scene.fixed:
        depth = np.zeros_like(l)
        load, friction = cf.error_load_low(l, q), cf.error_friction_force_low(l, q)
    else:
        depth = scene.static_depth / state.depth - 1
        load = scene.static_load / state.load - 1
        friction = _compound(load, mu)
    length = _root(depth)
    return {
        **_shared(depth, length, load, friction, mu, q),
        "trailing_edge": _compound(length, 1 / q - 1),
        "peak_pressure": _compound(depth, 1 / cf.peak_pressure_factor(l) - 1),
    }


def high_errors(scene: Limits, state: SteadyState) -> dict[str, Array]:
    """Return asymptote/exact - 1 of each quantity for l_r >> a, given the exact state at V > 0."""
    l, q = _ratios(state)
    if scene.fixed:
        depth, load = np.zeros_like(l), cf.error_load_high(q)
        mu, friction = cf.error_l2_fixed(q, l), cf.error_friction_force_high(q)
    else:
        # The spring has not yet let go of k_s delta: lift_load - W = k_s delta.
        load = (
            (scene.lift_load - scene.static_load) * (state.depth / scene.static_depth) / state.load
        )
        depth = _compound(cf.error_depth_high(l, q), load)
        mu = _compound(cf.error_l2_dead_weight(l, q), _root(load))
        friction = _compound(load, mu)
    length = _root(depth)
    return {
        **_shared(depth, length, load, friction, mu, q),
        "trailing_edge": -np.ones_like(l),  # Eq. 39 is zero
        "peak_pressure": _compound(length, 2 * l / cf.peak_pressure_factor(l) - 1),
    }


def _shared(
    depth: Array, length: Array, load: Array, friction: Array, mu: Array, q: Array
) -> dict[str, Array]:
    return {
        "depth": depth,
        "half_length": length,
        "retardation_length": np.zeros_like(q),
        "leading_edge": length,
        "load": load,
        "friction_force": friction,
        "friction_coefficient": mu,
        "dissipated_in_contact": 1 / cf.dissipated_in_contact(q) - 1,
    }


def _root(error: Array) -> Array:
    """Return the relative error of a square root: sqrt(1 + error) - 1."""
    return error / (1 + np.sqrt(1 + error))


def _ratios(state: SteadyState) -> tuple[Array, Array]:
    half = np.asarray(state.half_length)
    return state.retardation_length / half, np.abs(state.trailing_edge) / half


def _compound(first: Array, second: Array) -> Array:
    """Return the relative error of a product: (1 + first)(1 + second) - 1."""
    return first + second + first * second


@dataclass(frozen=True)
class Row:
    """One asymptote of one quantity, as it is listed for a support."""

    name: str
    quantity: str
    regime: str
    equation: int | None
    formula: str


L1 = Row("L1", "friction_coefficient", "low", 42, "C V/(R K)")
L2 = Row("L2", "friction_coefficient", "high", 46, "alpha sqrt(W/(R C V))")
DEPTH_LOW = Row("depth, low V", "depth", "low", None, "delta_0 = (3 W/(4 K sqrt(2 R)))^(2/3)")
DEPTH_HIGH = Row("depth, high V", "depth", "high", 49, "W/(C V)")
ROWS = {
    "fixed": (
        L1,
        Row("L2", "friction_coefficient", "high", 45, "alpha sqrt(delta/R)"),
        Row("load, low V", "load", "low", 40, "2 alpha R^(1/2) K delta^(3/2)"),
        Row("load, high V", "load", "high", 43, "C V delta"),
        Row("friction, low V", "friction_force", "low", 41, "2 alpha R^(-1/2) C V delta^(3/2)"),
        Row("friction, high V", "friction_force", "high", 44, "alpha R^(-1/2) C V delta^(3/2)"),
    ),
    "dead-weight": (L1, L2, DEPTH_LOW, DEPTH_HIGH),
    "suspended": (
        L1,
        Row("L2", "friction_coefficient", "high", None, "alpha sqrt((M g + k_s delta_0)/(R C V))"),
        Row("depth, low V", "depth", "low", None, "delta_0 = (3 M g/(4 K sqrt(2 R)))^(2/3)"),
        Row("depth, high V", "depth", "high", None, "(M g + k_s delta_0)/(C V)"),
        Row("load, low V", "load", "low", None, "M g"),
        Row("load, high V", "load", "high", None, "M g + k_s delta_0"),
    ),
}
"""What is listed for each support; W = M g is the load of a dead weight."""
