"""Sweeps in memory and in files: what is swept, what is asked, labels, failures, pictures."""

import csv
import io
import json
import math
import re
import threading
import time

import numpy as np
import pytest

import kvtheory as kv
from kvtheory import progress
from kvtheory.results import STEADY_UNITS
from kvtheory.scene.quantities import given
from kvtheory.sweeps import engine
from kvtheory.sweeps.plan import Plan, axes_of, columns_of
from tests.sweep_driver import assert_same

V, TAU = "drive.velocity", "foundation.retardation_time"
GRID = {V: "1 mm/s:10 m/s:7:log", TAU: ["10 ms", "1 s"]}
# The smallest of these velocities underflows in steady sliding; the others do not.
FAILING = {V: [1e-3, 1e-320, 0.1, 1e300], TAU: [0.1, 1e-300]}


def test_a_grid_equals_the_steady_states_of_its_points():
    result = kv.sweep(over=GRID)
    velocities, times = np.geomspace(1e-3, 10.0, 7), np.array([0.01, 1.0])
    assert np.array_equal(result[V], velocities)
    assert np.array_equal(result[TAU], times)
    whole = kv.steady(over={V: velocities[:, None], TAU: times})
    for name in STEADY_UNITS:
        assert np.array_equal(result[name], getattr(whole, name))
        assert result.units[name] == STEADY_UNITS[name]
    assert (result.points, result.failed, result.shape) == (14, 0, (7, 2))
    for name, error in whole.certificate.relative_error.items():
        assert result.certificate.relative_error[name] == np.max(error) < 1e-14


def test_zipped_points_lie_on_the_diagonal():
    over = {(V, TAU): ("1 mm/s:1 m/s:4:log", [0.1, 0.2, 0.3, 0.4])}
    pairs = kv.sweep(over=over, quantities="load")
    grid = kv.sweep(over={V: pairs[V], TAU: pairs[TAU]}, quantities="load")
    assert np.array_equal(pairs["load"], np.diagonal(grid["load"]))
    assert [axis.name for axis in pairs.axes] == ["point"]
    two = (V, TAU), ("indenter.radius", "support.mass")
    twice = kv.sweep(over={keys: ([1.0], [1.0]) for keys in two})
    assert [axis.name for axis in twice.axes] == ["point_1", "point_2"]


LISTS = kv.Scene(support=kv.DeadWeight(mass=[1e3, 2e3, 3e3]))


@pytest.mark.parametrize(
    ("scene", "over", "names", "loads"),
    [
        (LISTS, {V: "10 mm/s:1 m/s:6:log"}, ["support.mass", V], [[1.0] * 6, [2.0] * 6, [3.0] * 6]),
        (LISTS.replace({V: [0.1, 0.2, 0.3]}), None, ["point"], [1.0, 2.0, 3.0]),
        (LISTS.replace({V: [[0.1], [0.2]]}), None, ["point"], [1.0, 2.0, 3.0] * 2),
        (LISTS.replace({V: [0.1, 0.2, 0.3]}), {"support.mass": [2e3, 1e3]}, [V, "support.mass"],
         [[2.0, 1.0]] * 3),
        (kv.Scene(drive=kv.Drive(velocity=[0.1, 1.0])), {"support.mass": [1e3, 3e3]}, [V, "support.mass"],
         [[1.0, 3.0]] * 2),
    ],
)  # fmt: skip
def test_arrays_of_the_scene_are_an_axis_of_the_sweep(scene, over, names, loads):
    result = kv.sweep(scene, over=over, quantities=["load", "friction_force"])
    assert [axis.name for axis in result.axes] == names
    np.testing.assert_allclose(result["load"], 9806.65 * np.array(loads), rtol=1e-12)
    for index in np.ndindex(result.shape):
        at = {
            key: axis.values[key][i]
            for axis, i in zip(result.axes, index, strict=True)
            for key in axis.values
        }
        assert result["friction_force"][index] == kv.steady(over=at).friction_force


def test_transients_of_the_arrays_of_a_scene_do_not_fail():
    found = kv.sweep(LISTS, over={V: [0.1, 0.2]}, quantities="friction_force.max")
    assert found.failed == 0
    one = kv.sweep(over={"support.mass": [3e3], V: [0.2]}, quantities="friction_force.max")
    assert found["friction_force.max"][2, 1] == one["friction_force.max"][0, 0]


def test_arrays_that_do_not_broadcast_are_pointed_to_every_combination():
    with pytest.raises(ValueError, match="`sweep` with `over` takes every combination"):
        kv.steady(LISTS, over={V: [0.1, 0.2]})


SUPPORTS = {support: kv.Scene.table1(support) for support in ("fixed", "dead-weight", "suspended")}
WEDGE = kv.Scene(indenter=kv.Wedge(inclination=0.1))


@pytest.mark.processor
@pytest.mark.parametrize(
    ("scene", "method"),
    [*((scene, "exact") for scene in SUPPORTS.values())]
    + [(WEDGE, method) for method in ("exact", "quadrature", "asymptote")],
)
def test_every_cut_into_blocks_gives_the_same_bits(scene, method):
    over = {V: np.linspace(-2.0, 2.0, 13), TAU: np.geomspace(1e-3, 10.0, 5)}
    whole = kv.sweep(scene, over=over, method=method)
    for block in (2, 5) if method == "quadrature" else (1, 2, 5, 64):
        assert_same(whole, kv.sweep(scene, over=over, block=block, method=method))


@pytest.mark.parametrize("block", [1, 3, 8])
def test_a_scene_that_fails_is_missing_with_its_reason_and_the_others_are_not(block):
    result = kv.sweep(over=FAILING, block=block)
    failed = {failure.index for failure in result.failures}
    assert 0 < len(failed) == result.failed < result.points
    for told in json.loads(json.dumps(result.as_dict(), allow_nan=False))["failures"]:
        assert "range of double precision" in told["reason"]
    for index, (i, j) in enumerate(np.ndindex(4, 2)):
        point = {V: FAILING[V][i], TAU: FAILING[TAU][j]}
        if index in failed:
            assert next(f.point for f in result.failures if f.index == index) == point
            assert np.isnan(result["depth"][i, j])
            with pytest.raises(ValueError, match="double precision"):
                kv.steady(over=point)
        else:
            assert result["depth"][i, j] == kv.steady(over=point).depth


@pytest.mark.parametrize("suffix", [".csv", ".nc"])
@pytest.mark.parametrize("over", [GRID, FAILING, {(V, TAU): ([0.1, 1.0, 2.0], [1.0, 2.0, 3.0])}])
def test_files_hold_what_memory_holds_and_open_in_other_libraries(
    tmp_path, suffix, over, monkeypatch
):
    import pandas
    import xarray

    monkeypatch.setattr("kvtheory.sweeps.files.ROWS", 2)  # so that blocks are printed in parts
    path, saved = tmp_path / f"map{suffix}", tmp_path / f"saved{suffix}"
    stored, held = kv.sweep(over=over, output=path, block=3), kv.sweep(over=over)
    assert [item.name for item in tmp_path.iterdir()] == [path.name]
    held.save(saved)
    for other in (stored, kv.sweep(over=over, output=saved)):
        assert_same(other, held)
        assert (other.failed, other.failures) == (held.failed, held.failures)
        assert other.certificate == held.certificate
    if suffix == ".csv":
        assert saved.read_bytes() == path.read_bytes()
        table = pandas.read_csv(path, comment="#")
        np.testing.assert_allclose(table["load [N/m]"], held["load"].reshape(-1), rtol=1e-15)
        pairs = zip(*(np.atleast_1d(values) for values in held.swept.values()), strict=False)
        assert tuple(table.iloc[0, :2]) == next(pairs)
    else:
        with xarray.open_dataset(path) as data:
            assert data["load"].dims == tuple(axis.name for axis in held.axes)
            assert np.array_equal(data["load"].coords[TAU], held[TAU])


def test_csv_is_long_with_units_and_says_where_it_comes_from(tmp_path):
    scene = kv.Scene.table1("fixed")
    asked = {"over": FAILING, "quantities": ["load", "depth"], "output": tmp_path / "map.csv"}
    result = kv.sweep(scene, **asked)
    lines = (tmp_path / "map.csv").read_text(encoding="utf-8").splitlines()
    comments = [line for line in lines if line.startswith("#")]
    assert lines[: len(comments)] == comments
    assert f"# version: {kv.__version__}" in comments
    toml = [line.removeprefix("#   ") for line in comments if line.startswith("#   ")]
    assert toml == [line for line in kv.to_toml(scene).splitlines() if line]
    assert sum(line.startswith("# failed: point") for line in comments) == result.failed
    head, *rows = csv.reader(lines[len(comments) :])
    assert head == [f"{V} [m/s]", f"{TAU} [s]", "load [N/m]", "depth [m]"]
    assert [float(row[0]) for row in rows] == [v for v in FAILING[V] for _ in range(2)]
    loads = [math.nan if row[2] == "" else float(row[2]) for row in rows]
    assert np.array_equal(loads, result["load"].reshape(-1), equal_nan=True)


def test_netcdf_is_labelled_and_carries_units_scene_and_failures(tmp_path):
    import xarray

    result = kv.sweep(over=FAILING, output=tmp_path / "map.nc", block=2)
    with xarray.open_dataset(tmp_path / "map.nc") as data:
        for one in (data, result.to_xarray()):
            assert one["depth"].dims == (V, TAU)
            assert [one[name].attrs["units"] for name in ("depth", V)] == ["m", "m/s"]
            assert one.attrs["scene"] == kv.to_toml(kv.Scene())
            assert one.attrs["kvtheory_version"] == kv.__version__
            assert one.attrs["certificate"] == result.certificate.statement != ""
            found = one["load"].sel({V: 0.1, TAU: 0.1}).item()
            assert found == kv.steady(over={V: 0.1, TAU: 0.1}).load
        assert data["failure_index"].values.tolist() == [f.index for f in result.failures]
        assert data["failure_reason"].values.tolist() == [f.reason for f in result.failures]
    how = {"over": {V: [0.1, 0.2]}, "at": np.linspace(0.0, 0.2, 4_000), "quantities": "depth"}
    for _ in range(2):
        again = kv.sweep(output=tmp_path / "long.nc", **how)
    assert len(json.dumps(again.plan.record)) > 2**16  # more than HDF5 takes in one piece
    assert again["depth"].shape == (2, 4_000)


def test_a_scene_with_an_empty_list_is_not_swept():
    with pytest.raises(kv.SceneError, match=r"velocity = .*is empty; expected"):
        kv.sweep(kv.Scene(drive=kv.Drive([])), over={TAU: [0.1]})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, ["empty", '{"drive.velocity": "1 mm/s:10 m/s:200:log"}']),
        ({"drive.velocty": [1.0]}, ["drive.velocty", 'did you mean "drive.velocity"']),
        ({V: "1 mm/s:10 m/s"}, [V, "START:STOP:COUNT"]),
        ({V: "1 mm/s:10 m/s:0"}, ["COUNT", "1"]),
        ({V: "1 mm/s:10 m/s:2.5"}, ["COUNT", "2.5"]),
        ({V: "1 mm/s:10 m/s:3:lin"}, ["log"]),
        ({V: "-1 mm/s:10 m/s:3:log"}, ["one sign"]),
        ({V: "1:10:3"}, [V, "no unit"]),
        ({V: "1 mm/s:10 kg:3"}, ["wrong dimension", "m/s"]),
        ({V: []}, ["empty"]),
        ({V: [[0.1, 0.2]]}, ["one list"]),
        ({V: [0.1, math.nan]}, ["out of range"]),
        ({TAU: np.array([0.1, -1.0])}, [TAU, "out of range", "above 0"]),
        ({(V, TAU): ([1.0, 2.0], [1.0])}, ["equally many", f"{V} 2", f"{TAU} 1"]),
        ({(V, TAU): ([1.0],)}, ["a list for each key"]),
        ({(V, V): ([1.0], [1.0])}, ["swept twice"]),
        ({V: [0.1], (TAU, V): ([1.0], [1.0])}, ["swept twice"]),
        ({"support.depth": [1e-3]}, ["support.depth", "support.mass"]),
        ({(V, TAU): 1.0}, ["a list for each key"]),
        ({"a.b": [1.0], V: "x", TAU: [-1.0]}, ["a.b", V, TAU]),  # all mistakes at once
        ({"quantities": ["friction_coeficient"]}, ['did you mean "friction_coefficient"']),
        ({"quantities": ["WRONG"]}, ["expected one of 76 names, such as"]),
        ({"quantities": []}, ["empty"]),
        ({"quantities": "depth.mean"}, ["depth.mean", "depth.min"]),
        ({"at": ["1 s"], "quantities": "depth"}, ["after the end"]),
        ({"at": ["1 ms"], "quantities": "load"}, ["no quantity", "series"]),
        ({"output": "map.xls"}, ["map.xls", ".csv", ".nc"]),
    ],
)
def test_wrong_axes_and_arguments_are_reported(given, words):
    named = given.keys() & {"quantities", "at", "output"}
    with pytest.raises(ValueError, match=r".") as error:
        kv.sweep(**({"over": GRID} | given if named else {"over": given}))
    assert isinstance(error.value, kv.SceneError) or given.keys() & {"at", "output"}
    for word in words:
        assert word in str(error.value)


def plan_of(name, points):
    axes = axes_of(kv.Scene(), {V: np.geomspace(1e-3, 1.0, points)})
    return Plan(kv.Scene(), axes, columns_of(name, series=False), None, "exact", 1e-6)


@pytest.mark.parametrize("points", [3, 200, 5_000, 100_000])
@pytest.mark.parametrize("numba", [True, False])
def test_motions_are_shared_among_workers_and_in_large_blocks_only_if_compiled(
    points, numba, monkeypatch
):
    monkeypatch.setattr(engine, "find_spec", lambda name: numba or None)
    sizes = [task.points for task in engine.remaining(plan_of("hops", points), [])]
    most = engine.COMPILED_BLOCK if numba else engine.SINGLE_BLOCK
    assert sum(sizes) == points
    assert max(sizes) <= most
    assert len(sizes) >= min(engine.LEAST_BLOCKS, points // engine.SINGLE_BLOCK)


def test_remaining_blocks_fill_the_gaps_once():
    done = [(0, 7), (20, 40), (99, 100)]
    tasks = list(engine.remaining(plan_of("depth", 100), done, 16))
    covered = sorted([*done, *((t.start, t.start + t.points) for t in tasks)])
    assert [start for start, _ in covered] == [0, *(stop for _, stop in covered[:-1])]
    assert covered[-1][1] == 100
    assert max(t.points for t in tasks) <= 16
    assert all(t.start % 16 == 0 or t.start in (7, 40) for t in tasks)


@pytest.mark.parametrize("terminal", [False, True])
def test_progress_is_lines_in_a_log_and_a_bar_on_a_terminal(monkeypatch, terminal):
    """The bar goes on while nothing is reported; short work shows nothing, a closed stream ends nothing."""
    stream, shown = io.StringIO(), threading.Event()
    stream.isatty = lambda: terminal
    with progress.progress_bar("sweep", stream=stream) as report:
        report(0.5, "1000 of 2000 points")
    assert not stream.getvalue()

    class Watched(io.StringIO):
        isatty, texts = (lambda _: terminal), ()

        def write(self, text):
            self.texts = *self.texts, text
            found = [each for each in self.texts if "1000 of 2000 points" in each]
            if len(found) > 2:
                shown.set()
            return len(text)

    for name in ("PATIENCE", "ON_TERMINAL", "IN_LOG"):
        monkeypatch.setattr(progress, name, 1e-3)
    watched = Watched()
    with progress.progress_bar("sweep", time.monotonic() - 100.0, watched) as report:
        report(0.5, "1000 of 2000 points")
        assert shown.wait(60.0)
        report(1.0, "2000 of 2000 points")
    text = "".join(watched.texts)
    assert "sweep:  50 %|" in text
    passed = (60 * int(m) + int(s) for m, s in re.findall(r"\| (\d+):(\d+)<", text))
    assert max(passed) >= 100
    assert "sweep: 100 %|" in text.splitlines()[-1].split("\r")[-1]
    assert ("\r" in text) == terminal
    assert text.count("\n") == 1 if terminal else text.count("\n") > 2

    stream.close()
    with progress.progress_bar("sweep", stream=stream) as report:
        report(0.5, "")


def test_one_signature_of_progress():
    """Every public function that takes a while tells the share done, never falling, and words."""
    short = kv.Scene(run=kv.Run("20 ms"))
    data = kv.transient(kv.Scene(drive=kv.Drive("0.11 m/s")), at=np.linspace(0.0, 0.02, 101))
    calls = {
        "sweep": lambda told: kv.sweep(over=FAILING, block=2, progress=told),
        "transient": lambda told: kv.transient(short, progress=told),
        "elements": lambda told: kv.elements(short, per_length="20 /mm", progress=told),
        "compare our own": lambda told: kv.compare(short, per_length="10 /mm", progress=told),
        "solve": lambda told: kv.solve(short, at=["1 ms", "20 ms"], rtol=1e-4, progress=told),
        "compare": lambda told: kv.compare(short, data=data, progress=told),
    }
    for name, call in calls.items():
        told = []
        call(lambda share, words, told=told: told.append((share, words)))
        shares = [share for share, _ in told]
        assert shares == sorted(shares), name
        assert 0.0 <= shares[0] <= shares[-1] <= 1.0, name
        assert all(isinstance(words, str) for _, words in told), name
        if name == "sweep":
            assert told[-1][1].startswith("8 of 8 points, ")
            assert told[-1][1].endswith(" a second, 3 failed")


def test_plot_draws_curves_families_and_maps():
    result = kv.sweep(over={V: "1 mm/s:10 m/s:9:log"})
    (line,) = result.plot().get_lines()
    assert np.array_equal(line.get_ydata(), result["friction_coefficient"])
    assert line.get_xdata() == pytest.approx(result[V] * 1e3)

    family = kv.sweep(over={V: "1 mm/s:10 m/s:9:log", TAU: "10 ms,1 s"}).plot("depth")
    assert len(family.get_lines()) == 2
    assert [text.get_text() for text in family.get_legend().get_texts()] == ["10", "1000"]

    wide = kv.sweep(over={V: "1 mm/s:10 m/s:12:log", TAU: "10 ms:1 s:9:log"})
    image = wide.plot("load").collections[0]
    assert np.array_equal(image.get_array().filled(np.nan), wide["load"] * 1e-3)

    cube = kv.sweep(over={V: [1.0, 2.0], TAU: [1.0, 2.0], "indenter.radius": [0.1, 0.2]})
    with pytest.raises(ValueError, match="two dimensions"):
        cube.plot()
    with pytest.raises(ValueError, match='did you mean "depth"'):
        wide.plot("dept")


def test_every_quantity_of_a_scene_can_be_swept():
    for scene in SUPPORTS.values():
        for section in ("indenter", "foundation", "support"):
            part = getattr(scene, section)
            for name in given(part):
                over = {f"{section}.{name}": [getattr(part, name), 2.0 * getattr(part, name)]}
                found = kv.sweep(scene, over=over, quantities="load")["load"]
                assert found.tolist() == kv.steady(scene, over=over).load.tolist()
