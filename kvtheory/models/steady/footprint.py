r"""The footprint of a ball in steady sliding, and the line contact equivalent to it.

At low and at high velocity a cylinder of the radius R has the forces of the ball if its half length at rest
is (9 pi/32) a, with a that of the ball, and its width (4/3)(32/(9 pi))^2 a sqrt(R'/R) (derivations F20, F1):
two numbers satisfy four limits. In between the difference is small.
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.results import SteadyState

Array = NDArray[np.float64]

SHORTER = 9.0 * math.pi / 32.0
WIDTH = 4.0 / 3.0 / SHORTER**2
"""Its half length over that of the ball, and its width over the ball's half width, both at rest."""
LOAD_ERROR, FRICTION_COEFFICIENT_ERROR = 0.002, 0.0025
"""The largest differences relative to the ball, rounded up from 0.00192 and 0.00236."""


@dataclass(frozen=True)
class Footprint:
    """The contact area of a ball in steady sliding: a disc, cut at the rear where the pressure vanishes.

    Lengths in m, `stiffness` in N/m^3. `retardation_length` has the sign of the velocity, along whose
    direction the foundation moves through x; y is across, up to the `half_width` a sqrt(R'/R).
    """

    radius: float
    stiffness: float
    half_length: float
    half_width: float
    retardation_length: float

    def edges(self, y: ArrayLike) -> tuple[Array, Array]:
        """Return leading and trailing edge of the strips at y, as x; NaN outside the contact.

        With the half length A = sqrt(a^2 - y^2 R/R') of a strip, for V > 0 they are -A and
        sqrt(A^2 + l_r^2) - l_r (derivation F20-load).

        >>> found = Footprint(0.01, 1e10, 4e-3, 4e-3, 3e-3)
        >>> [edge.round(6).tolist() for edge in found.edges([0.0, 4e-3, 5e-3])]
        [[-0.004, -0.0, nan], [0.002, 0.0, nan]]
        """
        share = np.asarray(y, dtype=float) / self.half_width
        inside = np.abs(share) <= 1.0
        A = self.half_length * np.sqrt(np.where(inside, (1.0 - share) * (1.0 + share), np.nan))
        l_r, side = abs(self.retardation_length), math.copysign(1.0, self.retardation_length)
        beyond = np.hypot(A, l_r) + l_r
        return -side * A, side * A * (A / np.where(beyond > 0.0, beyond, 1.0))

    def pressure(self, x: ArrayLike, y: ArrayLike) -> Any:
        """Return the pressure in Pa, zero outside; x and y broadcast.

        p = K (A^2 - x^2 - 2 l_r x)/(2 R) between the edges.

        >>> float(Footprint(1.0, 2.0, 1.0, 1.0, 0.5).pressure(-0.5, 0.0))
        1.25
        """
        x = np.asarray(x, dtype=float)
        leading, trailing = self.edges(y)
        inside = (x >= np.minimum(leading, trailing)) & (x <= np.maximum(leading, trailing))
        rise = leading * leading - x * x - 2.0 * self.retardation_length * x
        return np.where(inside, 0.5 * self.stiffness / self.radius * rise, 0.0)


class EquivalentLine(NamedTuple):
    """A line contact equivalent to a ball at one depth, in SI."""

    width: float
    depth: float
    load: float
    """Per unit width."""


def equivalent_line(ball: SteadyState, stretch: float) -> EquivalentLine:
    """Return the line contact with the radius R equivalent to a ball in steady sliding.

    `stretch` is sqrt(R'/R), 1 for a ball. The friction coefficient is that of the ball, within
    `FRICTION_COEFFICIENT_ERROR`, at every velocity if the depth is kept; under a dead weight depth and width
    change with velocity.

    >>> import kvtheory as kv
    >>> ball = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
    >>> line = equivalent_line(kv.steady(ball), 1.0)
    >>> print(f"{line.width * 1e3:.4f} mm, {line.load / 1e3:.4f} N/mm")
    1.9002 mm, 5.1608 N/mm
    """
    width = WIDTH * ball.half_length * stretch
    return EquivalentLine(width, SHORTER**2 * ball.depth, ball.load / width)
