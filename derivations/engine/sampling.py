"""Comparison at random points: for steps that algebra does not decide, and to detect its errors."""

import math
import random
from collections.abc import Callable, Iterable, Mapping

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef

from .algebra import Interval

SAMPLES, DIGITS, AGREEMENT, SEED = 64, 50, sp.Rational(1, 10**40), 2020
"""Number of points, digits, allowed relative difference, seed."""


POINTS, PLACES, TRUSTED = 8, 30, sp.Rational(1, 10**18)
"""Number of points, digits and allowed relative difference of the check of proved steps."""


class NoValueError(ValueError):
    """An expression that cannot be evaluated at any point."""


def refutation(lhs: sp.Expr, rhs: sp.Expr, positive: tuple[sp.Expr, ...] = ()) -> str:
    """Describe a point that the assumptions and conditions allow and at which the sides differ, if any.

    For expressions that are not rational, where simplification has been wrong before: branches of
    roots and inverse functions, absolute values, cases.
    """
    symbols = sorted(lhs.free_symbols | rhs.free_symbols, key=str)
    sides = lhs, rhs
    if any(side.has(*_UNKNOWN) for side in sides) or not any(map(_is_not_rational, sides)):
        return ""
    draw = random.Random(SEED)
    with mpmath.workdps(PLACES):
        for _ in range(POINTS):
            chosen = {symbol: _value(symbol, draw) for symbol in symbols}
            point = {symbol: mpmath.mpmathify(value) for symbol, value in chosen.items()}
            try:
                if any(_fails(gap, point) for gap in positive):
                    continue
                left, right = (value_of(side, point) for side in sides)
            except NoValueError:
                raise
            except (ZeroDivisionError, ValueError, OverflowError, TypeError):
                continue
            if mpmath.isnan(left) or mpmath.isnan(right):
                continue
            scale = max(abs(left), abs(right))
            if abs(left - right) > float(TRUSTED) * max(scale, 1):
                return f"at {chosen}: {left} and {right}"
    return ""


_UNKNOWN = (AppliedUndef, sp.Derivative, sp.Integral, sp.Sum, sp.Subs)
"""An expression without a value at a point."""


def _is_not_rational(expr: sp.Expr) -> bool:
    powers = any(not power.exp.is_Integer for power in expr.atoms(sp.Pow))
    return powers or bool(expr.atoms(sp.Function, sp.Abs, sp.Piecewise, sp.Min, sp.Max))


def _fails(gap: sp.Expr, point: Mapping[sp.Expr, mpmath.mpf]) -> bool:
    """Tell whether a condition is known not to hold at a point."""
    if not gap.free_symbols <= point.keys() or gap.has(*_UNKNOWN):
        return False
    value = value_of(gap, point)
    return not isinstance(value, mpmath.mpf) or value <= 0


def _value(symbol: sp.Symbol, draw: random.Random) -> sp.Rational:
    """Draw an admissible value."""
    if symbol.is_integer:
        return sp.Integer(draw.randrange(1, 9) * (-1 if symbol.is_negative else 1))
    size = sp.Rational(draw.randrange(1, 4000), 1000)
    if symbol.is_negative:
        return -size
    return size if symbol.is_nonnegative or draw.random() < 0.5 else -size


def value_of(  # noqa: PLR0911 one return for each kind of node
    expr: sp.Expr, point: Mapping[sp.Expr, mpmath.mpf]
) -> mpmath.mpf:
    """Evaluate at a point; of few values of many expressions, so that it does not pay to compile them."""
    if expr.is_Symbol:
        return point[expr]
    if expr.is_Number or expr.is_NumberSymbol:
        return mpmath.mpf(expr._to_mpmath(mpmath.mp.prec))
    if expr.is_Pow and expr.exp.is_Integer:
        return value_of(expr.base, point) ** int(expr.exp)
    if isinstance(expr, sp.Piecewise):
        cases = (value for value, case in expr.args if case.xreplace(dict(point)) == sp.true)
        return value_of(next(cases, sp.nan), point)
    parts = [value_of(part, point) for part in expr.args]
    if expr.is_Add:
        return sum(parts[1:], parts[0])
    if expr.is_Mul:
        return math.prod(parts[1:], start=parts[0])
    if expr.is_Pow:
        return parts[0] ** parts[1]
    kind = _KINDS.get(expr.func, getattr(mpmath, expr.func.__name__, None))
    if kind is None:
        raise NoValueError(f"{type(expr).__name__} is no function that has a value here")
    return mpmath.mpmathify(kind(*parts))


_KINDS: dict[type, Callable[..., mpmath.mpf]] = {
    sp.Abs: abs, sp.Max: max, sp.Min: min, sp.UnevaluatedExpr: mpmath.mpmathify,
    type(sp.I): lambda: mpmath.mpc(0, 1),
}  # fmt: skip


def disagreement(lhs: sp.Expr, rhs: sp.Expr, ranges: Iterable[Interval]) -> str:
    """Describe the first point at which the sides differ or are not real; empty if there is none."""
    draw = random.Random(SEED)
    intervals = tuple(ranges)
    for _ in range(SAMPLES):
        point = {
            symbol: low + (high - low) * sp.Rational(draw.randrange(1, 10**12), 10**12)
            for symbol, low, high in intervals
        }
        left, right = (side.subs(point).evalf(DIGITS) for side in (lhs, rhs))
        real = all(value.is_Float or value.is_Integer for value in (left, right))
        if not real or abs(left - right) > AGREEMENT * max(abs(left), abs(right)):
            return f"at {point}: {left} and {right}, difference {left - right}"
    return ""
