r"""The slow manifold: a start from rest without inertia, one equation of motion (fact F13).

For eps -> 0 the forces balance at every instant, f_z = f with f = 1 - kappa (d - 1). With the leading
edge on undisturbed ground, l = -a, a = sqrt(d), and a peeling trailing edge r, the contact length
b = r + a solves

    b^2 (2 b + 3 (lambda - a)) = 4 f,

which has one positive root, and p(r) = 0 gives the rate d' = r^2 + 2 lambda r - d. What is
neglected is the fast relaxation after the start (time constant about eps, F12) and terms of order eps.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]

NEWTON_STEPS = 60
"""Newton's method falls monotonically on the convex side; far above the root it gains a factor 3/2."""


def contact_length(depth: ArrayLike, number: ArrayLike, support_number: ArrayLike = 0.0) -> Array:
    """Return b = r - l on the slow manifold, in units of a_0.

    Examples
    --------
    >>> float(contact_length(1.0, 0.0))  # at rest: the whole stationary contact
    2.0
    """
    d, number, kappa = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (depth, number, support_number))
    )
    f = 1.0 - kappa * (d - 1.0)
    if np.any(f <= 0.0) or np.any(d <= 0.0):
        raise ValueError("`depth` must be positive, and the spring must leave a load to carry")
    n = number - np.sqrt(d)
    b = np.cbrt(2.0 * f) + 1.5 * np.maximum(-n, 0.0)  # there 2 b^3 + 3 n b^2 >= 4 f
    for _ in range(NEWTON_STEPS):
        step = (b * b * (2.0 * b + 3.0 * n) - 4.0 * f) / (6.0 * b * (b + n))
        b = b - step
        if np.all(np.abs(step) <= 4.0 * np.finfo(float).eps * b):
            return b
    raise ArithmeticError("the contact length on the slow manifold did not converge")


def depth_rate(depth: ArrayLike, number: ArrayLike, support_number: ArrayLike = 0.0) -> Array:
    """Return d' on the slow manifold.

    Examples
    --------
    >>> float(depth_rate(1.0, 0.0))
    0.0
    """
    d, number = np.asarray(depth, float), np.asarray(number, float)
    r = contact_length(d, number, support_number) - np.sqrt(d)
    return np.asarray(r * (r + 2.0 * number) - d)


def solve(
    number: float, support_number: float, end: float, rtol: float = 1e-9
) -> Callable[[ArrayLike], Any]:
    """Return d(s) for 0 <= s <= end after a start from rest, lambda = `number` > 0, as a function.

    Raises
    ------
    ArithmeticError
        If the integration fails.

    Examples
    --------
    >>> depth = solve(4.0, 0.0, end=5.0)
    >>> print(f"{depth(0.0):.3f} {depth(5.0):.6f}")
    1.000 0.303964
    """
    if number <= 0.0:
        raise ValueError(f"`number` must be positive, got {number!r}: the trailing edge must peel")

    def log_rate(_: float, log_depth: Array) -> Array:
        d = np.exp(log_depth)  # the depth stays positive, however fast it falls
        return depth_rate(d, number, support_number) / d

    # Stiff at high velocity: the rate towards the steady state grows as lambda^(3/2).
    found = solve_ivp(
        log_rate, (0.0, end), [0.0], method="Radau", rtol=rtol, atol=rtol, dense_output=True
    )
    if not found.success:
        raise ArithmeticError(f"slow manifold: {found.message}")
    return lambda s: np.exp(found.sol(np.asarray(s, float))[0])
