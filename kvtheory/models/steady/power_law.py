r"""Steady sliding of a power law h = slope |x|^n/(n L^(n-1)) and of a wedge, n = 1: closed forms, one root.

Lengths are scaled by the half length a = L (n delta/(slope L))^(1/n) of the contact at rest, so that n
and l = l_r/a determine the contact (derivations "F19" and "wedge"). With c = n l the trailing edge
q = x_TE/a is the root of q^n + c q^(n-1) = 1 (derivation "F19-edge"), in ln q the root of the increasing and
convex function

    G(t) = (n - 1) t + ln(e^t + c),

so that Newton's method descends to it from q = min(1, c^(-1/(n-1))), where G >= 0. As G''/(2 G') <= 1/2,
the error e of ln q becomes at most e^2/2. Each step multiplies q, to preserve its digits.

An indenter that can move finds its depth from the balance of forces in units of the static state,

    f(s) + kappa (s^n - 1) = 1,    s = a/a_0 in (0, 1],    d = delta/delta_0 = s^n,

whose logarithm has a slope between n and n + 1 in ln s (derivation "F19-balance"); for a wedge s is in
closed form.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf
from kvtheory.theory.powers import root

Array = NDArray[np.float64]

MOST_STEPS, EDGE_STEPS, LAST_STEP = 40, 80, 1e-8
"""Most iterations for the depth, of which three to six are needed, and for the edge: about seven, and
ln(1/(n - 1)) more if n is close to 1. After a step as small as the last the error, of the order of its
square, is below rounding."""
LAST_RESIDUAL = 8 * 2.0**-52
"""Rounding of the residual of the edge, below which iteration does not improve it."""
RELATIVE_ERROR = 36 * float(np.finfo(float).eps)
"""8.0e-15, twice the largest error found by comparison with more than 50 digits."""
CERTIFICATE = Certificate(
    kind="estimated",
    statement="closed forms and well-conditioned roots in double precision; twice the worst difference "
    "to ball arithmetic on thousands of scenes over 24 decades of velocity and exponents from 1 to 24. "
    "The trailing edge is less certain by d ln x_TE/d ln V, which grows as 1/(n - 1) for n close to 1",
    relative_error=dict.fromkeys(STEADY_UNITS, RELATIVE_ERROR),
)
OWN_ERRORS = ("trailing_edge",)


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities at |V| in the order of `STEADY_UNITS`, and the error of the trailing edge.

    W = K delta a w, F = K delta^2 phi and so on (derivation F19).
    """
    K, support = scene.foundation.stiffness, scene.support
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    # Full arrays: NumPy rounds a power differently where one exponent stands for all.
    slope, L, n = (np.array(np.broadcast_to(x, scene.shape)) for x in scene.indenter.power)
    if scene.held:
        delta = support.depth
        a = L * root(n * delta / (slope * L), n)
    else:
        a_0 = L * root((n + 1.0) * (support.weight / K) / (2.0 * slope * L * L), n + 1.0)
        delta_0 = support.weight / (K * a_0 * cf.power_law_static_load(n))  # F19-low
        s, depth = scaled_root(n, l_r / a_0, support.spring * (delta_0 / support.weight))
        delta, a = depth * delta_0, s * a_0
    l = l_r / a
    q, Q = trailing_edge(n, l)
    pressure, x_te = K * delta, a * q
    return (
        delta, a, l_r, -a, x_te,
        pressure * a * cf.power_law_load(n, l, q, Q),
        pressure * delta * cf.power_law_friction_force(n, l, q, Q),
        (delta / a) * cf.power_law_friction_coefficient(n, l, q, Q),
        pressure * cf.power_law_peak_pressure(n, l),
        cf.power_law_dissipated_in_contact(n, l, q, Q),
        _edge_error(n, l, q, Q, x_te),
    )  # fmt: skip


def scaled_root(exponent: Array, drive_number: Array, support_number: Array) -> tuple[Array, Array]:
    """Solve f(s) + kappa (s^n - 1) = 1; return s = a/a_0 in (0, 1] and delta/delta_0 = s^n.

    Newton for the logarithm of f + kappa s^n, from between its limits. Depth is (1 + kappa)/(f/s^n +
    kappa): so rounding of s is not multiplied by n.
    """
    n, lam, kappa = exponent, drive_number, support_number
    whole = 1.0 + kappa
    s = (whole / (kappa + np.hypot(1.0, lam / cf.power_law_static_load(n)))) ** (1.0 / n)
    depth, active = s, np.full(s.shape, True)
    for _ in range(MOST_STEPS):
        q, _Q = trailing_edge(n, lam / s)
        power = s**n
        total = cf.power_law_scaled_load(n, s, s * q, lam) + kappa * power
        slope = s * cf.power_law_scaled_load_slope(n, s, s * q, lam) + n * kappa * power
        step = np.log(total / whole) * (total / slope)
        better = power * (whole / total) * np.exp((slope / total - n) * step)
        depth, s = np.where(active, better, depth), np.where(active, s * np.exp(-step), s)
        active &= np.abs(step) > LAST_STEP
        if not active.any():
            break
    peeling = lam * (1.5 * lam + kappa) < whole  # of a wedge; then lam < 1
    slow = cf.wedge_scaled_depth_peeling(kappa, np.minimum(lam, 1.0))
    wedge = np.where(peeling, slow, cf.wedge_scaled_depth_peeled(kappa, lam))
    return np.where(n > 1.0, s, wedge), np.where(n > 1.0, depth, wedge)


def _edge_error(n: Array, l: Array, q: Array, Q: Array, x_te: Array) -> Array:
    """Return the error of the trailing edge, that of l times -d ln q/d ln l; none at the tip of a wedge."""
    with np.errstate(divide="ignore", invalid="ignore"):
        amplified = RELATIVE_ERROR * (1.0 + n * l * Q / ((n - 1.0) + q * Q))
    at_tip = (n == 1.0) & (l > 1.0 + RELATIVE_ERROR)
    lost = x_te < np.finfo(float).tiny
    return np.where(at_tip, 0.0, np.where(lost, np.inf, amplified))


def trailing_edge(exponent: Array, number: Array) -> tuple[Array, Array]:
    """Return q = x_TE/a and Q = q^(n-1) for n >= 1 and l = l_r/a >= 0.

    For n = 1, the wedge, q = max(0, 1 - l) and Q is its limit, min(1, 1/l). Where q is below the range
    of double precision it is 0, and Q is still correct.

    >>> q, Q = trailing_edge(np.array([2.0, 1.0, 1.0]), np.array([0.75, 0.25, 4.0]))
    >>> q.round(12).tolist(), Q.round(12).tolist()
    ([0.5, 0.75, 0.0], [0.5, 1.0, 0.25])
    """
    c, m = exponent * number, exponent - 1.0
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        start = np.where(c > 1.0, c ** (-1.0 / m), 1.0)
        active = (m > 0.0) & (start >= np.finfo(float).tiny)  # below, the digits are lost already
        q = np.where(active, start, 0.0)
        for _ in range(EDGE_STEPS):
            residual = np.log(q**m * (q + c))
            step = np.where(active, residual / (m + q / (q + c)), 0.0)
            q = q * np.exp(-step)
            # Each is iterated separately, so that the result does not depend on the others in the array.
            active &= (np.abs(step) > LAST_STEP) & (np.abs(residual) > LAST_RESIDUAL)
            if not active.any():
                break
        q = np.where(m > 0.0, q, np.maximum(0.0, 1.0 - number))
        return q, 1.0 / (q + c)
