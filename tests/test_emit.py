"""The generated closed forms: the text is what the derivations say, and so are the numbers, at 50 digits."""

import re
from functools import cache
from itertools import product
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import emit, emit_javascript
from kvtheory.derivations import symbols as sym
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.symbols import exponent as n
from kvtheory.derivations.symbols import kappa, l, lam, q, s

from kvtheory.models.steady.ball import angle_and_tail
from kvtheory.theory import closed_forms
from tests.conftest import digits
from tests.test_theorems import exact

FUNCTIONS = [form for form in emit.FORMS if form.arguments]
ULPS = {"parabola": 8.0, "power_law_friction_rise": 40.0}
"""Bound of the rounding error of a family or a function, in units of the spacing of floats, else `MOST`."""
MOST = 12.0
NUMBERS = (0.0, 1e-150, 1e-12, 1e-8, 1e-3, 0.1, 0.5, 0.75, 1.0, 3**0.5, 10.0, 1e3, 1e6, 1e12, 1e150)
"""Retardation length over half length: edges, near-cancellations and what lies between."""
OF_BALL = (1e-12, 1e-8, 1e-3, 0.1, 0.5, 0.9999, 1.0, 1.0001, 1.842345, 10.0, 1e3, 1e6, 1e12)
OF_POWER_LAW = (1e-12, 1e-8, 1e-3, 0.1, 0.6, 0.999, 1.5, 10.0, 1e3, 1e6, 1e12)
EXPONENTS = (1.0, 1.0001, 1.3, 2.0, 3.0, 7.5, 20.0)
TERMS = {
    **dict.fromkeys(("ball_friction_rise", "ball_cubed_trailing_edges", "ball_tail"), lambda *_: 1.0),
    "power_law_friction_rise": lambda n, l, *_: 1.0 + l,
    "arm_lost": lambda A, B, E, P, eta, z: B * B + E + eta * (A * B + eta * (A * P * z + B)),
    "peeling_friction_force": lambda b, r, rho: b * b * (b * (b + rho) + r * (b + rho)),
    "onset_square": lambda T, g, S, h, e: (h + T * g * S) ** 2 + 4.0 * T * abs(e) * h,
    "onset_sum": lambda T, g, S, h, e: h + T * g * S + 2.0 * T * abs(e),
}  # fmt: skip
"""What has a zero is accurate in units of the sum of its terms."""
HALF = sp.Symbol("x_v", positive=True)
"""Of `sym.arm_number`."""
PLACES = {
    HALF: (0.0, 1e-9, 0.7, 2.0),
    sym.T_z: (1e-9, 0.3, 1e9), sym.T_x: (1e-9, 0.7, 1e9), sym.coupling: (1e-12, 0.3), sym.S_c: (2.0, 40.0),
    sym.S_z: (1.0, 20.0), sym.uncoupled: (0.25, 1.0), sym.rise: (-5.0, 1e-9, 0.9),
    sym.Omega: (1e-9, 2.0, 1e9), sym.spread: (1e-6, 3.0), sym.lag_plus: (0.1, 1.5),
    sym.b: (1e-6, 1.4), sym.right: (0.0, 0.7), sym.rho: (0.1, 1e6),
    sym.moment_mean: (1.0, 1e-9), sym.ratio_first: (1.0 / 3.0, 1e-9),
    sym.ratio_second: (0.2, 1e-9), sym.arm_number: (0.0, 1e-9, 1e9), sym.moment_slant: (0.0, 0.3),
    sym.moment_twist: (0.0, 0.08), sym.moment_ahead: (0.5, 1e-9), sym.excess_share: (0.0, 0.5),
    sym.spring_share: (1e-9, 0.3, 1.0),
}  # fmt: skip
"""Where forms of numbers that do not depend on one another are tested."""


@pytest.fixture(scope="module", autouse=True)
def _proved():
    catalogue()


_digits = digits(80)


def tail(x):
    return 2 * (1 + x * x) ** 2 * mp.atan(1 / x) - 2 * x**3 - mp.mpf(10) / 3 * x


@cache
def contact(exponent, number):
    """Return what the contact of a power law is made of."""
    N, x = mp.mpf(exponent), mp.mpf(number)
    if exponent == 1.0:
        edge = max(mp.mpf(0), 1 - x)
    else:
        start = mp.mpf(0) if N * x < 1 else -mp.log(N * x) / (N - 1)
        t = mp.findroot(lambda t: (N - 1) * t + mp.log(mp.exp(t) + N * x), start, tol=1e-110)
        edge = mp.exp(t)
    return {n: N, l: x, q: edge, sym.Q: 1 / (edge + N * x)}


def of_number(form):
    """q is computed in floating point as well, so that its rounding error is counted."""
    for number in NUMBERS:
        known = {l: mp.mpf(number)}
        if form.symbol != q:
            known[q] = exact("F16", q, known)
        yield {l: number, q: closed_forms.trailing_edge_ratio(number)}, known


def of_scaled_load(form):
    for place, drive in product((1e-6, 0.1, 0.7, 1.0), (0.0, 1e-12, 1e-3, 1.0, 1e6, 1e12, 1e150)):
        yield {s: place, lam: drive}, None


def of_ball(form):
    for number in OF_BALL:
        x = min(number, 1.0) if form.name == "ball_tail" else number  # beyond, an integral is used
        angle, rest = float(mp.atan(1 / mp.mpf(x))), float(tail(mp.mpf(x)))
        yield {l: x, lam: 0.7 * x, s: 0.7, sym.ball_tail: rest, sym.ball_angle: angle}, None


def of_contact(form):
    for point in product(EXPONENTS, OF_POWER_LAW):
        yield {symbol: float(value) for symbol, value in contact(*point).items()}, None


def of_scaled_power_law(form):
    points = product(EXPONENTS, (1e-6, 0.1, 0.7, 1.0), (1e-12, 1e-3, 1.0, 1e6, 1e12))
    for exponent, place, drive in points:
        edge = float(contact(exponent, drive / place)[q] * place)
        yield {n: exponent, s: place, sym.r: edge, lam: drive}, None


def of_support(form):
    for exponent, support, drive in product(
        EXPONENTS, (0.0, 1e-9, 1e-3, 0.3, 1.0, 1e9), (1e-12, 0.3, 1.0)
    ):
        yield {n: exponent, kappa: support, lam: drive}, None


def of_places(form):
    for values in product(*(PLACES[symbol] for symbol in form.arguments)):
        if form.name == "springpot_twist" and values == (1.0,):
            continue  # of the order 0, over which it is taken
        yield dict(zip(form.arguments, values, strict=True)), None


FAMILIES = (
    ("numbers", of_places, lambda form, given: form.label[:3] in ("F11", "F17", "F22")),
    ("support", of_support, lambda form, given: kappa in given),
    ("ball", of_ball, lambda form, given: {sym.ball_tail, sym.ball_angle} & given),
    ("scaled power law", of_scaled_power_law, lambda form, given: {n, s} <= given),
    ("power law", of_contact, lambda form, given: {n, sym.Q} & given),
    ("parabola", of_scaled_load, lambda form, given: s in given),
    ("parabola", of_number, lambda form, given: given <= {l, q}),
)
"""Names, the points at which they are tested, and what belongs to them; the first that fits is taken."""


def points(form):
    """Yield the arguments of a function, the truth there, and what it may be wrong by."""
    family, given = next(
        (name, points) for name, points, holds in FAMILIES if holds(form, set(form.arguments))
    )
    ulps = ULPS.get(form.name, ULPS.get(family, MOST))
    for values, known in given(form):
        arguments = [values[symbol] for symbol in form.arguments]
        at = known or dict(zip(form.arguments, map(mp.mpf, arguments), strict=True))
        at |= {symbol: 2 * at.get(HALF, mp.mpf(0)) for symbol, _ in form.at}
        truth = exact(form.label, form.symbol, at) * mp.mpmathify(form.times.subs(at))
        size = abs(float(truth))
        if form.name in TERMS:
            size = max(size, TERMS[form.name](*arguments))
        yield (
            arguments,
            truth,
            ulps * np.spacing(max(size, 1e-300) if family == "power law" else size),
        )


@pytest.mark.parametrize("form", FUNCTIONS, ids=lambda form: form.name)
def test_functions_agree_with_their_derivations(form):
    function = getattr(closed_forms, form.name)
    for arguments, truth, allowed in points(form):
        value = mp.mpf(float(function(*arguments)))
        assert abs(value - truth) <= allowed, (arguments, float(value), float(truth))


@pytest.mark.parametrize("form", FUNCTIONS, ids=lambda form: form.name)
def test_arrays_give_what_floats_give(form):
    """To a digit where powers are taken: those of an array are not those of a float to the last place."""
    rows = [arguments for arguments, _, _ in points(form)][::3]
    function = getattr(closed_forms, form.name)
    together = function(*np.array(rows, dtype=float).T)
    assert together.dtype == np.float64
    assert together == pytest.approx([function(*row) for row in rows], rel=1e-15)
    if n not in form.arguments and not form.label.startswith("F22"):
        assert together.tolist() == [function(*row) for row in rows]


@pytest.mark.parametrize(
    "form", [form for form in emit.FORMS if not form.arguments], ids=lambda form: form.name
)
def test_constants_are_rounded_once(form):
    assert getattr(closed_forms, form.name) == float(exact(form.label, form.symbol, {}))


@pytest.mark.parametrize("number", OF_BALL)
def test_the_tail_of_a_ball_is_known_relative_to_what_it_is_added_to(number):
    theta, found = angle_and_tail(np.array([number]))
    assert angle_and_tail(number) == pytest.approx((theta[0], found[0]), rel=1e-15)
    truth = tail(mp.mpf(number))
    assert abs(mp.mpf(float(found[0])) - truth) <= 6 * np.spacing(1.0) * (mp.pi + truth) / 4
    if number >= 1.0:
        assert abs(mp.mpf(float(found[0])) / truth - 1) < 2e-15
    assert float(theta[0]) == pytest.approx(float(mp.atan(1 / mp.mpf(number))), rel=1e-15)


@pytest.mark.parametrize("language", [emit, emit_javascript])
def test_the_text_is_generated_anew_letter_by_letter(language):
    constraints = (Path(__file__).parents[1] / "constraints.txt").read_text(encoding="utf-8")
    pinned = re.search(r"^sympy==(.+)$", constraints, re.MULTILINE)[1]
    if sp.__version__ != pinned:
        pytest.skip(f"the order of terms is that of SymPy {pinned}, not {sp.__version__}")
    assert language.TARGET.read_text(encoding="utf-8") == language.closed_forms_source()


def test_the_module_is_replaced_in_one_move(tmp_path, monkeypatch):
    monkeypatch.setattr(emit, "TARGET", tmp_path / "closed_forms.py")
    emit.TARGET.write_text("old", encoding="utf-8")
    emit.main()
    assert emit.TARGET.read_text(encoding="utf-8") == emit.closed_forms_source()
    assert list(tmp_path.iterdir()) == [emit.TARGET]


def test_an_expression_without_a_numpy_form_is_refused():
    with pytest.raises(TypeError, match="no NumPy code"):
        emit.code(sp.cos(l))


def test_the_generated_module_needs_numpy_only():
    text = emit.TARGET.read_text(encoding="utf-8")
    assert set(re.findall(r"^(?:from|import) (\w+)", text, re.MULTILINE)) == {"typing", "numpy"}
    assert not re.search(r"\*\* ?[\d.]", text)
