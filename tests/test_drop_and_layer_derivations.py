"""Derivations F28 to F32: forces, restitution and compliance against quadrature, marching and numbers."""

import math
import re

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import body, drop, layer, viscoelastic_ball
from kvtheory.derivations.shape import derive_shape
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq, minimize_scalar
from scipy.special import hyp1f1

import kvtheory as kv
from tests.conftest import digits

_digits = digits(50)

SCENE = {
    s.K: sp.Float("2.1e9"),
    s.tau: sp.Float("0.03"),
    s.R: sp.Float("0.013"),
    drop.radius_across: sp.Float("0.02"),
}
DEPTH, RATE = sp.Float("1.9e-4"), sp.Float("2.5e-3")


def _value(form, **more):
    point = SCENE | {
        s.delta_t.diff(s.t): RATE,
        s.delta_t: DEPTH,
        drop.ball_depth: DEPTH,
        drop.ball_rate: RATE,
    }
    point |= {
        drop.relaxed: DEPTH - SCENE[s.tau] * RATE,
        drop.ball_relaxed: DEPTH - SCENE[s.tau] * RATE,
    }
    return float(form.subs(point))


def _pressed(sign):
    """Return line and ball forces by adding up the elements that are pressed, at a rate of this sign."""
    K, tau, R, across = (float(SCENE[each]) for each in (s.K, s.tau, s.R, drop.radius_across))
    depth, rate = float(DEPTH), sign * float(RATE)

    def pressure(x, y=0.0):
        u = depth - x * x / (2 * R) - y * y / (2 * across)
        return np.where(u > 0, np.maximum(K * (u + tau * rate), 0.0), 0.0)

    x = (np.arange(4000) + 0.5) / 4000 * np.sqrt(2 * R * depth)
    y = (np.arange(1000) + 0.5) / 1000 * np.sqrt(2 * across * depth)
    line = 2 * np.sum(pressure(x)) * (x[1] - x[0])
    ball = 4 * np.sum(pressure(x[:, None], y[None])) * (x[1] - x[0]) * (y[1] - y[0])
    return line, ball


def test_the_forces_of_a_drop_are_those_of_the_elements_that_are_pressed():
    for forms, sign in ((drop.FORCE_IN, drop.BALL_IN), 1), ((drop.FORCE_OUT, drop.BALL_OUT), -1):
        for form, elements in zip(forms, _pressed(sign), strict=True):
            assert _value(form) == pytest.approx(elements, rel=2e-4)


def _restitution(law, number):
    """Integrate the scaled motion F32-down and F32-up in its second-order form, and return e."""
    factor, power = (float(each) for each in law)

    def sinks(_, state):
        d, v = max(state[0], 0.0), state[1]
        return v, -factor * d**power - number * factor * power * d ** (power - 1) * v

    def rises(_, state):
        return state[1], -factor * max(state[0] + number * state[1], 0.0) ** power

    turns = lambda _, state: state[1]  # noqa: E731
    ends = lambda _, state: state[0] + number * state[1]  # noqa: E731
    turns.terminal = ends.terminal = True
    settings = {"rtol": 1e-11, "atol": 1e-13, "method": "DOP853"}
    down = solve_ivp(sinks, (0, 50), (1e-13, 1.0), events=turns, **settings)
    up = solve_ivp(rises, (0, 50), down.y_events[0][0], events=ends, **settings)
    return -up.y_events[0][0][1]


LINE_NUMBERS = {0.05: 0.9101172, 0.2: 0.7067313, 1.0: 0.2808203}
BALL_NUMBERS = {0.05: 0.9108869, 0.2: 0.7129687, 1.0: 0.3053201}


@pytest.mark.parametrize(("law", "known"), [(drop.LINE, LINE_NUMBERS), (drop.BALL, BALL_NUMBERS)])
def test_restitution_follows_from_the_one_number(law, known):
    for number, expected in known.items():
        assert _restitution(law, number) == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize(("family", "law"), [("F32", drop.LINE), ("F32-ball", drop.BALL)])
def test_the_series_of_restitution(by_label, family, law):
    factor, power = (mp.mpf(str(sp.N(each, 50))) for each in law)
    part = power / (power + 1)
    top = ((power + 1) / (2 * factor)) ** (1 / (power + 1))
    taken = mp.quad(
        lambda d: factor * power * d ** (power - 1) * mp.sqrt(1 - (d / top) ** (power + 1)),
        [0, top / 2, top],
    )
    closed = part * factor * top**power * mp.beta(part, mp.mpf(3) / 2)
    assert mp.almosteq(taken, closed, rel_eps=mp.mpf("1e-15"))
    first, second = 2 * closed, 4 * part * closed**2 + (factor * top**power) ** 2 / 2
    assert f"{float(first):.6f}" in by_label[f"{family}-series"].text
    assert f"{float(second):.6f}" in by_label[f"{family}-series"].text
    claim = next(
        step.claim
        for step in by_label[f"{family}-series"].steps
        if step.claim.check == "leading_order"
    )
    size = {
        drop.loss: float(closed),
        drop.force_at_top: float(factor * top**power),
        drop.number: 1.0,
    }
    ratio = -claim.arguments["next_term"].subs(size)
    assert float(2 * closed) * float(ratio) == pytest.approx(float(second), rel=1e-12)
    errors = []
    for number in (0.01, 0.005):
        rest = _restitution(law, number) - (1 - float(first) * number + float(second) * number**2)
        errors.append(abs(rest) / number**2.5)
    assert max(errors) < 1.0
    assert errors[1] < 1.1 * errors[0]


def _marched(poisson, kappa):
    """Return T of a layer of thickness 1: Navier's equations in Lame's constants, marched upward."""
    k, shear = mp.mpf(kappa), mp.mpf(1)
    nu = mp.mpf(poisson)
    first = 2 * shear * nu / (1 - 2 * nu)
    mixed, stiff = first + shear, first + 2 * shear
    rates = mp.matrix(4)  # of u, w and their derivatives, for u sin(k x) and w cos(k x)
    rates[0, 2] = rates[1, 3] = 1
    rates[2, 0], rates[2, 3] = (shear * k**2 + mixed * k**2) / shear, mixed * k / shear
    rates[3, 1], rates[3, 2] = shear * k**2 / stiff, -mixed * k / stiff
    up = mp.expm(rates)
    free = [up[2, j] - k * up[1, j] for j in (2, 3)]
    start = mp.matrix([0, 0, free[1], -free[0]])  # no shear at the surface
    u, w, _, w_z = up * start
    stress = first * (k * u + w_z) + 2 * shear * w_z
    modulus = 2 * shear * (1 + nu)
    return modulus * k / (2 * (1 - nu**2)) * w / stress


@pytest.mark.parametrize("poisson", ["0.1", "0.3", "0.49"])
@pytest.mark.parametrize("kappa", ["0.05", "1.3", "6"])
def test_the_compliance_of_a_layer_is_that_of_a_march_from_the_ground(poisson, kappa):
    point = {layer.nu: sp.Float(poisson, 50), layer.kappa: sp.Float(kappa, 50)}
    found = mp.mpf(str(layer.TRANSFER.subs(point).evalf(50)))
    assert mp.almosteq(found, _marched(poisson, kappa), rel_eps=mp.mpf("1e-30"))


def test_a_layer_that_cannot_be_compressed_is_the_limit_of_one_that_hardly_can():
    point = {layer.nu: sp.Rational(1, 2), layer.kappa: sp.Float("0.7", 50)}
    found = mp.mpf(str(layer.TRANSFER.subs(point).evalf(50)))
    nearly = _marched(mp.mpf("0.5") - mp.mpf("1e-25"), "0.7")
    assert mp.almosteq(found, nearly, rel_eps=mp.mpf("1e-20"))


def test_the_next_terms_of_a_thin_layer(by_label):
    def relative(poisson, kappa, leading):
        nu, k = mp.mpf(poisson), mp.mpf(kappa)
        found = layer.TRANSFER.subs(
            {layer.nu: sp.Float(str(nu), 50), layer.kappa: sp.Float(str(k), 50)}
        )
        whole = 2 * (1 - nu**2) * mp.mpf(str(found.evalf(50))) / k
        return (whole / leading(nu, k) - 1) / k**2

    thin = lambda nu, k: (1 + nu) * (1 - 2 * nu) / (1 - nu)  # noqa: E731
    for poisson in ("0.2", "0.25", "0.45"):
        nu = mp.mpf(poisson)
        expected = nu * (4 * nu - 1) / (3 * (1 - nu) * (1 - 2 * nu))
        assert abs(relative(poisson, "1e-6", thin) - expected) < 1e-9
    assert abs(relative("0.5", "1e-6", lambda nu, k: k**2) + mp.mpf(9) / 5) < 1e-9
    assert r"\frac{9 \kappa_H^{2}}{5}" in by_label["F30-incompressible"].latex


@pytest.mark.parametrize("exponent", [2, 3, 5])
def test_the_mean_curvature_gives_the_friction_of_a_power_law_at_low_velocity(exponent):
    n = mp.mpf(exponent)  # independent elements under |x|**n: F28 against F19
    bend = mp.quad(lambda x: n * (n - 1) * x ** (n - 2) * (1 - x**n), [0, 1])
    load = mp.quad(lambda x: 1 - x**n, [0, 1])
    known = s.exponent * (s.exponent + 1) / (2 * s.exponent - 1)
    from_f19 = mp.mpf(str(sp.N(known.subs(s.exponent, exponent), 50)))
    assert mp.almosteq(bend / load, from_f19, rel_eps=mp.mpf("1e-20"))


@pytest.mark.parametrize(
    ("label", "shape", "load_power"),
    [("line", kv.Parabola(0.01), 1.5), ("ball", kv.Sphere(0.01), 2.0)],
)
def test_friction_at_high_velocity_is_that_of_the_elastic_energy(
    by_label, label, shape, load_power
):
    depth, fast = 2e-4, 1e3
    foundation = kv.GeneralizedMaxwell(1e10, arms=[(4e10, 0.02), (1.5e10, 0.3)])
    rate = (4e10 / 0.02 + 1.5e10 / 0.3) / 6.5e10
    support = kv.Fixed(depth)
    scene = kv.Scene(shape, foundation, support, kv.Drive(fast))
    found = float(kv.steady(scene).friction_coefficient) * fast / (rate * depth)
    claim = by_label[f"F29-{label}"].steps[-1].claim
    form = claim.rhs.subs({body.fading_rate: 1, s.V: 1, s.delta: 1})
    assert float(form) == pytest.approx(2 / (load_power + 1), rel=1e-15)
    assert found == pytest.approx(float(form), rel=2e-3)


def test_a_ball_on_arms_is_one_quadrature_over_its_strips():
    radius, across, depth, fast, spring = 0.01, 0.015, 2e-4, 0.05, 1e10
    arms = [(4e10, 0.02), (1.5e10, 0.3)]

    def G(n, c):  # the n-fold integral of the relaxation function
        parts = (stiff * hyp1f1(1, n + 1, -c / (fast * time)) for stiff, time in arms)
        return c**n / math.factorial(n) * (spring + sum(parts))

    middle = math.sqrt(2 * radius * depth)
    longest = brentq(lambda c: G(2, c) / G(1, c) - middle, middle, 2 * middle, xtol=1e-15)

    def added(rate):
        names = (viscoelastic_ball.c, s.a, s.R, viscoelastic_ball.G_2(viscoelastic_ball.c))
        numeric = sp.lambdify(names, rate, "math")

        def density(angle):  # c = longest sin(angle): no root at the end
            c = longest * math.sin(angle)
            half, gained = G(2, c) / G(1, c), 1 - G(2, c) * G(0, c) / G(1, c) ** 2
            place = math.sqrt(across / radius * max(middle**2 - half**2, 0))
            return (
                2 * place * gained * numeric(c, half, radius, G(2, c)) * longest * math.cos(angle)
            )

        return quad(density, 0, math.pi / 2, epsabs=0)[0]

    load, friction = map(added, (viscoelastic_ball.LOAD_RATE, viscoelastic_ball.FRICTION_RATE))
    foundation = kv.GeneralizedMaxwell(spring, arms=arms)
    sphere = kv.Sphere(radius, radius_across=across)
    found = kv.steady(
        kv.Scene(sphere, foundation, kv.Fixed(depth), kv.Drive(fast)), method="quadrature"
    )
    assert load == pytest.approx(float(found.load), rel=1e-6)
    assert friction == pytest.approx(float(found.friction_force), rel=1e-6)


class PowerUnderWeight:
    """h = c |x|**n under a load, with stiffness and retardation time 1, by quadrature and roots."""

    def __init__(self, factor, exponent, load, velocity):
        self.c, self.n, self.V = factor, exponent, velocity
        half = brentq(lambda a: self.forces(a)[0] - load, 1e-9, 10.0, xtol=1e-14, rtol=1e-13)
        self.friction = self.forces(half)[1] / load

    def forces(self, a):
        slope = lambda x: self.c * self.n * np.sign(x) * np.abs(x) ** (self.n - 1)  # noqa: E731
        pressure = lambda x: self.c * (a**self.n - np.abs(x) ** self.n) - self.V * slope(x)  # noqa: E731
        edge = brentq(pressure, 0.0, a, xtol=1e-15) if pressure(a) < 0 else a
        parts = ((-a, 0.0), (0.0, edge))
        load = sum(quad(pressure, *part, epsabs=0)[0] for part in parts)
        return load, sum(
            quad(lambda x: -slope(x) * pressure(x), *part, epsabs=1e-16)[0] for part in parts
        )


@pytest.mark.parametrize(
    ("text", "factor", "exponent"), [("c*x^4", 0.7, 4.0), ("c*abs(x)**1.5", 0.7, 1.5)]
)
def test_a_shape_under_a_dead_weight(text, factor, exponent):
    derived = {each.label.removeprefix("shape-weight-"): each for each in derive_shape(text)}
    load = 0.3
    point = {sp.Symbol("c", positive=True): factor, s.K: 1, s.tau: 1, s.W: load}

    def value(label, velocity):
        return float(derived[label].steps[-1].claim.rhs.subs({**point, s.V: velocity}))

    for label, velocity in (("low", 1e-5), ("high", 1e7)):
        found = PowerUnderWeight(factor, exponent, load, velocity).friction
        assert value(label, velocity) == pytest.approx(found, rel=2e-3)
    crossing = next(
        step for step in derived["crossing"].steps if step.left == "V^{*}"
    ).claim.rhs.subs(point)
    meets = float(crossing)
    assert value("low", meets) == pytest.approx(value("high", meets), rel=1e-12)
    numbers = [float(each) for each in re.findall(r"= (\d\.\d+)", derived["maximum"].text)]
    length = (load / factor) ** (1 / (exponent + 1))
    velocity, height = numbers[1] * length, numbers[2] * factor * length ** (exponent - 1)
    best = minimize_scalar(
        lambda V: -PowerUnderWeight(factor, exponent, load, V).friction,
        bounds=(velocity / 2, velocity * 2), method="bounded", options={"xatol": 1e-8},
    )  # fmt: skip
    assert -best.fun == pytest.approx(height, rel=1e-5)
    assert best.x == pytest.approx(velocity, rel=1e-3)
    Lambda, scaled = (
        next(
            step.claim.rhs
            for step in derived["groups"].steps
            if step.left == name and step.status == "proved"
        )
        for name in (r"\Lambda", r"\hat \mu")
    )
    [q] = Lambda.free_symbols
    place = brentq(lambda at: float(Lambda.subs(q, at)) - 2.0, 1e-3, 1.0)
    found = PowerUnderWeight(factor, exponent, load, 2.0 * length).friction
    assert float(scaled.subs(q, place)) * factor * length ** (exponent - 1) == pytest.approx(
        found, rel=1e-6
    )
