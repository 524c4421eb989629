"""The slow manifold just after a start from rest: scalars, cheap enough to choose a model by.

At d = 1 the contact length b solves b^2 (2 b + 3 (lambda - 1)) = 4, whatever the spring, and
d' = G(1) = b (b - 2 + 2 lambda) - 2 lambda; see `kvtheory.models.slow_manifold.motion`.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

NEWTON_STEPS = 60
"""Most Newton steps; fewer than ten are needed from above the root."""

ROUNDING = 4e-16
"""Relative size of a Newton step after which the iteration stops."""


@dataclass(frozen=True)
class Start:
    """The slow manifold just after the start, in scaled form: d = 1, d' = `rate`, contact length `width`."""

    number: float
    eps: float
    kappa: float
    width: float
    rate: float
    stiff: float
    """f_v = df_z/dd' on the slow manifold: the least value during the fast initial motion."""
    stiffest: float
    """f_v at d' = 0: the largest value during that motion."""
    relaxation: float
    """-G'(1), the rate of the slow motion."""
    steady: float
    """a of steady sliding, in units of a_0."""

    @property
    def ratio(self) -> float:
        """Ratio of slow to fast rate; it must be small for the slow manifold."""
        return self.eps * self.relaxation / self.stiff

    @property
    def goes_back(self) -> bool:
        """Whether the trailing edge would at once re-enter surface that it left (see `outruns`)."""
        a, b = 1.0, self.width
        return bool(outruns(a, b, self.rate, -self.relaxation, self.number) > 0.0)

    @property
    def least_error(self) -> float:
        """Lower bound, to first order, of the depth error just after the fast initial motion."""
        return self.eps * abs(self.rate) / self.stiffest

    def layer(self, s: Any) -> Any:
        """Return a bound of d' - G at the times s, due to the fast initial motion."""
        return abs(self.rate) * np.exp(-self.stiff * np.asarray(s, dtype=float) / self.eps)


def start(number: float, eps: float, kappa: float) -> Start:
    """Return the slow manifold at d = 1, after a start from rest to lambda = `number` > 0."""
    b = _width(number)
    v = b * (b - 2.0 + 2.0 * number) - 2.0 * number
    at_rest = 1.0 - number + math.sqrt(1.0 + number * number)
    slope = depth_slope(1.0, b, v, number)
    stiff = 0.75 * b
    return Start(
        number, eps, kappa, b, v, stiff, 0.75 * at_rest, (slope + kappa) / stiff,
        half_length(number, kappa),
    )  # fmt: skip


def half_length(number: float, support_number: float) -> float:
    """Return a/a_0 of steady sliding, the root s of the convex balance f + kappa (s^2 - 1) = 1.

    f = s^2 (lambda^2/(lambda + r) + r + s)/2 with r = sqrt(lambda^2 + s^2) (theorem "scaled-load"). The
    residual is not negative at s = 1, from where Newton's method converges monotonically; ArithmeticError
    if it does not, as where lambda is not finite.
    """
    s, kappa = 1.0, support_number
    for _ in range(NEWTON_STEPS):
        r = math.hypot(number, s)
        load = 0.5 * s * s * (number * number / (number + r) + r + s)
        step = (load + kappa * s * s - (1.0 + kappa)) / (1.5 * s * (r + s) + 2.0 * kappa * s)
        s -= step
        if abs(step) <= ROUNDING * s:
            return s
    raise ArithmeticError("the steady half length did not converge")


def _width(number: float) -> float:
    """Return b at d = 1: the root of b^2 (2 b + 3 (lambda - 1)) = 4, from above."""
    n = number - 1.0
    b = min(2.0, math.sqrt(4.0 / (3.0 * n)) if n > 0.0 else 2.0)
    for _ in range(NEWTON_STEPS):
        step = (b * b * (2.0 * b + 3.0 * n) - 4.0) / (6.0 * b * (b + n))
        b -= step
        if abs(step) <= ROUNDING * b:
            return b
    raise ArithmeticError("the contact length at the start did not converge")


def depth_slope(a: Any, b: Any, v: Any, number: float) -> Any:
    """Return f_d = df_z/dd at given d': (3/4)(b + p_left/(2 a)), the leading edge touching."""
    return 0.75 * (b + (v + 2.0 * number * a) / (2.0 * a))


def outruns(a: Any, b: Any, rate: Any, slope: Any, number: float) -> Any:
    """Return a number that is positive if the trailing edge moves outward faster than the foundation.

    (r + lambda) r' = (d' + d'')/2 (Eq. 33 differentiated) with d'' = G' d'; r' must not exceed lambda.
    `slope` is G'.
    """
    return rate * (1.0 + slope) - 2.0 * number * (b - a + number)
