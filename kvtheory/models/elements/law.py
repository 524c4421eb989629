"""One element of the foundation: its law, and the rule by which it is found to press, right or wrong."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TIE = 1e-9
"""Relative: an element in contact is on the surface, up to rounding."""


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


class ContactRule(NamedTuple):
    """How an element is found to press in an explicit scheme; a field that is not the default is a mistake.

    `flags`: an element in contact stays so until its pressure vanishes (Eqs. 23-25); without, it counts
    only where the surface of the foundation is met. `stale`: within a step that surface is the one at its
    start. `pulls`: an element below the plane z = 0 is never let go. `relaxes`: the free surface decays
    as e^(-t/tau) (Eq. 20).
    """

    flags: bool = True
    stale: bool = False
    pulls: bool = False
    relaxes: bool = True

    def pressed(
        self, g: Array, p: Array, surface: tuple[Array, Array], touched: NDArray[np.bool_],
        *, within: bool,
    ) -> NDArray[np.bool_]:  # fmt: skip
        """Return which elements press; `surface` is that at the start of the step, and the present one."""
        free = surface[0] if self.stale and within else surface[1]
        met = touched | (g > free) if self.flags else g >= free * (1.0 - TIE)
        return np.asarray(met & (g > 0.0 if self.pulls else p >= 0.0))


RIGHT = ContactRule()
