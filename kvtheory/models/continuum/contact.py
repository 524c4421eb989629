r"""Edges of the contact, what they leave behind (facts F8 to F11).

Scaled form: depth d, depth rate v, drive number lambda = Y', surface compression u = g in contact,
g = d - xi^2, at the material coordinate X = xi - Y. Outside, u e^s keeps A(X), the largest
e^sigma g(X, sigma) of the past.

Each past instant sigma confines the contact to the interval where e^s g(X, s) >= e^sigma g(X, sigma),

    xi^2 + 2 b xi - c <= 0,  b = q Delta/m,  c = d + q (d - d_sigma + Delta^2)/m,
    q = e^-(s - sigma),  m = 1 - q,  Delta = Y - Y_sigma,

with the ends -b -+ sqrt(b^2 + c). In the limit sigma -> s they are the roots of p = 0 (Eq. 33):
b -> lambda, c -> d + v. In the limit sigma -> -oo they are the edges on undisturbed ground, -+ sqrt(d)
(Eq. 32). An edge peels (the first limit binds) or touches what some past instant left.

The memory of a side is a chain of nodes, the innermost first. The ground of a node was left at one
instant (a strip, when lambda jumped; undisturbed ground, at sigma = -oo), or swept by a peeling edge
during one record of the motion: at sigma the edge was at X_e(sigma), a root of p = 0.
Nodes are never changed, so that the chain of any past time can still be walked. `side` is -1 for the
left edge and +1 for the right one.
"""

import math
from collections.abc import Sequence
from typing import Any

from kvtheory.models.continuum.dense_output import Instant, Past, instant

PEELING, TOUCHING, FREE = 0.0, 1.0, 2.0
"""States of an edge; both are free while the indenter flies."""

IN_X, IN_S, IN_D, IN_Y = 0, 1, 2, 3
OUT_X, OUT_S, OUT_D, OUT_Y = 4, 5, 6, 7
RECORD, BRANCH, NEXT, JOINED = 8, 9, 10, 11
SIZE = 12
"""Layout of a node: X, sigma, d, Y at its inner end and at its outer end; the record during which it
was swept, or -1; the sign of the root of p = 0 that swept it; the next node outward; and whether A
continues smoothly there."""

FAR = 1e150
"""Where undisturbed ground ends: its square is still a number."""

SWEEP_ERROR = 1e-15
"""Of an edge, from that of sigma: the edge is stationary where sigma is right."""
FARTHEST_GUESS = 0.75
"""Share of a sweep from its outer end: the guess by linear interpolation keeps off the inner end."""
SWEEP_STEPS, NEWTON_ALONE = 150, 20
"""Bisection alone needs less than 60; after so many, every other step is one, for Newton's may go round."""

ROUNDING = 1e-15
"""Of an edge on ground that was left just now, times the age of that ground, relative to 1 + |Y|."""

Node = Sequence[float]


def undisturbed(side: float, row: Any) -> None:
    """Write the node of ground that was never touched."""
    for i in range(SIZE):
        row[i] = 0.0
    row[IN_S] = row[OUT_S] = -math.inf
    row[OUT_X], row[RECORD], row[NEXT] = side * FAR, -1.0, -1.0


def root(side: float, b: float, c: float) -> tuple[float, float]:
    """Return -b + side sqrt(b^2 + c) without cancellation, and the square root.

    Beyond the loss of contact, b^2 + c < 0, both go on continuously, with a negative root.
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


def edge(
    run: Past, side: float, state: float, node: int, s: float, now: Instant
) -> tuple[float, float, float, int]:
    """Return xi of an edge, d(xi)/dd and d(xi)/dY for the force (a peeling edge adds none), and its node."""
    d, v, _, Y, number, _ = now
    if state == PEELING:
        return root(side, number, d + v)[0], 0.0, 0.0, node
    node = reached(run, side, node, s, d, Y)
    row = run.nodes[node]
    s_0, d_0, Y_0 = row[IN_S], row[IN_D], row[IN_Y]
    if row[RECORD] >= 0.0:
        s_0, d_0, Y_0 = sweep(run, side, row, s, d, Y)
    b, c, m = secant(s, d, Y, s_0, d_0, Y_0)
    xi, half = root(side, b, c)
    xi_d = side / (2.0 * m * max(half, 1e-300))
    return xi, xi_d, 2.0 * (1.0 - m) * xi_d * (Y - Y_0 - xi), node


def reached(run: Past, side: float, node: int, s: float, d: float, Y: float) -> int:
    """Return the node that an edge has reached, as far as A is smooth from `node` on."""
    row = run.nodes[node]
    while row[JOINED] != 0.0 and overrun(side, row, s, d, Y) > 0.0:
        node = int(row[NEXT])
        row = run.nodes[node]
    return node


def overrun(side: float, row: Node, s: float, d: float, Y: float) -> float:
    """Return how far the contact that the outer end of a node permits goes beyond that end."""
    b, c, _ = secant(s, d, Y, row[OUT_S], row[OUT_D], row[OUT_Y])
    return side * (root(side, b, c)[0] - Y - row[OUT_X])


def sweep(
    run: Past, side: float, row: Node, s: float, d: float, Y: float
) -> tuple[float, float, float]:
    """Return sigma, d, Y of the instant at which the ground at the edge was left.

    Newton's method in a bracket for X_e(sigma) = X_R(sigma), the end of the interval of sigma,
    divided by s - sigma, where both agree trivially. Where the edge is beyond the outer end of the
    node, that end confines it.
    """
    inner, outer = row[IN_S], row[OUT_S]
    ahead = overrun(side, row, s, d, Y)
    if ahead >= 0.0:
        return outer, row[OUT_D], row[OUT_Y]
    share = -ahead / (abs(row[OUT_X] - row[IN_X]) or math.inf)
    sigma = outer + min(share, FARTHEST_GUESS) * (inner - outer)
    for turn in range(SWEEP_STEPS):
        d_0, v_0, dv_0, Y_0, number, slope = instant(run, int(row[RECORD]), sigma)
        b, c, m = secant(s, d, Y, sigma, d_0, Y_0)
        xi, half = root(side, b, c)
        left_at, half_0 = root(row[BRANCH], number, d_0 + v_0)
        gap = left_at - Y_0 - (xi - Y)
        if side * gap < 0.0:
            inner = sigma
        else:
            outer = sigma
        if half > 0.0 and half_0 > 0.0:
            rate = pressure_rate(left_at, v_0, dv_0, number, slope) / (row[BRANCH] * 2.0 * half_0)
            end_rate = (
                (m - 1.0) * pressure(xi - Y + Y_0, d_0, v_0, number) / (2.0 * m * side * half)
            )
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
    side: float, state: float, row: Node, s: float, xi: float, now: Instant
) -> tuple[float, float]:
    """Return two numbers that are positive as long as an edge may keep its state and its node.

    A peeling edge moves inward through the material; at a touching edge the pressure is positive
    and the ground is that of its node. Both are relative to their terms, and as much larger as rounding
    may make them smaller.
    """
    d, v, dv, Y, number, slope = now
    if state == PEELING:
        terms = 1.0 + abs(v) + abs(dv) + number * number + abs(slope * xi)
        return -pressure_rate(xi, v, dv, number, slope) / terms, math.inf
    p = pressure(xi, d, v, number) / (1.0 + abs(v) + abs(number * xi))
    rounding = ROUNDING * (1.0 + abs(Y)) / (s - row[IN_S])
    return p + rounding, side * (row[OUT_X] - (xi - Y)) + rounding
