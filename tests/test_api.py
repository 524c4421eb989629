"""`kv.steady` and `kv.asymptotes` as users call them."""

import inspect
import json
import pickle
from concurrent.futures import ThreadPoolExecutor
from functools import cache

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results import STEADY_UNITS


def test_other_shapes_are_integrated_by_default():
    scene = kv.Scene(indenter=kv.Circle(radius=0.01))
    swept = kv.steady(scene, over={"indenter.radius": [0.01, 0.02], "drive.velocity": 0.01})
    assert swept.model == kv.asymptotes(scene).model == "quadrature"
    assert swept.depth.shape == swept.certificate.relative_error["depth"].shape == (2,)
    for method in ("exact", "asymptote"):
        told = r'^`method` = ".*the ball only.*"circle"; use `method` = "quadrature"$'
        with pytest.raises(ValueError, match=told):
            kv.steady(scene, method=method)
    profile = kv.Profile(lambda x: x * x / 0.02, lambda x: x / 0.01)
    integrated = kv.steady(kv.Scene(indenter=profile))
    for name in STEADY_UNITS:
        assert getattr(integrated, name) == pytest.approx(getattr(kv.steady(), name), rel=1e-11)


PUBLIC = (
    kv.steady, kv.asymptotes, kv.transient, kv.elements, kv.compare, kv.solve, kv.sweep, kv.stability,
    kv.footprint, kv.problem, kv.load_scene, kv.to_toml, kv.Scene,
)  # fmt: skip
NEVER = (1j, b"x", dict, object(), np.ones((2, 2), complex), np.datetime64("2020"))
"""Right for no argument."""


@cache
def wrong():
    """Return what is wrong for an argument of a name beside that; libraries of arrays take long to import."""
    import dask.array
    import pandas
    import xarray

    arrays = (
        np.array([0.05, 0.1]),
        pandas.Series([0.05]),
        xarray.DataArray([0.05]),
        dask.array.ones(2),
    )
    numbers = (None, True, "1e-3", -1.0, np.nan, np.inf, np.ma.masked, [0.05], {}, *arrays)
    names = (5, 0.1, np.nan, {"load": 1}, ["load", 5], [["load"]], *arrays)
    counts = (0, -1, 1.0, "2", True, np.nan, np.timedelta64(5), *arrays)
    flags = (None, 1, "yes", np.nan, [True], *arrays)
    size = (0.0, "1 mm", np.nan, *arrays)
    return {
        "rtol": (5, *numbers), "tolerance": numbers,
        **dict.fromkeys(("quantity", "quantities", "overrides", "method", "scheme"), names),
        **dict.fromkeys(("max_steps", "jobs", "block", "in_flight"), counts),
        **dict.fromkeys(("certify", "over_time", "overwrite"), flags),
        "over": (5, "drive.velocity", ["drive.velocity"], {1: 2}, {None: 1}, {(1,): [2]},
                 pandas.DataFrame(), *arrays),
        "scene": (5, "scene.toml", {}, *arrays), "progress": (5, "x", True, dict), "warn": (5, "x"),
        "executor": (5, ThreadPoolExecutor), "output": (5, "", "a\0.csv", *arrays), "path": (5, "", *arrays),
        "at": ("x", {}, np.nan, np.inf, -1.0, [[1.0], [1.0, 2.0]], [], {1: 2}, xarray.Dataset()),
        "time_step": size, "per_length": size,
        "name": (5, None, "wegde", *arrays), "data": (5, np.nan, *arrays),
        **dict.fromkeys(("indenter", "foundation", "support", "drive", "run", "start"), (5, None)),
    }  # fmt: skip


@pytest.mark.parametrize("function", PUBLIC)
def test_a_value_of_a_wrong_kind_is_refused_by_the_name_of_its_argument(function):
    for name in inspect.signature(function).parameters:
        told = "`problem`" if name == "name" else f"`{name}`"
        for value in (*NEVER, *wrong()[name]):
            given = {"over": {"drive.velocity": [0.1]}} if function is kv.sweep else {}
            with pytest.raises((ValueError, TypeError), match=told):
                function(**{**given, name: value})
    with pytest.raises(kv.SceneError) as caught:
        kv.transient(rtol="small", certify=None)
    assert [text.split(" = ")[0] for text in caught.value.problems] == ["`rtol`", "`certify`"]


@pytest.mark.parametrize(
    "given",
    [
        np.ma.masked_array([0.01, 0.02], [0, 1]), [np.ma.masked_array([0.01, 0.02], [0, 1])],
        [0.01, np.ma.masked], np.ma.masked, np.ma.masked_array([[0.01, 0.02]], [[0, 1]]),
    ],
)  # fmt: skip
def test_masked_values_are_refused_wherever_arrays_enter(given):
    for call in (
        lambda: kv.transient(at=given),
        lambda: kv.elements(at=given),
        lambda: kv.solve(at=given),
        lambda: kv.steady(over={"drive.velocity": given}),
        lambda: kv.stability(over={"drive.velocity": given}),
        lambda: kv.sweep(over={"drive.velocity": given}),
        lambda: kv.sweep(over={"drive.velocity": [0.1]}, quantities="depth", at=given),
        lambda: kv.Parabola(given),
        lambda: kv.Drive(history=[(0.0, 0.1), (1.0, given)]),
        lambda: kv.Drive(function=np.sin, breaks=given),
        lambda: kv.compare(data={"time": given, "depth": given}),
    ):
        with pytest.raises(ValueError, match=r"masked|expected|differ in length"):
            call()
    whole = np.ma.masked_array([0.01, 0.02], [0, 0])
    assert kv.transient(at=whole).time.tolist() == [0.01, 0.02]


def test_arrays_of_other_libraries_are_read():
    import dask.array
    import pandas
    import xarray

    plain = kv.steady(over={"drive.velocity": [0.01, 0.02]}).load
    for given in (
        pandas.Series([0.01, 0.02]), xarray.DataArray([0.01, 0.02]), dask.array.from_array([0.01, 0.02]),
        xarray.DataArray([10.0, 20.0], attrs={"units": "mm/s"}), np.array(["10 mm/s", "2 cm/s"]),
        np.array([0.01, 0.02], dtype=object), ("10 mm/s", 0.02),
    ):  # fmt: skip
        over = {"drive.velocity": given}
        assert kv.steady(over=over).load.tolist() == plain.tolist()
        assert kv.sweep(over=over)["drive.velocity"].tolist() == [0.01, 0.02]
    times = np.array([1, 2], dtype="timedelta64[ms]")
    assert kv.transient(at=times).time.tolist() == [1e-3, 2e-3]


def test_a_table_of_pandas_is_compared_in_the_units_of_its_columns():
    import pandas

    run = kv.transient(at=np.linspace(0.0, 0.2, 101))
    table = pandas.DataFrame({"t [ms]": 1e3 * run.time, "depth": run.depth})
    assert kv.compare(data=table).verdict == "agrees"


def test_states_of_no_scenes_of_a_history_and_with_certificates_of_their_own():
    for method in ("exact", "quadrature"):
        assert kv.steady(over={"drive.velocity": []}, method=method).depth.shape == (0,)
    kv.steady().certificate.relative_error["depth"] = 1.0
    assert kv.steady().certificate.relative_error["depth"] < 1e-14
    assert kv.steady(kv.Scene(drive=kv.Drive(history=[(0.0, 0.3), (1.0, 0.1)]))) == kv.steady()


RUBBER = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=[["1 GN/m^3", "10 ms"]]))


@pytest.mark.parametrize(
    "make",
    [
        kv.transient, kv.elements, kv.steady, kv.asymptotes, kv.stability, lambda: kv.solve(at=["1 ms"]),
        lambda: kv.transient(RUBBER), lambda: kv.sweep(over={"drive.velocity": [0.1, 1.0]}),
    ],
)  # fmt: skip
def test_results_can_be_sent_between_processes(make):
    result = make()
    assert pickle.loads(pickle.dumps(result)).as_dict() == result.as_dict()


def test_a_motion_sent_between_processes_still_answers_at_any_time():
    motion = kv.transient()
    moved = pickle.loads(pickle.dumps(motion))
    assert np.array_equal(moved.pressure([-1e-4, 0.0], 0.01), motion.pressure([-1e-4, 0.0], 0.01))


def test_results_become_json_and_what_does_not_exist_is_null():
    record = kv.steady(over={"drive.velocity": [0.1, 0.2]}).as_dict()
    assert json.loads(json.dumps(record, allow_nan=False)) == record
    found = record["model"], record["certificate"]["kind"], len(record["depth"])
    assert found == ("exact", "estimated", 2)
    assert record.keys().isdisjoint({"units", "over"})
    report = kv.asymptotes(over={"drive.velocity": 0.0})
    assert np.isnan(next(line.value for line in report.lines if line.equation == 49))
    record = json.loads(json.dumps(report.as_dict(), allow_nan=False))
    assert record["lines"][3]["value"] is None


def test_regime_and_advice():
    report = kv.asymptotes(over={"drive.velocity": [1e-5, 0.02, 0.03, 10.0]})
    assert report.regime.tolist() == ["low", "low", "high", "high"]
    assert report.use.tolist() == ["L1", "exact", "exact", "L2"]
    backwards = kv.asymptotes(over={"drive.velocity": [-1e-5, -10.0]})
    assert backwards.lines[0].value[0] == -report.lines[0].value[0]
    assert backwards.use.tolist() == ["L1", "L2"]
