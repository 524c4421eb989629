"""The cycle in which an indenter on a spring ends: steady sliding, or stick-slip that repeats itself.

Nothing sticks: what is called so is the slow creep while the spring is stretched, and the fall of the
friction force with the sliding velocity lets it go.
"""

import math
from typing import NamedTuple

import numpy as np

from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum import maxima
from kvtheory.models.continuum.solver import Trajectory

REPEATS = 0.01
"""Share of the swing, and of the period, by which a cycle may differ from the one before it."""
STEADY = 1e-3
"""Of the largest sliding velocity: a rate along x that is as small is none ..."""
LAST = 0.75
"""... where it lasts from this share of the motion to its end."""
MOST_PEAKS = 4
"""In one cycle."""
COMPARED = 3 * MOST_PEAKS
"""Peaks at the end of a motion in which a cycle is looked for."""
POINTS = 4000
"""On which the extremes of a cycle are looked for: a parabola between them is right to 1e-6."""


class Cycle(NamedTuple):
    """The cycle at the end of a motion, in scaled form.

    `settles` is 1 for steady sliding and for a cycle that repeats itself, else 0, and all other entries
    are NaN. `amplitude` is half the way of the indenter along x; steady sliding has no `period`. The
    others are the extremes of the sliding velocity and of the friction force.
    """

    settles: float
    amplitude: float = math.nan
    period: float = math.nan
    largest_slide: float = math.nan
    smallest_slide: float = math.nan
    largest_friction: float = math.nan
    smallest_friction: float = math.nan


def cycle(motion: Trajectory) -> Cycle:
    """Return the cycle in which a motion on a spring ends.

    Raises
    ------
    ValueError
        If the drive is rigid.

    Examples
    --------
    >>> from kvtheory.models.continuum.run import Spring
    >>> from kvtheory.models.continuum.solver import solve
    >>> from kvtheory.scene.base_motion import BaseMotion
    >>> given = BaseMotion.constant(0.5, end=20.0)
    >>> cycle(solve(given, 0.04, 0.0, end=20.0, rtol=1e-6, spring=Spring(0.5, 0.0, 5.0))).settles
    1.0
    """
    if not motion.rows.given.sprung:
        raise ValueError("a cycle needs a drive with a spring: `drive.stiffness`")
    times, found, count = motion.samples
    s, states = np.array(times[:count]), np.array(found[:count])
    speed, late = STEADY * np.abs(states[:, e_.NUMBER]).max(), s >= LAST * motion.end
    if np.all(np.abs(states[late, e_.ALONG_RATE]) <= speed):
        number, force = (states[-1, column] for column in (e_.NUMBER, e_.FRICTION_FORCE))
        return Cycle(1.0, 0.0, math.nan, number, number, force, force)
    peaks = _peaks(motion, s, states[:, e_.ALONG_RATE])
    if (first := _repeats(motion, peaks)) is None:
        return Cycle(0.0)
    within = motion.states(np.linspace(first, peaks[-1], POINTS))
    x, number, force = (
        within[:, column] for column in (e_.ALONG, e_.NUMBER, e_.FRICTION_FORCE)
    )  # fmt: skip
    return Cycle(
        1.0, 0.5 * (x.max() - x.min()), peaks[-1] - first,
        number.max(), number.min(), force.max(), force.min(),
    )  # fmt: skip


def _peaks(motion: Trajectory, s: np.ndarray, rate: np.ndarray) -> list[float]:
    """Return when x is largest, where its rate falls through zero: of the last cycles that are compared."""
    found = []
    for k in np.flatnonzero((rate[:-1] > 0.0) & (rate[1:] <= 0.0))[-COMPARED:].tolist():
        low, high = float(s[k]), float(s[k + 1])
        for _ in range(maxima.BISECTIONS):
            middle = 0.5 * (low + high)
            up = motion.states([middle])[0, e_.ALONG_RATE] > 0.0
            low, high = (middle, high) if up else (low, middle)
        found.append(high)
    return found


def _repeats(motion: Trajectory, peaks: list[float]) -> float | None:
    """Return when the last cycle begins, if it repeats the one before it."""
    x, t = motion.states(peaks)[:, e_.ALONG] if peaks else np.empty(0), np.array(peaks)
    for count in range(1, (len(peaks) - 1) // 2 + 1):
        if count > MOST_PEAKS:
            break
        now, before = slice(-count, None), slice(-2 * count, -count)
        swing = np.ptp(motion.states(np.linspace(t[-1 - count], t[-1], POINTS // 20))[:, e_.ALONG])
        gaps = np.diff(t)
        alike = np.all(np.abs(x[now] - x[before]) <= REPEATS * swing)
        if alike and np.all(np.abs(gaps[now] - gaps[before]) <= REPEATS * gaps[now].sum()):
            return float(t[-1 - count])
    return None
