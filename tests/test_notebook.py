"""The notebook is valid, runs from top to bottom, and would notice a wrong step."""

import io
import json
from contextlib import redirect_stdout
from dataclasses import replace

import pytest
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.render import edition, notebook
from kvtheory.derivations.render.recheck import Steps
from kvtheory.derivations.symbols import a, l_r, q


def executed(derivations):
    """Run all code cells in one namespace, as a kernel does, and return what they print."""
    cells = json.loads(notebook.document(edition(derivations)))["cells"]
    namespace, output = {"__name__": "__main__"}, io.StringIO()
    with redirect_stdout(output):
        for cell in cells:
            if cell["cell_type"] == "code":
                exec(compile(cell["source"], cell["id"], "exec"), namespace)
    return output.getvalue()


def test_the_notebook_is_of_format_4_5():
    book = json.loads(notebook.document(edition(catalogue())))
    assert (book["nbformat"], book["nbformat_minor"]) == (4, 5)
    assert len({cell["id"] for cell in book["cells"]}) == len(book["cells"])
    for cell in book["cells"]:
        code = cell["cell_type"] == "code"
        assert set(cell) == {"cell_type", "metadata", "source", "id"} | (
            {"outputs", "execution_count"} if code else set()
        )


def test_every_step_is_checked_again():
    printed = executed(catalogue())
    asked = {
        each.label: sum(
            step.claim.check not in {"define", "recall", "where"}
            for step in each.steps
            if step.claim
        )
        for each in catalogue()
    }
    lines = [line.split(":")[0] for line in printed.splitlines()]
    assert {label: lines.count(label) for label in asked} == asked


def test_a_wrong_step_stops_the_notebook():
    found = next(each for each in catalogue() if each.label == "eq27")
    *steps, last = found.steps
    wrong = replace(
        last, claim=replace(last.claim, arguments={**last.claim.arguments, "value": a - l_r})
    )
    with pytest.raises(AssertionError, match="eq27"):
        executed([replace(found, steps=(*steps, wrong))])


@pytest.mark.parametrize(
    ("check", "arguments"),
    [
        ("equal", (q + 1, q + 2)),
        ("root", (q**2 - 2, q, 1)),
        ("unique_root", (q**2 - 2, (q, 0, 1))),
        ("unique_root", ((q - 1) * (q - 2), (q, 0, 3))),
        ("sign", (q - 2, ">", 0, (q, 0, 3))),
        ("equivalent", (1 - q, q, 1)),
        ("integral", (a, q, (q, 0, 1), q**2 / 3)),
        ("integral", (a, q, (q, 0, 1), q**2 / 2, 1)),
        ("leading_order", (q + 2 * q**2, 2 * q, q, 0, q)),
        ("sampled", (q, q**2, [(q, 0, 1)])),
    ],
)
def test_the_second_opinion_sees_what_is_false(check, arguments):
    with pytest.raises(AssertionError, match="does not hold"):
        getattr(Steps("wrong"), check)(*arguments)
