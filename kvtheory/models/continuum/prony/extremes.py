"""Extremes of the quantities of a motion on a Prony series, and when its friction force settles.

As on Kelvin-Voigt, see `continuum.maxima`, but by denser and denser samples.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.continuum import maxima
from kvtheory.models.continuum.evaluation import MEASURED

Array = NDArray[np.float64]

GRID, ZOOMS, BESIDE = 65, 2, 2
"""Points around the largest sample, how often they are laid, and the samples that they cover on each side:
two, as a step ends where the next starts. The time is known to 1/256 of the distance of samples."""


def sampled(motion: Any) -> Array:
    """Return times that divide each step, the last just before its end."""
    starts = motion.steps["time"][motion.steps["lasts"] > 0.0]
    ends = np.append(starts[1:] * maxima.JUST_BEFORE, motion.end)
    parts = np.linspace(0.0, 1.0, maxima.SAMPLES + 1)
    times = np.minimum(starts[:, None] + (ends - starts)[:, None] * parts, ends[:, None])
    return np.asarray(times.reshape(-1))


def largest(motion: Any, name: str, sense: int) -> tuple[int, int, float, float]:
    """Return the extreme of a quantity in a sense, see `maxima.EXTREME`."""
    peaks = name == "peak_pressure"
    times, found, _ = motion.samples_with_peaks if peaks else motion.samples
    for _ in range(ZOOMS + 1):
        values = found[name]
        measured = np.abs(values) if sense == maxima.MAGNITUDE else sense * values
        k = int(np.argmax(np.nan_to_num(measured, nan=-math.inf)))  # in flight there are no edges
        best = float(times[k]), float(values[k])
        low, high = times[max(k - BESIDE, 0)], times[min(k + BESIDE, times.size - 1)]
        times = np.unique(np.append(np.linspace(low, high, GRID), best[0]))
        found = motion.states(times, peaks=peaks)
    value = abs(best[1]) if sense == maxima.MAGNITUDE else best[1]
    return MEASURED.index(name), sense, best[0], value


def settled(motion: Any, force: float, share: float) -> float:
    """Return the time from which friction stays within a share of `force`; NaN if it does not settle."""
    times, found, _ = motion.samples

    def outside(states: Any) -> Any:
        return np.abs(states["friction_force"] - force) > share * abs(force)

    late = np.flatnonzero(outside(found))
    if force == 0.0 or outside(found)[-1]:
        return math.nan
    if not late.size:
        return 0.0
    low, high = times[late[-1]], times[late[-1] + 1]
    for _ in range(maxima.BISECTIONS):
        middle = 0.5 * (low + high)
        late_still = outside(motion.states([middle], peaks=False))[0]
        low, high = (middle, high) if late_still else (low, middle)
    return float(high)
