r"""The line contact that stands for a ball: a cylinder with its radius, and how wide it must be.

In both limits of the velocity, a cylinder with the radius R of the ball has the forces of the ball if its
contact at rest is (9 pi/32) a long on either side, a that of the ball, and (4/3)(32/(9 pi))^2 a sqrt(R'/R)
wide (derivation F20 with F1): four limits, two numbers. In between little is missing.
"""

import math
from typing import NamedTuple

from kvtheory.results import SteadyState

SHORTER = 9.0 * math.pi / 32.0
"""Its half length over that of the ball."""
WIDTH = 4.0 / 3.0 / SHORTER**2
"""Its width over the half width of the contact of the ball at rest."""
LOAD_ERROR, FRICTION_COEFFICIENT_ERROR = 0.002, 0.0025
"""By how much it differs at most, relative to the ball: 0.00192 and 0.00236."""


class EquivalentLine(NamedTuple):
    """A line contact that stands for a ball at one depth, in SI."""

    width: float
    depth: float
    load: float
    """Per unit width."""


def equivalent_line(ball: SteadyState, stretch: float) -> EquivalentLine:
    """Return the line contact with the radius R that stands for a ball in steady sliding.

    `stretch` is sqrt(R'/R), 1 for a ball. Its friction coefficient is that of the ball at the velocity of
    `ball`, and at all others at the same depth; under a dead weight the width follows the velocity.

    >>> from kvtheory.models.steady.ball import at_load
    >>> line = equivalent_line(at_load(0.01, 1.0, 1e10, 0.1, 0.1, 9.80665), 1.0)
    >>> print(f"{line.width * 1e3:.4f} mm, {line.load / 1e3:.4f} N/mm")
    1.9002 mm, 5.1608 N/mm
    """
    width = WIDTH * ball.half_length * stretch
    return EquivalentLine(width, SHORTER**2 * ball.depth, ball.load / width)
