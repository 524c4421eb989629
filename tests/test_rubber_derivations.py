"""Derivations F23, F26 and F27: the proved expressions against numbers of other programs."""

from bisect import bisect_left
from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import few_arms, rubber_transient, viscoelastic
from scipy.optimize import brentq, minimize_scalar

import kvtheory as kv

K, R, M, V, ARM, TIME, GRAVITY = 10e9, 0.01, 1000.0, 0.05, 50e9, 0.1, 9.80665
WEIGHT = M * GRAVITY
STILL = (3 * WEIGHT / (4 * K * np.sqrt(2 * R))) ** (2 / 3)


def _numeric(names, *expressions):
    """Return the proved expressions as functions of plain numbers, rates and functions named."""
    plain = {name: sp.Symbol(f"n_{i}") for i, name in enumerate(names)}
    ordered = sorted(plain, key=lambda each: -sp.count_ops(each))
    forms = [form.subs([(each, plain[each]) for each in ordered]) for form in expressions]
    scene = {s.K_i: ARM, s.tau_i: TIME, s.R: R, s.K: K}
    return sp.lambdify(list(plain.values()), [form.subs(scene) for form in forms], "math")


_sinks, _edge = s.delta_t.diff(s.t), s.te_t(s.t)
ACCUMULATE = _numeric(
    (_sinks, s.v_t, s.Y_t, s.alpha_i(s.t), s.beta_i(s.t)), *rubber_transient.ACCUMULATE.values()
)
STRESS = _numeric(
    (s.xi, s.alpha_i(s.t_1), s.beta_i(s.t_1), s.alpha_i(s.t_in), s.beta_i(s.t_in), s.E_i),
    rubber_transient.STRESS,
)
SLOPE = _numeric((s.beta_i(s.t_1), s.beta_i(s.t_in), s.E_i, s.le_t(s.t_in)), rubber_transient.SLOPE)
MOMENTS = _numeric(
    (_sinks, s.v_t, s.S_i, s.T_i, *s.I_n, _edge.diff(s.t), s.stress_i(_edge - s.Y_t, s.t), _edge),
    *rubber_transient.MOMENTS.values(),
)


class Slide:
    """Sliding from rest on a spring and one arm, by the equations of F23 and a Runge-Kutta method."""

    def __init__(self, step):
        """Take the length of a step."""
        self.step, self.path = step, [(0.0, np.array([STILL, 0, 0, 0, 0, 0]), np.zeros(6))]
        self.kinked = False

    def past(self, time):
        """Return depth and accumulators at a time in the past, by cubic interpolation."""
        at = min(max(bisect_left(self.path, time, key=lambda each: each[0]), 1), len(self.path) - 1)
        (one, u, up), (two, v, vp) = self.path[at - 1 : at + 1]
        h, w = two - one, (time - one) / (two - one)
        bend = (1 - 2 * w) * (v - u) + h * ((w - 1) * up + w * vp)
        return (1 - w) * u + w * v + w * (w - 1) * bend

    def entry(self, element):
        """Return when an element entered, and the leading edge and the accumulators then."""
        if element >= -np.sqrt(2 * R * STILL):
            return 0.0, -np.sqrt(2 * R * STILL), 0.0, 0.0
        low, high = 0.0, self.path[-1][0]
        for _ in range(60):
            middle = (low + high) / 2
            depth, _, alpha, beta, *_ = self.past(middle)
            edge = -np.sqrt(2 * R * depth)
            low, high = (middle, high) if edge - V * middle > element else (low, middle)
        return middle, edge, alpha, beta

    def stress(self, time, x, state):
        """Return the stress of the arm at x, its slope over the elements, and whether the element entered."""
        when, edge, alpha, beta = self.entry(x - V * time)
        left = np.exp(-(time - when) / TIME)
        (found,) = STRESS(x - V * time, state[2], state[3], alpha, beta, left)
        return found, SLOPE(state[3], beta, left, edge if when else 0.0)[0], when > 0

    def trailing(self, time, state):
        """Return the zero of the pressure by Newton's method, with stress and slope of the pressure there."""
        x = np.sqrt(2 * R * state[0]) if time == 0 else self.edge
        for _ in range(30):
            stress, slope, entered = self.stress(time, x, state)
            pressure, slope = K * (state[0] - x**2 / (2 * R)) + stress, slope - K * x / R
            x -= pressure / slope
            if abs(pressure / slope) < 1e-15:
                break
        self.edge = x
        return x, stress, slope, entered

    def rates(self, time, state):
        """Return the rates of depth, its rate, both accumulators and both moments."""
        depth, sinks, alpha, beta, pull, turn = state
        x, stress, slope, entered = self.trailing(time, state)
        strained = sinks - V * x / R
        moves = V - ((K + ARM) * strained - stress / TIME) / slope
        low = -np.sqrt(2 * R * depth)
        powers = [(x**n - low**n) / n for n in (1, 2, 3, 4)]
        self.forces = (
            K * (depth * powers[0] - powers[2] / (2 * R)) + pull,
            -(K * (depth * powers[1] - powers[3] / (2 * R)) + turn) / R,
        )
        self.entered = entered
        return np.array([
            sinks, GRAVITY - self.forces[0] / M, *ACCUMULATE(sinks, V, V * time, alpha, beta),
            *MOMENTS(sinks, V, pull, turn, *powers[:3], moves, stress, x),
        ])  # fmt: skip

    def after(self, h):
        """Return the state after a step."""
        time, state, k1 = self.path[-1]
        k2 = self.rates(time + h / 2, state + h / 2 * k1)
        k3 = self.rates(time + h / 2, state + h / 2 * k2)
        k4 = self.rates(time + h, state + h * k3)
        return state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)

    def run(self, end):
        """Slide; a step ends where the trailing edge reaches the first element that entered."""
        self.path[0] = (*self.path[0][:2], self.rates(*self.path[0][:2]))
        while end - self.path[-1][0] > 1e-12:
            time = self.path[-1][0]
            h = min(self.step, end - time)
            state = self.after(h)
            rates = self.rates(time + h, state)
            if self.entered and not self.kinked:
                self.kinked = True
                low, high = 0.0, h
                for _ in range(40):
                    middle = (low + high) / 2
                    self.rates(time + middle, self.after(middle))
                    low, high = (low, middle) if self.entered else (middle, high)
                h, state = high, self.after(high)
                rates = self.rates(time + h, state)
            self.path.append((time + h, state, rates))
        return self.path[-1][1], self.forces


def test_f23_gives_the_transient_of_another_program():
    (coarse, first), (fine, second) = (Slide(step).run(0.06) for step in (4e-4, 2e-4))
    depth, *forces = (
        b + (b - a) / 15 for a, b in zip((coarse[0], *first), (fine[0], *second), strict=True)
    )
    assert depth == pytest.approx(0.12105290e-3, rel=4e-8)
    assert forces == pytest.approx([9631.5699, 300.69993], rel=1e-8)


def test_f23_follows_elements_beyond_the_kink_of_the_trailing_edge():
    slide = Slide(4e-4)
    state, forces = slide.run(0.08)
    assert slide.kinked
    arms = kv.GeneralizedMaxwell(K, arms=[["50 GN/m^3", "100 ms"]])
    scene = replace(kv.Scene.table1("dead-weight"), foundation=arms)
    found = kv.elements(scene.replace({"drive.velocity": V}), per_length="200 /mm", at=[0.08])
    ours = (state[0], *forces)
    for name, value in zip(("depth", "normal_force", "friction_force"), ours, strict=True):
        assert getattr(found, name)[0] == pytest.approx(value, rel=4e-4)


def test_f26_finds_the_foundation_from_its_friction_maximum(by_label):
    scene = kv.Scene.table1("dead-weight")

    def falls(velocity):
        return -float(kv.steady(scene, over={"drive.velocity": velocity}).friction_coefficient)

    best = minimize_scalar(falls, bracket=(0.02, 0.04, 0.08), tol=1e-10)
    known = {s.mu_max: -best.fun, s.V_max: best.x, s.W: WEIGHT, s.R: R, s.K: K}
    stiffness, time = (
        step.claim.rhs for step in by_label["F26"].steps if step.claim.check == "root"
    )
    assert float(stiffness.subs(known)) == pytest.approx(K, rel=1e-9)
    assert float(time.subs(known)) == pytest.approx(TIME, rel=1e-6)
    rows = by_label["F26"].table.rows
    assert [row[1][:8] for row in rows[::2]] == ["0.507265", "1.600270"]


def test_f27_bounds_what_another_series_changes():
    rng = np.random.default_rng(27)
    z = viscoelastic.z
    moments = sp.lambdify(z, [form for _, form in viscoelastic.MOMENTS.values()], "mpmath")
    limits = [float(sp.limit(form, z, 0)) for _, form in viscoelastic.MOMENTS.values()]

    def forces(c, arms):
        """Return load and friction force, over c**3/R and c**4/R**2, on a spring 1 and arms."""
        P, Q, D, E = limits + sum(k * np.array(moments(mp.mpf(c / l)), float) for k, l in arms)
        e = (P - Q) / (2 * (P + Q))
        return c**3 * (D + e * P), c**4 * (E + e**2 * P)

    worst = 0.0
    for _ in range(40):
        relative = 10 ** rng.uniform(-4, -2)
        arms = [(10 ** rng.uniform(-1, 2), 10 ** rng.uniform(-2, 2)) for _ in range(3)]
        other = [(k * (1 + relative * rng.choice((-1, 1))), l) for k, l in arms]
        load, friction = forces(1, arms)
        length = brentq(
            lambda c, other=other, load=load: forces(c, other)[0] - load, 0.8, 1.2, xtol=1e-13
        )
        change = abs(forces(length, other)[1] / friction - 1)
        worst = max(worst, change / (few_arms.BOUND * relative))
    assert 0.05 < worst < 1
