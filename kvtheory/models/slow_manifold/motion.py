r"""The slow manifold as a time series, with an estimate of what it neglects (fact F13).

For eps -> 0 the forces balance at every instant, f_z = f with f = 1 - kappa (d - 1). With the leading edge
on undisturbed ground, l = -a, a = sqrt(d), and a peeling trailing edge r, the contact length b = r + a
is the only positive root of b^2 (2 b + 3 (lambda - a)) = 4 f, and p(r) = 0 gives
d' = G(d) = r^2 + 2 lambda r - d. One ODE of first order is left.

As d falls from 1 to its steady value, s = int dd/G: no time stepping is needed. The substitution
a = a_oo + (1 - a_oo) e^-u makes the integrand smooth and bounded, and one Chebyshev series gives s(u)
for the whole run.

The neglected terms, to first order in eps: with the derivatives f_v = (3/4) b and f_d of the force,

    d' - G = -eps G' G/f_v                  along the slow motion, as eps d'' = -f_v (d' - G),
    d' - G = -G(1) e^(-f_v s/eps)           after the start, where d' = 0,
    d error = eps |G| |int (f_d + kappa)/f_v^2 ds - j|,    1/f_v(d' = 0) <= j <= 1/f_v(d' = G),

the last of which is a time delay: the error of d obeys e' = G' e + ..., as G itself does.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from kvtheory.models.slow_manifold.start import NEWTON_STEPS, Start, depth_slope, outruns
from kvtheory.theory.closed_forms import peeling_friction_force, trailing_edge_ratio

Array = NDArray[np.float64]

DEGREES = (24, 48, 96)
"""Degrees of the Chebyshev series, tried in turn; 24 is enough down to 1e-5, 48 at 1e-8, at any velocity."""
SETTLED, RESOLVED = 1e-2, 1e-2
"""Fractions of the tolerance: distance of the end of the path from the steady half length, beyond which the
remainder decays at a single rate; truncation error of the series."""
LARGEST_RATIO = 0.1
"""Ratio of slow to fast rate above which the first order in eps is unreliable."""
SAFETY = 1.5
"""Safety factor on the first-order estimates; it also covers the second order at the largest ratio."""
INVERSIONS, CLOSE = 12, 1e-7
"""Most Newton iterations from times to u (four were seen), and a step after which the next is rounding."""


@dataclass(frozen=True)
class SlowMotion:
    """Scaled quantities at the requested times, and an estimate of the magnitude of the error of each."""

    values: dict[str, Array]
    errors: dict[str, Array]
    ratio: float
    """The largest ratio of slow to fast rate on the way."""


def follow(given: Start, s: Array, tolerance: float) -> SlowMotion:
    """Return the slow motion at the times `s` (in units of tau), for lambda > 0.

    ArithmeticError if the path is not resolved, or an edge would re-enter surface that it left.

    >>> from kvtheory.models.slow_manifold.start import start
    >>> follow(start(4.0, 1e-4, 0.0), np.array([0.0, 5.0]), 1e-6).values["depth"].round(6)
    array([1.      , 0.303964])
    """
    path = _path(given, tolerance)
    u = path.when(np.minimum(s, path.length))
    # beyond the end of the path, the remainder decays with ds/du there as its time constant
    fading = np.exp(-np.maximum(s - path.length, 0.0) / float(path.pace.sum()))
    moved = (1.0 - given.steady) * np.exp(-u) * fading
    a, b, v, stiff, slope = _manifold(given, moved)
    values = _values(given, a, b, v)
    delay = path.at(u, path.delays)  # in units of eps
    least, most = 1.0 / given.stiffest, 1.0 / given.stiff
    apart = np.maximum(np.abs(delay - least), np.abs(delay - most))
    late = given.eps * (apart + path.ratio * (delay + most)) + path.error
    depth = SAFETY * np.abs(v) * late + tolerance * RESOLVED
    falling = -(slope + given.kappa) / stiff  # G'
    own = SAFETY * given.eps * np.abs(v) * -falling / stiff
    errors = _errors(given, values, a, b, falling, depth, own, given.layer(s))
    return SlowMotion(values, errors, path.ratio)


def depth_rate(depth: Array, number: float, support_number: float = 0.0) -> Array:
    """Return d' on the slow manifold at scaled depths."""
    a = np.sqrt(depth)
    r = _widths(a, number, support_number) - a
    return np.asarray(r * (r + 2.0 * number) - depth)


def _manifold(given: Start, moved: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return a, b, d' = G, f_v and f_d where a exceeds its steady value by `moved`, without cancellation."""
    number, kappa, a_0 = given.number, given.kappa, given.steady
    r_0 = a_0 * trailing_edge_ratio(number / a_0)
    b_0 = a_0 + r_0
    a = a_0 + moved
    grown = _widths(a, number, kappa) - b_0
    fallen = moved * (2.0 * a_0 + moved)  # a^2 - a_0^2
    for _ in range(2):
        b = b_0 + grown
        residual = (
            grown * (2.0 * (b * b + b * b_0 + b_0 * b_0) + 3.0 * (number - a_0) * (b + b_0))
            - 3.0 * b * b * moved + 4.0 * kappa * fallen
        )  # fmt: skip
        grown = grown - residual / (6.0 * b * (b + number - a))
    b = b_0 + grown
    turned = grown - moved  # r - r_0
    v = turned * (2.0 * (r_0 + number) + turned) - fallen
    return a, b, v, 0.75 * b, depth_slope(a, b, v, number)


def _widths(a: Array, number: float, kappa: float) -> Array:
    """Return the root b of b^2 (2 b + 3 (lambda - a)) = 4 f, by Newton's method from above."""
    f, n = 1.0 - kappa * (a * a - 1.0), number - a
    cubic = np.cbrt(2.0 * f)
    with np.errstate(divide="ignore", invalid="ignore"):
        b = np.where(n > 0.0, np.minimum(cubic, np.sqrt(4.0 * f / (3.0 * n))), cubic - 1.5 * n)
    for _ in range(NEWTON_STEPS):
        step = (b * b * (2.0 * b + 3.0 * n) - 4.0 * f) / (6.0 * b * (b + n))
        b = b - step
        if np.max(np.abs(step) / b) <= CLOSE:
            return b
    raise ArithmeticError("the contact length on the slow manifold did not converge")


@dataclass(frozen=True)
class _Path:
    """ds/du, s(u) and int (f_d + kappa)/f_v^2 ds as Chebyshev series on [0, `end`]."""

    end: float
    pace: Array
    times: Array
    delays: Array
    length: float
    ratio: float
    error: float

    def when(self, s: Array) -> Array:
        """Return u at the times `s`, at most `end`."""
        nodes = np.linspace(0.0, self.end, self.times.size)
        u = np.interp(s, self.at(nodes, self.times), nodes)
        for _ in range(INVERSIONS):
            basis = _basis(2.0 * u / self.end - 1.0, self.times.size)
            step = (basis @ self.times - s) / (basis[:, :-1] @ self.pace)
            u = np.minimum(np.maximum(u - step, 0.0), self.end)
            if np.all((np.abs(step) <= CLOSE) | (s >= self.length)):
                return u
        raise ArithmeticError("the times on the slow manifold could not be inverted")

    def at(self, u: Array, coefficients: Array) -> Array:
        """Return the value of a series at u."""
        return _basis(2.0 * u / self.end - 1.0, coefficients.size) @ coefficients


def _basis(x: Array, count: int) -> Array:
    """Return the Chebyshev polynomials at x in [-1, 1], a column for each."""
    return np.cos(np.arccos(np.minimum(np.maximum(x, -1.0), 1.0))[:, None] * np.arange(count))


@cache
def _transform(degree: int) -> tuple[Array, Array, Array]:
    """Return the Chebyshev nodes, and matrices from values there to coefficients and to their integral."""
    x = chebyshev.chebpts1(degree + 1)
    matrix = _basis(x, degree + 1).T * (2.0 / (degree + 1))
    matrix[0] *= 0.5
    return x, matrix, np.asarray(chebyshev.chebint(matrix, lbnd=-1.0), dtype=np.float64)


def _path(given: Start, tolerance: float) -> _Path:
    """Integrate ds and the delay from the start to the steady depth."""
    gap = 1.0 - given.steady
    end = math.log(max(gap / (SETTLED * tolerance), math.e))
    for degree in DEGREES:
        x, transform, integral = _transform(degree)
        moved = gap * np.exp(-0.5 * end * (x + 1.0))
        a, b, v, stiff, slope = _manifold(given, moved)
        if np.any(v >= 0.0):
            raise ArithmeticError("the depth does not fall on the slow manifold")
        pull = (slope + given.kappa) / (stiff * stiff)
        outrun = outruns(a, b, v, -pull * stiff, given.number)
        if np.any(outrun > 0.0) or np.any(v + 2.0 * given.number * a < 0.0):
            raise ArithmeticError("an edge would re-enter deformed foundation")
        pace = 2.0 * a * moved / -v  # ds/du
        series = transform @ pace
        tail = 0.5 * end * float(np.sum(np.abs(series[-3:])))
        if tail * abs(given.rate) <= RESOLVED * tolerance:
            times, delays = 0.5 * end * (integral @ np.array([pace, pace * pull]).T).T
            ratio = given.eps * float(np.max(pull))
            return _Path(end, series, times, delays, float(times.sum()), ratio, tail)
    raise ArithmeticError("the slow manifold is not resolved")


def _values(given: Start, a: Array, b: Array, v: Array) -> dict[str, Array]:
    """Return the scaled quantities; f_x is the peeling form of F11."""
    r, number = b - a, given.number
    rho = r + number
    return {
        "depth": a * a,
        "depth_rate": v,
        "normal_force": 1.0 - given.kappa * (a * a - 1.0),
        "friction_force": peeling_friction_force(b, r, rho),
        "leading_edge": -a,
        "trailing_edge": r,
        "peak_pressure": np.where(number < a, a * a + v + number**2, v + 2.0 * number * a),
    }


def _errors(
    given: Start, values: dict[str, Array], a: Array, b: Array, falling: Array,
    depth: Array, own: Array, layer: Array,
) -> dict[str, Array]:  # fmt: skip
    """Propagate the errors to each quantity by its derivatives with respect to d and d' (F11-derivatives).

    d' - G is `own` along the slow motion and `layer` after the start; an error of d adds `falling`, G',
    times it to d'. In the layer the derivatives of the forces are largest at d' = 0.
    """
    r, number = values["trailing_edge"], given.number
    arm = a * a - r * r
    p_left = values["depth_rate"] + 2.0 * number * a
    inside = number < a
    edge = np.abs(1.0 + falling) * depth + own + layer
    peak = np.where(inside, np.abs(1.0 + falling), np.abs(falling + number / a)) * depth
    return {
        "depth": depth,
        "depth_rate": np.abs(falling) * depth + own + layer,
        "normal_force": given.kappa * depth + 0.75 * b * own + given.stiffest * layer,
        "friction_force": 0.75
        * (np.abs(arm * (1.0 + falling) + p_left) * depth + np.abs(arm) * own + layer),
        "leading_edge": depth / (2.0 * a),
        "trailing_edge": edge / (2.0 * (r + number)),
        "peak_pressure": peak + own + layer,
    }
