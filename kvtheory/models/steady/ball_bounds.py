r"""Bounds of the errors of the asymptotes of a ball.

With s = a/a_0 and f its load in units of the static one, the balance of forces is f + kappa (s^2 - 1) = 1,
and d ln f/d ln s is between 3 and 4 (derivation "F20-balance"). From any s, whose total f + kappa s^2 is
(1 + kappa) e^r, the root is therefore between s e^(-r/2) and s e^(-r/4): r tells how far it is. One step of
Newton's method leaves |r| below 5e-4, which the tests hold it to, but the bounds are right without it.

The errors are monotonic in l (derivations "F20-error-..."). That of the depth for high velocity is

    (1 + x)^(2/3) - 1,    x = (3 pi/(8 lambda)) (s (1 + T/pi)/2 + kappa/s),

as W is (8 lambda/(3 pi)) s^3 of the damper and s^4 (1 + T/pi)/2 in these units. What leaves the contact is
8 l D/(pi + T) of the power, and both D and T fall with l.
"""

import math

from kvtheory.models.steady import ball_asymptotes
from kvtheory.models.steady.ball import NEAR, SQUARES, WEIGHTS
from kvtheory.models.steady.enclosure import Enclosure, Known
from kvtheory.theory import closed_forms as cf

DAMPER = 8.0 / (3.0 * math.pi)
"""f/(lambda s^3) for high velocity."""
NODES = tuple(zip(SQUARES.tolist(), WEIGHTS.tolist(), strict=True))


def enclose(number: float, support_number: float) -> Enclosure:
    """Return bounds of a/a_0 in steady sliding of a ball that can move.

    Parameters
    ----------
    number, support_number
        lambda >= 0 and kappa >= 0.

    Examples
    --------
    >>> found = enclose(4.0, 0.0)
    >>> print(f"{found.low:.6f} to {found.high:.6f}")
    0.644511 to 0.644514
    """
    kappa = support_number
    s = math.cbrt((1.0 + kappa) / (kappa + math.hypot(1.0, DAMPER * number)))
    total = _total(s, number, kappa)
    slope = cf.ball_scaled_load_slope(s, number, math.atan2(s, number)) + 2.0 * kappa * s * s
    s *= math.exp(-math.log(total / (1.0 + kappa)) * (total / slope))
    off = math.log(_total(s, number, kappa) / (1.0 + kappa))
    low, high = sorted((s * math.exp(-0.5 * off), s * math.exp(-0.25 * off)))
    return Enclosure(number, kappa, low, min(high, 1.0), "sphere")


def _total(s: float, number: float, kappa: float) -> float:
    return cf.ball_scaled_load(s, number, tail(number / s)) + kappa * s * s


def tail(l: float) -> float:
    """Return T as `ball.angle_and_tail` does, of a float.

    >>> round(tail(0.0), 12), round(tail(1e8), 12)
    (3.14159265359, 1.0667e-08)
    """
    if l <= NEAR:
        return cf.ball_tail(l, math.atan2(1.0, l))
    square = 1.0 / (l * l)
    return sum(weight / (1.0 + square * node) for node, weight in NODES) / l


def _high_depth(b: Enclosure) -> float:
    spring = 0.5 * b.high * (1.0 + tail(b.least) / math.pi) + b.support_number / b.low
    return math.cbrt(1.0 + spring / (DAMPER * b.number)) ** 2 - 1.0


def _dissipated(b: Enclosure) -> float:
    behind = 8.0 * b.largest * cf.ball_loss(b.least, tail(b.least))
    return behind / (math.pi + tail(b.largest) - behind)


BALL = Known(
    asymptotes=ball_asymptotes,
    enclose=enclose,
    low_coefficient=lambda b: cf.ball_error_l1(b.largest, tail(b.largest)),
    high_coefficient=lambda b: cf.ball_error_l2(b.least, tail(b.least)),
    high_depth=_high_depth,
    low_load=lambda b: abs(cf.ball_error_load_low(b.largest, tail(b.largest))),
    low_friction=lambda b: cf.ball_error_friction_low(b.largest, tail(b.largest)),
    high_load=lambda b: abs(cf.ball_error_load_high(b.least, tail(b.least))),
    high_friction=lambda b: abs(cf.ball_error_friction_high(b.least, tail(b.least))),
    dissipated=_dissipated,
)
