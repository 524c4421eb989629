"""The site as far as it can be looked at without building it: what is generated, what runs, what links."""

import json
import re
import shlex
from pathlib import Path

import check_site
import matplotlib as mpl
import pytest
from click.testing import CliRunner
from generators import api, commands, equations, gallery, keys, labels
from kvtheory.derivations.catalogue import CONTENTS

import kvtheory as kv
from figures.__main__ import TOPICS
from kvtheory.charts import collection
from kvtheory.charts.work_precision import Effort
from kvtheory.cli import main
from kvtheory.fitting import friction
from kvtheory.scene.files import SECTIONS
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.model import SUPPORTS
from kvtheory.scene.quantities import quantities

ROOT = Path(__file__).parent.parent
DOCS = ROOT / "docs"
NOTEBOOKS = sorted((DOCS / "gallery" / "notebooks").glob("*.ipynb"))


@pytest.fixture
def offscreen():
    before = mpl.get_backend()
    mpl.use("agg")
    yield
    import matplotlib.pyplot as plt

    plt.close("all")
    mpl.use(before)


def test_there_are_five_notebooks_and_the_gallery_lists_them():
    index = (DOCS / "gallery" / "index.md").read_text()
    assert len(NOTEBOOKS) >= 5
    assert all(f"notebooks/{path.stem}\n" in index for path in NOTEBOOKS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_keeps_no_output(path, offscreen):
    names = {}
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            exec("".join(cell["source"]), names)
    assert names["kv"] is kv


CODE = re.compile(
    r"<!-- python\n(?P<hidden>.*?)-->"
    r"|^```(?:\{code-cell\} )?(?P<kind>python|console|toml|yaml)\n(?P<shown>.*?)^```",
    re.MULTILINE | re.DOTALL,
)
"""Code of a page; what is hidden in a comment prepares what the reader has: data, a cluster."""
PROMPTS = {"console": r"\$ ", "yaml": " *- run: "}
"""What stands before a command, on a console and in a job of a CI service."""
OTHERS = "python", "pip", "pytest", "my-simulator"
"""Programs that are not run."""
PAGES = {
    path.relative_to(DOCS).as_posix(): text
    for path in sorted(DOCS.rglob("*.md"))
    if not {"_build", "generated"} & set(path.parts)
    and CODE.search(text := path.read_text("utf-8"))
}
BRIEF = Effort(repeats=1, longest=0.02, whole=0.1, every=20)
"""Of the chart on a page, which `test_charts_work_precision` tests; `test_fit` weighs more than one arm."""


def sections(text):
    """Return the sections of a scene file by their names."""
    return {
        part.partition("]")[0]: f"[{part}" for part in re.split(r"^\[(?=\w)", text, flags=re.M)[1:]
    }


TABLE1 = sections(kv.to_toml(kv.Scene()))


@pytest.mark.parametrize("name", PAGES)
def test_the_code_of_a_page_runs_in_order(name, tmp_path, monkeypatch, offscreen):
    """In an empty directory but for a scene: that of the last TOML block, or Table 1."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(collection, "QUICK", BRIEF)
    monkeypatch.setattr(friction, "MOST_ARMS", 1)
    scene, names = tmp_path / "my-scene.toml", {}
    exec(re.search("```python\n(.*?)```", PAGES["howto/index.md"], re.DOTALL)[1], names)
    scene.write_text(kv.to_toml(kv.Scene()), "utf-8")
    for piece in CODE.finditer(PAGES[name]):
        line = PAGES[name].count("\n", 0, piece.start("shown")) + 1
        if piece["kind"] == "toml":
            scene.write_text("\n".join({**TABLE1, **sections(piece["shown"])}.values()), "utf-8")
            kv.load_scene(scene)
        elif piece["kind"] in PROMPTS:
            prompt, shown = PROMPTS[piece["kind"]], piece["shown"].replace("\\\n", "")
            for command in re.findall(rf"^{prompt}(.*)", shown, re.MULTILINE):
                run_command(command)
        elif code := piece["hidden"] or piece["shown"]:
            exec(compile(code, f"{name}, line {line}", "exec"), names)
    if name == "tutorial/index.md":
        assert kv.steady(names["scene"]).notes == ()  # its layer is thin


def run_command(command):
    """Run a line of the console as it stands; it has to end well."""
    program, *arguments = shlex.split(command)
    arguments, _, target = (" ".join(map(shlex.quote, arguments))).partition(" '>' ")
    assert program in ("kvtheory", *OTHERS), command
    if program == "kvtheory":
        done = CliRunner().invoke(main, shlex.split(arguments))
        assert done.exit_code == 0, (command, done.output)
        if target:
            Path(target).write_text(done.stdout, "utf-8")


def test_every_link_in_readme_and_pages_leads_somewhere():
    for page in (ROOT / "README.md", *DOCS.rglob("*.md")):
        if {"_build", "generated"} & set(page.parts):
            continue
        text = page.read_text(encoding="utf-8")
        for target in re.findall(r"\]\((?!https?:|#)([^)#]+)", text):
            if "generated/" not in target:
                assert (page.parent / target).exists(), (page.name, target)
        for label in re.findall(r"\]\(#([^)]+)\)", text):
            assert label in {each.lower() for each in CONTENTS}, (page.name, label)


def test_a_built_site_is_checked_for_dead_links_and_for_what_is_loaded(tmp_path):
    (tmp_path / "a.html").write_text(
        '<a href="b.html#x">b</a><a href="#x">x</a><a href="c.html">c</a><a href="https://d.org">d</a>'
        '<script src="https://e.org/e.js"></script>'
    )
    (tmp_path / "b.html").write_text("")
    assert sorted(check_site.problems(tmp_path)) == [
        "a.html: c.html leads nowhere",
        "a.html: https://e.org/e.js is loaded from elsewhere",
    ]


def test_every_page_is_in_a_table_of_contents():
    listed = set()
    for page in DOCS.rglob("index.md"):
        for block in re.findall(r"```\{toctree\}\n(.*?)```", page.read_text(), re.DOTALL):
            listed |= {
                (page.parent / name).resolve()
                for name in re.findall(r"^(?:\w+ <)?([\w/-]+)>?$", block, re.MULTILINE)
            }
    pages = {
        path.with_suffix("").resolve()
        for path in (*DOCS.rglob("*.md"), *DOCS.rglob("*.ipynb"))
        if not {"_build", "generated", "_static"} & set(path.relative_to(DOCS).parts)
    }
    assert pages - listed == {(DOCS / "index").resolve()}


def test_the_reference_has_a_page_for_every_public_name():
    pages = api.pages()
    assert {f"api/{name}.md" for name in kv.__all__} < set(pages)
    for name in kv.__all__:
        assert f"`{name}`]({name}.md)" in pages["api/index.md"]
    listed = dict(re.findall(r"## (\w+)\n\n((?:- .*\n)+)", pages["api/index.md"]))
    shown = {title: set(re.findall(r"\[`(\w+)`\]", rows)) for title, rows in listed.items()}
    assert {"footprint", "stability", "steady"} < shown["Compute"]
    assert shown["Indenters"] == {model.__name__ for model in SHAPES.values()} | {
        "Profile",
        "Revolved",
    }
    assert shown["Supports"] == {model.__name__ for model in SUPPORTS.values()}
    assert all(kv.results.__name__ in getattr(kv, name).__module__ for name in shown["Results"])
    assert "pycon\n>>> " in pages["api/steady.md"]
    assert "| `radius` | m |" in pages["api/Parabola.md"]


def test_the_gallery_is_ordered_by_topic(tmp_path):
    gallery.write(tmp_path)
    folders = sorted(path for path in (tmp_path / "scripts").iterdir() if path.is_dir())
    heads = [(folder / "README.rst").read_text("utf-8").partition("\n")[0] for folder in folders]
    shown = [
        tuple(path.stem for path in sorted(folder.glob("*.py"), key=gallery.order))
        for folder in folders
    ]
    assert dict(zip(heads, shown, strict=True)) == TOPICS
    assert heads == list(TOPICS)


def test_docstrings_become_markdown_that_says_the_same():
    found = api.prose("Return |x|^n of `x`, see F1.\n\nRaises\n------\nValueError\n    If x < 0.\n")
    assert found == (
        "Return \\|x\\|\\^n of `x`, see [F1](#f1).\n\n**Raises**\n\n- `ValueError`: If x \\< 0."
    )


def test_the_page_of_commands_has_all_of_them_with_help():
    text = commands.pages()["commands.md"]
    for name in main.commands:
        assert f"## kvtheory {name}" in text
    assert "## kvtheory chart stability" in text
    assert text.count("Usage: kvtheory") >= len(main.commands)


def test_the_page_of_keys_has_every_quantity_with_unit_and_default():
    text = keys.pages()["scene-keys.md"]
    for section in SECTIONS:
        assert f"## [{section}]" in text
    for model in (kv.Parabola, kv.Suspended, kv.FractionalKelvinVoigt, kv.Sine, kv.Run):
        for name in quantities(model):
            assert f"| `{name}` |" in text
    assert "| `gravity` | m/s\\^2 | g, gravity | a finite value above 0 | 9.80665 m/s^2 |" in text


def test_the_table_of_equations_has_all_of_them_with_a_test():
    text = equations.pages()["equations.md"]
    for label in CONTENTS:
        row = re.search(rf"^\| \[{re.escape(label)}\]\(#.*$", text, re.MULTILINE)[0]
        assert "`tests/" in row
    assert "`theory/closed_forms.py::load_factor`" in text
    assert labels.mentioned('Eqs. 26-28, F17-load, "balance" and F99') == {
        "eq26", "eq27", "eq28", "F17-load", "balance",
    }  # fmt: skip


def test_exit_statuses_are_those_of_the_commands():
    text = (DOCS / "reference" / "exit-status.md").read_text()
    assert CliRunner().invoke(main, ["scene", "--problem", "none"]).exit_code == 2
    from kvtheory.cli import group as g

    for status in (g.DISAGREES, g.BAD_INPUT, g.INTERNAL_ERROR, g.INTERRUPTED, g.BROKEN_PIPE):
        assert f"| {status} |" in text


def test_the_paper_cites_what_it_lists_and_shows_what_there_is():
    paper = (ROOT / "paper.md").read_text()
    cited = set(re.findall(r"@(\w+)", paper.split("---", 2)[2]))
    known = set(re.findall(r"@\w+\{(\w+),", (ROOT / "paper.bib").read_text()))
    assert cited <= known
    for picture in re.findall(r"\]\((figures/[^)]+)\)", paper):
        assert (ROOT / picture).is_file()
