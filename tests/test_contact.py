"""The edges and their memory against what every past instant says, one by one."""

import math

import numpy as np
import pytest

import kvtheory as kv
from kvtheory.models.continuum import contact
from kvtheory.models.continuum.memory_chains import margin
from kvtheory.models.continuum.solver import solve
from kvtheory.models.continuum.surface import height, integrals
from kvtheory.scene.base_motion import BaseMotion
from tests.test_energy import END, drive_of, of

FIXED = math.inf


def ends_of_intervals(motion, given, s, sigma):
    """The intervals to which the instants `sigma` confine the contact at `s` (theorem F9)."""
    now = motion.at(s)
    Y, _, _ = given.at(s)
    d_0 = motion.states(sigma)["depth"]
    shift = Y - np.array([given.displacement(t) for t in sigma])
    q, m = np.exp(sigma - s), -np.expm1(sigma - s)
    b, c = q * shift / m, now.depth + q * (now.depth - d_0 + shift**2) / m
    half = np.sqrt(np.maximum(b * b + c, 0.0))
    return -b - half, -b + half


def edges_by_search(motion, given, s):
    """The intersection of all those intervals: a search on all the past, refined where it binds."""
    now = motion.at(s)
    number = given.at(s)[1]
    peel = math.sqrt(now.depth + now.rate + number * number)
    rest = math.sqrt(now.depth)
    left, right = max(-number - peel, -rest), min(-number + peel, rest)
    sigma = np.unique(np.concatenate([np.linspace(0, s, 800), s - s * np.geomspace(1e-5, 1, 400)]))
    sigma = sigma[(sigma >= 0) & (sigma < s * (1 - 1e-6))]
    for _ in range(5):
        lower, upper = ends_of_intervals(motion, given, s, sigma)
        left, right = max(left, lower.max()), min(right, upper.min())
        binding = {int(lower.argmax()), int(upper.argmin())}
        brackets = [(sigma[max(k - 1, 0)], sigma[min(k + 1, sigma.size - 1)]) for k in binding]
        sigma = np.unique([np.linspace(*bracket, 101) for bracket in brackets])
    return left, right


PAST = (
    "start", "stop", "slow-down", "there and back", "reversal", "stop-and-go", "oscillation, kappa 0.0"
)  # fmt: skip


@pytest.mark.parametrize("name", PAST)
@pytest.mark.parametrize(("eps", "kappa"), [(1.0, FIXED), (0.04, 0.0), (1.0, 0.5)])
def test_edges_are_the_intersection_of_all_past_instants(name, eps, kappa):
    given = drive_of(name)
    motion = solve(given, eps, kappa, END)
    for s in np.random.default_rng(9).uniform(0.01, END, 4):
        now = motion.at(s)
        if now.left_state == "free":
            continue
        assert (now.left, now.right) == pytest.approx(
            edges_by_search(motion, given, s), abs=2e-9
        ), s


@pytest.mark.parametrize(
    ("points", "eps", "kappa"),
    [
        ([(0, 7.1)], 0.078, 0.12),
        # lands where two strips meet, which a jump each left: the gap is least at a kink of the ground
        ([(0, -8.47), (0.179, -8.47), (0.179, 12.02)], 0.17, 0.0),
    ],
)
def test_flight_stays_above_all_that_was_left_and_ends_where_it_meets_that(points, eps, kappa):
    given = BaseMotion.from_points(points, END)
    motion = solve(given, eps, kappa, END)
    hops = [event.s for event in motion.events if event.kind in ("take-off", "landing")]
    sigma = np.unique([*np.linspace(0.0, hops[0], 401), *(s for s, _ in points)])
    sigma = sigma[sigma <= hops[0]]
    d, Y_0 = motion.states(sigma)["depth"][:, None], np.array([given.at(s)[:1] for s in sigma])
    for s in np.linspace(*hops[:2], 5)[1:]:
        Y, X, width = given.at(s)[0], -given.at(s)[0], 1.2
        for _ in range(4):
            X = X + np.linspace(-width, width, 201)
            highest = np.max(np.exp(sigma - s)[:, None] * (d - (X + Y_0) ** 2), axis=0)
            gaps = np.maximum(highest, 0.0) - (motion.at(s).depth - (X + Y) ** 2)
            X, width = X[np.argmin(gaps)], width / 50
        assert np.min(gaps) == pytest.approx(0.0, abs=1e-5) if s == hops[1] else np.min(gaps) > 0.0


def test_an_edge_at_rest_on_ground_left_by_a_jump_follows_the_quadratic():
    """After a stop the right edge meets the strip that the start detached, at d = 1."""
    motion = solve(BaseMotion.from_points([(0, 4), (0.1, 4), (0.1, 0)], END), 1.0, FIXED, END)
    s, Y = 1.0, 0.4
    q = math.exp(-s)
    # g(X, s) = e^-s g(X, 0) with xi = X + Y
    expected = (-q * Y + math.sqrt(q * q * Y * Y + (1 - q) * (1 - q + q * Y * Y))) / (1 - q)
    assert motion.at(s).right == pytest.approx(expected, abs=1e-13)
    X = expected - Y
    assert margin(X, s, 1.0, Y, 0.0, 1.0, 0.0) == pytest.approx(0.0, abs=1e-14)


def test_root_keeps_all_digits_where_the_formula_of_the_paper_cancels():
    assert contact.root(1.0, 1e9, 1.0)[0] == pytest.approx(5e-10, rel=1e-15)
    assert contact.root(-1.0, -1e9, 1.0)[0] == pytest.approx(-5e-10, rel=1e-15)


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
        d = motion.states(flat)["depth"].reshape(sigma.shape)
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
