"""The generated closed forms of the ball against their derivations, with 50 digits."""

import mpmath as mp
import numpy as np
import pytest
from kvtheory.derivations import emit
from kvtheory.derivations import symbols as sym
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.symbols import kappa, l, lam, s

from kvtheory.models.steady.ball import angle_and_tail
from kvtheory.theory import closed_forms
from tests.test_theorems import exact

NUMBERS = (1e-12, 1e-8, 1e-3, 0.1, 0.5, 0.9999, 1.0, 1.0001, 1.842345, 10.0, 1e3, 1e6, 1e12)
ULPS = 12
"""Bound of the rounding error, in units of the spacing of floats at the value or at one."""
OF_BALL = {sym.ball_tail, sym.ball_angle}
FUNCTIONS = [form for form in emit.FORMS if OF_BALL & set(form.arguments)]
NEAR_ONE = {
    "ball_error_load_low", "ball_error_friction_low", "ball_error_l2", "ball_friction_rise",
    "ball_cubed_trailing_edges",
}  # fmt: skip
"""What passes through zero is as accurate as its terms, which are of order one."""


@pytest.fixture(scope="module", autouse=True)
def _proved():
    catalogue(until=["F20-error-friction-high", "F20-slopes"])


@pytest.fixture(autouse=True)
def _fifty_digits():
    with mp.workdps(80):
        yield


def tail(x):
    return 2 * (1 + x * x) ** 2 * mp.atan(1 / x) - 2 * x**3 - mp.mpf(10) / 3 * x


def arguments(form, x):
    """Return the arguments of a form at l = x, of which those of a scaled load follow from s = 0.7."""
    place = 0.7
    values = {
        l: x, lam: x * place, s: place, sym.ball_tail: float(tail(mp.mpf(x))),
        sym.ball_angle: float(mp.atan(1 / mp.mpf(x))),
    }  # fmt: skip
    return {symbol: values[symbol] for symbol in form.arguments}


@pytest.mark.parametrize("form", FUNCTIONS, ids=lambda form: form.name)
@pytest.mark.parametrize("number", NUMBERS)
def test_functions_agree_at_50_digits(form, number):
    if form.name == "ball_tail":
        number = min(number, 1.0)  # beyond, the integral takes its place
    given = arguments(form, number)
    truth = exact(form.label, form.symbol, {key: mp.mpf(value) for key, value in given.items()})
    value = getattr(closed_forms, form.name)(*given.values())
    size = max(abs(float(truth)), 1.0 if form.name in NEAR_ONE | {"ball_tail"} else 0.0)
    assert abs(mp.mpf(value) - truth) <= ULPS * np.spacing(size), (value, float(truth))


@pytest.mark.parametrize("form", FUNCTIONS, ids=lambda form: form.name)
def test_arrays_give_what_floats_give(form):
    rows = [list(arguments(form, number).values()) for number in (1e-9, 0.3, 1e6)]
    function = getattr(closed_forms, form.name)
    assert function(*np.array(rows).T).tolist() == [function(*row) for row in rows]


@pytest.mark.parametrize("number", NUMBERS)
def test_the_tail_is_known_relative_to_what_it_is_added_to(number):
    theta, found = angle_and_tail(np.array([number]))
    truth = tail(mp.mpf(number))
    assert abs(mp.mpf(float(found[0])) - truth) <= 6 * np.spacing(1.0) * (mp.pi + truth) / 4
    if number >= 1.0:
        assert abs(mp.mpf(float(found[0])) / truth - 1) < 2e-15
    assert float(theta[0]) == pytest.approx(float(mp.atan(1 / mp.mpf(number))), rel=1e-15)


@pytest.mark.parametrize("support", [0.0, 1e-3, 1.0, 1e9])
def test_the_critical_velocity_at_a_load(support):
    truth = exact("F20-crossing", sym.ball_lam_cross, {kappa: mp.mpf(support)})
    assert closed_forms.ball_crossing_at_load(support) == pytest.approx(float(truth), rel=1e-15)
