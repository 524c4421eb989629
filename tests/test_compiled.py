"""Compiled and interpreted kernels: one source, the same numbers to the last bit."""

import collections
import errno
import importlib
import os
import subprocess
import sys
import types
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import kvtheory as kv
from kvtheory import compilation
from kvtheory.models.continuum import compiled, solver
from kvtheory.models.continuum.prony import trajectory
from kvtheory.models.continuum.solver import solve
from kvtheory.models.elements import row
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


def test_compiled_kernels_give_the_same_bits(both):
    for case, fast, slow in both:
        assert (fast.compiled, slow.compiled) == (True, False)
        assert np.array_equal(fast.records, slow.records)
        assert np.array_equal(fast.nodes, slow.nodes)
        assert fast.events == slow.events
        for name in ("rejected", "evaluations"):
            assert getattr(fast.counts, name) == getattr(slow.counts, name)
        np.testing.assert_array_equal(fast.natural, slow.natural)
        one, other = fast.states(case.times), slow.states(case.times)
        for name in one.dtype.names:
            np.testing.assert_array_equal(one[name], other[name])


def test_a_run_that_goes_on_compiled_gives_the_same_bits(monkeypatch):
    pytest.importorskip("numba")
    monkeypatch.setattr(solver, "ATTEMPTS", 7)
    asked = iter([False] * 4)
    monkeypatch.setattr(compiled.KERNEL, "worthwhile", lambda *_: next(asked, True))
    given = BaseMotion.from_points([(0, 4), (0.5, 4), (0.5, -4)], 1.5)
    mixed = solve(given, 0.04, 0.5, 1.5)
    whole = solve(given, 0.04, 0.5, 1.5, fast=False)
    assert next(asked, None) is None
    assert mixed.compiled
    assert not whole.compiled
    assert np.array_equal(mixed.records, whole.records)
    assert mixed.events == whole.events


@pytest.mark.parametrize(
    ("spent", "left", "most", "later", "on_disk", "wanted"),
    [
        (0.0, 0.0, 1.0, 0.0, True, False), (0.9, 0.0, 1.0, 0.0, True, False),
        (0.9, 0.2, 1.0, 0.0, True, False), (0.9, 1.0, 1.0, 0.0, True, True),  # loading takes 1.2
        (1.3, 0.0, 1.0, 0.0, True, True), (1.3, 0.0, 1.0, 0.0, False, False),
        (19.0, 8.0, 1.0, 0.0, False, False), (19.0, 12.0, 1.0, 0.0, False, True),  # compiling takes 20
        (20.1, 0.0, 1.0, 0.0, False, True), (5.0, 1e9, 1.0, 0.0, False, False),
        (5.0, 1e9, 9.0, 0.0, False, True), (5.0, 0.0, 1.0, 1e9, False, True),
        (0.01, 1e9, 9.0, 0.0, True, False), (np.inf, 0.0, 1.0, 0.0, False, True),
    ],
)  # fmt: skip
def test_kernels_are_compiled_where_the_work_that_is_left_pays_for_it(
    spent, left, most, later, on_disk, wanted, monkeypatch
):
    monkeypatch.setattr(compilation, "available", lambda: True)
    monkeypatch.setattr(compilation, "linked", lambda: True)
    monkeypatch.setattr(compilation, "pace", lambda: 1.0)
    kernel = compilation.Kernel(solve, (), 20.0)
    kernel.spent, kernel.on_disk = spent, on_disk
    with kernel.followed_by(later):
        assert kernel.worthwhile(left, most) is wanted
    assert kernel.later == 0.0


@pytest.mark.parametrize(("on_arms", "step"), [(True, 12e-3), (False, 1e-3)])
def test_a_run_asks_for_compiled_kernels_once_it_has_cost_as_much_as_to_load_them(
    on_arms, step, monkeypatch
):
    """An attempted step takes so long on a slow machine; and it is said that kernels are compiled."""
    kernel = trajectory.KERNEL if on_arms else compiled.KERNEL
    kernels = trajectory.evaluation if on_arms else compiled.bulk
    perform, clock = kernels.perform, [0.0]

    def timed(task, *given):
        clock[0] += step * next(attempts for attempts in given if isinstance(attempts, int))
        return perform(task, *given)

    def stop(share, words):
        if words == COMPILING:
            raise TimeoutError(words)

    monkeypatch.setattr(kernels, "perform", timed)
    for known in (compilation, compiled):
        monkeypatch.setattr(known, "thread_time", lambda: clock[0])
    for name, value in {"pace": lambda: 1.0, "available": lambda: True}.items():
        monkeypatch.setattr(compilation, name, value)
    for name, value in {
        "compiled": None, "spent": 0.0, "on_disk": True, "_loaded": lambda _: None
    }.items():  # fmt: skip
        monkeypatch.setattr(kernel, name, value)
    arms = {"foundation": kv.GeneralizedMaxwell("5 GN/m^3", arms=[("5 GN/m^3", "20 ms")])}
    scene = kv.Scene(**arms if on_arms else {})
    with pytest.raises(TimeoutError, match=COMPILING):
        collections.deque((kv.transient(scene, rtol=1e-9, progress=stop) for _ in range(20)), 0)
    assert compilation.LOADING / compilation.ENOUGH <= kernel.spent < 1.15 * compilation.LOADING


def test_profiles_of_an_interpreted_run_are_compiled_where_that_pays(monkeypatch):
    pytest.importorskip("numba")
    drive = BaseMotion.constant(4.0, 0.5)
    run = trajectory.solve(drive, [(3.0, 0.1)], (3e-3, 0.0), 0.5, 1e-6, fast=False)
    xi, found, calls = np.linspace(-1.1, 1.1, 9), {}, []
    compiled_entry = trajectory.KERNEL.__call__
    monkeypatch.setattr(
        type(trajectory.KERNEL), "__call__", lambda _, *how: calls.append(1) or compiled_entry(*how)
    )
    for pays in (False, True):
        monkeypatch.setattr(trajectory.KERNEL, "worthwhile", lambda *_, pays=pays: pays)
        assert not calls
        found[pays] = run.pressure(xi, 0.2), run.compression(xi, 0.2)
    assert calls
    assert np.array_equal(found[False], found[True])
    assert found[True][0].max() > 0.0


def test_interpreted_work_is_counted_and_that_of_compiled_kernels_is_not(monkeypatch):
    monkeypatch.setattr(compiled.KERNEL, "spent", 0.0)
    monkeypatch.setattr(compiled.KERNEL, "compiled", None)
    monkeypatch.setattr(compilation, "available", lambda: False)
    assert not solve(BaseMotion.constant(4.0, 2.0), 0.04, 0.0, 2.0).compiled
    assert compiled.KERNEL.spent > 0.0


def test_a_changed_kernel_is_compiled_anew(tmp_path):
    """The digest of the sources is part of the key under which numba keeps the compiled entries."""
    source = Path(compiled.MODULES[0].__file__)
    copy = types.SimpleNamespace(__file__=str(tmp_path / source.name))
    others = compiled.MODULES[1:]

    def digest():
        return compilation.Kernel(solve, (copy, *others), 1.0).digest

    Path(copy.__file__).write_bytes(source.read_bytes())
    before = digest()
    assert before == compiled.KERNEL.digest
    Path(copy.__file__).write_bytes(source.read_bytes() + b"\n")
    assert digest() != before


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


SHORT = """
def third(x):
    return x / 3.0
def sixth(x):
    return 0.5 * third(x)
def twelfth(x):
    return 0.5 * sixth(x)
def untyped(x):
    return [x, {}][int(x)]
"""


@pytest.fixture
def short(tmp_path, monkeypatch):
    """Return a function that makes a kernel of a file, kept in a new folder; nothing is known of numba."""
    pytest.importorskip("numba")
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(compilation, "_unusable", [])
    for known in (compilation.linked, compilation._imported):
        monkeypatch.setattr(compilation, known.__name__, cache(known.__wrapped__))
    (tmp_path / "short_kernels.py").write_text(SHORT)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "short_kernels", raising=False)
    module = importlib.import_module("short_kernels")
    return lambda name="twelfth": compilation.Kernel(getattr(module, name), (module,), 1.0)


def test_what_others_call_is_optimised_with_the_entry_only(short, monkeypatch):
    codegen = pytest.importorskip("numba.core.codegen")
    assert compilation.linked()
    finalize, done = codegen.CPUCodeLibrary.finalize, []
    monkeypatch.setattr(
        codegen.CPUCodeLibrary, "finalize", lambda self: (done.append(self.name), finalize(self))
    )
    for _ in range(2):
        kernel = short()
        assert kernel.prepared(24.0)
        assert kernel(24.0) == 2.0
    assert done == ["entry"]


def test_compiling_is_reported_and_loading_what_is_compiled_is_not(short):
    told = []
    with listening(lambda share, words: told.append((share, words))) as report:
        report(0.25, "begun")
        for expected in (False, True):
            kernel = short()
            assert kernel.on_disk is expected
            assert kernel.prepared(1.5)
    assert told == [(0.25, "begun"), (0.25, COMPILING)]


def test_a_progress_function_may_stop_the_call_before_kernels_are_compiled(short):
    def stop(share, words):
        raise TimeoutError(words)

    kernel = short()
    with listening(stop), pytest.raises(TimeoutError, match=COMPILING):
        kernel.prepared(1.5)
    assert compilation.available()
    assert kernel.prepared(1.5)


def test_kernels_that_cannot_be_kept_are_compiled_with_a_warning(short, monkeypatch):
    """No place for the cache, as of a function without a file, or no space at it."""
    homeless, known = {}, short()
    exec(SHORT, homeless)
    kernel = compilation.Kernel(homeless["third"], known.modules, 1.0)
    with pytest.warns(RuntimeWarning, match="every process compiles them again.*NUMBA_CACHE_DIR"):
        assert kernel.prepared(1.5)
    assert kernel(1.5) == 0.5

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("os.replace", full)
    with pytest.warns(RuntimeWarning, match="No space left.*NUMBA_CACHE_DIR"):
        assert known.prepared(24.0)
    assert known(24.0) == 2.0


@pytest.mark.parametrize("left", [b"", b"\x80damaged", None])
def test_damaged_files_of_kernels_are_replaced(short, tmp_path, left):
    """Emptied, overwritten or cut in half: the entry is compiled anew, and kept again."""
    assert short().prepared(24.0)
    kept = [path for path in (tmp_path / "kept").rglob("*") if path.is_file()]
    assert kept
    for path in kept:
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2] if left is None else left)
    anew = short()
    assert anew.prepared(24.0)
    assert anew(24.0) == 2.0
    again = short()
    assert again.on_disk
    assert again.prepared(24.0)
    assert sum(again.compiled.stats.cache_hits.values()) == 1


def gone(*_, **__):
    raise AttributeError("gone")


BREAKS = {
    "a class of the code": lambda m: m.delattr("numba.core.codegen.JITCodeLibrary"),
    "the compiler": lambda m: m.delattr("numba.core.compiler.Compiler"),
    "what is linked": lambda m: m.setattr(
        "numba.core.codegen.CPUCodeLibrary._linking_libraries", property(gone), raising=False
    ),
    "caching of objects": lambda m: m.delattr(
        "numba.core.codegen.CodeLibrary.enable_object_caching"
    ),
    "an option": lambda m: m.setitem(compilation.PRIVATE, "gone", True),
}
"""What other versions of numba may lack, of all that `linking` takes for granted."""


@pytest.mark.parametrize("lacking", BREAKS)
def test_a_numba_that_cannot_link_kernels_compiles_them_in_its_own_way(short, lacking, monkeypatch):
    monkeypatch.delitem(sys.modules, "kvtheory.linking", raising=False)
    with monkeypatch.context() as broken:
        BREAKS[lacking](broken)
        assert not compilation.linked()
    kernel = short()
    assert kernel.prepared(24.0)
    assert kernel(24.0) == 2.0
    assert compilation.available()
    sys.modules.pop("kvtheory.linking", None)


def test_files_that_numba_does_not_keep_as_expected_are_no_error(short, monkeypatch):
    monkeypatch.delattr("numba.core.caching.Cache.load_overload")
    kernel = short()
    assert not kernel.on_disk


def test_a_numba_that_cannot_compile_is_used_no_more_and_told_of_once(short):
    kernel = short("untyped")
    with pytest.warns(RuntimeWarning, match="numba cannot compile.*interpreted.*install") as told:
        assert [kernel.prepared(1.0) for _ in range(2)] == [False, False]
    assert len(told) == 1
    assert not compilation.available()
    assert not kernel.pays(np.inf)


@pytest.mark.parametrize("on_arms", [False, True])
def test_a_motion_whose_kernels_cannot_be_compiled_is_interpreted(on_arms, short, monkeypatch):
    broken = trajectory.KERNEL if on_arms else compiled.KERNEL
    monkeypatch.setattr(broken, "compiled", None)
    monkeypatch.setattr(broken, "spent", np.inf)
    monkeypatch.setattr(broken, "_loaded", lambda _: None)
    monkeypatch.setattr(broken, "_made_for", gone)
    drive = BaseMotion.constant(1.0, end=0.5)
    arms = [[(5.0, 1.0)], (0.04, 0.0)] if on_arms else [0.04, 0.0]
    with pytest.warns(RuntimeWarning, match="AttributeError: gone") as told:
        motion = (trajectory if on_arms else solver).solve(drive, *arms, 0.5, 1e-6)
    assert len(told) == 1
    assert not motion.compiled
    states = motion.states([0.5])
    assert np.isfinite(states["depth"]).all()


def test_many_scenes_whose_kernels_cannot_be_compiled_are_interpreted(short, monkeypatch):
    for kernel in (compiled.KERNEL, row.KERNEL):
        monkeypatch.setattr(kernel, "compiled", None)
        monkeypatch.setattr(kernel, "spent", np.inf)
        monkeypatch.setattr(kernel, "_loaded", lambda _: None)
        monkeypatch.setattr(kernel, "_made_for", gone)
    with pytest.warns(RuntimeWarning, match="AttributeError: gone") as told:
        found = kv.sweep(over={"drive.velocity": [0.1, 0.2]}, quantities="hops")
    assert len(told) == 1
    assert found.failures == ()
    assert not kv.elements(per_length="10 /mm", at=["1 ms"], certify=False).compiled


@pytest.mark.parametrize(
    ("variable", "package", "why"),
    [("PYTHONPATH", "raise ImportError('Numba needs NumPy 2.3 or less')\n", "NumPy 2.3"),
     ("PYTHONPATH", "raise OSError('libllvmlite.so: cannot open')\n", "OSError: libllvmlite"),
     ("PYTHONPATH", "", "no attribute 'config'"), ("NUMBA_DISABLE_JIT", "", "unset")],
    ids=["NumPy", "library", "folder", "disabled"],
)  # fmt: skip
def test_an_unusable_numba_costs_the_user_of_a_command_one_line(variable, package, why, tmp_path):
    source = tmp_path / "numba" / "__init__.py"
    source.parent.mkdir()
    source.write_text(package)
    code = (
        "from kvtheory import compilation; compilation.LOADING = compilation.LOOP_TIME = 1e-9\n"
        "from kvtheory.cli import main; main(['transient', '--at', '0 ms,200 ms'])"
    )
    given = {variable: str(tmp_path) if variable == "PYTHONPATH" else "1"}
    run = subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, **given}, capture_output=True, text=True, check=True
    )  # fmt: skip
    (line,) = run.stderr.splitlines()
    assert line.startswith("kvtheory: warning: numba ")
    assert why in line
    assert "interpreted" in line
    assert "0.08966" in run.stdout
