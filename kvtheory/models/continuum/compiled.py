"""The kernels compiled by numba, from the same source that runs interpreted without it."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from kvtheory import records
from kvtheory.compilation import Kernel
from kvtheory.models.continuum import (
    bulk,
    collocation,
    contact,
    deviation,
    edge_states,
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
    *(records, base_motion, edge_states, radau_iia, run, contact, collocation, memory_chains),
    *(trial_step, stepping, evaluation, maxima, deviation, bulk),
)
"""Modules that contain kernels."""

INLINED = base_motion, contact, collocation, "sliding_now", "_slack", "_probe"
"""Modules of short kernels that are called most often, and such functions of the others."""
SECONDS = 14.0
"""Time to compile, once per installation."""


class Arguments(NamedTuple):
    """Times, states, two states of workspace, deviations, extremes and settling, see `bulk.perform`."""

    times: Any
    states: Any
    rows: Any
    worst: Any
    extremes: Any
    settling: Any


NOTHING = Arguments(
    np.zeros(0), np.zeros(0, evaluation.STATE), np.zeros(0, evaluation.STATE),
    np.zeros(0, deviation.DEVIATION), np.zeros(0, maxima.EXTREME), np.zeros(0, bulk.SETTLING),
)  # fmt: skip
"""Those of a task that needs none."""
KERNEL = Kernel(bulk.perform, MODULES, SECONDS, INLINED)


def in_use(run: Any) -> bool:
    """Whether the records of a run are arrays, as compiled kernels need."""
    return isinstance(run.steps, np.ndarray)


def chosen(run: Any) -> Callable[..., int]:
    """Return the entry of the kernels, compiled if the records of the run are arrays."""
    return KERNEL if in_use(run) else bulk.perform


def prepared(run: Any) -> bool:
    """Load or compile the kernels, for a run whose records are arrays; return whether that worked."""
    return KERNEL.prepared(bulk.WALK, run, run, *NOTHING, 0, bulk.NO_BULK)


def follow(all_of: bulk.Bulk, fine: Any, other: Any, steps: int) -> None:
    """Solve many scenes with compiled kernels, see `bulk.perform`."""
    KERNEL(bulk.FOLLOW, fine, other, *NOTHING, steps, all_of)
