"""Derivations F23, F26, F27 and F33: the proved expressions against the law of elements, and numbers."""

from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import (
    damped_arms,
    few_arms,
    rubber_drive,
    rubber_transient,
    viscoelastic,
)
from kvtheory.derivations.engine import book
from kvtheory.derivations.engine.book import established
from scipy.optimize import brentq, minimize_scalar

import kvtheory as kv

K, R, ARM, TIME = 1e10, 0.5, 3.0, 0.4
WEIGHT = 1000.0 * 9.80665
NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


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


def depth(t):
    return 1.0 + 0.2 * np.sin(3.0 * t)


def travel(t):
    return 1.5 * t + 0.3 * t * t


def sinking(t):
    return 0.6 * np.cos(3.0 * t)


def sliding(t):
    return 1.5 + 0.6 * t


def leading(t):
    return -np.sqrt(2.0 * R * depth(t))


def trailing(t):
    return 0.5 + 0.1 * np.cos(2.0 * t)


def rate(function, t, h=1e-5):
    return (function(t + h) - function(t - h)) / (2.0 * h)


def integral(function, low, high):
    return 0.5 * (high - low) * WEIGHTS @ function(low + 0.5 * (high - low) * (NODES + 1.0))


def faded(function, begun, now):
    """Integrate what an arm remembers: e^(-(now - t)/tau_i) times a function."""
    return integral(lambda t: np.exp(-(now - t) / TIME) * function(t), begun, now)


def accumulators(now):
    alpha = faded(lambda t: sinking(t) - sliding(t) * travel(t) / R, 0.0, now)
    return alpha, faded(sliding, 0.0, now)


def entry(element):
    """Return when an element came into contact."""
    if element >= leading(0.0):
        return 0.0
    return brentq(lambda t: leading(t) - travel(t) - element, 0.0, 2.0, xtol=1e-15)


def stress(element, now):
    """Return the stress of the arm by its definition, s' = K_i u' - s/tau_i from its entry on."""

    def strained(t):
        return sinking(t) - (element + travel(t)) / R * sliding(t)

    return ARM * faded(strained, entry(element), now)


def moment(power, now):
    """Integrate x^n s over the contact, whose first elements were in contact at the start."""
    edges = [leading(now), min(leading(0.0) + travel(now), trailing(now)), trailing(now)]
    return sum(
        integral(lambda x: x**power * [stress(each - travel(now), now) for each in x], *piece)
        for piece in pairwise(edges)
    )


@pytest.mark.parametrize("now", [0.3, 1.2])
def test_f23_follows_a_given_motion(now):
    """Stress, its slope, accumulators and moments against the law of each element; all may have entered."""
    sinks, v, Y = sinking(now), sliding(now), travel(now)
    alpha, beta = accumulators(now)
    changes = rate(lambda t: np.array(accumulators(t)), now)
    assert ACCUMULATE(sinks, v, Y, alpha, beta) == pytest.approx(changes, abs=1e-8)
    for x in np.linspace(leading(now), trailing(now), 9)[1:]:
        begun = entry(x - Y)
        left, there = np.exp(-(now - begun) / TIME), accumulators(begun)
        assert STRESS(x - Y, alpha, beta, *there, left) == pytest.approx([stress(x - Y, now)])
        slope = SLOPE(beta, there[1], left, leading(begun) if begun else 0.0)
        assert slope == pytest.approx([rate(lambda xi: stress(xi, now), x - Y)], abs=1e-7)
    edge, low = trailing(now), leading(now)
    powers = [(edge**n - low**n) / n for n in (1, 2, 3)]
    found = MOMENTS(
        sinks, v, moment(0, now), moment(1, now), *powers, rate(trailing, now), stress(edge - Y, now), edge
    )  # fmt: skip
    assert found == pytest.approx(
        [rate(lambda t, n=n: moment(n, t), now) for n in (0, 1)], abs=1e-7
    )


def test_f26_finds_the_foundation_from_its_friction_maximum(by_label):
    scene = kv.Scene.table1("dead-weight")

    def falls(velocity):
        return -float(kv.steady(scene, over={"drive.velocity": velocity}).friction_coefficient)

    best = minimize_scalar(falls, bracket=(0.02, 0.04, 0.08), tol=1e-10)
    known = {s.mu_max: -best.fun, s.V_max: best.x, s.W: WEIGHT, s.R: 0.01, s.K: K}
    known |= {each: established("F3-values", each) for each in (s.mu_peak, s.Lambda_peak)}
    stiffness, time = (
        step.claim.rhs for step in by_label["F26"].steps if step.claim.check == "root"
    )
    assert float(stiffness.subs(known)) == pytest.approx(K, rel=1e-9)
    assert float(time.subs(known)) == pytest.approx(0.1, rel=1e-6)
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


DAMPING, ARMS, RADIUS, DEPTH = 0.5e9, ((20e9, 5e-3), (10e9, 0.2)), 0.01, 3e-4
"""A damper beside two arms."""
_moments = damped_arms.A, damped_arms.B, damped_arms.D, damped_arms.E, damped_arms.P
_excess = damped_arms.WHOLE[damped_arms.B] / damped_arms.WHOLE[damped_arms.A]
_TOGETHER = sp.lambdify(
    (*_moments, damped_arms.springpot, damped_arms.e),
    [form.subs(damped_arms.arm_ratio, 1) for form in (_excess, damped_arms.LOAD, damped_arms.WORK)],
    "mpmath",
)
"""The excess over half of the contact, load and friction force, with the moments of all arms added up."""
_P, _Q, _D, _E = (viscoelastic.MOMENTS[name][1] for name in (viscoelastic.P, viscoelastic.Q, viscoelastic.D,
                                                               viscoelastic.E))  # fmt: skip
_OF_ARM = sp.lambdify(viscoelastic.z, [_P + _Q, (_P - _Q) / 2, _D, _E, _P], "mpmath")


def _sliding_on_arms_and_damper(velocity, depth):
    """Return load and friction force, by the record F33."""
    half = mp.sqrt(2 * RADIUS * depth)

    def at(c):
        totals = [mp.mpf(0)] * len(_moments)
        for stiffness, time in ARMS:
            own = _OF_ARM(c / (velocity * time))
            totals = [total + stiffness / K * each for total, each in zip(totals, own, strict=True)]
        ratio = DAMPING * velocity / (K * c)
        excess, *_ = _TOGETHER(*totals, ratio, 0)
        _, load, work = _TOGETHER(*totals, ratio, excess)
        return excess, K * c**3 / RADIUS * load, K * c**4 / RADIUS**2 * work

    c = mp.findroot(
        lambda c: c * (mp.mpf(1) / 2 + at(c)[0]) - half, (half, 2 * half), solver="anderson"
    )
    return at(c)[1:]


@pytest.mark.parametrize(
    ("velocity", "load", "friction"),
    [("1e-3", 9955.691, 214.8258), ("0.03", 19014.63, 1486.771), ("1", 169030.5, 26179.89)],
)
def test_f33_slides_as_a_quadrature_of_the_history_says(velocity, load, friction):
    with mp.workdps(40):
        found = _sliding_on_arms_and_damper(mp.mpf(velocity), DEPTH)
    assert [*map(float, found)] == pytest.approx([load, friction], rel=1e-6)


def test_f33_has_the_limits_and_the_critical_velocities_that_it_states(by_label):
    half = np.sqrt(2 * RADIUS * DEPTH)
    damping = DAMPING + sum(stiffness * time for stiffness, time in ARMS)
    with mp.workdps(60):
        slow, fast = (
            _sliding_on_arms_and_damper(v, DEPTH) for v in (mp.mpf("1e-9"), mp.mpf("1e9"))
        )
    low = float(slow[1] / slow[0]) / 1e-9
    high = float(fast[1] / fast[0])
    assert (low, high) == pytest.approx((damping / (K * RADIUS), 2 * half / (3 * RADIUS)), rel=1e-5)
    assert float(fast[0]) == pytest.approx(DAMPING * 1e9 * DEPTH, rel=1e-5)
    scene = {
        s.K: K,
        s.R: RADIUS,
        s.delta: DEPTH,
        s.C: DAMPING,
        s.W: WEIGHT,
        damped_arms.C_all: damping,
    }
    fixed, weight = (
        float(established(label, s.V_star).subs(scene))
        for label in ("F33-critical", "F33-critical-weight")
    )
    assert low * fixed == pytest.approx(high, rel=1e-5)
    assert (low * weight) ** 2 == pytest.approx(
        8 * WEIGHT / (9 * RADIUS * DAMPING * weight), rel=1e-5
    )
    assert by_label["F33-critical"].status == "proved"


def test_f33_relaxes_behind_the_contact_with_the_rates_of_its_polynomial(by_label):
    stiffness, time = ARMS[0]
    # u' = -(K u + s)/C and s' = K_1 u' - s/tau
    system = np.array([[-K, -1], [-stiffness * K, -stiffness - DAMPING / time]]) / DAMPING
    rates = np.sort(-np.linalg.eigvals(system))
    scene = {s.K: K, s.C: DAMPING, damped_arms.spring_1: stiffness, damped_arms.tau_1: time}
    _, form = book.finished(["F33-free"])["F33-free"].result
    assert by_label["F33-free"].status == "proved"
    values = [float(form.subs(scene).subs(damped_arms.fades, rate)) for rate in rates]
    assert values == pytest.approx([0, 0], abs=1e-9 * K / time)
    assert rates[0] < 1 / time < rates[1]


def test_f24_changes_the_forces_of_a_damper_as_its_pressure_between_moving_edges_does():
    c, speed, eta, s = map(mp.mpf, ("2e-3", "0.05", "0.21", "13"))
    half = c * (mp.mpf(1) / 2 + eta)
    depth, sinks, drags = half**2 / (2 * RADIUS), mp.mpf("3e-6"), mp.mpf("2e-5")

    def force(small, lever):
        edge = -mp.sqrt(2 * RADIUS * (depth + small * sinks))
        rate = lambda x: small * s * sinks - x / RADIUS * (speed - small * s * drags)  # noqa: E731
        return mp.quad(lambda x: DAMPING * rate(x) * lever(x), [edge, c - half])

    unit, sigma, e = DAMPING * speed, s * c / speed, rubber_drive.excess_share
    for lever, arm, per_depth, per_drag in (
        (lambda x: 1, 1, rubber_drive.normal_per_depth, rubber_drive.normal_per_drag),
        (lambda x: -x / RADIUS, c / RADIUS, rubber_drive.rubbing_per_depth, rubber_drive.rubbing_per_drag),
    ):  # fmt: skip
        known = {rubber_drive.sigma: sigma, e: eta}
        shares = [rubber_drive.DAMPED[name].subs(known) for name in (per_depth, per_drag)]
        told = unit * arm * (shares[0] * sinks + shares[1] * drags * c / RADIUS)
        assert mp.diff(lambda h, lever=lever: force(h, lever), 0) == pytest.approx(told, rel=1e-6)
