"""The kernels compiled by numba, from the same source that runs interpreted without it."""

from collections.abc import Callable
from typing import Any

import numpy as np

from kvtheory import records
from kvtheory.compilation import Kernel
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

INLINED = base_motion, contact, radau_iia, "sliding_now", "_slack", "_probe"
"""Modules of short kernels that are called most often, and such functions of the others."""
SECONDS = 14.0
"""Time to compile, once per installation."""

KERNEL = Kernel(bulk.perform, MODULES, SECONDS, INLINED)


def in_use(run: Any) -> bool:
    """Whether the records of a run are arrays, as compiled kernels need."""
    return isinstance(run.steps, np.ndarray)


def chosen(run: Any) -> Callable[..., int]:
    """Return the entry of the kernels, compiled if the records of the run are arrays."""
    return KERNEL if in_use(run) else bulk.perform


def prepared(run: Any) -> bool:
    """Load or compile the kernels, for a run whose records are arrays; return whether that worked."""
    room = bulk.NO_BULK.workspace
    return KERNEL.prepared(
        bulk.WALK, run, run, room.times, room.samples, room.rows, room.times, 0, bulk.NO_BULK
    )


def follow(all_of: bulk.Bulk, fine: Any, other: Any, steps: int) -> None:
    """Solve many scenes with compiled kernels, see `bulk.perform`."""
    room = all_of.workspace
    KERNEL(
        bulk.FOLLOW, fine, other, room.times, room.samples, room.rows, np.zeros(2), steps, all_of
    )
