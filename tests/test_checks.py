"""The parts of a comparison: each check, noise, balances and time constants."""

import math
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

import kvtheory as kv
from kvtheory.api._compare import METHODS
from kvtheory.checks import hypotheses
from kvtheory.checks.checklist import judge, windows
from kvtheory.checks.comparison_case import COARSEST, make_case
from kvtheory.checks.noise import noise, rounded, time_rounding
from kvtheory.checks.theory import Rates, Theory
from kvtheory.checks.trial_elements import Rule, simulate
from kvtheory.fitting.series import read
from tests.test_compare import BALL

DENSE = np.unique([*np.linspace(0.0, 0.01, 300), *np.linspace(0.0, 0.2, 300)])


def exact(*parts, **given):
    found = kv.transient(kv.Scene(*parts, **given), at=DENSE, certify=False)
    return {n: getattr(found, n) for n in ("time", "depth", "normal_force", "friction_force")}


def with_noise(size):
    noisy = 1.0 + size * np.random.default_rng(1).normal(size=DENSE.size)
    return {**exact(), "normal_force": exact()["normal_force"] * noisy}


SLOWER, FASTER = {"foundation": kv.Foundation(1e10, 0.13)}, {"drive": kv.Drive(0.12)}
UNSOUND = {
    "sampling": lambda: {
        name: x[np.searchsorted(DENSE, np.linspace(0.0, 0.2, 9))] for name, x in exact().items()
    },
    "initial rest state": lambda: exact(kv.Parabola(0.012)),
    "jump at t = 0+": lambda: exact(**SLOWER),
    "impulse balance": lambda: {**exact(), "depth": exact()["depth"] ** 2 / 3e-4},
    "depth, largest": lambda: exact(**FASTER),
    "depth, RMS": lambda: exact(**FASTER),
    "steady limit": lambda: exact(**FASTER),
    "discretization noise": lambda: with_noise(0.2),
}


@pytest.mark.parametrize("name", UNSOUND)
def test_each_check_fails_for_some_data_and_passes_for_sound_ones(name):
    theory = Theory(kv.Scene(), METHODS)
    for data, ok in ((exact(), True), (UNSOUND[name](), False)):
        case = make_case(theory, read(data), None, 1.0, COARSEST)
        assert {check.name: check.ok for check in judge(case)}[name] is ok


def test_the_balance_finds_a_force_that_is_lacking():
    support, data = kv.Scene().support, exact()
    time, depth = data["time"], data["depth"][0]
    columns = {"depth": data["depth"], "normal_force": data["normal_force"] + 200.0}
    *_, last = windows(time)
    for window in (next(windows(time)), last):
        lacking = window.missing_force(columns, support, depth)
        assert lacking == pytest.approx(200.0, abs=40.0)
    for held in (support, kv.Suspended(mass=1000.0, stiffness=1e8)):
        rises = 3e-4 - 1e-3 * time
        force = held.weight - held.spring * (rises - 3e-4)
        uniform = {"depth": rises, "normal_force": np.broadcast_to(force, time.shape)}
        assert last.missing_force(uniform, held, 3e-4) == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("scale", [1e-300, 1e-200, 1.0, 1e200])
def test_noise_is_measured_at_any_scale(scale):
    t, r = np.linspace(0.0, 1.0, 400), np.random.default_rng(0).normal(size=400)
    assert noise(t, scale * r, np.full(400, scale)) / scale == pytest.approx(1.0, rel=0.2)


def test_rounding_is_read_from_digits_and_from_repeated_times():
    digits = rounded(np.array([1.23e-4, 4.56e-4, 1.24e-3]))
    assert digits == pytest.approx([5e-7, 5e-7, 5e-6])
    assert time_rounding(np.array([0.0, 0.1, 0.1, 0.1, 0.2])).tolist() == [0.1] * 5


def test_the_uncertainty_is_the_covariance_of_a_fit_of_both():
    slopes = np.random.default_rng(3).normal(size=(50, 2))
    expected = 50 * np.linalg.inv(slopes.T @ slopes)[0, 0]
    assert hypotheses.deviation(*slopes.T) ** 2 == pytest.approx(expected, rel=1e-12)
    assert hypotheses.deviation(slopes[:, 0], 2.0 * slopes[:, 0]) > 1e6


def test_time_constants_of_any_number_of_motions():
    rates = Rates.of([2.0, 0.1, 4.0 + 3.0j, 4.0 - 3.0j])
    assert (rates.fast, abs(rates.slow)) == (0.1, 5.0)
    assert rates.settling == pytest.approx(25.0 / 4.0)
    assert math.isinf(Rates.of([1.0, -2.0]).settling)


def test_a_ball_on_a_spring_has_the_rates_of_its_own_stability():
    scene = replace(BALL, drive=kv.Drive(0.1, stiffness="1 kN/m"))
    rates = kv.stability(scene).rates
    found = Theory(scene, METHODS).rates
    assert abs(found.slow) == pytest.approx(1.0 / np.hypot(*rates.T).min())
    assert np.isinf(found.settling) == (rates[:, 0].max() > 0.0)


@pytest.mark.parametrize("l", [1e-3, 1.0, 1e6])
def test_the_time_constants_of_fast_sliding_do_not_cancel(l):
    """A and B of F12 with 50 digits; x_TE = sqrt(a^2 + l_r^2) - l_r cancels as written in Eq. 27."""
    scene = kv.Scene(drive=kv.Drive(l * kv.steady(kv.Scene()).half_length / 0.1))
    theory = Theory(scene, METHODS)
    with mp.workdps(50):
        state = theory.steady_state
        a, l_r = mp.mpf(state.half_length), mp.mpf(state.retardation_length)
        root = mp.sqrt(a**2 + l_r**2)
        M, K, C = 1000, mp.mpf(10) ** 10, mp.mpf(10) ** 9
        A, B = K * (root + a), C * (root - l_r + a)
        slow = (B + mp.sqrt(B**2 - 4 * M * A)) / (2 * A)
    assert theory.rates.slow == pytest.approx(complex(slow), rel=1e-12)


@pytest.mark.parametrize(
    "foundation", [kv.Foundation(1e10, 0.1), kv.GeneralizedMaxwell(1e10, [(3e10, 0.01)])]
)
@pytest.mark.parametrize("ball", [False, True])
def test_the_simulation_of_mistakes_is_right_without_one(foundation, ball):
    """With a reversal, so that columns come back into sight: each kind of memory is used."""
    indenter, mass = (kv.Sphere(0.01), 1.0) if ball else (kv.Parabola(0.01), 1e3)
    drive = kv.Drive(history=[(0.0, 0.1), (0.04, 0.1), (0.04, -0.1)])
    scene = kv.Scene(indenter, foundation, kv.DeadWeight(mass), drive, kv.Run(0.06))
    theory = Theory(scene, METHODS)
    times, found = simulate(scene, (Rule(),), 0.06)
    at, rows = np.unique(times, return_index=True)
    exact = theory.at(at, 1e-6)
    for name in ("depth", "normal_force", "friction_force"):
        off = np.abs(found[name][rows, 0] - exact[name]) / theory.scales[name]
        assert np.quantile(off, 0.9) < 0.02, name
