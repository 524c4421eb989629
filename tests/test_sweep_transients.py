"""Measures of transients in sweeps, held against the transient itself on a dense grid of times."""

import dataclasses
import json
import math

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results import TRANSIENT_UNITS
from kvtheory.results.table import scales
from kvtheory.scene.static_state import StaticState
from kvtheory.sweeps import measures, simulated
from kvtheory.sweeps.plan import Plan, columns_of

V, TAU, DURATION = "drive.velocity", "foundation.retardation_time", "run.duration"
DENSE = np.linspace(0.0, 1.0, 20_001)

SCENES = {
    "spike and rise": kv.Scene(),
    "fixed": kv.Scene.table1("fixed"),
    "suspended": kv.Scene.table1("suspended"),
    "oscillates": kv.Scene(foundation=kv.Foundation(1e10, 2e-4), drive=kv.Drive(2.0)),
    "hops": kv.Scene(foundation=kv.Foundation(1e10, 1e-3), drive=kv.Drive(20.0)),
    "speeds up": kv.Scene(drive=kv.Drive(history=[(0.0, 0.1), (0.05, 0.1), (0.05, 0.15)])),
    "stops and returns": kv.Scene(
        drive=kv.Drive(history=[(0.0, 0.1), (0.02, 0.1), (0.02, 0.0), (0.03, -0.02)])
    ),
}
NAMES = [name for name in TRANSIENT_UNITS if name != "time"]
MEASURED = [f"{name}.{of}" for name in NAMES for of in ("end", "max", "min", "time_of_max")]


def one(scene, quantities, **more):
    """A sweep of the scene itself."""
    over = {DURATION: [scene.run.duration]}
    result = kv.sweep(scene, over=over, quantities=quantities, **more)
    assert not result.failures
    return {name: result[name][0] for name in result.values}


@pytest.fixture(scope="module", params=SCENES)
def case(request):
    """A scene, its transient on dense times, and its measures."""
    scene = SCENES[request.param]
    dense = kv.transient(scene, at=DENSE * scene.run.duration)
    whole = ["peak_to_steady_friction", "settling_time", "hops", "events"]
    return request.param, scene, dense, one(scene, [*MEASURED, *whole])


def test_measures_are_those_of_the_dense_series(case):
    _, scene, dense, found = case
    for name in NAMES:
        values = getattr(dense, name)
        spread = np.nanmax(np.abs(values)) + 1e-300
        assert found[f"{name}.end"] == pytest.approx(values[-1], abs=1e-12 * spread, nan_ok=True)
        # A grid can miss a sharp peak, but never by being higher.
        assert found[f"{name}.max"] >= np.nanmax(values) - 1e-9 * spread
        assert found[f"{name}.min"] <= np.nanmin(values) + 1e-9 * spread
        at = [0.0, found[f"{name}.time_of_max"]]
        there = getattr(kv.transient(scene, at=at), name)[1]
        assert there == pytest.approx(found[f"{name}.max"], abs=1e-9 * spread)
    step = np.abs(np.diff(dense.depth)).max()  # the depth has no sharp peaks
    assert dense.depth.min() - step <= found["depth.min"] <= found["depth.max"]
    assert found["depth.max"] <= dense.depth.max() + step


def test_events_hops_and_the_peak_are_those_of_the_transient(case):
    name, scene, _, found = case
    events, mine = kv.transient(scene).events, json.loads(found["events"])
    assert [event["kind"] for event in mine] == [event.kind for event in events]
    assert [event["time"] for event in mine] == pytest.approx([event.time for event in events])
    assert found["hops"] == sum(event.kind == "take-off" for event in events)
    assert (found["hops"] > 0) == (name in ("hops", "stops and returns"))
    when = next(event.time for event in events if event.kind == "friction force maximum")
    at = np.array([np.nextafter(when, 0.0), when])
    peak = np.abs(kv.transient(scene, at=at).friction_force).max()
    steady = abs(kv.steady(scene).friction_force)
    assert found["peak_to_steady_friction"] == pytest.approx(peak / steady, rel=1e-8)


def test_friction_stays_settled_from_the_settling_time_on(case):
    name, scene, dense, found = case
    assert np.isnan(found["settling_time"]) == (name in ("hops", "stops and returns"))
    steady = kv.steady(scene).friction_force
    off = np.abs(dense.friction_force / steady - 1.0)
    changed = np.flatnonzero(dense.velocity != dense.velocity[-1])
    begin = dense.time[changed[-1] + 1] if changed.size else 0.0
    if np.isnan(found["settling_time"]):
        assert off[-1] > 0.01
        return
    settled = dense.time >= begin + found["settling_time"]
    assert (off[settled] <= 0.01 + 1e-9).all()
    outside = dense.time[off > 0.01]
    grid = dense.time[1]
    assert outside.size == 0 or outside[-1] >= begin + found["settling_time"] - grid - 1e-12


def test_a_peak_of_a_run_that_has_not_settled_is_told():
    for indenter in (kv.Parabola(0.01), kv.Circle(0.01)):
        for end, short in ((0.01, True), (0.2, False)):
            over = {DURATION: [end]}
            found = kv.sweep(kv.Scene(indenter), over=over, quantities="peak_to_steady_friction")
            assert ("had not settled" in found.certificate.statement) == short


def test_series_are_those_of_the_transient():
    at = ["0 ms", "3 ms", "100 ms"]
    asked = [*NAMES, "depth.steady", "depth.end", "load"]
    result = kv.sweep(over={V: [0.05, 0.1]}, at=at, quantities=asked)
    for index, velocity in enumerate((0.05, 0.1)):
        single = kv.transient(kv.Scene(drive=kv.Drive(velocity=velocity)), at=at)
        for name in NAMES:
            assert result[name][index].tolist() == getattr(single, name).tolist()
    assert result.to_xarray()["depth"].dims == (V, "time")
    assert result["depth.steady"][1] == kv.steady().depth
    assert result["load"].shape == (2,)
    assert list(kv.sweep(over={V: [0.1]}, at="1 ms").values) == NAMES


def test_a_motion_that_cannot_be_followed_is_told_and_the_others_are_not_touched():
    # A history gives way to a swept velocity.
    history = kv.Scene(drive=kv.Drive(history=[(0.0, 1.0), (1.0, 0.5)]))
    result = kv.sweep(history, over={V: [0.1, 1e200, 0.2]}, quantities="depth.end")
    assert [failure.index for failure in result.failures] == [1]
    assert result.failures[0].reason
    alone = kv.sweep(over={V: [0.2]}, quantities="depth.end")
    assert result["depth.end"][2] == alone["depth.end"][0]
    asked = {"over": {DURATION: [0.2, 0.001]}, "at": ["0.1 s"], "quantities": ["depth", "load"]}
    short = kv.sweep(**asked)  # of which the second run ends before that time
    assert "after the end of the run" in short.failures[0].reason
    assert np.isnan([short["load"], short["depth"][:, 0]]).tolist() == [[False, True]] * 2


def test_the_error_of_a_scene_that_failed_does_not_count(monkeypatch):
    measure = measures.measure

    def failing(*given):
        found = measure(*given)
        found.errors["depth"][1], found.reasons[1] = math.inf, ArithmeticError("no")
        return found

    monkeypatch.setattr(measures, "measure", failing)
    found = kv.sweep(over={V: [0.05, 0.1]}, quantities="depth.end")
    assert 0.0 < found.certificate.relative_error["depth"] < 1e-3
    assert np.isnan(found["depth.end"]).tolist() == [False, True]


def test_the_certificate_covers_the_error_of_measures():
    over = {V: "10 mm/s:1 m/s:5:log"}
    asked = {"over": over, "quantities": ["depth.min", "friction_force.end"]}
    loose, tight = (kv.sweep(rtol=rtol, **asked) for rtol in (1e-4, 1e-10))
    scale = scales(StaticState.of(kv.Scene()))
    for name in loose.values:
        base = name.partition(".")[0]
        error = np.abs(loose[name] - tight[name]).max() / scale[base]
        assert 0.0 < error <= loose.certificate.relative_error[base]


def test_many_scenes_in_one_call_have_the_bits_of_single_ones(monkeypatch):
    """Followed by the compiled kernel of a block, or one by one."""
    from kvtheory.models.continuum import compiled
    from kvtheory.sweeps import measures

    pytest.importorskip("numba")
    asked = {
        "over": {V: "10 mm/s:5 m/s:12:log", TAU: [1e-3, 0.1, 1.0]},
        "at": ["0 ms", "3 ms", "200 ms"],
        "quantities": [*NAMES, *MEASURED, "peak_to_steady_friction", "settling_time", "hops"],
    }
    monkeypatch.setattr(compiled.KERNEL, "worthwhile", lambda *_: True)
    together = kv.sweep(**asked)
    monkeypatch.setattr(measures._Motions, "follow_together", lambda self, indices: False)
    alone = kv.sweep(**asked)
    assert together["hops"].max() > 0
    for name in alone.values:
        assert np.array_equal(together[name], alone[name], equal_nan=True), name
    assert dict(together.certificate.relative_error) == dict(alone.certificate.relative_error)


def test_what_shapes_a_waveform_is_swept_as_any_other_value():
    """The same as each scene alone; a ramp also has a steady state, which a swept velocity moves."""
    swing = kv.Sine(amplitude=0.1, frequency=5.0)
    over = {"drive.frequency": [5.0, 10.0], "drive.amplitude": [0.05, 0.1]}
    scene = kv.Scene(drive=kv.Drive(waveform=swing))
    found = kv.sweep(scene, over=over, quantities="depth.end")["depth.end"]
    for (i, k), depth in np.ndenumerate(found):
        frequency, amplitude = over["drive.frequency"][i], over["drive.amplitude"][k]
        drive = kv.Drive(waveform=kv.Sine(amplitude=amplitude, frequency=frequency))
        assert depth == kv.transient(kv.Scene(drive=drive)).depth[-1]
    ramp = kv.Scene(drive=kv.Drive(waveform=kv.SmoothRamp(velocity=0.1, rise_time=0.01)))
    names = ["friction_force", "friction_force.end"]
    found = kv.sweep(ramp, over={V: [0.05, 0.1]}, quantities=names)
    np.testing.assert_allclose(*(found[name] for name in names), rtol=2e-3)
    with pytest.raises(kv.SceneError, match="replaces the waveform, of which"):
        kv.sweep(scene, over={"drive.frequency": [5.0], V: [0.1]}, quantities="depth.end")


@pytest.mark.parametrize(
    "scene",
    [
        kv.Scene(indenter=kv.Circle(0.01), run=kv.Run(0.01)),
        kv.Scene(
            kv.Circle(0.01), kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01)]), run=kv.Run(0.01)
        ),
        kv.Scene(kv.Circle(0.01), drive=kv.Drive(0.1, stiffness=1e8), run=kv.Run(0.01)),
    ],
    ids=["circle", "circle on a Prony series", "circle on a spring"],
)
def test_what_the_solver_does_not_hold_for_is_swept_by_elements(scene):
    """Within the errors of both, the same as by elements alone; what only the solver gives is refused."""
    over, at = {V: [0.05, 0.1]}, [0.001, 0.01]
    names = ["depth", "friction_force.end"]
    swept = kv.sweep(scene, over=over, quantities=names, at=at)
    for velocity, depths, friction in zip(over[V], *(swept[name] for name in names), strict=True):
        drive = scene.drive.changed(velocity=velocity)
        alone = kv.elements(dataclasses.replace(scene, drive=drive), at=at)
        error, own = (found.certificate.relative_error["depth"] for found in (swept, alone))
        at_rest = kv.elements(scene, at=[0.0], certify=False).depth[0]
        assert np.abs(depths - alone.depth).max() < (error + own) * at_rest
        assert friction == pytest.approx(alone.friction_force[-1], rel=0.02)
    with pytest.raises(ValueError, match=r"settling_time, hops: .*`elements`.* NAME.max"):
        kv.sweep(scene, over=over, quantities=["depth.max", "settling_time", "hops"])


def on_an_arm(stiffness, history, duration):
    foundation = kv.GeneralizedMaxwell(1e10, arms=[(stiffness, 0.01)])
    return kv.Scene(foundation=foundation, drive=kv.Drive(history=history), run=kv.Run(duration))


def test_on_a_prony_series_measures_are_those_of_the_dense_series():
    scene = on_an_arm(3e10, [(0.0, 0.1), (0.008, 0.1), (0.008, 0.02)], 0.03)
    names = "depth", "friction_force", "trailing_edge"
    asked = [f"{name}.{of}" for name in names for of in ("end", "max", "min", "time_of_max")]
    found = one(scene, [*asked, "peak_to_steady_friction", "settling_time", "hops", "events"])
    dense = kv.transient(scene, at=np.linspace(0.0, 0.03, 121), certify=False)
    friction, steady = dense.friction_force, kv.steady(scene).friction_force
    scale, when = scales(StaticState.of(scene)), [found[f"{name}.time_of_max"] for name in names]
    peaks = kv.transient(scene, at=when, certify=False)
    for k, name in enumerate(names):
        values = getattr(dense, name) / scale[name]
        end, top, least = (found[f"{name}.{of}"] / scale[name] for of in ("end", "max", "min"))
        assert end == pytest.approx(values[-1], abs=1e-12)
        assert -1e-9 < top - values.max() < 1e-3
        assert -1e-3 < least - values.min() < 1e-9
        assert getattr(peaks, name)[k] / scale[name] == pytest.approx(top, abs=1e-9)
    ratio = found["friction_force.max"] / steady
    assert found["peak_to_steady_friction"] == pytest.approx(ratio, rel=1e-14)
    settled = dense.time > 0.008 + found["settling_time"]
    outside = np.abs(friction / steady - 1.0) > 0.01
    assert 0 < settled.sum() < 80
    assert not outside[settled].any()
    assert outside[np.flatnonzero(settled)[0] - 2]
    kinds = [event["kind"] for event in json.loads(found["events"])]
    assert found["hops"] == 0.0
    assert kinds == [event.kind for event in dense.events]


def test_a_scene_that_the_solver_refuses_on_a_prony_series_is_swept_by_elements(monkeypatch):
    """Its values are those of elements; what only the solver gives is missing, with the reason."""
    scene, over = on_an_arm(3e10, [(0.0, 0.1), (1.0, 0.1)], 0.01), {V: [0.1, 0.3]}
    solved = measures.certified

    def refusing(scene, *given, **more):
        if scene.drive.velocity == 0.3:
            raise ValueError("it takes off")
        return solved(scene, *given, **more)

    monkeypatch.setattr(measures, "certified", refusing)
    found = kv.sweep(scene, over=over, quantities="depth.end")
    assert not found.failures
    for velocity, depth, error in zip(over[V], found["depth.end"], (1e-6, 1e-3), strict=True):
        alone = dataclasses.replace(scene, drive=kv.Drive(velocity))
        truth = kv.elements(alone, at=[0.01]) if velocity == 0.3 else kv.transient(alone, at=[0.01])
        assert depth == pytest.approx(truth.depth[0], rel=error)
    assert 1e-5 < found.certificate.relative_error["depth"] < 1e-2
    found = kv.sweep(scene, over=over, quantities=["depth.end", "hops"])
    assert [failure.reason for failure in found.failures] == ["it takes off"]


def test_largest_values_by_elements_are_those_of_the_solver_within_what_is_stated():
    """A parabola followed by elements, through a reversal, a swing and a start from rest."""
    stop = kv.Drive(history=[(0.0, 0.1), (0.01, 0.1), (0.01, -0.06)])
    swing = kv.Drive(waveform=kv.Sine(amplitude=0.1, frequency=40.0))
    names = [f"{name}.{of}" for name in ("normal_force", "friction_force", "depth", "depth_rate",
             "peak_pressure", "leading_edge", "trailing_edge") for of in ("max", "min", "end")]  # fmt: skip
    names.append("peak_to_steady_friction")
    for drive in (kv.Drive(0.1), stop, swing):
        scene = kv.Scene(drive=drive, run=kv.Run(0.025))
        asked = names if drive.ends else names[:-1]
        right = kv.sweep(scene, over={"support.mass": [1e3]}, quantities=asked)
        plan = Plan(scene, (), columns_of(asked, series=False), None, "exact", 1e-6)
        friction = np.array([kv.steady(scene).friction_force if drive.ends else np.nan])
        found = simulated.measure(plan, {0: scene}, friction)
        scale = scales(StaticState.of(scene))
        for column in plan.columns:
            of = "friction_force" if not column.base else column.base
            unit = scale[of] if column.base else scale[of] / abs(friction[0])
            off = abs(found.values[column.name][0] - right[column.name].item()) / unit
            assert off <= min(found.errors[of][0], 0.06), (column.name, off, found.errors[of][0])
