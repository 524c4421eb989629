"""One run of a sweep: from a plan to a result in memory, or to a file that resumes."""

from collections.abc import Callable
from concurrent.futures import Executor
from contextlib import nullcontext
from functools import partial
from glob import escape
from pathlib import Path
from time import monotonic

from kvtheory.progress import Progress
from kvtheory.results.sweep import Sweep
from kvtheory.sweeps import engine, files
from kvtheory.sweeps.blocks import Block, compile_ahead
from kvtheory.sweeps.outcome import FAILURES_LISTED, outcome
from kvtheory.sweeps.plan import Plan
from kvtheory.sweeps.store import Memory, Store, WorkFile
from kvtheory.sweeps.workers import AHEAD, own_workers, workers_of

WORK = ".part"
"""What the name of a work file adds to that of the result."""


def in_memory(plan: Plan, walk: Callable[[Store], int]) -> Sweep:
    """Run a sweep and return its arrays."""
    store = Memory(plan)
    walk(store)
    return files.from_memory(outcome(plan, store.blocks))


def into_file(
    plan: Plan, walk: Callable[[Store], int], path: Path, *, overwrite: bool = False
) -> Sweep:
    """Run a sweep into a file, or resume it; an interrupt leaves a file with what there is."""
    files.check(path)
    work = path.with_name(path.name + WORK)
    if not overwrite and files.finished(path, plan):
        if work.exists():  # of a run that was killed just before it removed this
            WorkFile(work, plan).remove()
        return files.from_file(path, plan)
    store = WorkFile(work, plan, anew=overwrite)
    try:
        for litter in path.parent.glob(f".{escape(path.stem)}.*.part{path.suffix}"):
            litter.unlink()  # of a run that was killed while it wrote the result
        try:
            computed = walk(store)
        except KeyboardInterrupt:
            files.write(outcome(plan, store.blocks, FAILURES_LISTED), path)
            raise
        files.write(outcome(plan, store.blocks, FAILURES_LISTED), path)
    finally:
        store.close()
    store.remove()
    return files.from_file(path, plan, computed)


def walker(
    plan: Plan,
    executor: Executor | None,
    jobs: int,
    in_flight: int | None,
    block: int | None,
    report: Progress | None,
) -> Callable[[Store], int]:
    """Return what fills a store with the blocks that it lacks, and counts the points of these."""

    def walk(store: Store) -> int:
        done = store.done()
        before, computed, failed = sum(stop - start for start, stop in done), 0, 0
        several = workers_of(executor, jobs)
        compile_ahead(plan, plan.points - before, several)
        began = monotonic()

        def show() -> None:
            if report:
                share = (before + computed) / plan.points
                report(share, told(plan, before, computed, failed, monotonic() - began))

        def keep(result: Block) -> None:
            nonlocal computed, failed
            store.keep(result)
            computed += result.stop - result.start
            failed += len(result.failures)
            show()

        show()
        tasks = engine.remaining(plan, done, block)
        if executor is None and jobs == 1:
            engine.run_here(tasks, keep)
            return computed
        flying = in_flight or AHEAD * several
        pool = (
            own_workers(jobs, threads=plan.vectorised)
            if executor is None
            else nullcontext(partial(_same, executor))
        )
        with pool as workers:
            engine.run_by(workers, tasks, keep, flying, show)
        return computed

    return walk


def told(plan: Plan, before: int, computed: int, failed: int, seconds: float) -> str:
    """Say how far a sweep is; `before` counts the points of an earlier run, which the rate leaves out."""
    text = f"{before + computed:,} of {plan.points:,} points"
    rate = computed / seconds if seconds > 0.0 else 0.0
    if rate > 0.0:
        text += f", {rate:,.0f} a second" if rate >= 10.0 else f", {rate:.2g} a second"
    return text + (f", {failed:,} failed" if failed else "")


def _same(executor: Executor) -> Executor:
    return executor
