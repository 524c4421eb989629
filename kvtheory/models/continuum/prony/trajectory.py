"""A solved transient on a Prony series; its kernels are interpreted, or compiled by numba where it pays."""

from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cached_property
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.compilation import ALIKE, Kernel
from kvtheory.models.continuum import compiled
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.evaluation import STATE
from kvtheory.models.continuum.prony import (
    contact,
    evaluation,
    hops,
    records,
    restarts,
    segments,
    step,
    walk,
)
from kvtheory.models.continuum.prony.contact import time_at
from kvtheory.models.continuum.prony.records import (
    STEP,
    Run,
    as_arrays,
    begin,
    named,
    with_more_room,
)
from kvtheory.models.continuum.run import Spring, StepControl
from kvtheory.records import readable, structured
from kvtheory.results.errors import TransientError
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion

Array = NDArray[np.float64]

STEP_LIMIT = 30_000
ATTEMPTS = 100
"""Attempted steps between two reports of progress."""
SECONDS = 22.0
"""Time to compile, once per installation."""
EVALUATED = 50
"""Times at which states are evaluated between two decisions whether to compile."""
SUBDIVISIONS = 4
"""Points shown for each step."""
REFUSED = {
    walk.STUCK: "no consistent state of the edges is found",
    walk.PARTS: "the pressure in the contact, or the gap outside, has the wrong sign",
}
"""Why a motion is not solved: numerical failures, for the contact is one interval (theorem F17-interval)."""


BLANK = np.zeros(1), np.zeros(1, STATE), np.zeros(1)
"""Times, states and profile of tasks that need none."""
KERNEL = Kernel(
    evaluation.perform,
    (b_, r_, records, contact, step, segments, restarts, hops, walk, evaluation),
    SECONDS,
    compiled.INLINED,
)


def prepared(run: Run) -> bool:
    """Load or compile the kernels, for a run whose records are arrays; return whether that worked."""
    return KERNEL.prepared(evaluation.WALK, run, 0, *BLANK)


def time_of(run: Run) -> float:
    """Return the present time of a run."""
    now, clock = readable(run.now[0]), run.clock
    clock = named(clock) if isinstance(clock, np.ndarray) else clock
    return time_at(run._replace(clock=clock), now.piece, now.s)


@dataclass(frozen=True)
class Trajectory:
    """A solved transient: evaluate it anywhere in [0, end] with `states`."""

    run: Run

    @cached_property
    def counts(self) -> Any:
        """The state at the end, with the numbers of steps and evaluations, see `records.NOW`."""
        return readable(self.run.now[0])

    @property
    def compiled(self) -> bool:
        """Whether the kernels were compiled."""
        return isinstance(self.run.steps, np.ndarray)

    @cached_property
    def steps(self) -> NDArray[Any]:
        """The steps as a structured array, see `records.STEP`."""
        return np.asarray(structured(self.run.steps[: self.counts.steps], STEP))

    @cached_property
    def natural(self) -> Array:
        """Times at which to show the motion: those of the steps, subdivided."""
        ends = np.append(self.steps["time"][self.steps["lasts"] > 0.0], self.end)
        times = ends[:-1, None] + np.diff(ends)[:, None] * (np.arange(SUBDIVISIONS) / SUBDIVISIONS)
        return np.append(times.reshape(-1), ends[-1])

    @property
    def end(self) -> float:
        """The time at which it ends."""
        return time_of(self.run)

    def clock(self, s: ArrayLike) -> Array:
        """Return the clock at times: where the drive jumps, just after the pause, see `records`."""
        times, steps = np.asarray(s, dtype=float), self.steps
        index = np.maximum(np.searchsorted(steps["time"], times, side="right") - 1, 0)
        paused = steps["lasts"][index] == 0.0  # only if the motion ends with a pause
        clock = steps["start"][index] + (times - steps["time"][index])
        return np.asarray(np.where(paused, self.counts.s, clock))

    def states(self, s: ArrayLike, *, peaks: bool = True) -> NDArray[Any]:
        """Return the states at an array of times as a structured array, see `evaluation.STATE`."""
        times = np.ascontiguousarray(self.clock(s))
        task = evaluation.STATES if peaks else evaluation.WITHOUT_PEAKS
        return self._perform(task, times, np.zeros(times.size, STATE))

    def pressure(self, xi: Array, s: float) -> Array:
        """Return the scaled pressure at places and one time."""
        return self._profile(evaluation.PRESSURE, xi, s)

    def compression(self, xi: Array, s: float) -> Array:
        """Return the scaled compression of the foundation at places and one time."""
        return self._profile(evaluation.COMPRESSION, xi, s)

    def _profile(self, task: int, xi: Array, s: float) -> Array:
        now, profile = self.states([s], peaks=False), np.zeros(1 + xi.size)
        given = 0, np.append(self.clock(s), xi)
        if self.compiled:
            KERNEL(task, self.run, *given, now, profile)
        else:
            evaluation.perform(task, self.run, *given, named(now), profile)
        return profile[1:].reshape(xi.shape)

    @cached_property
    def arrays(self) -> Run:
        """The run with arrays for compiled kernels."""
        return as_arrays(self.run)

    def _perform(self, task: int, times: Array, found: NDArray[Any]) -> NDArray[Any]:
        """Perform a task at all times, compiled from where on that pays."""
        fast, done, took = self.compiled, 0, 0.0
        while done < times.size:
            left = took * (times.size / max(done, 1) - 1.0)
            fast = fast or (KERNEL.worthwhile(left, ALIKE) and prepared(self.arrays))
            part = slice(done, None if fast else done + EVALUATED)
            begun = thread_time()
            with nullcontext() if fast else KERNEL.interpreting():
                if fast:
                    KERNEL(task, self.arrays, 0, times[part], found[part], BLANK[-1])
                else:
                    evaluation.perform(
                        task, self.run, 0, times[part], named(found[part]), BLANK[-1]
                    )
            took += thread_time() - begun
            done = times.size if fast else done + EVALUATED
        return found


def solve(
    drive: BaseMotion, arms: Any, numbers: tuple[float, float], end: float, rtol: float,
    *, damper: float = 0.0, spring: Spring | None = None, fast: bool | None = None,
    control: StepControl = StepControl(),  # noqa: B008 - immutable
    progress: Callable[[float], Any] | None = None, max_steps: int = STEP_LIMIT,
) -> Trajectory:  # fmt: skip
    """Solve the transient of `drive` from rest until `end`, in scaled form.

    `arms` are pairs k_i = K_i/K and T_i = tau_i/tau, `damper` is C/(K tau), `numbers` eps and kappa,
    which is infinite for a fixed
    indenter. The rest is as in `continuum.solver.solve`.

    Raises
    ------
    ValueError
        If the method fails: `REFUSED` says how.
    TransientError
        If too many steps are needed.

    >>> motion = solve(BaseMotion.constant(1.0, end=2.0), [(5.0, 1.0)], (0.04, 0.0), 2.0, 1e-9)
    >>> print(f"{motion.states([2.0])['depth'][0]:.6f}")
    0.417162
    """
    arrays = KERNEL.worthwhile() if fast is None else fast
    given = drive, arms, numbers, spring, end, rtol, control, damper
    run = begin(*given, arrays=arrays)
    if arrays and not prepared(run):
        run = begin(*given, arrays=False)
    left, status = max_steps, walk.PAUSED
    begun = thread_time()
    while status != walk.DONE:
        interpreted = isinstance(run.steps, list)
        perform = evaluation.perform if interpreted else KERNEL
        with (
            np.errstate(all="ignore"),  # an iteration that diverges ends a step, compiled or not
            KERNEL.interpreting() if interpreted else nullcontext(),
        ):
            status = perform(evaluation.WALK, run, min(ATTEMPTS, left), *BLANK)
        now = readable(run.now[0])
        time = time_of(run)
        left = max_steps - now.steps - now.rejected
        if status in REFUSED:
            raise ValueError(REFUSED[status], time)
        if status == walk.FULL:
            run = with_more_room(run)
        if left <= 0 and status != walk.DONE:
            raise TransientError(f"more than {max_steps} steps (`max_steps`)", time)
        if fast is None and interpreted and status != walk.DONE and time:
            to_come = (thread_time() - begun) * (end / time - 1.0)
            if KERNEL.worthwhile(to_come) and prepared(same := as_arrays(run)):
                run = same
        if progress is not None:
            progress(time)
    return Trajectory(run)
