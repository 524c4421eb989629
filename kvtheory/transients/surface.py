"""The surface of the foundation at any time: under the indenter, and where it relaxes (fact F8)."""

import bisect
import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.transients import contact as c_
from kvtheory.transients import history as h_
from kvtheory.transients.continuum import Motion
from kvtheory.transients.history import instant
from kvtheory.transients.sides import SIDES

Array = NDArray[np.float64]


def _shares(points: int) -> tuple[Array, Array]:
    """Return points in (0, 1) and weights that integrate what ends in square roots at both ends."""
    x, weights = np.polynomial.legendre.leggauss(points)
    x = 0.5 * (1.0 + x)
    return x * x * (3.0 - 2.0 * x), 3.0 * weights * x * (1.0 - x)


SHARES, WEIGHTS = _shares(16)
"""An edge runs into a take-off, and out of a landing, as a square root of the time."""

HALVINGS = 40
"""For the instant at which ground was left; its height is stationary there (p = 0), so that half as
many digits of the instant as of the height would do."""

ROUNDING = 1e-15
"""Of an edge in units of 1 + |Y|, for it is kept as X = xi - Y."""


def chain(motion: Motion, k: int, s: float) -> Iterator[list[float]]:
    """Yield the nodes of ground that was touched, outward from the left edge (k = 0) or the right.

    The first node begins at the edge: in sigma, X, d and Y.
    """
    front, node = _front(motion, k, s)
    yield from front
    while node >= 0:
        row = list(motion.nodes[node])
        if row[c_.IN_S] > -math.inf:
            yield row
        node = int(row[c_.NEXT])


def _front(motion: Motion, k: int, s: float) -> tuple[list[list[float]], int]:
    """Return the nodes that do not yet, or no longer, exist as a whole, and the first that does."""
    index, (d, v, _, Y, number, _) = present(motion, s)
    record, side = motion.records[index], SIDES[k]
    state, top = record[h_.LEFT_STATE + 2 * k], int(record[h_.LEFT_NODE + 2 * k])
    X = record[h_.LEFT_X + k]
    if state == c_.FREE or (state == c_.PEELING and s == record[h_.START]):
        return [], top
    if state == c_.PEELING:
        then = instant(motion.records, motion.pieces, index, record[h_.START])
        now = [c_.root(side, number, d + v)[0] - Y, s, d, Y]
        return [[*now, X, record[h_.START], then[0], then[3], float(index), side]], top
    if motion.nodes[top][c_.IN_S] < s:  # else it was left just now
        top = c_.reached(side, top, s, d, Y, motion.nodes)
    row = list(motion.nodes[top])
    if s > record[h_.START]:
        edges = motion.at(s)
        X = (edges.left, edges.right)[k] - Y
    if row[c_.IN_S] == -math.inf:
        return [], top
    if row[c_.RECORD] >= 0.0 and row[c_.IN_S] < s:
        row[c_.IN_S], row[c_.IN_D], row[c_.IN_Y] = c_.sweep(
            side, row, s, d, Y, motion.records, motion.pieces
        )
    row[c_.IN_X] = X
    return [row], int(row[c_.NEXT])


def present(
    motion: Motion, s: float
) -> tuple[int, tuple[float, float, float, float, float, float]]:
    """Return the record that holds at `s`, and d, v, v', Y, lambda, lambda' from it."""
    index = bisect.bisect_right(motion.starts, s) - 1
    return index, instant(motion.records, motion.pieces, index, s)


def height(motion: Motion, xi: ArrayLike, s: float) -> Array:
    """Return the compression u at the positions `xi`, also where the surface relaxes (fact F8).

    Under the indenter u = d - xi^2. Outside u = e^-(s - sigma) g(X, sigma), where sigma is the instant
    at which X = xi - Y was left: known for a strip, the root of X_e(sigma) = X for ground that a
    peeling edge swept. Ground that was never touched has u = 0.

    Examples
    --------
    >>> from kvtheory.transients.continuum import solve
    >>> from kvtheory.transients.drive import Drive
    >>> motion = solve(Drive.constant(4.0, end=2.0), 0.04, 0.0, end=2.0)
    >>> height(motion, [-1.0, 0.0, 1.0, 3.0], 1.0).round(6)
    array([0.      , 0.307843, 0.23703 , 0.23551 ])
    """
    now, (_, (*_, Y, _, _)) = motion.at(s), present(motion, s)
    xi = np.asarray(xi, dtype=float)
    X, slack = xi - Y, ROUNDING * (1.0 + abs(Y))
    inside = (now.left - slack <= xi) & (xi <= now.right + slack)  # false in flight: edges are NaN
    u = np.where(inside, now.depth - xi * xi, 0.0)
    for k in range(2):
        for row in chain(motion, k, s):
            here = (X - row[c_.IN_X]) * (X - row[c_.OUT_X]) <= 0.0
            if here.any():
                u[here] = np.maximum(u[here], _left(motion, row, X[here], s))
    return u


def volume(motion: Motion, s: float) -> float:
    """Return U = int u dxi over the whole surface, of which f_z = 3/4 (U + U') (fact F14)."""
    now, free = motion.at(s), relaxing(motion, s, 1, kept(motion, 1))
    if now.left_state == "free":
        return free
    l, r = now.left, now.right
    return free + (r - l) * (now.depth - (r * r + r * l + l * l) / 3.0)


def relaxing(motion: Motion, s: float, power: int, memory: list[tuple[float, float]]) -> float:
    """Return the integral of u^`power` outside the contact; `memory` is `kept` for this power."""
    total = 0.0
    for k in range(2):
        front, node = _front(motion, k, s)
        total += sum(_integral(motion, row, s, power) for row in front)
        if node >= 0:
            when, integral = memory[node]
            total += integral * math.exp(power * (when - s))
    return total


def kept(motion: Motion, power: int) -> list[tuple[float, float]]:
    """Return, for each node, when it was complete, and the integral of u^power from there outward."""
    memory: list[tuple[float, float]] = []
    for row in motion.nodes:
        when, total = memory[int(row[c_.NEXT])] if row[c_.NEXT] >= 0.0 else (-math.inf, 0.0)
        latest = max(when, row[c_.IN_S], row[c_.OUT_S])
        if latest > -math.inf:
            total *= math.exp(power * (when - latest))
        if row[c_.IN_S] > -math.inf:
            total += _integral(motion, row, latest, power)
        memory.append((latest, total))
    return memory


def _swept_by(motion: Motion, row: Sequence[float], sigma: Any) -> tuple[Any, tuple[Any, ...]]:
    """Return xi of the edge that swept a node, and its d, v, v', Y, lambda, lambda' at `sigma`."""
    moment = instant(motion.records, motion.pieces, int(row[c_.RECORD]), sigma)
    d, v, _, _, number, _ = moment
    half = np.sqrt(np.maximum(d + v + number * number, 0.0))
    return row[c_.BRANCH] * half - number, moment


def _left(motion: Motion, row: list[float], X: Array, s: float) -> Array:
    """Return u at the points `X` of one node."""
    inner: Any = np.full(X.shape, row[c_.IN_S])
    if row[c_.RECORD] < 0.0:
        return np.exp(inner - s) * (row[c_.IN_D] - (X + row[c_.IN_Y]) ** 2)
    outer, outward = np.full(X.shape, row[c_.OUT_S]), row[c_.OUT_X] - row[c_.IN_X]
    for _ in range(HALVINGS):
        sigma = 0.5 * (inner + outer)
        xi, (_, _, _, Y, _, _) = _swept_by(motion, row, sigma)
        later = (xi - Y - X) * outward > 0.0
        inner, outer = np.where(later, inner, sigma), np.where(later, sigma, outer)
    _, (d, _, _, Y, _, _) = _swept_by(motion, row, inner)
    return np.exp(inner - s) * (d - (X + Y) ** 2)


def _integral(motion: Motion, row: Sequence[float], s: float, power: int) -> float:
    """Return the integral of [e^-(s - sigma) g(X, sigma)]^power over X on one node."""
    inner, d, Y = row[c_.IN_S], row[c_.IN_D], row[c_.IN_Y]
    outward = row[c_.OUT_X] - row[c_.IN_X]
    sigma = inner + (row[c_.OUT_S] - inner) * SHARES
    if row[c_.RECORD] < 0.0:
        u = math.exp(inner - s) * (d - (row[c_.IN_X] + outward * SHARES + Y) ** 2)
        return float(WEIGHTS @ u**power) * abs(outward)
    xi, (d_e, v, dv, _, number, slope) = _swept_by(motion, row, sigma)
    u = np.exp(sigma - s) * (d_e - xi * xi)
    with np.errstate(divide="raise", invalid="raise"):
        rate = c_.pressure_rate(xi, v, dv, number, slope) / (2.0 * (xi + number))
    whole = abs(float(WEIGHTS @ (u**power * rate)) * (row[c_.OUT_S] - inner))
    # sigma follows from an edge that is stationary in it: it may be off by the root of rounding
    sliver = _swept_by(motion, row, inner)[0] - (row[c_.IN_X] + Y)
    u_in = math.exp(inner - s) * (d - (row[c_.IN_X] + Y) ** 2)
    return whole + float(math.copysign(sliver, sliver * outward) * u_in**power)
