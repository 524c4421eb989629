"""The transient on a Prony series by brute force: no contact, no edges, no steps of an element.

With y_i the compressions of the dampers of the arms, of every element

    p = max(K_g g - sum K_i y_i, 0),   y_i' = (u - y_i)/tau_i,   u = (p + sum K_i y_i)/K_g,

K_g = K + sum K_i: without an indenter above it an element takes p = 0, with one u = g. This is one system of
ordinary equations, together with M d'' = W - k_s (d - d_0) - int p dx, by the classical Runge-Kutta method on
all elements there will be. The scene is scaled: R = 1/2, K = 1, a_0 = d_0 = 1.
"""

import numpy as np

REACH = 1.6
"""Of the static half length, to both sides of where the indenter comes."""


def run(scene, times, *, per_half_length=150, step=2e-3):
    """Return depth, its rate, both forces and the peak pressure at the times."""
    arms, M = scene.foundation.arms, scene.support.mass
    K_i, tau = (np.array([getattr(arm, name) for arm in arms])[:, None]
                for name in ("stiffness", "relaxation_time"))  # fmt: skip
    K_g, W = scene.foundation.stiffness + K_i.sum(), scene.support.weight
    held = scene.held
    k_s, motion = 0.0 if held else scene.support.spring, scene.drive.motion(times[-1] or 1.0, 1.0)
    low, high = motion.extremes(0.0, times[-1])
    dx = 1.0 / per_half_length
    X = dx * np.arange(np.floor((-REACH - high) / dx), np.ceil((REACH - low) / dx) + 1)
    state = [1.0, 0.0, np.maximum(1.0 - X * X, 0.0) * np.ones_like(K_i)]

    def pressed(t, d, y):
        x = X + motion.displacement(t)
        p = np.maximum(K_g * (d - x * x) - (K_i * y).sum(axis=0), 0.0)
        return x, p

    def slopes(t, now):
        d, v, y = now
        _, p = pressed(t, d, y)
        u = (p + (K_i * y).sum(axis=0)) / K_g
        pull = 0.0 if held else (W - k_s * (d - 1.0) - dx * p.sum()) / M
        return [v, pull, (u - y) / tau]

    def moved(now, by, h):
        return [a + h * b for a, b in zip(now, by, strict=True)]

    def report(t, now):
        x, p = pressed(t, now[0], now[2])
        return now[0], now[1], dx * p.sum(), -2.0 * dx * (x @ p), p.max()

    rows, t = [], 0.0
    stops = sorted({*times, *(c for c in motion.changes if c < times[-1])})
    for stop in stops:
        count = int(np.ceil((stop - t) / step))
        for k in range(count):
            h, at = (stop - t) / count, t + k * (stop - t) / count
            k1 = slopes(at, state)
            k2 = slopes(at + 0.5 * h, moved(state, k1, 0.5 * h))
            k3 = slopes(at + 0.5 * h, moved(state, k2, 0.5 * h))
            k4 = slopes(at + h, moved(state, k3, h))
            mean = [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
            state = moved(state, mean, h)
        t = stop
        if stop in times:
            rows.append(report(t, state))
    names = ("depth", "depth_rate", "normal_force", "friction_force", "peak_pressure")
    return dict(zip(names, np.array(rows).T, strict=True))
