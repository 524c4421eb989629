"""Sweeps survive kills, interrupts and full disks, never write over another file, and notice damage."""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import numpy as np
import psutil
import pytest

import kvtheory as kv
from kvtheory.sweeps.store import HEAD
from tests.sweep_driver import (
    OVER,
    POINTS,
    SLOW_POINTS,
    assert_same,
    done_of,
    kept,
    run,
    run_slowly,
)

ROOT = Path(__file__).parent.parent
V, TAU = "drive.velocity", "foundation.retardation_time"
SMALL = {V: "1 mm/s:10 m/s:40:log", TAU: ["50 ms", "0.2 s", "1 s"]}
REFUSED = r"not a sweep as it was written.*overwrite"
SUFFIXES = pytest.mark.parametrize("suffix", [".csv", ".nc"])


def driver(*arguments):
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-m", "tests.sweep_driver", *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=ROOT,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip


def wait_for(process, count):
    while int(process.stdout.readline()) < count:
        pass


def small(path, **more):
    return kv.sweep(output=path, **{"over": SMALL, **more})


def stop(share, words):
    """Stop a sweep after its first block."""
    if " a second" in words:
        raise OSError("enough")


def flipped(content, at):
    return content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :]


def names(folder):
    return [item.name for item in folder.iterdir()]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The file of a sweep that nothing disturbed."""
    path = tmp_path_factory.mktemp("whole") / "map.csv"
    run(path)
    return path.read_bytes()


def test_a_sweep_killed_at_random_moments_resumes_to_the_same_bytes(tmp_path, whole):
    output = tmp_path / "map.csv"
    told, errors = driver("kill", output).communicate()
    lives = json.loads(told or errors.decode())
    assert len(lives) > 12  # it was killed all but the last time
    earlier = 0
    for first, last, found in lives[:-1]:
        assert first >= earlier, "blocks were lost"
        assert found is None or found >= last
        earlier = last if found is None else found
    assert output.read_bytes() == whole
    assert names(tmp_path) == ["map.csv"]


def test_workers_end_with_a_killed_parent_and_their_sweep_resumes(tmp_path):
    output, undisturbed = tmp_path / "map.csv", tmp_path / "undisturbed.csv"
    process = driver(output, 2)
    wait_for(process, 20)
    children = psutil.Process(process.pid).children()
    workers = [child for child in children if "spawn_main" in str(child.cmdline())]
    assert len(workers) == 2
    process.kill()
    process.communicate()
    assert not psutil.wait_procs(workers, timeout=10)[1]
    assert 20 <= kept(output) < SLOW_POINTS
    run_slowly(output)
    run_slowly(undisturbed)
    assert output.read_bytes() == undisturbed.read_bytes()


@SUFFIXES
def test_an_interrupt_leaves_a_file_with_what_there_is_and_the_rest_follows(tmp_path, suffix):
    import xarray

    path, before = tmp_path / f"map{suffix}", []

    def interrupt(share, words):
        if done_of(words) >= 60:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        small(path, block=30, progress=interrupt)
    if suffix == ".csv":
        text = path.read_text(encoding="utf-8")
        assert "# unfinished: 60 of 120 points" in text
        assert sum(line[0] != "#" for line in text.splitlines()) == 61
    else:
        with xarray.open_dataset(path) as data:
            known = np.isfinite(data["load"].values.reshape(-1))
            assert known.tolist() == [True] * 60 + [False] * 60
    found = small(path, progress=lambda share, words: before.append(done_of(words)))
    assert (before[0], found.computed) == (60, 60)
    assert_same(found, kv.sweep(over=SMALL))
    assert names(tmp_path) == [path.name]


def test_a_full_disk_is_reported_and_nothing_kept_is_lost(tmp_path, whole, monkeypatch):
    output = tmp_path / "map.csv"
    process = driver(output, 1, 50_000)
    _, message = process.communicate()
    assert process.returncode == 1
    assert b"OSError" in message
    assert b"map.csv.part" in message
    assert not output.exists()
    assert kept(output) > 0

    def full(plan, block):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("kvtheory.sweeps.files._rows", full)
        with pytest.raises(OSError, match="No space"):
            run(output)
    assert names(tmp_path) == ["map.csv.part"]
    assert kept(output) == POINTS
    run(output)
    assert output.read_bytes() == whole


@SUFFIXES
def test_another_sweep_in_the_file_is_refused_and_left(tmp_path, suffix, monkeypatch):
    output = tmp_path / f"map{suffix}"
    asked = {"over": OVER, "quantities": "depth", "output": output}
    series = {"at": ["1 ms"], "over": {V: [0.1]}}
    first, before = kv.sweep(**asked), output.read_bytes()
    changes = {
        "scene": {"scene": kv.Scene.table1("fixed")},
        "over": {"over": {V: [1.0, 2.0]}},
        "quantities": {"quantities": "load"},
        "method": {"method": "asymptote"},
        "at": series,
        "rtol": {**series, "rtol": 1e-5},
    }
    for word, change in changes.items():
        with pytest.raises(ValueError, match=f"differs in .*{word}"):
            kv.sweep(**asked | change)
    with monkeypatch.context() as patch:
        patch.setattr("kvtheory.sweeps.plan.version", lambda name: "9.9.9")
        with pytest.raises(ValueError, match="differs in kvtheory"):
            kv.sweep(**asked)
    monkeypatch.setattr("kvtheory.sweeps.engine.compute", None)  # nothing is computed again
    assert np.array_equal(kv.sweep(**asked)["depth"], first["depth"])
    assert output.read_bytes() == before
    assert names(tmp_path) == [output.name]


@pytest.mark.parametrize("name", ["map.csv", "map.nc", "map.csv.part", "map.nc.part"])
@pytest.mark.parametrize("content", [b"", b"time [s],depth [m]\r\n0,1\r\n", b"\x00\xff" * 5000])
def test_files_of_others_are_left_alone(tmp_path, name, content):
    foreign = tmp_path / name
    if not content and name.endswith(".part"):  # a work file begins with an empty file
        content = b"precious"
    foreign.write_bytes(content)
    with pytest.raises(ValueError, match=r"is not a (work file of a )?sweep"):
        kv.sweep(over={V: [1.0]}, output=tmp_path / name.removesuffix(".part"))
    assert foreign.read_bytes() == content
    assert list(tmp_path.iterdir()) == [foreign]


def test_only_its_own_leftovers_are_removed(tmp_path):
    ours, others = (tmp_path / f".{stem}.0123456789ab.part.csv" for stem in ("map", "map.fine"))
    ours.touch()
    others.touch()  # another sweep, into map.fine.csv, may be writing it
    small(tmp_path / "map.csv")
    assert sorted(names(tmp_path)) == [others.name, "map.csv"]


def test_the_same_sweep_cannot_run_twice_at_a_time(tmp_path):
    refused = []

    def second(share, words):
        if not refused:
            with pytest.raises(OSError, match="in use") as error:
                small(tmp_path / "map.csv")
            refused.append(error)

    small(tmp_path / "map.csv", progress=second)
    assert refused


def test_an_unwritable_place_is_reported(tmp_path):
    with pytest.raises(OSError, match="no directory"):
        small(tmp_path / "nowhere" / "map.csv")
    (tmp_path / "map.csv.part").mkdir()
    with pytest.raises(OSError, match=r"map\.csv\.part"):
        small(tmp_path / "map.csv")
    assert names(tmp_path) == ["map.csv.part"]


@pytest.mark.skipif(sys.platform != "linux", reason="reads the peak of the memory from /proc")
def test_memory_is_bounded_by_the_block(tmp_path):
    code = (
        "import sys, kvtheory as kv\n"
        "kv.sweep(over={'drive.velocity': f'1 mm/s:10 m/s:{sys.argv[1]}:log',"
        " 'foundation.retardation_time': '10 ms:1 s:100'}, output='map.csv', block=10000, overwrite=True)\n"
        # The peak of getrusage is that of the parent, if that was larger.
        "print(next(l.split()[1] for l in open('/proc/self/status') if l.startswith('VmHWM')))"
    )
    few, many = (
        int(subprocess.check_output([sys.executable, "-c", code, count], cwd=tmp_path)) / 1024
        for count in ("100", "4000")
    )
    assert many < few + 15.0, (few, many)  # The results of 400,000 scenes are 32 MB.


def test_a_csv_that_was_cut_is_never_taken_for_whole(tmp_path):
    path = tmp_path / "map.csv"
    small(path)
    content = path.read_bytes()
    for spoilt in (
        b"",
        *(content[:end] for end in np.linspace(1, len(content) - 1, 7).astype(int)),
    ):
        path.write_bytes(spoilt)
        with pytest.raises(ValueError, match=REFUSED):
            small(path)
        assert path.read_bytes() == spoilt
    small(path, overwrite=True)
    assert small(path).computed == 0
    assert names(tmp_path) == [path.name]


def test_a_damaged_netcdf_file_gives_no_wrong_number(tmp_path):
    path, chance, noticed = tmp_path / "map.nc", random.Random(1), 0
    small(path)
    content, right = path.read_bytes(), small(path).values
    places = [at for at, byte in enumerate(content) if byte]
    for at in chance.sample(places, 16):
        path.write_bytes(flipped(content, at))
        try:
            found = small(path).values
        except (ValueError, OSError):
            noticed += 1
        else:
            assert all(np.array_equal(found[name], right[name]) for name in right)
    assert noticed > 6


@pytest.mark.parametrize(
    "asked", [{}, {"quantities": ["load", "events"], "over": {V: [0.05, 0.1]}}]
)
def test_a_damaged_block_of_the_work_file_is_computed_again(tmp_path, asked):
    path, chance = tmp_path / "map.csv", random.Random(2)
    whole = small(tmp_path / "whole.csv", **asked).path.read_bytes()
    with pytest.raises(OSError, match="enough"):
        small(path, block=1, progress=stop, **asked)
    assert kept(path) == 1
    work = path.with_name("map.csv.part")
    content = work.read_bytes()
    first, block = content.index(b"{"), content.index(b"[0, 1, ")
    assert block < len(content) - 100
    for at in chance.sample(range(first, block - HEAD.size), 6):  # which sweep it is
        work.write_bytes(flipped(content, at))
        with pytest.raises(ValueError, match="another sweep"):
            small(path, **asked)
        assert work.read_bytes() == flipped(content, at)
    places = chance.sample(range(block - HEAD.size, len(content)), 12)
    spoilt = [flipped(content, at) for at in places] + [content[:at] for at in places[:3]]
    zeros = bytes(len(content) - block + HEAD.size)  # what a power cut may leave
    for left in [content, *spoilt, content[: block - HEAD.size] + zeros]:
        work.write_bytes(left)
        found = small(path, **asked)
        assert found.computed == found.points - (left == content)
        assert path.read_bytes() == whole
        path.unlink()


def test_overwriting_computes_anew_and_drops_the_unfinished_work_of_another_sweep_only(tmp_path):
    path, other = tmp_path / "map.csv", {V: [0.1, 0.2]}
    path.write_text("time [s],depth [m]\n0,1\n")
    assert small(path, overwrite=True).computed == 120
    assert small(path).computed == 0
    for _ in range(2):
        assert small(path, over=other, overwrite=True).computed == 2
    path.unlink()
    for overwrite, found in ((False, 30), (False, 60), (True, 90)):
        with pytest.raises(OSError, match="enough"):
            small(path, block=30, progress=stop, overwrite=overwrite)
        assert kept(path) == found
        with pytest.raises(ValueError, match=r"map.csv.part.*differs in over"):
            small(path, over=other)
    assert small(path, overwrite=True).computed == 30
    with pytest.raises(OSError, match="enough"):
        small(path, block=30, progress=stop, overwrite=True)
    assert small(path, over=other, overwrite=True).computed == 2


@SUFFIXES
def test_every_mixture_of_columns_is_kept_written_and_read(tmp_path, suffix):
    """Numbers, series and texts, alone or together, of scenes of which one fails and one is at rest."""
    kinds = {
        "steady": "load",
        "series": "depth",
        "peak": "peak_to_steady_friction",
        "text": "events",
    }
    for number, chosen in enumerate([("steady",), ("text",), ("series", "text"), kinds]):
        asked = {"over": {V: [0.05, 0.0, 1e200]}, "quantities": [kinds[name] for name in chosen]}
        asked |= {"rtol": 1e-4} | ({"at": "0 ms:200 ms:3"} if "series" in chosen else {})
        held = kv.sweep(**asked)
        path, copy = (tmp_path / f"{of}{number}{suffix}" for of in ("stored", "saved"))
        with pytest.raises(OSError, match="enough"):
            kv.sweep(output=path, block=1, progress=stop, **asked)
        stored = kv.sweep(output=path, **asked)
        held.save(copy)
        saved = kv.sweep(output=copy, **asked)
        assert (held.failed, stored.computed, saved.computed) == (1, 2, 0)
        for other in (stored, saved):
            assert_same(other, held)
        if "peak" in chosen:
            assert np.isnan(held["peak_to_steady_friction"][1:]).all()  # no friction at rest
        if "text" in chosen:
            assert json.loads(held["events"][0])[0]["time"] == 0.0
            assert held["events"][2] == ""


def test_what_cannot_fit_is_refused_with_its_size_before_anything_is_done(tmp_path):
    over = {
        V: "1 mm/s:1 m/s:1000000",
        TAU: "1 ms:1 s:1000000",
        "support.mass": "1 kg/m:2 kg/m:10000",
    }
    for output in (None, tmp_path / "map.csv", tmp_path / "map.nc"):
        with pytest.raises(ValueError, match=r"10,000,000,000,000,000 points need .* GB; there"):
            kv.sweep(over=over, output=output)
    assert not list(tmp_path.iterdir())
