"""The surface of the foundation at any time: under the indenter, and where it relaxes (fact F8)."""

import bisect
import math
from collections.abc import Iterator

import numpy as np

from kvtheory.transients import contact as c_
from kvtheory.transients import history as h_
from kvtheory.transients.continuum import Motion
from kvtheory.transients.drive import evaluate
from kvtheory.transients.history import instant

POINTS, WEIGHTS = np.polynomial.legendre.leggauss(16)


def chain(motion: Motion, k: int, s: float) -> Iterator[list[float]]:
    """Yield the nodes of ground that was touched, outward from the left edge (k = 0) or the right.

    The first node begins at the edge: in sigma, X, d and Y.
    """
    index = bisect.bisect_right(motion.starts, s) - 1
    record = motion.records[index]
    state = record[h_.LEFT_STATE + 2 * k]
    top = int(record[h_.LEFT_NODE + 2 * k])
    d, v, _ = h_.motion(record, s)
    Y, number, _ = evaluate(motion.pieces[int(record[h_.PIECE])], s)
    side = (-1.0, 1.0)[k]
    if state == c_.PEELING and s > record[h_.START]:
        Y_0 = evaluate(motion.pieces[int(record[h_.PIECE])], record[h_.START])[0]
        now = [c_.root(side, number, d + v)[0] - Y, s, d, Y]
        then = [record[h_.LEFT_X + k], record[h_.START], record[h_.DEPTH], Y_0]
        yield [*now, *then, float(index), side]
    row = list(motion.nodes[top])
    if state == c_.TOUCHING:
        if row[c_.IN_S] < s:  # else it was left just now
            row = list(motion.nodes[c_.reached(side, top, s, d, Y, motion.nodes)])
        if row[c_.IN_S] < s and row[c_.RECORD] >= 0.0:
            row[c_.IN_S], row[c_.IN_D], row[c_.IN_Y] = c_.sweep(
                side, row, s, d, Y, motion.records, motion.pieces
            )
        edges = motion.at(s)
        row[c_.IN_X] = (edges.left, edges.right)[k] - Y
    while True:
        if row[c_.IN_S] > -math.inf:
            yield row
        if row[c_.NEXT] < 0.0:
            return
        row = list(motion.nodes[int(row[c_.NEXT])])


def volume(motion: Motion, s: float) -> float:
    """Return U = int u dxi over the whole surface, of which f_z = 3/4 (U + U') (fact F14)."""
    now = motion.at(s)
    free = sum(_relaxing(motion, row, s) for k in range(2) for row in chain(motion, k, s))
    if now.left_state == "free":
        return free
    l, r = now.left, now.right
    return free + (r - l) * (now.depth - (r * r + r * l + l * l) / 3.0)


def _relaxing(motion: Motion, row: list[float], s: float) -> float:
    """Return the integral of e^-(s - sigma) g(X, sigma) over X on one node."""
    if row[c_.RECORD] < 0.0:
        a, b = row[c_.IN_X] + row[c_.IN_Y], row[c_.OUT_X] + row[c_.OUT_Y]
        whole = (b - a) * (row[c_.IN_D] - (a * a + a * b + b * b) / 3.0)
        return abs(whole) * math.exp(row[c_.IN_S] - s)
    inner, outer = row[c_.IN_S], row[c_.OUT_S]
    total = 0.0
    for point, weight in zip(POINTS, WEIGHTS, strict=True):
        x = 0.5 * (1.0 + point)
        sigma = inner + (outer - inner) * x * x  # an edge may run into a take-off as a square root
        d, v, dv, _, number, slope = instant(
            motion.records, motion.pieces, int(row[c_.RECORD]), sigma
        )
        xi, half = c_.root(row[c_.BRANCH], number, d + v)
        speed = c_.pressure_rate(xi, v, dv, number, slope) / (2.0 * half)
        total += weight * x * math.exp(sigma - s) * (d - xi * xi) * abs(speed)
    return abs(inner - outer) * total
