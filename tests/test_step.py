"""The engine refuses what is wrong, shows the difference, and accepts what is right."""

import pytest
import sympy as sp
from kvtheory.derivations.book import StepError, established
from kvtheory.derivations.step import Proof

x = sp.Symbol("x", real=True)
y, z = sp.symbols("y z", positive=True)


@pytest.fixture
def proof():
    return Proof("trial", None, section="Trial", title="Trial")


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ((x + y) ** 2, x**2 + 2 * x * y + y**2),
        (1 / (1 - x) - 1 / (1 + x), 2 * x / (1 - x**2)),
        (1 / (sp.sqrt(1 + y) + sp.sqrt(y)), sp.sqrt(1 + y) - sp.sqrt(y)),
        (sp.sqrt(5 + 2 * sp.sqrt(6)), sp.sqrt(2) + sp.sqrt(3)),
        (sp.Derivative(sp.exp(-x / y), x), -sp.exp(-x / y) / y),
        (sp.sqrt(1 + (1 - y**2) ** 2 / (4 * y**2)), (1 + y**2) / (2 * y)),
    ],
)
def test_right_identities_pass_and_their_neighbours_fail(proof, left, right):
    proof.equal(left, right, "identity")
    assert proof.done(left, right).status == "proved"
    with pytest.raises(StepError, match="left - right = "):
        proof.equal(left, right * (1 + sp.Rational(1, 10**60) * y), "almost an identity")


def test_a_square_root_of_a_square_is_not_its_base(proof):
    with pytest.raises(StepError):
        proof.equal(sp.sqrt(x**2), x, "wrong for x < 0")


def test_definitions_are_replaced_in_later_steps(proof):
    proof.define(z, y**2)
    proof.equal(sp.sqrt(z), y, "definition")
    with pytest.raises(StepError, match="defined twice"):
        proof.define(z, y)
    with pytest.raises(StepError, match="circular"):
        proof.define(y, z + 1)


def test_definitions_alone_are_a_definition(proof):
    proof.define(z, y**2)
    assert proof.done(z, y**2).status == "definition"


def test_only_what_was_established_can_be_recalled(proof):
    proof.equal(y + y, 2 * y, "sum")
    proof.define(z, y**2)
    proof.done(z, y**2)
    later = Proof("later", None, section="Trial", title="Later")
    later.recall("trial", z, y**2)
    later.equal(sp.sqrt(z), y, "recalled")
    assert later.done(sp.sqrt(z), y).uses == ("trial",)
    with pytest.raises(StepError, match="does not establish"):
        later.recall("trial", x, y**2)
    with pytest.raises(StepError, match="not been derived"):
        later.recall("never", z, y**2)


def test_only_exact_equalities_can_be_recalled(proof):
    proof.leading_order(y + y**2, y, y, 0, "series", eps=y)
    proof.unique_root(x**2 - 2, (x, 0, 2), "Sturm")
    proof.sign(x, ">", 0, (x, 0, 2), "sign")
    proof.done(y + y**2, y)
    later = Proof("later", None, section="Trial", title="Later")
    for left, right in ((y + y**2, y), (x**2 - 2, 0), (x, 0)):
        with pytest.raises(StepError, match="does not establish"):
            later.recall("trial", left, right)
        with pytest.raises(StepError, match="does not establish"):
            established("trial", left)


def test_a_result_must_be_a_step(proof):
    with pytest.raises(StepError, match="no step established"):
        proof.done(x, y)


def test_integral_checks_antiderivative_value_and_continuity(proof):
    assert proof.integral(z, 3 * x**2, (x, 0, y), x**3, "power rule") == y**3
    proof.equal(z, y**3, "its value")
    with pytest.raises(StepError, match="left - right = "):
        proof.integral(x, 3 * x**2, (x, 0, y), x**3 + x, "wrong antiderivative")
    with pytest.raises(StepError, match="left - right = "):
        proof.integral(x, 3 * x**2, (x, 0, y), x**3, "wrong value", value=2 * y**3)
    with pytest.raises(StepError, match="continuous"):
        proof.integral(x, 1 / x**2, (x, -1, 1), -1 / x, "a pole between the ends")


def test_integral_must_be_the_defined_one(proof):
    proof.define(z, sp.Integral(x, (x, 0, y)))
    with pytest.raises(StepError, match="left - right = "):
        proof.integral(z, x, (x, 0, 2 * y), x**2 / 2, "other bounds")


def test_integral_to_infinity(proof):
    assert proof.integral(z, sp.exp(-x / y), (x, 0, sp.oo), -y * sp.exp(-x / y), "decay") == y


def test_root(proof):
    positive = (x, 0, sp.oo)
    quadratic = x**2 + 2 * y * x - 1
    proof.root(quadratic, x, sp.sqrt(1 + y**2) - y, "quadratic formula", over=positive)
    with pytest.raises(StepError, match="left - right = "):
        proof.root(quadratic, x, sp.sqrt(1 + y**2) + y, "wrong sign", over=positive)
    with pytest.raises(StepError, match="other roots"):
        proof.root(quadratic, x, sp.sqrt(1 + y**2) - y, "one of two")


def test_unique_root(proof):
    proof.unique_root(x**2 - 2, (x, 0, 2), "Sturm")
    proof.unique_root(x * (2 * x - 1) * (x - 1), (x, 0, 1), "the ends do not count")
    with pytest.raises(StepError, match="2 roots"):
        proof.unique_root(x**2 - 2, (x, -2, 2), "two of them")
    with pytest.raises(StepError, match="0 roots"):
        proof.unique_root(x**2 + 2, (x, -2, 2), "none")


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


@pytest.mark.parametrize(
    ("expr", "relation"),
    [
        (2 * x - 1, ">"),
        ((2 * x - 1) ** 2, ">"),
        (1 / (2 * x - 1) ** 2, ">"),
        ((x - sp.Rational(1, 10**9)) * (x + 1), ">="),
        (sp.Symbol("w", real=True) * (x + 1), ">"),
    ],
)
def test_sign_refuses_zeros_poles_and_unknown_factors(proof, expr, relation):
    with pytest.raises(StepError):
        proof.sign(expr, relation, 0, (x, 0, 1), "changes sign")


def test_sign_against_a_bound(proof):
    proof.sign(x * (1 - x), "<=", sp.Rational(1, 4), (x, 0, 1), "parabola")
    with pytest.raises(StepError):
        proof.sign(x * (1 - x), "<", sp.Rational(1, 4), (x, 0, 1), "it is reached")


def test_equivalent(proof):
    proof.equivalent(y * (x - z), x, z, "divide by y > 0")
    with pytest.raises(StepError):
        proof.equivalent(y * (z - x), x, z, "turns the relation round")


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


def test_leading_order_refuses_what_is_exact_and_what_is_not_small(proof):
    with pytest.raises(StepError, match="identically zero"):
        proof.leading_order(y, y, y, 0, "exact", eps=y)
    with pytest.raises(StepError, match="small positive"):
        proof.leading_order(y + y**2, y, y, 0, "not small", eps=1 + y)


def test_sampled_finds_a_small_error(proof):
    ranges = [(y, sp.Rational(1, 10), 10)]
    left = sp.exp(sp.log(y) / 3)
    proof.sampled(left, y ** sp.Rational(1, 3), ranges, "powers")
    assert proof.done(left, y ** sp.Rational(1, 3)).status == "sampled"
    with pytest.raises(StepError, match="difference"):
        proof.sampled(left, left * (1 + sp.Rational(1, 10**38)), ranges, "planted error")
    with pytest.raises(StepError, match="difference"):
        proof.sampled(sp.sqrt(y - 5), sp.sqrt(y - 5), ranges, "not real everywhere")
