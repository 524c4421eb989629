"""A transient in progress: records with named fields, so that one source can be interpreted and compiled.

Interpreted, a record is an object with attributes, and many of them are a list; compiled, they are
structured arrays. Both have more room than is used; `stepping.walk` stops before it is full.
"""

import math
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Legendre, Polynomial

from kvtheory.records import blanks, filled, new, record, structured
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion

PEELING, TOUCHING, FREE = 0, 1, 2
"""At a peeling edge the pressure vanishes, a touching one meets the free surface; both are free in flight."""
SIDES = (-1.0, 1.0)
"""Outward directions."""
STATE_NAMES = {PEELING: "peeling", TOUCHING: "touching", FREE: "free"}

STAGES = ((1e-3, 4), (1e-6, 5), (0.0, 7))
"""Tolerances, and the number of stages of a Radau IIA method that is the cheapest above each, as measured.

The error must be small all along the step, since memory is evaluated from its polynomial, and a step has
large costs besides its stages. For the start from rest of Table 1, with an error of the depth of about 1e-4,
1e-7 and 1e-11, three stages need 198, 552 and 4965 evaluations of F, four 207, 445 and 1181, five 253, 386
and 826, seven at most 341, 341 and 634. Beyond seven, the linear algebra costs what the evaluations save.
`make benchmark` compares it with LSODA, `kvtheory chart work-precision` with SciPy's other methods and CVODE.
"""
MOST_STAGES, MOST_PROBES = 7, 3

PLACES = (0.08, 0.25, 0.55)
"""Approximate places, as shares of a step, at which its defect is probed, besides its end."""

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
    start_depth="f8", start_rate="f8", start_along="f8",
)  # fmt: skip
"""Inertia number, support number, the time at which to stop, whether the indenter is fixed, tolerance of a
step, how far the state of an edge may be violated; step-size controls; inertia, damping and stiffness of a
spring along x, whether there is one; the number of pieces of the drive; d, d' and x' at s = 0."""
_SQUARE = "f8", (MOST_STAGES, MOST_STAGES)
METHOD = record(
    stages="i8", nodes=("f8", (MOST_STAGES,)), A=_SQUARE, inverse=_SQUARE, powers=_SQUARE,
    probe_count="i8", probes=("f8", (MOST_PROBES,)), scales=("f8", (MOST_PROBES, 3)),
)  # fmt: skip
"""A `Method`, padded with zeros."""


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


class Beginning(NamedTuple):
    """d, d' and x' just after s = 0: at rest at the static depth by default, above flat ground if d <= 0."""

    depth: float = 1.0
    rate: float = 0.0
    along_rate: float = 0.0


class Run(NamedTuple):
    """A transient in progress; `steps`, `nodes` and `events` are its outcome.

    Outside the kernels `given`, `method` and `now` hold one record, inside they are the record itself.
    `depths` are those of the drive, see `BaseMotion`: of a fixed indenter whose depth changes. With a spring,
    `along` holds the motion along x for each step, and the `pieces` after those of the drive are those by
    which the base slides under the indenter.
    """

    given: Any
    method: Any
    now: Any
    pieces: Any
    depths: Any
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
    rtol: float, control: StepControl, start: Beginning, *, arrays: bool = False,
) -> Run:  # fmt: skip
    """Return a new run; `numbers` are eps and kappa. Its records are objects, or arrays if `arrays`."""
    (eps, kappa), sprung = numbers, spring is not None
    fixed, stages = math.isinf(kappa), stages_for(rtol)
    given = (
        eps, 0.0 if fixed else kappa, end, fixed, rtol, max(EVENT_SHARE * rtol, EVENT_FLOOR),
        *control, *(spring or Spring()), sprung, len(drive.pieces),
        *start,
    )  # fmt: skip
    room, pieces = ROOM if arrays else ROOM // 2, drive.rows
    unknowns = 2 * stages if sprung else stages
    depths = np.array(drive.depths).reshape(-1, 2)
    if sprung:  # as wide as the pieces by which the base slides, with room for those
        wider = max(pieces.shape[1], b_.POWERS + 1 + stages) - pieces.shape[1]
        pieces = np.pad(pieces, ((0, room), (0, wider)))
    make, matrix = np.zeros if arrays else blanks, np.zeros((unknowns + 3, unknowns + 1))
    return Run(
        given=np.array([given], GIVEN) if arrays else [new(GIVEN, *given)],
        method=_method(stages, arrays), now=make(1, NOW), pieces=pieces if arrays else pieces.tolist(),
        depths=depths if arrays else depths.tolist(),
        steps=make(room, STEP), nodes=make(3 * room // 2, NODE), events=make(room, EVENT),
        matrix=matrix if arrays else matrix.tolist(), along=make(room if sprung else 1, STEP),
    )  # fmt: skip


def set_off(run: Run) -> None:
    """Set the initial state of a run: in contact with ground at rest, or in flight above flat ground."""
    now, given = run.now, run.given
    now.s, now.span, now.kink, now.x = 0.0, math.inf, 0.0, 0.0
    now.d, now.v, now.w = given.start_depth, given.start_rate, given.start_along
    now.piece, now.slide, now.met, now.smooth, now.toggles = 0, 0, False, False, 0
    now.steps, now.nodes, now.events, now.rejected, now.evaluations = 0, 2, 0, 0, 0
    half_length = math.sqrt(max(now.d, 0.0))
    for k in range(2):
        side, node = now.sides[k], run.nodes[k]
        side.state = TOUCHING if half_length > 0.0 else FREE
        side.node, side.X = k, SIDES[k] * half_length
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
    return Run(
        **records, pieces=np.array(run.pieces), depths=np.array(run.depths).reshape(-1, 2),
        matrix=np.array(run.matrix),
    )  # fmt: skip


def as_objects(run: Run) -> Run:
    """Return a run, new or in progress, with objects for interpreted kernels."""
    records = {name: filled(kind, getattr(run, name).tolist()) for name, kind in KINDS.items()}
    return Run(
        **records,
        pieces=run.pieces.tolist(),
        depths=run.depths.tolist(),
        matrix=run.matrix.tolist(),
    )


@cache
def _method(stages: int, arrays: bool) -> Any:
    """Return the Radau IIA method as the record of a run."""
    method, found = radau(stages), np.zeros(1, METHOD)
    found["stages"], found["probe_count"] = stages, len(method.probes)
    for name, rows in method._asdict().items():
        array = np.array(rows)
        found[name][0][tuple(slice(size) for size in array.shape)] = array
    return found if arrays else filled(METHOD, found.tolist())


class Method(NamedTuple):
    """Nodes c, matrix A, its inverse, the powers of theta from the stages; probes, and their scales."""

    nodes: Any
    A: Any
    inverse: Any
    powers: Any
    probes: Any
    scales: Any


@cache
def radau(stages: int) -> Method:
    """Return the Radau IIA method with this number of stages: collocation, so that a step is one polynomial.

    It is stiffly accurate: eps v' = F keeps the form in which eps -> 0 leaves F = 0 at every stage (Hairer
    and Wanner, Solving Ordinary Differential Equations II, sections IV.5, IV.8 and VI.1). In rational
    arithmetic, since the inverses are ill-conditioned. L_j are the Lagrange polynomials of the nodes: A_ij
    is the integral of L_j, its inverse the derivative of theta L_j/c_j; the powers of theta of v are those
    of V_j - v_0. The defect of a smooth step is a multiple of M = prod(theta - c_i); it is probed at its
    extremes nearest to `PLACES`, whose scales are the largest |int M|, |M| and |M'| of the step divided by
    |M| there.
    """
    legendre = Legendre.basis(stages) - Legendre.basis(stages - 1)
    roots = np.sort(np.real(legendre.roots()))[:-1]
    roots -= legendre(roots) / legendre.deriv()(roots)
    c = [*(Fraction(x) for x in (0.5 * (1.0 + roots)).tolist()), Fraction(1)]
    A, inverse, powers = ([[0.0] * stages for _ in c] for _ in range(3))
    for j, at in enumerate(c):
        lagrange = np.array([Fraction(1)])
        for other in c[:j] + c[j + 1 :]:
            lagrange = np.convolve(lagrange, [-other, Fraction(1)]) / (at - other)
        for i, place in enumerate(c):
            A[i][j] = float(sum(x * place ** (k + 1) / (k + 1) for k, x in enumerate(lagrange)))
            slope = sum(x * (k + 1) * place**k for k, x in enumerate(lagrange))
            inverse[i][j] = float(slope / at)
            powers[i][j] = float(lagrange[i] / at)
    nodes = [float(x) for x in c]
    M, theta = Polynomial.fromroots(nodes), np.linspace(0.0, 1.0, 401)
    turns = np.sort(np.real(M.deriv().roots()))
    # with few stages, one extreme may be the nearest to two places
    probes = sorted({float(turns[np.argmin(np.abs(turns - place))]) for place in PLACES})
    inner = theta[theta >= nodes[0]]
    largest = [np.abs(f).max() for f in (M.integ()(theta), M(inner), M.deriv()(inner))]
    scales = [[float(x / abs(M(p))) for x in largest] for p in probes]
    return Method(nodes, A, inverse, powers, probes, scales)


def stages_for(rtol: float) -> int:
    """Return the number of stages that is cheapest for a tolerance."""
    return next(count for above, count in STAGES if rtol > above)
