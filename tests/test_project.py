"""The structure of the project: who imports whom, and what an import costs."""

import ast
import graphlib
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import grimp
import pytest

import kvtheory

ROOT = Path(__file__).parent.parent


def python(code):
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=ROOT,
    )
    return done.stdout.strip()


def test_importing_pulls_in_neither_sympy_nor_matplotlib_nor_scipy():
    heavy = python(
        "import sys, kvtheory\n"
        "print([name for name in sys.modules if name.split('.')[0] in "
        "('sympy', 'matplotlib', 'scipy', 'pint', 'click', 'derivations')])"
    )
    assert heavy == "[]"


def test_help_needs_click_alone():
    heavy = python(
        "import sys\nfrom click.testing import CliRunner\nfrom kvtheory.cli import main\n"
        "assert CliRunner().invoke(main, ['--help']).exit_code == 0\n"
        "print([name for name in sys.modules if name.split('.')[0] in "
        "('sympy', 'matplotlib', 'scipy', 'pint', 'derivations')])"
    )
    assert heavy == "[]"


def test_the_exact_solution_needs_numpy_alone():
    heavy = python(
        "import sys, kvtheory\nkvtheory.steady()\n"
        "print([name for name in sys.modules if name.split('.')[0] in ('sympy', 'matplotlib', 'scipy')])"
    )
    assert heavy == "[]"


def test_one_version_everywhere():
    assert kvtheory.__version__ == version("kvtheory")
    assert f"version: {kvtheory.__version__}" in (ROOT / "CITATION.cff").read_text()
    assert f"## {kvtheory.__version__}" in (ROOT / "CHANGELOG.md").read_text()


def test_public_names_exist():
    for name in kvtheory.__all__:
        assert getattr(kvtheory, name) is not None


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
    """No option of the command line in the strings of what is not the command line."""
    spoken = re.compile(r"(?<![\w<>-])(--[a-z][a-z-]+|-o)\b")
    texts = []
    for path in (ROOT / "kvtheory").rglob("*.py"):
        if "cli" in path.parts:
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
        f"import sys\nsys.argv = ['kvtheory', {command!r}, {str(path)!r}, '--json']\n"
        "from kvtheory.cli import main\n"
        "try:\n    main()\nexcept SystemExit as end:\n    assert not end.code\n"
        "print(*(name.split('.')[0] for name in sys.modules), file=sys.stdout)"
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
