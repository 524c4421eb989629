"""The kernels compiled by numba, from the same source that runs interpreted without it.

Only one entry, `bulk.perform`, is cached, so that each kernel is compiled once. Numba does not notice changes
in other files, so the name of the entry contains a digest of all kernel sources.
"""

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any

import numpy as np

from kvtheory import compilation, records
from kvtheory.compilation import available
from kvtheory.models.continuum import (
    bulk,
    contact,
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
    *(records, base_motion, contact, radau_iia, run, memory_chains, trial_step, stepping),
    *(evaluation, maxima, deviation, bulk),
)
"""Modules that contain kernels."""

OPTIONS: Any = {"_nrt": False}
"""Kernels allocate nothing, so that numba need not count references; runs take less than half the time."""
INLINED = base_motion, contact, radau_iia
"""Modules of short kernels that are called most often."""
SHORT = ("sliding_now", "_slack", "_probe")
"""Functions of the other modules that are inlined too."""

WORTHWHILE = 4000
"""Number of interpreted steps after which compiling pays: about a second. Loading the compiled kernels takes
half a second; compiling them, once per installation, takes a quarter of a minute."""


class Tally:
    """Number of steps interpreted in this process."""

    steps = 0


def worthwhile() -> bool:
    """Whether to use compiled kernels from now on; they give the same numbers."""
    return Tally.steps >= WORTHWHILE and available()


def sources(modules: tuple[ModuleType, ...] = MODULES) -> str:
    """Return a digest of the source of the kernels."""
    digest = hashlib.sha256()
    for module in modules:
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()


def in_use(run: Any) -> bool:
    """Whether the records of a run are arrays, as compiled kernels need."""
    return isinstance(run.steps, np.ndarray)


def chosen(run: Any) -> Callable[..., int]:
    """Return the entry of the kernels, compiled if the records of the run are arrays."""
    return kernel() if in_use(run) else bulk.perform


@cache
def kernel(perform: Any = bulk.perform, modules: tuple[ModuleType, ...] = MODULES) -> Any:
    """Return the compiled entry of the kernels, which releases the interpreter lock; it needs numba."""
    for module in modules:
        inlined = [*vars(module)] if module in INLINED else SHORT
        own = getattr(module, "COMPILED", {})
        compilation.register(module, inlined, own, **OPTIONS, no_cfunc_wrapper=True)

    entry = FunctionType(perform.__code__, perform.__globals__, perform.__name__)
    entry.__qualname__ = f"perform_{sources(modules)}"
    return compilation.cached(entry, **OPTIONS)


def follow(all_of: bulk.Bulk, fine: Any, other: Any, steps: int) -> None:
    """Solve many scenes with compiled kernels, see `bulk.perform`."""
    room = all_of.workspace
    kernel()(
        bulk.FOLLOW, fine, other, room.times, room.samples, room.rows, np.zeros(2), steps, all_of
    )
