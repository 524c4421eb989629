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
from kvtheory.checks.comparison_case import COARSEST, COMMON, alike, common_noise, make_case
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


@pytest.mark.parametrize(
    ("rows", "share", "expected"), [(20, 0.65, False), (60, 0.65, True), (20, 0.02, True)]
)
def test_noise_of_few_rows_is_of_elements_only_if_it_is_nearly_the_same_in_both_forces(
    rows, share, expected
):
    """`share` of the noise of friction is its own: a squared correlation of 0.7 comes about by chance."""
    rng = np.random.default_rng(4)
    every = np.linspace(0, DENSE.size - 1, rows).round().astype(int)
    data = {name: values[every] for name, values in exact().items()}
    common, own = rng.standard_normal((2, rows))
    data["normal_force"] = data["normal_force"] * (1.0 + 0.01 * common)
    data["friction_force"] = data["friction_force"] + 10.0 * (common + share * own)
    case = make_case(Theory(kv.Scene(), METHODS), read(data), None, 1.0, COARSEST)
    assert common_noise(case) > COMMON
    assert alike(case) is expected


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


def check(found, name):
    """Return the check of a comparison with this name."""
    return next(each for each in found.checks if each.name == name)


def uneven(times, **given):
    """Return theory at uneven times."""
    scene = kv.Scene(run=kv.Run(times[-1]), **given)
    found = kv.transient(scene, at=times, certify=False)
    return scene, {n: getattr(found, n) for n in ("time", "depth", "normal_force")}


def test_sampling_is_judged_within_the_transient_of_a_long_uneven_run():
    scene, data = uneven(np.array([*np.linspace(0.0, 0.2, 60), *np.linspace(0.25, 20.0, 40)]))
    found = kv.compare(scene, data)
    slow = abs(Theory(scene, METHODS).rates.slow)
    inside = np.count_nonzero((data["time"] > 0.0) & (data["time"] <= 3.0 * slow))
    assert inside == 10
    assert check(found, "sampling").measured == pytest.approx(3.0 * slow / inside)
    assert check(found, "sampling").allowed == pytest.approx(slow)
    assert found.verdict == "agrees"


def test_a_jump_is_not_judged_where_no_sample_follows_it_at_once():
    scene, data = uneven(np.array([0.03, 0.04, *np.linspace(0.06, 0.27, 8)]))
    found = check(kv.compare(scene, data), "jump at t = 0+")
    assert (found.ok, found.measured, found.allowed) == (None, None, None)
    assert "no sample in the fast time constant, 0.744 ms" in found.note


def test_the_papers_step_is_known_where_the_elements_are():
    """Its step follows from the spacing: without it a check more cannot be made."""
    scene, data = uneven(np.linspace(0.0, 0.2, 101))
    for given, known in (({}, False), ({"per_length": "200 /mm"}, True)):
        found = kv.compare(scene, data, scheme="paper", **given)
        number = check(found, "stability number")
        made = sum(each.ok is not None for each in found.checks)
        assert f"All {made} checks that could be made passed" in found.diagnosis
        assert made == 9 + 2 * known
        if known:
            extent = np.abs(found.theory["trailing_edge"] - found.theory["leading_edge"]).max()
            assert number.measured == pytest.approx(1e-4 * 1e9 * extent / 1e3, rel=1e-3)
            assert number.allowed == pytest.approx(2.785, rel=1e-3)
        else:
            assert number.note == "not made: the time step is not known"


def test_what_is_allowed_covers_true_differences_and_is_not_much_more():
    """Coarse elements against theory, at uneven times: dense after the start, where the motion is fast."""
    scene = kv.Scene(drive=kv.Drive("1 m/s"), run=kv.Run(0.05))
    times = np.unique([*np.geomspace(1e-5, 0.05, 100), *np.linspace(0.0, 0.05, 60)])
    data = kv.elements(scene, at=times, certify=False, per_length="10 /mm", scheme="paper")
    case = make_case(Theory(scene, METHODS), read(data), None, 1.0, COARSEST)
    for name, most in (("depth", 300.0), ("normal_force", 10.0), ("friction_force", 10.0)):
        off, allowed = np.abs(getattr(data, name) - case.now[name]), case.allowed(name)
        assert np.all(off <= allowed)
        assert off @ off < allowed @ allowed < most**2 * (off @ off)
    depth, friction = case.now["depth"], case.now["friction_force"]
    carried = 1.5 * case.allowed("depth") * friction / depth  # friction grows as depth^(3/2)
    assert np.all((case.allowed("friction_force") >= carried)[friction > 0.0])


def test_a_ball_at_a_given_depth_that_goes_back_is_compared():
    """It meets its own trace, which needs elements."""
    drive = kv.Drive(waveform=kv.Triangle(mean=0.0, amplitude=0.1, frequency=20.0))
    scene = kv.Scene(kv.Sphere(0.01), support=kv.Fixed(1.767e-4), drive=drive, run=kv.Run(0.04))
    times = np.linspace(0.0, 0.04, 61)
    data = kv.elements(scene, per_length="30 /mm", at=times, certify=False)
    columns = {n: getattr(data, n) for n in ("time", "normal_force", "friction_force")}
    found = kv.compare(scene, columns, per_length="30 /mm")
    assert found.verdict == "agrees"
    back = found.theory["friction_force"]
    assert back.min() < -0.2 * back.max() < 0.0
    for name in ("normal force, RMS", "friction force, RMS"):
        assert 0.0 <= check(found, name).measured < check(found, name).allowed < 0.3


def test_the_time_is_written_below_the_last_row_of_curves():
    _, data = uneven(np.linspace(0.0, 0.2, 101))
    axes = [ax for ax in kv.compare(data=data).plot().axes if ax.lines]
    labels = [ax.get_xlabel() for ax in axes]
    assert labels == ["", "", "time $t$ [ms]", "time $t$ [ms]"]
