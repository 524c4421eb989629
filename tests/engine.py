"""A contact engine in 60 lines, with the faults that engines have; it shares no code with the package.

Elements are exact in time (Kelvin-Voigt: the surface decays; arms: strained at a constant rate in a step).
The indenter takes a trapezoidal step with two Newton iterations.
"""

import math

import numpy as np


def run(
    *,
    V,
    K,
    C=0.0,
    arms=(),
    R=0.01,
    M=1.0,
    W,
    depth,
    ball=False,
    per_a=60,
    steps=800,
    at=200,
    **fault,
):
    """Return a series in SI: the base moves at V(t), whose last argument says which side of a jump counts.

    Faults: `slides` or `remembers` false, `hunt` (the damping grows with the compression), `middle` (friction
    by the normal in the middle of the patch), `share` of the contact, `loaded` (arms at the start), `start`
    (factor on the initial depth), `sinks` (factor on delta' in the compression rate), `sine` (of the slope,
    for its tangent, in friction), `arc` (pressure along the surface), `circle` (for the parabola).
    """
    slides, remembers = fault.get("slides", True), fault.get("remembers", True)
    K_i, T_i = np.array(arms, dtype=float).reshape(-1, 2).T[:, :, None, None]
    a, end = math.sqrt(2 * R * depth), V[-1][0]
    h, dx = end / steps, a / per_a
    t = np.arange(steps + 1) * h
    left, right = np.array([speeds(V, t, -1), speeds(V, t, 1)])
    Y = np.append(0.0, np.cumsum((right[:-1] + left[1:]) * h / 2))
    X = (np.arange((-1.6 * a - Y.max()) // dx, (1.6 * a - Y.min()) // dx) + 0.5) * dx
    y, area = (np.arange(1.5 * per_a)[:, None] + 0.5) * dx, 2 * dx * dx
    if not ball:
        y, area = np.zeros((1, 1)), dx
    start = depth * fault.get("start", 1.0)
    u = np.maximum(start - (X**2 + y * y) / (2 * R), 0.0)
    s = K_i * u * fault.get("loaded", 0.0)
    E, kept = math.exp(-h * K / C) if C else 0.0, np.exp(-h / T_i)
    gain = K_i * T_i / h * (1 - kept)

    def press(d, rate, k, v, moving):
        x = X + Y[k]
        high, slope = (x * x + y * y) / (2 * R), x / R
        if fault.get("circle"):
            high, slope = R - np.sqrt(R * R - x * x), x / np.sqrt(R * R - x * x)
        g = d - high
        rise = fault.get("sinks", 1.0) * rate - slides * slope * v
        if arms:
            free = ((gain * u - kept * s).sum(axis=0) / (K + gain.sum())) if moving else u
        else:
            free = u * E if moving else u
        free = free if remembers and slides else 0.0 * u
        on = (g >= free) & (g > 0)
        new = np.where(on, g, free)
        if arms:
            new_s = kept * s + gain * (new - u) if moving else s
            p, stiff = np.where(on, K * new + new_s.sum(axis=0), 0.0), (K + gain.sum()) * h / 2
        else:
            damping = C * g / depth if fault.get("hunt") else C
            new_s, p, stiff = s, np.where(on, K * g + damping * rise, 0.0), damping + K * h / 2
        p, held = np.maximum(p, 0.0), p > 0
        share = fault.get("share", 1.0) * area
        p_x = p * np.sqrt(1 + slope**2) if fault.get("arc") else p
        ends = x[held.any(axis=0)][[0, -1]] if held.any() else np.full(2, np.nan)
        F_z, F_x = share * p_x.sum(), -share * (p_x * slope).sum()
        F_x = -F_z * ends.mean() / R if fault.get("middle") else F_x
        F_x = -share * (p * np.sin(np.arctan(x / R))).sum() if fault.get("sine") else F_x
        return F_z, F_x, share * (stiff * held).sum(), ends, p.max(), new, new_s

    d, rate, pull, rows = start, 0.0, 0.0, []
    for k in range(steps + 1):
        if k:
            pull_0, rate_0, d_0 = pull, rate, d
            for _ in range(2):
                d = d_0 + h * (rate_0 + rate) / 2
                F_z, _, slope, *_ = press(d, rate, k, left[k], True)
                rate -= (rate - rate_0 - h * (pull_0 + (W - F_z) / M) / 2) / (1 + h / 2 * slope / M)
            d = d_0 + h * (rate_0 + rate) / 2
            *_, u, s = press(d, rate, k, left[k], True)
        F_z, F_x, _, ends, peak, *_ = press(d, rate, k, right[k], False)
        pull = (W - F_z) / M
        if k % (steps // at) == 0:
            rows.append((t[k], d, F_z, F_x, *ends[:: 1 if right[k] > 0 else -1], peak))
    names = (
        "time",
        "depth",
        "normal_force",
        "friction_force",
        "leading_edge",
        "trailing_edge",
        "peak_pressure",
    )
    return dict(zip(names, np.array(rows).T, strict=True))


def speeds(V, t, side):
    """Return a velocity that is constant between jumps, just before (-1) or after (1) the times."""
    times, values = np.array(V).T
    last = np.searchsorted(times, t + side * 1e-9 * times[-1], side="right") - 1
    return values[np.clip(last, 0, len(times) - 2)]
