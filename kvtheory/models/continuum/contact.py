r"""Motion within a step, the contact edges, and the ground that they leave behind (facts F8 to F11).

Scaled form: depth d, depth rate v, drive number lambda = Y', surface compression u = g in contact,
g = d - xi^2, at the material coordinate X = xi - Y. Outside the contact u e^s keeps A(X), the largest
e^sigma g(X, sigma) of the past.

Each past instant sigma confines the contact to the interval where e^s g(X, s) >= e^sigma g(X, sigma),

    xi^2 + 2 b xi - c <= 0,  b = q Delta/m,  c = d + q (d - d_sigma + Delta^2)/m,
    q = e^-(s - sigma),  m = 1 - q,  Delta = Y - Y_sigma,

with the ends -b -+ sqrt(b^2 + c). In the limit sigma -> s they are the roots of p = 0 (Eq. 33):
b -> lambda, c -> d + v. In the limit sigma -> -oo they are the edges on undisturbed ground, -+ sqrt(d)
(Eq. 32). An edge peels (the first limit binds) or touches ground that was left at some past instant.

The memory of a side is a chain of nodes, the innermost first. The ground of a node was left at one
instant (a strip, when lambda jumped; undisturbed ground, at sigma = -oo), or swept by a peeling edge
during one step: at sigma the edge was at X_e(sigma), a root of p = 0. Nodes on a chain never
change, so the chain of any past time remains available. Side 0 is the left edge, side 1 the
right one; `run` describes the records.
"""

import math
from typing import Any

from kvtheory.models.continuum.run import PEELING, SIDES, Run
from kvtheory.scene.base_motion import evaluate

SWEEP_ERROR, FARTHEST_GUESS = 1e-15, 0.75
"""Allowed error of an edge due to that of sigma, in which it is stationary; largest fraction of a sweep, from
its outer end, for the linear initial guess, which must stay off the inner end."""
SWEEP_STEPS, NEWTON_ALONE = 150, 20
"""Iteration limit (bisection alone needs fewer than 60); after `NEWTON_ALONE`, every other step bisects."""

ROUNDING = 1e-15
"""Rounding error of an edge on recently left ground, times the age of that ground, relative to 1 + |Y|."""

Instant = tuple[float, float, float, float, float, float]
"""d, v, v', Y, lambda, lambda' at one time."""


def motion(step: Any, s: float) -> tuple[float, float, float]:
    """Return depth, depth rate and its derivative at `s` from the polynomial of a step."""
    powers, theta = step.rate, (s - step.start) / step.span
    depth = rate = slope = 0.0
    for k in range(len(powers) - 1, -1, -1):
        slope = slope * theta + rate
        rate = rate * theta + powers[k]
        depth = depth * theta + powers[k] / (k + 1)
    return step.depth + depth * theta * step.span, rate, slope / step.span


def instant(run: Run, index: int, s: float) -> Instant:
    """Return the motion at `s` from the step `index`."""
    step = run.steps[index]
    return motion(step, s) + evaluate(run.pieces[step.piece], s)


def root(side: float, b: float, c: float) -> tuple[float, float]:
    """Return -b + side sqrt(b^2 + c) without cancellation, and the square root.

    Without contact, b^2 + c < 0, both are continued with a negative square root.
    """
    radicand = b * b + c
    half = math.sqrt(radicand) if radicand >= 0.0 else -math.sqrt(-radicand)
    if side * b > 0.0 and half > 0.0:
        return side * c / (abs(b) + half), half
    return -b + side * half, half


def secant(
    s: float, d: float, Y: float, s_0: float, d_0: float, Y_0: float
) -> tuple[float, float, float]:
    """Return b, c and m for the interval to which the instant `s_0` confines the contact at `s`."""
    m = -math.expm1(s_0 - s)
    ratio = (1.0 - m) / m
    shift = Y - Y_0
    return ratio * shift, d + ratio * (d - d_0 + shift * shift), m


def pressure(xi: float, d: float, v: float, number: float) -> float:
    """Return p = d + v - xi^2 - 2 lambda xi."""
    return d + v - xi * (xi + 2.0 * number)


def pressure_rate(xi: float, v: float, dv: float, number: float, slope: float) -> float:
    """Return dp/ds at fixed X; it is negative while an edge peels inward."""
    return v + dv - 2.0 * (number * (xi + number) + slope * xi)


def forces(l: float, r: float, d: float, v: float, number: float) -> tuple[float, float]:
    """Return f_z = 3/4 int p dxi and f_x = -3/2 int xi p dxi over the contact (F11)."""
    width, total = r - l, r + l
    square = r * r + r * l + l * l
    f_z = 0.75 * width * (d + v - square / 3.0 - number * total)
    f_x = -0.75 * width * (total * (d + v - 0.5 * (r * r + l * l)) - 4.0 / 3.0 * number * square)
    return f_z, f_x


def edge(run: Run, k: int, held: Any, s: float, now: Instant) -> tuple[float, float, float, int]:
    """Return xi of an edge, d(xi)/dd and d(xi)/dY for the force (zero for a peeling edge), and its node.

    `held` has the state and the node of the edge.
    """
    d, v, _, Y, number, _ = now
    side = SIDES[k]
    if held.state == PEELING:
        return root(side, number, d + v)[0], 0.0, 0.0, held.node
    reached_node = reached(run, side, held.node, s, d, Y)
    node = run.nodes[reached_node]
    s_0, d_0, Y_0 = node.inner.s, node.inner.d, node.inner.Y
    if node.step >= 0:
        s_0, d_0, Y_0 = sweep(run, side, node, s, d, Y)
    b, c, m = secant(s, d, Y, s_0, d_0, Y_0)
    xi, half = root(side, b, c)
    xi_d = side / (2.0 * m * max(half, 1e-300))
    return xi, xi_d, 2.0 * (1.0 - m) * xi_d * (Y - Y_0 - xi), reached_node


def reached(run: Run, side: float, index: int, s: float, d: float, Y: float) -> int:
    """Return the node that an edge has reached: the last one from `index` on across which A is smooth."""
    while run.nodes[index].joined and overrun(side, run.nodes[index].outer, s, d, Y) > 0.0:
        index = run.nodes[index].next
    return index


def overrun(side: float, end: Any, s: float, d: float, Y: float) -> float:
    """Return how far the contact permitted by the outer end of a node extends beyond that end."""
    b, c, _ = secant(s, d, Y, end.s, end.d, end.Y)
    return side * (root(side, b, c)[0] - Y - end.X)


def sweep(
    run: Run, side: float, node: Any, s: float, d: float, Y: float
) -> tuple[float, float, float]:
    """Return sigma, d, Y of the instant at which the ground at the edge was left.

    Newton's method in a bracket for X_e(sigma) = X_R(sigma), the end of the interval of sigma,
    divided by s - sigma, where both agree trivially. Where the edge is beyond the outer end of the
    node, that end confines it.
    """
    end, inner, outer = node.outer, node.inner.s, node.outer.s
    ahead = overrun(side, end, s, d, Y)
    if ahead >= 0.0:
        return outer, end.d, end.Y
    share = -ahead / (abs(end.X - node.inner.X) or math.inf)
    sigma = outer + min(share, FARTHEST_GUESS) * (inner - outer)
    for turn in range(SWEEP_STEPS):
        d_0, v_0, dv_0, Y_0, number, slope = instant(run, node.step, sigma)
        b, c, m = secant(s, d, Y, sigma, d_0, Y_0)
        xi, half = root(side, b, c)
        left_at, half_0 = root(node.branch, number, d_0 + v_0)
        gap = left_at - Y_0 - (xi - Y)
        if side * gap < 0.0:
            inner = sigma
        else:
            outer = sigma
        if half > 0.0 and half_0 > 0.0:
            rate = pressure_rate(left_at, v_0, dv_0, number, slope) / (node.branch * 2.0 * half_0)
            p_0 = pressure(xi - Y + Y_0, d_0, v_0, number)
            end_rate = (m - 1.0) * p_0 / (2.0 * m * side * half)
            move = -gap * (s - sigma) / ((rate - end_rate) * (s - sigma) + gap or math.inf)
            if abs(end_rate * move) <= SWEEP_ERROR:
                return sigma, d_0, Y_0
        else:
            move = math.inf
        sigma += move
        inside = min(inner, outer) < sigma < max(inner, outer)
        if not inside or (turn >= NEWTON_ALONE and turn % 2 == 0):
            sigma = 0.5 * (inner + outer)
            if sigma in (inner, outer):
                return sigma, d_0, Y_0
    return math.nan, math.nan, math.nan


def slack(
    side: float, state: int, node: Any, s: float, xi: float, now: Instant
) -> tuple[float, float]:
    """Return two numbers that are positive as long as an edge may keep its state and its node.

    A peeling edge moves inward through the material; at a touching edge the pressure is positive and the
    ground is that of its node. Both are relative to their terms, and allow for rounding.
    """
    d, v, dv, Y, number, slope = now
    if state == PEELING:
        terms = 1.0 + abs(v) + abs(dv) + number * number + abs(slope * xi)
        return -pressure_rate(xi, v, dv, number, slope) / terms, math.inf
    p = pressure(xi, d, v, number) / (1.0 + abs(v) + abs(number * xi))
    rounding = ROUNDING * (1.0 + abs(Y)) / (s - node.inner.s)
    return p + rounding, side * (node.outer.X - (xi - Y)) + rounding
