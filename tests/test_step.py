"""What the engine proves, recalls and prints step by step; `test_planted` tries false steps and true ones."""

import pytest
import sympy as sp
from kvtheory.derivations.engine import book, nomenclature
from kvtheory.derivations.engine.book import StepError, established
from kvtheory.derivations.engine.chapter import Chapter
from kvtheory.derivations.engine.step import Proof

from tests import planted
from tests.planted import x, y, z


@pytest.fixture(autouse=True)
def own_labels(monkeypatch):
    """Let each test finish proofs under its own labels."""
    monkeypatch.setattr(book, "_finished", dict(book._finished))


@pytest.fixture
def proof():
    return Proof("trial", None, section="Trial", title="Trial")


s_any = sp.Symbol("s_any", positive=True)
CROSSINGS = {
    "falls from infinity": (1 / y - sp.atan(y), (y, 0, sp.oo), None, True),
    "rises through zero": (sp.exp(x) - 2, (x, 0, 1), None, True),
    "with a letter": (x**3 + s_any * x - s_any, (x, 0, 1), None, True),
    "its slope in another form": (x**2 - 2, (x, 0, 2), 2 * x, True),
    "no zero inside": (sp.exp(x) - 3, (x, 0, 1), None, False),
    "the zero is the end": (x - 1, (x, 0, 1), None, False),
    "the other end": (sp.exp(x) - 1, (x, 0, 1), None, False),
    "zero only in the limit": (1 / y, (y, 0, sp.oo), None, False),
    "an asymptote above zero": (1 + 1 / x, (x, 0, sp.oo), None, False),
    "a jump through a pole": (1 / x, (x, -1, 1), None, False),
    "three zeros": (x**3 - x, (x, -2, 2), None, False),
    "a kink": (sp.Abs(x) + x - 1, (x, -1, 2), None, False),
    "beyond the interval for some letters": (x - s_any, (x, 0, 1), None, False),
    "a slope that is not its own": (x**2 - 3 * x + 1, (x, 0, 2), 2 * x, False),
    "undefined in between": (sp.log(x - 1), (x, 0, 3), None, False),
}
"""Expression, interval, a form of the slope, and whether it vanishes exactly once there."""


@pytest.mark.parametrize("name", CROSSINGS)
def test_one_crossing_is_proved_where_there_is_one(proof, name):
    expr, over, slope, true = CROSSINGS[name]
    if true:
        proof.crossing(expr, over, "once", slope=slope)
    else:
        with pytest.raises(StepError):
            proof.crossing(expr, over, "once", slope=slope)


def test_definitions_are_replaced_in_later_steps(proof):
    proof.define(z, y**2)
    proof.equal(sp.sqrt(z), y, "definition")
    with pytest.raises(StepError, match="defined twice"):
        proof.define(z, y)
    with pytest.raises(StepError, match="circular"):
        proof.define(y, z + 1)


def test_only_what_was_established_can_be_recalled(proof):
    proof.define(z, y**2)
    assert proof.done(z, y**2).status == "definition"
    later = Proof("later", None, section="Trial", title="Later")
    later.recall("trial", (z, y**2))
    later.equal(sp.sqrt(z), y, "recalled")
    assert later.done(sp.sqrt(z), y).uses == ("trial",)
    with pytest.raises(StepError, match="does not establish"):
        later.recall("trial", (x, y**2))
    with pytest.raises(StepError, match="not been derived"):
        later.recall("never", (z, y**2))


def test_only_exact_equalities_can_be_recalled(proof):
    proof.leading_order(y + y**2, y, y, 0, "series", eps=y)
    proof.unique_root(x**2 - 2, (x, 0, 2), "Sturm")
    proof.sign(x, ">", 0, (x, 0, 2), "sign")
    proof.done(y + y**2, y)
    later = Proof("later", None, section="Trial", title="Later")
    for left, right in ((y + y**2, y), (x**2 - 2, 0), (x, 0)):
        with pytest.raises(StepError, match="does not establish"):
            later.recall("trial", (left, right))
        with pytest.raises(StepError, match="does not establish"):
            established("trial", left)


def test_a_result_must_be_a_step(proof):
    with pytest.raises(StepError, match="no step established"):
        proof.done(x, y)


def test_integral_must_be_the_defined_one(proof):
    proof.define(z, sp.Integral(x, (x, 0, y)))
    with pytest.raises(StepError, match="left - right = "):
        proof.integral(z, x, (x, 0, 2 * y), "other bounds")


@pytest.mark.parametrize(
    ("expr", "relation", "over"),
    [
        (x * (1 - x), ">", (x, 0, 1)),
        (x / (x - 1), "<", (x, 0, 1)),
        ((x - 1) ** 2 * (x + 3), ">=", (x, 0, sp.oo)),
        (y * (x**2 + 1), ">", (x, -sp.oo, sp.oo)),
        (-((2 * x - 1) ** 2), "<=", (x, 0, 1)),
    ],
)
def test_sign(proof, expr, relation, over):
    opposite = {">": "<", "<": ">", ">=": "<=", "<=": ">="}[relation]
    proof.sign(expr, relation, 0, over, "sign")
    with pytest.raises(StepError):
        proof.sign(expr, opposite, 0, over, "the opposite")


def test_the_series_of_a_leading_order_is_printed_with_its_sign(proof):
    """The coefficient is not multiplied into a distance from the point, which would lose brackets."""
    proof.leading_order(y**2, sp.S.One, y, 1, "near the end", eps=1 - y)
    proof.leading_order(y, sp.S.One, y, 1, "near the end", eps=1 - y)
    series = [str(step.right) for step in proof.done(y, 1).steps]
    assert r"1 - 2 \left(1 - y\right) + O" in series[0]
    assert r"1 - \left(1 - y\right) + O" in series[1]


@pytest.mark.parametrize(
    ("expr", "leading", "point", "eps", "expected"),
    [
        (sp.sqrt(1 + y**2) - y, 1, 0, y, (-1, 1)),
        (sp.sqrt(1 + y**2) - y, 1 / (2 * y), sp.oo, 1 / y, (sp.Rational(-1, 4), 2)),
        (y**2 / (1 + y), y, sp.oo, 1 / y, (-1, 1)),
        ((1 - y**3) / 3, 1 - y, 1, 1 - y, (-1, 1)),
        (y + y**3, y, 0, y**2, (1, 1)),
        (y + y**2, y, 0, 4 * y**2, (sp.Rational(1, 2), sp.Rational(1, 2))),
    ],
)
def test_leading_order(proof, expr, leading, point, eps, expected):
    assert proof.leading_order(expr, sp.sympify(leading), y, point, "series", eps=eps) == expected
    assert proof.done(expr, leading).status == "proved-leading-order"
    with pytest.raises(StepError):
        proof.leading_order(expr, sp.Rational(101, 100) * leading, y, point, "no", eps=eps)


def test_a_result_carries_premises_and_domain_through_two_recalls():
    planted.fixed_at_one()
    middle = Proof("middle", None, section="Trial", title="Middle")
    middle.recall("at-one", (planted.b, sp.Rational(4, 3)))
    middle.where(planted.x > 1)
    middle.equal(planted.b * planted.x, 4 * planted.x / 3, "scaled")
    middle.done(planted.b * planted.x, 4 * planted.x / 3)
    last = Proof("last", None, section="Trial", title="Last")
    last.recall("middle", (planted.b * planted.x, 4 * planted.x / 3))
    last.equal(planted.b * planted.x + 1, 1 + 4 * planted.x / 3, "and on")
    result = last.done(planted.b * planted.x + 1, 1 + 4 * planted.x / 3)
    assert "y = 1" in result.premises
    assert result.domain == ("x > 1",)


def test_what_a_record_uses_in_words_makes_it_argued():
    planted.fixed_at_one()
    by_words = Proof("by-words", None, section="Trial", title="By words", uses=("at-one",))
    by_words.equal(x + x, 2 * x, "sum")
    assert by_words.done(x + x, 2 * x).status == "argued"


@pytest.mark.parametrize(
    ("name", "value", "domain"),
    [
        (planted.m, planted.x, "x > 0"),
        (planted.u, sp.sqrt(planted.x), "x > 0"),
        (planted.u, sp.log(planted.x), "x > 0"),
        (planted.G(planted.u), planted.x, "x > 0"),
        (sp.Symbol("q", negative=True), planted.x - 1, "x < 1"),
    ],
)
def test_what_is_assumed_of_a_name_becomes_the_domain_of_its_value(proof, name, value, domain):
    proof.define(name, value)
    assert proof.equal(name, value, "by definition") is None
    assert proof.done(name, value).domain == (domain,)


def test_the_name_of_an_integral_restricts_it_too(proof):
    a, b, x, y = planted.a, planted.b, planted.x, planted.y
    proof.integral(y, x, (x, -a, b), "an area")
    assert proof.done(y, sp.factor((b**2 - a**2) / 2)).domain == ("a < b",)


def test_the_interval_of_a_named_root_restricts_nothing_else():
    a, x, y = planted.a, planted.x, planted.y
    source = Proof("edge", None, section="Trial", title="Edge")
    source.root(x**2 - y, x, sp.sqrt(y), "the edge", over=(x, 0, sp.oo), name=a)
    assert source.done(a, sp.sqrt(y)).domain == ()
    later = Proof("later", None, section="Trial", title="Later")
    later.recall("edge", (a, sp.sqrt(y)))
    with pytest.raises(StepError):
        later.holds(x, ">", 0, "x is any place here")


def test_a_title_that_words_prove_is_argued_and_its_lines_are_proved():
    result = Chapter("Trial")

    @result("words")
    def _argued(proof):
        """A root grows faster than a logarithm.

        Twice.

        Argued: It is seen in a plot.
        """
        proof.equal((y + 1) ** 2, y**2 + 2 * y + 1, "twice")

    @result("resting")
    def _proved(proof):
        """Thrice."""
        proof.recall("words")
        proof.equal(x * (y + 1) ** 2, x * (y**2 + 2 * y + 1), "and so")

    @result("naming", uses=("words",))
    def _named(proof):
        """Four times."""
        proof.equal(4 * y, y + y + 2 * y, "four times")

    words, resting, naming = result.derive()
    assert (naming.status, naming.steps[0].status) == ("argued", "proved")
    assert "What it also rests on is used in words" in naming.text
    assert words.status == "argued"
    assert words.text == "Twice. Argued, not checked by machine. It is seen in a plot."
    assert {words.steps[0].status, resting.status} == {"proved"}


def test_a_letter_declared_twice_with_different_assumptions_is_refused(monkeypatch):
    for name in ("BY_NAME", "SYMBOLS", "DECLARED"):
        monkeypatch.setattr(nomenclature, name, getattr(nomenclature, name).copy())
    letter = nomenclature.symbol("own_letter")
    assert nomenclature.symbol("own_letter") == letter
    with pytest.raises(ValueError, match="the letter own_letter is declared twice"):
        nomenclature.symbol("own_letter", real=True)
