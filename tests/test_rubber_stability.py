"""Stability of steady sliding on a Prony series, against quadrature of its definition, and elements."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import kvtheory as kv
from kvtheory.models.steady import general_stability

ZENER, TWO = [(5e10, 0.1)], [(3e10, 0.01), (5e9, 0.5)]


def growth(scene, stiffness, rate, ramp):
    """Return growth and frequency by elements, in 1/s, after a ramp that ends near steady sliding.

    The expected rate chooses the instants; slow arms relax beside the swing.
    """
    V, omega = scene.drive.velocity, abs(rate.imag)
    at = ramp + np.linspace(1.5, 9.5, 161) * 2.0 * np.pi / omega
    drive = kv.Drive(history=[(0.0, 0.0), (ramp, V)], stiffness=stiffness, mass=scene.drive_mass)
    whole = replace(scene, drive=drive, run=kv.Run(float(at[-1])))
    run = kv.elements(whole, per_length="100 /mm", at=at, certify=False)
    t, x = at - at[0], run.sliding_velocity / V - 1.0
    slowest = max(arm.relaxation_time for arm in scene.foundation.arms)

    def misfit(pair):
        e, phase = np.exp(pair[0] * omega * t), pair[1] * omega * t
        base = np.stack([t**0, np.exp(-t / slowest), e * np.cos(phase), e * np.sin(phase)], axis=1)
        return np.linalg.norm(x - base @ np.linalg.lstsq(base, x, rcond=None)[0])

    options = {"xatol": 1e-7, "fatol": 1e-12 * np.linalg.norm(x)}
    starts = ((-0.02, 1.0), (0.02, 1.0))
    best = min((minimize(misfit, each, method="Nelder-Mead", options=options) for each in starts),
               key=lambda each: each.fun)  # fmt: skip
    return best.x * omega


QUICK = "stable", "critical_stiffness", "frequency"


def rubber(arms, velocity, stiffness=1e6, **parts):
    parts = {"support": kv.DeadWeight(mass=1000.0), **parts}
    drive = kv.Drive(velocity=velocity, stiffness=stiffness, mass=parts["support"].mass)
    return kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=arms), drive=drive, **parts)


def forces(scene, strip, s, points=60):
    """A, B, C, D of a parabola at the half length `strip`, by plain sums over the history of each element."""
    V, R, K = scene.drive.velocity, scene.indenter.radius, scene.foundation.stiffness
    held = kv.Scene(kv.Parabola(R), scene.foundation, kv.Fixed(strip**2 / (2.0 * R)), kv.Drive(V))
    state = kv.steady(held)
    nodes, weights = np.polynomial.legendre.leggauss(points)
    nodes, weights = 0.5 + 0.5 * nodes, 0.5 * weights
    x = state.leading_edge + nodes[:, None] * (state.trailing_edge - state.leading_edge)
    share = weights * (state.trailing_edge - state.leading_edge)
    age = (x - state.leading_edge) / V
    t = age * nodes
    G = K + sum(arm.stiffness for arm in scene.foundation.arms)
    slope = -sum(
        arm.stiffness / arm.relaxation_time * np.exp(-t / arm.relaxation_time)
        for arm in scene.foundation.arms
    )
    lowered = G + age[:, 0] * ((slope * np.exp(-s * t)) @ weights)
    moved = age[:, 0] * ((-slope * (x - V * t) / R * (1.0 - np.exp(-s * t))) @ weights)
    lever = -share * x[:, 0] / R
    return np.array([share @ lowered, share @ moved, lever @ lowered, lever @ moved])


def residue(scene, s, spring):
    """The determinant that vanishes at a rate, over the sum of its terms' sizes."""
    support, R = scene.support, scene.indenter.radius
    a = np.sqrt(2.0 * R * kv.steady(scene).depth)
    if scene.indenter.per_width:
        A, B, C, D = forces(scene, a, s)
    else:
        nodes, weights = (0.25 * np.pi * x for x in np.polynomial.legendre.leggauss(40))
        cosines = np.cos(0.25 * np.pi + nodes)
        sums = [
            2 * a * w * c * forces(scene, a * c, s) for c, w in zip(cosines, weights, strict=True)
        ]
        A, B, C, D = sum(sums) * scene.indenter.stretch
    along = scene.drive_mass * s * s + spring - D
    if scene.held:
        return abs(along) / (abs(D) + spring)
    across = support.mass * s * s + support.spring + A
    return abs(across * along + B * C) / (abs(across) * (abs(D) + spring) + abs(B * C))


@pytest.mark.parametrize(
    ("arms", "velocity", "stiffness", "omega"),
    [
        (ZENER, 0.05, 4.533990e6, 66.6002),
        (ZENER, 0.3, 146.765e6, None),
        (TWO, 0.2, 44.7401e6, None),
    ],
)
def test_critical_stiffness_of_table_1(arms, velocity, stiffness, omega):
    found = kv.stability(rubber(arms, velocity), quantity=QUICK)
    assert found.critical_stiffness == pytest.approx(stiffness, rel=3e-6)
    assert not found.stable
    if omega:
        assert 2.0 * np.pi * found.frequency == pytest.approx(omega, rel=1e-6)
    for factor, stable in ((1.0 - 1e-9, False), (1.0 + 1e-9, True)):
        near = rubber(arms, velocity, factor * found.critical_stiffness)
        assert kv.steady(near).stable is stable


def test_slow_sliding_is_stable_for_every_stiffness():
    found = kv.stability(rubber(TWO, [0.0, 0.05, -0.05]), quantity=QUICK)
    assert found.stable.all()
    assert np.isnan(found.critical_stiffness).all()


@pytest.mark.parametrize("ball", [False, True])
def test_a_fast_stiff_arm_is_a_damper(ball):
    """To first order in its relaxation time: ten times as fast, a tenth of the difference."""
    parts = {"indenter": kv.Sphere(0.01), "support": kv.DeadWeight(mass=1.0)} if ball else {}
    velocity = np.array([0.039, 0.214])
    scenes = [rubber([(1e9 / t, t)], velocity, **parts) for t in (1e-6, 1e-7)]
    damper = kv.Scene(drive=kv.Drive(velocity=velocity), **parts)
    truth, *found = (
        kv.stability(each, quantity=QUICK).critical_stiffness for each in (damper, *scenes)
    )
    off = [np.abs(each / truth - 1.0) for each in found]
    assert (off[0] < 2e-2).all()
    assert off[1] == pytest.approx(0.1 * off[0], rel=0.1)


@pytest.mark.parametrize(
    ("support", "ball"),
    [("dead-weight", False), ("suspended", False), ("fixed", False), ("suspended", True)],
)
def test_onsets_and_rates_solve_the_linearised_equations(support, ball):
    mass = 1.0 if ball else 1000.0
    kinds = {
        "dead-weight": kv.DeadWeight(mass=mass),
        "suspended": kv.Suspended(mass=mass, stiffness=3e4 * mass),
        "fixed": kv.Fixed(depth=1e-4),
    }
    indenter = kv.Sphere(0.01, 0.02) if ball else kv.Parabola(0.01)
    drive = kv.Drive(velocity=0.2, stiffness=1e3 * mass, mass=mass)
    scene = kv.Scene(indenter, kv.GeneralizedMaxwell(1e10, arms=TWO), kinds[support], drive)
    found = kv.stability(scene, quantity=[*QUICK, "rates"])
    size = 1e-6 if ball else 1e-11
    onset = 2j * np.pi * found.frequency
    assert residue(scene, onset, found.critical_stiffness) < size
    for rate in found.rates[:2]:
        assert residue(scene, complex(*rate), drive.stiffness) < size
    assert found.stable == (found.rates[0, 0] < 0.0)
    assert np.isfinite(found.certificate.relative_error["rates"]).all()
    for factor, side in () if ball else ((1.0 - 1e-4, 1.0), (1.0 + 1e-4, -1.0)):
        over = {"drive.stiffness": factor * found.critical_stiffness}
        assert np.sign(kv.stability(scene, over=over, quantity="rates").rates[0, 0]) == side


def test_a_rate_is_not_lost_among_the_resonances_of_the_strips_of_a_ball():
    """Against zeros of `residue` in 48 strips."""
    layer = kv.GeneralizedMaxwell(
        thickness="2 mm", poisson_ratio=0.3, modulus="2 MPa", stiffness_from="thin",
        arms=[["1 MPa", "10 ms"], ["0.5 MPa", "0.1 s"]],
    )  # fmt: skip
    drive = kv.Drive(velocity=0.01, stiffness=1e3, mass=0.3)
    scene = kv.Scene(kv.Sphere(0.01), layer, kv.DeadWeight(mass=0.3, load=1.0), drive)
    found = kv.stability(scene, quantity="rates")
    errors = found.certificate.relative_error["rates"]
    assert (errors < 1e-4).all()
    truth = -0.522553710386766 + 58.0810207562919j, -13.9105590785273 + 260.123835034526j
    for rate, error, true in zip(found.rates[1::2], errors[1::2], truth, strict=True):
        assert abs(complex(*rate) - true) <= error * abs(true)


FAST = [(2e11, 5e-3)]


@pytest.mark.parametrize(
    ("arms", "velocity", "mass", "side", "ramp"),
    [(FAST, 0.091, 100.0, 1.4, 0.1), (FAST, 0.091, 100.0, 0.7, 0.5),
     (TWO, 0.2, 50.0, 1.4, 0.1), (TWO, 0.2, 50.0, 0.7, 0.3)],
)  # fmt: skip
def test_elements_grow_or_fade_at_the_rate_on_both_sides_of_the_critical_stiffness(
    arms, velocity, mass, side, ramp
):
    scene = rubber(arms, velocity, support=kv.DeadWeight(mass=mass, load=9806.65))
    stiffness = side * kv.stability(scene, quantity="critical_stiffness").critical_stiffness
    over = {"drive.stiffness": stiffness}
    rate = complex(*kv.stability(scene, over=over, quantity="rates").rates[0])
    assert (rate.real > 0.0) == (side < 1.0)
    found, frequency = growth(scene, stiffness, rate, ramp)
    assert found == pytest.approx(rate.real, rel=0.02)
    assert frequency == pytest.approx(abs(rate.imag), rel=2e-3)


@pytest.mark.parametrize("ball", [False, True])
def test_the_general_way_agrees_with_the_closed_forms_on_kelvin_voigt(ball):
    """F24 with a damper for the law, against the quartic of F22, each within its error."""
    rng, unit = np.random.default_rng(3), 1e-3 if ball else 1.0
    indenter, seen = kv.Sphere(0.01) if ball else kv.Parabola(0.01), 0
    for _ in range(8):
        load, mass = 9806.65 * unit, 1000.0 * unit * 10.0 ** rng.uniform(-1, 1)
        support = kv.DeadWeight(mass=mass, load=load)
        drive = kv.Drive(10.0 ** rng.uniform(-1.5, 1), stiffness=1e6 * unit, mass=2.0 * mass)
        scene = kv.Scene(indenter, kv.Foundation(1e10, 0.1), support, drive)
        closed = kv.stability(scene, quantity=[*QUICK, "rates"])
        own = closed.certificate.relative_error
        motions = general_stability.SmallMotions(scene.at(np.array([drive.velocity])).flat())
        (upper, _, frequency), _ = motions.critical()
        for name, (value,) in (("critical_stiffness", upper), ("frequency", frequency)):
            there = getattr(closed, name)
            assert np.isnan(value) == np.isnan(there)
            if not np.isnan(there):
                seen += 1
                allowed = own[name] + motions.crossings.error.max()
                assert abs(value / there - 1.0) <= allowed < 1e-7
        found, _ = motions.rates(np.array([drive.stiffness]))
        quartic = closed.rates @ [1.0, 1.0j]
        assert np.sort_complex(found[0]) == pytest.approx(np.sort_complex(quartic), rel=1e-7)
    assert seen >= 6


def test_a_ball_gets_as_many_strips_as_its_error_needs(monkeypatch):
    """Arms so fast that they relax within the strips at the rim only."""
    arms = [(2e12, 1.42e-5), (1.97e12, 3.12e-4)]
    parts = {"indenter": kv.Sphere(0.01), "support": kv.DeadWeight(mass=4.5, load=9.8)}
    scene = rubber(arms, np.array([0.049]), 1e3, **parts).flat()
    monkeypatch.setattr(general_stability, "STRIPS", 6)
    monkeypatch.setattr(general_stability, "ACCURATE", np.inf)
    few = general_stability.SmallMotions(scene).crossings
    monkeypatch.setattr(general_stability, "ACCURATE", 1e-8)
    motions = general_stability.SmallMotions(scene)
    found = motions.crossings
    monkeypatch.setattr(general_stability, "STRIPS", 192)
    truth = general_stability.SmallMotions(scene).crossings
    assert len(motions.fine.c) > 6
    for each in (few, found):
        assert np.all(np.abs(each.stiffness / truth.stiffness - 1.0) <= each.error + truth.error)
    assert np.all(found.error < 1e-8)
    assert few.error.max() > 1e-8


def test_an_empty_array_of_scenes_has_an_empty_answer():
    found = kv.stability(rubber(ZENER, 0.05), over={"drive.velocity": np.empty(0)})
    assert (found.stable.shape, found.rates.shape) == ((0,), (0, 4, 2))


def test_the_critical_velocity_is_where_the_stiffness_is_critical():
    found = kv.stability(rubber(ZENER, 0.05), quantity="critical_velocity")
    there = kv.stability(rubber(ZENER, found.critical_velocity), quantity=QUICK)
    assert there.critical_stiffness == pytest.approx(1e6, rel=1e-9)
    assert found.certificate.relative_error["critical_velocity"] < 1e-12


def test_a_critical_velocity_that_cannot_be_refined_has_no_certificate():
    """Of a spring so soft that it is first unstable at the friction maximum, with no crossing just below."""
    found = kv.stability(rubber(ZENER, 0.05, 1e-2), quantity="critical_velocity")
    top = kv.stability(rubber(ZENER, 0.05, 1e-4), quantity="critical_velocity")
    assert found.critical_velocity == pytest.approx(top.critical_velocity, rel=1e-7)
    assert found.certificate.relative_error["critical_velocity"] == math.inf
