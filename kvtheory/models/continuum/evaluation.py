"""The state at any time of a motion that was followed: depth, edges and forces."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.contact import FREE
from kvtheory.models.continuum.dense_output import instant
from kvtheory.models.continuum.run import Run
from kvtheory.scene.base_motion import evaluate

DEPTH, RATE, ACCELERATION, NUMBER, LEFT, RIGHT = range(6)
LEFT_STATE, RIGHT_STATE, NORMAL_FORCE, FRICTION_FORCE, PEAK_PRESSURE, ROUNDING = range(6, 12)
DRIVE, ALONG, ALONG_RATE, SPRING_FORCE = range(12, 16)
SIZE = 16
"""Layout of a state, in scaled form; edges are NaN in flight. `NUMBER` is that of the base under the
indenter, `ROUNDING` is how far rounding may have moved an edge: much, on ground that was left only just
before. `DRIVE` is the drive number; the last three are x, x' and the force of spring and damper, which
are zero for a rigid drive."""

SUBDIVISIONS = 4
"""Points shown for each step, which is long where nothing happens."""

UNIT = 4e-16
"""Rounding of d and Y, relative to 1 + |Y|."""


def states(times: Any, found: Any, run: Run) -> None:
    """Write the state at each of the `times` into a row of `found`.

    Where the drive jumps, it is the state just after the jump.
    """
    for i in range(len(times)):
        state_at(run, record_at(run, times[i]), times[i], found[i])


def natural(run: Run, times: Any, found: Any) -> int:
    """Write the times that show all that happens, the steps subdivided, and the states there."""
    count, index = 0, 0
    for index in range(run.counts[r_.RECORDS]):
        start, end = natural_step(run, index)
        for k in range(SUBDIVISIONS):
            s = start + (end - start) * (k / SUBDIVISIONS)
            if s < end and (count == 0 or s > times[count - 1]):
                times[count] = s
                state_at(run, index, s, found[count])
                count += 1
    times[count] = run.now[r_.S]
    state_at(run, index, times[count], found[count])
    return count + 1


def natural_step(run: Run, index: int) -> tuple[float, float]:
    """Return when a step begins, and when the next one does."""
    last = index + 1 == run.counts[r_.RECORDS]
    end = run.now[r_.S] if last else run.records[index + 1][h_.START]
    return run.records[index][h_.START], end


def record_at(run: Run, s: float) -> int:
    """Return the index of the last record that begins at `s` or before."""
    low, high, records = 0, run.counts[r_.RECORDS], run.records
    while high - low > 1:
        middle = (low + high) // 2
        if records[middle][h_.START] <= s:
            low = middle
        else:
            high = middle
    return low


def state_at(run: Run, index: int, s: float, found: Any) -> None:
    """Write the state at `s`, within the record `index`."""
    record, now = run.records[index], instant(run, index, s)
    d, v, dv, Y, number, _ = now
    sides = record[h_.LEFT_STATE : h_.LEFT_X]
    l = r = math.nan
    f_z = f_x = p = rounding = 0.0
    if sides[0] != FREE:
        # what was left at this very instant confines nothing yet
        l, r = record[h_.LEFT_X] + Y, record[h_.RIGHT_X] + Y
        if s > record[h_.START]:
            l, l_d, _, _ = c_.edge(run, -1.0, sides[0], int(sides[1]), s, now)
            r, r_d, _, _ = c_.edge(run, 1.0, sides[2], int(sides[3]), s, now)
            rounding = UNIT * (1.0 + abs(Y)) * max(abs(l_d), abs(r_d))
        f_z, f_x = c_.forces(l, r, d, v, number)
        p = max(c_.pressure(min(max(-number, l), r), d, v, number), 0.0)
    found[DEPTH], found[RATE], found[ACCELERATION], found[NUMBER] = d, v, dv, number
    found[LEFT], found[RIGHT] = l, r
    found[LEFT_STATE], found[RIGHT_STATE] = sides[0], sides[2]
    found[NORMAL_FORCE], found[FRICTION_FORCE] = f_z, f_x
    found[PEAK_PRESSURE], found[ROUNDING] = p, rounding
    found[DRIVE], found[ALONG], found[ALONG_RATE], found[SPRING_FORCE] = number, 0.0, 0.0, 0.0
    if run.given.sprung:
        along = run.along[index]
        found[DRIVE] = evaluate(run.pieces[int(along[h_.PIECE])], s)[1]
        found[ALONG], found[ALONG_RATE], _ = h_.motion(along, s)
        force = run.given.spring * found[ALONG] + run.given.damping * found[ALONG_RATE]
        found[SPRING_FORCE] = force
