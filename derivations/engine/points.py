"""The signs that an expression has at a few admissible points: where both are seen, neither can be proved.

Numbers are floats with a measure of their rounding, so that only certain signs count. Nothing is proved
here: an attempt to prove what is false is given up sooner.
"""

import math
import random
from collections.abc import Callable
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

_DRAWS, _POINTS, _CERTAIN = 200, 8, 1e-9
_Interval = tuple[sp.Symbol, sp.Expr | int, sp.Expr | int]
_Value = tuple[float, float]
"""A number, and the size of which its rounding error is a small fraction."""


class _NoValueError(ArithmeticError):
    """An expression without a value at any point, such as an integral or a complex letter."""


@lru_cache(maxsize=16384)
def signs(
    expr: sp.Expr, intervals: tuple[_Interval, ...] = (), positive: tuple[sp.Expr, ...] = ()
) -> frozenset[int]:
    """Return the signs, 1 and -1, that were seen of an expression where the conditions hold."""
    seen: set[int] = set()
    try:
        for attempt in _admitted(intervals, positive):
            seen |= _sign_at(expr, _Point(attempt, intervals))
            if len(seen) == 2:
                break
    except _NoValueError:
        pass
    return frozenset(seen)


@lru_cache(maxsize=4096)
def _admitted(intervals: tuple[_Interval, ...], positive: tuple[sp.Expr, ...]) -> tuple[int, ...]:
    """Return the draws at which the conditions hold, as far as they have values."""
    ends = [gap for name, *ends in intervals for gap in _gaps(name, *ends)]
    found: list[int] = []
    for attempt in range(_DRAWS):
        point = _Point(attempt, intervals)
        try:
            if all(_sign_at(gap, point) == {1} for gap in (*ends, *positive)):
                found.append(attempt)
        except _NoValueError:
            return ()
        if len(found) == _POINTS:
            break
    return tuple(found)


def _gaps(name: sp.Symbol, low: sp.Expr | int, high: sp.Expr | int) -> list[sp.Expr]:
    """Return what is positive for a variable inside an interval, and by what it is assumed to be."""
    gaps = [name - low, high - name]
    gaps += [name] if name.is_nonnegative else [-name] if name.is_nonpositive else []
    return [gap for gap in gaps if gap.is_extended_positive is not True]


def _sign_at(expr: sp.Expr, point: "_Point") -> set[int]:
    """Return the sign at a point, in a set; the empty set where it is not certain."""
    try:
        value, size = _value(expr, point)
    except (ZeroDivisionError, OverflowError, ValueError, TypeError):
        return set()
    return {1 if value > 0 else -1} if abs(value) > _CERTAIN * size else set()


class _Point(dict[sp.Expr, float]):
    """The values of letters and of unknown functions in one draw, as they are asked for."""

    def __init__(self, attempt: int, intervals: tuple[_Interval, ...]) -> None:
        self._attempt = attempt
        self._ends = {name: (low, high) for name, low, high in intervals}

    def __missing__(self, letter: sp.Expr) -> float:
        if not letter.is_real:
            raise _NoValueError
        share = _drawn(letter, self._attempt)
        if letter in self._ends:
            low, high = (float(_value(sp.sympify(end), self)[0]) for end in self._ends.pop(letter))
            if math.isfinite(low) and math.isfinite(high):
                share = low + (high - low) * abs(share) / (1 + abs(share))
            elif math.isfinite(low) or math.isfinite(high):
                share = low + abs(share) if math.isfinite(low) else high - abs(share)
        self[letter] = share
        return share


@lru_cache(maxsize=65536)
def _drawn(letter: sp.Expr, attempt: int) -> float:
    """Draw a value that the assumptions on a letter admit: near 1, or of any order of magnitude."""
    name = letter.name if letter.is_Symbol else letter  # the same as in print, but at once
    draw = random.Random(f"{attempt} {name} {getattr(letter, 'dummy_index', '')}")
    spread = 3.0 if attempt % 3 == 0 else 0.5
    size = float(draw.randrange(1, 7)) if letter.is_integer else 10 ** draw.uniform(-spread, spread)
    negative = letter.is_nonpositive or (not letter.is_nonnegative and draw.random() < 0.5)
    return -size if negative else size


def _value(expr: sp.Expr, point: _Point) -> _Value:
    if isinstance(expr, sp.Symbol | AppliedUndef | sp.Derivative):
        value = point[expr]
        return value, abs(value)
    if expr.is_Number or expr.is_NumberSymbol:
        value = _number(expr)
        return value, abs(value)
    kind = _KINDS.get(type(expr))
    if kind is None:
        raise _NoValueError
    return kind(*(_value(part, point) for part in expr.args))


@lru_cache(maxsize=1024)
def _number(expr: sp.Expr) -> float:
    return float(expr)


def _sum(*parts: _Value) -> _Value:
    return math.fsum(value for value, _ in parts), math.fsum(size for _, size in parts)


def _product(*parts: _Value) -> _Value:
    return math.prod(value for value, _ in parts), math.prod(size for _, size in parts)


def _power(base: _Value, exponent: _Value) -> _Value:
    value = math.pow(base[0], exponent[0])
    turns = abs(exponent[0]) * base[1] / abs(base[0]) + exponent[1] * abs(math.log(abs(base[0])))
    return value, abs(value) * (1 + turns)


def _smooth(
    function: Callable[[float], float], slope: Callable[[float], float]
) -> Callable[[_Value], _Value]:
    """Return a function of a number with its error, by its slope."""

    def at(argument: _Value) -> _Value:
        value = function(argument[0])
        return value, abs(value) + abs(slope(argument[0])) * argument[1]

    return at


def _extreme(choose: Callable[..., float]) -> Callable[..., _Value]:
    return lambda *parts: (choose(value for value, _ in parts), max(size for _, size in parts))


_KINDS: dict[type, Callable[..., _Value]] = {
    sp.Add: _sum,
    sp.Mul: _product,
    sp.Pow: _power,
    sp.exp: _smooth(math.exp, math.exp),
    sp.log: _smooth(math.log, lambda x: 1 / x),
    sp.sin: _smooth(math.sin, math.cos),
    sp.cos: _smooth(math.cos, math.sin),
    sp.atan: _smooth(math.atan, lambda x: 1 / (1 + x * x)),
    sp.sinh: _smooth(math.sinh, math.cosh),
    sp.cosh: _smooth(math.cosh, math.sinh),
    sp.tanh: _smooth(math.tanh, lambda x: 1 - math.tanh(x) ** 2),
    sp.Abs: lambda part: (abs(part[0]), part[1]),
    sp.Max: _extreme(max),
    sp.Min: _extreme(min),
}
