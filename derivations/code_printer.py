"""Expressions as code for floating-point numbers, in any language whose functions have a library."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy as sp
from sympy.codegen.cfunctions import expm1, log1p

from .symbols import lam


@dataclass(frozen=True)
class CodePrinter:
    """Prints expressions; integer powers are products, square roots of sums of squares `hypot`.

    `library` is the library of functions, and `names` maps functions to its names where they differ.

    >>> a, b = sp.symbols("a b", positive=True)
    >>> CodePrinter("JavaScript", "Math").code(sp.sqrt(1 + a**2) + b**3 / (2 * a))
    '(Math.hypot(1, a) + b * b * b / (2 * a))'
    """

    language: str
    library: str
    names: Mapping[str, str] = field(default_factory=dict)

    def code(self, expr: sp.Expr) -> str:
        """Print an expression; a sum is in parentheses."""
        numerator, denominator = sp.fraction(expr, exact=True)
        if denominator != 1:
            below = self.code(denominator)
            below = f"({below})" if denominator.is_Mul or denominator.is_Pow else below
            return f"{self.code(numerator)} / {below}"
        for kind, write in _WRITERS.items():
            if isinstance(expr, kind):
                return write(self, expr)
        raise TypeError(f"no {self.language} code for {expr}")

    def outer(self, expr: sp.Expr) -> str:
        """Print an expression without parentheses around a whole sum."""
        return _bare(self.code(expr))

    def call(self, name: str, arguments: tuple[sp.Expr, ...]) -> str:
        """Print the call of a function."""
        return f"{name}({', '.join(map(self.outer, arguments))})"

    def name(self, symbol: sp.Symbol) -> str:
        """Return the name of a variable; `lambda` is a keyword of Python."""
        return "lam" if symbol == lam else str(symbol)

    def function(self, name: str) -> str:
        """Return a function of the library."""
        return f"{self.library}.{self.names.get(name, name)}"

    def sum(self, expr: sp.Add) -> str:
        """Print a sum."""
        text = " + ".join(self.code(term) for term in expr.as_ordered_terms())
        return f"({text.replace('+ -', '- ')})"

    def product(self, expr: sp.Mul) -> str:
        """Print a product."""
        sign = "-" if expr.as_coeff_Mul()[0] < 0 else ""
        factors = (-expr if sign else expr).as_ordered_factors()
        return sign + " * ".join(self.code(factor) for factor in factors)

    def power(self, expr: sp.Pow) -> str:
        """Print a power."""
        base, exponent = expr.as_base_exp()
        if exponent.is_Integer:
            return " * ".join([self.code(base)] * int(exponent))
        legs = [sp.sqrt(term) for term in base.as_ordered_terms()]
        if exponent == sp.S.Half and len(legs) == 2 and all(leg.is_Atom for leg in legs):
            return self.call(self.function("hypot"), tuple(sorted(legs, key=str)))
        if exponent.free_symbols:
            above = self.code(exponent) if exponent.is_Atom else f"({self.outer(exponent)})"
            return f"{self.code(base)} ** {above}"
        if exponent == sp.Rational(1, 4):
            return self.power(sp.Pow(sp.sqrt(base), sp.S.Half, evaluate=False))
        root = {sp.S.Half: "sqrt", sp.Rational(1, 3): "cbrt"}[exponent]
        return self.call(self.function(root), (base,))


def _applied(name: str) -> Callable[[CodePrinter, sp.Expr], str]:
    return lambda printer, expr: printer.call(printer.function(name), expr.args)


def _least(printer: CodePrinter, expr: sp.Expr) -> str:
    return printer.call(printer.function("min"), tuple(sorted(expr.args, key=str)))


_WRITERS: dict[type, Callable[[CodePrinter, sp.Expr], str]] = {
    sp.Symbol: CodePrinter.name,
    sp.Integer: lambda _, expr: str(expr),
    type(sp.pi): lambda printer, _: printer.function("pi"),
    sp.Add: CodePrinter.sum,
    sp.Mul: CodePrinter.product,
    sp.Pow: CodePrinter.power,
    sp.asinh: _applied("asinh"),
    sp.exp: _applied("exp"),
    sp.sin: _applied("sin"),
    expm1: _applied("expm1"),
    log1p: _applied("log1p"),
    sp.Min: _least,
}


def _bare(text: str) -> str:
    """Drop the parentheses around a whole sum."""
    if not text.startswith("("):
        return text
    depth = 0
    for position, character in enumerate(text):
        depth += {"(": 1, ")": -1}.get(character, 0)
        if depth == 0 and position < len(text) - 1:
            return text
    return text[1:-1]
