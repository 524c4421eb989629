"""The stored elements: a window on an infinite row that moves with the base.

Element i sits at x_i = (i + shift) dx + Y(t). It is stored while it is near the indenter, or while the
drive will bring it there again before it has relaxed; every other element counts as undisturbed. A ball has a
row for each strip, at y = 0, dy, ...
"""

import math
from contextlib import nullcontext
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from kvtheory.compilation import ALIKE, Kernel
from kvtheory.models.elements import kernels
from kvtheory.models.elements.kernels import Constants, Course, Row
from kvtheory.models.elements.model import span
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES, Scheme
from kvtheory.scene.base_motion import SAME_TIME, BaseMotion, evaluate
from kvtheory.theory.laws import Array, Element

FORGOTTEN = 1e-12
"""A compression that has relaxed to this share counts as zero."""
KEPT_DEPTH = 4.0
"""Elements are kept within the reach of an indenter this many times as deep as at rest."""
SECONDS = 11.0
"""Time to compile, once per installation."""

KERNEL = Kernel(kernels.advance, (kernels,), SECONDS)


class OutgrownError(ArithmeticError):
    """The indenter sank so deep that it may meet elements no longer stored."""


class IndenterState(NamedTuple):
    """Time (s), depth (m) and rate (m/s), and both along x, the way of the base on the spring."""

    time: float
    depth: float
    rate: float
    along: float = 0.0
    along_rate: float = 0.0


class ElementRow:
    """The stored elements and the indenter, at rest in them, above a moving base; `compiled` or not."""

    def __init__(
        self, constants: Constants, path: BaseMotion, scheme: Scheme = SCHEMES[DEFAULT],
        kept_depth: float = KEPT_DEPTH,
    ) -> None:  # fmt: skip
        self.constants, self.path, self.compiled = constants, path, False
        self.tableau, self.fitted = scheme.table, scheme.fitted
        self.deepest, self.state = kept_depth * constants.depth, np.zeros(kernels.CURVED + 1)
        self.faded, depth = np.ones(constants.law.rates.size), constants.depth
        self.state[kernels.FORCES] = constants.weight
        self.stored = self._empty(0, 1, 1)
        height = partial(kernels.surface_at, constants.surface)
        self.lay(depth, lambda x, y: np.maximum(depth - height(x, y)[0], 0.0))

    def lay(self, depth: float, surface: Any, contact: Any = None) -> None:
        """Press the indenter into elements compressed by `surface`(x, y), in contact by `contact`(x)."""
        self.state[kernels.DEPTH], self.stored.counts[kernels.BEGUN] = depth, 0
        while kernels.set_window(self.stored, (0.0, 0.0), depth) == kernels.LACKING:
            self._move(0.0)
        row, law = self.stored, self.constants.law
        row.modes[...], row.flags[...] = 0.0, False
        kernels.approach(row, np.zeros_like(self.faded), 0.0, depth)
        for j in range(int(row.counts[kernels.STRIPS])):
            part = slice(row.low[j], row.high[j])
            x = self.constants.spacing * row.numbers[part]
            u = surface(x, j * self.constants.across)
            row.rows[kernels.MEETS, j, part] += u
            row.flags[:, j, part] = contact(x) if contact else u > 0.0
            if not law.arm_time.size:
                row.modes[0, j, part] = u
        kernels.find_runs(row)
        kernels.add_kinks(row, law.step(1.0), 0.0)
        kernels.begin(row, depth)

    def compile(self, course: Course, found: Array, left: float = 0.0) -> None:
        """Go on compiled if that pays, as steps would take `left` interpreted; profiles cannot be."""
        if (
            not self.compiled
            and self.constants.surface.profile is None
            and KERNEL.worthwhile(left, ALIKE)
        ):
            self.compiled = KERNEL.prepared(self.stored, course, found, 0, 0, 0)

    @np.errstate(all="ignore")  # the kernels check the results
    def run(
        self, course: Course, found: Array, begin: tuple[int, int], until: int
    ) -> tuple[int, int, int]:
        """Take steps up to `until` or a failure; return the status, and the steps and reports done."""
        profile = self.constants.surface.profile is not None
        with nullcontext() if self.compiled or profile else KERNEL.interpreting():
            return self._run(
                KERNEL if self.compiled else kernels.advance, course, found, begin, until
            )

    def _run(
        self, advance: Any, course: Course, found: Array, begin: tuple[int, int], until: int
    ) -> tuple[int, int, int]:
        status, (step, reported) = kernels.LACKING, begin
        while status == kernels.LACKING:
            status, step, reported = advance(self.stored, course, found, step, reported, until)
            if status == kernels.LACKING:
                self._move(float(course.times[step]))
        return status, step, reported

    def step(self, state: IndenterState, h: float) -> IndenterState:
        """Take one step from a state, or raise `OutgrownError` deeper than the row was made for."""
        self.state[:4] = state[1:]
        times = state.time + np.array([0.0, h])
        course = course_of(self.path, self.constants.law, times, np.array([h]))
        if self.run(course, np.zeros((0, 1)), (0, 0), 1)[0]:
            raise OutgrownError
        return IndenterState(state.time + h, *map(float, self.state[:4]))

    def _empty(self, first: int, width: int, strips: int) -> Row:
        """Return elements that are undisturbed."""
        arms, counts = self.constants.law.rates.size, np.zeros(kernels.UPDATES + 1, np.int64)
        counts[kernels.FIRST], runs = first, strips * (width // 2 + 1)
        return Row(
            constants=self.constants, tableau=self.tableau, fitted=self.fitted, deepest=self.deepest,
            state=self.state, modes=np.zeros((arms, strips, width)), faded=self.faded,
            rows=np.zeros((5, strips, width)), flags=np.zeros((3, strips, width), dtype=bool),
            low=np.zeros(strips, np.int64), high=np.zeros(strips, np.int64), counts=counts,
            numbers=np.arange(float(first), first + width) + self.constants.shift,
            begun=np.zeros((runs, 3), np.int64), ended=np.zeros((runs, 3), np.int64),
            edges=np.zeros((runs, 2, 3)), weights=np.ones(strips), stages=np.zeros((7, max(4, arms))),
        )  # fmt: skip

    def _move(self, t: float) -> None:
        """Move the window so that it holds the missing elements, and those still of use."""
        old = self.stored
        first, low, high, strips, count, *_ = old.counts.tolist()
        rows, width = old.flags.shape[1:]
        spare, useful = (high - low) // 2, self._useful(t)
        start = min(low - spare, max(first, useful[0]))
        stop = max(high + spare, min(first + width, useful[1]))
        strips = max(strips, rows)
        new = self._empty(start, stop - start, strips)
        new.counts[kernels.BEGUN :] = old.counts[kernels.BEGUN :]
        kept, last = max(start, first), min(stop, first + width)
        if kept < last:
            to, of = slice(kept - start, last - start), slice(kept - first, last - first)
            for name in ("modes", "rows", "flags"):
                getattr(new, name)[:, :rows, to] = getattr(old, name)[..., of]
        new.begun[:count] = old.begun[:count] + np.array([0, first - start, first - start])
        new.edges[:count] = old.edges[:count]
        self.stored = new

    def _useful(self, t: float) -> tuple[int, int]:
        """Return which elements may be met again: where the drive leads; a spring, to any not forgotten."""
        c, row = self.constants, self.stored
        if math.isfinite(c.mass_along):
            compressed = np.abs(c.law.shares * self.faded @ row.modes.reshape(self.faded.size, -1))
            known = (compressed > FORGOTTEN * c.depth).reshape(row.flags[0].shape)
            known = np.flatnonzero((known | row.flags[kernels.TOUCHED]).any(axis=0))
            first = int(row.counts[kernels.FIRST])
            return first + int(known.min(initial=0)), first + int(known.max(initial=-1)) + 1
        memory = -math.log(FORGOTTEN) * c.law.longest_time
        back, ahead = self.path.extremes(t, min(t + memory, max(t, self.path.end)))
        low, high = span(c.surface, self.deepest)
        return math.floor((low - ahead) / c.spacing), math.ceil((high - back) / c.spacing)


def course_of(
    path: BaseMotion, law: Element, times: Array, steps: Array, after: Any = (), about: Any = (),
    unsure: float = 0.0, limits: Any = (-math.inf, math.inf, math.inf),
) -> Course:  # fmt: skip
    """Return the course of steps between these times, with the motion of the base and of an element."""
    t = np.stack([times[:-1], times[:-1] + 0.5 * steps, times[1:]], axis=1)
    before = t.copy()
    before[:, 2] -= SAME_TIME * np.spacing(t[:, 2])

    def motion(times: Array) -> tuple[Array, Array]:
        k = np.maximum(np.searchsorted(path.starts, times, side="right") - 1, 0)
        pieces: Any = path.rows.T[:, k]
        Y, V, _ = evaluate(pieces, times)  # type: ignore[arg-type]
        return np.asarray(Y, dtype=float), np.asarray(V, dtype=float)

    lengths, which = np.unique(steps, return_inverse=True)
    over = law.step(np.append(0.0, np.outer(lengths, (0.5, 1.0))))
    times = np.ascontiguousarray(times)  # the kernels are compiled once, for this layout
    return Course(
        times, motion(t)[0], motion(before)[1], over, which, np.array(after, dtype=np.int64),
        np.array(about, dtype=float).reshape(len(after), 4), unsure, limits,
    )  # fmt: skip
