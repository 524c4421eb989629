r"""Test whether an expression is identically zero, in a ring of polynomials: fast and exact.

Symbols are the generators, and so are roots, powers with a symbol in the exponent, exponentials, and
whatever else is no fraction of them. Of a root ``g = b**(1/q)`` it is used that ``g**q = b``. Other
relations between generators are not known here, so that only the answer True is a proof.

>>> x = sp.Symbol("x", positive=True)
>>> vanishes(sp.sqrt(1 + x) ** 3 - (1 + x) * sp.sqrt(1 + x)), vanishes(sp.sin(x) - x)
(True, False)
>>> vanishes(x**(2*sp.pi) - (x**sp.pi)**2 + 1 / (1 + x) + x / (1 + x) - 1)
True
"""

from functools import lru_cache, reduce

import sympy as sp
from sympy.polys.rings import PolyElement, PolyRing

LARGEST = 64
"""Higher powers are generators of their own: nothing here has them, and they would not end."""

_Key = tuple[sp.Expr, sp.Expr]
"""A generator as base and exponent."""


@lru_cache(maxsize=4096)
def vanishes(expr: sp.Expr) -> bool:
    """Tell whether an expression is proved to be zero wherever it is defined."""
    polynomials = Polynomials.of(expr)
    try:
        top, bottom = map(polynomials.reduced, polynomials.fraction(expr))
    except ZeroDivisionError:
        return False
    return bool(top == 0 and bottom != 0)


@lru_cache(maxsize=32768)
def letters_of(expr: sp.Expr) -> frozenset[sp.Expr]:
    """Return the free symbols, which SymPy collects anew whenever it is asked."""
    if expr.is_Add or expr.is_Mul or expr.is_Pow:
        return frozenset().union(*map(letters_of, expr.args))
    return frozenset(expr.free_symbols)


@lru_cache(maxsize=8192)
def is_rational(expr: sp.Expr) -> bool:
    """Tell whether only rational numbers and whole powers of symbols are in the expression.

    Then a coefficient that vanishes is literally 0 once it has been expanded.
    """
    if expr.is_Add or expr.is_Mul:
        return all(map(is_rational, expr.args))
    if expr.is_Pow:
        return bool(expr.exp.is_Integer) and is_rational(expr.base)
    return bool(expr.is_Symbol or expr.is_Rational)


def _power(expr: sp.Expr) -> tuple[_Key, int, int]:
    """Return g, k, m with expr = g**k b**m, where b is the base of the generator g."""
    base, exponent = expr.as_base_exp()
    if exponent.is_Rational:
        if abs(exponent) > LARGEST:
            return (expr, sp.S.One), 1, 0
        key = base, sp.Rational(1, exponent.q)
        return (key, int(exponent), 0) if exponent.q == 1 else (key, *_split(exponent))
    number, rest = exponent.as_coeff_Mul()
    if not number.is_Rational or abs(number.p) > LARGEST:
        return (expr, sp.S.One), 1, 0
    return (_lowest_terms(base), rest / number.q), int(number.p), 0


def _split(exponent: sp.Rational) -> tuple[int, int]:
    """Return k, m with k/q + m = exponent, 0 < k < q."""
    return int(exponent.p % exponent.q), int(exponent.p // exponent.q)


@lru_cache(maxsize=1024)
def _lowest_terms(base: sp.Expr) -> sp.Expr:
    """Write equal bases alike, so that their powers are one generator."""
    return sp.cancel(base) if base.is_Add or base.is_Mul else base


def _whole(expr: sp.Expr) -> bool:
    return bool(expr.is_Pow and expr.exp.is_Integer and abs(expr.exp) <= LARGEST)


def _parts(expr: sp.Expr) -> tuple[sp.Expr, ...]:
    """Return the factors of a power whose exponent is a sum: b**(x + y) = b**x b**y."""
    base, exponent = expr.as_base_exp()
    return tuple(base**term for term in exponent.args) if exponent.is_Add else ()


def _collect(expr: sp.Expr, keys: dict[_Key, None]) -> None:
    """Find the generators."""
    if expr.is_Rational:
        return
    if expr.is_Add or expr.is_Mul:
        for arg in expr.args:
            _collect(arg, keys)
    elif _whole(expr):
        _collect(expr.base, keys)
    elif parts := _parts(expr):
        for part in parts:
            _collect(part, keys)
    else:
        key, _, whole = _power(expr)
        known = key in keys
        keys[key] = None
        if whole or (not known and _is_root(key)):
            _collect(key[0], keys)


def _is_root(key: _Key) -> bool:
    return bool(key[1].is_Rational and key[1] != 1)


@lru_cache(maxsize=256)
def _ring(count: int) -> PolyRing:
    return PolyRing([f"g{place}" for place in range(count)], sp.QQ)


class Polynomials:
    """The ring, and what the expressions are in it: fractions of two polynomials."""

    def __init__(self, keys: tuple[_Key, ...]) -> None:
        self._ring = _ring(len(keys))
        self._places = dict(zip(keys, self._ring.gens, strict=True))
        self.generators = [base**exponent for base, exponent in keys]
        # A root in a root comes after the one that contains it.
        self._roots = sorted(filter(_is_root, keys), key=lambda key: -key[0].count_ops())
        self.independent = not self._roots and all(map(letters_of, self.generators))
        """Whether no generator is known to follow from others."""

    @classmethod
    def of(cls, expr: sp.Expr) -> "Polynomials":
        """Return the ring of the generators of an expression."""
        keys: dict[_Key, None] = {}
        _collect(expr, keys)
        return cls(tuple(keys))

    def fraction(self, expr: sp.Expr) -> tuple[PolyElement, PolyElement]:
        """Return numerator and denominator."""
        if expr.is_Rational:
            return self.number(expr), self._ring(1)
        if expr.is_Add or expr.is_Mul:
            join = _sum if expr.is_Add else _product
            found = self.fraction(expr.args[0])
            for arg in expr.args[1:]:
                found = join(found, self.fraction(arg))
            return found
        if _whole(expr):
            return _raised(self.fraction(expr.base), int(expr.exp))
        if parts := _parts(expr):
            return reduce(_product, map(self.fraction, parts))
        key, power, whole = _power(expr)
        found = _raised((self._places[key], self._ring(1)), power)
        return _product(found, _raised(self.fraction(key[0]), whole)) if whole else found

    def number(self, number: sp.Rational) -> PolyElement:
        """Return a number as a polynomial."""
        return self._ring(sp.QQ(number.p, number.q))

    def generator(self, letter: sp.Expr) -> PolyElement:
        """Return the generator of a letter."""
        return self._places[letter, sp.S.One]

    def expression(self, polynomial: PolyElement) -> sp.Expr:
        """Return a polynomial as an expression."""
        return sp.Add(*(
            sp.Mul(sp.Rational(int(factor.numerator), int(factor.denominator)),
                   *(each**power for each, power in zip(self.generators, powers, strict=True) if power))
            for powers, factor in polynomial.terms()
        ))  # fmt: skip

    def reduced(self, polynomial: PolyElement) -> PolyElement:
        """Put the base for the powers of a root, up to a factor that is not zero."""
        for key in self._roots:
            order = int(key[1].q)
            place = self._ring.gens.index(self._places[key])
            top, bottom = self.fraction(key[0])
            most = max((monom[place] // order for monom in polynomial), default=0)
            total = self._ring(0)
            for monom, coefficient in polynomial.terms():
                times, left = divmod(monom[place], order)
                rest = {(*monom[:place], left, *monom[place + 1 :]): coefficient}
                total += self._ring.from_dict(rest) * top**times * bottom ** (most - times)
            polynomial = total
        return polynomial


_Fraction = tuple[PolyElement, PolyElement]


def _sum(one: _Fraction, other: _Fraction) -> _Fraction:
    if one[1] == other[1]:
        return one[0] + other[0], one[1]
    _, left, right = one[1].cofactors(other[1])
    return one[0] * right + other[0] * left, one[1] * right


def _product(one: _Fraction, other: _Fraction) -> _Fraction:
    return one[0] * other[0], one[1] * other[1]


def _raised(fraction: _Fraction, power: int) -> _Fraction:
    top, bottom = fraction if power >= 0 else fraction[::-1]
    if bottom == 0:
        raise ZeroDivisionError("a denominator is identically zero")
    return top ** abs(power), bottom ** abs(power)
