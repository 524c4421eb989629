"""Integrals of many functions at once, each to a tolerance: Gauss's rule, on halves where it must."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

POINTS = 10
"""Of the rule on one panel: most steps of a motion then need no more than their two halves."""
TOLERANCE = 1e-12
"""Of an integral, relative to 1 + its size, by how much a panel may differ from its halves. The halves
are kept, whose error is smaller by many digits."""
PANEL_LIMIT = 1000
"""Of one integral at one level of halving. Four are needed where a drive passes, in one step, through
rest to ten thousand half lengths in a retardation time."""

_X, _W = np.polynomial.legendre.leggauss(POINTS)
ABSCISSAE, WEIGHTS = 0.5 * (1.0 + _X), 0.5 * _W
"""On [0, 1]."""


def integrals(function: Callable[[Any, Array], Array], low: Array, high: Array) -> Array:
    """Return the integral of each function k over s from `low[k]` to `high[k]`.

    An integrand may end in square roots, or in their reciprocals: with s = low + (high - low) x^2
    (3 - 2 x), the integrand over x in [0, 1] is smooth at both ends. A panel of x is halved until its
    rule agrees with that on its halves.

    Parameters
    ----------
    function
        Returns the values of the functions `which`, shape (n,), at the points `s`, shape (n, m); their
        shape is (n, m), or (n, m, c) of c integrands each.
    low, high
        Limits, shape (count,).

    Returns
    -------
    Array
        Shape (count,) or (count, c).

    Raises
    ------
    ArithmeticError
        If an integral needs too many panels: its integrand is not piecewise smooth, or not finite.

    Examples
    --------
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
