"""The claims of a derivation as plain JSON, from which another program can check them again.

An expression is a nested list, its operation first: `["+", "x", ["*", "2", "y"]]`. A string is a rational
number if it starts with a digit or a minus sign, else the name of a symbol.
"""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef, UndefinedFunction
from sympy.core.relational import Relational

from ..engine.record import Claim, Derivation

Tree = str | list[Any]

KINDS = {
    "define": "definition",
    "recall": "recalled",
    "asymptote": "leading term",
    "where": "condition",
    "equal": "equality",
    "holds": "inequality",
    "sign": "inequality",
    "unique_root": "unique root",
    "leading_order": "limit",
    "greatest": "maximum",
    "equivalent": "equivalence",
}
"""The kinds of claims by the checks that prove them; others keep the name of their check."""

_TWO_SIDED = {
    *("define", "recall", "asymptote", "equal", "holds", "sign", "integral", "equivalent"),
}
_NAMES = {"expr": "expression", "eps": "small"}
_OMITTED = {"lhs", "rhs", "label", "short"}
_FACTS = ("positive", "negative", "nonnegative", "nonpositive", "nonzero", "integer", "real")
_OPERATIONS: dict[type, str] = {
    sp.Add: "+", sp.Mul: "*", sp.Pow: "^", sp.And: "and", sp.Or: "or",
    sp.Eq: "=", sp.Ne: "!=",
    sp.StrictLessThan: "<", sp.LessThan: "<=", sp.StrictGreaterThan: ">", sp.GreaterThan: ">=",
}  # fmt: skip
_CONSTANTS = {
    sp.pi: "pi", sp.E: "e", sp.oo: "infinity", sp.I: "i", sp.true: "true", sp.false: "false",
}  # fmt: skip


class Names:
    """The names of the symbols and functions of a document; a second one of the same name gets a prime."""

    def __init__(self) -> None:
        self._symbols: dict[Any, str] = {}
        self._functions: dict[Any, str] = {}
        self._met: set[Any] = set()

    def facts(self) -> dict[str, dict[str, list[str]]]:
        """Return what is assumed of those met since the last call, implied facts left out."""
        kinds = {"symbols": self._symbols, "functions": self._functions}
        found = {
            kind: {name: _assumed(each) for each, name in names.items() if each in self._met}
            for kind, names in kinds.items()
        }
        self._met.clear()
        return found

    def _named(self, letter: Any, stem: str, names: dict[Any, str]) -> str:
        self._met.add(letter)
        if letter not in names:
            free = (stem + "'" * count for count in range(len(names) + 1))
            names[letter] = next(name for name in free if name not in names.values())
        return names[letter]

    def tree(self, value: Any) -> Tree:
        """Return an expression as a nested list."""
        expr = sp.sympify(value)
        if expr.is_Rational:
            return str(expr)
        if isinstance(expr, sp.Symbol):
            return self._named(expr, expr.name, self._symbols)
        if isinstance(expr, sp.UnevaluatedExpr):
            return self.tree(expr.args[0])
        if expr == -sp.oo:
            return ["*", "-1", ["infinity"]]
        found = [rows(self, expr) for kind, rows in _COMPOUND.items() if isinstance(expr, kind)]
        operation = _OPERATIONS.get(expr.func, expr.func.__name__.lower())
        plain = (
            [_CONSTANTS[expr]] if expr in _CONSTANTS else [operation, *map(self.tree, expr.args)]
        )
        return found[0] if found else plain

    def call(self, expr: sp.Expr) -> list[Tree]:
        """Return a function of unknown form at a place."""
        name = self._named(expr.func, str(expr.func), self._functions)
        return ["call", name, *map(self.tree, expr.args)]

    def rows(self, rows: Iterable[Iterable[Any]]) -> list[Tree]:
        """Return tuples of expressions."""
        return [[self.tree(part) for part in row] for row in rows]

    def value(self, argument: Any) -> Any:
        """Return an argument of a check: an expression, several, or a word."""
        if isinstance(argument, Mapping):
            return [[self.tree(name), self.tree(value)] for name, value in argument.items()]
        if isinstance(argument, tuple | list):
            return [self.value(part) for part in argument]
        return argument if isinstance(argument, str | None) else self.tree(argument)


_COMPOUND: dict[type, Callable[[Names, Any], list[Tree]]] = {
    AppliedUndef: Names.call,
    sp.Derivative: lambda names, e: [
        "derivative", names.tree(e.expr), *(names.tree(part) for pair in e.variable_count for part in pair)
    ],
    sp.Integral: lambda names, e: ["integral", names.tree(e.function), *names.rows(e.limits)],
    sp.Sum: lambda names, e: ["sum", names.tree(e.function), *names.rows(e.limits)],
    sp.Subs: lambda names, e: [
        "at", names.tree(e.expr), *names.rows(zip(e.variables, e.point, strict=True))
    ],
    sp.Piecewise: lambda names, e: ["cases", *names.rows(e.args)],
    sp.MatrixBase: lambda names, e: ["matrix", *names.rows(e.tolist())],
    sp.Indexed: lambda names, e: ["indexed", str(e.base), *map(names.tree, e.indices)],
}  # fmt: skip


def _assumed(letter: Any) -> list[str]:
    known = letter._kwargs if isinstance(letter, UndefinedFunction) else letter.assumptions0
    found = [fact for fact in _FACTS if known.get(fact)]
    if {"positive", "negative"} & set(found):
        return [fact for fact in found if fact in {"positive", "negative", "integer"}]
    return found


def claims(derivation: Derivation, names: Names) -> dict[str, Any]:
    """Return the claims of a derivation, and what is assumed of their symbols and functions."""
    found = []
    rules: dict[sp.Expr, str] = {}
    for index, step in enumerate(derivation.steps):
        claim = step.claim
        if claim is None:
            continue
        label = f"{derivation.label}/{index}"
        found.append({"id": label, **_claim(claim, step.source, names, rules)})
        if claim.check in {"define", "recall", "asymptote", "integral", "root"}:
            rules[claim.lhs] = label
    return {**names.facts(), "claims": found}


def _claim(claim: Claim, source: str, names: Names, rules: Mapping[sp.Expr, str]) -> dict[str, Any]:
    arguments = {
        _NAMES.get(name, name): names.value(value)
        for name, value in claim.arguments.items()
        if name not in _OMITTED and value is not None
    }
    condition = claim.arguments.get("condition")
    if isinstance(condition, Relational):
        arguments = {"condition": names.tree(condition)}
    elif claim.check in _TWO_SIDED:
        arguments = {"left": names.tree(claim.lhs), "right": names.tree(claim.rhs), **arguments}
        arguments.setdefault("relation", ">=" if claim.check == "equivalent" else "=")
    ends = [pair for name, low, high in claim.intervals for pair in ((low, name), (name, high))]
    pairs = [*((sp.S.Zero, gap) for gap in claim.positive if not gap.is_positive), *ends]
    domain = [
        ["<", names.tree(low), names.tree(high)] for low, high in pairs if sp.oo not in (-low, high)
    ]
    premises = [label for lhs, label in rules.items() if lhs in claim.rules]
    cited = {"source": source} if source else {}
    return {
        "kind": KINDS.get(claim.check, claim.check),
        **arguments,
        **cited,
        "premises": premises,
        "domain": domain,
    }
