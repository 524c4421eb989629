"""The premises of a result: definitions and laws, carried along, and whether they contradict each other."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from .conditions import NONE, Conditions
from .record import STATUSES, Step
from .rules import is_name


@dataclass(frozen=True)
class Premise:
    """An equality that was not proved but assumed, by a definition or as the condition of a root."""

    lhs: sp.Expr
    rhs: sp.Expr
    latex: str = ""

    def __eq__(self, other: object) -> bool:
        """Compare the content, not the printed form."""
        return isinstance(other, Premise) and (self.lhs, self.rhs) == (other.lhs, other.rhs)

    def __hash__(self) -> int:
        return hash((self.lhs, self.rhs))


@dataclass(frozen=True)
class Fact:
    """An established relation with all its premises."""

    step: Step
    premises: tuple[Premise, ...] = ()
    conditions: Conditions = NONE
    domain: tuple[str, ...] = ()
    """The conditions in print."""


def weakest(statuses: Iterable[str]) -> str:
    """Return the least of some statuses."""
    return max(statuses, key=STATUSES.index)


def merged(groups: Iterable[Iterable[Premise]]) -> tuple[Premise, ...]:
    """Return all premises once, in the order in which they first come."""
    return tuple(dict.fromkeys(premise for group in groups for premise in group))


@lru_cache(maxsize=4096)
def contradiction(premises: tuple[Premise, ...], new: tuple[Premise, ...]) -> str:
    """Describe a premise that cannot hold together with new ones; empty if none is found.

    Each premise is checked with the others substituted. Laws that are not mere names are solved
    together as polynomials.
    """
    for premise in premises:
        said = premise.lhs.free_symbols | premise.rhs.free_symbols
        if premise not in new and not any(
            each.lhs in said or each.lhs == premise.lhs for each in new
        ):
            continue
        if not _touches(premise, premises):
            continue
        others: dict[sp.Expr, sp.Expr] = {}
        for other in premises:
            if other != premise and is_name(other.lhs):
                others.setdefault(other.lhs, other.rhs)
        rest = premise.lhs - premise.rhs
        for _ in range(_DEPTH):
            if never_zero(rest):
                return f"{premise.lhs} = {premise.rhs} contradicts what else is given"
            bound = (node.variables for node in rest.atoms(sp.Integral, sp.Sum, sp.Derivative))
            if others.keys() & {variable for each in bound for variable in each}:
                break
            rest, before = rest.xreplace(others), rest
            if rest == before or rest.count_ops() > _TOO_LONG:
                break
    return _as_polynomials([each for each in premises if not is_name(each.lhs)])


_DEPTH, _TOO_LONG = 3, 40
"""How often premises are put into each other, and the operations beyond which this is given up:
definitions that name each other in turn make expressions grow."""


def _touches(premise: Premise, premises: Iterable[Premise]) -> bool:
    """Tell whether a premise says more than the definition of a new name."""
    return not premise.lhs.is_Symbol or any(
        other != premise and (premise.lhs in other.lhs.free_symbols | other.rhs.free_symbols)
        for other in premises
    )


@lru_cache(maxsize=8192)
def never_zero(expr: sp.Expr) -> bool:
    """Tell whether the assumptions on the symbols exclude that the expression vanishes."""
    if expr.is_zero is False:
        return True
    if expr.has(sp.Derivative, sp.Integral, sp.Sum) or expr.count_ops() > _TOO_LONG:
        return False
    numerator = sp.expand(sp.fraction(sp.together(expr))[0])
    return numerator.is_zero is False


def _as_polynomials(laws: list[Premise]) -> str:
    """Solve laws together, where each is a polynomial, for a contradiction."""
    sides = [sp.fraction(sp.together(law.lhs - law.rhs))[0] for law in laws]
    if len(sides) < 2 or any(not side.is_polynomial() for side in sides):
        return ""
    symbols = sorted(set().union(*(side.free_symbols for side in sides)), key=str)
    if len(set.intersection(*(side.free_symbols for side in sides))) == 0:
        return ""
    for element in sp.groebner(sides, *symbols).exprs:
        if never_zero(element):
            return f"{', '.join(f'{law.lhs} = {law.rhs}' for law in laws)} have no common solution"
    return ""


_KINDS = ("positive", "negative", "nonnegative", "nonzero", "real", "integer", "finite")
"""What may be assumed on a symbol and asked of a value."""


@lru_cache(maxsize=4096)
def violates(symbol: sp.Expr, value: sp.Expr) -> bool:
    """Tell whether a value is known to lie outside of what a symbol may be."""
    if value.has(sp.nan, sp.zoo):
        return True
    if any(
        getattr(symbol, f"is_{kind}") and getattr(value, f"is_{kind}") is False for kind in _KINDS
    ):
        return True
    if value.is_number and symbol.is_real and value.is_real is None:
        return abs(sp.im(value).evalf(20)) > sp.Float("1e-15")
    return False


def fixed_value(variable: sp.Expr, premises: Iterable[Premise]) -> sp.Expr | None:
    """Return the number that premises give to a variable, None where they leave it free."""
    rules = {premise.lhs: premise.rhs for premise in premises if is_name(premise.lhs)}
    value = variable
    for _ in range(len(rules)):
        value = value.xreplace(rules)
    return value if value.is_number else None
