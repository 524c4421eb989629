"""What a sweep keeps of one transient: maxima, the time to settle, hops. The only place that solves one.

A motion is sampled densely, for it is smooth between the steps of the solver and known everywhere;
what is looked for is then narrowed down between two samples.
"""

import json
import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.continuum import evaluation
from kvtheory.models.continuum.maxima import force_maxima
from kvtheory.models.continuum.solved_scene import FORCE_MAXIMA, SolvedScene, certified
from kvtheory.results import Certificate
from kvtheory.scene.model import Scene
from kvtheory.sweeps.plan import Plan

Array = NDArray[np.float64]

SAMPLES = 12
"""For each step of the solver, on which the depth is a polynomial of degree 8."""
ZOOM, ZOOMS = 33, 5
"""Samples between two others, and how often: within 16^-4 of a sample a maximum differs by less than
rounding."""
SAME = 1e-10
"""Relative; of values as equal as this, as in steady sliding, the first is the largest."""
ROWS = {
    "depth": evaluation.DEPTH,
    "depth_rate": evaluation.RATE,
    "normal_force": evaluation.NORMAL_FORCE,
    "friction_force": evaluation.FRICTION_FORCE,
    "peak_pressure": evaluation.PEAK_PRESSURE,
}
"""Rows of the scaled states that are a quantity but for its unit."""
EDGES = ("leading_edge", "trailing_edge")
SETTLED = 0.01
"""Share of the steady friction force within which the motion counts as settled."""


def follow(
    scene: Scene, plan: Plan, steady: Mapping[str, float]
) -> tuple[dict[str, Any], Certificate]:
    """Solve one scene; return the columns of the plan that are of the transient, and the errors.

    The certificate is of the series; that of a maximum is the one of the quantity itself.

    Raises
    ------
    ValueError, ArithmeticError
        If the motion cannot be followed.
    """
    solution, _, errors = certified(scene, None, plan.rtol)
    times = _times(solution)
    first = solution.states(times)
    found: dict[str, Any] = {}
    series: dict[str, Any] = {}
    if plan.times is not None:
        if max(plan.times) > scene.run.duration:
            raise ValueError(f"a time of `at` is after the end of the run, {scene.run.duration} s")
        series = solution.series(np.array(plan.times))
    for column in plan.columns:
        name, measure = column.base, column.measure
        if measure == "series":
            found[column.name] = series[name]
        elif measure in WHOLE:
            found[column.name] = WHOLE[measure](scene, solution, times, first, steady)
        elif measure == "end":
            found[column.name] = _value(solution, name, times[-1])
        elif measure != "steady":
            sense = np.negative if measure == "min" else np.positive
            time = largest(solution, times, first, partial(_scaled, name, sense))
            wanted = measure == "time_of_max" or math.isnan(time)
            found[column.name] = time if wanted else _value(solution, name, time)
    return found, errors


def largest(
    solution: SolvedScene,
    times: Array,
    moments: Array,
    quantity: Callable[[SolvedScene, Array, Array], Array],
) -> float:
    """Return when a quantity is largest, the first time of it, in s; NaN if it never exists.

    `quantity` takes a solution, times and the states there.
    """
    values = quantity(solution, times, moments)
    if np.isnan(values).all():
        return math.nan
    ends = times[[0, -1]]
    for zoom in range(ZOOMS):
        best = _first_of_largest(values)
        if zoom > 1 and times[best] in ends:
            break  # the motion begins or ends with it
        # Two to each side, for one of them may be the same time but for rounding.
        a, b = times[max(best - 2, 0)], times[min(best + 2, times.size - 1)]
        # The best sample stays among the samples: what lies beside a jump is not lost.
        times = np.sort(np.append(np.linspace(a, b, ZOOM), times[best]))
        values = quantity(solution, times, solution.states(times))
    return float(times[_first_of_largest(values)])


def _first_of_largest(values: Array) -> int:
    top = float(np.nanmax(values))
    return int(np.argmax(values >= top - SAME * abs(top)))


def _scaled(
    name: str, sense: Callable[[Array], Array], solution: SolvedScene, times: Array, moments: Array
) -> Array:
    """Return a quantity, or a positive multiple of it, which is enough to find where it is largest."""
    if name in ROWS:
        return sense(moments[ROWS[name]])
    return sense(_series(solution, name, times))


def _series(solution: SolvedScene, name: str, times: Array) -> Array:
    """Return a quantity in SI, with the history before: at rest, it tells which edge leads."""
    before = solution.natural_times
    before = before[before < times[0]] if name in EDGES else before[:0]
    return np.asarray(solution.series(np.append(before, times))[name])[before.size :]


def _value(solution: SolvedScene, name: str, time: float) -> float:
    return float(_series(solution, name, np.array([time]))[0])


def _times(solution: SolvedScene) -> Array:
    """Return dense times in s over the steps of the solver, with those just before each step ends."""
    motion = solution.motion
    starts = np.array(motion.starts)
    ends = np.append(np.nextafter(starts[1:], 0.0), motion.end)
    parts = np.linspace(0.0, 1.0, SAMPLES + 1)
    scaled = starts[:, None] + (ends - starts)[:, None] * parts
    return np.unique(np.minimum(scaled, motion.end)) * solution.units.time


def _peak_to_steady(
    scene: Scene, solution: SolvedScene, times: Array, moments: Array, steady: Mapping[str, float]
) -> float:
    """Return max |F_x| over |steady F_x|; NaN at rest."""
    friction = abs(steady["friction_force"])
    time = largest(solution, times, moments, partial(_scaled, "friction_force", np.abs))
    return abs(_value(solution, "friction_force", time)) / friction if friction else math.nan


def _settling_time(
    scene: Scene, solution: SolvedScene, times: Array, moments: Array, steady: Mapping[str, float]
) -> float:
    """Return how long after its last change of the drive the friction stays settled; NaN if never."""
    friction = steady["friction_force"] / solution.units.friction_force

    def last_outside(moments: Array) -> int:
        outside = np.abs(moments[ROWS["friction_force"]] - friction) > SETTLED * abs(friction)
        return int(outside.size - 1 - np.argmax(outside[::-1])) if outside.any() else -1

    at = last_outside(moments)
    if friction == 0.0 or at == times.size - 1:
        return math.nan
    if at < 0:
        return 0.0
    a, b = times[at], times[at + 1]
    for _ in range(ZOOMS):
        inner = np.linspace(a, b, ZOOM)
        at = last_outside(solution.states(inner))
        if not 0 <= at < ZOOM - 1:
            break
        a, b = inner[at], inner[at + 1]
    return max(float(b) - scene.drive.last_change, 0.0)


def _hops(scene: Scene, solution: SolvedScene, *_: Any) -> float:
    """Return how often the indenter takes off."""
    return float(sum(event.kind == "take-off" for event in solution.motion.events))


def _events(scene: Scene, solution: SolvedScene, *_: Any) -> str:
    """Return the events as JSON, with times in s; the maxima of the forces among them."""
    maxima = zip(force_maxima(solution.motion), FORCE_MAXIMA, strict=True)
    events = sorted([*((e.s, e.kind) for e in solution.motion.events), *maxima], key=lambda e: e[0])
    return json.dumps([{"time": s * solution.units.time, "kind": kind} for s, kind in events])


WHOLE: Mapping[str, Callable[..., Any]] = {
    "peak_to_steady_friction": _peak_to_steady,
    "settling_time": _settling_time,
    "hops": _hops,
    "events": _events,
}
"""Single values of a whole transient; their units are in `columns.WHOLE`."""
