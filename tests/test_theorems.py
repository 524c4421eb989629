"""The theorems and F20 against quadrature of the definitions with 50 digits, which shares nothing with them.

Units: K = R = 1. The parabola with half length 1 has the depth 1/2, so that l = l_r, mu R/a = mu.
"""

from dataclasses import replace
from functools import cache

import mpmath as mp
import pytest
import sympy as sp
from kvtheory.derivations import emit
from kvtheory.derivations import symbols as sym
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.chapters import asymptote_errors, circle, energy, master_curve, theorems
from kvtheory.derivations.engine.book import StepError, established
from kvtheory.derivations.symbols import kappa, l, lam, q, s, xi

from tests.conftest import digits
from tests.planted import derive

_digits = digits(50)

ERRORS = {
    "error-load-low": sym.e_load_low, "error-friction-low": sym.e_friction_low, "error-L1": sym.e_l1,
    "error-load-high": sym.e_load_high, "error-friction-high": sym.e_friction_high,
    "error-L2-fixed": sym.e_l2_fixed, "error-L2-dead-weight": sym.e_l2_weight,
    "error-depth-low": sym.e_depth_low, "error-depth-high": sym.e_depth_high,
}  # fmt: skip
OWNER = {form.symbol: form.label for form in emit.FORMS} | {
    symbol: label for label, symbol in ERRORS.items()
}
NUMBERS = ("1e-4", "0.1", "0.75", "1", "1.7", "30", "1e5")
"""Retardation length over half length."""


@pytest.fixture(scope="module", autouse=True)
def _proved():
    return catalogue(until=["F20-slopes"])


@cache
def compiled(label, symbol, names):
    """Return the last form of a quantity as a function of these and of its other parts, and those parts."""
    form = established(label, symbol)
    parts = tuple(form.free_symbols - set(names))
    return sp.lambdify([*names, *parts], form, "mpmath"), parts


def exact(label, symbol, known):
    """Evaluate the last form of a quantity, and so on for what it is made of, from known values."""
    function, parts = compiled(label, symbol, tuple(known))
    more = [exact(OWNER.get(part, label), part, known) for part in parts]
    return mp.mpmathify(function(*known.values(), *more))


def state(number):
    number = mp.mpf(number)
    return {l: number, q: mp.sqrt(1 + number**2) - number}


def near(value, truth, digits=40):
    return abs(value - truth) <= abs(truth) * mp.mpf(10) ** -digits


def forces(depth, l_r, shape, slope, leading):
    """Integrate p = depth - h - l_r h' and -h' p from the leading edge to where p vanishes."""

    def pressure(x):
        return depth - shape(x) - l_r * slope(x)

    guess = mp.sqrt(2 * depth + l_r**2) - l_r
    trailing = mp.findroot(pressure, guess, tol=mp.mpf(10) ** (-1.8 * mp.mp.dps))
    # Two pieces: the outlet side may have almost peeled off.
    pieces = [leading, 0, trailing]
    return mp.quad(pressure, pieces), mp.quad(lambda x: -slope(x) * pressure(x), pieces)


def parabola(l_r, depth=0.5):
    depth = mp.mpf(depth)
    return forces(depth, mp.mpf(l_r), lambda x: x * x / 2, lambda x: x, -mp.sqrt(2 * depth))


def true_circle(l_r, depth):
    height, slope = (lambda x: 1 - mp.sqrt(1 - x * x)), (lambda x: x / mp.sqrt(1 - x * x))
    return forces(depth, mp.mpf(l_r), height, slope, -mp.sqrt(1 - (1 - depth) ** 2))


@pytest.mark.parametrize(
    ("module", "name", "prove"),
    [
        (theorems, "LOAD", "_rational"),
        (theorems, "FRICTION_FORCE", "_rational"),
        (theorems, "FRICTION_COEFFICIENT", "_rational"),
        (theorems, "STABLE_FRICTION_FORCE", "_cancellation"),
        (theorems, "STABLE_FRICTION_COEFFICIENT", "_cancellation"),
        (theorems, "SCALED_LOAD", "_scaled_load"),
        (master_curve, "DRIVE_CUBED", "_master_curve"),
        (master_curve, "FRICTION_CUBED", "_master_curve"),
        (master_curve, "PEAK", "_peak"),
        (energy, "FRACTION", "_parabola"),
        (circle, "CORRECTION", "_fixed"),
        (circle, "RECEDES", "_shape"),
        (circle, "LOAD_COEFFICIENT", "_fixed"),
        (circle, "FORCE_COEFFICIENT", "_fixed"),
        (circle, "LOADED_COEFFICIENT", "_dead_weight"),
    ],
)
def test_a_slightly_wrong_formula_is_refused(monkeypatch, module, name, prove):
    monkeypatch.setattr(module, name, getattr(module, name) * (1 + sp.Rational(1, 10**9)))
    with pytest.raises(StepError):
        derive(module, prove)


@pytest.mark.parametrize("error", asymptote_errors.ASYMPTOTES, ids=lambda error: error.label)
def test_a_tighter_bound_and_a_wrong_direction_are_refused(error):
    step = sp.Rational(1, 1000)
    for wrong in (
        replace(error, lower=error.lower + step),
        replace(error, upper=error.upper - step),
        replace(error, growth="<" if error.growth == ">" else ">"),
    ):
        with pytest.raises(StepError):
            derive(asymptote_errors, "_error", asymptote=wrong)


@pytest.mark.parametrize("number", NUMBERS)
def test_the_rational_forms_are_the_integrals_of_the_definitions(number):
    """F1 and F16, the split of the power (F6), and the master curve (F2)."""
    (load, friction), known = parabola(number), state(number)
    inside = known[l] * mp.quad(lambda x: x * x, [-1, 0, known[q]])
    drive, height = known[l] ** 3 / load, (friction / load) ** 3 / load
    for label, symbol, truth in (
        ("F1", sym.w, 2 * load),
        ("F1", sym.phi, 2 * friction),
        ("F16", sym.phi, 2 * friction),
        ("F1", sym.m, friction / load),
        ("F16", sym.m, friction / load),
        ("F6", sym.eta, inside / friction),
        ("F2", sym.X, drive),
        ("F2", sym.Y, height),
    ):
        assert near(exact(label, symbol, known), truth), label
    assert near(exact("F2", sym.T, known) ** 3, height / drive)
    assert 4 - mp.mpf(10) ** -40 <= 5 * exact("F6", sym.eta, known) <= 5


@pytest.mark.parametrize("number", NUMBERS)
def test_f7_is_the_maximum_of_the_pressure(number):
    known = state(number)
    places = [(1 + known[q]) * k / 20 - 1 for k in range(20)]
    pressures = [exact("F16", sym.P, known | {xi: place}) for place in places]
    for place, pressure in zip(places, pressures, strict=True):
        assert near(pressure, 1 - place**2 - 2 * known[l] * place)
    peak = exact("F7", sym.P_max, known)
    assert max(pressures) <= peak * (1 + mp.mpf(10) ** -40)
    assert near(peak, exact("F16", sym.P, known | {xi: max(-known[l], -mp.mpf(1))}))


@pytest.mark.parametrize("drive", ["0.003", "1", "40"])
def test_scaled_load_and_its_slopes(drive):
    drive, side = mp.mpf(drive), mp.mpf("0.7")

    def scaled(symbol, place=side):
        return exact("scaled-load", symbol, {s: place, lam: drive})

    load, _ = parabola(drive / side)  # lengths scaled by a, so that W = K a^3/R times this
    assert near(scaled(sym.f), side**3 * load * mp.mpf(3) / 2)
    for slope, of in ((sym.f_s, sym.f), (sym.f_ss, sym.f_s)):
        assert near(scaled(slope), mp.diff(lambda place, of=of: scaled(of, place), side), 20)


@pytest.mark.parametrize("support", [0, 0.5, 100])
def test_the_balance_is_as_well_conditioned_as_claimed(support):
    def depth(excess):
        def balance(place):
            load = exact("scaled-load", sym.f, {s: place, lam: mp.mpf(3)})
            return load + support * place**2 - (1 + support) * (1 + excess)

        return mp.findroot(balance, 0.7, tol=mp.mpf(10) ** -90) ** 2

    off = mp.mpf(10) ** -12
    assert 0.6 * off < depth(off) / depth(0) - 1 < 1.000001 * off
    load = exact("scaled-load", sym.f, {s: mp.sqrt(depth(0)), lam: mp.mpf(3)})
    known = {s: mp.sqrt(depth(0)), q: state(3 / mp.sqrt(depth(0)))[q], kappa: support}
    claimed = exact("error-load-suspended", sym.e_load_spring, known)
    assert abs(claimed - ((1 + support) / load - 1)) < mp.mpf(10) ** -35


def test_f3_is_the_maximum_of_the_quadratures():
    def height(number):
        load, friction = parabola(number)
        return friction / load / mp.cbrt(load)

    number = mp.findroot(lambda u: mp.diff(height, u), 1.7)
    assert near(number, mp.sqrt(3), 15)
    assert near(exact("F3", q, {}), state(number)[q], 15)
    assert near(exact("F3-values", sym.mu_peak, {}), height(mp.sqrt(3)))
    drive = mp.sqrt(3) / mp.cbrt(parabola(mp.sqrt(3))[0])
    assert near(exact("F3-values", sym.Lambda_peak, {}), drive)
    assert [mp.nstr(value, 6) for value in (drive, height(mp.sqrt(3)))] == ["1.60027", "0.507265"]


def test_f5_is_where_the_asymptotes_meet():
    alpha = 2 * mp.sqrt(2) / 3
    assert near(exact("F5", sym.Lambda_fixed, {}), alpha)
    critical = exact("F5", sym.Lambda_weight, {})
    assert near(critical, alpha / mp.sqrt(critical))  # C V/(R K) = alpha sqrt(W/(R C V)), W = 1
    beyond = exact("F3-values", sym.Lambda_peak, {}) / critical
    assert near(beyond**3, 27 * (1 + mp.sqrt(3)) / 16)
    assert mp.nstr(beyond, 4) == "1.664"


def asymptotes(number):
    """Eqs. 40-46 and 49 over the exact values, by quadrature; C V = l."""
    viscous, depth = mp.mpf(number), mp.mpf("0.5")
    load, friction = parabola(number)
    mu, alpha = friction / load, 2 * mp.sqrt(2) / 3
    return {
        "error-load-low": 2 * alpha * depth**1.5 / load,
        "error-friction-low": 2 * alpha * viscous * depth**1.5 / friction,
        "error-L1": viscous / mu,
        "error-load-high": viscous * depth / load,
        "error-friction-high": alpha * viscous * depth**1.5 / friction,
        "error-L2-fixed": alpha * mp.sqrt(depth) / mu,
        "error-L2-dead-weight": alpha * mp.sqrt(load / viscous) / mu,
        "error-depth-low": mp.cbrt(load / (2 * alpha)) ** 2 / depth,
        "error-depth-high": load / viscous / depth,
    }


@pytest.mark.parametrize("number", NUMBERS)
def test_errors_are_those_of_the_papers_formulas_and_keep_their_bounds(number):
    truth, l_r = asymptotes(number), mp.mpf(number)
    assert set(truth) == set(ERRORS)
    for label, symbol in ERRORS.items():
        assert near(exact(label, symbol, state(number)), truth[label] - 1, 30), label
    assert 0 < truth["error-depth-low"] - 1 < l_r**2 / 2
    assert truth["error-L2-dead-weight"] < (1 + 2 / (3 * l_r)) ** 2


def second_order(corrected, coarse="1e-3"):
    """Fit the order of what a correction leaves out, as eps = (a/R)^2 is halved twice."""
    left = [abs(corrected(mp.mpf(coarse) / 2**k)) for k in range(3)]
    return all(3.98 < left[k] / left[k + 1] < 4.02 for k in range(2))


@pytest.mark.parametrize("number", ["0.1", "4"])
@mp.workdps(20)
def test_the_circle_at_given_depth(number):
    known = state(number)

    def left_out(eps, of, symbol):
        pair = [shape(known[l] * mp.sqrt(eps), eps / 2) for shape in (true_circle, parabola)]
        ratio = of(*pair[0]) / of(*pair[1])
        return ratio - 1 - exact("circle-fixed", symbol, known) * eps

    for symbol, of in (
        (sym.c_w, lambda load, friction: load),
        (sym.c_f, lambda load, friction: friction),
        (sym.c_mu, lambda load, friction: friction / load),
    ):
        assert second_order(lambda eps, of=of, symbol=symbol: left_out(eps, of, symbol)), symbol


@pytest.mark.parametrize("end", ["1e-3", "0.3", "0.9", "0.999"])
def test_the_square_of_the_slope_of_a_circle(end):
    end = mp.mpf(end)
    truth = mp.quad(lambda place: mp.diff(lambda x: 1 - mp.sqrt(1 - x * x), place) ** 2, [0, end])
    slope = end / mp.sqrt(1 - end**2)
    assert near(exact("circle-steepness", sym.slope_square, {sym.tilt: slope}), truth, 20)


@pytest.mark.parametrize("number", ["1e-3", "0.2", "0.38"])
def test_the_place_of_the_peak_pressure_of_a_circle(number):
    number = mp.mpf(number)
    angle = mp.asin(mp.sqrt(27) / 2 * number) / 3
    place = exact("circle-peak", sym.turning, {sym.turning_angle: angle})

    def pressure(y):
        return mp.sqrt(1 - y * y) + number * y / mp.sqrt(1 - y * y)

    assert near(mp.diff(pressure, place) + 1, mp.mpf(1), 20)
    assert pressure(place) > max(pressure(0.9 * place), pressure(1.05 * place))


@pytest.mark.parametrize("number", ["0.1", "4"])
@mp.workdps(20)
def test_the_circle_at_given_load(number):
    known = state(number)

    def at_load(eps):
        l_r = known[l] * mp.sqrt(eps)
        load, friction = parabola(l_r, eps / 2)
        excess, guesses = (lambda d: true_circle(l_r, d)[0] / load - 1), (eps / 2, eps / 1.98)
        depth = mp.findroot(excess, guesses, tol=mp.mpf(10) ** (-1.2 * mp.mp.dps))
        return depth / (eps / 2) - 1, true_circle(l_r, depth)[1] / friction - 1

    for index, symbol in enumerate((sym.c_delta_load, sym.c_mu_load)):
        c = exact("circle-dead-weight", symbol, known)
        assert second_order(lambda eps, i=index, c=c: at_load(eps)[i] - c * eps), symbol


# The ball


def tail(x):
    return exact("F20-load", sym.ball_tail, {l: x, sym.ball_angle: mp.atan(1 / x)})


def strip(x, y, power):
    """W_2 or F_2 of a strip over K delta a, by integrals of its pressure."""
    A = mp.sqrt(1 - y * y)
    end = mp.sqrt(A * A + x * x) - x
    return mp.quad(lambda xi: (-2 * xi) ** power * (A * A - xi * xi - 2 * x * xi), [-A, end])


@pytest.mark.parametrize("number", ["0.3", "20"])
@mp.workdps(16)
def test_load_and_friction_are_sums_over_strips(number):
    x = mp.mpf(number)
    known = {l: x, sym.ball_tail: tail(x)}

    def total(power):
        pieces = [0, 0.5, 1, 1.4, mp.pi / 2]
        return 2 * mp.quad(lambda t: strip(x, mp.sin(t), power) * mp.cos(t), pieces)

    load, friction = total(0), total(1) / 2
    assert mp.almosteq(exact("F20-load", sym.ball_load, known), load, 1e-12)
    assert mp.almosteq(exact("F20", sym.ball_coefficient, known), friction / load, 1e-10)


@pytest.mark.parametrize("number", ["1e-3", "0.3", "20"])
def test_the_sums_of_trailing_edges(number):
    x = mp.mpf(number)
    for symbol, power in ((sym.ball_edges, 1), (sym.ball_cubes, 3)):
        truth = mp.quad(
            lambda t, n=power: (mp.hypot(mp.cos(t), x) - x) ** n * mp.cos(t),
            [0, 0.5, 1, 1.4, 1.55, 1.57, mp.pi / 2],
        )
        found = exact("F20-slopes", symbol, {l: x, sym.ball_tail: tail(x)})
        assert mp.almosteq(found, truth, 1e-14)


def test_the_maximum_is_where_the_root_is():
    def rise(x):
        return exact("F20-peak", sym.ball_slip, {l: x, sym.ball_tail: tail(x)})

    root = mp.findroot(rise, mp.mpf("1.8"))
    assert mp.nstr(root, 8) == "1.8423449"

    def friction(x):
        known = {l: x, sym.ball_tail: tail(x)}
        load = exact("F20-load", sym.ball_load, known)
        return exact("F20", sym.ball_coefficient, known) * load ** mp.mpf("-0.25")

    assert abs(mp.diff(friction, root)) < 1e-10
    assert friction(root) > max(friction(root * 0.99), friction(root * 1.01))


@pytest.mark.parametrize("drive", ["0.001", "1", "1000"])
def test_the_load_grows_between_its_third_and_fourth_power(drive):
    drive, place = mp.mpf(drive), mp.mpf("0.6")

    def load(at):
        known = {s: at, lam: drive, sym.ball_tail: tail(drive / at)}
        return exact("F20-balance", sym.ball_scaled, known)

    growth = mp.diff(lambda u: mp.log(load(mp.exp(u))), mp.log(place))
    known = {s: place, lam: drive, sym.ball_angle: mp.atan(place / drive)}
    told = exact("F20-balance", sym.ball_scaled_s, known)
    assert 3 < growth < 4
    assert mp.almosteq(growth * load(place), told, 1e-10)


@pytest.mark.parametrize("exponent", ["1.1", "2", "3.5"])
@pytest.mark.parametrize("edge", ["0.9", "0.3", "1e-6"])
def test_a_power_law_stays_within_its_bounds_of_high_velocity(by_label, exponent, edge):
    """F19-high against integrals of the pressure, p/(K delta) = 1 - y^n +- n l y^(n - 1)."""
    n, q = mp.mpf(exponent), mp.mpf(edge)
    l = (1 - q**n) / (n * q ** (n - 1))

    def under(y, side, power):
        return (n * y ** (n - 1)) ** power * (1 - y**n + side * l * n * y ** (n - 1))

    load, friction = (
        mp.quad(lambda y, k=power: under(y, 1, k), [0, 1])
        + sign * mp.quad(lambda y, k=power: under(y, -1, k), [0, q])
        for power, sign in ((0, 1), (1, -1))
    )
    limit = n**2 / (2 * n - 1)
    assert 0 < load / l - 1 < 2 * n / ((n + 1) * l)
    assert 0 < friction / l - limit < 1 / (2 * l) + 1 / ((2 * n - 1) * l**2)
    assert by_label["F19-high"].status == "proved"
