"""A transient on a Prony series in progress: its records, interpreted or compiled."""

import math
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum.run import (
    FREE,
    SIDES,
    TOUCHING,
    Beginning,
    Spring,
    StepControl,
    radau,
    stages_for,
)
from kvtheory.records import blanks, new, record, structured
from kvtheory.scene import base_motion as b_
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.theory.laws import Element

NEVER = -1
"""Number of a segment: ground that was never touched. Step of a segment: elements in contact at rest, or free
ground between two places that was never touched."""

SMOOTH = 1e-9
"""Relative difference of lambda or lambda' between pieces of the drive that counts as rounding."""
ROOM = 48
"""Initial capacity in steps."""
FARTHEST = 5e6
"""Largest sum of A_i that a step may reach, over the root of the tolerance: for rounding."""

SIDE = record(
    state="i8", segment="i8", own="i8", index="i8", xi="f8", sigma="f8", near="f8", pace="f8",
    compression="f8", rise="f8",
)  # fmt: skip
"""State of an edge; the segment in which it moves, of the contact if it peels, of free ground if it touches;
that which it writes; the step in which the element there passed an edge; xi_e; the instant at which it did,
that at which the edge began in the segment, and the rate of that instant; u of the element there, and u' of
the free ground that a touching edge meets."""
SEGMENT = record(
    edge="i8", step="i8", next="i8", a="f8", b="f8", X_a="f8", X_b="f8"
)  # fmt: skip
"""Edge and first step of a segment, the next one outward on free ground, the instants and X at its ends."""
STEP = record(
    start="f8", span="f8", time="f8", lasts="f8", depth="f8", along="f8", piece="i8",
    kinked=("i8", (2,)), first="i8", count="i8", restart="i8", sides=(SIDE, (2,)),
)  # fmt: skip
"""Start and span of a step on the clock of the run; the time at its start, and how long it lasts, see
`with_pauses`; d and x at its start, the piece of the drive, whether the histories of the edges
have a kink there; where the contact's segments are in `chain`, and their number; the first step since the
last restart of the accumulators; both sides at its start."""
NOW = record(
    s="f8", d="f8", v="f8", x="f8", w="f8", span="f8", limit="f8", piece="i8", steps="i8", segments="i8",
    chain="i8", block="i8", unused=("i8", (2,)), first="i8", count="i8", restart="i8", toggles="i8",
    rejected="i8", evaluations="i8",
    kinked=("i8", (2,)), smooth="?", sides=(SIDE, (2,)), compression="f8", rise="f8",
)  # fmt: skip
"""Clock, d, d', x, x', length of the next step, and its limit by an event, piece of the drive, numbers of
steps, segments and entries in `chain`; where the room for the contact begins there, and its next unused
entries outward at both ends; the contact there; the first step since the last restart of the accumulators
in `Run.element`; the changes at this instant, numbers of rejected steps and evaluations; whether the
histories of the edges have a kink here, and whether the last step continues smoothly; both sides; u
and u' of the free element that was evaluated last."""
GIVEN = record(
    eps="f8", kappa="f8", end="f8", rtol="f8", eps_x="f8", damping="f8", spring="f8", damper="f8", glass="f8",
    last_power="f8", farthest="f8", first_step="f8", longest="f8", grow="f8", stages="i8", arms="i8",
    fixed="?", sprung="?", start_depth="f8", start_rate="f8", start_along="f8",
)  # fmt: skip
"""Inertia and support number, the end, the tolerance of a step; inertia, damping and stiffness along x; C/K
and sum K_i/K of the foundation; the last coefficient of a polynomial in Legendre's over that of its last
power; the largest sum of A_i that a step may reach; controls of the step size; numbers of stages and of arms;
whether the indenter is fixed, and held by a spring; d, d' and x' just after s = 0."""


METHOD = record(A="f8", inverse="f8", powers="f8")
"""An entry of A, of its inverse, and of the matrix of the powers of theta from the stages."""
PIECE = record(paused="?", since="f8")
"""Whether a piece of the drive is a pause, and the time at which it begins."""
ARM = record(stiffness="f8", relaxation_time="f8")
"""k_i and T_i of an arm."""
MODE = record(rate="f8", share="f8", amplitude="f8")
"""Rate of a mode of free ground, its share in u, and its amplitude in one element."""
_OF_CONTACT: Any = {
    "accumulated_depth": "f8", "accumulated_slide": "f8", "stress_at_edge": ("f8", (2,)),
    "force": "f8", "moment": "f8",
}  # fmt: skip
ARM_STATE = record(**_OF_CONTACT)
"""A_i, B_i, s_e at both edges, F_i and M_i of an arm; or a coefficient of each as a polynomial in a step."""
ARM_STAGE = record(**_OF_CONTACT, source="f8")
"""The same at a stage, and the source of the equation that is being solved, see `step.relax`."""
ELEMENT = record(
    accumulated_depth="f8", accumulated_slide="f8", stress="f8", stress_at_edge="f8"
)  # fmt: skip
"""Of an arm of one element: A_i and B_i at this time, s_i, and s_i as an edge passed the element."""
POLYNOMIAL = record(
    depth_rate="f8", offset_rate="f8", edges=("f8", (2,)), compression=("f8", (2,)),
    rise=("f8", (2,)),
)  # fmt: skip
"""A coefficient of d', x', both xi_e, and u and u' there, see `SIDE`, as polynomials over a step."""
STAGE = record(
    node="f8", of_start="f8", s="f8", time="f8", depth_rate="f8", offset_rate="f8", depth="f8", offset="f8",
    way="f8", sliding_velocity="f8", edges=("f8", (2,)), entry_time=("f8", (2,)),
    entry_step=("i8", (2,)), edge_shift=("f8", (2,)), compression=("f8", (2,)), rise=("f8", (2,)),
)  # fmt: skip
"""Node of a stage and the sum of its row of A^-1; clock, time, d', x', d, x; Y and lambda of the base under
the indenter; of both edges xi_e, the instant and the step in which the element there passed an edge, and the
velocity through the material times the span; u and u' there, see `SIDE`."""
UNKNOWN = record(change="f8", move="f8", residual="f8", before="f8", image="f8", back="f8")
"""Of an unknown of Broyden's method: its change over the stage, and the last move; the residual, and that
before this move; the inverse Jacobian times their difference, and the move times the inverse Jacobian."""


class Run(NamedTuple):
    """A transient in progress; its outcome are `steps`, their polynomials, `segments` and `chain`.

    Outside the kernels `given` and `now` hold one record, inside they are the record itself. What has entries
    for arms, stages, coefficients or unknowns is read by its name before the indices: `stages.edges[j, k]`.
    Compiled, it is a structured array; interpreted, an object with an array for each name, see `named`.

    `depths` are d and d' at the start of each piece of the drive, and d'' in it, if they are given, see
    `BaseMotion`. `polynomials` (steps, coefficients) are those of the steps, `memory` (steps, arms,
    coefficients) those of the arms, `state` (arms) is the present one.
    `from_modes` gives the stresses of free ground from the rates of the dampers, s_i/(k_i T_i): k_i times
    the difference to u cancels on a stiff arm. The others are of the step: `stages` and `arm_stages` (arms,
    stages), `filters` of the arms, `jacobian`, `inverse_jacobian` and `unknowns` of Broyden's method, and
    one `element` (arms).
    """

    given: Any
    now: Any
    pieces: Any
    depths: Any
    clock: Any
    steps: Any
    polynomials: Any
    memory: Any
    segments: Any
    chain: Any
    method: Any
    arms: Any
    modes: Any
    to_modes: Any
    from_modes: Any
    state: Any
    stages: Any
    arm_stages: Any
    filters: Any
    jacobian: Any
    inverse_jacobian: Any
    unknowns: Any
    element: Any


RECORDS = {"given": GIVEN, "now": NOW, "steps": STEP, "segments": SEGMENT}
"""Types of the records of a run."""
NAMED = {
    "polynomials": POLYNOMIAL, "memory": ARM_STATE, "method": METHOD, "arms": ARM, "state": ARM_STATE,
    "stages": STAGE, "arm_stages": ARM_STAGE, "unknowns": UNKNOWN, "element": ELEMENT, "modes": MODE,
    "clock": PIECE,
}  # fmt: skip
"""Types of what is read by name before its indices."""


def named(array: Any) -> Any:
    """Return an object with a view of a structured array for each of its fields."""
    return SimpleNamespace(**{name: array[name] for name in array.dtype.names})


def together(views: Any, kind: np.dtype[Any]) -> Any:
    """Return a structured array with these fields; it may be one already."""
    if isinstance(views, np.ndarray):
        return views
    found = np.zeros(vars(views)[(kind.names or ("",))[0]].shape, kind)
    for name, values in vars(views).items():
        found[name] = values
    return found


def begin(
    drive: BaseMotion, arms: Any, numbers: tuple[float, float], spring: Spring | None, end: float,
    rtol: float, control: StepControl, damper: float, start: Beginning, *, arrays: bool,
) -> Run:  # fmt: skip
    """Return a new run; `arms` are pairs k_i, T_i, `damper` is C/K, `numbers` are eps and kappa."""
    (eps, kappa), count, fixed = numbers, len(arms), math.isinf(numbers[1])
    n = stages_for(rtol)
    starts = start.rate != 0.0 or start.along_rate != 0.0
    pieces, depths, clock, end = with_pauses(drive, end, needed=damper > 0.0, starts=starts)
    unknowns, own = n * max(2 - fixed - (spring is None), 1), spring or Spring()
    given = (
        eps, 0.0 if fixed else kappa, end, rtol, own.eps, own.damping, own.stiffness,
        damper, float(sum(k for k, _ in arms)), 1.0 / math.comb(2 * n, n),
        max(FARTHEST * math.sqrt(rtol), 100.0), control.first_step, control.longest, control.grow, n,
        count, fixed, spring is not None, *start,
    )  # fmt: skip
    element = Element.of(1.0, damper, arms)
    k, T = np.array(arms, dtype=float).reshape(-1, 2).T
    tableau, stages = radau(n), np.zeros(n, STAGE)
    stages["node"], stages["of_start"] = tableau.nodes, np.array(tableau.inverse).sum(axis=1)
    method, own_arms = np.zeros((n, n), METHOD), np.zeros(count, ARM)
    method["A"], method["inverse"], method["powers"] = tableau.A, tableau.inverse, tableau.powers
    own_arms["stiffness"], own_arms["relaxation_time"] = k, T
    modes = np.zeros(element.rates.size, MODE)
    modes["rate"], modes["share"] = element.rates, element.shares
    shapes = {
        "polynomials": (ROOM, n + 1), "memory": (ROOM, count, n + 1), "arm_stages": (count, n),
        "state": count, "element": count, "unknowns": unknowns,
    }  # fmt: skip
    run = Run(
        given=[new(GIVEN, *given)], now=blanks(1, NOW), pieces=pieces, depths=depths, clock=clock,
        steps=blanks(1 if arrays else ROOM, STEP), segments=blanks(3 if arrays else 2 * ROOM, SEGMENT),
        chain=np.zeros(8 * ROOM, dtype=np.int64), method=method, arms=own_arms, modes=modes, stages=stages,
        to_modes=np.ascontiguousarray(element.to_modes),
        from_modes=-(k * T)[:, None] * element.from_modes[:count] * element.rates,
        filters=np.zeros((count, n, n)),
        **{f"{kind}jacobian": np.zeros((unknowns, unknowns)) for kind in ("", "inverse_")},
        **{name: np.zeros(shape, NAMED[name]) for name, shape in shapes.items()},
    )  # fmt: skip
    _set_off(run._replace(given=run.given[0], now=run.now[0]))
    if not arrays:
        return run._replace(**{name: named(getattr(run, name)) for name in NAMED})
    run = as_arrays(run)
    return run._replace(steps=_longer(run.steps, ROOM), segments=_longer(run.segments, 2 * ROOM))


def with_pauses(
    drive: BaseMotion, end: float, *, needed: bool, starts: bool = False
) -> tuple[Any, Any, Any, float]:
    """Return pieces of a drive on the clock of a run, their depths and times, and the clock at the end.

    Where a velocity jumps, the pressure of a damper does, and an edge passes ground at once. So the clock
    runs on for a while in which time stands still and the velocity changes uniformly: also at first, if the
    indenter `starts` with a velocity. Without a damper there is no such pause, and the clock shows the time.
    """
    held = np.pad(np.array(drive.depths).reshape(-1, 2), ((0, 0), (0, 1)))
    if not needed:
        clock = np.zeros(len(drive.rows), PIECE)
        clock["since"] = drive.rows[:, b_.START]
        return drive.rows, held, clock, end
    found: list[Any] = []
    pauses: list[Any] = []
    depths: list[Any] = []
    lost, before, last, rate_before = 0.0, 0.0, end, 0.0
    rows = np.pad(drive.rows, ((0, 0), (0, max(b_.POWERS + 2 - drive.rows.shape[1], 0))))
    pause = end / (1.0 + len(rows))
    for row, (depth, rate) in zip(rows, drive.depths or [(0.0, 0.0)] * len(rows), strict=True):
        start, after = row[b_.START], row[b_.POWERS]
        jumps = _differ(after, before) or _differ(rate, rate_before) or (starts and start <= 0.0)
        if start <= end and jumps:
            new = np.zeros_like(row)
            new[: b_.POWERS] = start + lost, start + lost + pause, row[b_.DISPLACEMENT]
            new[b_.POWERS : b_.POWERS + 2] = before, (after - before) / pause
            found, lost = [*found, new], lost + pause
            pauses.append((True, start))
            depths.append((depth, rate_before, (rate - rate_before) / pause))
            last = end + lost
        moved = row.copy()
        moved[[b_.START, b_.END]] += lost
        if found:  # without a gap by rounding, in which there would be no step
            moved[b_.START] = found[-1][b_.END]
        found.append(moved)
        pauses.append((False, start))
        depths.append((depth, rate, 0.0))
        before, rate_before = b_.evaluate(row, row[b_.END])[1], rate
    held = np.array(depths if drive.depths else held)
    return np.array(found), held, np.array(pauses, PIECE), last


def _differ(after: float, before: float) -> bool:
    return abs(after - before) > SMOOTH * (1.0 + abs(after))


def _longer(rows: Any, count: int) -> Any:
    """Return an array with so many rows; new ones are zero."""
    return np.concatenate([rows, np.zeros((count - len(rows), *rows.shape[1:]), rows.dtype)])


def as_arrays(run: Run) -> Run:
    """Return a run, new or in progress, with arrays for compiled kernels."""
    found = {name: structured(getattr(run, name), kind) for name, kind in RECORDS.items()}
    found |= {name: together(getattr(run, name), kind) for name, kind in NAMED.items()}
    return run._replace(**found)


def _set_off(run: Run) -> None:
    """Set the initial state: in flight above flat ground, or in contact with ground at rest.

    In contact both edges touch, with segments at both ends of it.
    """
    now, given = run.now, run.given
    now.d, now.span, now.limit = given.start_depth, math.inf, math.inf
    if not run.clock["paused"][0]:  # else they change in the pause
        now.v, now.w = given.start_rate, given.start_along
    half_length = math.sqrt(max(now.d, 0.0))
    for k in range(2):
        side = now.sides[k]
        side.state, side.segment, side.own = FREE, NEVER, NEVER
        side.xi, side.pace = SIDES[k] * half_length, 1.0
        now.kinked[k] = 1
    if half_length == 0.0:
        return
    now.segments, now.chain, now.count, now.unused[1] = 3, 3, 3, 3
    now.unused[0] = -1
    for k, edge, step, a, b in (
        (0, 0, 0, -1.0, -1.0),
        (1, 1, NEVER, -1.0, 1.0),
        (2, 1, 0, 1.0, 1.0),
    ):
        segment = run.segments[k]
        segment.edge, segment.step, segment.next = edge, step, NEVER
        segment.X_a, segment.X_b = a * half_length, b * half_length
        segment.b = 0.0 if step == NEVER else math.inf
        run.chain[k] = k
    for k in range(2):
        now.sides[k].state, now.sides[k].own = TOUCHING, 2 * k


def with_more_room(run: Run) -> Run:
    """Return the run with room for twice as much."""
    wider: dict[str, Any] = {"chain": _longer(run.chain, 2 * len(run.chain))}
    for name in ("polynomials", "memory"):
        rows = getattr(run, name)
        array = together(rows, NAMED[name])
        more = _longer(array, 2 * len(array))
        wider[name] = more if rows is array else named(more)
    for name in ("steps", "segments"):
        records = getattr(run, name)
        if isinstance(records, list):
            wider[name] = records + blanks(len(records), RECORDS[name])
        else:
            wider[name] = _longer(records, 2 * len(records))
    return run._replace(**wider)
