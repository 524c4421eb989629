"""Each equation and theorem, with the functions that compute it and its tests."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from kvtheory.derivations.catalogue import CONTENTS
from kvtheory.derivations.emit import FORMS

import kvtheory as kv
from generators.labels import anchor_of, mentioned

ROOT = Path(__file__).parents[2]
OF_PRINTING = {"test_render", "test_derive_cli", "test_notebook", "test_docs"}
"""Tests that name labels as samples of what is printed."""
MOST = 4
"""Functions or tests that are listed for one equation."""


def pages() -> dict[str, str]:
    """Return the table of all of them."""
    functions, tests = users("kvtheory"), users("tests")
    rows = []
    for label, title in CONTENTS.items():
        own = [form.name for form in FORMS if form.label == label]
        closed = [f"theory/closed_forms.py::{name}" for name in own]
        held = tests[label] or (["tests/test_emit.py"] if own else ["tests/test_derivations.py"])
        link, computed = f"[{label}](#{anchor_of(label)})", _some([*closed, *functions[label]])
        rows.append(f"| {link} | {title} | {computed} | {_some(held)} |")
    head = "| label | title | computed by | tested by |\n|---|---|---|---|"
    return {
        "equations.md": f"# Equations, functions and tests\n\n{_TOLD}\n\n{head}\n"
        + "\n".join(rows)
        + "\n"
    }


@cache
def users(package: str) -> dict[str, list[str]]:
    """Return the functions of a package whose text mentions a label, by the label."""
    found: dict[str, list[str]] = defaultdict(list)
    for path in sorted((ROOT / package).rglob("*.py")):
        for name, text in _functions(path) if path.stem not in OF_PRINTING else ():
            if package == "tests" and not name.startswith("test_"):
                continue
            for label in mentioned(text):
                place = path.relative_to(ROOT / "kvtheory" if package == "kvtheory" else ROOT)
                found[label].append(f"{place}::{name}")
    return found


def _functions(path: Path) -> Iterator[tuple[str, str]]:
    """Yield the functions of a module, and their text with that of the decorators."""
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef):
            start = min([node.lineno, *(each.lineno for each in node.decorator_list)])
            yield node.name, "\n".join(lines[start - 1 : node.end_lineno])


def place_of(place: str) -> str:
    """Return where a function is; one of the interface is a link to its page."""
    module, _, name = place.partition("::")
    public = module.startswith("api/") and name in kv.__all__
    return f"[`kv.{name}`](/generated/api/{name}.md)" if public else f"`{place}`"


def _some(places: list[str]) -> str:
    shown = [*map(place_of, dict.fromkeys(places))]
    more = [f"and {len(shown) - MOST} more"] if len(shown) > MOST else []
    return ", ".join([*shown[:MOST], *more])


_TOLD = """Every step of every derivation is checked by SymPy when the derivations are made, and
`tests/test_emit.py` compares the closed forms with the symbolic expressions at 50 digits. The
functions and tests below name the equation in their text."""
