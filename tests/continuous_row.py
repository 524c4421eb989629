"""A simulator that shares nothing with the package: an implicit scheme on a row of points with exact memory.

The compression of each point is u <- max(g, u e^(-h/tau)); what this leaves over, averaged over the step, is
its pressure, and the new depth is found by bisection. `plant` breaks it.
"""

import math

import numpy as np

REACH = 1.5
"""Of the static half length, on both sides of the indenter."""
HALVINGS = 32


def run(scene, velocity, end, *, points=500, steps=2000, plant="", value=0.0):
    """Return a time series in SI; `points` lie in the static half length, `velocity` is V(t)."""
    R, K, tau = scene.indenter.radius, scene.foundation.stiffness, scene.foundation.retardation_time
    held = scene.support.kind == "fixed"
    M, W, k_s = math.inf, 0.0, 0.0
    if held:
        depth_0 = scene.support.depth
    else:
        M, k_s = scene.support.mass, getattr(scene.support, "stiffness", 0.0)
        W = M * scene.support.gravity
        depth_0 = (0.75 * W / (K * math.sqrt(2 * R))) ** (2 / 3)
    if plant == "radius at the right depth":
        R *= value
    a, h = math.sqrt(2 * R * depth_0), end / steps
    t = np.arange(steps + 1) * h
    V = np.array([velocity(time) for time in t])
    Y = np.concatenate([[0.0], np.cumsum(0.5 * h * (V[1:] + V[:-1]))])
    dx = a / points
    first, last = (-REACH * a - Y.max()) / dx, (REACH * a - Y.min()) / dx
    X = np.arange(math.floor(first), math.ceil(last) + 1) * dx
    depth, rate, rows = depth_0 * (value if plant == "initial depth" else 1.0), 0.0, []
    depth = 0.0 if plant == "undeformed" else depth
    u = np.maximum(depth - X**2 / (2 * R), 0.0)
    decay = 1.0 if plant == "no relaxation" else math.exp(-h / tau)
    inertia = {"no inertia": 0.0, "inertia": value}.get(plant, 1.0)
    exponent = value if plant == "shape" else 2.0

    def press(d, x, free):
        new = np.maximum(d - np.abs(x / a) ** exponent * a * a / (2 * R), free)
        if plant == "no damping":
            return K * new * (new > free), new
        return K * (new - free) / -math.expm1(-h / tau), new

    for k in range(steps + 1):
        near = slice(*np.searchsorted(X + Y[k], [-REACH * a, REACH * a]))
        x, free = X[near] + Y[k], u[near] * decay
        if k == 0:
            p = np.where(u[near] > 0, K * np.maximum(u[near] - tau * x / R * V[0], 0.0), 0.0)
        else:
            if not held:
                low, high = depth - 0.5 * depth_0, depth + 0.5 * depth_0
                for _ in range(HALVINGS):
                    d = 0.5 * (low + high)
                    change = M * inertia * ((d - depth) / h - rate) / h
                    lacks = change - W + k_s * (d - depth_0) + dx * press(d, x, free)[0].sum()
                    low, high = (low, d) if lacks > 0 else (d, high)
                rate, depth = (d - depth) / h, d
            p, new = press(depth, x, free)
            u = u * decay
            u[near] = new
        on = np.flatnonzero(p > 1e-9 * K * depth_0)
        ends = (x[on[0]], x[on[-1]]) if on.size else (math.nan, math.nan)
        arm = value if plant == "lever arm" else 0.0
        F_x = -dx * ((x - arm) * p).sum() / R
        edges = ends if V[max(k - 1, 0)] >= 0 else ends[::-1]  # of the step that ends here
        rows.append((t[k], depth, rate, dx * p.sum(), F_x, *edges, p.max()))
    names = ("time", "depth", "depth_rate", "normal_force", "friction_force", "leading_edge",
             "trailing_edge", "peak_pressure")  # fmt: skip
    return dict(zip(names, np.array(rows).T, strict=True))
