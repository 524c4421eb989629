r"""Steady sliding of a parabola on any linear viscoelastic foundation: one scalar root.

An element that has travelled a distance X in the contact has been compressed at the rate u' = (a - X)/R, so
that p = int G((X - X')/V) u' dX'. With the length c of the contact, w = (distance to the trailing edge)/c and
g(w) = G(c w/V), four moments of the relaxation function hold the whole steady state (theorem F17):

    P = int g (1 - w),   Q = int g w,   D = int g w (1 - w)/2,   E = int g (1 - 3 w + 2 w^3)/12,

all over 0 < w < 1, none negative if G falls and is convex; and with A = P + Q and eta = (P - Q)/(2 A)

    a = c P/A,   x_TE = c Q/A,   W = (c^3/R) (D + eta P),   F = (c^4/R^2) (E + eta^2 P).

No sum cancels. The contact grows with the depth and with the load (theorem F17-growth),

    a' = 1 - P G/A^2 between 1/2 and 1,   W' = a' c^2 P/R,

G being the value at the trailing edge, so that c is one root, by Halley's method.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady.blockwise import converge, cube_root
from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.scene.foundations import FractionalKelvinVoigt
from kvtheory.scene.indenters import power
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]

MOST_STEPS = 12
"""Most iterations; three to six are needed."""
LAST_STEP = 1e-6
"""A step as small as this leaves an error of its cube."""
PEAK_STEP, PEAK_STEPS = 1e-8, 80
"""Tolerance and steps for the position of the peak, whose value has an error of second order; bisection alone
would need as many steps."""
FRACTION_TERMS = 10
"""Terms of the continued fraction for z <= 4: the next one is below rounding."""
FAR = 1e150
"""z of an arm that relaxes immediately: its square is still finite."""

RELATIVE_ERROR = 24 * float(np.finfo(float).eps)
"""5.3e-15, twice the worst that the comparison with 50 digits has shown."""

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


class Moments(NamedTuple):
    """Moments of the relaxation function over a contact of length c, in N/m^3."""

    P: Array
    Q: Array
    D: Array
    E: Array
    end: Array
    """G at the trailing edge."""
    end_slope: Array
    """c dG/dc there."""


class Prony:
    """G = K + sum K_i e^(-X/l_i), l_i = |V| tau_i; one row of `stiffness` and `length` for each arm."""

    def __init__(self, K: Array, V: Array, arms: Sequence[Array]) -> None:
        moving = V != 0.0
        self.K = K
        self.stiffness = np.stack(arms[0::2]) * moving
        self.length = np.where(moving, np.abs(V) * np.stack(arms[1::2]), 1.0)

    def moments(self, c: Array) -> Moments:
        """Return the moments over a contact of length c."""
        K, z = self.K, np.minimum(c / self.length, FAR)
        P, Q, D, E, end = exponential_moments(z)
        rows = self._sum(P), self._sum(Q), self._sum(D), self._sum(E)
        return Moments(
            *(0.5 * K + rows[0], 0.5 * K + rows[1], K / 12.0 + rows[2], rows[3]),
            *(K + self._sum(end), -self._sum(z * end)),
        )

    def dissipated(self, c: Array, eta: Array, work: Array) -> tuple[Array, Array]:
        """Return the share of the work that is lost in the contact, all terms positive, and its error."""
        z = np.minimum(c / self.length, FAR)
        P, Q, _, E, _ = exponential_moments(z)
        A, B = P + Q, 0.5 * (P - Q)
        lost = E - 0.5 * B * B + eta * (A * B + eta * (B + 0.5 * A * z * P))
        return self._sum(lost) / work, np.full_like(work, RELATIVE_ERROR)

    def response(self, X: Array) -> tuple[Array, Array, Array]:
        """Return G, X dG/dX and the mean of G up to X."""
        z = np.minimum(X / self.length, FAR)
        end = np.exp(-z)
        mean = -np.expm1(-z) / np.maximum(z, np.finfo(float).tiny)
        return self.K + self._sum(end), -self._sum(z * end), self.K + self._sum(mean)

    def least_peak(self, a: Array) -> Array:
        """Return a distance at which the pressure still rises, because G has hardly decreased."""
        return np.minimum(0.25 * a, 0.5 * self.length.min(axis=0))

    def _sum(self, rows: Array) -> Array:
        total: Array = (self.stiffness * rows).sum(axis=0)
        return total


def exponential_moments(z: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return P, Q, D, E and the end value of g = e^(-z w), z >= 0, to a few units in the last place.

    With the modified spherical Bessel functions i_n(z/2) = i_(n-1)(z/2) (z/2) t_(n-1) they are

        A = e^(-z/2) i_0,   P - Q = A y,   D = A t_0/4,   E = A t_0 (z/2) (1 + t_1 (1 + z/2))/24,

    y = (z/2) t_0. For z <= 4 the t_n are continued fractions of positive terms; beyond, t_0 = (coth(z/2)
    - 2/z) 2/z and what follows from it lose no digits (derivation F17-arm).
    """
    x, fall = 0.5 * z, np.expm1(-z)  # e^-z - 1
    near = x <= 2.0
    square, far = np.where(near, x * x, 0.0), np.where(near, 3.0, x)
    t = np.full_like(x, 1.0 / (2.0 * FRACTION_TERMS + 3.0))
    for n in range(FRACTION_TERMS - 1, 0, -1):
        t = 1.0 / (2.0 * n + 3.0 + square * t)
    rest = 1.0 / far + 2.0 * (1.0 + fall) / np.where(near, -1.0, fall)  # 1 - coth x + 1/x
    t_0 = np.where(near, 1.0 / (3.0 + square * t), (1.0 - rest) / far)
    t_1 = np.where(near, t, (1.0 / t_0 - 3.0) / (far * far))
    A = np.where(z > 0.0, -fall / np.where(z > 0.0, z, 1.0), 1.0)
    P = 0.5 * A * (1.0 + x * t_0)
    Q = 0.5 * A * np.where(near, 1.0 - x * t_0, rest)
    return P, Q, 0.25 * A * t_0, A * t_0 * x * (1.0 + t_1 * (1.0 + x)) / 24.0, 1.0 + fall


class Fractional:
    """G = K [1 + (X/l)^(-alpha)/Gamma(1 - alpha)], l = |V| tau: each moment is a Gamma function."""

    def __init__(self, K: Array, V: Array, parameters: tuple[Array, ...]) -> None:
        from scipy.special import rgamma

        tau, self.alpha = parameters
        self.K, self.length = K, np.abs(V) * tau
        self.rgamma = [rgamma(n - self.alpha) for n in range(6)]

    def moments(self, c: Array) -> Moments:
        """Return the moments over a contact of length c."""
        K, alpha, part = self.K, self.alpha, self._part(c)
        _, first, _, third, fourth, fifth = self.rgamma
        return Moments(
            *(0.5 * K + part * third, 0.5 * K + part * (1.0 - alpha) * third),
            *(K / 12.0 + part * 0.5 * (1.0 - alpha) * fourth,),
            *(part * 0.25 * alpha * (3.0 - alpha) * fifth,),
            *(K + part * first, -alpha * part * first),
        )

    def dissipated(self, c: Array, eta: Array, work: Array) -> tuple[Array, Array]:
        """Return the share of the work lost in the contact: that not stored at the trailing edge.

        Towards order 0 almost nothing is lost, and the difference cancels; hence its separate error.
        """
        rest, two = 1.0 - self.alpha, 2.0**-self.alpha
        third, fourth = self.rgamma[3:5]
        none = 2.0 * np.expm1(rest * math.log(2.0)) * third  # (w + w')^-alpha over both w
        once = rest * (4.0 * two - 1.0) * fourth  # and times w
        both = 2.0 * (1.0 - 2.0 * two * self.alpha) * third / (4.0 - self.alpha)  # and times w w'
        shift = eta - 0.5
        stored = both + shift * (2.0 * once + shift * none)
        size = 2.0 * third + np.abs(shift) * (2.0 * once + np.abs(shift) * none)
        spring, part = 0.5 * self.K * eta * eta, 0.5 * self._part(c)
        lost = 1.0 - (spring + part * stored) / work
        least = np.maximum(lost, np.finfo(float).eps)
        return lost, RELATIVE_ERROR * (1.0 + (spring + part * size) / (work * least))

    def response(self, X: Array) -> tuple[Array, Array, Array]:
        """Return G, X dG/dX and the mean of G up to X."""
        part, first = self._part(X), self.rgamma[1]
        return (
            self.K + part * first,
            -self.alpha * part * first,
            self.K + part * self.rgamma[2],
        )

    def least_peak(self, a: Array) -> Array:
        """Return a distance at which the pressure still rises, or at which it is its limit at X = 0."""
        return np.maximum((1.0 - self.alpha), np.finfo(float).eps) * 0.25 * a

    def _part(self, X: Array) -> Array:
        part: Array = self.K * power(self.length / X, self.alpha)
        return part


def law(scene: Scene) -> Prony | Fractional:
    """Return the relaxation function of a scene along its contact, in the shape of the scene."""
    foundation = scene.foundation
    K, V = (
        np.broadcast_to(x, scene.shape) for x in (foundation.stiffness, scene.drive.final_velocity)
    )
    if isinstance(foundation, FractionalKelvinVoigt):
        return Fractional(K, V, (foundation.retardation_time, foundation.order))
    arms = [(arm.stiffness, arm.relaxation_time) for arm in foundation.arms]
    return Prony(K, V, [np.broadcast_to(x, scene.shape) for arm in arms for x in arm])


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


def contact_length(scene: Scene, row: Prony | Fractional) -> Array:
    """Return the length of the contact, on every support."""
    support, R = scene.support, scene.indenter.radius
    if scene.held:
        return length_at_half(row, np.broadcast_to(np.sqrt(2.0 * R * support.depth), scene.shape))
    return _length_at_load(row, R, support.weight, support.spring)


def length_at_half(row: Prony | Fractional, a: Array) -> Array:
    """Return the length of the contact whose half length at rest is a: between a and 2 a."""

    def step(c: Array) -> Array:
        M = row.moments(c)
        share, slope, bend = growth(M)
        off = share - a / c
        step = off / (slope - 0.5 * off * (bend / slope))  # of c, over c
        return -np.log1p(-np.clip(step, 1.0 - 2.0 * a / c, 1.0 - a / c))

    return converge(step, 1.5 * a, LAST_STEP, MOST_STEPS)


def _length_at_load(row: Prony | Fractional, R: Array, load: Array, spring: Array) -> Array:
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


def state(scene: Scene, row: Prony | Fractional, c: Array) -> tuple[Array, ...]:
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


def _peak(R: Array, row: Prony | Fractional, a: Array) -> Array:
    """Return the greatest pressure: p' = (a G - X mean G)/R falls, and has one root at X <= a.

    Newton's method for ln(a G/(X mean G)) against ln X, and bisection where its steps are long.
    """
    low, high = np.log(row.least_peak(a)), np.log(a)
    y, active = high, np.full(a.shape, True)
    for _ in range(PEAK_STEPS):
        X = np.exp(y)
        end, end_slope, mean = row.response(X)
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
