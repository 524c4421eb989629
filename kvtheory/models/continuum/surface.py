"""The surface of the foundation at any time: under the indenter, and where it relaxes (fact F8)."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum import evaluation
from kvtheory.models.continuum.dense_output import instant
from kvtheory.models.continuum.memory_chains import SIDES
from kvtheory.models.continuum.quadrature import integrals
from kvtheory.models.continuum.solver import Trajectory
from kvtheory.scene import base_motion as drive_

Array = NDArray[np.float64]


HALVINGS = 40
"""For the instant at which ground was left; its height is stationary there (p = 0), so that half as
many digits of the instant as of the height would do."""

LEAST_HALF = 1e-9
"""Of half the width of the interval in which p > 0, relative to 1 + |lambda|: a smaller one is rounding.
It is zero where an indenter takes off, which is found a little too late: nothing is swept in that while."""

STRIP = np.polynomial.legendre.leggauss(3)
"""Exact for u^2 on a strip."""

ROUNDING = 1e-15
"""Of an edge in units of 1 + |Y|, for it is kept as X = xi - Y."""


def _chain(motion: Trajectory, k: int, s: float, edge: float) -> Iterator[list[float]]:
    """Yield the nodes of ground that was touched, outward from an edge, where the first one begins."""
    front, node = _front(motion, k, s, edge)
    yield from front
    while node >= 0:
        row = list(motion.nodes[node])
        if row[c_.IN_S] > -math.inf:
            yield row
        node = int(row[c_.NEXT])


def _front(motion: Trajectory, k: int, s: float, edge: float) -> tuple[list[list[float]], int]:
    """Return the nodes that do not yet, or no longer, exist as a whole, and the first that does.

    `edge` is xi of the edge at `s`.
    """
    index = evaluation.record_at(motion.rows, s)
    d, v, _, Y, number, _ = instant(motion, index, s)
    record, side = motion.records[index], SIDES[k]
    state, top = record[h_.LEFT_STATE + 2 * k], int(record[h_.LEFT_NODE + 2 * k])
    X = record[h_.LEFT_X + k]
    if state == c_.FREE or (state == c_.PEELING and s == record[h_.START]):
        return [], top
    if state == c_.PEELING:
        then = instant(motion, index, record[h_.START])
        now = [c_.root(side, number, d + v)[0] - Y, s, d, Y]
        return [[*now, X, record[h_.START], then[0], then[3], float(index), side]], top
    if motion.nodes[top][c_.IN_S] < s:  # else it was left just now
        top = c_.reached(motion, side, top, s, d, Y)
    row = list(motion.nodes[top])
    if s > record[h_.START]:
        X = edge - Y
    if row[c_.IN_S] == -math.inf:
        return [], top
    if row[c_.RECORD] >= 0.0 and row[c_.IN_S] < s:
        row[c_.IN_S], row[c_.IN_D], row[c_.IN_Y] = c_.sweep(motion, side, row, s, d, Y)
    row[c_.IN_X] = X
    return [row], int(row[c_.NEXT])


def height(motion: Trajectory, xi: ArrayLike, s: float) -> Array:
    """Return the compression u at the positions `xi`, also where the surface relaxes (fact F8).

    Under the indenter u = d - xi^2. Outside u = e^-(s - sigma) g(X, sigma), where sigma is the instant
    at which X = xi - Y was left: known for a strip, the root of X_e(sigma) = X for ground that a
    peeling edge swept. Ground that was never touched has u = 0.

    Examples
    --------
    >>> from kvtheory.models.continuum.solver import solve
    >>> from kvtheory.scene.base_motion import BaseMotion
    >>> motion = solve(BaseMotion.constant(4.0, end=2.0), 0.04, 0.0, end=2.0)
    >>> height(motion, [-1.0, 0.0, 1.0, 3.0], 1.0).round(6)
    array([0.      , 0.307843, 0.23703 , 0.23551 ])
    """
    now, Y = motion.at(s), instant(motion, evaluation.record_at(motion.rows, s), s)[3]
    xi = np.asarray(xi, dtype=float)
    X, slack = xi - Y, ROUNDING * (1.0 + abs(Y))
    inside = (now.left - slack <= xi) & (xi <= now.right + slack)  # false in flight: edges are NaN
    u = np.where(inside, now.depth - xi * xi, 0.0)
    for k, edge in enumerate((now.left, now.right)):
        for row in _chain(motion, k, s, edge):
            here = (X - row[c_.IN_X]) * (X - row[c_.OUT_X]) <= 0.0
            if here.any():
                u[here] = np.maximum(u[here], _left(motion, row, X[here], s))
    return u


def volume(motion: Trajectory, s: float) -> float:
    """Return U = int u dxi over the whole surface, of which f_z = 3/4 (U + U') (fact F14)."""
    now, free = motion.at(s), float(relaxing(motion, [s], 1, kept(motion, 1))[0])
    if now.left_state == "free":
        return free
    l, r = now.left, now.right
    return free + (r - l) * (now.depth - (r * r + r * l + l * l) / 3.0)


def relaxing(
    motion: Trajectory, times: Sequence[float], power: int, memory: list[tuple[float, float]]
) -> Array:
    """Return the integral of u^`power` outside the contact at each time; `memory` is `kept` for it."""
    total = np.zeros(len(times))
    rows, owners = [], []
    edges = motion.states(times)[:, [evaluation.LEFT, evaluation.RIGHT]].tolist()
    for i, s in enumerate(times):
        for k in range(2):
            front, node = _front(motion, k, s, edges[i][k])
            rows += front
            owners += [i] * len(front)
            if node >= 0:
                when, integral = memory[node]
                total[i] += integral * math.exp(power * (when - s))
    np.add.at(total, owners, _integrals(motion, rows, np.asarray(times)[owners], power))
    return total


def kept(motion: Trajectory, power: int) -> list[tuple[float, float]]:
    """Return, for each node, when it was complete, and the integral of u^power from there outward."""
    complete = np.array([max(row[c_.IN_S], row[c_.OUT_S]) for row in motion.nodes])
    own, touched = np.zeros(complete.size), complete > -math.inf
    rows = [row for row, one in zip(motion.nodes, touched, strict=True) if one]
    own[touched] = _integrals(motion, rows, complete[touched], power)
    memory: list[tuple[float, float]] = []
    for row, since, integral in zip(motion.nodes, complete.tolist(), own.tolist(), strict=True):
        when, total = memory[int(row[c_.NEXT])] if row[c_.NEXT] >= 0.0 else (-math.inf, 0.0)
        latest = max(when, since)
        if latest > -math.inf:
            total *= math.exp(power * (when - latest))
            total += integral * math.exp(power * (since - latest))
        memory.append((latest, total))
    return memory


def _sweep_of(motion: Trajectory, rows: Array) -> Callable[[Any, Array], tuple[Array, ...]]:
    """Return a function of `which` nodes among `rows`, and times sigma of shape (which, points).

    It returns xi, d, Y and dX/dsigma of the edges that swept these nodes.
    """
    records = np.array(motion.records)[rows[:, c_.RECORD].astype(int)].T
    pieces = np.array(motion.pieces)[records[h_.PIECE].astype(int)].T
    rates, numbers = records[h_.POWERS :], pieces[drive_.POWERS :]
    depths, slopes = polynomial.polyint(rates), polynomial.polyder(rates)
    travels, number_slopes = polynomial.polyint(numbers), polynomial.polyder(numbers)

    def at(which: Any, sigma: Array) -> tuple[Array, ...]:
        def value(coefficients: Array, x: Array) -> Array:
            return np.asarray(polynomial.polyval(x, coefficients[:, which, None], tensor=False))

        record, piece, branch = (
            records[:, which, None], pieces[:, which, None], rows[which, c_.BRANCH, None]
        )  # fmt: skip
        span, t = record[h_.SPAN], sigma - piece[drive_.START]
        theta = (sigma - record[h_.START]) / span
        d = record[h_.DEPTH] + span * value(depths, theta)
        Y = piece[drive_.DISPLACEMENT] + value(travels, t)
        v, number = value(rates, theta), value(numbers, t)
        half = np.sqrt(np.maximum(d + v + number * number, 0.0))
        least = LEAST_HALF * (1.0 + np.abs(number))
        gone, half = half < least, np.maximum(half, least)
        near = branch * number > 0.0  # without cancellation
        xi = branch * np.where(near, (d + v) / (np.abs(number) + half), half - branch * number)
        rate = v + value(slopes, theta) / span - 2.0 * value(number_slopes, t) * xi
        return xi, d, Y, np.where(gone, 0.0, rate / (2.0 * branch * half) - number)

    return at


def _left(motion: Trajectory, row: list[float], X: Array, s: float) -> Array:
    """Return u at the points `X` of one node."""
    inner: Any = np.full(X.shape, row[c_.IN_S])
    if row[c_.RECORD] < 0.0:
        return np.exp(inner - s) * (row[c_.IN_D] - (X + row[c_.IN_Y]) ** 2)
    outer, outward = np.full(X.shape, row[c_.OUT_S]), row[c_.OUT_X] - row[c_.IN_X]
    swept = _sweep_of(motion, np.array([row]))
    for _ in range(HALVINGS):
        sigma = 0.5 * (inner + outer)
        xi, _, Y, _ = swept([0], sigma)
        later = ((xi - Y - X) * outward > 0.0)[0]
        inner, outer = np.where(later, inner, sigma), np.where(later, sigma, outer)
    _, d, Y, _ = swept([0], inner)
    return (np.exp(inner - s) * (d - (X + Y) ** 2))[0]


def _integrals(motion: Trajectory, nodes: Sequence[Sequence[float]], s: Array, power: int) -> Array:
    """Return the integrals of [e^-(s - sigma) g(X, sigma)]^power over X on nodes, each at its time s."""
    rows = np.array([row[: c_.NEXT] for row in nodes]).reshape(-1, c_.NEXT)
    found, strip = np.empty(len(rows)), rows[:, c_.RECORD] < 0.0
    found[strip] = _of_strips(rows[strip], s[strip], power)
    found[~strip] = _of_sweeps(motion, rows[~strip], s[~strip], power)
    return found


def _of_strips(rows: Array, s: Array, power: int) -> Array:
    inner, d, Y = rows[:, c_.IN_S, None], rows[:, c_.IN_D, None], rows[:, c_.IN_Y, None]
    middle = 0.5 * (rows[:, c_.OUT_X] + rows[:, c_.IN_X])
    half = 0.5 * np.abs(rows[:, c_.OUT_X] - rows[:, c_.IN_X])
    x, weights = STRIP
    u = np.exp(inner - s[:, None]) * (d - (middle[:, None] + half[:, None] * x + Y) ** 2)
    return half * (u**power @ weights)


def _of_sweeps(motion: Trajectory, rows: Array, s: Array, power: int) -> Array:
    inner, outer = rows[:, c_.IN_S], rows[:, c_.OUT_S]
    swept = _sweep_of(motion, rows)

    def flux(which: Any, sigma: Array) -> Array:
        xi, d, _, rate = swept(which, sigma)
        return (np.exp(sigma - s[which, None]) * (d - xi * xi)) ** power * rate

    whole = np.abs(integrals(flux, inner, outer))
    # sigma follows from an edge that is stationary in it: it may be off by the root of rounding
    xi = rows[:, c_.IN_X] + rows[:, c_.IN_Y]
    sliver = swept(slice(None), inner[:, None])[0][:, 0] - xi
    u_in = np.exp(inner - s) * (rows[:, c_.IN_D] - xi * xi)
    return whole + np.sign(rows[:, c_.OUT_X] - rows[:, c_.IN_X]) * sliver * u_in**power
