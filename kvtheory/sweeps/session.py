"""One run of a sweep: from a plan to a result in memory, or to a file that resumes."""

from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import nullcontext
from functools import partial
from glob import escape
from pathlib import Path

from kvtheory.sweeps import engine, files
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import Plan
from kvtheory.sweeps.result import Sweep
from kvtheory.sweeps.store import Memory, Store, WorkFile
from kvtheory.sweeps.workers import in_flight_of, own_workers

Report = Callable[[int, int, int, int], None]

WORK = ".part"
"""What the name of a work file adds to that of the result."""


def in_memory(plan: Plan, walk: Callable[[Store], None]) -> Sweep:
    """Run a sweep and return its arrays."""
    store = Memory(plan)
    walk(store)
    return files.from_memory(files.outcome(plan, store.blocks))


def into_file(plan: Plan, walk: Callable[[Store], None], path: Path) -> Sweep:
    """Run a sweep into a file, or resume it; an interrupt leaves a file with what there is."""
    files.check(path)
    work = path.with_name(path.name + WORK)
    if files.finished(path, plan):
        if work.exists():  # of a run that was killed just before it removed this
            WorkFile(work, plan).remove()
        return files.from_file(path, plan)
    store = WorkFile(work, plan)
    try:
        for litter in path.parent.glob(f".{escape(path.stem)}.*.part{path.suffix}"):
            litter.unlink()  # of a run that was killed while it wrote the result
        try:
            walk(store)
        except KeyboardInterrupt:
            files.write(files.outcome(plan, store.blocks, files.FAILURES_LISTED), path)
            raise
        files.write(files.outcome(plan, store.blocks, files.FAILURES_LISTED), path)
    finally:
        store.close()
    store.remove()
    return files.from_file(path, plan)


def walker(
    plan: Plan,
    executor: Executor | None,
    jobs: int,
    in_flight: int | None,
    block: int | None,
    report: Report | None,
) -> Callable[[Store], None]:
    """Return what fills a store with the blocks that it lacks."""

    def walk(store: Store) -> None:
        done = store.done()
        before = sum(stop - start for start, stop in done)
        counts = {"done": before, "failed": 0}

        def show() -> None:
            if report:
                report(counts["done"], before, counts["failed"], plan.points)

        def keep(result: Block) -> None:
            store.keep(result)
            counts["done"] += result.stop - result.start
            counts["failed"] += len(result.failures)
            show()

        show()
        tasks = engine.remaining(plan, done, block)
        if executor is None and jobs == 1:
            engine.run_here(tasks, keep)
            return
        flying = in_flight or in_flight_of(executor, jobs)
        pool = (
            own_workers(jobs, threads=plan.vectorised)
            if executor is None
            else nullcontext(partial(_same, executor))
        )
        with pool as workers:
            engine.run_by(workers, tasks, keep, flying, show)

    return walk


def _same(executor: Executor) -> Executor:
    return executor
