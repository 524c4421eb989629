"""The strips of a ball: where they are, and how their forces are summed.

Strips do not know of each other, so that a ball is strips at y = 0, dy, 2 dy, ... with one motion, and its
force is the trapezoidal rule over them. The force f(y) of a strip is smooth and even up to the rim of
the contact, y = b, where it falls to zero as b - y in sliding, as (b - y)^(3/2) at rest, and as (b - y)^2
where the rim has lifted. With b = (m + s) dy, 0 <= s < 1, the rule lacks on either side

    -f'(b) dy^2 B_2(s)/2 + O(dy^(5/2)),   B_2(s) = s^2 - s + 1/6

(Euler and Maclaurin). With -f'(b) = f((m - 1) dy)/((1 + s) dy) it is the last strip but one that counts more,
or less; without this, the order is two. Only where the ball comes down on ground that it left, whose rim
is not where h = delta, is it two all the same.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.law import Array

PER_STRIP = 6.0
"""Elements along as wide as a strip, on a ball that is round: then both spacings matter about as much."""
FEWEST_STRIPS = 16
"""From the middle plane to the rim at rest."""
THREADED = 10_000
"""From about so many elements on, BLAS takes threads; below, it is twice as fast as a plain sum."""


def total(weights: Array, values: NDArray[Any]) -> float:
    """Return the sum of products; by no threads, which would cost more than they save."""
    if weights.size < THREADED:
        return float(weights @ values)
    return float(np.einsum("i,i->", weights, values))


def weights_across(dy: float, count: int, rim: float) -> Array:
    """Return the width for which each strip counts, on both sides, in m; corrected at a `rim` above zero.

    >>> y, b = np.arange(8.0), 5.0
    >>> [round(float(weights_across(1.0, 8, rim) @ np.maximum(b * b - y * y, 0.0)), 2) for rim in (0.0, b)]
    [165.0, 166.5]
    >>> round(4.0 / 3.0 * b**3, 2)
    166.67
    """
    weights = np.full(count, 2.0 * dy)
    weights[0] = dy
    last, s = divmod(rim / dy, 1.0)
    if last >= 1.0:
        weights[int(last) - 1] += dy * (s * s - s + 1.0 / 6.0) / (1.0 + s)
    return weights
