"""Work-precision charts: the accuracy and the cost of each method, measured side by side.

Each method sweeps its accuracy parameter. Its first call, which imports and compiles, is timed separately;
one run of each setting gives the errors; then all settings are repeated in random order, for the least time
and the quartiles. Settings that fail are kept, with the reason.
"""

import random
import time
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from kvtheory.charts.methods import Clock, Method, TimedOutError, transient_methods
from kvtheory.charts.problems import Problem, Reference, errors, reference
from kvtheory.progress import Progress, silent
from kvtheory.results.certificate import record
from kvtheory.results.errors import DivergenceError

WRONG = 1e-3
"""Error of a curve at which a run that reported success is wrong, if it is also far beyond its tolerance."""
BEYOND = 100.0
"""Multiple of its tolerance at which an error is far beyond it."""
JUDGED = "depth, maximum", "friction, maximum"
"""Errors by which a run is called wrong."""
REASONS = ("unstable", "not converged", "timed out", "refused", "missed event",
           "wrong but reported success")  # fmt: skip
REASON_OF: dict[type[BaseException], str] = {
    TimedOutError: "timed out",
    DivergenceError: "unstable",
    ArithmeticError: "not converged",
    ValueError: "refused",
}
"""Why a run failed, by its exception."""


@dataclass(frozen=True)
class Effort:
    """Limits of a chart: repeats of each setting, seconds for one run and for all repeats."""

    repeats: int
    longest: float
    whole: float
    every: int


FULL, QUICK = Effort(11, 20.0, 120.0, 1), Effort(3, 0.4, 3.0, 2)
"""Only one of `every` settings of a parameter is taken."""


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


def transient_chart(
    problem: Problem, *, methods: Iterable[Method] | None = None, effort: Effort = FULL,
    progress: Progress = silent,
) -> Chart:  # fmt: skip
    """Measure every method that suits the problem.

    Examples
    --------
    >>> from kvtheory.charts.problems import standard_scene
    >>> one = transient_methods()["two states, LSODA"]
    >>> chart = transient_chart(Problem("table-1", standard_scene("table-1")), methods=[one], effort=QUICK)
    >>> all(point.errors["depth, maximum"] < 0.05 for point in chart.series[0].points)
    True
    """
    right = reference(problem)
    chosen = [m for m in (methods or transient_methods().values()) if m.suits(problem)]
    series: list[Series] = []
    jobs: list[tuple[Point, Callable[[], Any]]] = []
    for done, method in enumerate(chosen, 1):
        points = [Point(value) for value in method.values[:: effort.every]]
        first = attempt(points, partial(_solve, problem, method, right), effort)
        series.append(Series(method.name, method.kind, method.knob, method.work, points, first))
        good = [point for point in points if not point.reason or point.errors]
        jobs += [(point, partial(method.solve, problem, point.knob, Clock())) for point in good]
        progress(0.7 * done / len(chosen), method.name)
    repeat(jobs, effort)
    progress(1.0, "")
    return Chart(problem.name, series, right.agreement, right.methods)


def repeat(jobs: list[tuple[Point, Callable[[], Any]]], effort: Effort) -> None:
    """Time the jobs repeatedly in random order, as far as the effort allows."""
    order = random.Random(0)
    began = time.perf_counter()
    for _ in range(effort.repeats):
        order.shuffle(jobs)
        for point, run in jobs:
            if time.perf_counter() - began > effort.whole and point.times:
                continue
            if point.first > effort.longest / 4.0 and point.times:
                continue  # of long runs a second one is enough
            start = time.perf_counter()
            with np.errstate(all="ignore"):
                run()
            point.times.append(time.perf_counter() - start)


def attempt(points: list[Point], solve: Callable[[Point, Clock], object], effort: Effort) -> float:
    """Run each setting once, the cheapest first, and keep why it failed; return the time of the first call.

    That call imports and compiles, and is made separately. Once a setting has timed out, the more expensive
    ones count as timed out and are not begun.
    """
    first, clock = Clock(effort.longest), Clock(effort.longest)
    first.start()
    # What overflows is told below, by its error or its reason.
    with np.errstate(all="ignore"), suppress(TimedOutError, ArithmeticError, ValueError):
        solve(Point(points[0].knob), first)
    seconds = time.perf_counter() - first.began
    for point in points:
        if any(other.reason == "timed out" for other in points):
            point.reason = "timed out"
            continue
        clock.start()
        try:
            with np.errstate(all="ignore"):
                solve(point, clock)
        except tuple(REASON_OF) as error:
            point.reason = next(REASON_OF[kind] for kind in type(error).mro() if kind in REASON_OF)
            point.message = str(error)
        point.first = time.perf_counter() - clock.began
    return seconds


def _solve(problem: Problem, method: Method, right: Reference, point: Point, clock: Clock) -> None:
    """Solve a problem with one setting, and judge the result."""
    curves, point.work = method.solve(problem, point.knob, clock)
    point.errors = errors(curves, right.curves)
    if method.kind == "numerical" and method.knob == "rtol":
        point.reason = _judge(point.errors, point.knob, curves, right)


def _judge(found: dict[str, float], tolerance: float, curves: Any, right: Reference) -> str:
    """Return why a run that reported success is wrong, or nothing."""
    worst = max(found[name] for name in JUDGED)
    if not np.isfinite(worst):
        return "not converged"
    if worst < WRONG or worst < BEYOND * tolerance:
        return ""
    flying = (right.curves.friction == 0.0) & (right.curves.depth != 1.0)
    return "missed event" if np.any(curves.friction[flying] != 0.0) else REASONS[-1]
