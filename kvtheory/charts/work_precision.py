"""Work-precision charts: the accuracy and the cost of each method, measured side by side.

Each method sweeps its accuracy parameter. Its first call, which imports and compiles, is timed separately;
one run of each setting gives the errors; then all settings are repeated in random order, for the least time
and the quartiles. Settings that fail are kept, with the reason.
"""

import math
import random
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

import numpy as np

from kvtheory.progress import Progress, silent
from kvtheory.results.errors import DivergenceError
from kvtheory.results.presented import record

MISSED, WRONG, TIMED_OUT = "missed event", "wrong but reported success", "timed out"
REASONS = "unstable", "not converged", TIMED_OUT, "refused", MISSED, WRONG
CHEAPEST = 3
"""Settings of each method, before every nth is taken, by whose times the whole chart is forecast."""
BRIEFLY = 0.4
"""Time (s) that the first forecast may take."""


class TimedOutError(Exception):
    """A run took longer than allowed."""


REASON_OF: dict[type[BaseException], str] = {
    TimedOutError: TIMED_OUT, DivergenceError: "unstable",
    ArithmeticError: "not converged", ValueError: "refused",
}  # fmt: skip
"""Why a run failed, by its exception."""


@dataclass(frozen=True)
class Clock:
    """Ends a run that takes too long, from within its right-hand side."""

    seconds: float = math.inf
    began: float = field(default_factory=time.perf_counter)

    @property
    def elapsed(self) -> float:
        """Time since the clock was made."""
        return time.perf_counter() - self.began

    def check(self, *_: Any) -> None:
        """Raise `TimedOutError` if the time is up."""
        if self.elapsed > self.seconds:
            raise TimedOutError


NO_LIMIT = Clock()


@dataclass(frozen=True)
class Reference:
    """The reference solution; the difference of two independent methods in each error; and their names."""

    solution: Any
    agreement: dict[str, float]
    methods: tuple[str, str]


@dataclass(frozen=True)
class Method:
    """A way to solve a problem; `solve` returns the solution and the work it took."""

    name: str
    knob: str
    values: Sequence[float]
    work: Literal["evaluations", "element updates"]  # what is counted
    solve: Callable[[Any, float, Clock], tuple[Any, int]]
    kind: Literal["numerical", "model"] = (
        "numerical"  # the error of a model no parameter can reduce
    )
    suits: Callable[[Any], bool] = lambda problem: True
    scenes: int = 1  # solved at once
    growth: float = 0.1  # power of the parameter with which a run takes longer; measured on Table 1
    cost: float | None = None  # of the cheapest setting, over the longest of those with None


@dataclass(frozen=True)
class Effort:
    """Repeats of each setting; limits (s) of one run and of all repeats; every nth setting is run."""

    repeats: int
    longest: float
    whole: float
    every: int


FULL, QUICK = Effort(11, 20.0, 120.0, 1), Effort(3, 0.4, 3.0, 2)


@dataclass
class Point:
    """One setting of a parameter: its cost and errors, or why it failed. Times are in s."""

    knob: float
    reason: str = ""
    message: str = ""
    errors: dict[str, float] = field(default_factory=dict)
    work: int = 0
    first: float = 0.0
    times: list[float] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        """The least time."""
        return min(self.times, default=self.first)

    @property
    def quartiles(self) -> tuple[float, float]:
        """The first and the third quartile of the times."""
        low, high = np.percentile(self.times or [self.first], [25, 75])
        return float(low), float(high)


@dataclass
class Series:
    """A method with its settings; `first` is the time (s) of its very first call, imports included."""

    method: str
    kind: str
    knob: str
    work: str
    points: list[Point]
    first: float = 0.0


@dataclass(frozen=True)
class Chart:
    """All methods on one scene; `floor` is the difference of two independent references in each error."""

    name: str
    series: list[Series]
    floor: dict[str, float]
    reference: tuple[str, str]

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; infinite errors are None."""
        found: dict[str, Any] = record(self)
        for series, plain in zip(self.series, found["series"], strict=True):
            for point, row in zip(series.points, plain["points"], strict=True):
                row.update(seconds=point.seconds, quartiles=list(point.quartiles))
        return found


class Measurement:
    """The methods that suit a problem, measured in two steps: the cheapest settings, then the others.

    A problem has a `name` and a `reference()`; it can `assess(found, reference, tolerance)`, which gives the
    errors of a solution, and why it is wrong, if so, for a method with a tolerance.
    """

    def __init__(self, problem: Any, methods: Iterable[Method], effort: Effort = FULL) -> None:
        self.problem, self.effort = problem, effort
        self.methods = [method for method in methods if method.suits(problem)]
        self.series = [
            Series(m.name, m.kind, m.knob, m.work, [Point(x) for x in m.values[:: effort.every]])
            for m in self.methods
        ]

    def first_forecast(self) -> float:
        """Return the time (s) of the whole chart, from one run of the cheapest setting of some methods.

        They need no compiling, and are ended after `BRIEFLY` in all. The reference takes about as long as the
        dearest run.
        """
        clock = Clock(BRIEFLY)
        times = []
        for method in self.methods:
            began = clock.elapsed
            if method.cost is None:
                with np.errstate(all="ignore"), suppress(*REASON_OF):
                    method.solve(self.problem, method.values[0], clock)
            times.append(clock.elapsed - began)
        longest = max(times, default=0.0)
        for method, one, seconds in zip(self.methods, self.series, times, strict=True):
            cheapest = seconds if method.cost is None else method.cost * longest
            one.points[0].first = min(cheapest, self.effort.longest)
        expected = self._expected(1)
        whole = sum(one[0] + sum(one) for one in expected) + max(map(max, expected), default=0.0)
        return whole + self._repeats(expected)

    def begin(self, progress: Progress) -> None:
        """Solve the reference; call each method, which may compile, and run its cheapest settings."""
        self.right = self.problem.reference()
        for method, one in self._each(progress):
            clock = Clock(self.effort.longest)
            with np.errstate(all="ignore"), suppress(TimedOutError, ArithmeticError, ValueError):
                method.solve(self.problem, one.points[0].knob, clock)
            one.first = clock.elapsed
            self._attempt(method, one.points, 0, self.begun)

    @property
    def begun(self) -> int:
        """How many settings of each method `begin` runs: at least two, for the growth of the time."""
        return max(2, -(-CHEAPEST // self.effort.every))

    def forecast(self) -> float:
        """Return the time (s) that `finish` will take, from the times of the cheapest settings."""
        expected = self._expected(self.begun)
        return sum(sum(one[self.begun :]) for one in expected) + self._repeats(expected)

    def _expected(self, known: int) -> list[list[float]]:
        """Return the time of each setting of each method, of which some are known."""
        longest = self.effort.longest
        pairs = zip(self.methods, self.series, strict=True)
        return [expected_times(method, one, known, longest) for method, one in pairs]

    def _repeats(self, expected: Iterable[Iterable[float]]) -> float:
        """Return the time (s) of all repeats, from that of each run."""
        effort, repeated = self.effort, []
        for one, times in zip(self.series, expected, strict=True):
            pairs = zip(one.points, times, strict=True)
            repeated += [t for p, t in pairs if 0.0 < t < effort.longest and not p.reason]
        once = sum(repeated)
        again = (effort.repeats - 1) * sum(t for t in repeated if t <= effort.longest / 4.0)
        return once + min(again, max(effort.whole - once, 0.0))

    def finish(self, progress: Progress) -> Chart:
        """Run the other settings, and repeat all that succeeded."""
        jobs: list[tuple[Point, Callable[[], Any]]] = []
        for method, one in self._each(lambda share, words: progress(0.7 * share, words)):
            self._attempt(method, one.points, self.begun, len(one.points))
            for point in one.points:
                if point.errors:
                    jobs.append((point, partial(method.solve, self.problem, point.knob, Clock())))
        _repeat(jobs, self.effort, lambda share, words: progress(0.7 + 0.3 * share, words))
        for method, one in zip(self.methods, self.series, strict=True):
            for point in one.points:
                point.times = [seconds / method.scenes for seconds in point.times]
                point.first /= method.scenes
        return Chart(self.problem.name, self.series, self.right.agreement, self.right.methods)

    def _each(self, progress: Progress) -> Iterator[tuple[Method, Series]]:
        for done, (method, one) in enumerate(zip(self.methods, self.series, strict=True)):
            progress(done / len(self.methods), method.name)
            yield method, one

    def _attempt(self, method: Method, points: list[Point], start: int, stop: int) -> None:
        """Run each setting once, until one times out."""
        rated = method.kind == "numerical" and method.knob == "rtol"
        for k in range(len(points))[start:stop]:
            point, clock = points[k], Clock(self.effort.longest)
            if k > 0 and points[k - 1].reason == TIMED_OUT:
                point.reason = TIMED_OUT
                continue
            try:
                with np.errstate(all="ignore"):  # overflow is reported by its error or its reason
                    found, point.work = method.solve(self.problem, point.knob, clock)
                    tolerance = point.knob if rated else None
                    point.errors, point.reason = self.problem.assess(found, self.right, tolerance)
            except tuple(REASON_OF) as error:
                kinds = (kind for kind in type(error).mro() if kind in REASON_OF)
                point.reason, point.message = REASON_OF[next(kinds)], str(error)
            point.first = clock.elapsed


def expected_times(method: Method, series: Series, known: int, longest: float) -> list[float]:
    """Return the time of a run of each setting from those of the first `known` ones.

    It grows as a power of the parameter; that of elements, if two are known, linearly with the square of
    their number. A run ends after `longest`, and settings beyond it are not tried.
    """
    knobs, times = [p.knob for p in series.points], [p.first for p in series.points[:known]]
    first, last = times[0], times[-1]
    for x in knobs[known:]:
        if last >= longest or series.points[known - 1].reason == TIMED_OUT:
            times.append(0.0)
            continue
        if x < knobs[0] or known == 1:
            last = times[known - 1] * max(x / knobs[0], knobs[known - 1] / x) ** method.growth
        else:
            slope = (times[known - 1] - first) / (knobs[known - 1] ** 2 - knobs[0] ** 2)
            last = first + max(slope, 0.0) * (x * x - knobs[0] ** 2)
        times.append(min(last, longest))
    return times


def make_chart(
    problem: Any, methods: Iterable[Method], *, effort: Effort = FULL,
    progress: Progress = silent,
) -> Chart:  # fmt: skip
    """Measure every method that suits the problem."""
    measurement = Measurement(problem, methods, effort)
    measurement.begin(silent)
    return measurement.finish(progress)


def _repeat(
    jobs: list[tuple[Point, Callable[[], Any]]], effort: Effort, progress: Progress
) -> None:
    """Time the jobs repeatedly in random order, as far as the effort allows."""
    order, whole = random.Random(0), Clock()
    for done in range(effort.repeats):
        progress(done / effort.repeats, "repeats")
        order.shuffle(jobs)
        for point, run in jobs:
            # One repeat of a long run is enough.
            enough = whole.elapsed > effort.whole or point.first > effort.longest / 4.0
            if enough and point.times:
                continue
            clock = Clock()
            with np.errstate(all="ignore"):
                run()
            point.times.append(clock.elapsed)
