"""A transient in progress: rows of floats, so that one source can be interpreted and compiled.

Interpreted, rows are lists; compiled, they are arrays. Both have room for more than is there, and the
walk stops before the room runs out.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum.contact import TOUCHING
from kvtheory.models.continuum.radau_iia import Method, radau, stages_for
from kvtheory.scene.base_motion import BaseMotion

S, D, V, SPAN, KINK = range(5)
"""Indices of `now`: time, depth, depth rate, the length of the next step, and the last kink or jump of the
drive."""
PIECE, MET, SMOOTH, TOGGLES, RECORDS, NODES, EVENTS, REJECTED, EVALUATIONS = range(9)
"""Indices of `counts`: the piece of the drive, whether its beginning was dealt with, whether the motion
goes on smoothly from the last record, the changes of state at this instant; then how many there are."""

SIDES = (-1.0, 1.0)

ROOM = 64
"""Records at first; a start from rest takes some thirty."""
PER_STEP, EVENTS_PER_STEP = 8, 8
"""Nodes and events that one step may add; a landing may also double the nodes."""

EVENT_SHARE, EVENT_FLOOR = 1e-4, 1e-12
"""Share of the tolerance by which a state of an edge must be violated, or rounding would toggle it."""


class StepControl(NamedTuple):
    """What sets the steps beside the tolerance.

    `first_step` is in units of the fastest time constant, after a jump; if it is too long it is
    rejected. `longest` is in units of tau: what the foundation forgets does not hide between the
    probes of a step. A step grows by no more than `grow`; the first step after an event, or on a piece
    of the drive, takes at most `straight` of the way to the next event or the end of the piece.
    `stages` of the Radau IIA method, if they are zero, are as many as is cheapest for the tolerance.
    """

    first_step: float = 0.3
    longest: float = 0.5
    grow: float = 10.0
    straight: float = 1.0
    stages: int = 0


class Given(NamedTuple):
    """What never changes in a run, beside the drive.

    Inertia number, support number, the time at which to stop; whether the indenter is fixed, tolerance
    of a step, how far a state of an edge may be violated.
    """

    eps: float
    kappa: float
    end: float
    fixed: bool
    rtol: float
    allowed: float
    control: StepControl
    method: Method


class Run(NamedTuple):
    """A transient in progress; `records`, `nodes` and `events` are its outcome.

    Of each edge, the left one first, there are its state, its innermost node and its material coordinate.
    """

    given: Given
    pieces: Any
    now: Any
    counts: Any
    states: Any
    tops: Any
    edges: Any
    records: Any
    nodes: Any
    events: Any
    matrix: Any


def begin(
    drive: BaseMotion,
    numbers: tuple[float, float],
    end: float,
    rtol: float,
    control: StepControl,
    *,
    arrays: bool = False,
) -> Run:
    """Return a run at rest: the stationary contact at d = 1; `numbers` are eps and kappa.

    Its rows are lists, or arrays for compiled kernels.
    """
    eps, kappa = numbers
    fixed, stages = math.isinf(kappa), control.stages or stages_for(rtol)
    allowed = max(EVENT_SHARE * rtol, EVENT_FLOOR)
    method = _arrays_of(stages) if arrays else radau(stages)
    given = Given(eps, 0.0 if fixed else kappa, end, fixed, rtol, allowed, control, method)
    small: Any = [0.0] * 5, [0] * 9, [0.0] * 2, [0] * 2, [0.0] * 2
    sizes = (
        (ROOM, h_.POWERS + 1 + stages), (3 * ROOM, c_.SIZE), (ROOM, 2), (stages + 3, stages + 1)
    )  # fmt: skip
    if arrays:
        large: Any = map(np.zeros, sizes)
        run = Run(given, drive.rows, *map(np.array, small), *large)
    else:
        run = Run(given, drive.rows.tolist(), *small, *(_lists(*size) for size in sizes))
    rest(run)
    return run


def rest(run: Run) -> None:
    """Put a run at rest at its beginning."""
    for i in range(len(run.counts)):
        run.counts[i] = 0
    run.counts[NODES] = 2
    now = run.now
    now[S], now[D], now[V], now[SPAN], now[KINK] = 0.0, 1.0, 0.0, math.inf, 0.0
    for k in range(2):
        run.states[k], run.tops[k], run.edges[k] = TOUCHING, k, SIDES[k]
        c_.undisturbed(SIDES[k], run.nodes[k])


def has_room(run: Run) -> bool:
    """Whether one more step surely fits."""
    return (
        run.counts[RECORDS] < len(run.records)
        and 2 * run.counts[NODES] + PER_STEP <= len(run.nodes)
        and run.counts[EVENTS] + EVENTS_PER_STEP <= len(run.events)
    )


def with_more_room(run: Run) -> Run:
    """Return the run with room for twice as much."""
    return run._replace(
        records=_doubled(run.records), nodes=_doubled(run.nodes), events=_doubled(run.events)
    )


def as_arrays(run: Run) -> Run:
    """Return the run, however far it has come, with arrays for rows."""
    given = run.given._replace(method=_arrays_of(len(run.given.method.nodes)))
    return Run(given, *map(np.array, run[1:]))


@cache
def _arrays_of(stages: int) -> Method:
    return Method(*map(np.array, radau(stages)))


def _lists(count: int, size: int) -> list[list[float]]:
    return [[0.0] * size for _ in range(count)]


def _doubled(rows: Any) -> Any:
    if isinstance(rows, np.ndarray):
        return np.concatenate([rows, np.zeros_like(rows)])
    return rows + _lists(len(rows), len(rows[0]))
