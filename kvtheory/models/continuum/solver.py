r"""The whole transient without discretizing the foundation: one equation of motion, two edges.

    eps d'' = 1 - f_z - kappa (d - 1),    d(0) = 1, d'(0) = 0, at rest for s < 0

with f_z in closed form in d, d', lambda and the two edges (fact F11), and another equation along x if the
drive has a spring (`coupled`). Between events the right-hand side is smooth; a step that runs over an
event is cut there, for its polynomial continues the states of the edges that it began with. A fixed
indenter, d = 1, needs no equation along z, only events.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum import compiled, deviation, evaluation, maxima, stepping
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.contact import FREE, PEELING, TOUCHING
from kvtheory.models.continuum.events import ScaledEvent, events_of
from kvtheory.models.continuum.run import (
    Run,
    Spring,
    StepControl,
    as_arrays,
    begin,
    with_more_room,
)
from kvtheory.results.errors import TransientError
from kvtheory.scene.base_motion import BaseMotion

STEP_LIMIT = 300_000
ATTEMPTS = 1000
"""Between two looks at how far the run has come."""


REASONS = {
    stepping.STUCK: "the step length went to zero",
    stepping.INCONSISTENT: "no consistent state of the edges",
}


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


STATE_NAMES = {PEELING: "peeling", TOUCHING: "touching", FREE: "free"}


@dataclass(frozen=True)
class Trajectory:
    """A solved transient: evaluate it anywhere in [0, end] with `at` or `states`.

    `rows` is the finished run, with arrays for rows if its kernels were compiled.
    """

    rows: Run

    @property
    def end(self) -> float:
        """The time at which the motion ends."""
        return float(self.rows.given.end)

    @property
    def compiled(self) -> bool:
        """Whether the kernels were compiled, at last."""
        return compiled.in_use(self.rows)

    @property
    def steps(self) -> int:
        """Number of steps taken."""
        return int(self.rows.counts[r_.RECORDS])

    @property
    def rejected(self) -> int:
        """Number of steps repeated."""
        return int(self.rows.counts[r_.REJECTED])

    @property
    def evaluations(self) -> int:
        """Number of evaluations of the equation of motion."""
        return int(self.rows.counts[r_.EVALUATIONS])

    @cached_property
    def events(self) -> tuple[ScaledEvent, ...]:
        """What happened to the contact, in the order of time."""
        return events_of(self)

    @cached_property
    def records(self) -> list[list[float]]:
        """The polynomials of the steps, as lists."""
        return np.array(self.rows.records[: self.steps]).tolist()

    @cached_property
    def nodes(self) -> list[list[float]]:
        """What the edges left behind, as lists."""
        return np.array(self.rows.nodes[: self.rows.counts[r_.NODES]]).tolist()

    @cached_property
    def pieces(self) -> list[list[float]]:
        """The pieces of the drive, as lists."""
        return np.array(self.rows.pieces).tolist()

    @cached_property
    def starts(self) -> list[float]:
        """The times at which the steps begin."""
        return [row[h_.START] for row in self.records]

    @property
    def natural(self) -> NDArray[np.float64]:
        """Times that show all that happens: those of the steps, subdivided."""
        return np.asarray(self._natural[0])

    @cached_property
    def _natural(self) -> tuple[Any, Any]:
        """The natural times, and the states there, as rows for the kernels."""
        count = evaluation.SUBDIVISIONS * self.steps + 1
        times, found = self._room(count)
        count = self._kernel(evaluation.natural)(self.rows, times, found)
        return times[:count], found[:count]

    def at(self, s: float) -> Moment:
        """Return the state at `s`; where the drive jumps, just after the jump."""
        row = self.states([s])[0].tolist()
        for side in (evaluation.LEFT_STATE, evaluation.RIGHT_STATE):
            row[side] = STATE_NAMES[row[side]]
        return Moment(s, *row[: evaluation.PEAK_PRESSURE])

    def states(self, s: ArrayLike) -> NDArray[np.float64]:
        """Return the states at an array of times: a row for each, laid out as in `states`."""
        times = np.asarray(s, dtype=float)
        if not np.all((times >= 0.0) & (times <= self.end)):
            raise ValueError(f"`s` must lie in [0, {self.end!r}], got {s!r}")
        return np.array(self._states(self._rows(times))).reshape(-1, evaluation.SIZE)

    def _states(self, times: Any) -> Any:
        found = self._rows(np.empty((len(times), evaluation.SIZE)))
        self._kernel(evaluation.states)(times, found, self.rows)
        return found

    def deviations(
        self, other: "Trajectory", times: NDArray[np.float64] | None = None
    ) -> list[float]:
        """Return how far another solution is from this one at the natural `times`, or others.

        See `deviation`.
        """
        if self.compiled != other.compiled:
            one, two = (Trajectory(as_arrays(motion.rows)) for motion in (self, other))
            return one.deviations(two, times)
        if times is None:
            at, found = self._natural
        else:
            at = self._rows(np.sort(times))
            found = self._states(at)
        worst, room = (
            self._rows(np.zeros(size)) for size in (deviation.SIZE, (2, evaluation.SIZE))
        )
        self._kernel(deviation.deviations)(at, found, self.rows, other.rows, room, worst)
        return [float(x) for x in worst]

    @cached_property
    def samples(self) -> tuple[Any, Any, int]:
        """Dense times and the states there, and how many they are, see `maxima`."""
        count = (maxima.SAMPLES + 1) * self.steps
        times, found = self._room(count)
        return times, found, self._kernel(maxima.sample)(self.rows, times, found)

    def largest(self, column: int, sense: int = maxima.LARGEST) -> tuple[float, float]:
        """Return when a column of the states is largest, and its value, see `maxima`."""
        room = self._rows(np.empty(evaluation.SIZE))
        s, value = self._kernel(maxima.largest)(self.rows, *self.samples, column, sense, room)
        return float(s), float(value)

    def settled(self, force: float, share: float) -> float:
        """Return since when the friction force is settled, see `maxima`."""
        room = [0.0] * evaluation.SIZE
        return float(maxima.settled(self.rows, *self.samples, force, share, room))

    @property
    def last(self) -> list[float]:
        """The state at the end, with the leading and the trailing edge behind it."""
        row = [0.0] * (evaluation.SIZE + 2)
        maxima.last(*self.samples[1:], row)
        return row

    def _kernel(self, function: Callable[..., Any]) -> Any:
        return compiled.chosen(function, self.rows)

    def _room(self, count: int) -> tuple[Any, Any]:
        """Return room for times, and for the states there."""
        return self._rows(np.empty(count)), self._rows(np.empty((count, evaluation.SIZE)))

    def _rows(self, array: NDArray[np.float64]) -> Any:
        return array if self.compiled else array.tolist()


def solve(
    drive: BaseMotion,
    inertia_number: float,
    support_number: float,
    end: float,
    rtol: float = 1e-9,
    *,
    spring: Spring | None = None,
    fast: bool | None = None,
    control: StepControl = StepControl(),  # noqa: B008 - immutable
    progress: Callable[[float], Any] | None = None,
    max_steps: int = STEP_LIMIT,
) -> Trajectory:
    """Follow the transient of `drive` from rest until `end`, in scaled form.

    Parameters
    ----------
    drive
        The drive number lambda(s); it must reach `end`.
    inertia_number
        eps > 0; not used if the support is fixed.
    support_number
        kappa >= 0; infinity is the fixed indenter, d = 1.
    end
        Time until which to solve, in units of tau.
    rtol
        Error allowed in a step for d' relative to 1 + |d'|, and for x' likewise, all along the step.
    spring
        What holds the indenter along x; without it the drive is rigid.
    fast
        Whether the kernels are compiled; by default, if numba is installed and enough steps were
        interpreted for that to pay. The numbers are the same.
    control
        What sets the steps beside the tolerance.
    progress
        Called with the time reached, now and then.
    max_steps
        Steps after which to give up; those that are repeated count, too.

    Raises
    ------
    TransientError
        If a step cannot be made, or too many would be needed.

    Examples
    --------
    >>> motion = solve(BaseMotion.constant(4.0, end=2.0), 0.04, 0.0, end=2.0)
    >>> print(f"{motion.at(2.0).depth:.6f}")
    0.303968
    """
    if not 0.0 < end <= drive.end:
        raise ValueError(f"`end` must be positive and within the drive, got {end!r}")
    if spring is not None and not (
        spring.eps > 0.0 and spring.damping >= 0.0 and spring.stiffness > 0.0
    ):
        raise ValueError(
            "expected a `spring` with inertia and stiffness above 0, damping from 0 on"
        )
    if not (inertia_number > 0.0 and support_number >= 0.0 and 1e-13 <= rtol <= 1e-2):
        raise ValueError(
            "expected `inertia_number` > 0, `support_number` >= 0, 1e-13 <= `rtol` <= 1e-2"
        )
    numbers = float(inertia_number), float(support_number)
    arrays = compiled.worthwhile() if fast is None else fast
    run = begin(drive, numbers, spring, float(end), rtol, control, arrays=arrays)
    left, status = max_steps, stepping.PAUSED
    while status != stepping.DONE:
        if not compiled.in_use(run) and (compiled.worthwhile() if fast is None else fast):
            run = as_arrays(run)
        status = compiled.chosen(stepping.walk, run)(run, min(ATTEMPTS, left))
        before, left = left, max_steps - int(run.counts[r_.RECORDS] + run.counts[r_.REJECTED])
        compiled.Tally.steps += 0 if compiled.in_use(run) else before - left
        s = float(run.now[r_.S])
        if status in REASONS:
            raise TransientError(REASONS[status], s)
        if status == stepping.FULL:
            run = with_more_room(run)
        if left <= 0 and status != stepping.DONE:
            raise TransientError(f"more than {max_steps} steps (`max_steps`)", s)
        if progress is not None:
            progress(s)
    return Trajectory(run)
