"""The kernels, compiled by numba from the very source that is also interpreted.

Nothing here computes. Numba is told that the functions of the kernel modules may be compiled; entries
call them, and only these entries are cached. Numba would not notice that a function in another file
has changed, so the entries are named by a digest of all kernel sources: after any change they are
compiled anew.
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
from kvtheory.progress import compiling
from kvtheory.scene import base_motion

MODULES = (
    base_motion,
    dense_output,
    contact,
    coupled,
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
INLINED = base_motion, dense_output, contact, radau_iia, evaluation
"""Kernels that are short and called most. A run is handed to a function as some hundred numbers, which costs
more than what is computed: with these inlined a motion takes half the time, and compiling a third more. With
all of them, it would take a quarter less, and compiling three times as long."""
SHORT = ("sliding_now", "_slack", "_probe")
"""Functions of the other modules that are inlined, too: called once or twice, or with little to do beside
being handed a run. A rigid drive gets back what a spring, which makes a run longer, takes from it."""

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


def in_use(run: Any) -> bool:
    """Whether a run has arrays for rows, as compiled kernels want them."""
    return isinstance(run.records, np.ndarray)


def chosen(function: Callable[..., Any], run: Any) -> Any:
    """Return a function of the kernels, compiled if they are in use."""
    return kernel(function) if in_use(run) else function


@cache
def kernel(function: Callable[..., Any]) -> Any:
    """Return a function of the kernels, compiled; it runs without the interpreter lock.

    Raises
    ------
    ModuleNotFoundError
        If numba is not installed.
    """
    _register()

    def entry(*given: Any) -> Any:
        return function(*given)

    entry.__qualname__ = f"{function.__name__}_{sources()}"
    return _kept(entry)


@cache
def _register() -> None:
    """Tell numba that the functions of the kernel modules may be compiled."""
    from numba.extending import register_jitable

    for module in MODULES:
        for function in vars(module).values():
            if inspect.isfunction(function) and function.__module__ == module.__name__:
                inlined = module in INLINED or function.__name__ in SHORT
                register_jitable(**UNCOUNTED, forceinline=inlined)(function)


def _kept(entry: Any) -> Any:
    """Return an entry that is compiled when it is called, and kept on the disk if there is a place."""
    from numba import njit

    try:
        compiled = njit(entry, cache=True, nogil=True, **UNCOUNTED)
    except RuntimeError:  # no place to keep it: the package and the home are read-only
        compiling()
        return njit(entry, nogil=True, **UNCOUNTED)
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
