"""The rungs of a time series: their assumptions, and that each estimate covers what it neglects."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import kvtheory as kv
from kvtheory.ladder.series import ODD, ON_RIGID, SOLVED
from kvtheory.models.slow_manifold import motion as slow_motion
from kvtheory.models.slow_manifold import start as slow_start
from kvtheory.results.table import scales as scales_of
from kvtheory.scene.static_state import StaticState
from tests.spring_random import of_unit_scales


def depth_rate(d, number, kappa):
    """Return d' on the slow manifold (F13).

    The forces balance, b^2 (2 b + 3 (lambda - a)) = 4 f with b = r + a, and p(r) = 0.
    """
    a = math.sqrt(d)
    r = np.roots([2.0, 3.0 * (number - a), 0.0, -4.0 * (1.0 - kappa * (d - 1.0))]).real.max() - a
    return r * (r + 2.0 * number) - d


def by_radau(number, kappa, end):
    """Return d(s) for 0 <= s <= end after a start from rest, as a function, by SciPy."""

    def log_rate(_, log_depth):  # the depth stays positive, however fast it falls
        d = math.exp(log_depth[0])
        return [depth_rate(d, number, kappa) / d]

    found = solve_ivp(log_rate, (0.0, end), [0.0], "Radau", rtol=1e-9, atol=1e-9, dense_output=True)
    return lambda s: np.exp(found.sol(s)[0])


def light(number=4.0, eps=1e-6, kappa=0.0, end=3.0):
    """Return a start from rest in scaled units."""
    return of_unit_scales(eps, kappa, kv.Drive(number), end)


@pytest.mark.parametrize(("number", "kappa"), [(0.1, 0.0), (4.0, 0.0), (100.0, 0.0), (2.0, 0.3)])
def test_the_quadrature_of_the_slow_manifold_agrees_with_its_integration(number, kappa):
    """Two solvers without common code."""
    times = np.geomspace(1e-4, 3.0, 30)
    found = slow_motion.follow(slow_start.start(number, 1e-12, kappa), times, 1e-9)
    integrated = by_radau(number, kappa, 3.0)
    np.testing.assert_allclose(found.values["depth"], integrated(times), rtol=1e-7)
    rates = [depth_rate(d, number, kappa) for d in found.values["depth"]]
    np.testing.assert_allclose(found.values["depth_rate"], rates, atol=1e-9 * number)


def random_start(rng):
    kappa = float(rng.choice([0.0, 10 ** rng.uniform(-2, 1.5)]))
    number, eps, end = (10 ** rng.uniform(*decades) for decades in ((-2, 2), (-8, -1), (-1, 1.3)))
    return number, eps, kappa, np.sort(end * 10 ** rng.uniform(-3, 0, 12))


def test_the_estimate_covers_what_the_slow_manifold_neglects():
    """Against the continuum with a far smaller tolerance."""
    rng, close, tried = np.random.default_rng(5), [], 0
    for _ in range(40):
        number, eps, kappa, times = random_start(rng)
        try:
            given = slow_start.start(number, eps, kappa)
            found = slow_motion.follow(given, times, 10 ** rng.uniform(-8, -3))
        except ArithmeticError:
            continue
        if found.ratio > slow_motion.LARGEST_RATIO:
            continue
        scene = light(number, eps, kappa, times[-1])
        truth = kv.transient(scene, at=times, rtol=1e-11)
        scales = scales_of(StaticState.of(scene))
        for name in SOLVED:
            error = np.abs(found.values[name] - getattr(truth, name) / scales[name])
            assert np.all(error <= found.errors[name] + 1e-9), (name, number, eps, kappa)
        close.append(
            np.max(np.abs(found.values["depth"] - truth.depth)) / found.errors["depth"].max()
        )
        tried += 1
    assert tried >= 20
    assert np.median(close) > 0.3


def test_the_slow_manifold_is_used_where_it_is_enough_and_only_there():
    late, early = [0.1, 1.0], [0.0, 1.0]
    slow = kv.solve(light(), at=late, rtol=1e-3)
    mirror = kv.solve(light(-4.0), at=late, rtol=1e-3)
    assert slow.model == mirror.model == "slow manifold"
    for name in SOLVED:
        side = -1 if name in ODD else 1
        np.testing.assert_array_equal(getattr(mirror, name), side * getattr(slow, name))
    assert kv.solve(light(), at=late, rtol=1e-8).model == "continuum"
    assert kv.solve(light(eps=0.1), at=late, rtol=1e-3).model == "continuum"
    assert kv.solve(light(), at=early, rtol=1e-3).model == "continuum"  # the layer
    depth = kv.solve(light(), at=early, quantity="depth", rtol=1e-3)
    assert depth.model == "slow manifold"
    # A stiff spring unloads: the trailing edge moves out again, over ground that it left.
    found = kv.solve(light(0.35, 1e-7, 24.0), at=[0.5], rtol=1e-2)
    assert found.model == "continuum"
    assert "re-enter deformed foundation" in found.climb[1].outcome


@pytest.mark.parametrize("support", ["fixed", "dead-weight"])
@pytest.mark.parametrize("velocity", [-0.1, 0.0, 0.1])
def test_what_is_steady_at_once_is_the_continuum_too(support, velocity):
    scene = kv.Scene(
        support=kv.Scene.table1(support).support, drive=kv.Drive(velocity), run=kv.Run(0.05)
    )
    at = [0.0, 0.01, 0.05]
    found = kv.solve(scene, at=at, rtol=1e-6)
    assert found.model == ("exact" if support == "fixed" or velocity == 0.0 else "continuum")
    truth, scales = kv.transient(scene, at=at, rtol=1e-9), scales_of(StaticState.of(scene))
    for name in SOLVED:
        error = np.abs(getattr(found, name) - getattr(truth, name)).max() / scales[name]
        assert error <= 1e-6, name


def test_a_history_climbs_to_the_continuum_and_what_is_not_asked_for_is_not_given():
    history = [(0.0, 0.1), (0.05, 0.1), (0.05, 0.0)]
    scene = kv.Scene(drive=kv.Drive(history=history))
    found = kv.solve(scene, at=[0.1], quantity=["depth", "friction_force"], rtol=1e-9)
    assert found.model == "continuum"  # with steps that are tightened until the certificate is met
    assert [step.outcome for step in found.climb[:2]] == ["the depth changes", "the drive changes"]
    assert np.isnan(found.normal_force).all()
    assert set(found.certificate.relative_error) == {"time", "velocity", "depth", "friction_force"}
    assert max(found.certificate.relative_error.values()) <= 1e-9
    with pytest.raises(AttributeError, match="no `load`"):
        found.load  # noqa: B018


def test_other_shapes_climb_to_the_elements():
    scene, at = kv.Scene(kv.Wedge(inclination=0.05), run=kv.Run(0.02)), [0.01, 0.02]
    found = kv.solve(scene, at=at, quantity="depth", rtol=1e-2)
    assert found.model == "elements"
    finer = kv.elements(scene, at=at, per_length=4.0 * found.answer.per_length)
    assert found.depth == pytest.approx(finer.depth, rel=1e-2)
    assert math.isnan(found.climb[-2].error)
    drive = kv.Drive(velocity="91 mm/s", stiffness="1 MN/m^2")
    sprung = kv.Scene(kv.Circle(0.01), drive=drive, run=kv.Run(0.01))
    assert kv.solve(sprung, at=[0.005], rtol=0.05).model == "elements"


def stiff_case(seed):
    """Return a start on a stiff spring, damped or not, the same on a rigid drive, and some times."""
    rng = np.random.default_rng(seed)
    number, eps, inertia = (10 ** rng.uniform(*decades) for decades in ((-1, 1), (-3, 0), (-2, 1)))
    stiffness = 10 ** rng.uniform(3, 6)
    damping = float(rng.choice([0.0, 10 ** rng.uniform(-2, 0)])) * math.sqrt(stiffness * inertia)
    rigid = light(number, eps, float(rng.choice([0.0, 3.0])), 2.0)
    drive = kv.Drive(number, stiffness=stiffness, damping=damping, mass=inertia)
    return replace(rigid, drive=drive), rigid, np.sort(rng.uniform(0.0, 2.0, 8))


@pytest.mark.parametrize("seed", range(3))
def test_what_the_spring_does_is_within_its_tolerance(seed):
    """Its force and the sliding velocity, by both models of a parabola, against a tight transient."""
    sprung, _, at = stiff_case(seed)
    truth, scales = kv.transient(sprung, at=at, rtol=1e-9), scales_of(StaticState.of(sprung))
    for name in ON_RIGID:
        found = kv.solve(sprung, quantity=name, at=at, rtol=3e-2)
        error = np.abs(getattr(found, name) - getattr(truth, name)).max() / scales[name]
        assert error <= found.certificate.relative_error[name] + 1e-8 <= 3e-2 + 1e-8, name
