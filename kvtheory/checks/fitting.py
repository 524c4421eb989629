"""Hypotheses about a fault: each changes the data or the theory, and is rated by how well these then fit."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares, minimize_scalar

from kvtheory.checks.allowances import Band
from kvtheory.checks.comparison_case import Case
from kvtheory.checks.theory import TRIAL_RTOL, Array, Curves, Theory
from kvtheory.scene import Scene

Pair = tuple[Curves, Curves]
"""Data and theory to compare with each other, in SI."""

ROWS = 160
"""Rows of the data on which faults are tried: half of them spread evenly, half right after the start."""
LARGEST = 1e3
"""Upper bound of the difference of a single value, in units of its allowance."""
SHARE_OF_VALUES = 0.98
"""Fraction of the values that must be allowed for a fault to explain the data; the rest are at jumps."""
LEFT_OVER = 1.5
"""Factor on the allowance for a fitted fault, which reproduces the method's own errors only roughly."""
PRECISION, STEP = 1e-5, 1e-3
"""Precision of a fitted unknown, and its step for slopes: the theory of trials is smooth far below that."""
MAXIMUM_TRIALS, BY_ELEMENTS = 30, 8
"""Most evaluations to fit one unknown; a good guess needs five. Fewer if theory is a run of many elements."""
WORTH_SEARCHING, SEARCH_PRECISION = 0.3, 0.01
"""Part of the difference that x = 0 must explain for a search to begin, and the precision of x."""
VELOCITY = "drive.velocity"
"""The key that stands for all velocities of a drive."""


class Hypothesis(NamedTuple):
    """A possible fault: its name, its description, and the data and theory that it compares.

    With `starts` it has an unknown x, fitted by least squares from the best of them. With `span`, x is
    searched for from -span to span, if the fit is not smooth in x. Otherwise x is 0. `factor` is the number
    that is reported for x. `powers` are those of the quantities of the scene that scale with e^x, if any.
    """

    name: str
    text: Callable[[float], str]
    make: Callable[[float], Pair | None]
    starts: Sequence[float] = ()
    span: float = 0.0
    factor: Callable[[float], float | None] = lambda _x: None
    powers: Mapping[str, float] | None = None


def fixed(name: str, text: str, pair: Pair | None, factor: float | None = None) -> Hypothesis:
    """Return a hypothesis without an unknown."""
    return Hypothesis(name, lambda _x: text, lambda _x: pair, factor=lambda _x: factor)


class Trial(NamedTuple):
    """How a hypothesis fits: the root mean square of the differences relative to what is allowed.

    `enough` says whether the remaining difference is allowed, `value` is the unknown, and `alike` are the
    parameters that the data cannot distinguish from the one that it names.
    """

    hypothesis: Hypothesis
    score: float = math.inf
    enough: bool = False
    value: float = 0.0
    alike: tuple[str, ...] = ()


@dataclass(frozen=True)
class Bench(Case):
    """A case cut down to the rows and the curves on which faults are tried."""

    @cached_property
    def _units(self) -> tuple[Array, Array]:
        """The width of theory's band and the allowance outside of it, by curve."""
        bands = [np.nan_to_num(self.bands[n].high - self.bands[n].low) for n in self.names]
        return np.array(bands), np.array([self.allowed(name) for name in self.names])

    def _gaps(self, one: Curves, other: Curves) -> Array:
        """Return the differences of the curves that count; zero where one side does not exist."""
        return np.nan_to_num(np.array([one[name] - other[name] for name in self.names]))

    def ratios(self, pair: Pair | None) -> Array:
        """Return how far data lie outside the band of theory, relative to what is allowed, by curve."""
        band, limit = self._units
        if pair is None:
            return np.full(limit.shape, LARGEST)
        gap = self._gaps(*pair)
        ratios = np.sign(gap) * np.maximum(np.abs(gap) - band, 0.0) / limit
        return np.clip(ratios, -LARGEST, LARGEST)

    @cached_property
    def start(self) -> float:
        """The score of the data as they are."""
        return self._rated(fixed("", "", None), (self.columns, self.now)).score

    def _rated(self, hypothesis: Hypothesis, pair: Pair | None, x: float = 0.0) -> Trial:
        if pair is None:
            return Trial(hypothesis)
        ratios = np.abs(self.ratios(pair))
        largest = np.quantile(ratios, SHARE_OF_VALUES, axis=1).max()
        score = math.sqrt(float(np.mean(ratios * ratios)))
        return Trial(hypothesis, score, bool(largest <= LEFT_OVER), x)

    def tried(self, hypothesis: Hypothesis, best: float) -> Trial:
        """Return how a hypothesis fits; a search is made only if its first score is below `best`."""
        make = cache(hypothesis.make)
        if not hypothesis.starts:
            trials = [self._rated(hypothesis, make(0.0))]
            promising = trials[0].score < min((1.0 - WORTH_SEARCHING) * self.start, best)
            if hypothesis.span and promising:

                def score(x: float) -> float:
                    trials.append(self._rated(hypothesis, make(x), x))
                    return min(trials[-1].score, LARGEST)

                bounds, options = (-hypothesis.span, hypothesis.span), {"xatol": SEARCH_PRECISION}
                minimize_scalar(score, bounds=bounds, method="bounded", options=options)
            return min(trials, key=lambda trial: trial.score)

        def ratios(x: float) -> Array:
            return self.ratios(make(x)).reshape(-1)

        def slope(x: Array) -> Array:
            return ((ratios(float(x[0]) + STEP) - ratios(float(x[0]))) / STEP)[:, None]

        first = hypothesis.starts[0]
        if len(hypothesis.starts) > 1:
            first = min(hypothesis.starts, key=lambda x: float(np.sum(np.log1p(ratios(x) ** 2))))
        # With a plain sum of squares, values that a fault cannot explain would distort the fit.
        found = least_squares(
            lambda x: ratios(float(x[0])), [first], jac=slope, loss="soft_l1", xtol=PRECISION,
            max_nfev=BY_ELEMENTS if self.theory.by_elements else MAXIMUM_TRIALS,
        )  # fmt: skip
        value = float(found.x[0])
        return self._rated(hypothesis, make(value), value)

    def against(self, scene: Scene, times: Array | None = None) -> Pair | None:
        """Return the data and the theory of another scene, or None where it has none."""
        try:
            theory = Theory(scene, self.theory.methods)
            found = theory.at(self.time if times is None else times, TRIAL_RTOL)
        except (ValueError, ArithmeticError):
            return None
        if theory.by_elements and times is None:  # the errors of few elements cancel
            coarse = self.theory.at(self.time, TRIAL_RTOL)
            found = {name: self.now[name] + found[name] - coarse[name] for name in self.now}
        return self.columns, found

    def indistinguishable(self, best: Trial, others: Sequence[Hypothesis]) -> tuple[str, ...]:
        """Return the names of the parameters that the data cannot distinguish from the best one.

        With such a parameter free too, the uncertainty of the best fault's unknown exceeds its value: the
        data do not need it. The slopes are those of theory at the best fit.
        """
        at = best.hypothesis
        scene = scaled_scene(self.theory.scene, at.powers or {}, math.exp(best.value))
        here, slopes = self.against(scene), []
        for other in (at, *others):
            there = self.against(scaled_scene(scene, other.powers or {}, math.exp(STEP)))
            if here is None or there is None:
                return ()
            gaps = self._gaps(there[1], here[1]) / sum(self._units)
            slopes.append(gaps.reshape(-1) / STEP)
        pairs = zip(others, slopes[1:], strict=True)
        return tuple(o.name for o, s in pairs if uncertainty(slopes[0], s) >= abs(best.value))


def uncertainty(slope: Array, other: Array) -> float:
    """Return the standard deviation of an unknown while another is free too, by the slopes of n values.

    It is the root of the first entry of n (J^T J)^-1, infinite for a singular matrix. The slopes are in units
    of what is allowed, an error that all n values may share: hence the n.
    """
    across = float(slope @ other)
    left = float(slope @ slope) - (across * across / float(other @ other) if across else 0.0)
    return math.sqrt(slope.size / left) if left > 0.0 else math.inf


def bench(case: Case) -> Bench:
    """Choose the rows on which faults are tried."""
    count, first = case.time.size, int(np.searchsorted(case.time, 0.0))
    rows = np.unique(np.concatenate([
        np.linspace(0, count - 1, min(count, ROWS // 2)).round().astype(int),
        np.minimum(first + np.arange(ROWS // 2), count - 1),
    ]))  # fmt: skip
    drive = "velocity"
    drives = drive in case.names and bool((case.excess(drive) > case.limit(drive)).any())
    cut = {field.name: getattr(case, field.name) for field in fields(case)} | {
        "names": tuple(name for name in case.names if name != drive or drives),
        "series": replace(case.series, columns={n: v[rows] for n, v in case.columns.items()}),
        "now": {name: values[rows] for name, values in case.now.items()},
        "bands": {n: Band(*(part[rows] for part in band)) for n, band in case.bands.items()},
        "edge_force": case.edge_force[rows],
    }
    return Bench(**cut)


def scaled_scene(scene: Scene, powers: Mapping[str, float], factor: float) -> Scene:
    """Return a scene with its quantities multiplied by powers of a factor."""
    values = scene.values()
    over = {key: factor**power * values[key] for key, power in powers.items() if key != VELOCITY}
    if VELOCITY in powers:
        scene = replace(scene, drive=scene.drive.faster(factor ** powers[VELOCITY]))
    return scene.replace(over)
