"""Rational functions: their signs over a box, and their real roots."""

import random
from collections.abc import Iterator, Mapping
from typing import Any

from flint import acb, acb_poly, arb, arb_poly, fmpq, fmpq_mpoly, fmpq_mpoly_ctx, fmpq_poly

from .trees import Rules, Tree, UnsupportedError
from .values import NEGATIVE, POSITIVE, Facts, Point, UndefinedError, Value, name_of

MOST_TERMS = 4000
"""Larger polynomials are left alone."""
ORDERS = (1, 2, 3, 6)
"""A variable under roots is tried as a power of another with these exponents."""
_ALWAYS = {
    "exp": "positive",
    "cosh": "positive",
    "pi": "positive",
    "e": "positive",
    "abs": "nonnegative",
}
_NO_END: Value = None


class Quotient:
    """A quotient of polynomials, one letter or many, without a common factor where that can be found."""

    def __init__(self, top: Any, bottom: Any) -> None:
        if not isinstance(top, arb_poly):
            common = top.gcd(bottom)
            top, bottom = (top // common, bottom // common) if len(top) else (top, bottom**0)
            if isinstance(top, fmpq_mpoly) and max(len(top), len(bottom)) > MOST_TERMS:
                raise UnsupportedError("too many terms")
        self.top, self.bottom = top, bottom

    def _pair(self, other: Any) -> tuple["Quotient", "Quotient"]:
        """Return both with coefficients of one kind."""
        if isinstance(other, fmpq):
            other = Quotient(self.bottom**0 * other, self.bottom**0)
        elif isinstance(other, arb) and not isinstance(self.top, fmpq_mpoly):
            other = Quotient(arb_poly([other]), arb_poly([1]))
        elif not isinstance(other, Quotient):
            raise UnsupportedError("no rational coefficients")
        if type(self.top) is type(other.top):
            return self, other
        one, two = (Quotient(arb_poly(each.top), arb_poly(each.bottom)) for each in (self, other))
        return one, two

    def __add__(self, other: Any) -> "Quotient":
        one, two = self._pair(other)
        return Quotient(one.top * two.bottom + two.top * one.bottom, one.bottom * two.bottom)

    def __sub__(self, other: Any) -> "Quotient":
        return self + other * fmpq(-1)

    def __mul__(self, other: Any) -> "Quotient":
        one, two = self._pair(other)
        return Quotient(one.top * two.top, one.bottom * two.bottom)

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, exponent: Any) -> "Quotient":
        if not isinstance(exponent, fmpq):
            raise UnsupportedError("a power that is no number")
        top, bottom, power = self.top, self.bottom, int(exponent.p)
        if exponent.q != 1:  # only of a power of the variable
            degree = top.degree() if isinstance(top, fmpq_poly) and bottom == 1 else -1
            if degree % int(exponent.q) or top != fmpq_poly([0] * degree + [1]):
                raise UnsupportedError("a root of a polynomial")
            top = fmpq_poly([0] * (degree // int(exponent.q)) + [1])
        if power < 0:
            top, bottom = bottom, top
        return Quotient(top ** abs(power), bottom ** abs(power))


def _letters(tree: Tree, rules: Rules) -> Iterator[Tree]:
    """Yield what a tree is a rational function of: roots, exponentials and so on among it."""
    law = rules.law(tree)
    if law is not None:
        yield from _letters(law, rules)
    elif tree.op == "derivative":
        yield from _letters(rules.derivative(tree.args[0], tree.args[1:]), rules)
    elif tree.op in {"+", "*"} or (tree.op == "^" and tree.args[1].op == "number"):
        whole = tree.op != "^" or tree.args[1].args[0].denominator == 1
        for part in tree.args if whole else ():
            yield from _letters(part, rules)
        yield from () if whole else (tree,)
    elif tree.op != "number":
        yield tree


def proved_sign(
    tree: Tree, rules: Rules, facts: Facts, ranges: Mapping[Tree, tuple[Value, Value]]
) -> str:
    """Return the sign of a rational function over a box: "+", "-", "+0", "-0" or "" if it is not proved.

    Each letter is written in a positive one; then coefficients of one sign decide, or the lack of roots.
    """
    letters = list(dict.fromkeys(_letters(tree, rules)))
    context = fmpq_mpoly_ctx.get(tuple(f"x{i}" for i in range(max(1, len(letters)))), "lex")
    one, zeros, free, bound = context.constant(1), set(), set(), {}
    for i, (letter, t) in enumerate(zip(letters, context.gens(), strict=False)):
        known, ends = _known(letter, facts), ranges.get(letter, (None, None))
        low, high = (end if isinstance(end, fmpq) else _NO_END for end in ends)
        low = fmpq(0) if low is _NO_END and known & POSITIVE else low
        high = fmpq(0) if high is _NO_END and known & NEGATIVE else high
        if known & {"nonnegative", "nonpositive"} and 0 in (low, high):
            zeros.add(i)
        if low is _NO_END and high is _NO_END:
            bound[letter] = Quotient(t, one)
            zeros.add(i)
            free.add(i)
        elif low is _NO_END or high is _NO_END:
            bound[letter] = Quotient(t + low if high is _NO_END else high - t, one)
        else:
            bound[letter] = Quotient(t * high + low, t + 1)
    point = Point(rules, facts, random.Random(0))
    point.bound = bound
    found = Quotient(one, one) * point.value(tree)
    if found.top.is_zero():
        return "0"
    sign, strict = 1, True
    for part in (found.top, found.bottom):
        constant, factors = part.factor()
        sign *= 1 if constant > 0 else -1
        for factor, multiplicity in factors:
            one_sign, positive = _factor_sign(factor, zeros, free)
            even = multiplicity % 2 == 0
            if not (one_sign or even) or (part is found.bottom and not positive):
                return ""
            sign, strict = sign * (1 if even else one_sign), strict and positive
    return ("+" if sign > 0 else "-") + ("" if strict else "0")


def _known(letter: Tree, facts: Facts) -> set[str]:
    """Return what is known of the sign of a letter."""
    if letter.op == "^":
        positive = "positive" in facts.get(name_of(letter.args[0]), ())
        root = letter.args[1].op == "number" and letter.args[1].args[0].denominator % 2 == 0
        return {"positive"} if positive else {"nonnegative"} if root else set()
    return set(facts.get(name_of(letter), ())) | {_ALWAYS.get(letter.op, "")}


def _factor_sign(factor: Any, zeros: set[int], free: set[int]) -> tuple[int, bool]:
    """Return the sign of a polynomial of positive letters, and whether it never vanishes."""
    terms = factor.to_dict()
    signs = {1 if value > 0 else -1 for value in terms.values()}
    if len(signs) == 1 and all(powers[i] % 2 == 0 for powers in terms for i in free):
        return signs.pop(), any(all(powers[i] == 0 for i in zeros) for powers in terms)
    used = {i for powers in terms for i, power in enumerate(powers) if power}
    if len(used) == 1 and not used & zeros:
        (index,) = used
        row = {powers[index]: value for powers, value in terms.items()}
        poly = fmpq_poly([row.get(i, 0) for i in range(max(row) + 1)])
        if not any(root > 0 for root in _real(poly)):
            return (1 if poly(fmpq(1)) > 0 else -1), True
    return 0, False


def real_roots(tree: Tree, variable: Tree, point: Point) -> list[arb]:
    """Isolate the real roots of a rational function of one variable, all else being numbers."""
    for order in ORDERS:
        power = Quotient(fmpq_poly([0] * order + [1]), fmpq_poly([1]))
        try:
            found = point.at({variable: power}).value(tree)
        except UnsupportedError:
            continue
        if not isinstance(found, Quotient):
            raise UnsupportedError("an expression without its variable")
        roots = _real(found.top)
        if not isinstance(found.top, fmpq_poly) and any(
            found.bottom(root).contains(0) for root in roots
        ):
            raise UndefinedError("a root that may be a pole")
        return roots if order == 1 else [root**order for root in roots if root > 0]
    raise UnsupportedError("no rational function of its variable")


def _real(poly: Any) -> list[arb]:
    if isinstance(poly, fmpq_poly):
        isolated: list[Any] = poly.complex_roots()
        return [root.real for root, _ in isolated if root.imag == 0]
    try:
        roots = acb_poly([acb(each) for each in poly.coeffs()]).roots()
    except (ValueError, ArithmeticError) as error:
        raise UndefinedError("roots that are not isolated") from error
    return [root.real for root in roots if root.imag.contains(0)]
