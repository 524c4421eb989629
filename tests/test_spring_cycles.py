"""The cycle in which an indenter on a spring ends, in sweeps: what it is, and who has none."""

import dataclasses

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum.cycles import cycle

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
        cycle(kv.transient(rtol=1e-3, certify=False).solution.motion)


def test_series_of_a_spring_over_a_sweep_of_its_stiffness():
    names, over = ["sliding_velocity", "spring_force", "velocity"], {"drive.stiffness": [1e6, 1e7]}
    short = dataclasses.replace(SCENE, run=kv.Run("20 ms"))
    found = kv.sweep(short, over=over, quantities=names, at="0 ms,10 ms", rtol=1e-5)
    assert found["velocity"] == pytest.approx(np.full((2, 2), 0.091))
    assert found["sliding_velocity"][:, 0] == pytest.approx([0.091, 0.091])
    assert found["spring_force"][1, 1] > found["spring_force"][0, 1] > 0.0


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
        assert cycle(found.solution.motion).period == pytest.approx(5.076, rel=1e-3)
    else:
        assert late == pytest.approx(4.3e-3, rel=2e-2)
