"""Extremes of the quantities of a solved transient, and when its friction force settles.

A motion is smooth within a step. It is sampled densely; a maximum is then refined between two samples.
"""

import math
from typing import Any

from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum.run import Run
from kvtheory.records import record

SAMPLES = 12
"""Parts of each step, on which the depth is a polynomial of degree 8."""
JUST_BEFORE = 1.0 - 2.0**-53
"""Factor from a number to the next smaller one."""
SAME = 1e-10
"""Relative difference of values that count as equal, as in steady sliding; the first one then counts."""
GOLDEN, SECTIONS = 0.6180339887498949, 18
"""Golden-section steps, down to a thousandth of a step; then Newton's method on central differences."""
NEWTON_STEPS, DIFFERENCE, BISECTIONS = 3, 1e-3, 60
"""Iterations; width of a difference as a share of a step: width^4 and rounding/width are both small."""
LARGEST, SMALLEST, MAGNITUDE = 1, -1, 0
"""Senses of an extreme."""
EXTREME = record(quantity="i8", sense="i8", time="f8", value="f8")
"""An extreme of one of the `MEASURED` quantities, by its place among them: what is asked, and the answer."""


def sample(run: Run, times: Any, found: Any) -> int:
    """Write times and states that divide each step into `SAMPLES` parts, the last just before its end."""
    count = 0
    for index in range(run.now.steps):
        start, end = _step(run, index)
        for k in range(SAMPLES + 1):
            times[count] = end if k == SAMPLES else start + (end - start) * (k / SAMPLES)
            e_.state_at(run, index, times[count], found[count])
            count += 1
    return count


def find(run: Run, times: Any, found: Any, count: int, extreme: Any, row: Any) -> None:
    """Write time and value of an extreme that is asked."""
    extreme.time, extreme.value = largest(
        run, times, found, count, extreme.quantity, extreme.sense, row
    )


def largest(
    run: Run, times: Any, found: Any, count: int, quantity: int, sense: int, row: Any
) -> tuple[float, float]:
    """Return time and value of the extreme of a quantity in a `sense`; NaN if it never exists.

    The `quantity` is its place in `evaluation.MEASURED`. `times` and `found` hold the `count` samples, `row`
    is workspace for a state. Candidates are all samples, and the refined maxima beside each sample that may
    be exceeded between it and its neighbours.
    """
    top, best_s, best = -math.inf, math.nan, math.nan
    for i in range(count):
        top = max(top, _measured(found[i], quantity, sense))
    highest = top
    for i in range(count):
        value = _measured(found[i], quantity, sense)
        if not highest - SAME * abs(highest) <= value + _rise(found, i, quantity, sense):
            continue
        for k in range(3):
            s, there = times[i], value
            if k != 1:
                if not 0 <= i % (SAMPLES + 1) + k - 1 <= SAMPLES or not highest > -math.inf:
                    continue
                neighbour = _measured(found[i + k - 1], quantity, sense)
                if abs(value - neighbour) <= SAME * abs(value):
                    continue
                near, far = times[min(i, i + k - 1)], times[max(i, i + k - 1)]
                s, there = _refined(run, i // (SAMPLES + 1), near, far, quantity, sense, row)
            top = max(top, there)
            if not best >= top - SAME * abs(top) and there >= top - SAME * abs(top):
                best_s, best = s, there
    return best_s, best * (sense if sense != MAGNITUDE else 1)


def settled(
    run: Run, times: Any, found: Any, count: int, force: float, share: float, row: Any
) -> float:
    """Return the time from which friction stays within a share of `force`; NaN if it does not settle."""
    at = count - 1
    while at >= 0 and not abs(found[at].friction_force - force) > share * abs(force):
        at -= 1
    if force == 0.0 or at == count - 1:
        return math.nan
    if at < 0:
        return 0.0
    outside, inside = times[at], times[at + 1]
    for _ in range(BISECTIONS):
        middle = 0.5 * (outside + inside)
        e_.state_at(run, at // (SAMPLES + 1), middle, row)
        if abs(row.friction_force - force) > share * abs(force):
            outside = middle
        else:
            inside = middle
    return inside


def _measured(state: Any, quantity: int, sense: int) -> float:
    """Return the objective to maximize."""
    value = e_.measured(state)[quantity]
    return abs(value) if sense == MAGNITUDE else sense * value


def _step(run: Run, index: int) -> tuple[float, float]:
    """Return the start of a step, and the last instant that belongs to it."""
    last = index + 1 == run.now.steps
    return run.steps[index].start, e_.end_of(run, index) * (1.0 if last else JUST_BEFORE)


def _rise(found: Any, i: int, quantity: int, sense: int) -> float:
    """Return how far a sample exceeds its neighbours in the step: it bounds what sampling misses there."""
    value, rise = _measured(found[i], quantity, sense), 0.0
    for k in (-1, 1):
        if 0 <= i % (SAMPLES + 1) + k <= SAMPLES:
            over = value - _measured(found[i + k], quantity, sense)
            if over < -SAME * abs(value):
                return 0.0
            rise = max(rise, over)
    return rise


def _refined(
    run: Run, index: int, a: float, b: float, quantity: int, sense: int, row: Any
) -> tuple[float, float]:
    """Return where a quantity is largest on [a, b], within one step, and the value."""
    start, end = _step(run, index)
    low, high = b - GOLDEN * (b - a), a + GOLDEN * (b - a)
    at_low = _at(run, index, low, quantity, sense, row)
    at_high = _at(run, index, high, quantity, sense, row)
    for _ in range(SECTIONS):
        if at_low >= at_high:
            b, high, at_high = high, low, at_low
            low = b - GOLDEN * (b - a)
            at_low = _at(run, index, low, quantity, sense, row)
        else:
            a, low, at_low = low, high, at_high
            high = a + GOLDEN * (b - a)
            at_high = _at(run, index, high, quantity, sense, row)
    s, best = (low, at_low) if at_low >= at_high else (high, at_high)
    h = DIFFERENCE * (end - start)
    for _ in range(NEWTON_STEPS):
        if not start <= s - 2.0 * h < s + 2.0 * h <= end:
            break
        left = _at(run, index, s - h, quantity, sense, row)
        right = _at(run, index, s + h, quantity, sense, row)
        far = _at(run, index, s + 2.0 * h, quantity, sense, row)
        far -= _at(run, index, s - 2.0 * h, quantity, sense, row)
        curvature = (left - 2.0 * best + right) / h
        if not curvature < 0.0:
            break
        moved = s - (8.0 * (right - left) - far) / (12.0 * curvature)
        there = _at(run, index, min(max(moved, start), end), quantity, sense, row)
        if not (start <= moved <= end and there >= best - SAME * abs(best)):
            break
        s, best = moved, there
    return s, best


def _at(run: Run, index: int, s: float, quantity: int, sense: int, row: Any) -> float:
    e_.state_at(run, index, s, row)
    return _measured(row, quantity, sense)
