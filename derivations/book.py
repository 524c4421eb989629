"""The book of a proof: what it has defined, recalled and established, and what it ends in."""

from collections.abc import Callable
from functools import wraps
from inspect import signature
from typing import Any, ParamSpec, TypedDict, TypeVar, Unpack, cast

import sympy as sp

from derivations.algebra import difference
from derivations.record import STATUSES, Claim, Derivation, Step, Table
from derivations.symbols import TEX

_P = ParamSpec("_P")
_Value = TypeVar("_Value")

_finished: dict[str, "Book"] = {}
"""The finished proofs by label, for `Book.recall`."""


class StepError(ValueError):
    """A step that is wrong, or that the engine cannot show to be right."""


class Shown(TypedDict, total=False):
    """LaTeX that replaces SymPy's own for a side of a step."""

    left: str
    right: str


def asked(check: Callable[_P, _Value]) -> Callable[_P, _Value]:
    """Let a check keep what it was asked with the step that it records."""
    form = signature(check)

    @wraps(check)
    def run(*args: _P.args, **kwargs: _P.kwargs) -> _Value:
        given = form.bind(*args, **kwargs).arguments
        book = cast("Book", given.pop("self"))
        words = {"reason", "shown"}
        arguments = {name: value for name, value in given.items() if name not in words}
        book._asked = check.__name__, arguments, dict(book._rules)
        return check(*args, **kwargs)

    return run


def tex(expr: sp.Expr) -> str:
    """Print an expression in the notation of the paper."""
    return str(sp.latex(expr, symbol_names=TEX, fold_frac_powers=True))


def established(label: str, lhs: sp.Expr) -> sp.Expr:
    """Return the last form of `lhs` that the derivation with this label has established exactly."""
    forms = [right for left, right in _source(label)._exact if left == lhs]
    if not forms:
        raise StepError(f"{label} does not establish {lhs}")
    return forms[-1]


def _source(label: str) -> "Book":
    if label not in _finished:
        raise StepError(f"{label} has not been derived yet")
    return _finished[label]


class Book:
    """Definitions, relations of other proofs, and the steps made so far; `step.Proof` checks them.

    What is defined or recalled is a rule: later steps are checked with its left side replaced by
    its right side, until no left side is left.
    """

    def __init__(
        self,
        label: str,
        equation: int | None,
        *,
        section: str,
        title: str,
        text: str = "",
        uses: tuple[str, ...] = (),
    ) -> None:
        self.label, self.equation = label, equation
        self._section, self._title, self._text = section, title, text
        self._uses, self._declared = list(uses), uses
        self._rules: dict[sp.Expr, sp.Expr] = {}
        self._steps: list[Step] = []
        self._needed: set[sp.Expr] = set()
        self._known: dict[tuple[sp.Expr, sp.Expr], Step] = {}
        self._exact: dict[tuple[sp.Expr, sp.Expr], Step] = {}
        self._asked: tuple[str, dict[str, Any], dict[sp.Expr, sp.Expr]] = ("", {}, {})

    @asked
    def define(self, lhs: sp.Expr, rhs: sp.Expr, reason: str = "", **shown: Unpack[Shown]) -> None:
        """Let the left side stand for the right side."""
        self._rule(lhs, rhs)
        self._record(lhs, "=", rhs, reason, "definition", shown)

    @asked
    def recall(self, label: str, lhs: sp.Expr, rhs: sp.Expr, reason: str = "") -> None:
        """Use a relation that the derivation with this label has established."""
        source = _source(label)
        step = source._exact.get((sp.sympify(lhs), sp.sympify(rhs)))
        if step is None:
            raise StepError(f"{self.label}: {label} does not establish {lhs} = {rhs}")
        self._rule(lhs, rhs)
        if label not in self._uses:
            self._uses.append(label)
        shown: Shown = {"left": step.left, "right": step.right}
        self._record(lhs, "=", rhs, reason, step.status, shown, source=label)

    def done(self, lhs: sp.Expr, rhs: sp.Expr | int, *, table: Table | None = None) -> Derivation:
        """End the proof with a relation that one of its steps established."""
        result = self._known.get((sp.sympify(lhs), sp.sympify(rhs)))
        if result is None:
            raise StepError(f"{self.label}: no step established {lhs} and {rhs}")
        _finished[self.label] = self
        steps = self._stated()
        cited = {step.source for step in steps} | set(self._declared)
        return Derivation(
            label=self.label,
            equation=self.equation,
            section=self._section,
            title=self._title,
            text=self._text,
            latex=result.latex,
            status=max((step.status for step in steps), key=STATUSES.index),
            steps=steps,
            uses=tuple(label for label in self._uses if label in cited),
            table=table,
        )

    def _stated(self) -> tuple[Step, ...]:
        """Return the steps without the premises of which no check made use."""
        needed, before = set(self._needed), -1
        while len(needed) > before:
            before = len(needed)
            forms = [rhs for lhs, rhs in self._rules.items() if lhs in needed]
            needed |= {lhs for lhs in self._rules if any(form.has(lhs) for form in forms)}
        asked = [
            sp.sympify(argument)
            for step in self._steps
            if step.claim and not step.source
            for argument in step.claim.arguments.values()
            if isinstance(argument, sp.Basic)
        ]

        def used(claim: Claim) -> bool:
            return claim.lhs in needed or any(form.has(claim.rhs) for form in asked)

        return tuple(
            step
            for step in self._steps
            if not step.source or step.claim is None or used(step.claim)
        )

    def _rule(self, lhs: sp.Expr, rhs: sp.Expr) -> None:
        if lhs in self._rules:
            raise StepError(f"{self.label}: {lhs} is defined twice")
        if self._resolve(rhs).has(lhs):
            raise StepError(f"{self.label}: the definition {lhs} = {rhs} is circular")
        self._rules[lhs] = sp.sympify(rhs)

    def _resolve(self, expr: sp.Expr | int) -> sp.Expr:
        """Replace all that was defined or recalled, and carry out the derivatives."""
        before, after = None, sp.sympify(expr)
        while after != before:
            self._needed |= {lhs for lhs in self._rules if after.has(lhs)}
            before, after = after, after.subs(self._rules).doit(integrals=False)
        return after

    def _vanish(self, lhs: sp.Expr, rhs: sp.Expr, claim: str) -> None:
        rest = difference(lhs, rhs)
        if rest != 0:
            raise StepError(f"{self.label}: {claim} is not an identity: left - right = {rest}")

    def _record(
        self,
        lhs: sp.Expr,
        relation: str,
        rhs: sp.Expr,
        reason: str,
        status: str,
        shown: Shown,
        *,
        exact: bool = True,
        source: str = "",
    ) -> None:
        """Keep a step; an exact one is an equality that later proofs may use as a rule."""
        left, right = shown.get("left", tex(lhs)), shown.get("right", tex(rhs))
        key = sp.sympify(lhs), sp.sympify(rhs)
        check, arguments, rules = self._asked
        claim = Claim(check, *key, arguments, rules)
        step = Step(left, relation, right, reason, status, source, claim)
        self._steps.append(step)
        self._known[key] = step
        if exact:
            self._exact[key] = step
