"""The elements that matter: a window on an endless row that moves with the base.

Element i sits at x_i = (i + shift) dx + Y(t). It is stored while it is near the indenter, or while the
drive will bring it there again before it has relaxed; every other element counts as undisturbed. A ball has a
row for each strip, at y = 0, dy, ...; they are as long as each other, and one comes after the other.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.law import Array, Step
from kvtheory.models.elements.model import Model, span
from kvtheory.scene.base_motion import BaseMotion

FORGOTTEN = 1e-12
"""A compression that has relaxed to this share counts as none."""
MANY_ARMS = 12
"""With so many, to relax an element that is left alone is most of the work: it is done where needed only."""
KEPT_DEPTH = 16.0
"""Elements are kept within the reach of an indenter this many times as deep as at rest."""


class OutgrownError(ArithmeticError):
    """The indenter sank so deep that it may meet elements that were given up; `rows` as found so far."""

    rows: Sequence[tuple[float, ...]] = ()


class IndenterState(NamedTuple):
    """Time (s), depth (m) and its rate (m/s), and both along x; two forces to judge an explicit step by.

    `along` is how far the base has dragged the indenter on its spring, 0 on a rigid drive. `imbalance`
    says by how much M δ'' over the step differs from the mean of the forces at its ends, and `force` is
    the larger of these and the weight (N/m).
    """

    time: float
    depth: float
    rate: float
    along: float = 0.0
    along_rate: float = 0.0
    imbalance: float = 0.0
    force: float = 0.0


class Under(NamedTuple):
    """The elements under the indenter at one instant, strip by strip.

    `along` are their x, a row, and `across` those y of their strips, a column. `state` is that of each at
    the start of the step, `left` the one that it has now if it was left alone (with many arms, of those not
    in contact at the start), `touched` whether it was in contact at the start; `travel` is the way of the
    base under the indenter between, of the length `delay`, and `law` what the law says of it.
    """

    place: tuple[slice, slice]
    along: Array
    across: Array
    height: Array
    state: Array
    left: Array
    touched: NDArray[np.bool_]
    travel: float
    delay: float
    law: Step

    @property
    def strips(self) -> int:
        """How many strips there are."""
        return self.across.size

    @property
    def x(self) -> Array:
        """Return x of every element."""
        return self._spread(self.along)

    def at(self, elements: Any) -> tuple[Array, Array]:
        """Return x and y of some elements."""
        strip, element = np.divmod(elements, self.along.size)
        return self.along[0, element], self.across[strip, 0]

    def slope(self, model: Model, back: float = 0.0) -> Array:
        """Return dh/dx at every element, so far back."""
        return self._spread(model.slope(self.along - back, self.across))

    def _spread(self, values: Array) -> Array:
        everywhere = np.empty((self.strips, self.along.size))
        everywhere[:] = values
        return everywhere.reshape(-1)

    def rest(self) -> Array:
        """Return where the mean pressure would vanish: it is `law.stiffness` times how far g is below."""
        # Without arms, an element held and one left alone come to the same.
        if len(self.state) == 1:
            return self.left[0]
        held: Array = self.state[0] - self.law.held_pressure @ self.state / self.law.stiffness
        return np.where(self.touched, held, self.left[0])


class ElementRow:
    """The states of the stored elements, first to last, and which of them are in contact.

    `last` is the length of the step by which they came there.
    """

    def __init__(self, model: Model, path: BaseMotion, kept_depth: float = KEPT_DEPTH) -> None:
        self.model, self.path = model, path
        slowest = model.law.slowest if model.rule.relaxes else math.inf
        self.memory = -slowest * math.log(FORGOTTEN)
        self.deepest = kept_depth * model.depth
        self.reach = span(model.indenter, self.deepest)
        self.first, self.states = 0, np.zeros((1 + model.law.arm_stiffness.size, 1, 0))
        self.touched = np.zeros((1, 0), dtype=bool)
        self.updates, self.last = 0, 0.0
        self.many = model.rule.flags and model.law.arm_stiffness.size >= MANY_ARMS
        depth = model.start * model.depth
        start = IndenterState(0.0, depth, 0.0)
        rest = self.under(start, start, 0.0, depth)
        self.settle(
            rest, model.law.at_rest(np.maximum(depth - rest.height, 0.0)), rest.height <= depth
        )

    def place(self, at: IndenterState) -> float:
        """Return Y, by how far the base has moved under the indenter."""
        return self.path.displacement(at.time) - at.along

    def under(self, now: IndenterState, at: IndenterState, delay: float, depth: float) -> Under:
        """Return the elements that an indenter of at most this depth can meet, `now` and `delay` later.

        Raises
        ------
        OutgrownError
            If that is deeper than the row was made for.
        """
        if not depth < self.deepest:
            raise OutgrownError
        Y = self.place(at)
        before = self.place(now) if delay else Y
        low, high = self.model.under(Y, before, depth)
        strips, stored = self.model.strips(depth), self.touched.shape
        if low < self.first or high > self.first + stored[1] or strips > stored[0]:
            self._move(at.time, low, high, strips)
        self.updates += strips * (high - low)
        place = slice(strips), slice(low - self.first, high - self.first)
        x, y = self.model.grid(low, high, strips, Y)
        state = self.states[:, *place].reshape(len(self.states), -1)
        touched, height = self.touched[place].reshape(-1), self.model.height(x, y).reshape(-1)
        left = self._left(state, delay, ~touched if self.many else None)
        law = self.model.law.step(delay)
        return Under(place, x, y, height, state, left, touched, Y - before, delay, law)

    def before(self, under: Under, depth: float, elements: Any) -> Array:
        """Return how far some elements were below the indenter at the start of a step, at this depth."""
        x, y = under.at(elements)
        gap: Array = depth - self.model.height(x - under.travel, y) - under.state[0, elements]
        return gap

    def entering(self, under: Under, depth: float, rise: Array) -> tuple[NDArray[np.intp], Array]:
        """Return the elements that enter the contact in a step, and for how long each is in it.

        `depth` is that at the start; `rise` says how far each is below its free surface at the end.
        """
        new = ((rise > 0.0) & ~under.touched).nonzero()[0]
        gap = self.before(under, depth, new)
        return new, under.delay * rise[new] / (rise[new] - np.minimum(gap, 0.0))

    def pressed(self, under: Under, depth: float, g: Array) -> Array:
        """Return the state of elements that the indenter presses to g, from a `depth` at the start."""
        law, arms = under.law, self.model.law
        if not arms.remembers:
            return g[None, :]
        base = np.where(under.touched, law.held[:, None] * under.state, under.left)
        rise = g - base[0]
        moved: Array = base + law.ramp[:, None] * rise
        moved[0] = g
        new, within = self.entering(under, depth, rise)
        moved[1:, new] = base[1:, new] + arms.ramps(within)[0] * rise[new]
        return moved

    def settle(
        self, under: Under, states: Array, touched: NDArray[np.bool_], delay: float = 0.0
    ) -> None:
        """Let `delay` pass: put in what has become of the elements under the indenter."""
        flat, shape = self.states.reshape(len(self.states), -1), self.states.shape
        elsewhere = None
        if self.many:
            elsewhere = np.ones(shape[1:], dtype=bool)
            elsewhere[under.place] = False
        self.states, self.last = self._left(flat, delay, elsewhere).reshape(shape), delay
        if self.many and delay:
            released = np.flatnonzero(under.touched & ~touched)
            states[:, released] = self._left(under.state[:, released], delay)
        shape = self.states[:, *under.place].shape
        self.states[:, *under.place] = states.reshape(shape)
        self.touched[:] = False
        self.touched[under.place] = touched.reshape(shape[1:])

    def _left(self, states: Array, delay: float, wanted: NDArray[np.bool_] | None = None) -> Array:
        """Return what becomes of elements that are left alone; zero where not `wanted`, or undisturbed."""
        if not (delay and self.model.rule.relaxes):
            return states.copy()
        law = self.model.law.step(delay)
        if wanted is None:
            return law.alone(states)
        columns = np.flatnonzero(states[[0, -1]].any(axis=0) & wanted.ravel())
        left = np.zeros_like(states)
        left[:, columns] = law.alone(states[:, columns])
        return left

    def _move(self, t: float, low: int, high: int, strips: int) -> None:
        """Move the window so that it holds the elements `low` to `high` of strips, and those still of use."""
        spare, useful = high - low, self._useful(t)
        first = min(low - spare, max(self.first, useful[0]))
        rows, elements = self.touched.shape
        last = max(high + spare, min(self.first + elements, useful[1]))
        touched = np.zeros((max(strips, rows), last - first), dtype=bool)
        states = np.zeros((len(self.states), *touched.shape))
        start, stop = max(first, self.first), min(last, self.first + elements)
        if start < stop:
            new, old = (slice(start - f, stop - f) for f in (first, self.first))
            states[:, :rows, new], touched[:rows, new] = (
                self.states[:, :, old],
                self.touched[:, old],
            )
        self.first, self.states, self.touched = first, states, touched

    def _useful(self, t: float) -> tuple[int, int]:
        """Return which elements may be met again: where the drive leads; a spring, to any not forgotten."""
        if self.model.sprung:
            compressed = np.abs(self.states[0]) > FORGOTTEN * self.model.depth
            known = self.first + np.flatnonzero((compressed | self.touched).any(axis=0))
            return (int(known[0]), int(known[-1]) + 1) if known.size else (self.first, self.first)
        dx = self.model.spacing
        back, ahead = self.path.extremes(t, min(t + self.memory, max(t, self.path.end)))
        return math.floor((self.reach[0] - ahead) / dx), math.ceil((self.reach[1] - back) / dx)
