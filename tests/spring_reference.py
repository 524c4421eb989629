"""Reference solutions of the transient on a spring, by two methods that share no code with the package.

The scaled form is that of `tests.transient_reference`, with lambda = lambda_0 - w and

    x' = w,   eps_x w' = f_x - c w - k x,   f_x = -(3/2) int xi p dxi,   x = w = 0 at s = 0.

- `tests.transient_history` finds the contact from what no past instant forbids, and integrates by DOP853.
- `elements` takes the memory (F8) as it stands, on a row of points, and knows nothing of a contact.

`python -m tests.spring_reference` writes the table, with the change from a coarser to a finer solution
as the error of each value, and the places of the elements beside it; it takes a few minutes.
"""

# ruff: noqa: B023 - the functions of a step of the elements are called within that step alone

import json
import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from tests.transient_history import history
from tests.transient_reference import entry, extrapolated
from tests.transient_scenes import Scene

TABLE = Path(__file__).parent / "data" / "spring_reference.json"
TOLERANCES = (1e-10, 1e-11)
LONGEST = 0.02
ELEMENTS = "damped", "stop", "fixed, stop", "stick-slip", "hop", "two hops"
"""Scenes in which elements confirm the history, memory and flights among them."""
NEAR = 2.5
"""Farther from the axis, in half lengths, no element can be touched within a step."""
SPACINGS = 0.004, 0.002, 0.001


@dataclass(frozen=True)
class Sprung(Scene):
    """A scene, and inertia, damping and stiffness along x."""

    inertia: float = 1.0
    damping: float = 0.0
    stiffness: float = 1.0


def sprung(number, epsilon, spring, end=2.0, kappa=0.0):
    """Return a scene that is looked at eight times; a number is a start from rest."""
    drive = [(0.0, number)] if isinstance(number, float) else number
    times = tuple(np.linspace(0.0, end, 9)[1:].round(9).tolist())
    return Sprung(drive, epsilon, times, kappa, *spring)


def jump(time, first, second):
    return [(0.0, first), (time, first), (time, second)]


SCENES = {
    "table 1, 91 mm/s": sprung(3.7, 0.00306, (0.204, 0.0, 2.04), 8.0),
    "soft": sprung(4.0, 0.02, (0.5, 0.0, 0.1), 6.0),
    "stiff": sprung(2.0, 0.05, (0.2, 0.0, 60.0)),
    "damped": sprung(2.0, 0.05, (0.2, 0.4, 3.0), 3.0),
    "overdamped": sprung(1.0, 0.1, (0.05, 3.0, 1.0), 3.0),
    "slow": sprung(0.2, 0.03, (0.3, 0.0, 1.0), 4.0),
    "fast": sprung(20.0, 0.01, (0.3, 0.1, 4.0)),
    "heavy along x": sprung(3.0, 0.02, (10.0, 0.0, 1.0), 4.0),
    "light along x": sprung(3.0, 0.05, (0.01, 0.0, 2.0)),
    "heavy": sprung(2.0, 3.0, (1.0, 0.0, 3.0), 4.0),
    "suspended": sprung(3.0, 0.02, (0.3, 0.05, 2.0), 4.0, kappa=4.0),
    "fixed": sprung(2.0, None, (0.1, 0.0, 3.0), 3.0),
    "fixed, soft": sprung(6.0, None, (0.5, 0.0, 0.2), 4.0),
    "fixed, stop": sprung(jump(0.5, 4.0, 0.0), None, (0.05, 0.0, 5.0)),
    "backwards": sprung(-3.0, 0.02, (0.3, 0.0, 1.0), 4.0),
    "stop": sprung(jump(0.7, 5.0, 0.0), 0.02, (0.1, 0.0, 4.0)),
    "stop, soft": sprung(jump(1.0, 3.0, 0.0), 0.1, (0.5, 0.0, 1.0), 4.0),
    "reversal": sprung(jump(0.6, 3.0, -3.0), 0.05, (0.2, 0.1, 2.0)),
    "ramp": sprung([(0.0, 0.0), (1.0, 5.0)], 0.03, (0.2, 0.0, 3.0), 3.0),
    "to and fro": sprung(
        [(0.0, 0.0), (0.5, 2.0), (1.5, -2.0), (2.0, 0.0)], 0.05, (0.1, 0.0, 2.0), 3.0
    ),
    "stick-slip": sprung(1.5, 0.3, (0.05, 0.0, 0.3), 6.0),
    "hop": sprung(jump(0.3, 6.0, -6.0), 0.3, (0.3, 0.0, 8.0)),
    "oscillation": sprung(
        {"mean": 1.0, "amplitude": 2.0, "frequency": 6.0}, 0.05, (0.1, 0.05, 1.0)
    ),
    "two hops": sprung(jump(0.5, 10.0, 0.0), 0.5, (0.02, 0.0, 2.0)),
}


def elements(scene, spacing):
    """Return d and x at the times of the scene from a row of points, of second order in `spacing`.

    Both equations are balances of impulse, for which U = int u dxi and M = int xi u dxi are enough:

        eps v + 3/4 U,        (eps v + 3/4 U)' = 1 - kappa (d - 1) - 3/4 U
        eps_x w + 3/2 M,      (eps_x w + 3/2 M)' = -3/2 (M - lambda U) - c w - k x

    and each step is the trapezoidal rule, with the points at u <- max(g, u e^-h).
    """
    times, dx = [0.0], spacing
    drive = []
    for start, stop, rate in scene.pieces():
        if stop > start:
            grid = np.linspace(start, stop, math.ceil((stop - start) / spacing) + 1)
            drive += [(b - a, rate(a), rate(b), rate(0.5 * (a + b))) for a, b in pairwise(grid)]
            times += grid[1:].tolist()
    X = dx * np.arange(-math.ceil(reach(scene) / dx), math.ceil(reach(scene) / dx) + 1)
    u = np.maximum(1.0 - X * X, 0.0)
    d, v, x, w, Y_0 = 1.0, 0.0, 0.0, 0.0, 0.0
    U, M = dx * u.sum(), dx * (X @ u)
    rows = {0.0: (d, x)}
    for s, (h, first, last, middle) in zip(times[1:], drive, strict=True):
        Y_1, free = Y_0 + h * (first + 4.0 * middle + last) / 6.0, u * math.exp(-h)
        near = np.abs(X + Y_0 - x) < NEAR
        at, left = X[near], free[near]
        rest, first_moment = dx * free[~near].sum(), dx * (X[~near] @ free[~near])

        def after(d_1, x_1):
            xi = at + (Y_1 - x_1)
            new = np.maximum(left, d_1 - xi * xi)
            total = rest + dx * new.sum()
            return new, total, first_moment + dx * (at @ new) + (Y_1 - x_1) * total

        def defect(step):
            d_1, x_1 = d + step[0], x + step[1]
            v_1, w_1 = 2.0 * step[0] / h - v, 2.0 * step[1] / h - w
            _, U_1, M_1 = after(d_1, x_1)
            z = 0.0
            if scene.epsilon is not None:
                pull = 1.0 - scene.kappa * (0.5 * (d + d_1) - 1.0) - 0.375 * (U + U_1)
                z = scene.epsilon * (v_1 - v) + 0.75 * (U_1 - U) - h * pull
            slip = 0.5 * ((M - (first - w) * U) + (M_1 - (last - w_1) * U_1))
            pull = -1.5 * slip - scene.damping * 0.5 * (w + w_1) - scene.stiffness * 0.5 * (x + x_1)
            return np.array([z, scene.inertia * (w_1 - w) + 1.5 * (M_1 - M) - h * pull])

        step = _newton(defect, np.array([h * v, h * w]), held=scene.epsilon is None)
        d_1, x_1 = d + step[0], x + step[1]
        v, w = 2.0 * step[0] / h - v, 2.0 * step[1] / h - w
        new, U, M = after(d_1, x_1)
        u = free
        u[near] = new
        d, x, Y_0 = d_1, x_1, Y_1
        rows[s] = (d, x)
    return np.array([rows[s] for s in scene.times]).T


def _newton(defect, step, *, held):
    """Return where both defects vanish; the derivatives are differences, kept for all iterations."""
    tiny = 1e-7
    for _ in range(30):
        at = defect(step)
        columns = [(defect(step + tiny * unit) - at) / tiny for unit in np.eye(2)]
        slope = np.array(columns).T
        if held:
            slope[0], at[0] = (1.0, 0.0), step[0]
        change = np.linalg.solve(slope, -at)
        step = step + change
        if np.abs(change).max() < 1e-13:
            return step
    raise ArithmeticError("Newton's method for a step of the elements did not converge")


def reach(scene):
    """Return how far the row must extend: the travel of the drive, and room for a swing."""
    travel = sum((b - a) * max(abs(rate(a)), abs(rate(b))) for a, b, rate in scene.pieces())
    return travel + 6.0


if __name__ == "__main__":
    table = {}
    for name, scene in SCENES.items():
        coarse, fine = (history(scene, tolerance, LONGEST) for tolerance in TOLERANCES)
        table[name] = entry(scene, "history", coarse, fine)
        if name in ELEMENTS:
            values, errors = extrapolated(elements, scene, SPACINGS)
            table[name]["elements"] = {"values": values.tolist(), "errors": errors.tolist()}
    TABLE.write_text(json.dumps(table, indent=1) + "\n")
