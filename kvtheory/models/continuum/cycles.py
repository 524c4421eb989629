"""The limit cycle of an indenter on a spring: steady sliding, or periodic stick-slip.

Nothing sticks: "stick" is slow creep while the spring is stretched; "slip" follows from the fall of the
friction force with the sliding velocity.

A motion need not last until its cycle has settled. Near the limit of stability the amplitude A obeys
dA/dn = g A - c A^3 over the number n of cycles, so that 1/A^2 tends to its limit as exp(-2 g n): three cycles
at equal distances give that limit (Aitken). Near any cycle the approach is geometric, too. The limit is
accepted where two such triples agree; its error was then up to 1.1 %. From rest, with Table 1 and six springs
at 39 to 214 mm/s, this took 5 to 117 cycles; the amplitude itself was within 1 % of it after up to 971.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.continuum import maxima
from kvtheory.models.continuum.evaluation import STATE
from kvtheory.models.continuum.solver import Trajectory
from kvtheory.records import structured

Array = NDArray[np.float64]

REPEATS, MOST_PEAKS = 0.01, 4
"""Share of the swing, and of the period, by which a cycle may differ from the one before it; peaks in one."""
STEADY, LAST = 1e-3, 0.75
"""A rate along x counts as zero if it stays below the first share of the largest sliding velocity from the
second share of the motion to its end."""
FEWEST = 8
"""Least number of cycles for two triples, the wider of which spans the last half of the motion."""
AGREE, FAR = 1e-3, 1.5
"""Share of the amplitude by which both limits may differ (their error may be ten times that), and largest
ratio between amplitude and limit: beyond it, a triple may belong to another stage of the motion."""
QUIET = 1e-4
"""Share of the amplitude below which differences between cycles are integration errors."""
POINTS = 4000
"""Samples of a cycle for its extremes, which are parabolic between samples: accurate to 1e-6."""


class Cycle(NamedTuple):
    """The cycle at the end of a motion, in scaled form; its values are those of the limit.

    `settles` is 1 for steady sliding and for a cycle whose limit is known, else 0, and all other entries
    are NaN. `amplitude` is half the travel of the indenter along x; steady sliding has no `period`. The
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
    """Return the cycle in which a motion on a spring ends; a rigid drive raises ValueError."""
    if not motion.given.sprung:
        raise ValueError("a cycle needs a drive with a spring: `drive.stiffness`")
    times, found, count = motion.samples
    s, states = np.array(times[:count]), structured(found[:count], STATE)
    rates, late = states["offset_rate"], s >= LAST * motion.end
    speed = STEADY * np.abs(states["sliding_velocity"]).max()
    if np.all(np.abs(rates[late]) <= speed):
        number, force = (states[name][-1] for name in ("sliding_velocity", "friction_force"))
        return Cycle(1.0, 0.0, math.nan, number, number, force, force)
    turns, x = _turns(motion, s, rates)
    ends, sizes = _cycles(turns, x)
    stride, limit = _limit(sizes)
    if math.isnan(limit):
        return Cycle(0.0)
    now = _measured(motion, ends[-2], ends[-1])
    if limit == sizes[-1]:
        return Cycle(1.0, *now)
    before = _measured(motion, ends[-2 - stride], ends[-1 - stride])
    share = (limit - sizes[-1]) / (sizes[-1] - sizes[-1 - stride])
    return Cycle(1.0, *(now + share * (now - before)))


def _turns(motion: Trajectory, s: Array, rate: Array) -> tuple[Array, Array]:
    """Return times and values of the extremes of x, alternating; the first and the last are maxima."""
    up = rate > 0.0
    k = np.flatnonzero(up[:-1] != up[1:])
    k = k[np.argmax(up[k]) :] if up[k].any() else k[:0]
    k = k[: len(k) - 1 + len(k) % 2]
    low, high = s[k], s[k + 1]
    for _ in range(maxima.BISECTIONS if k.size else 0):
        middle = 0.5 * (low + high)
        same = (motion.states(middle)["offset_rate"] > 0.0) == up[k]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return high, motion.states(high)["offset"]


def _cycles(turns: Array, x: Array) -> tuple[Array, Array]:
    """Return the ends of the cycles and their amplitudes; none if the last two cycles differ."""
    for size in range(2, 2 * MOST_PEAKS + 1, 2):
        count = (len(x) - 1) // size
        if count < 2:
            break
        first = len(x) - 1 - size * count
        way, gaps = x[first:-1].reshape(-1, size), np.diff(turns[first:]).reshape(-1, size)
        swings = np.ptp(way, axis=1)
        if all(
            np.all(np.abs(each[-1] - each[-2]) <= REPEATS * whole)
            for each, whole in ((way, swings[-1]), (gaps, gaps[-1].sum()))
        ):
            return turns[first::size], 0.5 * swings
    return turns[:0], x[:0]


def _limit(sizes: Array) -> tuple[int, float]:
    """Return the stride of the wider of two triples, and the limit of the amplitude if both agree on it.

    >>> n = np.arange(40)
    >>> stride, limit = _limit(2.0 / np.sqrt(1.0 + 0.5 * np.exp(-0.02 * n)))
    >>> stride, round(limit, 6)
    (10, 2.0)
    >>> _limit(np.exp(-0.02 * n))
    (10, nan)
    """
    count = len(sizes)
    stride = max(1, count // 4)
    last = sizes[-1 - 2 * stride :: stride]
    if len(last) == 3 and np.ptp(last) <= QUIET * last[-1]:
        return stride, float(last[-1])
    if count < FEWEST:
        return stride, math.nan
    wide, near = (_aitken(sizes[-1 - 2 * m :: m] ** -2.0) for m in (stride, stride // 2))
    if min(wide, near) <= 0.0:
        return stride, math.nan
    limit = wide**-0.5
    agrees = abs(near**-0.5 - limit) <= AGREE * limit
    close = max(limit / sizes[-1], sizes[-1] / limit) <= FAR
    return stride, limit if agrees and close else math.nan


def _aitken(values: Array) -> float:
    """Return the limit of a geometric approach from its last three values."""
    first, second = np.diff(values)
    turn = first - second
    return float(values[-1] + second * second / turn) if turn else math.nan


def _measured(motion: Trajectory, start: float, end: float) -> Array:
    """Return the amplitude, the period and the extremes of one cycle."""
    within = motion.states(np.linspace(start, end, POINTS))
    x, number, force = (within[name] for name in ("offset", "sliding_velocity", "friction_force"))
    extremes = number.max(), number.min(), force.max(), force.min()
    return np.array([0.5 * np.ptp(x), end - start, *extremes])
