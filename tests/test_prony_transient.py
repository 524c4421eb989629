"""`solve` and `compare` on a Prony series: which model answers, how wrong it is, and what is diagnosed."""

from dataclasses import replace

import numpy as np
import pytest

import kvtheory as kv
from tests.spring_random import of_unit_scales

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


@pytest.mark.parametrize(("tau", "velocity"), [(4.6e-9, 0.0), (6.8e-10, -0.1)])
def test_a_stop_and_a_reversal_on_fast_arms_are_those_of_a_damper(tau, velocity):
    """The layers of the arms are shorter than the tolerance resolves; the peak of the pressure is in one."""
    points, at = [(0.0, 0.1), (0.02, 0.1), (0.02, velocity), (0.03, velocity)], [0.01, 0.021, 0.03]
    arms = kv.GeneralizedMaxwell(1e10, arms=[(1e9 / tau, tau)])
    scene = kv.Scene(foundation=arms, drive=kv.Drive(history=points), run=kv.Run(0.03))
    found = kv.solve(scene, at=at, rtol=1e-3, quantity=[*ASKED, "peak_pressure"])
    assert found.model == "continuum"
    truth = kv.transient(replace(scene, foundation=kv.Foundation(1e10, 0.1)), at=at, rtol=1e-8)
    for name in (*ASKED, "peak_pressure"):
        scale = np.abs(getattr(truth, name)).max()
        off = np.abs(getattr(found, name) - getattr(truth, name)).max() / scale
        assert off < 1e-4, name


def test_our_own_simulation_agrees_with_exact_at_its_end():
    scene = kv.Scene(foundation=RUBBER, run=kv.Run("0.4 s"))
    found = kv.compare(scene, per_length="100 /mm")
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


def test_the_rate_of_a_light_mass_in_a_short_run_is_within_its_claim():
    """It vibrates 200 times, which steps pass over; the tight solution takes many steps in each tenth."""
    rubber = kv.GeneralizedMaxwell(0.75, arms=[(1.5, 100.0), (0.75, 2.0)])
    scene = replace(of_unit_scales(1e-8, 0.0, kv.Drive(0.4), 0.05), foundation=rubber)
    at, scale = np.linspace(0.05, 1.0, 12) * 0.05, rubber.retardation_time
    found = kv.transient(scene, at=at, rtol=1e-4)
    truth = kv.transient(scene, at=at, rtol=1e-8, certify=False)
    off = scale * np.abs(found.depth_rate - truth.depth_rate).max()
    claimed = found.certificate.relative_error["depth_rate"]
    assert truth.steps > 5 * found.steps
    assert off <= claimed <= 5.0 * off


def test_the_claim_of_an_edge_beside_a_stiff_damper_covers_the_tension_that_no_event_sees():
    """After a stop only the damper presses there, as the indenter slowly rises. From elements 5e-8 apart."""
    history = [(0.0, 2.0), (5e-6, 2.0), (5e-6, -2.0), (1e-5, -2.0), (1e-5, 0.0), (2e-5, 0.0)]
    rubber = kv.GeneralizedMaxwell(0.75, arms=[(0.15, 0.5)], damping=0.75)
    scene = of_unit_scales(0.1, 0.0, kv.Drive(history=history), 2e-5)
    found = kv.transient(replace(scene, foundation=rubber), at=[1.1e-5, 1.5e-5, 2e-5], rtol=1e-3)
    off = np.abs(found.leading_edge - 1.0 + [2.6462e-5, 2.3733e-5, 2.109e-5]).max()
    assert off <= found.certificate.relative_error["leading_edge"] < 1e-4
