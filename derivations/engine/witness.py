"""A point at which premises and conditions hold together: without one they prove nothing.

Letters are drawn, the equations solved one after the other with 120 digits, at changes of sign. Values,
slopes and integrals of unknown functions are letters of their own.
"""

import math
import random
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, lru_cache
from itertools import chain
from typing import Any

import mpmath
import sympy as sp
from sympy.core.function import AppliedUndef

from .conditions import known_sign, linear, positive_letter, proves_nonnegative, proves_positive
from .identity import letters_of

_OPAQUE = (AppliedUndef, sp.Derivative, sp.Integral, sp.Sum, sp.Subs, sp.Indexed)
_TRIES, _DIGITS, _NONE = 800, 120, mpmath.mpf(10) ** -90
_GRID = [
    *(mpmath.mpf(10) ** k for k in range(-20, -4)),
    *(mpmath.mpf(10) ** (mpmath.mpf(k) / 3) for k in range(-12, 13)),
    *(mpmath.mpf(10) ** k for k in range(5, 21)),
]


Pairs = tuple[tuple[sp.Expr, sp.Expr], ...]
_Point = dict[sp.Expr, mpmath.mpf]
_Expressions = tuple[sp.Expr, ...]


def has_witness(premises: Pairs, positive: _Expressions, near: _Point | None = None) -> bool:
    """Tell whether a point was found where all premises hold and the other expressions are positive.

    It is looked for `near` a point first, to which what was found is added.
    """
    near = {} if near is None else near
    groups = _without_definitions(premises, positive)
    parts: list[frozenset[sp.Expr]] = []
    for letters in map(letters_of, chain(*groups)):
        joined = [part for part in parts if part & letters]
        parts = [*(part for part in parts if part not in joined), letters.union(*joined)]
    # What has no letter in common needs no common point.
    for part in dict.fromkeys(parts):
        asked = laws, gaps, signed = (
            *(tuple(each for each in group if letters_of(each) <= part) for group in groups),
        )
        if asked not in _found:
            if (point := _search(laws, gaps, signed, near)) is None:
                return False
            _found[asked] = point
        near |= _found[asked]
    return True


_found: dict[tuple[_Expressions, ...], _Point] = {}
"""The points that were found, by what vanishes, is positive, and is not negative there."""


def _search(
    laws: _Expressions, gaps: _Expressions, signed: _Expressions, near: _Point
) -> _Point | None:
    slack = {gap: positive_letter(place) for place, gap in enumerate(gaps)}
    order = sorted(frozenset().union(*map(letters_of, (*laws, *gaps, *signed))), key=str)
    above = {*gaps, *signed}
    draw = random.Random(2020)
    with mpmath.workdps(_DIGITS):
        for attempt in range(2 if laws and len(order) == 1 else _TRIES):  # then nothing is drawn
            # Some conditions are met by letting them be equal to something positive.
            forced = draw.sample(gaps, draw.randrange(len(gaps) + 1)) if attempt % 2 else []
            start = {slack[gap]: _drawn(slack[gap], draw, above) for gap in forced}
            closed = [*laws, *(gap - slack[gap] for gap in forced)]
            draw.shuffle(order)
            # What is in few equations is left to them; else what stands for unknown functions is.
            held = Counter(letter for law in closed for letter in letters_of(law))
            last = (
                held.__getitem__ if attempt % 4 > 1 else lambda each: not isinstance(each, sp.Dummy)
            )
            order.sort(key=last, reverse=True)
            try:
                for point in _extended(start, closed, order, draw, above, {} if attempt else near):
                    if _meets(point, gaps, signed):
                        return point
            except (ZeroDivisionError, ValueError, OverflowError, TypeError):
                continue
    return None


@lru_cache(maxsize=4096)
def _without_definitions(
    premises: Pairs, positive: _Expressions
) -> tuple[list[sp.Expr], list[sp.Expr], list[sp.Expr]]:
    """Put in the values of names; return what must vanish, be positive, and not be negative."""
    values: dict[sp.Expr, sp.Expr] = {}
    laws: list[sp.Expr] = []
    for lhs, rhs in premises:
        name, value = _put(lhs, values), _put(rhs, values)
        if name.is_Symbol and not value.has(name):
            values = {each: _put(known, {name: value}) for each, known in values.items()}
            values[name] = value
        else:
            laws.append(name - value)
    whole = [sp.sin(sp.pi * value) for name, value in values.items() if name.is_integer]
    sized = [(name, value) for name, value in values.items() if name.is_nonnegative]
    sized += [(-name, -value) for name, value in values.items() if name.is_nonpositive]
    groups = (
        (*laws, *whole),
        (*positive, *(value for name, value in sized if name.is_positive)),
        [value for name, value in sized if not name.is_positive],
    )
    left = [[_lettered(_put(each, values)) for each in dict.fromkeys(group)] for group in groups]
    laws, gaps, signed = left
    return (
        [law for law in laws if law != 0],
        [gap for gap in gaps if known_sign(gap) != 1],
        [gap for gap in signed if known_sign(gap, strict=False) != 1],
    )


def _put(expr: sp.Expr, values: dict[sp.Expr, sp.Expr]) -> sp.Expr:
    """Put in values of letters, but not of the variables of an integral, which are its own."""
    if values.keys().isdisjoint(letters_of(expr)):
        return expr
    if isinstance(expr, (sp.Integral, sp.Sum, sp.Derivative, sp.Subs)):
        free = expr.free_symbols
        return _inside(expr, tuple((name, value) for name, value in values.items() if name in free))
    if expr.has(sp.Integral, sp.Sum, sp.Derivative, sp.Subs):
        return expr.func(*(_put(part, values) for part in expr.args))
    return expr.xreplace(values)


@lru_cache(maxsize=4096)
def _inside(node: sp.Expr, values: Pairs) -> sp.Expr:
    return node.subs(values)


@cache
def _lettered(expr: sp.Expr) -> sp.Expr:
    """Write letters for what depends on unknown functions, with their sign."""
    if isinstance(expr, _OPAQUE):
        known = {"positive": proves_positive(expr), "nonnegative": proves_nonnegative(expr)}
        # Named, so that the order of the letters does not depend on how many there were before.
        return sp.Dummy(str(expr), real=True, **{k: v for k, v in known.items() if v})
    return expr.func(*map(_lettered, expr.args)) if expr.has(*_OPAQUE) else expr


def _drawn(letter: sp.Symbol, draw: random.Random, above: set[sp.Expr]) -> mpmath.mpf:
    """Draw an admissible value, above zero where a condition says so."""
    size = draw.randrange(1, 9) if letter.is_integer else 10 ** draw.uniform(-2, 1)
    negative = letter.is_nonpositive or (
        not letter.is_nonnegative and letter not in above and draw.random() < 0.5
    )
    return mpmath.mpf(-size if negative else size)


def _extended(
    point: _Point,
    equations: list[sp.Expr],
    order: list[sp.Symbol],
    draw: random.Random,
    above: set[sp.Expr],
    near: _Point,
) -> Iterator[_Point]:
    """Give values to the letters that are left: by an equation, else those near a point, or by chance."""
    waiting = []
    for each in equations:
        left = letters_of(each) - point.keys()
        if not left:
            if abs(value_of(each, point)) > _NONE:
                return
        else:
            waiting.append((len(left), each, left))
    if not waiting and all(letter in point for letter in order):
        yield point
        return
    if waiting and (least := min(waiting, key=lambda row: row[0]))[0] == 1:
        _, equation, (letter,) = least
        rest = [each for _, each, _ in waiting if each is not equation]
        for value in _roots(equation, letter, point):
            yield from _extended({**point, letter: value}, rest, order, draw, above, near)
        return
    letter = next(each for each in order if each not in point)
    point = {**point, letter: near.get(letter) or _drawn(letter, draw, above)}
    yield from _extended(point, [each for _, each, _ in waiting], order, draw, above, near)


def _roots(equation: sp.Expr, letter: sp.Symbol, point: _Point) -> Iterator[mpmath.mpf]:
    """Yield admissible roots: of a linear equation, else between points with values of two signs."""
    slope, rest = linear(equation, letter)
    if slope != 0:
        zero, slant = value_of(rest, point), value_of(slope, point)
        found: Iterable[mpmath.mpf] = [] if slant == 0 else [-zero / slant]
    else:
        grid = [] if letter.is_nonnegative else [-each for each in reversed(_GRID)]
        grid += [mpmath.mpf(0)] if not letter.is_nonzero else []
        grid += [] if letter.is_nonpositive else _GRID
        found = _between(equation, letter, point, grid)
    yield from (value for value in found if _admits(letter, value))


def _between(
    equation: sp.Expr, letter: sp.Symbol, point: _Point, grid: list[mpmath.mpf]
) -> Iterator[mpmath.mpf]:
    """Yield roots on a grid and between its points; floats say where to look for them."""
    rough, height = (_in_one(equation, letter, point, each) for each in (mpmath.fp, mpmath.mp))
    before, last = None, math.nan
    for place in grid:
        try:
            value = float(rough(float(place)))
        except (ZeroDivisionError, ValueError, OverflowError, TypeError):
            value = math.nan
        if value == 0:
            root = place
        elif value * last < 0:
            root = mpmath.findroot(height, (before, place), solver="anderson", verify=False)
        else:
            root = None
        if root is not None and abs(height(root)) < _NONE:
            yield root
        before, last = place, value


def _admits(letter: sp.Symbol, value: mpmath.mpf) -> bool:
    if not isinstance(value, mpmath.mpf) or not mpmath.isfinite(value):
        return False
    if letter.is_integer and abs(value - mpmath.nint(value)) > _NONE:
        return False
    if letter.is_nonzero and abs(value) < _NONE:
        return False
    return not (letter.is_nonnegative and value < 0) and not (letter.is_nonpositive and value > 0)


def _meets(point: _Point, gaps: _Expressions, signed: _Expressions) -> bool:
    least = [(gap, _NONE) for gap in gaps] + [(gap, -_NONE) for gap in signed]
    values = ((value_of(gap, point), low) for gap, low in least)
    return all(isinstance(value, mpmath.mpf) and value > low for value, low in values)


def value_of(expr: sp.Expr, point: Mapping[sp.Expr, mpmath.mpf]) -> mpmath.mpf:
    """Evaluate at a point; of few values of many expressions, so that it does not pay to compile them."""
    if expr.is_Symbol:
        return point[expr]
    return _kind(expr, mpmath.mp)(*[value_of(part, point) for part in expr.args])


def _in_one(expr: sp.Expr, letter: sp.Symbol, point: _Point, numbers: Any) -> Callable[[Any], Any]:
    """Return the value as a function of one letter; what is without it is evaluated once."""
    if expr == letter:
        return lambda value: value
    if letter not in letters_of(expr):
        known = numbers.convert(value_of(expr, point))
        return lambda _: known
    kind = _kind(expr, numbers)
    parts = [_in_one(part, letter, point, numbers) for part in expr.args]
    return lambda value: kind(*[part(value) for part in parts])


@lru_cache(maxsize=8192)
def _kind(expr: sp.Expr, numbers: Any) -> Callable[..., Any]:
    """Return what gives the value of a node from those of its parts: floats, or numbers of many digits."""
    if expr.is_Number or expr.is_NumberSymbol:
        known = numbers.convert(mpmath.mpf(expr._to_mpmath(mpmath.mp.prec)))
        return lambda: known
    if expr.is_Pow and expr.exp.is_Integer:
        whole = int(expr.exp)
        return lambda base, _: base**whole
    name = expr.func.__name__
    kind = _KINDS.get(expr.func) or getattr(numbers, name, getattr(mpmath, name, None))
    if kind is None:
        raise TypeError(f"{type(expr).__name__} is no function that has a value here")
    return kind


_KINDS: dict[type, Callable[..., Any]] = {
    sp.Add: lambda *parts: sum(parts[1:], parts[0]),
    sp.Mul: lambda *parts: math.prod(parts[1:], start=parts[0]),
    sp.Pow: pow, sp.Abs: abs, sp.Max: max, sp.Min: min, sp.UnevaluatedExpr: lambda part: part,
}  # fmt: skip
