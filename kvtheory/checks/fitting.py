"""How well a changed theory, or changed data, fits: the ruler of the diagnosis."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from kvtheory.checks.allowances import Allowance
from kvtheory.checks.comparison_case import Case
from kvtheory.checks.theory import CURVES, Theory
from kvtheory.scene import Drive, Scene

Array = NDArray[np.float64]
Curves = Mapping[str, Array]

ROWS = 160
"""Rows of the data on which faults are tried: half of them spread evenly, half right after the start."""
LARGEST = 1e3
"""A single value counts at most this many times what it is allowed."""
MOST_OF_THEM = 0.98
"""Share of the values that must be as allowed for a fault to explain the data; the rest are at jumps."""
LEFT_OVER = 1.5
"""Times what is allowed: a fitted fault reproduces the method's own errors only about so well."""
FITTED_TO = 1e-5
"""Relative accuracy of a fitted factor."""
TRIAL_RTOL = 1e-5
"""Tolerance of the theory in trials."""


class Fit(NamedTuple):
    """Root mean square of the differences relative to what is allowed, and whether the rest is allowed."""

    score: float
    enough: bool


@dataclass(frozen=True)
class Bench:
    """The rows on which faults are tried."""

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
    def theory(self) -> Theory:
        """The theory that the data are held against."""
        return self.case.theory

    def fit(self, columns: Curves, curves: Curves) -> Fit:
        """Compare changed data with a changed theory, by what is allowed for the unchanged ones."""
        total, enough, allowed = 0.0, True, self.case.allowance
        for name in self.names:
            band = np.nan_to_num(allowed.high[name] - allowed.low[name])
            most = self.case.most(name) * self.theory.scales[name]
            gap = np.abs(columns[name] - curves[name])
            known = np.isfinite(gap)
            ratio = np.minimum(np.maximum(gap[known] - band[known], 0.0) / most[known], LARGEST)
            total += float(np.mean(ratio * ratio)) if ratio.size else 0.0
            enough &= bool(ratio.size) and float(np.quantile(ratio, MOST_OF_THEM)) <= LEFT_OVER
        return Fit(math.sqrt(total / len(self.names)), enough)

    def solved(self, scene: Scene, times: Array | None = None) -> Curves | None:
        """Return the theory of another scene at the times of the rows, or None where it has none."""
        theory = replace(self.theory, scene=scene)
        try:
            return theory.at(self.time if times is None else times, TRIAL_RTOL)
        except (ValueError, ArithmeticError):
            return None


def bench(case: Case) -> Bench:
    """Choose the rows on which faults are tried."""
    count = case.series.time.size
    first = int(np.searchsorted(case.series.time, 0.0))
    rows = np.unique(np.concatenate([
        np.linspace(0, count - 1, min(count, ROWS // 2)).round().astype(int),
        np.minimum(first + np.arange(ROWS // 2), count - 1),
    ]))  # fmt: skip
    series = replace(case.series, columns={n: v[rows] for n, v in case.series.columns.items()})
    old = case.allowance
    low, high, smooth = (
        {name: values[name][rows] for name in CURVES}
        for values in (old.low, old.high, old.systematic)
    )
    thin = replace(
        case, series=series, now={name: case.now[name][rows] for name in CURVES},
        allowance=Allowance(low, high, smooth, old.noise, old.force[rows],
                            {name: values[rows] for name, values in old.rounding.items()}),
    )  # fmt: skip
    drive_differs = "velocity" in case.names and bool(
        (case.excess("velocity") > case.most("velocity")).any()
    )
    names = tuple(name for name in case.names if name != "velocity" or drive_differs)
    return Bench(thin, names)


def best(score: Callable[[float], float], grid: Array) -> tuple[float, float]:
    """Return the least score and where it is: the best of an increasing grid, then Brent's method."""
    scores = [score(float(x)) for x in grid]
    k = int(np.argmin(scores))
    low, high = grid[max(k - 1, 0)], grid[min(k + 1, len(grid) - 1)]
    found = minimize_scalar(
        score, bounds=(low, high), method="bounded", options={"xatol": FITTED_TO * (high - low)}
    )
    if found.fun < scores[k]:
        return float(found.fun), float(found.x)
    return scores[k], float(grid[k])


def scaled_scene(scene: Scene, key: str, factor: float) -> Scene:
    """Return a scene with one of its quantities multiplied.

    >>> scaled_scene(Scene(), "support.mass", 2.0).support.mass
    2000.0
    """
    section, name = key.split(".")
    part: Any = getattr(scene, section)
    if isinstance(part, Drive) and part.history is not None:
        changed = Drive(history=[(time, factor * speed) for time, speed in part.history])
        return replace(scene, drive=changed)
    return replace(scene, **{section: replace(part, **{name: factor * getattr(part, name)})})
