"""Where a result holds: the signs of its letters, and the conditions under which it was proved."""

import sympy as sp

from ..engine.book import tex
from ..engine.letters import letters, printed
from ..engine.record import Claim, Derivation

_SIGNS = (("is_positive", "> 0"), ("is_nonnegative", r"\ge 0"), ("is_negative", "< 0"))


def domain(derivation: Derivation) -> str:
    """Return a sentence, or nothing if a result has no conditions.

    A letter without a sign is a real number. What is assumed of a letter that is defined here, because
    it does not follow from the other conditions, is said apart.
    """
    own = [step for step in derivation.steps if step.claim and not step.source]
    claims = [step.claim for step in own if step.claim]
    symbols = {symbol for claim in claims for symbol in _symbols(claim)}
    new, signs = letters(derivation.label, derivation.section), []
    stated = {step.latex for step in own} | {
        part for step in own for part in step.domain.split(", ")
    }
    defined = {step.claim.lhs for step in derivation.steps if step.claim}
    signed = {each: f"{printed(tex(each), new)} > 0" for each in symbols & defined}
    assumed = {
        each: latex for each, latex in signed.items() if latex in {*derivation.domain} - stated
    }
    symbols -= {*assumed}
    for sign, relation in _SIGNS:
        having = sorted((s for s in symbols if getattr(s, sign)), key=str)
        symbols -= set(having)
        if having:
            signs.append(f"${', '.join(printed(tex(each), new) for each in having)} {relation}$")
    said = {step.latex for step in own} | {
        step.domain for step in own if step.latex == derivation.latex
    }
    apart = [assumed[each] for each in sorted(assumed, key=str)]
    ends = (each.split(" < ") for each in derivation.domain if each.count(" < ") == 2)
    implied = {f"{one} < {other}" for *_, one, other in ends}
    left = [each for each in derivation.domain if each not in {*said, *apart, *implied}]
    holds = [*signs, *(f"${each}$" for each in left)]
    parts = [f"It holds for {', '.join(holds)}"] if holds else []
    parts += [f"assumed, not proved: {', '.join(f'${each}$' for each in apart)}"] if apart else []
    return f"{'; '.join(parts)}." if parts else ""


def _symbols(claim: Claim) -> set[sp.Symbol]:
    """Return the letters of a claim but for those that sweep over an interval of their own."""
    over = claim.arguments.get("over")
    found = claim.lhs.free_symbols | claim.rhs.free_symbols
    return {each for each in found if isinstance(each, sp.Symbol)} - ({over[0]} if over else set())
