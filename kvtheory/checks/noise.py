"""Noise and rounding error of a time series, estimated from the data alone."""

import math

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.theory import Array

SMALLEST = 1e-300
"""Stands for zero where digits are counted."""
NORMAL_MAD = 0.6745
"""Median magnitude of a standard normal variate."""
FEWEST = 5
"""Values needed to estimate noise from neighbours."""
MIXES = (0.0, 0.5, 0.9, 0.99, 0.999)
"""Shares of noise in proportion to the value that are tried; the rest is constant."""
DOUBT = 5.0
"""Difference in log-likelihood up to which a less likely model is not ruled out."""
RARE, FROM_FEW = 2.0, 2.0
"""Standard deviations allowed beyond sqrt(2 ln n), the expected largest of n normal errors: less than one
false alarm in a thousand runs of twenty checks. And the uncertainty of a standard deviation from n values,
relative to it, in 1/sqrt(n)."""
SURE = 4.5
"""Standard deviations that a normal error exceeds once in 150,000."""
RARE_FLIPS, NORMAL_RARE = 0.95, 1.96
"""Quantile by which noise is told that flips the last digit of fewer than half of the rows; and the magnitude
that a standard normal variate has there."""
FEW_DIGITS = (2, 3, 4, 5, 6)
"""Digits to which a column may be rounded; more do not matter."""
SEVERAL, ON_GRID, DISTINCT = 4, 1e-3, 1e-9
"""Fewest distinct values that show a grid; accepted distance from it, relative to its step; and smallest
difference of distinct values, relative to the largest."""
SAME = 1e-6
"""Distance from a rounded value, in units of its last digit, that is accepted."""
REPEATED = 0.1
"""Share of rows with the same time as the row before, from which times count as rounded."""


def extreme(count: int) -> float:
    """Return the multiple of sigma that the largest of `count` normal errors almost never exceeds."""
    n = max(count, 2)
    return (math.sqrt(2.0 * math.log(n)) + RARE) * (1.0 + FROM_FEW / math.sqrt(n))


def means(values: Array, rows: int) -> Array:
    """Return the means of so many neighbours each."""
    return np.asarray(values[: values.size - values.size % rows].reshape(-1, rows).mean(axis=1))


def gaps(time: Array, residual: Array) -> tuple[Array, NDArray[np.intp]]:
    """Return how far values are from the line between their neighbours, and the indices of these values.

    White noise has the variance sigma^2 (1 + w^2 + (1 - w)^2) there, w the weight of the earlier neighbour.
    """
    known = np.flatnonzero(np.isfinite(residual))
    t, r = time[known], residual[known]
    span = t[2:] - t[:-2] if t.size >= FEWEST else np.zeros(0)
    use = np.flatnonzero(span > 0.0)
    w = (t[2:] - t[1:-1])[use] / span[use] if use.size else span
    gap = np.abs(r[1:-1][use] - w * r[:-2][use] - (1.0 - w) * r[2:][use])
    return gap / np.sqrt(1.0 + w * w + (1.0 - w) ** 2), known[use + 1]


def noise(time: Array, residual: Array, curve: Array, half: Array | float = 0.0) -> Array:
    """Return sigma of the random part of a residual for each value, from its differences to its neighbours.

    The median of magnitudes is robust against jumps. Sigma is modelled as constant, proportional to the
    curve, or mixed; the largest of the most likely (by Laplace's law) and those hardly less likely is used,
    as few values show the noise where the curve is large. Where most values are equal, it is that of those
    which differ, up to their last digit, of which `half` is given.
    """
    gap, rows = gaps(time, residual)
    size = np.nan_to_num(np.abs(curve))
    if not rows.size or not size.any():
        return np.zeros_like(residual)
    size = size / size.max()  # first, so that no square underflows
    size = size / math.sqrt(float(np.mean(size * size)))
    sigmas = []
    for mix in MIXES:
        shape = np.hypot(1.0 - mix, mix * size)
        sigma = float(np.median(gap / shape[rows])) / NORMAL_MAD
        if sigma > 0.0:
            inner = sigma * shape[rows]
            sigmas.append((float(np.sum(np.log(inner) + gap / inner)), sigma * shape))
    likeliest = min((unlikely for unlikely, _ in sigmas), default=0.0)
    found = [sigma for unlikely, sigma in sigmas if unlikely <= likeliest + DOUBT]
    if found:
        return np.asarray(np.max(found, axis=0))
    rare = float(np.quantile(gap, RARE_FLIPS)) / NORMAL_RARE
    return np.minimum(rare, 2.0 * half) * np.ones_like(residual)


def rounded(values: Array, fewest: float = FEW_DIGITS[0], grid: bool = True) -> Array:
    """Return the rounding error: half the step of a grid that all values lie on, or half their last digit."""
    distinct = np.unique(values[np.isfinite(values)])
    steps = np.diff(distinct)
    steps = steps[steps > DISTINCT * np.abs(distinct).max(initial=0.0)]
    step = float(steps.min()) if grid and steps.size >= SEVERAL - 1 else math.inf
    on_grid = np.abs(distinct / step - np.round(distinct / step)).max(initial=0.0) <= ON_GRID
    half = 0.5 * step if on_grid and math.isfinite(step) else 0.0
    size = 10.0 ** np.floor(np.log10(np.maximum(np.abs(np.nan_to_num(values)), SMALLEST)))
    sizes = (np.full_like(size, size.max()), size) if steps.size else (size,)
    for last in (each * 10.0 ** (1 - d) for d in FEW_DIGITS if d >= fewest for each in sizes):
        off = np.abs(values / last - np.round(values / last))
        if np.nanmax(off, initial=0.0) <= SAME:
            return np.asarray(np.maximum(half, 0.5 * last))
    return np.full_like(values, half)


def digits(values: Array) -> float:
    """Return with how many digits the largest value is written, infinite if with more than count."""
    largest, half = float(np.nanmax(np.abs(values))), float(rounded(values, grid=False).max())
    if not largest * half:
        return math.inf
    return math.floor(math.log10(largest)) + 1 - round(math.log10(2.0 * half))


def time_rounding(time: Array) -> Array:
    """Return the rounding error of each time in s, if so many are repeated that they must be rounded."""
    distinct = np.unique(time)
    if distinct.size < 2 or time.size - distinct.size < REPEATED * time.size:
        return np.zeros_like(time)
    steps = np.diff(distinct)
    nearest = np.fmax(np.append(steps, 0.0), np.append(0.0, steps))
    return np.asarray(nearest[np.searchsorted(distinct, time)])
