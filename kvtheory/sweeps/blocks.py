"""One block of a sweep: a small task in, numbers out. The only place where scenes are solved.

`compute` is a function of its argument alone, so every executor and every cut into blocks gives the
same bits; a scene that fails is a missing value with its reason, and its neighbours are not touched.
"""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady.methods import METHODS
from kvtheory.models.steady.stable_sliding import lasts
from kvtheory.scene.broadcasting import replaceable, values
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import changed
from kvtheory.sweeps.axes import narrowed, values_at
from kvtheory.sweeps.columns import STABLE
from kvtheory.sweeps.plan import Plan

Array = NDArray[np.float64]

FAILS = (ValueError, ArithmeticError, RuntimeError)
"""What a scene without an answer raises; anything else is a mistake of the program."""

INTERPRETED = 1.5
"""Of the steps from which compiling pays: more are interpreted before the first block that is compiled."""


@dataclass(frozen=True)
class Task:
    """Points `start` to `stop` of a sweep; its plan holds only the values that they need."""

    plan: Plan
    start: int
    stop: int
    moved: int

    @property
    def points(self) -> int:
        """How many scenes it holds."""
        return self.stop - self.start


@dataclass(frozen=True)
class Block:
    """Results of the points `start` to `stop`: an array over them for each column, see `Plan.blank`.

    `failures` are pairs of index and reason; `errors` is the certificate: the statements, and the
    worst relative error of each quantity.
    """

    start: int
    stop: int
    values: Mapping[str, NDArray[Any]]
    failures: Sequence[tuple[int, str]]
    errors: tuple[Sequence[str], Mapping[str, float]]


def task(plan: Plan, start: int, stop: int) -> Task:
    """Return the task for some points of a plan."""
    axes, moved = narrowed(plan.axes, start, stop)
    return Task(replace(plan, axes=axes), start, stop, moved)


def compute(given: Task) -> Block:
    """Solve the scenes of a task.

    Examples
    --------
    >>> from kvtheory.sweeps.axes import axes_of
    >>> from kvtheory.sweeps.columns import columns_of
    >>> axes = axes_of(Scene(), {"drive.velocity": [0.1, 0.2, 0.4]})
    >>> plan = Plan(Scene(), axes, columns_of("depth", series=False), None, "exact", 1e-6)
    >>> compute(task(plan, 1, 3)).values["depth"].round(6).tolist()
    [4.7e-05, 2.4e-05]
    """
    plan = given.plan
    over = values_at(plan.axes, given.start - given.moved, given.stop - given.moved)
    found = plan.blank(given.points)
    reasons: dict[int, str] = {}
    statements: set[str] = set()
    errors: dict[str, float] = {}
    needed = {column.base for column in plan.columns if column.steady} | plan.compared
    steady: dict[str, Array] = {}
    if needed:
        told, worst_of = _steady(plan, over, sorted(needed), steady, reasons)
        statements |= told
        for column in plan.columns:
            if column.steady:
                found[column.name] = steady[column.base]
                if column.base != STABLE:
                    errors[column.name] = worst_of.get(column.base, 0.0)
    if plan.transient:
        statements |= _transients(given, over, steady, (found, reasons, errors))
    blank = plan.blank(1)
    for name, array in found.items():
        array[list(reasons)] = blank[name][0]
    failures = [(given.start + index, reasons[index]) for index in sorted(reasons)]
    return Block(given.start, given.stop, found, failures, (sorted(statements), errors))


def _steady(
    plan: Plan,
    over: Mapping[str, Array],
    names: Sequence[str],
    found: dict[str, Array],
    reasons: dict[int, str],
) -> tuple[set[str], dict[str, float]]:
    """Find quantities of steady sliding; halve a block that fails until the scene at fault is alone.

    Returns the statements of the certificates and the worst errors.
    """
    count = next(iter(over.values())).size
    known = replaceable(plan.scene)
    over = {key: array for key, array in over.items() if key in known}
    found |= {name: np.full(count, np.nan) for name in names}
    statements: set[str] = set()
    errors: dict[str, float] = {}
    waiting = [(0, count)]
    while waiting:
        a, b = waiting.pop()
        part = {key: array[a:b] for key, array in over.items()}
        try:
            with np.errstate(over="raise", invalid="raise", divide="raise"):
                given = values(plan.scene, part)
                state = METHODS[plan.method](plan.scene, given)
                if STABLE in names:
                    state = replace(state, stable=lasts(plan.scene, given))
        except FAILS as error:
            if b - a > 1:
                middle = (a + b) // 2
                waiting += [(middle, b), (a, middle)]
            else:
                reasons[a] = reason(error)
            continue
        statements.add(state.certificate.statement)
        for name in names:
            found[name][a:b] = getattr(state, name)
            if name != STABLE:
                worst(errors, name, state.certificate.relative_error[name])
    return statements, errors


def _transients(
    given: Task,
    over: Mapping[str, Array],
    steady: Mapping[str, Array],
    into: tuple[Mapping[str, NDArray[Any]], dict[int, str], dict[str, float]],
) -> set[str]:
    """Follow the motions; return the statements of the certificates.

    `into` is filled: the arrays of the columns, the reasons of failures, and the worst errors.
    """
    plan, (arrays, reasons, errors) = given.plan, into
    # Imported here: the solver and the simulator take a while.
    if plan.by_elements:
        from kvtheory.sweeps.simulated import measure
    else:
        from kvtheory.sweeps.measures import measure

    scenes: dict[int, Scene] = {}
    for index in range(given.points):
        if index in reasons:
            continue
        point = {key: float(array[index]) for key, array in over.items()}
        try:
            scenes[index] = _in_time(plan, at_point(plan.scene, point))
        except FAILS as error:
            reasons[index] = reason(error)
    friction = steady.get("friction_force", np.full(given.points, np.nan))
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        found = measure(plan, scenes, friction, FAILS)
    reasons.update((index, reason(error)) for index, error in found.reasons.items())
    columns = [column for column in plan.columns if not column.steady]
    kept = [index for index in scenes if index not in reasons]
    for name in {column.base for column in columns if column.base} | plan.compared:
        worst(errors, name, found.errors[name][kept])
    for column in columns:
        values = found.texts if column.text else found.values
        arrays[column.name][:] = values[column.name]
    return found.statements


def compile_ahead(plan: Plan, points: int, workers: int) -> None:
    """Compile the kernels here, if `points` are so many that each of the workers would do it otherwise.

    Workers load what is compiled from the disk, if they share it and have processors of the same kind.
    """
    if not plan.transient or plan.by_elements:
        return
    from kvtheory.models.continuum import compiled
    from kvtheory.sweeps.measures import STEPS, compile_ahead

    if not compiled.available() or STEPS * points < INTERPRETED * compiled.WORTHWHILE * workers:
        return
    for index in (0, plan.points - 1):  # the second, if the first has no answer
        over = values_at(plan.axes, index, index + 1)
        with suppress(*FAILS):
            point = {key: float(array[0]) for key, array in over.items()}
            compile_ahead(plan, at_point(plan.scene, point))
            break


def _in_time(plan: Plan, scene: Scene) -> Scene:
    """Return a scene whose run is as long as the times that are asked for."""
    if max(plan.times or (0.0,)) > scene.run.duration:
        late = f"a time of `at` is after the end of the run, {scene.run.duration} s"
        raise ValueError(late)
    return scene


def at_point(scene: Scene, point: Mapping[str, float]) -> Scene:
    """Return the scene with some values replaced; a velocity replaces a history, or a swing.

    >>> at_point(Scene(), {"drive.velocity": 0.5, "support.mass": 10.0}).support.mass
    10.0
    """
    sections: dict[str, dict[str, float]] = {}
    for key, value in point.items():
        section, _, name = key.partition(".")
        sections.setdefault(section, {})[name] = value
    parts: dict[str, Any] = {
        section: scene.drive.changed(**values)
        if section == "drive"
        else changed(getattr(scene, section), **values)
        for section, values in sections.items()
    }
    return replace(scene, **parts)


def reason(error: Exception) -> str:
    """Say on one line why a scene has no answer."""
    range_left = isinstance(error, FloatingPointError | OverflowError | ZeroDivisionError)
    told = "; ".join(str(error).splitlines()) or type(error).__name__
    return f"the scene leaves the range of double precision: {told}" if range_left else told


def worst(errors: dict[str, float], name: str, error: Any) -> None:
    """Raise the error of a quantity to the largest seen."""
    errors[name] = max(errors.get(name, 0.0), float(np.max(error, initial=0.0)))
