r"""Read printed mathematics back: it must be the expression that was printed.

A parser for the small subset of LaTeX in which the derivations are written: sums, products, fractions,
powers, roots, functions, derivatives, integrals and values at a point. Anything else is refused.

>>> x, l_r = sp.symbols("x l_r")
>>> read(r"\frac{x^2}{2} - l_{\mathrm{r}} (1 + x)", {"x": x, r"l_{\mathrm{r}}": l_r})
-l_r*(x + 1) + x**2/2
"""

import re
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef, UndefinedFunction

Meaning = Any
"""A name stands for an expression, a function (`UndefinedFunction`), or an expression as a function of
variables (`Lambda`); under the name \\\\int for the variable and ends of an integral without ends."""


class UnreadableError(ValueError):
    """Mathematics that the parser does not know."""


_TOKEN = re.compile(r"\\[A-Za-z]+|\\.|\d+(?:\.\d+)?|\S")
_SPACING = {r"\,", r"\!", r"\;", r"\:", r"\ ", r"\left", r"\right", r"\limits", r"\displaystyle"}
_ARGUMENTS = {r"\frac", r"\sqrt", r"\dot", r"\ddot", r"\hat", r"\bar", r"\breve", r"\check"}
_FUNCTIONS = {
    r"\exp": sp.exp, r"\sin": sp.sin, r"\cos": sp.cos, r"\tan": sp.tan, r"\ln": sp.log,
    r"\arctan": sp.atan, r"\max": sp.Max, r"\min": sp.Min,
}  # fmt: skip
_OPEN, _CLOSE = {"(": ")", "[": "]", "{": "}"}, {")", "]", "}"}
_TIME = {"s", "t", "zeta", "sigma"}
"""The names of variables that a prime or a dot may stand for."""


def read(latex: str, names: Mapping[str, Meaning]) -> sp.Expr:
    """Return the expression of one side of a relation."""
    return _Reader(latex, names).whole()


def names_in(*expressions: sp.Expr, tex_of: Mapping[sp.Expr, str]) -> dict[str, Meaning]:
    """Return how the symbols and functions of expressions are displayed."""
    found: dict[str, Meaning] = {}
    for expr in expressions:
        symbols, calls = _named_in(expr)
        for symbol in symbols:
            found[tex_of.get(symbol) or sp.latex(symbol)] = symbol
        for name, call in calls:
            if name not in found or _is_current(call):
                found[name] = call
    return found


@lru_cache(maxsize=8192)
def _named_in(expr: sp.Expr) -> tuple[frozenset[sp.Expr], tuple[tuple[str, sp.Expr], ...]]:
    """Return the symbols, and the calls of functions with their names."""
    bound = {name for node in expr.atoms(sp.Integral, sp.Subs) for name in node.variables}
    calls = expr.atoms(AppliedUndef)
    names = tuple((sp.latex(sp.Symbol(call.func.__name__)), call) for call in calls)
    return frozenset(expr.free_symbols | bound), names


def _is_current(call: AppliedUndef) -> bool:
    """Tell whether a function is taken at the running time or place, as its bare name says."""
    return all(argument.is_Symbol for argument in call.args) and str(call.args[-1]) in {"s", "t"}


def _tokens(latex: str) -> list[str]:
    r"""Split into tokens, with braces about every script and every argument.

    >>> _tokens(r"\dot u_i")
    ['\\dot', '{', 'u', '}', '_', '{', 'i', '}']
    """
    upright = re.sub(r"\\mathrm\{([^{}]*)\}", r"\1 ", latex)
    raw = [token for token in _TOKEN.findall(upright) if token not in _SPACING]
    found: list[str] = []
    waiting = 0
    for index, token in enumerate(raw):
        opened = index and raw[index - 1] in "_^"
        option = waiting and "[" in raw[index - 1 : index + 1]  # of a root: its order
        if (waiting or opened) and not option and token not in "{]":
            if token[:1].isdigit() and len(token) > 1:
                raise UnreadableError(
                    f"{token} needs braces in {latex}: LaTeX takes its first digit alone"
                )
            found += ["{", token, "}"]
            waiting -= bool(waiting)
            continue
        if waiting and token == "{":
            waiting -= 1
        found.append(token)
        waiting = max(waiting, 0)
        if token in _ARGUMENTS:
            waiting = 1
    return found


_COMMANDS = {
    r"\frac": "_fraction", r"\int": "_integral", r"\sqrt": "_root", r"\dot": "_dotted",
    r"\ddot": "_dotted", "{": "_braced", ".": "_value_at",
}  # fmt: skip
"""What reads the mathematics that begins with a token."""


class _Reader:
    """A position in a list of tokens, read by recursive descent."""

    def __init__(self, latex: str, names: Mapping[str, Meaning]) -> None:
        self.latex, self.tokens, self.place = latex, _tokens(latex), 0
        known = sorted(((_tokens(name), name) for name in names), key=lambda pair: -len(pair[0]))
        self.names = [(tokens, names[name]) for tokens, name in known if name != r"\int"]
        everywhere = names.get(r"\int")
        self.everywhere = everywhere if isinstance(everywhere, sp.Tuple) else None
        """Variable and ends of an integral that is written without them."""

    def whole(self) -> sp.Expr:
        """Read everything."""
        found = self._sum()
        if self.place < len(self.tokens):
            raise self._unknown()
        return found

    def _unknown(self) -> UnreadableError:
        rest = " ".join(self.tokens[self.place : self.place + 6])
        return UnreadableError(f"cannot read {rest!r} in {self.latex}")

    def _next(self) -> str:
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def _take(self, token: str) -> bool:
        if self._next() == token:
            self.place += 1
            return True
        return False

    def _expect(self, token: str) -> None:
        if not self._take(token):
            raise self._unknown()

    def _sum(self) -> sp.Expr:
        negative = self._take("-") or (self._take("+") and False)
        total = -self._term() if negative else self._term()
        while self._next() in ("+", "-"):
            negative = self._take("-") or not self._take("+")
            total += -self._term() if negative else self._term()
        return total

    def _term(self) -> sp.Expr:
        product, divided = self._factor(), False
        while True:
            token = self._next()
            if token in ("", "+", "-", "=", ",", "|") or token in _CLOSE or self._at_differential():
                return product
            if self._take("/"):
                product, divided = product / self._factor(), True
                continue
            if divided:
                raise UnreadableError(
                    f"what stands below the line in {self.latex} needs parentheses"
                )
            number = self.tokens[self.place - 1][:1].isdigit() and not self._take(r"\cdot")
            if number and (token[:1].isdigit() or (token == r"\frac" and self._at_number())):
                raise UnreadableError(f"two numbers side by side in {self.latex}")
            self._take(r"\cdot")
            product *= self._factor()

    def _at_number(self) -> bool:
        """Tell whether a fraction of two numbers stands here."""
        start = self.place
        fraction = self._fraction()
        self.place = start
        return bool(fraction.is_number)

    def _factor(self) -> sp.Expr:
        base = self._base()
        if self._take("^"):
            return base ** self._braced()
        return base

    def _base(self) -> sp.Expr:
        token = self._next()
        if self._named() is not None:
            return self._name()
        if token in _COMMANDS:
            return getattr(self, _COMMANDS[token])()
        if token in ("(", "["):
            return self._closed(token)
        self.place += 1
        if token[:1].isdigit():
            return sp.Rational(token)
        if token == "e" and self._take("^"):
            return sp.exp(self._braced())
        if token in _FUNCTIONS:
            return _FUNCTIONS[token](*self._arguments())
        self.place -= 1
        raise self._unknown()

    def _closed(self, opening: str) -> sp.Expr:
        self._expect(opening)
        found = self._sum()
        self._expect(_OPEN[opening])
        return found

    def _root(self) -> sp.Expr:
        self._expect(r"\sqrt")
        order = self._closed("[") if self._next() == "[" else sp.Integer(2)
        return self._braced() ** (1 / order)

    def _braced(self) -> sp.Expr:
        self._expect("{")
        found = self._sum()
        self._expect("}")
        return found

    def _arguments(self) -> list[sp.Expr]:
        """Read what a function is applied to: a list in parentheses, or the next factor."""
        power = self._braced() if self._take("^") else None
        if power is not None:
            raise self._unknown()
        braced = self._take("{")
        if not self._take("("):
            if braced:
                raise self._unknown()
            found = [self._factor()]
            if self._at_factor():
                raise UnreadableError(
                    f"what the function in {self.latex} applies to needs parentheses"
                )
            return found
        found = [self._sum()]
        while self._take(","):
            found.append(self._sum())
        self._expect(")")
        if braced:
            self._expect("}")
        return found

    def _at_factor(self) -> bool:
        """Tell whether a further factor stands here."""
        token = self._next()
        plain = token in ("", "+", "-", "=", ",", "|", "/", r"\cdot", *_CLOSE)
        return not (plain or token in _FUNCTIONS or self._at_differential())

    def _named(self) -> tuple[int, Meaning] | None:
        """Return the longest name that stands here, and how many tokens it has."""
        for tokens, meaning in self.names:
            if self.tokens[self.place : self.place + len(tokens)] == tokens:
                return len(tokens), meaning
        return None

    def _name(self) -> sp.Expr:
        found = self._named()
        if found is None:
            raise self._unknown()
        self.place += found[0]
        meaning = found[1]
        primes = 0
        while self._take("'") or self._prime():
            primes += 1
        callable_ = isinstance(meaning, (AppliedUndef, UndefinedFunction, sp.Lambda))
        given = self._arguments() if callable_ and self._at_arguments() else None
        return self._applied(meaning, given, primes)

    def _prime(self) -> bool:
        if self.tokens[self.place : self.place + 4] == ["^", "{", r"\prime", "}"]:
            self.place += 4
            return True
        return False

    def _at_arguments(self) -> bool:
        return self._next() == "(" or self.tokens[self.place : self.place + 2] == ["{", "("]

    def _applied(self, meaning: Meaning, given: list[sp.Expr] | None, primes: int) -> sp.Expr:
        """Return a function at some arguments, differentiated as often as it has primes."""
        if isinstance(meaning, sp.Lambda):
            body, variables = meaning.expr, list(meaning.variables)
            whole = sp.Derivative(body, (variables[-1], primes)) if primes else body
            return whole if given in (None, variables) else sp.Subs(whole, variables, given)
        if isinstance(meaning, UndefinedFunction):
            if given is None:
                raise self._unknown()
            call = meaning(*given)
        elif isinstance(meaning, AppliedUndef):
            call = meaning if given is None else meaning.func(*given)
        else:
            call = meaning
        if not primes:
            return call
        if not call.args or (len(call.args) > 1 and str(call.args[-1]) not in _TIME):
            raise self._unknown()
        return sp.Derivative(call, (call.args[-1], primes))

    def _dotted(self) -> sp.Expr:
        """Read what is under dots; a subscript beside them belongs to the name under them."""
        order = 2 if self._next() == r"\ddot" else 1
        self.place += 1
        self._expect("{")
        inside = self._until_closed()
        if self._take("_"):
            self._expect("{")
            inside += ["_", "{", *self._until_closed(), "}"]
        found = next((meaning for tokens, meaning in self.names if tokens == inside), None)
        if not isinstance(found, AppliedUndef):
            raise self._unknown()
        call = found.func(*self._arguments()) if self._at_arguments() else found
        return sp.Derivative(call, (call.args[-1], order))

    def _until_closed(self) -> list[str]:
        start, depth = self.place, 1
        while depth and self.place < len(self.tokens):
            depth += (self._next() == "{") - (self._next() == "}")
            self.place += 1
        return self.tokens[start : self.place - 1]

    def _fraction(self) -> sp.Expr:
        self._expect(r"\frac")
        operator = self._operator()
        if operator is not None:
            variable, order = operator
            return sp.Derivative(self._term(), (variable, order))
        start = self.place
        self._expect("{")
        if self._take("d") or self._take(r"\partial"):
            try:
                inner = self._sum()
                self._expect("}")
                self._expect("{")
                if not (self._take("d") or self._take(r"\partial")):
                    raise self._unknown()
                variable = self._name()
                self._expect("}")
            except UnreadableError:
                self.place = start
            else:
                return sp.Derivative(inner, variable)
        self.place = start
        return self._braced() / self._braced()

    def _operator(self) -> tuple[sp.Expr, int] | None:
        r"""Read \{d}{ds} or \{d^2}{ds^2} after \frac."""
        start = self.place
        for letter in ("d", r"\partial"):
            self.place = start
            if not (self._take("{") and self._take(letter)):
                continue
            order = self._braced() if self._take("^") else sp.S.One
            if not (
                self._take("}")
                and self._take("{")
                and self._take(letter)
                and self._named() is not None
            ):
                continue
            variable = self._name()
            if self._take("^") and self._braced() != order:
                raise self._unknown()
            self._expect("}")
            return variable, int(order)
        self.place = start
        return None

    def _at_differential(self) -> bool:
        """Tell whether d and a variable stand here, and end an integral."""
        if self._next() not in ("d", "{"):
            return False
        start = self.place
        self._take("{")
        letter = self._take("d")
        self._take("}")
        found = self._named() if letter else None
        self.place = start
        if found is None or not isinstance(found[1], sp.Symbol):
            return False
        after = start + (1 if self.tokens[start] == "d" else 3) + found[0]
        return after >= len(self.tokens) or self.tokens[after] in {"+", "-", "=", ",", *_CLOSE}

    def _integral(self) -> sp.Expr:
        self._expect(r"\int")
        limits = []
        for mark in ("_", "^"):
            if self._take(mark):
                limits.append(self._limit())
        if not limits and self.everywhere is None:
            raise UnreadableError(f"an integral without ends in {self.latex}")
        integrand = self._sum()
        if not self._at_differential():
            raise self._unknown()
        self._take("{")
        self._expect("d")
        self._take("}")
        variable = self._name()
        if limits:
            return sp.Integral(integrand, (variable, *limits))
        if self.everywhere is None or variable != self.everywhere[0]:
            raise self._unknown()
        return sp.Integral(integrand, self.everywhere)

    def _limit(self) -> sp.Expr:
        if self.tokens[self.place : self.place + 3] == ["{", r"\infty", "}"]:
            self.place += 3
            return sp.oo
        return self._braced()

    def _value_at(self) -> sp.Expr:
        r"""Read \left. f \right|_{x = a}."""
        self._expect(".")
        inner = self._sum()
        self._expect("|")
        self._expect("_")
        self._expect("{")
        variable = self._name()
        self._expect(r"\to" if self._next() == r"\to" else "=")
        value = self._sum()
        self._expect("}")
        return sp.Subs(inner, variable, value)
