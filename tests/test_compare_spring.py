"""Time series of an indenter on a spring held against theory: what agrees, what does not, and its name."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.checks.columns import recognise
from kvtheory.checks.fitting import scaled_scene
from kvtheory.checks.theory import Rates
from tests.confusion import SCENES as PLANTED
from tests.confusion import STOP_AND_GO
from tests.faulty_simulator import simulate

SCENES = {
    "stable": PLANTED["spring"],
    "to and fro": PLANTED["spring, to and fro"],
    "stick-slip": kv.Scene(drive=kv.Drive("91 mm/s", stiffness="1 MN/m^2")),
    "fixed": kv.Scene(
        support=kv.Fixed("0.3 mm"), drive=kv.Drive("0.1 m/s", stiffness="1 MN/m^2", mass="1 kg/mm")
    ),
    "backward": kv.Scene(drive=kv.Drive(history=STOP_AND_GO, stiffness="1 MN/m^2")),
}
MEASURED = ("time", "depth", "normal_force", "friction_force", "spring_force", "sliding_velocity")


def solved(scene, count=401):
    at = np.linspace(0.0, scene.run.duration, count)
    found = kv.transient(scene, at=at, rtol=1e-9, certify=False)
    return {name: getattr(found, name) for name in found.units if name != "velocity"}


@cache
def exact(name):
    return solved(SCENES[name])


def failed(found):
    return [check.name for check in found.checks if check.ok is False]


@pytest.mark.parametrize("name", SCENES)
def test_elements_that_share_no_code_with_theory_agree(name):
    found = kv.compare(SCENES[name], simulate(SCENES[name], time_step=1e-4))
    assert failed(found) == []
    assert found.verdict == "agrees"
    made = {check.name for check in found.checks if check.ok}
    assert {"sliding velocity, largest", "spring force, largest", "velocity, largest"} <= made


@pytest.mark.parametrize("name", SCENES)
def test_theory_agrees_with_itself_noisy_and_rounded_too(name):
    rng = np.random.default_rng(3)
    series = {key: values for key, values in exact(name).items() if key in MEASURED}
    curves = {key: values for key, values in series.items() if key != "time"}
    noisy = {key: x * (1.0 + 0.01 * rng.standard_normal(x.size)) for key, x in curves.items()}
    digits = {key: np.array([float(f"{v:.3g}") for v in x]) for key, x in curves.items()}
    found = kv.compare(SCENES[name], exact(name))
    curves_of = [c for c in found.checks if c.name.endswith(("RMS", "largest"))]
    assert max(check.measured / check.allowed for check in curves_of) < 1e-3
    for changed in (noisy, digits):
        assert failed(kv.compare(SCENES[name], {"time": series["time"], **changed})) == []


@pytest.mark.parametrize("factor", [1.01, 0.8])
@pytest.mark.parametrize("symbol", ["k_x", "M_x", "c_x"])
def test_a_wrong_spring_mass_or_damper_is_named_and_measured(symbol, factor):
    """A hundredth shows where the elements are known to be fine."""
    scene = SCENES["stable"]
    key = {"k_x": "drive.stiffness", "M_x": "drive.mass", "c_x": "drive.damping"}[symbol]
    fine = "20000 /mm" if abs(factor - 1.0) < 0.1 else None
    found = kv.compare(scene, solved(scaled_scene(scene, {key: 1.0}, factor)), per_length=fine)
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == f"wrong {symbol}", found.diagnosis
    assert found.explanations[0].factor == pytest.approx(factor, rel=5e-3)


@pytest.mark.parametrize("name", ["stable", "stick-slip", "fixed"])
def test_a_rigid_drive_in_the_place_of_the_spring_is_named(name):
    scene = SCENES[name]
    rigid = replace(scene, drive=kv.Drive(scene.drive.velocity))
    found = kv.compare(scene, solved(rigid))
    assert found.explanations[0].name == "rigid drive instead of a spring", found.diagnosis


def test_a_damper_that_the_scene_has_not_is_measured():
    scene = SCENES["stick-slip"]
    damped = replace(scene, drive=scene.drive.changed(damping=3000.0))
    found = kv.compare(scene, solved(damped))
    assert found.explanations[0].name == "wrong c_x"
    assert "c_x = 30" in found.diagnosis


def test_the_sensor_in_the_drive_is_enough():
    """An experiment may know the force of the spring alone."""
    series = exact("stick-slip")
    heads = {"t [ms]": 1e3 * series["time"], "spring force [N/mm]": 1e-3 * series["spring_force"]}
    assert kv.compare(SCENES["stick-slip"], heads).verdict == "agrees"
    wrong = {**heads, "spring force [N/mm]": -heads["spring force [N/mm]"]}
    found = kv.compare(SCENES["stick-slip"], wrong)
    assert found.explanations[0].name == "sign of spring_force"
    late = kv.compare(SCENES["stick-slip"], {**heads, "t [ms]": heads["t [ms]"] + 30.0})
    assert late.explanations[0].name == "time offset"
    assert late.explanations[0].factor == pytest.approx(0.03, rel=0.01)


def test_a_wrong_unit_of_the_time_is_named():
    series = exact("stick-slip")
    found = kv.compare(SCENES["stick-slip"], {**series, "time": 1e-3 * series["time"]})
    assert found.explanations[0].name == "unit of time"


def test_where_the_phase_is_lost_agreement_says_nothing():
    """Coarse elements, and swings enough to be anywhere."""
    scene = replace(SCENES["stick-slip"], run=kv.Run(20.0))
    data = solved(scene, 1500)
    found = kv.compare(scene, data, per_length="50 /mm")
    assert failed(found) == ["phase of the cycle"]
    assert found.verdict == "cannot tell"
    assert "Theory cannot say where the cycle" in found.diagnosis
    assert kv.compare(scene, data, per_length="1000 /mm").verdict == "agrees"


def test_steady_sliding_is_the_limit_where_it_is_stable():
    checks = {
        name: {check.name: check for check in kv.compare(SCENES[name], exact(name)).checks}
        for name in ("stick-slip", "fixed")
    }
    assert checks["fixed"]["phase of the cycle"].ok is None
    assert "unstable" in checks["stick-slip"]["steady limit"].note
    assert "rigid drive" in checks["stick-slip"]["slow time constant"].note
    assert checks["stick-slip"]["phase of the cycle"].ok


def test_a_settled_motion_is_held_against_exact_steady_sliding():
    spring = kv.Drive("20 mm/s", stiffness="1 MN/m^2", damping="50 kN*s/m^2")
    scene = kv.Scene(drive=spring, run=kv.Run(2.0))
    found = {check.name: check for check in kv.compare(scene, solved(scene)).checks}
    assert found["steady limit"].ok


def test_time_constants_of_any_number_of_motions():
    rates = Rates.of([2.0, 0.1, 4.0 + 3.0j, 4.0 - 3.0j])
    assert (rates.fast, abs(rates.slow)) == (0.1, 5.0)
    assert rates.settling == pytest.approx(25.0 / 4.0)
    assert math.isinf(Rates.of([1.0, -2.0]).settling)


@pytest.mark.parametrize(
    ("header", "quantity"),
    [("sliding velocity [mm/s]", "sliding_velocity"), ("F_s [N/mm]", "spring_force"),
     ("Federkraft [N/mm]", "spring_force"), ("V [mm/s]", "velocity")],
)  # fmt: skip
def test_columns_of_a_spring_are_their_own(header, quantity):
    assert recognise(header).quantity == quantity


def test_a_rigid_drive_slides_at_its_velocity_and_holds_the_friction():
    data = kv.transient(at=np.linspace(0.0, 0.2, 200).tolist(), rtol=1e-9)
    columns = {
        "time": data.time, "sliding_velocity": data.velocity, "spring_force": data.friction_force,
    }  # fmt: skip
    assert kv.compare(data=columns).verdict == "agrees"


def test_a_wrong_spring_is_measured_where_theory_is_by_elements():
    rubber = kv.GeneralizedMaxwell(1e10, [(3e10, 0.01)])
    drive = kv.Drive("91 mm/s", stiffness="20 MN/m^2")
    scene = kv.Scene(foundation=rubber, drive=drive, run=kv.Run("30 ms"))
    given = scaled_scene(scene, {"drive.stiffness": 1.0}, 0.8)
    for data, verdict in ((scene, "agrees"), (given, "disagrees")):
        at = np.linspace(0.0, 0.03, 101)
        found = kv.compare(scene, kv.elements(data, per_length="100 /mm", at=at, certify=False))
        assert found.verdict == verdict, found.diagnosis
    assert found.explanations[0].name == "wrong k_x", found.diagnosis
    assert found.explanations[0].factor == pytest.approx(0.8, rel=2e-2)


@pytest.mark.parametrize("scheme", ["edge-corrected", "semi-implicit"])
def test_our_own_simulation_agrees(scheme):
    found = kv.compare(SCENES["backward"], scheme=scheme)
    assert failed(found) == []
    assert found.verdict == "agrees"


def test_our_own_run_that_diverges_disagrees(tmp_path):
    slow = kv.Scene(drive=kv.Drive("12 mm/s", stiffness="1 MN/m^2"))
    found = kv.compare(slow, scheme="paper", per_length="60 /mm")
    assert failed(found) == ["run to the end"]
    assert found.explanations[0].name == "unstable time step"
    found.to_csv(tmp_path / "a.csv")
    assert "depth, theory [m]" in (tmp_path / "a.csv").read_text(encoding="utf-8")
