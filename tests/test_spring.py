"""The transient on a spring: an independent table, balances, limits, errors, and what happens on the way."""

import dataclasses
import json

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum.collocation import balances as balances_at
from kvtheory.models.continuum.contact import motion
from kvtheory.models.continuum.energy import ledger
from kvtheory.models.continuum.run import Spring
from kvtheory.models.continuum.solver import solve
from kvtheory.models.continuum.surface import volume
from kvtheory.scene.base_motion import BaseMotion, evaluate
from tests import SCENES, spring_random
from tests import spring_reference as ref
from tests.spring_random import balances, in_si, random_case
from tests.test_transient_reference import worst

TABLE = json.loads(ref.TABLE.read_text())
COLUMNS = {
    "d": "depth", "v": "depth_rate", "x": "offset", "w": "offset_rate",
    "f_z": "normal_force", "f_x": "friction_force",
}  # fmt: skip


def solved(name, rtol=1e-9):
    return spring_random.solved(ref.SCENES[name], rtol)


@pytest.mark.parametrize("name", ref.SCENES)
def test_every_quantity_agrees_with_the_independent_table(name):
    states = solved(name).states(ref.SCENES[name].times)
    assert worst(states, COLUMNS, TABLE[name], times_stated=3.0) <= 1e-7


@pytest.mark.parametrize("name", ["damped", "stop", "reversal"])
def test_the_jacobian_is_that_of_both_forces(name):
    """A wrong one would only slow Newton's method down."""
    run, h = solved(name, 1e-6).interpreted, 1e-6
    long = [
        k for k in range(run.now.steps) if run.steps[k].span > 0.01
    ]  # not on ground left just now
    assert len(long) > 9
    for step, along in ((run.steps[k], run.along[k]) for k in long[::3]):
        s = step.start + 0.5 * step.span
        state = np.array([*motion(step, s)[:2], *motion(along, s)[:2]])
        Y, number, _ = evaluate(run.pieces[along.piece], s)

        def forces(state, step=step, s=s, Y=Y, number=number):
            d, v, x, w = state.tolist()
            return np.array(balances_at(run, step, s, (d, v, 0.0, Y - x, number - w, 0.0), x, w))

        for k, change in enumerate(h * np.eye(4), 1):
            slope = (forces(state + change) - forces(state - change))[:, 0] / (2 * h)
            assert forces(state)[:, k] == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_the_table_holds_what_is_hard():
    events = {name: [event.kind for event in solved(name, 1e-4).events] for name in ref.SCENES}
    assert len(events) >= 20
    assert sum("take-off" in kinds for kinds in events.values()) >= 3
    assert sum("sliding reverses" in kinds for kinds in events.values()) >= 8


@pytest.mark.parametrize("seed", range(SCENES // 25))
def test_energy_and_both_impulses_balance(seed):
    motion = random_case(seed).solved(1e-11)
    assert max(balances(motion).values()) < 1e-9
    # the whole foundation pushes with the normal force, f_z = 3/4 (U + U') over all elements (F14)
    s, step = 0.43 * motion.end, 1e-4
    before, now, after = (volume(motion, t) for t in (s - step, s, s + step))
    force = 0.75 * (now + (after - before) / (2 * step))
    assert motion.at(s).normal_force == pytest.approx(force, abs=1e-5 * max(1.0, force))


@pytest.mark.parametrize("seed", range(6))
def test_a_reversed_drive_is_the_mirror_image(seed):
    there, back = (random_case(seed, sign).solved(1e-9).states([0.3, 1.0]) for sign in (1, -1))
    for column in ("sliding_velocity", "offset", "spring_force", "friction_force"):
        np.testing.assert_allclose(there[column], -back[column], atol=1e-6, rtol=0)
    np.testing.assert_allclose(there["depth"], back["depth"], atol=1e-6, rtol=0)


def test_a_spring_so_stiff_that_only_a_damper_saves_it_from_ringing():
    """Ten decades either side: the quasi-static limit along x, and a mass that hardly moves."""
    given = BaseMotion.constant(3.0, 2.0)
    stiff = solve(given, 0.05, 0.0, 2.0, 1e-8, spring=Spring(1e-3, 1e4, 1e10)).states([2.0])[0]
    assert stiff["spring_force"] == pytest.approx(stiff["friction_force"], abs=1e-4)
    rigid = solve(given, 0.05, 0.0, 2.0, 1e-8).states([2.0])[0]
    heavy = solve(given, 0.05, 0.0, 2.0, 1e-8, spring=Spring(1e10, 0.0, 1.0)).states([2.0])[0]
    for row in (stiff, heavy):
        assert row["depth"] == pytest.approx(rigid["depth"], abs=1e-7)


def test_events_of_one_swing_after_the_other_are_not_those_of_one_instant():
    """Each step of this ringing ends at an event, and none is without."""
    spring = Spring(0.4040693775238458, 0.05639174170214583, 11754.287414521204)
    given = BaseMotion.constant(-0.14061512846933633, 2.230349425995419)
    motion = solve(
        given, 3.544933112792483e-05, 0.0349581168774773, given.end, spring=spring, rtol=1e-6
    )
    assert len([event for event in motion.events if "touches" in event.kind]) > 6
    assert motion.at(given.end).depth == pytest.approx(0.9919754, abs=1e-5)


SPRUNG = kv.Drive(velocity="91 mm/s", stiffness="1 MN/m^2")


def test_series_of_a_scene_with_a_spring():
    scene = kv.Scene(drive=SPRUNG)
    result = kv.transient(scene, rtol=1e-8)
    V, own = 0.091, result.as_dict()
    assert {"sliding_velocity", "spring_force"} <= own.keys()
    assert result.velocity == pytest.approx(V, rel=1e-14)
    assert result.sliding_velocity[0] == pytest.approx(V)
    assert result.spring_force[0] == 0.0
    assert set(result.certificate.relative_error) >= {"sliding_velocity", "spring_force"}
    assert "sliding_velocity" not in kv.transient(rtol=1e-4).as_dict()
    books = result.energy(0.2)
    assert abs(books.balance) < 1e-7 * books.work
    assert books.stored_drive > 0.0
    damped = solved("damped", 1e-10)
    assert ledger(damped, damped.end).dissipated_drive > 0.0


def test_edges_follow_the_sign_of_the_sliding_velocity():
    name = "hop"
    motion = solved(name)
    result = kv.transient(in_si(ref.SCENES[name]), rtol=1e-8)
    touching = ~np.isnan(result.leading_edge)
    forward = result.sliding_velocity > 0.0
    left = np.minimum(result.leading_edge, result.trailing_edge)
    assert np.all((result.leading_edge == left)[touching & forward])
    assert np.all((result.trailing_edge == left)[touching & ~forward])
    reversals = [event.time for event in result.events if event.kind == "sliding reverses"]
    assert reversals == pytest.approx(
        [event.s for event in motion.events if event.kind == "sliding reverses"], abs=1e-5
    )


def test_the_certificate_covers_the_error():
    dishonest = []
    for seed in range(SCENES // 16):
        case = random_case(seed)
        result = kv.transient(case.scene(), at=case.times, rtol=1e-5)
        truth = kv.transient(case.scene(), at=case.times, rtol=1e-11, certify=False)
        for name in ("depth", "friction_force", "sliding_velocity", "spring_force"):
            error = np.abs(getattr(result, name) - getattr(truth, name)).max()
            if error > result.certificate.relative_error[name] + 1e-7:
                dishonest.append((seed, name))
    assert dishonest == []


@pytest.mark.parametrize("spring", [{}, {"stiffness": 1e6, "mass": 1000.0}])
def test_pressure_and_surface_of_a_fixed_indenter_owe_the_motion_along_x(spring):
    wave = kv.Sine(amplitude=0.5, frequency=7.0, mean=0.2)
    scene = kv.Scene(support=kv.Fixed(depth=3e-4), drive=kv.Drive(waveform=wave, **spring))
    found, truth = (kv.transient(scene, rtol=rtol, at=[0.05, 0.2]) for rtol in (1e-6, 1e-12))
    units, stated = found.solution.units, found.certificate.relative_error
    for t in found.time:
        x = np.linspace(-3.0, 3.0, 201) * units.half_length
        inside = (np.array([found.pressure(x, t), truth.pressure(x, t)]) > 0.0).all(axis=0)
        p = found.pressure(x[inside], t) / units.pressure
        if spring:
            right = truth.pressure(x[inside], t) / units.pressure
        else:
            xi = x[inside] / units.half_length
            right = 1.0 - xi * (xi + 2.0 * wave(t) / units.velocity)
        assert 0.0 < np.abs(p - right).max() <= stated["pressure"] < 1e-4
        apart = np.abs(found.surface(x, t) - truth.surface(x, t)).max() / units.depth
        assert apart <= stated["surface"] < 1e-4


NAMES = ("stick_slip_settles", "stick_slip_amplitude", "stick_slip_period")
SCENE = kv.Scene(drive=kv.Drive(velocity="91 mm/s", stiffness="1 MN/m^2"), run=kv.Run("3 s"))


def test_steady_sliding_and_stick_slip_on_either_side_of_the_critical_velocity():
    names = [*NAMES, "sliding_velocity.cycle_max", "sliding_velocity.cycle_min"]
    found = kv.sweep(
        SCENE, over={"drive.velocity": ["20 mm/s", "91 mm/s"]}, quantities=names, rtol=1e-5
    )
    settles, amplitude, period, fastest, slowest = (found[name] for name in names)
    assert settles.tolist() == [1.0, 1.0]
    assert amplitude[0] == 0.0
    assert np.isnan(period[0])
    assert fastest[0] == pytest.approx(0.02, rel=1e-2)
    assert slowest[1] < 0.091 < fastest[1]
    # the peaks of the spring force itself, of a motion followed apart
    result = kv.transient(SCENE, at=np.linspace(2.0, 3.0, 4001).tolist(), rtol=1e-6, certify=False)
    force = result.spring_force
    peaks = result.time[1:-1][(force[1:-1] > force[:-2]) & (force[1:-1] >= force[2:])]
    assert period[1] == pytest.approx(np.diff(peaks).mean(), rel=1e-2)
    assert amplitude[1] == pytest.approx(0.5 * np.ptp(force) / 1e6, rel=2e-2)


def test_a_run_that_is_too_short_does_not_settle():
    short = dataclasses.replace(SCENE, run=kv.Run("0.3 s"))
    found = kv.sweep(short, over={"drive.velocity": ["91 mm/s"]}, quantities=NAMES, rtol=1e-4)
    assert found["stick_slip_settles"].tolist() == [0.0]
    assert np.isnan(found["stick_slip_amplitude"]).all()
    assert "no cycle is known" in found.certificate.statement


def test_near_the_limit_of_stability_the_limit_is_told_long_before_it_is_reached():
    # after 1500 cycles it is 0.07144 half lengths; after these 14, 0.106
    near = dataclasses.replace(
        SCENE, drive=kv.Drive(velocity="91 mm/s", stiffness="6.7 MN/m^2"), run=kv.Run("1.2 s")
    )
    found = kv.sweep(near, over={"drive.velocity": [0.091]}, quantities=NAMES, rtol=1e-5)
    half = kv.steady(dataclasses.replace(SCENE, drive=kv.Drive(velocity=1e-6))).half_length
    assert found["stick_slip_settles"].tolist() == [1.0]
    assert found["stick_slip_amplitude"][0] == pytest.approx(0.07144 * half, rel=1.5e-2)
    assert found["stick_slip_period"][0] == pytest.approx(0.07839, rel=1e-3)


def test_a_swing_that_fades_slowly_is_no_cycle():
    # the critical velocity is 53.6 mm/s; each swing is within 1 % of the one before it
    slow = dataclasses.replace(SCENE, run=kv.Run("6 s"))
    found = kv.sweep(slow, over={"drive.velocity": [0.053]}, quantities=NAMES, rtol=1e-4)
    assert found["stick_slip_settles"].tolist() == [0.0]


def test_a_rigid_drive_has_no_cycle():
    with pytest.raises(kv.SceneError, match="stick_slip_period: needs drive"):
        kv.sweep(over={"drive.velocity": [0.1]}, quantities="stick_slip_period")
    with pytest.raises(ValueError, match="drive with a spring"):
        _ = kv.transient(rtol=1e-3, certify=False).solution.cycle


def test_a_sweep_says_where_steady_sliding_is_stable():
    speeds, springs = np.geomspace(0.01, 1.0, 7), np.geomspace(1e4, 1e9, 5)
    over = {"drive.velocity": speeds, "drive.stiffness": springs, "support.mass": [1e2, 1e3]}
    found = kv.sweep(over=over, block=9)
    grid = np.meshgrid(*over.values(), indexing="ij")
    whole = kv.steady(over=dict(zip(over, grid, strict=True)))
    assert np.array_equal(found["stable"], whole.stable)
    assert 0.0 < found["stable"].mean() < 1.0
    assert "stable" not in found.certificate.relative_error
    assert "stable" not in kv.sweep(over={"drive.velocity": speeds}).units
    rigid = kv.sweep(over={"drive.velocity": speeds}, quantities="stable")
    assert np.all(rigid["stable"] == 1.0)


def test_where_stability_is_not_known_a_sweep_says_so():
    wedge = kv.Scene(indenter=kv.Wedge(inclination=0.1), drive=SCENE.drive)
    over = {"drive.velocity": [0.1]}
    assert "stable" not in kv.sweep(wedge, over=over).units
    with pytest.raises(ValueError, match="the stability of steady sliding holds for the parabola"):
        kv.sweep(wedge, over=over, quantities="stable")


@pytest.mark.parametrize(("within", "swings"), [("1 ms", True), ("20 s", False)])
def test_where_steady_sliding_is_stable_a_sudden_start_may_end_in_a_cycle(within, swings):
    """Hard excitation: the same drive, spring and velocity end in two motions."""
    rubber = kv.Foundation(stiffness="10 GN/m^3", retardation_time="1 s")
    history = [["0 s", "0 mm/s"], [within, "4.3 mm/s"]]
    drive = kv.Drive(history=history, stiffness="0.1 MN/m^2")
    scene = kv.Scene(foundation=rubber, drive=drive, run=kv.Run("60 s"))
    found = kv.transient(scene, rtol=1e-4, certify=False)
    steady = dataclasses.replace(scene, drive=kv.Drive(velocity="4.3 mm/s", stiffness="0.1 MN/m^2"))
    assert kv.stability(steady, quantity="stable").stable
    late = found.sliding_velocity[found.time > 45.0]
    if swings:
        assert (late.min(), late.max()) == pytest.approx((0.36e-3, 38e-3), rel=0.05)
        assert found.cycle.period == pytest.approx(5.076, rel=1e-3)
    else:
        assert late == pytest.approx(4.3e-3, rel=2e-2)
