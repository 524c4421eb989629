"""Series of balls and on rubber held against theory, and the faults that are found by a fit."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.api._compare import METHODS
from kvtheory.checks.checklist import judge
from kvtheory.checks.columns import recognise
from kvtheory.checks.comparison_case import COARSEST, make_case
from kvtheory.checks.fitting import scaled_scene
from kvtheory.checks.reading import read
from kvtheory.checks.theory import Rates, Theory

BALL = kv.Scene(
    indenter=kv.Sphere(0.01),
    support=kv.DeadWeight(mass=1.0),
    drive=kv.Drive(0.1),
    run=kv.Run(0.016),
)
DEPTH = 1.7667919077651083e-4
"""The static depth of the ball in m."""
BALLS = {
    "dead-weight": BALL,
    "fixed": replace(BALL, support=kv.Fixed(DEPTH)),
    "suspended": replace(BALL, support=kv.Suspended(mass=1.0, stiffness=3e4)),
}
RUBBER = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, [(3e10, 0.01)]), run=kv.Run(0.008))
MEASURED = "time", "depth", "normal_force", "friction_force"


@cache
def simulated(scene, per_length="60 /mm"):
    at = np.linspace(0.0, scene.run.duration, 81)
    found = kv.elements(scene, per_length=per_length, at=at.tolist(), certify=False)
    return {name: getattr(found, name) for name in MEASURED}


def failed(found):
    return [check.name for check in found.checks if check.ok is False]


@pytest.mark.parametrize("per_length", ["20 /mm", "40 /mm", "60 /mm"])
@pytest.mark.parametrize("name", BALLS)
def test_a_correct_ball_agrees_however_coarse_its_elements(name, per_length):
    """An upper bound of the force of an element is told in the note, and decides nothing."""
    found = kv.compare(BALLS[name], per_length=per_length)
    assert (found.verdict, failed(found)) == ("agrees", [])
    enough = next(check for check in found.checks if check.name == "elements enough")
    assert enough.ok is None
    assert "of the load" in enough.note


def test_coarse_elements_do_not_hide_a_fault_of_a_ball():
    data = simulated(scaled_scene(BALL, {"foundation.stiffness": 1.0}, 1.1), "20 /mm")
    assert kv.compare(BALL, data, per_length="20 /mm").verdict == "disagrees"


def test_too_few_elements_of_a_line_are_still_an_error():
    data = kv.elements(per_length="10 /mm", scheme="paper", certify=False, at="0 ms:200 ms:201")
    assert "elements enough" in failed(kv.compare(data=data, per_length="10 /mm"))


@pytest.mark.parametrize(
    ("scene", "key", "symbol", "factor"),
    [(BALL, "support.mass", "M", 1.2), (RUBBER, "foundation.stiffness", "K", 1.1)],
    ids=["ball", "rubber"],
)  # fmt: skip
def test_a_parameter_is_named_where_theory_is_a_simulation(scene, key, symbol, factor):
    found = kv.compare(scene, simulated(scaled_scene(scene, {key: 1.0}, factor)))
    assert found.verdict == "disagrees"
    assert found.explanations[0].name == f"wrong {symbol}", found.diagnosis
    assert found.explanations[0].factor == pytest.approx(factor, rel=1e-2)
    unit = {"M": "kg rather than 1 kg,", "K": "GN/m^3 rather than 10 GN/m^3,"}[symbol]
    assert unit in found.diagnosis


@pytest.mark.parametrize("scene", [BALL, RUBBER, kv.Scene()], ids=["ball", "rubber", "line"])
def test_a_scale_and_an_offset_of_a_column_are_named_and_measured(scene):
    data = simulated(scene, "200 /mm")
    half = kv.compare(scene, {**data, "friction_force": 0.5 * data["friction_force"]})
    assert half.explanations[0].name == "scale of friction_force", half.diagnosis
    assert half.explanations[0].factor == pytest.approx(0.5, rel=1e-2)
    drift = 0.2 * data["normal_force"][0]
    off = kv.compare(scene, {**data, "normal_force": data["normal_force"] + drift})
    assert off.explanations[0].name == "offset of normal_force", off.diagnosis
    assert off.explanations[0].factor == pytest.approx(drift, rel=3e-2)


@pytest.mark.parametrize("arm", [2e-4, -2e-4])
def test_the_lever_arm_is_measured_with_its_sign(arm):
    """F_x of the data is the moment about a point that is off by `arm`."""
    data = simulated(kv.Scene(), "200 /mm")
    F_x = data["friction_force"] + arm / 0.01 * data["normal_force"]
    found = kv.compare(data={**data, "friction_force": F_x}).explanations
    first = next(each for each in found if each.name == "lever arm of friction_force")
    assert first.enough
    assert first.factor == pytest.approx(arm, rel=2e-2)


def test_a_wrong_sign_of_friction_may_be_that_of_the_drive():
    """Where no edges are given, both say the same."""
    data = simulated(kv.Scene(), "200 /mm")
    found = kv.compare(data={**data, "friction_force": -data["friction_force"]})
    names = [each.name for each in found.explanations if each.enough]
    assert names == ["sign of friction_force", "direction of the drive"]
    assert "Also possible: the base moves in the other direction" in found.diagnosis


def test_what_was_not_tried_is_said():
    """Noise that grows is no fault of the list."""
    data = simulated(RUBBER)
    waves = 1.0 + 0.3 * np.sin(np.linspace(0.0, 40.0, 81)) * np.linspace(0.0, 1.0, 81) ** 2
    found = kv.compare(RUBBER, {**data, "depth": data["depth"] * waves})
    assert found.verdict == "disagrees"
    assert "contact rules, are not tried" in found.diagnosis


def test_agreement_says_where_the_memory_was_not_tested():
    to_and_fro = kv.Scene(drive=kv.Drive(history=[(0.0, 0.1), (0.05, 0.1), (0.05, -0.1)]))
    for scene, untested in ((kv.Scene(), True), (to_and_fro, False)):
        found = kv.compare(scene, kv.transient(scene, at="0 ms:200 ms:201"))
        assert found.verdict == "agrees"
        assert ("memory of the free surface was not tested" in found.diagnosis) == untested


def test_a_ball_on_a_spring_has_the_rates_of_its_own_stability():
    scene = replace(BALL, drive=kv.Drive(0.1, stiffness="1 kN/m"))
    rates = kv.stability(scene).rates
    found = Theory(scene, METHODS).rates
    assert abs(found.slow) == pytest.approx(1.0 / np.hypot(*rates.T).min())
    assert np.isinf(found.settling) == (rates[:, 0].max() > 0.0)
    assert isinstance(found, Rates)


@pytest.mark.parametrize("l", [1e-3, 1.0, 1e6])
def test_the_time_constants_of_fast_sliding_do_not_cancel(l):
    """A and B of F12 with 50 digits; x_TE = sqrt(a^2 + l_r^2) - l_r cancels as written in Eq. 27."""
    import mpmath as mp

    state = kv.steady(kv.Scene())
    scene = kv.Scene(drive=kv.Drive(l * state.half_length / 0.1))
    theory = Theory(scene, METHODS)
    with mp.workdps(50):
        a, l_r = (
            mp.mpf(getattr(theory.steady_state, n)) for n in ("half_length", "retardation_length")
        )
        root = mp.sqrt(a**2 + l_r**2)
        M, K, C = 1000, mp.mpf(10) ** 10, mp.mpf(10) ** 9
        A, B = K * (root + a), C * (root - l_r + a)
        slow = (B + mp.sqrt(B**2 - 4 * M * A)) / (2 * A)
    assert theory.rates.slow == pytest.approx(complex(slow), rel=1e-12)


def test_a_unit_that_is_that_of_the_table_is_read_exactly():
    assert recognise("F_z [N/m]").factor == 1.0
    assert recognise("z_A [m]").factor == -1.0


DENSE = np.unique([*np.linspace(0.0, 0.01, 300), *np.linspace(0.0, 0.2, 300)])


def exact(scene):
    found = kv.transient(scene, at=DENSE, certify=False)
    return {name: getattr(found, name) for name in MEASURED}


def with_noise(size):
    data = exact(kv.Scene())
    noise = size * np.random.default_rng(1).normal(size=DENSE.size)
    return {**data, "normal_force": data["normal_force"] * (1.0 + noise)}


UNSOUND = {
    "sampling": lambda: {
        k: v[np.searchsorted(DENSE, np.linspace(0.0, 0.2, 9))] for k, v in exact(kv.Scene()).items()
    },
    "initial rest state": lambda: exact(kv.Scene(kv.Parabola(0.012))),
    "jump at t = 0+": lambda: exact(kv.Scene(foundation=kv.Foundation(1e10, 0.13))),
    "impulse balance": lambda: {
        **exact(kv.Scene()),
        "depth": exact(kv.Scene())["depth"] ** 2 / 3e-4,
    },
    "depth, largest": lambda: exact(kv.Scene(drive=kv.Drive(0.12))),
    "depth, RMS": lambda: exact(kv.Scene(drive=kv.Drive(0.12))),
    "fast time constant": lambda: exact(kv.Scene(support=kv.DeadWeight(1500.0, load=9806.65))),
    "slow time constant": lambda: exact(kv.Scene(foundation=kv.Foundation(1e10, 0.13))),
    "steady limit": lambda: exact(kv.Scene(drive=kv.Drive(0.12))),
    "discretization noise": lambda: with_noise(0.2),
}


@pytest.mark.parametrize("name", UNSOUND)
def test_each_check_fails_for_some_data_and_passes_for_sound_ones(name):
    theory = Theory(kv.Scene(), METHODS)
    for data, ok in ((exact(kv.Scene()), True), (UNSOUND[name](), False)):
        case = make_case(theory, read(data), None, 1.0, COARSEST)
        assert {check.name: check.ok for check in judge(case)}[name] is ok
