r"""Steady sliding of a parabolic indenter: closed forms and one scalar root.

Lengths are scaled by the half length a of the stationary contact, so that one number, l = l_r/a,
determines the contact (Eqs. 26-29, theorem F1). A fixed indenter needs nothing else. For an indenter
that can move, the depth follows from the balance of forces, in units of the static depth delta_0, half
length a_0 and weight,

    f_z(s) + kappa (s^2 - 1) = 1,    s = a/a_0 in (0, 1],    d = delta/delta_0 = s^2,

with kappa = 0 for a dead weight (theorem "scaled-load"). Each term of f_z is positive and
d ln f_z/d ln s lies between 2 and 3, so that rounding moves the depth by a few units in the last
place at most, over any range of velocity.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.steady import closed_forms as cf
from kvtheory.models.steady.blockwise import cube_root, evaluate
from kvtheory.results import STEADY_UNITS, Certificate, SteadyState

HALLEY_STEPS = 2
"""The first guess is within 3 % of the root; cubic convergence gives 1e-5, then all digits."""

HELD, CARRIED = (
    Certificate(
        kind="estimated",
        statement="closed forms and a well-conditioned root in double precision; the sum of what every "
        "operation may round, to first order, confirmed by ball arithmetic on more than ten thousand "
        "scenes over 24 decades of velocity",
        relative_error=dict.fromkeys(STEADY_UNITS, ulps * float(np.finfo(float).eps)),
    )
    for ulps in (9, 33)
)
"""Errors at a depth, 2.0e-15, and at a load, 7.3e-15, on any processor whose hypot is within one unit in the
last place."""

Array = NDArray[np.float64]


def at_depth(
    radius: ArrayLike,
    stiffness: ArrayLike,
    retardation_time: ArrayLike,
    velocity: ArrayLike,
    depth: ArrayLike,
) -> SteadyState:
    """Return the steady state at a given indentation depth (the paper's FI model).

    Parameters
    ----------
    radius, stiffness, retardation_time, velocity, depth
        R in m, K in N/m^3, tau in s, V in m/s (any sign, or zero), delta in m; they broadcast.

    Returns
    -------
    SteadyState
        With W = K delta a w(q), F = (a/R) W phi/w and so on (theorem F1); the error of each
        quantity is in its certificate.

    Raises
    ------
    FloatingPointError
        If a value leaves the range of double precision.

    Examples
    --------
    >>> state = at_depth(0.01, 1e10, 0.1, 0.1, 3e-4)
    >>> print(f"{state.load:.6g} {state.friction_force:.6g} {state.trailing_edge:.6g}")
    35344.6 5344.58 0.00029563
    """
    given = radius, stiffness, retardation_time, velocity, depth
    return evaluate(_contact, given, velocity, HELD)


def at_load(
    radius: ArrayLike,
    stiffness: ArrayLike,
    retardation_time: ArrayLike,
    velocity: ArrayLike,
    weight: ArrayLike,
    spring: ArrayLike = 0.0,
) -> SteadyState:
    """Return the steady state under a weight (the paper's MI model), on a spring or without.

    The weight M g is in N/m, the stiffness of the suspension in N/m^2: it is relaxed at the static depth,
    and 0 for a dead weight. The other arguments, and the state, are as in `at_depth`.

    Examples
    --------
    >>> state = at_load(0.01, 1e10, 0.1, 0.1, 9806.65)
    >>> print(f"{1e3 * state.depth:.6f} mm, mu = {state.friction_coefficient:.6f}")
    0.089661 mm, mu = 0.085709
    """
    given = radius, stiffness, retardation_time, velocity, weight, spring
    return evaluate(_balance, given, velocity, CARRIED)


def scaled_root(drive_number: Array, support_number: Array) -> Array:
    """Solve f_z(s) + kappa (s^2 - 1) = 1 for s = a/a_0 in (0, 1], by Halley's method.

    The first guess interpolates between the limits s = 1 at lambda = 0 and s^2 (3/4 lambda + kappa)
    = 1 + kappa at lambda -> oo.
    """
    kappa = support_number
    s = np.sqrt((1.0 + kappa) / (kappa + np.hypot(1.0, 0.75 * drive_number)))
    for _ in range(HALLEY_STEPS):
        residual = cf.scaled_load(s, drive_number) + kappa * (s * s - 1.0) - 1.0
        slope = cf.scaled_load_slope(s, drive_number) + 2.0 * kappa * s
        curvature = cf.scaled_load_curvature(s, drive_number) + 2.0 * kappa
        s = s - residual / (slope - 0.5 * residual * (curvature / slope))
    return s


def _balance(
    R: Array, K: Array, tau: Array, V: Array, weight: Array, spring: Array
) -> tuple[Array, ...]:
    return _contact(R, K, tau, V, depth_at_load(R, K, tau, V, weight, spring))


def depth_at_load(R: Array, K: Array, tau: Array, V: Array, weight: Array, spring: Array) -> Array:
    """Return the depth at which the load is carried, all arguments as in `at_load`."""
    a_0 = cube_root(1.5 * R * (weight / K))  # weight = (4/3) K a_0 delta_0, delta_0 = a_0^2/(2 R)
    delta_0 = a_0 * (a_0 / (2.0 * R))
    s = scaled_root(np.abs(V) * tau / a_0, spring * (delta_0 / weight))
    return s * s * delta_0


def _contact(R: Array, K: Array, tau: Array, V: Array, delta: Array) -> tuple[Array, ...]:
    """Return the quantities in the order of `STEADY_UNITS`."""
    a = np.sqrt(2.0 * R * delta)  # Eq. 28
    l_r = np.abs(V) * tau  # Eq. 29
    l = l_r / a
    q = cf.trailing_edge_ratio(l)
    side = np.where(V < 0.0, -1.0, 1.0)  # a reversed drive is the mirror image
    pressure = K * delta
    slope = a / R
    return (
        delta,
        a,
        l_r,
        -side * a,  # Eq. 26
        side * a * q,  # Eq. 27
        pressure * a * cf.load_factor(q),
        side * pressure * a * (slope * cf.friction_force_factor(l, q)),
        side * slope * cf.friction_coefficient_factor(l, q),
        pressure * cf.peak_pressure_factor(l),
        cf.dissipated_in_contact(q),
    )
