"""No planted false step is accepted, and no true one is refused."""

import pytest
import sympy as sp
from kvtheory.derivations.book import StepError
from kvtheory.derivations.step import Proof

from tests import planted


@pytest.fixture
def proof():
    return Proof("trial", None, section="Trial", title="Trial")


def test_the_tables_are_long():
    assert min(len(planted.FALSE), len(planted.TRUE)) >= 60


@pytest.mark.parametrize("name", planted.FALSE)
def test_false_steps_are_refused(proof, name):
    with pytest.raises(StepError):
        planted.FALSE[name](proof)


@pytest.mark.parametrize("name", planted.TRUE)
def test_true_steps_are_accepted(proof, name):
    planted.TRUE[name](proof)


def test_a_result_carries_premises_and_domain_through_two_recalls():
    planted._fixed_at_one()
    middle = Proof("middle", None, section="Trial", title="Middle")
    middle.recall("at-one", planted.b, sp.Rational(4, 3))
    middle.where(planted.x > 1)
    middle.equal(planted.b * planted.x, 4 * planted.x / 3, "scaled")
    middle.done(planted.b * planted.x, 4 * planted.x / 3)
    last = Proof("last", None, section="Trial", title="Last")
    last.recall("middle", planted.b * planted.x, 4 * planted.x / 3)
    last.equal(planted.b * planted.x + 1, 1 + 4 * planted.x / 3, "and on")
    result = last.done(planted.b * planted.x + 1, 1 + 4 * planted.x / 3)
    assert "y = 1" in result.premises
    assert result.domain == ("x > 1",)


def test_a_sampled_step_stays_sampled_when_it_is_recalled_twice():
    x, y, z = sp.symbols("x y z", positive=True)
    first = Proof("first", None, section="Trial", title="First")
    first.define(z, sp.exp(sp.log(y) / 3))
    first.sampled(z, y ** sp.Rational(1, 3), [(y, 1, 2)], "numbers")
    first.done(z, y ** sp.Rational(1, 3))
    second = Proof("second", None, section="Trial", title="Second")
    second.recall("first", z, y ** sp.Rational(1, 3))
    second.equal(z**3, y, "cubed")
    assert second.done(z**3, y).status == "sampled"
    third = Proof("third", None, section="Trial", title="Third")
    third.recall("second", z**3, y)
    third.equal(2 * z**3, 2 * y, "doubled")
    assert third.done(2 * z**3, 2 * y).status == "sampled"
    by_words = Proof("by-words", None, section="Trial", title="By words", uses=("second",))
    by_words.equal(x + x, 2 * x, "sum")
    assert by_words.done(x + x, 2 * x).status == "sampled"


@pytest.mark.parametrize(
    ("name", "value", "domain"),
    [
        (planted.m, planted.x, "x > 0"),
        (planted.u, sp.sqrt(planted.x), "x > 0"),
        (planted.u, sp.log(planted.x), "x > 0"),
        (planted.g(planted.u), planted.x, "x > 0"),
        (sp.Symbol("q", negative=True), planted.x - 1, "x < 1"),
    ],
)
def test_what_is_assumed_of_a_name_becomes_the_domain_of_its_value(proof, name, value, domain):
    proof.define(name, value)
    assert proof.equal(name, value, "by definition") is None
    assert proof.done(name, value).domain == (domain,)


def test_the_name_of_an_integral_restricts_it_too(proof):
    a, b, x, y = planted.a, planted.b, planted.x, planted.y
    proof.integral(y, x, (x, -a, b), x**2 / 2, "an area")
    assert proof.done(y, sp.factor((b**2 - a**2) / 2)).domain == ("a < b",)


def test_the_interval_of_a_named_root_restricts_nothing_else():
    a, x, y = planted.a, planted.x, planted.y
    source = Proof("edge", None, section="Trial", title="Edge")
    source.root(x**2 - y, x, sp.sqrt(y), "the edge", over=(x, 0, sp.oo), name=a)
    assert source.done(a, sp.sqrt(y)).domain == ()
    later = Proof("later", None, section="Trial", title="Later")
    later.recall("edge", a, sp.sqrt(y))
    with pytest.raises(StepError):
        later.holds(x, ">", 0, "x is any place here")
