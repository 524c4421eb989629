"""`kvtheory derive`: labels as people write them, mistakes before the work, numbers, letters, shapes."""

import json
import re
import shlex
from functools import partial

import pytest
from kvtheory.derivations import catalogue as chapters
from kvtheory.derivations.catalogue import CONTENTS, catalogue
from kvtheory.derivations.labels import find

import kvtheory as kv
from kvtheory.cli import main
from tests import SUPPORTS, commands

run = partial(commands.run, "derive")


def derived(directory, only, *options, overrides=()):
    """Derive some records into a directory, and return them by label."""
    given = [part for each in overrides for part in ("--set", each)]
    run("--only", only, "--format", "json", "-o", str(directory), *options, *given)
    records = json.loads((directory / "derivations.json").read_text(encoding="utf-8"))
    return {record["label"]: record for record in records}


@pytest.fixture
def no_work(monkeypatch):
    """Let every derivation fail, to see that a mistake is found before it."""

    def refuse(chapter):
        raise AssertionError("derived before the mistake was found")

    monkeypatch.setattr(chapters, "_chapter", refuse)


# Labels


def test_the_contents_are_those_of_the_catalogue():
    assert [*CONTENTS.items()] == [(each.label, each.title) for each in catalogue()]


def test_labels_and_symbols_are_listed_and_nothing_is_derived(no_work, tmp_path):
    lines = run("--list").output.splitlines()
    assert [line.split()[0] for line in lines[1:]] == list(CONTENTS)
    listed = json.loads(run("--list", "--json").output)
    assert [entry["label"] for entry in listed] == list(CONTENTS)
    names = [line.split()[0] for line in run("--symbols").stdout.splitlines()[1:]]
    assert {"R", "l_r", "x_TE", "delta_0"} <= set(names)
    listed = json.loads(run("--symbols", "--json").stdout)
    assert {"name": "R", "latex": "R", "meaning": "radius of the indenter", "unit": "m"} in listed
    mine = tmp_path / "mine.toml"  # every name is one that --notation takes
    mine.write_text("".join(f"{json.dumps(name)} = 1\n" for name in names))
    assert "unknown symbol" not in run("--notation", str(mine), status=2).stderr


def test_labels_are_understood_as_people_write_them():
    for name in (
        "33", "eq33", "Eq33", "eq. 33", "Eq. (33)", "EQ 33", "equation 33", "(33)", " 33 "
    ):  # fmt: skip
        assert find([name], CONTENTS) == ["eq33"]
    for name in ("f3", "F3", "theorem F3", "Theorem f3"):
        assert find([name], CONTENTS) == ["F3", "F3-values"]
    for label in CONTENTS:
        assert label in find([label], CONTENTS)
        assert label in find([label.upper()], CONTENTS)


def test_a_range_is_of_one_kind_and_both_its_ends_are_known():
    numbered = {f"eq{number}" for number in range(26, 49)}
    for name in ("eq26-eq48", "26-48", "Eqs. (26)-(48)", "eq48\u2013eq26", "Eq. 26 - Eq. 48"):
        assert set(find([name], CONTENTS)) == numbered
    families = {label.split("-")[0] for label in find(["F1-F4"], CONTENTS)}
    assert families == {"F1", "F2", "F3", "F4"}
    with pytest.raises(ValueError, match="unknown label 'eq60'; the nearest is 'eq6'"):
        find(["eq26-eq60"], CONTENTS)
    with pytest.raises(ValueError, match="unknown label 'eq26-F3'"):
        find(["eq26-F3"], CONTENTS)


# Mistakes


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--only", "eq333"], "unknown label 'eq333'; the nearest is 'eq33'"),
        (["--format", ""], "is empty; expected at least one item"),
        (["--format", ","], "is empty; expected at least one item"),
        (["--format", "tex,,html"], "item 2 of the list is empty"),
        (["--format", "pfd"], "unknown format 'pfd'; the nearest is 'pdf'"),
        (["-o", "/proc/nothing/here"], "cannot write to"),
        (["-o", f"{__file__}/out"], "cannot write to"),
        (["--shape", "c*x**3"], "is not even"),
        (["--shape", "__import__('os')"], "is not read"),
        (["--shape", "c*x**4", "--only", "eq27"], "does not go with --only"),
        (["--label-prefix", "a b%"], "--label-prefix 'a b%': expected up to 30"),
        (["--set", "drive.velocity=1 m/s"], "go with --numbers"),
        (["--numbers", "--set", "drive.velocity=0 m/s"], "drive.velocity is 0"),
        (["--numbers", "--set", "indenter.shape=circle"],
         "the parabola, the power law, the wedge and the ball only"),
    ],
)  # fmt: skip
def test_a_mistake_costs_one_message_and_no_work(no_work, tmp_path, arguments, message):
    where = [] if "-o" in arguments else ["-o", str(tmp_path / "out")]
    result = run(*arguments, *where, status=2)
    assert message in result.stderr
    assert not (tmp_path / "out").exists()


def test_only_what_is_needed_is_derived_and_how_much_that_is(monkeypatch, tmp_path):
    used, whole = [], chapters._chapter
    monkeypatch.setattr(chapters, "_chapter", lambda one: used.append(one.__name__) or whole(one))
    told = run("--only", "27", "--format", "json", "-o", str(tmp_path)).stderr
    # To the end of the section, whose letters follow from all of it.
    assert [name.rpartition(".")[2] for name in used] == ["model", "steady", "one_contact"]
    assert f"deriving {list(CONTENTS).index('eq27') + 1} records for the 1 asked for" in told


def test_the_example_of_the_help_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run(*shlex.split(main.commands["derive"].example)[2:])
    assert r"\label" in (tmp_path / "my-thesis" / "derivations.tex").read_text(encoding="utf-8")


# Closure, numbers, letters


def test_closure_adds_the_premises(tmp_path):
    found = list(derived(tmp_path, "eq46", "--closure"))
    assert found[-1] == "eq46"
    assert {"eq3", "eq28", "load", "scaling"} <= set(found)


def test_numbers_are_those_of_the_scene(tmp_path):
    overrides = ["support.mass=2000 kg/m", "drive.velocity=50 mm/s"]
    found = derived(tmp_path, "27,28,load,coefficient,F3", "--numbers", overrides=overrides)
    state = kv.steady(kv.load_scene(None, overrides))
    numbers = {label: entry["numbers"][-1] for label, entry in found.items() if entry["numbers"]}
    for label, value in {
        "eq27": state.trailing_edge, "eq28": state.half_length, "load": 2000 * 9.80665,
        "coefficient": state.friction_coefficient, "F3": 2 - 3**0.5,
    }.items():  # fmt: skip
        assert numbers[label]["value"] == pytest.approx(value, rel=1e-12)
    assert r"(500\," not in numbers["eq28"]["substituted"]
    assert r"10\,\mathrm{mm}" in numbers["eq28"]["substituted"]
    assert numbers["eq28"]["unit"] == "m"


POWER = {"shape": "power-law", "length": "10 mm"}
WEDGE = {"shape": "wedge", "inclination": "0.1"}
CASES = (
    (SUPPORTS, {"shape": "parabola", "radius": "10 mm"}, "100 mm/s", "coefficient", None),
    (SUPPORTS[1:], {"shape": "sphere", "radius": "10 mm"}, "100 mm/s", "F20", "a/R"),
    (SUPPORTS[:1], {**POWER, "exponent": "3"}, "100 mm/s", "F19", "d/a"),
    (SUPPORTS[2:], {**POWER, "exponent": "1.5"}, "0.1 um/s", "F19", "d/a"),
    (SUPPORTS[:2], WEDGE, "1 mm/s", "wedge-peeling", "d/a"),
    (SUPPORTS[1:], WEDGE, "100 mm/s", "wedge-peeled", "d/a"),
)


@pytest.mark.parametrize(
    ("support", "shape", "velocity", "label", "scale"),
    [(support, *case) for supports, *case in CASES for support in supports],
)
def test_every_closed_form_takes_numbers(tmp_path, support, shape, velocity, label, scale):
    """The friction coefficient of the records of each shape is that of `steady`."""
    given = {f"indenter.{key}": value for key, value in shape.items()}
    given |= {"support.kind": support, "drive.velocity": velocity}
    if support == "suspended":
        given["support.stiffness"] = "1 MN/m" if shape["shape"] == "sphere" else "1 MN/m^2"
    if support != "fixed" and shape["shape"] == "sphere":
        given["support.mass"] = "1 kg"
    overrides = [f"{key}={value}" for key, value in given.items()]
    records = derived(tmp_path, f"{label},eq29", "--numbers", overrides=overrides)
    state = kv.steady(kv.load_scene(None, overrides))
    unit = {None: 1.0, "a/R": state.half_length / 0.01, "d/a": state.depth / state.half_length}
    found = {name: record["numbers"] for name, record in records.items()}
    value = found[label][-1]["value"] * unit[scale]
    assert value == pytest.approx(state.friction_coefficient, rel=1e-9)
    assert found["eq29"][-1]["value"] == pytest.approx(state.retardation_length, rel=1e-12)


def test_numbers_are_of_records_about_this_shape_and_others_are_named(tmp_path):
    """The closed forms of other shapes, and of the other regime of a wedge, have none."""
    for shape, labels in {"wedge": {"wedge", "wedge-peeled"}, "parabola": {"eq27", "F1"}}.items():
        overrides = {"wedge": ["indenter.shape=wedge", "indenter.inclination=0.1"]}.get(shape, [])
        options = [part for each in overrides for part in ("--set", each)]
        told = run("--only", "wedge,eq27,F1,F20", "--numbers", "--format", "json",
                   "-o", str(tmp_path), *options)  # fmt: skip
        records = json.loads((tmp_path / "derivations.json").read_text(encoding="utf-8"))
        found = {record["label"] for record in records if record["numbers"]}
        assert labels <= found
        assert all(label.startswith("wedge") == (shape == "wedge") for label in found)
        assert not any(label.startswith("F20") for label in found)
        assert shape != "wedge" or found == labels
        assert f"no numbers of this scene in {len(records) - len(found)}" in told.stderr


ARMS = 'foundation.arms=[["50 GN/m^3", "100 ms"], ["20 GN/m^3", "5 ms"]]'


@pytest.mark.parametrize("shape", ["parabola", "sphere"])
def test_numbers_on_a_prony_series_are_those_of_the_scene(tmp_path, shape):
    """Also where the load follows by quadrature over the strips; dashpots and limits have none."""
    overrides = ["foundation.kind=generalized-maxwell", "foundation.stiffness=5 GN/m^3", ARMS,
                 f"indenter.shape={shape}", "indenter.radius=10 mm", "drive.velocity=50 mm/s"]  # fmt: skip
    if shape == "sphere":
        overrides += ["support.mass=1 kg", "indenter.radius_across=20 mm"]
    labels = "28,29,F1,F17-concave,F17-kelvin-voigt,F17-limits,F17-moments,F17-parts,F18-voigt,F20,F20-any"
    records = derived(tmp_path, labels, "--numbers", overrides=overrides)
    found = {
        (label, row["symbol"]): row["value"]
        for label, record in records.items() for row in record["numbers"]
    }  # fmt: skip
    state = kv.steady(kv.load_scene(None, overrides))
    expected = {
        "parabola": {
            ("F17-concave", "a"): state.half_length,
            ("F17-parts", "a"): state.half_length,
            ("F17-parts", "F_{z}"): state.load,
            ("F17-parts", "F_{x}"): state.friction_force,
        },
        "sphere": {
            ("F20-any", r"W_{\mathrm{s}}"): state.load,
            ("F20-any", r"F_{\mathrm{s}}"): state.friction_force,
        },
    }[shape]
    geometry = {("eq28", "a"): state.half_length, ("eq28", r"\delta"): state.depth}
    moments = {("F17-parts", name) for name in ("P", "D", "E", "A", "B", r"\eta")}
    assert moments <= found.keys() or shape == "sphere"
    found = {key: value for key, value in found.items() if key not in moments}
    assert found == pytest.approx(geometry | expected, rel=1e-10)


def test_an_arm_has_numbers_where_it_is_the_only_one(tmp_path):
    overrides = ["foundation.kind=generalized-maxwell", "drive.velocity=50 mm/s",
                 'foundation.arms=[["50 GN/m^3", "100 ms"]]']  # fmt: skip
    records = derived(tmp_path, "F17-load,F17", "--numbers", overrides=overrides)
    load, friction = (records[label]["numbers"][-1]["value"] for label in ("F17-load", "F17"))
    state = kv.steady(kv.load_scene(None, overrides))
    length = state.trailing_edge - state.leading_edge
    a, c, K = state.half_length, length, 10e9
    spring = K * (c**3 / 12 + (a / c - 0.5) * c**3 / 2) / 0.01
    assert 50e9 * c**3 / 0.01 * load + spring == pytest.approx(state.load, rel=1e-9)
    work = K * (a / c - 0.5) ** 2 * c**4 / 2 + 50e9 * c**4 * friction
    assert work / 0.01**2 == pytest.approx(state.friction_force, rel=1e-9)


def test_numbers_hold_far_from_the_scale_of_a_contact(tmp_path):
    """The trailing edge is 1e-294 m, where its closed form cancels to hundreds of digits."""
    overrides = ["foundation.stiffness=1e300 N/m^3"]
    found = derived(tmp_path, "eq27,F3", "--numbers", overrides=overrides)
    expected = 1000 * 9.80665 / (1e299 * 0.1)  # W -> C V delta, x_TE -> a^2/(2 l_r) = R delta/l_r
    assert found["eq27"]["numbers"][-1]["value"] == pytest.approx(expected, rel=1e-12)


def test_the_name_of_a_scene_is_no_markup(tmp_path):
    hostile = tmp_path / "`<script>$a$.toml"
    hostile.write_text(commands.run("scene").stdout, encoding="utf-8")
    run("--only", "29", "--numbers", str(hostile), "--format", "html,md,tex", "-o", str(tmp_path))
    html, md, tex = (
        (tmp_path / f"derivations.{kind}").read_text() for kind in ("html", "md", "tex")
    )
    assert "<script" not in html + tex
    lines = [line for line in md.splitlines() if "<script" in line]
    assert lines
    assert all(line.startswith("Made by") and ": `` " in line for line in lines)


def test_markdown_and_latex_are_tame(tmp_path):
    """No sign before a letter is a tag, and a file may have any name."""
    mine = tmp_path / "中\u202e.toml"
    mine.write_text('V = "v"', encoding="utf-8")
    run("--only", "26,30", "--notation", str(mine), "--format", "md,tex,bib", "-o", str(tmp_path))
    assert "--only 26,30" in (tmp_path / "derivations.md").read_text()
    text = (tmp_path / "derivations.md").read_text(encoding="utf-8")
    assert not re.search(r"<(?!https://doi)", re.sub("`.*`", "", text))
    assert r"\lt" in text
    for kind in ("tex", "bib"):
        assert not re.search(
            "[中\u202e]", (tmp_path / f"derivations.{kind}").read_text(encoding="utf-8")
        )


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
    formats = "--format", "tex,html,md,ipynb,json"
    found = derived(tmp_path, "27,28,29", "--notation", str(mine), *formats)
    assert found["eq29"]["latex"] == r"\ell_0 = V \tau"
    assert found["eq28"]["latex"] == r"H = \sqrt{2 R \delta}"
    for path in (p for p in tmp_path.rglob("*") if p.suffix in {".tex", ".md", ".json"}):
        assert r"l_{\mathrm{r}}" not in path.read_text(encoding="utf-8"), path
    mine.write_text('R = "K"\nK = "R"\n')  # two letters can be exchanged
    found = derived(tmp_path, "3", "--notation", str(mine))
    assert found["eq3"]["latex"] == r"h(x) = \frac{x^{2}}{2 K}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('aa = "b"', "unknown symbol 'aa'; the nearest is 'a'"),
        ('a = "V"', "that letter already stands for V"),
        ('a = "e"\nx = "e"', "that letter already stands for"),
        ('a = "b + 1"', "expected one symbol"),
        *(
            (f"V = '{letter}'", "expected one symbol")
            for letter in (
                "x_{&}",
                "x_{%}",
                "x_{a_b_c}",
                "x_{^}",
                "x^*_1^*",
                "l_{\u202er}",
                "x_ä",
                r"\varalpha",
                r"x_{\foo}",
                r"x_{\input{a}}",
                "x_{<img src=x onerror=alert(1)>}",
            )
        ),
        ("a = 1", "expected text"),
        ("a = ", "not TOML"),
    ],
)
def test_letters_that_would_mislead_are_refused(no_work, tmp_path, text, message):
    mine = tmp_path / "mine.toml"
    mine.write_text(text)
    result = run("--notation", str(mine), "-o", str(tmp_path / "out"), status=2)
    assert message in result.stderr


def test_only_symbols_that_are_shown_can_clash(tmp_path):
    """An example that looks simple, and letters of symbols in other chapters."""
    mine = tmp_path / "mine.toml"
    mine.write_text('l_r = "\\\\ell"\na = "b"\nR = "\\\\varrho"\n')
    found = derived(tmp_path, "27,28", "--notation", str(mine))
    assert found["eq28"]["latex"] == r"b = \sqrt{2 \varrho \delta}"
    mine.write_text('a = "R"\n')
    given = "--only", "27,28", "--notation", str(mine), "-o", str(tmp_path / "no")
    told = run(*given, status=2).stderr
    assert "that letter already stands for R" in told
    assert not (tmp_path / "no").exists()


def test_the_citation_says_the_version(tmp_path):
    run("--only", "3", "--format", "bib", "-o", str(tmp_path))
    text = (tmp_path / "derivations.bib").read_text(encoding="utf-8")
    assert f"version = {{{kv.__version__}}}" in text
    assert "10.3389/fmech.2020.00038" in text
    assert text.count("{") == text.count("}")
