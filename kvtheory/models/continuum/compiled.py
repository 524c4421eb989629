"""The kernels, compiled by numba from the very source that is also interpreted.

Nothing here computes. Numba is told that the functions of the kernel modules may be compiled; the
entries below call them, and only these entries are cached. Numba would not notice that a function in
another file has changed, so the entries close over a digest of all kernel sources, which is part of the
key of the cache: after any change they are compiled anew.
"""

import hashlib
import inspect
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from kvtheory.models.continuum import (
    bulk,
    contact,
    dense_output,
    deviation,
    evaluation,
    maxima,
    memory_chains,
    radau_iia,
    run,
    stepping,
    trial_step,
)
from kvtheory.scene import base_motion

MODULES = (
    base_motion,
    dense_output,
    contact,
    radau_iia,
    run,
    memory_chains,
    trial_step,
    stepping,
    evaluation,
    maxima,
    deviation,
    bulk,
)
"""Where the kernels are."""

UNCOUNTED: Any = {"_nrt": False}
"""Kernels allocate nothing, so that numba need not count references to rows: it takes half the time."""


WORTHWHILE = 4000
"""Steps that are interpreted before it pays to compile: about a second. To load compiled kernels takes
half a second, to compile them, once for an installation, a quarter of a minute."""


class Tally:
    """How many steps were interpreted in this process."""

    steps = 0


def available() -> bool:
    """Whether numba is installed: the extra `fast`."""
    return find_spec("numba") is not None


def worthwhile() -> bool:
    """Whether the kernels should be compiled from now on: the numbers are the same."""
    return Tally.steps >= WORTHWHILE and available()


def sources(modules: tuple[ModuleType, ...] = MODULES) -> str:
    """Return a digest of the source of the kernels."""
    digest = hashlib.sha256()
    for module in modules:
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()


class Kernels(NamedTuple):
    """The compiled entries, named as the functions that they call; they run without the interpreter lock."""

    walk: Callable[..., int]
    states: Callable[..., None]
    deviations: Callable[..., None]
    sample: Callable[..., int]
    largest: Callable[..., tuple[float, float]]
    follow: Callable[..., None]


@cache
def kernels() -> Kernels:
    """Return the compiled entries.

    Raises
    ------
    ModuleNotFoundError
        If numba is not installed.
    """
    from numba.extending import register_jitable

    for module in MODULES:
        for function in vars(module).values():
            if inspect.isfunction(function) and function.__module__ == module.__name__:
                register_jitable(**UNCOUNTED)(function)
    digest = sources()

    def walk(progress: Any, attempts: int) -> int:
        return stepping.walk(progress, attempts) if digest else 0

    def states(times: Any, found: Any, progress: Any) -> None:
        if digest:
            evaluation.states(times, found, progress)

    def deviations(times: Any, found: Any, fine: Any, other: Any, rows: Any, worst: Any) -> None:
        if digest:
            deviation.deviations(times, found, fine, other, rows, worst)

    def sample(progress: Any, times: Any, found: Any) -> int:
        return maxima.sample(progress, times, found) if digest else 0

    def largest(
        progress: Any, times: Any, found: Any, count: int, column: int, sense: int, row: Any
    ) -> tuple[float, float]:
        if digest:
            return maxima.largest(progress, times, found, count, column, sense, row)
        return 0.0, 0.0

    def follow(
        scenes: Any, fine: Any, other: Any, asked: Any, room: Any, found: Any, steps: int
    ) -> None:
        if digest:
            bulk.follow(scenes, fine, other, asked, room, found, steps)

    return Kernels(*map(_kept, (walk, states, deviations, sample, largest, follow)))


def _kept(entry: Any) -> Any:
    """Return an entry that is compiled when it is called, and kept on the disk if there is a place."""
    from numba import njit

    try:
        compiled = njit(entry, cache=True, nogil=True, **UNCOUNTED)
    except RuntimeError:  # no place to keep it: the package and the home are read-only
        return njit(entry, nogil=True, **UNCOUNTED)
    kept = compiled._cache
    load = kept.load_overload

    def load_or_forget(*key: Any) -> Any:
        try:
            return load(*key)
        except Exception:  # whatever damaged files raise, or those of another version
            kept.flush()
            return None

    kept.load_overload = load_or_forget
    return compiled
