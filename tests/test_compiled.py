"""Compiled and interpreted kernels: one source, the same numbers to the last bit."""

import errno
import types
from pathlib import Path

import numpy as np
import pytest

from kvtheory import compilation
from kvtheory.models.continuum import compiled, solver
from kvtheory.models.continuum.solver import solve
from kvtheory.progress import COMPILING, listening
from kvtheory.scene.base_motion import BaseMotion
from tests import SCENES, spring_random
from tests.commands import python
from tests.test_transient_random import random_case


@pytest.fixture(scope="module", params=[1e-3, 1e-5, 1e-8])
def both(request):
    def solved(case, fast):
        return solve(case.drive, case.eps, case.kappa, case.drive.end, request.param, fast=fast)

    cases = [random_case(seed, 1) for seed in range(500, 500 + SCENES // 8)]
    found = [(case, solved(case, True), solved(case, False)) for case in cases]
    sprung = [spring_random.random_case(seed) for seed in range(3)]
    return found + [
        (case, *(case.solved(10 * request.param, fast=fast) for fast in (True, False)))
        for case in sprung
    ]


def test_the_same_bits(both):
    for case, fast, slow in both:
        assert (fast.compiled, slow.compiled) == (True, False)
        assert np.array_equal(fast.records, slow.records)
        assert np.array_equal(fast.nodes, slow.nodes)
        assert fast.events == slow.events
        for name in ("rejected", "evaluations"):
            assert getattr(fast.counts, name) == getattr(slow.counts, name)
        np.testing.assert_array_equal(fast.natural, slow.natural)
        np.testing.assert_array_equal(fast.states(case.times), slow.states(case.times))


def test_a_run_that_goes_on_compiled_gives_the_same_bits(monkeypatch):
    monkeypatch.setattr(solver, "ATTEMPTS", 7)
    monkeypatch.setattr(compiled, "WORTHWHILE", compiled.Tally.steps + 20)
    given = BaseMotion.from_points([(0, 4), (0.5, 4), (0.5, -4)], 1.5)
    mixed = solve(given, 0.04, 0.5, 1.5)
    whole = solve(given, 0.04, 0.5, 1.5, fast=False)
    assert mixed.compiled
    assert not whole.compiled
    assert np.array_equal(mixed.records, whole.records)
    assert mixed.events == whole.events


def test_few_steps_are_interpreted(monkeypatch):
    monkeypatch.setattr(compiled.Tally, "steps", 0)
    motion = solve(BaseMotion.constant(4.0, 2.0), 0.04, 0.0, 2.0)
    assert not motion.compiled
    assert compiled.Tally.steps == motion.counts.steps + motion.counts.rejected


def test_a_changed_kernel_is_compiled_anew(tmp_path):
    """The digest of the sources is part of the key under which numba keeps the compiled entries."""
    source = Path(compiled.MODULES[0].__file__)
    copy = types.SimpleNamespace(__file__=str(tmp_path / source.name))
    Path(copy.__file__).write_bytes(source.read_bytes())
    before = compiled.sources((copy, *compiled.MODULES[1:]))
    assert before == compiled.sources()
    Path(copy.__file__).write_bytes(source.read_bytes() + b"\n")
    assert compiled.sources((copy, *compiled.MODULES[1:])) != before


def test_every_kernel_module_that_they_import_is_among_the_sources():
    """Whatever a kernel module takes from the package is a kernel module too."""
    kernels = {module.__name__ for module in compiled.MODULES}
    for module in compiled.MODULES:
        for thing in vars(module).values():
            if isinstance(thing, types.ModuleType):
                home = thing.__name__
            else:
                home = getattr(thing, "__module__", None) or ""
            assert home in kernels or not home.startswith("kvtheory")


def test_without_numba_the_kernels_are_interpreted():
    code = (
        "import sys; sys.modules['numba'] = None\n"
        "import importlib.util as util; found = util.find_spec\n"
        "util.find_spec = lambda name, *a: None if name == 'numba' else found(name, *a)\n"
        "import kvtheory as kv; result = kv.transient(at=['200 ms'])\n"
        "print(result.compiled, round(float(result.depth[0]) * 1e6, 3))"
    )
    assert python("-c", code).split() == ["False", "89.661"]


def doubled(x):
    return 2.0 * x


def third(x):
    return x / 3.0


def sixth(x):
    return 0.5 * third(x)


def twelfth(x):
    return 0.5 * sixth(x)


def test_what_others_call_is_optimised_with_the_entry_only(tmp_path, monkeypatch):
    codegen = pytest.importorskip("numba.core.codegen")
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    finalize, done = codegen.CPUCodeLibrary.finalize, []
    monkeypatch.setattr(
        codegen.CPUCodeLibrary, "finalize", lambda self: (done.append(self.name), finalize(self))
    )
    compilation.register(types.SimpleNamespace(__name__=__name__, third=third, sixth=sixth))
    for _ in range(2):
        assert compilation.cached(twelfth)(24.0) == 2.0
    assert done == ["entry"]


def test_compiling_is_reported_and_loading_what_is_compiled_is_not(tmp_path, monkeypatch):
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    told = []
    with listening(lambda share, words: told.append((share, words))) as report:
        report(0.25, "begun")
        for _ in range(2):
            assert compilation.cached(doubled)(1.5) == 3.0
    assert told == [(0.25, "begun"), (0.25, COMPILING)]


def test_kernels_that_cannot_be_kept_are_compiled_with_a_warning(tmp_path, monkeypatch):
    """No place for the cache, as of a function without a file, or no space at it."""
    homeless = {}
    exec("def doubled(x):\n    return 2.0 * x\n", homeless)
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    with pytest.warns(RuntimeWarning, match="every process compiles them again.*NUMBA_CACHE_DIR"):
        assert compilation.cached(homeless["doubled"])(1.5) == 3.0

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    with pytest.warns(RuntimeWarning, match="No space left.*NUMBA_CACHE_DIR"):
        assert compilation.cached(doubled)(1.5) == 3.0


@pytest.mark.parametrize("left", [b"", b"\x80damaged", None])
def test_damaged_files_of_kernels_are_replaced(tmp_path, monkeypatch, left):
    """Emptied, overwritten or cut in half: the entry is compiled anew, and kept again."""
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    assert compilation.cached(doubled)(1.5) == 3.0
    kept = [path for path in tmp_path.rglob("*") if path.is_file()]
    assert kept
    for path in kept:
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2] if left is None else left)
    assert compilation.cached(doubled)(1.5) == 3.0
    again = compilation.cached(doubled)
    assert again(1.5) == 3.0
    assert sum(again.stats.cache_hits.values()) == 1
