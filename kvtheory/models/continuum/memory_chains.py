"""Both sides of the contact in a run: what its edges leave behind, take-off, flight and landing."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.contact import FREE, TOUCHING
from kvtheory.models.continuum.dense_output import instant
from kvtheory.models.continuum.run import SIDES, Run

SUMMIT_RTOL = 1e-9
"""For sigma; the margin is stationary there, so that its error is of the order of the square."""


def set_end(row: Any, end: int, X: float, s: float, d: float, Y: float) -> None:
    """Set X, sigma, d, Y of the inner end of a node (`end` = IN_X) or of its outer one (OUT_X)."""
    row[end], row[end + 1], row[end + 2], row[end + 3] = X, s, d, Y


def copy_end(row: Any, end: int, other: Any, other_end: int) -> None:
    """Set an end of a node to an end of another."""
    for i in range(4):
        row[end + i] = other[other_end + i]


def free_row(run: Run) -> int:
    """Return the index of the row in which the next node is written."""
    return run.counts[r_.NODES]


def push(run: Run, k: int, record: float, branch: float) -> None:
    """Put the node whose ends are in the free row on a chain.

    A is smooth across to the next node if one edge swept both, smoothly.
    """
    row, top = run.nodes[free_row(run)], run.tops[k]
    below = run.nodes[int(top)]
    joined = (
        record >= 0.0
        and below[c_.RECORD] >= 0.0
        and row[c_.OUT_S] == below[c_.IN_S]
        and branch == below[c_.BRANCH]
        and row[c_.OUT_S] != run.now[r_.KINK]
    )
    row[c_.RECORD], row[c_.BRANCH] = record, branch
    row[c_.NEXT], row[c_.JOINED] = top, 1.0 if joined else 0.0
    put(run, k)


def put(run: Run, k: int) -> None:
    """Let the free row be the innermost node of a chain."""
    run.tops[k] = run.counts[r_.NODES]
    run.counts[r_.NODES] += 1


def push_strip(run: Run, k: int, inner: float, outer: float, Y: float) -> None:
    """Put a strip on a chain that is left as a whole now."""
    row, s, d = run.nodes[free_row(run)], run.now[r_.S], run.now[r_.D]
    set_end(row, c_.IN_X, inner, s, d, Y)
    set_end(row, c_.OUT_X, outer, s, d, Y)
    push(run, k, -1.0, 0.0)


def trim(run: Run, k: int, Y: float) -> None:
    """Let the chain of a touching side begin at the edge."""
    now, row = run.now, run.nodes[free_row(run)]
    old = run.nodes[run.tops[k]]
    for i in range(c_.SIZE):
        row[i] = old[i]
    if row[c_.RECORD] >= 0.0:
        row[c_.IN_S], row[c_.IN_D], row[c_.IN_Y] = c_.sweep(
            run, SIDES[k], old, now[r_.S], now[r_.D], Y
        )
    row[c_.IN_X] = run.edges[k]
    put(run, k)


def leave(run: Run, Y: float) -> None:
    """Take off: all ground is memory."""
    for k in range(2):
        if run.states[k] == TOUCHING:
            trim(run, k, Y)
    if run.edges[0] < run.edges[1]:
        push_strip(run, 1, run.edges[0], run.edges[1], Y)
    run.states[0] = run.states[1] = FREE


def land(run: Run, Y: float) -> None:
    """Touch down: part the chains at the landing point, and let both edges touch."""
    now = run.now
    _, X, side, node, sigma = summit(run, now[r_.S], now[r_.D], Y)
    near = 1 if side > 0.0 else 0
    far = 1 - near
    inner = run.tops[near]
    while inner != node:
        row = run.nodes[inner]
        push_reversed(run, far, row)
        inner = int(row[c_.NEXT])
    old = run.nodes[node]
    d_0, Y_0 = old[c_.IN_D], old[c_.IN_Y]
    if old[c_.RECORD] >= 0.0:
        d_0, _, _, Y_0, _, _ = instant(run, int(old[c_.RECORD]), sigma)
    if old[c_.IN_X] != X:
        push_reversed(run, far, old)
        set_end(run.nodes[run.tops[far]], c_.IN_X, X, sigma, d_0, Y_0)
    row = run.nodes[free_row(run)]
    for i in range(c_.SIZE):
        row[i] = old[i]
    set_end(row, c_.IN_X, X, sigma, d_0, Y_0)
    put(run, near)
    for k in range(2):
        run.states[k], run.edges[k] = TOUCHING, X


def push_reversed(run: Run, k: int, old: Any) -> None:
    """Put a node on the chain of the other side."""
    row = run.nodes[free_row(run)]
    copy_end(row, c_.IN_X, old, c_.OUT_X)
    copy_end(row, c_.OUT_X, old, c_.IN_X)
    push(run, k, old[c_.RECORD], old[c_.BRANCH])


def summit(run: Run, s: float, d: float, Y: float) -> tuple[float, float, float, int, float]:
    """Return the largest margin, its X, side and node, and the sigma at which X was left.

    The indenter lands when the margin reaches zero. The margin e^-s (e^s g - A) is concave in X, for A
    is a supremum of functions with the same curvature at earlier, smaller weights; so its largest value
    is found by walking outward while it rises.
    """
    for side in (1.0, -1.0):
        node = run.tops[1 if side > 0.0 else 0]
        row = run.nodes[node]
        if rise(side, row[c_.IN_X], s, Y, row[c_.IN_S], row[c_.IN_Y]) <= 0.0:
            continue
        while rise(side, row[c_.OUT_X], s, Y, row[c_.OUT_S], row[c_.OUT_Y]) > 0.0:
            node = int(row[c_.NEXT])
            row = run.nodes[node]
        X, sigma, d_0, Y_0 = _peak(run, side, row, s, Y)
        return margin(X, s, d, Y, sigma, d_0, Y_0), X, side, node, sigma
    right = run.tops[1]
    row = run.nodes[right]
    value = margin(row[c_.IN_X], s, d, Y, row[c_.IN_S], row[c_.IN_D], row[c_.IN_Y])
    return value, row[c_.IN_X], 1.0, right, row[c_.IN_S]


def margin(X: float, s: float, d: float, Y: float, s_0: float, d_0: float, Y_0: float) -> float:
    """Return g(X, s) - e^-(s - s_0) g(X, s_0)."""
    xi, xi_0 = X + Y, X + Y_0
    return d - xi * xi - math.exp(s_0 - s) * (d_0 - xi_0 * xi_0)


def rise(side: float, X: float, s: float, Y: float, s_0: float, Y_0: float) -> float:
    """Return half the outward slope of the margin over X."""
    return -side * (X + Y - math.exp(s_0 - s) * (X + Y_0))


def _peak(run: Run, side: float, row: Any, s: float, Y: float) -> tuple[float, float, float, float]:
    """Return X, sigma, d, Y of the largest margin on one node, whose outer end it does not exceed."""
    inner, outer = row[c_.IN_S], row[c_.OUT_S]
    if rise(side, row[c_.IN_X], s, Y, inner, row[c_.IN_Y]) <= 0.0:
        return row[c_.IN_X], inner, row[c_.IN_D], row[c_.IN_Y]
    if row[c_.RECORD] < 0.0:
        q = math.exp(inner - s)
        return (q * row[c_.IN_Y] - Y) / -math.expm1(inner - s), inner, row[c_.IN_D], row[c_.IN_Y]
    while True:
        sigma = 0.5 * (inner + outer)
        d_0, v_0, _, Y_0, number, _ = instant(run, int(row[c_.RECORD]), sigma)
        X = c_.root(row[c_.BRANCH], number, d_0 + v_0)[0] - Y_0
        if abs(inner - outer) <= SUMMIT_RTOL * (s - sigma) or sigma in (inner, outer):
            return X, sigma, d_0, Y_0
        if rise(side, X, s, Y, sigma, Y_0) > 0.0:
            inner = sigma
        else:
            outer = sigma
