"""Motions that do not start at rest, by the elements of `tests.damped_elements`, with steps of Heun's method.

It shares no code with the package but the motion of the base. `python -m tests.start_elements KIND COUNT
[SEED]` compares random scenes with the solvers.
"""

import math
import sys

import numpy as np

from kvtheory.models.continuum import solver
from kvtheory.models.continuum.prony import trajectory
from kvtheory.models.continuum.run import Beginning, Spring
from kvtheory.scene.base_motion import BaseMotion
from tests.damped_elements import Elements

COUNT, STEP = 48, 4e-3
"""Elements in half the static contact, and the step, of the coarsest of three runs."""
MEASURED = "depth", "depth_rate", "normal_force", "friction_force", "sliding_velocity"


def followed(start):
    """Return the depth and its rate at a time, before or after it, if points are given, and the start."""
    if isinstance(start, tuple):
        return None, start
    t, depth = np.array(start).T

    def held(time, side):
        beside = time + side * 1e-9
        d, other = np.interp([time, beside], t, depth)
        return d, (other - d) / (beside - time)

    return held, (*held(0.0, 1.0), 0.0)


def run(drive, arms, damper, eps, kappa, start, spring, times, finer):
    """Return rows of the `MEASURED` at the times; `spring` is eps_x, c_x, k_x or None."""
    held, (d, v, w) = followed(start)
    end, dx, h = times[-1], 1.0 / (COUNT * finer), STEP / finer
    low, high = drive.extremes(0.0, end)
    deepest = max(
        1.0, d, 1.5 * bool(held), (eps * v * v + abs(d - 1.0) * (2.0 + kappa * abs(d - 1.0))) ** 0.4
    )
    pad = 1.3 * math.sqrt(deepest) + (abs(w) * end + 1.0 if spring else 0.0) + 4.0
    X = dx * np.arange(math.floor((-pad - high) / dx), math.ceil((pad - low) / dx) + 1)
    ground, x, rows, t = Elements(arms, damper, X, d), 0.0, [], 0.0
    ground.law(h)
    eps_x, c_x, k_x = spring or (math.inf, 0.0, 0.0)
    over = np.where(ground.u > 0.0, ground.u, -1.0)

    def pulls(s, over, d, v, x, w, t):
        place = X + drive.displacement(t) - x
        rise = v - 2.0 * (drive.velocity(t) - w) * place
        pressed = over > 0.0
        p = np.where(pressed, d - place * place + damper * rise + s.sum(axis=0), 0.0)
        f_z, f_x = ground.forces(p, place, pressed, over)
        along = (f_x - c_x * w - k_x * x) / eps_x if spring else 0.0
        return (1.0 - f_z - kappa * (d - 1.0)) / eps, along, f_z, f_x

    def overlap(d, x, t):
        return d - (X + drive.displacement(t) - x) ** 2

    for stop in times:
        for n in range(round((stop - t) / h)):
            now, then = t + n * h, t + (n + 1) * h
            a, b, *_ = pulls(ground.s, over, d, v, x, w, now)
            if held:
                d, v, a = *held(now, 1.0), 0.0
            d_1, v_1 = d + h * (v + 0.5 * h * a), v + h * a
            x_1, w_1 = x + h * (w + 0.5 * h * b), w + h * b
            for _ in range(2):
                if held:
                    d_1, v_1 = held(then, -1.0)
                _, s_1, over_1 = ground.moved(overlap(d_1, x_1, then))
                a_1, b_1, *_ = pulls(s_1, over_1, d_1, v_1, x_1, w_1, then)
                v_1, w_1 = v + 0.5 * h * (a + a_1), w + 0.5 * h * (b + b_1)
                d_1, x_1 = d + 0.5 * h * (v + v_1), x + 0.5 * h * (w + w_1)
            d, v, x, w = d_1, v_1, x_1, w_1
            if held:
                d, v = held(then, 1.0)
            ground.u, ground.s, over = ground.moved(overlap(d, x, then))
        t = stop
        _, _, f_z, f_x = pulls(ground.s, over, d, v, x, w, t)
        rows.append((d, v, f_z, f_x, drive.velocity(t) - w))
    return np.array(rows)


def extrapolated(*given):
    """Return these rows for fine elements and steps, and their error, column by column."""
    a, b, c = (run(*given, finer) for finer in (1, 2, 4))
    fine = np.abs(c - b).max(axis=0)
    return c, 2.0 * np.maximum(fine, 0.5 * np.abs(b - a).max(axis=0)) + 1e-6


def solved(drive, arms, damper, eps, kappa, start, spring, times, rtol=1e-7):
    """Return the same rows by the solver of the law."""
    if isinstance(start, list):
        drive, kappa = drive.holding(start), math.inf
        start = *drive.depths[0], 0.0
    how = {"start": Beginning(*start), "spring": Spring(*spring) if spring else None}
    if arms:
        given = drive, arms, (eps, kappa), times[-1], rtol
        motion = trajectory.solve(*given, damper=damper, max_steps=3000, **how)
    else:
        motion = solver.solve(drive, eps, kappa, times[-1], rtol, **how)
    states = motion.states(times)
    return np.array([states[name] for name in MEASURED]).T


LAWS = (
    lambda rng: ([], 1.0),
    lambda rng: ([(10 ** rng.uniform(-0.3, 0.8), 10 ** rng.uniform(-1.0, 0.5))], 0.0),
    lambda rng: (
        [(10 ** rng.uniform(-0.3, 0.8), 10 ** rng.uniform(-1.0, 0.5))],
        rng.uniform(0.1, 0.5),
    ),
)
"""Arms and damper: a damper alone, an arm, and both."""
KINDS = {
    "drop": lambda rng: ((-rng.uniform(0.0, 3.0), rng.uniform(-1.0, 6.0), 0.0), None),
    "release": lambda rng: ((rng.uniform(0.2, 2.5), rng.uniform(-3.0, 3.0), 0.0), None),
    "oblique": lambda rng: (
        (-rng.uniform(0.0, 2.0), rng.uniform(0.0, 5.0), rng.uniform(-3.0, 3.0)),
        (rng.uniform(0.3, 3.0), 0.0, 0.0 if rng.random() < 0.5 else rng.uniform(0.1, 3.0)),
    ),
    "coasting": lambda rng: ((1.0, 0.0, 0.0), (rng.uniform(0.3, 3.0), 0.0, 0.0)),
    "drawn": lambda rng: (
        (1.0, 0.0, None), (rng.uniform(0.3, 3.0), rng.uniform(0.0, 0.5), rng.uniform(0.1, 3.0))
    ),
}  # fmt: skip
"""The start and the spring of a random scene; x' is that of the drive where it is None."""

HELD = "held"
"""Random indentations, holds and withdrawals of a fixed indenter, with or without sliding."""


def drawn(kind, seed):
    """Return a random scene."""
    rng = np.random.default_rng(seed)
    number, end = rng.uniform(-3.0, 3.0), 2.4
    drive = BaseMotion.constant(number, end=end)
    if kind == HELD:
        arms, damper = LAWS[seed % 3](rng)
        count = rng.integers(2, 7)
        points = 0.12 * np.sort(rng.choice(np.arange(1, 20), count, replace=False))
        depths = np.where(rng.random(count + 1) < 0.75, rng.uniform(0.0, 1.5, count + 1), -0.3)
        depths[1:] = np.where(rng.random(count) < 0.25, depths[:-1], depths[1:])
        held = list(zip([0.0, *points.tolist()], depths.tolist(), strict=True))
        number = 0.0 if rng.random() < 0.4 else number
        drive, times = BaseMotion.constant(number, end=end), [0.12 * n - 0.06 for n in range(1, 21)]
        return drive, arms, damper, 1.0, 0.0, held, None, times
    (d, v, w), spring = KINDS[kind](rng)
    arms, damper = LAWS[seed % 3](rng)
    kappa = 0.0 if rng.random() < 0.6 else rng.uniform(0.1, 3.0)
    times = [0.12 * n for n in range(1, 21)]
    start = d, v, number if w is None else w
    return drive, arms, damper, 10 ** rng.uniform(-1.0, 0.3), kappa, start, spring, times


def compared(kind, seed):
    """Return the differences over the error of the elements, by quantity."""
    given = drawn(kind, seed)
    known, error = extrapolated(*given)
    found = solved(*given)
    return np.abs(known - found).max(axis=0) / error, np.abs(known - found).max(axis=0)


if __name__ == "__main__":
    kind, count, first = sys.argv[1], int(sys.argv[2]), int((*sys.argv, 0)[3])
    outside = 0
    for seed in range(first, first + count):
        try:
            ratio, apart = compared(kind, seed)
        except (ValueError, ArithmeticError) as error:
            print(seed, "failed:", error, flush=True)
            outside += 1
            continue
        if ratio.max() > 1.0:
            outside += 1
            print(seed, ratio.round(2).tolist(), apart, flush=True)
    print(f"{kind}: {outside} of {count} outside", flush=True)
