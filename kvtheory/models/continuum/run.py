"""A transient in progress: rows of floats, so that one source can be interpreted and compiled.

Interpreted, rows are lists; compiled, they are arrays. Both have room for more than is there, and the
walk stops before the room runs out.
"""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum.contact import TOUCHING
from kvtheory.models.continuum.radau_iia import Method, radau, stages_for
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion

S, D, V, SPAN, KINK, X, W = range(7)
"""Indices of `now`: time, depth, depth rate, the length of the next step, the last kink or jump of the
drive, and on a spring the place of the indenter along x and its rate."""
PIECE, SLIDE, MET, SMOOTH, TOGGLES, RECORDS, NODES, EVENTS, REJECTED, EVALUATIONS = range(10)
"""Indices of `counts`: the piece of the drive, the piece by which the base slides under the indenter (the
same one for a rigid drive), whether its beginning was dealt with, whether the motion goes on smoothly from
the last record, the changes of state at this instant; then how many there are."""

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


class Spring(NamedTuple):
    """What holds the indenter along x: its inertia number there, damping number and stiffness number."""

    eps: float
    damping: float
    stiffness: float


RIGID = Spring(1.0, 0.0, 0.0)
"""In the place of a spring that is not there."""


class Given(NamedTuple):
    """What never changes in a run, beside the drive.

    Inertia number, support number, the time at which to stop; whether the indenter is fixed, tolerance
    of a step, how far a state of an edge may be violated. Of a drive with a spring: inertia, damping and
    stiffness along x. Then whether there is one, and how many pieces the drive has.
    """

    eps: float
    kappa: float
    end: float
    fixed: bool
    rtol: float
    allowed: float
    control: StepControl
    method: Method
    eps_x: float
    damping: float
    spring: float
    sprung: bool
    drives: int


class Run(NamedTuple):
    """A transient in progress; `records`, `nodes` and `events` are its outcome.

    Of each edge, the left one first, there are its state, its innermost node and its material coordinate.
    With a spring, `along` holds the motion along x for each record, and `pieces` goes on behind those of
    the drive with how the base slides under the indenter.
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
    along: Any


def begin(
    drive: BaseMotion,
    numbers: tuple[float, float],
    spring: Spring | None,
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
    sprung, count = spring is not None, len(drive.pieces)
    given = Given(
        eps, 0.0 if fixed else kappa, end, fixed, rtol, allowed, control, method,
        *(spring or RIGID), sprung, count,
    )  # fmt: skip
    small: Any = [0.0] * 7, [0] * 10, [0.0] * 2, [0] * 2, [0.0] * 2
    unknowns, row = 2 * stages if sprung else stages, h_.POWERS + 1 + stages
    sizes = (
        (ROOM, row), (3 * ROOM, c_.SIZE), (ROOM, 2), (unknowns + 3, unknowns + 1),
        (ROOM, row) if sprung else (1, 1),
    )  # fmt: skip
    pieces = np.array(with_slides(drive.pieces, stages)) if sprung else drive.rows
    if arrays:
        large: Any = map(np.zeros, sizes)
        run = Run(given, pieces, *map(np.array, small), *large)
    else:
        run = Run(given, pieces.tolist(), *small, *(_lists(*size) for size in sizes))
    rest(run)
    return run


def with_slides(pieces: Sequence[Sequence[float]], stages: int) -> list[list[float]]:
    """Return the pieces of a drive, as long as those by which the base slides, and room for these."""
    size = max(len(pieces[0]), b_.POWERS + 1 + stages)
    return [[*piece, *[0.0] * (size - len(piece))] for piece in pieces] + _lists(ROOM, size)


def rest(run: Run) -> None:
    """Put a run at rest at its beginning."""
    for i in range(len(run.counts)):
        run.counts[i] = 0
    run.counts[NODES] = 2
    now = run.now
    now[S], now[D], now[V], now[SPAN], now[KINK] = 0.0, 1.0, 0.0, math.inf, 0.0
    now[X] = now[W] = 0.0
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
    wider = run._replace(
        records=_doubled(run.records), nodes=_doubled(run.nodes), events=_doubled(run.events)
    )
    if not run.given.sprung:
        return wider
    return wider._replace(along=_doubled(run.along), pieces=_longer(run.pieces, len(run.records)))


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
    return _longer(rows, len(rows))


def _longer(rows: Any, count: int) -> Any:
    more = _lists(count, len(rows[0]))
    return np.concatenate([rows, more]) if isinstance(rows, np.ndarray) else rows + more
