"""Rules of contact: when an element follows the indenter, and what it does when it does not.

The right rules are those of the paper (Eqs. 20-25). The others are mistakes that a simulator may make;
what one does to a scene is its difference to the right rules in the same scheme (`schemes.ruled`).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.law import Array

Flags = NDArray[np.bool_]

FIRST_STAGE = 1.0 / 6.0
"""Weight of the first stage of RK4, for which alone the surface of the last step is the present one."""


class Meeting(NamedTuple):
    """The elements near the indenter as a rule sees them, at an instant within a step or at its end.

    `g` is how deep each would be if it followed the indenter, `p` its pressure then; `free` is how deep it
    is if left alone since the start of the step, when it was at `surface`, in contact where `touched`.
    """

    g: Array
    p: Array
    free: Array
    surface: Array
    touched: Flags


class Rule(NamedTuple):
    """How much of its pressure each element gives within a step, and which are in contact at its end.

    `relaxes` says whether the free surface does, `pulls` whether contact may bear tension.
    """

    press: Callable[[Meeting], Array | Flags]
    keep: Callable[[Meeting], Flags]
    relaxes: bool = True
    pulls: bool = False


def _right(at: Meeting) -> Flags:
    """Contact ends where the pressure vanishes and begins where the surface is met."""
    return np.asarray((at.touched | (at.g > at.free)) & (at.p >= 0.0))


def _sticking(at: Meeting) -> Flags:
    return np.asarray(at.g > 0.0)


def _anew(at: Meeting) -> Flags:
    return np.asarray((at.g >= at.surface) & (at.g > 0.0) & (at.p >= 0.0))


def _stale(at: Meeting) -> Array:
    return np.where(_anew(at), 1.0, FIRST_STAGE * _right(at))


RULES = {
    "right": Rule(_right, _right),
    "tension": Rule(_sticking, _sticking, pulls=True),
    "stale": Rule(_stale, _right),
    "unrelaxed": Rule(_anew, _anew, relaxes=False),
    "frozen": Rule(_right, _right, relaxes=False),
}
"""The right rules, and mistakes: tension is allowed at the trailing edge; the surface of the last step is
taken for the present one, so that contact is lost where the indenter rises; besides, the free surface
does not relax; it does not relax where the indenter comes back to it."""
