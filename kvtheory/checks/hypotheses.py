"""Hypotheses about a fault: each changes the data or the theory, and is rated by how well both then fit."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from kvtheory.checks.allowances import Band
from kvtheory.checks.checklist import means_of
from kvtheory.checks.comparison_case import Case, rms
from kvtheory.checks.theory import CURVES, TRIAL_RTOL, Array, Curves
from kvtheory.fitting.least_squares import covariance, descend
from kvtheory.scene import Scene

Pair = tuple[Curves, Curves]
"""Data and theory to compare with each other, in SI."""

ROWS = 160
"""Rows of the data on which faults are tried: half spread evenly, half right after the start."""
LARGEST, FARTHER, HUGE = 1e3, 10.0, 1e100
"""Largest difference of a value that counts, in allowances; or this multiple of those that the data have, if
that is larger, so that a fit has a slope however far it begins; but never more than the last one."""
SHARE_OF_VALUES = 0.98
"""Share of the values that a fault must bring within their allowance; the rest are at jumps."""
LEFT_OVER = 1.5
"""Factor on the allowance for a fault, which reproduces the method's own errors only roughly."""
PRECISION, STEP, FITTED = 1e-4, 1e-3, 1e-3
"""Precision of a fitted unknown, its step for slopes, and the part of a difference that a fit may leave."""
MEAN_LEFT = 0.1
"""Part of what the worst mean is off that a fault may leave beside an allowance: a simulator with that fault
differs from ours in details, too."""
FAR, WALKS = 0.7, 4
"""Largest change of a parameter in a descent, as a logarithm, for theory is slow far away; and most descents,
each from where the one before reached that bound."""
EVALUATIONS = 8
"""Most evaluations of a descent."""
PROMISING = 0.03
"""Part of the squared difference that the first step of a fit must promise."""
NO_EFFECT = 1e-6
"""Slope, relative to that of the best parameter, below which another has no effect."""
LATE_START = 3.0
"""Last time over span that proves an offset."""
DENSE, SOON, AFTER = 1200, 60, 1e-4
"""Instants of interpolated theory: even, and after changes of the drive, the first so soon over the span."""
POWER_OF_TEN = 0.02
"""Distance of a decadic logarithm from a whole number up to which a factor counts as a power of ten."""
WRONG = "wrong "
"""Prefix of the names of faults that are a wrong parameter."""
VELOCITY = "drive.velocity"
"""The key that stands for all velocities of a drive."""


class Hypothesis(NamedTuple):
    """A possible fault; with `starts` it has an unknown x, and `number`, from x, goes to `make`."""

    name: str
    text: str  # the description, with the number as {0} or as `times`, {2}, and `shown` times it as {1}
    make: Callable[[float], Pair | None]  # the data and theory that it compares
    starts: Sequence[float] = ()  # x is fitted by least squares from the best of them
    unit: float = 1.0  # the number is `unit` times x, or e^x with `log`
    shown: float = 1e3
    log: bool = False
    remote: Sequence[float] = ()  # starts that are tried if nothing explains the data
    powers: Mapping[str, float] | None = None  # of the quantities that scale with the number
    factor: float | None = None  # reported without an unknown
    last: bool = False  # named after any other fault that is enough, as it fits nearly anything
    least: float = -math.inf  # of the numbers that are physical

    def number(self, x: float) -> float | None:
        """Return what is reported for the unknown."""
        return self.unit * (math.exp(x) if self.log else x) if self.starts else self.factor

    def words(self, x: float) -> str:
        """Return the description with its number."""
        number = self.number(x) or 0.0
        ten = bool(self.powers) and power_of_ten(number)
        remark = " (a power of ten: check its unit)" if ten else ""
        return self.text.format(number, number * self.shown, times(number)) + remark

    def pair(self, x: float) -> Pair | None:
        """Return the data and theory for the unknown, or None where it is unphysical."""
        number = self.number(x) or 0.0
        return self.make(number) if number >= self.least else None


def fixed(name: str, text: str, pair: Pair | None, factor: float | None = None) -> Hypothesis:
    """Return a hypothesis without an unknown."""
    return Hypothesis(name, text, lambda _number: pair, factor=factor)


def times(factor: float) -> str:
    """Return a factor in words, with as many digits as its difference from 1 needs."""
    small = math.floor(math.log10(abs(factor - 1.0) or 1.0))
    return f"{factor:.{max(4, 2 - small)}g} times"


def power_of_ten(factor: float) -> int | None:
    """Return the power if a factor is a power of ten, or its negative."""
    power = math.log10(abs(factor)) if factor else POWER_OF_TEN
    return round(power) if abs(power - round(power)) < POWER_OF_TEN else None


class Trial(NamedTuple):
    """How a hypothesis fits: RMS over what is allowed, whether that is enough, and its unknown."""

    hypothesis: Hypothesis
    score: float = math.inf
    enough: bool = False
    value: float = 0.0


class Average(NamedTuple):
    """A mean of all rows, by curve: its weights, what it is off and allowed, in SI.

    Of the rows on which faults are tried it has `shares`, with values on lines between them, and stands for
    `rows` of these.
    """

    weights: Mapping[str, float]
    shares: Array
    off: float
    allowed: float
    rows: int


@dataclass(frozen=True)
class Bench(Case):
    """A case reduced to the rows and curves on which faults are tried, and what means of all rows are off."""

    means: tuple[Average, ...] = ()

    @cached_property
    def _units(self) -> tuple[Array, Array]:
        """The width of theory's range and the allowance outside it, by curve."""
        bands = [np.nan_to_num(self.bands[n].high - self.bands[n].low) for n in self.names]
        return np.array(bands), np.array([self.allowed(name) for name in self.names])

    def _gaps(self, pair: Pair) -> Array:
        """Return the differences of the curves; zero where one side does not exist."""
        return np.nan_to_num(np.array([pair[0][name] - pair[1][name] for name in self.names]))

    @cached_property
    def largest(self) -> float:
        """The largest difference that counts: exact data are far from theory in units of their allowances."""
        off = np.minimum(np.abs(self._gaps((self.columns, self.now))) / sum(self._units), HUGE)
        usual = float(np.quantile(off, SHARE_OF_VALUES, axis=1).max())
        means = (math.sqrt(mean.rows) * abs(mean.off) / mean.allowed for mean in self.means)
        return min(max(LARGEST, FARTHER * max(usual, *means, 0.0)), HUGE)

    def _relative(self, gaps: Array) -> tuple[Array, Array]:
        """Return differences relative to the range of theory and what is allowed outside; and their means."""
        of = dict(zip(self.names, gaps, strict=True))
        found = [
            sum(by * (of[name] @ mean.shares) for name, by in mean.weights.items()) / mean.allowed
            for mean in self.means
        ]
        return (gaps / sum(self._units)).reshape(-1), np.array(found)

    @cached_property
    def _unseen(self) -> Array:
        """What the means of all rows are off beside those of these rows, over what is allowed."""
        _, here = self._relative(self._gaps((self.columns, self.now)))
        return np.array([mean.off / mean.allowed for mean in self.means]) - here

    def off(self, pair: Pair) -> Array:
        """Return how far means of all rows are off by a pair, over what is allowed."""
        return np.asarray(self._unseen + self._relative(self._gaps(pair))[1])

    def ratios(self, pair: Pair | None) -> Array:
        """Return all differences relative to what is allowed; a mean counts as the rows it stands for."""
        if pair is None:
            return np.full(self._units[0].size + len(self.means), self.largest)
        rows, means = self._relative(self._gaps(pair))
        of_means = (self._unseen + means) * [math.sqrt(mean.rows) for mean in self.means]
        return np.clip(np.append(rows, of_means), -self.largest, self.largest)

    def allows(self, pair: Pair) -> bool:
        """Whether no row and no mean is off by more than is allowed."""
        rows, means = self._relative(self._gaps(pair))
        return bool((np.abs(np.append(rows, self._unseen + means)) <= 1.0).all())

    @cached_property
    def _noise(self) -> Array:
        """Sigma of the noise, by curve."""
        return np.nan_to_num(np.array([self.bands[name].noise for name in self.names]))

    @cached_property
    def quiet(self) -> float:
        """The score of data that differ from theory by their noise alone."""
        return rms(self._noise / sum(self._units))

    @cached_property
    def untouched(self) -> Trial:
        """How theory fits the data as they are."""
        return self.rated(fixed("", "", None), (self.columns, self.now))

    @property
    def start(self) -> float:
        """The score of the data as they are."""
        return self.untouched.score

    def rated(self, hypothesis: Hypothesis, pair: Pair | None, x: float = 0.0) -> Trial:
        """Return how a hypothesis fits with its unknown at x."""
        if pair is None:
            return Trial(hypothesis)
        band, limit = self._units
        outside = np.maximum(np.abs(self._gaps(pair)) - band, 0.0) / limit
        largest = np.quantile(outside, SHARE_OF_VALUES, axis=1).max()
        worst = max((abs(mean.off) / mean.allowed for mean in self.means), default=0.0)
        means = bool((np.abs(self.off(pair)) <= 1.0 + MEAN_LEFT * worst).all())
        enough = bool(largest <= LEFT_OVER) and means and self._of_noise(outside * limit)
        return Trial(hypothesis, rms(self.ratios(pair)), enough, x)

    def _of_noise(self, outside: Array) -> bool:
        """Whether noise explains what lies outside the band and the smooth error, all values together."""
        smooth = np.nan_to_num(np.array([self.bands[name].systematic for name in self.names]))
        beyond = np.sort(np.maximum(outside - LEFT_OVER * self.tolerance * smooth, 0.0), axis=1)
        kept = beyond[:, : math.ceil(SHARE_OF_VALUES * beyond.shape[1])]
        left = np.sqrt(np.mean(kept * kept, axis=1))
        limits = [self.rms_limit(name) * self.theory.scales[name] for name in self.names]
        fitted = [FITTED * rms(gap) for gap in self._gaps((self.columns, self.now))]
        return bool((left <= LEFT_OVER * np.array(limits) + fitted).all())

    def shows(self, pair: Pair | None) -> bool:
        """Whether another theory differs from the right one by more than is allowed, anywhere."""
        band, limit = self._units
        off = np.abs(self._gaps((pair[1], self.now))) - band if pair else np.array(np.inf)
        return bool((off > limit).any())

    def tried(self, hypothesis: Hypothesis, starts: Sequence[float] | None = None) -> Trial:
        """Return how a hypothesis fits, its unknown fitted from the best of its starts."""
        starts = hypothesis.starts if starts is None else starts
        pairs: dict[float, tuple[float, Array, Pair | None]] = {}

        def score(x: float) -> float:
            return pairs[x][0]

        def residuals(points: Array) -> Array:
            for x in (x for x in points[:, 0].tolist() if x not in pairs):
                pair = hypothesis.pair(x)
                ratios = self.ratios(pair)
                pairs[x] = math.inf if pair is None else rms(ratios), ratios, pair
            return np.array([pairs[x][1] for x in points[:, 0].tolist()])

        residuals(np.array(starts or [0.0])[:, None])
        best = min(pairs, key=score)
        far = FAR if hypothesis.powers else math.inf
        for _ in range(WALKS if starts else 0):
            found, _ = descend(
                residuals, np.array([[best]]), best - far, best + far, EVALUATIONS, step=STEP,
                costly=True, robust=True, precision=PRECISION,
                promising=PROMISING if len(starts) == 1 else 0.0,
            )  # fmt: skip
            moved, best = abs(found[0, 0] - best), float(found[0, 0])
            if moved < far:
                break
        best = min(pairs, key=score)
        return self.rated(hypothesis, pairs[best][2], best)

    @cached_property
    def solved(self) -> list[Scene]:
        """The scenes whose theory was computed, which is nearly all of the work of a diagnosis."""
        return []

    def against(self, scene: Scene, times: Array | None = None) -> Pair | None:
        """Return the data and the theory of another scene, or None where it has none."""
        self.solved.append(scene)
        try:
            theory = type(self.theory)(scene, self.theory.methods)
            found = theory.at(self.time if times is None else times, TRIAL_RTOL)
        except (ValueError, ArithmeticError):
            return None
        if self.theory.by_elements and times is None:  # the errors of few elements cancel
            coarse = self.theory.at(self.time, TRIAL_RTOL)
            found = {name: self.now[name] + found[name] - coarse[name] for name in self.now}
        return self.columns, found

    @cached_property
    def dense(self) -> Curves:
        """Theory at many instants, with the time, to be interpolated."""
        end, span = float(self.time[-1]), float(self.time[-1] - self.time[0])
        end = end if end <= LATE_START * span else span  # the times may be off by hours
        changes = self.theory.motion.changes
        near = [t + span for t in changes for span in end * np.geomspace(AFTER, 0.1, SOON)]
        times = np.array([*np.linspace(0.0, end, DENSE), *near, *changes])
        times = np.unique(np.clip(times, 0.0, max(end, 0.0)))
        return {"time": times, **self.theory.at(times, TRIAL_RTOL)}

    @cached_property
    def rest(self) -> Mapping[str, float]:
        """Theory before the start."""
        found = self.theory.at(np.array([-1.0, 0.0]), TRIAL_RTOL)
        return {name: values[0] for name, values in found.items()}

    def late(self, delay: float, names: Sequence[str] = CURVES) -> Pair:
        """Return the data, and theory with curves of these names late by a time in s."""
        at, known = self.time - delay, self.dense
        moved = {n: np.interp(at, known["time"], known[n]) for n in names}
        moved = {n: np.where(at < 0.0, self.rest[n], x) for n, x in moved.items()}
        return self.columns, {**self.now, **moved}

    def indistinguishable(self, best: Trial, trials: Sequence[Trial]) -> tuple[str, ...]:
        """Return the parameters that the data cannot distinguish from the best one.

        With such a parameter free as well, the uncertainty of the best one's unknown, by the slopes of theory
        at the best fit, exceeds its value.
        """
        powers = {t.hypothesis.name: t.hypothesis.powers for t in trials if t.hypothesis.powers}
        fitted = powers.pop(best.hypothesis.name)
        scene = scaled_scene(self.theory.scene, fitted, math.exp(best.value))
        here = self.against(scene)

        def slope(powers: Mapping[str, float]) -> Array:
            there = self.against(scaled_scene(scene, powers, math.exp(STEP)))
            if here is None or there is None:
                return np.zeros(self._units[0].size + len(self.means))
            return np.concatenate(self._relative(self._gaps((there[1], here[1])))) / STEP

        own, alike = slope(fitted), []
        for name, other in ((name, slope(each)) for name, each in powers.items()):
            matters = np.linalg.norm(other) > NO_EFFECT * np.linalg.norm(own) > 0.0
            if matters and deviation(own, other) >= abs(best.value):
                alike.append(name.removeprefix(WRONG))
        return tuple(alike)


def deviation(*slopes: Array) -> float:
    """Return the standard deviation of the first unknown, others free; all n values share the error."""
    return math.sqrt(slopes[0].size * float(covariance(np.stack(slopes, axis=1))[0, 0]))


def bench(case: Case, most: int = ROWS) -> Bench:
    """Choose the rows on which faults are tried, at most so many."""
    count, first = case.time.size, int(np.searchsorted(case.time, 0.0))
    rows = np.unique(np.concatenate([
        np.linspace(0, count - 1, min(count, most // 2)).round().astype(int),
        np.minimum(first + np.arange(most // 2), count - 1),
    ]))  # fmt: skip

    def shares(of: Any) -> Array:
        """Return how much the rows count in a mean, if what is between them is on a line."""
        at = np.interp(np.flatnonzero(of), rows, np.arange(rows.size))
        near = np.floor(at).astype(int)
        parts = ((near, near + 1.0 - at), (np.minimum(near + 1, rows.size - 1), at - near))
        return np.asarray(sum(np.bincount(k, by, rows.size) for k, by in parts) / at.size)

    drive = "velocity"
    drives = drive in case.names and bool((case.excess(drive) > case.limit(drive)).any())
    cut = {field.name: getattr(case, field.name) for field in fields(case)} | {
        "names": tuple(name for name in case.names if name != drive or drives),
        "series": replace(case.series, columns={n: v[rows] for n, v in case.columns.items()}),
        "now": {name: values[rows] for name, values in case.now.items()},
        "bands": {n: Band(*(part[rows] for part in band)) for n, band in case.bands.items()},
        "edge_force": case.edge_force[rows],
        "means": tuple(
            Average(
                m.weights, shares(m.rows), m.off(case.columns), m.allowed, int(m.rows[rows].sum())
            )
            for m in means_of(case)
        ),
    }
    return Bench(**cut)


def scaled_scene(scene: Scene, powers: Mapping[str, float], factor: float) -> Scene:
    """Return a scene with its quantities multiplied by powers of a factor."""
    values = scene.values()
    over = {key: factor**power * values[key] for key, power in powers.items() if key != VELOCITY}
    if VELOCITY in powers:
        scene = replace(scene, drive=scene.drive.faster(factor ** powers[VELOCITY]))
    return scene.replace(over)
