"""`kv.elements` on a Prony series: the law of one element, its schemes, and runs against other methods."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.linalg import expm

import kvtheory as kv
from kvtheory.charts.stability import growth
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.schemes import SCHEMES
from kvtheory.models.elements.stability import amplification, lengths, limit_at
from kvtheory.results.table import scales
from kvtheory.theory.laws import Element
from tests import SUPPORTS, prony_elements
from tests.spring_random import of_unit_scales

ARMS = [(3e10, 0.01), (1e10, 0.1)]
RUBBER = kv.GeneralizedMaxwell(1e10, arms=ARMS)
MIXED = kv.GeneralizedMaxwell(1e10, arms=[(2e10, 5e-3), (1e10, 0.2)], damping=5e8)
WAYS = {
    "start": [(0.0, 3.0)],
    "stop": [(0.0, 3.0), (0.4, 3.0), (0.4, 0.0)],
    "reversal": [(0.0, 3.0), (0.4, 3.0), (0.4, -2.0)],
    "stop and go": [(0.0, 3.0), (0.3, 3.0), (0.3, 0.0), (0.6, 0.0), (0.6, 3.0)],
    "ramp": [(0.0, 0.0), (0.3, 3.0), (0.6, 3.0), (1.0, -3.0)],
}


def random_law(rng, damping=0.0):
    return Element.of(1.0, damping, 10.0 ** rng.uniform(-2, 2, (int(rng.integers(1, 6)), 2)))


def left_alone(law, state, h):
    """Return (u, s_i) of a free element after a time, by its modes."""
    y = state[0] - state[1:] / law.arm_stiffness
    y = np.append(y, state[:1]) if law.damping else y
    modes = law.to_modes @ y * law.step(h).fall
    u = law.shares @ modes
    return np.append(u, law.arm_stiffness * (u - (law.from_modes @ modes)[: law.arm_time.size]))


def scaled(history, support="dead-weight", arms=((3.0, 0.2), (0.5, 2.0)), end=1.0):
    """Return a scene with static half length, depth and load 1."""
    kappa = {"fixed": np.inf, "dead-weight": 0.0, "suspended": 1.0}[support]
    scene = of_unit_scales(0.1, kappa, kv.Drive(history=history), end)
    rubber = kv.GeneralizedMaxwell(0.75, [(0.75 * K, tau) for K, tau in arms])
    return replace(scene, foundation=rubber)


# The law of one element


def test_an_element_left_alone_is_that_of_its_equations():
    """Against the exponential of y_i' = (u - y_i)/tau_i, K u + sum K_i (u - y_i) = 0, by another method."""
    rng = np.random.default_rng(1)
    for _ in range(50):
        law, h = random_law(rng), 10.0 ** rng.uniform(-2, 2)
        K_i, tau = law.arm_stiffness, law.arm_time
        state = np.concatenate([[1.0], K_i * rng.uniform(0.0, 1.0, K_i.size)])
        matrix = (
            np.outer(np.ones_like(K_i), K_i / law.stiffness_within(0.0)) - np.eye(K_i.size)
        ) / tau[:, None]
        y = expm(h * matrix) @ (1.0 - state[1:] / K_i)
        u = K_i @ y / law.stiffness_within(0.0)
        found = left_alone(law, state, h)
        assert found[0] == pytest.approx(u, rel=1e-11, abs=1e-13)
        assert found[1:] == pytest.approx(
            K_i * (u - y), rel=1e-10, abs=1e-12 * law.stiffness_within(0.0)
        )
        assert abs(law.stiffness * found[0] + found[1:].sum()) < 1e-11 * law.stiffness_within(0.0)


def test_an_element_left_alone_beside_a_damper_is_that_of_its_equations():
    """C u' = -K u - sum s_i, s_i' = K_i u' - s_i/tau_i, by its exponential; u need not be in balance."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        law, h = random_law(rng, 10.0 ** rng.uniform(-3, 2)), 10.0 ** rng.uniform(-2, 2)
        K_i, tau = law.arm_stiffness, law.arm_time
        state = np.concatenate([[1.0], K_i * rng.uniform(-1.0, 1.0, K_i.size)])
        sinks = -np.append(law.stiffness, np.ones(K_i.size)) / law.damping
        matrix = np.vstack([sinks, np.outer(K_i, sinks)]) - np.diag(np.append(0.0, 1.0 / tau))
        size = np.append(1.0, K_i)
        off = (left_alone(law, state, h) - expm(h * matrix) @ state) / size
        assert np.abs(off).max() < 1e-9


def test_an_element_on_a_ramp_is_that_of_its_equations():
    """s_i' = K_i u' - s_i/tau_i, integrated; the mean pressure too, of a damper as well."""
    rng = np.random.default_rng(2)
    for damping in [0.0] * 5 + [3.0] * 5:
        law, h, rise = random_law(rng, damping), 10.0 ** rng.uniform(-2, 0.5), rng.uniform(-1, 1)
        K_i, tau = law.arm_stiffness, law.arm_time
        s_0 = K_i * rng.uniform(-1.0, 1.0, K_i.size)
        truth = solve_ivp(
            lambda t, s, K_i=K_i, tau=tau, rate=rise / h: K_i * rate - s / tau,
            (0.0, h), s_0, "LSODA", rtol=1e-9, atol=1e-12, dense_output=True,
        )  # fmt: skip
        step = law.step(h)
        assert step.held * s_0 + step.ramp * rise == pytest.approx(
            truth.y[:, -1], rel=1e-6, abs=1e-8 * law.stiffness_within(0.0)
        )
        whole = quad(lambda t, s=truth.sol: s(t).sum(), 0.0, h, epsrel=1e-9)[0]
        mean = law.stiffness * (0.7 + 0.5 * rise) + (whole + damping * rise) / h
        found = law.stiffness * 0.7 + step.weights @ s_0 + step.stiffness * rise
        assert found == pytest.approx(mean, rel=1e-6, abs=1e-8 * law.stiffness_within(0.0))


def test_twenty_arms_over_ten_decades_relax_and_never_grow():
    tau = np.geomspace(1e-8, 1e2, 20)
    law = Element.of(1.0, 0.0, np.transpose([np.geomspace(1e3, 1e-3, 20), tau]))
    assert law.longest_time > tau.max()
    state = np.concatenate([[1.0], np.zeros(20)])
    heights = [left_alone(law, state, h)[0] for h in np.geomspace(1e-9, 1e4, 60)]
    assert np.all(np.diff(heights) < 1e-12)
    assert 0.0 <= heights[-1] < 1e-12


@pytest.mark.parametrize("h", [1e-4, 0.03, 2.0])
def test_kelvin_voigt_is_the_limit_of_a_stiff_and_fast_arm_in_first_order(h):
    """With K_1 tau_1 = C. Of the ways to take the mean, Kelvin-Voigt has that with weights; left is both."""
    plain, off = Element.of(2.0, 0.5).step(h), []
    for tau in (1e-6, 1e-7):
        law = Element.of(2.0, 0.0, [(0.5 / tau, tau)])
        arm = law.step(h)
        state = np.array([1.0, -2.0])  # free of pressure: K u + s = 0
        off.append(abs(left_alone(law, state, h)[0] - plain.fall[0]))
        assert arm.damping == pytest.approx(plain.damping, rel=10 * tau / h)
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.05)


# Schemes


@pytest.mark.parametrize("arms", [ARMS, [(1e14, 1e-5)], [(1e12, 1e-3)]])
def test_measured_stability_limit_of_the_papers_scheme_is_the_derived_one(arms):
    """By two runs side by side, whose difference grows or does not."""
    scene = kv.Scene(
        foundation=kv.GeneralizedMaxwell(1e10, arms=arms), drive=kv.Drive(1e-3), run=kv.Run(0.6)
    )
    model = Model.of(scene)
    limit = limit_at(SCHEMES["paper"], model.constants, max(lengths(model, model.path(scene))))
    below, above = (
        growth(scene, "paper", 5e4, share * limit, steady=False) for share in (0.8, 1.15)
    )
    assert below <= 1.0 < 1.1 < above


def test_the_matrix_of_a_step_has_the_stability_polynomial_of_kelvin_voigt():
    """F15: |R(h sigma)| of both rates."""
    c, length, h = Model.of(kv.Scene()).constants, 2e-3, 7e-4
    for name in ("paper", "explicit-euler"):
        sigma = np.roots([c.mass, c.law.damping * length, c.law.stiffness * length])
        R = np.polynomial.polynomial.polyval(h * sigma, SCHEMES[name].stability_polynomial)
        found = np.linalg.eigvals(amplification(SCHEMES[name], c, length, h))
        assert np.sort(found) == pytest.approx(np.sort(R), rel=1e-10)


def test_the_order_is_two():
    """Of friction under a fixed indenter, spacing and step halved together, against exact.

    The normal force is nearer to exact, with an error that changes sign.
    """
    scene = replace(kv.Scene.table1("fixed"), foundation=RUBBER, run=kv.Run(0.1))
    exact, errors = kv.steady(scene), []
    for density in (2e4, 4e4, 8e4):
        end = kv.elements(scene, per_length=density, at=[0.1], certify=False)
        errors.append(abs(end.friction_force[0] / exact.friction_force - 1.0))
        assert abs(end.normal_force[0] / exact.load - 1.0) < errors[-1] < 1e-3
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.25)


# Against brute force, in time


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("support", SUPPORTS)
def test_the_transient_is_that_of_brute_force(way, support):
    scene, times = scaled(WAYS[way], support), [0.05, 0.35, 0.45, 0.65, 1.0]
    truth = prony_elements.run(scene, times)
    found = kv.elements(scene, per_length=100.0, at=times, certify=False)
    scale = scales(Model.of(scene).at_rest)
    for name in truth:
        assert np.abs(getattr(found, name) - truth[name]).max() < 3e-3 * scale[name], name


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("support", SUPPORTS)
def test_the_transient_beside_a_damper_is_that_of_brute_force(way, support):
    scene, times = scaled(WAYS[way], support), [0.05, 0.35, 0.45, 0.65, 1.0]
    scene = replace(scene, foundation=replace(scene.foundation, damping=0.1))
    truth = prony_elements.run_damped(scene, times)
    found = kv.elements(scene, per_length=100.0, at=times, certify=False)
    scale = scales(Model.of(scene).at_rest)
    for name in truth:
        assert np.abs(getattr(found, name) - truth[name]).max() < 4e-3 * scale[name], name


def test_arms_beside_a_damper_from_rest():
    """Fact F33: from a quadrature of the history, by elements marched in time."""
    found = kv.elements(kv.Scene(foundation=MIXED), at=[2e-3, 20e-3, 150e-3], per_length="80 /mm")
    error = found.certificate.relative_error
    depth, friction = [0.289390e-3, 0.172051e-3, 0.117546e-3], [1763.0, 1091.0, 800.0]
    assert found.depth == pytest.approx(depth, abs=1e-9 + 3e-4 * error["depth"])
    assert found.friction_force == pytest.approx(friction, rel=4e-3)


def test_each_scheme_takes_arms_beside_a_damper():
    scene = kv.Scene(foundation=MIXED, drive=kv.Drive(0.03), run=kv.Run(0.02))
    best = kv.elements(scene, at=[0.02], per_length="80 /mm", certify=False)
    for name in SCHEMES:
        found = kv.elements(scene, at=[0.02], per_length="40 /mm", scheme=name)
        error = found.certificate.relative_error
        assert found.depth == pytest.approx(best.depth, abs=3e-4 * error["depth"]), name
        assert found.friction_force == pytest.approx(best.friction_force, rel=6e-3), name


@pytest.mark.parametrize("shape", [kv.Wedge(0.05), kv.PowerLaw(0.01, 3.0)])
def test_the_order_is_two_beside_a_damper(shape):
    """Of both forces under a fixed indenter in steady sliding, where its tip is passed, too."""
    scene = kv.Scene(shape, MIXED, kv.Fixed(1e-4), kv.Drive(0.03), kv.Run(0.8))
    exact, errors = kv.steady(scene, method="quadrature"), []
    for density in (2e4, 8e4):
        end = kv.elements(scene, per_length=density, at=[0.8], certify=False)
        errors.append(abs(end.friction_force[0] / exact.friction_force - 1.0))
        assert abs(end.normal_force[0] / exact.load - 1.0) < 2e-4
    assert errors[1] < 0.2 * errors[0] < 2e-4


# Extremes


def test_a_hundred_arms_cost_no_more_elements_than_three():
    """All quantities at one instant; progress goes on until the last run is over."""
    told = []
    times = np.geomspace(1e-4, 1.0, 100)
    many = kv.GeneralizedMaxwell(1e10, arms=[(3e8, float(time)) for time in times])
    scene = kv.Scene(indenter=kv.Circle("10 mm"), foundation=many)
    found = kv.solve(
        scene, at="10 ms", rtol=1e-2, progress=lambda share, words: told.append((share, words))
    )
    assert found.answer.element_updates < 5e5
    assert told[-1][0] == 1.0
    assert "for the error" in told[-1][1]
    assert max(found.certificate.relative_error.values()) <= 1e-2


@pytest.mark.parametrize("velocity", [1e-9, 1e3])
@pytest.mark.parametrize("tau", [1e-9, 1e9])
def test_extremes_have_finite_answers(velocity, tau):
    arms, end = [(1e10, tau), (1e11, 1e-2 * tau)], 1e-3 / max(velocity, 1e-3)
    foundation = kv.GeneralizedMaxwell(1e10, arms=arms)
    scene = kv.Scene(foundation=foundation, drive=kv.Drive(velocity), run=kv.Run(end))
    how = {"per_length": "20 /mm", "time_step": end / 300.0, "certify": False}
    result = kv.elements(scene, at=[0.5 * end, end], **how)
    assert np.isfinite([result.depth, result.normal_force, result.friction_force]).all()
