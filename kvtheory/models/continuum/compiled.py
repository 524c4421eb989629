"""The kernels compiled by numba, from the same source that runs interpreted without it.

A run is followed to its end interpreted, or compiled from where on that pays, with room as needed.
"""

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cached_property
from time import thread_time
from typing import Any, NamedTuple

import numpy as np

from kvtheory import records
from kvtheory.compilation import Kernel
from kvtheory.models.continuum import (
    bulk,
    collocation,
    contact,
    deviation,
    evaluation,
    maxima,
    memory_chains,
    run,
    stepping,
    trial_step,
)
from kvtheory.models.continuum.run import DONE, FULL, PAUSED
from kvtheory.records import readable
from kvtheory.results.errors import TransientError
from kvtheory.scene import base_motion

MODULES = (
    *(records, base_motion, run, contact, collocation, memory_chains),
    *(trial_step, stepping, evaluation, maxima, deviation, bulk),
)
"""Modules that contain kernels."""

INLINED = base_motion, contact, collocation, "sliding_now", "_slack", "_probe"
"""Modules of short kernels that are called most often, and such functions of the others."""
SECONDS = 14.0
"""Time to compile, once per installation."""

FASTER = 100
"""How many times as many steps compiled kernels take between two reports."""


class Arguments(NamedTuple):
    """Times, states, two states of workspace, deviations, extremes and settling, see `bulk.perform`."""

    times: Any
    states: Any
    rows: Any
    worst: Any
    extremes: Any
    settling: Any


NOTHING = Arguments(
    np.zeros(0), np.zeros(0, evaluation.STATE), np.zeros(0, evaluation.STATE),
    np.zeros(0, deviation.DEVIATION), np.zeros(0, maxima.EXTREME), np.zeros(0, bulk.SETTLING),
)  # fmt: skip
"""Those of a task that needs none."""
KERNEL = Kernel(bulk.perform, MODULES, SECONDS, INLINED)


def in_use(run: Any) -> bool:
    """Whether the records of a run are arrays, as compiled kernels need."""
    return isinstance(run.steps, np.ndarray)


def chosen(run: Any) -> Callable[..., int]:
    """Return the entry of the kernels, compiled if the records of the run are arrays."""
    return KERNEL if in_use(run) else bulk.perform


def prepared(run: Any) -> bool:
    """Load or compile the kernels, for a run whose records are arrays; return whether that worked."""
    return KERNEL.prepared(bulk.WALK, run, run, *NOTHING, 0, bulk.NO_BULK)


def follow(all_of: bulk.Bulk, fine: Any, other: Any, steps: int) -> None:
    """Solve many scenes with compiled kernels, see `bulk.perform`."""
    KERNEL(bulk.FOLLOW, fine, other, *NOTHING, steps, all_of)


@dataclass(frozen=True)
class Finished:
    """A run that has ended; its records are arrays if its kernels were compiled."""

    run: Any

    @cached_property
    def given(self) -> Any:
        """Inertia, support, spring, tolerance: the record `GIVEN` of the run."""
        return readable(self.run.given[0])

    @cached_property
    def counts(self) -> Any:
        """The state at the end, and the numbers of steps, events and so on: the record `NOW` of the run."""
        return readable(self.run.now[0])

    @property
    def compiled(self) -> bool:
        """Whether the run ended with compiled kernels."""
        return in_use(self.run)


class Solver(NamedTuple):
    """How runs of one kind are followed.

    `begin` makes one, with arrays for compiled kernels or without; `walk` goes on for so many attempted
    steps, `attempts` between two reports if interpreted, and returns a status; `time` is the present one.
    `refused` has the reasons of those that end a run with a `failure`.
    """

    kernel: Kernel
    attempts: int
    begin: Callable[[bool], Any]
    prepared: Callable[[Any], bool]
    as_arrays: Callable[[Any], Any]
    with_more_room: Callable[[Any], Any]
    walk: Callable[[Any, int], int]
    time: Callable[[Any], float]
    refused: Mapping[int, str]
    failure: type[Exception]


def finished(
    solver: Solver, end: float, max_steps: int, fast: bool | None, progress: Callable[[float], Any] | None
) -> Any:  # fmt: skip
    """Return a finished run; raise `solver.failure`, or TransientError if too many steps are needed."""
    arrays = solver.kernel.worthwhile() if fast is None else fast
    run = solver.begin(arrays)
    if arrays and not solver.prepared(run):
        run = solver.begin(False)
    left, status, begun = max_steps, PAUSED, thread_time()
    while status != DONE:
        interpreted = not in_use(run)
        with solver.kernel.interpreting() if interpreted else nullcontext():
            attempts = solver.attempts * (1 if interpreted else FASTER)
            status = solver.walk(run, min(attempts, left))
        now, s = readable(run.now[0]), solver.time(run)
        left = max_steps - now.steps - now.rejected
        if status in solver.refused:
            raise solver.failure(solver.refused[status], s)
        if status == FULL:
            run = solver.with_more_room(run)
        if left <= 0 and status != DONE:
            raise TransientError(f"more than {max_steps} steps (`max_steps`)", s)
        if fast is None and interpreted and status != DONE and s:
            to_come = (thread_time() - begun) * (end / s - 1.0)
            if solver.kernel.worthwhile(to_come) and solver.prepared(same := solver.as_arrays(run)):
                run = same
        if progress is not None:
            progress(s)
    return run
