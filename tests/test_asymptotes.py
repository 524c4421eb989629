"""The asymptotes against ball arithmetic: each is exactly as wrong as it says, in every quantity."""

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results import STEADY_UNITS
from tests import reference

SUPPORTS = ("fixed", "dead-weight", "suspended")
SCENES = 40


def random_scene(rng, kind):
    """Return a scene with its numbers over decades, |V| within eight decades of V*."""
    R, K, tau = (10.0 ** rng.uniform(*ends) for ends in ((-4, 0), (6, 12), (-4, 2)))
    weight = 10.0 ** rng.uniform(0, 5)
    depth = (0.75 * weight / (K * np.sqrt(2 * R))) ** (2 / 3)
    supports = {
        "fixed": kv.Fixed(depth=depth),
        "dead-weight": kv.DeadWeight(mass=weight / 9.80665),
        "suspended": kv.Suspended(
            mass=weight / 9.80665, stiffness=weight / depth * 10 ** rng.uniform(-2, 2)
        ),
    }
    V = rng.choice([-1.0, 1.0]) * np.sqrt(2 * R * depth) / tau * 10.0 ** rng.uniform(-8, 8)
    return kv.Scene(kv.Parabola(R), kv.Foundation(K, tau), supports[kind], kv.Drive(V))


def enclosed(scene):
    f, V, s = scene.foundation, scene.drive.velocity, scene.support
    given = scene.indenter.radius, f.stiffness, f.retardation_time, V
    if s.depth is not None:
        return reference.at_depth(*given, s.depth)
    return reference.at_load(*given, s.weight, s.spring)


@pytest.mark.parametrize("kind", SUPPORTS)
def test_each_asymptote_is_exactly_as_wrong_as_it_says(kind):
    rng = np.random.default_rng(SUPPORTS.index(kind))
    seen = dict.fromkeys(STEADY_UNITS, 0.0)
    for _ in range(SCENES):
        scene = random_scene(rng, kind)
        found, truth = kv.steady(scene, method="asymptote"), enclosed(scene)
        for name in STEADY_UNITS:
            error = reference.relative_error(getattr(found, name), truth[name])
            claimed = found.certificate.relative_error[name]
            assert error <= claimed, (name, error, claimed)
            assert claimed <= error * (1.0 + 1e-9) + 1e-13, (name, error, claimed)
            seen[name] = max(seen[name], error)
    given = {"depth", "half_length", "leading_edge"} if kind == "fixed" else set()
    exact = {"retardation_length", *given, *({"load"} if kind == "dead-weight" else ())}
    assert {name for name, error in seen.items() if error < 1e-10} == exact


@pytest.mark.parametrize("kind", SUPPORTS)
def test_the_regimes_are_told_apart_at_the_critical_velocity(kind):
    scene = kv.Scene.table1(kind)
    critical = kv.asymptotes(scene).critical_velocity
    over = {"drive.velocity": np.array([0.999, 1.001]) * critical}
    found = kv.steady(scene, over=over, method="asymptote")
    assert found.trailing_edge[0] == found.half_length[0]
    assert found.trailing_edge[1] == 0.0
    mu = found.friction_coefficient
    assert mu[0] == pytest.approx(mu[1], rel=2.1e-3)


@pytest.mark.parametrize("kind", SUPPORTS)
def test_at_rest_the_low_asymptote_is_the_truth(kind):
    found = kv.steady(kv.Scene.table1(kind), over={"drive.velocity": 0.0}, method="asymptote")
    exact = kv.steady(kv.Scene.table1(kind), over={"drive.velocity": 0.0})
    for name in STEADY_UNITS:
        assert getattr(found, name) == pytest.approx(getattr(exact, name), rel=1e-14, abs=0)
        assert found.certificate.relative_error[name] < 1e-13
