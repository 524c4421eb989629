"""The state at any time of a motion on a Prony series: depth, edges, forces, pressure, free surface."""

import math
from typing import Any

from kvtheory.models.continuum.prony.contact import (
    ALONG,
    EDGES,
    FORCES,
    FREE,
    MOMENTS,
    NEVER,
    PEELING,
    TIME,
    accumulated,
    free,
    integral,
    motion,
    over,
    past,
    pressed,
    total,
    value,
)
from kvtheory.models.continuum.prony.records import Run
from kvtheory.models.continuum.prony.step import forces
from kvtheory.models.continuum.prony.walk import walk
from kvtheory.models.continuum.run import step_at
from kvtheory.scene.base_motion import evaluate

DEPTH, RATE, NUMBER, DRIVE, ALONG_X, ALONG_RATE, LEFT, RIGHT = range(8)
NORMAL_FORCE, FRICTION_FORCE, PEAK_PRESSURE, TRAVEL, LEFT_STATE, RIGHT_STATE = range(8, 14)
SIZE = 14
"""Columns of a state in scaled form: d, d', lambda of the base under the indenter and of the drive, x, x',
both edges, both forces, the largest pressure, Y, and the states of both edges."""

REFINED, BISECTIONS, SAMPLES, LAYER = 12, 60, 3, 0.25
"""Golden sections in the search for the peak between two samples, before a parabola; bisections for the
instant at which an edge passed a place; samples in each step of the history, but in the layer where arms are
loaded, at half of the age, down to this share of the shortest relaxation time."""
GOLDEN = 0.6180339887498949
ROUNDING = 1e-12


def states(run: Run, times: Any, found: Any, peaks: bool) -> None:
    """Write the state at each of the `times` into a row of `found`, with peak pressures if wanted."""
    for i in range(len(times)):
        s, row = times[i], found[i]
        index = step_at(run, s)
        step, rows = run.steps[index], run.rows[index]
        d, v, Y, number, theta = motion(run, index, s)
        first = second = 0.0
        for k in over(len(run.arms)):
            first += total(past(run, index, k, FORCES, theta))
            second += total(past(run, index, k, MOMENTS, theta))
        l, r = value(rows[EDGES], theta), value(rows[EDGES + 1], theta)
        row[DEPTH], row[RATE], row[NUMBER], row[TRAVEL] = d, v, number, Y
        row[LEFT], row[RIGHT] = l, r
        row[DRIVE] = evaluate(run.pieces[step.piece], s)[1]
        row[ALONG_X] = step.along + step.span * integral(rows[ALONG], theta)
        row[ALONG_RATE] = value(rows[ALONG], theta)
        row[NORMAL_FORCE], row[FRICTION_FORCE] = forces(l, r, d, first, second)
        row[LEFT_STATE], row[RIGHT_STATE] = step.sides[0].state, step.sides[1].state
        if step.sides[0].state == FREE:
            row[LEFT] = row[RIGHT] = math.nan
        row[PEAK_PRESSURE] = 0.0
        if peaks:
            accumulated(run, index, theta)
            row[PEAK_PRESSURE] = peak(run, index, s, row)


def pressure_of(run: Run, s: float, state: Any, number: int, place: float) -> float:
    """Return p of an element of a segment, -inf outside of the contact; `here` has the present accumulators.

    The place is the instant at which the element entered, or X if it was in contact at rest.
    """
    segment, Y = run.segments[number], state[TRAVEL]
    at_rest = segment.step == NEVER
    index = NEVER if at_rest else step_at(run, place)
    p, xi = pressed(run, s, state[DEPTH], Y, place + Y, segment.edge, index, place)
    slack = 1e-12 * (1.0 + abs(Y))
    return p if state[LEFT] - slack <= xi <= state[RIGHT] + slack else -math.inf


def peak(run: Run, index: int, s: float, state: Any) -> float:
    """Return the largest pressure: of samples in each segment, refined by golden sections about the best."""
    largest, step, fastest = 0.0, run.steps[index], math.inf
    for i in range(len(run.arms)):
        fastest = min(fastest, LAYER * run.arms[i, TIME])
    for i in range(step.first, step.first + step.count):
        number = run.chain[i]
        segment = run.segments[number]
        at_rest = segment.step == NEVER
        low = max(segment.X_a, state[LEFT] - state[TRAVEL]) if at_rest else segment.a
        high = min(segment.X_b, state[RIGHT] - state[TRAVEL]) if at_rest else min(segment.b, s)
        if not at_rest:
            low, high = inside(run, s, state, number, low, high)
        if not high - low > ROUNDING * s:
            continue
        j = NEVER if at_rest else step_at(run, low)
        best, before, after, last, at = -math.inf, low, high, low, low
        while True:
            p = pressure_of(run, s, state, number, at)
            if p > best:
                best, before, after = p, last, math.inf
            elif after == math.inf:
                after = at
            if at >= high:
                break
            last = at
            width = (high - low) / (2 * SAMPLES)
            if not at_rest:
                while j < index and run.steps[j + 1].start <= at:
                    j += 1
                width = min(run.steps[j].span, high - low) / SAMPLES
                width = min(width, max(0.5 * (s - at), fastest))
            at = at + width if at + 1.5 * width < high else high  # not twice, but for rounding
        largest = max(largest, best)
        if best > 0.0:
            largest = max(largest, golden(run, s, state, number, before, min(after, high)))
    return largest


def inside(
    run: Run, s: float, state: Any, number: int, low: float, high: float
) -> tuple[float, float]:
    """Return the instants between which the elements of a segment entered that are in contact."""
    first, last = (LEFT, RIGHT) if run.segments[number].edge == 1 else (RIGHT, LEFT)
    if pressure_of(run, s, state, number, low) == -math.inf:
        low = instant_of(run, number, s, state[first] - state[TRAVEL])
    if pressure_of(run, s, state, number, high) == -math.inf:
        high = instant_of(run, number, s, state[last] - state[TRAVEL])
    return low, high


def golden(run: Run, s: float, state: Any, number: int, low: float, high: float) -> float:
    """Return the largest pressure between two places of a segment: by golden sections, then a parabola."""
    one, two = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    f, g = (pressure_of(run, s, state, number, one), pressure_of(run, s, state, number, two))
    beside, h = two, g
    for _ in range(REFINED):
        if f > g:
            beside, h, high, two, g = two, g, two, one, f
            one = high - GOLDEN * (high - low)
            f = pressure_of(run, s, state, number, one)
        else:
            beside, h, low, one, f = one, f, one, two, g
            two = low + GOLDEN * (high - low)
            g = pressure_of(run, s, state, number, two)
    largest = max(f, g)
    fall, rise = (f - h) * (one - two), (f - g) * (one - beside)
    if min(f, g, h) > -math.inf and fall != rise:
        top = one - 0.5 * (fall * (one - two) - rise * (one - beside)) / (fall - rise)
        largest = max(largest, pressure_of(run, s, state, number, min(max(top, low), high)))
    return largest


def instant_of(run: Run, number: int, s: float, X: float) -> float:
    """Return when an edge passed `X`, within a segment; NaN if it did not before `s`."""
    segment = run.segments[number]
    low, high = segment.a, min(segment.b, s)
    ends = _place(run, segment.edge, low), _place(run, segment.edge, high)
    slack = 1e-12 * (1.0 + abs(X))
    if not min(ends[0], ends[1]) - slack <= X <= max(ends[0], ends[1]) + slack:
        return math.nan
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if (_place(run, segment.edge, middle) < X) == (ends[0] < ends[1]):
            low = middle
        else:
            high = middle
    return high


def _place(run: Run, edge: int, s: float) -> float:
    index = step_at(run, s)
    _, _, Y, _, theta = motion(run, index, s)
    return value(run.rows[index, EDGES + edge], theta) - Y


def pressure(run: Run, s: float, state: Any, xi: float) -> float:
    """Return the pressure at one place, zero outside of the contact."""
    index, X = step_at(run, s), xi - state[TRAVEL]
    step = run.steps[index]
    if not state[LEFT] <= xi <= state[RIGHT]:
        return 0.0
    accumulated(run, index, (s - step.start) / step.span)
    largest = 0.0
    for i in range(step.first, step.first + step.count):
        segment = run.segments[run.chain[i]]
        if segment.step == NEVER:
            if segment.X_a <= X <= segment.X_b:
                largest = max(largest, pressure_of(run, s, state, run.chain[i], X))
        else:
            sigma = instant_of(run, run.chain[i], s, X)
            if not math.isnan(sigma):
                largest = max(largest, pressure_of(run, s, state, run.chain[i], sigma))
    return largest


def surface(run: Run, s: float, state: Any, xi: float) -> float:
    """Return the compression at one place: under the indenter, or where an edge left the ground."""
    index, X = step_at(run, s), xi - state[TRAVEL]
    if state[LEFT] <= xi <= state[RIGHT]:
        return float(state[DEPTH] - xi * xi)
    for k in range(2):
        side = run.steps[index].sides[k]
        if side.state != FREE and (xi < state[LEFT]) != (k == 0):
            continue
        number = side.own if side.state == PEELING else side.segment
        while number != NEVER:
            segment = run.segments[number]
            sigma = math.nan if segment.step == NEVER else instant_of(run, number, s, X)
            if not math.isnan(sigma):
                gap, _ = free(
                    run, s, state[DEPTH], state[TRAVEL], segment.edge, step_at(run, sigma), sigma
                )
                return gap + state[DEPTH] - xi * xi
            number = segment.next
    return 0.0


WALK, STATES, WITHOUT_PEAKS, PRESSURE, SURFACE = range(5)
"""Tasks of `perform`."""


def perform(task: int, run: Run, attempts: int, times: Any, found: Any) -> int:
    """Perform a task, the only entry to the kernels: walk, or write states at times, pressures or heights.

    The latter are at the places that follow one time, whose state is in the first row.
    """
    one = Run(run.given[0], run.now[0], *run[2:])
    if task == WALK:
        return walk(one, attempts)
    if task in (STATES, WITHOUT_PEAKS):
        states(one, times, found, task == STATES)
    else:
        for i in range(1, len(times)):
            if task == PRESSURE:
                found[i, 0] = pressure(one, times[0], found[0], times[i])
            else:
                found[i, 0] = surface(one, times[0], found[0], times[i])
    return 0
