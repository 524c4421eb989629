"""The derivations of forces, rates, slow manifold and balances, against numerical work."""

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations import theorems, transient_balance, transient_motion, transient_rates
from kvtheory.derivations.book import StepError, established

from tests.test_transient_derivations import CLOSE, close, value

pytestmark = pytest.mark.usefixtures("fifty_digits")


def force(d, rate, lam, weight):
    """Integrate weight(xi) times the pressure after a start from rest, by quadrature."""
    trailing = mp.sqrt(d + rate + lam**2) - lam
    return mp.quad(
        lambda xi: weight(xi) * (d - xi**2 + rate - 2 * lam * xi), [-mp.sqrt(d), trailing]
    )


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


def test_an_edge_that_touches_moves_with_the_depth_as_derived(by_label):
    assert by_label["F11-edges"].status == "proved"
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
    """Linearize the motion in SI units in floats: the paper's "1 ms" and "10 ms"."""
    R, K, tau, V, M, weight = 0.01, 1e10, 0.1, 0.1, 1000.0, 9806.65

    def load(depth, rate):
        leading = -np.sqrt(2 * R * depth)
        trailing = np.sqrt(2 * R * (depth + tau * rate) + (V * tau) ** 2) - V * tau
        x = np.polynomial.Polynomial([0, 1])
        pressure = K * (depth - x**2 / (2 * R) + tau * (rate - x * V / R))
        primitive = pressure.integ()
        return primitive(trailing) - primitive(leading)

    low, high = 1e-6, 3e-4
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if load(middle, 0) < weight else (low, middle)
    per_depth = (load(low * 1.0001, 0) - load(low * 0.9999, 0)) / (2e-4 * low)
    per_rate = (load(low, 1e-7) - load(low, -1e-7)) / 2e-7
    times = sorted(-1e3 / np.roots([M, per_rate, per_depth]).real)
    printed = {row[1]: row[2] for row in by_label["F12-table1"].table.rows}
    assert [float(printed["$T_1$"]), float(printed["$T_2$"])] == pytest.approx(times, rel=5e-4)
    assert float(printed[r"$\delta/\delta_0$"]) == pytest.approx(low / 300.177e-6, rel=5e-4)
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
    assert not any(
        each.startswith((r"\lambda f_x", r"d'' = \frac{1")) for each in by_label[label].premises
    )


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
        getattr(transient_balance, prove)()


class Start:
    """A fixed indenter, d = 1, that starts from rest: contact, wake, and the ground left at once."""

    def __init__(self, drive):
        self.drive, self.edge = drive, mp.sqrt(1 + drive**2) - drive

    def parts(self, time):
        """Return (from, to, u, u') for each part of the deformed surface, in terms of xi."""
        drive, edge, way = self.drive, self.edge, self.drive * time
        at_edge = 1 - edge**2

        def wake(xi):
            return at_edge * mp.exp(-(xi - edge) / drive)

        def at_once(xi):
            return (1 - (xi - way) ** 2) * mp.exp(-time)

        return (
            (-1, edge, lambda xi: 1 - xi**2, lambda xi: -2 * drive * xi),
            (edge, edge + way, wake, lambda xi: -wake(xi)),
            (edge + way, 1 + way, at_once, lambda xi: -at_once(xi)),
        )

    def over(self, time, density, parts=slice(None)):
        """Integrate density(u, u') over some parts of the surface."""
        return sum(
            mp.quad(lambda xi, u=u, rate=rate: density(u(xi), rate(xi)), [low, high])
            for low, high, u, rate in self.parts(time)[parts]
        )


@pytest.fixture
def start():
    return Start(mp.mpf("0.6"))


NOW = mp.mpf("0.8")


def change_of(start, density, **parts):
    return mp.diff(lambda time: start.over(time, density, **parts), NOW)


def test_momentum_of_all_elements(start):
    total = start.over(NOW, lambda u, _: u)
    change = change_of(start, lambda u, _: u)
    assert abs(normal(mp.mpf(1), mp.mpf(0), start.drive) - 3 * (total + change) / 4) < 1e-20


def test_energy_of_all_elements(start):
    power = start.drive * friction(mp.mpf(1), mp.mpf(0), start.drive)
    stored = 3 * change_of(start, lambda u, _: u**2) / 8
    lost = 3 * start.over(NOW, lambda _, rate: rate**2) / 4
    assert abs(power - stored - lost) < 1e-20


def test_what_the_contact_hands_over_is_lost_in_the_free_surface(start):
    outside = {"parts": slice(1, None)}
    stored = 3 * start.over(NOW, lambda u, _: u**2, **outside) / 8
    change = 3 * change_of(start, lambda u, _: u**2, **outside) / 8
    handed_over = 3 * (1 - start.edge**2) ** 2 * start.drive / 8
    assert abs(change + 2 * stored - handed_over) < 1e-20
