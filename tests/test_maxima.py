"""The maxima of friction over velocity: closed forms against the search, the search against dense scans."""

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.steady import maxima
from tests import SCENES, SUPPORTS, reference_viscoelastic

V = "drive.velocity"
TWO_ARMS = kv.GeneralizedMaxwell(1e10, arms=[["10 GN/m^3", "1 ms"], ["10 GN/m^3", "1 s"]])
MANY = max(1, SCENES // 200)
F3 = 3 * (np.sqrt(3) - 1) / 4 * (3 - np.sqrt(3)) ** (-1 / 3)
"""mu (K R^2/W)^(1/3) at the maximum."""


def scanned(scene, decades=5.0, per_decade=160, noise=1e-13):
    """Return velocities, friction and the places of all maxima of a scan over all time scales."""
    times = [arm.relaxation_time for arm in scene.foundation.arms]
    times.append(scene.foundation.retardation_time)
    a = kv.steady(scene, over={V: 0.0}).half_length
    low, high = np.log10(a / max(times)) - decades, np.log10(a / min(times)) + decades
    speeds = np.logspace(low, high, int((high - low) * per_decade))
    mu = kv.steady(scene, over={V: speeds}).friction_coefficient
    places, best, sign = [], 0, 1.0
    for i, value in enumerate(mu):
        if sign * value > sign * mu[best]:
            best = i
        elif sign * value < sign * mu[best] * (1.0 - sign * noise):
            if sign > 0.0:
                places.append(best)
            best, sign = i, -sign
    return speeds, mu, places


def agree(found, errors, speeds, mu, places):
    """Check that the maxima are those of a scan, none missing and none too many."""
    assert len(found) == len(places)
    for (v, top), (off, own), i in zip(found, errors, places, strict=True):
        assert speeds[i - 1] * (1.0 - off) <= v <= speeds[i + 1] * (1.0 + off)
        assert mu[i] <= top * (1.0 + own)
        assert top <= mu[i] * 1.01


def random_scene(rng, shape, kind):
    K, R, count = 10 ** rng.uniform(8, 11), 10 ** rng.uniform(-3, -1), rng.integers(1, 6)
    arms = zip(K * 10 ** rng.uniform(-1.5, 3, count), 10 ** rng.uniform(-5, 3, count), strict=True)
    depth = R * 10 ** rng.uniform(-4, -2)
    ball = shape is kv.Sphere
    load = np.pi * K * R * depth**2 if ball else 4 / 3 * K * np.sqrt(2 * R * depth) * depth
    support = {
        "fixed": lambda: kv.Fixed(depth=depth),
        "dead-weight": lambda: kv.DeadWeight(load=load),
        "suspended": lambda: kv.Suspended(
            load=load, stiffness=load / depth * 10 ** rng.uniform(-2, 3)
        ),
    }[kind]()
    foundation = kv.GeneralizedMaxwell(K, arms=[tuple(map(float, arm)) for arm in arms])
    return kv.Scene(shape(R), foundation, support)


@pytest.mark.parametrize(
    ("shape", "count", "noise"), [(kv.Parabola, 24 * MANY, 1e-13), (kv.Sphere, 3 * MANY, 4e-11)]
)
def test_random_prony_series_have_the_maxima_of_a_scan_ten_times_denser(shape, count, noise):
    rng = np.random.default_rng(7)
    for number in range(count):
        scene = random_scene(rng, shape, SUPPORTS[number % 3])
        found = maxima.report(scene, "exact")
        errors = found["maxima_certificate"].relative_error["maxima"]
        agree(found["maxima"], errors, *scanned(scene, 3.5, noise=noise))


def test_the_known_maxima_of_a_dead_weight():
    scene = kv.Scene()
    ((velocity, top),) = kv.asymptotes(scene).maxima
    K, R, W = scene.foundation.stiffness, scene.indenter.radius, scene.support.weight
    assert top == pytest.approx(F3 * (W / (K * R * R)) ** (1 / 3), rel=1e-14)
    Lambda = np.sqrt(3) * (3 - np.sqrt(3)) ** (-1 / 3)
    assert velocity == pytest.approx(Lambda * (R * W / K) ** (1 / 3) / 0.1, rel=1e-14)
    springpot = kv.Scene(foundation=kv.FractionalKelvinVoigt(1e10, 0.1, 1.0))
    ((again, same),) = kv.asymptotes(springpot).maxima
    assert again == pytest.approx(velocity, rel=1e-6)
    assert same == pytest.approx(top, rel=1e-13)


@pytest.mark.parametrize(
    "indenter",
    [kv.Parabola(0.01), kv.Sphere(0.01), *(kv.PowerLaw(0.01, n) for n in (1.05, 1.2, 2.0, 6.0, 20.0))],
    ids=str,
)  # fmt: skip
def test_the_search_finds_what_the_closed_forms_say(indenter):
    scene = kv.Scene(indenter, support=kv.DeadWeight(load=3e3))
    (closed,) = kv.asymptotes(scene).maxima
    at_peak = kv.steady(scene, over={V: closed[0]})
    assert at_peak.friction_coefficient == pytest.approx(closed[1], rel=1e-14)
    assert 1.0 < at_peak.retardation_length / at_peak.half_length < 2.0
    rows = maxima._search(scene.at(1.0), "exact", *maxima.FINE)
    assert rows.shape == (1, 4)
    assert abs(rows[0, :2] / closed - 1.0) == pytest.approx(0.0, abs=1e-4)
    assert np.all(abs(rows[0, :2] / closed - 1.0) <= rows[0, 2:] + maxima.CLOSED_ERROR)
    held = kv.Scene(indenter, support=kv.Fixed(depth=1e-4))
    assert kv.asymptotes(held).maxima == ()
    assert maxima._search(held.at(1.0), "exact", *maxima.FINE).shape == (0, 4)


@pytest.mark.parametrize("kind", SUPPORTS)
def test_a_plateau_and_a_limit_are_no_maxima(kind):
    wedge = kv.Scene(kv.Wedge(0.1), support=kv.Scene.table1(kind).support)
    assert maxima._search(wedge.at(1.0), "exact", *maxima.FINE).shape == (0, 4)
    report = kv.asymptotes(wedge)
    assert report.maxima == ()
    assert np.isnan([report.peak_velocity, report.peak_friction_coefficient]).all()
    assert "no friction maximum" in repr(report)


def test_a_fixed_indenter_has_a_maximum_for_each_of_two_distant_arms():
    """F18: with a finite glassy stiffness friction falls again at a given depth too."""
    for support in kv.Fixed(depth=3e-4), kv.DeadWeight(mass=1000.0):
        scene = kv.Scene(foundation=TWO_ARMS, support=support)
        report = kv.asymptotes(scene)
        assert len(report.maxima) == 2
        errors = report.maxima_certificate.relative_error
        agree(report.maxima, errors["maxima"], *scanned(scene, per_decade=400))
        names = "peak_velocity", "peak_friction_coefficient"
        assert tuple(getattr(report, name) for name in names) == report.maxima[0]
        assert tuple(errors[name] for name in names) == errors["maxima"][0]


@pytest.mark.parametrize("kind", SUPPORTS)
def test_ball_arithmetic_proves_a_maximum_within_the_errors(kind):
    support = kv.Scene.table1(kind).support
    report = kv.asymptotes(kv.Scene(foundation=TWO_ARMS, support=support))
    law = reference_viscoelastic.laws.Prony, (1e10, 1e-3, 1e10, 1.0), 0.01, 1e10, 1.001
    errors = report.maxima_certificate.relative_error["maxima"]
    assert len(errors) == 2
    for (velocity, top), (off, own) in zip(report.maxima, errors, strict=True):
        assert off < 2e-6
        assert own < 2e-13
        below, at, above = (
            reference_viscoelastic.at_depth(*law, v, support.depth)
            if support.depth is not None
            else reference_viscoelastic.at_load(*law, v, support.weight, support.spring)
            for v in velocity * np.array([1.0 / (1.0 + off), 1.0, 1.0 + off])
        )
        assert at["friction_coefficient"] > below["friction_coefficient"]
        assert at["friction_coefficient"] > above["friction_coefficient"]
        assert abs(at["friction_coefficient"] / top - 1) < own


def test_a_stiffer_suspension_moves_the_maximum_towards_that_of_a_fixed_indenter():
    scene = kv.Scene.table1("suspended")
    report = kv.asymptotes(scene, over={"support.stiffness": 10.0 ** np.arange(0.0, 19.0, 6.0)})
    assert report.peak_velocity[0] == pytest.approx(kv.asymptotes().peak_velocity, rel=1e-6)
    assert np.all(np.diff(report.peak_velocity[1:]) > 0.0)
    limit = 2 * np.sqrt(2) / 3 * np.sqrt(kv.steady(over={V: 0.0}).depth / 0.01)  # Eq. 45
    assert report.peak_friction_coefficient[-1] == pytest.approx(limit, rel=1e-5)
    assert report.peak_friction_coefficient[-1] < limit


def test_a_circle_has_the_maximum_of_a_parabola_where_it_is_shallow():
    circle, parabola = (
        kv.asymptotes(kv.Scene(shape, support=kv.DeadWeight(load=1e-3)))
        for shape in (kv.Circle(0.01), kv.Parabola(0.01))
    )
    assert circle.peak_velocity == pytest.approx(parabola.peak_velocity, rel=2e-6)
    report = kv.asymptotes(kv.Scene(kv.Circle(0.01)))
    speeds = report.peak_velocity * np.geomspace(1 / 1.1, 1.1, 41)
    mu = kv.steady(kv.Scene(kv.Circle(0.01)), over={V: speeds}).friction_coefficient
    assert mu.argmax() == 20
    assert mu.max() == pytest.approx(report.peak_friction_coefficient, rel=1e-13)


def test_a_wedge_on_an_arm_has_a_maximum_and_no_known_limits():
    scene = kv.Scene(kv.Wedge(0.1), kv.GeneralizedMaxwell(1e10, arms=[["30 GN/m^3", "10 ms"]]))
    report = kv.asymptotes(scene)
    ((velocity, top),) = report.maxima
    speeds = velocity * np.array([0.1, 0.5, 0.99, 1.0, 1.01, 2.0, 10.0])
    mu = kv.steady(scene, over={V: speeds}).friction_coefficient
    assert mu[3] == pytest.approx(top, rel=1e-12)
    assert np.all(np.diff(mu[:4]) > 0.0)
    assert np.all(np.diff(mu[3:]) < 0.0)
    assert report.lines == ()
    assert np.isnan(report.critical_velocity)
    assert report.notes[0] in repr(report)
    record = report.as_dict()
    assert record["regime"] is None
    assert record["critical_velocity"] is None
    assert record["maxima"] == [[velocity, top]]


def test_arrays_of_scenes_pad_the_shorter_lists():
    key, stiffness = "foundation.arms[1].stiffness", np.array([[1e6], [1e10]])
    scene = kv.Scene(foundation=TWO_ARMS)
    many = kv.asymptotes(scene, over={key: stiffness, V: [0.1, -1.0, 0.0]})
    for row, value in enumerate(stiffness[:, 0]):
        alone = kv.asymptotes(scene, over={key: value})
        assert len(alone.maxima) == 1 + row
        for (velocity, top), one in zip(many.maxima, alone.maxima, strict=False):
            assert velocity.shape == top.shape == (2, 3)
            assert np.all(velocity[row] == pytest.approx(one[0], rel=1e-6))
            assert np.all(top[row] == pytest.approx(one[1], rel=1e-13))
        assert many.peak_friction_coefficient[row] == pytest.approx(
            max(top for _, top in alone.maxima), rel=1e-13
        )
    assert np.isnan(many.maxima[1][0][0]).all()
    assert many.as_dict()["maxima"][1][0][0] == [None, None, None]
    for shape in kv.Parabola(0.01), kv.Circle(0.01):
        assert kv.asymptotes(kv.Scene(shape), over={"support.mass": []}).regime.shape == (0,)
