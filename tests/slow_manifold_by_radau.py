r"""The slow manifold: a start from rest without inertia, one equation of motion (fact F13), by SciPy.

For eps -> 0 the forces balance at every instant, f_z = f with f = 1 - kappa (d - 1). With the leading edge on
undisturbed ground, l = -a, a = sqrt(d), and a peeling trailing edge r, the contact length b = r + a solves

    b^2 (2 b + 3 (lambda - a)) = 4 f,

which has one positive root, and p(r) = 0 gives the rate d' = r^2 + 2 lambda r - d. Neglected are the fast
relaxation after the start (time constant about eps, F12) and terms of order eps.
"""

import numpy as np
from scipy.integrate import solve_ivp

NEWTON_STEPS = 60
"""Newton's method falls monotonically on the convex side; far above the root it gains a factor 3/2."""


def contact_length(depth, number, support_number=0.0):
    """Return b = r - l on the slow manifold, in units of a_0: 2 at rest."""
    d, number, kappa = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (depth, number, support_number))
    )
    f, n = 1.0 - kappa * (d - 1.0), number - np.sqrt(d)
    b = np.cbrt(2.0 * f) + 1.5 * np.maximum(-n, 0.0)  # there 2 b^3 + 3 n b^2 >= 4 f
    for _ in range(NEWTON_STEPS):
        step = (b * b * (2.0 * b + 3.0 * n) - 4.0 * f) / (6.0 * b * (b + n))
        b = b - step
        if np.all(np.abs(step) <= 4.0 * np.finfo(float).eps * b):
            return b
    raise ArithmeticError("the contact length on the slow manifold did not converge")


def depth_rate(depth, number, support_number=0.0):
    """Return d' on the slow manifold."""
    d, number = np.asarray(depth, float), np.asarray(number, float)
    r = contact_length(d, number, support_number) - np.sqrt(d)
    return np.asarray(r * (r + 2.0 * number) - d)


def solve(number, support_number, end, rtol=1e-9):
    """Return d(s) for 0 <= s <= end after a start from rest, lambda = `number` > 0, as a function."""

    def log_rate(_, log_depth):
        d = np.exp(log_depth)  # the depth stays positive, however fast it falls
        return depth_rate(d, number, support_number) / d

    # Stiff at high velocity: the rate towards the steady state grows as lambda^(3/2).
    found = solve_ivp(log_rate, (0.0, end), [0.0], "Radau", rtol=rtol, atol=rtol, dense_output=True)
    if not found.success:
        raise ArithmeticError(f"slow manifold: {found.message}")
    return lambda s: np.exp(found.sol(np.asarray(s, float))[0])
