"""Sweeps outlive kills, interrupts, full disks and lost workers, and never write over another file."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import numpy as np
import psutil
import pytest

import kvtheory as kv
from tests.sweep_driver import (
    BLOCK,
    OVER,
    POINTS,
    SLOW_POINTS,
    done_of,
    kept,
    run,
    run_slowly,
)

ROOT = Path(__file__).parent.parent
V = "drive.velocity"


def start(output, jobs=1, *more):
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-m", "tests.sweep_driver", str(output), str(jobs), *more],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT,
    )  # fmt: skip


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The file of a sweep that nothing disturbed."""
    path = tmp_path_factory.mktemp("whole") / "map.csv"
    run(path)
    return path.read_bytes()


def test_a_sweep_killed_at_random_moments_resumes_to_the_same_bytes(tmp_path, whole):
    output = tmp_path / "map.csv"
    done = subprocess.run(
        [sys.executable, "-m", "tests.sweep_driver", "kill", str(output)],
        check=True, capture_output=True, text=True, cwd=ROOT, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip
    lives = json.loads(done.stdout)
    assert len(lives) > 20  # it was killed all but the last time
    earlier = 0
    for first, last, found in lives[:-1]:
        assert first >= earlier, "blocks were lost"
        assert found is None or found >= last
        earlier = last if found is None else found
    assert output.read_bytes() == whole
    assert [item.name for item in tmp_path.iterdir()] == ["map.csv"]


def test_workers_end_with_a_killed_parent_and_their_sweep_resumes(tmp_path):
    output = tmp_path / "map.csv"
    for count in (10, 30):
        process = start(output, 2)
        while int(process.stdout.readline()) < count:
            pass
        workers = [
            p for p in psutil.Process(process.pid).children() if "spawn_main" in str(p.cmdline())
        ]
        assert len(workers) == 2
        process.kill()
        process.communicate()
        assert not psutil.wait_procs(workers, timeout=10)[1]
        assert count <= kept(output) < SLOW_POINTS
    run_slowly(output, jobs=2)
    undisturbed = tmp_path / "undisturbed.csv"
    run_slowly(undisturbed)
    assert output.read_bytes() == undisturbed.read_bytes()


def test_an_interrupt_leaves_a_file_with_what_there_is_and_the_rest_follows(tmp_path, whole):
    output = tmp_path / "map.csv"
    process = start(output)
    while int(process.stdout.readline()) < 10 * BLOCK:
        pass
    process.send_signal(signal.SIGINT)
    process.communicate()
    assert process.returncode == 130
    text = output.read_text(encoding="utf-8")
    rows = [line for line in text.splitlines() if not line.startswith("#")][1:]
    assert 10 * BLOCK <= len(rows) < POINTS
    assert f"# unfinished: {len(rows)} of {POINTS} points" in text
    assert set(rows) < set(whole.decode().splitlines())
    before = []
    run(output, progress=lambda share, words: before.append(done_of(words)))
    assert before[0] == len(rows)
    assert output.read_bytes() == whole


def test_an_interrupted_netcdf_holds_nan_where_nothing_is_yet(tmp_path):
    import xarray

    output = tmp_path / "map.nc"

    def interrupt(share, words):
        if done_of(words) >= 2 * BLOCK:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(output, progress=interrupt)
    with xarray.open_dataset(output) as data:
        assert np.isfinite(data["load"].values).sum() == 2 * BLOCK
    assert np.isfinite(run(output)["load"]).all()


def test_a_full_disk_is_told_and_nothing_kept_is_lost(tmp_path, whole):
    output = tmp_path / "map.csv"
    for limit in (1_000_000, 2_000_000):
        process = start(output, 1, str(limit))
        _, message = process.communicate()
        assert process.returncode == 1
        assert b"OSError" in message
        assert b"map.csv.part" in message
        assert not output.exists()
        assert kept(output) > 0
    run(output)
    assert output.read_bytes() == whole


def test_a_disk_that_is_full_when_the_result_is_written_keeps_the_work(tmp_path, monkeypatch):
    output = tmp_path / "map.csv"

    def full(plan, block):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("kvtheory.sweeps.files._rows", full)
        with pytest.raises(OSError, match="No space"):
            run(output)
    assert [item.name for item in tmp_path.iterdir()] == ["map.csv.part"]
    assert kept(output) == POINTS
    run(output)
    assert output.exists()


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
def test_another_sweep_in_the_file_is_refused_and_left(tmp_path, suffix, monkeypatch):
    output = tmp_path / f"map{suffix}"
    asked = {"over": OVER, "quantities": ["load", "depth"], "output": output}
    first = kv.sweep(**asked)
    before = output.read_bytes()
    changes = {
        "scene": {"scene": kv.Scene.table1("fixed")},
        "over": {"over": {V: [1.0, 2.0]}},
        "quantities": {"quantities": "depth"},
        "method": {"method": "asymptote"},
    }
    for word, change in changes.items():
        with pytest.raises(ValueError, match=f"differs in {word}"):
            kv.sweep(**asked | change)
    with monkeypatch.context() as patch:
        patch.setattr("kvtheory.sweeps.plan.version", lambda name: "9.9.9")
        with pytest.raises(ValueError, match="differs in kvtheory"):
            kv.sweep(**asked)
    monkeypatch.setattr("kvtheory.sweeps.engine.compute", None)  # nothing is computed again
    assert np.array_equal(kv.sweep(**asked)["load"], first["load"])
    assert output.read_bytes() == before
    assert [item.name for item in tmp_path.iterdir()] == [output.name]


def test_an_unfinished_work_file_of_another_sweep_is_refused(tmp_path):
    output = tmp_path / "map.csv"

    def stop(share, words):
        if share:
            raise OSError("enough")

    with pytest.raises(OSError, match="enough"):
        run(output, progress=stop)
    with pytest.raises(ValueError, match=r"map.csv.part.*differs in over"):
        kv.sweep(over={V: [1.0]}, quantities=["load", "depth"], output=output)
    assert kept(output) == BLOCK
    assert not output.exists()


@pytest.mark.parametrize("name", ["map.csv", "map.nc", "map.csv.part", "map.nc.part"])
@pytest.mark.parametrize("content", [b"", b"time [s],depth [m]\r\n0,1\r\n", b"\x00\xff" * 5000])
def test_files_of_others_are_left_alone(tmp_path, name, content):
    foreign = tmp_path / name
    foreign.write_bytes(content)
    if not content and name.endswith(".part"):
        return  # an empty file is what SQLite begins with
    with pytest.raises(ValueError, match=r"is not a (work file of a )?sweep"):
        kv.sweep(over={V: [1.0]}, output=tmp_path / name.removesuffix(".part"))
    assert foreign.read_bytes() == content
    assert list(tmp_path.iterdir()) == [foreign]


def test_another_database_is_left_alone(tmp_path):
    work = tmp_path / "map.csv.part"
    with closing(sqlite3.connect(work)) as base:
        base.execute("CREATE TABLE precious (thing TEXT)")
    before = work.read_bytes()
    with pytest.raises(ValueError, match="is not a work file"):
        kv.sweep(over={V: [1.0]}, output=tmp_path / "map.csv")
    assert work.read_bytes() == before


def test_the_same_sweep_cannot_run_twice_at_a_time(tmp_path):
    output = tmp_path / "map.csv"
    told = []

    def second(share, words):
        if not told:
            with pytest.raises(OSError, match="in use") as error:
                run(output)
            told.append(error)

    run(output, progress=second)
    assert told


def test_an_unwritable_place_is_told(tmp_path):
    with pytest.raises(OSError, match="no directory"):
        run(tmp_path / "nowhere" / "map.csv")
    (tmp_path / "map.csv.part").mkdir()
    with pytest.raises(OSError, match=r"map\.csv\.part"):
        run(tmp_path / "map.csv")
    assert [item.name for item in tmp_path.iterdir()] == ["map.csv.part"]


@pytest.mark.skipif(sys.platform != "linux", reason="asks Linux for the peak of the memory")
def test_memory_is_bounded_by_the_block(tmp_path):
    code = (
        "import sys, kvtheory as kv\n"
        "kv.sweep(over={'drive.velocity': f'1 mm/s:10 m/s:{sys.argv[1]}:log',"
        " 'foundation.retardation_time': '10 ms:1 s:100'}, output='map.csv', block=10000, overwrite=True)\n"
        # The peak that getrusage tells is that of the parent, if that was larger.
        "print(next(l.split()[1] for l in open('/proc/self/status') if l.startswith('VmHWM')))"
    )
    few, many = (
        int(subprocess.run(
            [sys.executable, "-c", code, count], check=True, capture_output=True, text=True, cwd=tmp_path,
        ).stdout) / 1024
        for count in ("100", "5000")
    )  # fmt: skip
    assert many < few + 15.0, (few, many)  # The results of half a million scenes are 40 MB.
