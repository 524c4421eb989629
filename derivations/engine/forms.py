"""Expressions expanded, factored, reduced and differentiated: what SymPy's functions give, but sooner.

Fractions are computed in a ring of polynomials, whose generators are those of `identity`. Signs follow from
those of the letters alone. Only what these rules do not cover goes to SymPy.
"""

import math
from collections import Counter
from collections.abc import Mapping
from functools import lru_cache, reduce
from operator import add, mul

import sympy as sp
from sympy.polys.rings import PolyElement

from .identity import LARGEST, Polynomials, letters_of

SMOOTH = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.atan, sp.asinh)
"""Functions that have all derivatives wherever their argument is real."""
_ELEMENTARY = (*SMOOTH, sp.log, sp.tan, sp.asin)


@lru_cache(maxsize=16384)
def derivative(  # noqa: PLR0911 one return for each rule
    expr: sp.Expr, letter: sp.Symbol
) -> sp.Expr:
    """Differentiate by the rules of sums, products, powers and chains.

    >>> x, y = sp.symbols("x y")
    >>> derivative(x**3 * y + sp.exp(2 * x), x)
    3*x**2*y + 2*exp(2*x)
    """
    if letter not in letters_of(expr):
        return sp.S.Zero
    if expr == letter:
        return sp.S.One
    if expr.is_Add:
        return sp.Add(*(derivative(arg, letter) for arg in expr.args))
    if expr.is_Mul:
        slopes = [(k, derivative(arg, letter)) for k, arg in enumerate(expr.args)]
        return sp.Add(
            *(
                sp.Mul(*expr.args[:k], slope, *expr.args[k + 1 :])
                for k, slope in slopes
                if slope != 0
            )
        )
    if isinstance(expr, sp.exp):
        return derivative(expr.exp, letter) * expr
    if expr.is_Pow and letter not in letters_of(expr.exp):
        return expr.exp * derivative(expr.base, letter) * expr.base ** (expr.exp - 1)
    if isinstance(expr, _ELEMENTARY):
        return expr.fdiff(1) * derivative(expr.args[0], letter)
    return sp.diff(expr, letter)


def carried_out(expr: sp.Expr) -> sp.Expr:
    """Carry out derivatives and values at a place, but no integrals and sums."""
    if not expr.has(sp.Derivative, sp.Subs, Computed):
        return expr
    if isinstance(expr, sp.Derivative):
        inner = carried_out(expr.expr)
        if not all(letter.is_Symbol and times.is_Integer for letter, times in expr.variable_count):
            return sp.Derivative(inner, *expr.variable_count).doit(integrals=False, sums=False)
        for letter in expr.variables:
            inner = derivative(inner, letter)
        return inner
    if expr.is_Add or expr.is_Mul or expr.is_Pow:
        return expr.func(*map(carried_out, expr.args))
    if isinstance(expr, sp.Subs):
        inner = carried_out(expr.expr)
        if not inner.has(sp.Derivative, sp.Integral, sp.Sum, sp.Subs):
            return put(inner, dict(zip(expr.variables, expr.point, strict=True)))
    return expr.doit(integrals=False, sums=False)


_BINDING = (sp.Derivative, sp.Integral, sp.Sum, sp.Product, sp.Subs, sp.Limit, sp.Lambda)


def put(expr: sp.Expr, values: Mapping[sp.Symbol, sp.Expr]) -> sp.Expr:
    """Put in values of letters, all at once."""
    if expr.has(*_BINDING) or not all(letter.is_Symbol for letter in values):
        return expr.subs(values, simultaneous=True)
    return expr.xreplace({letter: sp.sympify(value) for letter, value in values.items()})


class Computed(sp.Expr):
    """An expression that is printed as it stands and evaluated by `doit` in a check."""


@lru_cache(maxsize=16384)
def expanded(expr: sp.Expr) -> sp.Expr:
    """Multiply out.

    >>> x, y = sp.symbols("x y", positive=True)
    >>> expanded((x + sp.sqrt(y)) ** 2 / x)
    x + 2*sqrt(y) + y/x
    """
    letters: dict[sp.Expr, None] = {}
    if not _is_polynomial(expr, letters):
        powers = any(not each.exp.is_Integer for each in expr.atoms(sp.Pow, sp.exp))
        rules = dict.fromkeys(("power_base", "power_exp"), powers)
        return sp.expand(expr, basic=False, log=expr.has(sp.log), **rules)
    names = Polynomials(tuple((letter, sp.S.One) for letter in letters))
    return names.expression(_polynomial(expr, names))


def coefficients(expr: sp.Expr, letter: sp.Symbol) -> dict[sp.Expr, sp.Expr]:
    """Return the coefficients of a polynomial in a letter by its powers.

    >>> x, y = sp.symbols("x y")
    >>> coefficients((x + y) ** 2 - y**2, x)
    {2: 1, 1: 2*y}
    """
    found: dict[sp.Expr, list[sp.Expr]] = {}
    for term in sp.Add.make_args(expanded(expr)):
        parts = [factor.as_base_exp() for factor in sp.Mul.make_args(term)]
        power = next((exponent for base, exponent in parts if base == letter), sp.S.Zero)
        rest = sp.Mul(*(base**exponent for base, exponent in parts if base != letter))
        found.setdefault(power, []).append(rest)
    return {power: sp.Add(*terms) for power, terms in found.items()}


def _is_polynomial(expr: sp.Expr, letters: dict[sp.Expr, None]) -> bool:
    """Collect the letters, their inverses and their roots; False if there is anything else."""
    if expr.is_Rational:
        return True
    if expr.is_Add or expr.is_Mul:
        return all(_is_polynomial(arg, letters) for arg in expr.args)
    letter, power = _letter(expr)
    if letter.is_Symbol or (letter.is_Pow and letter.base.is_Symbol and letter.exp.is_Rational):
        letters[letter] = None
        return True
    if (
        letter.is_Function
        or isinstance(letter, sp.Derivative)
        or (letter.is_Pow and letter.base.is_Symbol)
    ):
        letters[letter] = None
        return _is_multiplied_out(letter)
    return power > 1 and letter.is_Add and _is_polynomial(letter, letters)


@lru_cache(maxsize=8192)
def _is_multiplied_out(expr: sp.Expr) -> bool:
    return bool(sp.expand(expr) == expr)


def _letter(expr: sp.Expr) -> tuple[sp.Expr, int]:
    """Return g, k with expr = g**k, k > 0: a base, its inverse, or a root of one of them."""
    if not (expr.is_Pow and expr.exp.is_Rational) or abs(expr.exp) > LARGEST:
        return expr, 1
    p, q = int(expr.exp.p), int(expr.exp.q)
    return expr.base ** sp.Rational(1 if p > 0 else -1, q), abs(p)


def _polynomial(expr: sp.Expr, names: Polynomials) -> PolyElement:
    if expr.is_Rational:
        return names.number(expr)
    if expr.is_Add or expr.is_Mul:
        return reduce(add if expr.is_Add else mul, (_polynomial(arg, names) for arg in expr.args))
    letter, power = _letter(expr)
    inner = _polynomial(letter, names) if letter.is_Add else names.generator(letter)
    return inner**power


@lru_cache(maxsize=8192)
def reduced(expr: sp.Expr) -> sp.Expr:
    """Write as one fraction without a common factor, multiplied out.

    >>> x = sp.Symbol("x", positive=True)
    >>> reduced(1 / (x - 1) - 2 / (x**2 - 1))
    1/(x + 1)
    """
    names = Polynomials.of(expr)
    top, bottom = names.fraction(expr)
    top, bottom = top.cancel(bottom)
    return names.expression(top) / names.expression(bottom)


@lru_cache(maxsize=8192)
def factors(expr: sp.Expr) -> tuple[sp.Expr, ...]:
    """Return the factors of numerator and denominator, with their powers; what is positive stays whole.

    A factor of both is not left out: it may vanish.

    >>> x, y = sp.symbols("x y", positive=True)
    >>> factors((x + 1) * (x**2 - y**2) / (y - x))
    (-1, 1/(-x + y), x + 1, -x + y, x + y)
    """
    if any(map(_is_root_of_sum, expr.atoms(sp.Pow))):
        expr = expr.replace(_is_root_of_sum, _factored_below)
    names, powers = Polynomials.of(expr), Counter[tuple[sp.Expr, bool]]()
    number = _collect_factors(expr, 1, names, powers)
    found = (factor ** (times if above else -times) for (factor, above), times in powers.items())
    return (*(() if number == 1 else (number,)), *found)


def _is_root_of_sum(expr: sp.Expr) -> bool:
    rooted = expr.is_Pow and expr.exp.is_Rational and not expr.exp.is_Integer
    return bool(rooted and expr.base.has(sp.Add))


@lru_cache(maxsize=1024)
def _factored_below(power: sp.Pow) -> sp.Expr:
    """Factor what is below a root, unless the sign of its terms is seen as they stand."""
    whole = sp.together(power.base)
    seen = sign_of_terms(whole) == 1
    return (whole if seen else sp.Mul(*factors(reduced(whole)))) ** power.exp


def _collect_factors(
    expr: sp.Expr, power: int, names: Polynomials, powers: Counter[tuple[sp.Expr, bool]]
) -> sp.Expr:
    """Count the factors, and return the number before them."""
    if expr.is_Mul:
        return sp.Mul(*(_collect_factors(arg, power, names, powers) for arg in expr.args))
    if expr.is_Pow and expr.exp.is_Integer:
        return _collect_factors(expr.base, power * int(expr.exp), names, powers)
    if expr.is_Number:
        return expr**power
    if not expr.is_Add or sign_of_terms(expr) == 1:
        powers[expr, power > 0] += abs(power)
        return sp.S.One
    number = sp.S.One
    for part, times in zip(names.fraction(expr), (power, -power), strict=True):
        if len(part) > 1 and (sign := _sign_of_polynomial(part, names)):
            number *= sign**times
            powers[sign * names.expression(part), times > 0] += abs(times)
            continue
        content, found = part.factor_list()
        number *= sp.Rational(int(content.numerator), int(content.denominator)) ** times
        for factor, count in found:
            powers[names.expression(factor), times > 0] += abs(times) * count
    return number


@lru_cache(maxsize=32768)
def sign_of_terms(expr: sp.Expr, *, strict: bool = True) -> int:
    """Return the sign that follows from that of the terms and factors, 0 where they do not tell.

    If it need not be strict, 1 and -1 are "not negative" and "not positive".

    >>> x, y = sp.Symbol("x", positive=True), sp.Symbol("y", real=True)
    >>> sign_of_terms(x + y**2), sign_of_terms(y**2), sign_of_terms(y**2, strict=False)
    (1, 0, 1)
    """
    if expr.is_Add and letters_of(expr):
        loose = {sign_of_terms(term, strict=False) for term in expr.args}
        if len(loose) > 1 or 0 in loose:
            return 0
        (sign,) = loose
        return sign if not strict or any(map(sign_of_terms, expr.args)) else 0
    if expr.is_Mul:
        return math.prod(sign_of_terms(factor, strict=strict) for factor in expr.args)
    if expr.is_Pow and expr.exp.is_Rational:
        return _sign_of_power(expr.base, expr.exp, strict)
    if expr.is_positive or (not strict and expr.is_nonnegative):
        return 1
    return -1 if expr.is_negative or (not strict and expr.is_nonpositive) else 0


def sign_of_fraction(expr: sp.Expr) -> int:
    """Return the sign that the terms above and below the line of one fraction have, 0 where they differ."""
    names = Polynomials.of(expr)
    return math.prod(_sign_of_polynomial(part, names) for part in names.fraction(expr))


def _sign_of_polynomial(polynomial: PolyElement, names: Polynomials) -> int:
    """Return the sign that follows from that of the terms, as `sign_of_terms` does."""
    seen, strict = set(), False
    for powers, factor in polynomial.terms():
        parts = [
            (each, sp.Integer(2 - power % 2))
            for each, power in zip(names.generators, powers, strict=True)
            if power
        ]
        sign = 1 if factor > 0 else -1
        seen.add(math.prod((_sign_of_power(*part, False) for part in parts), start=sign))
        if len(seen) > 1 or 0 in seen:
            break
        strict = strict or all(_sign_of_power(*part, True) for part in parts)
    else:
        return seen.pop() if strict else 0
    # Terms with roots or with numbers such as π may still join.
    return 0 if names.independent else sign_of_terms(names.expression(polynomial))


@lru_cache(maxsize=8192)
def _sign_of_power(base: sp.Expr, exponent: sp.Rational, strict: bool) -> int:
    """Return the sign of a power, whose base must not vanish if the exponent is negative."""
    sign = sign_of_terms(base, strict=strict or bool(exponent.is_negative))
    if not exponent.is_Integer:
        return max(sign, 0)
    if exponent.is_odd:
        return sign
    real = base.expr.is_real if isinstance(base, sp.Derivative) else base.is_real
    may_vanish = real and exponent.is_positive and not strict
    return 1 if sign or may_vanish or (base.is_Symbol and base.is_nonzero) else 0
