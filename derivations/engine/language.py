"""The language of the kernel: what the expressions of a step may be made of. All else is refused by name.

What is here is what the records use, and what is accepted here is decided soundly: every function is smooth
where it is real, or its kinks are known; a letter is one real number.
"""

from collections.abc import Iterator

import sympy as sp
from sympy.codegen.cfunctions import expm1, log1p
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from .forms import Computed

FUNCTIONS = (
    *(sp.exp, sp.log, sp.sin, sp.cos, sp.tan, sp.asin, sp.atan, sp.sinh, sp.cosh, sp.asinh),
    *(expm1, log1p),
    *(sp.Abs, sp.Max, sp.Min),
)
_NUMBERS = (sp.Rational, type(sp.pi), type(sp.E), type(sp.oo), type(-sp.oo))
_COMPOUND = (
    *(sp.Add, sp.Mul, sp.Pow, AppliedUndef, sp.Derivative, sp.Integral, sp.Sum, sp.Subs),
    *(sp.Indexed, sp.UnevaluatedExpr, sp.Tuple, Relational, sp.And, type(sp.true)),
    *(sp.ImmutableDenseMatrix, Computed),
)


def foreign(expr: sp.Basic) -> str:
    """Return what is not in the language, in words; nothing if all is.

    >>> x = sp.Symbol("x", real=True)
    >>> foreign(sp.gamma(x) + 1), foreign(x**2 + sp.exp(x))
    ('gamma is not among the functions that the kernel knows', '')
    """
    return next(filter(None, map(_foreign, parts(expr))), "")


def parts(expr: sp.Basic) -> Iterator[sp.Basic]:
    """Yield an expression and all that is in it, but for the name of an indexed quantity."""
    yield expr
    if not isinstance(expr, sp.Indexed):
        for part in expr.args:
            yield from parts(part)


def _foreign(node: sp.Basic) -> str:
    if isinstance(node, sp.Symbol):
        if type(node) is not sp.Symbol or not node.is_commutative:
            return f"{node} is a {type(node).__name__} and no letter"
        return "" if node.is_extended_real else f"{node} is not known to be real"
    if isinstance(node, (*_NUMBERS, *_COMPOUND, *FUNCTIONS)):
        return ""
    if isinstance(node, sp.Function):
        return f"{type(node).__name__} is not among the functions that the kernel knows"
    return f"{node}, a {type(node).__name__}, is no exact real value"
