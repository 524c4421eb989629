"""Derivations as a Jupyter notebook whose cells check each step again, with SymPy alone."""

import json
import keyword
import re
from collections.abc import Iterable
from inspect import signature
from pathlib import Path
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef, UndefinedFunction
from sympy.printing.str import StrPrinter

from ..engine.record import Claim, Derivation, Step
from . import frame, recheck
from .edition import Edition
from .text import calculation, number

_IMPORTED = (
    "Abs, Derivative, E, Eq, "
    "Function, Heaviside, I, IndexedBase, Integral, Matrix, Max, Min, Piecewise, S, Subs, Sum, "
    "Symbol, acos, asin, asinh, atan, cos, cosh, exp, log, oo, pi, sin, sinh, sqrt, tan, tanh"
)
_ALSO = "from sympy.codegen.cfunctions import expm1, log1p"
_GIVEN, _SEEN = {"define", "recall", "asymptote"}, {"pair"}
"""Checks whose relation is a premise, and those whose relations stand in lines of their own."""


class _Code(StrPrinter):
    """Print an expression as Python, with the names that the cell declares."""

    def __init__(self, names: dict[Any, str]) -> None:
        super().__init__({"sympy_integers": True, "order": "none"})
        labels = {
            part.label: name for part, name in names.items() if isinstance(part, sp.IndexedBase)
        }
        self._names = {**names, **labels}

    def _print_Symbol(self, expr: sp.Symbol) -> str:  # noqa: N802
        return self._names[expr]

    _print_Dummy = _print_Symbol  # noqa: N815

    def _print_Function(self, expr: sp.Function) -> str:  # noqa: N802
        arguments = self.stringify(expr.args, ", ")
        return f"{self._names.get(expr.func, expr.func.__name__)}({arguments})"

    def _print_Rank(self, expr: sp.Expr) -> str:  # noqa: N802
        return f"S({self._print(expr.args[0])}.rank())"

    def _print_Determinant(self, expr: sp.Expr) -> str:  # noqa: N802
        return f"({self._print(expr.args[0])}).det(method='berkowitz')"


def document(edition: Edition) -> str:
    """Return the notebook; running its cells from top to bottom checks every step."""
    head = [f"# {edition.title}", *frame.INTRODUCTION]
    if edition.command:
        head.append(
            f"Made by {f'kvtheory {edition.version}'.strip()}: {frame.code_span(edition.command)}"
        )
    cells = [
        _markdown("\n\n".join(head)),
        _code(Path(recheck.__file__).read_text(encoding="utf-8")),
    ]
    cells.append(_code(f"from sympy import {_IMPORTED}\n{_ALSO}"))
    for derivation in edition.derivations:
        cells += [_markdown(_words(derivation)), _code(_steps(derivation))]
    return assembled(cells)


def assembled(cells: list[dict[str, Any]]) -> str:
    """Return the notebook of some cells."""
    for index, cell in enumerate(cells):
        cell["id"] = f"cell-{index}"
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    notebook = {
        "cells": cells,
        "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }
    return json.dumps(notebook, ensure_ascii=False, indent=1) + "\n"


def _markdown(text: str) -> dict[str, Any]:
    return {"cell_type": "markdown", "metadata": {}, "source": text}


def _code(text: str) -> dict[str, Any]:
    return {
        "cell_type": "code", "execution_count": None, "metadata": {}, "outputs": [],
        "source": text.rstrip(),
    }  # fmt: skip


def _words(derivation: Derivation) -> str:
    lines = [f"### ({number(derivation.label)}) {derivation.title}", derivation.text]
    for step in derivation.steps:
        lines.append(f"- {shown(step)}")
    if derivation.numbers:
        lines += ["", frame.WITH_NUMBERS, ""]
        lines += [f"- ${calculation(each)}$ {each.note}".rstrip() for each in derivation.numbers]
    return "\n\n".join(line for line in lines[:2] if line) + "\n\n" + "\n".join(lines[2:])


def shown(step: Step) -> str:
    """Return a step with its source and its reason."""
    source = f" ({number(step.source)})" if step.source else ""
    reason = f" — {step.reason}" if step.reason else ""
    return f"${step.latex}${source}{reason}"


def _steps(derivation: Derivation) -> str:
    """Return the code of one derivation: its symbols, then a line or two for each step."""
    names = _names(derivation.steps)
    code = _Code(names)
    lines = [*_declared(names), f'steps = Steps("{derivation.label}")']
    for step in derivation.steps:
        if step.claim is not None and step.claim.check not in _SEEN:
            lines += _call(step, step.claim, code)
    return "\n".join(lines)


def _call(step: Step, claim: Claim, code: _Code) -> list[str]:
    given = claim.check in _GIVEN
    check = "given" if given else claim.check
    arguments = {"lhs": claim.lhs, "rhs": claim.rhs} if given else claim.arguments
    asked = signature(getattr(recheck.Steps, check)).parameters
    wanted = {name: value for name, value in arguments.items() if name in asked}
    text = ", ".join(f"{name}={_printed(value, code)}" for name, value in wanted.items())
    comment = [f"# {step.reason}"] if step.reason else []
    return [*comment, f"steps.{check}({text})"]


def _printed(value: Any, code: _Code) -> str:
    if isinstance(value, str) or value is None:
        return repr(value)
    if isinstance(value, (tuple, list)):
        return f"({', '.join(_printed(each, code) for each in value)},)"
    return str(code.doprint(sp.sympify(value)))


def _names(steps: Iterable[Step]) -> dict[Any, str]:
    """Give each symbol and unknown function of the steps a name of its own."""
    names: dict[Any, str] = {}
    for step in steps:
        if step.claim:
            for value in (step.claim.lhs, step.claim.rhs, *step.claim.arguments.values()):
                for part in sorted(_parts(value), key=str):
                    if part not in names:
                        names[part] = _free(str(part), {*names.values(), *_IMPORTED.split(", ")})
    return names


def _parts(value: Any) -> set[Any]:
    if isinstance(value, (tuple, list)):
        return set().union(*map(_parts, value))
    if not isinstance(value, sp.Basic):
        return set()
    bases = value.atoms(sp.IndexedBase)
    symbols = value.atoms(sp.Symbol) - {base.label for base in bases}
    return symbols | bases | {each.func for each in value.atoms(AppliedUndef)}


def _free(name: str, taken: set[str]) -> str:
    stem = re.sub(r"\W", "_", name)
    stem = f"{stem}_" if keyword.iskeyword(stem) or not stem.isidentifier() else stem
    candidates = (f"{stem}{'_' * k}" for k in range(10))
    return next(candidate for candidate in candidates if candidate not in taken)


def _declared(names: dict[Any, str]) -> list[str]:
    """Declare the symbols with their assumptions."""
    lines = []
    for part, name in names.items():
        if isinstance(part, sp.IndexedBase):
            lines.append(f'{name} = IndexedBase("{part.label}")')
            continue
        function = isinstance(part, UndefinedFunction)
        assumed = part._kwargs if function else part._assumptions_orig
        facts = "".join(
            f", {fact}={value}" for fact, value in assumed.items() if fact != "commutative"
        )
        kind = "Function" if function else "Symbol"
        shown = part.__name__ if function else part.name
        lines.append(f"{name} = {kind}({json.dumps(shown)}{facts})")
    return lines
