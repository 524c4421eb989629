"""The walk over the blocks of a sweep: here, or by an executor, with a bounded number in flight."""

import logging
from collections.abc import Callable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from importlib.util import find_spec

from kvtheory.sweeps.blocks import Block, Task, compute, task
from kvtheory.sweeps.plan import Plan

VECTORISED_BLOCK = 65536
"""Steady states in a block: 5 MB of results in 20 ms; half as many cost a third of the speed."""
QUADRATURE_BLOCK = 512
"""Scenes integrated in a block: as many as go through one column of nodes; 64 cost half the speed."""
SINGLE_BLOCK, COMPILED_BLOCK = 64, 512
"""Motions followed in a block, one by one or in one call: about 0.1 s to 1 s, of which passing it on takes a
percent."""
LEAST_BLOCKS = 16
"""Of a sweep of motions, so that a few workers share even a small one."""

TRIES = 3
"""Times that a block is given out; a worker may die under it, but not every time."""
REFRESH = 0.5
"""Seconds after which progress is shown anew, and an interrupt is heard, while nothing comes back."""

HINT = ' (a script that starts processes needs `if __name__ == "__main__":`)'
"""Without it, each process runs the script anew, and ends at once."""

log = logging.getLogger(__name__)

Workers = Callable[[], Executor]
"""Gives the executor; called again, a new one, if the old one is broken."""


def remaining(plan: Plan, done: list[tuple[int, int]], block: int | None = None) -> Iterator[Task]:
    """Yield tasks for all points outside the `done` ranges, at most `block` points each.

    Edges of blocks lie on multiples of `block`, but for those that earlier runs left.
    """
    usual = _motions(plan) if plan.transient else QUADRATURE_BLOCK
    size = block or (VECTORISED_BLOCK if plan.vectorised else usual)
    at = 0
    for start, stop in [*done, (plan.points, plan.points)]:
        while at < start:
            end = min(start, (at // size + 1) * size)
            yield task(plan, at, end)
            at = end
        at = max(at, stop)


def _motions(plan: Plan) -> int:
    """Return how many motions are followed in a block."""
    together = find_spec("numba") is not None and not plan.textual
    most = COMPILED_BLOCK if together else SINGLE_BLOCK
    return min(most, max(SINGLE_BLOCK, plan.points // LEAST_BLOCKS))


def run_here(tasks: Iterator[Task], keep: Callable[[Block], None]) -> None:
    """Compute the blocks one after the other in this thread."""
    for given in tasks:
        keep(compute(given))


def run_by(
    workers: Workers,
    tasks: Iterator[Task],
    keep: Callable[[Block], None],
    in_flight: int,
    idle: Callable[[], None],
) -> None:
    """Have an executor compute the blocks, `in_flight` of them at a time; it is not shut down.

    A block that is lost with its worker is given out again. On an interrupt, or an error in
    keeping, blocks that wait are withdrawn; those that have come back are kept.

    Raises
    ------
    RuntimeError
        If a block was lost `TRIES` times.
    """
    executor = workers()
    flying: dict[Future[Block], tuple[Task, int]] = {}
    again: list[tuple[Task, int]] = []
    try:
        while True:
            while len(flying) < in_flight:
                given, tries = again.pop() if again else (next(tasks, None), 1)
                if given is None:
                    break
                try:
                    flying[executor.submit(compute, given)] = given, tries
                except BrokenExecutor as error:
                    again.append((given, tries))
                    executor = _renewed(workers, executor, error)
            if not flying:
                return
            done, _ = wait(flying, REFRESH, FIRST_COMPLETED)
            idle()
            for future in done:
                given, tries = flying.pop(future)
                lost = _error(future)
                if lost is None:
                    keep(future.result())
                    continue
                again.append(_once_more(given, tries, lost))
    except BaseException:
        _salvage(flying, keep)
        raise


def _once_more(given: Task, tries: int, lost: BaseException) -> tuple[Task, int]:
    """Return what to give out again, or give up."""
    points = f"points {given.start} to {given.stop - 1}"
    if tries == TRIES:
        told = f"{type(lost).__name__}: {lost}{HINT if isinstance(lost, BrokenProcessPool) else ''}"
        raise RuntimeError(f"{points} were lost {TRIES} times: {told}") from lost
    log.warning("%s are given out again: %r", points, lost)
    return given, tries + 1


def _error(future: Future[Block]) -> BaseException | None:
    """Return what went wrong with a block; executors of clusters also withdraw it by themselves."""
    try:
        return future.exception()
    except CancelledError as error:
        return error


def _renewed(workers: Workers, old: Executor, error: BrokenExecutor) -> Executor:
    """Return a new executor for a broken one; that of the caller cannot be made anew."""
    new = workers()
    if new is old:
        raise RuntimeError(f"the executor is broken: {error}") from error
    return new


def _salvage(flying: dict[Future[Block], tuple[Task, int]], keep: Callable[[Block], None]) -> None:
    """Withdraw what has not begun, and keep what has come back, if keeping is still possible."""
    for future in flying:
        future.cancel()
    for future in flying:
        if future.done() and not future.cancelled() and future.exception() is None:
            try:
                keep(future.result())
            except OSError:
                return
