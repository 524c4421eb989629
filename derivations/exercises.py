"""Exercises: the check of a step of a derivation that a student enters.

A step is right if the engine (`step.Proof`) proves it, and wrong if it fails at a random admissible point
(`render.recheck`); else it is not decided.

>>> from .symbols import a, l_r, x, x_te
>>> exercise = Exercise("edge")
>>> check = exercise.ask(
...     "root", "value", of=[a, l_r], hint="complete the square.",
...     expr=a**2 - 2 * l_r * x - x**2, variable=x, over=(x, -a, sp.oo), name=x_te,
... )
>>> check(sp.sqrt(a**2 + l_r**2) - l_r)
Right: proved.
>>> check(sp.sqrt(a**2 + l_r**2))
Wrong: it does not hold.
Hint: complete the square.
>>> check(x_te)
Not decidable: write it without x_TE; use only a, l_r.
Hint: complete the square.
"""  # fmt: skip

import inspect
import io
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef

from .engine.book import StepError
from .engine.step import Proof
from .render.recheck import Steps

_UNEVALUATED = (sp.Integral, sp.Derivative, sp.Limit, sp.Subs, sp.Sum, sp.nan, sp.zoo)


class Exercise:
    """What is given so far; `ask` makes the check of a step."""

    def __init__(self, label: str) -> None:
        self.label = label
        self._known: dict[sp.Expr, sp.Expr | None] = {}

    def given(self, lhs: sp.Expr, rhs: sp.Expr) -> None:
        """Let later steps use an equation."""
        self._known[sp.sympify(lhs)] = sp.sympify(rhs)

    def where(self, condition: sp.Expr) -> None:
        """Let an inequality hold in later steps."""
        self._known[condition] = None

    def ask(
        self, check: str, hole: str, *, of: Sequence[sp.Expr], hint: str, **arguments: Any
    ) -> Callable[[Any], None]:
        """Return a function that prints whether an answer is right, wrong or not decidable.

        `check` is one of the engine, such as "equal", "integral", "root" or "leading_order"; `hole` is the
        argument that the student enters, `arguments` are the others. An answer may contain only the symbols,
        and values of functions, in `of`. The hint is printed unless the answer is right.
        """
        known = dict(self._known)

        def judge(answer: Any) -> None:
            verdict = _unfit(answer, of)
            if not verdict:
                proof, steps = Proof(self.label, None, section="", title=""), Steps(self.label)
                for lhs, rhs in known.items():
                    if rhs is None:
                        proof.where(lhs)
                    else:
                        proof.define(lhs, rhs)
                        steps.given(lhs, rhs)
                verdict = _verdict(proof, steps, check, {**arguments, hole: answer})
            print(verdict if verdict.startswith("Right") else f"{verdict}\nHint: {hint}")

        return judge


def _verdict(proof: Proof, steps: Steps, check: str, arguments: dict[str, Any]) -> str:
    """Prove a step, or refute it at a point where the conditions of the proof hold."""
    try:
        getattr(proof, check)(**_accepted(proof, check, arguments), reason="")
        return "Right: proved."
    except StepError:
        pass
    for gap in proof._conditions.positive:
        steps.where(gap > 0)
    try:
        with redirect_stdout(io.StringIO()):
            getattr(steps, check)(**_accepted(steps, check, arguments))
            if check == "root" and "over" in arguments:
                _, low, high = map(sp.sympify, arguments["over"])
                for one, other in ((low, arguments["value"]), (arguments["value"], high)):
                    if one.is_finite is not False and other.is_finite is not False:
                        steps.holds(one, "<", other)
    except Exception as error:
        if isinstance(error, AssertionError) and str(error).endswith("does not hold"):
            return "Wrong: it does not hold."
    return "Not decidable: neither proved nor refuted; try another form."


def _accepted(judge: Proof | Steps, check: str, arguments: dict[str, Any]) -> dict[str, Any]:
    """Return the arguments that this check takes."""
    wanted = inspect.signature(getattr(judge, check)).parameters
    return {key: value for key, value in arguments.items() if key in wanted}


def _unfit(answer: Any, of: Sequence[sp.Expr]) -> str:
    """Say why there is nothing to decide; empty if there is."""
    if answer is ...:
        return "Not decidable: put your expression in the place of the dots."
    try:
        expr = sp.sympify(answer, strict=True)
    except sp.SympifyError:
        return f"Not decidable: {answer!r} is not an expression of SymPy."
    if not isinstance(expr, sp.Expr) or expr.has(*_UNEVALUATED):
        return f"Not decidable: {expr} is not a formula; carry out integrals and derivatives."
    if expr.has(sp.Float):
        return f"Not decidable: {expr} has rounded numbers; write fractions as S(1)/3."
    if strange := ingredients(expr) - set(of):
        only = ", ".join(map(str, of)) or "numbers"
        return f"Not decidable: write it without {', '.join(sorted(map(str, strange)))}; use only {only}."
    return ""


def ingredients(expr: sp.Expr) -> set[sp.Expr]:
    """Return the symbols and the values of functions that an expression is made of."""
    calls = expr.atoms(AppliedUndef)
    return calls | expr.xreplace(dict.fromkeys(calls, sp.S.One)).free_symbols
