"""Edges of contact between two elements, by numbers alone.

The overlap w = g - u says how far the indenter is below the free surface: it meets it where w = 0. On
free ground w falls to the edge in a straight line, and where contact peeled off, as a square.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.law import Array

Runs = NDArray[np.intp]
"""A row for each run of elements in contact: the element before it, and its last."""
Gaps = tuple[Any, Any, Any]
"""w, w', w'' at the first element outside, inward, in units of the spacing."""
INSIDE, OUTSIDE = np.array([1, 0]), np.array([0, 1])
"""From `Runs` to the last element inside each edge, left and right, and to the first outside."""
BEYOND = np.array([[[0, 1]], [[-1, 2]], [[-2, 3]]])
"""To the three nearest elements outside."""
OUTWARD = np.array([-1.0, 1.0])
STRAIGHT = 0.25
"""Of w'^2: the least w'^2 - 2 w w'', which is w'^2 where w is a straight line and 0 where it is a square."""


def runs_of(pressed: NDArray[np.bool_]) -> Runs:
    """Return the runs of elements in contact; those at both ends are taken to be out of it.

    >>> runs_of(np.array([False, True, True, False])).tolist()
    [[0, 2]]
    """
    changes: Runs = (pressed[1:] != pressed[:-1]).nonzero()[0]
    return changes.reshape(-1, 2)


def sums_over(runs: Runs, values: Array) -> Array:
    """Return the sum of the values over each run.

    >>> sums_over(np.array([[0, 2], [3, 4]]), np.array([9.0, 1.0, 2.0, 9.0, 3.0, 9.0])).tolist()
    [3.0, 3.0]
    """
    sums: Array = np.add.reduceat(values, runs.ravel() + 1)[::2]
    return sums


def gaps(w: Any, far: Any, farthest: Any) -> Gaps:
    """Return the parabola of w through the three nearest elements outside, where w < 0."""
    return w, 1.5 * w - 2.0 * far + 0.5 * farthest, w - 2.0 * far + farthest


def touching(found: Gaps) -> Any:
    """Return how far inward of the first element outside w = 0 is, from 0 to 1 element."""
    w, slope, curvature = found
    fall = slope + np.sqrt(np.maximum(slope * slope - 2.0 * w * curvature, 0.0))
    return np.fmin(np.maximum(np.divide(-2.0 * w, fall), 0.0), 1.0)


def straight(found: Gaps) -> Any:
    """Whether w falls to the edge in a straight line rather than as a square.

    >>> bool(straight((-0.5, 1.0, 0.0))), bool(straight((-0.25, 1.0, -2.0)))
    (True, False)
    """
    w, slope, curvature = found
    return slope * slope - 2.0 * w * curvature > STRAIGHT * slope * slope


def bend(values: Array, runs: Runs) -> Array:
    """Return by how much a field bends at each edge, by differences on either side.

    >>> bend(np.array([0.0, 0.0, 3.0, 9.0, 9.0, 9.0, 9.0]), np.array([[1, 3]])).tolist()
    [[6.0, -6.0]]
    """
    inner, outer, inward = runs + INSIDE, runs + OUTSIDE, np.array([1, -1])
    inside = values[inner + inward] - values[inner]
    bent: Array = inside - (values[outer] - values[outer - inward])
    return bent


def kink_area(overlap: Any) -> tuple[Any, Any, Any, Any]:
    """Return what trapezoids leave out of the area of u at an edge by dx, its d/dδ and d²/dδ², and the bend.

    `overlap` is w at the three nearest elements outside. Between the first of them and the next inside, u
    is the larger of two nearly straight lines, which cross where w = 0; the trapezoid takes the chord
    (theorem `element-kink`). Besides, the jump of the slope leaves a twelfth of it times dx^2, as at every
    end of a smooth piece (Euler-Maclaurin). The bend is that jump, as a difference of two elements.

    >>> x = 0.1 * np.arange(-5.0, 6.0) + 0.03
    >>> sums = 0.1 * np.maximum(x, 0.0).sum() - 0.05 * x[-1] - 0.01 / 12.0
    >>> bool(abs(sums + 0.1 * kink_area(x[4:1:-1])[0] - 0.5 * x[-1] ** 2) < 1e-15)
    True
    """
    w, far, farthest = overlap
    rise = 2.0 * w - 3.0 * far + farthest
    within = w + rise
    known = (w < 0.0) & (within > 0.0)
    rise = np.where(known, rise, np.inf)
    half = 0.5 / rise
    area = np.where(known, half * within * w + rise / 12.0, 0.0)
    return area, np.where(known, half * (within + w), 0.0), 2.0 * half, rise
