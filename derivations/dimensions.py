r"""The dimensions of displayed relations: both sides, and the terms of every sum, must have the same.

The unit of a letter is that of the nomenclature, by what is printed for it; scaled letters have none. A
dimension is a vector of exponents, which may contain letters themselves, as in a power law.
"""

import re
from collections.abc import Mapping
from functools import cache

import sympy as sp
from sympy.codegen.cfunctions import expm1, log1p
from sympy.core.function import AppliedUndef

from .chapters.rubber_transient import Determinant
from .engine.atoms import atoms
from .engine.book import tex
from .engine.letters import letters, printed
from .engine.nomenclature import BY_LATEX, TEX
from .engine.record import Derivation
from .engine.step import Greatest

Dimension = tuple[sp.Expr, ...]

BASE = ("N", "m", "s", "K", "mol")
_DERIVED = {
    "kg": {"N": 1, "s": 2, "m": -1},
    "Pa": {"N": 1, "m": -2},
    "J": {"N": 1, "m": 1},
    "1": {},
}
_POWERS = str.maketrans("²³⁴", "234")
_UNIT = re.compile(r"([A-Za-z]+|1)(\d?)")
NONE: Dimension = (sp.S.Zero,) * len(BASE)
_PURE = (
    *(sp.exp, sp.log, sp.sin, sp.cos, sp.tan, sp.asin, sp.acos, sp.atan),
    *(sp.sinh, sp.cosh, sp.tanh, sp.coth, sp.asinh, sp.gamma, expm1, log1p),
)
"""Functions of a number, which give a number."""
_ALIKE = (sp.Abs, sp.Max, sp.Min, sp.UnevaluatedExpr)
"""Expressions of the dimension of their arguments."""

_FALL = {r"\breve H": "N/m³"}
_SHAPE = {"h": "1"}
_LENGTHS = {r"\hat y": "m", r"\bar m": "m", r"\chi": "1/m", "J": "1/m"}
_MOMENTS = {rf"\breve {each}": "N/m³" for each in "PDEAB"}
OWN: dict[str, dict[str, str]] = {
    **dict.fromkeys(("F17-parts", "F17-falls"), _MOMENTS),
    "F18-fall": {r"\breve H": "1/m"},
    "F18-voigt": {"F_z": "m²", "F_x": "m²"},
    "F18-glass": _FALL,
    **dict.fromkeys(("F27-kernel", "F27-steepest"), _MOMENTS | {r"\breve C": "Pa/m³"}),
    "F27-close": _MOMENTS,
    **dict.fromkeys(("F9-difference", "F9-shapes"), _SHAPE),
    **dict.fromkeys(("F9-power", "F9-catenary"), _LENGTHS),
    "F9-circle": {"R": "1"},
    "eq14": {"f_z": "N/m"},
    "eq15": {"f_x": "N/m"},
    "dense-row": {"f_z": "N/m", "f_x": "N/m"},
    "element-mean-force": {"p_s": "Pa"},
}
"""Units of letters in records where they are not those of the nomenclature: moments of the whole relaxation
function, not of an arm over its stiffness; its fall over a scaled distance; functions that are written for
scaled ones; a shape in any unit; forces over a stiffness."""
EXEMPT = {
    "groups-lengths": "scale factors of the units themselves",
    **dict.fromkeys(
        ("groups-fixed", "groups-dead-weight", "groups-transient"), "matrices of exponents"
    ),
}
"""Records whose relations are about dimensions, and why they have none."""


class DimensionError(ValueError):
    """Terms of different dimensions are added or compared, or a dimension is not known."""


@cache
def of_unit(unit: str) -> Dimension:
    """Return the exponents of the base units.

    >>> of_unit("N s/m³")
    (1, -3, 1, 0, 0)
    """
    found = dict.fromkeys(BASE, sp.S.Zero)
    parts = unit.translate(_POWERS).replace("(", "").replace(")", "").split("/")
    for sign, part in zip((1, -1), parts, strict=False):
        for name, power in _UNIT.findall(part):
            if name not in _DERIVED and name not in BASE:
                raise DimensionError(f"the unit {unit} is not known")
            for base, each in _DERIVED.get(name, {name: 1}).items():
                found[base] += sign * each * int(power or 1)
    return tuple(found.values())


def _times(one: Dimension, other: Dimension, power: sp.Expr | int = 1) -> Dimension:
    return tuple(sp.expand(a + power * b) if b else a for a, b in zip(one, other, strict=True))


class _Walk:
    """The letters of one derivation."""

    def __init__(self, label: str, section: str) -> None:
        self.new, self.own = letters(label, section), OWN.get(label, {})
        self._known: dict[sp.Expr, Dimension | None] = {}

    def of(self, expr: sp.Expr) -> Dimension | None:
        """Return the dimension; None for zero and infinity, which have every one."""
        if expr not in self._known:
            self._known[expr] = self._of(expr)
        return self._known[expr]

    def _of(self, expr: sp.Expr) -> Dimension | None:  # noqa: PLR0911, PLR0912 one branch for each kind
        if expr.is_number and not expr.has(AppliedUndef, sp.Integral):
            return None if expr in (0, sp.oo, -sp.oo) else NONE
        if expr.is_Symbol or isinstance(expr, AppliedUndef | sp.Indexed):
            return self._letter(expr)
        if expr.is_Add or isinstance(expr, _ALIKE):
            return self.same(*expr.args)
        if expr.is_Mul:
            total = NONE
            for factor in expr.args:
                total = _times(total, self.of(factor) or NONE)
            return total
        if expr.is_Pow:
            base, exponent = expr.args
            self.pure(exponent)
            return _times(NONE, self.of(base) or NONE, exponent)
        if isinstance(expr, sp.Derivative):
            total = self.of(expr.expr) or NONE
            for variable, count in expr.variable_count:
                total = _times(total, self.of(variable) or NONE, -count)
            return total
        if isinstance(expr, sp.Integral):
            total = self.of(expr.function) or NONE
            for variable, *ends in expr.limits:
                total = _times(total, self.same(variable, *ends) or NONE)
            return total
        if isinstance(expr, sp.Subs):
            for pair in zip(expr.variables, expr.point, strict=True):
                self.same(*pair)
            return self.of(expr.expr)
        if isinstance(expr, sp.Piecewise):
            return self.same(*(value for value, _ in expr.args))
        if isinstance(expr, Greatest | sp.Sum):
            return self.of(expr.args[0])
        if isinstance(expr, Determinant):
            return self.of(sp.Mul(*expr.args[0].diagonal(), evaluate=False))
        if isinstance(expr, _PURE):
            self.pure(*expr.args)
            return NONE
        raise DimensionError(f"{type(expr).__name__} has no known dimension")

    def same(self, *terms: sp.Expr) -> Dimension | None:
        """Return the dimension that all terms have."""
        found = {term: each for term in terms if (each := self.of(term)) is not None}
        first = next(iter(found.values()), None)
        for term, each in found.items():
            if each != first:
                raise DimensionError(
                    f"{term} has the dimension {each}, {next(iter(found))} {first}"
                )
        return first

    def pure(self, *terms: sp.Expr) -> None:
        """Refuse an exponent or an argument with a dimension."""
        for term in terms:
            if self.of(term) not in (None, NONE):
                raise DimensionError(f"{term} is no pure number")

    def _letter(self, expr: sp.Expr) -> Dimension:
        name = expr.func.__name__ if isinstance(expr, AppliedUndef) else ""
        name = str(expr.base) if isinstance(expr, sp.Indexed) else name
        upright = _INDEX.sub(r"_{\\mathrm{\1}}", name)
        for shown in (
            (sp.latex(sp.Symbol(name)), _NAMES.get(name, ""), upright) if name else (tex(expr),)
        ):
            found = list(atoms(printed(shown, self.new)))
            if len(found) == 1:
                row = BY_LATEX.get(found[0].symbol)
                unit = self.own.get(found[0].symbol) or (row.unit if row else None)
                dots = len(_DOTS.findall(found[0].dots))
                if unit is not None:
                    return _times(of_unit(unit), of_unit("s"), -dots)
        raise DimensionError(f"{expr} is not in the nomenclature")


_NAMES = {symbol.name: latex for symbol, latex in TEX.items() if symbol.is_Symbol}
_INDEX = re.compile(r"_(\w+)$")
_DOTS = re.compile(r"d(?=d*ot)")


def faults(derivation: Derivation, sources: Mapping[str, Derivation]) -> list[str]:
    """Describe the relations whose dimensions differ or are not known; `sources` are records by label."""
    found, walks = [], cache(_Walk)
    for step in derivation.steps if derivation.label not in EXEMPT else ():
        origin = sources.get(step.source, derivation)
        walk = walks(origin.label, origin.section)
        try:
            if step.claim and isinstance(step.claim.lhs, sp.Tuple):
                for sides in zip(step.claim.lhs, step.claim.rhs, strict=True):
                    walk.same(*sides)
            elif step.claim:
                walk.same(step.claim.lhs, step.claim.rhs)
        except DimensionError as error:
            found.append(f"{derivation.label}: {step.latex}: {error}")
    return found
