"""Check the steps of a derivation again, with nothing but SymPy.

This check is independent: it shares no code with the engine that proved the steps. An identity is decided
by algebra where that is quick, else at random points with 50 digits; so are signs and limits.
"""

import random
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

Expr = Any
Over = tuple[Any, Any, Any]
"""A SymPy expression; a variable with its bounds."""

POINTS, TRIES, DIGITS, CLOSE = 12, 500, 50, sp.Float("1e-35")
NEAR = sp.Rational(1, 10**4)
"""From the ends of an interval, over its length, or the reciprocal of a place far out."""
DISTANCES = [sp.Rational(1, 10**6), sp.Rational(1, 10**9)]
"""From the point of a limit: the remainder must fall by more than half from one to the next."""


_SIGNS = {
    ">": lambda value: value > 0,
    ">=": lambda value: value >= 0,
    "<": lambda value: value < 0,
    "<=": lambda value: value <= 0,
}


class Steps:
    """The steps of one derivation; premises are substituted into all later steps."""

    def __init__(self, label: str) -> None:
        self.label, self.draw = label, random.Random(2020)
        self.rules: dict[Expr, Expr] = {}
        self.conditions: list[Expr] = []
        self.numbers: dict[Expr, Expr] = {}

    def given(self, lhs: Expr, rhs: Expr) -> None:
        """Define the left side by the right side."""
        self.rules[sp.sympify(lhs)] = sp.sympify(rhs)

    def where(self, condition: Expr) -> None:
        """Let an inequality hold at all points that are drawn from here on."""
        self.conditions.append(condition)

    def equal(self, lhs: Expr, rhs: Expr, cases: tuple[Expr, ...] = ()) -> None:
        """Check that both sides are the same, in each of the cases if there are some."""
        for case in cases or (sp.true,):
            with self._case(case):
                self._zero(self._put(lhs) - self._put(rhs), f"{lhs} = {rhs}", quiet=True)
        self._report(True, f"{lhs} = {rhs}", "a difference of zero")

    def holds(self, lhs: Expr, relation: str, rhs: Expr, cases: tuple[Expr, ...] = ()) -> None:
        """Check an inequality at admissible points."""
        for case in cases or (sp.true,):
            with self._case(case):
                forms = self._put(lhs) - self._put(rhs), sp.sympify(lhs) - rhs
                fine = any(self._all(relation, form) for form in forms)
            self._report(fine, f"{lhs} {relation} {rhs}", "", quiet=True)
        self._report(True, f"{lhs} {relation} {rhs}", f"{POINTS} points")

    def integral(
        self,
        lhs: Expr,
        integrand: Expr,
        over: Over,
        antiderivative: Expr,
        value: Expr | None = None,
    ) -> None:
        """Check an antiderivative, and the difference of its values at the bounds."""
        variable, low, high = over[0], self._put(over[1]), self._put(over[2])
        primitive, inner = self._put(antiderivative), self._put(integrand)
        slope = self._put(sp.diff(primitive, variable))
        self._zero(slope - inner, f"the derivative of {antiderivative}", quiet=True)
        ends = [
            self._put(primitive.subs(variable, end))
            if end.is_finite
            else sp.limit(primitive, variable, end)
            for end in (low, high)
        ]
        value = ends[1] - ends[0] if value is None else sp.sympify(value)
        self._zero(ends[1] - ends[0] - self._put(value), f"{lhs} = {value}")
        self.rules[sp.sympify(lhs)] = value

    def root(self, expr: Expr, variable: Expr, value: Expr, name: Expr | None = None) -> None:
        """Check that the expression vanishes there; the root may have a name of its own."""
        there = self._put(expr).subs(variable, self._put(value))
        self._zero(there, f"{expr} = 0 at {variable} = {value}")
        if name is not None:
            self.rules[name] = sp.sympify(value)

    def unique_root(self, expr: Expr, over: Over) -> None:
        """Check that the polynomial has one root between the bounds."""
        variable, low, high = over
        poly = sp.Poly(sp.fraction(sp.together(self._put(expr)))[0], variable)
        inside = [
            root
            for root in sp.Poly(poly.sqf_part(), variable).nroots(n=30, maxsteps=200)
            if abs(sp.im(root)) < sp.Float("1e-20") and low < sp.re(root) < high
        ]
        self._report(len(inside) == 1, f"{expr} has one root in {over[1:]}", "roots with 30 digits")

    def crossing(self, expr: Expr, over: Over) -> None:
        """Check that the expression rises or falls at all points, and changes its sign between the bounds."""
        variable, low, high = over[0], *map(sp.sympify, over[1:])
        whole = self._masked(self._put(expr))
        point = self._point(whole)
        span = high - low if high.is_finite else sp.S.One
        places = sorted(self._inside(low, high) for _ in range(POINTS))
        last = high - span * NEAR if high.is_finite else 1 / NEAR
        places = [low + span * NEAR, *places, last]
        values = [self._value(whole, {**point, variable: place}) for place in sorted(places)]
        rises = [one < other for one, other in pairwise(values)]
        fine = (all(rises) or not any(rises)) and values[0] * values[-1] < 0
        self._report(fine, f"{expr} = 0 once in {over[1:]}", f"{POINTS} points")

    def sign(self, expr: Expr, relation: str, bound: Expr, over: Over) -> None:
        """Check that the expression stays on its side of the bound."""
        gap = self._put(expr) - self._put(bound)
        points = ({over[0]: self._inside(*over[1:])} for _ in range(POINTS))
        holds = all(_SIGNS[relation](self._value(gap, self._point(gap, at))) for at in points)
        self._report(holds, f"{expr} {relation} {bound} in {over[1:]}", f"{POINTS} points")

    def greatest(
        self, value: Expr, expr: Expr, place: Over, surplus: Expr, given: tuple[Expr, ...] = ()
    ) -> None:
        """Check that the value is nowhere exceeded, and that it is attained at the given point."""
        kept = list(self.conditions)
        self.conditions += given
        gap = self._put(value) - self._put(expr)
        self._zero(gap - self._put(surplus), f"{value} - {expr} = {surplus}", quiet=True)
        # Of unknown functions only the identity is checked: points have no values of them.
        fine = bool(gap.atoms(AppliedUndef)) or self._all(">=", gap)
        self._report(fine, f"{value} >= {expr}", "", quiet=True)
        self.conditions = kept
        self._zero(self._put(sp.sympify(surplus).subs(*place)), f"{value} is the greatest {expr}")

    def equivalent(self, nonnegative: Expr, lhs: Expr, rhs: Expr) -> None:
        """Check that the first one has the sign of the difference of the others."""
        ratio = sp.cancel(self._put(nonnegative) / (self._put(lhs) - self._put(rhs)))
        positive = ratio.is_positive or all(
            self._value(ratio, self._point(ratio)) > 0 for _ in range(POINTS)
        )
        self._report(bool(positive), f"{lhs} >= {rhs}", "a positive ratio")

    def leading_order(
        self, expr: Expr, leading: Expr, variable: Expr, point: Expr, eps: Expr
    ) -> None:
        """Check that the ratio of both tends to one."""
        point = sp.sympify(point)
        ratio = self._put(expr) / self._put(leading) - 1
        others = {s: self._inside(0, 1) for s in ratio.free_symbols - {variable}}
        gaps = []
        for distance in DISTANCES:
            near = (
                1 / distance if point is sp.oo else point + (distance if point == 0 else -distance)
            )
            gaps.append(abs(self._value(ratio, {**others, variable: near})))
        falls = gaps[1] < gaps[0] / 2 or gaps[1] == 0
        self._report(
            falls, f"{expr} ~ {leading} as {variable} -> {point}", f"off by {float(gaps[1]):.1e}"
        )

    def _put(self, expr: Expr) -> Expr:
        before, after = None, sp.sympify(expr)
        while after != before:
            before, named = after, None
            while after != named:  # a derivative acts on what its names stand for
                named, after = after, self._named(after)
            after = after.doit(integrals=False)
        return after

    def _named(self, expr: Expr) -> Expr:
        """Substitute definitions once; known integrals as wholes, functions exactly as they are written."""
        expr = expr.xreplace({k: v for k, v in self.rules.items() if isinstance(k, sp.Integral)})
        expr = expr.replace(
            lambda node: isinstance(node, sp.Subs) and not self.rules.keys() & set(node.variables),
            lambda node: self._put(node.expr).subs(
                dict(zip(node.variables, node.point, strict=True)), simultaneous=True
            ),
        )
        exact = {
            lhs: rhs
            for lhs, rhs in self.rules.items()
            if isinstance(lhs, (AppliedUndef, sp.Derivative))
        }
        expr = expr.xreplace(exact)
        slopes = {  # `subs` would hold constant what the names in a derivative stand for
            each: sp.Derivative(each.expr.xreplace(self.rules), *each.variable_count)
            for each in expr.atoms(sp.Derivative)
            if not any(variable in self.rules for variable in each.variables)
        }
        rest = {k: v for k, v in self.rules.items() if k not in exact}
        return expr.xreplace(slopes) if slopes.keys() - slopes.values() else expr.subs(rest)

    def _zero(self, expr: Expr, claim: str, *, quiet: bool = False) -> None:
        masked = self._masked(expr)
        if masked == 0 or (
            not _has_powers(masked) and sp.expand(sp.fraction(sp.together(masked))[0]) == 0
        ):
            self._report(True, claim, "algebra", quiet=quiet)
        elif masked.has(sp.Integral, sp.Sum):
            self._report(sp.simplify(expr) == 0, claim, "algebra", quiet=quiet)
        else:
            terms = sp.Add.make_args(masked)
            holds = True
            for _ in range(POINTS):
                point = self._point(masked)
                values = [self._value(term, point) for term in terms]
                holds = holds and abs(sum(values)) <= CLOSE * max(map(abs, values))
            self._report(holds, claim, f"{POINTS} points", quiet=quiet)

    def _masked(self, expr: Expr) -> Expr:
        """Let unknown functions and their derivatives be numbers, the same ones in each check."""
        for kind in (sp.Subs, sp.Derivative, AppliedUndef):
            for part in sorted(expr.atoms(kind), key=sp.count_ops, reverse=True):
                never = part.is_nonnegative  # what is known of its sign
                number = self.numbers.setdefault(part, sp.Dummy(real=True, nonnegative=never))
                expr = expr.xreplace({part: number})
        return expr

    def _all(self, relation: str, gap: Expr) -> bool:
        gap = self._masked(gap)
        points = (self._point(gap) for _ in range(POINTS))
        return all(_SIGNS[relation](self._value(gap, point)) for point in points)

    @contextmanager
    def _case(self, case: Expr) -> Iterator[None]:
        """Let an equality or an inequality hold for a while."""
        kept = dict(self.rules), list(self.conditions)
        if isinstance(case, sp.Eq):
            self.rules[case.lhs] = case.rhs
        elif case != sp.true:
            self.conditions.append(case)
        yield
        self.rules, self.conditions = kept

    def _point(self, expr: Expr, fixed: dict[Expr, Expr] | None = None) -> dict[Expr, Expr]:
        """Draw values for all symbols until the conditions hold."""
        gaps = [self._masked(self._put(each.gts - each.lts)) for each in self.conditions]
        wanted = expr.free_symbols | set().union(*(gap.free_symbols for gap in gaps))
        for _ in range(TRIES):
            point = {s: self._inside(0, 3, s) for s in wanted} | (fixed or {})
            if all(self._value(gap, point) > 0 for gap in gaps):
                return point
        raise AssertionError(f"{self.label}: no point satisfies {self.conditions}")

    def _value(self, expr: Expr, point: dict[Expr, Expr]) -> Expr:
        drawn = {s: point[s] if s in point else self._inside(0, 3, s) for s in expr.free_symbols}
        return sp.sympify(expr).subs(drawn).evalf(DIGITS)

    def _inside(self, low: Expr, high: Expr, symbol: Expr | None = None) -> Expr:
        low, high = map(sp.sympify, (low, high))
        share = sp.Float(self.draw.randrange(1, 10**9), 2 * DIGITS) / 10**9
        negative = symbol is not None and symbol.is_negative
        if isinstance(symbol, sp.Dummy) and not symbol.is_nonnegative:  # of an unknown function
            negative = self.draw.random() < 0.5
        sign = -1 if negative else 1
        if low.is_finite and high.is_finite:
            return sign * (low + (high - low) * share)
        far = (1 - share) / share  # from 0 to infinity
        return low + far if low.is_finite else (high - far if high.is_finite else far - 1 / far)

    def _report(self, holds: bool, claim: str, how: str, *, quiet: bool = False) -> None:
        if not holds:
            raise AssertionError(f"{self.label}: {claim} does not hold")
        if not quiet:
            print(f"{self.label}: {claim}   [{how}]")


def Rank(matrix: Expr) -> Expr:  # noqa: N802
    """Return the rank of a matrix of numbers."""
    return sp.Integer(matrix.rank())


def _has_powers(expr: Expr) -> bool:
    """Tell whether an exponent is a symbol; algebra takes long over these."""
    return any(power.exp.free_symbols for power in expr.atoms(sp.Pow))
