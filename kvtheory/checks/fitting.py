"""How well a changed theory, or changed data, fits, and what has to be changed by how much.

The unknown of a fault is fitted by nonlinear least squares on the differences in units of what is allowed
for them; the covariance of a fit of two unknowns says whether the data tell them apart.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from kvtheory.checks.comparison_case import Case
from kvtheory.checks.theory import TRIAL_RTOL, Curves
from kvtheory.scene import Scene

Array = NDArray[np.float64]
Pair = tuple[Curves, Curves]
"""Data and theory to hold against each other, in SI."""

ROWS = 160
"""Rows of the data on which faults are tried: half of them spread evenly, half right after the start."""
LARGEST = 1e3
"""A single value counts at most this many times what it is allowed."""
MOST_OF_THEM = 0.98
"""Share of the values that must be as allowed for a fault to explain the data; the rest are at jumps."""
LEFT_OVER = 1.5
"""Times what is allowed: a fitted fault reproduces the method's own errors only about so well."""
FITTED_TO = 1e-5
"""Accuracy of a fitted unknown."""
STEP = 1e-3
"""By which an unknown is changed to see what it does: the theory of trials is smooth far below that."""
MOST_TRIALS = 30
"""Of one unknown; from a near start, five are enough."""


class Fit(NamedTuple):
    """Root mean square of the differences relative to what is allowed, and whether the rest is allowed."""

    score: float
    enough: bool


class Fitted(NamedTuple):
    """A fault fitted, and its unknown."""

    fit: Fit
    value: float = 0.0


NO_FIT = Fitted(Fit(math.inf, False))


@dataclass(frozen=True)
class Bench:
    """The rows on which faults are tried, and the curves that count."""

    case: Case
    names: tuple[str, ...]

    @property
    def time(self) -> Array:
        """The times of the rows in s."""
        return self.case.series.time

    @property
    def columns(self) -> Curves:
        """The data of the rows, in SI."""
        return self.case.series.columns

    @property
    def now(self) -> Curves:
        """The theory of the scene as it is given, in SI."""
        return self.case.now

    def ratios(self, columns: Curves, curves: Curves) -> Array:
        """Return how far data lie outside the band of theory, by what is allowed for the unchanged ones.

        There is a row for each curve; what does not exist on one of the sides counts nothing.
        """
        allowed, found = self.case.allowance, []
        for name in self.names:
            band = np.nan_to_num(allowed.high[name] - allowed.low[name])
            most = self.case.most(name) * self.case.theory.scales[name]
            gap = np.nan_to_num(columns[name] - curves[name])
            found.append(np.sign(gap) * np.maximum(np.abs(gap) - band, 0.0) / most)
        return np.clip(found, -LARGEST, LARGEST)

    def fit(self, columns: Curves, curves: Curves) -> Fit:
        """Judge changed data and a changed theory."""
        ratios = np.abs(self.ratios(columns, curves))
        most = np.quantile(ratios, MOST_OF_THEM, axis=1)
        return Fit(math.sqrt(float(np.mean(ratios * ratios))), bool(most.max() <= LEFT_OVER))

    def fitted(self, make: Callable[[float], Pair | None], starts: Sequence[float]) -> Fitted:
        """Return the unknown x at which `make(x)` fits best, sought from the best of `starts`."""
        made: dict[float, Pair | None] = {}

        def ratios(x: float) -> Array:
            if x not in made:
                made[x] = make(x)
            pair = made[x]
            if pair is None:
                return np.full(len(self.names) * self.time.size, LARGEST)
            return self.ratios(*pair).reshape(-1)

        def slope(x: Array) -> Array:
            return ((ratios(float(x[0]) + STEP) - ratios(float(x[0]))) / STEP)[:, None]

        def size(x: float) -> float:
            return float(np.sum(np.log1p(ratios(x) ** 2)))

        start = min(starts, key=size)
        # Without a bound on what one value counts, what a fault cannot explain would bend the fit.
        found = least_squares(
            lambda x: ratios(float(x[0])), [start], jac=slope, loss="soft_l1", xtol=FITTED_TO,
            max_nfev=MOST_TRIALS,
        )  # fmt: skip
        value = float(found.x[0])
        pair = made[value] if value in made else make(value)
        return NO_FIT if pair is None else Fitted(self.fit(*pair), value)

    def effect(self, one: Curves, other: Curves) -> Array:
        """Return how far two theories are from each other, in units of what data may be off."""
        allowed, found = self.case.allowance, []
        for name in self.names:
            band = np.nan_to_num(allowed.high[name] - allowed.low[name])
            most = self.case.most(name) * self.case.theory.scales[name]
            found.append(np.nan_to_num(one[name] - other[name]) / (most + band))
        return np.concatenate(found)

    def solved(self, scene: Scene, times: Array | None = None) -> Curves | None:
        """Return the theory of another scene at the times of the rows, or None where it has none."""
        theory, moments = (
            replace(self.case.theory, scene=scene),
            self.time if times is None else times,
        )
        try:
            found = theory.at(moments, TRIAL_RTOL)
        except (ValueError, ArithmeticError):
            return None
        if not theory.by_elements or times is not None:
            return found
        return {name: self.now[name] + found[name] - self._coarse[name] for name in self.now}

    @cached_property
    def _coarse(self) -> Curves:
        """The theory of the scene as it is given by as few elements as in trials, whose errors cancel."""
        return self.case.theory.at(self.time, TRIAL_RTOL)


def uncertainty(slope: Array, other: Array) -> float:
    """Return the standard deviation of an unknown while another is free too, by the slopes of n values.

    It is the root of the first entry of n (J^T J)^-1, and infinite if the matrix is singular. The slopes
    are in units of what is allowed: that bounds what is off in all values together, so that many of them
    know no more than one; hence the n.

    >>> uncertainty(np.array([1.0, 1.0]), np.array([0.0, 2.0]))
    1.4142135623730951
    """
    across = float(slope @ other)
    left = float(slope @ slope) - (across * across / float(other @ other) if across else 0.0)
    return math.sqrt(slope.size / left) if left > 0.0 else math.inf


def bench(case: Case) -> Bench:
    """Choose the rows on which faults are tried."""
    count = case.series.time.size
    first = int(np.searchsorted(case.series.time, 0.0))
    rows = np.unique(np.concatenate([
        np.linspace(0, count - 1, min(count, ROWS // 2)).round().astype(int),
        np.minimum(first + np.arange(ROWS // 2), count - 1),
    ]))  # fmt: skip
    drive = "velocity"
    drives = drive in case.names and bool((case.excess(drive) > case.most(drive)).any())
    names = tuple(name for name in case.names if name != drive or drives)
    return Bench(case.rows(rows), names)


FASTER = "drive.velocity"
"""Of a drive, the velocity stands for all its velocities."""


def scaled_scene(scene: Scene, powers: Mapping[str, float], factor: float) -> Scene:
    """Return a scene with its quantities multiplied by powers of a factor.

    >>> scaled_scene(Scene(), {"support.mass": 1.0, "support.gravity": -1.0}, 2.0).support.mass
    2000.0
    """
    values = scene.values()
    over = {key: factor**power * values[key] for key, power in powers.items() if key != FASTER}
    if FASTER in powers:
        scene = replace(scene, drive=scene.drive.faster(factor ** powers[FASTER]))
    return scene.replace(over)
