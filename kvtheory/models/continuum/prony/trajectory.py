"""A solved transient on a Prony series; its kernels are interpreted, or compiled by numba where it pays."""

import math
from collections.abc import Callable
from contextlib import nullcontext
from functools import cached_property, partial
from time import thread_time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.compilation import ALIKE, Kernel
from kvtheory.models.continuum import compiled, maxima
from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.compiled import Finished, Solver, finished
from kvtheory.models.continuum.energy import Impulses, Ledger, impulses
from kvtheory.models.continuum.evaluation import MEASURED, STATE
from kvtheory.models.continuum.maxima import EXTREME
from kvtheory.models.continuum.prony import (
    contact,
    energy,
    evaluation,
    hops,
    records,
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
from kvtheory.models.continuum.run import FREE, TOUCHING, Beginning, Spring, StepControl
from kvtheory.models.continuum.solver import ScaledEvent
from kvtheory.records import readable, structured
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion

Array = NDArray[np.float64]

STEP_LIMIT = 30_000
ATTEMPTS = 10
"""Interpreted steps attempted between two reports: short beside loading kernels, as that is decided there."""
SECONDS = 22.0
"""Time to compile, once per installation."""
EVALUATED = 50
"""Times at which states are evaluated between two decisions whether to compile."""
SUBDIVISIONS = 4
"""Points shown for each step."""
REFUSED = {
    r_.STUCK: "no consistent state of the edges is found",
    r_.INCONSISTENT: "the pressure in the contact, or the gap outside, has the wrong sign",
}
"""Why a motion is not solved: numerical failures, for the contact is one interval (theorem F17-interval)."""
GRID, ZOOMS, BESIDE = 65, 2, 2
"""Points around the largest sample, how often they are laid, and the samples that they cover on each side:
two, as a step ends where the next starts. The time is known to 1/256 of the distance of samples."""

BLANK = np.zeros(1), np.zeros(1, STATE), np.zeros(1)
"""Times, states and profile of tasks that need none."""
KERNEL = Kernel(
    evaluation.perform,
    (b_, r_, e_, records, contact, step, segments, hops, walk, evaluation),
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


class Trajectory(Finished):
    """A solved transient: evaluate it anywhere in [0, end] with `states`."""

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

    def ledger(self, s: ArrayLike) -> Ledger:
        """Return the energy ledger at times."""
        return energy.ledger(self, s)

    def impulses(self, s: ArrayLike) -> Impulses:
        """Return the vertical impulses until the times."""
        return impulses(self, partial(self.states, peaks=False), s)

    @property
    def events(self) -> tuple[ScaledEvent, ...]:
        """The changes of the edges, in order of time."""
        steps, found = self.steps, []
        for k, name in enumerate(("left", "right")):
            states = steps["sides"]["state"][:, k]
            first = TOUCHING if self.given.start_depth > 0.0 else FREE
            before = np.append(first, states[:-1])
            for start, old, new in zip(steps["time"], before, states, strict=True):
                kind = f"{name} edge {'touches' if new == TOUCHING else 'peels'}"
                if FREE in (old, new):
                    kind = "take-off" if new == FREE else "landing"
                if old != new and (FREE not in (old, new) or k == 0):  # both edges fly
                    found.append(ScaledEvent(float(start), kind))
        return tuple(sorted(found, key=lambda event: event.s))

    @cached_property
    def samples(self) -> tuple[Array, NDArray[Any], int]:
        """Times that divide each step, the last just before its end; states without peaks; their number."""
        starts = self.steps["time"][self.steps["lasts"] > 0.0]
        ends = np.append(starts[1:] * maxima.JUST_BEFORE, self.end)
        parts = np.linspace(0.0, 1.0, maxima.SAMPLES + 1)
        times = np.minimum(
            starts[:, None] + (ends - starts)[:, None] * parts, ends[:, None]
        ).reshape(-1)
        return times, self.states(times, peaks=False), times.size

    @cached_property
    def samples_with_peaks(self) -> tuple[Array, NDArray[Any], int]:
        """The same with peak pressures."""
        return self.samples[0], self.states(self.samples[0]), self.samples[2]

    def largest(self, *wanted: tuple[str, int]) -> NDArray[Any]:
        """Return the extreme of each quantity in a sense as structured array, see `maxima.EXTREME`.

        As on Kelvin-Voigt, see `continuum.maxima`, but by denser and denser samples.
        """
        return np.array([self._largest(*each) for each in wanted], EXTREME)

    def _largest(self, name: str, sense: int) -> tuple[int, int, float, float]:
        peaks = name == "peak_pressure"
        times, found, _ = self.samples_with_peaks if peaks else self.samples
        for _ in range(ZOOMS + 1):
            values = found[name]
            measured = np.abs(values) if sense == maxima.MAGNITUDE else sense * values
            k = int(
                np.argmax(np.nan_to_num(measured, nan=-math.inf))
            )  # in flight there are no edges
            best = float(times[k]), float(values[k])
            low, high = times[max(k - BESIDE, 0)], times[min(k + BESIDE, times.size - 1)]
            times = np.unique(np.append(np.linspace(low, high, GRID), best[0]))
            found = self.states(times, peaks=peaks)
        value = abs(best[1]) if sense == maxima.MAGNITUDE else best[1]
        return MEASURED.index(name), sense, best[0], value

    def settled(self, force: float, share: float) -> float:
        """Return the time from which friction stays within a share of `force`; NaN if it does not settle."""
        times, found, _ = self.samples

        def outside(states: Any) -> Any:
            return np.abs(states["friction_force"] - force) > share * abs(force)

        late = np.flatnonzero(outside(found))
        if force == 0.0 or outside(found)[-1]:
            return math.nan
        if not late.size:
            return 0.0
        low, high = times[late[-1]], times[late[-1] + 1]
        for _ in range(maxima.BISECTIONS):
            middle = 0.5 * (low + high)
            late_still = outside(self.states([middle], peaks=False))[0]
            low, high = (middle, high) if late_still else (low, middle)
        return float(high)

    def _profile(self, task: int, xi: Array, s: float) -> Array:
        now, profile = self.states([s], peaks=False), np.zeros(1 + xi.size)
        given = 0, np.append(self.clock(s), xi)
        fast = self.compiled or (KERNEL.worthwhile() and prepared(self.arrays))
        with nullcontext() if fast else KERNEL.interpreting():
            if fast:
                KERNEL(task, self.arrays, *given, now, profile)
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
    *, damper: float = 0.0, spring: Spring | None = None,
    start: Beginning = Beginning(),  # noqa: B008 - immutable
    fast: bool | None = None, control: StepControl = StepControl(),  # noqa: B008 - immutable
    progress: Callable[[float], Any] | None = None, max_steps: int = STEP_LIMIT,
) -> Trajectory:  # fmt: skip
    """Solve the transient of `drive` from `start`, by default at rest, until `end`, in scaled form.

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
    given = drive, arms, numbers, spring, end, rtol, control, damper, start
    solver = Solver(
        kernel=KERNEL, attempts=ATTEMPTS, begin=lambda arrays: begin(*given, arrays=arrays),
        prepared=prepared, as_arrays=as_arrays, with_more_room=with_more_room, walk=_walk,
        time=time_of, refused=REFUSED, failure=ValueError,
    )  # fmt: skip
    return Trajectory(finished(solver, end, max_steps, fast, progress))


def _walk(run: Run, attempts: int) -> int:
    perform = evaluation.perform if isinstance(run.steps, list) else KERNEL
    with np.errstate(all="ignore"):  # an iteration that diverges ends a step, compiled or not
        return int(perform(evaluation.WALK, run, attempts, *BLANK))
