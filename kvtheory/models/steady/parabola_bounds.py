r"""Bounds of the errors of the asymptotes of a parabola.

An indenter that can move has its l = l_r/a within bounds that need no root. With s = a/a_0,
lambda = V tau/a_0 and r = sqrt(lambda^2 + s^2) the load is f = s^2 g(s) in units of the static one (theorem
"scaled-load"), g = (lambda^2/(lambda + r) + r + s)/2, and the balance of forces f + kappa (s^2 - 1) = 1 says

    s = T(s),    T(s)^2 = (1 + kappa)/(g(s) + kappa).

g grows with s, for d(lambda^2/(lambda + r) + r)/dr = 1 - lambda^2/(lambda + r)^2 > 0, and so T falls: it
sends an upper bound of the root to a lower one and back. g > (3/4) lambda gives the first, and the error of
the depth for high velocity, (g(s) + kappa)/(3/4 lambda) - 1.
"""

import math

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady.enclosure import Enclosure, Known
from kvtheory.theory import closed_forms as cf


def _load_over_square(s: float, number: float) -> float:
    """Return g = f/s^2, f the load in units of the static one."""
    r = math.hypot(number, s)
    return 0.5 * (number * number / (number + r) + r + s)


def enclose(number: float, support_number: float) -> Enclosure:
    """Return bounds of a/a_0 in steady sliding of an indenter that can move.

    Parameters
    ----------
    number, support_number
        lambda >= 0 and kappa >= 0.

    Examples
    --------
    >>> found = enclose(4.0, 0.0)
    >>> print(f"{found.low:.5f} to {found.high:.5f}")
    0.55133 to 0.55138
    """
    kappa = support_number

    def image(s: float) -> float:
        return math.sqrt((1.0 + kappa) / (_load_over_square(s, number) + kappa))

    first = math.sqrt((1.0 + kappa) / max(0.75 * number + kappa, 1.0 + kappa))
    high = min(first, image(image(first)))  # at low velocity this halves the width
    return Enclosure(number, kappa, image(high), high)


def _dissipated(b: Enclosure) -> float:
    """1/(fraction) - 1 = (3/4) t/(1 - t), t = q (1 - q), which is largest at q = 1/2 (theorem F6)."""
    nearest = min(max(0.5, b.q_least), b.q_largest)
    t = nearest * (1.0 - nearest)
    return 0.75 * t / (1.0 - t)


def _high_depth(b: Enclosure) -> float:
    return (_load_over_square(b.high, b.number) + b.support_number) / (0.75 * b.number) - 1.0


PARABOLA = Known(
    asymptotes=asymptotes,
    enclose=enclose,
    low_coefficient=lambda b: cf.error_l1(b.largest, b.q_least),
    high_coefficient=lambda b: cf.error_l2_fixed(b.q_largest, b.least),
    high_depth=_high_depth,
    low_load=lambda b: abs(cf.error_load_low(b.largest, b.q_least)),
    low_friction=lambda b: abs(cf.error_friction_force_low(b.largest, b.q_least)),
    high_load=lambda b: abs(cf.error_load_high(b.q_least)),
    high_friction=lambda b: abs(cf.error_friction_force_high(b.q_least)),
    dissipated=_dissipated,
)
