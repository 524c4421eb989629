"""The stored elements: a window on an infinite row that moves with the base.

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
from kvtheory.models.elements.model import Model, span
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES, Scheme
from kvtheory.scene.base_motion import SAME_TIME, BaseMotion, evaluate
from kvtheory.theory.laws import Array, Element

FORGOTTEN = 1e-12
"""A compression that has relaxed to this share counts as zero."""
KEPT_DEPTH = 4.0
"""Elements are kept within the reach of an indenter this many times as deep as at rest."""
WORTHWHILE = 10_000
"""Number of interpreted steps of a strip after which compiling pays: about a second. Loading the compiled
kernels takes half a second; compiling them, once per installation, about twenty seconds."""


class OutgrownError(ArithmeticError):
    """The indenter sank so deep that it may meet elements no longer stored."""


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
    """Number of steps of a strip interpreted in this process."""

    steps = 0


@cache
def compiled_advance() -> Any:
    """Return `kernels.advance`, compiled."""
    compilation.register(kernels, compiled=kernels.COMPILED, _nrt=False)
    return compilation.cached(kernels.advance, _nrt=False)


class ElementRow:
    """The stored elements, the motion of the base, and the indenter above them, moved by a scheme.

    `compiled` says whether its steps are compiled.
    """

    def __init__(
        self, model: Model, path: BaseMotion, scheme: Scheme = SCHEMES[DEFAULT],
        kept_depth: float = KEPT_DEPTH,
    ) -> None:  # fmt: skip
        self.model, self.path, self.compiled, law = model, path, False, model.law
        if not model.rule.relaxes:
            law = law._replace(rates=0.0 * law.rates)
        self.memory = -math.log(FORGOTTEN) * (law.longest_time if law.rates.any() else math.inf)
        self.deepest, self.state = kept_depth * model.depth, np.zeros(kernels.CURVED + 1)
        shared = ((name, getattr(model, name, None)) for name in Elements._fields)
        self.constants: dict[str, Any] = {
            name: float(x) if isinstance(x, float) else x for name, x in shared if x is not None
        } | {
            "law": law, "tableau": scheme.table, "fitted": scheme.fitted, "deepest": self.deepest,
            "rest_velocity": model.at_rest.velocity, "profile": model.profile,
            "faded": np.ones(law.rates.size),
            "kinks": np.array(model.indenter.kinks, dtype=float),
        }  # fmt: skip
        self.stored = self._empty(0, 1, 1)
        depth = model.start * model.depth
        self.lay(depth, lambda x, y: np.maximum(depth - model.height(x, y), 0.0))
        self.state[kernels.DEPTH], self.state[kernels.FORCES] = depth, model.weight

    def compile(self, steps: int) -> None:
        """Compile if that pays: once so much was interpreted in this process, or will be in these steps."""
        work = steps * self.stored.low.size
        pays = Tally.steps + work > WORTHWHILE and compilation.available()
        Tally.steps = max(Tally.steps, WORTHWHILE) if pays else Tally.steps + work
        self.compiled = pays and self.model.profile is None

    def lay(self, depth: float, surface: Any, contact: Any = None) -> None:
        """Press the indenter to a depth into elements at Y = 0 that are compressed by `surface`(x, y).

        In contact are those where `contact`(x) or, without it, those that are compressed.
        """
        while kernels.set_window(self.stored, (0.0, 0.0), depth) == kernels.LACKING:
            self._move(0.0)
        row = self.stored
        for each in (row.modes, row.rows, row.flags):
            each[...] = 0
        for j in range(int(row.counts[kernels.STRIPS])):
            part = slice(row.low[j], row.high[j])
            x = row.spacing * row.numbers[part]
            u = surface(x, j * row.across)
            row.rows[kernels.U, j, part] = u
            row.flags[kernels.TOUCHED, j, part] = contact(x) if contact else u > 0.0
            if not row.law.arm_time.size:
                row.modes[0, j, part] = u
        self._begin()
        kernels.approach(row, np.ones_like(row.faded), 0.0, 0.0, depth)
        kernels.add_kinks(row, row.law.step(1.0), 0.0)
        kernels.begin(row)

    def run(
        self, course: Course, found: Array, begin: tuple[int, int], until: int
    ) -> tuple[int, int, int]:
        """Take steps up to `until` or a failure; return the status, and the steps and reports done."""
        advance = compiled_advance() if self.compiled else kernels.advance
        status, (step, reported) = kernels.LACKING, begin
        while status == kernels.LACKING:
            status, step, reported = advance(
                self.stored, self.state, course, found, step, reported, until
            )
            if status == kernels.LACKING:
                self._move(float(course.times[step]))
        return status, step, reported

    def step(self, state: IndenterState, h: float) -> IndenterState:
        """Take one step from a state.

        Raises
        ------
        OutgrownError
            If the indenter sinks deeper than the row was made for.
        """
        self.state[:4] = state[1:]
        times = state.time + np.array([0.0, h])
        course = course_of(self.path, self.stored.law, times, np.array([h]))
        if self.run(course, np.zeros((0, 1)), (0, 0), 1)[0]:
            raise OutgrownError
        return IndenterState(state.time + h, *map(float, self.state[:4]))

    def states(self) -> tuple[Array, Array]:
        """Return u of all stored elements, and the forces of their arms."""
        row, law = self.stored, self.stored.law
        modes = row.modes * row.faded[:, None, None]
        u = np.tensordot(law.shares, modes, 1)
        if not law.arm_time.size:
            return u, modes[:0]
        touched = row.flags[kernels.TOUCHED]
        u = np.where(touched, row.rows[kernels.U], u)
        free = law.arm_stiffness[:, None, None] * (u - np.tensordot(law.from_modes, modes, 1))
        return u, np.where(touched, row.modes, free)

    def _empty(self, first: int, width: int, strips: int, runs: int = 0) -> Elements:
        """Return elements that are undisturbed."""
        law, runs = self.model.law, max(runs, 2 * strips)
        low, high, counts = (np.zeros(n, np.int64) for n in (strips, strips, kernels.UPDATES + 1))
        counts[kernels.FIRST], (begun, ended) = first, np.zeros((2, runs, 3), dtype=np.int64)
        return Elements(
            modes=np.zeros((law.rates.size, strips, width)), rows=np.zeros((5, strips, width)),
            flags=np.zeros((2, strips, width), dtype=bool), low=low, high=high, counts=counts,
            numbers=np.arange(float(first), first + width) + self.model.shift, begun=begun, ended=ended,
            edges=np.zeros((runs, 2, 3)), weights=np.ones(strips), ramps=np.zeros(law.arm_time.size),
            stages=np.zeros((7, max(4, law.rates.size))), **self.constants,
        )  # fmt: skip

    def _move(self, t: float) -> None:
        """Move the window so that it holds the missing elements, and those still of use."""
        old = self.stored
        first, low, high, strips, runs, *_ = old.counts.tolist()
        rows, width = old.flags.shape[1:]
        spare, useful = (high - low) // 2, self._useful(t)
        start = min(low - spare, max(first, useful[0]))
        stop = max(high + spare, min(first + width, useful[1]))
        new = self._empty(start, stop - start, max(strips, rows), max(2 * runs, len(old.edges)))
        new.counts[kernels.UPDATES] = old.counts[kernels.UPDATES]
        new.counts[kernels.STRIPS] = rows
        kept, last = max(start, first), min(stop, first + width)
        if kept < last:
            to, of = slice(kept - start, last - start), slice(kept - first, last - first)
            for name in ("modes", "rows", "flags"):
                getattr(new, name)[:, :rows, to] = getattr(old, name)[..., of]
        new.low[:rows], new.high[:rows] = 0, stop - start
        new.edges[: len(old.edges)] = old.edges[..., [kernels.OLD, kernels.OLD, kernels.FALLS]]
        self.stored = new
        self._begin()

    def _begin(self) -> None:
        """Find the runs of elements in contact."""
        row = self.stored
        row.rows[kernels.HEIGHT] = np.where(row.flags[kernels.TOUCHED], -1.0, 1.0)
        kernels.find_runs(row, kernels.HEIGHT, 0.0)
        kernels.begin(row)

    def _useful(self, t: float) -> tuple[int, int]:
        """Return which elements may be met again: where the drive leads; a spring, to any not forgotten."""
        dx, row = self.model.spacing, self.stored
        if self.model.sprung:
            compressed = np.abs(self.states()[0]) > FORGOTTEN * self.model.depth
            known = np.flatnonzero((compressed | row.flags[kernels.TOUCHED]).any(axis=0))
            first = int(row.counts[kernels.FIRST])
            return first + int(known.min(initial=0)), first + int(known.max(initial=-1)) + 1
        back, ahead = self.path.extremes(t, min(t + self.memory, max(t, self.path.end)))
        low, high = span(self.model.indenter, self.deepest)
        return math.floor((low - ahead) / dx), math.ceil((high - back) / dx)


def course_of(
    path: BaseMotion, law: Element, times: Array, steps: Array, after: Any = (), about: Any = (),
    limits: Sequence[float] = (-math.inf, math.inf, math.inf),
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

    reports = np.array(about, dtype=float).reshape(len(after), 5)
    lengths, which = np.unique(steps, return_inverse=True)
    over = law.step(np.append(0.0, np.outer(lengths, (0.5, 1.0))))
    times = np.ascontiguousarray(times)  # the kernels are compiled once, for this layout
    return Course(times, motion(t)[0], motion(before)[1], np.array(after, dtype=np.int64), reports,
                  np.array(limits), over, which)  # fmt: skip
