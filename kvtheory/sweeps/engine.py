"""Runs a sweep: submits blocks to an executor, a bounded number at a time, and keeps the results."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent import futures
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext, suppress
from glob import escape
from importlib.util import find_spec
from pathlib import Path
from time import monotonic
from typing import Any

from kvtheory import compilation
from kvtheory.progress import Progress
from kvtheory.results.sweep import Sweep
from kvtheory.sweeps import files
from kvtheory.sweeps.blocks import Block, Task, compile_ahead, compute, task
from kvtheory.sweeps.plan import Plan
from kvtheory.sweeps.store import opened

WORK = ".part"
"""Suffix of a work file, after the name of the result."""
ANY = "?" * 12
"""Matches what differs from call to call in the name of a temporary file (`export.replace_files`)."""
VECTORISED_BLOCK = 65536
"""Steady states in a block: 5 MB of results in 20 ms; half as many reduce the speed by a third."""
QUADRATURE_BLOCK = 512
"""Scenes integrated in a block: as many as go through one column of nodes; 64 cost half the speed."""
SINGLE_BLOCK, COMPILED_BLOCK = 64, 512
"""Transients in a block, one by one or in one call: 0.1 s to 1 s, of which the transfer takes a percent."""
LEAST_BLOCKS = 16
"""Fewest blocks in a sweep of transients, so that a few workers share even a small one."""
AHEAD = 2
"""Blocks in flight per worker: one that is running and one that waits."""
UNKNOWN_WORKERS = 16
"""Number of workers assumed where an executor does not tell; on a larger cluster give `in_flight`."""
REFRESH = 0.5
"""Interval in s at which progress is shown and an interrupt is noticed while no block returns."""
HINT = ' (a script that starts processes needs `if __name__ == "__main__":`)'
"""Without that line, each process runs the script again, and ends at once."""


def in_memory(plan: Plan, **how: Any) -> Sweep:
    """Run a sweep and return its arrays."""
    done = list[Block]()
    run(plan, [], done.append, **how)
    return files.from_memory(plan, sorted(done, key=lambda block: block.start))


def into_file(plan: Plan, path: Path, *, overwrite: bool, **how: Any) -> Sweep:
    """Run a sweep into a file, or resume it; after an interrupt the file holds what was done."""
    files.check(path)
    work, computed = path.with_name(path.name + WORK), 0
    finished = not overwrite and files.finished(path, plan)
    if finished and not work.exists():
        return files.from_file(path, plan)
    with opened(work, plan, anew=overwrite) as kept:
        if not finished:  # else it was killed just before it removed this
            for unfinished in path.parent.glob(f".{escape(path.stem)}.{ANY}.part{path.suffix}"):
                unfinished.unlink()  # of a run that was killed while it wrote the result
            try:
                computed = run(plan, kept.done, kept.keep, **how)
            except KeyboardInterrupt:
                files.write(plan, kept.done, kept, path)
                raise
            files.write(plan, kept.done, kept, path)
    work.unlink()
    return files.from_file(path, plan, computed)


def run(
    plan: Plan, kept: list[Block], keep: Callable[[Block], None], *, executor: Executor | None,
    jobs: int, in_flight: int | None, block: int | None, report: Progress | None,
) -> int:  # fmt: skip
    """Compute all blocks that are not `kept`, and return their points; `executor` is not shut down.

    After an error or an interrupt, waiting blocks are cancelled, and those returned are kept. A pool that
    breaks ends the sweep.
    """
    before = done = sum(one.stop - one.start for one in kept)
    failed, begun = sum(len(one.failures) for one in kept), monotonic()
    workers = jobs if executor is None else getattr(executor, "_max_workers", 0) or UNKNOWN_WORKERS
    most = 1 if executor is None and jobs == 1 else in_flight or AHEAD * workers
    flying = set[Future[Block]]()

    def returned(future: Future[Block]) -> None:
        nonlocal done, failed
        result = future.result()
        keep(result)
        done += result.stop - result.start
        failed += len(result.failures)

    def show() -> None:
        rate = (done - before) / max(monotonic() - begun, 1e-9)
        speed = f", {rate:,.0f} a second" if rate >= 10.0 else f", {rate:.2g} a second"
        text = f"{done:,} of {plan.points:,} points{speed if rate else ''}"
        if report:
            report(done / plan.points, text + (f", {failed:,} failed" if failed else ""))

    compile_ahead(plan, plan.points - before, workers)
    show()
    tasks = remaining(plan, [(one.start, one.stop) for one in kept], block)
    with _workers(jobs, plan) if executor is None else nullcontext(executor.submit) as submit:
        try:
            while True:
                while len(flying) < most and (given := next(tasks, None)):
                    flying.add(submit(compute, given))
                if not flying:
                    return done - before
                for future in futures.wait(flying, REFRESH, futures.FIRST_COMPLETED).done:
                    flying.remove(future)
                    returned(future)
                show()
        except BaseException as error:
            for future in flying:
                future.cancel()
            for future in flying:
                if future.done() and not future.cancelled():
                    with suppress(Exception):  # if it broke as well, or the disk is full
                        returned(future)
            if isinstance(error, futures.BrokenExecutor | futures.CancelledError):
                hint = HINT if isinstance(error, BrokenProcessPool) else ""
                why = f"the executor is broken: {error or type(error).__name__}{hint}"
                raise RuntimeError(
                    f"{why}; finished blocks of a file are kept, and the same call resumes"
                ) from error
            raise


def remaining(plan: Plan, done: list[tuple[int, int]], block: int | None = None) -> Iterator[Task]:
    """Yield tasks of at most `block` points outside the `done` ranges, cut at multiples of `block`."""
    size = block or (VECTORISED_BLOCK if plan.vectorised else QUADRATURE_BLOCK)
    if plan.transient and not block:
        together = find_spec("numba") is not None and not plan.texts
        most = COMPILED_BLOCK if together else SINGLE_BLOCK
        size = min(most, max(SINGLE_BLOCK, plan.points // LEAST_BLOCKS))
    at = 0
    for start, stop in [*done, (plan.points, plan.points)]:
        while at < start:
            end = min(start, (at // size + 1) * size)
            yield task(plan, at, end)
            at = end
        at = max(at, stop)


@contextmanager
def _workers(jobs: int, plan: Plan) -> Iterator[Callable[..., Future[Block]]]:
    """Yield `submit` of the default workers: this thread for one job, threads for NumPy, else processes."""

    def here(function: Any, given: Task) -> Future[Block]:
        future: Future[Block] = Future()
        future.set_result(function(given))
        return future

    if jobs == 1:
        yield here
        return
    pool: Executor
    if plan.vectorised:
        pool = futures.ThreadPoolExecutor(jobs)
    else:
        spawn = multiprocessing.get_context("spawn")
        pool = futures.ProcessPoolExecutor(
            jobs, spawn, initializer=_follow_parent, initargs=(compilation.known_unusable(),)
        )
    with pool:
        yield pool.submit


def _follow_parent(unusable: tuple[str, ...]) -> None:
    """Leave interrupts to the parent process, which has warned, and end with it, even if it is killed."""
    compilation.give_up(unusable)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent: Any = multiprocessing.parent_process()
    threading.Thread(target=lambda: (parent.join(), os._exit(1)), daemon=True).start()
