"""The equation of motion: against an independent solution, and by the laws that it must obey."""

import math

import numpy as np
import pytest

from kvtheory.models.continuum.run import STAGES, Spring, StepControl, radau
from kvtheory.models.continuum.solver import solve
from kvtheory.models.continuum.surface import height
from kvtheory.results.errors import TransientError
from kvtheory.scene.base_motion import BaseMotion
from tests.test_energy import END, HISTORIES, of

TABLE1 = 4.0812765306, 0.0030609574
"""lambda and eps of Table 1 under dead weight."""


def distance(motion, other, end, count=150):
    """Largest difference of depth and rate, the rate relative to 1 + |d'| as the tolerance is."""
    times = np.concatenate([np.linspace(0, end, count), end * np.geomspace(1e-7, 1e-2, count)])
    worst = 0.0
    for s in times:
        now, (d, v) = motion.at(s), other(s)
        worst = max(worst, abs(now.depth - d), abs(now.rate - v) / (1 + abs(v)))
    return worst


def test_steps_and_evaluations():
    """The error is proportional to the tolerance, so that the steps must shrink as its eighth root.

    Without inertia the evaluations do not grow.
    """
    number, eps = TABLE1
    given = BaseMotion.constant(number, 2.0)
    steps = [solve(given, eps, 0.0, 2.0, rtol).counts.steps for rtol in (1e-8, 1e-10, 1e-12)]
    assert np.array(steps[1:]) / steps[:-1] == pytest.approx(100 ** (1 / 8), rel=0.2)
    light = [solve(given, eps, 0.0, 2.0).counts.evaluations for eps in (1e-2, 1e-4, 1e-6, 1e-8)]
    assert max(light) <= 3 * light[0]


@pytest.mark.parametrize("stages", [count for _, count in STAGES])
def test_tableau_is_radau_iia(stages):
    """Stage order: each row integrates all powers below the number of stages; the last, 2 s - 2."""
    method = radau(stages)
    A, c = np.array(method.A), np.array(method.nodes)
    for k in range(stages):
        assert A @ c**k == pytest.approx(c ** (k + 1) / (k + 1), abs=1e-14)
    for k in range(2 * stages - 1):
        assert A[-1] @ c**k == pytest.approx(1 / (k + 1), abs=1e-14)
    assert A @ np.array(method.inverse) == pytest.approx(np.eye(stages), abs=1e-13)


@pytest.mark.parametrize(
    "name",
    ["stop", "stiff stop", "slow-down", "reversal", "there and back", "heavy", "hop", "hops"],
)
def test_motion_obeys_its_equation_and_converges(name):
    (_, eps, kappa), (_, motion), (_, better) = HISTORIES[name], of(name, 1e-9), of(name, 1e-11)
    assert distance(motion, lambda s: better.at(s)[1:3], END) <= 5e-9
    for s in np.random.default_rng(1).uniform(0, END, 40):
        now = better.at(s)
        balance = 1 - now.normal_force - kappa * (now.depth - 1)
        terms = 1 + abs(eps * now.acceleration)
        assert abs(eps * now.acceleration - balance) <= 3e-7 * max(terms, eps), s


def test_heights_of_hops_are_ballistic():
    points, eps, _ = HISTORIES["hop"]
    motion = solve(BaseMotion.from_points(points, 2.0), eps, 0.0, 2.0)
    times = {event.kind: event.s for event in motion.events}
    start = motion.at(times["take-off"])
    for s in np.linspace(times["take-off"], times["landing"], 5)[:-1]:
        t = s - start.s
        now = motion.at(s)
        assert now.depth == pytest.approx(
            start.depth + start.rate * t + t * t / (2 * eps), abs=1e-12
        )
        assert now.left_state == "free"
        assert now.normal_force == 0.0


def test_at_rest_nothing_happens():
    motion = solve(BaseMotion.from_points([(0, 0), (1, 0), (1, 4)], 1.5), 0.04, 0.0, 1.5)
    assert motion.events[0].s == 1.0
    assert motion.at(0.5)[1:4] == pytest.approx((1, 0, 0), abs=1e-14)
    assert motion.at(0.5).normal_force == pytest.approx(1, abs=1e-14)


def test_cost_grows_in_proportion_to_the_events_of_the_memory():
    def cycles(count):
        points = [(0, 4)]
        for k in range(count):
            points += [(k + 0.4, 4), (k + 0.4, -2), (k + 1, -2), (k + 1, 4)]
        motion = solve(BaseMotion.from_points(points, count), 0.04, 0.0, float(count))
        begun = sum(event.kind.startswith("memory begins") for event in motion.events)
        return motion.counts.evaluations, begun

    few, many = cycles(20), cycles(40)
    assert many[1] == pytest.approx(2 * few[1], rel=0.1)
    assert many[0] <= 2.2 * few[0]


def test_memory_begins_where_an_edge_goes_back_and_ends_where_it_leaves():
    motion = solve(BaseMotion.from_points([(0, 4), (0.5, 4), (0.5, -4)], 1.5), 0.04, 0.5, 1.5)
    memory = [(event.kind, event.s) for event in motion.events if "memory" in event.kind]
    kinds = [kind for kind, _ in memory]
    assert kinds == ["memory begins at the right edge", "memory ends at the right edge"]
    begun, ended = (s for _, s in memory)
    assert motion.at(begun - 1e-9).right_state == "peeling"
    assert motion.at(0.5 * (begun + ended)).right_state == "touching"


@pytest.mark.parametrize(
    "change",
    [{"end": 0.0}, {"end": 3.0}, {"inertia_number": 0.0}, {"support_number": -1.0}, {"rtol": 0.0},
     {"spring": Spring(0.0, 0.0, 1.0)}, {"spring": Spring(1.0, -1.0, 1.0)}],
)  # fmt: skip
def test_what_makes_no_sense_is_refused(change):
    arguments = {"inertia_number": 0.04, "support_number": 0.0, "end": 2.0} | change
    with pytest.raises(ValueError, match="`"):
        solve(BaseMotion.constant(1.0, 2.0), **arguments)


def test_a_drive_of_too_many_steps_ends_in_an_error():
    with pytest.raises(TransientError, match=r"more than 10 steps.* at s = 0\.\d+"):
        solve(BaseMotion.constant(4.0, 2.0), 0.04, 0.0, 2.0, max_steps=10)


def triangle(levels, quarter, end):
    """Return a drive from rest through the levels, one after each `quarter`."""
    points = [(0.0, 0.0), *((quarter * (k + 1), level) for k, level in enumerate(levels))]
    return BaseMotion.from_points(points, end)


def test_a_touch_in_flight_is_seen_however_fast_the_ground_becomes_within_a_step():
    """At the start of a step of a flight the drive may just turn; the touch is brief."""
    drive = triangle([6994.3463, -2098.3039, 6994.3463, -6994.3463], 0.03464932670844973, 0.13)
    for control in (StepControl(), StepControl(first_step=0.07, longest=0.02, grow=3.0)):
        hops = [
            event.kind
            for event in solve(drive, 10.02245639, 0.0, 0.13, 1e-8, control=control).events
            if event.kind in ("take-off", "landing")
        ]
        assert hops == ["take-off", "landing", "take-off"]


def test_ground_that_was_left_just_now_is_found():
    """Newton's method alone goes round there, so that an edge had no place."""
    level, quarter, end = 0.009654823105660083, 0.0641212712494557, 1.6030317812363926
    drive = triangle([level * (-1) ** (k + 1) for k in range(25)], quarter, end)
    motion = solve(drive, 0.26558088605703467, 0.0, end, 1e-8)
    after = [start + np.geomspace(1e-9, 1e-4, 40) for start in motion.starts]
    times = np.append(np.concatenate(after), 1.3465473545522675)
    found = motion.states(times[times < end])
    for name in found.dtype.names:
        assert np.all(np.isfinite(found[name])), name


def edges_by_f8(number, way, s):
    """Edges of a fixed indenter: each past instant confines the contact (F8), the present one by p >= 0."""
    past = np.unique(
        np.concatenate([np.linspace(0, s, 20001), s - s * np.geomspace(1e-4, 1, 2000)])
    )
    past = past[past < s * (1 - 1e-5)]
    m = -np.expm1(past - s)
    shift = way(s) - way(past)
    b, c = (1 - m) / m * shift, 1 + (1 - m) / m * shift**2
    b, c = np.append(b, number(s)), np.append(c, 1.0)
    root = np.sqrt(b * b + c)
    return max(-1.0, (-b - root).max()), min(1.0, (root - b).min())


@pytest.mark.parametrize(
    ("w", "mean"), [(3.6, -0.999), (3.6, 1.2819), (1.5, 1.1578), (1.5, 1.16378)]
)
def test_a_momentary_reversal_is_not_missed(w, mean):
    """V reverses for a moment, or slows down so that a peeling edge touches for a moment."""
    size = 3.0

    def number(s):
        return size * (np.sin(w * s) + mean)

    def way(s):
        return size * (2 * np.sin(0.5 * w * s) ** 2 / w + mean * s)

    end = 8.0 / w
    motion = solve(BaseMotion.from_function(number, end), 1.0, math.inf, end)
    for s in np.linspace(0.05, 0.99, 60) * end:
        now = motion.at(s)
        assert (now.left, now.right) == pytest.approx(edges_by_f8(number, way, s), abs=1e-7)


def test_it_lands_where_the_gap_is_zero():
    """Also after a flight so low that the gap closes slowly: the surface is evaluated just before."""
    number = 28.5
    motion = solve(BaseMotion.constant(number, 1.0), 0.0088, 0.0, 1.0)
    landings = [event.s for event in motion.events if event.kind == "landing"]
    assert landings
    for s in landings:
        X = motion.at(s).left - number * s
        before = s - 1e-5 * np.arange(1, 4)
        margins = []
        for t in before:
            xi = X + number * t
            margins.append(motion.at(t).depth - xi * xi - height(motion, [xi], t)[0])
        assert abs(np.dot([3.0, -3.0, 1.0], margins)) < 1e-13  # extrapolated to the landing
