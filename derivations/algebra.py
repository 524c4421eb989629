"""Decisions by exact algebra: is it zero, which sign has it, how does it approach a limit.

Nothing here is numerical. A function that cannot decide raises `UndecidedError`; it never guesses.
"""

import sympy as sp
from sympy.core.function import AppliedUndef

Interval = tuple[sp.Symbol, sp.Expr | int, sp.Expr | int]
"""A variable with its lower and upper bound, as SymPy writes it."""


class UndecidedError(ArithmeticError):
    """The algebra could neither prove nor refute what was asked."""


_CONTINUOUS = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.asin, sp.acos, sp.Abs)
"""Functions without jumps or poles where they are real."""


def normalise(expr: sp.Expr) -> sp.Expr:
    """Write tangents as quotients, minima by cases, and factor what stands under roots.

    Factoring lets ``sqrt((1 - q**2)**2/(4*q**2) + 1)`` become ``(q**2 + 1)/(2*q)`` where the
    assumptions on the symbols allow it.
    """
    expr = expr.replace(sp.tan, lambda angle: sp.sin(angle) / sp.cos(angle))
    expr = expr.replace(sp.Min, lambda *args: sp.Min(*args).rewrite(sp.Piecewise))
    return expr.replace(
        lambda e: e.is_Pow and e.exp.is_Rational and not e.exp.is_Integer,
        lambda e: sp.expand_power_base(sp.factor(sp.together(e.base)) ** e.exp),
    )


def difference(left: sp.Expr, right: sp.Expr) -> sp.Expr:
    """Return left - right in a form that is literally 0 when it is identically zero.

    The numerator over the common denominator is expanded, with every root an algebraic generator;
    a number is decided by its minimal polynomial, and only what is left goes to `sympy.simplify`.
    """
    numerator, denominator = sp.fraction(sp.together(normalise(left - right)))
    rest = sp.expand(normalise(numerator))
    if rest != 0 and not rest.free_symbols and rest.is_algebraic:
        variable = sp.Dummy()
        rest = rest if sp.minimal_polynomial(rest, variable) != variable else sp.S.Zero
    return rest if rest == 0 else sp.simplify(rest / denominator)


def roots_between(expr: sp.Expr, over: Interval) -> int:
    """Count the distinct real zeros of a rational expression inside the open interval, by Sturm."""
    variable, low, high = over[0], *map(sp.sympify, over[1:])
    square_free = _univariate(sp.fraction(sp.cancel(normalise(expr)))[0], variable).sqf_part()
    for end in (low, high):
        if end.is_finite and square_free.eval(end) == 0:
            square_free = square_free.quo(sp.Poly(variable - end, variable))
    below, above = (end if end.is_finite else None for end in (low, high))
    return int(square_free.count_roots(below, above))


def sign_between(expr: sp.Expr, over: Interval) -> str:
    """Return the sign of a rational expression inside the interval: ``+``, ``-``, ``+0``, ``-0``.

    A trailing 0 says that it also vanishes somewhere inside. Factors that do not contain the
    variable must have a known sign.
    """
    variable, inside = over[0], _inside(*map(sp.sympify, over[1:]))
    expr = normalise(expr)
    assumed = _within_assumptions(*map(sp.sympify, over))
    if assumed and _signed(expr):
        return "+" if expr.is_positive else "-"
    numerator, denominator = sp.fraction(sp.factor(sp.together(expr)))
    sign, touches = 1, ""
    for part in (numerator, denominator):
        constant, factors = sp.factor_list(part)
        for base, power in [(constant, 1), *factors]:
            if variable not in base.free_symbols or (assumed and _signed(base)):
                if not (base.is_positive or base.is_negative):
                    raise UndecidedError(f"the sign of {base} is not known")
                sign *= int(sp.sign(base)) ** power
            elif roots_between(base, over):
                if part is denominator or power % 2:
                    raise UndecidedError(f"{base} vanishes inside the interval")
                touches = "0"
            else:
                sign *= int(sp.sign(base.subs(variable, inside))) ** power
    return ("+" if sign > 0 else "-") + touches


def _signed(expr: sp.Expr) -> bool:
    """Tell whether the assumptions on the symbols alone give the expression a sign."""
    return bool(expr.is_positive or expr.is_negative)


def _within_assumptions(variable: sp.Symbol, low: sp.Expr, high: sp.Expr) -> bool:
    """Tell whether the variable has the sign that is assumed of it all over the interval."""
    above = low >= 0 if variable.is_nonnegative else True
    return bool(above and (high <= 0 if variable.is_nonpositive else True))


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


def leading_term(
    expr: sp.Expr, variable: sp.Symbol, point: sp.Expr | int
) -> tuple[sp.Expr, sp.Expr, sp.Symbol]:
    """Return (c, k, h) with expr = c h**k + higher order, h > 0 the distance from the point.

    h is ``variable`` at 0, ``1/variable`` at infinity and ``point - variable`` elsewhere.
    """
    h = sp.Symbol("h", positive=True)
    near = {sp.S.Zero: h, sp.oo: 1 / h}.get(sp.sympify(point), point - h)
    local = sp.together(normalise(sp.together(expr.subs(variable, near))))
    if local == 0:
        raise UndecidedError("the expression is identically zero, it has no leading term")
    coefficient, exponent = sp.cancel(local).leadterm(h)
    return sp.radsimp(coefficient), exponent, h


def next_order(
    ratio: sp.Expr, eps: sp.Expr, variable: sp.Symbol, point: sp.Expr | int
) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Return (c, k, r) with ratio = 1 + c eps**k + O(eps**r) as variable -> point.

    The small quantity must be positive near the point and vanish there.
    """
    exact = sp.cancel(normalise(sp.together(ratio)))
    first, zero, h = leading_term(exact, variable, point)
    if difference(first * h**zero, sp.S.One) != 0:
        raise UndecidedError(f"left/right does not tend to 1 but behaves as {first * h**zero}")
    next_c, next_k, _ = leading_term(exact - 1, variable, point)
    eps_c, eps_k, _ = leading_term(eps, variable, point)
    if not (eps_c.is_positive and eps_k.is_positive):
        raise UndecidedError(f"{eps} is not a small positive quantity")
    k = next_k / eps_k
    c = sp.radsimp(next_c / eps_c**k)
    if h in c.free_symbols:
        raise UndecidedError(f"no power of {eps} follows, but {c}")
    return c, k, (next_k + 1) / eps_k


def value_at(expr: sp.Expr, variable: sp.Symbol, end: sp.Expr) -> sp.Expr:
    """Return the value at the end of an interval, which may be infinite."""
    return expr.subs(variable, end) if end.is_finite else sp.limit(expr, variable, end)


def is_continuous(expr: sp.Expr, variable: sp.Symbol) -> bool:
    """Tell whether the expression is built so that it has no jump or pole in the variable.

    An undefined function stands for any continuous one.
    """
    if variable not in expr.free_symbols or expr == variable:
        return True
    if expr.is_Pow:
        base, exponent = expr.as_base_exp()
        harmless = exponent.is_positive or base.is_positive
        fixed = variable not in exponent.free_symbols
        return bool(harmless and is_continuous(base, variable) and fixed)
    if isinstance(expr, sp.log):
        return bool(expr.args[0].is_positive and is_continuous(expr.args[0], variable))
    allowed = expr.is_Add or expr.is_Mul or isinstance(expr, (*_CONTINUOUS, AppliedUndef))
    return bool(allowed and all(is_continuous(arg, variable) for arg in expr.args))
