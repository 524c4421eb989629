r"""The engine: a proof is a list of steps, and each step is checked when it is made.

>>> from derivations.symbols import V, l_r, tau
>>> proof = Proof("eq29", 29, section="Steady sliding", title="Retardation length")
>>> proof.define(l_r, V * tau, "how far an element travels while it relaxes")
>>> proof.done(l_r, V * tau).latex
'l_{\\mathrm{r}} = V \\tau'
>>> proof.equal(l_r / tau, 2 * V, "wrong")
Traceback (most recent call last):
...
derivations.book.StepError: eq29: l_r/tau = 2*V is not an identity: left - right = -V
"""

from collections.abc import Iterable
from typing import Unpack

import sympy as sp

from derivations.algebra import (
    Interval,
    UndecidedError,
    is_continuous,
    next_order,
    roots_between,
    sign_between,
    value_at,
)
from derivations.book import Book, Shown, StepError, asked, tex
from derivations.sampling import disagreement

_SIGNS = {">": {"+"}, ">=": {"+", "+0"}, "<": {"-"}, "<=": {"-", "-0"}}
_RELATIONS = {">": ">", ">=": r"\ge", "<": "<", "<=": r"\le"}


class Proof(Book):
    """Collect checked steps and end in a `record.Derivation`.

    In every step `left` and `right` replace the LaTeX of a side where SymPy's own is clumsy; what is
    checked is the SymPy expression.
    """

    @asked
    def equal(self, lhs: sp.Expr, rhs: sp.Expr, reason: str, **shown: Unpack[Shown]) -> None:
        """Prove an identity."""
        self._vanish(self._resolve(lhs), self._resolve(rhs), f"{lhs} = {rhs}")
        self._record(lhs, "=", rhs, reason, "proved", shown)

    @asked
    def integral(
        self,
        lhs: sp.Expr,
        integrand: sp.Expr,
        over: Interval,
        antiderivative: sp.Expr,
        reason: str,
        *,
        value: sp.Expr | None = None,
        **shown: Unpack[Shown],
    ) -> sp.Expr:
        """Prove that `lhs`, the integral of `integrand`, has the value that is returned.

        The antiderivative is differentiated; it must be continuous, so that its end values count.
        `lhs` either was defined as this integral or is named by this step. `value` is the form in
        which the value is wanted; it is proved to be the difference of the end values.
        """
        whole = sp.Integral(integrand, over)
        variable, low, high = over[0], *(self._resolve(end) for end in over[1:])
        primitive, inner = self._resolve(antiderivative), self._resolve(integrand)
        if not is_continuous(primitive, variable):
            raise StepError(f"{self.label}: {primitive} may not be continuous in {variable}")
        self._vanish(sp.diff(primitive, variable), inner, f"d/d{variable} of {antiderivative}")
        found = sp.factor(value_at(primitive, variable, high) - value_at(primitive, variable, low))
        if lhs in self._rules:
            self._same_integral(self._rules.pop(lhs), whole)
        wanted = found if value is None else value
        self._vanish(self._resolve(wanted), found, f"{whole} = {wanted}")
        self._rule(lhs, wanted)
        shown.setdefault("right", tex(wanted) if lhs == whole else f"{tex(whole)} = {tex(wanted)}")
        self._record(lhs, "=", wanted, reason, "proved", shown)
        return wanted

    @asked
    def root(
        self,
        expr: sp.Expr,
        variable: sp.Symbol,
        value: sp.Expr,
        reason: str,
        **shown: Unpack[Shown],
    ) -> None:
        """Prove that the expression vanishes where the variable has this value."""
        at_value = self._resolve(expr).subs(variable, self._resolve(value))
        self._vanish(at_value, sp.S.Zero, f"root {variable} = {value} of {expr}")
        self._record(variable, "=", value, reason, "proved", shown)

    @asked
    def unique_root(
        self, expr: sp.Expr, over: Interval, reason: str, **shown: Unpack[Shown]
    ) -> None:
        """Prove by Sturm's theorem that the polynomial has exactly one root inside the interval."""
        try:
            count = roots_between(self._resolve(expr), over)
        except UndecidedError as error:
            raise StepError(f"{self.label}: roots of {expr}: {error}") from error
        if count != 1:
            raise StepError(f"{self.label}: {expr} has {count} roots inside {over}, not one")
        self._record(expr, "=", sp.S.Zero, reason, "proved", shown, exact=False)

    @asked
    def sign(
        self,
        expr: sp.Expr,
        relation: str,
        bound: sp.Expr | int,
        over: Interval,
        reason: str,
        **shown: Unpack[Shown],
    ) -> None:
        """Prove that a rational expression stays on one side of `bound` inside the interval."""
        claim = f"{expr} {relation} {bound} inside {over}"
        gap = self._resolve(expr - bound)
        try:
            found = sign_between(gap, over)
        except UndecidedError as error:
            raise StepError(f"{self.label}: {claim}: {error}; left - right = {gap}") from error
        if found not in _SIGNS[relation]:
            raise StepError(f"{self.label}: {claim} is wrong: left - right = {gap} is {found}")
        self._record(
            expr,
            _RELATIONS[relation],
            sp.sympify(bound),
            reason,
            "proved",
            shown,
            exact=False,
        )

    @asked
    def positive(self, expr: sp.Expr, reason: str, **shown: Unpack[Shown]) -> None:
        """Prove that an expression is positive because its symbols are: a sum of positive terms.

        The symbols stand for themselves here, so that powers with a symbol as exponent are decided.
        """
        if not sp.sympify(expr).is_positive:
            raise StepError(f"{self.label}: {expr} is not built of positive terms alone")
        self._record(expr, ">", sp.S.Zero, reason, "proved", shown, exact=False)

    @asked
    def equivalent(
        self, nonnegative: sp.Expr, lhs: sp.Expr, rhs: sp.Expr, reason: str, **shown: Unpack[Shown]
    ) -> None:
        """Prove that `nonnegative` >= 0 says the same as lhs >= rhs: their ratio is positive."""
        ratio = sp.cancel(self._resolve(nonnegative) / self._resolve(lhs - rhs))
        if not ratio.is_positive:
            raise StepError(
                f"{self.label}: {lhs} >= {rhs} is not the same as {nonnegative} >= 0: ratio {ratio}"
            )
        self._record(lhs, r"\ge", rhs, reason, "proved", shown, exact=False)

    @asked
    def leading_order(
        self,
        expr: sp.Expr,
        leading: sp.Expr,
        variable: sp.Symbol,
        point: sp.Expr | int,
        reason: str,
        *,
        eps: sp.Expr,
        **shown: Unpack[Shown],
    ) -> tuple[sp.Expr, sp.Expr]:
        """Prove expr = leading (1 + c eps**k + higher order) as variable -> point; return (c, k).

        The small quantity `eps` is any positive expression that vanishes there.
        """
        claim = f"{expr} ~ {leading} as {variable} -> {point}"
        ratio = self._resolve(expr) / self._resolve(leading)
        try:
            c, k, rest = next_order(ratio, self._resolve(eps), variable, point)
        except UndecidedError as error:
            raise StepError(f"{self.label}: {claim}: {error}") from error
        factor = shown.get("right") or (f"({tex(leading)})" if leading.is_Add else tex(leading))
        shown["right"] = f"{factor} {_series(c, eps, k, rest)}"
        self._record(expr, "=", leading, reason, "proved-leading-order", shown, exact=False)
        return c, k

    @asked
    def sampled(
        self,
        lhs: sp.Expr,
        rhs: sp.Expr,
        ranges: Iterable[Interval],
        reason: str,
        **shown: Unpack[Shown],
    ) -> None:
        """Compare both sides at many random points of the ranges with 50 digits."""
        found = disagreement(self._resolve(lhs), self._resolve(rhs), ranges)
        if found:
            raise StepError(f"{self.label}: {lhs} = {rhs} fails {found}")
        self._record(lhs, "=", rhs, reason, "sampled", shown)

    def _same_integral(self, defined: sp.Expr, evaluated: sp.Integral) -> None:
        """Prove that the integral by which a symbol was defined is the one that was evaluated."""
        if not isinstance(defined, sp.Integral) or defined.variables != evaluated.variables:
            raise StepError(f"{self.label}: {defined} is not the integral {evaluated}")
        pairs = zip(
            (defined.function, *defined.limits[0][1:]),
            (evaluated.function, *evaluated.limits[0][1:]),
            strict=True,
        )
        for one, other in pairs:
            self._vanish(self._resolve(one), self._resolve(other), f"{defined} = {evaluated}")


def _series(c: sp.Expr, eps: sp.Expr, k: sp.Expr, rest: sp.Expr) -> str:
    """Print 1 + c eps**k + O(eps**rest)."""
    term = (sp.factor(c) if c.free_symbols else c) * eps**k
    negative = term.could_extract_minus_sign()
    signed = f"- {tex(-term)}" if negative else f"+ {tex(term)}"
    return rf"\left(1 {signed} + O\left({tex(eps**rest)}\right)\right)"
