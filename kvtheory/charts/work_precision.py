"""Work-precision charts: the accuracy and the cost of each method, measured side by side.

Each method sweeps its accuracy parameter. Its first call, which imports and compiles, is timed separately;
one run of each setting gives the errors; then all settings are repeated in random order, for the least time
and the quartiles. Settings that fail are kept, with the reason.
"""

import math
import random
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Literal

import numpy as np

from kvtheory.progress import Progress, silent
from kvtheory.results.errors import DivergenceError
from kvtheory.results.presented import record

MISSED, WRONG = "missed event", "wrong but reported success"
REASONS = "unstable", "not converged", "timed out", "refused", MISSED, WRONG


class TimedOutError(Exception):
    """A run took longer than allowed."""


REASON_OF: dict[type[BaseException], str] = {
    TimedOutError: "timed out", DivergenceError: "unstable",
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


def make_chart(
    problem: Any, methods: Iterable[Method], *, effort: Effort = FULL,
    progress: Progress = silent,
) -> Chart:  # fmt: skip
    """Measure every method that suits the problem.

    A problem has a `name` and a `reference()`; it can `assess(found, reference, tolerance)`, which gives the
    errors of a solution, and why it is wrong, if so, for a method with a tolerance.
    """
    right = problem.reference()
    chosen = [method for method in methods if method.suits(problem)]
    series: list[Series] = []
    jobs: list[tuple[Point, Callable[[], Any]]] = []
    for done, method in enumerate(chosen, 1):
        points = [Point(value) for value in method.values[:: effort.every]]
        first = _attempt(problem, method, right, points, effort)
        series.append(Series(method.name, method.kind, method.knob, method.work, points, first))
        for point in points:
            if point.errors:
                jobs.append((point, partial(method.solve, problem, point.knob, Clock())))
        progress(0.7 * done / len(chosen), method.name)
    _repeat(jobs, effort)
    for method, one in zip(chosen, series, strict=True):
        for point in one.points:
            point.times = [seconds / method.scenes for seconds in point.times]
            point.first /= method.scenes
    progress(1.0, "")
    return Chart(problem.name, series, right.agreement, right.methods)


def _attempt(
    problem: Any, method: Method, right: Reference, points: list[Point], effort: Effort
) -> float:
    """Run each setting once, until one times out; return the time of a first call, which compiles."""
    rated = method.kind == "numerical" and method.knob == "rtol"
    clock = Clock(effort.longest)
    # Overflow is reported below, by its error or its reason.
    with np.errstate(all="ignore"):
        with suppress(TimedOutError, ArithmeticError, ValueError):
            method.solve(problem, points[0].knob, clock)
        first = clock.elapsed
        for before, point in zip([None, *points], points, strict=False):
            if before and before.reason == "timed out":
                point.reason = "timed out"
                continue
            clock = Clock(effort.longest)
            try:
                found, point.work = method.solve(problem, point.knob, clock)
                tolerance = point.knob if rated else None
                point.errors, point.reason = problem.assess(found, right, tolerance)
            except tuple(REASON_OF) as error:
                kinds = (kind for kind in type(error).mro() if kind in REASON_OF)
                point.reason, point.message = REASON_OF[next(kinds)], str(error)
            point.first = clock.elapsed
    return first


def _repeat(jobs: list[tuple[Point, Callable[[], Any]]], effort: Effort) -> None:
    """Time the jobs repeatedly in random order, as far as the effort allows."""
    order, whole = random.Random(0), Clock()
    for _ in range(effort.repeats):
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
