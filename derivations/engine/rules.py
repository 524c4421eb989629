"""Rules of rewriting: the definitions and recalled relations of a proof, substituted from left to right.

A rule reaches everything: under a derivative the inner expression is written out first, so that no
dependence on the variable is hidden behind a name.
"""

from collections.abc import Iterable, Mapping
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from .forms import Computed, carried_out

Rules = Mapping[sp.Expr, sp.Expr]
Dependences = Mapping[sp.Expr, frozenset[sp.Expr]]
"""What a name depends on by premises that are no rules here: its value must not be differentiated."""


class HiddenError(ValueError):
    """A derivative or an integral of what depends on the variable in a way that is not written out."""


def resolve(
    expr: sp.Expr | int, rules: Rules, hidden: Dependences
) -> tuple[sp.Expr, frozenset[sp.Expr], frozenset[sp.Derivative]]:
    """Replace until no left side is left, carry out the derivatives, and say which rules were used.

    The derivatives that were carried out are returned too: whether they exist is for the caller to say.

    Raises
    ------
    HiddenError
        For a derivative or an integral over a variable on which a name depends unseen.
    """
    return _resolved(sp.sympify(expr), tuple(rules.items()), tuple(hidden.items()))


@lru_cache(maxsize=4096)
def _resolved(
    expr: sp.Expr,
    rules: tuple[tuple[sp.Expr, sp.Expr], ...],
    hidden: tuple[tuple[sp.Expr, frozenset[sp.Expr]], ...],
) -> tuple[sp.Expr, frozenset[sp.Expr], frozenset[sp.Derivative]]:
    """Resolve once: a step asks for the same expression when it checks, records and displays it."""
    rewriter = _Rewriter(dict(rules), dict(hidden))
    before, after = None, expr
    while after != before:
        before, after = after, rewriter.rewrite(after)
        if after.has(sp.Derivative, sp.Subs, Computed):
            after = carried_out(after)
        elif all(lhs.is_Symbol for lhs, _ in rules):  # then nothing that was put in is a left side
            break
    return after, frozenset(rewriter.used), frozenset(rewriter.derived)


def is_name(lhs: sp.Expr) -> bool:
    """Tell whether a left side is a symbol, a function at a point, or a derivative of one."""
    return lhs.is_Symbol or isinstance(lhs, (AppliedUndef, sp.Derivative, sp.Indexed))


class _Rewriter:
    """One resolution: the rules, their results so far, and which of them were used."""

    def __init__(self, rules: Rules, hidden: Dependences) -> None:
        self.rules, self.hidden = rules, hidden
        self.used: set[sp.Expr] = set()
        self.derived: set[sp.Derivative] = set()
        self._compound = {lhs: rhs for lhs, rhs in rules.items() if not is_name(lhs)}
        self._done: dict[sp.Expr, sp.Expr] = {}

    def rewrite(self, expr: sp.Expr) -> sp.Expr:
        """Return the expression with every rule applied to it and to its parts."""
        found = self._done.get(expr)
        if found is None:
            found = self._done[expr] = self._rewrite(expr)
        return found

    def _rewrite(self, expr: sp.Expr) -> sp.Expr:
        if expr in self.rules:
            self.used.add(expr)
            return self.rewrite(self.rules[expr])
        if not expr.args:
            return expr
        if isinstance(expr, sp.Derivative):
            return self._derivative(expr)
        if isinstance(expr, (sp.Integral, sp.Sum)):
            return self._bound(expr)
        if isinstance(expr, sp.Subs):
            inner = self._without(expr.variables).rewrite(expr.expr)
            return sp.Subs(inner, expr.variables, [self.rewrite(place) for place in expr.point])
        parts = [self.rewrite(part) for part in expr.args]
        new = expr.func(*parts) if parts != list(expr.args) else expr
        for lhs, rhs in self._compound.items():
            replaced = new.subs(lhs, rhs) if new.free_symbols >= lhs.free_symbols else new
            if replaced != new:
                self.used.add(lhs)
                new = replaced
        return new

    def _derivative(self, expr: sp.Derivative) -> sp.Expr:
        """Write out the differentiated expression, then insert the values of the variables."""
        variables = [variable for variable, _ in expr.variable_count]
        fixed = [variable for variable in variables if variable in self.rules]
        inner = self._without(fixed).rewrite(expr.expr)
        self._refuse_hidden(inner, variables)
        self.derived.add(sp.Derivative(inner, *expr.variable_count))
        if not fixed:
            return sp.Derivative(inner, *expr.variable_count)
        for variable in fixed:
            self.used.add(variable)
        at = [(variable, self.rewrite(self.rules[variable])) for variable in fixed]
        return sp.Derivative(inner, *expr.variable_count).doit().subs(at)

    def _bound(self, expr: sp.Expr) -> sp.Expr:
        """Rewrite an integral or a sum, whose own variable no rule may touch."""
        inner = self._without(expr.variables)
        limits = [(limit[0], *map(self.rewrite, limit[1:])) for limit in expr.limits]
        integrand = inner.rewrite(expr.function)
        self._refuse_hidden(integrand, expr.variables)
        return expr.func(integrand, *limits)

    def _without(self, variables: Iterable[sp.Expr]) -> "_Rewriter":
        """Return a rewriter that leaves some variables alone and shares the record of use."""
        untouched = set(variables)
        kept = {lhs: rhs for lhs, rhs in self.rules.items() if lhs not in untouched}
        if len(kept) == len(self.rules):
            return self
        inner = _Rewriter(kept, self.hidden)
        inner.used, inner.derived = self.used, self.derived
        return inner

    def _refuse_hidden(self, expr: sp.Expr, variables: Iterable[sp.Expr]) -> None:
        for name in expr.atoms(sp.Symbol, AppliedUndef) & self.hidden.keys():
            for variable in variables:
                if name != variable and variable in self.hidden[name]:
                    raise HiddenError(f"{name} depends on {variable}, which {expr} does not show")
