"""The generated closed forms of stability against their derivations, with 50 digits."""

from itertools import product

import mpmath as mp
import numpy as np
import pytest
from kvtheory.derivations import symbols as sym
from kvtheory.derivations.catalogue import catalogue

from kvtheory.theory import closed_forms
from tests.test_emit import OF_MOTION
from tests.test_emit_power_law import exact

ULPS = 12
"""Bound of the rounding error of every function, in units of the spacing of floats at its value."""
TERMS = {
    "friction_rise": lambda q, n, S: S + (1.0 + q) / q,
    "onset_square": lambda T, g, S, h, e: (h + T * g * S) ** 2 + 4.0 * T * abs(e) * h,
    "onset_sum": lambda T, g, S, h, e: h + T * g * S + 2.0 * T * abs(e),
}
"""What has a zero is accurate in units of the sum of its terms."""
SAMPLES = {
    sym.a: (1e-6, 0.7),
    sym.q: (1.0, 0.999, 0.3, 1e-9),
    sym.damper_share: (0.0, 1e-9, 3.0),
    sym.support_rate: (0.0, 0.2, 1e9),
    sym.T_z: (1e-9, 0.3, 1e9),
    sym.T_x: (1e-9, 0.7, 1e9),
    sym.coupling: (1e-12, 0.3),
    sym.S_c: (2.0, 40.0),
    sym.S_z: (1.0, 20.0),
    sym.uncoupled: (0.25, 1.0),
    sym.rise: (-5.0, 1e-9, 0.9),
    sym.Omega: (1e-9, 2.0, 1e9),
    sym.spread: (1e-6, 3.0),
    sym.lag_plus: (0.1, 1.5),
}


@pytest.fixture(scope="module", autouse=True)
def _proved():
    catalogue(until=[form.label for form in OF_MOTION])


@pytest.fixture(autouse=True)
def _fifty_digits():
    with mp.workdps(50):
        yield


def points(form):
    """Yield the arguments of a function; where q is one, l = (1 - q^2)/(2 q) may be another."""
    free = [symbol for symbol in form.arguments if symbol != sym.l]
    for values in product(*(SAMPLES[symbol] for symbol in free)):
        given = dict(zip(free, values, strict=True))
        if sym.l in form.arguments:
            given[sym.l] = (1.0 - given[sym.q]) * (1.0 + given[sym.q]) / (2.0 * given[sym.q])
        yield [given[symbol] for symbol in form.arguments]


@pytest.mark.parametrize("form", OF_MOTION, ids=lambda form: form.name)
def test_functions_agree_at_50_digits(form):
    for values in points(form):
        known = {symbol: mp.mpf(v) for symbol, v in zip(form.arguments, values, strict=True)}
        truth = exact(form.label, form.symbol, known)
        value = getattr(closed_forms, form.name)(*values)
        size = TERMS[form.name](*values) if form.name in TERMS else abs(float(truth))
        assert abs(mp.mpf(float(value)) - truth) <= ULPS * np.spacing(size), (values, truth)


@pytest.mark.parametrize("form", OF_MOTION, ids=lambda form: form.name)
def test_arrays_give_what_floats_give(form):
    rows = list(points(form))
    together = getattr(closed_forms, form.name)(*np.array(rows).T)
    assert together.dtype == np.float64
    single = [getattr(closed_forms, form.name)(*row) for row in rows]
    assert together == pytest.approx(single, rel=1e-15)


def test_the_coupling_and_what_it_leaves_are_one():
    for q in (1.0, 0.6, 1e-6):
        l = (1.0 - q) * (1.0 + q) / (2.0 * q)
        for share in (0.0, 2.0):
            whole = closed_forms.coupling(l, q, share) + closed_forms.uncoupled(q, share)
            assert whole == pytest.approx(1.0, rel=1e-15)
