"""Power series in a positive variable at 0, by recurrences of their coefficients: exact, and fast."""

from collections.abc import Callable, Iterable
from functools import reduce

import sympy as sp

from .forms import expanded
from .identity import vanishes
from .points import signs

_COUNTS = 6, 12
"""How many coefficients are tried to find the first that is not zero."""
_Series = list[sp.Expr]


class _NoSeriesError(ArithmeticError):
    """An expression that has no power series, or none that these rules give."""


def leading_of_series(expr: sp.Expr, h: sp.Symbol) -> tuple[sp.Expr, sp.Expr] | None:
    """Return c, k with the leading term c h**k; None where numerator or denominator has no series here.

    >>> h = sp.Symbol("h", positive=True)
    >>> leading_of_series((sp.exp(h) - 1 - h) / sp.sqrt(1 + h), h)
    (1/2, 2)
    >>> leading_of_series(sp.atan(h) - h, h)
    (-1/3, 3)
    """
    try:
        (one, top), (other, bottom) = (_lowest(part, h) for part in sp.fraction(expr))
    except _NoSeriesError:
        return None
    return without_root(sp.cancel(top / bottom)), sp.Integer(one - other)


def without_root(number: sp.Expr) -> sp.Expr:
    """Write a number without roots below its line; the factor that removes those of letters may vanish."""
    return number if number.free_symbols else sp.radsimp(number)


def _lowest(expr: sp.Expr, h: sp.Symbol) -> tuple[int, sp.Expr]:
    """Return the first power whose coefficient is not zero, and the coefficient."""
    for count in _COUNTS:
        for power, coefficient in enumerate(_series(expr, h, count)):
            if coefficient == 0 or vanishes(coefficient):
                continue
            if not signs(coefficient):
                raise _NoSeriesError(f"{coefficient} may vanish")
            return power, coefficient
    raise _NoSeriesError(f"{expr} begins with a higher power")


def _series(expr: sp.Expr, h: sp.Symbol, count: int) -> _Series:
    """Return the first coefficients."""
    if not expr.has(h):
        return [expanded(expr), *[sp.S.Zero] * (count - 1)]
    if expr == h:
        return [sp.S.Zero, sp.S.One, *[sp.S.Zero] * (count - 2)]
    if expr.is_Pow and not expr.exp.has(h):
        return _power(_series(expr.base, h, count), expr.exp)
    if expr.func not in _RULES:
        raise _NoSeriesError(f"{expr.func} has no rule")
    return _RULES[expr.func](*(_series(part, h, count) for part in expr.args))


def _sum(*parts: _Series) -> _Series:
    return [sp.Add(*terms) for terms in zip(*parts, strict=True)]


def _product(*parts: _Series) -> _Series:
    return reduce(_times, parts)


def _times(one: _Series, other: _Series) -> _Series:
    return [_total(one[k] * other[n - k] for k in range(n + 1)) for n in range(len(one))]


def _total(terms: Iterable[sp.Expr]) -> sp.Expr:
    return expanded(sp.Add(*terms))


def _power(u: _Series, exponent: sp.Expr) -> _Series:
    """Raise a series: f = u**p satisfies u f' = p u' f."""
    if exponent.is_Integer and exponent > 0:
        return reduce(_times, [u] * int(exponent))
    if not u[0].is_positive:
        raise _NoSeriesError(f"{u[0]} is not known to be positive")
    f = [u[0] ** exponent]
    for n in range(1, len(u)):
        terms = (((exponent + 1) * k - n) * u[k] * f[n - k] for k in range(1, n + 1))
        f.append(expanded(sp.Add(*terms) / (n * u[0])))
    return f


def _exponential(u: _Series) -> _Series:
    """Return the series of f = exp(u), f' = u' f."""
    f = [sp.exp(u[0])]
    for n in range(1, len(u)):
        f.append(_total(k * u[k] * f[n - k] / n for k in range(1, n + 1)))
    return f


def _arc_tangent(u: _Series) -> _Series:
    """Return the series of f = atan(u), f' = u'/(1 + u**2)."""
    if not u[0].is_real:
        raise _NoSeriesError(f"{u[0]} is not known to be real")
    rise = [*(k * c for k, c in enumerate(u[1:], 1)), sp.S.Zero]
    square = _times(u, u)
    slope = _times(rise, _power([1 + square[0], *square[1:]], sp.S.NegativeOne))
    return [sp.atan(u[0]), *(c / n for n, c in enumerate(slope[:-1], 1))]


_RULES: dict[type, Callable[..., _Series]] = {
    sp.Add: _sum,
    sp.Mul: _product,
    sp.exp: _exponential,
    sp.atan: _arc_tangent,
}
