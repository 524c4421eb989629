r"""The shape of an indenter from a text that a user types; the text is never executed.

>>> read_shape("c*x^4").rise
c*x_abs**4
>>> read_shape("|x|**1.5/b + x**2/(2*R)").rise
x_abs**(3/2)/b + x_abs**2/(2*R)
>>> read_shape("c*x**3")
Traceback (most recent call last):
ValueError: the shape "c*x**3" is not even: write abs(x) or |x| where x has an odd power
"""

import ast
import math
import re
from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp

from .engine.nomenclature import TEX, symbol

distance = symbol("x_abs", latex=r"\bar x")
"""Distance from the lowest line of the indenter."""

LONGEST, MOST_TERMS, HIGHEST = 200, 6, 12
"""Characters of a shape, terms of its sum, and its highest power."""
MOST_SPREAD, MOST_BITS = 200, 1000
"""Terms of a product that is multiplied out on the way, and bits of a number."""
MOST_WORK = 250
"""Of the closed forms of a sum: the square of its terms and letters, times the highest power of q in it."""
TAKEN = {
    *"adehipquxCFKOVW", r"\delta", r"\mu", r"\tau", r"\pi", r"\infty", r"\barx", r"\hatq",
    "l_r", "x_LE", "x_TE", "W_a", "W_b", "F_a", "F_b",
}  # fmt: skip
"""Letters that already have a meaning in the derivation, as they are printed, without braces and spaces."""

_OPERATORS: dict[type[ast.operator], Callable[[sp.Expr, sp.Expr], sp.Expr]] = {
    ast.Add: lambda one, other: one + other,
    ast.Sub: lambda one, other: one - other,
    ast.Mult: lambda one, other: one * other,
    ast.Div: lambda one, other: one / other,
}
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9]{0,11}(_[A-Za-z0-9]{1,12})?")
_X = sp.Symbol("x", real=True)


@dataclass(frozen=True)
class Shape:
    """A sum of powers of the distance from the lowest line, with positive coefficients or numbers."""

    text: str
    rise: sp.Expr
    """The height over `distance`, which is positive."""
    parameters: tuple[sp.Symbol, ...]
    powers: tuple[sp.Rational, ...]

    def coefficient(self, power: sp.Rational) -> sp.Expr:
        """Return the coefficient of a power."""
        return sp.Add(*(
            term / distance**power
            for term in sp.Add.make_args(self.rise)
            if term.as_independent(distance, as_Add=False)[1] == distance**power
        ))  # fmt: skip

    @property
    def root_order(self) -> int:
        """The least number k for which all powers of the k-th power of a length are whole."""
        return int(sp.ilcm(1, *(power.q for power in self.powers)))


def read_shape(text: str) -> Shape:
    """Read a sum of powers of abs(x), or of even powers of x, with parameters that are positive.

    Raises
    ------
    ValueError
        For what is no such sum; the message says what is expected.
    """
    if len(text) > LONGEST:
        raise ValueError(f"the shape has {len(text)} characters; at most {LONGEST} are read")
    if strange := re.search(r"[^A-Za-z0-9_ .+*/^|()-]", text):
        raise ValueError(f"the shape {text!r} is not read: it has the character {strange[0]!r}")
    try:
        tree = ast.parse(_python(text), mode="eval")
    except (SyntaxError, ValueError) as error:
        raise ValueError(f'the shape "{text}" is not a formula such as "c*x**4"') from error
    written = _expression(tree.body, text)
    if _spread(written) > MOST_SPREAD:
        raise ValueError(f'the shape "{text}" has too many terms; at most {MOST_TERMS} are read')
    formula = sp.expand(written)
    if sp.expand(formula - formula.subs(_X, -_X)) != 0:
        raise ValueError(
            f'the shape "{text}" is not even: write abs(x) or |x| where x has an odd power'
        )
    rise = sp.expand(formula.subs(_X, distance))
    powers = tuple(sorted(_power(term, text) for term in sp.Add.make_args(rise)))
    if len(powers) > MOST_TERMS:
        raise ValueError(
            f'the shape "{text}" has {len(powers)} terms; at most {MOST_TERMS} are read'
        )
    parameters = tuple(sorted(rise.free_symbols - {distance}, key=str))
    shape = Shape(text, rise, parameters, powers)
    degree = int(shape.root_order * powers[-1])
    if len(powers) > 1 and (len(powers) + len(parameters)) ** 2 * degree > MOST_WORK:
        raise ValueError(
            f'the shape "{text}": {len(powers)} terms with {len(parameters)} parameters give forms with '
            f"powers up to {degree}, which are too long; take fewer terms, or lower and whole powers"
        )
    return shape


def _python(text: str) -> str:
    """Write bars and carets as Python does."""
    return re.sub(r"\|([^|]*)\|", r"abs(\1)", text.strip()).replace("^", "**")


def _expression(node: ast.expr, text: str) -> sp.Expr:
    """Build the formula from what is allowed, and refuse all else."""
    found = None
    match node:
        case ast.Constant(value=int() | float() as number) if _plain(number):
            found = sp.Rational(str(number))
        case ast.Name(id=name):
            found = _X if name == "x" else _parameter(name, text)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            found = -_expression(operand, text)
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            found = _expression(left, text) ** _exponent(right, text)
        case ast.BinOp(left=left, op=operator, right=right) if type(operator) in _OPERATORS:
            found = _OPERATORS[type(operator)](_expression(left, text), _expression(right, text))
        case ast.Call(func=ast.Name(id="abs"), args=[argument], keywords=[]):
            found = sp.Abs(_expression(argument, text))
    if found is not None and found.is_finite is not False and _is_small(found):
        return found
    raise ValueError(
        f'the shape "{text}": {ast.unparse(node)!r} is not read; expected numbers, names, x, abs(x), '
        "+, -, *, / and powers"
    )


def _spread(expr: sp.Expr) -> int:
    """Return how many terms there are at most once everything is multiplied out."""
    parts = [_spread(part) for part in expr.args]
    if expr.is_Add:
        return sum(parts)
    if expr.is_Pow and parts[0] > 1:
        power = math.ceil(abs(expr.exp))
        return math.comb(parts[0] + power - 1, power)
    return math.prod(parts)


def _is_small(expr: sp.Expr) -> bool:
    """Tell whether the numbers and the powers that were built so far are no burden."""
    numbers = (part for each in expr.atoms(sp.Rational) for part in (each.p, each.q))
    return all(abs(part).bit_length() <= MOST_BITS for part in numbers)


def _plain(number: float) -> bool:
    return not isinstance(number, bool) and math.isfinite(number)


def _parameter(name: str, text: str) -> sp.Symbol:
    found = sp.Symbol(name, positive=True)
    printed = re.sub(r"\\mathrm|[{} ]", "", sp.latex(found))
    taken = name in TAKEN or printed in TAKEN or found in TEX
    if taken or not _NAME.fullmatch(name):
        why = "already has a meaning" if taken else "is no name"
        raise ValueError(f'the shape "{text}": {name!r} {why}; choose another letter, such as c')
    return found


def _exponent(node: ast.expr, text: str) -> sp.Rational:
    power = _expression(node, text)
    if not power.is_Rational or abs(power) > HIGHEST or power.q > HIGHEST:
        raise ValueError(
            f'the shape "{text}": {ast.unparse(node)!r} is not a number up to {HIGHEST}, as a power must be'
        )
    return power


def _power(term: sp.Expr, text: str) -> sp.Rational:
    rest = term.as_independent(distance, as_Add=False)[1]
    power = rest.as_base_exp()[1] if rest != 1 else sp.S.Zero
    if rest != distance**power or not power.is_Rational or not 1 <= power <= HIGHEST:
        raise ValueError(
            f'the shape "{text}": expected a sum of powers of |x| from 1 to {HIGHEST}, not {term}'.replace(
                str(distance), "|x|"
            )
        )
    return power
