r"""Closed forms with the numbers of a scene inserted, as in a hand calculation.

The numbers come in as SI values and units by the name of a symbol; what follows from them (half length,
retardation length, edges) is computed from the proved closed forms.

>>> shown(0.00031, "m"), shown(2.5e9, "N/m³"), shown(0.25, "1")
('310\\,\\mathrm{\\mu m}', '2.5\\,\\mathrm{GN/m^{3}}', '0.25')
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

import sympy as sp
from sympy.core.function import AppliedUndef

from . import symbols as sym
from .atoms import atoms, replaced
from .book import established, tex
from .letters import letters
from .nomenclature import BY_LATEX
from .record import Calculation, Claim, Derivation, Step
from .render.text import relations

Numbers = dict[sp.Symbol, sp.Expr]

DIGITS = 30
"""Forms are evaluated with this many digits, so that a value is right to the last one shown."""
SHOWN_DIGITS = 6
AGREEMENT = 1e-9
"""Relative difference below which two values of one quantity are the same."""

FOLLOWING = (
    ("eq29", sym.l_r),
    ("eq28", sym.a),
    ("eq26", sym.x_le),
    ("eq27", sym.x_te),
)
"""The quantities that follow from a scene and its depth, with the derivations that give them."""

CONSTANTS = (sym.R, sym.M, sym.K, sym.C, sym.tau, sym.g, sym.a_0, sym.delta_0, sym.W_0)
"""The constants of a scene, the same in every state."""

COORDINATES = (sym.x, sym.z, sym.t, sym.xi)
"""Positions, which are not results."""

_CHECKS = ("define", "equal", "root", "integral", "leading_order")
_PREFIXES = (
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, r"\mu "),
    (1e-9, "n"),
)
_NEEDLESS = re.compile(r"\{\(([^()]*)\)\}")
"""Parentheses around everything between two braces."""
_NUMBER = re.compile(r"(-?[\d.]+)e([+-]\d+)")


def with_numbers(
    derivations: Iterable[Derivation], quantities: Mapping[str, float]
) -> Iterator[Derivation]:
    """Give each derivation its closed forms with these quantities, as `known_quantities` returns them."""
    known = known_quantities(quantities)
    for derivation in derivations:
        numbers = tuple(_calculations(derivation, known))
        yield replace(derivation, numbers=numbers)


def known_quantities(quantities: Mapping[str, float]) -> Numbers:
    """Return the quantities (in SI, by the name of a symbol) with what follows from them."""
    by_name = {
        symbol.name: symbol for symbol in vars(sym).values() if isinstance(symbol, sp.Symbol)
    }
    known: Numbers = {by_name[name]: sp.Float(value, DIGITS) for name, value in quantities.items()}
    following = [(symbol, established(label, symbol)) for label, symbol in FOLLOWING]
    for symbol, form in (*following, (sym.l, sym.l_r / sym.a), (sym.q, sym.x_te / sym.a)):
        value = _value(form, known)
        if value is not None:
            known.setdefault(symbol, value)
    return known


def shown_quantities(quantities: Mapping[str, float]) -> dict[str, str]:
    """Return the known quantities in LaTeX by the LaTeX of their symbol, as far as they are listed."""
    return _listed(known_quantities(quantities))


def _latex(symbol: sp.Symbol) -> str:
    return next((atom.symbol for atom in atoms(tex(symbol))), "")


def _listed(known: Numbers) -> dict[str, str]:
    values = {}
    for symbol, value in known.items():
        latex = _latex(symbol)
        if latex in BY_LATEX:
            values[latex] = shown(float(value), BY_LATEX[latex].unit)
    return values


def _calculations(derivation: Derivation, given: Numbers) -> tuple[Calculation, ...]:
    """Go through the steps, each of which may use what those before it define.

    Of several forms of a quantity the last one counts. A derivation that gives another value to a
    quantity of the scene speaks of another state, of which only the scene's constants are known;
    where it does so in an equation of its own, its symbols are not those of the scene.
    """
    own = letters(derivation.label, derivation.section)  # here these stand for something else
    known, found = {symbol: given[symbol] for symbol in given if _latex(symbol) not in own}, {}
    for step in derivation.steps:
        claim = step.claim
        if claim is None or step.relation != "=" or claim.check not in (*_CHECKS, "recall"):
            continue
        value = _value(claim.rhs, known)
        asymptote = claim.check == "leading_order"
        before = known.get(claim.lhs)
        same = before is None or value is None or _agree(value, before)
        restated = claim.check == "define" and claim.lhs in given and step.latex != derivation.latex
        wanted = step.left in BY_LATEX and claim.lhs not in COORDINATES
        if value is not None and wanted and not (step.source or restated):
            if not (same or asymptote or claim.check == "root"):
                return ()
            found[step.left, asymptote] = _calculation(step, claim, value, before, known)
        if not isinstance(claim.lhs, sp.Symbol) or asymptote:
            continue
        if step.source and not same:
            known = {symbol: known[symbol] for symbol in CONSTANTS if symbol in known}
        known.pop(claim.lhs, None)
        if value is not None:
            known[claim.lhs] = value
    # The result comes last, also where what follows from it is said after it.
    return tuple(
        sorted(found.values(), key=lambda each: derivation.latex.startswith(f"{each.symbol} ="))
    )


def _agree(one: sp.Expr, other: sp.Expr) -> bool:
    return bool(abs(one - other) <= AGREEMENT * max(abs(one), abs(other)))


def _value(form: sp.Expr, known: Numbers) -> sp.Expr | None:
    """Return the value of a form, or None if it contains a symbol without a value."""
    if not form.free_symbols <= known.keys() or form.has(AppliedUndef, sp.Integral, sp.Derivative):
        return None
    value = form.subs(known).evalf(DIGITS)
    return value if value.is_Float or value.is_Integer else None


def _calculation(
    step: Step, claim: Claim, value: sp.Expr, exact: sp.Expr | None, known: Numbers
) -> Calculation:
    formula = relations(step.right)[-1].removeprefix("=").strip()
    note = ""
    if claim.check == "leading_order":
        formula = formula.rpartition(r" \left(1 ")[0] or formula
        note = "an asymptote"
        if exact is not None:
            note += f", {float(value / exact - 1):+.3%} off the exact value"
    unit = BY_LATEX[step.left].unit if step.left in BY_LATEX else "1"
    return Calculation(
        symbol=step.left,
        formula=formula,
        substituted=_substituted(formula, known),
        shown=shown(float(value), unit),
        value=float(value),
        unit=unit,
        note=note,
    )


def _substituted(formula: str, known: Numbers) -> str:
    r"""Replace each symbol by its quantity with its unit; return nothing if one has no value."""
    quantities = {r"\alpha": shown(float(sym.alpha), "1"), **_listed(known)}
    present = {atom.symbol for atom in atoms(formula)}
    if not present or not present <= quantities.keys():
        return ""
    text = replaced(formula, lambda symbol: f"({quantities[symbol]})")
    return _NEEDLESS.sub(r"{\1}", text)


def shown(value: float, unit: str) -> str:
    """Return a quantity in LaTeX, with the prefix that leaves one to three digits before the point."""
    prefix = ""
    if unit != "1" and unit[0] in "mNPs1" and not unit.startswith(("1", "kg")) and value:
        scale, prefix = next(
            (each for each in _PREFIXES if abs(value) >= each[0] * (1 - 1e-12)), (1.0, "")
        )
        value /= scale
    number = _NUMBER.sub(
        lambda found: rf"{found[1]} \cdot 10^{{{int(found[2])}}}", f"{value:.{SHOWN_DIGITS}g}"
    )
    return number if unit == "1" else rf"{number}\,\mathrm{{{prefix}{_unit(unit)}}}"


def _unit(unit: str) -> str:
    powers = unit.replace("²", "^{2}").replace("³", "^{3}")
    return powers.replace(" ", r"\,")
