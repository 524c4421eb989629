"""The transient with the contact found from the whole past: what no past instant forbids.

The scaled form is explained in `tests.transient_reference`.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import minimize_scalar

from tests.transient_scenes import QUANTITIES, Array, Rate, Solution, at_times

PER_STEP = 4
"""Past instants kept for each step; the most forbidding one between them is found by a search."""
RECENT = 1e-9
"""Instants closer than this are left to the limit s' -> s: their differences would be rounding."""
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)


@dataclass
class Past:
    """The motion so far: sampled instants, and the steps that interpolate between them."""

    s: Array = field(default_factory=lambda: np.zeros(1))
    d: Array = field(default_factory=lambda: np.ones(1))
    Y: Array = field(default_factory=lambda: np.zeros(1))
    steps: list[Any] = field(default_factory=list)

    def add(self, step: Any) -> None:
        s = np.linspace(step.t_old, step.t, PER_STEP + 1)[1:]
        d, _, Y = step(s)[:3]
        self.s, self.d, self.Y = (
            np.append(old, new) for old, new in ((self.s, s), (self.d, d), (self.Y, Y))
        )
        self.steps.append(step)

    def at(self, s: float) -> tuple[float, float]:
        """Return d and Y at a past instant."""
        if s <= 0.0:
            return 1.0, 0.0
        d, _, Y = self.steps[(int(np.searchsorted(self.s, s)) - 1) // PER_STEP](s)[:3]
        return d, Y


def ends(b: Any, c: Any) -> Array:
    """Return both roots of xi^2 + 2 b xi - c without cancellation; NaN if there are none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        far = -b - np.copysign(np.sqrt(b * b + c), b)
        return np.sort([far, -c / far], axis=0)


def allowed(delay: Any, d: float, m: Any, d_past: Any) -> Array:
    """Return where g(xi, s) >= e^-delay g(xi - m, s - delay): an interval, or NaN."""
    decay, lost = np.exp(-delay), -np.expm1(-delay)
    return ends(decay * m / lost, d + decay * (d - d_past + m * m) / lost)


def contact(s: float, y: Array, rates: Sequence[float], past: Past) -> Array:
    """Return the ends of the contact: what no past instant forbids; NaN in flight.

    The instant s' forbids every xi where e^s' g was above e^s g; their difference is concave in
    xi, so that each leaves an interval. Two limits belong to the past: s' -> -oo, undisturbed
    ground, where g >= 0, and s' -> s, where p >= 0. `rates` holds lambda, and at a jump also the
    lambda before it. No xi is in contact if one interval is empty or they do not overlap.
    """
    d, v, Y = y
    n = int(np.searchsorted(past.s, s - RECENT))
    samples = allowed(s - past.s[:n], d, Y - past.Y[:n], past.d[:n])
    limits = ends(np.array([0.0, *rates]), np.array([d, *(d + v for _ in rates)]))

    def interval(instant: float) -> Array:
        d_past, Y_past = past.at(instant)
        return allowed(s - instant, d, Y - Y_past, d_past)

    left = -_least(-limits[0], -samples[0], past.s[:n], lambda t: -interval(t)[0])
    right = _least(limits[1], samples[1], past.s[:n], lambda t: interval(t)[1])
    return np.array([left, right] if left < right else [math.nan, math.nan])


def _least(limits: Array, samples: Array, instants: Array, end: Rate) -> float:
    """Return the least of the limits, and of `end` over all instants; NaN if one is NaN."""
    bound = float(np.min(limits))
    if samples.size == 0:
        return bound
    k = int(np.argmin(samples))
    near = slice(max(k - 1, 0), k + 2)
    # A smooth curve dips between its samples by less than it changes from one to the next.
    if 2.0 * samples[k] - samples[near].max() > bound:
        return bound
    bracket = instants[near][[0, -1]]
    found = minimize_scalar(end, bounds=bracket, method="bounded", options={"xatol": 1e-9})
    return float(np.min([bound, samples[k], found.fun]))


def forces(d: float, v: float, rate: float, edges: Array) -> tuple[float, float]:
    """Return (3/4) int p dxi and -(3/2) int xi p dxi over the contact; nothing in flight."""
    if np.isnan(edges).any():
        return 0.0, 0.0
    half = 0.5 * (edges[1] - edges[0])
    xi = edges.mean() + half * POINTS
    p = half * WEIGHTS * (d + v - xi * (xi + 2.0 * rate))
    return 0.75 * float(p.sum()), -1.5 * float(xi @ p)


def history(scene: Any, tolerance: float, longest_step: float) -> Solution:
    """Return the quantities at the times of the scene, just after a jump; on a spring x and w, too."""
    sprung, moves = scene.inertia is not None, scene.epsilon is not None
    past, y, before = Past(), np.array([1.0, 0.0, 0.0, *((0.0, 0.0) if sprung else ())]), 0.0
    rows = []

    def law(s: float, y: Array, start: float, rate: Rate) -> list[float]:
        d, v, _, *along = y
        x, w = along or (0.0, 0.0)
        now = rate(s) - w
        if not (moves or sprung):
            return [0.0, 0.0, now]
        rates = (now, before) if s == start else (now,)
        f_z, f_x = forces(d, v, now, contact(s, y[:3], rates, past))
        dv = (1.0 - f_z - scene.kappa * (d - 1.0)) / scene.epsilon if moves else 0.0
        found = [v if moves else 0.0, dv, now]
        if sprung:
            found += [w, (f_x - scene.damping * w - scene.stiffness * x) / scene.inertia]
        return found

    for start, stop, rate in scene.pieces():
        now = rate(start) - (y[4] if sprung else 0.0)
        edges = contact(start, y[:3], (now, before), past)
        rows.append((start, *y[:2], *y[3:], *forces(y[0], y[1], now, edges), *edges))
        if stop == start:
            break
        solver = DOP853(
            lambda s, y, start=start, rate=rate: law(s, y, start, rate),
            start, y, stop, longest_step, tolerance, 0.01 * tolerance,
        )  # fmt: skip
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(f"the integration failed at s = {solver.t}: {message}")
            past.add(solver.dense_output())
        y = solver.y
        before = rate(stop) - (y[4] if sprung else 0.0)
    names = (*QUANTITIES[:2], *(("x", "w") if sprung else ()), *QUANTITIES[2:])
    return at_times(scene, rows, names)
