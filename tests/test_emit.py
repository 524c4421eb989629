"""The generated closed forms: the text is what the derivations say, and so are the numbers."""

import re
from itertools import product
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations import emit
from kvtheory.derivations import symbols as sym
from kvtheory.derivations.symbols import l, lam, q, s, xi

from kvtheory.theory import closed_forms
from tests.test_theorems import exact

ULPS = 8
"""Bound of the rounding error of every function, in units of the spacing of floats at its value."""

NUMBERS = (0.0, 1e-150, 1e-12, 1e-8, 1e-3, 0.1, 0.5, 0.75, 1.0, 3**0.5, 10.0, 1e3, 1e6, 1e12, 1e150)
"""Retardation length over half length: edges, near-cancellations and what lies between."""

OF_SHAPES = {emit.n, emit.kappa, emit.z, sym.ball_tail, sym.ball_angle}
"""Arguments of power law, wedge and ball, which `test_emit_power_law` and `test_emit_ball` test."""
OF_MOTION = [form for form in emit.FORMS if form.label.startswith("F22")]
"""Those of stability, which `test_emit_stability` tests."""
FUNCTIONS = [
    form
    for form in emit.FORMS
    if form.arguments and not (OF_SHAPES | {sym.Q}) & set(form.arguments) and form not in OF_MOTION
]
OF_NUMBER = [form for form in FUNCTIONS if set(form.arguments) <= {l, q}]
AT_REST_WITHOUT_LIMIT = {"error_l2_fixed", "error_l2_dead_weight", "error_depth_high"}
"""Asymptotes for high velocity that are infinite at l = 0."""


@pytest.fixture(scope="module")
def source():
    return emit.closed_forms_source()


@pytest.fixture(autouse=True)
def _fifty_digits(source):
    with mp.workdps(50):
        yield


def assert_close(value, truth, what):
    spacing = np.spacing(abs(float(truth)))
    assert abs(mp.mpf(float(value)) - truth) <= ULPS * spacing, (what, float(value), truth)


def test_the_text_is_generated_anew_letter_by_letter(source):
    constraints = (Path(__file__).parents[1] / "constraints.txt").read_text(encoding="utf-8")
    pinned = re.search(r"^sympy==(.+)$", constraints, re.MULTILINE)[1]
    if sp.__version__ != pinned:
        pytest.skip(
            f"the text depends on SymPy's order of terms: {pinned} wrote it, not {sp.__version__}"
        )
    assert emit.TARGET.read_text(encoding="utf-8") == source


def test_the_module_is_replaced_in_one_move(source, tmp_path, monkeypatch):
    monkeypatch.setattr(emit, "TARGET", tmp_path / "closed_forms.py")
    emit.TARGET.write_text("old", encoding="utf-8")
    emit.main()
    assert emit.TARGET.read_text(encoding="utf-8") == source
    assert list(tmp_path.iterdir()) == [emit.TARGET]


def test_an_expression_without_a_numpy_form_is_refused():
    with pytest.raises(TypeError, match="no NumPy code"):
        emit.code(sp.cos(l))


@pytest.mark.parametrize(
    "form", [form for form in emit.FORMS if not form.arguments], ids=lambda f: f.name
)
def test_constants_are_rounded_once(form):
    assert getattr(closed_forms, form.name) == float(exact(form.label, form.symbol, {}))


@pytest.mark.parametrize("form", OF_NUMBER, ids=lambda form: form.name)
@pytest.mark.parametrize("number", NUMBERS)
def test_functions_of_the_number_agree_at_50_digits(form, number):
    """q is computed in floating point as well, so that its rounding error is counted."""
    values = {l: number, q: closed_forms.trailing_edge_ratio(number)}
    function = getattr(closed_forms, form.name)
    arguments = [values[symbol] for symbol in form.arguments]
    if number == 0 and form.name in AT_REST_WITHOUT_LIMIT:
        with pytest.raises(ZeroDivisionError):
            function(*map(float, arguments))
        return
    known = {l: mp.mpf(number)}
    if form.symbol != q:
        known[q] = exact("F16", q, known)
    assert_close(function(*arguments), exact(form.label, form.symbol, known), (form.name, number))


@pytest.mark.parametrize("number", NUMBERS)
def test_pressure_agrees_at_50_digits(number):
    ratio = float(closed_forms.trailing_edge_ratio(number))
    for place in (-1.0, -0.7, 0.0, ratio / 2, ratio * (1 - 1e-12), ratio):
        truth = exact("F16", emit.sym.P, {q: mp.mpf(ratio), xi: mp.mpf(place)})
        assert_close(closed_forms.pressure_factor(ratio, place), truth, (number, place))


SCALED = [form for form in FUNCTIONS if s in form.arguments]


@pytest.mark.parametrize("form", SCALED, ids=lambda form: form.name)
def test_scaled_loads_agree_at_50_digits(form):
    for place, drive in product((1e-6, 0.1, 0.7, 1.0), (0.0, 1e-12, 1e-3, 1.0, 1e6, 1e12, 1e150)):
        truth = exact(form.label, form.symbol, {s: mp.mpf(place), lam: mp.mpf(drive)})
        assert_close(getattr(closed_forms, form.name)(place, drive), truth, (place, drive))


@pytest.mark.parametrize("form", FUNCTIONS, ids=lambda form: form.name)
def test_arrays_give_what_floats_give(form):
    samples = {
        l: [1e-9, 0.3, 1e9],
        q: [1.0, 0.7, 1e-9],
        xi: [-1.0, 0.2, 0.0],
        s: [1.0, 0.5, 1e-4],
        lam: [0, 2, 1e9],
    }
    columns = [np.array(samples[symbol], dtype=float) for symbol in form.arguments]
    function = getattr(closed_forms, form.name)
    result = function(*columns)
    assert result.dtype == np.float64
    assert result.tolist() == [function(*row) for row in zip(*columns, strict=True)]


def test_the_generated_module_needs_numpy_only():
    text = emit.TARGET.read_text(encoding="utf-8")
    assert set(re.findall(r"^(?:from|import) (\w+)", text, re.MULTILINE)) == {"typing", "numpy"}
    assert not re.search(r"\*\* ?[\d.]", text)
