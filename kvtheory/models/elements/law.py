"""The law of one element of the foundation: all that a scheme asks of it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class KelvinVoigt(NamedTuple):
    """A spring K (N/m^3) beside a damper C = K τ: its state is the compression u alone.

    >>> law = KelvinVoigt(2.0, 0.1)
    >>> law.pressure(1.0, 5.0), round(float(law.left(1.0, 0.1)), 6), round(law.mean_stiffness(0.1), 6)
    (3.0, 0.367879, 3.163953)
    """

    stiffness: float
    retardation_time: float

    @property
    def damping(self) -> float:
        """C = K τ, in N s/m^3."""
        return self.stiffness * self.retardation_time

    def pressure(self, g: Array, g_rate: Array) -> Array:
        """Return p = K g + C g' of an element that follows the indenter (Eqs. 6, 7, 12)."""
        return self.stiffness * g + self.damping * g_rate

    def left(self, u: Array | float, delay: float) -> Array | float:
        """Return the compression of an element that was left alone for so long (Eqs. 20, 21)."""
        return math.exp(-delay / self.retardation_time) * u

    def mean_stiffness(self, h: float) -> float:
        """Return k in k (g - u), the mean of the pressure over a step h, weighted by e^(t/τ).

        The element is pressed to g, and u is what it would be at the end if it were left alone.
        """
        return -self.stiffness / math.expm1(-h / self.retardation_time)
