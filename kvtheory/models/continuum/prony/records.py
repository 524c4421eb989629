"""A transient on a Prony series in progress: its records, interpreted or compiled."""

import math
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.prony.contact import AT_REST, OWN, PER_ARM
from kvtheory.models.continuum.radau_iia import radau, stages_for
from kvtheory.models.continuum.run import Spring, StepControl
from kvtheory.scene.base_motion import BaseMotion

ROOM = 48
"""Initial capacity in steps."""

STEP = r_._record(
    start="f8", span="f8", depth="f8", along="f8", lead="f8", kinked="?", piece="i8",
    oldest="i8",
)  # fmt: skip
"""Start and span of a step; d, x and X of the leading edge at its start; whether the history has a kink
there; the piece of the drive; the step in which the element at the trailing edge entered."""
NOW = r_._record(
    s="f8", d="f8", v="f8", x="f8", w="f8", r="f8", sigma="f8", span="f8",
    oldest="i8", piece="i8", steps="i8", rejected="i8", evaluations="i8", kinked="?", smooth="?",
)  # fmt: skip
"""Time, d, d', x, x', the trailing edge and when the element there entered, the length of the next step; the
step in which it entered, the piece of the drive, numbers of steps, rejected steps and evaluations; whether
the history has a kink here, and whether the last step continues smoothly."""
GIVEN = r_._record(
    eps="f8", kappa="f8", end="f8", rtol="f8", eps_x="f8", damping="f8", spring="f8", glass="f8",
    first_step="f8", longest="f8", grow="f8", stages="i8", fixed="?", sprung="?",
)  # fmt: skip
"""Inertia and support number, the end, the tolerance of a step; inertia, damping and stiffness along x; sum
K_i/K; controls of the step size; number of stages; whether the indenter is fixed, and held by a spring."""


class Run(NamedTuple):
    """A transient in progress, whose outcome are `steps` and the polynomials in `rows`.

    Outside the kernels `given` and `now` hold one record, inside they are the record itself. `arms` are
    pairs k_i, T_i, `state` is A_i, B_i, s_i(r), F_i, M_i of each arm at present. The others are of the
    method and of the step: `sums` of the rows of `inverse`; `stages` as `rows`, but values at the stages;
    `places` with other values there (`step`); a filter for each arm; a square, its inverse and vectors of
    Broyden's method; and `here`, as `state`, at one instant.
    """

    given: Any
    now: Any
    pieces: Any
    arms: Any
    state: Any
    steps: Any
    rows: Any
    nodes: Any
    A: Any
    inverse: Any
    sums: Any
    powers: Any
    stages: Any
    places: Any
    filters: Any
    square: Any
    inverted: Any
    vectors: Any
    here: Any


PLACES, VECTORS = 11, 7
"""Number of values of a place, and of vectors."""


def begin(
    drive: BaseMotion, arms: Any, numbers: tuple[float, float], spring: Spring | None, end: float,
    rtol: float, control: StepControl, *, arrays: bool,
) -> Run:  # fmt: skip
    """Return a new run at rest; `arms` are pairs k_i, T_i, and `numbers` eps and kappa."""
    (eps, kappa), count, fixed = numbers, len(arms), math.isinf(numbers[1])
    n = stages_for(rtol)
    method, unknowns = radau(n), n * max(int(not fixed) + int(spring is not None), 1)
    own = spring or Spring()
    given = (
        eps, 0.0 if fixed else kappa, end, rtol, own.eps, own.damping, own.stiffness,
        float(sum(k for k, _ in arms)), control.first_step, control.longest, control.grow, n, fixed,
        spring is not None,
    )  # fmt: skip
    now = (0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, math.inf, AT_REST, 0, 0, 0, 0, True, False)
    wide = PER_ARM + OWN * count

    return Run(
        given=np.array([given], GIVEN) if arrays else [r_.new(GIVEN, *given)],
        now=np.array([now], NOW) if arrays else [r_.new(NOW, *now)],
        pieces=drive.rows,
        arms=np.array(arms, dtype=float),
        state=np.zeros((count, OWN)),
        steps=np.zeros(ROOM, STEP) if arrays else r_._blanks(ROOM, STEP),
        rows=np.zeros((ROOM, wide, n + 1)),
        nodes=np.array(method.nodes),
        A=np.array(method.A),
        inverse=np.array(method.inverse),
        sums=np.sum(method.inverse, axis=1),
        powers=np.array(method.powers),
        stages=np.zeros((wide, n)),
        places=np.zeros((n, PLACES)),
        filters=np.zeros((count, n, n)),
        square=np.zeros((unknowns, unknowns)),
        inverted=np.zeros((unknowns, unknowns)),
        vectors=np.zeros((VECTORS, unknowns)),
        here=np.zeros((count, OWN)),
    )


def with_more_room(run: Run) -> Run:
    """Return the run with room for twice as many steps."""
    steps, rows = run.steps, np.concatenate([run.rows, np.zeros_like(run.rows)])
    if isinstance(steps, list):
        return run._replace(steps=steps + r_._blanks(len(steps), STEP), rows=rows)
    return run._replace(steps=np.concatenate([steps, np.zeros_like(steps)]), rows=rows)
