"""Exercises: a notebook for each row of `exercises.toml`, made from its record, and a list of them."""

import tomllib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import sympy as sp
from kvtheory.derivations.engine.book import tex
from kvtheory.derivations.engine.letters import letters, printed
from kvtheory.derivations.engine.record import Derivation, Step
from kvtheory.derivations.exercises import ingredients
from kvtheory.derivations.render import notebook

from generators.labels import anchor_of

TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))["exercise"]
HOLES = {"equal": "rhs", "integral": "antiderivative", "root": "value", "leading_order": "leading"}
"""The argument of each check that a student enters, unless a row of the table names another."""
QUESTIONS = {
    "rhs": r"Find the right side of ${left} = \ldots$",
    "value": "Find ${left}$, the solution of ${expr} = 0$.",
    "leading": r"Find the leading term of ${left}$ as ${variable} \to {point}$.",
    "antiderivative": "Find an antiderivative of ${integrand}$ with respect to ${variable}$.",
    "whole": r"Evaluate ${left} = \int_{{{low}}}^{{{high}}} {integrand} \, \mathrm{{d}}{variable}$.",
}


def pages(derivations: Sequence[Derivation]) -> dict[str, str]:
    """Return the notebooks, and a list of links to them and to the proofs."""
    records, texts, links = {each.label: each for each in derivations}, {}, ""
    for number, row in enumerate(TABLE, 1):
        record = records[row["record"]]
        name = f"exercises/exercise-{number:02}-{record.label}.ipynb"
        texts[name] = notebook.assembled(list(_cells(row, record)))
        link = f"{{download}}`{record.title} </generated/{name}>`"
        links += f"{number}. {link}, proof [{record.label}](#{anchor_of(record.label)})\n"
    return {**texts, "exercises/links.inc": links}


def tasks() -> str:
    """Return the table of the page `exercises.md`, which is read without building the site, too."""
    rows = [
        f"| {number} | {row['topic']} | {row['level']} | {row['told']} |\n"
        for number, row in enumerate(TABLE, 1)
    ]
    return "| no. | topic | level | task |\n|---|---|---|---|\n" + "".join(rows)


def steps_left(row: dict[str, Any], record: Derivation) -> Iterator[tuple[Step, str, str]]:
    """Yield each step that is left out, the argument of its check that is to be entered, and the hint."""
    known = {
        str(s.claim.lhs): s for s in reversed(record.steps) if s.claim and s.claim.check in HOLES
    }
    for lhs, hint, *hole in row["left"]:
        found = [
            each
            for key, each in known.items()
            if key == lhs or (lhs[-1] == "(" and key.startswith(lhs))
        ]
        if not found:
            raise ValueError(
                f"exercises.toml: {record.label} has no step {lhs}, but {', '.join(known)}"
            )
        yield found[0], (hole or [HOLES[found[0].claim.check]])[0], hint


def _cells(row: dict[str, Any], record: Derivation) -> Iterator[dict[str, Any]]:
    """Yield the cells: symbols, then for each step the question, its check, the answer and the solution."""
    left = list(steps_left(row, record))
    steps = record.steps[: 1 + max(record.steps.index(step) for step, *_ in left)]
    names = notebook._names(steps)
    code, told, given = notebook._Code(names), 0, 0
    yield notebook._markdown("\n\n".join([f"# {record.title}", row["told"], record.text, _HOW]))
    imports = f"from sympy import {notebook._IMPORTED}\n{notebook._ALSO}\n\n{_IMPORT}\n"
    start = f'exercise = Exercise("{record.label}")'
    yield notebook._code("\n".join([imports, *notebook._declared(names), start]))
    for number, (step, hole, hint) in enumerate(left, 1):
        place, asked = steps.index(step), step.claim.arguments
        parts = sorted(ingredients(sp.sympify(asked[hole])), key=str)
        shown = [f"- {notebook.shown(each)}" for each in steps[told:place]]
        use = ", ".join(f"`{code.doprint(each)}` (${_tex(each, record)}$)" for each in parts)
        question = f"{_question(step, hole, record)} Use only {use or 'numbers'}."
        yield notebook._markdown(
            "\n\n".join([f"## Step {number}", *filter(None, ["\n".join(shown)]), question])
        )
        arguments = [
            f"    {key}={notebook._printed(each, code)},"
            for key, each in asked.items()
            if key != hole
        ]
        yield _folded(
            *("# The check", *filter(None, (_given(each, code) for each in steps[given:place]))),
            *(
                f'check_{number} = exercise.ask(\n    "{step.claim.check}", "{hole}",',
                f"    hint={hint!r},",
            ),
            *(f"    of=[{', '.join(map(code.doprint, parts))}],", *arguments, ")"),
        )
        yield notebook._code(f"answer = ...\ncheck_{number}(answer)")
        answer = notebook._printed(asked[hole], code)
        yield _folded("# The solution", f"answer = {answer}", f"check_{number}(answer)")
        told, given = place + 1, place


def _folded(*lines: str) -> dict[str, Any]:
    """Return a cell of code that is closed until it is opened."""
    hidden = {"jupyter": {"source_hidden": True}, "tags": ["hide-input"]}
    return {**notebook._code("\n".join(lines)), "metadata": hidden}


def _given(step: Step, code: notebook._Code) -> str:
    """Return the line by which later steps use this one, if it gives a name or a condition."""
    claim = step.claim
    if claim and claim.check == "where":
        return f"exercise.where({code.doprint(claim.arguments['condition'])})"
    names = claim and (claim.check in {"define", "recall", "integral"} or "name" in claim.arguments)
    return f"exercise.given({code.doprint(claim.lhs)}, {code.doprint(claim.rhs)})" if names else ""


def _question(step: Step, hole: str, record: Derivation) -> str:
    asked = step.claim.arguments
    whole = step.claim.check == "integral" and hole == "value"
    over = dict(zip(("variable", "low", "high"), asked.get("over", ()), strict=False))
    parts = {
        key: _tex(each, record)
        for key, each in {**asked, **over}.items()
        if not isinstance(each, (str, tuple))
    }
    return QUESTIONS["whole" if whole else hole].format(**{**parts, "left": step.left})


def _tex(expr: Any, record: Derivation) -> str:
    return printed(tex(sp.sympify(expr)), letters(record.label, record.section))


_IMPORT = "from kvtheory.derivations.exercises import Exercise"
_HOW = """Enter each step as an expression of SymPy in the place of the dots, with fractions as `S(1)/3`. Its
cell says whether it is right (proved), wrong (refuted at a random point) or not decidable. The folded cells
hold the check of each step, which has to be run first, and the solution."""
