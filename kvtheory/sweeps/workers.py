"""Executors: the caller's, or our own of threads or processes."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager

from kvtheory.sweeps.engine import Workers

AHEAD = 2
"""Blocks in flight for each worker: one that is computed and one that waits for it."""
UNKNOWN_WORKERS = 16
"""Assumed of an executor that does not tell; on a larger cluster say `in_flight`."""


@contextmanager
def own_workers(jobs: int, *, threads: bool) -> Iterator[Workers]:
    """Provide a pool of `jobs` workers, renewed when it breaks, and shut down at the end."""
    made: list[Executor] = []

    def workers() -> Executor:
        if threads:
            pool: Executor = ThreadPoolExecutor(jobs)
        else:
            pool = ProcessPoolExecutor(
                jobs, multiprocessing.get_context("spawn"), initializer=_follow_parent
            )
        made.append(pool)
        return pool

    try:
        yield workers
    finally:
        for pool in made:
            pool.shutdown(wait=True, cancel_futures=True)


def workers_of(executor: Executor | None, jobs: int) -> int:
    """Return how many workers compute the blocks."""
    if executor is None:
        return jobs
    return int(getattr(executor, "_max_workers", None) or UNKNOWN_WORKERS)


def _follow_parent() -> None:
    """Leave interrupts to the parent, and end with it, even if it is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
