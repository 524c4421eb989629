"""A transient on a Prony series in progress: its records, interpreted or compiled."""

import math
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum.prony.contact import NEVER, OWN, ROWS, SIDES, TOUCHING
from kvtheory.models.continuum.radau_iia import radau, stages_for
from kvtheory.models.continuum.run import Spring, StepControl
from kvtheory.records import blanks, new, record, structured
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.theory.laws import Element

ROOM = 48
"""Initial capacity in steps."""
FARTHEST = 5e6
"""Largest sum of A_i that a step may reach, over the root of the tolerance: for rounding."""

SIDE = record(
    state="i8", segment="i8", own="i8", index="i8", xi="f8", sigma="f8", near="f8", pace="f8"
)  # fmt: skip
"""State of an edge; the segment in which it moves, of the contact if it peels, of free ground if it touches;
that which it writes; the step in which the element there passed an edge; xi_e; the instant at which it did,
that at which the edge began in the segment, and the rate of that instant."""
SEGMENT = record(
    edge="i8", step="i8", next="i8", a="f8", b="f8", X_a="f8", X_b="f8"
)  # fmt: skip
"""Edge and first step of a segment, the next one outward on free ground, the instants and X at its ends."""
STEP = record(
    start="f8", span="f8", depth="f8", along="f8", piece="i8", kinked=("i8", (2,)), first="i8",
    count="i8", since="i8", sides=(SIDE, (2,)),
)  # fmt: skip
"""Start and span of a step; d and x at its start, the piece of the drive, whether the histories of the edges
have a kink there; where the contact's segments are in `chain`, and their number; the first step of the count
of the accumulators; both sides at its start."""
NOW = record(
    s="f8", d="f8", v="f8", x="f8", w="f8", span="f8", limit="f8", piece="i8", steps="i8", segments="i8",
    chain="i8", first="i8", count="i8", since="i8", toggles="i8", rejected="i8", evaluations="i8",
    kinked=("i8", (2,)), smooth="?", sides=(SIDE, (2,)),
)  # fmt: skip
"""Time, d, d', x, x', length of the next step, and its limit by an event, piece of the drive, numbers of
steps, segments and entries in `chain`; the contact there; the first step of the count of the accumulators in
`Run.here`; the changes at this instant, numbers of rejected
steps and evaluations; whether the histories of the edges have a kink here, and whether the last step
continues smoothly; both sides."""
GIVEN = record(
    eps="f8", kappa="f8", end="f8", rtol="f8", eps_x="f8", damping="f8", spring="f8", glass="f8",
    counted="f8", first_step="f8", longest="f8", grow="f8", stages="i8", fixed="?", sprung="?",
)  # fmt: skip
"""Inertia and support number, the end, the tolerance of a step; inertia, damping and stiffness along x; sum
K_i/K; the largest sum of A_i that a step may reach; controls of the step size; number of stages; whether the
indenter is fixed, and held by a spring."""


class Run(NamedTuple):
    """A transient in progress; its outcome are `steps`, their polynomials, `segments` and `chain`.

    Outside the kernels `given` and `now` hold one record, inside they are the record itself. `rows` are the
    polynomials of a step, `memory` those of each arm. `method` has A, its inverse, the powers of theta from
    the stages, and nodes, row sums of the inverse and a constant; `arms` are as in `contact`, `state` has
    their rows at present. `from_modes` gives the stresses of free ground from the rates of the dampers,
    s_i/(k_i T_i): k_i times the difference to u cancels on a stiff arm. The others are of the step: `stages`
    and `arm_stages` are as `rows` and `memory`, but values at the stages, and what else belongs to a stage;
    `filters` and `sources` those of the arms; `squares` and `vectors` those of Broyden's method; `here` is as
    `state`, of one element.
    """

    given: Any
    now: Any
    pieces: Any
    steps: Any
    rows: Any
    memory: Any
    segments: Any
    chain: Any
    method: Any
    arms: Any
    to_modes: Any
    from_modes: Any
    state: Any
    stages: Any
    arm_stages: Any
    filters: Any
    sources: Any
    squares: Any
    vectors: Any
    here: Any


PLACES, VECTORS = 12, 6
"""Number of other values of a stage, and of vectors."""


def begin(
    drive: BaseMotion, arms: Any, numbers: tuple[float, float], spring: Spring | None, end: float,
    rtol: float, control: StepControl, *, arrays: bool,
) -> Run:  # fmt: skip
    """Return a new run at rest; `arms` are pairs k_i, T_i, and `numbers` eps and kappa."""
    (eps, kappa), count, fixed = numbers, len(arms), math.isinf(numbers[1])
    n = stages_for(rtol)
    unknowns, own = n * max(2 - fixed - (spring is None), 1), spring or Spring()
    given = (
        eps, 0.0 if fixed else kappa, end, rtol, own.eps, own.damping, own.stiffness,
        float(sum(k for k, _ in arms)), max(FARTHEST * math.sqrt(rtol), 100.0), control.first_step,
        control.longest, control.grow, n, fixed, spring is not None,
    )  # fmt: skip
    element = Element.of(1.0, 0.0, arms)
    k, T = np.array(arms, dtype=float).T
    columns = k, T, element.rates, element.shares
    method, tableau = np.zeros((4, n, n)), radau(n)
    method[:3] = tableau.A, tableau.inverse, tableau.powers
    method[3, :3] = tableau.nodes, method[1].sum(axis=1), np.full(n, 1.0 / math.comb(2 * n, n))
    run = Run(
        given=[new(GIVEN, *given)],
        now=blanks(1, NOW),
        pieces=drive.rows,
        steps=blanks(1 if arrays else ROOM, STEP),
        rows=np.zeros((ROOM, ROWS, n + 1)),
        memory=np.zeros((ROOM, count, OWN, n + 1)),
        segments=blanks(3 if arrays else 2 * ROOM, SEGMENT),
        chain=np.zeros(8 * ROOM, dtype=np.int64),
        method=method,
        arms=np.stack(columns, axis=1),
        to_modes=np.ascontiguousarray(element.to_modes),
        from_modes=-(k * T)[:, None] * element.from_modes * element.rates,
        state=np.zeros((count, OWN)),
        stages=np.zeros((ROWS + PLACES, n)),
        arm_stages=np.zeros((count, OWN, n)),
        filters=np.zeros((count, n, n)),
        sources=np.zeros((count, n)),
        squares=np.zeros((2, unknowns, unknowns)),
        vectors=np.zeros((VECTORS, unknowns)),
        here=np.zeros((count, OWN)),
    )
    _rest(run._replace(now=run.now[0]))
    if not arrays:
        return run
    run = as_arrays(run)
    return run._replace(steps=_longer(run.steps, ROOM), segments=_longer(run.segments, 2 * ROOM))


def _longer(rows: Any, count: int) -> Any:
    """Return an array with so many rows; new ones are zero."""
    return np.concatenate([rows, np.zeros((count - len(rows), *rows.shape[1:]), rows.dtype)])


def as_arrays(run: Run) -> Run:
    """Return a run, new or in progress, with arrays for compiled kernels."""
    kinds = {"given": GIVEN, "now": NOW, "steps": STEP, "segments": SEGMENT}
    return run._replace(**{n: structured(getattr(run, n), kind) for n, kind in kinds.items()})


def _rest(run: Run) -> None:
    """Set the contact at rest: both edges touch, and write segments at both ends of it."""
    now = run.now
    now.d, now.segments, now.chain, now.count = 1.0, 3, 3, 3
    now.span = now.limit = math.inf
    for k, edge, step, a, b in (
        (0, 0, 0, -1.0, -1.0),
        (1, 1, NEVER, -1.0, 1.0),
        (2, 1, 0, 1.0, 1.0),
    ):
        segment = run.segments[k]
        segment.edge, segment.step, segment.next, segment.X_a, segment.X_b = edge, step, NEVER, a, b
        segment.b = 0.0 if step == NEVER else math.inf
        run.chain[k] = k
    for k in range(2):
        side = now.sides[k]
        side.state, side.segment, side.own, side.xi, side.pace = (
            TOUCHING,
            NEVER,
            2 * k,
            SIDES[k],
            1.0,
        )
        now.kinked[k] = 1


def with_more_room(run: Run) -> Run:
    """Return the run with room for twice as much."""
    more = {"steps": STEP, "segments": SEGMENT}
    wider: dict[str, Any] = {
        name: _longer(rows := getattr(run, name), 2 * len(rows))
        for name in ("rows", "memory", "chain")
    }
    for name, kind in more.items():
        records = getattr(run, name)
        if isinstance(records, list):
            wider[name] = records + blanks(len(records), kind)
        else:
            wider[name] = _longer(records, 2 * len(records))
    return run._replace(**wider)
