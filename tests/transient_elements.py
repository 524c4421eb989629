"""The transient by the memory (F8) as it stands, on a row of points: no contact, no edges.

The scaled form is explained in `tests.transient_reference`.
"""

import math

import numpy as np

from tests.transient_scenes import at_times

SPACING = 2e-3
"""Of elements and of their time steps, before refinement; it divides the static half length."""
REACH = 2.0
"""The elements extend so far beyond the path of the indenter's axis, in half lengths."""
MARGIN = 0.1
"""More than d grows in a step; outside |xi| = sqrt(d + MARGIN) no element can be touched."""
NEWTON_STEPS = 50


def elements(scene, refinement):
    """Return d, U = int u dx and M = int xi u dx over all elements, of second order.

    The motion is written by the balance of impulse, so that it needs no pressure:

        J = epsilon v + (3/4) U,   J' = 1 - kappa (d - 1) - (3/4) U.

    For the forces, f_z = (3/4) (U + U') and f_x = -(3/2) (M + M' - lambda U).
    """
    steps = _steps(scene, refinement)
    dx = SPACING / refinement
    travel = [Y for _, _, Y in steps]
    first, last = -REACH - max(travel), REACH - min(travel)
    X = dx * np.arange(math.floor(first / dx), math.ceil(last / dx) + 1)
    w = np.maximum(0.0, 1.0 - X * X)  # u e^s: the largest e^s' g so far
    total, moment = w.sum(), X @ w
    d, U, J = 1.0, dx * total, 0.75 * dx * total
    rows = []
    for s, h, Y in steps:
        half = math.sqrt(max(d, 0.0) + MARGIN)
        window = slice(*np.searchsorted(X, [-half - Y, half - Y]))
        xi, old, growth = X[window] + Y, w[window].copy(), math.exp(s)
        others = total - old.sum()
        if scene.epsilon is not None and h > 0.0:
            free = dx * others / growth, old / growth
            d, J = _trapezoidal(scene, d, J, U, h, dx, xi * xi, free)
        if half > REACH or d > half * half:
            raise ArithmeticError(f"the contact outgrows the elements that it can touch at s = {s}")
        w[window] = np.maximum(old, growth * (d - xi * xi))
        total = others + w[window].sum()
        moment += X[window] @ (w[window] - old)
        U = dx * total / growth
        rows.append((s, d, U, dx * (moment + Y * total) / growth))
    return at_times(scene, rows, ("d", "U", "M"))


def _steps(scene, refinement):
    """Return for each step its end, its length and the travel Y at its end; the first is s = 0."""
    steps = [(0.0, 0.0, 0.0)]
    for start, stop, rate in scene.pieces():
        count = refinement * math.ceil((stop - start) / SPACING)
        for s in np.linspace(start, stop, count + 1)[1:]:
            h = s - steps[-1][0]
            simpson = rate(s - h) + 4.0 * rate(s - 0.5 * h) + rate(s)
            steps.append((float(s), h, steps[-1][2] + h * simpson / 6.0))
    return steps


def _trapezoidal(scene, d, J, U, h, dx, square, free):
    """Return d and J after a step, by Newton's method for the implicit trapezoidal rule."""
    others, surface = free
    epsilon, kappa, new = scene.epsilon, scene.kappa, d
    for _ in range(NEWTON_STEPS):
        g = new - square
        U_new = others + dx * np.maximum(g, surface).sum()
        width = dx * np.count_nonzero(g > surface)
        J_new = J + h * (1.0 - kappa * (0.5 * (d + new) - 1.0) - 0.375 * (U + U_new))
        residual = epsilon * (new - d) - 0.5 * h * (J + J_new - 0.75 * (U + U_new))
        slope = 0.375 * width + 0.25 * h * (kappa + 0.75 * width)
        change = residual / (epsilon + h * slope)
        new -= change
        if abs(change) < 1e-14:
            return new, J_new
    raise ArithmeticError("Newton's method for a step of the elements did not converge")
