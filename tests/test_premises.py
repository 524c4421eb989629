"""The graph of premises and the index of assumptions hold what the records hold, and the page draws it."""

import re
from pathlib import Path

import pytest
from generators import premises
from kvtheory.derivations.catalogue import catalogue

from tests.browser import Browser

SCRIPT = Path(__file__).parent.parent / "docs" / "_static" / "premises.js"


def reach(label, links):
    """Return the label and all others to which links lead."""
    found, new = set(), {label}
    while new:
        found |= new
        new = {each for one in new for each in links[one]} - found
    return found


@pytest.fixture(scope="module")
def pages():
    return premises.pages(catalogue())


@pytest.fixture(scope="module")
def index():
    """The assumptions of each kind, by their LaTeX."""
    found = premises.assumptions(catalogue())
    return {kind: {one.latex: one for one in each} for kind, each in found.items()}


def test_the_graph_has_each_record_and_edge_once(pages):
    edges = re.findall(r'data-label="(\S+)" data-uses="([^"]*)"', pages["premises/graph.html"])
    assert [(label, uses.split()) for label, uses in edges] == [
        (each.label, list(each.uses)) for each in catalogue()
    ]


def test_the_lists_say_what_each_record_rests_on_and_what_on_it(pages):
    uses = {each.label: each.uses for each in catalogue()}
    before = {label: reach(label, uses) - {label} for label in uses}
    entries = re.findall(r'<dt id="of-(\S+)">.*?</dt><dd>(.*?)</dd>', pages["premises/lists.html"])
    assert [label for label, _ in entries] == list(uses)
    for label, text in entries:
        rests, used = (re.findall(r'"#of-(\S+)"', part) for part in text.split("Used by"))
        assert sorted(rests) == sorted(before[label])
        assert sorted(used) == sorted(each for each in uses if label in before[each])


def test_every_premise_and_condition_of_every_record_is_in_the_index(index):
    known = {**index["laws"], **index["definitions"]}
    assert not index["laws"].keys() & index["definitions"].keys()
    for each in catalogue():
        for latex in each.premises:
            assert each.label in known[latex].direct | known[latex].through
        for latex in each.domain:
            one = index["ranges"][latex]
            assert each.label in one.direct | one.through
    for one in (one for kind in index.values() for one in kind.values()):
        assert one.direct
        assert not one.direct & one.through


def test_assumptions_that_are_known(index):
    parabola = index["laws"][r"h(x) = \frac{x^{2}}{2 R}"]
    assert parabola.direct == {"eq3"}
    assert "small slopes" in parabola.words
    assert {"eq28", "load", "F3-values"} <= parabola.through
    assert "F19-load" not in parabola.direct | parabola.through  # a power law needs no parabola
    assert any("no force from neighbours" in one.words for one in index["laws"].values())
    assert "wedge-edge" in index["ranges"]["l < 1"].direct
    assert {"eq27", "load"} <= index["signs"]["K > 0"].direct


def test_the_page_draws_what_is_chosen(pages, tmp_path):
    """A click shows what a record rests on and what rests on it, with the edges between them."""
    page = tmp_path / "premises.html"
    parts = (pages[f"premises/{name}.html"] for name in ("graph", "lists"))
    page.write_text("\n".join([*parts, f"<script>{SCRIPT.read_text('utf-8')}</script>"]), "utf-8")
    uses = {each.label: each.uses for each in catalogue()}
    before = reach("F3", uses)
    after = {label for label in uses if "F3" in reach(label, uses)}
    browser = Browser(tmp_path / "profile")
    try:
        browser.open(page)
        shown = 'document.querySelectorAll("#premises a[data-label]:not([hidden])")'
        drawn = 'document.querySelectorAll("#premises path")'
        assert browser.run(f"{shown}.length") == len(uses)
        assert browser.run(f"{drawn}.length") == sum(map(len, uses.values()))
        browser.run("document.querySelector('[data-label=\"F3\"]').click()")
        assert set(browser.run(f"[...{shown}].map(each => each.dataset.label)")) == before | after
        assert browser.run(f"{drawn}.length") == sum(
            {result, premise} <= some
            for result, each in uses.items()
            for premise in each
            for some in (before, after)
        )
        assert "F3" in browser.run("document.querySelector('output a').textContent")
        browser.run("document.querySelector('button').click(); new Promise(f => setTimeout(f, 50))")
        assert browser.run(f"{shown}.length") == len(uses)
        assert not browser.errors
    finally:
        browser.close()
