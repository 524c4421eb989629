"""`kvtheory derive`: labels as people write them, mistakes before the work, numbers, letters, shapes."""

import json

import pytest
from click.testing import CliRunner
from kvtheory.derivations import catalogue as chapters
from kvtheory.derivations.catalogue import catalogue
from kvtheory.derivations.contents import CONTENTS
from kvtheory.derivations.labels import find

from kvtheory.cli import main


def run(*arguments: str, code: int = 0):
    result = CliRunner().invoke(main, ["derive", *arguments])
    assert result.exit_code == code, result.output
    return result


def entries(directory):
    return {
        entry["label"]: entry
        for entry in json.loads((directory / "derivations.json").read_text(encoding="utf-8"))
    }


@pytest.fixture
def no_work(monkeypatch):
    """Let every derivation fail, to see that a mistake is found before it."""

    def refuse(chapter):
        raise AssertionError("derived before the mistake was found")

    monkeypatch.setattr(chapters, "_chapter", refuse)


# Labels


def test_the_contents_are_those_of_the_catalogue():
    assert {each.label: each.title for each in catalogue()} == CONTENTS
    assert list(CONTENTS) == [each.label for each in catalogue()]


def test_the_list_has_one_line_for_each_label_and_derives_nothing(no_work):
    lines = run("--list").output.splitlines()
    assert [line.split()[0] for line in lines[1:]] == list(CONTENTS)
    listed = json.loads(run("--list", "--json").output)
    assert [entry["label"] for entry in listed] == list(CONTENTS)


@pytest.mark.parametrize(
    "name", ["33", "eq33", "Eq33", "eq. 33", "Eq. (33)", "EQ 33", "equation 33", "(33)", " 33 "]
)
def test_an_equation_is_understood_as_people_write_it(name):
    assert find([name], CONTENTS) == ["eq33"]


@pytest.mark.parametrize("name", ["f3", "F3", "theorem F3", "Theorem f3"])
def test_a_theorem_is_understood_as_people_write_it(name):
    assert find([name], CONTENTS) == ["F3", "F3-values"]


@pytest.mark.parametrize("label", CONTENTS)
def test_each_label_finds_itself(label):
    assert label in find([label], CONTENTS)
    assert label in find([label.upper()], CONTENTS)


# Mistakes


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "eq333"], "unknown label 'eq333'; the nearest is 'eq33'"),
        (["--format", ""], "no format"),
        (["--format", ","], "no format"),
        (["--format", "pfd"], "unknown format 'pfd'; the nearest is 'pdf'"),
        (["-o", "/proc/nothing/here"], "cannot write to"),
        (["--shape", "c*x**3"], "is not even"),
        (["--shape", "__import__('os')"], "is not read"),
        (["--shape", "c*x**4", "--only", "eq27"], "does not go with --only"),
        (["--set", "drive.velocity=1 m/s"], "go with --numbers"),
        (["--numbers", "--set", "drive.velocity=0 m/s"], "drive.velocity is 0"),
        (
            ["--numbers", "--set", "indenter.shape=circle"],
            "the parabola, the power law, the wedge and the ball only",
        ),
    ],
)
def test_a_mistake_costs_one_message_and_no_work(no_work, tmp_path, arguments, message):
    where = [] if "-o" in arguments else ["-o", str(tmp_path / "out")]
    result = run(*arguments, *where, code=2)
    assert message in result.stderr
    assert not (tmp_path / "out").exists()
    assert "Traceback" not in result.output


def test_a_file_in_the_place_of_the_directory_is_found_first(no_work, tmp_path):
    (tmp_path / "file").write_text("")
    result = run("-o", str(tmp_path / "file" / "out"), code=2)
    assert "cannot write to" in result.stderr


def test_only_what_is_needed_is_derived(monkeypatch, tmp_path):
    derived = []
    whole = chapters._chapter

    def count(chapter):
        derived.append(chapter.__name__)
        return whole(chapter)

    monkeypatch.setattr(chapters, "_chapter", count)
    run("--only", "27", "--format", "json", "-o", str(tmp_path))
    assert derived == ["kvtheory.derivations.model", "kvtheory.derivations.steady"]


# Closure, numbers, letters


def test_closure_adds_the_premises(tmp_path):
    run("--only", "eq46", "--closure", "--format", "json", "-o", str(tmp_path))
    found = list(entries(tmp_path))
    assert found[-1] == "eq46"
    assert {"eq3", "eq28", "load", "scaling"} <= set(found)


def test_numbers_are_those_of_the_scene(tmp_path):
    import kvtheory as kv

    overrides = ["support.mass=2000 kg/m", "drive.velocity=50 mm/s"]
    options = [part for each in overrides for part in ("--set", each)]
    run("--only", "27,28,load,coefficient,F3", "--numbers", "--format", "json",
        "-o", str(tmp_path), *options)  # fmt: skip
    state = kv.steady(kv.load_scene(None, overrides))
    found = {label: entry["numbers"] for label, entry in entries(tmp_path).items()}
    values = {label: numbers[-1]["value"] for label, numbers in found.items()}
    assert values["eq27"] == pytest.approx(state.trailing_edge, rel=1e-12)
    assert values["eq28"] == pytest.approx(state.half_length, rel=1e-12)
    assert values["load"] == pytest.approx(2000 * 9.80665, rel=1e-12)
    assert values["coefficient"] == pytest.approx(state.friction_coefficient, rel=1e-12)
    assert values["F3"] == pytest.approx(2 - 3**0.5, rel=1e-15)
    assert r"(500\," not in found["eq28"][-1]["substituted"]
    assert r"10\,\mathrm{mm}" in found["eq28"][-1]["substituted"]
    assert found["eq28"][-1]["unit"] == "m"


@pytest.mark.parametrize("support", ["fixed", "dead-weight", "suspended"])
@pytest.mark.parametrize(
    ("shape", "velocity", "label", "scale"),
    [
        ({"shape": "parabola", "radius": "10 mm"}, "100 mm/s", "coefficient", None),
        ({"shape": "sphere", "radius": "10 mm"}, "100 mm/s", "F20", "a/R"),
        ({"shape": "power-law", "length": "10 mm", "exponent": "3"}, "100 mm/s", "F19", "d/a"),
        ({"shape": "power-law", "length": "10 mm", "exponent": "1.5"}, "0.1 um/s", "F19", "d/a"),
        ({"shape": "wedge", "inclination": "0.1"}, "1 mm/s", "wedge-peeling", "d/a"),
        ({"shape": "wedge", "inclination": "0.1"}, "100 mm/s", "wedge-peeled", "d/a"),
    ],
)
def test_every_closed_form_takes_numbers(tmp_path, support, shape, velocity, label, scale):
    """Each shape on each support: the friction coefficient of its own records is that of `steady`."""
    import kvtheory as kv

    given = {f"indenter.{key}": value for key, value in shape.items()}
    given |= {"support.kind": support, "drive.velocity": velocity}
    if support == "suspended":
        given["support.stiffness"] = "1 MN/m" if shape["shape"] == "sphere" else "1 MN/m^2"
    if support != "fixed" and shape["shape"] == "sphere":
        given["support.mass"] = "1 kg"
    overrides = [f"{key}={value}" for key, value in given.items()]
    options = [part for each in overrides for part in ("--set", each)]
    run("--only", f"{label},eq29", "--numbers", "--format", "json", "-o", str(tmp_path), *options)
    state = kv.steady(kv.load_scene(None, overrides))
    unit = {None: 1.0, "a/R": state.half_length / 0.01, "d/a": state.depth / state.half_length}
    found = {name: entry["numbers"] for name, entry in entries(tmp_path).items()}
    value = found[label][-1]["value"] * unit[scale]
    assert value == pytest.approx(state.friction_coefficient, rel=1e-9)
    assert found["eq29"][-1]["value"] == pytest.approx(state.retardation_length, rel=1e-12)


def test_numbers_are_of_records_about_this_shape_and_others_are_named(tmp_path):
    """The closed forms of other shapes, and of the other regime of a wedge, have none."""
    wedge = ["--set", "indenter.shape=wedge", "--set", "indenter.inclination=0.1"]
    labels = "wedge,eq27,F1,F20"
    told = run("--only", labels, "--numbers", "--format", "json", "-o", str(tmp_path), *wedge)
    found = entries(tmp_path)
    assert {label for label, entry in found.items() if entry["numbers"]} == {
        "wedge-peeled",
        "wedge",
    }
    assert f"no numbers of this scene in {len(found) - 2}" in told.stderr
    told = run("--only", labels, "--numbers", "--format", "json", "-o", str(tmp_path))
    with_numbers = {label for label, entry in entries(tmp_path).items() if entry["numbers"]}
    assert {"eq27", "F1"} <= with_numbers
    assert not any(label.startswith(("wedge", "F20")) for label in with_numbers)


def test_numbers_hold_far_from_the_scale_of_a_contact(tmp_path):
    """The trailing edge is 1e-294 m, where its closed form cancels to hundreds of digits."""
    run("--only", "eq27,F3", "--numbers", "--format", "json", "-o", str(tmp_path),
        "--set", "foundation.stiffness=1e300 N/m^3")  # fmt: skip
    load, damping, speed = 1000 * 9.80665, 1e299, 0.1
    expected = load / (damping * speed)  # W -> C V delta and x_TE -> a^2/(2 l_r) = R delta/l_r
    assert entries(tmp_path)["eq27"]["numbers"][-1]["value"] == pytest.approx(expected, rel=1e-12)


def test_it_says_how_much_is_derived_for_what_is_asked(tmp_path):
    told = run("--only", "27", "--format", "json", "-o", str(tmp_path)).stderr
    assert f"deriving {list(CONTENTS).index('eq27') + 1} records for the 1 asked for" in told


def test_the_name_of_a_scene_is_no_markup(tmp_path):
    hostile = tmp_path / "`<script>$a$.toml"
    hostile.write_text(CliRunner().invoke(main, ["scene"]).stdout, encoding="utf-8")
    run("--only", "29", "--numbers", str(hostile), "--format", "html,md,tex", "-o", str(tmp_path))
    html, md, tex = (
        (tmp_path / f"derivations.{kind}").read_text() for kind in ("html", "md", "tex")
    )
    assert "<script" not in html
    assert "<script" not in tex
    lines = [line for line in md.splitlines() if "<script" in line]
    assert lines
    assert all(line.startswith("Made by") and ": `` " in line for line in lines)


def test_numbers_stand_in_every_format_that_carries_text(tmp_path):
    run("--only", "29", "--numbers", "--format", "tex,html,md,ipynb,json", "-o", str(tmp_path))
    for name in ("derivations.tex", "derivations.md", "derivations.ipynb", "derivations.json",
                 "fragments/eq29-steps.tex"):  # fmt: skip
        assert "100" in (tmp_path / name).read_text(encoding="utf-8"), name
        assert "mm/s" in (tmp_path / name).read_text(encoding="utf-8"), name
    assert "With these numbers:" in (tmp_path / "derivations.html").read_text(encoding="utf-8")


def test_letters_are_applied_everywhere(tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text('l_r = "\\\\ell_0"\na = "H"\n')
    run("--only", "27,28,29", "--notation", str(mine), "--format", "tex,html,md,ipynb,json",
        "-o", str(tmp_path))  # fmt: skip
    found = entries(tmp_path)
    assert found["eq29"]["latex"] == r"\ell_0 = V \tau"
    assert found["eq28"]["latex"] == r"H = \sqrt{2 R \delta}"
    for path in (p for p in tmp_path.rglob("*") if p.suffix in {".tex", ".md", ".json"}):
        assert r"l_{\mathrm{r}}" not in path.read_text(encoding="utf-8"), path


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('aa = "b"', "unknown symbol 'aa'; the nearest is 'a'"),
        ('a = "V"', "that letter already stands for V"),
        ('a = "e"\nx = "e"', "that letter already stands for"),
        ('a = "b + 1"', "expected one symbol"),
        ("a = 1", "expected text"),
        ("a = ", "not TOML"),
    ],
)
def test_letters_that_would_mislead_are_refused(no_work, tmp_path, text, message):
    mine = tmp_path / "mine.toml"
    mine.write_text(text)
    result = run("--notation", str(mine), "-o", str(tmp_path / "out"), code=2)
    assert message in result.stderr


def test_only_symbols_that_are_shown_can_clash(tmp_path):
    """An example that looks simple, and letters of symbols in other chapters."""
    mine = tmp_path / "mine.toml"
    mine.write_text('l_r = "\\\\ell"\na = "b"\nR = "\\\\varrho"\n')
    only = ["--only", "27,28", "--notation", str(mine), "--format", "json", "-o"]
    run(*only, str(tmp_path))
    assert entries(tmp_path)["eq28"]["latex"] == r"b = \sqrt{2 \varrho \delta}"
    mine.write_text('a = "R"\n')
    assert "that letter already stands for R" in run(*only, str(tmp_path / "no"), code=2).stderr
    assert not (tmp_path / "no").exists()


def test_the_symbols_are_listed_by_name_and_derive_nothing(no_work, tmp_path):
    names = [line.split()[0] for line in run("--symbols").stdout.splitlines()[1:]]
    assert {"R", "l_r", "x_TE", "delta_0"} <= set(names)
    listed = json.loads(run("--symbols", "--json").stdout)
    assert {"name": "R", "latex": "R", "meaning": "radius of the indenter", "unit": "m"} in listed
    mine = tmp_path / "mine.toml"  # every name is one that --notation takes
    mine.write_text("".join(f"{json.dumps(name)} = 1\n" for name in names))
    told = run("--notation", str(mine), code=2).stderr
    assert "unknown symbol" not in told


def test_the_citation_says_the_version(tmp_path):
    import kvtheory as kv

    run("--only", "27", "--format", "bib", "-o", str(tmp_path))
    text = (tmp_path / "derivations.bib").read_text(encoding="utf-8")
    assert f"version = {{{kv.__version__}}}" in text
    assert "10.3389/fmech.2020.00038" in text
    assert text.count("{") == text.count("}")


def test_two_letters_can_be_exchanged(tmp_path):
    mine = tmp_path / "mine.toml"
    mine.write_text('R = "K"\nK = "R"\n')
    run("--only", "3", "--notation", str(mine), "--format", "json", "-o", str(tmp_path))
    assert entries(tmp_path)["eq3"]["latex"] == r"h(x) = \frac{x^{2}}{2 K}"
