r"""A Prony series for any relaxation function, or for any spectrum of relaxation times (fact F27).

Within the factors 1 - eps and 1 + eps lie the slopes -H' of the series over those of G, from the shortest
time to the longest, the integrals of -H' t and -H' t^2 before, and H - K at the end. So do, at an equal
length of the contact, load and friction in steady sliding, for every contact that is passed in a time up
to the longest; faster times than the shortest act as dampers. Times are compared beyond this range by the
factor by which the contacts of both may differ under one load.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kvtheory.fitting.fewer import EARLY, MARGIN, Slopes
from kvtheory.fitting.spectrum import Array, Series, fewer, refined, solved

STEP = 1e-3
"""Change of ln t by which a relaxation function is differentiated, with an error of its fourth power."""
GRID, BEYOND = 8, 1.0
"""Relaxation times per decade from which the series is chosen, and decades beyond the range."""
NODES, POWER = 64, 8
"""Nodes of the integrals from t = 0, in the root of this power of t, as a function may be infinite there."""
GREATEST = 1e100
"""Largest value of a function, in N/m^3, with which all sums are finite."""
DENSE, FAR = 256, 3.0
"""Times per decade at which a spectrum is summed, and decades beyond the range."""


@dataclass(frozen=True)
class Measured(Slopes):
    """The slopes of a function, its integrals before the first time, and its value at the last one.

    `falls` are by how much it falls from each time to the next: slopes alone miss a jump between them.
    """

    own: Array
    falls: Array

    @property
    def _own(self) -> Array:
        return self.own

    def deviation(self, series: Series) -> float:
        """Return eps of the slopes and of the falls, which are within the same factors."""
        t = self.x[:-3, None]
        parts = -np.exp(-t[:-1] / series.time) * np.expm1(-np.diff(t, axis=0) / series.time)
        ratio = np.einsum("ij,j->i", parts, series.modulus) / self.falls
        return max(super().deviation(series), float(np.abs(ratio - 1.0).max()))


def arms_of(
    G: Callable[[Any], Any], K: float, rtol: float, over: tuple[float, float]
) -> tuple[Series, float]:
    """Return the fewest arms for a relaxation function (N/m^3), and eps; or raise ValueError."""
    first, longest = EARLY * rtol * over[0] / MARGIN, over[1] * MARGIN
    x = Slopes.of(np.ones(1), np.ones(1), first, longest).x

    def at(t: Array) -> Array:
        return np.array([value_of("G", G, each) for each in t.tolist()])

    moves = np.stack([at(x * np.exp(k * STEP)) for k in (-2, -1, 1, 2)])
    weights = np.array([1.0, -8.0, 8.0, -1.0]) / (12.0 * STEP)
    slope = -np.einsum("k,ki->i", weights, moves) / x
    start, end = at(np.array([first, longest])).tolist()
    u, weight = np.polynomial.legendre.leggauss(NODES)
    t = first * (0.5 + 0.5 * u) ** POWER
    weight = weight * 0.5 * POWER * first * (0.5 + 0.5 * u) ** (POWER - 1)
    above = at(t) - start  # int -G' t^n dt = n int (G - G(first)) t^(n - 1) dt
    slope[-3], slope[-2] = float(above @ weight), 2.0 * float((above * t) @ weight)
    slope[-1] = end - K
    falls = -np.diff(at(x[:-3]))
    if not ((slope > 0.0).all() and (falls > 0.0).all()):
        raise ValueError(
            "`G`: expected a finite function that falls, to more than its relaxed value within the range"
        )
    return _fewest(
        Measured(x, np.ones((1, x.size)), np.ones(1), np.array(over), slope, falls), rtol
    )


def arms_of_spectrum(
    H: Callable[[Any], Any], rtol: float, over: tuple[float, float]
) -> tuple[Series, float]:
    """Return the fewest arms for a spectrum, G - K = int H(tau) e^(-t/tau) d ln tau, and eps."""
    low, high = np.log10(over) + FAR * np.array([-1.0, 1.0])
    tau = np.logspace(low, high, 2 * int((high - low) * DENSE / 2.0) + 1)
    size = np.array([value_of("H", H, each) for each in tau.tolist()]) * np.log(tau[1] / tau[0])
    if not ((size >= 0.0).all() and size.any()):
        raise ValueError("`H`: expected finite values of at least 0, not all of them 0")
    size[[0, -1]] *= 0.5
    data = Slopes.of(
        size[size > 0.0], tau[size > 0.0], EARLY * rtol * over[0] / MARGIN, over[1] * MARGIN
    )
    unresolved = data.deviation(Series(0.0, 2.0 * size[::2], tau[::2]))
    if unresolved > rtol:
        raise ValueError(
            f"`H` changes too fast: sums over {DENSE // 2} and {DENSE} times a decade differ by "
            f"{unresolved:.2g} of them, above `rtol`; give a narrow peak as an arm"
        )
    return _fewest(data, rtol, unresolved)


def value_of(name: str, function: Callable[[Any], Any], time: float) -> float:
    """Return the value of a user's function at a time, or raise ValueError if it is not a finite number."""
    with np.errstate(all="ignore"):
        found = function(time)
    try:
        value = float(found)
    except (TypeError, ValueError):
        value = np.nan
    if not abs(value) <= GREATEST:
        raise ValueError(f"`{name}` is {found} at {time:g} s: expected a finite number in N/m^3")
    return value


def _fewest(data: Slopes, rtol: float, known: float = 0.0) -> tuple[Series, float]:
    """Return the fewest arms within rtol of data that are themselves within `known`, and eps."""

    def off(series: Series) -> float:
        within = (1.0 - EARLY * rtol) ** 2 * (1.0 - known)
        return (1.0 + data.deviation(series)) / within - 1.0

    low, high = np.log10([data.x.min(), data.x.max()]) + BEYOND * np.array([-1.0, 1.0])
    series = solved(data, np.logspace(low, high, int((high - low) * GRID) + 1))
    series = Series(0.0, series.modulus, series.time)
    best, least = series, off(series)
    if least > rtol:  # a single arm falls beyond its time as none at a time nearby
        best = series = refined(data, series)
        least = off(series)
    if least > rtol:
        raise ValueError(
            f"`rtol` = {rtol:g}: no series was found within it; the best is off by {least:.2g}"
        )
    while series.time.size > 1:
        series = refined(data, fewer(data, series, 0))
        series = Series(0.0, series.modulus, series.time)
        if (now := off(series)) > rtol:
            break
        best, least = series, now
    return best, least
