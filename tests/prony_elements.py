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
    state = np.append([1.0, 0.0], np.maximum(1.0 - X * X, 0.0) * np.ones_like(K_i))

    def pressed(t, now):
        x, y = X + motion.displacement(t), now[2:].reshape(K_i.size, X.size)
        return x, y, np.maximum(K_g * (now[0] - x * x) - (K_i * y).sum(axis=0), 0.0)

    def slopes(t, now):
        _, y, p = pressed(t, now)
        u = (p + (K_i * y).sum(axis=0)) / K_g
        pull = 0.0 if held else (W - k_s * (now[0] - 1.0) - dx * p.sum()) / M
        return np.append([now[1], pull], (u - y) / tau)

    rows, t = [], 0.0
    for stop in sorted({*times, *(c for c in motion.changes if c < times[-1])}):
        count = int(np.ceil((stop - t) / step))
        for k in range(count):
            h, at = (stop - t) / count, t + k * (stop - t) / count
            k1 = slopes(at, state)
            k2 = slopes(at + 0.5 * h, state + 0.5 * h * k1)
            k3 = slopes(at + 0.5 * h, state + 0.5 * h * k2)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + slopes(at + h, state + h * k3))
        t = stop
        if stop in times:
            x, _, p = pressed(t, state)
            rows.append((*state[:2], dx * p.sum(), -2.0 * dx * (x @ p), p.max()))
    names = ("depth", "depth_rate", "normal_force", "friction_force", "peak_pressure")
    return dict(zip(names, np.array(rows).T, strict=True))


def run_damped(scene, times, *, per_half_length=600, step=4e-3):
    """Return the same beside a damper C: two runs by Euler's implicit method, extrapolated in the step.

    At the end of a step u is that of the indenter or that without pressure, whichever is larger.
    """
    coarse, fine = (_damped(scene, times, per_half_length, h) for h in (step, 0.5 * step))
    return {name: 2.0 * fine[name] - coarse[name] for name in fine}


def _damped(scene, times, per_half_length, step):
    foundation, M, held = scene.foundation, scene.support.mass, scene.held
    K_i, tau = (np.array([getattr(arm, name) for arm in foundation.arms])[:, None]
                for name in ("stiffness", "relaxation_time"))  # fmt: skip
    C, W = foundation.damping, scene.support.weight
    k_s, motion = 0.0 if held else scene.support.spring, scene.drive.motion(times[-1] or 1.0, 1.0)
    low, high = motion.extremes(0.0, times[-1])
    dx = 1.0 / per_half_length
    X = dx * np.arange(np.floor((-REACH - high) / dx), np.ceil((REACH - low) / dx) + 1)
    u = np.maximum(1.0 - X * X, 0.0)
    y, d, v, t, rows = u * np.ones_like(K_i), 1.0, 0.0, 0.0, []
    for stop in sorted({*times, *(c for c in motion.changes if c < times[-1])}):
        count = int(np.ceil((stop - t) / step))
        h = (stop - t) / max(count, 1)
        stiff = K_i * tau / (h + tau)  # s_i = stiff_i (u - y_i before) at the end of a step
        K = foundation.stiffness + stiff.sum() + C / h if count else 0.0
        for k in range(count):
            x, before = X + motion.displacement(t + (k + 1) * h), v
            rest = (stiff * y).sum(axis=0) + C / h * u
            while not held:
                p = np.maximum(K * (d + h * v - x * x) - rest, 0.0)
                off = M * (v - before) / h - W + k_s * (d + h * v - 1.0) + dx * p.sum()
                move = off / (M / h + k_s * h + h * K * dx * np.count_nonzero(p))
                v -= move
                if abs(move) < 1e-11:
                    break
            d += h * v
            u = np.maximum(d - x * x, rest / K)
            y = (tau * y + h * u) / (h + tau)
        t = stop
        if stop in times:
            x = X + motion.displacement(t)
            p = K * (d - x * x) - rest if count else np.maximum(1.0 - x * x, 0.0)
            p = np.maximum(p, 0.0)
            rows.append((d, v, dx * p.sum(), -2.0 * dx * (x @ p)))
    names = ("depth", "depth_rate", "normal_force", "friction_force")
    return dict(zip(names, np.array(rows).T, strict=True))
