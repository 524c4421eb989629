"""Deviation of two solutions of one transient, from which its error is estimated.

At a take-off or landing the edges and the peak pressure jump. Two solutions find it at slightly different
times; between these, one has jumped and the other has not. There the other solution is evaluated at the same
time relative to its own jump.
"""

import math
from typing import Any

from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum.run import Run, step_at
from kvtheory.models.continuum.stepping import TAKE_OFF
from kvtheory.models.continuum.trial_step import EVENT_RESOLUTION
from kvtheory.records import record

_ALL = "f8", (len(e_.MEASURED),)
DEVIATION = record(
    apart=_ALL, size=_ALL, hops="f8", edge_rounding="f8", normal_rounding="f8", friction_rounding="f8",
    peak_rounding="f8", hop_rounding="f8",
)  # fmt: skip
"""The largest difference of each of the `MEASURED` quantities, and its largest magnitude; the difference of
the times of take-offs and landings; effects of rounding: on the edges, and through them on the forces and the
peak pressure; through the gap, on the time of a landing."""


def deviations(times: Any, found: Any, fine: Run, other: Run, rows: Any, worst: Any) -> None:
    """Raise the deviations `worst` to those of `other` from the states `found` of `fine`.

    The `times` are in order; `rows` is workspace for two states. If the solutions differ in the number of
    hops, their error is unknown, and the deviation of a quantity is at least its change since the start.
    """
    alike = hops(fine) == hops(other)
    last_f, last_o, next_f, next_o = -1, -1, next_hop(fine, 0), next_hop(other, 0)
    for i in range(len(times)):
        s = times[i]
        while alike and next_f >= 0 and fine.events[next_f].s <= s:
            rounding = _hop_rounding(fine, fine.events[next_f].s, rows[1])
            worst.hop_rounding = max(worst.hop_rounding, rounding)
            last_f, last_o = next_f, next_o
            next_f, next_o = next_hop(fine, next_f + 1), next_hop(other, next_o + 1)
        e_.state_at(other, step_at(other, s), s, rows[0])
        shifted = 0
        if alike:
            for f, o in ((last_f, last_o), (next_f, next_o)):
                if f < 0:
                    continue
                here, there = fine.events[f].s, other.events[o].s
                worst.hops = max(worst.hops, abs(there - here))
                if abs(s - here) <= abs(there - here):
                    then = min(max(there + (s - here), 0.0), other.now.s)
                    e_.state_at(other, step_at(other, then), then, rows[1])
                    shifted = 1
        _raise(worst, found[i], rows[0], rows[shifted])
        if not alike:
            _raise(worst, found[i], found[0], found[0])
            worst.hops = max(worst.hops, other.now.s)


def hops(run: Run) -> int:
    """Return the number of take-offs and landings."""
    count, index = 0, next_hop(run, 0)
    while index >= 0:
        count, index = count + 1, next_hop(run, index + 1)
    return count


def next_hop(run: Run, index: int) -> int:
    """Return the index of the next take-off or landing from the event `index` on; -1 if there is none."""
    for i in range(index, run.now.events):
        if run.events[i].kind >= TAKE_OFF:
            return i
    return -1


def _hop_rounding(run: Run, s: float, row: Any) -> float:
    """Return the rounding error of the time of a hop; at a landing, the pressure is the closing rate."""
    index, found = step_at(run, s), EVENT_RESOLUTION * (1.0 + s)
    e_.state_at(run, index, s, row)
    if row.peak_pressure > 0.0:
        Y = row.edges[0] - run.steps[index].sides[0].X
        found += e_.UNIT * (1.0 + abs(Y)) / row.peak_pressure
    return found


def _raise(worst: Any, row: Any, one: Any, two: Any) -> None:
    """Raise the deviations to those of `row` from the nearer of two other states, in each quantity."""
    values, ones, twos = e_.measured(row), e_.measured(one), e_.measured(two)
    for k in range(len(values)):
        value = _known(values[k])
        apart = min(abs(value - _known(ones[k])), abs(value - _known(twos[k])))
        worst.size[k] = max(worst.size[k], abs(value))
        worst.apart[k] = max(worst.apart[k], apart)
    rounding, pressure = row.rounding, row.peak_pressure
    arm = max(abs(_known(row.edges[0])), abs(_known(row.edges[1])))
    worst.edge_rounding = max(worst.edge_rounding, rounding)
    worst.normal_rounding = max(worst.normal_rounding, 0.75 * pressure * rounding)
    steepest = 2.0 * (abs(row.sliding_velocity) + arm)
    worst.peak_rounding = max(worst.peak_rounding, steepest * rounding)
    worst.friction_rounding = max(worst.friction_rounding, 1.5 * arm * pressure * rounding)


def _known(value: float) -> float:
    """Return a value, or zero for an edge in flight, which is NaN."""
    return 0.0 if math.isnan(value) else value
