"""Where a result holds: the conditions under which it was proved, and signs that no row of a table states."""

import sympy as sp

from ..engine.atoms import atoms
from ..engine.book import tex
from ..engine.letters import letters, printed
from ..engine.nomenclature import BY_LATEX, sign_of
from ..engine.record import Claim, Derivation

_RELATIONS = {"": "> 0", "not negative": r"\ge 0", "negative": "< 0"}


def domain(derivation: Derivation) -> str:
    """Return a sentence, or nothing if a result has no conditions.

    What the nomenclature says of a letter is not repeated. What is assumed of a letter that is defined here,
    because it does not follow from the other conditions, is said apart.
    """
    own = [step for step in derivation.steps if step.claim and not step.source]
    claims = [step.claim for step in own if step.claim]
    symbols = {symbol for claim in claims for symbol in _symbols(claim)}
    new = letters(derivation.label, derivation.section)
    stated = {step.latex for step in own} | {
        part for step in own for part in step.domain.split(", ")
    }
    defined = {step.claim.lhs for step in derivation.steps if step.claim}
    shown = {each: printed(tex(each), new) for each in sorted(symbols, key=str)}
    signed = {each: f"{latex} > 0" for each, latex in shown.items()}
    assumed = [
        signed[each]
        for each in shown
        if each in defined and signed[each] in {*derivation.domain} - stated
    ]
    having: dict[str, list[str]] = {}
    for each, latex in shown.items():
        real = each.is_extended_real  # else the name of a row of numbers
        if real and (sign := sign_of(each)) != _listed(latex) and signed[each] not in assumed:
            having.setdefault(sign, []).append(latex)
    signs = [
        f"${', '.join(each)} {_RELATIONS[sign]}$"
        if sign in _RELATIONS
        else f"${', '.join(each)}$ {sign}"
        for sign, each in having.items()
    ]
    said = {step.latex for step in own} | {
        step.domain for step in own if step.latex == derivation.latex
    }
    said |= {signed[each] for each in shown if each.is_positive}
    ends = (each.split(" < ") for each in derivation.domain if each.count(" < ") == 2)
    implied = {f"{one} < {other}" for *_, one, other in ends}
    left = [each for each in derivation.domain if each not in {*said, *assumed, *implied}]
    holds = [*signs, *(f"${each}$" for each in left)]
    parts = [f"It holds for {', '.join(holds)}"] if holds else []
    parts += (
        [f"assumed, not proved: {', '.join(f'${each}$' for each in assumed)}"] if assumed else []
    )
    sentence = "; ".join(parts)
    return f"{sentence[:1].upper()}{sentence[1:]}." if parts else ""


def _listed(latex: str) -> str:
    """Return what the nomenclature says of the sign of a letter."""
    found = next(atoms(latex), None)
    row = BY_LATEX.get(found.symbol) if found else None
    return row.sign if row else ""


def _symbols(claim: Claim) -> set[sp.Symbol]:
    """Return the letters of a claim but for those that sweep over an interval of their own."""
    over = claim.arguments.get("over")
    found = claim.lhs.free_symbols | claim.rhs.free_symbols
    return {each for each in found if isinstance(each, sp.Symbol)} - ({over[0]} if over else set())
