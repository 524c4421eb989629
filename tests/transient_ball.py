"""The transient of a ball by the memory (F8) as it stands, on a sheet of points: no contact, no edges.

Scaled form: lengths along by a_0, across by b_0 = a_0 sqrt(R'/R), depths by delta_0, times by tau, forces by
W_0 = (pi/2) K a_0 b_0 delta_0. With U = int u dxi deta over all points, f_z = (2/pi) (U + U'), and the
motion is written by the balance of impulse, so that it needs no pressure:

    J = epsilon v + (2/pi) U,   J' = 1 - kappa (d - 1) - (2/pi) U.
"""

import math

import numpy as np
from scipy.optimize import fsolve

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


def sheet_on_spring(at_rest, end, points, step):
    """Return s, d, the sliding velocity in a_0/tau and the spring force at every step, from rest.

    The mean pressure of a point in a step follows from u before and after, p = (u_1 - u_0 e^-h)/(1 - e^-h),
    and is zero where it was left alone; f_x is that of the slope -2 xi halfway.
    """
    dx, number = 1.0 / points, at_rest.drive_number
    X = np.arange(-REACH - abs(number) * end, REACH + abs(number) * end, dx)
    eta = ((np.arange(math.ceil(REACH / dx)) + 0.5) * dx)[:, None]
    inertia, damping, stiffness = (
        at_rest.drive_inertia_number, at_rest.drive_damping_number, at_rest.drive_stiffness_number,
    )  # fmt: skip
    count = math.ceil(end / step)
    h = end / count
    old = math.exp(-h) * np.maximum(0.0, 1.0 - X * X - eta * eta)
    d, v, x, w, rows = 1.0, 0.0, 0.0, 0.0, []
    each = SHARE * 2.0 * dx * dx

    def pressed(place, Y, Y_new):
        u = np.maximum(place - (X + Y_new) ** 2 - eta * eta, old)
        p = each * (u - old) / -math.expm1(-h)
        return u, float(p.sum()), -float((2.0 * (X + 0.5 * (Y + Y_new)) * p).sum())

    def lacking(new):
        d_new, x_new = new
        _, f_z, f_x = pressed(d_new, number * s - x, number * (s + h) - x_new)
        push = 1.0 - at_rest.support_number * (0.5 * (d + d_new) - 1.0) - f_z
        drag = f_x - damping * (x_new - x) / h - stiffness * 0.5 * (x + x_new)
        return (
            at_rest.inertia_number * ((d_new - d) / h - v) - 0.5 * h * push,
            inertia * ((x_new - x) / h - w) - 0.5 * h * drag,
        )

    for k in range(count):
        s = k * h
        d_new, x_new = fsolve(lacking, (d + h * v, x + h * w), xtol=1e-12)
        u, _, _ = pressed(d_new, number * s - x, number * (s + h) - x_new)
        v, w = 2.0 * (d_new - d) / h - v, 2.0 * (x_new - x) / h - w
        d, x, old = d_new, x_new, math.exp(-h) * u
        rows.append((s + h, d, number - w, stiffness * x + damping * w))
    return np.array(rows).T
