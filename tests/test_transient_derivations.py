"""The derivations of the transient against quadrature, roots, elements and numerical derivatives."""

import mpmath as mp
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import (
    theorems,
    transient_balance,
    transient_edges,
    transient_motion,
    transient_rates,
)
from kvtheory.derivations.chapters.steady import LEADING, TRAILING
from kvtheory.derivations.chapters.transient_scaling import PRESSURE
from kvtheory.derivations.engine.book import established
from kvtheory.derivations.engine.step import Proof, StepError

import kvtheory as kv
from tests.conftest import digits
from tests.planted import derive

_digits = digits(50)

DIGITS = 50
CLOSE = mp.mpf("1e-40")


def value(expr, point):
    """Evaluate an expression with 50 digits."""
    exact = {symbol: sp.Float(str(number), DIGITS + 10) for symbol, number in point.items()}
    return mp.mpf(str(sp.N(sp.sympify(expr).subs(exact), DIGITS)))


def close(one, other, scale=1):
    return abs(one - other) <= CLOSE * max(abs(one), abs(other), scale)


# The scaled form and Eq. 33

SCENE = {s.R: "0.013", s.K: "2.1e9", s.tau: "0.17", s.V: "0.021", s.M: "730"}
DEPTH, RATE, STATIC = mp.mpf("1.9e-4"), mp.mpf("-3.1e-4"), mp.mpf("2.7e-4")


R, K, TAU, V = (mp.mpf(SCENE[symbol]) for symbol in (s.R, s.K, s.tau, s.V))


def dimensional_pressure(x):
    """The pressure in SI units, from Eqs. 3, 6 and 7 alone."""
    u, rate = DEPTH - x**2 / (2 * R), RATE - x / R * V
    return K * (u + TAU * rate)


def test_both_roots_of_equation_33_and_the_scaled_forces():
    peak, width, a_0 = -V * TAU, mp.sqrt(2 * R * DEPTH), mp.sqrt(2 * R * STATIC)
    leading, trailing = (
        mp.findroot(dimensional_pressure, end, solver="anderson", tol=1e-70)
        for end in ((peak - width, peak), (peak, peak + width))
    )
    point = {s.a: width, s.tau: TAU, s.l_r: V * TAU, s.d: DEPTH, s.d_s: RATE}
    named = {s.delta_t.diff(s.t): s.d_s, s.delta_t: s.d}
    for found, expr in zip((leading, trailing), (LEADING, TRAILING), strict=True):
        assert close(found, value(expr.subs(named), point), mp.mpf("1e-3"))
    point = {
        s.d: DEPTH / STATIC, s.d_s: TAU * RATE / STATIC, s.lam: V * TAU / a_0,
        transient_motion.left: leading / a_0, transient_motion.right: trailing / a_0,
    }  # fmt: skip
    load, friction = (
        mp.quad(lambda x, arm=arm: arm(x) * dimensional_pressure(x), [leading, trailing])
        for arm in (lambda x: 1, lambda x: -x / R)
    )
    w_0 = mp.mpf(4) / 3 * K * a_0 * STATIC
    assert close(load / w_0, value(transient_motion.NORMAL_FORCE, point))
    scaled = friction / (w_0 * STATIC / a_0)
    assert close(scaled, value(transient_motion.FRICTION_FORCE, point))


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
    h = sp.Symbol("h", positive=True)
    decay = sp.exp(-h)
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


# Forces, rates and the slow manifold


def force(d, rate, lam, weight):
    """Integrate weight(xi) times the pressure after a start from rest, by quadrature."""
    ends = [-mp.sqrt(d), mp.sqrt(d + rate + lam**2) - lam]
    return mp.quad(lambda xi: weight(xi) * (d - xi**2 + rate - 2 * lam * xi), ends)


def normal(d, rate, lam):
    return force(d, rate, lam, lambda xi: mp.mpf(3) / 4)


def friction(d, rate, lam):
    return force(d, rate, lam, lambda xi: -3 * xi / 2)


MOTION = mp.mpf("0.6"), mp.mpf("-0.2"), mp.mpf("0.7")


def test_forces_while_the_right_edge_peels():
    d, rate, lam = MOTION
    radius = mp.sqrt(d + rate + lam**2)
    point = {s.right: radius - lam, s.rho: radius, s.b: radius - lam + mp.sqrt(d)}
    assert close(normal(*MOTION), value(transient_motion.PEELING_NORMAL_FORCE, point))
    assert close(friction(*MOTION), value(transient_motion.PEELING_FRICTION_FORCE, point))


def test_jacobian_after_a_start_from_rest():
    d, rate, lam = MOTION
    trailing = mp.sqrt(d + rate + lam**2) - lam
    point = {s.d_s: rate, s.lam: lam, s.right: trailing, s.a: mp.sqrt(d)}
    slopes = iter(transient_motion.JACOBIAN)
    for measured in (normal, friction):
        for order in ((1, 0), (0, 1)):
            found = mp.diff(lambda one, two, f=measured: f(one, two, lam), (d, rate), order)
            assert abs(found - value(next(slopes), point)) < mp.mpf("1e-20")


@pytest.mark.usefixtures("by_label")
def test_an_edge_that_touches_moves_with_the_depth_as_derived():
    then, moved, decay = mp.mpf("0.9"), mp.mpf("0.3"), mp.mpf("0.6")

    def edge(d):
        return mp.findroot(lambda xi: d - xi**2 - decay * (then - (xi - moved) ** 2), 1)

    d = mp.mpf("0.7")
    place = edge(d)
    (call,) = transient_motion._touching.atoms(sp.core.function.AppliedUndef)
    slope = established("F11-edges", sp.Derivative(call, s.d)).subs(call, s.xi)
    found = value(slope, {s.xi: place, s.eta: place - moved, s.E: decay})
    assert abs(mp.diff(edge, d) - found) < mp.mpf("1e-20")


def steady_state(lam, kappa):
    return mp.findroot(lambda d: 1 - normal(d, mp.mpf(0), lam) - kappa * (d - 1), 0.5)


def eigenvalues(lam, inertia, kappa):
    """Return the rates of the two-state motion at its steady state, from numerical derivatives."""
    d = steady_state(lam, kappa)
    slopes = [mp.diff(lambda x, y: normal(x, y, lam), (d, 0), order) for order in ((1, 0), (0, 1))]
    jacobian = mp.matrix([[0, 1], [-(slopes[0] + kappa) / inertia, -slopes[1] / inertia]])
    return sorted(mp.eig(jacobian, left=False, right=False), key=mp.re)


@pytest.mark.parametrize(("lam", "kappa"), [("0.4", "0"), ("3", "0.8")])
def test_rates_are_eigenvalues(lam, kappa):
    lam, kappa, inertia = mp.mpf(lam), mp.mpf(kappa), mp.mpf("0.004")
    half = mp.sqrt(steady_state(lam, kappa))
    point = {
        s.eps: inertia, s.kappa: kappa, s.per_depth: mp.sqrt(half**2 + lam**2) + half,
        s.per_rate: mp.sqrt(half**2 + lam**2) - lam + half,
    }  # fmt: skip
    formulas = [value(expr, point) for expr in (transient_rates.FAST, transient_rates.SLOW)]
    for found, formula in zip(eigenvalues(lam, inertia, kappa), formulas, strict=True):
        assert abs(found - formula) < mp.mpf("1e-15") * abs(formula)


def test_oscillation_begins_at_the_boundary():
    q = mp.mpf("0.3")
    half = mp.cbrt(4 / (3 * value(theorems.LOAD, {s.q: q})))
    lam, critical = half * (1 - q**2) / (2 * q), 3 * half * q / 8
    below, above = (eigenvalues(lam, critical * (1 + sign), mp.mpf(0)) for sign in (-1e-6, 1e-6))
    assert all(abs(mp.im(rate)) < mp.mpf("1e-15") for rate in below)
    assert all(abs(mp.im(rate)) > mp.mpf("1e-4") for rate in above)


def test_the_two_time_constants_of_table_1(by_label):
    """The paper's "1 ms" and "10 ms"."""
    times = sorted(1e3 * each for each in kv.stability(quantity="time_constants").time_constants)
    depth = kv.steady().depth / kv.steady(over={"drive.velocity": 0.0}).depth
    printed = {row[1]: float(row[2]) for row in by_label["F12-table1"].table.rows}
    assert [printed["$T_1$"], printed["$T_2$"]] == pytest.approx(times, rel=5e-4)
    assert printed[r"$\delta/\delta_0$"] == pytest.approx(depth, rel=5e-4)
    assert times == pytest.approx([0.744, 11.75], rel=1e-3)


@pytest.mark.parametrize(("d", "lam"), [("0.9", "0.05"), ("0.4", "3"), ("0.7", "0.8367")])
def test_slow_manifold_balances_the_weight(d, lam):
    d, lam, carried = mp.mpf(d), mp.mpf(lam), mp.mpf("0.93")
    half, unit = mp.sqrt(d), mp.cbrt(2 * carried)
    roots = mp.polyroots([2, 3 * (lam - half) / unit, 0, -2], maxsteps=500, extraprec=300)
    (beta,) = [mp.re(x) for x in roots if abs(mp.im(x)) < mp.mpf("1e-30") and mp.re(x) > 0]
    assert abs(value(transient_rates.EXCESS, {s.beta: beta}) - (lam - half) / unit) < CLOSE
    right = unit * beta - half
    rate = value(transient_rates.SLOW_RATE, {s.right: right, s.lam: lam, s.d: d})
    assert abs(normal(d, rate, lam) - carried) < CLOSE


# Balances


@pytest.mark.parametrize("label", ["F14-surface", "F14-force", "F14", "F14-power", "F14-energy"])
def test_a_balance_rests_on_names_and_laws_alone(by_label, label):
    """No premise of a balance is itself a sum over all elements or a power of the drive."""
    assert by_label[label].status == "proved"
    sums = [each for each in by_label[label].premises if r"\int" in each]
    named = ("E_{\\mathrm{s}}", "\\bar U", "f_z", "f_x")
    assert all(each.startswith(named) for each in sums)
    laws = r"\lambda f_x", r"d'' = \frac{1"
    assert not any(each.startswith(laws) for each in by_label[label].premises)


@pytest.mark.parametrize(
    ("name", "prove"),
    [
        ("_share", "_force"), ("_height", "_force"), ("_rate", "_power"), ("_height", "_energy"),
        ("_rate", "_energy"), ("_share", "_energy"), ("_speed", "_momentum"),
    ],
)  # fmt: skip
def test_a_slightly_wrong_balance_is_refused(monkeypatch, by_label, name, prove):
    assert "F14-energy" in by_label
    wrong = getattr(transient_balance, name) * (1 + sp.Rational(1, 10**9))
    monkeypatch.setattr(transient_balance, name, wrong)
    with pytest.raises(StepError):
        derive(transient_balance, prove)
