"""The derivations of scaled form, memory and edges, against quadrature, roots and elements."""

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations import transient_edges, transient_motion
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.step import Proof, StepError
from kvtheory.derivations.transient_scaling import LEADING, PRESSURE, SECTION, TRAILING

pytestmark = pytest.mark.usefixtures("fifty_digits")

DIGITS = 50
CLOSE = mp.mpf("1e-40")


def value(expr, point):
    """Evaluate an expression with 50 digits."""
    exact = {symbol: sp.Float(str(number), DIGITS + 10) for symbol, number in point.items()}
    return mp.mpf(str(sp.N(sp.sympify(expr).subs(exact), DIGITS)))


def close(one, other, scale=1):
    return abs(one - other) <= CLOSE * max(abs(one), abs(other), scale)


def test_all_facts_are_there_and_none_is_sampled(by_label):
    own = [each for each in catalogue() if each.section.startswith("Transient")]
    assert own[0].section == SECTION
    groups = {"eq33", "scaled", "F8", "F9", "F10", "F11", "F12", "F13", "F14"}
    assert {each.label.split("-")[0] for each in own} == groups
    assert all(step.status != "sampled" for each in own for step in each.steps)
    assert by_label["eq33"].status == by_label["scaled-form"].status == "proved"


# The scaled form and Eq. 33

SCENE = {s.R: "0.013", s.K: "2.1e9", s.tau: "0.17", s.V: "0.021", s.M: "730"}
DEPTH, RATE, STATIC = mp.mpf("1.9e-4"), mp.mpf("-3.1e-4"), mp.mpf("2.7e-4")


class Dimensional:
    """Pressure and forces of the contact in SI units, from Eqs. 3, 6 and 7 alone."""

    def __init__(self):
        self.R, self.K, self.tau, self.V, self.M = (mp.mpf(number) for number in SCENE.values())

    def pressure(self, x):
        u, rate = DEPTH - x**2 / (2 * self.R), RATE - x / self.R * self.V
        return self.K * (u + self.tau * rate)

    def edges(self):
        peak = -self.V * self.tau
        width = mp.sqrt(2 * self.R * DEPTH)
        ends = ((peak - width, peak), (peak, peak + width))
        return [mp.findroot(self.pressure, end, solver="anderson", tol=1e-70) for end in ends]


def test_both_roots_of_equation_33():
    scene = Dimensional()
    point = {
        s.a: mp.sqrt(2 * scene.R * DEPTH), s.tau: scene.tau, s.l_r: scene.V * scene.tau,
    }  # fmt: skip
    named = {s.delta_t.diff(s.t): s.d_s, s.delta_t: s.d}
    point |= {s.d: DEPTH, s.d_s: RATE}
    for found, expr in zip(scene.edges(), (LEADING, TRAILING), strict=True):
        assert close(found, value(expr.subs(named), point), mp.mpf("1e-3"))


def test_scaled_forces_are_the_dimensional_ones():
    scene = Dimensional()
    leading, trailing = scene.edges()
    a_0 = mp.sqrt(2 * scene.R * STATIC)
    w_0 = mp.mpf(4) / 3 * scene.K * a_0 * STATIC
    point = {
        s.d: DEPTH / STATIC, s.d_s: scene.tau * RATE / STATIC, s.lam: scene.V * scene.tau / a_0,
        s.left: leading / a_0, s.right: trailing / a_0,
    }  # fmt: skip
    load = mp.quad(scene.pressure, [leading, trailing])
    friction = mp.quad(lambda x: -x / scene.R * scene.pressure(x), [leading, trailing])
    assert close(load / w_0, value(transient_motion.NORMAL_FORCE, point))
    scaled = friction / (w_0 * STATIC / a_0)
    assert close(scaled, value(transient_motion.FRICTION_FORCE, point))


# Memory


def element(g, steps, duration):
    """Integrate u' + u = p, p >= 0 where u = g and 0 where u > g, by the implicit Euler method."""
    step = duration / steps
    u = max(g(0.0), 0.0)
    for i in range(1, steps + 1):
        u = max(g(i * step), u / (1 + step))
    return u


@pytest.mark.parametrize("phase", [0.3, 1.9, 4.0])
def test_memory_is_a_running_maximum(phase):
    def g(time):
        return 0.4 + np.sin(3 * time + phase) - 0.3 * time

    duration = 2.7
    instants = np.linspace(0, duration, 400_001)
    exact = np.exp(-duration) * max(0.0, np.max(np.exp(instants) * g(instants)))
    errors = [element(g, steps, duration) - exact for steps in (2000, 4000, 8000)]
    extrapolated = exact + 2 * errors[2] - errors[1]
    assert extrapolated == pytest.approx(exact, rel=1e-5)


def test_update_fails_only_where_the_pressure_changes_from_plus_to_minus():
    """Steps with a peak inside are too low by at most h**2/8 max |p + p'|; the others are exact."""
    seen = {True: 0, False: 0}
    for start in np.linspace(0, 6, 61):
        h = 0.37
        inside = np.linspace(start, start + h, 20_001)
        g, slope, bend = np.sin(inside), np.cos(inside), -np.sin(inside)
        pressure = g + slope
        exact = np.max(np.exp(inside - start - h) * g)
        missing = exact - max(g[-1], np.exp(-h) * g[0])
        peak = pressure[0] > 0 > pressure[-1]
        seen[peak] += 1
        bound = h**2 / 8 * np.max(np.abs(pressure + slope + bend)) if peak else 1e-15
        assert missing <= bound
        assert (missing > 0) == peak
    assert min(seen.values()) > 3


@pytest.mark.parametrize("seed", range(5))
def test_contact_is_one_interval_and_the_gap_is_concave(seed):
    draw = np.random.default_rng(seed)
    instants = np.linspace(0, 3, 601)
    waves = draw.normal(size=(2, 4)) @ np.sin(np.outer(draw.uniform(1, 9, 4), instants))
    d, travel = 1 + 0.3 * waves[0] - 0.3 * waves[0, 0], waves[1]
    X = np.linspace(-6, 6, 4001)
    history = np.exp(instants)[:, None] * (d[:, None] - (X + travel[:, None]) ** 2)
    history[0] = np.maximum(history[0], 0)
    for now in (40, 200, 401, 600):
        gap = history[now] - history[:now].max(axis=0)
        assert np.all(np.diff(gap, 2) <= 1e-9)
        touching = np.flatnonzero(gap >= 0)
        assert touching.size == 0 or np.ptp(touching) == touching.size - 1
    gap = history[600] - np.maximum.reduce(history[:300])
    assert np.all(np.diff(gap, 2) < -(np.exp(3) - np.exp(instants[299])) * (X[1] - X[0]) ** 2)


# Edges


class Slowing:
    """A fixed indenter, d = 1, over a foundation that moves with lambda = 2 - 3 s."""

    def drive(self, time):
        return 2 - 3 * time

    def travel(self, time):
        return 2 * time - mp.mpf(3) / 2 * time**2

    def peel(self, time):
        """Return the element at which the right edge peels."""
        drive = self.drive(time)
        return -drive + mp.sqrt(1 + drive**2) - self.travel(time)

    def turn(self):
        return mp.findroot(lambda time: mp.diff(self.peel, time), 0.7)

    def g(self, element, time):
        return 1 - (element + self.travel(time)) ** 2

    def left_at(self, now):
        """Return when the ground that the right edge touches now was left."""
        turn = self.turn()

        def meeting(then):
            element = self.peel(then)
            here, before = (mp.exp(time) * self.g(element, time) for time in (now, then))
            return (here - before) / (now - then) ** 2

        return mp.findroot(meeting, turn - (now - turn) / 2)


def test_the_turn_is_a_leading_order_and_says_so(by_label):
    assert by_label["F10-turn"].status == "proved-leading-order"
    assert by_label["F10-instant-limits"].status == "proved-leading-order"


def test_an_edge_turns_onto_ground_that_it_left_half_as_long_ago():
    slowing = Slowing()
    turn = slowing.turn()
    curvature = mp.diff(slowing.peel, turn, 2)
    deviations = []
    for h in (mp.mpf("1e-3"), mp.mpf("1e-4")):
        then = slowing.left_at(turn + h)
        deviations.append((then - turn) / h + mp.mpf(1) / 2)
        moved = slowing.peel(then) - slowing.peel(turn)
        assert float(moved / (curvature * h**2 / 2)) == pytest.approx(0.25, rel=5 * float(h))
    assert float(deviations[0] / deviations[1]) == pytest.approx(10, rel=0.01)


def test_pressure_at_an_edge_that_touches_is_its_velocity():
    slowing = Slowing()
    now = slowing.turn() + mp.mpf("0.1")
    edge, then = slowing.peel(slowing.left_at(now)), slowing.left_at(now)
    speed = mp.diff(lambda time: slowing.peel(slowing.left_at(time)), now)
    xi, eta = edge + slowing.travel(now), edge + slowing.travel(then)
    point = {s.d: 1, s.d_s: 0, s.lam: slowing.drive(now), s.xi: xi}
    pressure = value(PRESSURE, point)
    velocity = sp.Derivative(transient_edges.edge_path, s.time)
    named = transient_edges.TOUCHING_PRESSURE.subs(velocity, s.d_s)
    found = value(named, {s.xi: xi, s.eta: eta, s.E: mp.exp(then - now), s.d_s: speed})
    assert pressure > 0
    assert abs(found - pressure) < mp.mpf("1e-20")


@pytest.mark.parametrize("moved", ["0.7", "-0.4"])
def test_edges_on_ground_that_was_left_at_once(moved):
    d, before, moved = mp.mpf("0.83"), mp.mpf("0.91"), mp.mpf(moved)
    decay = mp.exp(mp.mpf("-0.6"))
    known = {
        s.E: decay, s.drift: moved / (1 - decay), s.lift: (d - decay * before) / (1 - decay),
    }  # fmt: skip
    for expr in (transient_edges.LEFT_AT_ONCE, transient_edges.RIGHT_AT_ONCE):
        xi = value(expr, known)
        assert abs(d - xi**2 - decay * (before - (xi - moved) ** 2)) < CLOSE
    soon = mp.mpf("1e-20")
    drive, rate = mp.mpf("1.3"), mp.mpf("-0.4")
    known = {
        s.E: mp.exp(-soon), s.drift: drive * soon / -mp.expm1(-soon),
        s.lift: (d + rate * soon - mp.exp(-soon) * d) / -mp.expm1(-soon),
    }  # fmt: skip
    peel = -drive + mp.sqrt(d + rate + drive**2)
    assert abs(value(transient_edges.RIGHT_AT_ONCE, known) - peel) < 10 * soon


@pytest.mark.parametrize(("kind", "right"), [(sp.Max, True), (sp.Min, False)])
def test_the_update_holds_with_max_and_not_with_min(kind, right):
    """F8-update anew, in other letters: free until the end of the step, or in contact there."""
    h, decay = sp.Symbol("h", positive=True), sp.exp(-sp.Symbol("h", positive=True))
    before, after, now = sp.symbols("u_0 u_1 g_1", real=True)
    clearance, impulse = sp.symbols("c_1 J_1", nonnegative=True)
    proof = Proof("planted-update", None, section="Test", title="Test")
    proof.define(now, after - clearance)
    proof.define(before, sp.exp(h) * (after - decay * impulse))
    cases = sp.Eq(impulse, 0), sp.Eq(clearance, 0)
    if right:
        proof.equal(after, kind(decay * before, now), "update", cases=cases)
    else:
        with pytest.raises(StepError):
            proof.equal(after, kind(decay * before, now), "update", cases=cases)
