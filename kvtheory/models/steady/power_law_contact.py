r"""The contact of a power law: its shape, its trailing edge, and roots of real degree.

With c = n l the trailing edge q = x_TE/a is the root of q^n + c q^(n-1) = 1 (derivation "F19-edge"), in
ln q the root of the increasing and convex function

    G(t) = (n - 1) t + ln(e^t + c),

so that Newton's method descends to it from q = min(1, c^(-1/(n-1))), where G >= 0. As G''/(2 G') <= 1/2,
the error e of ln q becomes at most e^2/2. The last step multiplies q, to preserve its digits.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.indenters import Parabola, Wedge

Array = NDArray[np.float64]

MOST_STEPS, LAST_STEP = 80, 1e-8
"""Most iterations; about seven are needed, and ln(1/(n - 1)) more if n is close to 1. After a step as small
as this the error, its square, is below rounding."""
LAST_RESIDUAL = 8 * 2.0**-52
"""Rounding of the residual, below which iteration does not improve it."""


def shape_of(indenter: Any) -> tuple[Array, Array, Array]:
    """Return slope, L and n of h = slope |x|^n/(n L^(n-1)).

    >>> [float(each) for each in shape_of(Wedge(inclination=0.1))]
    [0.1, 1.0, 1.0]
    """
    if isinstance(indenter, Wedge):
        shape = indenter.inclination, 1.0, 1.0
    elif isinstance(indenter, Parabola):
        shape = 1.0, indenter.radius, 2.0
    else:
        shape = 1.0, indenter.length, indenter.exponent
    slope, length, exponent = map(np.asarray, shape)
    return slope, length, exponent


def trailing_edge(exponent: Array, number: Array) -> tuple[Array, Array]:
    """Return q = x_TE/a and Q = q^(n-1) for n >= 1 and l = l_r/a >= 0.

    For n = 1, the wedge, q = max(0, 1 - l) and Q is its limit, min(1, 1/l). Where q is below the range
    of double precision it is 0, and Q is still correct.

    >>> q, Q = trailing_edge(np.array([2.0, 1.0, 1.0]), np.array([0.75, 0.25, 4.0]))
    >>> q.round(12).tolist(), Q.round(12).tolist()
    ([0.5, 0.75, 0.0], [0.5, 1.0, 0.25])
    """
    c, m = exponent * number, exponent - 1.0
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        start = np.where(c > 1.0, c ** (-1.0 / m), 1.0)
        active = (m > 0.0) & (start >= np.finfo(float).tiny)  # below, the digits are lost already
        q = np.where(active, start, 0.0)
        for _ in range(MOST_STEPS):
            residual = np.log(q**m * (q + c))
            step = np.where(active, residual / (m + q / (q + c)), 0.0)
            q = q * np.exp(-step)
            # Each is iterated separately, so that the result does not depend on the others in the array.
            active &= (np.abs(step) > LAST_STEP) & (np.abs(residual) > LAST_RESIDUAL)
            if not active.any():
                break
        q = np.where(m > 0.0, q, np.maximum(0.0, 1.0 - number))
        return q, 1.0 / (q + c)


def root(base: Array, degree: Array) -> Array:
    """Return base^(1/degree), with a Newton step that corrects the rounding of 1/degree.

    >>> float(root(np.array(1000.0), np.array(3.0)))
    10.0
    """
    found = base ** (1.0 / degree)
    return found * (1.0 - (found**degree / base - 1.0) / degree)
