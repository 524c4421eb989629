"""Whether a value is the only root of an expression within the domain of the variable."""

from dataclasses import dataclass
from itertools import pairwise

import sympy as sp

from .algebra import UndecidedError, difference, normalise, roots_between
from .conditions import (
    Conditions,
    Interval,
    proves_nonnegative,
    proves_nonzero,
    proves_positive,
    proves_real,
)
from .forms import expanded


@dataclass(frozen=True)
class Domain:
    """The domain of a variable: two bounds, each with whether it belongs to the domain."""

    low: sp.Expr
    high: sp.Expr
    low_included: bool = False
    high_included: bool = False

    def holds(self, value: sp.Expr, known: Conditions) -> bool:
        """Tell whether the value is proved to lie inside."""
        above = _exceeds(value, self.low, self.low_included, known)
        return above and _exceeds(self.high, value, self.high_included, known)

    def excludes(self, value: sp.Expr, known: Conditions) -> bool:
        """Tell whether the value, if it is real at all, is proved to lie outside."""
        below = _exceeds(self.low, value, not self.low_included, known)
        return below or _exceeds(value, self.high, not self.high_included, known)


def _exceeds(one: sp.Expr, other: sp.Expr, or_equal: bool, known: Conditions) -> bool:
    if one == sp.oo or other == -sp.oo:
        return one != other
    if one == -sp.oo or other == sp.oo:
        return False
    proves = proves_nonnegative if or_equal else proves_positive
    return proves(one - other, known)


def domain_of(variable: sp.Expr, over: Interval | None) -> Domain:
    """Return the given interval, or what the assumptions on the variable allow."""
    if over is not None:
        return Domain(*map(sp.sympify, over[1:]))
    if variable.is_nonnegative:
        return Domain(sp.S.Zero, sp.oo, low_included=not variable.is_positive)
    if variable.is_nonpositive:
        return Domain(-sp.oo, sp.S.Zero, high_included=not variable.is_negative)
    return Domain(-sp.oo, sp.oo)


def only_root(
    expr: sp.Expr, variable: sp.Expr, value: sp.Expr, domain: Domain, known: Conditions
) -> None:
    """Prove that the expression vanishes for this value and for no other of the domain.

    Raises
    ------
    UndecidedError
        Where this is wrong or cannot be proved.
    """
    if not proves_real(value, known):
        raise UndecidedError(f"{value} is not known to be real")
    if not domain.holds(value, known):
        raise UndecidedError(f"{value} is not known to lie in the domain of {variable}")
    x = sp.Dummy("x", real=True)
    numerator, denominator = sp.fraction(sp.together(normalise(expr.subs(variable, x))))
    if not numerator.has(x):
        raise UndecidedError(f"{expr} does not determine {variable}")
    rest = difference(numerator.subs(x, value), sp.S.Zero)
    if rest != 0:
        raise UndecidedError(f"it is no root: left - right = {rest}")
    bottom = denominator.subs(x, value)
    if not proves_nonzero(bottom, known) and difference(bottom, sp.S.Zero) == 0:
        raise UndecidedError(f"{expr} is not defined there")
    numerator, x, value, domain = _without_roots(expanded(numerator), x, value, domain)
    if not numerator.is_polynomial(x):
        raise UndecidedError(f"{expr} is no polynomial in {variable}: other roots are not excluded")
    if not _alone(sp.Poly(numerator, x), x, value, domain, known):
        raise UndecidedError("other roots are not excluded")


def _without_roots(
    expr: sp.Expr, x: sp.Symbol, value: sp.Expr, domain: Domain
) -> tuple[sp.Expr, sp.Symbol, sp.Expr, Domain]:
    """Write fractional powers of a variable that is not negative in whole powers of another."""
    order = sp.ilcm(
        1, 1, *(p.exp.q for p in expr.atoms(sp.Pow) if p.base == x and p.exp.is_Rational)
    )
    if order == 1 or not domain.low.is_zero or domain.high != sp.oo:
        return expr, x, value, domain
    y = sp.Dummy("y", nonnegative=True, positive=None if domain.low_included else True)
    return sp.powdenest(expr.subs(x, y**order)), y, value ** sp.Rational(1, order), domain


def _alone(poly: sp.Poly, x: sp.Symbol, value: sp.Expr, domain: Domain, known: Conditions) -> bool:
    """Tell whether a polynomial is proved to have no second root in the domain."""
    if all(coefficient.is_Rational for coefficient in poly.all_coeffs()):
        return _alone_by_sturm(poly, x, domain)
    if poly.degree() == 2:
        lead, middle, _ = poly.all_coeffs()
        other = sp.cancel(-middle / lead) - value
        excluded = domain.excludes(other, known) or difference(other, value) == 0
        return excluded and proves_nonzero(lead, known)
    quotient = _quotient(poly, value)
    if quotient.degree() == 0:
        return proves_nonzero(quotient.as_expr(), known)
    half_line = domain.low.is_zero and domain.high == sp.oo
    half_line = half_line and (not domain.low_included or proves_nonzero(poly.eval(0), known))
    return bool(half_line and _one_change_of_sign(poly, known)) or all(
        _elsewhere(sp.Poly(factor, x), value, domain, known)
        for factor, _ in sp.factor_list(quotient.as_expr())[1]
        if factor.has(x)
    )


def _alone_by_sturm(poly: sp.Poly, x: sp.Symbol, domain: Domain) -> bool:
    """Count the roots of a polynomial with rational coefficients."""
    try:
        inside = roots_between(poly.as_expr(), (x, domain.low, domain.high))[0]
    except UndecidedError:
        return False
    ends = ((domain.low, domain.low_included), (domain.high, domain.high_included))
    return inside + sum(included and poly.eval(end) == 0 for end, included in ends) == 1


def _quotient(poly: sp.Poly, value: sp.Expr) -> sp.Poly:
    """Divide by variable - value, which is known to be a factor."""
    coefficients = [sp.S.Zero]
    for coefficient in poly.all_coeffs()[:-1]:
        coefficients.append(sp.factor(coefficient + value * coefficients[-1]))
    return sp.Poly(coefficients[1:], poly.gen)


def _elsewhere(factor: sp.Poly, value: sp.Expr, domain: Domain, known: Conditions) -> bool:
    """Tell whether the roots of a factor are outside the domain, or the known root again."""
    if factor.degree() > 1:
        return False
    slope, constant = factor.all_coeffs()
    if not proves_nonzero(slope, known):
        return False
    other = sp.radsimp(-constant / slope) if constant.has(sp.Pow) else sp.cancel(-constant / slope)
    return domain.excludes(other, known) or difference(other, value) == 0


def _one_change_of_sign(poly: sp.Poly, known: Conditions) -> bool:
    """Apply Descartes' rule: one change of sign in the coefficients is one positive root."""
    signs = []
    for coefficient in poly.coeffs():
        if proves_positive(coefficient, known):
            signs.append(1)
        elif proves_positive(-coefficient, known):
            signs.append(-1)
        else:
            return False
    return sum(one != other for one, other in pairwise(signs)) == 1
