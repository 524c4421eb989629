"""The structure of the project: who imports whom, and what an import costs."""

import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

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


def test_import_contracts_hold():
    done = subprocess.run(
        [Path(sys.executable).parent / "lint-imports"],
        check=False,
        capture_output=True,
        text=True,
        cwd=ROOT,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 broken" in done.stdout


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
