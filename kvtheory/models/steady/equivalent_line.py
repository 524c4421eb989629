r"""The line contact equivalent to a ball: a cylinder with the same radius, and its width.

In both limits of the velocity, a cylinder with the radius R of the ball has the forces of the ball if the
half length of its contact at rest is (9 pi/32) a, with a that of the ball, and its width
(4/3)(32/(9 pi))^2 a sqrt(R'/R) (derivation F20 with F1): two numbers satisfy four limits. In between the
difference is small.
"""

import math
from typing import NamedTuple

from kvtheory.results import SteadyState

SHORTER = 9.0 * math.pi / 32.0
"""Its half length over that of the ball."""
WIDTH = 4.0 / 3.0 / SHORTER**2
"""Its width over the half width of the contact of the ball at rest."""
LOAD_ERROR, FRICTION_COEFFICIENT_ERROR = 0.002, 0.0025
"""The largest differences relative to the ball, rounded up from 0.00192 and 0.00236."""


class EquivalentLine(NamedTuple):
    """A line contact equivalent to a ball at one depth, in SI."""

    width: float
    depth: float
    load: float
    """Per unit width."""


def equivalent_line(ball: SteadyState, stretch: float) -> EquivalentLine:
    """Return the line contact with the radius R equivalent to a ball in steady sliding.

    `stretch` is sqrt(R'/R), 1 for a ball. Its friction coefficient is that of the ball, within
    `FRICTION_COEFFICIENT_ERROR`, at every velocity if the depth is kept; under a dead weight depth and
    width change with velocity.

    >>> import kvtheory as kv
    >>> ball = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
    >>> line = equivalent_line(kv.steady(ball), 1.0)
    >>> print(f"{line.width * 1e3:.4f} mm, {line.load / 1e3:.4f} N/mm")
    1.9002 mm, 5.1608 N/mm
    """
    width = WIDTH * ball.half_length * stretch
    return EquivalentLine(width, SHORTER**2 * ball.depth, ball.load / width)
