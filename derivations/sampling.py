"""Comparison at random points, for the steps that algebra does not decide."""

import random
from collections.abc import Iterable

import sympy as sp

from derivations.algebra import Interval

SAMPLES, DIGITS, AGREEMENT, SEED = 64, 50, sp.Rational(1, 10**40), 2020
"""Number of points, digits, allowed relative difference, seed."""


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
