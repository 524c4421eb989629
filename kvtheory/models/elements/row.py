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
from kvtheory.models.elements import kernels as k_
from kvtheory.models.elements.kernels import (
    Constants,
    Course,
    Edges,
    Elements,
    Instants,
    Limits,
    Motion,
    Row,
    Runs,
)
from kvtheory.models.elements.model import span
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES, Scheme
from kvtheory.records import blanks, readable, structured
from kvtheory.scene.base_motion import SAME_TIME, BaseMotion, evaluate
from kvtheory.scene.start import StartState
from kvtheory.theory.laws import Array, Element

FORGOTTEN = 1e-12
"""A compression that has relaxed to this share counts as zero."""
KEPT_DEPTH = 4.0
"""Elements are kept within the reach of an indenter this many times as deep as at rest."""
NEVER = Instants(np.zeros(0, np.int64), *np.zeros((4, 0)))
"""No instants are reported."""
UNLIMITED = Limits(-math.inf, math.inf, math.inf)
"""A run goes on however unstable it is."""
INLINED = "run_at", "set_window", "find_runs", "press"
"""Kernels that explicit stages call: a call hands over each array of a row anew."""
SECONDS = 11.0
"""Time to compile, once per installation."""

KERNEL = Kernel(kernels.advance, (kernels,), SECONDS, INLINED)


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
    """The stored elements and the indenter, at rest in them or above, on a moving base; `compiled` or not."""

    def __init__(
        self, constants: Constants, path: BaseMotion, scheme: Scheme = SCHEMES[DEFAULT],
        kept_depth: float = KEPT_DEPTH, start: StartState | None = None,
    ) -> None:  # fmt: skip
        self.constants, self.path, self.compiled = constants, path, False
        depth, rate, along_rate, along = start or StartState(constants.depth, 0.0, 0.0)
        self.deepest = kept_depth * max(constants.depth, depth)
        self.faded, tableau = np.ones(constants.law.rates.size), scheme.table
        (now,), (counts,) = blanks(1, k_.INDENTER), blanks(1, k_.COUNTS)
        now.mean_force, now.rate = constants.weight, rate
        now.along, now.along_rate = along, along_rate
        self.stored = Row(
            constants=constants, tableau=tableau, fitted=scheme.fitted, deepest=self.deepest, now=now,
            counts=counts, faded=self.faded, rates=Motion(*np.zeros((4, len(tableau)))),
            begun=Runs(*np.zeros((3, 1), np.int64)), ended=Runs(*np.zeros((3, 1), np.int64)),
            edges=Edges(np.zeros((1, 2)), np.zeros((1, 2)), np.zeros((1, 2), dtype=bool)),
            dampers=np.zeros(self.faded.size), **self._undisturbed(0, 1, 1),
        )  # fmt: skip
        height = partial(kernels.surface_at, constants.surface)
        self.lay(depth, lambda x, y: np.maximum(depth - height(x, y)[0], 0.0))

    def lay(self, depth: float, surface: Any, contact: Any = None) -> None:
        """Press the indenter into elements compressed by `surface`(x, y), in contact by `contact`(x)."""
        self.stored.now.depth, self.stored.counts.begun = depth, 0
        while kernels.set_window(self.stored, (0.0, 0.0), depth) == kernels.LACKING:
            self._move(0.0)
        row, law = self.stored, self.constants.law
        of = row.elements
        flags = of.touched, of.changed, of.pressed
        for each in (row.modes, *flags):
            each[...] = 0
        kernels.approach(row, np.zeros_like(self.faded), 0.0, depth)
        for j in range(row.counts.strips):
            part = slice(row.low[j], row.high[j])
            x = self.constants.spacing * row.numbers[part]
            u = surface(x, j * self.constants.across)
            of.threshold[j, part] += u
            for each in flags:
                each[j, part] = contact(x) if contact else u > 0.0
            if not law.arm_time.size:
                row.modes[0, j, part] = u
        kernels.find_runs(row)
        kernels.add_kinks(row, law.step(1.0), 0.0)
        kernels.begin(row, depth)

    def compile(self, course: Course, left: float = 0.0) -> None:
        """Go on compiled if that pays, as steps would take `left` interpreted; profiles cannot be.

        The records of the row are then such as compiled kernels take.
        """
        if self.compiled or self.constants.surface.profile or not KERNEL.worthwhile(left, ALIKE):
            return
        now, counts = self.stored.now, self.stored.counts
        stored = self.stored._replace(
            now=structured([now], k_.INDENTER)[0], counts=structured([counts], k_.COUNTS)[0]
        )
        if KERNEL.prepared(stored, course, np.zeros(0, k_.REPORT), 0, 0, 0):
            self.stored, self.compiled = stored, True

    @np.errstate(all="ignore")  # the kernels check the results
    def run(
        self, course: Course, found: Any, begin: tuple[int, int], until: int
    ) -> tuple[int, int, int]:
        """Take steps up to `until` or a failure; return the status, and the steps and reports done.

        What is reported is written into `found`, see `reports`.
        """
        profile = self.constants.surface.profile is not None
        with nullcontext() if self.compiled or profile else KERNEL.interpreting():
            return self._run(
                KERNEL if self.compiled else kernels.advance, course, found, begin, until
            )

    def _run(
        self, advance: Any, course: Course, found: Any, begin: tuple[int, int], until: int
    ) -> tuple[int, int, int]:
        status, (step, reported) = kernels.LACKING, begin
        while status == kernels.LACKING:
            status, step, reported = advance(self.stored, course, found, step, reported, until)
            if status == kernels.LACKING:
                self._move(float(course.times[step]))
        return status, step, reported

    def step(self, state: IndenterState, h: float) -> IndenterState:
        """Take one interpreted step from a state, or raise `OutgrownError` deeper than the row reaches."""
        now = self.stored.now
        now.depth, now.rate, now.along, now.along_rate = state[1:]
        times = state.time + np.array([0.0, h])
        course = course_of(self.path, self.constants.law, times, np.array([h]))
        status, *_ = self.run(course, self.reports(0), (0, 0), 1)
        if status != kernels.DONE:
            raise OutgrownError
        found = now.depth, now.rate, now.along, now.along_rate
        return IndenterState(state.time + h, *map(float, found))

    def reports(self, count: int) -> Any:
        """Return so many blank reports."""
        return np.zeros(count, k_.REPORT) if self.compiled else blanks(count, k_.REPORT)

    def _undisturbed(self, first: int, width: int, strips: int) -> dict[str, Any]:
        """Return what a row has for each element and each strip, all undisturbed."""
        shape = strips, width
        return {
            "first": first, "numbers": np.arange(float(first), first + width) + self.constants.shift,
            "modes": np.zeros((self.faded.size, *shape)),
            "elements": Elements(*np.zeros((5, *shape)), *np.zeros((3, *shape), dtype=bool)),
            "low": np.zeros(strips, np.int64), "high": np.zeros(strips, np.int64),
            "weights": np.ones(strips),
        }  # fmt: skip

    def _move(self, t: float) -> None:
        """Move the window so that it holds the missing elements, and those still of use."""
        old, counts, first = self.stored, readable(self.stored.counts), self.stored.first
        strips, width = old.elements.u.shape
        spare, useful = (counts.high - counts.low) // 2, self._useful(t)
        start = min(counts.low - spare, max(first, useful[0]))
        stop = max(counts.high + spare, min(first + width, useful[1]))
        new = self._undisturbed(start, stop - start, max(counts.strips, strips))
        row = self.stored = with_room(old._replace(**new))
        kept, last = max(start, first), min(stop, first + width)
        if kept < last:
            to, of = slice(kept - start, last - start), slice(kept - first, last - first)
            for one, other in zip(_blocks(row), _blocks(old), strict=True):
                one[..., :strips, to] = other[..., of]
        row.begun.low[:] += first - start
        row.begun.high[:] += first - start

    def _useful(self, t: float) -> tuple[int, int]:
        """Return which elements may be met again: where the drive leads; a spring, to any not forgotten."""
        c, row = self.constants, self.stored
        if math.isfinite(c.mass_along):
            compressed = np.abs(c.law.shares * self.faded @ row.modes.reshape(self.faded.size, -1))
            touched = row.elements.touched
            free = (compressed > FORGOTTEN * c.depth).reshape(touched.shape)
            known = np.flatnonzero((free | touched).any(axis=0))
            return row.first + int(known.min(initial=0)), row.first + int(known.max(initial=-1)) + 1
        memory = -math.log(FORGOTTEN) * c.law.longest_time
        back, ahead = self.path.extremes(t, min(t + memory, max(t, self.path.end)))
        low, high = span(c.surface, self.deepest)
        return math.floor((low - ahead) / c.spacing), math.ceil((high - back) / c.spacing)


def _blocks(row: Row) -> tuple[Any, ...]:
    """Return all that is known of each element, in three arrays: `Row.elements` are views of two of them."""
    return row.modes, row.elements.u.base, row.elements.touched.base


def with_room(row: Row) -> Row:
    """Return the row with room for as many runs as its elements can form."""
    strips, width = row.elements.u.shape
    more = strips * (width // 2 + 1) - row.begun.strip.size
    if more <= 0:
        return row

    def longer(arrays: Any) -> Any:
        return type(arrays)(
            *(np.concatenate([a, np.zeros((more, *a.shape[1:]), a.dtype)]) for a in arrays)
        )

    return row._replace(begun=longer(row.begun), ended=longer(row.ended), edges=longer(row.edges))


def course_of(
    path: BaseMotion, law: Element, times: Array, steps: Array, instants: Instants = NEVER,
    unsure: float = 0.0, limits: Limits = UNLIMITED,
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
    held = np.zeros((0, 2))
    if path.depths:
        k = np.maximum(np.searchsorted(path.starts, times, side="right") - 1, 0)
        depth, rate = np.array(path.depths)[k].T
        held = np.stack([depth + rate * (times - np.array(path.starts)[k]), rate], axis=1)
    return Course(
        times, motion(t)[0], motion(before)[1], held, over, which, instants, unsure, limits
    )
