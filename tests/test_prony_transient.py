"""`solve` and `compare` on a Prony series: which model answers, how wrong it is, and what is diagnosed."""

from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.ladder import equivalent
from kvtheory.ladder.climbing import Request
from kvtheory.ladder.series import SOLVED, Models, rungs
from kvtheory.results import TRANSIENT_UNITS
from kvtheory.results.table import scales
from kvtheory.scene.static_state import StaticState
from tests.test_elements_prony import SUPPORTS, WAYS, scaled

RUBBER = kv.GeneralizedMaxwell(1e10, arms=[(3e10, 0.01), (1e10, 0.1)])
ASKED = ["depth", "normal_force", "friction_force"]


def fast(tau, velocity=0.1):
    """Return Table 1 with two arms for its damper."""
    arms = [(0.7e9 / tau, tau), (0.1e9 / tau, 3.0 * tau)]
    return kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=arms), drive=kv.Drive(velocity))


def test_slow_arms_are_solved_without_elements_also_where_the_indenter_hops():
    found = kv.solve(fast(1e-3), at=[0.01, 0.1], rtol=1e-3, quantity=ASKED)
    assert found.model == "continuum"
    arms, run = [(3e11, 0.01)], kv.Run(duration=0.007)
    hop = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=arms), drive=kv.Drive(0.3), run=run)
    found = kv.solve(hop, at=[0.004, 0.007], rtol=1e-3, quantity=ASKED)
    assert found.model == "continuum"
    assert found.normal_force[1] == 0.0


def test_a_tolerance_is_met_through_a_stop_without_elements():
    history = [(0.0, 0.1), (0.05, 0.1), (0.05, 0.0), (0.07, 0.0), (0.07, 0.1)]
    foundation = kv.GeneralizedMaxwell(1e10, arms=[(5e10, 0.1)])
    scene = kv.Scene(foundation=foundation, drive=kv.Drive(history=history), run=kv.Run(0.08))
    found = kv.solve(scene, at=[0.08], rtol=1e-6, quantity=["depth", "friction_force"])
    assert found.model == "continuum"
    assert found.certificate.relative_error["friction_force"] < 1e-6


def test_a_damper_replaces_fast_arms_where_the_motion_stops_and_the_certificate_says_so():
    arms = fast(1e-9).foundation
    points = [(0.0, 0.1), (0.11, 0.1), (0.11, 0.0), (0.12, 0.0)]
    scene = kv.Scene(foundation=arms, drive=kv.Drive(history=points), run=kv.Run(duration=0.12))
    rung = rungs(Models(kv.steady, kv.transient, kv.elements, kv.fewer_arms))[-2]
    found = rung.judge(scene, Request(tuple(ASKED), 1e-3, [0.01, 0.1], TRANSIENT_UNITS)).run()
    assert "Kelvin-Voigt foundation with the damping sum K_i tau_i" in found.certificate.statement
    truth = kv.transient(kv.Scene(), at=[0.01, 0.1], rtol=1e-9)
    assert found.values["depth"] == pytest.approx(truth.depth, rel=1e-4)
    assert 0.0 < found.certificate.relative_error["depth"] < 1e-3


def test_the_first_instant_is_no_matter_of_kelvin_voigt():
    """There the force of a damper jumps, that of an arm does not."""
    times = [0.0, 0.1]
    with pytest.raises(ValueError, match="as fast as arms relax"):
        equivalent.fastest_rate(kv.steady, fast(1e-9), times)
    assert equivalent.fastest_rate(kv.steady, fast(1e-9), times[1:]) < 1e7


def test_the_estimate_covers_what_a_damper_in_the_place_of_arms_neglects():
    """Against elements, on random scenes with arms that are fast, but not very."""
    rung = rungs(Models(kv.steady, kv.transient, kv.elements, kv.fewer_arms))[-2]
    ratios = []
    for seed in range(14):
        rng = np.random.default_rng(seed)
        end, top = 10.0 ** rng.uniform([-0.3, -1.0], [0.4, 0.9])
        tau = 10.0 ** rng.uniform(-3.5, -1.5, rng.integers(1, 4))
        C = 10.0 ** rng.uniform(-1.0, 0.5, tau.size)
        arms = [(float(c / t), float(t)) for c, t in zip(C, tau, strict=True)]
        way = list(WAYS.values())[rng.integers(len(WAYS))]
        history = [(float(t * end), float(V * top / 3.0)) for t, V in way]
        scene = scaled(history, SUPPORTS[seed % 3], arms, float(end))
        times = np.sort(rng.uniform(0.0, end, 4)).tolist()
        request = Request(SOLVED, 1.0, times, TRANSIENT_UNITS)
        try:
            answer = rung.judge(scene, request).run()
        except ValueError:
            continue
        truth = kv.elements(scene, per_length=150.0, at=request.times)
        measures = scales(StaticState.of(scene))
        for name in SOLVED:
            off = np.abs(answer.values[name] - getattr(truth, name))
            error = float(np.nanmax(off, initial=0.0)) / measures[name]
            claimed = answer.certificate.relative_error[name]
            known = truth.certificate.relative_error[name]
            assert error <= claimed + known, (seed, name)
            if known < 0.3 * claimed:
                ratios.append(error / claimed)
    assert len(ratios) > 10
    assert max(ratios) < 0.7


def test_our_own_simulation_agrees_with_exact_at_its_end():
    found = kv.compare(kv.Scene(foundation=RUBBER), per_length="100 /mm")
    assert found.verdict == "agrees"
    end = next(check for check in found.checks if check.name == "steady limit")
    assert end.ok
    assert end.equation == "F17"


def test_a_simulation_with_kelvin_voigt_of_a_scene_that_is_not_is_named():
    scene = replace(kv.Scene.table1("suspended"), foundation=RUBBER, run=kv.Run(0.1))
    plain = replace(scene, foundation=kv.Foundation(1e10, RUBBER.retardation_time))
    data = kv.elements(plain, per_length="100 /mm", certify=False)
    found = kv.compare(scene, data)
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == "Kelvin-Voigt instead of arms"
    assert found.explanations[0].enough
    assert "arms have no stiffness" in found.diagnosis


def test_a_wrong_sign_is_named_on_arms_too():
    scene = kv.Scene(foundation=RUBBER, run=kv.Run(0.05))
    data = kv.elements(scene, per_length="100 /mm", certify=False)
    wrong = {"time": data.time, "depth": data.depth, "friction_force": -data.friction_force}
    assert kv.compare(scene, wrong).explanations[0].name == "sign of friction_force"
