"""Bounds of the half length of an indenter in steady sliding, and of what follows from them."""

import math
from collections.abc import Callable
from types import ModuleType
from typing import NamedTuple


class Enclosure(NamedTuple):
    """lambda, kappa, and bounds of s = a/a_0; kappa is infinite and s = 1 for a fixed indenter."""

    number: float
    support_number: float
    low: float
    high: float
    shape: str = "parabola"

    @property
    def least(self) -> float:
        """The least l = l_r/a."""
        return self.number / self.high

    @property
    def largest(self) -> float:
        """The largest l = l_r/a."""
        return self.number / self.low

    @property
    def q_least(self) -> float:
        """The least q = x_TE/a."""
        return 1.0 / (self.largest + math.hypot(1.0, self.largest))  # Eq. 27

    @property
    def q_largest(self) -> float:
        """The largest q = x_TE/a."""
        return 1.0 / (self.least + math.hypot(1.0, self.least))


Bound = Callable[[Enclosure], float]
"""Of the relative error of an asymptote, for all l = l_r/a of an enclosure."""


class Known(NamedTuple):
    """What the bounds of all quantities follow from, for one shape of the indenter.

    The errors are those of asymptote over truth, less one: of the forces and of the friction coefficient
    for high velocity at a given depth, of the depth for high velocity of an indenter that can move.
    """

    asymptotes: ModuleType
    enclose: Callable[[float, float], Enclosure]
    low_coefficient: Bound
    high_coefficient: Bound
    high_depth: Bound
    low_load: Bound
    low_friction: Bound
    high_load: Bound
    high_friction: Bound
    dissipated: Bound
