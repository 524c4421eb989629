r"""Steady sliding of a parabola on any linear viscoelastic foundation: one scalar root.

At a distance X behind the leading edge an element is compressed at the rate u' = (a - X)/R, so that
p = int G((X - X')/V) u' dX'. The length c of the contact and the moments P, Q, D, E of the relaxation
function over it (`kvtheory.theory.laws`) give the whole steady state (theorem F17): with A = P + Q and
eta = (P - Q)/(2 A)

    a = c P/A,   x_TE = c Q/A,   W = (c^3/R) (D + eta P),   F = (c^4/R^2) (E + eta^2 P).

The contact grows with the depth and with the load (theorem F17-growth),

    a' = 1 - P G/A^2 between 1/2 and 1,   W' = a' c^2 P/R,

with G at the trailing edge; c is therefore the only root, found by Halley's method.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.scene.model import Scene
from kvtheory.theory.laws import RELATIVE_ERROR, Fractional, Law, Moments, Prony
from kvtheory.theory.powers import converge, cube_root

Array = NDArray[np.float64]

MOST_STEPS, LAST_STEP = 12, 1e-6
"""Most iterations, of which three to six are needed; a step as small as this leaves an error of its cube."""
PEAK_STEP, PEAK_STEPS = 1e-8, 80
"""Tolerance and steps for the position of the peak, whose value has an error of second order."""
CERTIFICATE = Certificate(
    kind="estimated",
    statement="moments of the relaxation function without cancellation and a well-conditioned root in "
    "double precision; twice the worst difference to 50 digits on ten thousand scenes of 1 to 20 arms "
    "over ten decades of relaxation times, and of fractional orders",
    relative_error=dict.fromkeys(STEADY_UNITS, RELATIVE_ERROR),
)
OWN_ERRORS = ("dissipated_in_contact",)


def law(scene: Scene) -> Law:
    """Return the law of the foundation along the contact, in the shape of the scene."""

    def full(x: Any) -> Array:
        return np.broadcast_to(x, scene.shape)

    foundation: Any = scene.foundation
    V = np.abs(full(scene.drive.final_velocity))
    K = full(foundation.stiffness)
    if foundation.springpot:
        return Fractional(K, foundation.retardation_time, foundation.order).over(V)
    damping = full(foundation.damping) if np.any(foundation.damping) else None
    arms = [(full(arm.stiffness), full(arm.relaxation_time)) for arm in foundation.arms]
    stiffness, time = np.reshape(arms, (-1, 2, *scene.shape)).swapaxes(0, 1)
    return Prony(K, stiffness, time, damping).over(V)


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities at |V| in the order of `STEADY_UNITS`, and the error of the last one."""
    row = law(scene)
    return state(scene, row, contact_length(scene, row))


def contact_length(scene: Scene, row: Law) -> Array:
    """Return the length of the contact, at a load by Halley's method for ln(W + k_s delta) against ln c."""
    R, load, spring = scene.indenter.radius, scene.support.weight, scene.support.spring
    if scene.held:
        a = np.sqrt(2.0 * R * scene.support.depth)
        return length_at_half(row, np.broadcast_to(a, scene.shape))
    a_0 = cube_root(1.5 * R * (load / row.K))
    target = 1.0 + spring * (a_0 * a_0 / (2.0 * R)) / load

    def step(c: Array) -> Array:
        M = row.moments(c)
        share, slope, bend = growth(M)
        size = c * c * (c / (R * load))
        k = spring * (c / (R * load)) * c
        total = size * (M.D + (share - 0.5) * M.P) + 0.5 * k * share * share
        rise = (slope * (size * M.P + k * share)) / total
        curve = size * (bend * M.P + slope * (M.P + M.Q)) + k * (slope * slope + share * bend)
        off = np.log(total / target)
        return off / (rise - 0.5 * off * ((curve / total + rise) / rise - rise))

    return converge(step, 2.0 * a_0, LAST_STEP, MOST_STEPS)


def length_at_half(row: Law, a: Array) -> Array:
    """Return the length of the contact whose half length at rest is a: between a and 2 a."""

    def step(c: Array) -> Array:
        share, slope, bend = growth(row.moments(c))
        off = share - a / c
        step = off / (slope - 0.5 * off * (bend / slope))  # of c, over c
        return -np.log1p(-np.clip(step, 1.0 - 2.0 * a / c, 1.0 - a / c))

    return converge(step, 1.5 * a, LAST_STEP, MOST_STEPS)


def growth(M: Moments) -> tuple[Array, Array, Array]:
    """Return a/c, a' = da/dc and c a''."""
    A = M.P + M.Q
    share, end = M.P / A, M.end / A
    return share, 1.0 - share * end, 2.0 * share * end * end - end - share * (M.end_slope / A)


def state(scene: Scene, row: Law, c: Array) -> tuple[Array, ...]:
    """Return the quantities of a parabola from its contact length; a given depth is kept exactly."""
    R, delta = scene.indenter.radius, scene.support.depth
    M = row.moments(c)
    A, eta, slope = M.P + M.Q, M.eta, c / R
    a = c * (M.P / A) if delta is None else np.sqrt(2.0 * R * delta)
    load, work = M.D + eta * M.P, M.E + eta * eta * M.P
    inside, error = row.dissipated(M, c, np.where(work > 0.0, work, 1.0))
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    return (
        a * (a / (2.0 * R)) if delta is None else delta, a, l_r, -a, c * (M.Q / A),
        c * c * slope * load, (c * slope) ** 2 * work, slope * (work / load), _peak(R, row, a),
        np.where(work > 0.0, inside, 1.0), error,
    )  # fmt: skip


def _peak(R: Array, row: Law, a: Array) -> Array:
    """Return the greatest pressure, the one root of p' = (a G - X mean G)/R at X <= a."""
    low, high = np.log(row.least_peak(a)), np.log(a)
    y, active = high, np.full(a.shape, True)
    for _ in range(PEAK_STEPS):
        X = np.exp(y)
        end, end_slope, mean = row.modulus(X)
        off = np.log(a * (end / (X * mean)))
        low, high = np.where(off > 0.0, y, low), np.where(off < 0.0, y, high)
        new = y - off / (end_slope / end - end / mean)
        short = np.abs(new - y) <= 0.5 * (high - low)
        new = np.where(short & (new >= low) & (new <= high), new, 0.5 * (low + high))
        active, y = active & (np.abs(new - y) >= PEAK_STEP), np.where(active, new, y)
        if not active.any():
            break
    X = np.exp(y)
    M = row.moments(X)
    peak: Array = (a * (M.P + M.Q) - X * M.P) * (X / R)
    return peak
