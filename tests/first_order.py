"""What a newcomer writes first: the elements, by Euler's method, in a loop over the steps."""

import math

import numpy as np

from tests.faulty_simulator import drive

ELEMENTS = 400
"""In the static half length: fewer than in the paper's Table 1."""


def first_order(scene, method):
    """Return a time series in SI for a dead weight, with dt = 2 dx/V; `method` is that of the damping."""
    R, W, M = scene.indenter.radius, scene.support.weight, scene.support.mass
    K, tau = scene.foundation.stiffness, scene.foundation.retardation_time
    depth = (3 * W / (4 * K * math.sqrt(2 * R))) ** (2 / 3)
    a = math.sqrt(2 * R * depth)
    dx, velocity, rate, rows = a / ELEMENTS, drive(scene), 0.0, []
    h = 2 * dx / np.abs(velocity(np.linspace(0.0, scene.run.duration, 1001))).max()
    t = np.arange(math.ceil(scene.run.duration / h) + 1) * h
    V = velocity(t)
    Y = np.concatenate([[0.0], np.cumsum(V[:-1] * h)])
    X = np.arange(math.floor((-1.6 * a - Y.max()) / dx), math.ceil((1.6 * a - Y.min()) / dx)) * dx
    u = np.maximum(depth - X * X / (2 * R), 0.0)
    for k in range(t.size):
        x = X + Y[k]
        g = depth - x * x / (2 * R)
        p = K * (g + tau * (rate - x / R * V[k]))
        on = (g >= u * (1 - 1e-12)) & (p >= 0.0) & (g > 0.0)
        force = dx * p[on].sum()
        rows.append((t[k], depth, rate, force, -dx * (p[on] * x[on]).sum() / R))
        u = np.maximum(u, g) * math.exp(-h / tau)
        implicit = h * K * tau * dx * on.sum() if method == "semi-implicit" else 0.0
        kick = h * (W - force) / (M + implicit)
        depth += h * (rate + kick if implicit else rate)
        rate += kick
    names = ("time", "depth", "depth_rate", "normal_force", "friction_force")
    return dict(zip(names, np.array(rows).T, strict=True))
