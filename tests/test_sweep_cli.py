"""`kvtheory sweep`, as a shell runs it."""

import json
import sys
from functools import partial

import numpy as np
import pytest

import kvtheory as kv
from tests import commands

OVER = [
    "--over", "drive.velocity=1 mm/s:10 m/s:4:log", "--over", "foundation.retardation_time=10 ms,1 s",
]  # fmt: skip
THREADS = "concurrent.futures:ThreadPoolExecutor"


run = partial(commands.run, "sweep")


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_file_holds_the_sweep_and_the_same_command_has_nothing_left_to_do(place):
    first = run(*OVER, "-o", "map.csv", "--plot", "map.png")
    assert "8 points, 8 of them computed now" in first.stdout
    assert first.stderr == ""  # what takes no second needs no progress
    assert (place / "map.png").read_bytes().startswith(b"\x89PNG")
    lines = (place / "map.csv").read_text().splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    assert rows[0].startswith("drive.velocity [m/s],foundation.retardation_time [s],depth [m],")
    assert len(rows) == 9
    again = json.loads(run(*OVER, "-o", "map.csv", "--json").stdout)
    assert (again["points"], again["computed"], again["failed"]) == (8, 0, 0)


def test_zipped_points_options_and_scene(place):
    (place / "scene.toml").write_text(kv.to_toml(kv.Scene.table1("fixed")))
    run(
        "scene.toml", "--set", "support.depth=0.1 mm", "-o", "pairs.nc", "--quantity", "load,depth",
        "--over", "drive.velocity=0.1 m/s,1 m/s & foundation.retardation_time=1 s:2 s:2",
    )  # fmt: skip
    result = kv.sweep(
        kv.Scene(support=kv.Fixed(depth="0.1 mm")), quantities=["load", "depth"], output="pairs.nc",
        over={("drive.velocity", "foundation.retardation_time"): ([0.1, 1.0], [1.0, 2.0])},
    )  # fmt: skip
    assert result.shape == (2,)
    assert result["depth"].tolist() == [1e-4, 1e-4]


def test_lists_of_the_scene_file_are_columns(place):
    text = kv.to_toml(kv.Scene()).replace('mass = "1000.0 kg/m"', 'mass = ["1 kg/mm", "2 kg/mm"]')
    (place / "scene.toml").write_text(text)
    run(
        "scene.toml",
        "--over",
        "drive.velocity=10 mm/s,1 m/s",
        "--quantity",
        "load",
        "-o",
        "map.csv",
    )
    rows = [line for line in (place / "map.csv").read_text().splitlines() if line[0] != "#"]
    assert rows[0] == "support.mass [kg/m],drive.velocity [m/s],load [N/m]"
    masses, _, loads = np.array([row.split(",") for row in rows[1:]], float).T
    assert masses.tolist() == [1e3, 1e3, 2e3, 2e3]
    np.testing.assert_allclose(loads, 9.80665 * masses, rtol=1e-12)
    run("scene.toml", "--quantity", "load", "-o", "lists.csv")
    commands.refused(["sweep", "-o", "none.csv"], ["over", "is empty", "drive.velocity"])
    assert not (place / "none.csv").exists()


def test_workers_give_the_same_file(place):
    threads = ["--executor", THREADS]
    ways = [], ["--jobs", "2"], [*threads, "--block", "3"], [*threads, "--jobs", "1"]
    for number, more in enumerate(ways):
        run(*OVER, "-o", f"{number}.csv", *more)
    assert len({file.read_bytes() for file in place.iterdir()}) == 1


def test_a_factory_may_lie_in_the_working_directory(place, monkeypatch):
    (place / "our_cluster.py").write_text(
        "from concurrent.futures import ThreadPoolExecutor\nmade = [ThreadPoolExecutor(1)]\n"
        "def workers():\n    return made[0]\n"
    )
    monkeypatch.setattr(sys, "path", list(sys.path))
    run(*OVER, "-o", "map.csv", "--executor", "our_cluster:workers")
    (pool,) = sys.modules["our_cluster"].made
    with pytest.raises(RuntimeError, match="after shutdown"):
        pool.submit(abs, -1)  # what the command made, it ends


def test_failures_are_counted_and_told(place):
    result = run("--over", "drive.velocity=1e-318 m/s:1e-310 m/s:7:log", "-o", "map.csv")
    assert "7 failed" in result.stdout
    assert "range of double precision" in result.stdout
    assert "... the others are in map.csv" in result.stdout
    record = run("--over", "drive.velocity=1e-320 m/s", "-o", "one.csv", "--json").stdout
    (failure,) = json.loads(record)["failures"]
    assert (failure["index"], failure["point"]) == (0, {"drive.velocity": 1e-320})


def test_transients_by_measures_and_series(place):
    told = run(*OVER, "-o", "peaks.csv", "--quantity", "peak_to_steady_friction,hops,events")
    assert "In some scenes friction had not settled" in told.output
    rows = [line for line in (place / "peaks.csv").read_text().splitlines() if line[0] != "#"]
    assert rows[0].endswith("peak_to_steady_friction [1],hops [1],events")
    run(*OVER, "-o", "series.csv", "--quantity", "depth", "--at", "0 ms,1 ms,0.2 s")
    table = np.genfromtxt(place / "series.csv", delimiter=",", skip_header=0, comments="#")[1:]
    assert table.shape == (24, 4)
    assert table[:3, 2].tolist() == [0.0, 0.001, 0.2]


def test_an_interrupt_is_told_and_the_command_goes_on(place, monkeypatch):
    from kvtheory.sweeps import engine

    compute, calls = engine.compute, []

    def interrupted(task):
        calls.append(task)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return compute(task)

    with monkeypatch.context() as patch:
        patch.setattr(engine, "compute", interrupted)
        result = run(*OVER, "-o", "map.csv", "--block", "2", status=130)
    assert '"map.csv" holds the finished points, and the same command resumes' in result.stderr
    assert "# unfinished: 4 of 8 points" in (place / "map.csv").read_text()
    assert "8 points, 4 of them computed now" in run(*OVER, "-o", "map.csv").stdout
    assert [item.name for item in place.iterdir()] == ["map.csv"]


def test_netcdf_without_its_library_is_told(place, monkeypatch):
    monkeypatch.setitem(sys.modules, "netCDF4", None)
    assert 'pip install ".[data]" in the checkout' in run(*OVER, "-o", "a.nc", status=2).stderr
    assert not list(place.iterdir())
