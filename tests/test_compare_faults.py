"""Faults planted in a simulator of its own, and whether the diagnosis names them."""

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.api import _compare
from kvtheory.checks.fitting import uncertainty
from tests.blind_trial import simulated
from tests.confusion import SCENES, quick, series


@pytest.fixture(scope="module", autouse=True)
def _each_mistake_is_simulated_once():
    """Most series are of one scene at the same times, where elements with a mistake do the same again."""
    simulated = _compare.METHODS.elements
    known = {}

    def once(scene, spacing, step, times, does):
        key = repr(scene), spacing, step, tuple(times), tuple(does.items())
        if key not in known:
            known[key] = simulated(scene, spacing, step, times, does)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_compare, "METHODS", _compare.METHODS._replace(elements=once))
        yield


@pytest.mark.parametrize("plant", quick(), ids=lambda plant: f"{plant.scene}: {plant.name}")
def test_each_planted_fault_is_named_and_measured(plant):
    found = kv.compare(SCENES[plant.scene], plant.data(), **plant.known)
    assert found.verdict == "disagrees"
    assert found.explanations[0].name in plant.names, found.diagnosis
    assert found.explanations[0].text[1:] in found.diagnosis
    if plant.factor is not None:
        assert found.explanations[0].factor == pytest.approx(plant.factor, rel=0.02)


BLIND = {
    "missing inertia": ({"plant": "no inertia"}, "wrong inertia"),
    "too deep at first": ({"plant": "initial depth", "value": 1.05}, "wrong initial depth"),
    "undeformed at first": ({"plant": "undeformed"}, "undeformed at the start"),
    "lever arm": ({"plant": "lever arm", "value": 2e-4}, "lever arm of friction_force"),
    "radius, depth kept": ({"plant": "radius at the right depth", "value": 1.05}, "wrong R"),
    "1 % of K": ({"key": "foundation.stiffness", "factor": 1.01}, "wrong K"),
    "1 % of tau": ({"key": "foundation.retardation_time", "factor": 0.99}, "wrong tau"),
}


@pytest.mark.parametrize("title", BLIND)
def test_faults_of_a_simulator_written_without_looking_are_named(title):
    """All of them: `python -m tests.blind_trial`."""
    options, name = BLIND[title]
    found = kv.compare(data=simulated("Table 1", **options))
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == name, found.diagnosis


@pytest.mark.parametrize("late", [1000.0, -0.5e-3])
def test_an_offset_of_any_size_is_named(late):
    data = series(kv.Scene(), {})
    found = kv.compare(data={**data, "time": data["time"] + late})
    assert found.explanations[0].name == "time offset"
    assert found.explanations[0].factor == pytest.approx(late, rel=1e-3)


def test_what_cannot_be_told_apart_is_said():
    given = kv.Scene.table1("fixed")
    data = series(given, {"foundation.retardation_time": 1.2})
    found = kv.compare(
        given, {name: data[name] for name in ("time", "normal_force", "friction_force")}
    )
    equal = {each.name: each.factor for each in found.explanations if each.enough}
    assert equal["wrong tau"] == pytest.approx(1.2, rel=0.01)
    assert equal["wrong V"] == pytest.approx(1.2, rel=0.01)
    assert found.explanations[0].alike == ("V",)
    assert "tau and V cannot be told apart by these data" in found.diagnosis


@pytest.mark.parametrize(
    ("factor", "per_length", "alike"),
    [(1.2, None, ("g",)), (1.2, "20000 /mm", ()), (3.0, None, ())],
)
def test_mass_and_gravity_are_told_apart_by_fine_data_or_by_a_large_fault(
    factor, per_length, alike
):
    """They differ in the first milliseconds alone, where inertia counts."""
    times = np.unique([*np.linspace(0.0, 0.01, 300), *np.linspace(0.0, 0.2, 300)])
    heavy = kv.Scene(support=kv.DeadWeight(mass=1e3 * factor))
    found = kv.compare(data=kv.transient(heavy, at=times, rtol=1e-9), per_length=per_length)
    assert found.explanations[0].name == "wrong M"
    assert found.explanations[0].alike == alike
    assert ("M and g cannot be told apart by these data" in found.diagnosis) == bool(alike)


def test_the_uncertainty_is_the_covariance_of_a_fit_of_both():
    slopes = np.random.default_rng(3).normal(size=(50, 2))
    expected = 50 * np.linalg.inv(slopes.T @ slopes)[0, 0]
    assert uncertainty(*slopes.T) ** 2 == pytest.approx(expected, rel=1e-12)
    assert uncertainty(slopes[:, 0], 2.0 * slopes[:, 0]) > 1e6


def test_a_loud_unknown_fault_is_not_explained_away():
    rng = np.random.default_rng(5)
    data = series(kv.Scene(), {})
    walk = np.cumsum(rng.standard_normal(data["time"].size))
    found = kv.compare(
        data={**data, "depth": data["depth"] * (1.0 + 0.2 * walk / np.abs(walk).max())}
    )
    assert found.verdict == "disagrees"
    assert not any(each.enough for each in found.explanations)


def test_data_that_diverge_are_diagnosed_without_a_warning():
    time = np.linspace(0.0, 0.2, 400)
    growth = np.exp(np.minimum(5e3 * time, 600.0)) * (-1.0) ** np.arange(400)
    found = kv.compare(
        data={"time": time, "depth": 3e-4 * (1.0 + 1e-9 * growth), "normal_force": 9806.65 + growth}
    )
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == "unstable time step"
    assert "F15" in found.diagnosis


def test_an_indenter_thrown_off_early_is_called_unstable():
    """Even if it has fallen back far enough by the end, as a large error of one column would not."""
    slow = kv.Scene(drive=kv.Drive(0.008), run=kv.Run(0.4))
    data = series(slow, {})
    flight = np.maximum(data["time"] - 0.02, 0.0)
    thrown = flight * (1.0 - 0.5 * 9.80665 * flight)
    found = kv.compare(
        slow,
        {**data, "depth": data["depth"] - thrown,
         "normal_force": np.where(flight > 0.0, 0.0, data["normal_force"])},
    )  # fmt: skip
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == "unstable time step"
    wrong_unit = kv.compare(slow, {**data, "depth": 100.0 * data["depth"]})
    assert wrong_unit.explanations[0].name == "unit of depth"


def test_of_offsets_that_fit_as_well_the_smallest_is_named():
    """The force on a fixed indenter never changes after the start."""
    still = kv.Scene.table1("fixed")
    data = series(still, {})
    found = kv.compare(still, {**data, "time": data["time"] - 2e-3})
    assert found.explanations[0].name == "time offset"
    assert found.explanations[0].factor == pytest.approx(-2e-3, rel=0.06)
