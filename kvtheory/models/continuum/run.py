"""A transient in progress: rows of floats, so that one source can be interpreted and compiled.

Interpreted, rows are lists; compiled, they are arrays. Both have room for more than is there, and the
walk stops before the room runs out.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import history as h_
from kvtheory.models.continuum.contact import TOUCHING
from kvtheory.models.continuum.integrator import Method, radau, stages_for
from kvtheory.scene.base_motion import BaseMotion

S, D, V, PIECE, MET, SMOOTH, SPAN, KINK, TOGGLES = range(9)
"""Indices of `now`: time, depth, depth rate, the piece of the drive, whether its beginning was dealt
with, whether the motion goes on smoothly from the last record, the length of the next step, the last
kink or jump of the drive, and the changes of state at this instant."""
STATE, TOP, X = 9, 11, 13
"""Of each edge, the left one first: its state, its innermost node, its material coordinate."""
RECORDS, NODES, EVENTS, REJECTED, EVALUATIONS = range(15, 20)
"""How many there are."""
EPS, KAPPA, FIXED, RTOL, ALLOWED, END = range(20, 26)
"""Inertia number, support number, whether the support is fixed, tolerance of a step, how far a state
of an edge may be violated, and the time at which to stop."""
FIRST_STEP, LONGEST, GROW, STRAIGHT = range(26, 30)
"""Step control, see `StepControl`."""
SIZE = 30

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
    `stages` of the Radau IIA method are as many as is cheapest for the tolerance, unless they are given.
    """

    first_step: float = 0.3
    longest: float = 0.5
    grow: float = 10.0
    straight: float = 1.0
    stages: int | None = None


class Run(NamedTuple):
    """A transient in progress; `records`, `nodes` and `events` are its outcome."""

    now: Any
    records: Any
    nodes: Any
    events: Any
    pieces: Any
    method: Method
    matrix: Any


def begin(
    drive: BaseMotion,
    inertia_number: float,
    support_number: float,
    end: float,
    rtol: float,
    control: StepControl,
    *,
    arrays: bool = False,
) -> Run:
    """Return a run at rest: the stationary contact at d = 1."""
    fixed = math.isinf(support_number)
    stages = control.stages or stages_for(rtol)
    now = [0.0] * SIZE
    now[D], now[SPAN] = 1.0, math.inf
    now[STATE] = now[STATE + 1] = TOUCHING
    now[TOP + 1] = 1.0
    now[X], now[X + 1] = SIDES
    now[NODES] = 2.0
    now[EPS], now[KAPPA], now[FIXED] = (
        inertia_number,
        0.0 if fixed else support_number,
        float(fixed),
    )
    now[RTOL], now[ALLOWED], now[END] = rtol, max(EVENT_SHARE * rtol, EVENT_FLOOR), end
    now[FIRST_STEP:SIZE] = control[:-1]
    rows: Any = _arrays if arrays else _lists
    nodes = rows(3 * ROOM, c_.SIZE)
    for k in range(2):
        nodes[k][:] = c_.undisturbed(SIDES[k])
    pieces = [list(piece) for piece in drive.pieces]
    return Run(
        np.array(now) if arrays else now,
        rows(ROOM, h_.POWERS + 1 + stages),
        nodes,
        rows(ROOM, 2),
        np.array(pieces) if arrays else pieces,
        radau(stages, arrays),
        rows(stages + 3, stages + 1),
    )


def has_room(run: Run) -> bool:
    """Whether one more step surely fits."""
    now = run.now
    return (
        now[RECORDS] < len(run.records)
        and 2.0 * now[NODES] + PER_STEP <= len(run.nodes)
        and now[EVENTS] + EVENTS_PER_STEP <= len(run.events)
    )


def with_more_room(run: Run) -> Run:
    """Return the run with room for twice as much."""
    return run._replace(
        records=_doubled(run.records), nodes=_doubled(run.nodes), events=_doubled(run.events)
    )


def as_arrays(run: Run) -> Run:
    """Return the run, however far it has come, with arrays for rows."""
    now, records, nodes, events, pieces = (np.array(rows) for rows in run[:5])
    method = radau(len(run.method.nodes), True)
    return Run(now, records, nodes, events, pieces, method, np.array(run.matrix))


def _lists(count: int, size: int) -> list[list[float]]:
    return [[0.0] * size for _ in range(count)]


def _arrays(count: int, size: int) -> Any:
    return np.zeros((count, size))


def _doubled(rows: Any) -> Any:
    if isinstance(rows, np.ndarray):
        return np.concatenate([rows, np.zeros_like(rows)])
    return rows + _lists(len(rows), len(rows[0]))
