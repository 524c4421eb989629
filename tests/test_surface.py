"""The free surface against every instant of the past, and its integrals."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

import kvtheory as kv
from kvtheory.models.continuum.evaluation import DEPTH
from kvtheory.models.continuum.solver import solve
from kvtheory.models.continuum.surface import height, integrals, volume
from kvtheory.scene.base_motion import BaseMotion
from tests.test_energy import END, of

NAMES = "start", "stop", "reversal", "suspended", "there and back", "hop", "fixed reversal"


@pytest.fixture(scope="module", params=NAMES)
def solved(request):
    given, motion = of(request.param)
    return given, motion


def highest(motion, given, xi, s):
    """Fact F8: max(0, largest e^(sigma - s) g(X, sigma)) over the past, each maximum refined."""
    X = np.asarray(xi) - given.at(s)[0]

    def left(sigma):
        flat = sigma.reshape(-1)
        d = motion.states(flat)[:, DEPTH].reshape(sigma.shape)
        Y = np.array([given.displacement(t) for t in flat]).reshape(sigma.shape)
        return np.exp(sigma - s) * (d - (X + Y) ** 2)

    jumps = [t for t in motion.starts if t <= s]
    past = [np.clip(t + np.geomspace(1e-7, END, 60), 0.0, s) for t in {*jumps[:1], 0.3, 0.5, 0.6}]
    sigma = np.unique(np.concatenate([np.linspace(0, s, 500), jumps, *past]))[:, None]
    top = np.zeros(X.shape)
    for _ in range(4):
        values = left(sigma)
        best = values.argmax(axis=0)
        sigma = np.broadcast_to(sigma, values.shape)
        low, high = (
            np.take_along_axis(sigma, np.clip(best + step, 0, len(sigma) - 1)[None], axis=0)
            for step in (-1, 1)
        )
        top = np.maximum(top, values.max(axis=0))  # it may be at a jump
        sigma = low + (high - low) * np.linspace(0, 1, 25)[:, None]
    return top


@pytest.mark.parametrize("s", [0.07, 0.55, 1.9])
def test_height_is_the_highest_of_all_past_instants(solved, s):
    given, motion = solved
    xi = np.random.default_rng(3).uniform(-4, 6, 40)
    assert height(motion, xi, s) == pytest.approx(highest(motion, given, xi, s), abs=1e-9)


@pytest.mark.parametrize("s", [0.3, 0.55, 1.37])
def test_height_integrates_to_the_volume(solved, s):
    _, motion = solved
    xi = np.linspace(-12, 14, 100_001)
    u = height(motion, xi, s)
    assert u.min() >= -1e-12
    assert np.trapezoid(u, xi) == pytest.approx(volume(motion, s), abs=2e-7)


@pytest.mark.parametrize("slope", [3.0, 300.0, 30_000.0])
def test_volume_behind_a_fixed_indenter_on_a_ramp(slope):
    """Fact F14, U = (4/3) (e^-s + int e^(t - s) f_z dt), with f_z and both edges in closed form."""

    def f_z(t):
        number = slope * t
        r = 1 / (number + math.sqrt(1 + number * number))
        return 0.75 * ((1 + r) - (1 + r**3) / 3 + number * (1 - r * r))

    motion = solve(
        BaseMotion.from_points([(0, 0), (END, slope * END)], END), 1.0, math.inf, END, 1e-10
    )
    for s in (1e-3, 0.2, 0.7, END):
        gained, _ = quad(
            lambda t: math.exp(t - s) * f_z(t),  # noqa: B023
            *(0, s), epsabs=0, epsrel=1e-13, limit=200, points=[min(1 / slope, 0.5 * s)],
        )  # fmt: skip
        assert volume(motion, s) == pytest.approx(4 / 3 * (math.exp(-s) + gained), rel=1e-12)


def test_integrals_adapt_to_each_function():
    """1/((s - c)^2 + w^2) with a peak much narrower than a panel, and ends like square roots."""
    w, c = np.array([1.0, 1e-2, 1e-4]), np.array([0.3, 1 / 3, 0.9])
    high = np.array([1.0, 2.0, 3.0])
    found = integrals(
        lambda k, s: np.stack(
            [(w / math.pi)[k, None] / ((s - c[k, None]) ** 2 + w[k, None] ** 2), np.sqrt(s)], -1
        ),
        0.0 * high,
        high,
    )
    peaks = (np.arctan((high - c) / w) + np.arctan(c / w)) / math.pi
    assert found[:, 0] == pytest.approx(peaks, rel=1e-11)
    assert found[:, 1] == pytest.approx(2 / 3 * high**1.5, rel=1e-13)


def test_an_integral_that_does_not_exist_is_an_error():
    for function in (lambda _, s: s * math.nan, lambda _, s: np.sign(np.sin(1e9 * s))):
        with pytest.raises(ArithmeticError, match="panels"):
            integrals(function, np.zeros(3), np.ones(3))


def test_surface_is_continuous_at_the_edges(solved):
    _, motion = solved
    for s in (0.0, 0.31, 0.5, 1.1, 2.0):
        now = motion.at(s)
        if now.left_state == "free":
            continue
        for edge in (now.left, now.right):
            for side in (-1e-12, 0.0, 1e-12):
                u = height(motion, edge + side, s)
                assert u == pytest.approx(now.depth - edge * edge, abs=1e-10)


def test_under_a_flying_indenter_the_surface_relaxes():
    _, motion = of("hop")
    times = {event.kind: event.s for event in motion.events}
    a, b = times["take-off"] + 0.01, times["landing"] - 0.01
    slide = 7.1 * (b - a)
    xi = np.linspace(-1.0, 3.0, 60)
    before, after = height(motion, xi, a), height(motion, xi + slide, b)
    assert before.max() > 0.1
    assert after == pytest.approx(math.exp(a - b) * before, abs=1e-12)


def test_surface_in_metres():
    result = kv.transient(at=[0.05], rtol=1e-9)
    x = np.linspace(result.leading_edge[0], result.trailing_edge[0], 7)
    assert result.surface(x, 0.05) == pytest.approx(result.depth[0] - x**2 / 0.02, abs=1e-12)
    ahead = result.surface(result.leading_edge[0] - 1e-3, 0.05)
    assert ahead == 0.0
    for time in (-1e-3, 0.3, math.nan):
        with pytest.raises(ValueError, match="`time`"):
            result.surface(0.0, time)
