"""The transient of a ball by the memory (F8) as it stands, on a sheet of points: no contact, no edges.

Scaled form: lengths along by a_0, across by b_0 = a_0 sqrt(R'/R), depths by delta_0, times by tau, forces by
W_0 = (pi/2) K a_0 b_0 delta_0. With U = int u dxi deta over all points, f_z = (2/pi) (U + U'), and the
motion is written by the balance of impulse, so that it needs no pressure:

    J = epsilon v + (2/pi) U,   J' = 1 - kappa (d - 1) - (2/pi) U.
"""

import math

import numpy as np

REACH = 1.6
"""The points extend so far beyond the path of the axis, and across."""
SHARE = 2.0 / math.pi


def sheet(pieces, epsilon, kappa, points, step):
    """Return s, d and f_z at every step, of second order; `pieces` are (end, number), from rest.

    There are so many points in a half length, and as many across; the rule across is that of midpoints.
    """
    dx = 1.0 / points
    ends, numbers = map(np.array, zip(*pieces, strict=True))
    travel = np.cumsum(np.append(0.0, np.diff(ends, prepend=0.0) * numbers))
    X = np.arange(-REACH - travel.max(), REACH - travel.min(), dx)
    eta = (np.arange(math.ceil(REACH / dx)) + 0.5) * dx
    u = np.maximum(0.0, 1.0 - X * X - (eta * eta)[:, None])
    area = 2.0 * dx * dx
    d, U, J = 1.0, area * u.sum(), SHARE * area * u.sum()
    rows, s, Y = [(0.0, 1.0, U)], 0.0, 0.0
    for end, number in pieces:
        count = math.ceil((end - s) / step)
        h = (end - s) / count
        for _ in range(count):
            Y += h * number
            old = math.exp(-h) * u
            shape = (X + Y) ** 2 + (eta * eta)[:, None]
            new = d
            for _ in range(60):
                U_new = area * np.maximum(new - shape, old).sum()
                width = area * np.count_nonzero(new - shape > old)
                J_new = J + h * (1.0 - kappa * (0.5 * (d + new) - 1.0) - 0.5 * SHARE * (U + U_new))
                residual = epsilon * (new - d) - 0.5 * h * (J + J_new - SHARE * (U + U_new))
                change = residual / (
                    epsilon + 0.5 * h * SHARE * width + 0.25 * h * h * (kappa + SHARE * width)
                )
                new -= change
                if abs(change) < 1e-13:
                    break
            u, d, U, J = np.maximum(new - shape, old), new, U_new, J_new
            s += h
            rows.append((s, d, U))
    s, d, U = np.array(rows).T
    return s, d, SHARE * (U + np.gradient(U, s))
