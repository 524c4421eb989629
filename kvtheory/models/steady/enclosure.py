r"""Bounds of the steady half length, without solving for it.

With s = a/a_0, lambda = V tau/a_0 and r = sqrt(lambda^2 + s^2) the load is f = s^2 g(s) in units of the
static one (theorem "scaled-load"), g = (lambda^2/(lambda + r) + r + s)/2, and the balance of forces
f + kappa (s^2 - 1) = 1 says

    s = T(s),    T(s)^2 = (1 + kappa)/(g(s) + kappa).

g grows with s, for d(lambda^2/(lambda + r) + r)/dr = 1 - lambda^2/(lambda + r)^2 > 0, and so T falls: it
sends an upper bound of the root to a lower one and back. g > (3/4) lambda gives the first.
"""

import math
from typing import NamedTuple


class Enclosure(NamedTuple):
    """lambda, kappa, and bounds of s = a/a_0."""

    number: float
    support_number: float
    low: float
    high: float

    @property
    def least(self) -> float:
        """The least l = l_r/a."""
        return self.number / self.high

    @property
    def largest(self) -> float:
        """The largest l = l_r/a."""
        return self.number / self.low


FIXED = 1.0
"""s of an indenter that cannot move."""


def load_over_square(s: float, number: float) -> float:
    """Return g = f/s^2, f the load in units of the static one.

    Examples
    --------
    >>> load_over_square(1.0, 0.0)  # at rest the static load
    1.0
    """
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
        return math.sqrt((1.0 + kappa) / (load_over_square(s, number) + kappa))

    first = math.sqrt((1.0 + kappa) / max(0.75 * number + kappa, 1.0 + kappa))
    high = min(first, image(image(first)))  # at low velocity this halves the width
    return Enclosure(number, kappa, image(high), high)
