"""What agreement excludes: errors of twice the size that is told show, and errors of half of it do not."""

from functools import cache

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.api._compare import METHODS
from kvtheory.checks import comparing
from kvtheory.checks.checklist import judge, steady_limit
from kvtheory.checks.comparison_case import COARSEST, make_case, symptoms
from kvtheory.checks.contact_rules import mistakes
from kvtheory.checks.detectable import QUANTITIES
from kvtheory.checks.faults import parameters_of
from kvtheory.checks.hypotheses import scaled_scene
from kvtheory.checks.theory import Theory
from kvtheory.fitting.series import read
from tests import confusion, engine

SCENE, DENSITY = kv.Scene(run=kv.Run(0.15)), "200 /mm"
FORCES = "normal_force", "friction_force"
PARAMETERS = {each.symbol: each.powers for each in parameters_of(SCENE)}


@cache
def theory(scene=SCENE):
    found = kv.transient(scene, at="0 ms:150 ms:301", rtol=1e-9, certify=False)
    return {name: getattr(found, name) for name in confusion.FEW}


@cache
def simulated():
    found = confusion.run(SCENE)
    return {name: found[name][::5] for name in confusion.FEW}


def cased(data, scene=SCENE, per_length=200e3):
    return make_case(Theory(scene, METHODS), read(data), per_length, 1.0, COARSEST)


def with_error(name, size):
    """Return the simulation with an error, its elements being the same ones."""
    data = dict(simulated())
    way = next(way for way in QUANTITIES[name][1] if way in (*data, *PARAMETERS))
    if way in data:
        return {**data, way: (1.0 + size) * data[way]}
    wrong = theory(scaled_scene(SCENE, PARAMETERS[way], 1.0 + size))
    return {n: x + (wrong[n] - theory()[n] if n != "time" else 0.0) for n, x in data.items()}


def test_an_error_of_twice_what_is_told_shows_and_one_of_half_of_it_does_not():
    assert np.allclose(simulated()["time"], theory()["time"])
    told = kv.compare(SCENE, simulated(), per_length=DENSITY)
    assert "These data would have shown an error of " in told.diagnosis
    assert set(told.detectable) == set(QUANTITIES)
    for sign, (name, size) in zip(4 * (1.0, -1.0), told.detectable.items(), strict=True):
        assert 1e-5 < size < 0.02
        for part, verdict in ((0.5, "agrees"), (2.0, "disagrees")):
            found = comparing.verdict(judge(cased(with_error(name, sign * part * size))))
            assert found == verdict, (name, sign * part * size)


def test_what_never_shows_is_told():
    at = np.linspace(0.0, 0.2, 50)
    still = kv.Scene(drive=kv.Drive(0.0))
    rest = {"time": at, "depth": 0.0 * at + float(kv.steady(still).depth)}
    found = kv.compare(still, {**rest, "normal_force": 0.0 * at + still.support.weight})
    record = found.as_dict()["detectable"]
    assert {name for name, size in record.items() if size is None} == {
        "friction_force", "retardation_time", "velocity",
    }  # fmt: skip
    assert "would not show one of 100% in tau, V." in found.diagnosis
    wrong = kv.compare(still, {**rest, "normal_force": 0.0 * at + 1.1 * still.support.weight})
    assert (wrong.verdict, wrong.detectable) == ("disagrees", {})


@pytest.mark.parametrize("name", ["friction_force", "velocity"])
def test_a_measured_curve_tells_it_by_its_scatter(name):
    V, scene = np.geomspace(1e-3, 1.0, 25), kv.Scene()
    mu = np.asarray(kv.steady(scene.at(V)).friction_coefficient)
    mu = mu * (1.0 + 0.02 * np.random.default_rng(1).standard_normal(25))
    size = kv.compare(scene, {"velocity": V, "friction_coefficient": mu}).detectable[name]
    for part, verdict in ((0.5, "agrees"), (2.0, "disagrees")):
        by = {"velocity": 1.0, "friction_force": 1.0} | {name: 1.0 + part * size}
        data = {"velocity": V / by["velocity"], "friction_coefficient": mu * by["friction_force"]}
        assert kv.compare(scene, data).verdict == verdict


@cache
def by_engine(**fault):
    static = kv.steady(kv.Scene(drive=kv.Drive(0.0)))
    how = {"K": 1e10, "C": 1e9, "M": 1e3, "W": 9806.65, "depth": float(static.depth), "per_a": 300}
    return engine.run(V=[(0.0, 0.1), (0.12, 0.1)], steps=800, at=400, **how, **fault)


@pytest.mark.parametrize("sine", [False, True])
def test_the_mean_of_settled_friction_shows_the_sine_of_a_slope_in_the_place_of_its_tangent(sine):
    """Half a percent, as large as half an element at the edge; but that acts on both forces, and cancels."""
    data = {name: by_engine(sine=sine)[name] for name in confusion.FEW}
    case = cased(data, kv.Scene(run=kv.Run(0.12)), 300 / 2.45e-3)
    *_, friction = steady_limit(case)
    off = friction.off(case.columns) / float(case.theory.steady_state.friction_force)
    assert off == pytest.approx(-0.0053 * sine, abs=5e-4)
    failed = [check.name for check in judge(case) if check.ok is False]
    assert failed == ["steady limit"] * sine


def test_forces_that_are_zero_wherever_they_should_not_be_are_judged():
    """The rows left are those in which theory has no contact either, where no ratio of forces exists."""
    pressed = kv.Fixed(history=[(0.0, 0.0), (0.1, 3e-4), (0.2, 0.0)])
    scene = kv.Scene(support=pressed, drive=kv.Drive(0.0), run=kv.Run(0.2))
    time = np.linspace(0.0, 0.2, 41)
    assert kv.compare(scene, {"time": time, "normal_force": 0.0 * time}).verdict == "disagrees"


@pytest.mark.parametrize("name", FORCES)
def test_a_force_that_is_off_by_a_fiftieth_is_named(name):
    case = cased({**simulated(), name: 0.98 * simulated()[name]})
    found, _ = comparing.explanations(case, comparing.FAMILIES[:2])
    best = max(found, key=lambda each: each.rank)
    assert (best.name, best.enough) == (f"scale of {name}", True)
    assert best.factor == pytest.approx(0.98, abs=2e-3)


def test_a_contact_that_is_lost_for_single_steps_is_named():
    lost = np.where(np.arange(301) % 23 == 22, 0.02, 1.0)
    data = {name: x * (lost if name in FORCES else 1.0) for name, x in simulated().items()}
    (found,) = symptoms(cased(data), ())
    assert (found.name, found.enough) == ("contact lost for single steps", True)
    assert "13 times from 11 ms on" in found.text
    assert not list(symptoms(cased(simulated()), ()))


def test_a_factor_on_the_depth_rate_alone_is_named_and_measured():
    data = {name: by_engine(sinks=0.9)[name] for name in confusion.FEW}
    case = cased(data, kv.Scene(run=kv.Run(0.12)), 300 / 2.45e-3)
    found, _ = comparing.explanations(case, [("contact rules", mistakes)])
    first = max(found, key=lambda each: each.rank)
    assert (first.name, first.enough) == ("wrong depth term in the compression rate", True)
    assert first.factor == pytest.approx(0.9, abs=0.02)
