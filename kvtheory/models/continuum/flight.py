"""The free flight of the indenter over what it left behind: where it will land.

The margin e^-s (e^s g - A) is concave in X, for A is a supremum of functions with the same curvature
at earlier, smaller weights; so its largest value is found by walking outward while it rises.
"""

import math
from collections.abc import Sequence

from kvtheory.models.continuum.contact import (
    BRANCH,
    IN_D,
    IN_S,
    IN_X,
    IN_Y,
    NEXT,
    OUT_S,
    OUT_X,
    OUT_Y,
    RECORD,
    root,
)
from kvtheory.models.continuum.dense_output import Rows, instant
from kvtheory.scene.base_motion import Piece

SUMMIT_RTOL = 1e-9
"""For sigma; the margin is stationary there, so that its error is of the order of the square."""


def summit(
    s: float,
    d: float,
    Y: float,
    left: int,
    right: int,
    nodes: Rows,
    records: Rows,
    pieces: Sequence[Piece],
) -> tuple[float, float, float, int, float]:
    """Return the largest margin, its X, side and node, and the sigma at which X was left.

    The indenter lands when the margin reaches zero.
    """
    for side in (1.0, -1.0):
        node = right if side > 0.0 else left
        row = nodes[node]
        if rise(side, row[IN_X], s, Y, row[IN_S], row[IN_Y]) <= 0.0:
            continue
        while rise(side, row[OUT_X], s, Y, row[OUT_S], row[OUT_Y]) > 0.0:
            node = int(row[NEXT])
            row = nodes[node]
        X, sigma, d_0, Y_0 = _peak(side, row, s, Y, records, pieces)
        return margin(X, s, d, Y, sigma, d_0, Y_0), X, side, node, sigma
    row = nodes[right]
    value = margin(row[IN_X], s, d, Y, row[IN_S], row[IN_D], row[IN_Y])
    return value, row[IN_X], 1.0, right, row[IN_S]


def margin(X: float, s: float, d: float, Y: float, s_0: float, d_0: float, Y_0: float) -> float:
    """Return g(X, s) - e^-(s - s_0) g(X, s_0)."""
    xi, xi_0 = X + Y, X + Y_0
    return d - xi * xi - math.exp(s_0 - s) * (d_0 - xi_0 * xi_0)


def rise(side: float, X: float, s: float, Y: float, s_0: float, Y_0: float) -> float:
    """Return half the outward slope of the margin over X."""
    return -side * (X + Y - math.exp(s_0 - s) * (X + Y_0))


def _peak(
    side: float, row: Sequence[float], s: float, Y: float, records: Rows, pieces: Sequence[Piece]
) -> tuple[float, float, float, float]:
    """Return X, sigma, d, Y of the largest margin on one node, whose outer end it does not exceed."""
    inner, outer = row[IN_S], row[OUT_S]
    if rise(side, row[IN_X], s, Y, inner, row[IN_Y]) <= 0.0:
        return row[IN_X], inner, row[IN_D], row[IN_Y]
    if row[RECORD] < 0.0:
        q = math.exp(inner - s)
        return (q * row[IN_Y] - Y) / -math.expm1(inner - s), inner, row[IN_D], row[IN_Y]
    while True:
        sigma = 0.5 * (inner + outer)
        d_0, v_0, _, Y_0, number, _ = instant(records, pieces, int(row[RECORD]), sigma)
        X = root(row[BRANCH], number, d_0 + v_0)[0] - Y_0
        if abs(inner - outer) <= SUMMIT_RTOL * (s - sigma) or sigma in (inner, outer):
            return X, sigma, d_0, Y_0
        if rise(side, X, s, Y, sigma, Y_0) > 0.0:
            inner = sigma
        else:
            outer = sigma
