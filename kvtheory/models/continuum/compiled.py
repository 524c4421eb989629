"""The kernels, compiled by numba from the very source that is also interpreted.

Nothing here computes. Numba is told that the functions of the kernel modules may be compiled; one entry,
`bulk.perform`, calls them, and only it is cached: each kernel is compiled once. Numba would not notice a
change of a function in another file, so the entry is named by a digest of all kernel sources.
"""

import hashlib
import inspect
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from kvtheory.models.continuum import (
    bulk,
    contact,
    coupled,
    deviation,
    evaluation,
    maxima,
    memory_chains,
    radau_iia,
    run,
    stepping,
    trial_step,
)
from kvtheory.models.continuum.bulk import perform
from kvtheory.progress import compiling
from kvtheory.scene import base_motion

MODULES = (
    *(base_motion, contact, coupled, radau_iia, run, memory_chains, trial_step, stepping),
    *(evaluation, maxima, deviation, bulk),
)
"""Where the kernels are."""

OPTIONS: Any = {"_nrt": False}
"""Kernels allocate nothing, so that numba need not count references to rows: it takes half the time."""
INLINED = base_motion, contact, radau_iia
"""Modules of short kernels that are called most."""
SHORT = ("sliding_now", "_slack", "_probe")
"""Functions of the other modules that are inlined, too."""

WORTHWHILE = 4000
"""Steps that are interpreted before it pays to compile: about a second. To load the compiled kernels takes
half a second, to compile them, once for an installation, half a minute."""


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


def in_use(run: Any) -> bool:
    """Whether a run has arrays for records, as compiled kernels need them."""
    return isinstance(run.steps, np.ndarray)


def chosen(run: Any) -> Callable[..., int]:
    """Return the entry of the kernels, compiled if the run needs that."""
    return kernel() if in_use(run) else bulk.perform


@cache
def kernel() -> Any:
    """Return the entry of the kernels, compiled; it runs without the interpreter lock.

    Raises
    ------
    ModuleNotFoundError
        If numba is not installed.
    """
    _register()

    def entry(
        task: int,
        one: Any,
        two: Any,
        times: Any,
        states: Any,
        rows: Any,
        values: Any,
        count: int,
        bulk: Any,
    ) -> int:
        return perform(task, one, two, times, states, rows, values, count, bulk)

    entry.__qualname__ = f"perform_{sources()}"
    return _kept(entry)


def follow(all_of: bulk.Bulk, fine: Any, other: Any, steps: int) -> None:
    """Follow many scenes by compiled kernels: `bulk.follow`."""
    room = all_of.workspace
    kernel()(
        bulk.FOLLOW, fine, other, room.times, room.samples, room.rows, np.zeros(2), steps, all_of
    )


@cache
def _register() -> None:
    """Tell numba that the functions of the kernel modules may be compiled."""
    from numba.extending import register_jitable

    for module in MODULES:
        for function in vars(module).values():
            if inspect.isfunction(function) and function.__module__ == module.__name__:
                inlined = module in INLINED or function.__name__ in SHORT
                register_jitable(**OPTIONS, no_cfunc_wrapper=True, forceinline=inlined)(function)


def _kept(entry: Any) -> Any:
    """Return an entry that is compiled on its first call, and cached on disk if there is a writable place."""
    from numba import njit

    try:
        compiled = njit(entry, cache=True, nogil=True, **OPTIONS)
    except RuntimeError:  # the package and the home are read-only
        compiling()
        return njit(entry, nogil=True, **OPTIONS)
    kept = compiled._cache
    load = kept.load_overload

    def load_or_forget(*key: Any) -> Any:
        found = None
        try:
            found = load(*key)
        except Exception:  # whatever damaged files raise, or those of another version
            kept.flush()
        if found is None:
            compiling()
        return found

    kept.load_overload = load_or_forget
    return compiled
