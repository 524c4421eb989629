"""Signs at points end only attempts that must fail, and the series of the engine are those of SymPy."""

import pytest
import sympy as sp
from kvtheory.derivations.engine.algebra import UndecidedError, antiderivative
from kvtheory.derivations.engine.book import StepError
from kvtheory.derivations.engine.conditions import Conditions, proves_positive
from kvtheory.derivations.engine.points import signs
from kvtheory.derivations.engine.series import leading_of_series
from kvtheory.derivations.engine.step import Proof

from tests.planted import _proof

x = sp.Symbol("x", real=True)
y, z, h = sp.symbols("y z h", positive=True)
f = sp.Function("f", real=True)


@pytest.mark.parametrize(
    ("expr", "known", "seen"),
    [
        (y - z, Conditions(), {1, -1}),
        (y - z, Conditions(positive=(y - z,)), {1}),
        (1 - y, Conditions(intervals=((y, 0, 1),)), {1}),
        (x**2 - 1, Conditions(intervals=((x, 2, 2 + z),)), {1}),
        (f(x) - f(y), Conditions(), {1, -1}),
        ((1 + y) ** 3 - 1 - 3 * y - 3 * y**2 - y**3, Conditions(), set()),
        (sp.sqrt(y) ** 2 * 10**9 - y * 10**9, Conditions(), set()),
        (sp.Integral(f(x), (x, 0, 1)), Conditions(), set()),
        (y, Conditions(positive=(-y,)), set()),
        (sp.sqrt(-1 - y), Conditions(), set()),
    ],
)
def test_a_sign_is_seen_only_where_it_is_certain_and_admitted(expr, known, seen):
    assert signs(expr, known.intervals, known.positive) == seen


@pytest.mark.parametrize("power", range(2, 12))
def test_no_rounding_error_passes_for_a_sign(power):
    """A true inequality whose terms cancel to all digits of a float is not given up."""
    close = sp.Rational(1, 10) ** (2 * power)
    assert signs((y + close) ** 2 - y**2 - 2 * close * y) <= {1}
    assert proves_positive(sp.expand((y + close) ** 2 - y**2), Conditions())


@pytest.mark.parametrize(
    "expr",
    [
        (2 * h * sp.exp(h) - 2 * sp.exp(h) + 2) / (h * sp.exp(h) - h),
        sp.sqrt(y + h) - sp.sqrt(y) - h / (2 * sp.sqrt(y)),
        (sp.atan(h) - h) / (1 - sp.sqrt(1 - h**2)),
        sp.exp(-z * h) * (1 + z * h) - 1,
        (h + y) ** z - y**z - z * h * y ** (z - 1),
        sp.exp(sp.atan(h)) - 1 - h,
    ],
)
def test_the_leading_term_is_that_of_sympy(expr):
    coefficient, power = leading_of_series(sp.together(expr), h)
    other, same = expr.leadterm(h)
    assert power == same
    assert sp.simplify(coefficient - other) == 0


def test_what_has_no_series_here_is_left_to_others():
    assert leading_of_series(sp.log(h), h) is None
    assert leading_of_series(sp.sqrt(h) + h, h) is None
    assert leading_of_series(1 - sp.sqrt(1 - h**40), h) is None


@pytest.mark.parametrize(
    "expr", [y**3 * sp.exp(-z * y), sp.exp(y) * sp.exp(-z * y) / 3, 1 / y**2, y**z, 1 + y]
)
def test_an_antiderivative_has_the_right_slope(expr):
    assert sp.simplify(sp.diff(antiderivative(expr, y), y) - expr) == 0


@pytest.mark.parametrize("expr", [1 / y, y * sp.sin(y), sp.exp(-y) / y, sp.exp(y**2)])
def test_an_antiderivative_that_no_rule_gives_is_refused(expr):
    with pytest.raises(UndecidedError, match="no rule for the integral"):
        antiderivative(expr, y)


def test_a_recalled_integral_is_not_evaluated_at_its_place():
    """SymPy's integration is not believed, and must not write a premise."""
    source, over = _proof("an-integral"), (x, 0, 1)
    whole = sp.Integral(sp.exp(-y * x), over)
    source.define(z, whole, "a name")
    source.equal(2 * z, z + z, "twice")
    source.done(2 * z, z + z)
    later = Proof("its-place", None, section="Trial", title="Trial")
    later.recall("an-integral", (z, whole), at={y: sp.Integer(2)})
    assert later._rules[z] == sp.Integral(sp.exp(-2 * x), over)
    with pytest.raises(StepError):
        later.recall("an-integral", (z, whole), at={y: sp.Integer(-2)})


def test_a_letter_that_is_not_positive_is_tried_where_it_can_be():
    u = sp.Symbol("u", nonpositive=True)
    sum_of_arcs = sp.atan((u + 2) / (1 - 2 * u)) - sp.atan(u) - sp.atan(2)
    with pytest.raises(StepError, match="is not an identity"):
        _proof("arcs").equal(sum_of_arcs, -sp.pi, "between 0 and 1/2 only")
