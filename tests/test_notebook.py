"""The notebook is valid, runs from top to bottom, and would notice a wrong step."""

import json
from dataclasses import replace

import pytest
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.render import edition, notebook
from kvtheory.derivations.render.recheck import Steps
from kvtheory.derivations.symbols import a, l_r, q

from tests import rechecked


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
    """Cells that have run as they are may be left out, but for every thirtieth and one of each kind."""
    derivations, kept = catalogue(), json.loads(rechecked.PATH.read_text(encoding="utf-8"))
    now, kinds, again = rechecked.digests(derivations), set(), []
    for number, each in enumerate(derivations):
        new = {step.claim.check for step in each.steps if step.claim} - kinds
        kinds |= new
        if new or number % 30 == 0 or kept.get(each.label) != now[each.label]:
            again.append(each)
    asked, told = rechecked.counted(again)
    assert told == asked


def test_a_wrong_step_stops_the_notebook():
    found = next(each for each in catalogue() if each.label == "eq27")
    *steps, last = found.steps
    claim = replace(last.claim, arguments={**last.claim.arguments, "value": a - l_r})
    wrong = replace(last, claim=claim)
    altered = replace(found, steps=(*steps, wrong))
    assert rechecked.digests([altered]) != rechecked.digests([found])
    with pytest.raises(AssertionError, match="eq27"):
        rechecked.executed([altered])


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
    ],
)
def test_the_second_opinion_sees_what_is_false(check, arguments):
    with pytest.raises(AssertionError, match="does not hold"):
        getattr(Steps("wrong"), check)(*arguments)
