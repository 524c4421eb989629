"""The state at any time of a solved motion: depth, edges and forces."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum.contact import instant, motion
from kvtheory.models.continuum.run import FREE, Run, step_at
from kvtheory.records import record
from kvtheory.scene.base_motion import END, START, evaluate

STATE = record(
    depth="f8", depth_rate="f8", acceleration="f8", sliding_velocity="f8", velocity="f8", way="f8",
    offset="f8", offset_rate="f8", spring_force="f8", edges=("f8", (2,)), edge_states=("i8", (2,)),
    leading_edge="f8", trailing_edge="f8", normal_force="f8", friction_force="f8",
    peak_pressure="f8", rounding="f8",
)  # fmt: skip
"""A state in scaled form: d, d', d'', lambda of the base under the indenter and of the drive, Y, x, x', the
force of spring and damper, both edges (NaN in flight) and their states, both forces, the largest pressure,
and the rounding error of an edge, which is large on ground that was left just before."""
MEASURED = (
    "depth", "depth_rate", "normal_force", "friction_force", "peak_pressure", "sliding_velocity",
    "velocity", "offset", "spring_force", "leading_edge", "trailing_edge", "left_edge", "right_edge",
)  # fmt: skip
"""Quantities of which extremes and deviations are asked."""
SERIES = (
    "velocity", "sliding_velocity", "spring_force", "depth", "depth_rate", "normal_force",
    "friction_force", "peak_pressure", "leading_edge", "trailing_edge",
)  # fmt: skip
"""The quantities of a series, which are fields of the states."""

SUBDIVISIONS = 4
"""Points shown for each step; steps are long where the motion is steady."""

UNIT = 4e-16
"""Rounding of d and Y, relative to 1 + |Y|."""


def measured(state: Any) -> Any:
    """Return the `MEASURED` quantities of a state."""
    return (
        state.depth, state.depth_rate, state.normal_force, state.friction_force,
        state.peak_pressure, state.sliding_velocity, state.velocity, state.offset,
        state.spring_force, state.leading_edge, state.trailing_edge, state.edges[0], state.edges[1],
    )  # fmt: skip


def states(times: Any, found: Any, run: Run) -> None:
    """Write the state at each of the `times` into a record of `found`.

    Where the drive jumps, it is the state just after the jump.
    """
    for i in range(len(times)):
        state_at(run, step_at(run, times[i]), times[i], found[i])


def natural(run: Run, times: Any, found: Any) -> int:
    """Write the times at which to show a motion, its subdivided steps, and the states there."""
    count, index = 0, 0
    for index in range(run.now.steps):
        start, end = run.steps[index].start, end_of(run, index)
        for k in range(SUBDIVISIONS):
            s = start + (end - start) * (k / SUBDIVISIONS)
            if s < end and (count == 0 or s > times[count - 1]):
                times[count] = s
                state_at(run, index, s, found[count])
                count += 1
    times[count] = run.now.s
    state_at(run, index, times[count], found[count])
    return count + 1


def end_of(run: Run, index: int) -> float:
    """Return the end of a step, where the next one begins."""
    return run.now.s if index + 1 == run.now.steps else run.steps[index + 1].start


def state_at(run: Run, index: int, s: float, found: Any) -> None:
    """Write the state at `s`, within the step `index`."""
    step, now = run.steps[index], instant(run, index, s)
    d, v, dv, Y, number, _ = now
    left, right = step.sides[0], step.sides[1]
    l = r = math.nan
    f_z = f_x = p = rounding = 0.0
    if left.state != FREE:
        # ground that was left at this very instant confines nothing yet
        l, r = left.X + Y, right.X + Y
        if s > step.start:
            l, l_d, _, _ = c_.edge(run, 0, left, s, now)
            r, r_d, _, _ = c_.edge(run, 1, right, s, now)
            rounding = UNIT * (1.0 + abs(Y)) * max(abs(l_d), abs(r_d))
        f_z, f_x = c_.forces(l, r, d, v, number)
        p = max(c_.pressure(min(max(-number, l), r), d, v, number), 0.0)
    found.depth, found.depth_rate, found.acceleration = d, v, dv
    found.sliding_velocity, found.velocity, found.way = number, number, Y
    found.edges[0], found.edges[1] = l, r
    first = run.given.drives if run.given.sprung else 0
    leads = number > 0.0 or (number == 0.0 and forward(run.pieces, first, step.piece, s))
    found.leading_edge, found.trailing_edge = (l, r) if leads else (r, l)
    found.edge_states[0], found.edge_states[1] = left.state, right.state
    found.normal_force, found.friction_force = f_z, f_x
    found.peak_pressure, found.rounding = p, rounding
    found.offset, found.offset_rate, found.spring_force = 0.0, 0.0, 0.0
    if run.given.sprung:
        along = run.along[index]
        found.velocity = evaluate(run.pieces[along.piece], s)[1]
        found.offset, found.offset_rate, _ = motion(along, s)
        spring, damping = run.given.spring, run.given.damping
        found.spring_force = spring * found.offset + damping * found.offset_rate


def forward(pieces: Any, first: int, k: int, s: float) -> bool:
    """Whether the left edge was the leading edge before the base came to the rest it is in at `s`.

    `pieces` are those of its motion, from the `first` to the present one, `k`.
    """
    number = 0.0
    while number == 0.0 and k >= first:
        piece = pieces[k]
        number = evaluate(piece, 0.5 * (piece[START] + min(s, piece[END])))[1]
        k -= 1
    return number >= 0.0
