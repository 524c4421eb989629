"""One block of a sweep: a small task in, numbers out. The only place where scenes are solved.

`compute` is a function of its argument alone, so that every executor and every size of block gives the
same bits. A scene that fails is a missing value with its reason; the others are not affected.
"""

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady.methods import METHODS
from kvtheory.models.steady.stable_sliding import lasts
from kvtheory.results.certificate import Certificate
from kvtheory.results.sweep import Failure
from kvtheory.scene.model import Scene
from kvtheory.sweeps.axes import values_at
from kvtheory.sweeps.plan import STABLE, Plan

Array = NDArray[np.float64]

FAILS = (ValueError, ArithmeticError, RuntimeError)
"""What a scene without an answer raises; anything else is a defect of the program."""

INTERPRETED = 1.5
"""Steps interpreted before the first block is compiled, over those from which compiling pays."""


@dataclass(frozen=True)
class Task:
    """Points of a sweep from `start` on: their swept values, and the plan without its axes."""

    plan: Plan
    start: int
    over: Mapping[str, Array]
    tries: int = 1

    @property
    def points(self) -> int:
        """The number of scenes."""
        return next(iter(self.over.values())).size


@dataclass
class Account:
    """What is known of points besides their values: which failed and why, and the worst errors."""

    points: int = 0
    failed: int = 0
    failures: dict[int, str] = field(default_factory=dict)
    statements: set[str] = field(default_factory=set)
    errors: dict[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, blocks: Iterable["Block"], most: int | None = None) -> "Account":
        """Sum up blocks; `failures` lists at most the first `most`."""
        total = cls()
        for block in blocks:
            total.add(block.account, most)
        return total

    def add(self, other: "Account", most: int | None = None) -> None:
        """Add the account of other points."""
        self.points += other.points
        self.failed += other.failed
        if most is None or len(self.failures) < most:
            self.failures |= dict(list(other.failures.items())[:most])
        self.statements |= other.statements
        for name, error in other.errors.items():
            self.worst(name, error)

    def worst(self, name: str, errors: Any) -> None:
        """Raise the error of a quantity to the largest of these."""
        self.errors[name] = max(self.errors.get(name, 0.0), float(np.max(errors, initial=0.0)))

    def fail(self, index: int, error: Exception) -> None:
        """Note on one line why a scene has no answer."""
        reason = "; ".join(str(error).splitlines()) or type(error).__name__
        if isinstance(error, FloatingPointError | OverflowError | ZeroDivisionError):
            reason = f"the scene leaves the range of double precision: {reason}"
        self.failures[index] = reason

    @property
    def certificate(self) -> Certificate:
        """The certificate of all points."""
        return Certificate("estimated", "; ".join(sorted(self.statements)), self.errors)

    def listed(self, plan: Plan) -> tuple[Failure, ...]:
        """Return the failures with the swept values of their points."""
        found = []
        for index, reason in self.failures.items():
            point = {key: float(a[0]) for key, a in values_at(plan.axes, index, index + 1).items()}
            found.append(Failure(index, point, reason))
        return tuple(found)

    def to_json(self) -> str:
        """Return the account as JSON."""
        failures = list(self.failures.items())
        return json.dumps([self.points, self.failed, failures, sorted(self.statements), self.errors])

    @classmethod
    def from_json(cls, text: str) -> "Account":
        """Read what `to_json` gave."""
        points, failed, failures, statements, errors = json.loads(text)
        return cls(points, failed, dict(failures), set(statements), errors)


@dataclass
class Block:
    """Results of the points from `start` to `stop`: an array over them for each column (`Plan.blank`)."""

    start: int
    stop: int
    values: dict[str, NDArray[Any]]
    account: Account


def task(plan: Plan, start: int, stop: int) -> Task:
    """Return the task for some points of a plan."""
    return Task(replace(plan, axes=()), start, values_at(plan.axes, start, stop))


def compute(given: Task) -> Block:
    """Solve the scenes of a task.

    Examples
    --------
    >>> from kvtheory.sweeps.axes import axes_of
    >>> from kvtheory.sweeps.plan import columns_of
    >>> axes = axes_of(Scene(), {"drive.velocity": [0.1, 0.2, 0.4]})
    >>> plan = Plan(Scene(), axes, columns_of("depth", series=False), None, "exact", 1e-6)
    >>> compute(task(plan, 1, 3)).values["depth"].round(6).tolist()
    [4.7e-05, 2.4e-05]
    """
    plan, account = given.plan, Account(given.points)
    values = plan.blank(given.points)
    names = sorted({column.base for column in plan.columns if column.steady} | plan.compared)
    steady, errors = _steady(given, names, account) if names else ({}, {})
    for column in plan.columns:
        if column.steady:
            values[column.name] = steady[column.base]
            if column.base != STABLE:
                account.worst(column.name, errors.get(column.base, 0.0))
    if plan.transient:
        _transients(given, steady.get("friction_force"), values, account)
    failed = sorted(account.failures)
    for name, missing in plan.blank(1).items():
        values[name][failed] = missing[0]
    account.failed = len(failed)
    account.failures = {given.start + index: account.failures[index] for index in failed}
    return Block(given.start, given.start + given.points, values, account)


def _steady(
    given: Task, names: list[str], account: Account
) -> tuple[dict[str, Array], dict[str, float]]:
    """Return quantities of steady sliding and their worst errors.

    A part that fails is halved until the scene at fault is alone.
    """
    plan, worst = given.plan, Account()
    found = {name: np.full(given.points, np.nan) for name in names}
    waiting = [(0, given.points)]
    while waiting:
        a, b = waiting.pop()
        try:
            with np.errstate(over="raise", invalid="raise", divide="raise"):
                scene = plan.scene.replace({key: array[a:b] for key, array in given.over.items()})
                state = METHODS[plan.method](scene)
                if STABLE in names:
                    state = replace(state, stable=lasts(scene))
        except FAILS as error:
            if b - a > 1:
                middle = (a + b) // 2
                waiting += [(middle, b), (a, middle)]
            else:
                account.fail(a, error)
            continue
        account.statements.add(state.certificate.statement)
        for name in names:
            found[name][a:b] = getattr(state, name)
            if name != STABLE:
                worst.worst(name, state.certificate.relative_error[name])
    return found, worst.errors


def _transients(
    given: Task, friction: Array | None, values: dict[str, NDArray[Any]], account: Account
) -> None:
    """Follow the motions; `friction` is the steady friction force in N/m, where it is needed."""
    plan = given.plan
    # Imported here, as the solver and the simulator take a while to import.
    if plan.by_elements:
        from kvtheory.sweeps.simulated import measure
    else:
        from kvtheory.sweeps.measures import measure

    scenes: dict[int, Scene] = {}
    for index in set(range(given.points)) - account.failures.keys():
        try:
            scenes[index] = _scene(given, index)
        except FAILS as error:
            account.fail(index, error)
    if friction is None:
        friction = np.full(given.points, np.nan)
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        found = measure(plan, scenes, friction, FAILS)
    for index, error in found.reasons.items():
        account.fail(index, error)
    account.statements |= found.statements
    kept = [index for index in scenes if index not in account.failures]
    columns = [column for column in plan.columns if not column.steady]
    for name in sorted({column.base for column in columns if column.base} | plan.compared):
        account.worst(name, found.errors[name][kept])
    for column in columns:
        values[column.name][:] = found.values[column.name]


def _scene(given: Task, index: int) -> Scene:
    """Return one scene of a task, whose run must be as long as the times that are asked for."""
    point = {key: float(array[index]) for key, array in given.over.items()}
    scene = given.plan.scene.replace(point)
    if max(given.plan.times or (0.0,)) > scene.run.duration:
        late = f"a time of `at` is after the end of the run, {scene.run.duration} s"
        raise ValueError(late)
    return scene


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
        with suppress(*FAILS):
            compile_ahead(plan, _scene(task(plan, index, index + 1), 0))
            break
