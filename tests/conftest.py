"""How the tests are shared out among processes, and what becomes of them without the programs that they need.

What takes longest starts first: in one process the tests that compile all kernels, which the others load,
and in another one all derivations, whose proofs take half a minute and are kept, too. Where neither is known
yet, no process then does what another one does. What a file sets up is shared by its tests, so other scopes
are files.
"""

import gc
import os
import shutil
import sys
from functools import cache
from pathlib import Path

import mpmath as mp
import pytest
from hypothesis import settings

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "docs"))  # the generators of the site

settings.register_profile("any processor", settings(), deadline=None)
settings.load_profile("any processor")  # a busy machine fails no test

FIRST = (
    *(
        "kernels",
        "derivations",
        "test_compare_faults",
        "test_figures",
        "test_prony_continuum",
    ),
    *("test_cli", "test_compare", "test_fit", "test_energy", "test_planted", "test_explorer"),
    *("test_sweep_executors", "test_prony_reference", "test_charts_stability", "test_asperities"),
    *("test_start", "test_cycles"),
)
"""Scopes in the order in which they begin, then all others."""
COMPILING = "test_compiled_kernels"
"""The tests whose names begin so compile every kernel, whether it pays or not."""
DERIVING = "derivations.catalogue import", "(by_label)", "$ kvtheory derive"
"""In the text of a file of tests, or of a page, that derives everything or most of it."""

PACKAGES = {"chromium": "chromium", "pdflatex": "texlive-latex-base"}
"""Programs that are not Python's, and the packages of Debian that hold them."""
MISSING = "{} is not installed"


def required(program: str) -> str:
    """Return the path of a program; without it, skip the test, or fail in CI."""
    found = shutil.which(program)
    if found is None:
        (pytest.fail if os.environ.get("CI") else pytest.skip)(MISSING.format(program))
    return found


@pytest.fixture(scope="session")
def by_label():
    """All derivations by their labels."""
    from kvtheory.derivations.catalogue import catalogue

    return {derivation.label: derivation for derivation in catalogue()}


def digits(count):
    """Return a fixture for all tests of a file: mpmath computes with so many digits."""

    @pytest.fixture(autouse=True)
    def with_digits():
        with mp.workdps(count):
            yield

    return with_digits


@pytest.fixture
def interpreted(monkeypatch):
    """Let no motion on a Prony series wait 20 s for its kernels."""
    from kvtheory.models.continuum.prony import trajectory

    monkeypatch.setattr(trajectory.KERNEL, "worthwhile", lambda *_: False)


@pytest.fixture(scope="session")
def site(tmp_path_factory):
    """The directory in which `make docs` looks for what need not be made again."""
    given = os.environ.get("KVTHEORY_SITE")
    return ROOT / given if given else tmp_path_factory.mktemp("site")


def pytest_terminal_summary(terminalreporter):
    """Say what was not tested for want of a program, and how to install it."""
    reasons = [str(report.longrepr) for report in terminalreporter.stats.get("skipped", [])]
    for program, package in PACKAGES.items():
        count = sum(MISSING.format(program) in reason for reason in reasons)
        if count:
            terminalreporter.write_line(
                f"Not tested: {count} tests that need {program}. On Debian: sudo apt-get install {package}",
                yellow=True,
            )


@cache
def derives(path: Path) -> bool:
    """Whether a file of tests or a page of the site derives most of the catalogue."""
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    return any(part in text for part in DERIVING)


def scope_of(nodeid: str) -> str:
    """Return the name of the scope of a test: its file, or what shares kernels or derivations."""
    path, _, name = nodeid.partition("::")
    if name.startswith(COMPILING):
        return "kernels"
    page = name.partition("[")[2].rstrip("]")
    deriving = path.startswith("tests/") and (
        derives(ROOT / path) or (page.endswith(".md") and derives(ROOT / "docs" / page))
    )
    return "derivations" if deriving else Path(path).stem


def pytest_collection_modifyitems(items):
    """Put scopes in order."""
    ranks = {scope: rank for rank, scope in enumerate(FIRST)}
    items.sort(key=lambda item: ranks.get(scope_of(item.nodeid), len(FIRST)))


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Let the garbage collector pass over all that the tests import, and come less often."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()
        gc.set_threshold(50_000)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config, log):
    """Hand out the scopes in this order, and not those with most tests first."""
    from xdist.scheduler import LoadScopeScheduling

    class Scheduling(LoadScopeScheduling):
        def _split_scope(self, nodeid):
            return scope_of(nodeid)

    config.option.loadscopereorder = False
    return Scheduling(config, log)
