"""Edges of contact between two elements, by numbers alone.

The overlap w = g - u says how far the indenter is below the free surface: it meets it where w = 0. On
free ground w falls to the edge in a straight line, and where contact peeled off, as a square.
"""

import math

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.law import Array

Gaps = tuple[float, float, float]
"""w, w', w'' at the first element outside, inward, in units of the spacing."""
STRAIGHT = 0.25
"""Of w'^2: the least w'^2 - 2 w w'', which is w'^2 where w is a straight line and 0 where it is a square."""


def edges_of(pressed: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return, from left to right, the last element inside each edge, and which way outside is.

    >>> edges_of(np.array([False, True, True, False]))
    [(1, -1), (2, 1)]
    """
    changes = np.flatnonzero(pressed[1:] != pressed[:-1]).tolist()
    return [(k, 1) if pressed[k] else (k + 1, -1) for k in changes]


def gaps(overlap: Array, inner: int, outward: int) -> Gaps:
    """Return the parabola of w through the three nearest elements outside, where w < 0."""
    w, far, farthest = (overlap.item(inner + k * outward) for k in (1, 2, 3))
    return w, 1.5 * w - 2.0 * far + 0.5 * farthest, w - 2.0 * far + farthest


def touching(found: Gaps) -> float:
    """Return how far inward of the first element outside w = 0 is, from 0 to 1 element."""
    w, slope, curvature = found
    fall = slope + math.sqrt(max(slope * slope - 2.0 * w * curvature, 0.0))
    inward = -2.0 * w / fall if fall else math.inf
    return min(max(inward, 0.0), 1.0) if inward == inward else 1.0  # noqa: PLR0124 (not a number)


def straight(found: Gaps) -> bool:
    """Whether w falls to the edge in a straight line rather than as a square.

    >>> straight((-0.5, 1.0, 0.0)), straight((-0.25, 1.0, -2.0))
    (True, False)
    """
    w, slope, curvature = found
    return slope * slope - 2.0 * w * curvature > STRAIGHT * slope * slope


def jump(found: Gaps) -> float:
    """Return by how much u bends where w = 0, as a difference of two elements."""
    return found[1] + 0.5 * found[2]


def bend(values: Array, inner: int, outward: int) -> float:
    """Return by how much a field bends at an edge, by differences on either side.

    >>> bend(np.array([0.0, 0.0, 3.0, 9.0]), 2, -1)
    6.0
    """
    inside = values.item(inner - outward) - values.item(inner)
    return inside - (values.item(inner + outward) - values.item(inner + 2 * outward))


def kink_area(dx: float, found: Gaps) -> tuple[float, float]:
    """Return what trapezoids leave out of the area of u at an edge, and d/dδ of it.

    Between the first element outside and the next inside, u is the larger of two nearly straight lines,
    which cross where w = 0; the trapezoid takes the chord (theorem `element-kink`). Besides, the jump of
    the slope leaves a twelfth of it times dx^2, as at every end of a smooth piece (Euler-Maclaurin).

    >>> x = 0.1 * np.arange(-5.0, 6.0) + 0.03
    >>> sums = 0.1 * np.maximum(x, 0.0).sum() - 0.05 * x[-1] - 0.01 / 12.0
    >>> bool(abs(sums + kink_area(0.1, gaps(x, 5, -1))[0] - 0.5 * x[-1] ** 2) < 1e-15)
    True
    """
    outside, within = found[0], found[0] + jump(found)
    if not (within > 0.0 > outside > -math.inf):
        return 0.0, 0.0
    half = 0.5 * dx / (within - outside)
    ends = dx / 12.0 * (within - outside)
    return half * within * outside + ends, half * (within + outside)
