"""Which elements press on the indenter: the rule of the paper, and mistakes that people make.

Explicit schemes ask it in every stage; the implicit ones rest on the exact memory, which needs no rule.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

TIE = 1e-9
"""Relative: an element in contact is on the surface, up to rounding."""


class ContactRule(NamedTuple):
    """How an element is found to press; each field that is not the default is a mistake.

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
