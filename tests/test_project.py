"""The structure of the project: who imports whom, and what an import costs."""

import ast
import graphlib
import re
import subprocess
import tarfile
import zipfile
from importlib.metadata import version
from pathlib import Path

import grimp
import pytest

import kvtheory
from tests.commands import python

ROOT = Path(__file__).parent.parent


def test_help_needs_click_alone():
    heavy = python(
        "-c",
        "import sys\nfrom click.testing import CliRunner\nfrom kvtheory.cli import main\n"
        "assert CliRunner().invoke(main, ['--help']).exit_code == 0\n"
        "print([name for name in sys.modules if name.split('.')[0] in "
        "('sympy', 'matplotlib', 'scipy', 'pint', 'derivations')])",
    )
    assert heavy == "[]"


def test_one_version_everywhere():
    assert kvtheory.__version__ == version("kvtheory")
    assert f'"version": "{kvtheory.__version__}"' in (ROOT / "codemeta.json").read_text()
    assert f"version: {kvtheory.__version__}" in (ROOT / "CITATION.cff").read_text()
    assert f"## {kvtheory.__version__}" in (ROOT / "CHANGELOG.md").read_text()


def test_no_module_imports_itself_by_way_of_others():
    graph = grimp.build_graph("kvtheory", cache_dir=None)
    imports = {
        name: graph.find_modules_directly_imported_by(name) for name in sorted(graph.modules)
    }
    try:
        graphlib.TopologicalSorter(imports).prepare()
    except graphlib.CycleError as error:
        pytest.fail(f"a circle of imports: {' <- '.join(error.args[1])}")


def test_every_error_of_the_models_is_public():
    """What is raised on purpose, besides Python's own errors, can be caught by a name of `kvtheory`."""
    internal = {"OutgrownError", "TimedOutError"}  # always caught inside
    raised = set()
    for path in (ROOT / "kvtheory").rglob("*.py"):
        raised |= set(re.findall(r"^class (\w+Error)\(", path.read_text(), re.MULTILINE))
    assert raised - internal == {name for name in kvtheory.__all__ if name.endswith("Error")}


def test_the_library_speaks_python():
    """No option of the command line in the strings of what neither is nor calls the command line."""
    spoken = re.compile(r"(?<![\w<>-])(--[a-z][a-z-]+|-o)\b")
    texts = []
    for path in (ROOT / "kvtheory").rglob("*.py"):
        if {"cli", "drivers"} & set(path.parts):
            continue
        tree = ast.parse(path.read_text())
        texts += [
            (path.name, node.value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
        ]
    found = [(name, text) for name, text in texts if spoken.search(text)]
    assert found == []


HEAVY = {"derivations", "matplotlib", "netCDF4", "pint", "scipy", "sympy", "xarray"}


@pytest.mark.parametrize(
    ("command", "allowed"),
    [("steady", set()), ("transient", set()), ("elements", {"scipy"}), ("asymptotes", {"scipy"})],
)
def test_a_command_on_a_scene_in_usual_units_imports_what_it_computes_with(
    command, allowed, tmp_path
):
    path = tmp_path / "scene.toml"
    path.write_text(kvtheory.scene.template())
    imported = python(
        "-c",
        f"import sys\nsys.argv = ['kvtheory', {command!r}, {str(path)!r}, '--json']\n"
        "from kvtheory.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print(*(name.split('.')[0] for name in sys.modules), file=sys.stdout)",
    )
    assert set(imported.splitlines()[-1].split()) & HEAVY <= allowed


def test_the_shortcuts_for_usual_units_are_those_of_the_library_of_units(monkeypatch):
    from kvtheory.scene import units

    usual = {
        (written, unit): units._factor(written, unit)
        for unit in units.USUAL
        for written in units.USUAL[unit]
    }
    units._factor.cache_clear()
    monkeypatch.setattr(units, "USUAL", {})
    for (written, unit), factor in usual.items():
        assert units._factor(written, unit) == factor, (written, unit)
    units._factor.cache_clear()


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Build both from a copy of what git tracks, without the network."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("dist")
    tracked = subprocess.run(
        ["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True
    ).stdout
    for name in filter(None, tracked.split("\0")):
        if (ROOT / name).is_file():
            target = source / name
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes((ROOT / name).read_bytes())
    script = (
        "from setuptools import build_meta as b\n"
        f"print(b.build_sdist({str(out)!r}))\nprint(b.build_wheel({str(out)!r}))\n"
    )
    python("-c", script, cwd=source)
    return {path.suffix: path for path in out.iterdir()}


def test_the_wheel_takes_one_name_and_the_sdist_can_be_tested_by_a_distributor(built):
    with zipfile.ZipFile(built[".whl"]) as wheel:
        names = wheel.namelist()
    top = {name.split("/")[0] for name in names}
    assert {name for name in top if not name.endswith(".dist-info")} == {"kvtheory"}
    assert {
        "kvtheory/derivations/engine/step.py", "kvtheory/py.typed", "kvtheory/charts/atlas.toml",
        "kvtheory/plots/failures.html", "kvtheory/charts/work_precision_reference.json",
        "kvtheory/explorer/closed_forms.js", "kvtheory/explorer/explorer.css",
        "kvtheory/explorer/formulas.toml", "kvtheory/reference_problems/scenes/wedge.toml",
    } <= set(names)  # fmt: skip
    with tarfile.open(built[".gz"]) as sdist:
        names = [name.partition("/")[2] for name in sdist.getnames()]
    assert {
        "CITATION.cff", "CHANGELOG.md", "Makefile", "constraints.txt", "LICENSE",
        "tests/test_exact.py", "tests/data/transient_reference.json", "figures/fig6.py",
        "derivations/engine/step.py", "kvtheory/plots/comparison.html", "docs/conf.py", "codemeta.json",
    } <= set(names)  # fmt: skip


def test_only_the_command_line_imports_the_derivations():
    users = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "kvtheory").rglob("*.py")
        if "kvtheory.derivations" in path.read_text() or "import sympy" in path.read_text()
    }
    assert users <= {"kvtheory/cli/derive.py"}
