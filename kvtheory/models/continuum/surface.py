"""The surface of the foundation at any time: under the indenter, and where it relaxes (fact F8)."""

import math
from collections.abc import Callable, Sequence
from copy import copy
from typing import Any

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum.contact import instant
from kvtheory.models.continuum.run import FREE, NODE, PEELING, PLACE, SIDES, step_at
from kvtheory.records import new, structured
from kvtheory.scene import base_motion as drive_

Array = NDArray[np.float64]

HALVINGS = 40
"""Bisections for the instant at which ground was left; its height is stationary there (p = 0), so that half
as many digits of the instant as of the height would do."""
LEAST_HALF = 1e-9
"""Least half width of the interval in which p > 0, relative to 1 + |lambda|: a smaller one is rounding. It is
zero at a take-off, which is located slightly too late: nothing is swept in between."""
ROUNDING = 1e-15
"""Rounding error of an edge in units of 1 + |Y|, since it is stored as X = xi - Y."""

POINTS = 10
"""Points of Gauss's rule on one panel: most steps of a motion are then halved only once."""
TOLERANCE = 1e-12
"""Largest difference between a panel and its halves, relative to 1 + the size of the integral. The halves
are used, whose error is smaller by many digits."""
PANEL_LIMIT = 1000
"""Most panels of one integral at one level of halving. Four are needed where a drive goes, in one step,
through rest to ten thousand half lengths in a retardation time."""
ABSCISSAE, WEIGHTS = (np.polynomial.legendre.leggauss(POINTS) + np.array([[1.0], [0.0]])) * 0.5
"""Gauss's rule on [0, 1]."""
STRIP = np.polynomial.legendre.leggauss(3)
"""Exact for u^2 on a strip."""


def height(motion: Any, xi: ArrayLike, s: float) -> Array:
    """Return the compression u at the positions `xi`, also where the surface relaxes (fact F8).

    Under the indenter u = d - xi^2. Outside u = e^-(s - sigma) g(X, sigma), where sigma is the instant
    at which X = xi - Y was left: known for a strip, the root of X_e(sigma) = X for ground that a
    peeling edge swept. Ground that was never touched has u = 0.
    """
    run, now = motion.interpreted, motion.at(s)
    Y = instant(run, step_at(run, s), s)[3]
    xi = np.asarray(xi, dtype=float)
    X, slack = xi - Y, ROUNDING * (1.0 + abs(Y))
    inside = (now.left - slack <= xi) & (xi <= now.right + slack)  # false in flight: edges are NaN
    u = np.where(inside, now.depth - xi * xi, 0.0)
    for k, edge in enumerate((now.left, now.right)):
        nodes, index = _front(motion, k, s, edge)
        while index >= 0:
            nodes.append(run.nodes[index])
            index = run.nodes[index].next
        for node in nodes:
            here = (X - node.inner.X) * (X - node.outer.X) <= 0.0
            if node.inner.s > -math.inf and here.any():
                u[here] = np.maximum(u[here], _left(motion, node, X[here], s))
    return u


def volume(motion: Any, s: float) -> float:
    """Return U = int u dxi over the whole surface, of which f_z = 3/4 (U + U') (fact F14)."""
    now, free = motion.at(s), float(relaxing(motion, [s], 1, kept(motion, 1))[0])
    if now.left_state == "free":
        return free
    l, r = now.left, now.right
    return free + (r - l) * (now.depth - (r * r + r * l + l * l) / 3.0)


def relaxing(
    motion: Any, times: Sequence[float], power: int, memory: list[tuple[float, float]]
) -> Array:
    """Return the integral of u^`power` outside the contact at each time; `memory` comes from `kept`."""
    total = np.zeros(len(times))
    nodes, owners = [], []
    edges = motion.states(times)["edges"].tolist()
    for i, s in enumerate(times):
        for k in range(2):
            front, index = _front(motion, k, s, edges[i][k])
            nodes += front
            owners += [i] * len(front)
            if index >= 0:
                when, integral = memory[index]
                total[i] += integral * math.exp(power * (when - s))
    ages = np.asarray(times)[owners]
    np.add.at(total, owners, _integrals(motion, structured(nodes, NODE), ages, power))
    return total


def kept(motion: Any, power: int) -> list[tuple[float, float]]:
    """Return, for each node, when it was complete, and the integral of u^power from there outward."""
    nodes = motion.nodes
    complete = np.maximum(nodes["inner"]["s"], nodes["outer"]["s"])
    own, touched = np.zeros(complete.size), complete > -math.inf
    own[touched] = _integrals(motion, nodes[touched], complete[touched], power)
    memory: list[tuple[float, float]] = []
    rows = nodes["next"].tolist(), complete.tolist(), own.tolist()
    for outward, since, integral in zip(*rows, strict=True):
        when, total = memory[outward] if outward >= 0 else (-math.inf, 0.0)
        latest = max(when, since)
        if latest > -math.inf:
            total *= math.exp(power * (when - latest))
            total += integral * math.exp(power * (since - latest))
        memory.append((latest, total))
    return memory


def _front(motion: Any, k: int, s: float, edge: float) -> tuple[list[Any], int]:
    """Return the nodes that are partial at `s`, with the edge at xi = `edge`, and the next whole one."""
    run = motion.interpreted
    index = step_at(run, s)
    d, v, _, Y, number, _ = instant(run, index, s)
    step, held, side = run.steps[index], run.steps[index].sides[k], SIDES[k]
    top = held.node
    if held.state == FREE or (held.state == PEELING and s == step.start):
        return [], top
    if held.state == PEELING:
        then = instant(run, index, step.start)
        inner = c_.root(side, number, d + v)[0] - Y, s, d, Y
        outer = held.X, step.start, then[0], then[3]
        return [new(NODE, inner, outer, index, side, -1, False)], top
    if run.nodes[top].inner.s < s:  # else it was left just now
        top = c_.reached(run, side, top, s, d, Y)
    node = run.nodes[top]
    if node.inner.s == -math.inf:
        return [], top
    place = node.inner.s, node.inner.d, node.inner.Y
    if node.step >= 0 and node.inner.s < s:
        place = c_.sweep(run, side, node, s, d, Y)
    cut = copy(node)
    cut.inner = new(PLACE, edge - Y if s > step.start else held.X, *place)
    return [cut], node.next


def _sweep_of(motion: Any, nodes: NDArray[Any]) -> Callable[[Any, Array], tuple[Array, ...]]:
    """Return a function of `which` nodes, and times sigma of shape (which, points).

    It returns xi, d, Y and dX/dsigma of the edges that swept these nodes.
    """
    steps = motion.records[nodes["step"]]
    pieces = motion.pieces[steps["piece"]].T
    rates, numbers = steps["rate"].T, pieces[drive_.POWERS :]
    depths, slopes = polynomial.polyint(rates), polynomial.polyder(rates)
    travels, number_slopes = polynomial.polyint(numbers), polynomial.polyder(numbers)

    def at(which: Any, sigma: Array) -> tuple[Array, ...]:
        def value(coefficients: Array, x: Array) -> Array:
            return np.asarray(polynomial.polyval(x, coefficients[:, which, None], tensor=False))

        step, piece = steps[which, None], pieces[:, which, None]
        branch, span, t = nodes["branch"][which, None], step["span"], sigma - piece[drive_.START]
        theta = (sigma - step["start"]) / span
        d = step["depth"] + span * value(depths, theta)
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


def _left(motion: Any, node: Any, X: Array, s: float) -> Array:
    """Return u at the points `X` of one node."""
    inner: Any = np.full(X.shape, node.inner.s)
    if node.step < 0:
        return np.exp(inner - s) * (node.inner.d - (X + node.inner.Y) ** 2)
    outer, outward = np.full(X.shape, node.outer.s), node.outer.X - node.inner.X
    swept = _sweep_of(motion, structured([node], NODE))
    for _ in range(HALVINGS):
        sigma = 0.5 * (inner + outer)
        xi, _, Y, _ = swept([0], sigma)
        later = ((xi - Y - X) * outward > 0.0)[0]
        inner, outer = np.where(later, inner, sigma), np.where(later, sigma, outer)
    _, d, Y, _ = swept([0], inner)
    return (np.exp(inner - s) * (d - (X + Y) ** 2))[0]


def _integrals(motion: Any, nodes: NDArray[Any], s: Array, power: int) -> Array:
    """Return the integrals of [e^-(s - sigma) g(X, sigma)]^power over X on nodes, each at its time s."""
    found, strip = np.empty(len(nodes)), nodes["step"] < 0
    inner, outer = nodes[strip]["inner"][:, None], nodes[strip]["outer"][:, None]
    middle, half = 0.5 * (outer["X"] + inner["X"]), 0.5 * np.abs(outer["X"] - inner["X"])
    x, weights = STRIP
    u = np.exp(inner["s"] - s[strip, None]) * (inner["d"] - (middle + half * x + inner["Y"]) ** 2)
    found[strip] = half[:, 0] * (u**power @ weights)

    nodes, s = nodes[~strip], s[~strip]
    inner, outer, swept = nodes["inner"], nodes["outer"], _sweep_of(motion, nodes)

    def flux(which: Any, sigma: Array) -> Array:
        xi, d, _, rate = swept(which, sigma)
        return (np.exp(sigma - s[which, None]) * (d - xi * xi)) ** power * rate

    whole = np.abs(integrals(flux, inner["s"], outer["s"]))
    # sigma follows from an edge that is stationary in it: its error may be the square root of rounding
    xi = inner["X"] + inner["Y"]
    sliver = swept(slice(None), inner["s"][:, None])[0][:, 0] - xi
    u_in = np.exp(inner["s"] - s) * (inner["d"] - xi * xi)
    found[~strip] = whole + np.sign(outer["X"] - inner["X"]) * sliver * u_in**power
    return found


def integrals(function: Callable[[Any, Array], Array], low: Array, high: Array) -> Array:
    """Return the integral of each function k over s from `low[k]` to `high[k]`, by Gauss's rule.

    `function` returns the values of the functions `which`, shape (n,), at the points `s`, shape (n, m), in
    that shape, or (n, m, c) for c integrands each. An integrand may be singular at its ends as sqrt or
    1/sqrt: with s = low + (high - low) x^2 (3 - 2 x), it is smooth over x in [0, 1]. A panel of x is halved
    until its rule agrees with that on its halves; ArithmeticError if too many panels are needed.

    >>> ends = np.array([1.0, 4.0])
    >>> integrals(lambda _, s: 1.0 / np.sqrt(s), 0.0 * ends, ends).round(12)
    array([2., 4.])
    """

    def rule(which: Any, start: Array, width: float) -> Array:
        x = start[:, None] + width * ABSCISSAE
        span = (high - low)[which, None]
        values = function(which, low[which, None] + span * (x * x * (3.0 - 2.0 * x)))
        weights = (6.0 * width) * span * x * (1.0 - x) * WEIGHTS
        return np.einsum("nm,nm...->n...", weights, values)

    which, start, width = np.arange(low.size), np.zeros(low.size), 1.0
    whole = rule(which, start, width)
    total, size = np.zeros(whole.shape), 1.0 + np.abs(whole)
    while which.size:
        width *= 0.5
        if 2 * np.bincount(which).max() > PANEL_LIMIT:
            raise ArithmeticError(f"an integral of the motion needs over {PANEL_LIMIT} panels")
        which, start = np.repeat(which, 2), np.stack([start, start + width], axis=-1).reshape(-1)
        parts = rule(which, start, width)
        halves = parts[::2] + parts[1::2]
        agree = np.abs(halves - whole) <= TOLERANCE * size[which[::2]]  # never if they are NaN
        again = ~np.all(agree.reshape(agree.shape[0], -1), axis=1)
        np.add.at(total, which[::2][~again], halves[~again])
        kept = np.repeat(again, 2)
        which, start, whole = which[kept], start[kept], parts[kept]
    return total
