r"""Conditions under which a step holds: intervals and inequalities, and what follows from them.

Everything here is conservative: a function returns True only for what is proved, and where it cannot
prove anything it returns False.

>>> x = sp.Symbol("x", real=True)
>>> proves_positive(1 - x**2, Conditions(intervals=((x, 0, 1),)))
True
>>> proves_positive(1 - x**2)
False
>>> y = sp.Symbol("y", positive=True)
>>> [proves_positive(sp.sin(3 * y), Conditions(positive=(end - y,))) for end in (sp.pi / 3, sp.pi / 2)]
[True, False]
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp
from sympy.codegen.cfunctions import log1p

from .forms import derivative, expanded, factors, put, reduced, sign_of_fraction, sign_of_terms
from .identity import letters_of
from .points import signs

Interval = tuple[sp.Symbol, sp.Expr | int, sp.Expr | int]
"""A variable with its lower and upper bound, as SymPy writes it; the ends do not belong to it."""


@dataclass(frozen=True)
class Conditions:
    """The premises in addition to the assumptions on the symbols."""

    intervals: tuple[Interval, ...] = ()
    positive: tuple[sp.Expr, ...] = ()
    """Expressions that are taken to be positive."""

    def with_interval(self, over: Interval) -> "Conditions":
        """Return these conditions, with one variable inside an interval as well."""
        return Conditions((*self.intervals, over), self.positive)

    @property
    def gaps(self) -> tuple[sp.Expr, ...]:
        """All that is positive: the expressions, and how far a variable is from the ends of its interval."""
        ends = (
            gap for name, low, high in self.intervals for gap in (name - low, high - name)
            if not gap.has(sp.oo, -sp.oo)
        )  # fmt: skip
        return (*self.positive, *ends)


NONE = Conditions()


def proves_positive(expr: sp.Expr, known: Conditions = NONE) -> bool:
    """Tell whether the expression is positive wherever the conditions hold."""
    expr = sp.sympify(expr)
    return -1 not in signs(expr, known.intervals, known.positive) and _sign(expr, known) == 1


def proves_nonnegative(expr: sp.Expr, known: Conditions = NONE) -> bool:
    """Tell whether the expression is never negative where the conditions hold."""
    return _is_nonnegative(sp.sympify(expr), known)


@lru_cache(maxsize=8192)
def _is_nonnegative(expr: sp.Expr, known: Conditions) -> bool:
    if -1 in signs(expr, known.intervals, known.positive):
        return False
    if known_sign(expr, strict=False) == 1 or _sign(expr, known) == 1:
        return True
    if expr.is_Add or expr.is_Mul:
        if all(proves_nonnegative(part, known) for part in expr.args):
            return True
    elif isinstance(expr, sp.Integral) and len(expr.limits) == 1:
        return _is_nonnegative_integral(expr, known)
    return any(_product_sign(one, strict=False) == 1 for one in _swept(expr, known))


def _is_nonnegative_integral(expr: sp.Integral, known: Conditions) -> bool:
    """Decide by the integrand, whose variable has the conditions of its range and no others."""
    variable, low, high = expr.limits[0]
    bound = sp.Dummy(variable.name, real=True)
    inside = known.with_interval((bound, low, high))
    integrand = expr.function.subs(variable, bound)
    return (
        _exists(integrand, (bound, low, high), known)
        and proves_nonnegative(high - low, known)
        and proves_nonnegative(integrand, inside)
    )


def _exists(integrand: sp.Expr, over: Interval, known: Conditions) -> bool:
    """Tell whether an integral is known to exist: of what is continuous, between finite ends."""
    from .algebra import is_continuous

    return all(sp.sympify(end).is_finite for end in over[1:]) and is_continuous(
        integrand, over, known
    )


def proves_nonzero(expr: sp.Expr, known: Conditions = NONE) -> bool:
    """Tell whether the expression has no zero where the conditions hold."""
    expr = sp.sympify(expr)
    if sign_of_terms(expr) != 0 or expr.is_nonzero is True or _sign(expr, known) != 0:
        return True
    excluded = {each.base for each in known.positive if is_square(each)}
    if not excluded or expr.has(sp.Integral, sp.Derivative):
        return False
    excluded |= {-each for each in excluded}
    bases = (factor.as_base_exp()[0] for factor in factors(expr))
    return all(
        expanded(base) in excluded or base.is_nonzero or _sign(base, known) for base in bases
    )


def is_square(gap: sp.Expr) -> bool:
    """Tell whether a condition is that a square is positive: that its base does not vanish."""
    return bool(gap.is_Pow and gap.exp == 2)


def proves_real(expr: sp.Expr, known: Conditions = NONE) -> bool:
    """Tell whether the expression is real and finite wherever the conditions hold."""
    if expr.is_real:
        return True
    if isinstance(expr, sp.Derivative):
        return proves_real(expr.expr, known)
    if expr.is_Pow:
        base, exponent = expr.args
        if not (exponent.is_Rational and proves_real(base, known)):
            return False
        if exponent.is_negative and not proves_nonzero(base, known):
            return False
        return bool(exponent.is_Integer or proves_nonnegative(base, known))
    return bool((expr.is_Add or expr.is_Mul) and all(proves_real(arg, known) for arg in expr.args))


@lru_cache(maxsize=8192)
def _sign(expr: sp.Expr, known: Conditions) -> int:
    """Return 1 or -1 for an expression of that sign everywhere, and 0 where nothing is proved."""
    seen = signs(expr, known.intervals, known.positive)
    if len(seen) == 2:
        return 0
    if sign := known_sign(expr):
        return sign
    if isinstance(expr, sp.Integral) and len(expr.limits) == 1:
        sign = _sign_of_integral(expr, known)
    elif expr.is_Add and known.positive:
        sign = next((side for side in _sides(seen) if _outweighs(side * expr, known)), 0)
    elif expr.is_Mul:
        sign = int(sp.prod([_sign(factor, known) for factor in expr.args]))
    elif expr.is_Pow and expr.exp.is_Integer:
        sign = _sign(expr.base, known) ** abs(int(expr.exp))
    elif isinstance(expr, sp.sin):  # of an angle between 0 and pi
        sign = int(all(_sign(gap, known) == 1 for gap in (expr.args[0], sp.pi - expr.args[0])))
    if sign:
        return sign
    sign = _sign_of_forms(expr, known) or _sign_by_roots(expr, known)
    if sign or not expr.free_symbols:
        return sign
    factored = sp.Mul(*factors(expr)) if expr.is_Add and known.positive else expr
    several = sum(bool(part.free_symbols) for part in sp.Mul.make_args(factored)) > 1
    if factored != expr and several and (sign := _sign(factored, known)):
        return sign
    return next((side for side in _sides(seen) if _by_slope(side * expr)), 0)


def _sign_of_forms(expr: sp.Expr, known: Conditions) -> int:
    forms = []
    for one in _swept(expr, known):
        if sign := _sign_of_fraction(one):  # which costs much less than to factor
            return sign
        forms.append(one)
    return next(filter(None, map(_product_sign, forms)), 0)


def _sign_of_integral(expr: sp.Integral, known: Conditions) -> int:
    """Return the sign of the integrand, between ends in order."""
    variable, low, high = expr.limits[0]
    bound = sp.Dummy(variable.name, real=True)
    integrand, over = expr.function.subs(variable, bound), (bound, low, high)
    if not (_exists(integrand, over, known) and proves_positive(high - low, known)):
        return 0
    return _sign(integrand, known.with_interval(over))


def _sides(seen: frozenset[int]) -> tuple[int, ...]:
    """Return the signs that may be proved: the one that was seen, or else both."""
    return tuple(seen) or (1, -1)


_DERIVATIVES, _LONGEST = 6, 60
"""How often an inequality is put down to that of a derivative, and the operations that it may have."""


@lru_cache(maxsize=4096)
def _by_slope(expr: sp.Expr, left: int = _DERIVATIVES) -> bool:
    """Tell whether a smooth function of one positive letter is positive by its slope and a value.

    It rises from a value at 0 that is not negative; an analytic function whose slope never changes its
    sign does so strictly, if it is not constant.
    """
    from .algebra import is_continuous

    exponents = {node.exp for node in expr.atoms(sp.exp)}
    if len(expr.free_symbols) == 2 and len(exponents) == 1:  # it may depend on a product alone
        (product,) = exponents
        one = sp.Dummy(positive=True)
        expr = expr.subs(product, one) if product.is_positive else expr
    if len(expr.free_symbols) != 1 or not left or expr.count_ops() > _LONGEST:
        return False
    (letter,) = expr.free_symbols
    if letter.is_positive and expr.has(sp.atan) and _by_arc(expr, letter):
        return True
    kinds = (sp.exp, sp.log, sp.sin, sp.cos, sp.atan)
    if not (letter.is_positive and expr.has(*kinds)) or letter.is_integer:
        return False
    slope = expanded(derivative(expr, letter))
    if slope == 0 or not is_continuous(expr, (letter, 0, sp.oo), NONE, smooth=True):
        return False
    start = expr.subs(letter, 0)
    return bool(start.is_nonnegative and (slope.is_nonnegative or _never_below(slope, left - 1)))


def _by_arc(expr: sp.Expr, letter: sp.Symbol) -> bool:
    """Decide a rational function and an arc tangent times a polynomial: over that, the slope is rational."""
    from .algebra import limit

    arcs = sorted(expr.atoms(sp.atan), key=str)
    if len(arcs) != 1 or expr.atoms(sp.Function) - {*arcs}:
        return False
    name = sp.Dummy()
    constant, varying = expanded(expr).as_independent(letter, as_Add=True)
    dropped = constant if constant.is_positive and not constant.is_Rational else 0
    share = sp.Poly((varying + constant - dropped).xreplace({arcs[0]: name}), name)
    size = next((each for each in (share.LC(), -share.LC()) if each.is_positive), None)
    if share.degree() != 1 or size is None:
        return False
    whole = share.LC() / size * arcs[0] + sp.cancel(share.coeff_monomial(1) / size)
    slope = reduced(derivative(whole, letter))
    if not slope.is_rational_function(letter) or slope.is_number:
        return False
    end = {1: sp.S.Zero, -1: sp.oo}.get(_sign_by_roots(slope, NONE))
    return end is not None and bool(limit(whole, letter, end).is_nonnegative)


def _never_below(slope: sp.Expr, left: int) -> bool:
    """Tell whether a slope is never negative, after positive factors have been left out."""
    forms = [slope, sp.Mul(*factors(slope))]
    forms.append(sp.Mul(*(part for part in sp.Mul.make_args(forms[1]) if not part.is_positive)))
    return any(
        _product_sign(form, strict=False) == 1 or _by_slope(expanded(form), left) for form in forms
    )


def known_sign(expr: sp.Expr, *, strict: bool = True) -> int:
    """Return the sign that follows directly from the assumptions on the symbols."""
    sign = sign_of_terms(expr, strict=strict)
    made_of_parts = expr.is_Add or expr.is_Mul or (expr.is_Pow and expr.exp.is_Rational)
    if sign or (made_of_parts and letters_of(expr) and not _has_integers(expr)):
        return sign  # SymPy knows no more
    if expr.is_positive or (expr.is_nonnegative and not strict):
        return 1
    return -1 if expr.is_negative or (expr.is_nonpositive and not strict) else 0


def _has_integers(expr: sp.Expr) -> bool:
    return any(each.is_integer for each in letters_of(expr))


def _swept(expr: sp.Expr, known: Conditions) -> Iterator[sp.Expr]:
    """Yield the expression, and in variables that sweep over what the conditions allow, each once."""
    seen: set[sp.Expr] = set()
    for form in _forms(expr, known):
        if form not in seen:
            seen.add(form)
            yield form


@lru_cache(maxsize=1024)
def positive_letter(place: int) -> sp.Dummy:
    """Return a positive letter for one place, the same whenever it is asked: a new one defeats caches."""
    return sp.Dummy(f"positive_{place}", positive=True)


def _forms(expr: sp.Expr, known: Conditions) -> Iterator[sp.Expr]:
    yield expr
    for place, (variable, *ends) in enumerate(known.intervals):
        low, high = map(sp.sympify, ends)
        step = positive_letter(place)
        if expr.has(variable) and low.is_finite and high.is_finite:
            expr = put(expr, {variable: (low + high * step) / (1 + step)})
            yield expr
    for place, positive in enumerate(known.positive, len(known.intervals)):
        if positive.free_symbols <= expr.free_symbols:
            yield from _named(expr, positive, positive_letter(place))
    for order in (known.positive[::-1], known.positive):
        solved, rest = expr, order
        while rest:
            name = positive_letter(len(known.intervals) + len(rest))
            solved, rest = _solved(solved, rest[0], rest[1:], name)
            yield solved


def _named(expr: sp.Expr, positive: sp.Expr, name: sp.Dummy) -> Iterator[sp.Expr]:
    """Yield the expression with a name for something positive that it contains as it stands."""
    for form in _written(expr):
        changed = _renamed(form, positive, name)
        if changed != form:
            yield changed


@lru_cache(maxsize=4096)
def _renamed(expr: sp.Expr, positive: sp.Expr, name: sp.Dummy) -> sp.Expr:
    written = {positive: name, expanded(positive): name, expanded(-positive): -name}
    for gap, value in written.items():
        expr = expr.subs(gap, value)
    return expr


def _written(expr: sp.Expr) -> Iterator[sp.Expr]:
    """Yield an expression as it stands, as one fraction, and as a product."""
    yield expr
    yield reduced(expr)
    yield sp.Mul(*factors(expr))


@lru_cache(maxsize=8192)
def _solved(
    expr: sp.Expr, positive: sp.Expr, rest: tuple[sp.Expr, ...], name: sp.Dummy
) -> tuple[sp.Expr, tuple[sp.Expr, ...]]:
    """Put in for one of its symbols what it is in terms of something positive."""
    # A symbol of known sign would lose it.
    order = sorted(
        positive.free_symbols & expr.free_symbols,
        key=lambda each: (bool(each.is_positive), str(each)),
    )
    for symbol in order:
        slope, rest_of = linear(positive, symbol)
        if slope.is_nonzero:
            value = {symbol: (name - rest_of) / slope}
            return put(expr, value), tuple(put(each, value) for each in rest)
    return expr, rest


@lru_cache(maxsize=8192)
def linear(expr: sp.Expr, symbol: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
    """Return slope and rest of what is linear in a symbol, else zero and the expression."""
    slope = derivative(expr, symbol)
    return (sp.S.Zero, expr) if slope.has(symbol) else (slope, expanded(expr - slope * symbol))


@lru_cache(maxsize=8192)
def _sign_of_fraction(expr: sp.Expr) -> int:
    """Return the sign that the terms above and below the line have, 0 where they differ."""
    return 0 if len(signs(expr)) == 2 else sign_of_fraction(expr)


@lru_cache(maxsize=8192)
def _product_sign(expr: sp.Expr, *, strict: bool = True) -> int:
    """Return the sign of a product from that of its factors, 0 where one of them is not known.

    If it need not be strict, factors may vanish, and 1 and -1 are "not negative", "not positive".
    """
    if len(signs(expr)) == 2:
        return 0
    sign = 1
    for factor in factors(expr):
        base, power = factor.as_base_exp()
        even = bool(power.is_Integer and power % 2 == 0)
        base = base if power.is_Integer else factor
        one = _factor_sign(base, strict=strict)
        if one:
            sign *= 1 if even else one
        elif not (even and base.is_real and (base.is_nonzero or not strict)):
            return 0
    return sign


@lru_cache(maxsize=8192)
def _factor_sign(factor: sp.Expr, *, strict: bool) -> int:
    whole = expanded(factor)
    sign = known_sign(factor, strict=strict) or known_sign(whole, strict=strict)
    if sign or not whole.is_Add:
        return sign
    seen = signs(whole)
    if len(seen) == 2:
        return 0
    for side in _sides(seen):
        if _outweighs(side * whole, NONE):
            return side
    univariate = len(whole.free_symbols) == 1 and whole.is_polynomial()
    return _sign_by_roots(whole, NONE) if univariate else 0


@lru_cache(maxsize=4096)
def _outweighs(total: sp.Expr, known: Conditions) -> bool:
    """Tell whether each negative term of a sum has a positive one of its own that is larger.

    Roots are compared by their squares, exponentials by their exponents; a root with all other terms too.
    """
    terms = sp.Add.make_args(expanded(total))
    for root in (term for term in terms if term.is_Pow and known_sign(term) == 1):
        rest = expanded(sum(terms) - root)
        if rest.is_real and known_sign(expanded(root**2 - rest**2)) == 1:
            return True
    plus = [term for term in terms if known_sign(term) == 1]
    minus = [-term for term in terms if known_sign(term) == -1]
    if len(plus) + len(minus) < len(terms) or not minus:
        return False
    for small in minus:
        for large in plus:
            if (
                known_sign(expanded(large**2 - small**2)) == 1
                or _is_smaller_power(small, large)
                or _is_share(small / large, known)
            ):
                plus.remove(large)
                break
        else:
            rest = expanded(sum(plus) ** 2 - sum(minus) ** 2)
            return len(minus) == 1 and known_sign(rest) == 1
    return True


def _is_smaller_power(small: sp.Expr, large: sp.Expr) -> bool:
    """Tell whether the logarithm of a product says that it is smaller; that of a letter has no known sign."""
    if any(factor.as_base_exp()[0].is_Symbol for factor in sp.Mul.make_args(small / large)):
        return False
    gap = expanded(sp.expand_log(sp.log(large) - sp.log(small)))
    return bool(gap.is_positive)


def _is_share(ratio: sp.Expr, known: Conditions) -> bool:
    """Tell whether a product is less than 1: of powers of letters of which the conditions say so."""
    bound, powers = ratio.as_coeff_Mul()
    factors = [factor.as_base_exp() for factor in sp.Mul.make_args(sp.powsimp(powers))]
    below = all(base.is_positive and 1 - base in known.positive and exponent.is_positive
                for base, exponent in factors)  # fmt: skip
    return bool(known.positive and powers != 1 and 0 < bound <= 1 and below)


def _sign_by_roots(expr: sp.Expr, known: Conditions) -> int:
    """Decide a rational function of one variable by Sturm's theorem."""
    from .algebra import UndecidedError, sign_between

    if len(expr.free_symbols) != 1:
        return 0
    (variable,) = expr.free_symbols
    if not variable.is_extended_real:
        return 0
    low = 0 if variable.is_nonnegative else -sp.oo
    high = 0 if variable.is_nonpositive else sp.oo
    given = [over for over in known.intervals if over[0] == variable]
    try:
        found = sign_between(expr, given[-1] if given else (variable, low, high))
    except (UndecidedError, sp.PolynomialError):
        return 0
    sign = {"+": 1, "-": -1}.get(found, 0)
    # The interval is open, but a variable that may be zero reaches its end.
    closed = not given and 0 in (low, high) and not variable.is_nonzero
    return 0 if closed and known_sign(sign * expr.subs(variable, 0)) != 1 else sign


def open_factors(expr: sp.Expr, known: Conditions) -> list[sp.Expr]:
    """Return what must be positive for an expression to be so, as far as it is not proved.

    One factor of unknown sign, what stands under a root, or the expression itself.

    >>> q = sp.Symbol("q", positive=True)
    >>> open_factors((1 - q**2) / (2 * q), NONE)
    [1 - q]
    """
    if known_sign(expr) == 1:
        return []
    if expr.is_Pow and expr.exp.is_Rational and not expr.exp.is_Integer:
        return open_factors(expr.base, known)
    if expr.has(sp.Derivative, sp.Integral) or not expr.free_symbols:
        return [expr]
    sign, unknown = 1, []
    for part in sp.fraction(sp.together(expr)):
        for factor in sp.Mul.make_args(sp.factor(part)):
            found = _sign(factor, known)
            sign *= found or 1
            if not found:
                unknown.append(factor)
    if not unknown and sign > 0:
        return []
    if len(unknown) != 1 or unknown[0].is_Pow:
        return [] if proves_positive(expr, known) else [expr]
    gap = expanded(sign * unknown[0])
    base, exponent = sp.powsimp(1 - gap).as_base_exp()
    return [1 - base if base.is_positive and exponent.is_positive and base.is_Symbol else gap]


@lru_cache(maxsize=16384)
def demands(expr: sp.Expr) -> tuple[frozenset[sp.Expr], frozenset[sp.Expr]]:
    """Collect what must not vanish, and what must not be negative, where the expression is real."""
    own = _OWN_DEMANDS.get(expr.func)
    nonzero, nonnegative = map(set, own(*expr.args) if own else ((), ()))
    for part in expr.args:
        inner = demands(part)
        nonzero |= inner[0]
        nonnegative |= inner[1]
    return frozenset(nonzero), frozenset(nonnegative)


_Demands = tuple[tuple[sp.Expr, ...], tuple[sp.Expr, ...]]


def _demands_of_power(base: sp.Expr, exponent: sp.Expr) -> _Demands:
    nonzero = () if exponent.is_nonnegative else (base,)
    return nonzero, () if exponent.is_integer else (base,)


_OWN_DEMANDS: dict[type, Callable[..., _Demands]] = {
    sp.Pow: _demands_of_power,
    sp.log: lambda u: ((u,), (u,)),
    log1p: lambda u: ((1 + u,), (1 + u,)),
    sp.asin: lambda u: ((), (1 - u**2,)),
    sp.tan: lambda u: ((sp.cos(u),), ()),
}
"""What a node demands of its arguments."""
