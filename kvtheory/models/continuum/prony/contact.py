r"""The contact of a parabola with a Prony series: accumulators, and the history of both edges (F23).

Scaled form, with k_i = K_i/K and T_i = tau_i/tau: u = d - xi^2 in the contact, p = u + sum s_i. An element at
X = xi - Y that entered at sigma, where an edge was at xi_e = X + Y(sigma), and its arms had the stresses s_e,
has

    s_i = k_i (A_i - xi B_i) + e^-(s - sigma)/T_i [s_e - k_i (A_i - xi_e B_i)](sigma),

    A_i' = d' + lambda B_i - A_i/T_i,   B_i' = 2 lambda - B_i/T_i,

A_i and B_i starting at zero; those in contact at rest lack the term in brackets. The moments F_i and M_i of
s_i over the contact, from which both forces follow, obey, with I_n = int xi^n dxi, summed over both edges,

    F_i' = k_i (d' I_0 - 2 lambda I_1) - F_i/T_i +- s_e X_e',
    M_i' = lambda F_i + k_i (d' I_1 - 2 lambda I_2) - M_i/T_i +- xi_e s_e X_e'.

An edge peels at p = 0, or touches the free surface, d - xi^2 = u: zero on ground that was never touched, and
where an edge left it at sigma, the solution of u + sum s_i = 0, a sum of N modes. It peels as long as p of
the element there would fall, and touches as long as it rises.

A step stores polynomials over its length, a row for each quantity, and one of each arm in `memory`. A loop
`for i in over(count)` runs over arms: compiled, i is one after the other; interpreted, all at once, as a
slice. The memory is evaluated from them, also within the step that is being solved. A segment is ground
over which one edge passed one way without a kink: it is told from the rows of this edge, and the instants
at its ends. The contact is a sequence of segments from left to right; the free ground on each side is a
list that begins at the edge. An edge that passes the end of a segment, or turns, ends a step.
"""

import math
from typing import Any

import numpy as np

from kvtheory.scene.base_motion import evaluate

RATE, ALONG, EDGES, ROWS = 0, 1, 2, 4
"""Rows of a step: d', x', both edges xi_e; their number."""
DEPTHS, SLIDES, STRESSES, FORCES, MOMENTS, OWN = 0, 1, 2, 4, 5, 6
"""Rows of an arm: A_i, B_i, s_e at both edges, F_i, M_i; their number."""
STIFFNESS, TIME, FALL, SHARE = range(4)
"""Columns of an arm: k_i, T_i, rate and share of a free mode."""

PEELING, TOUCHING, FREE = 0, 1, 2
"""States of an edge; both are free in flight."""
SIDES = (-1.0, 1.0)
NEVER = -1
"""Number of a segment: ground that was never touched. Step of a segment: elements in contact at rest, or free
ground between two places that was never touched."""

ITERATIONS, EDGE_ERROR, STALLED = 40, 4e-15, 1e-11
"""Iteration limit, and allowed error of an edge, relative to 1 + |Y|; that at the limit, due to rounding."""

PROBE, GOLDEN = 1e-3, 0.3819660112501051
"""Share of a segment within which the pressure is compared with that at its end; golden section."""
FARTHEST = 0.1
"""How far an edge is continued beyond the end of a segment."""

SEVERAL = 4
"""Arms from which on they are evaluated as an array where the kernels are interpreted."""

Run = Any


def over(count: int) -> Any:
    """Return the arms: one by one if compiled or few, else all as one slice."""
    return (slice(0, count),) if count >= SEVERAL else range(count)


def total(values: Any) -> Any:
    """Return the sum over the arms of a turn of such a loop."""
    return values.sum()


COMPILED = {"over": lambda count: range(count), "total": lambda value: value}  # noqa: PLW0108 - numba needs it
"""What stands for these functions where they are compiled."""


def value(row: Any, theta: float) -> float:
    """Return a polynomial at `theta`."""
    total = 0.0
    for k in range(len(row) - 1, -1, -1):
        total = total * theta + row[k]
    return total


def past(run: Run, index: int, i: Any, row: int, theta: float) -> Any:
    """Return a polynomial of an arm in the step `index` at `theta`."""
    powers, found = run.memory[index], 0.0 * run.arms[i, STIFFNESS]
    for k in range(powers.shape[2] - 1, -1, -1):
        found = found * theta + powers[i, row, k]
    return found


def integral(row: Any, theta: float) -> float:
    """Return the integral of a polynomial from 0 to `theta`."""
    total = 0.0
    for k in range(len(row) - 1, -1, -1):
        total = total * theta + row[k] / (k + 1)
    return total * theta


def motion(run: Run, index: int, s: float) -> tuple[float, float, float, float, float]:
    """Return d, d', Y, lambda and theta at `s`, from a step."""
    step = run.steps[index]
    theta = (s - step.start) / step.span
    Y, number, _ = evaluate(run.pieces[step.piece], s)
    d = step.depth + step.span * integral(run.rows[index, RATE], theta)
    if run.given.sprung:
        Y -= step.along + step.span * integral(run.rows[index, ALONG], theta)
        number -= value(run.rows[index, ALONG], theta)
    return d, value(run.rows[index, RATE], theta), Y, number, theta


def step_of(run: Run, edge: int, index: int, sigma: float) -> int:
    """Return the step of an instant, between the same kinks of an edge as the step `index`."""
    steps, last = run.steps, run.now.steps
    while index < last and sigma >= steps[index + 1].start and steps[index + 1].kinked[edge] == 0:
        index += 1
    while index > 0 and sigma < steps[index].start and steps[index].kinked[edge] == 0:
        index -= 1
    return index


def pressed(
    run: Run, s: float, d: float, Y: float, xi: float, edge: int, index: int, sigma: float
) -> tuple[float, float]:
    """Return p and xi of an element in contact, and write its s_i into `here`, which has A_i and B_i.

    It entered at `sigma`, in the step `index`, at this edge; at `xi` if it was in contact at rest.
    """
    theta = xi_e = 0.0
    if index != NEVER:
        _, _, Y_e, _, theta = motion(run, index, sigma)
        xi_e = value(run.rows[index, EDGES + edge], theta)
        xi = xi_e - Y_e + Y
    p, here = d - xi * xi, run.here
    for i in over(len(run.arms)):
        k = run.arms[i, STIFFNESS]
        here[i, STRESSES] = k * (here[i, DEPTHS] - xi * here[i, SLIDES])
        if index != NEVER:
            then = past(run, index, i, DEPTHS, theta) - xi_e * past(run, index, i, SLIDES, theta)
            left = past(run, index, i, STRESSES + edge, theta) - k * then
            here[i, STRESSES] += left * np.exp(np.minimum((sigma - s) / run.arms[i, TIME], 1.0))
        p += total(here[i, STRESSES])
    return p, xi


def free(
    run: Run, s: float, d: float, Y: float, edge: int, index: int, sigma: float
) -> tuple[float, float]:
    """Return the gap u - (d - xi^2) above an element that an edge left at `sigma`, and xi; write its s_i."""
    _, _, Y_e, _, theta = motion(run, index, sigma)
    xi_e = value(run.rows[index, EDGES + edge], theta)
    xi, arms, here, u_e, u = xi_e - Y_e + Y, run.arms, run.here, 0.0, 0.0
    for i in over(len(arms)):
        here[i, FORCES] = past(run, index, i, STRESSES + edge, theta)
        u_e -= total(here[i, FORCES])
    for m in range(len(arms)):
        mode = 0.0
        for i in over(len(arms)):
            mode += total(run.to_modes[m, i] * (u_e - here[i, FORCES] / arms[i, STIFFNESS]))
        here[m, MOMENTS] = mode * math.exp(min((sigma - s) * arms[m, FALL], 1.0))
        u += arms[m, SHARE] * here[m, MOMENTS]
    for i in over(len(arms)):
        here[i, STRESSES] = u * arms[i, STIFFNESS]
        for m in range(len(arms)):
            here[i, STRESSES] -= arms[i, STIFFNESS] * run.from_modes[i, m] * here[m, MOMENTS]
    return u - d + xi * xi, xi


def edge_at(
    run: Run, k: int, s: float, d: float, Y: float, xi: float, index: int, sigma: float
) -> tuple[float, int, float]:
    """Return xi of an edge, the step and the instant of the element there; write its s_i into `here`.

    From a guess of `xi`, of elements that were in contact at rest, or else of `sigma`. NaN if the secant
    method does not converge.
    """
    side, touches = run.now.sides[k], run.now.sides[k].state == TOUCHING
    if side.segment == NEVER or (touches and run.segments[side.segment].step == NEVER):
        for i in over(len(run.arms)):
            run.here[i, STRESSES] = 0.0
        return SIDES[k] * math.sqrt(max(d, 0.0)), index, sigma
    segment = run.segments[side.segment]
    at_rest = segment.step == NEVER
    far, near = segment.a if segment.edge == k else segment.b, side.near
    if far == math.inf:
        return _search(run, k, s, d, Y, xi, index, sigma, math.nan, math.nan)
    at_far, x = NEVER, xi
    if at_rest:
        far, near = segment.X_b + Y, segment.X_a + Y
        if k == 1:
            far, near = near, far
    else:
        at_far, x = step_of(run, segment.edge, index, far), sigma
    f, _ = _margin(run, side.state, s, d, Y, segment.edge, at_far, far)
    if f < 0.0 and side.state == PEELING:
        inside = _inside(run, k, s, d, Y, at_far, far, f)
        if inside != far:
            far, f = inside, 0.0
    if f >= 0.0:
        return _search(run, k, s, d, Y, xi, NEVER if at_rest else index, x, far, near)
    # beyond the end of the segment: continued as if all elements there had passed with the last one
    _, xi = _margin(run, side.state, s, d, Y, segment.edge, at_far, far)
    slope, beyond = 2.0 * xi, SIDES[k]
    if side.state == PEELING:
        beyond = -SIDES[k]
        for i in over(len(run.arms)):
            slope += total(run.arms[i, STIFFNESS] * run.here[i, SLIDES])
    return xi + beyond * min(abs(f / slope), FARTHEST), at_far, far


def at_far_end(run: Run, k: int, s: float, d: float, Y: float) -> float:
    """Return p, or the gap if the edge touches, where the segment of an edge ends; `here` has A_i and B_i."""
    side, never = run.now.sides[k], math.inf
    if side.segment == NEVER:
        return never
    segment, touches = run.segments[side.segment], side.state == TOUCHING
    far, X = (segment.a, segment.X_a) if segment.edge == k else (segment.b, segment.X_b)
    if far == math.inf:
        return never
    if segment.step == NEVER:
        if touches:
            return (X + Y) * (X + Y) - d
        return pressed(run, s, d, Y, X + Y, segment.edge, NEVER, 0.0)[0]
    index = step_of(run, segment.edge, segment.step, far)
    return _margin(run, side.state, s, d, Y, segment.edge, index, far)[0]


def _inside(
    run: Run, k: int, s: float, d: float, Y: float, index: int, far: float, f: float
) -> float:
    """Return an element in contact if the other edge passed the far end, where p < 0, else that end.

    The pressure falls outward from the far end if it was this edge that passed.
    """
    side, at_rest = run.now.sides[k], index == NEVER
    edge, low, high, best = run.segments[side.segment].edge, far, side.sigma, f
    if at_rest:
        high = side.xi - evaluate(run.pieces[run.now.piece], run.now.s)[0] + run.now.x + Y
    x = far + PROBE * (high - far)
    for turn in range(ITERATIONS):
        if not at_rest:
            index = step_of(run, edge, index, x)
        p, _ = pressed(run, s, d, Y, x, edge, index, x)
        if p > 0.0:
            return x
        if turn == 0:
            if p <= f:
                return far
            at, best = x, p
        elif p > best:
            low, high = (at, high) if (x > at) == (high > low) else (low, at)
            at, best = x, p
        elif (x > at) == (high > low):
            high = x
        else:
            low = x
        wide = abs(high - at) > abs(at - low)
        x = at + GOLDEN * ((high if wide else low) - at)
    return far


def _margin(
    run: Run, state: int, s: float, d: float, Y: float, edge: int, index: int, x: float
) -> tuple[float, float]:
    """Return p, or the gap if the edge touches, and xi."""
    if state == PEELING:
        return pressed(run, s, d, Y, x, edge, index, x)
    return free(run, s, d, Y, edge, index, x)


def _search(
    run: Run, k: int, s: float, d: float, Y: float, xi: float, index: int, x: float, far: float, near: float
) -> tuple[float, int, float]:  # fmt: skip
    """Find an edge by the secant method from a guess x: of the instant, or of xi of elements at rest.

    It lies between two instants, if they are known.
    """
    side, at_rest = run.now.sides[k], index == NEVER
    edge, before, at, last = run.segments[side.segment].edge, math.nan, 0.0, math.nan
    bracketed = not math.isnan(far)
    for _ in range(ITERATIONS):
        if not at_rest:
            x = min(x, near) if bracketed and edge == k else x
            index = step_of(run, edge, index, x)
        f, xi = _margin(run, side.state, s, d, Y, edge, index, x)
        if abs(xi - last) <= EDGE_ERROR * (1.0 + abs(Y)):
            return xi, index, x
        move = (1e-4 if at_rest else 1e-3 * (run.now.s - s)) if math.isnan(last) else 0.0
        if f != before and not math.isnan(last):
            move = -f * (x - at) / (f - before)
        before, at, last = f, x, xi
        if f > 0.0:
            far = x
        else:
            near = x
        x += move
        if bracketed and not min(near, far) <= x <= max(near, far):
            x = 0.5 * (near + far)
        elif not at_rest:
            x = min(x, s)
    return (xi if abs(xi - last) <= STALLED else math.nan), index, x
