"""Each exercise accepts its solution and refuses what is wrong, and says what it cannot decide."""

import io
import json
import re
from contextlib import redirect_stdout
from pathlib import Path

import pytest
import sympy as sp
from generators import exercises as site
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.exercises import Exercise

a, q = sp.symbols("a q", positive=True)
NAMES = [row["record"] for row in site.TABLE]


def says(check, answer):
    output = io.StringIO()
    with redirect_stdout(output):
        check(answer)
    return output.getvalue()


@pytest.fixture(scope="module")
def books():
    """The cells of all notebooks by their records."""
    pages = site.pages(catalogue())
    found = [json.loads(text)["cells"] for name, text in pages.items() if name.endswith(".ipynb")]
    return dict(zip(NAMES, found, strict=True))


def run(cells):
    """Run the cells as a student who answers nothing; return the names, and the solutions in order."""
    names, solutions = {}, []
    for cell in cells:
        if cell["cell_type"] == "code":
            folded = cell["metadata"].get("tags") == ["hide-input"]
            assert folded == cell["source"].startswith("# The ")
            if solution := re.fullmatch(
                r"# The solution\nanswer = (.*)\ncheck_\d\(answer\)", cell["source"]
            ):
                solutions.append(eval(solution[1], names))
            else:
                with redirect_stdout(io.StringIO()) as output:
                    exec(cell["source"], names)
                assert ("in the place of the dots" in output.getvalue()) == (
                    "answer" in cell["source"]
                )
    return names, solutions


def test_there_are_ten_of_each_level_and_the_page_lists_them(books):
    assert len(set(NAMES)) == len(books) == 10
    assert {row["level"] for row in site.TABLE} == {"easy", "medium", "hard"}
    links = site.pages(catalogue())["exercises/links.inc"]
    assert all(f"-{name}.ipynb>`" in links for name in NAMES)
    assert all(row["told"].count(". ") == 1 for row in site.TABLE)


def test_the_page_in_the_checkout_has_the_tasks():
    page = Path(__file__).parents[1] / "docs" / "tutorial" / "exercises.md"
    assert site.tasks() in page.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES)
def test_a_solution_is_right_and_a_planted_answer_wrong(books, name, by_label):
    names, solutions = run(books[name])
    left = [
        *site.steps_left(next(row for row in site.TABLE if row["record"] == name), by_label[name])
    ]
    assert len(solutions) == len(left) >= 1
    for number, (solution, (step, _, hint)) in enumerate(zip(solutions, left, strict=True), 1):
        check = names[f"check_{number}"]
        assert says(check, solution) == "Right: proved.\n"
        assert says(check, 2 * solution) == f"Wrong: it does not hold.\nHint: {hint}\n"
        # Neither the question itself nor what is not worked out is an answer.
        assert says(check, step.claim.lhs).startswith("Not decidable: ")


def test_the_other_root_is_wrong(books):
    """Though the pressure vanishes there, it is not in the contact."""
    names, (_, edge) = run(books["eq27"])
    half_distance = edge + names["l_r"]
    assert "Wrong" in says(names["check_2"], edge - 2 * half_distance)


def test_another_form_and_another_constant_are_right(books):
    names, (antiderivative, value) = run(books["load"])
    assert "Right" in says(names["check_1"], sp.expand(antiderivative) + 7)
    assert "Right" in says(names["check_2"], sp.expand(value))


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        (..., "the dots"),
        ("a", "'a' is not an expression"),
        (None, "not an expression"),
        (sp.Eq(a, 1), "not a formula"),
        (sp.Integral(a, (a, 0, 1)), "carry out integrals"),
        (a / 3.0, "write fractions as S(1)/3"),
        (a + q, "write it without q; use only a"),
    ],
)
def test_what_is_no_answer_is_not_decided(answer, why):
    check = Exercise("one").ask("equal", "rhs", of=[a], hint="none.", lhs=2 * a)
    told = says(check, answer)
    assert told.startswith("Not decidable: ")
    assert why in told


def test_what_is_neither_proved_nor_refuted_is_not_decided():
    check = Exercise("two").ask("equal", "rhs", of=[a], hint="none.", lhs=sp.atan(a))
    told = says(check, sp.im(sp.log(1 + sp.I * a)))
    assert told.startswith("Not decidable: neither proved nor refuted")


def test_a_condition_that_is_given_holds_where_a_point_may_refute():
    exercise = Exercise("three")
    exercise.where(q < 1)
    check = exercise.ask("equal", "rhs", of=[q], hint="none.", lhs=sp.sqrt((1 - q) ** 2))
    assert "Wrong" not in says(check, 1 - q)
    assert "Wrong" in says(check, q - 1)


def test_a_row_that_has_become_stale_is_named(by_label):
    row = {"record": "eq27", "left": [["x_LE", ""]]}
    with pytest.raises(ValueError, match=r"eq27 has no step x_LE, but .*x_TE"):
        list(site.steps_left(row, by_label["eq27"]))
