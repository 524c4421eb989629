"""A run is followed to its end: interpreted, or compiled from where on that pays, with room as needed."""

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from time import thread_time
from typing import Any, NamedTuple

import numpy as np

from kvtheory.compilation import Kernel
from kvtheory.models.continuum.run import DONE, FULL, PAUSED
from kvtheory.records import readable
from kvtheory.results.errors import TransientError


class Solver(NamedTuple):
    """How runs of one kind are followed.

    `begin` makes one, with arrays for compiled kernels or without; `walk` goes on for so many attempted
    steps, `attempts` between two reports, and returns a status; `time` is the present one. `refused` has the
    reasons of those that end a run with a `failure`.
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


def follow(
    solver: Solver, end: float, max_steps: int, fast: bool | None, progress: Callable[[float], Any] | None
) -> Any:  # fmt: skip
    """Return a finished run; raise `solver.failure`, or TransientError if too many steps are needed."""
    arrays = solver.kernel.worthwhile() if fast is None else fast
    run = solver.begin(arrays)
    if arrays and not solver.prepared(run):
        run = solver.begin(False)
    left, status, begun = max_steps, PAUSED, thread_time()
    while status != DONE:
        interpreted = not isinstance(run.steps, np.ndarray)
        with solver.kernel.interpreting() if interpreted else nullcontext():
            status = solver.walk(run, min(solver.attempts, left))
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
