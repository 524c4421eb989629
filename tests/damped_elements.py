"""The transient on a spring, a damper and arms by elements, each exact over a step that is linear in time.

A step ends with u = max(d - x^2, u of the element if it were free): there are no contact flags, no edges and
no memory beside the state of each element. Scaled: stiffness 1, f_z = 3/4 int p dx, f_x = -3/2 int x p dx.
"""

import math

import numpy as np
from scipy.linalg import expm

REACH = 1.9
"""Of the static half length, to both sides of where the indenter comes."""
SWING = 0.6
"""How far it may move on a spring, over the way of the drive."""
TURNS, SETTLED = 12, 1e-11


class Elements:
    """Elements at X, their u and s_i, and the law over a step."""

    def __init__(self, arms, damper, X, depth=1.0):
        self.k, self.T = np.array(arms, dtype=float).reshape(-1, 2).T
        self.c, self.X, self.dx = damper, X, X[1] - X[0]
        self.u, self.s = np.maximum(depth - X * X, 0.0), np.zeros((self.k.size, X.size))

    def law(self, h):
        """Prepare steps of length h."""
        n, rates = self.k.size, np.diag(1.0 / self.T)
        self.free = np.zeros((n + 1, n + 1))
        if self.c:  # u' = -(u + sum s)/c
            self.free[0] = -1.0 / self.c
            self.free[1:] = self.k[:, None] * self.free[0]
            self.free[1:, 1:] -= rates
            self.free = expm(self.free * h)
        else:  # u = -sum s
            own = expm(-np.linalg.solve(np.eye(n) + self.k[:, None], rates) * h)
            self.free[:, 1:] = np.vstack([-own.sum(axis=0), own])
        z = h / self.T
        self.h, self.fall = h, np.exp(-z)[:, None]
        self.mean = -np.expm1(-z) / z
        self.stiffness = 0.5 + self.c / h + self.k @ ((1.0 - self.mean) / z)
        """Of the mean pressure over a step."""

    def moved(self, g):
        """Return u, s_i and how deep an element is pressed after a step that ends with overlaps g."""
        free = self.free @ np.vstack([self.u, self.s])
        pressed = g > free[0]
        s = self.fall * self.s + (self.k * self.mean)[:, None] * (g - self.u)
        return np.where(pressed, g, free[0]), np.where(pressed, s, free[1:]), g - free[0]

    def step(self, d, Y):
        """Return u, s_i and mean pressures after a step to d and Y, which are pressed, and how deep."""
        g = d - (self.X + Y) ** 2
        u, s, depth = self.moved(g)
        p = self.u + self.mean @ self.s + self.stiffness * (g - self.u)
        return u, s, np.where(depth > 0.0, p, 0.0), depth > 0.0, depth

    def forces(self, p, x, pressed, depth):
        """Return f_z and f_x, to the edges between elements."""
        f, moment, inside = p.sum(), p @ x, np.nonzero(pressed)[0]
        for n, out in ((inside[0], -1), (inside[-1], 1)) if inside.size > 2 else ():
            share = depth[n] / (depth[n] - depth[n + out]) - 0.5
            f, moment = f + share * p[n], moment + share * p[n] * x[n]
        return 0.75 * self.dx * f, -1.5 * self.dx * moment


def run(drive, arms, damper, eps, kappa, times, spring=None, *, count, step):
    """Return rows of d, d', f_z, f_x and peak pressure at the times; `count` elements a half length."""
    (low, high), fixed = drive.extremes(0.0, times[-1]), math.isinf(kappa)
    pad, dx = REACH + (SWING * (high - low) if spring else 0.0), 1.0 / count
    first, last = math.floor((-pad - high) / dx), math.ceil((pad - low) / dx)
    X, (eps_x, c_x, k_x) = dx * np.arange(first, last + 1), spring or (1.0, 0.0, 0.0)
    elements, t, rows = Elements(arms, damper, X), 0.0, []
    now, rate, gain = np.array([1.0, 0.0]), np.zeros(2), np.zeros(2)  # d, x; d', x'; their change
    free = np.array([not fixed, bool(spring)])
    inertia, held = np.diag([1.0 if fixed else eps, eps_x]), np.diag([0.0 if fixed else kappa, k_x])
    for stop in sorted({*times, *(c for c in drive.changes if 0.0 < c < times[-1])}):
        many = max(1, math.ceil((stop - t) / step - 1e-9))
        h, t_0 = (stop - t) / many, t
        elements.law(h)
        for m in range(many):
            t_1 = stop if m + 1 == many else t_0 + (m + 1) * h
            gain = gain * bool(m)
            for _ in range(TURNS):
                then, mid = now + h * (rate + 0.5 * gain), rate + 0.5 * gain
                Y, Y_1 = drive.displacement(t) - now[1], drive.displacement(t_1) - then[1]
                u, s, p, pressed, depth = elements.step(then[0], Y_1)
                x = X + 0.5 * (Y + Y_1)
                pull = np.array(elements.forces(p, x, pressed, depth)) * [-1.0, 1.0]
                place = 0.5 * (now + then) - [1.0, 0.0]
                load = pull - held @ place + np.array([1.0, -c_x * mid[1]])
                I_0, I_1, I_2 = (dx * (x**n @ pressed) for n in range(3))
                below = np.array([[I_0, 2.0 * I_1], [2.0 * I_1, 4.0 * I_2]])
                stiff = held + 1.5 * elements.stiffness * below
                jacobian = inertia + 0.5 * h * (0.5 * h * stiff + np.diag([0.0, c_x]))
                residual = inertia @ gain - h * np.array(load)
                move = np.zeros(2)
                move[free] = -np.linalg.solve(jacobian[free][:, free], residual[free])
                gain = gain + move
                if np.abs(move).max() <= SETTLED * (1.0 + np.abs(rate).max()):
                    break
            elements.u, elements.s = u, s
            now, rate, t = then, rate + gain, t_1
        if stop in times:
            x = X + drive.displacement(stop) - now[1]
            rise = rate[0] - 2.0 * (drive.velocity(stop) - rate[1]) * x
            p = np.where(pressed, u + damper * rise + s.sum(axis=0), 0.0)
            rows.append((now[0], rate[0], *elements.forces(p, x, pressed, depth), p.max()))
    return np.array(rows)


def extrapolated(*given, count, step, **options):
    """Return these rows in the limit of fine elements and steps, and their error, column by column."""
    a, b, c = (
        run(*given, count=count * n, step=step / n, **options) for n in (1, 2, 4)
    )  # fmt: skip
    apart = np.abs(c - b).max(axis=0)
    return 2.0 * c - b, 1.5 * np.abs((2.0 * c - b) - (2.0 * b - a)).max(axis=0) + 0.15 * apart
