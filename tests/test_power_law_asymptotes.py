"""Asymptotes of power law and wedge: as wrong as they say, where they cross, and the friction maximum."""

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.results import STEADY_UNITS
from tests import reference, reference_power_law
from tests.test_power_law import EXPONENTS, SUPPORTS, random_case

SCENES = 30
AT_REST = {"drive.velocity": 0.0}
SHAPES = {
    "wedge": kv.Wedge(0.1),
    "pointed": kv.PowerLaw(0.01, 1.2),
    "parabola": kv.Parabola(0.01),
    "blunt": kv.PowerLaw(0.01, 8.0),
    "ball": kv.Sphere(0.01, radius_across=0.04),
}
CARRIED = {
    "fixed": kv.Fixed(depth=3e-4),
    "dead-weight": kv.DeadWeight(load=9e3),
    "suspended": kv.Suspended(load=9e3, stiffness=1e9),
}


def scene_of(case, kind):
    slope, L, n, K, tau, V, *rest = case
    support = {
        "fixed": lambda depth: kv.Fixed(depth=depth),
        "dead-weight": lambda weight, _: kv.DeadWeight(mass=weight / 9.80665),
        "suspended": lambda weight, spring: kv.Suspended(mass=weight / 9.80665, stiffness=spring),
    }[kind](*rest)
    shape = kv.Wedge(slope) if n == 1.0 else kv.PowerLaw(L, n)
    return kv.Scene(shape, kv.Foundation(K, tau), support, kv.Drive(V))


def enclosed(case, scene):
    given = (case[0], 1.0 if case[2] == 1.0 else case[1], *case[2:6])
    if scene.support.depth is not None:
        return reference_power_law.at_depth(*given, scene.support.depth)
    return reference_power_law.at_load(*given, scene.support.weight, scene.support.spring)


@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize("n", EXPONENTS)
def test_each_asymptote_is_exactly_as_wrong_as_it_says(n, kind):
    rng = np.random.default_rng([int(1000 * n), SUPPORTS.index(kind), 7])
    for _ in range(SCENES):
        case = random_case(rng, n, kind, decades=8)
        scene = scene_of(case, kind)
        found, truth = kv.steady(scene, method="asymptote"), enclosed(case, scene)
        assert found.model == "asymptote"
        for name in STEADY_UNITS:
            error = reference.relative_error(getattr(found, name), truth[name])
            claimed = found.certificate.relative_error[name]
            assert error <= claimed, (name, case, error, claimed)
            assert claimed <= error * (1.0 + 1e-9) + 1e-13, (name, case, error, claimed)


@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize("n", [1.0, 1.2, 1.5, 3.0, 8.0])
@pytest.mark.parametrize("tolerance", [1e-3, 0.05])
def test_an_asymptote_is_within_the_tolerance_up_to_the_velocity_that_is_named(n, kind, tolerance):
    """Of either regime, for every quantity, on both sides of the end of its range."""
    base = kv.Scene.table1(kind)
    shape = kv.Wedge(0.1) if n == 1.0 else kv.PowerLaw(0.01, n)
    scene = kv.Scene(shape, base.foundation, base.support)
    for place, line in enumerate(kv.asymptotes(scene, tolerance=tolerance).lines):
        edge = line.velocity_max if line.regime == "low" else line.velocity_min
        if not 0.0 < edge < np.inf:  # the load on a soft spring hardly changes
            assert line.quantity == "load"
            assert base.support.spring * kv.steady(scene, over=AT_REST).depth < 9806.65 * tolerance
            continue
        outward = 1.0 + 1e-6 if line.regime == "low" else 1.0 - 1e-6
        for factor, inside in ((1 / outward, True), (outward, False)):
            over = {"drive.velocity": edge * factor}
            there = kv.asymptotes(scene, over=over, tolerance=tolerance).lines[place]
            assert (abs(there.relative_error) <= tolerance) == inside, (line.name, there)
            wrong = there.value / there.exact - 1.0
            assert wrong == pytest.approx(there.relative_error, rel=1e-9, abs=1e-14)


@pytest.mark.parametrize("kind", CARRIED)
@pytest.mark.parametrize("shape", SHAPES)
def test_the_errors_keep_their_digits_far_from_the_crossing(shape, kind):
    """Where the error of the load or of the depth nears -100 % and another one is huge."""
    scene = kv.Scene(SHAPES[shape], support=CARRIED[kind])
    V = kv.asymptotes(scene).critical_velocity * 10.0 ** np.arange(-18.0, 19.0, 3.0)
    report = kv.asymptotes(scene, over={"drive.velocity": V})
    assert (report.use[:6] == "L1").all()
    assert (report.use[9:] == "L2").all()
    for line in report.lines:
        error = line.value / line.exact - 1.0
        off = np.abs(line.relative_error - error)
        assert (off <= 2.5e-14 * (1.0 + np.abs(error))).all(), line.name


@pytest.mark.parametrize("kind", SUPPORTS)
@pytest.mark.parametrize("n", [1.0, 1.2, 2.0, 3.0, 8.0])
def test_the_asymptotes_of_friction_meet_at_the_critical_velocity(n, kind):
    base = kv.Scene.table1(kind)
    shape = kv.Wedge(0.1) if n == 1.0 else kv.PowerLaw(0.01, n)
    scene = kv.Scene(shape, base.foundation, base.support)
    V = kv.asymptotes(scene).critical_velocity
    low, high = kv.asymptotes(scene, over={"drive.velocity": V}).lines[:2]
    assert low.value == pytest.approx(high.value, rel=1e-14)
    if n == 2.0:
        parabola = kv.Scene(kv.Parabola(0.01), base.foundation, base.support)
        assert pytest.approx(kv.asymptotes(parabola).critical_velocity, rel=1e-14) == V


@pytest.mark.parametrize("n", [1.05, 1.2, 1.5, 2.0, 3.0, 6.0, 20.0])
def test_the_friction_maximum_of_a_dead_weight(n):
    scene = kv.Scene(kv.PowerLaw(0.01, n))
    report = kv.asymptotes(scene)
    V, top = report.peak_velocity, report.peak_friction_coefficient
    at_peak = kv.steady(scene, over={"drive.velocity": V})
    assert at_peak.friction_coefficient == pytest.approx(top, rel=1e-14)
    assert 1.0 < at_peak.retardation_length / at_peak.half_length < 2.0
    around = V * np.geomspace(1e-6, 1e6, 4001)
    mu = kv.steady(scene, over={"drive.velocity": around}).friction_coefficient
    assert np.all(mu <= top * (1 + 1e-15))
    assert np.all(np.diff(mu[:1990]) > 0)  # no second one
    assert np.all(np.diff(mu[2010:]) < 0)
    if n == 2.0:
        parabola = kv.asymptotes(kv.Scene(kv.Parabola(0.01)))
        assert parabola.peak_velocity == pytest.approx(V, rel=1e-7)
        assert parabola.peak_friction_coefficient == pytest.approx(top, rel=1e-14)


@pytest.mark.parametrize("n", [1.0, 1.3, 2.0, 4.0, 10.0])
def test_under_a_dead_weight_friction_falls_with_its_own_power(n):
    scene = kv.Scene(kv.Wedge(0.1) if n == 1.0 else kv.PowerLaw(0.01, n))
    V = np.array([1e8, 1e9])
    mu = kv.steady(scene, over={"drive.velocity": V}).friction_coefficient
    exponent = np.log(mu[1] / mu[0]) / np.log(10.0)
    assert exponent == pytest.approx(-(1.0 - 1.0 / n), abs=1e-8)


def test_arrays_give_what_single_scenes_give():
    scene = kv.Scene(kv.PowerLaw(0.01, 3.0))
    V = np.geomspace(1e-4, 10.0, 7)
    together = kv.asymptotes(scene, over={"drive.velocity": V})
    for place, velocity in enumerate(V):
        alone = kv.asymptotes(scene, over={"drive.velocity": velocity})
        assert together.use[place] == alone.use
        for one, other in zip(together.lines, alone.lines, strict=True):
            assert one.relative_error[place] == pytest.approx(other.relative_error, rel=1e-12)
