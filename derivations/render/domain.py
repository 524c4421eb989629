"""Where a result holds: the signs of its symbols, and the intervals over which it was checked."""

from collections.abc import Iterator

import sympy as sp

from ..book import tex
from ..record import Claim, Derivation

_SIGNS = (("is_positive", "> 0"), ("is_nonnegative", r"\ge 0"), ("is_negative", "< 0"))


def domain(derivation: Derivation) -> str:
    """Return a sentence, or nothing if a result has no conditions.

    A symbol without a sign is a real number.
    """
    claims = [step.claim for step in derivation.steps if step.claim]
    ranges = [_interval(*over) for claim in claims for over in _intervals(claim)]
    ranged = {over[0] for claim in claims for over in _intervals(claim)}
    symbols = {symbol for claim in claims for symbol in _symbols(claim)} - ranged
    signs = []
    for sign, relation in _SIGNS:
        having = sorted((s for s in symbols if getattr(s, sign)), key=str)
        symbols -= set(having)
        if having:
            signs.append(f"${', '.join(map(tex, having))} {relation}$")
    holds = [*signs, *dict.fromkeys(ranges)]
    return f"It holds for {' and '.join(holds)}." if holds else ""


def _symbols(claim: Claim) -> set[sp.Symbol]:
    found = claim.lhs.free_symbols | claim.rhs.free_symbols
    return {symbol for symbol in found if isinstance(symbol, sp.Symbol)}


def _intervals(claim: Claim) -> Iterator[tuple[sp.Symbol, sp.Expr, sp.Expr]]:
    """Yield the intervals inside which a sign, a root or samples were checked."""
    if claim.check in {"sign", "unique_root"}:
        yield claim.arguments["over"]
    if claim.check == "sampled":
        yield from claim.arguments["ranges"]


def _interval(variable: sp.Symbol, low: sp.Expr, high: sp.Expr) -> str:
    low, high = sp.sympify(low), sp.sympify(high)
    if high.is_infinite:
        return f"${tex(variable)} > {tex(low)}$" if low.is_finite else f"real ${tex(variable)}$"
    return f"${tex(low)} < {tex(variable)} < {tex(high)}$"
