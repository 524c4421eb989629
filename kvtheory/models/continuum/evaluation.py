"""The state at any time of a solved motion: depth, edges and forces."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum.contact import FREE, instant, motion
from kvtheory.models.continuum.run import Run, step_at
from kvtheory.scene.base_motion import END, START, evaluate

DEPTH, RATE, ACCELERATION, NUMBER, LEFT, RIGHT = range(6)
LEFT_STATE, RIGHT_STATE, NORMAL_FORCE, FRICTION_FORCE, PEAK_PRESSURE, ROUNDING = range(6, 12)
DRIVE, ALONG, ALONG_RATE, SPRING_FORCE, LEADING, TRAILING = range(12, 18)
SIZE = 18
"""Columns of a state, in scaled form; edges are NaN in flight. `NUMBER` is the drive number of the base under
the indenter, `ROUNDING` the rounding error of an edge, which is large on ground that was left just before.
`DRIVE` is the drive number; x, x' and the force of spring and damper are zero for a rigid drive."""

SUBDIVISIONS = 4
"""Points shown for each step; steps are long where the motion is steady."""

UNIT = 4e-16
"""Rounding of d and Y, relative to 1 + |Y|."""


def states(times: Any, found: Any, run: Run) -> None:
    """Write the state at each of the `times` into a row of `found`.

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
    found[DEPTH], found[RATE], found[ACCELERATION], found[NUMBER] = d, v, dv, number
    found[LEFT], found[RIGHT] = l, r
    leads = number > 0.0 or (number == 0.0 and forward(run, step, s))
    found[LEADING], found[TRAILING] = (l, r) if leads else (r, l)
    found[LEFT_STATE], found[RIGHT_STATE] = left.state, right.state
    found[NORMAL_FORCE], found[FRICTION_FORCE] = f_z, f_x
    found[PEAK_PRESSURE], found[ROUNDING] = p, rounding
    found[DRIVE], found[ALONG], found[ALONG_RATE], found[SPRING_FORCE] = number, 0.0, 0.0, 0.0
    if run.given.sprung:
        along = run.along[index]
        found[DRIVE] = evaluate(run.pieces[along.piece], s)[1]
        found[ALONG], found[ALONG_RATE], _ = motion(along, s)
        spring, damping = run.given.spring, run.given.damping
        found[SPRING_FORCE] = spring * found[ALONG] + damping * found[ALONG_RATE]


def forward(run: Run, step: Any, s: float) -> bool:
    """Whether the left edge was the leading edge before the base came to the rest it is in at `s`."""
    number, k, first = 0.0, step.piece, run.given.drives if run.given.sprung else 0
    while number == 0.0 and k >= first:
        piece = run.pieces[k]
        number = evaluate(piece, 0.5 * (piece[START] + min(s, piece[END])))[1]
        k -= 1
    return number >= 0.0
