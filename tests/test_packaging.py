"""What is built: a wheel that holds the package alone, and an sdist from which it can be tested."""

import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent


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
    subprocess.run([sys.executable, "-c", script], cwd=source, capture_output=True, check=True)
    return {path.suffix: path for path in out.iterdir()}


def test_the_wheel_takes_one_name_and_the_sdist_can_be_tested_by_a_distributor(built):
    with zipfile.ZipFile(built[".whl"]) as wheel:
        names = wheel.namelist()
    top = {name.split("/")[0] for name in names}
    assert {name for name in top if not name.endswith(".dist-info")} == {"kvtheory"}
    assert {
        "kvtheory/derivations/step.py", "kvtheory/py.typed", "kvtheory/charts/atlas.toml",
        "kvtheory/plots/failures.html", "kvtheory/charts/work_precision_reference.json",
        "kvtheory/explorer/closed_forms.js", "kvtheory/explorer/explorer.css",
        "kvtheory/explorer/formulas.toml", "kvtheory/reference_problems/scenes/wedge.toml",
    } <= set(names)  # fmt: skip
    with tarfile.open(built[".gz"]) as sdist:
        names = [name.partition("/")[2] for name in sdist.getnames()]
    assert {
        "CITATION.cff", "CHANGELOG.md", "Makefile", "constraints.txt", "LICENSE",
        "tests/test_exact.py", "tests/data/transient_reference.json", "figures/fig6.py",
        "derivations/step.py", "kvtheory/plots/comparison.html", "docs/conf.py", "codemeta.json",
    } <= set(names)  # fmt: skip


def test_only_the_command_line_imports_the_derivations():
    users = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "kvtheory").rglob("*.py")
        if "kvtheory.derivations" in path.read_text() or "import sympy" in path.read_text()
    }
    assert users <= {"kvtheory/cli/derive.py"}
