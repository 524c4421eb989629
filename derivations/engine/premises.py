"""The premises of a result: definitions and laws, carried along, and whether they contradict each other."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp
from sympy.core.function import AppliedUndef

from .algebra import difference
from .conditions import NONE, Conditions
from .forms import sign_of_terms
from .points import signs
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
def contradiction(premises: tuple[Premise, ...]) -> str:
    """Describe laws of one function that differ; empty if there are none.

    That the others hold together is shown by a point at which they do: see `witness`.
    """
    by_function: dict[sp.Expr, list[Premise]] = {}
    for law in premises:
        call = law.lhs.expr if isinstance(law.lhs, sp.Derivative) else law.lhs
        if isinstance(call, AppliedUndef):
            by_function.setdefault(call.func, []).append(law)
    for group in by_function.values():
        slopes = [law for law in group if isinstance(law.lhs, sp.Derivative)]
        values = [law for law in group if law not in slopes]
        fixed = [law for law in values if not law.lhs.free_symbols]
        found = [
            (one, other)
            for one in values
            if is_general(one.lhs, one.rhs)
            for other in group
            if not _follows(one, other)
        ]
        found += [
            (one, other)
            for one in slopes
            for other in slopes
            if one.lhs.expr == other.lhs.expr and not _follows_slope(one, other)
        ]
        if slopes and len(fixed) > min(law.lhs.derivative_count for law in slopes):
            found.append((slopes[0], fixed[-1]))
        for one, other in found:
            return f"{one.lhs} = {one.rhs} and {other.lhs} = {other.rhs} are not known to agree"
    return ""


def is_general(call: sp.Expr, value: sp.Expr) -> bool:
    """Tell whether a function is given as an expression in its argument; else it is related at a place."""
    alone = all(arg.is_Symbol and value.has(arg) for arg in call.args)
    return alone and not value.atoms(AppliedUndef)


def _follows(law: Premise, other: Premise) -> bool:
    """Tell whether another premise about a function is what its law says; or is about a place."""
    value = sp.Lambda(law.lhs.args, law.rhs)
    place = other.lhs if other.lhs.func == law.lhs.func else None
    if place is not None and place.free_symbols and not is_general(other.lhs, other.rhs):
        return True
    sides = (side.replace(law.lhs.func, value).doit() for side in (other.lhs, other.rhs))
    return difference(*sides) == 0


def _follows_slope(one: Premise, other: Premise) -> bool:
    """Tell whether a higher derivative agrees with a lower one of the same function."""
    more = [variable for variable, count in other.lhs.variable_count for _ in range(count)]
    for variable, count in one.lhs.variable_count:
        for _ in range(count):
            if variable not in more:
                return True
            more.remove(variable)
    return not more or difference(sp.diff(one.rhs, *more).subs(one.lhs, one.rhs), other.rhs) == 0


_KINDS = {
    **{"positive": 1, "nonnegative": 1, "negative": -1},
    **{"nonzero": 0, "real": 0, "finite": 0},
    "integer": None,
}
"""What may be assumed on a symbol and asked of a value, with a sign that shows it possible; 0 for any."""


@lru_cache(maxsize=4096)
def violates(symbol: sp.Expr, value: sp.Expr) -> bool:
    """Tell whether a value is known to lie outside of what a symbol may be."""
    if value.has(sp.nan, sp.zoo):
        return True
    seen = signs(value) or {sign_of_terms(value)} - {0}
    return any(
        getattr(symbol, f"is_{kind}") and getattr(value, f"is_{kind}") is False
        for kind, sign in _KINDS.items()
        if sign not in seen and not (sign == 0 and seen)
    )


def fixed_value(variable: sp.Expr, premises: Iterable[Premise]) -> sp.Expr | None:
    """Return the number that premises give to a variable, None where they leave it free."""
    rules = {premise.lhs: premise.rhs for premise in premises if is_name(premise.lhs)}
    value = variable
    for _ in range(len(rules)):
        value = value.xreplace(rules)
    return value if value.is_number else None
