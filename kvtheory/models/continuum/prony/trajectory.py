"""A solved transient on a Prony series; its kernels are interpreted, or compiled by numba where it pays."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory import compilation
from kvtheory.models.continuum import compiled
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.prony import (
    contact,
    counting,
    evaluation,
    hops,
    segments,
    step,
    walk,
)
from kvtheory.models.continuum.prony.records import STEP, Run, as_arrays, begin, with_more_room
from kvtheory.models.continuum.run import Spring, StepControl
from kvtheory.records import readable, structured
from kvtheory.results.errors import TransientError
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion

Array = NDArray[np.float64]

STEP_LIMIT = 30_000
ATTEMPTS = 100
"""Attempted steps between two reports of progress."""
WORTHWHILE, LOADABLE = 5_000, 300
"""Interpreted steps after which compiling pays, 20 s once per installation, and after which loading
kernels that are compiled does, a second."""
SUBDIVISIONS = 4
"""Points shown for each step."""
REFUSED = {
    walk.STUCK: "no consistent state of the edges is found",
    walk.PARTS: "the pressure in the contact, or the gap outside, has the wrong sign",
}
"""Why a motion is not solved: numerical failures, for the contact is one interval (theorem F17-interval)."""


class Tally:
    """Number of steps interpreted in this process."""

    steps = 0


def kernel() -> Any:
    """Return the compiled entry of the kernels; it needs numba."""
    return compiled.kernel(
        evaluation.perform, (b_, r_, contact, step, segments, counting, hops, walk, evaluation)
    )


def worthwhile(coming: int = 0) -> bool:
    """Return whether to use compiled kernels from now on; about `coming` more steps are certain."""
    steps = Tally.steps + coming
    if steps < min(LOADABLE, WORTHWHILE) or not compilation.available():
        return False
    return steps >= WORTHWHILE or compilation.on_disk(kernel())


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
        ends = np.append(self.steps["start"], self.counts.s)
        times = ends[:-1, None] + np.diff(ends)[:, None] * (np.arange(SUBDIVISIONS) / SUBDIVISIONS)
        return np.append(times.reshape(-1), ends[-1])

    def states(self, s: ArrayLike, *, peaks: bool = True) -> Array:
        """Return the states at an array of times: a column for each, with the rows of `evaluation`."""
        times = np.ascontiguousarray(s, dtype=float)
        task = evaluation.STATES if peaks else evaluation.WITHOUT_PEAKS
        return self._perform(task, times, np.empty((times.size, evaluation.SIZE))).T

    def profile(self, task: int, xi: Array, s: float) -> Array:
        """Return the pressure or the compression, a task of `evaluation`, at places and one time."""
        found = np.empty((1 + xi.size, evaluation.SIZE))
        found[0] = self.states([s])[:, 0]
        return self._perform(task, np.append(s, xi), found)[1:, 0].reshape(xi.shape)

    def _perform(self, task: int, times: Array, found: Array) -> Array:
        perform = kernel() if self.compiled else evaluation.perform
        perform(task, self.run, 0, times, found)
        return found


def solve(
    drive: BaseMotion, arms: Any, numbers: tuple[float, float], end: float, rtol: float,
    *, spring: Spring | None = None, fast: bool | None = None,
    control: StepControl = StepControl(),  # noqa: B008 - immutable
    progress: Callable[[float], Any] | None = None, max_steps: int = STEP_LIMIT,
) -> Trajectory:  # fmt: skip
    """Solve the transient of `drive` from rest until `end`, in scaled form.

    `arms` are pairs k_i = K_i/K and T_i = tau_i/tau, `numbers` eps and kappa, which is infinite for a fixed
    indenter. The rest is as in `continuum.solver.solve`.

    Raises
    ------
    ValueError
        If the method fails: `REFUSED` says how.
    TransientError
        If too many steps are needed.

    >>> motion = solve(BaseMotion.constant(1.0, end=2.0), [(5.0, 1.0)], (0.04, 0.0), 2.0, 1e-9)
    >>> print(f"{motion.states([2.0])[0, 0]:.6f}")
    0.417162
    """
    arrays = worthwhile(len(drive.pieces)) if fast is None else fast
    run = begin(drive, arms, numbers, spring, end, rtol, control, arrays=arrays)
    left, status, nothing = max_steps, walk.PAUSED, (np.zeros(1), np.zeros((1, 1)))
    while status != walk.DONE:
        interpreted = isinstance(run.steps, list)
        perform = evaluation.perform if interpreted else kernel()
        with np.errstate(all="ignore"):  # an iteration that diverges ends a step, compiled or not
            status = perform(evaluation.WALK, run, min(ATTEMPTS, left), *nothing)
        now = readable(run.now[0])
        before, left = left, max_steps - now.steps - now.rejected
        Tally.steps += before - left if interpreted else 0
        if status in REFUSED:
            raise ValueError(REFUSED[status], now.s)
        if status == walk.FULL:
            run = with_more_room(run)
        if left <= 0 and status != walk.DONE:
            raise TransientError(f"more than {max_steps} steps (`max_steps`)", now.s)
        if fast is None and interpreted and status != walk.DONE and worthwhile():
            run = as_arrays(run)
        if progress is not None:
            progress(now.s)
    return Trajectory(run)
