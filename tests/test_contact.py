"""The edges and their memory against what every past instant says, one by one."""

import math

import numpy as np
import pytest

from kvtheory.models.continuum import contact
from kvtheory.models.continuum.evaluation import DEPTH
from kvtheory.models.continuum.memory_chains import margin
from kvtheory.models.continuum.solver import solve
from kvtheory.scene.base_motion import BaseMotion

FIXED = math.inf

HISTORIES = {
    "start": [(0, 4)],
    "stop": [(0, 4), (0.5, 4), (0.5, 0)],
    "slow-down": [(0, 4), (0.5, 4), (0.5, 1)],
    "ramps": [(0, 0), (0.5, 4), (1.5, -4), (2.0, 3)],
    "reversal": [(0, 4), (0.5, 4), (0.5, -4)],
    "stop-and-go": [(0, 4), (0.3, 4), (0.3, 0), (0.6, 0), (0.6, 4), (0.9, 4), (0.9, 0.5)],
}
SINES = {
    "oscillation": lambda s: 2 * math.sin(5 * s),
    "two frequencies": lambda s: 2 * math.sin(5 * s) + 1.5 * math.sin(13.7 * s),
}
END = 2.0


def drive(name):
    if name in HISTORIES:
        return BaseMotion.from_points(HISTORIES[name], END)
    return BaseMotion.from_function(SINES[name], END)


def ends_of_intervals(motion, given, s, sigma):
    """The intervals to which the instants `sigma` confine the contact at `s` (theorem F9)."""
    now = motion.at(s)
    Y, _, _ = given.at(s)
    d_0 = motion.states(sigma)[:, DEPTH]
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


@pytest.mark.parametrize("name", [*HISTORIES, *SINES])
@pytest.mark.parametrize(("eps", "kappa"), [(1.0, FIXED), (0.04, 0.0), (1.0, 0.5)])
def test_edges_are_the_intersection_of_all_past_instants(name, eps, kappa):
    given = drive(name)
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
    d, Y_0 = motion.states(sigma)[:, DEPTH, None], np.array([given.at(s)[:1] for s in sigma])
    for s in np.linspace(*hops[:2], 5)[1:]:
        Y, X, width = given.at(s)[0], -given.at(s)[0], 1.2
        for _ in range(4):
            X = X + np.linspace(-width, width, 201)
            highest = np.max(np.exp(sigma - s)[:, None] * (d - (X + Y_0) ** 2), axis=0)
            gaps = np.maximum(highest, 0.0) - (motion.at(s).depth - (X + Y) ** 2)
            X, width = X[np.argmin(gaps)], width / 50
        assert np.min(gaps) == pytest.approx(0.0, abs=1e-5) if s == hops[1] else np.min(gaps) > 0.0


def test_fixed_indenter_has_the_edges_of_the_paper():
    for number in (1e-4, 1.0, 1e4):
        now = solve(BaseMotion.constant(number, 1.0), 1.0, FIXED, 1.0).at(0.7)
        assert now.left == pytest.approx(-1.0, rel=1e-14)
        assert now.right == pytest.approx(1 / (math.sqrt(1 + number * number) + number), rel=1e-13)
        assert (now.left_state, now.right_state) == ("touching", "peeling")


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
