"""Values of trees at random points, by exact rational numbers and balls of python-flint."""

import random
from collections.abc import Iterable, Mapping
from functools import reduce
from math import isqrt
from operator import add, mul
from typing import Any

import flint
from flint import acb, arb, fmpq

from .trees import FUNCTIONS, Rules, Tree, UnsupportedError, number

Value = Any
"""A rational number (fmpq), a real ball (arb), a complex one (acb), or a quotient of polynomials."""
Facts = Mapping[str, Iterable[str]]
"""What is assumed of symbols, and of functions with parentheses after their names."""

QUADRATURE_BITS, MOST_EVALUATIONS = 50, 4000
"""Accuracy asked of an integral, and how often its integrand may be evaluated."""
NODES = 3
"""Places that stand for an interval over which a function of unknown form is integrated."""
POSITIVE, NEGATIVE = {"positive", "nonnegative"}, {"negative", "nonpositive"}


class UndefinedError(ArithmeticError):
    """A value that does not exist, or is not known well enough, at this point."""


class Point:
    """A value for each letter, drawn when it is first asked for, and what follows from them."""

    def __init__(self, rules: Rules, facts: Facts, draw: random.Random) -> None:
        self.rules, self.facts, self.draw = rules, facts, draw
        self.ranges: Mapping[Tree, tuple[Value, Value]] = {}
        """Bounds of letters."""
        self.linear = False
        """Whether an integral was replaced by a sum over places: then only its linearity is used."""
        self.bound: dict[Tree, Value] = {}
        self.parent: Point | None = None
        self._analytic = False
        self._root = self
        self._memo: dict[Tree, Value] = {}
        self._opaque: dict[Any, Value] = {}
        self._forms: dict[str, tuple[Tree, ...]] = {}
        self._places: dict[Any, Tree] | None = None

    def at(self, bound: Mapping[Tree, Value], *, analytic: bool = False) -> "Point":
        """Return the same point but for some letters."""
        other = Point(self.rules, self.facts, self.draw)
        other.bound, other.parent, other._root = dict(bound), self, self._root
        other._analytic = analytic or self._analytic
        return other

    def set(self, letter: Tree, value: Value) -> None:
        """Give a letter a value, and forget what followed from another one."""
        self.bound[letter] = value
        kept = {
            tree: found
            for tree, found in self._memo.items()
            if letter not in self.rules.reach(tree)
        }
        self._memo = kept

    def value(self, tree: Tree) -> Value:
        """Return the value of a tree."""
        if tree in self.bound:
            return self.bound[tree]
        if self.parent is not None and self.rules.reach(tree).isdisjoint(self.bound):
            return self.parent.value(tree)
        if tree not in self._memo:
            law = self.rules.law(tree)
            self._memo[tree] = self._value(tree) if law is None else self.value(law)
        return self._memo[tree]

    def _value(self, tree: Tree) -> Value:
        op, args = tree.op, tree.args
        if op == "+":
            return reduce(add, map(self.value, args))
        if op == "*":
            return reduce(mul, map(self.value, args))
        if op == "^":
            return powered(self.value(args[0]), self.value(args[1]), self._analytic)
        if op == "symbol":
            return drawn(self.facts.get(args[0], ()), self.draw, *self.ranges.get(tree, ()))
        known = getattr(self, f"_{op}", None)
        if known is not None:
            return known(*args)
        if len(args) != 1:
            raise UnsupportedError(f"the expression {op}")
        return applied(op, self.value(args[0]), self._analytic)

    def _number(self, value: Any) -> Value:
        return fmpq(value.numerator, value.denominator)

    def _pi(self) -> Value:
        return arb.pi()

    def _e(self) -> Value:
        return arb(1).exp()

    def _max(self, *args: Tree) -> Value:
        values = [self.value(arg) for arg in args]
        return next(
            one for one in values if all(each is one or sign_of(one - each) >= 0 for each in values)
        )

    def _min(self, *args: Tree) -> Value:
        values = [self.value(arg) for arg in args]
        return next(
            one for one in values if all(each is one or sign_of(one - each) <= 0 for each in values)
        )

    def _derivative(self, inner: Tree, *variables: Tree) -> Value:
        return self.value(self.rules.derivative(inner, variables))

    def _at(self, inner: Tree, names: tuple[Tree, ...], places: tuple[Tree, ...]) -> Value:
        return self.at(dict(zip(names, map(self.value, places), strict=True))).value(inner)

    def _cases(self, *cases: tuple[Tree, Tree]) -> Value:
        return self.value(next(value for value, where in cases if self.truth(where)))

    def _rank(self, matrix: Tree) -> Value:
        return fmpq(flint.fmpq_mat([list(map(self.value, row)) for row in matrix.args]).rank())

    def _determinant(self, matrix: Tree) -> Value:
        rows = [list(map(self.value, row)) for row in matrix.args]
        exact = all(isinstance(each, fmpq) for row in rows for each in row)
        return flint.fmpq_mat(rows).det() if exact else flint.arb_mat(rows).det()

    def truth(self, relation: Tree) -> bool:
        """Tell whether a relation holds; a doubt is an error."""
        if relation.op in {"true", "and", "or"}:
            return (any if relation.op == "or" else all)(map(self.truth, relation.args))
        return holds(relation.op, self.value(relation.args[0]) - self.value(relation.args[1]))

    def _call(self, name: str, orders: tuple[int, ...], *args: Tree) -> Value:
        """Return the value of a function of unknown form, the same at the same place."""
        values, root = [self.value(arg) for arg in args], self._root
        if name not in self.rules.related:
            form, *letters = root._form(name, len(values))
            by = [one for one, n in zip(letters, orders, strict=True) for _ in range(n)]
            place = root.at(dict(zip(letters, values, strict=True)), analytic=self._analytic)
            return place.value(self.rules.derivative(form, by))
        key = (name, orders, *_rounded(values))
        if key in root.places():
            return root.value(root.places()[key])
        facts = self.facts.get(f"{name}()", ()) if not any(orders) else ()
        return root._opaque.setdefault(key, drawn(facts, self.draw))

    def places(self) -> dict[Any, Tree]:
        """Return what the premises say of functions at places, and of integrals."""
        if self._places is None:
            self._places = {}
            for lhs in self.rules.values:
                if lhs.op in {"call", "integral"}:
                    values = [self.value(arg) for arg in lhs.args[2:]]
                    self._places[*lhs.args[:2], *_rounded(values)] = lhs
        return self._places

    def _form(self, name: str, count: int) -> tuple[Tree, ...]:
        """Return the form of a function; where nothing is known a cubic, or the exponential of one."""
        if name in self.rules.forms:
            return self.rules.forms[name]
        if name not in self._forms:
            letters = [Tree("symbol", f"argument {i} of {name}") for i in range(count)]
            facts = set(self.facts.get(f"{name}()", ()))
            cubic = number(self.draw.randrange(1, 9)) / number(4)
            for letter in letters:
                for order in (1, 2, 3):
                    cubic += (
                        number(self.draw.randrange(1, 9))
                        / number(8 * order)
                        * letter ** number(order)
                    )
            cubic += reduce(mul, letters) / number(3)
            if facts & (POSITIVE | NEGATIVE):  # it rises or falls
                form = Tree("exp", number(self.draw.choice((-1, 1))) * cubic / number(8))
            else:
                form = cubic
            self._forms[name] = (number(-1) * form if facts & NEGATIVE else form, *letters)
        return self._forms[name]

    def _integral(self, inner: Tree, variable: Tree, *ends: Tree) -> Value:
        low, high = map(self.value, ends)
        root, place = self._root, (inner, variable, *_rounded([low, high]))
        if place in root.places():
            return root.value(root.places()[place])
        calls = [each for each in self.rules.reach(inner) if each.op == "call"]
        if root.linear or any(
            each.args[0] in self.rules.related and not self.rules.law(each) for each in calls
        ):
            root.linear = True
            shares = [
                (drawn({"positive"}, self.draw), drawn((), self.draw, 0, 1)) for _ in range(NODES)
            ]
            shares = root._opaque.setdefault(tuple(_rounded([low, high])), shares)
            width = (
                high - low
            )  # places inside, and weights of one sign: it keeps the sign of its integrand
            terms = (w * self.at({variable: low + width * x}).value(inner) for w, x in shares)
            return width * reduce(add, terms)

        def integrand(place: acb, analytic: bool) -> acb:
            try:
                return acb(self.at({variable: place}, analytic=analytic).value(inner))
            except UndefinedError:
                return acb("nan", "nan")

        before, flint.ctx.prec = flint.ctx.prec, QUADRATURE_BITS + 24
        small = arb(2) ** -QUADRATURE_BITS
        try:
            found = acb.integral(
                integrand, acb(low), acb(high),
                rel_tol=small, abs_tol=small, eval_limit=MOST_EVALUATIONS,
            )  # fmt: skip
        finally:
            flint.ctx.prec = before
        return _finite(found.real)


def drawn(
    facts: Iterable[str], draw: random.Random, low: Value = None, high: Value = None
) -> Value:
    """Draw a rational number that obeys what is assumed of a letter, and lies between bounds."""
    facts, share = set(facts), fmpq(draw.randrange(1, 2**12), 2**12)
    low = fmpq(0) if facts & POSITIVE and (low is None or low < 0) else low
    high = fmpq(0) if facts & NEGATIVE and (high is None or high > 0) else high
    if low is not None and high is not None:
        near = share**4  # one end or the other, where an interval that is too wide shows
        share = draw.choice((share, near, 1 - near))
        return low + (high - low) * share
    whole = "integer" in facts
    size = fmpq(draw.randrange(1, 9)) if whole else share * fmpq(2) ** draw.randrange(-2, 4)
    if low is not None or high is not None:
        return low + size if high is None else high - size
    return -size if draw.random() < 0.5 else size


def holds(relation: str, gap: Value) -> bool:
    """Tell whether gap > 0 and so on, for all numbers of a ball; raise where some differ."""
    sign = sign_of(gap)
    return {"<": sign < 0, "<=": sign <= 0, ">": sign > 0, ">=": sign >= 0, "=": not sign}[relation]


def sign_of(value: Value) -> int:
    """Return the sign of a real value; raise if its ball does not decide it."""
    if value > 0 or value < 0:
        return 1 if value > 0 else -1
    if value == 0:
        return 0
    raise UndefinedError("a sign that the ball does not decide")


def powered(base: Value, exponent: Value, analytic: bool = False) -> Value:
    """Return a power."""
    if not isinstance(base, fmpq | arb | acb):
        return base**exponent
    if not isinstance(exponent, fmpq | arb | acb):
        raise UnsupportedError("a polynomial in an exponent")
    if base == 0 and isinstance(exponent, fmpq):
        if exponent < 0:
            raise UndefinedError("a denominator of zero")
        return base
    if isinstance(exponent, fmpq) and exponent.q <= 2:
        root = base if exponent.q == 1 else _square_root(base, analytic)
        return _finite(root ** int(exponent.p))
    if isinstance(base, acb) or isinstance(exponent, acb):
        place = acb(base)
        if not analytic and place.contains(0) and isinstance(exponent, fmpq | arb) and exponent > 0:
            size = arb(place.abs_upper()) ** exponent  # of any value of the power
            return acb(arb(0, size), arb(0, size))
        return _finite(place.pow(acb(exponent), analytic=analytic))
    return _finite(arb(base) ** exponent)


def _square_root(base: Value, analytic: bool) -> Value:
    if isinstance(base, acb):
        return base.sqrt(analytic=analytic)
    if isinstance(base, fmpq) and base > 0:
        top, bottom = isqrt(int(base.p)), isqrt(int(base.q))
        if top * top == base.p and bottom * bottom == base.q:
            return fmpq(top, bottom)
    return _finite(arb(base).sqrt())


def applied(name: str, value: Value, analytic: bool = False) -> Value:
    """Return the value of a function."""
    if name == "abs":
        return abs(value)
    if not isinstance(value, fmpq | arb | acb) or name not in FUNCTIONS:
        raise UnsupportedError(f"the function {name}")
    if isinstance(value, fmpq) and value == 0 and name not in {"cos", "cosh", "exp", "log"}:
        return value
    ball = value if isinstance(value, acb) else arb(value)
    if name == "log" and isinstance(ball, acb):
        return _finite(ball.log(analytic=analytic))
    return _finite(getattr(ball, name)())


def _finite(value: Value) -> Value:
    if isinstance(value, arb | acb) and not value.is_finite():
        raise UndefinedError("no finite real value")
    return value


def _rounded(values: Iterable[Value]) -> list[int]:
    """Name a place by its numbers, rounded."""
    rounded = []
    for value in values:
        if not isinstance(value, fmpq | arb):
            raise UnsupportedError("a function of unknown form at a place that is no real number")
        middle = value if isinstance(value, fmpq) else value.mid().fmpq()
        rounded.append(int(middle.p * 2**96 // middle.q))
    return rounded


def name_of(letter: Tree) -> str:
    """Return the name under which something is assumed of a letter; nothing is of derivatives."""
    if letter.op == "call":
        return "" if any(letter.args[1]) else f"{letter.args[0]}()"
    return str(letter.args[0]) if letter.op == "symbol" else ""
