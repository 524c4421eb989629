"""The same sweep gives the same bits on every executor, and a pool that breaks costs no finished block."""

import os
import pickle
import signal
import warnings
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import active_children, get_context

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum import compiled
from kvtheory.sweeps import blocks
from kvtheory.sweeps.blocks import compile_ahead, compute, task
from kvtheory.sweeps.plan import Plan, axes_of, columns_of
from tests import sweep_driver
from tests.sweep_driver import done_of

V, TAU = "drive.velocity", "foundation.retardation_time"
OVER = {V: "10 mm/s:1 m/s:5:log", TAU: ["50 ms", "0.2 s", "1 s"]}
STEADY = {"quantities": ["depth", "friction_coefficient"], "method": "quadrature"}
WHOLE = ["peak_to_steady_friction", "settling_time", "hops", "events"]
MOTION = {
    "quantities": [*WHOLE, "depth.end", "depth"], "at": ["0 ms", "7 ms", "0.2 s"], "rtol": 1e-5,
}  # fmt: skip
KINDS = {"steady": STEADY, "motion": MOTION}


def assert_same(a, b):
    sweep_driver.assert_same(a, b)
    assert (a.failures, a.certificate) == (b.failures, b.certificate)


@pytest.fixture(scope="module")
def here():
    """Each sweep, done in this thread."""
    return {kind: kv.sweep(over=OVER, **asked) for kind, asked in KINDS.items()}


class Killer:
    """As `progress` of a sweep, kills one of the processes of `pids` after the first block."""

    def __init__(self, pids):
        self.pids, self.done = pids, []

    def __call__(self, share, words):
        if share and not self.done:
            self.done.append(done_of(words))
            os.kill(self.pids()[0], signal.SIGKILL)


def children():
    return [child.pid for child in active_children()]


class Backwards(Executor):
    """Computes nothing until it must, and then the last block first."""

    def __init__(self):
        self.waiting, self.most, self.down = [], 0, False

    def submit(self, function, /, *arguments):
        future = Future()
        self.waiting.append((future, function, arguments))
        self.most = max(self.most, len(self.waiting))
        if len(self.waiting) == 4:
            self.flush()
        return future

    def flush(self):
        while self.waiting:
            future, function, arguments = self.waiting.pop()
            future.set_result(function(*arguments))

    def shutdown(self, wait=True, *, cancel_futures=False):
        self.down = True


@pytest.mark.parametrize("kind", KINDS)
def test_blocks_in_any_order(here, kind):
    executor = Backwards()
    result = kv.sweep(over=OVER, executor=executor, block=2, in_flight=4, **KINDS[kind])
    assert_same(result, here[kind])
    assert executor.most == 4
    assert not executor.down


def test_threads_of_the_caller(here):
    with ThreadPoolExecutor(2) as executor:
        for kind, asked in KINDS.items():
            assert_same(kv.sweep(over=OVER, executor=executor, block=4, **asked), here[kind])
        assert executor.submit(abs, -1).result() == 1  # it was not shut down


def breaks_and_resumes(here, output, **pool):
    """Kill a process of a pool: one message ends the sweep, and the same call without the pool resumes."""
    arguments, before, kill = (
        {"over": OVER, "block": 1, "output": output, **STEADY},
        [],
        Killer(children),
    )
    with pytest.raises(RuntimeError, match=r"the executor is broken.*the same call resumes"):
        kv.sweep(progress=kill, **pool, **arguments)
    result = kv.sweep(progress=lambda share, words: before.append(done_of(words)), **arguments)
    assert before[0] >= kill.done[0] > 0
    assert_same(result, here["steady"])


def test_own_processes_that_break_lose_no_finished_block(here, tmp_path):
    breaks_and_resumes(here, tmp_path / "map.nc", jobs=2)


def test_the_callers_pool_that_breaks_loses_no_finished_block(here, tmp_path):
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        # The motions in one block of a process of the caller; then the steady states, whose process dies.
        assert_same(kv.sweep(over=OVER, executor=executor, **MOTION), here["motion"])
        breaks_and_resumes(here, tmp_path / "map.csv", executor=executor)


def test_dask_on_a_cluster_of_processes(here, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # those of the cluster's own start and end
        from distributed import Client, LocalCluster

        with (
            LocalCluster(
                n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None,
                worker_dashboard_address=None, local_directory=str(tmp_path),
            ) as cluster,
            Client(cluster) as client,
        ):  # fmt: skip
            executor = client.get_executor(pure=False)
            assert_same(kv.sweep(over=OVER, executor=executor, block=4, **MOTION), here["motion"])
            pids = list(client.run(os.getpid).values())
            assert len({*pids, os.getpid()}) == 3
            kill = Killer(lambda: pids)
            again = kv.sweep(over=OVER, executor=executor, block=1, progress=kill, **STEADY)
            assert kill.done
            assert_same(again, here["steady"])
            assert client.submit(abs, -1).result() == 1


def test_a_task_is_small_and_picklable():
    axes = axes_of(kv.Scene(), {V: np.linspace(0.1, 0.2, 1000), TAU: np.linspace(0.1, 0.2, 1000)})
    plan = Plan(kv.Scene(), axes, columns_of("depth", series=False), None, "exact", 1e-6)
    given = task(plan, 500_064, 500_128)
    text = pickle.dumps(given)
    assert len(text) < 5000
    one, other = (compute(each).table["depth"] for each in (given, pickle.loads(text)))
    assert one.tolist() == other.tolist()


@pytest.mark.parametrize(("quantity", "points", "anew"), [
    ("hops", 320, True), ("hops", 250, True), ("hops", 320, False), ("hops", 40, True), ("load", 320, True),
])  # fmt: skip
def test_kernels_are_compiled_once_before_work_is_given_out(monkeypatch, quantity, points, anew):
    """Two workers would each compile for half of 320 motions of 0.1 s; fewer they had better interpret."""
    told, clock = [], iter([0.0, 0.2])

    class Recording(ThreadPoolExecutor):
        def submit(self, function, given):
            told.append("block")
            raise RuntimeError("enough is known")

    monkeypatch.setattr(blocks, "compute", lambda given: told.append(given.start))
    monkeypatch.setattr(blocks, "thread_time", lambda: next(clock))
    monkeypatch.setattr(compiled.KERNEL, "compiled", None)
    monkeypatch.setattr(compiled.KERNEL, "on_disk", not anew, raising=False)
    monkeypatch.setattr(compiled.KERNEL, "pays", lambda total: total > 15.9)
    with Recording(2) as executor, pytest.raises(RuntimeError, match="enough is known"):
        kv.sweep(over={V: f"10 mm/s:1 m/s:{points}"}, quantities=quantity, executor=executor)
    measured = [0, points - 1] if quantity == "hops" and points >= 50 else []
    first = measured * (2 if points == 320 and anew else 1)
    assert told[: len(first)] == first
    assert set(told[len(first) :]) == {"block"}


@pytest.mark.parametrize("names", [["hops", "depth"], ["events"]])
def test_what_is_compiled_ahead_is_all_that_a_block_calls(monkeypatch, names):
    pytest.importorskip("numba")
    columns = columns_of(names, series="depth" in names)
    axes = axes_of(kv.Scene(), {V: [0.1, 0.2]})
    plan = Plan(kv.Scene(), axes, columns, (0.0, 0.1), "exact", 1e-6)
    compile_ahead(plan, 10**6, 1)
    assert len(compiled.KERNEL.compiled.signatures) == 1
    assert compute(task(plan, 0, 2)).failures == []
    assert kv.transient(at=[0.1]).compiled
    assert len(compiled.KERNEL.compiled.signatures) == 1
