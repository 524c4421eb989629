"""The elements that matter: a window on an endless row that moves with the base.

Element i sits at x_i = i dx + Y(t). It is stored while it is near the indenter, or while the drive
will bring it there again before it has relaxed; every other element counts as undisturbed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.model import Array, Model, span
from kvtheory.scene.base_motion import BaseMotion

FORGOTTEN = 1e-12
"""A compression that has relaxed to this share counts as none."""
KEPT_DEPTH = 16.0
"""Elements are kept within the reach of an indenter this many times as deep as at rest."""


class OutgrownError(ArithmeticError):
    """The indenter sank so deep that it may meet elements that were given up; `rows` as found so far."""

    rows: Sequence[tuple[float, ...]] = ()


@dataclass
class Under:
    """The elements under the indenter at one instant: a view into the row.

    `free` is the compression that each has if the indenter leaves it alone until then, `touched`
    whether it was in contact at the start of the step.
    """

    place: slice
    x: Array
    height: Array
    free: Array
    touched: NDArray[np.bool_]


class Row:
    """The compressions u of the stored elements, first to last, and which of them are in contact."""

    def __init__(self, model: Model, path: BaseMotion, kept_depth: float = KEPT_DEPTH) -> None:
        self.model, self.path = model, path
        self.memory = -model.retardation_time * math.log(FORGOTTEN)
        self.deepest = kept_depth * model.depth
        self.reach = span(model.indenter, self.deepest)
        self.first, self.u, self.touched = 0, np.zeros(0), np.zeros(0, dtype=bool)
        self.updates = 0
        rest = self.under(0.0, 0.0, model.depth)
        self.settle(rest, np.maximum(model.depth - rest.height, 0.0), rest.height <= model.depth)

    def under(self, t: float, delay: float, depth: float) -> Under:
        """Return the elements that an indenter of at most this depth can meet at t, and `delay` before.

        Raises
        ------
        OutgrownError
            If that is deeper than the row was made for.
        """
        if not depth < self.deepest:
            raise OutgrownError
        Y, Y_now = self.path.displacement(t), self.path.displacement(t - delay)
        low = self.model.under(max(Y, Y_now), depth)[0]
        high = self.model.under(min(Y, Y_now), depth)[1]
        if low < self.first or high > self.first + self.u.size:
            self._move(t, low, high)
        place = slice(low - self.first, high - self.first)
        x: Array = self.model.spacing * np.arange(low, high, dtype=np.float64) + Y
        decay = math.exp(-delay / self.model.retardation_time)
        self.updates += high - low
        height = self.model.height(x)
        return Under(place, x, height, decay * self.u[place], self.touched[place])

    def settle(
        self, under: Under, u: Array, touched: NDArray[np.bool_], delay: float = 0.0
    ) -> None:
        """Let `delay` pass: put in what has become of the elements under the indenter."""
        self.u *= math.exp(-delay / self.model.retardation_time)
        self.u[under.place] = u
        self.touched[:] = False
        self.touched[under.place] = touched

    def _move(self, t: float, low: int, high: int) -> None:
        """Move the window so that it holds the elements `low` to `high`, and those still of use."""
        dx, spare = self.model.spacing, high - low
        back, ahead = self.path.extremes(t, min(t + self.memory, max(t, self.path.end)))
        useful = math.floor((self.reach[0] - ahead) / dx), math.ceil((self.reach[1] - back) / dx)
        first = min(low - spare, max(self.first, useful[0]))
        last = max(high + spare, min(self.first + self.u.size, useful[1]))
        u, touched = np.zeros(last - first), np.zeros(last - first, dtype=bool)
        start, stop = max(first, self.first), min(last, self.first + self.u.size)
        if start < stop:
            new, old = (slice(start - f, stop - f) for f in (first, self.first))
            u[new], touched[new] = self.u[old], self.touched[old]
        self.first, self.u, self.touched = first, u, touched
