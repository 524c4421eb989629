"""The engine refuses, with its reason, each false step of `tests/planted.py`, and accepts each true one."""

import pytest
import sympy as sp

from tests import planted

SHOWN = {
    "true for integers only": "left - right = ",
    "almost the same by a factor": "left - right = ",
    "wrong primitive": "left - right = ",
    "root of the wrong sign": "left - right = ",
    "across a pole": "continuous",
    "one of two roots without an interval": "other roots",
    "two roots": "2 roots",
    "no root where one is claimed": "0 roots",
    "exact, so without a next term": "identically zero",
    "what is not small": "small positive",
}
"""What a refusal says is wrong."""
ROWS = [
    pytest.param(step, expected, why, SHOWN.get(name, ""), id=f"{kind}: {name}")
    for kind, name, expected, step, why in planted.rows()
]
NAMED = "is not among the functions that the kernel knows"
"""What a refusal says of a function that no record uses."""


def test_the_tables_are_long():
    tables = planted.FALSE, planted.CONDITIONED
    assert sum(len(group) for table in tables for group in table.values()) >= 400
    assert sum(len(group) for group in planted.TRUE.values()) >= 115


@pytest.mark.parametrize(
    "name", ["gamma of the next order, which is true", "sine integral", "factorial"]
)
def test_what_no_record_uses_is_refused_by_name(name):
    rows = {row[1]: row[3] for row in planted.rows()}
    assert NAMED in planted.verdict(rows[name])[1]


def test_a_refusal_evaluates_no_integral_that_it_prints(monkeypatch):
    """SymPy orders terms by their values, which takes seconds for an integral that diverges."""
    rows = {row[1]: row[3] for row in planted.rows()}
    monkeypatch.setattr(sp.Expr, "__complex__", lambda _: pytest.fail("evaluated"))
    assert planted.verdict(rows["difference of logarithms"])[0] == "refused"


@pytest.mark.parametrize(("step", "expected", "why", "shown"), ROWS)
def test_planted(step, expected, why, shown):
    result, words = planted.verdict(step)
    assert (result, shown in words) == (expected, True), f"{why}; {words}"
