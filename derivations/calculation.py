r"""Closed forms with the numbers of a scene inserted, as in a hand calculation.

The numbers come in as SI values and units by the name of a symbol; what follows from them (half length,
retardation length, edges) is computed from the proved closed forms.

>>> shown(0.00031, "m"), shown(2.5e9, "N/m³"), shown(0.25, "1")
('310\\,\\mathrm{\\mu m}', '2.5\\,\\mathrm{GN/m^{3}}', '0.25')
"""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import mpmath
import sympy as sp
from mpmath.libmp import prec_to_dps
from sympy.core.function import AppliedUndef

from . import symbols as sym
from .chapters import relaxation, viscoelastic
from .chapters import viscoelastic_ball as ball
from .chapters.groups import k_s
from .dimensions import OWN as OWN_UNITS
from .engine.atoms import atoms, replaced
from .engine.book import established, tex
from .engine.letters import letters
from .engine.nomenclature import BY_LATEX, Symbol
from .engine.record import Calculation, Claim, Derivation, Step
from .render.text import relations

Numbers = dict[sp.Expr, sp.Expr]
Arms = Iterable[tuple[float, float]]
"""The stiffness and the relaxation time of each arm of a Prony series."""

DIGITS, CANCELLED = 30, 5.0
"""Forms are evaluated with this many digits, and this many more for each decade between l_r and a, as far
as terms may cancel: so a value is right to the last digit shown."""
GUARD = 10
"""Digits beyond these while a root is found."""
SHOWN_DIGITS = 6
AGREEMENT = 1e-9
"""Relative difference below which two values of one quantity are the same."""

FOLLOWING = (("eq29", sym.l_r), ("eq28", sym.a), ("eq26", sym.x_le), ("eq27", sym.x_te))
"""The quantities that follow from a scene and its depth, with the derivations that give them."""

GIVEN = {
    symbol.name: symbol
    for symbol in (
        *(sym.R, sym.K, sym.tau, sym.C, sym.V, sym.delta, sym.M, sym.g, k_s, sym.W, sym.F, sym.mu),
        *(sym.delta_0, sym.a_0, sym.W_0, sym.lam, sym.eps, sym.kappa),
        *(sym.L, sym.exponent, sym.inclination, ball.across),
    )
}
"""The quantities that a scene may give, by name."""

OWN = {"sphere": "F20", "power-law": "F19", "wedge": "wedge"}
"""The family of records about a shape; all others are about the parabola, but for those of the next table."""

SHARED = {
    "sphere": ("eq22", "eq29", "eq26", "eq27", "eq28"),  # in its middle plane
    "power-law": ("eq22", "eq29"), "wedge": ("eq22", "eq29"),
}  # fmt: skip

ELSEWHERE = {
    True: ("wedge-peeled", "wedge", "wedge-weight-peeled"),
    False: ("wedge-edge", "wedge-peeling", "wedge-low", "wedge-weight-peeling"),
}
"""The records about a wedge that do not hold, by whether l < 1."""

ON_ARMS = {
    "parabola": ("F17", "F18", "eq26", "eq28"),
    "sphere": ("eq26", "eq28", "F17-strip", "F20-any"),
}
"""The records, and families of records, that hold on a Prony series, by the shape."""
OTHER_LAWS = ("springpot", "voigt", "limits")
"""Ends of the labels of records about other laws, or about limits: their letters have other values there."""

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
_BRACKET = re.compile(r"\\(left|right)(?![A-Za-z])")
_NUMBER = re.compile(r"(-?[\d.]+)e([+-]\d+)")


def with_numbers(
    derivations: Iterable[Derivation],
    quantities: Mapping[str, float],
    shape: str,
    arms: Arms = (),
) -> Iterator[Derivation]:
    """Give each derivation about this shape its closed forms, as `known_quantities` returns them."""
    known = known_quantities(quantities, shape, arms=arms)
    other = ELSEWHERE[bool(known[sym.l] < 1)] if shape == "wedge" else ()
    for derivation in derivations:
        holds = _concerns(derivation.label, shape, arms) and derivation.label not in other
        yield replace(derivation, numbers=_calculations(derivation, known) if holds else ())


def _concerns(label: str, shape: str, arms: Arms = ()) -> bool:
    family = label.split("-", maxsplit=1)[0]
    if label.endswith(OTHER_LAWS):
        return False
    if arms:
        return bool({family, label} & {*ON_ARMS[shape]})
    if shape in OWN:
        return family == OWN[shape] or label in SHARED[shape]
    return family not in OWN.values()


def known_quantities(
    quantities: Mapping[str, float],
    shape: str = "parabola",
    digits: int = DIGITS,
    arms: Arms = (),
) -> Numbers:
    """Return the quantities (in SI, by the names of `GIVEN`) with what follows from them."""
    known: Numbers = {GIVEN[name]: sp.Float(value, digits) for name, value in quantities.items()}
    if arms:
        with mpmath.workdps(digits + GUARD):
            return known | _on_arms(known, arms)
    forms = {symbol: established(label, symbol) for label, symbol in FOLLOWING}
    n, l, q = sym.exponent, sym.l, sym.q
    forms[l] = sym.l_r / sym.a
    if shape == "power-law":
        forms[sym.a] = (n * sym.L ** (n - 1) * sym.delta) ** (1 / n)  # F19-pressure
        forms |= {sym.excess: n - 1, sym.Q: q ** (n - 1)}
    if shape == "wedge":
        forms |= {sym.a: sym.delta / sym.inclination, q: sp.Max(0, 1 - l)}
    if shape in ("power-law", "wedge"):
        forms[sym.x_te] = q * sym.a  # F19-edge, wedge-edge
    else:
        forms[q] = sym.x_te / sym.a
    for _ in forms:  # each may need those after it
        for symbol, form in forms.items():
            if symbol not in known and (value := _value(form, known)) is not None:
                known[symbol] = value
        if shape == "power-law" and l in known:
            known[q] = _trailing_edge(known[n], known[l], digits)
    if digits == DIGITS and l in known:
        digits += math.ceil(CANCELLED * abs(math.log10(known[l])))
        return known_quantities(quantities, shape, digits) if digits > DIGITS else known
    return known


def _on_arms(known: Numbers, arms: Arms) -> Numbers:
    """Return what F17 says of a Prony series; of a ball in its middle plane, and the sums of F20-any.

    G_n is the integral of G repeated n times; the length c of the contact is the root of a G_1 = G_2.
    """
    K, V, R, depth = (mpmath.mpmathify(known[each]) for each in (sym.K, sym.V, sym.R, sym.delta))
    series = [(K, mpmath.inf), *((mpmath.mpf(k), V * mpmath.mpf(tau)) for k, tau in arms)]

    def repeated(n: int, c: mpmath.mpf) -> mpmath.mpf:
        return sum(
            k * c**n * mpmath.hyp1f1(1, n + 1, -c / l) for k, l in series
        ) / mpmath.factorial(n)

    half = mpmath.sqrt(2 * R * depth)
    c = mpmath.findroot(
        lambda c: repeated(2, c) - half * repeated(1, c), (half, 2 * half), solver="anderson"
    )
    found = {sym.a: half, sym.x_le: -half, sym.x_te: c - half, relaxation.c: c}
    found |= {viscoelastic.b: half / c, viscoelastic.e: half / c - mpmath.mpf(1) / 2}
    memory = relaxation.G(relaxation.c), *(part(relaxation.c) for part in relaxation.repeated)
    found |= {integral: repeated(n, c) for n, integral in enumerate(memory)}
    if len(series) == 2:  # else the letters of an arm stand for several
        found[viscoelastic.arm_number] = c / series[1][1]
    if ball.across in known:
        stretch = mpmath.sqrt(mpmath.mpmathify(known[ball.across]) / R)

        def gained(weight: Callable[[mpmath.mpf], mpmath.mpf], c: mpmath.mpf) -> mpmath.mpf:
            G, G_1, G_2 = (repeated(n, c) for n in range(3))
            place = stretch * mpmath.sqrt(half**2 - (G_2 / G_1) ** 2)
            return 2 * place * (1 - G_2 * G / G_1**2) * weight(2 * G_2 / G_1 - c) * G_2 / R

        found[ball.middle] = c
        rates = (ball.LOAD_RATE, lambda arm: 1), (ball.FRICTION_RATE, lambda arm: arm / R)
        for rate, weight in rates:
            form = ball.strip_place(ball.c) * rate * sp.Derivative(sym.a, ball.c)
            found[2 * sp.Integral(form, ball.ALONG)] = mpmath.quad(partial(gained, weight), [0, c])
    return {name: sp.Float(value, mpmath.mp.dps) for name, value in found.items()}


def _trailing_edge(n: sp.Float, l: sp.Float, digits: int) -> sp.Float:
    """Return q of a power law: ln q is the root of an increasing, convex function (F19-edge)."""
    with mpmath.workdps(digits + GUARD):
        n, l = mpmath.mpmathify(n), mpmath.mpmathify(l)
        found = mpmath.findroot(
            lambda s: (n - 1) * s + mpmath.log(mpmath.exp(s) + n * l), 0, solver="newton",
            df=lambda s: n - 1 + mpmath.exp(s) / (mpmath.exp(s) + n * l),
        )  # fmt: skip
        return sp.Float(mpmath.exp(found), digits)


def shown_quantities(
    quantities: Mapping[str, float], shape: str, arms: Arms = ()
) -> dict[str, str]:
    """Return the known quantities in LaTeX by the LaTeX of their symbol, as far as they are listed."""
    return _listed(known_quantities(quantities, shape, arms=arms))


def _latex(symbol: sp.Symbol) -> str:
    return next((atom.symbol for atom in atoms(tex(symbol))), "")


def _listed(known: Numbers) -> dict[str, str]:
    values = {}
    for symbol, value in known.items():
        latex = _latex(symbol) if symbol.is_Symbol else ""
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
    known, found = (
        {
            symbol: given[symbol]
            for symbol in given
            if not symbol.is_Symbol or _latex(symbol) not in own
        },
        {},
    )
    for step in derivation.steps:
        claim = step.claim
        if claim is None or step.relation != "=" or claim.check not in (*_CHECKS, "recall"):
            continue
        value = _value(claim.rhs, known)
        asymptote = claim.check == "leading_order"
        before = known.get(claim.lhs)
        same = before is None or value is None or _agree(value, before)
        restated = claim.check == "define" and claim.lhs in given and step.latex != derivation.latex
        restated = restated and not claim.rhs.has(AppliedUndef)
        wanted = _row(step) is not None and claim.lhs not in COORDINATES
        if value is not None and wanted and not (step.source or restated):
            if not (same or asymptote or claim.check == "root"):
                return ()
            units = OWN_UNITS.get(derivation.label, {})
            found[step.left, asymptote] = _calculation(step, claim, value, before, known, units)
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


def _row(step: Step) -> Symbol | None:
    """Return the row of the nomenclature of the left side, if that is one symbol."""
    found = list(atoms(step.left))
    alone = len(found) == 1 and (found[0].start, found[0].end) == (0, len(step.left))
    plain = alone and not (found[0].dots or found[0].primes)
    return BY_LATEX.get(found[0].symbol) if plain else None


def _agree(one: sp.Expr, other: sp.Expr) -> bool:
    return bool(abs(one - other) <= AGREEMENT * max(abs(one), abs(other)))


def _value(form: sp.Expr, known: Numbers) -> sp.Expr | None:
    """Return the value of a form, or None if it contains a symbol without a value."""
    if form in known:
        return known[form]
    if form.has(sp.Integral, sp.Derivative):
        return None
    form = form.xreplace({each: known[each] for each in form.atoms(AppliedUndef) & known.keys()})
    if not form.free_symbols <= known.keys() or form.has(AppliedUndef):
        return None
    digits = prec_to_dps(max(value._prec for value in known.values() if value.is_Float))
    value = form.subs(known).evalf(digits)
    return value if value.is_Float or value.is_Integer else None


def _calculation(
    step: Step,
    claim: Claim,
    value: sp.Expr,
    exact: sp.Expr | None,
    known: Numbers,
    units: Mapping[str, str],
) -> Calculation:
    formula = relations(step.right)[-1].removeprefix("=").strip()
    note = ""
    if claim.check == "leading_order":
        formula = _without_series(formula)
        note = "an asymptote"
        if exact:
            note += f", {float(value / exact - 1):+.3%} off the exact value"
    row = _row(step)
    unit = units.get(row.latex, row.unit) if row else "1"
    return Calculation(
        symbol=step.left,
        formula=formula,
        substituted=_substituted(formula, known),
        shown=shown(float(value), unit),
        value=float(value),
        unit=unit,
        note=note,
    )


def _without_series(formula: str) -> str:
    r"""Leave out the last bracket, the series by which a leading term is multiplied.

    >>> _without_series(r"\frac{a}{2} \left(1 - \frac{\left(1 + a\right) b}{3} + O\left(b^{2}\right)\right)")
    '\\frac{a}{2}'
    """
    open_ones = 0
    for bracket in reversed([*_BRACKET.finditer(formula)]):
        open_ones += 1 if bracket[1] == "right" else -1
        if not open_ones:
            return formula[: bracket.start()].strip() or formula
    return formula


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
