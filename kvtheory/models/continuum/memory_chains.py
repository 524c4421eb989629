"""The memory of both sides: the ground that the edges leave behind, take-off, flight and landing."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum.contact import instant
from kvtheory.models.continuum.run import FREE, SIDES, TOUCHING, Run

SUMMIT_RTOL = 1e-9
"""Relative tolerance of sigma; the margin is stationary there, so that its error is of second order."""


def set_place(place: Any, X: float, s: float, d: float, Y: float) -> None:
    """Write an end of a node."""
    place.X, place.s, place.d, place.Y = X, s, d, Y


def copy(node: Any, inner: Any, outer: Any, old: Any) -> None:
    """Write a node with these ends, and otherwise a copy of `old`."""
    set_place(node.inner, inner.X, inner.s, inner.d, inner.Y)
    set_place(node.outer, outer.X, outer.s, outer.d, outer.Y)
    node.step, node.branch, node.next, node.joined = old.step, old.branch, old.next, old.joined


def push(run: Run, k: int, step: int, branch: float) -> None:
    """Add a node to a chain: the first unused record, whose ends are already written.

    A is smooth across to the next node if the same edge swept both without a kink between them.
    """
    node, top = run.nodes[run.now.nodes], run.now.sides[k].node
    below = run.nodes[top]
    meets = node.outer.s == below.inner.s and node.outer.s != run.now.kink
    node.joined = step >= 0 and below.step >= 0 and branch == below.branch and meets
    node.step, node.branch, node.next = step, branch, top
    put(run, k)


def put(run: Run, k: int) -> None:
    """Make the first unused record the innermost node of a chain."""
    run.now.sides[k].node = run.now.nodes
    run.now.nodes += 1


def push_strip(run: Run, k: int, inner: float, outer: float, Y: float) -> None:
    """Add to a chain a strip of ground that is left as a whole at the present instant."""
    node, s, d = run.nodes[run.now.nodes], run.now.s, run.now.d
    set_place(node.inner, inner, s, d, Y)
    set_place(node.outer, outer, s, d, Y)
    push(run, k, -1, 0.0)


def trim(run: Run, k: int, Y: float) -> None:
    """Cut the chain of a touching side so that it begins at the edge."""
    now, side = run.now, run.now.sides[k]
    old, node = run.nodes[side.node], run.nodes[now.nodes]
    copy(node, old.inner, old.outer, old)
    if node.step >= 0:
        s, d, left_at = c_.sweep(run, SIDES[k], old, now.s, now.d, Y)
        set_place(node.inner, side.X, s, d, left_at)
    node.inner.X = side.X
    put(run, k)


def leave(run: Run, Y: float) -> None:
    """Take off: the ground under the contact joins the memory."""
    left, right = run.now.sides[0], run.now.sides[1]
    for k in range(2):
        if run.now.sides[k].state == TOUCHING:
            trim(run, k, Y)
    if left.X < right.X:
        push_strip(run, 1, left.X, right.X, Y)
    left.state = right.state = FREE


def land(run: Run, Y: float) -> None:
    """Land: split the chains at the landing point, where both edges touch."""
    now = run.now
    _, X, side, index, sigma = summit(run, now.s, now.d, Y)
    near = 1 if side > 0.0 else 0
    far = 1 - near
    inner = now.sides[near].node
    while inner != index:
        push_reversed(run, far, run.nodes[inner])
        inner = run.nodes[inner].next
    old = run.nodes[index]
    d_0, Y_0 = old.inner.d, old.inner.Y
    if old.step >= 0:
        d_0, _, _, Y_0, _, _ = instant(run, old.step, sigma)
    if old.inner.X != X:
        push_reversed(run, far, old)
        set_place(run.nodes[now.sides[far].node].inner, X, sigma, d_0, Y_0)
    node = run.nodes[now.nodes]
    copy(node, old.inner, old.outer, old)
    set_place(node.inner, X, sigma, d_0, Y_0)
    put(run, near)
    for k in range(2):
        now.sides[k].state, now.sides[k].X = TOUCHING, X


def push_reversed(run: Run, k: int, old: Any) -> None:
    """Add a copy of a node to the chain of the other side, with its ends exchanged."""
    copy(run.nodes[run.now.nodes], old.outer, old.inner, old)
    push(run, k, old.step, old.branch)


def summit(run: Run, s: float, d: float, Y: float) -> tuple[float, float, float, int, float]:
    """Return the largest margin, its X, side and node, and the instant sigma at which X was left.

    The indenter lands when the margin reaches zero. The margin e^-s (e^s g - A) is concave in X, for A
    is a supremum of functions with the same curvature at earlier, smaller weights; so its largest value
    is found by walking outward while it rises.
    """
    for k in (1, 0):
        side, index = SIDES[k], run.now.sides[k].node
        if rise(side, run.nodes[index].inner, s, Y) <= 0.0:
            continue
        while rise(side, run.nodes[index].outer, s, Y) > 0.0:
            index = run.nodes[index].next
        X, sigma, d_0, Y_0 = _peak(run, side, run.nodes[index], s, Y)
        return margin(X, s, d, Y, sigma, d_0, Y_0), X, side, index, sigma
    index = run.now.sides[1].node
    at = run.nodes[index].inner
    return margin(at.X, s, d, Y, at.s, at.d, at.Y), at.X, 1.0, index, at.s


def margin(X: float, s: float, d: float, Y: float, s_0: float, d_0: float, Y_0: float) -> float:
    """Return g(X, s) - e^-(s - s_0) g(X, s_0)."""
    xi, xi_0 = X + Y, X + Y_0
    return d - xi * xi - math.exp(s_0 - s) * (d_0 - xi_0 * xi_0)


def rise(side: float, at: Any, s: float, Y: float) -> float:
    """Return half the outward slope of the margin over X, at a place."""
    return slope(side, at.X, s, Y, at.s, at.Y)


def slope(side: float, X: float, s: float, Y: float, s_0: float, Y_0: float) -> float:
    """Return half the outward slope of the margin over X."""
    return -side * (X + Y - math.exp(s_0 - s) * (X + Y_0))


def _peak(
    run: Run, side: float, node: Any, s: float, Y: float
) -> tuple[float, float, float, float]:
    """Return X, sigma, d, Y of the largest margin on one node; it is not beyond the outer end."""
    at, inner, outer = node.inner, node.inner.s, node.outer.s
    if rise(side, at, s, Y) <= 0.0:
        return at.X, inner, at.d, at.Y
    if node.step < 0:
        q = math.exp(inner - s)
        return (q * at.Y - Y) / -math.expm1(inner - s), inner, at.d, at.Y
    while True:
        sigma = 0.5 * (inner + outer)
        d_0, v_0, _, Y_0, number, _ = instant(run, node.step, sigma)
        X = c_.root(node.branch, number, d_0 + v_0)[0] - Y_0
        if abs(inner - outer) <= SUMMIT_RTOL * (s - sigma) or sigma in (inner, outer):
            return X, sigma, d_0, Y_0
        if slope(side, X, s, Y, sigma, Y_0) > 0.0:
            inner = sigma
        else:
            outer = sigma
