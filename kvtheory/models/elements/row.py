"""The elements that matter: a window on an endless row that moves with the base.

Element i sits at x_i = (i + shift) dx + Y(t). It is stored while it is near the indenter, or while the
drive will bring it there again before it has relaxed; every other element counts as undisturbed. A ball has a
row for each strip, at y = 0, dy, ...
"""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from kvtheory import compilation
from kvtheory.models.elements import kernels
from kvtheory.models.elements.kernels import Course, Elements
from kvtheory.models.elements.law import Array
from kvtheory.models.elements.model import Model, span
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES, Scheme
from kvtheory.scene.base_motion import SAME_TIME, BaseMotion, evaluate

FORGOTTEN = 1e-12
"""A compression that has relaxed to this share counts as none."""
KEPT_DEPTH = 4.0
"""Elements are kept within the reach of an indenter this many times as deep as at rest."""
WORTHWHILE = 10_000
"""Steps of a strip that are interpreted before it pays to compile: about a second. To load what is compiled
takes half a second; to compile it, once for an installation, a quarter of a minute."""


class OutgrownError(ArithmeticError):
    """The indenter sank so deep that it may meet elements that were given up; `rows` as found so far."""

    rows: Sequence[tuple[float, ...]] = ()


class IndenterState(NamedTuple):
    """Time (s), depth (m) and its rate (m/s), and both along x.

    `along` is how far the base has dragged the indenter on its spring, 0 on a rigid drive.
    """

    time: float
    depth: float
    rate: float
    along: float = 0.0
    along_rate: float = 0.0


class Tally:
    """How many steps of a strip were interpreted in this process."""

    steps = 0


@cache
def compiled_advance() -> Any:
    """Return `kernels.advance`, compiled."""
    return compilation.kept(kernels.advance, kernels)


class ElementRow:
    """The stored elements, the motion of the base, and the indenter above them.

    `compiled` says whether its steps are compiled.
    """

    def __init__(self, model: Model, path: BaseMotion, kept_depth: float = KEPT_DEPTH) -> None:
        self.model, self.path = model, path
        longest = model.law.longest_time if model.rule.relaxes else math.inf
        self.memory = -longest * math.log(FORGOTTEN)
        self.deepest = kept_depth * model.depth
        self.constants = model.constants(SCHEMES[DEFAULT], self.deepest)
        self.state = np.zeros(kernels.LAST + 1)
        self.state[kernels.DEPTH] = depth = model.start * model.depth
        self.stored = self._empty(0, 1, 1)
        rest = lambda x, y: np.maximum(depth - model.height(x, y), 0.0)  # noqa: E731
        self.lay(max(depth, model.depth), rest)
        self.state[kernels.DEPTH] = depth
        self.compiled = False

    def lay(self, depth: float, surface: Any, contact: Any = None) -> None:
        """Compress the elements that an indenter of this depth meets at Y = 0 by `surface`(x, y).

        In contact are those where `contact`(x) or, without it, those that are compressed.
        """
        while kernels.attend(self.stored, 0.0, (0.0, 0.0), depth) == kernels.LACKING:
            self._move(0.0)
        row = self.stored
        for each in (row.u, row.arms, row.touched):
            each[...] = 0
        for j in range(row.u.shape[0]):
            part = slice(row.low[j], row.high[j])
            x, y = kernels.positions(row, row.low[j], row.high[j], 0.0), j * row.across
            row.u[j, part] = surface(x, y)
            row.touched[j, part] = contact(x) if contact else row.u[j, part] > 0.0

    def _empty(self, first: int, width: int, strips: int) -> Elements:
        shape = strips, width
        ends, work = np.zeros((4, strips), dtype=np.int64), np.zeros((5, *shape))
        counts, flags = (
            np.zeros(kernels.UPDATES + 1, dtype=np.int64),
            np.zeros((2, *shape), dtype=bool),
        )
        counts[kernels.FIRST] = first
        return Elements(
            u=work[0], arms=np.zeros((self.model.law.arm_stiffness.size, *shape)), since=work[1],
            touched=flags[0], pressed=flags[1], low=ends[0], high=ends[1],
            first=ends[2], last=ends[3], counts=counts,
            numbers=np.arange(float(first), first + width) + self.model.shift, rest=work[2],
            height=work[3], meets=work[4], slope=np.zeros(shape if self.model.sprung else (0, 0)),
            **self.constants,
        )  # fmt: skip

    def use(self, scheme: Scheme) -> None:
        """Take the steps from here on by a scheme."""
        self.constants = self.model.constants(scheme, self.deepest)
        self.stored = self.stored._replace(**self.constants)

    def run(
        self, course: Course, found: Array, balances: Array, begin: tuple[int, int], until: int
    ) -> tuple[int, int, int]:
        """Take steps until one of them, or until something is wrong; return what, and how far it came."""
        advance = compiled_advance() if self.compiled else kernels.advance
        step, reported = begin
        while True:
            status, step, reported = advance(
                self.stored, self.state, course, balances, found, step, reported, until
            )
            if status != kernels.LACKING:
                return status, step, reported
            self._move(float(course.times[step]))

    def step(self, scheme: Scheme, state: IndenterState, h: float) -> IndenterState:
        """Take one step from a state.

        Raises
        ------
        OutgrownError
            If the indenter sinks deeper than the row was made for.
        """
        if self.stored.tableau.shape != scheme.table.shape or self.stored.fitted != scheme.fitted:
            self.use(scheme)
        self.state[:4] = state[1:]
        course = course_of(self.path, np.array([state.time, state.time + h]), np.array([h]))
        if (
            self.run(course, np.zeros((0, 13)), np.zeros((2, kernels.WINDOW)), (0, 0), 1)[0]
            != kernels.DONE
        ):
            raise OutgrownError
        return IndenterState(state.time + h, *map(float, self.state[:4]))

    def _move(self, t: float) -> None:
        """Move the window so that it holds the elements that are lacking, and those still of use."""
        old = self.stored
        first, low, high, strips, _ = old.counts.tolist()
        spare, useful = (high - low) // 2, self._useful(t)
        start = min(low - spare, max(first, useful[0]))
        stop = max(high + spare, min(first + old.u.shape[1], useful[1]))
        new = self._empty(start, stop - start, max(strips, old.u.shape[0]))
        new.counts[kernels.UPDATES] = old.counts[kernels.UPDATES]
        kept, last = max(start, first), min(stop, first + old.u.shape[1])
        if kept < last:
            rows, to, of = (
                old.u.shape[0],
                slice(kept - start, last - start),
                slice(kept - first, last - first),
            )
            for name in ("u", "arms", "since", "touched"):
                getattr(new, name)[..., :rows, to] = getattr(old, name)[..., of]
            for name in ("low", "high", "first", "last"):
                moved = getattr(old, name) + first - start
                getattr(new, name)[:rows] = np.clip(moved, 0, stop - start)
        self.stored = new

    def _useful(self, t: float) -> tuple[int, int]:
        """Return which elements may be met again: where the drive leads; a spring, to any not forgotten."""
        dx, row = self.model.spacing, self.stored
        if self.model.sprung:
            compressed = np.abs(self.states(t)[0]) > FORGOTTEN * self.model.depth
            known = np.flatnonzero((compressed | row.touched).any(axis=0))
            first = int(row.counts[kernels.FIRST])
            return (
                (first + int(known[0]), first + int(known[-1]) + 1)
                if known.size
                else (first, first)
            )
        back, ahead = self.path.extremes(t, min(t + self.memory, max(t, self.path.end)))
        low, high = span(self.model.indenter, self.deepest)
        return math.floor((low - ahead) / dx), math.ceil((high - back) / dx)

    def states(self, t: float) -> tuple[Array, Array]:
        """Return u of all stored elements at a time, and the forces of their arms."""
        row, law = self.stored, self.stored.law
        past = t - row.since
        for j in range(past.shape[0]):
            past[j, row.low[j] : row.high[j]] = 0.0
        if not row.arms.size:
            return row.u * np.exp(-law.rates[0] * past), row.arms
        modes = row.arms * np.exp(-law.rates[:, None, None] * past)
        u = np.where(row.touched, row.u, np.tensordot(law.shares, modes, 1))
        free = law.arm_stiffness[:, None, None] * (u - np.tensordot(law.from_modes, modes, 1))
        return u, np.where(row.touched, row.arms, free)


def course_of(
    path: BaseMotion, times: Array, steps: Array, after: Sequence[int] = (), about: Any = (),
    limits: Sequence[float] = (-math.inf, math.inf, math.inf),
) -> Course:  # fmt: skip
    """Return the course of steps between these times, with the motion of the base."""
    t = np.stack([times[:-1], times[:-1] + 0.5 * steps, times[1:]], axis=1)
    before = t.copy()
    before[:, 2] -= SAME_TIME * np.spacing(t[:, 2])
    Y, V = motion(path, t)[0], motion(path, before)[1]
    reports = np.array(about, dtype=float).reshape(len(after), 5)
    return Course(times, steps, Y, V, np.array(after, dtype=np.int64), reports, np.array(limits))


def motion(path: BaseMotion, times: Array) -> tuple[Array, Array]:
    """Return Y and V at all these times."""
    k = np.maximum(np.searchsorted(path.starts, times, side="right") - 1, 0)
    pieces: Any = path.rows.T[:, k]
    at: Any = times
    Y, V, _ = evaluate(pieces, at)
    return np.asarray(Y, dtype=float), np.asarray(V, dtype=float)
