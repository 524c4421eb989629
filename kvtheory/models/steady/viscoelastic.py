r"""Steady sliding of a parabola on any linear viscoelastic foundation: one scalar root.

An element that has travelled a distance X in the contact has been compressed at the rate u' = (a - X)/R, so
that p = int G((X - X')/V) u' dX'. The length c of the contact and the moments P, Q, D, E of the relaxation
function over it (`kvtheory.theory.laws`) hold the whole steady state (theorem F17): with A = P + Q and
eta = (P - Q)/(2 A)

    a = c P/A,   x_TE = c Q/A,   W = (c^3/R) (D + eta P),   F = (c^4/R^2) (E + eta^2 P).

The contact grows with the depth and with the load (theorem F17-growth),

    a' = 1 - P G/A^2 between 1/2 and 1,   W' = a' c^2 P/R,

G being the value at the trailing edge, so that c is one root, by Halley's method.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady.blockwise import converge, cube_root
from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.scene.foundations import Foundation, FractionalKelvinVoigt
from kvtheory.scene.model import Scene
from kvtheory.theory.laws import RELATIVE_ERROR, Fractional, Law, Moments, Prony

Array = NDArray[np.float64]

MOST_STEPS = 12
"""Most iterations; three to six are needed."""
LAST_STEP = 1e-6
"""A step as small as this leaves an error of its cube."""
PEAK_STEP, PEAK_STEPS = 1e-8, 80
"""Tolerance and steps for the position of the peak, whose value has an error of second order; bisection alone
would need as many steps."""
CERTIFICATE = Certificate(
    kind="estimated",
    statement="moments of the relaxation function without cancellation and a well-conditioned root in "
    "double precision; twice the worst difference to 50 digits on ten thousand scenes of 1 to 20 arms "
    "over ten decades of relaxation times, and of fractional orders",
    relative_error=dict.fromkeys(STEADY_UNITS, RELATIVE_ERROR),
)
HELD = CARRIED = CERTIFICATE
"""At a depth, and at a load."""
OWN_ERRORS = ("dissipated_in_contact",)


def law(scene: Scene) -> Law:
    """Return the law of the foundation along the contact, in the shape of the scene."""

    def full(x: Any) -> Array:
        return np.broadcast_to(x, scene.shape)

    foundation, V = scene.foundation, np.abs(full(scene.drive.final_velocity))
    K = full(foundation.stiffness)
    if isinstance(foundation, FractionalKelvinVoigt):
        return Fractional(K, foundation.retardation_time, foundation.order).over(V)
    damping = full(foundation.damping) if isinstance(foundation, Foundation) else None
    arms = [(full(arm.stiffness), full(arm.relaxation_time)) for arm in foundation.arms]
    stiffness, time = np.reshape(arms, (-1, 2, *scene.shape)).swapaxes(0, 1)
    return Prony(K, stiffness, time, damping).over(V)


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities in the order of `STEADY_UNITS`, and the error of the last one.

    Kelvin-Voigt is the springpot of order 1, and an arm that is stiff and fast:

    >>> from kvtheory.scene import GeneralizedMaxwell
    >>> springpot = Scene(foundation=FractionalKelvinVoigt([1e10], 0.1, 1.0))
    >>> arm = Scene(foundation=GeneralizedMaxwell([1e10], arms=[(1e19, 1e-10)]))
    >>> print(f"{quantities(springpot)[7][0]:.6f} {quantities(arm)[7][0]:.6f}")
    0.085709 0.085709
    """
    row = law(scene)
    return state(scene, row, contact_length(scene, row))


def contact_length(scene: Scene, row: Law) -> Array:
    """Return the length of the contact, on every support."""
    support, R = scene.support, scene.indenter.radius
    if scene.held:
        return length_at_half(row, np.broadcast_to(np.sqrt(2.0 * R * support.depth), scene.shape))
    return _length_at_load(row, R, support.weight, support.spring)


def length_at_half(row: Law, a: Array) -> Array:
    """Return the length of the contact whose half length at rest is a: between a and 2 a."""

    def step(c: Array) -> Array:
        M = row.moments(c)
        share, slope, bend = growth(M)
        off = share - a / c
        step = off / (slope - 0.5 * off * (bend / slope))  # of c, over c
        return -np.log1p(-np.clip(step, 1.0 - 2.0 * a / c, 1.0 - a / c))

    return converge(step, 1.5 * a, LAST_STEP, MOST_STEPS)


def _length_at_load(row: Law, R: Array, load: Array, spring: Array) -> Array:
    """Return the length of the contact under a load, on a spring that is relaxed at the static depth.

    Halley's method for ln(W + k_s delta) against ln c, from the contact at rest.
    """
    a_0 = cube_root(1.5 * R * (load / row.K))
    wanted = 1.0 + spring * (a_0 * a_0 / (2.0 * R)) / load

    def step(c: Array) -> Array:
        M = row.moments(c)
        share, slope, bend = growth(M)
        size = c * c * (c / (R * load))
        k = spring * (c / (R * load)) * c
        total = size * (M.D + (share - 0.5) * M.P) + 0.5 * k * share * share
        rise = (slope * (size * M.P + k * share)) / total
        curve = size * (bend * M.P + slope * (M.P + M.Q)) + k * (slope * slope + share * bend)
        off = np.log(total / wanted)
        return off / (rise - 0.5 * off * ((curve / total + rise) / rise - rise))

    return converge(step, 2.0 * a_0, LAST_STEP, MOST_STEPS)


def growth(M: Moments) -> tuple[Array, Array, Array]:
    """Return a/c, a' = da/dc and c a''."""
    A = M.P + M.Q
    share, end = M.P / A, M.end / A
    return share, 1.0 - share * end, 2.0 * share * end * end - end - share * (M.end_slope / A)


def state(scene: Scene, row: Law, c: Array) -> tuple[Array, ...]:
    """Return the quantities of a parabola from the length of its contact.

    A given depth is kept to the last bit; otherwise it follows from the length of the contact.
    """
    R, V, delta = scene.indenter.radius, scene.drive.final_velocity, scene.support.depth
    M = row.moments(c)
    A = M.P + M.Q
    a = c * (M.P / A) if delta is None else np.sqrt(2.0 * R * delta)
    delta = a * (a / (2.0 * R)) if delta is None else delta
    eta = 0.5 * (M.P - M.Q) / A
    side = np.where(V < 0.0, -1.0, 1.0)  # a reversed drive is the mirror image
    slope = c / R
    load, work = M.D + eta * M.P, M.E + eta * eta * M.P
    inside, error = row.dissipated(c, eta, np.where(work > 0.0, work, 1.0))
    return (
        delta,
        a,
        np.abs(V) * scene.foundation.retardation_time,
        -side * a,
        side * c * (M.Q / A) + 0.0,
        c * c * slope * load,
        side * (c * slope) ** 2 * work + 0.0,
        side * slope * (work / load) + 0.0,
        _peak(R, row, a),
        np.where(work > 0.0, inside, 1.0),
        error,
    )


def _peak(R: Array, row: Law, a: Array) -> Array:
    """Return the greatest pressure: p' = (a G - X mean G)/R falls, and has one root at X <= a.

    Newton's method for ln(a G/(X mean G)) against ln X, and bisection where its steps are long.
    """
    low, high = np.log(row.least_peak(a)), np.log(a)
    y, active = high, np.full(a.shape, True)
    for _ in range(PEAK_STEPS):
        X = np.exp(y)
        end, end_slope, mean = row.modulus(X)
        off = np.log(a * (end / (X * mean)))
        low, high = np.where(off > 0.0, y, low), np.where(off < 0.0, y, high)
        new = y - off / (end_slope / end - end / mean)
        short = np.abs(new - y) <= 0.5 * (high - low)  # else the steps may go to and fro
        new = np.where(short & (new >= low) & (new <= high), new, 0.5 * (low + high))
        active, y = active & (np.abs(new - y) >= PEAK_STEP), np.where(active, new, y)
        if not active.any():
            break
    X = np.exp(y)
    M = row.moments(X)
    peak: Array = (a * (M.P + M.Q) - X * M.P) * (X / R)
    return peak
