"""A shape of one's own: derived as the paper's parabola is, and refused where it cannot be."""

from functools import cache

import mpmath as mp
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.chapters import steady
from kvtheory.derivations.engine.book import established
from kvtheory.derivations.shape import derive_shape, q_root, symbols
from kvtheory.derivations.shape_text import distance, read_shape

from tests.conftest import digits

DIGITS = 30
_digits = digits(DIGITS)


@cache
def results(text):
    """Return the derivations of a shape by their labels, and its closed forms."""
    found = {each.label: each for each in derive_shape(text)}
    names = {"trailing": s.l_r, "load": s.W, "friction": s.F, "coefficient": s.mu}
    return found, {name: established(f"shape-{name}", symbol) for name, symbol in names.items()}


def numbers(rise, forms, point):
    """Return W and F by quadrature of the elements' law, and by the closed forms."""
    values = {symbol: sp.Rational(value) for symbol, value in point.items()}

    def closed(name):
        return mp.mpf(sp.N(forms[name].subs(values).subs(values), DIGITS))

    l_r = closed("trailing")
    values[s.l_r] = sp.Float(str(l_r), DIGITS)
    curves = rise, sp.diff(rise, distance)
    h, slope = (sp.lambdify(distance, each.subs(values), "mpmath") for each in curves)
    K, a, b = (mp.mpf(sp.N(values[x], DIGITS)) for x in (s.K, s.a, s.q))

    def pressure(x, side):
        return K * (h(a) - h(x) + side * l_r * slope(x))

    def force(weight):
        ahead, behind = (
            mp.quad(lambda x, side=side: weight(x, side) * pressure(x, side), [0, end])
            for side, end in ((1, a), (-1, a * b))
        )
        return ahead + behind

    load, friction = force(lambda x, side: 1), force(lambda x, side: side * slope(x))
    return load, friction, [closed(name) for name in ("load", "friction")]


POINT = {s.K: "3.1", s.a: "0.7", s.q: "0.36", q_root: "0.6", s.C: "1", s.V: "1"}


@pytest.mark.parametrize(
    "text",
    ["c*x**4", "c*abs(x)", "x**2/(2*R)", "c*|x| + 2*x^2", "c*|x|**1.5", "b*x**2 + c*|x|**1.5"],
)
def test_load_and_friction_are_the_integrals_of_the_pressure(text):
    found, forms = results(text)
    point = {**POINT, **dict.fromkeys(read_shape(text).parameters, "1.3")}
    load, friction, closed = numbers(read_shape(text).rise, forms, point)
    assert closed == [pytest.approx(load, rel=1e-20), pytest.approx(friction, rel=1e-20)]
    assert {each.status for each in found.values()} <= {
        "definition",
        "proved",
        "proved-leading-order",
    }


def test_the_parabola_is_the_one_of_the_paper():
    _, forms = results("x**2/(2*R)")
    depth = s.a**2 / (2 * s.R)
    for name, known in (("load", steady.load), ("friction", steady.friction)):
        assert sp.simplify(forms[name] - known.subs(s.delta, depth)) == 0
    assert sp.simplify(forms["coefficient"] - steady.friction_coefficient) == 0


@pytest.mark.parametrize("n", [2, 3, 4])
def test_the_limits_of_a_power_are_the_known_ones(n):
    found, _ = results(f"c*abs(x)**{n}")
    slope = sp.Symbol("c", positive=True) * s.a ** (n - 1)
    low, high = (found[f"shape-{name}"].steps[-1].claim.rhs for name in ("low", "high"))
    assert sp.simplify(low - slope * s.l_r / s.a * n * sp.Rational(n + 1, 2 * n - 1)) == 0
    assert sp.simplify(high - slope * sp.Rational(n**2, 2 * n - 1)) == 0


def test_a_wedge_ends_at_its_tip_with_the_slope_as_friction_coefficient():
    found, _ = results("c*|x|")
    assert found["shape-tip"].latex == r"\mu = c"
    assert "shape-high" not in found


def test_it_says_where_closed_forms_end():
    for text, label, said in (
        ("c*x**4", "shape-trailing", True),
        ("c*x**4", "shape-leading", False),
        ("c*|x| + 2*x^2", "shape-leading", True),
        ("x**2/(2*R)", "shape-trailing", False),
    ):
        assert ("no closed form" in results(text)[0][label].text) == said
    assert "has a closed form" in results("x**2/(2*R)")[0]["shape-trailing"].text


@pytest.mark.parametrize(
    "text",
    [
        "", "x", "c*x", "x**3", "c", "c*x**4 + 1", "abs(x)**0.5", "x**2 - x**4", "-x**2", "x**n", "1/x**2",
        "x**13", "x**2/0", "sin(x)", "x.real", "x[0]", "lambda: 1", "__import__('os').system('true')",
        "abs(x, x)", "abs(x)(x)", "f'{x}'", "x if x else x", "(x for x in x)", "a*x**2", "K*x**2", "x**2;x",
        "True*x**2", "9**9**9*x**2", "x**2" + " " * 300, "'x'", "x**2 == 1", "x := 1", "1e999*x**2",
        "x**2**9", "x**2 # <img>", "x**2\n", "x_abs*x**2", "xbar*x**2", "W_ahead*x**2", "q_root*x**2",
        "pi*x**2", "E_A*x**2", "(((2**12)**12)**12)**12*x**2",
        "(a1+a2+a3+a4+a5+a6+a7+a8+a9+b1+b2+b3+b4+b5+b6+b7+b8+b9)**12*x**2",
        "x**2/(a1+a2+a3+a4+a5+a6+a7+a8+a9+b1+b2+b3+b4+b5+b6+b7+b8+b9)**12",
    ],
)  # fmt: skip
def test_what_is_no_shape_is_refused(text):
    with pytest.raises(ValueError, match="shape"):
        derive_shape(text)


@pytest.mark.parametrize(
    "text",
    [
        "a1*x**2 + b1*x**4 + c1*x**6 + d1*x**8 + f1*x**10 + g1*x**12", "b*|x|**(7/5) + c*|x|**(9/7)",
        "b*|x|**(15/11) + c*|x|**(13/12) + x**2", "|x|**1.1 + |x|**1.3 + |x|**1.7 + |x|**1.9 + x**12 + x**2",
        "(a1+a2+a3+b1+b2)*x**2 + c*x**4", "|x| + x**2 + |x|**3 + x**4 + |x|**5 + x**12",
    ],
)  # fmt: skip
def test_sums_whose_closed_forms_would_be_endless_are_refused(text):
    """By their terms, letters and powers, not by a clock."""
    with pytest.raises(ValueError, match="which are too long; take fewer terms"):
        read_shape(text)


def test_the_nomenclature_is_that_of_the_shape():
    """Its half length is not that of a parabola."""
    rows = {row.latex: row for row in symbols("c*x**4")}
    assert (rows["a"].meaning, rows["c"].unit) == ("half length of the contact at rest", "1/m³")
