"""The state at any time of a solved motion on a Prony series: depth, edges, forces and pressure."""

import math
from typing import Any

from kvtheory.models.continuum.prony.contact import (
    ALONG,
    AT_REST,
    DEPTHS,
    EDGE,
    FORCES,
    MOMENTS,
    OWN,
    PER_ARM,
    SLIDES,
    arms,
    integral,
    motion,
    value,
)
from kvtheory.models.continuum.prony.records import Run
from kvtheory.models.continuum.prony.step import forces
from kvtheory.models.continuum.prony.walk import walk
from kvtheory.scene.base_motion import evaluate

DEPTH, RATE, NUMBER, DRIVE, ALONG_X, ALONG_RATE, LEFT, RIGHT = range(8)
NORMAL_FORCE, FRICTION_FORCE, PEAK_PRESSURE, TRAVEL = range(8, 12)
SIZE = 12
"""Columns of a state in scaled form: d, d', lambda of the base under the indenter and of the drive, x, x',
both edges, both forces, the largest pressure, and Y."""

REFINED, BISECTIONS = 12, 60
"""Evaluations in the search for the peak between two instants at which elements entered, and bisections for
the instant at which an element entered; the pressure is stationary at the peak."""


def step_at(run: Run, s: float) -> int:
    """Return the index of the last step that begins at `s` or before."""
    low, high = 0, run.now.steps
    while high - low > 1:
        middle = (low + high) // 2
        if run.steps[middle].start <= s:
            low = middle
        else:
            high = middle
    return low


def states(run: Run, times: Any, found: Any) -> None:
    """Write the state at each of the `times` into a row of `found`."""
    for i in range(len(times)):
        s, row = times[i], found[i]
        index = step_at(run, s)
        d, v, Y, number, theta = motion(run, index, s)
        rows, first, second = run.rows[index], 0.0, 0.0
        for k in range(len(run.arms)):
            at = PER_ARM + OWN * k
            first += value(rows[at + FORCES], theta)
            second += value(rows[at + MOMENTS], theta)
        l, r = -math.sqrt(d), value(rows[EDGE], theta)
        row[DEPTH], row[RATE], row[NUMBER], row[LEFT], row[RIGHT], row[TRAVEL] = (
            d,
            v,
            number,
            l,
            r,
            Y,
        )
        row[DRIVE] = evaluate(run.pieces[run.steps[index].piece], s)[1]
        row[ALONG_X] = run.steps[index].along + run.steps[index].span * integral(rows[ALONG], theta)
        row[ALONG_RATE] = value(rows[ALONG], theta)
        row[NORMAL_FORCE], row[FRICTION_FORCE] = forces(l, r, d, first, second)
        present(run, index, theta)
        row[PEAK_PRESSURE] = peak(run, index, s, row)


def present(run: Run, index: int, theta: float) -> None:
    """Write the accumulators of the arms at one time into `here`."""
    for i in range(len(run.arms)):
        for row in (DEPTHS, SLIDES):
            run.here[i, row] = value(run.rows[index, PER_ARM + OWN * i + row], theta)


def pressure_of(run: Run, s: float, state: Any, sigma: float) -> tuple[float, float]:
    """Return p and dp/dxi of the element that entered at `sigma`; `here` holds the present accumulators."""
    index = step_at(run, sigma)
    d, _, Y, _, theta = motion(run, index, sigma)
    l = -math.sqrt(d)
    xi = l - Y + state[TRAVEL]
    total, slope, _ = arms(run, s, xi, index, sigma, l, theta, run.here)
    return state[DEPTH] - xi * xi + total, slope - 2.0 * xi


def pressure_at_rest(run: Run, s: float, state: Any, xi: float) -> float:
    """Return p of an element that was in contact at rest."""
    total, _, _ = arms(run, s, xi, AT_REST, 0.0, 0.0, 0.0, run.here)
    return float(state[DEPTH] - xi * xi + total)


def peak(run: Run, index: int, s: float, state: Any) -> float:
    """Return the largest pressure: at ends and middles of steps of the history, and where dp/dxi is zero."""
    largest, oldest = 0.0, run.steps[index].oldest
    if oldest == AT_REST:
        bend = 0.0
        for i in range(len(run.arms)):
            bend += run.arms[i, 0] * run.here[i, SLIDES]
        xi = min(max(-0.5 * bend, state[TRAVEL] - 1.0), state[RIGHT])
        largest = pressure_at_rest(run, s, state, xi)
    before, rising = s, pressure_of(run, s, state, s)[1]
    for j in range(index, max(oldest, 0) - 1, -1):
        for half in (1.0, 0.0):
            sigma = run.steps[j].start
            if half > 0.0:
                sigma += 0.5 * ((run.steps[j + 1].start if j < index else s) - sigma)
            p, slope = pressure_of(run, s, state, sigma)
            largest = max(largest, p)
            if rising > 0.0 > slope:  # towards the trailing edge
                low, high, at_low, at_high = before, sigma, rising, slope
                for turn in range(REFINED):
                    share = at_low / (at_low - at_high)
                    if turn % 3 == 2 or not 0.02 < share < 0.98:
                        share = 0.5
                    middle = low + share * (high - low)
                    p, slope_there = pressure_of(run, s, state, middle)
                    largest = max(largest, p)
                    if slope_there > 0.0:
                        low, at_low = middle, slope_there
                    else:
                        high, at_high = middle, slope_there
            before, rising = sigma, slope
    return largest


def pressure(run: Run, s: float, state: Any, xi: float) -> float:
    """Return the pressure at one place in the contact."""
    index, X = step_at(run, s), xi - state[TRAVEL]
    present(run, index, (s - run.steps[index].start) / run.steps[index].span)
    if run.steps[0].lead < X:
        return pressure_at_rest(run, s, state, xi)
    low, high = 0.0, s
    for _ in range(BISECTIONS):
        sigma = 0.5 * (low + high)
        d, _, Y, _, _ = motion(run, step_at(run, sigma), sigma)
        if -math.sqrt(d) - Y > X:
            low = sigma
        else:
            high = sigma
    return pressure_of(run, s, state, high)[0]


WALK, STATES, PRESSURE = range(3)
"""Tasks of `perform`."""


def perform(task: int, run: Run, attempts: int, times: Any, found: Any) -> int:
    """Perform a task, the only entry to the kernels: walk, or write states at times, or pressures.

    The pressures are at the places that follow one time, whose state is in the first row.
    """
    one = Run(run.given[0], run.now[0], *run[2:])
    if task == WALK:
        return walk(one, attempts)
    if task == STATES:
        states(one, times, found)
    else:
        for i in range(1, len(times)):
            found[i, 0] = pressure(one, times[0], found[0], times[i])
    return 0
