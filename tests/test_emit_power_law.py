"""The generated closed forms of power law and wedge against their derivations, with 50 digits."""

from functools import cache
from itertools import product

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import emit
from kvtheory.derivations import symbols as sym
from kvtheory.derivations.book import established
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.symbols import exponent as n
from kvtheory.derivations.symbols import l, q

from kvtheory.theory import closed_forms
from tests import test_emit, test_emit_ball

ULPS = 12
"""Bound of the rounding error of every function, in units of the spacing of floats at its value."""
EXPONENTS = (1.0, 1.0001, 1.3, 2.0, 3.0, 7.5, 20.0)
NUMBERS = (1e-12, 1e-8, 1e-3, 0.1, 0.6, 0.999, 1.5, 10.0, 1e3, 1e6, 1e12)
DIFFERENCES = {sym.gap_edge, sym.gap_slope, sym.bend}
SMALL = 0.5
"""Where the forms of what has peeled are used: up to this z."""
CANCELLING = {
    # The two parts of l/m - 1 and of phi at rest, and the slope at the friction maximum, have their
    # zeros; there they are accurate in units of their terms.
    "power_law_friction_rise": 40.0,
    "power_law_error_l1": 24.0,
    "power_law_error_friction_low": 24.0,
}


@pytest.fixture(scope="module", autouse=True)
def _proved():
    catalogue(until=["wedge-weight-peeled"])


@pytest.fixture(autouse=True)
def _fifty_digits():
    with mp.workdps(60):
        yield


@cache
def of_contact(exponent, number):
    """Return everything that a contact is made of, with 60 digits."""
    N, x = mp.mpf(exponent), mp.mpf(number)
    if exponent == 1.0:
        edge = max(mp.mpf(0), 1 - x)
    else:
        start = mp.mpf(0) if N * x < 1 else -mp.log(N * x) / (N - 1)
        t = mp.findroot(lambda t: (N - 1) * t + mp.log(mp.exp(t) + N * x), start, tol=1e-110)
        edge = mp.exp(t)
    Q = 1 / (edge + N * x)
    found = {n: N, l: x, q: edge, sym.Q: Q, sym.z_peeled: N * x * Q}
    found |= {sym.gap_edge: 1 - edge, sym.gap_slope: 1 - Q, sym.bend: x - (1 - edge)}
    y = -mp.log(edge) if edge > 0 else mp.inf
    rise = (N - 1) * y
    found[sym.y] = y
    for symbol, z in ((sym.phi_rise, rise), (sym.phi_fall, -y)):
        found[symbol] = (mp.expm1(z) - z) / z**2 if 0 < abs(z) < mp.inf else mp.mpf(1) / 2
    return found


@cache
def written(label, symbol, names):
    form = established(label, symbol)
    parts = tuple(form.free_symbols - set(names))
    return parts, sp.lambdify([*names, *parts], form, "mpmath")


def exact(label, symbol, known):
    parts, function = written(label, symbol, tuple(known))
    return mp.mpmathify(function(*known.values(), *(exact(label, p, known) for p in parts)))


def near(value, truth, ulps, what):
    spacing = np.spacing(abs(float(truth)))
    assert abs(mp.mpf(float(value)) - truth) <= ulps * spacing, (what, float(value), truth)


OF_CONTACT = [
    form
    for form in emit.FORMS
    if (n in form.arguments or sym.Q in form.arguments)
    and not {sym.s, sym.kappa} & set(form.arguments)
]


def test_every_function_is_tested_here_or_there():
    here = {form.name for form in (*OF_CONTACT, *SCALED, *OF_LOAD)}
    others = (*test_emit.FUNCTIONS, *test_emit.OF_MOTION, *test_emit_ball.FUNCTIONS)
    there = {form.name for form in others} | {"ball_crossing_at_load"}
    assert not here & there
    assert here | there == {form.name for form in emit.FORMS if form.arguments}


@pytest.mark.parametrize("form", OF_CONTACT, ids=lambda form: form.name)
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_functions_of_the_contact_agree_at_50_digits(form, exponent):
    ulps = CANCELLING.get(form.name, ULPS)
    for number in NUMBERS:
        known = of_contact(exponent, number)
        if form.symbol in DIFFERENCES and known[sym.z_peeled] > SMALL:
            continue  # not used there
        rounded = {symbol: mp.mpf(float(known[symbol])) for symbol in form.arguments}
        given = [float(known[symbol]) for symbol in form.arguments]
        truth = exact(form.label, form.symbol, rounded)
        terms = max(abs(truth), mp.mpf(1e-300))
        if form.name in CANCELLING:
            terms = max(terms, known[l] if form.name != "power_law_friction_rise" else 1 + known[l])
        value = getattr(closed_forms, form.name)(*given)
        allowed = ulps * np.spacing(float(terms))
        assert abs(mp.mpf(float(value)) - truth) <= allowed, (form.name, number, value, truth)


SCALED = [form for form in emit.FORMS if {n, sym.s} <= set(form.arguments)]
OF_LOAD = [
    form
    for form in emit.FORMS
    if sym.kappa in form.arguments and form.name != "ball_crossing_at_load"
]


@pytest.mark.parametrize("form", SCALED, ids=lambda form: form.name)
@pytest.mark.parametrize("exponent", EXPONENTS)
def test_scaled_loads_agree_at_50_digits(form, exponent):
    for place, drive in product((1e-6, 0.1, 0.7, 1.0), (1e-12, 1e-3, 1.0, 1e6, 1e12)):
        edge = float(of_contact(exponent, drive / place)[q] * place)
        given = {n: exponent, sym.s: place, sym.r: edge, sym.lam: drive}
        known = {symbol: mp.mpf(value) for symbol, value in given.items()}
        value = getattr(closed_forms, form.name)(*(given[symbol] for symbol in form.arguments))
        near(value, exact(form.label, form.symbol, known), ULPS, (form.name, place, drive))


@pytest.mark.parametrize("form", OF_LOAD, ids=lambda form: form.name)
def test_functions_of_the_support_agree_at_50_digits(form):
    for exponent, support, drive in product(EXPONENTS, (0.0, 1e-9, 0.3, 1e9), (1e-12, 0.3, 1.0)):
        given = {n: exponent, sym.kappa: support, sym.lam: drive}
        known = {symbol: mp.mpf(value) for symbol, value in given.items()}
        value = getattr(closed_forms, form.name)(*(given[symbol] for symbol in form.arguments))
        near(value, exact(form.label, form.symbol, known), ULPS, (form.name, support, drive))


@pytest.mark.parametrize("form", [*OF_CONTACT, *SCALED, *OF_LOAD], ids=lambda form: form.name)
def test_arrays_give_what_floats_give(form):
    """To a digit: an array's powers are not those of a float to the last place."""
    known = [of_contact(2.5, number) for number in (1e-9, 0.3, 1e9)]
    more = {sym.s: 0.7, sym.r: 0.2, sym.lam: 0.4, sym.kappa: 0.5}
    rows = [[float({**more, **one}[symbol]) for symbol in form.arguments] for one in known]
    function = getattr(closed_forms, form.name)
    together = function(*np.array(rows).T)
    assert together.dtype == np.float64
    assert together == pytest.approx([function(*row) for row in rows], rel=1e-15)
