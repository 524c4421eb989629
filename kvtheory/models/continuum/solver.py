r"""The whole transient without discretizing the foundation: one equation of motion, two edges.

    eps d'' = 1 - f_z - kappa (d - 1),    d(0) = 1, d'(0) = 0, at rest for s < 0

(or from another `Beginning`: at another depth, in contact with ground at rest, or above flat ground)

with f_z in closed form in d, d', lambda and the two edges (fact F11), and another equation along x if the
drive has a spring (`collocation`). Between events the right-hand side is smooth; a step that runs over an
event is cut there, for its polynomial continues the states of the edges that it began with. A fixed
indenter, d = 1, needs no equation along z, only events.
"""

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum import (
    bulk,
    compiled,
    deviation,
    energy,
    evaluation,
    maxima,
    stepping,
    surface,
)
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.compiled import NOTHING, Finished, Solver, finished
from kvtheory.models.continuum.run import (
    STATE_NAMES,
    TOUCHING,
    Beginning,
    Run,
    Spring,
    StepControl,
)
from kvtheory.records import blanks, set_fields, structured, value
from kvtheory.results.errors import TransientError
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion

Array = NDArray[np.float64]

STEP_LIMIT = 300_000
ATTEMPTS = 100
"""Interpreted steps attempted between two reports: short beside loading kernels, as that is decided there."""
REASONS = {
    r_.STUCK: "the step length went to zero",
    r_.INCONSISTENT: "no consistent state of the edges",
}
REVERSAL = "sliding reverses"
"""Kind of an event that occurs on a spring only."""


class Moment(NamedTuple):
    """State at one time in scaled form; edges are NaN and states ``"free"`` in flight."""

    s: float
    depth: float
    rate: float
    acceleration: float
    number: float
    left: float
    right: float
    left_state: str
    right_state: str
    normal_force: float
    friction_force: float


class ScaledEvent(NamedTuple):
    """An event of the contact at the time `s`."""

    s: float
    kind: str


class Trajectory(Finished):
    """A solved transient: evaluate it anywhere in [0, end] with `at` or `states`."""

    @property
    def end(self) -> float:
        """The time at which it ends."""
        return float(value(self.run.given[0], "end"))

    @cached_property
    def events(self) -> tuple[ScaledEvent, ...]:
        """The events of the contact, in order of time."""
        found = structured(self.run.events[: self.counts.events], r_.EVENT).tolist()
        kinds = [ScaledEvent(s, stepping.KINDS[kind]) for s, kind in found]
        return tuple(
            sorted([*kinds, *self._memory(), *self._reversals()], key=lambda event: event.s)
        )

    def _memory(self) -> Iterator[ScaledEvent]:
        """Yield an event where an edge begins or ceases to touch previously deformed ground."""
        sides, left_at = self.records["sides"], self.nodes["inner"]["s"]
        remembers = (sides["state"] == TOUCHING) & (left_at[sides["node"]] > -math.inf)
        changes, sides_of = np.nonzero(remembers[1:] != remembers[:-1])  # none at first
        for at, k in zip((changes + 1).tolist(), sides_of.tolist(), strict=True):
            verb, name = "begins" if remembers[at, k] else "ends", ("left", "right")[k]
            yield ScaledEvent(self.starts[at], f"memory {verb} at the {name} edge")

    def _reversals(self) -> Iterator[ScaledEvent]:
        """Yield when the indenter on a spring begins to slide the other way: where lambda changes sign."""
        if not self.given.sprung:
            return
        before, steps, ends = 0.0, self.records, [*self.starts[1:], self.end]
        spans, rows = steps["span"].tolist(), self.pieces[steps["piece"]].tolist()
        for start, end, span, row in zip(self.starts, ends, spans, rows, strict=True):
            powers = [c * span**k for k, c in enumerate(row[b_.POWERS :])]
            within, share = list[float](), (end - start) / span
            if abs(powers[0]) <= sum(map(abs, powers[1:])):  # else there is no root up to 1
                roots = polynomial.polyroots(np.trim_zeros(powers, "b") or [1.0])
                within = sorted(x for x in roots.real.tolist() if 0.0 < x < share)
            for low, high in pairwise([0.0, *within, share]):
                number = b_.evaluate(row, start + 0.5 * (low + high) * span)[1]
                if number * before < 0.0:
                    yield ScaledEvent(start + low * span, REVERSAL)
                before = number or before

    @cached_property
    def records(self) -> NDArray[Any]:
        """The steps as a structured array, see `run.STEP`."""
        return np.asarray(structured(self.run.steps[: self.counts.steps], r_.STEP))

    @cached_property
    def nodes(self) -> NDArray[Any]:
        """The ground that the edges left, as a structured array, see `run.NODE`."""
        return np.asarray(structured(self.run.nodes[: self.counts.nodes], r_.NODE))

    @cached_property
    def interpreted(self) -> Run:
        """The run with objects for records, as interpreted kernels see it."""
        run = r_.as_objects(self.run) if self.compiled else self.run
        return run._replace(given=run.given[0], method=run.method[0], now=run.now[0])

    @cached_property
    def pieces(self) -> NDArray[np.float64]:
        """The pieces of the base motion, a row for each."""
        return np.array(self.run.pieces)

    @cached_property
    def starts(self) -> list[float]:
        """The times at which the steps begin."""
        return list(self.records["start"].tolist())

    @property
    def natural(self) -> NDArray[np.float64]:
        """Times at which to show the motion, in order: those of the steps, subdivided."""
        return np.asarray(self._natural[0])

    @cached_property
    def _natural(self) -> tuple[Any, Any]:
        """These times, and the states there."""
        times, found = self._room(evaluation.SUBDIVISIONS * self.counts.steps + 1)
        count = self._perform(bulk.NATURAL, times, found)
        return times[:count], found[:count]

    def at(self, s: float) -> Moment:
        """Return the state at `s`; where the drive jumps, just after the jump."""
        row = self.states([s])[0]
        left, right = (STATE_NAMES[state] for state in row["edge_states"].tolist())
        edges = dict(zip(("left", "right"), row["edges"].tolist(), strict=True))
        return Moment(
            s, float(row["depth"]), float(row["depth_rate"]), float(row["acceleration"]),
            float(row["sliding_velocity"]), **edges, left_state=left, right_state=right,
            normal_force=float(row["normal_force"]), friction_force=float(row["friction_force"]),
        )  # fmt: skip

    def states(self, s: ArrayLike, *, peaks: bool = True) -> NDArray[Any]:
        """Return the states at an array of times as a structured array, see `evaluation.STATE`.

        They always have `peaks`, which only on a Prony series are much work.
        """
        times = np.asarray(s, dtype=float)
        if not ((times >= 0.0) & (times <= self.end)).all():
            raise ValueError(f"`s` must lie in [0, {self.end!r}], got {s!r}")
        found = self._records(len(times), evaluation.STATE)
        self._perform(bulk.STATES, self._rows(times), found)
        return np.asarray(structured(found, evaluation.STATE))

    def pressure(self, xi: Array, s: float) -> Array:
        """Return p = d + d' - xi^2 - 2 lambda xi at places of the contact and one time, else zero."""
        now = self.at(s)
        p = now.depth + now.rate - xi * (xi + 2.0 * now.number)
        inside = (now.left <= xi) & (xi <= now.right)  # false in flight, where both are NaN
        return np.where(inside, np.maximum(p, 0.0), 0.0)

    def compression(self, xi: Array, s: float) -> Array:
        """Return the compression of the foundation at places and one time."""
        return surface.height(self, xi, s)

    def ledger(self, s: ArrayLike) -> energy.Ledger:
        """Return the energy ledger at times."""
        return energy.ledger(self, s)

    def impulses(self, s: ArrayLike) -> energy.Impulses:
        """Return the vertical impulses until the times."""
        return energy.impulses(self, self.states, s)

    def deviations(self, other: "Trajectory", times: NDArray[np.float64] | None = None) -> Any:
        """Return the `deviation` of another solution at the `times`, by default the natural ones."""
        if self.compiled != other.compiled:
            one, two = (Trajectory(r_.as_arrays(motion.run)) for motion in (self, other))
            return one.deviations(two, times)
        if times is None:
            at, found = self._natural
        else:
            at = np.sort(times)
            found = self._records(len(at), evaluation.STATE)
            self._perform(bulk.STATES, self._rows(at), found)
        worst = self._records(1, deviation.DEVIATION)
        self._perform(bulk.DEVIATIONS, self._rows(at), found, worst=worst, other=other.run)
        return structured(worst, deviation.DEVIATION)[0]

    @cached_property
    def samples(self) -> tuple[Any, Any, int]:
        """Dense times and the states there, and their number, see `maxima`."""
        times, found = self._room((maxima.SAMPLES + 1) * self.counts.steps)
        return times, found, self._perform(bulk.SAMPLE, times, found)

    def largest(self, *wanted: tuple[str, int]) -> NDArray[Any]:
        """Return the extreme of each quantity in a sense as structured array, see `maxima.EXTREME`."""
        times, found, count = self.samples
        extremes = self._records(len(wanted), maxima.EXTREME)
        for extreme, asked in zip(extremes, wanted, strict=True):
            set_fields(extreme, quantity=evaluation.MEASURED.index(asked[0]), sense=asked[1])
        self._perform(bulk.LARGEST, times, found, extremes=extremes, count=count)
        return np.asarray(structured(extremes, maxima.EXTREME))

    def settled(self, force: float, share: float) -> float:
        """Return the time from which the friction force is settled, see `maxima`."""
        times, found, count = self.samples
        settling = self._records(1, bulk.SETTLING)
        set_fields(settling[0], force=force, share=share)
        self._perform(bulk.SETTLED, times, found, settling=settling, count=count)
        return float(value(settling[0], "time"))

    def _perform(
        self, task: int, times: Any, found: Any, *, worst: Any = NOTHING.worst,
        extremes: Any = NOTHING.extremes, settling: Any = NOTHING.settling, count: int = 0,
        other: Any = None,
    ) -> int:  # fmt: skip
        return compiled.chosen(self.run)(
            task, self.run, other or self.run, times, found, self._two, worst, extremes, settling,
            count, bulk.NO_BULK,
        )  # fmt: skip

    @cached_property
    def _two(self) -> Any:
        return self._records(2, evaluation.STATE)

    def _room(self, count: int) -> tuple[Any, Any]:
        """Return room for times, and for the states there."""
        return self._rows(np.empty(count)), self._records(count, evaluation.STATE)

    def _records(self, count: int, kind: np.dtype[Any]) -> Any:
        """Return blank records, as the kernels need them."""
        return np.zeros(count, kind) if self.compiled else blanks(count, kind)

    def _rows(self, array: Any) -> Any:
        """Return an array as the kernels need it: contiguous, or as lists if they are interpreted."""
        if not self.compiled:
            return array if isinstance(array, list) else array.tolist()
        return array if array.flags.c_contiguous else np.ascontiguousarray(array)


def solve(
    drive: BaseMotion, inertia_number: float, support_number: float, end: float, rtol: float = 1e-9,
    *, spring: Spring | None = None, start: Beginning = Beginning(),  # noqa: B008 - immutable
    fast: bool | None = None, control: StepControl = StepControl(),  # noqa: B008 - immutable
    progress: Callable[[float], Any] | None = None, max_steps: int = STEP_LIMIT,
) -> Trajectory:  # fmt: skip
    """Solve the transient of `drive` from `start`, by default at rest, until `end`, in scaled form.

    The drive must reach `end`. Numbers are eps > 0 (not used if the support is fixed) and kappa >= 0, where
    infinity is the fixed indenter, d = 1. `rtol` is the error allowed all along a step for d' relative to
    1 + |d'|, and for x' likewise. By default the kernels are compiled (`fast`) where that pays, see
    `compilation`; the numbers are the same. `progress` is called with the time reached. Rejected steps count
    towards `max_steps`. TransientError if a step fails, or too many are needed.

    >>> motion = solve(BaseMotion.constant(4.0, end=2.0), 0.04, 0.0, end=2.0)
    >>> print(f"{motion.at(2.0).depth:.6f}")
    0.303968
    """
    if not 0.0 < end <= drive.end:
        raise ValueError(f"`end` must be positive and within the drive, got {end!r}")
    if spring and not (spring.eps > 0.0 and spring.damping >= 0.0 and spring.stiffness >= 0.0):
        raise ValueError("expected a `spring` with inertia > 0, stiffness and damping >= 0")
    if not (inertia_number > 0.0 and support_number >= 0.0 and 1e-13 <= rtol <= 1e-2):
        raise ValueError(
            "expected `inertia_number` > 0, `support_number` >= 0, 1e-13 <= `rtol` <= 1e-2"
        )
    numbers = float(inertia_number), float(support_number)
    given = drive, numbers, spring, float(end), rtol, control, start
    followed = Solver(
        kernel=compiled.KERNEL, attempts=ATTEMPTS,
        begin=lambda arrays: r_.begin(*given, arrays=arrays), prepared=compiled.prepared,
        as_arrays=r_.as_arrays, with_more_room=r_.with_more_room, walk=_walk,
        time=lambda run: float(value(run.now[0], "s")), refused=REASONS, failure=TransientError,
    )  # fmt: skip
    return Trajectory(finished(followed, end, max_steps, fast, progress))


def _walk(run: Run, attempts: int) -> int:
    return compiled.chosen(run)(bulk.WALK, run, run, *NOTHING, attempts, bulk.NO_BULK)
