"""The second opinion: it confirms the claims of the derivations, finds wrong ones, and is independent."""

import copy
import json
import sys
from collections import Counter
from importlib.util import find_spec

import pytest
from click.testing import CliRunner
from generators import derivations as site_derivations
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.recheck.checks import _CHECKS, Question, Record, Verdict
from kvtheory.derivations.recheck.report import counts, having
from kvtheory.derivations.recheck.trees import read
from kvtheory.derivations.render import edition
from kvtheory.derivations.render import json as written

from kvtheory.cli import main
from tests.commands import python
from tests.planted_claims import OPERATORS, another_place, planted


@pytest.fixture(scope="module")
def records():
    return json.loads(written.document(edition(catalogue())))


def of(records, label):
    return next(record for record in records if record["label"] == label)


def test_the_claims_are_those_of_the_steps(records):
    for derivation, record in zip(catalogue(), records, strict=True):
        claimed = [
            f"{record['label']}/{i}" for i, step in enumerate(derivation.steps) if step.claim
        ]
        assert [claim["id"] for claim in record["claims"]] == claimed
        known = {claim["id"] for claim in record["claims"]}
        assert all(set(claim["premises"]) < known for claim in record["claims"])


def test_no_claim_is_refuted_and_every_known_kind_is_decided():
    verdicts = site_derivations.verdicts()  # of all records: the page of the site is made of these
    assert having(verdicts, "refuted") == {}
    undecided = [each for each in having(verdicts, "unconfirmed").values() if each.kind in _CHECKS]
    assert (
        undecided == []
    )  # a claim about two forms of one expression is about them as they are printed
    weaker = Counter(each.kind for each in having(verdicts, "supported").values())
    assert set(weaker) <= {"limit", "inequality", "integral", "maximum", "crossing", "pair"}
    assert counts(verdicts)["confirmed"] > 5 * sum(weaker.values())


@pytest.mark.parametrize(
    "name",
    ["F13/8", "F10-touch/1", "F10-touch/2", "F10-touch/15", "F3/3", "F11-edges/4", "F11-edges/5"],
)
def test_a_root_elsewhere_is_refuted_also_where_only_a_premise_has_its_variable(records, name):
    record = of(records, name.split("/")[0])
    claim = next(each for each in record["claims"] if each["id"] == name)
    for wrong in another_place(record, claim, None):
        claims = [wrong if each is claim else each for each in record["claims"]]
        assert Record({**record, "claims": claims}, {}).verdict(wrong).status == "refuted"


def test_a_hundred_wrong_claims_are_found(records):
    others = {record["label"]: record for record in records}
    wrong = [*planted(records, 100)]
    assert len(wrong) == 100
    assert {name for name, _, _ in wrong} == {operator.__name__ for operator in OPERATORS}
    missed = [
        (name, claim["id"], verdict)
        for name, record, claim in wrong
        if (verdict := Record(record, others).verdict(claim)).status != "refuted"
    ]
    assert missed == []


def test_a_recalled_relation_keeps_its_conditions(records):
    others = {record["label"]: record for record in records}
    record = copy.deepcopy(of(records, "F10-peel"))
    (claim,) = (each for each in record["claims"] if each["id"] == "F10-peel/3")
    strict = {**record, "claims": [{**claim, "domain": [["<", "1", "rho"]]}]}
    user = {**claim, "id": "new/0", "kind": "recalled", "source": "F10-peel", "premises": []}
    checked = Record({**record, "claims": [user]}, {**others, "F10-peel": strict})
    assert checked.verdict({**user, "domain": [["<", "2", "rho"]]}).status == "confirmed"
    assert checked.verdict({**user, "domain": []}).status == "refuted"


def test_only_one_defined_side_is_no_equality(records):
    """Of two sides that agree where both are real, each must be real where the other is."""
    record = copy.deepcopy(of(records, "eq29"))
    base = {**record["claims"][2], "premises": [], "domain": []}
    root = ["^", ["^", "x", "1/2"], "2"]
    assert Record(record, {}).verdict({**base, "left": root, "right": "x"}).status == "unconfirmed"
    kept = {**base, "left": root, "right": "x", "domain": [["<", "0", "x"]]}
    assert Record(record, {}).verdict(kept).status == "confirmed"


def test_what_is_not_understood_is_not_confirmed(records):
    record = of(records, "eq27")
    claim = record["claims"][2]
    for strange in (
        {"kind": "lemma"},
        {"left": ["besselj", "x", "p"]},
        {"right": ["zeta", "x"]},
        {"left": claim["right"]},
    ):
        assert Record(record, {}).verdict({**claim, **strange}).status == "unconfirmed"


def small(claim, *premises, symbols="x y z", functions=()):
    """Return the verdict on a claim under premises, all letters being real."""
    claims = [
        {
            "id": f"new/{i}",
            "kind": "definition",
            "domain": [],
            "premises": [],
            "left": a,
            "right": b,
        }
        for i, (a, b) in enumerate(premises)
    ]
    asked = {"premises": [each["id"] for each in claims], "domain": [], "id": "new/9", **claim}
    names = {name: ["real"] for name in symbols.split()}
    record = {"label": "new", "symbols": names, "functions": dict(functions), "claims": claims}
    return Record(record, {}).verdict(asked)


def test_a_premise_about_an_expression_is_used_as_its_value():
    """x^2 / y = 1 - z has no letter in which it is linear, nor is z a letter of the left side."""
    compound, value = ["*", ["^", "x", "2"], ["^", "y", "-1"]], ["+", "1", ["*", "-1", "z"]]
    root = {"kind": "root", "expression": compound, "variable": "z", "value": "1"}
    assert small(root, (compound, value)).status == "confirmed"
    assert small({**root, "value": "2"}, (compound, value)).status == "unconfirmed"
    more = {"kind": "equality", "left": ["+", compound, "z"], "right": "1"}
    assert small(more, (compound, value)).status == "confirmed"
    assert small({**more, "right": "2"}, (compound, value)).status == "refuted"


def test_a_letter_that_a_premise_gives_a_value_has_it_everywhere():
    """The name y of f(x) is asked for before the premise y - z^2 = 1 gives f(x) its value."""
    name, place = read("y"), read(["call", "f", "x"])
    premise = {read(["+", "y", ["*", "-1", ["^", "z", "2"]]]): read("1")}
    question = Question({name: place}, premise, [], {"f()": ["real"]}, "new/0")
    for point in question.points(name):
        assert point.value(name) == point.value(place) == 1 + point.value(read("z")) ** 2


def test_a_positive_function_may_fall_as_well_as_rise():
    """int_0^1 (1 - 2 x) f(x) dx is positive where f falls, and of no sign for every positive f."""
    inner = ["*", ["+", "1", ["*", "-2", "x"]], ["call", "f", "x"]]
    moment = ["integral", inner, ["x", "0", "1"]]
    claim = {"kind": "inequality", "left": moment, "relation": ">", "right": "0"}
    given = {"f": ["positive"]}
    assert small(claim, functions=given).status == "refuted"
    assert small({**claim, "relation": "<"}, functions=given).status == "refuted"
    doubled = ["*", "2", moment]
    same = {**claim, "domain": [["<", "0", moment]], "left": doubled}
    assert small(same, functions=given).status == "supported"


def test_z3_decides_inequalities_of_several_letters_where_it_is_installed():
    def verdict(right):
        record = {"symbols": {"x": ["positive"], "y": ["positive"]}, "functions": {}, "claims": []}
        claim = {
            "id": "new/0", "kind": "inequality", "premises": [], "domain": [["<", "y", "x"]],
            "left": ["^", "x", "2"], "relation": ">", "right": right,
        }  # fmt: skip
        return Record(record, {}).verdict(claim)

    found = verdict(["*", "x", "y"])
    by_z3 = find_spec("z3") is not None
    assert found == Verdict(*(("confirmed", "by z3") if by_z3 else ("supported", "at points")))
    assert verdict(["*", "2", "x", "y"]).status == "refuted"


def test_neither_sympy_nor_the_engine_is_imported():
    code = (
        "import sys; import kvtheory.derivations.recheck.report; "
        "print([m for m in sys.modules if m.split('.')[0] in ('sympy', 'mpmath') or "
        "m.startswith('kvtheory.derivations.') and '.recheck' not in m])"
    )
    assert python("-c", code) == "[]"


# $ kvtheory derive --recheck


def run(*arguments, code=0):
    result = CliRunner().invoke(main, ["derive", "--recheck", *arguments])
    assert result.exit_code == code, result.output
    return result


def test_the_command_prints_a_row_for_each_record():
    lines = run("--only", "eq27,F1").stdout.splitlines()
    assert [line.split()[0] for line in lines[1:3]] == ["eq27", "F1"]
    assert "by isolation of roots" in lines[1]
    assert lines[3].startswith("Checked again: confirmed ")


def test_the_command_says_which_claim_is_refuted(monkeypatch):
    def altered(edition):
        return document(edition).replace('"right": ["*", "-1", "K",', '"right": ["*", "-2", "K",')

    document = written.document
    monkeypatch.setattr(written, "document", altered)
    assert "eq27/2 refuted: left - right = " in run("--only", "eq27", code=1).stdout
    told = json.loads(run("--only", "eq27", "--json", code=1).stdout)
    assert told["refuted"] >= 1
    assert told["records"]["eq27"]["eq27/2"]["status"] == "refuted"


def test_the_command_refuses_what_it_would_not_do(monkeypatch):
    for option in (["--format", "pdf"], ["-o", "here"], ["--numbers"], ["--closure"]):
        assert "--recheck writes nothing" in run(*option, code=2).stderr
    assert "'eq270'" in run("--only", "eq270", code=2).stderr
    for name in [name for name in sys.modules if "derivations.recheck" in name]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "flint", None)
    assert 'python-flint: pip install ".[recheck]"' in run(code=2).stderr
