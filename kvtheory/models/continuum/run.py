"""A transient in progress: records with named fields, so that one source can be interpreted and compiled.

Interpreted, a record is an object with attributes, and many of them are a list; compiled, they are
structured arrays. Both have more room than is used; `stepping.walk` stops before it is full.
"""

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum.edge_states import FREE, SIDES, TOUCHING
from kvtheory.models.continuum.radau_iia import MOST_PROBES, MOST_STAGES, radau, stages_for
from kvtheory.records import blanks, filled, new, record, structured
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion

FAR = 1e150
"""Outer end of undisturbed ground; its square is finite."""
DONE, PAUSED, FULL, STUCK, INCONSISTENT = range(5)
"""How a walk ended: at the end; after the allowed attempts; without room for another step; with a step size
of zero; without a consistent state of the contact."""
ROOM = 64
"""Initial capacity in steps; a start from rest takes about thirty."""
PER_STEP, EVENTS_PER_STEP = 8, 8
"""Nodes and events that one step may add; a landing may also double the nodes."""

EVENT_SHARE, EVENT_FLOOR = 1e-4, 1e-12
"""Violation that toggles the state of an edge: a share of the tolerance, and a floor well above rounding."""


PLACE = record(X="f8", s="f8", d="f8", Y="f8")
"""Ground at X, left at the time s when depth and displacement of the base were d and Y."""
NODE = record(inner=PLACE, outer=PLACE, step="i8", branch="f8", next="i8", joined="?")
"""Ground between two places; the step in which it was swept, or -1; the sign of the root of p = 0 that swept
it; the next node outward, and whether A is smooth there."""
SIDE = record(state="i8", node="i8", X="f8")
"""State of an edge, its innermost node, and its material coordinate."""
STEP = record(
    start="f8", span="f8", depth="f8", piece="i8", sides=(SIDE, (2,)), rate=("f8", (MOST_STAGES + 1,))
)  # fmt: skip
"""Start and span of a step, depth and both sides at its start, the piece of the base motion, and the depth
rate as powers of (s - start)/span; the depth is its exact integral."""
EVENT = record(s="f8", kind="i8")
NOW = record(
    s="f8", d="f8", v="f8", span="f8", kink="f8", x="f8", w="f8",
    piece="i8", slide="i8", met="?", smooth="?", toggles="i8",
    steps="i8", nodes="i8", events="i8", rejected="i8", evaluations="i8", sides=(SIDE, (2,)),
)  # fmt: skip
"""Time, depth, depth rate, length of the next step, last kink or jump of the drive; on a spring the position
of the indenter along x and its rate. The piece of the drive, the piece by which the base slides under the
indenter (the same one for a rigid drive), whether the start of the piece was handled, whether the last step
continues smoothly, the changes of state at this instant; the numbers of steps, nodes, events, rejected steps
and evaluations; and both sides."""
GIVEN = record(
    eps="f8", kappa="f8", end="f8", fixed="?", rtol="f8", allowed="f8",
    first_step="f8", longest="f8", grow="f8", straight="f8",
    eps_x="f8", damping="f8", spring="f8", sprung="?", drives="i8",
)  # fmt: skip
"""Inertia number, support number, the time at which to stop, whether the indenter is fixed, tolerance of a
step, how far the state of an edge may be violated; step-size controls; inertia, damping and stiffness of a
spring along x, whether there is one; the number of pieces of the drive."""
_SQUARE = "f8", (MOST_STAGES, MOST_STAGES)
METHOD = record(
    stages="i8", nodes=("f8", (MOST_STAGES,)), A=_SQUARE, inverse=_SQUARE, powers=_SQUARE,
    probe_count="i8", probes=("f8", (MOST_PROBES,)), scales=("f8", (MOST_PROBES, 3)),
)  # fmt: skip
"""A `radau_iia.Method`, padded with zeros."""


class StepControl(NamedTuple):
    """Step-size controls beside the tolerance.

    `first_step`, after a jump, is in units of the fastest time constant; if it is too long it is rejected.
    `longest` is in units of tau, so that the probes of a step see fading memory. A step grows by no more
    than `grow`; the first step after an event, or on a piece of the drive, takes at most `straight` of the
    way to the next event or the end of the piece.
    """

    first_step: float = 0.3
    longest: float = 0.5
    grow: float = 10.0
    straight: float = 1.0


class Spring(NamedTuple):
    """The spring along x: inertia number, damping number and stiffness number; a rigid drive by default."""

    eps: float = 1.0
    damping: float = 0.0
    stiffness: float = 0.0


class Run(NamedTuple):
    """A transient in progress; `steps`, `nodes` and `events` are its outcome.

    Outside the kernels `given`, `method` and `now` hold one record, inside they are the record itself.
    With a spring, `along` holds the motion along x for each step, and the `pieces` after those of the
    drive are those by which the base slides under the indenter.
    """

    given: Any
    method: Any
    now: Any
    pieces: Any
    steps: Any
    nodes: Any
    events: Any
    matrix: Any
    along: Any


KINDS = {
    "given": GIVEN, "method": METHOD, "now": NOW,
    "steps": STEP, "nodes": NODE, "events": EVENT, "along": STEP,
}  # fmt: skip
"""Types of the records of a run."""


def begin(
    drive: BaseMotion, numbers: tuple[float, float], spring: Spring | None, end: float,
    rtol: float, control: StepControl, *, arrays: bool = False,
) -> Run:  # fmt: skip
    """Return a new run; `numbers` are eps and kappa. Its records are objects, or arrays if `arrays`."""
    (eps, kappa), sprung = numbers, spring is not None
    fixed, stages = math.isinf(kappa), stages_for(rtol)
    given = (
        eps, 0.0 if fixed else kappa, end, fixed, rtol, max(EVENT_SHARE * rtol, EVENT_FLOOR),
        *control, *(spring or Spring()), sprung, len(drive.pieces),
    )  # fmt: skip
    room, pieces = ROOM if arrays else ROOM // 2, drive.rows
    unknowns = 2 * stages if sprung else stages
    if sprung:  # as wide as the pieces by which the base slides, with room for those
        wider = max(pieces.shape[1], b_.POWERS + 1 + stages) - pieces.shape[1]
        pieces = np.pad(pieces, ((0, room), (0, wider)))
    make, matrix = np.zeros if arrays else blanks, np.zeros((unknowns + 3, unknowns + 1))
    return Run(
        given=np.array([given], GIVEN) if arrays else [new(GIVEN, *given)],
        method=_method(stages, arrays),
        now=make(1, NOW),
        pieces=pieces if arrays else pieces.tolist(),
        steps=make(room, STEP),
        nodes=make(3 * room // 2, NODE),
        events=make(room, EVENT),
        matrix=matrix if arrays else matrix.tolist(),
        along=make(room if sprung else 1, STEP),
    )


def rest(run: Run) -> None:
    """Set the initial state of a run: the contact at rest, d = 1."""
    now = run.now
    now.s, now.d, now.v, now.span, now.kink, now.x, now.w = 0.0, 1.0, 0.0, math.inf, 0.0, 0.0, 0.0
    now.piece, now.slide, now.met, now.smooth, now.toggles = 0, 0, False, False, 0
    now.steps, now.nodes, now.events, now.rejected, now.evaluations = 0, 2, 0, 0, 0
    for k in range(2):
        side, node = now.sides[k], run.nodes[k]
        side.state, side.node, side.X = TOUCHING, k, SIDES[k]
        for place in (node.inner, node.outer):
            place.X, place.s, place.d, place.Y = 0.0, -math.inf, 0.0, 0.0
        node.outer.X = SIDES[k] * FAR
        node.step, node.branch, node.next, node.joined = -1, 0.0, -1, False


def step_at(run: Any, s: float) -> int:
    """Return the index of the last step that begins at `s` or before."""
    low, high = 0, run.now.steps
    while high - low > 1:
        middle = (low + high) // 2
        if run.steps[middle].start <= s:
            low = middle
        else:
            high = middle
    return low


def has_room(run: Run) -> bool:
    """Whether one more step is certain to fit."""
    now = run.now
    doubles = 2 if now.sides[0].state == FREE else 1
    return (
        now.steps < len(run.steps)
        and doubles * now.nodes + PER_STEP <= len(run.nodes)
        and now.events + EVENTS_PER_STEP <= len(run.events)
    )


def with_more_room(run: Run) -> Run:
    """Return the run with room for twice as much."""
    wider: dict[str, Any] = {}
    objects, sprung = isinstance(run.steps, list), len(run.along) > 1
    for name in ("steps", "nodes", "events", *(("along",) if sprung else ())):
        rows = getattr(run, name)
        more = blanks(len(rows), KINDS[name]) if objects else np.zeros_like(rows)
        wider[name] = rows + more if objects else np.concatenate([rows, more])
    if sprung:
        pieces = np.pad(run.pieces, ((0, len(run.steps)), (0, 0)))
        wider["pieces"] = pieces.tolist() if objects else pieces
    return run._replace(**wider)


def as_arrays(run: Run) -> Run:
    """Return a run of objects, new or in progress, with arrays for compiled kernels."""
    records = {name: structured(getattr(run, name), kind) for name, kind in KINDS.items()}
    return Run(**records, pieces=np.array(run.pieces), matrix=np.array(run.matrix))


def as_objects(run: Run) -> Run:
    """Return a run, new or in progress, with objects for interpreted kernels."""
    records = {name: filled(kind, getattr(run, name).tolist()) for name, kind in KINDS.items()}
    return Run(**records, pieces=run.pieces.tolist(), matrix=run.matrix.tolist())


@cache
def _method(stages: int, arrays: bool) -> Any:
    """Return the Radau IIA method as the record of a run."""
    method, found = radau(stages), np.zeros(1, METHOD)
    found["stages"], found["probe_count"] = stages, len(method.probes)
    for name, rows in method._asdict().items():
        array = np.array(rows)
        found[name][0][tuple(slice(size) for size in array.shape)] = array
    return found if arrays else filled(METHOD, found.tolist())
