"""The closed forms against ball arithmetic, and the identities that steady sliding must obey."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kvtheory as kv
from kvtheory.models.steady import methods, exact
from kvtheory.results import STEADY_UNITS
from tests import reference, steady
from tests.rounding import Rounded
from tests.steady import at_depth, at_load

EPS = np.finfo(float).eps
SCENES = 3400
"""Random scenes for each support, more than 10^4 in all."""


def random_scenes(count, seed):
    """R, K, tau, V, W over many decades, with Lambda = V tau (K/(R W))^(1/3) over 24 of them."""
    rng = np.random.default_rng(seed)
    R, K, tau, W = 10.0 ** rng.uniform([[-6], [3], [-6], [-6]], [[3], [15], [3], [9]], (4, count))
    number = 10.0 ** rng.uniform(-12, 12, count)
    number[:4] = 1e-12, 1e12, 1e-12, 1e12
    V = number / tau * np.cbrt(R * W / K) * rng.choice([-1.0, 1.0], count)
    return R, K, tau, V, W


def depths(R, K, W):
    a = np.cbrt(1.5 * R * W / K)
    return a * a / (2 * R)


SUPPORTS = {
    "fixed": lambda R, K, W, rng: (depths(R, K, W),),
    "dead-weight": lambda R, K, W, rng: (W,),
    "suspended": lambda R, K, W, rng: (W, W / depths(R, K, W) * 10.0 ** rng.uniform(-9, 9, R.size)),
}


def worst_errors(arguments, support):
    method = "at_depth" if support == "fixed" else "at_load"
    state = getattr(steady, method)(*arguments)
    worst = dict.fromkeys(STEADY_UNITS, 0.0)
    for i, scene in enumerate(zip(*(x.tolist() for x in arguments), strict=True)):
        truth = getattr(reference, method)(*scene)
        for name in worst:
            error = reference.relative_error(float(getattr(state, name)[i]), truth[name])
            worst[name] = max(worst[name], error)
    return worst


@pytest.mark.processor
@pytest.mark.parametrize("support", SUPPORTS)
def test_error_stays_below_the_certificate(support):
    R, K, tau, V, W = random_scenes(SCENES, seed=2020)
    extra = SUPPORTS[support](R, K, W, np.random.default_rng(38))
    worst = worst_errors((R, K, tau, V, *extra), support)
    print({name: f"{error / EPS:.1f} eps" for name, error in worst.items()})
    for name, error in worst.items():
        assert error <= claimed(support), name


def claimed(support):
    certificate = exact.HELD if support == "fixed" else exact.CARRIED
    (error,) = set(certificate.relative_error.values())
    return error


@pytest.mark.parametrize("support", SUPPORTS)
def test_the_certificate_is_the_worst_case_of_rounding(support):
    """Whatever processor and C library round, over 24 decades of velocity and 18 of the suspension."""
    R, K, tau, W = 0.017, 1.3e10, 0.13, 9876.5
    a_0, depth = np.cbrt(1.5 * R * W / K), float(depths(R, K, W))
    worst = 0.0
    for number in 10.0 ** np.linspace(-12.0, 12.0, 25):
        indenter, drive = (
            SimpleNamespace(radius=Rounded(R)),
            SimpleNamespace(final_velocity=Rounded(number * a_0 / tau)),
        )
        foundation = SimpleNamespace(stiffness=Rounded(K), retardation_time=Rounded(tau))
        for kappa in 10.0 ** np.linspace(-9.0, 9.0, 10) if support == "suspended" else [0.0]:
            grip = {"depth": depth, "weight": W, "spring": kappa * W / depth}
            scene = SimpleNamespace(
                indenter=indenter, foundation=foundation, drive=drive, held=support == "fixed",
                support=SimpleNamespace(**{key: Rounded(value) for key, value in grip.items()}),
            )  # fmt: skip
            found = exact.quantities(scene)
            worst = max(worst, *(getattr(value, "worst", 0.0) for value in found))
    assert worst <= claimed(support)
    assert support == "dead-weight" or worst > claimed(support) - EPS


POSITIVE = st.floats(-6, 6).map(lambda exponent: 10.0**exponent)


@given(R=POSITIVE, K=POSITIVE, tau=POSITIVE, W=POSITIVE, number=POSITIVE)
def test_one_number_fixes_the_friction_coefficient(R, K, tau, W, number):
    """Scale invariance: mu (K R^2/W)^(1/3) depends on Lambda alone, for any scene."""
    V = number / tau * np.cbrt(R * W / K)
    scaled = at_load(R, K, tau, V, W).friction_coefficient * np.cbrt(K * R * R / W)
    unit = at_load(1.0, 1.0, 1.0, number, 1.0).friction_coefficient
    assert scaled == pytest.approx(unit, rel=1e-13)


@given(V=POSITIVE, spring=st.sampled_from([0.0, 1e5, 1e9]))
def test_reversal_mirrors_the_contact(V, spring):
    forth, back = (at_load(0.01, 1e10, 0.1, v, 9806.65, spring) for v in (V, -V))
    for name in ("leading_edge", "trailing_edge", "friction_force", "friction_coefficient"):
        assert getattr(back, name) == -getattr(forth, name)
    for name in ("depth", "load", "peak_pressure", "dissipated_in_contact"):
        assert getattr(back, name) == getattr(forth, name)


@given(V=POSITIVE, factor=st.floats(1.001, 1e6), spring=st.sampled_from([0.0, 1e5, 1e9]))
def test_faster_lifts_the_indenter(V, factor, spring):
    slow, fast = (at_load(0.01, 1e10, 0.1, v, 9806.65, spring) for v in (V, V * factor))
    assert fast.depth <= slow.depth
    assert fast.depth < slow.depth or V * factor < 1e-6


@given(V=POSITIVE, depth=POSITIVE)
def test_power_is_spent_inside_and_behind_the_contact(V, depth):
    """Theorem F6, each loss from its definition: C V^2 int h'^2 dx and V K u_TE^2/2."""
    R, K, tau = 0.01, 1e10, 0.1
    state = at_depth(R, K, tau, V, depth)
    inside = K * tau * V**2 * (state.trailing_edge**3 - state.leading_edge**3) / (3 * R**2)
    left_over = V * tau * state.trailing_edge / R  # u_TE = l_r h'(x_TE), where p = 0
    behind = V * K * left_over**2 / 2
    power = state.friction_force * V
    assert inside + behind == pytest.approx(power, rel=1e-12)
    assert inside / power == pytest.approx(state.dissipated_in_contact, rel=1e-12)
    assert 0.8 - 1e-15 <= state.dissipated_in_contact <= 1.0


def test_rest_is_the_winkler_contact():
    state = at_load(0.01, 1e10, 0.1, 0.0, 9806.65)
    a = (1.5 * 0.01 * 9806.65 / 1e10) ** (1 / 3)
    assert state.friction_force == 0.0
    assert state.friction_coefficient == 0.0
    assert state.leading_edge == -state.trailing_edge == pytest.approx(-a, rel=1e-14)
    assert state.peak_pressure == pytest.approx(1e10 * state.depth, rel=1e-14)
    assert state.dissipated_in_contact == 1.0


@pytest.mark.parametrize("decades", [-10, 10])
def test_limits_ten_decades_from_the_critical_velocity(decades):
    V = 0.02 * 10.0**decades
    state = at_load(0.01, 1e10, 0.1, V, 9806.65)
    alpha = 2 * np.sqrt(2) / 3
    limit = V * 0.1 / 0.01 if decades < 0 else alpha * np.sqrt(9806.65 / (0.01 * 1e9 * V))
    assert state.friction_coefficient == pytest.approx(limit, rel=1e-9)


def test_a_suspension_joins_dead_weight_and_fixed():
    free = at_load(0.01, 1e10, 0.1, 0.1, 9806.65)
    static = at_load(0.01, 1e10, 0.1, 0.0, 9806.65)
    held = at_depth(0.01, 1e10, 0.1, 0.1, static.depth)
    soft = at_load(0.01, 1e10, 0.1, 0.1, 9806.65, 1e-6)
    stiff = at_load(0.01, 1e10, 0.1, 0.1, 9806.65, 1e22)
    for name in STEADY_UNITS:
        assert getattr(soft, name) == pytest.approx(getattr(free, name), rel=1e-12)
        assert getattr(stiff, name) == pytest.approx(getattr(held, name), rel=1e-12)


@pytest.mark.processor
def test_arrays_broadcast_and_do_not_depend_on_the_blocks(monkeypatch):
    V, tau = np.geomspace(1e-3, 1e1, 7)[:, None], np.array([0.01, 0.1, 1.0])
    whole = at_load(0.01, 1e10, tau, V, 9806.65)
    monkeypatch.setattr(methods, "BLOCK", 2)
    blocks = at_load(0.01, 1e10, tau, V, 9806.65)
    single = at_load(0.01, 1e10, 0.1, float(V[3, 0]), 9806.65)
    for name in STEADY_UNITS:
        assert getattr(whole, name).shape == (7, 3)
        assert np.array_equal(getattr(whole, name), getattr(blocks, name))
        assert isinstance(getattr(single, name), float)
        assert getattr(whole, name)[3, 1] == pytest.approx(getattr(single, name), rel=1e-15)


KELVIN_VOIGT = kv.Scene().foundation
MAXWELL = kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"], ["5 GN/m^3", "1 s"]])
FRACTIONAL = kv.FractionalKelvinVoigt(1e10, 0.1, 0.5)
LINES = (
    kv.Parabola(0.01),
    kv.Wedge(0.1),
    *(kv.PowerLaw(0.01, n) for n in (1.0, 1.5, 2.0, 3.0, 8.6)),
)
BALL = kv.Sphere(0.01)
CLOSED_FORMS = (
    *((line, KELVIN_VOIGT) for line in LINES),
    *((LINES[0], MAXWELL), (LINES[0], FRACTIONAL)),
    *((BALL, foundation) for foundation in (KELVIN_VOIGT, MAXWELL, FRACTIONAL)),
)


@pytest.mark.processor
@pytest.mark.parametrize("support", SUPPORTS)
@pytest.mark.parametrize(("shape", "foundation"), CLOSED_FORMS, ids=str)
def test_no_scene_depends_on_those_beside_it(shape, foundation, support):
    """Each converges for itself: the same bits alone, in threes, and among many."""
    if shape is BALL:
        held = kv.Suspended(mass=1.0, stiffness=1e4)
        own = {"fixed": kv.Fixed(1e-4), "dead-weight": kv.DeadWeight(mass=1.0), "suspended": held}
    else:
        own = {support: kv.Scene.table1(support).support}
    scene = kv.Scene(shape, foundation, own[support])
    V = np.geomspace(1e-6, 1e3, 60)
    together = kv.steady(scene, over={"drive.velocity": V})
    for size in (1, 3, 7):
        for start in range(0, V.size, size):
            part = slice(start, start + size)
            few = kv.steady(scene, over={"drive.velocity": V[part]})
            for name in STEADY_UNITS:
                assert np.array_equal(getattr(few, name), getattr(together, name)[part]), name


@pytest.mark.processor
def test_the_first_guess_needs_no_more_than_the_steps_it_is_given(monkeypatch):
    numbers = np.geomspace(1e-14, 1e14, 4001)
    for kappa in (0.0, 1e-6, 1e-3, 0.03, 0.3, 1.0, 3.0, 1e2, 1e8, 1e14):
        monkeypatch.setattr(exact, "HALLEY_STEPS", 2)
        taken = exact.scaled_root(numbers, np.full_like(numbers, kappa))
        monkeypatch.setattr(exact, "HALLEY_STEPS", 6)
        settled = exact.scaled_root(numbers, np.full_like(numbers, kappa))
        assert np.max(np.abs(taken / settled - 1)) <= 4 * EPS


def test_overflow_is_an_error():
    with pytest.raises(FloatingPointError):
        at_depth(1e300, 1e300, 1.0, 1.0, 1e300)
