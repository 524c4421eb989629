"""Decisions by exact algebra: zero or not, sign, behaviour near a limit.

Nothing here is numerical. A function that cannot decide raises `UndecidedError`; it never guesses.
"""

from collections.abc import Callable, Mapping
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from .conditions import (
    Conditions,
    Interval,
    demands,
    proves_nonnegative,
    proves_nonzero,
    proves_positive,
)
from .forms import (
    SMOOTH,
    coefficients,
    derivative,
    expanded,
    factors,
    put,
    reduced,
    sign_of_terms,
)
from .identity import is_rational, vanishes
from .series import leading_of_series, without_root


class UndecidedError(ArithmeticError):
    """The algebra could neither prove nor refute the statement."""


DISTANCE = sp.Dummy("h", positive=True)
"""The distance from the point of a limit: no other letter, whatever its name, is this one."""
_CONTINUOUS = (sp.Abs, sp.Min, sp.Max)
"""Functions without jumps or poles where they are real."""
KINKS = (*_CONTINUOUS, sp.sign)
"""What need not be smooth."""
_WRITTEN = {
    sp.tan: lambda u: sp.sin(u) / sp.cos(u),
    sp.asinh: lambda u: sp.log(u + sp.sqrt(u**2 + 1)),
    sp.cosh: lambda u: (sp.exp(u) + sp.exp(-u)) / 2,
    sp.sinh: lambda u: (sp.exp(u) - sp.exp(-u)) / 2,
}
"""Functions by others."""


@lru_cache(maxsize=4096)
def normalise(expr: sp.Expr) -> sp.Expr:
    """Write functions by others, extremes of two by their distance, and factor radicands.

    Factoring lets ``sqrt((1 - q**2)**2/(4*q**2) + 1)`` become ``(q**2 + 1)/(2*q)`` where the
    assumptions on the symbols allow it.
    """
    for kind, written in _WRITTEN.items():
        expr = expr.replace(kind, written) if expr.has(kind) else expr
    if expr.has(sp.Max, sp.Min):
        expr = expr.replace(_is_of_two, _by_distance)
    if expr.has(sp.log):  # e**(c log b) = b**c
        expr = expr.replace(sp.exp, lambda u: sp.exp(u).rewrite(sp.Pow))
    return expr.replace(
        lambda e: e.is_Pow and e.exp.is_Rational and not e.exp.is_Integer,
        lambda e: sp.expand_power_base(sp.factor(sp.together(e.base)) ** e.exp),
    )


def _in_sines(expr: sp.Expr) -> sp.Expr:
    """Write sines and cosines of sums by those of the terms, and even powers of cosines by sines.

    >>> x = sp.Symbol("x", real=True)
    >>> _in_sines(sp.sin(2 * x)), _in_sines(sp.cos(x) ** 3)
    (2*sin(x)*cos(x), (1 - sin(x)**2)*cos(x))
    """
    return sp.expand_trig(expr).replace(
        lambda e: e.is_Pow and isinstance(e.base, sp.cos) and e.exp.is_Integer and e.exp > 1,
        lambda e: (1 - sp.sin(e.base.args[0]) ** 2) ** (e.exp // 2) * e.base ** (e.exp % 2),
    )


def _is_of_two(expr: sp.Expr) -> bool:
    return isinstance(expr, (sp.Max, sp.Min)) and len(expr.args) == 2


def _by_distance(expr: sp.Expr) -> sp.Expr:
    """Write the larger or smaller of two by their distance."""
    one, other = expr.args
    sign = 1 if isinstance(expr, sp.Max) else -1
    return (one + other + sign * sp.Abs(one - other)) / 2


@lru_cache(maxsize=4096)
def difference(left: sp.Expr, right: sp.Expr) -> sp.Expr:
    """Return left - right in a form that is literally 0 when it is identically zero.

    What is a fraction of symbols, roots and powers is decided in a ring of polynomials. Else the
    numerator over the common denominator is expanded, with every root an algebraic generator, and a
    number is decided by its minimal polynomial.
    """
    if left == right:
        return sp.S.Zero
    letters = {node: _letter_of(node) for node in (left - right).atoms(sp.Integral)}
    back = {letter: node for node, letter in letters.items()}
    return _difference(*(_masked(side, letters) for side in (left, right))).xreplace(back)


@lru_cache(maxsize=4096)
def _letter_of(integral: sp.Integral) -> sp.Dummy:
    """Return a letter for an integral, which no rule of algebra may split: its parts may diverge."""
    return sp.Dummy(real=True)


def _masked(expr: sp.Expr, letters: Mapping[sp.Expr, sp.Dummy]) -> sp.Expr:
    return expr.xreplace(letters) if letters else expr


def _difference(left: sp.Expr, right: sp.Expr) -> sp.Expr:
    whole = left - right
    if vanishes(whole) or vanishes(whole := normalise(whole)):
        return sp.S.Zero
    numerator, denominator = sp.fraction(sp.together(whole))
    rest = expanded(normalise(numerator))
    if rest != 0 and not rest.free_symbols and rest.is_algebraic:
        variable = sp.Dummy()
        rest = rest if sp.minimal_polynomial(rest, variable) != variable else sp.S.Zero
    if vanishes(rest):
        return sp.S.Zero
    if rest.has(sp.sin, sp.cos) and vanishes(_in_sines(rest)):
        return sp.S.Zero
    rest = (rest / denominator).doit(integrals=False, sums=False)
    return sp.S.Zero if vanishes(rest) else rest


def parted(integral: sp.Integral, known: Conditions) -> sp.Expr:
    """Write constants before an integral; split it where each part exists: continuous, between finite ends.

    >>> from kvtheory.derivations.engine.conditions import NONE
    >>> x, f = sp.Symbol("x", real=True), sp.Function("f", real=True)
    >>> parted(sp.Integral(2 + 3 * f(x), (x, 0, 1)), NONE)
    3*Integral(f(x), (x, 0, 1)) + 2
    """
    variable, *ends = integral.limits[0]
    if len(integral.limits) != 1 or len(ends) != 2:
        return integral
    low, high = ends
    terms = sp.Add.make_args(expanded(integral.function))
    ordered = proves_nonnegative(high - low, known)
    over = (variable, low, high) if ordered else (variable, -sp.oo, sp.oo)
    finite = low.is_finite and high.is_finite
    exist = finite and all(is_continuous(term, over, known) for term in terms)
    terms = terms if exist else (sp.factor(integral.function),)
    total = sp.S.Zero
    for term in terms:
        factor, rest = term.as_independent(variable, as_Add=False)
        base, power = (variable, sp.S.Zero) if rest == 1 else rest.as_base_exp()
        if exist and base == variable and power.is_Integer and power >= 0:
            total += factor * (high ** (power + 1) - low ** (power + 1)) / (power + 1)
        else:
            total += factor * sp.Integral(rest, integral.limits[0])
    return total


def roots_between(expr: sp.Expr, over: Interval) -> tuple[int, int]:
    """Count the zeros of a rational expression inside the open interval: all, and those of odd order.

    By Sturm's theorem.
    """
    variable, low, high = over[0], *map(_number, over[1:])
    numerator = sp.fraction(_reduced(expr))[0]
    _, parts = _univariate(numerator, variable).sqf_list()
    counts = [(_count(part, low, high), power) for part, power in parts]
    return sum(n for n, _ in counts), sum(n for n, power in counts if power % 2)


def _number(end: sp.Expr | int) -> sp.Expr:
    """Return the end of an interval, which must be a rational number or infinite."""
    end = sp.sympify(end)
    if end in (sp.oo, -sp.oo) or end.is_Rational:
        return end
    raise UndecidedError(f"the end {end} of the interval is no rational number")


def _count(factor: sp.Poly, low: sp.Expr, high: sp.Expr) -> int:
    """Count the roots of a square-free polynomial between two numbers, the ends excluded."""
    for end in (low, high):
        if end.is_finite and factor.eval(end) == 0:
            factor = factor.quo(sp.Poly(factor.gen - end, factor.gen))
    below, above = (end if end.is_finite else None for end in (low, high))
    return int(factor.count_roots(below, above)) if factor.degree() > 0 else 0


def sign_between(expr: sp.Expr, over: Interval) -> str:
    """Return the sign of a rational expression inside the interval: ``+``, ``-``, ``+0``, ``-0``.

    A trailing 0 says that it also vanishes somewhere inside. Factors that do not contain the
    variable must have a known sign.
    """
    variable, inside = over[0], _inside(*map(_number, over[1:]))
    sign, touches = 1, ""
    for factor in factors(normalise(expr)):
        base, power = (
            factor.as_base_exp() if factor.is_Pow and factor.exp.is_Integer else (factor, 1)
        )
        known = sign_of_terms(base)
        if known:
            sign *= known ** int(abs(power))
        elif variable not in base.free_symbols:
            raise UndecidedError(f"the sign of {base} is not known")
        elif roots_between(base, over)[0]:
            if power < 0 or power % 2:
                raise UndecidedError(f"{base} vanishes inside the interval")
            touches = "0"
        else:
            sign *= int(sp.sign(base.subs(variable, inside))) ** int(abs(power))
    return ("+" if sign > 0 else "-") + touches


def _univariate(expr: sp.Expr, variable: sp.Symbol) -> sp.Poly:
    poly = sp.Poly(expr, variable) if expr.is_polynomial(variable) else None
    if poly is None or not (poly.domain.is_ZZ or poly.domain.is_QQ):
        raise UndecidedError(f"{expr} is not a polynomial in {variable} with rational coefficients")
    return poly


def _inside(low: sp.Expr, high: sp.Expr) -> sp.Expr:
    """Return an exact point of the open interval."""
    if low.is_finite and high.is_finite:
        return (low + high) / 2
    if low.is_finite:
        return low + 1
    return high - 1 if high.is_finite else sp.S.Zero


def sides(variable: sp.Symbol, point: sp.Expr | int, known: Conditions) -> list[int]:
    """Return from which sides the variable can tend to the point: +1 from above, -1 from below.

    A side counts unless a condition, or what is assumed of the variable, excludes it. Where one of
    them decides neither, or no side is left, nothing can be said of the limit.
    """
    if not variable.is_extended_real or (variable.is_integer and point != sp.oo):
        raise UndecidedError(f"{variable} does not run through real values")
    sign = variable if variable.is_nonnegative else -variable if variable.is_nonpositive else None
    ends = [
        (variable - low, high - variable) for name, low, high in known.intervals if name == variable
    ]
    demanded = [gap for pair in ends for gap in pair if not gap.has(sp.oo, -sp.oo)]
    demanded += [gap for gap in (sign, *known.positive) if gap is not None and gap.has(variable)]
    h, open_ones = DISTANCE, []
    for side in (-1,) if point == sp.oo else (1, -1) if point == 0 else (-1, 1):
        place = 1 / h if point == sp.oo else point + side * h
        local = (_reduced(gap.subs(variable, place)) for gap in demanded)
        found = [_leading(_without_faded(each, h)[1], h)[0] for each in local]
        if all(proves_positive(each, known) for each in found):
            open_ones.append(side)
        elif not any(proves_positive(-each, known) for each in found):
            raise UndecidedError(
                f"{variable} is not known to reach {point} where {demanded} are positive"
            )
    if not open_ones:
        raise UndecidedError(f"{variable} cannot tend to {point} under the conditions")
    return open_ones


def leading_term(
    expr: sp.Expr, variable: sp.Symbol, point: sp.Expr | int, side: int = -1
) -> tuple[sp.Expr, sp.Expr]:
    """Return (c, k) with expr = c h**k + higher order, h > 0 the distance from the point.

    h is ``1/variable`` at infinity.
    """
    h = DISTANCE
    return _leading(near(expr, variable, point, h, side), h)


def _leading(local: sp.Expr, h: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
    """Return (c, k) with local = c h**k + higher order."""
    if local == 0:
        raise UndecidedError("the expression is identically zero, it has no leading term")
    local = local.replace(sp.atan, lambda u: _arc(u, h))
    found = _lowest_powers(local, h) or leading_of_series(local, h)
    if found is None:
        raise UndecidedError(f"{local} has no known series in whole powers of {h}")
    return found


def _arc(tangent: sp.Expr, h: sp.Symbol) -> sp.Expr:
    """Write the arc of a positive tangent by that of its inverse, if it grows as h -> 0."""
    found = _lowest_powers(tangent, h) if sign_of_terms(tangent) == 1 else None
    if found and found[1].is_negative:
        return sp.pi / 2 - sp.atan(1 / tangent)
    return sp.atan(tangent)


def _lowest_powers(local: sp.Expr, h: sp.Symbol) -> tuple[sp.Expr, sp.Expr] | None:
    """Read the leading term of a rational function off; None for any other expression."""
    if not is_rational(local):
        return None
    (top, one), (bottom, other) = (_lowest(part, h) for part in sp.fraction(local))
    return reduced(top / bottom), one - other


def _lowest(part: sp.Expr, h: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
    """Return the coefficient of the lowest power, and the power."""
    if not (
        is_rational(part) and part.is_polynomial()
    ):  # coefficients that are fractions may vanish without being literally 0
        polynomial = sp.Poly(part, h)
        (power,) = min(polynomial.monoms())
        return polynomial.coeff_monomial(h**power), sp.Integer(power)
    found = coefficients(part, h)
    least = min(found)
    return found[least], least


def near(
    expr: sp.Expr, variable: sp.Symbol, point: sp.Expr | int, h: sp.Symbol, side: int
) -> sp.Expr:
    """Write the expression in the distance h > 0 from the point, on one side of it."""
    power, shown = _faded(expr, variable, point, h, side)
    if power:
        raise UndecidedError(f"{expr} is smaller or larger than any power of {h}")
    return shown


def _faded(
    expr: sp.Expr, variable: sp.Symbol, point: sp.Expr | int, h: sp.Symbol, side: int
) -> tuple[int, sp.Expr]:
    """Return n, f with expr = T**n f near the point, as `_without_faded` does."""
    if not sp.sympify(point).is_finite and point != sp.oo:
        raise UndecidedError(f"series are taken at a finite point or at infinity, not at {point}")
    place = 1 / h if point == sp.oo else point + side * h
    local = _reduced(_in_exponentials(put(expr, {variable: place}), h))
    return _without_faded(local, h) if local.has(sp.exp) else (0, local)


def _in_exponentials(expr: sp.Expr, h: sp.Symbol) -> sp.Expr:
    """Write hyperbolic functions that may grow or fade by exponentials."""
    for kind in (sp.sinh, sp.cosh):
        expr = expr.replace(kind, lambda u, f=kind: _WRITTEN[f](u) if u.has(h) else f(u))
    return expr


def _refuse_growth(expr: sp.Expr, h: sp.Symbol) -> None:
    """Refuse what may grow beside an exponential that fades, or have poles without end."""
    for node in sp.preorder_traversal(expr):
        if not node.has(h) or node.is_Add or node.is_Mul or node == h:
            continue
        slow = isinstance(node, (sp.log, sp.atan, sp.asinh, sp.Abs, sp.Max, sp.Min))
        slow = slow or (node.is_Pow and not node.exp.has(h))
        bounded = (
            isinstance(node, (sp.exp, sp.sin, sp.cos))
            and not _leading(node.args[0], h)[1].is_negative
        )
        if not (slow or bounded):
            raise UndecidedError(f"{node} may grow as fast as {expr} fades")


def _without_faded(local: sp.Expr, h: sp.Symbol) -> tuple[int, sp.Expr]:
    """Return n, f with local = T**n (f + what is smaller than any power of h), T = exp(-c/h**k).

    All exponentials with an exponent without bound must be whole powers of one, T, and nothing else may
    grow faster than a power. A quotient of
    polynomials in T has the series of the quotient of their lowest coefficients.
    """
    exponents = {node.exp: _leading(sp.cancel(node.exp), h) for node in local.atoms(sp.exp)}
    fading = {each: c for each, (c, k) in exponents.items() if each.has(h) and k.is_negative}
    if not fading:
        return 0, local
    least = min(fading, key=lambda each: (sp.count_ops(each), str(each)))  # the same in every run
    faded = sp.Dummy("faded")
    if not (fading[least].is_negative or fading[least].is_positive):
        raise UndecidedError(f"{sp.exp(least)} has no known limit")
    least = least if fading[least].is_negative else -least
    powers = {each: sp.cancel(each / least) for each in fading}
    if not all(power.is_Rational for power in powers.values()):
        raise UndecidedError(f"{local} has exponentials that are no powers of one another")
    order = sp.ilcm(1, 1, *(power.q for power in powers.values()))
    shown = sp.together(
        local.xreplace({sp.exp(each): faded ** (order * powers[each]) for each in fading})
    )
    _refuse_growth(shown, h)
    (top, one), (bottom, other) = (_lowest(part, faded) for part in sp.fraction(shown))
    return int(one - other), sp.cancel(top / bottom)


def _reduced(expr: sp.Expr) -> sp.Expr:
    """Write as one fraction without a common factor."""
    return reduced(expr if is_rational(expr) else normalise(expr))


def next_order(
    ratio: sp.Expr, eps: sp.Expr, variable: sp.Symbol, point: sp.Expr | int, known: Conditions
) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Return (c, k, r) with ratio = 1 + c eps**k + O(eps**r) as variable -> point, from all its sides.

    The small quantity must vanish there, and be positive on one side; on the other a whole k makes
    up for its sign. The ratio must have a series in whole powers of the distance: then the power after
    the last one that is written bounds the rest.
    """
    approached = sides(variable, point, known)
    found = [_next_on(ratio, eps, variable, point, side) for side in approached]
    c, k, rest, _ = found[0]
    if not any(positive for *_, positive in found):
        raise UndecidedError(f"{eps} is not a small positive quantity")
    for other in found[1:]:
        if difference(c, other[0]) != 0 or other[1] != k or not (k.is_Integer or other[3]):
            raise UndecidedError(f"{ratio} has another series on the other side of {point}")
    return c, k, rest


def first_coefficients(
    ratio: sp.Expr, variable: sp.Symbol, point: sp.Expr | int, known: Conditions
) -> list[sp.Expr]:
    """Return the coefficients with which anything begins below a line or a root, if they may vanish.

    Where one does, it begins with another power, and what was left out is larger.
    """
    nonzero, nonnegative = demands(ratio)
    found = [
        _leading(near(base, variable, point, DISTANCE, side), DISTANCE)[0]
        for side in sides(variable, point, known)
        for base in sorted(nonzero | nonnegative, key=str)
        if base.has(variable) and base != variable
    ]
    return [each for each in found if not proves_nonzero(each, known)]


def _next_on(
    ratio: sp.Expr, eps: sp.Expr, variable: sp.Symbol, point: sp.Expr | int, side: int
) -> tuple[sp.Expr, sp.Expr, sp.Expr, bool]:
    """Return (c, k, r) on one side of the point, and whether eps is positive there."""
    h = DISTANCE
    local = near(ratio, variable, point, h, side)
    first, zero = _leading(local, h)
    if difference(first * h**zero, sp.S.One) != 0:
        raise UndecidedError(f"left/right does not tend to 1 but behaves as {first * h**zero}")
    top, bottom = sp.fraction(local)
    rest = expanded(top - bottom) / bottom if is_rational(local) else _reduced(local - 1)
    next_c, next_k = _leading(rest, h)
    eps_c, eps_k = leading_term(eps, variable, point, side)
    if not (eps_c.is_nonzero and eps_c.is_real and eps_k.is_positive):
        raise UndecidedError(f"{eps} is not a small positive quantity")
    k = next_k / eps_k
    c = without_root(next_c / eps_c**k)
    return c, k, (next_k + 1) / eps_k, bool(eps_c.is_positive)


def antiderivative(expr: sp.Expr, variable: sp.Symbol) -> sp.Expr:
    """Integrate powers, and polynomials times exponentials, by their rules.

    >>> x, k = sp.symbols("x k", positive=True)
    >>> antiderivative(x**2 + x * sp.exp(-k * x), x)
    x**3/3 - x*exp(-k*x)/k - exp(-k*x)/k**2
    """
    total = sp.S.Zero
    for term in sp.Add.make_args(expanded(expr)):
        factor, rest = term.as_independent(variable, as_Add=False)
        powers = rest.as_powers_dict()
        power, exponent = powers.pop(variable, sp.S.Zero), powers.pop(sp.E, sp.S.Zero)
        rate = derivative(exponent, variable)
        whole = power.is_Integer and power >= 0
        if (
            set(powers) - {sp.S.One}
            or rate.has(variable)
            or power == -1
            or not (rate == 0 or whole)
        ):
            raise UndecidedError(f"no rule for the integral of {rest} over {variable}")
        if rate == 0:
            total += factor * variable ** (power + 1) / (power + 1)
        else:
            parts = (
                (-1) ** k * sp.ff(power, k) * variable ** (power - k) / rate ** (k + 1)
                for k in range(int(power) + 1)
            )
            total += factor * sum(parts) * sp.exp(exponent)
    return expanded(total)


def value_at(expr: sp.Expr, variable: sp.Symbol, end: sp.Expr) -> sp.Expr:
    """Return the value at the end of an interval, which may be infinite."""
    if end.is_finite:
        return put(expr, {variable: end})
    if end == -sp.oo:
        expr = put(expr, {variable: -variable})
    return limit(expr, variable, sp.oo)


def limit(expr: sp.Expr, variable: sp.Symbol, point: sp.Expr | int) -> sp.Expr:
    """Return the finite limit at infinity, or at a point from above."""
    power, local = _faded(expr, variable, point, DISTANCE, 1)
    if power > 0 or local == 0:
        return sp.S.Zero
    coefficient, exponent = _leading(local, DISTANCE)
    if power < 0 or exponent.is_negative:
        raise UndecidedError(f"{expr} has no finite limit")
    return coefficient if exponent == 0 else sp.S.Zero


def is_continuous(
    expr: sp.Expr, over: Interval, known: Conditions, *, smooth: bool = False
) -> bool:
    """Tell whether the expression is real, without a jump or a pole, from end to end of the interval.

    If `smooth`, all its derivatives are so too. An undefined function stands for any that is smooth.
    """
    variable = over[0]
    if variable not in expr.free_symbols or expr == variable:
        return True
    inside = known.with_interval(over)
    if expr.is_Pow:
        return _is_continuous_power(expr, over, known, smooth)
    if isinstance(expr, sp.asin) and not smooth:
        (argument,) = expr.args
        real = _throughout(proves_nonnegative, 1 - argument**2, over, inside)
        return real and is_continuous(argument, over, known)
    if isinstance(expr, sp.Derivative) and isinstance(expr.expr, AppliedUndef):
        expr = expr.expr
    allowed = expr.is_Add or expr.is_Mul
    allowed = allowed or isinstance(expr, (*SMOOTH, *(() if smooth else _CONTINUOUS), AppliedUndef))
    return bool(
        allowed and all(is_continuous(arg, over, known, smooth=smooth) for arg in expr.args)
    )


def _is_continuous_power(expr: sp.Pow, over: Interval, known: Conditions, smooth: bool) -> bool:
    base, exponent = expr.as_base_exp()
    inside = known.with_interval(over)
    if base == sp.E or (exponent.has(over[0]) and _throughout(proves_positive, base, over, inside)):
        parts = (exponent,) if base == sp.E else (base, exponent)
        return all(is_continuous(part, over, known, smooth=smooth) for part in parts)
    if exponent.has(over[0]) or not is_continuous(base, over, known, smooth=smooth):
        return False
    if exponent.is_integer:
        return bool(exponent.is_nonnegative or _throughout(proves_nonzero, base, over, inside))
    real = _throughout(proves_positive, base, over, inside)
    return bool(
        real
        or (
            not smooth
            and exponent.is_positive
            and _throughout(proves_nonnegative, base, over, inside)
        )
    )


def is_differentiable(derivative: sp.Derivative, known: Conditions) -> bool:
    """Tell whether a derivative exists and is the one that the rules of differentiation give.

    It is, of what is made of smooth functions, wherever the result is defined. Under an integral the
    integrand and its derivative must be continuous in both variables, and the ends finite. Nothing may have
    a kink.
    """
    inner, variables = derivative.expr, set(derivative.variables)
    for node in inner.atoms(sp.Integral, sp.Sum, sp.Product):
        if not node.free_symbols & variables:
            continue
        infinite = any(end.is_infinite for limit in node.limits for end in limit[1:])
        if infinite or not all(_under_integral(node, variable, known) for variable in variables):
            return False
    return not any(node.has(*variables) for node in inner.atoms(*KINKS))


def _under_integral(node: sp.Expr, variable: sp.Symbol, known: Conditions) -> bool:
    if isinstance(node, sp.Sum | sp.Product) or not node.has(variable):
        return True
    (bound, *ends), *others = node.limits
    if others or len(ends) != 2:
        return not node.function.has(variable)
    inside = known.with_interval((bound, *ends))
    return all(
        is_continuous(each, (bound, *ends), known)
        and is_continuous(each, (variable, -sp.oo, sp.oo), inside)
        for each in (node.function, node.function.diff(variable).doit())
    )


def _throughout(
    proves: Callable[..., bool], expr: sp.Expr, over: Interval, known: Conditions
) -> bool:
    """Tell whether something is proved of an expression in an interval with its ends."""
    ends = [end for end in map(sp.sympify, over[1:]) if end.is_finite]
    return proves(expr, known) and all(proves(expr.subs(over[0], end), known) for end in ends)
