r"""Mathematics as one writes it by hand: the only place that decides how an expression is printed.

A sum begins with a positive term, a damper follows its spring, a common factor stands before its bracket,
a characteristic polynomial falls in powers of the growth rate; a product is a number, then constants, letters
(capital, Greek, small), roots, brackets, functions; roots of one order are one root; dots and primes are
derivatives.

>>> C, V, W, delta, R, s = sp.symbols("C V W delta R s_r", positive=True)
>>> doprint(W - C * V * delta)
'W - C V \\delta'
>>> doprint(V + C * s - R + W * s**2).split(" + ")[-1], doprint(V + C * s - R + W * s**2)[0]
('V - R', 'W')
>>> doprint(3 * sp.sqrt(3) / 4 - sp.Rational(3, 4)), doprint(sp.sqrt(2 * R * delta))
('\\frac{3}{4} \\left(\\sqrt{3} - 1\\right)', '\\sqrt{2 R \\delta}')
>>> doprint(sp.Derivative(-C / R, R)), doprint(sp.Subs(C / R, R, R * V))
('\\frac{\\partial}{\\partial R} \\left(- \\frac{C}{R}\\right)', '\\left. \\frac{C}{R} \\right|_{R \\to R V}')
>>> t, u = sp.Symbol("t", real=True), sp.Function("u")
>>> doprint(W * u(t) + C * u(t).diff(t)), doprint(sp.Derivative(delta, t))
('W u + C \\dot{u}', '\\dot{\\delta}')
>>> doprint(C * V * (1 - C / W) / R)
'\\frac{C V}{R} \\left(1 - \\frac{C}{W}\\right)'
"""

import re
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from math import gcd
from typing import Any, NamedTuple

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.printing.latex import LatexPrinter

from .nomenclature import CONSTANTS, SEVERAL, SYMBOLS, TEX

_TALL = sp.Integral, sp.Sum, sp.Product, sp.Piecewise, sp.Limit
"""What stands beside a fraction, not in it."""
_CLOSED = sp.Symbol, sp.Indexed, AppliedUndef
_MOST_PRIMES = 3
_RATE = "s_r"
"""The growth rate of a disturbance."""
_MOST_TERMS, _MOST_CHARACTERS = 5, 160
"""Of a sum in a bracket of its own: in a longer one a line could not be broken."""
_ACCENT = re.compile(r"\\(?:bar|hat|tilde|breve|check|math[a-z]+) ?\{?")

# A function of time is printed without its argument, unless its letter alone is also that of a number.


class _Root(NamedTuple):
    """A product of powers with the same denominator of their exponents: above and below its line."""

    order: int
    power: int
    above: Sequence[sp.Expr]
    below: Sequence[sp.Expr]


def doprint(expr: sp.Expr) -> str:
    """Return the LaTeX of an expression."""
    return str(_PRINTER.doprint(expr))


def _content(terms: Sequence[sp.Expr]) -> sp.Rational:
    """Return the rational factor that a sum has in common; a fraction, where all have it."""
    numbers = [term.as_coeff_Mul()[0] for term in terms]
    if not all(number.is_Rational for number in numbers):
        return sp.S.One
    sign = -1 if all(number < 0 for number in numbers) else 1
    if all(number.is_Integer for number in numbers):
        return sp.Integer(sign * gcd(*map(int, numbers)))
    low = sp.ilcm(*(number.q for number in numbers))
    if all(term.is_number for term in terms) or all(number.q == low for number in numbers):
        return sp.Rational(sign * gcd(*(int(number * low) for number in numbers)), low)
    return sp.Integer(sign)


def _primitive(expr: sp.Expr, *, cleared: bool = False) -> tuple[sp.Rational, sp.Expr]:
    """Return the common factor of a sum and the rest; `cleared`, the rest has no fractions of numbers."""
    content = _content(expr.args)
    if cleared and content.q == 1:
        numbers = [(term / content).as_coeff_Mul()[0] for term in expr.args]
        if all(number.is_Rational for number in numbers):
            low = sp.ilcm(1, *(number.q for number in numbers))
            content *= sp.Rational(gcd(*(int(number * low) for number in numbers)), low)
    if content == 1:
        return content, expr
    return content, sp.Add(*(term / content for term in expr.args))


def _is_negative(term: sp.Expr) -> bool:
    return bool(term.as_coeff_Mul()[0].is_negative)


@lru_cache(maxsize=16384)
def _rank(factor: sp.Expr) -> tuple[Any, ...]:
    """Return the place of a factor in a product."""
    base = factor.as_base_exp()[0] if factor.is_Pow else factor
    shown = base.name if base.is_Symbol else str(base)
    if base.is_number or shown.startswith("\\"):
        return 0, not isinstance(factor, sp.NumberSymbol), str(factor)
    if isinstance(base, sp.Symbol | sp.Indexed):
        letter = _ACCENT.sub("", TEX.get(base) or sp.latex(base))
        greek = letter.startswith("\\")
        place = 1 if greek else 2 * letter[0].islower()
        return (
            1,
            place,
            "k~" if letter == "n" else letter.replace(r"\var", "\\"),
        )  # l n looks like ln
    open_ended = isinstance(base, sp.Function) and not isinstance(base, (sp.Abs, sp.Max, sp.Min))
    kinds = (
        (isinstance(base, sp.Add), 4), (isinstance(factor, sp.exp), 6), (isinstance(base, _TALL), 7),
        (open_ended, 9),
    )  # fmt: skip
    return next((place for found, place in kinds if found), 5), shown, 0


class Printer(LatexPrinter):
    """SymPy's own, in the order of a hand."""

    _small = ""
    """Where what is printed is small: in a "fraction", or in a "script". There a line is a slash."""

    def __init__(self, settings: dict[str, Any]) -> None:
        super().__init__(settings)
        self._known: dict[tuple[str, str, sp.Expr], str] = {}
        """What was printed: a part is asked for again to see how long it is, or how tall."""

    def _once(self, way: str, expr: sp.Expr, show: Callable[[Any], Any]) -> str:
        key = way, self._small, expr
        if key not in self._known:
            self._known[key] = str(show(expr))
        return self._known[key]

    def _print(self, expr: Any, **kwargs: Any) -> str:
        show = super()._print
        if kwargs or not isinstance(expr, sp.Basic):
            return str(show(expr, **kwargs))
        return self._once("whole", expr, show)

    def _within(self, place: str, expr: Any, show: Callable[[Any], Any]) -> str:
        before, self._small = self._small, place
        try:
            return str(show(expr))
        finally:
            self._small = before

    def _print_Add(self, expr: sp.Add, order: Any = None) -> str:  # noqa: N802
        content, rest = _primitive(expr)
        short = len(expr.args) <= _MOST_TERMS and len(self._sum(rest)) <= _MOST_CHARACTERS
        if abs(content) != 1 and short:
            return self._product(content, [rest])
        return self._sum(expr)

    def _sum(self, expr: sp.Add) -> str:
        return self._once("sum", expr, self._summed)

    def _summed(self, expr: sp.Add) -> str:
        terms = self._ordered(expr)
        shown = [self._term(terms[0])]
        for term in terms[1:]:
            text = self._term(term)
            shown.append(f"- {text[1:].strip()}" if text.startswith("-") else f"+ {text}")
        return " ".join(shown)

    def _term(self, term: sp.Expr) -> str:
        text = str(self._print(term))
        return rf"\left({text}\right)" if term.is_Add or term.is_Relational else text

    def _ordered(self, expr: sp.Add) -> list[sp.Expr]:
        """Return the terms: powers of one letter fall, what has two terms begins with the number."""
        terms = list(self._as_ordered_terms(expr))
        numbers = [term for term in terms if term.is_Rational]
        letters = expr.free_symbols
        rising = len(terms) == 2 or (len(letters) == 1 and _is_negative(terms[0]))
        if rising and numbers and expr.is_polynomial(*letters) and len(letters) == 1:
            terms.reverse()
        elif numbers:
            others = [term for term in terms if term not in numbers]
            leads = not _is_negative(numbers[0]) and len(letters) > 1
            leads = leads or len(terms) == 2 or _is_negative(terms[0])
            falls = len(letters) > 1 and _is_negative(numbers[0])
            terms = [*numbers, *others] if leads else [*others, *numbers] if falls else terms
        if len(terms) == 2 and _is_rate(terms[0]) and not _is_rate(terms[1]):
            terms.reverse()
        growth = next((each for each in letters if str(each) == _RATE), None)
        powers = {term: term.as_coeff_exponent(growth)[1] for term in terms if growth}
        if {*powers.values()} in ({0, 2}, {0, 1, 2}) and len(letters) > 2:  # a characteristic one
            terms.sort(key=lambda term: (-powers[term], _is_negative(term)))
        first = next((term for term in terms if not _is_negative(term)), terms[0])
        return [first, *(term for term in terms if term is not first)]

    def _print_Mul(self, expr: sp.Mul) -> str:  # noqa: N802
        if not expr.is_commutative or any(isinstance(each, sp.MatrixBase) for each in expr.args):
            return str(super()._print_Mul(expr))
        numbers = [each for each in expr.args if each.is_Rational]
        return self._product(sp.Mul(*numbers), [each for each in expr.args if not each.is_Rational])

    def _print_Pow(self, expr: sp.Pow) -> str:  # noqa: N802
        base, exponent = expr.args
        common = base.is_Add and exponent.is_Integer and _content(base.args) != 1
        if exponent.is_Rational and (exponent.is_negative or common):
            return self._product(sp.S.One, [expr])
        return self._power(base, exponent)

    def _power(self, base: sp.Expr, exponent: sp.Expr) -> str:
        if exponent == 1:
            return str(self._print(base))
        if exponent.is_Rational and exponent.p == 1:
            return self._root(_Root(exponent.q, 1, [base], []))
        if base.is_Function and not isinstance(base, AppliedUndef):
            return str(super()._print_Pow(sp.Pow(base, exponent, evaluate=False)))
        shown = str(self._print(base))
        called = isinstance(base, AppliedUndef | sp.Derivative) and shown.endswith(")")
        called = called and not _is_operator(shown)
        closed = (
            called
            or (isinstance(base, _CLOSED) and "^" not in shown and "'" not in shown)
            or (base.is_Integer and base.is_nonnegative)
            or isinstance(base, sp.NumberSymbol)
            or (shown.startswith(r"\dot") and base.is_Derivative)
        )
        text = (
            f"{exponent.p}/{exponent.q}"
            if exponent.is_Rational and exponent.q > 1
            else self._within("script", exponent, self._print)
        )
        return f"{shown if closed else self._bracket(shown)}^{{{text}}}"

    def _bracket(self, shown: str) -> str:
        if self._small == "script":
            return f"({shown})"
        return rf"\left({shown}\right)"

    def _product(self, number: sp.Rational, factors: Iterable[sp.Expr]) -> str:
        """Print a product: sign, fraction, and what stands beside it."""
        number, named, factors = _named(number, _gathered(factors))
        number, above, below, roots = self._parted(number, factors)
        above += [each for each in named if each.as_base_exp()[1] > 0]
        below += [1 / each for each in named if each.as_base_exp()[1] < 0]
        beside: list[str] = []
        upper: list[sp.Expr | _Root] = [*above]
        lower: list[sp.Expr | _Root] = [*below]
        for root in roots:
            if root.above and root.below:
                beside.append(self._root(root))
            elif root.above:
                upper.append(root)
            else:
                lower.append(root._replace(above=root.below, below=()))
        sign = "- " if number < 0 else ""
        top, bottom = abs(number.p), number.q
        small = self._small and (lower or bottom > 1)
        if small and (self._small == "script" or not any(map(_is_sum, (*upper, *lower)))):
            return sign + self._slashed(top, upper, bottom, lower, beside)
        if lower or bottom > 1:
            open_above = not any(map(_is_sum, lower))
            sums = not lower and (top, len(upper)) != (1, 1)  # 3/4 (a + b), but (a + b)/2
            ratio = any(isinstance(each, sp.Derivative) for each in lower)  # of two slopes
            place = "" if open_above and not ratio else "fraction"
            tall = [
                each
                for each in upper
                if self._within(place, each, self._is_tall) == "True" or (sums and _is_sum(each))
            ]
            upper = [each for each in upper if each not in tall]
            ranked = sorted(tall, key=self._place)
            beside += self._apart([self._factor(each, alone=False) for each in ranked])
        if (
            sign
            and top == 1
            and len(upper) == 1
            and _is_sum(upper[0])
            and not (lower or bottom > 1)
        ):
            return sign + self._factor(upper[0], alone=False)
        if lower or bottom > 1:
            over, under = (
                self._within("fraction", each, lambda part: self._line(*part))
                for each in ((top, upper), (bottom, lower))
            )
            line = rf"\frac{{{over or '1'}}}{{{under}}}"
        else:
            line = self._line(top, upper)
        return sign + (" ".join(part for part in (line, *beside) if part) or "1")

    def _slashed(
        self, top: int, upper: list[Any], bottom: int, lower: list[Any], beside: list[str]
    ) -> str:
        """Print a fraction on one line, with what stands beside it above."""
        above = " ".join(part for part in (self._line(top, upper), *beside) if part)
        alone = len(upper) == 1 and top == 1 and not beside and _is_sum(upper[0])
        below = self._line(bottom, lower)
        single = len(lower) + (bottom > 1) == 1 and not (
            lower and getattr(lower[0], "is_Add", False)
        )
        return f"{self._bracket(above) if alone else above or 1}/{below if single else self._bracket(below)}"

    def _line(self, number: int, factors: list[Any]) -> str:
        """Print a number and factors side by side."""
        ranked = sorted(factors, key=self._place)
        alone = len(ranked) == 1 and number == 1
        shown = self._apart([self._factor(each, alone=alone) for each in ranked])
        digits = [] if number == 1 and shown else [str(number)]
        if digits and shown and shown[0][0].isdigit():
            digits.append(r"\cdot")
        return " ".join([*digits, *shown]) if (shown or number != 1) else ""

    def _apart(self, shown: list[str]) -> list[str]:
        """Put a derivative in brackets where another factor follows it."""
        return [self._bracket(each) if _is_operator(each) else each for each in shown[:-1]] + shown[
            -1:
        ]

    def _place(self, factor: sp.Expr | _Root) -> tuple[Any, ...]:
        """Return the place in a product: a bracket that a function would take in comes before it."""
        if not isinstance(factor, _Root):
            base = factor.as_base_exp()[0]
            if not isinstance(base, AppliedUndef | sp.Derivative):
                return _rank(factor)
            shown, call = str(self._print(factor)), getattr(base, "expr", base)
            place = 8 if _is_operator(shown) else 2 if ")" in shown[-5:] else 4.5
            return place, str(call), base.is_Derivative
        plain = all(each.is_number for each in factor.above)
        return (0, True, str(factor)) if plain else (3, factor.order, str(factor))

    def _factor(self, factor: sp.Expr | _Root, *, alone: bool) -> str:
        if isinstance(factor, _Root):
            return self._root(factor)
        shown = self._sum(factor) if factor.is_Add else str(self._print(factor))
        loose = factor.is_Add or isinstance(factor, sp.Piecewise | sp.Mul | sp.Rel)
        loose = loose or (factor.is_Derivative and shown.startswith(r"\mathrm"))
        return self._bracket(shown) if loose and not alone else shown

    def _is_tall(self, factor: sp.Expr | _Root) -> bool:
        if isinstance(factor, _Root):
            return False
        base = factor.as_base_exp()[0]
        if isinstance(factor, sp.Derivative | sp.Subs):
            shown = str(self._print(factor))
            return r"\frac" in shown or r"\right|" in shown
        return isinstance(factor, _TALL) or (
            base.is_Add and any(mark in self._sum(base) for mark in (r"\frac", r"\int"))
        )

    def _parted(
        self, number: sp.Rational, factors: Iterable[sp.Expr]
    ) -> tuple[sp.Rational, list[sp.Expr], list[sp.Expr], list[_Root]]:
        """Return the number, what stands above and below the line, and the roots."""
        above, below = [], []
        line = any(each.is_Pow and each.exp.is_Rational and each.exp < 0 for each in factors)
        rooted: dict[tuple[int, int], list[tuple[sp.Expr, sp.Rational]]] = {}
        for factor in factors:
            base, exponent = factor.args if factor.is_Pow else (factor, sp.S.One)
            if base.is_Add and exponent.is_Integer:
                content, base = _primitive(base, cleared=line)
                number *= content**exponent
            if exponent.is_Rational and not exponent.is_Integer and base.is_nonnegative:
                key = (exponent.q, 0) if abs(exponent) < 1 else (exponent.q, abs(exponent.p))
                rooted.setdefault(key, []).append((base, exponent))
            elif exponent.is_Rational and exponent.is_negative:
                below.append(sp.Pow(base, -exponent, evaluate=False) if exponent != -1 else base)
            else:
                above.append(base if exponent == 1 else sp.Pow(base, exponent, evaluate=False))
        roots = []
        for (order, power), members in rooted.items():
            parts = [abs(exponent.p) for _, exponent in members]
            common = power or gcd(*parts)
            number, root = self._joined(number, order, common, members)
            roots.append(root)
        return number, above, below, roots

    def _joined(
        self,
        number: sp.Rational,
        order: int,
        power: int,
        members: list[tuple[sp.Expr, sp.Rational]],
    ) -> tuple[sp.Rational, _Root]:
        """Write powers with one denominator as one root, with the number that it can take up."""
        above: list[sp.Expr] = []
        below: list[sp.Expr] = []
        for base, exponent in members:
            lone = len(members) == 1 or order > 2 or not base.is_Integer
            if not lone and exponent > 0 and number.q % base == 0:
                number *= base
                below.append(base)
            else:
                (above if exponent > 0 else below).append(base ** (abs(exponent.p) // power))
        return number, _Root(order, power, above, below)

    def _root(self, root: _Root) -> str:
        inner = (
            self._product(sp.S.One, [sp.Mul(*root.above, *(1 / each for each in root.below))])
            if root.below
            else self._line(1, _flat(root.above))
        )
        order = "" if root.order == 2 else f"[{root.order}]"
        if root.power == 1:
            return rf"\sqrt{order}{{{inner}}}"
        lone = (
            len(root.above) == 1
            and not root.below
            and isinstance(root.above[0], (*_CLOSED, sp.Integer))
        )
        shown = inner if lone and "^" not in inner else self._bracket(inner)
        return f"{shown}^{{{root.power}/{root.order}}}"

    def _print_Rational(self, expr: sp.Rational) -> str:  # noqa: N802
        return (
            f"{expr.p}/{expr.q}"
            if self._small and expr.q > 1
            else str(super()._print_Rational(expr))
        )

    def _print_UnevaluatedExpr(self, expr: sp.UnevaluatedExpr) -> str:  # noqa: N802
        return str(self._print(expr.args[0]))

    def _print_Integral(self, expr: sp.Integral) -> str:  # noqa: N802
        signs = "".join(
            rf"\int_{{{low}}}^{{{high}}} "
            for low, high in (
                [self._within("script", end, self._print) for end in limit[1:]]
                for limit in expr.limits[::-1]
            )
        )
        inner = str(self._print(expr.function))
        loose = expr.function.is_Add or inner.startswith("-")
        places = "".join(rf"\, d{self._print(limit[0])}" for limit in expr.limits)
        return f"{signs}{self._bracket(inner) if loose else inner}{places}"

    def _print_exp(self, expr: sp.exp, exp: Any = None) -> str:
        inner = self._print(expr.args[0])
        if self._small or r"\frac" not in inner:
            shown = f"e^{{{self._within('script', expr.args[0], self._print)}}}"
        else:
            shown = rf"\exp\left({inner}\right)"
        return shown if exp is None else rf"{self._bracket(shown)}^{{{exp}}}"

    _print_ExpBase = _print_exp  # noqa: N815

    def _print_Function(self, expr: sp.Function, exp: Any = None) -> str:  # noqa: N802
        if not isinstance(expr, AppliedUndef):
            return self._applied(super()._print_Function(expr, exp), expr)
        called = self._called(expr)
        return called if exp is None else rf"{self._bracket(called)}^{{{exp}}}"

    def _print_log(self, expr: sp.log, exp: Any = None) -> str:
        return self._applied(super()._print_log(expr, exp), expr)

    def _applied(self, shown: str, call: sp.Function) -> str:
        """Print the argument of a known function, without brackets where it is one letter."""
        name, _, inner = shown.partition(r"{\left(")
        if not inner or len(call.args) != 1:
            return shown
        inner = inner.removesuffix(r" \right)}")
        return f"{name} {inner}" if call.args[0].is_Symbol else name + self._bracket(inner)

    def _hprint_Function(self, func: str) -> str:  # noqa: N802
        plain = func in {"expm1", "log1p"}  # no index
        return rf"\operatorname{{{func}}}" if plain else str(super()._hprint_Function(func))

    def _called(self, call: AppliedUndef, order: int = 0) -> str:
        """Print a function at its place, with a dot for each derivative to time, else a prime."""
        name = self._print(sp.Symbol(call.func.__name__))
        running = all(each.is_Symbol for each in call.args) and str(call.args[-1]) in {"t", "s"}
        if running and name + "'" * order not in SYMBOLS and (order or len(call.args) == 1):
            inner = ""
        else:
            inner = f"({', '.join(map(self._print, call.args))})"
            inner = self._bracket(inner[1:-1]) if r"\frac" in inner or r"\left" in inner else inner
        if order and str(call.args[-1]) == "t" and order <= 2:
            return _dotted(name, order) + inner
        return name + "'" * order + inner

    def _print_Derivative(self, expr: sp.Derivative) -> str:  # noqa: N802
        call = expr.expr
        plain = _has_primes(call) and len(expr.variable_count) == 1
        if plain and call.args[-1] == expr.variables[0] and len(expr.variables) <= _MOST_PRIMES:
            return self._called(call, len(expr.variables))
        if call.is_Symbol and len(expr.variable_count) == 1:
            ((variable, order),) = expr.variable_count
            if str(variable) == "t" and order in (1, 2):
                return _dotted(self._print(call), order)
            power = "" if order == 1 else f"^{{{order}}}"
            sign = r"\partial" if call in SEVERAL else r"\mathrm{d}"
            below = rf"{sign} {self._print(variable)}{power}"
            if self._small:
                return rf"{sign}{power} {self._print(call)}/{below}"
            return rf"\frac{{{sign}{power} {self._print(call)}}}{{{below}}}"
        shown, inner = str(super()._print_Derivative(expr)), str(self._print(call))
        if inner.startswith("-") and shown.endswith(inner):
            shown = shown.removesuffix(inner) + self._bracket(inner)
        return shown

    def _print_Subs(self, node: sp.Subs) -> str:  # noqa: N802
        inner, place = node.expr, dict(zip(node.variables, node.point, strict=True))
        if isinstance(inner, AppliedUndef) and inner.args == node.variables:
            return self._called(inner.func(*node.point))
        if isinstance(inner, sp.Derivative) and _has_primes(inner.expr):
            call, letters = inner.expr, set(inner.variables)
            if letters == {call.args[-1]} == set(place) and len(inner.variables) <= _MOST_PRIMES:
                return (
                    self._called(call.func(*call.args[:-1], node.point[0]), len(inner.variables))
                    if str(call.args[-1]) != "t"
                    else self._valued(node)
                )
        return self._valued(node)

    def _valued(self, node: sp.Subs) -> str:
        inner = str(self._print(node.expr))
        loose = any(part.is_Add for part in sp.Mul.make_args(node.expr)) or inner.startswith("- ")
        places = ", ".join(
            f"{self._print(letter)} {sign} {self._within('script', at, self._print)}"
            for letter, at in zip(node.variables, node.point, strict=True)
            for sign in ["=" if not at.has(letter) else r"\to"]
        )
        return rf"\left. {self._bracket(inner) if loose else inner} \right|_{{{places}}}"


def _dotted(name: str, order: int) -> str:
    letter, script, rest = name.partition("_")
    return rf"\{'d' * order}ot{{{letter}}}{script}{rest}"


def _is_rate(term: sp.Expr) -> bool:
    """Tell whether a term is a velocity times something: a damper, which stands after its spring."""
    rates = (each for each in term.atoms(sp.Derivative) if str(each.variables[0]) == "t")
    return not term.is_Derivative and any(len(each.variables) == 1 for each in rates)


def _has_primes(call: sp.Expr) -> bool:
    """Tell whether primes or dots say to what a function is differentiated: its argument, or time."""
    return isinstance(call, AppliedUndef) and (
        len(call.args) == 1 or str(call.args[-1]) in {"t", "s"}
    )


def _is_operator(shown: str) -> bool:
    """Tell whether a derivative is printed that applies to all that follows it."""
    return re.match(r"\\frac\{(?:d|\\partial)(?:\^\{\d+\})?\}", shown) is not None


def _is_sum(factor: sp.Expr | _Root) -> bool:
    return not isinstance(factor, _Root) and bool(factor.as_base_exp()[0].is_Add)


def _named(
    number: sp.Rational, factors: list[sp.Expr]
) -> tuple[sp.Rational, list[sp.Expr], list[sp.Expr]]:
    """Find a constant with a letter of its own in the number of a product."""
    surds = [each for each in factors if each.is_Pow and each.is_number and each.base.is_Rational]
    value = number * sp.Mul(*surds)
    for letter, constant in CONSTANTS.items() if surds else ():
        for power in (sp.S.One, sp.Rational(2, 3), sp.S.NegativeOne):
            known = constant**power
            ratio, low = value / known, known.as_coeff_Mul()[0].q
            whole = ratio.is_Integer or (ratio.is_Rational and power > 0)
            if whole and value.as_coeff_Mul()[0].q % low == 0:
                rest = [each for each in factors if each not in surds]
                return ratio, [sp.Symbol(letter, positive=True) ** power], rest
    return number, [], factors


def _gathered(factors: Iterable[sp.Expr]) -> list[sp.Expr]:
    """Write the powers of one letter as one power, where an exponent is no number."""
    found: dict[sp.Expr, list[sp.Expr]] = {}
    for factor in factors:
        base, exponent = factor.as_base_exp() if factor.is_Pow else (factor, sp.S.One)
        found.setdefault(base, []).append(exponent)
    parts: list[sp.Expr] = []
    for base, exponents in found.items():
        symbolic = len(exponents) > 1 and not all(each.is_number for each in exponents)
        for each in [sp.Add(*exponents)] if symbolic else exponents:
            parts.append(base if each == 1 else sp.Pow(base, each, evaluate=False))
    return parts


def _flat(factors: Iterable[sp.Expr]) -> list[sp.Expr]:
    """Return the factors of factors, numbers apart."""
    return [part for each in factors for part in sp.Mul.make_args(each)]


_PRINTER = Printer(
    {"symbol_names": TEX, "fold_frac_powers": True, "inv_trig_style": "full", "ln_notation": True}
)
