"""Comparison at random points: for steps that algebra does not decide, and to detect its errors."""

import random
from collections.abc import Iterable

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef

from .algebra import Interval

SAMPLES, DIGITS, AGREEMENT, SEED = 64, 50, sp.Rational(1, 10**40), 2020
"""Number of points, digits, allowed relative difference, seed."""


POINTS, PLACES, TRUSTED = 8, 30, sp.Rational(1, 10**18)
"""Number of points, digits and allowed relative difference of the check of proved steps."""


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
    both = sp.lambdify(symbols, [lhs, rhs], "mpmath", cse=True)
    with mpmath.workdps(PLACES):
        for _ in range(POINTS):
            point = [_value(symbol, draw) for symbol in symbols]
            chosen = dict(zip(symbols, point, strict=True))
            if any(gap.subs(chosen).is_positive is False for gap in positive):
                continue
            try:
                left, right = both(*map(mpmath.mpmathify, point))
            except (ZeroDivisionError, ValueError, OverflowError, TypeError):
                continue
            if mpmath.isnan(left) or mpmath.isnan(right):
                continue
            scale = max(abs(left), abs(right))
            if abs(left - right) > float(TRUSTED) * max(scale, 1):
                return f"at {dict(zip(symbols, point, strict=True))}: {left} and {right}"
    return ""


_UNKNOWN = (AppliedUndef, sp.Derivative, sp.Integral, sp.Sum, sp.Subs)
"""An expression without a value at a point."""


def _is_not_rational(expr: sp.Expr) -> bool:
    powers = any(not power.exp.is_Integer for power in expr.atoms(sp.Pow))
    return powers or bool(expr.atoms(sp.Function, sp.Abs, sp.Piecewise, sp.Min, sp.Max))


def _value(symbol: sp.Symbol, draw: random.Random) -> sp.Rational:
    """Draw an admissible value."""
    if symbol.is_integer:
        return sp.Integer(draw.randrange(1, 9) * (-1 if symbol.is_negative else 1))
    size = sp.Rational(draw.randrange(1, 4000), 1000)
    if symbol.is_negative:
        return -size
    return size if symbol.is_nonnegative or draw.random() < 0.5 else -size


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
