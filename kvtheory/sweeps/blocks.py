"""One block of a sweep: a small task in, numbers out. The only place where scenes are solved.

`compute` is a function of its argument alone, so that every executor and every size of block gives the
same bits. A scene that fails is a missing value with its reason; the others are not affected.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from time import thread_time
from typing import NamedTuple

import numpy as np

from kvtheory.models.steady.methods import METHODS
from kvtheory.models.steady.stable_sliding import lasts
from kvtheory.progress import silent
from kvtheory.results import SteadyState
from kvtheory.scene.capabilities import lacks_continuum
from kvtheory.scene.foundations import beyond, extrapolates
from kvtheory.scene.model import Scene
from kvtheory.sweeps.plan import FAILS, OF_LAYER, REMARKS, STABLE, Array, Measured, Plan, Table

CONTACT = "depth", "half_length"
"""Quantities of steady sliding from which notes on a layer follow."""
MEASURED = 50
"""Fewest points of a sweep of which two are solved to see how long that takes."""


class Task(NamedTuple):
    """Points of a sweep from `start` on: their swept values, and the plan without its axes."""

    plan: Plan
    start: int
    over: Mapping[str, Array]

    @property
    def points(self) -> int:
        """The number of scenes."""
        return next(iter(self.over.values())).size


def task(plan: Plan, start: int, stop: int) -> Task:
    """Return the task for some points of a plan."""
    return Task(replace(plan, axes=()), start, plan.values_at(start, stop))


@dataclass
class Block:
    """The table of the points from `start` to `stop`, and the largest errors of its columns.

    `failures` are pairs of index and reason, `statements` those of the certificates.
    """

    start: int
    stop: int
    table: Table
    failures: list[tuple[int, str]]
    statements: list[str]
    errors: dict[str, float]


def compute(given: Task) -> Block:
    """Solve the scenes of a task."""
    plan, table = given.plan, Table()
    steady = _steady(given) if plan.needed(steady=True) else Measured()
    motion = _transients(given, steady) if plan.transient else Measured()
    reasons = steady.reasons | motion.reasons
    failed = sorted(reasons)
    errors = {name: motion.errors[name] for name in plan.needed(steady=False) if plan.transient}
    for column in plan.columns:
        name, base = column.name, column.base
        if column.measure == "steady":
            table[name] = steady.values[base]
            errors[name] = max(errors.get(name, 0.0), steady.errors.get(base, 0.0))
        else:
            table[name] = motion.values[name]
        table[name][failed] = column.missing
    errors.pop(STABLE, None)
    errors |= _on_layer(given, failed, steady)
    failures = [(given.start + index, _reason(reasons[index])) for index in failed]
    statements = sorted(steady.statements | motion.statements)
    return Block(given.start, given.start + given.points, table, failures, statements, errors)


def _on_layer(given: Task, failed: Sequence[int], steady: Measured) -> dict[str, float]:
    """Return the numbers from which notes on a layer follow, by name with `OF_LAYER`."""
    plan, left = given.plan, np.setdiff1d(np.arange(given.points), failed)
    if plan.layer_numbers is None or plan.scene.foundation.modulus is None or not left.size:
        return {}
    contact = {name: steady.values[name][left] for name in CONTACT if name in steady.values}
    with np.errstate(all="ignore"):
        scene = plan.scene.replace({key: array[left] for key, array in given.over.items()})
        found = plan.layer_numbers(scene, **contact, on_body=plan.method not in METHODS)
    return {f"{name}{OF_LAYER}": number for name, number in found.items()}


def _state(scene: Scene, method: str) -> SteadyState:
    """Solve steady sliding, by a method of the foundation or on the layer itself."""
    if method in METHODS:
        return METHODS[method](scene)
    from kvtheory.layer.answer import solve  # SciPy takes a while to import

    return solve(scene, silent)


def _reason(error: Exception) -> str:
    reason = "; ".join(str(error).splitlines()) or type(error).__name__
    beyond_range = isinstance(error, FloatingPointError | OverflowError | ZeroDivisionError)
    return "the scene leaves the range of double precision: " * beyond_range + reason


def _steady(given: Task) -> Measured:
    """Solve steady sliding; a part that fails is bisected until the failing scene is isolated."""
    plan, names = given.plan, {*given.plan.needed(steady=True)}
    if plan.scene.foundation.modulus is not None:
        names |= {*CONTACT}
    found = Measured({name: np.full(given.points, np.nan) for name in names})
    waiting = [(0, given.points)]
    while waiting:
        a, b = waiting.pop()
        try:
            with np.errstate(over="raise", invalid="raise", divide="raise"):
                scene = plan.scene.replace({key: array[a:b] for key, array in given.over.items()})
                state = _state(scene, plan.method)
                if STABLE in names:
                    state = replace(state, stable=lasts(scene))
        except FAILS as error:
            if b - a > 1:
                waiting += [((a + b) // 2, b), (a, (a + b) // 2)]
            else:
                found.reasons[a] = error
            continue
        for name, values in found.values.items():
            values[a:b] = getattr(state, name)
        found.statements.add(state.certificate.statement)
        length = state.trailing_edge - state.leading_edge
        if extrapolates(scene.foundation, scene.drive.final_velocity, length):
            found.statements.add(REMARKS[0])
        if beyond(scene.foundation):
            found.statements.add(REMARKS[1])
        for name, wrong in state.certificate.relative_error.items():
            found.errors[name] = max(found.errors.get(name, 0.0), float(np.max(wrong)))
    return found


def _transients(given: Task, steady: Measured) -> Measured:
    """Compute the transients of the scenes whose steady sliding did not fail."""
    # Imported here, as the solver and the simulator take a while to import.
    from kvtheory.sweeps import measures, simulated

    plan, by_elements = given.plan, bool(lacks_continuum(given.plan.scene))
    latest = max(given.plan.times or (0.0,))
    scenes: dict[int, Scene] = {}
    reasons: dict[int, Exception] = {}
    for index in set(range(given.points)) - steady.reasons.keys():
        try:
            point = {key: float(array[index]) for key, array in given.over.items()}
            scene = given.plan.scene.replace(point)
            if latest > (end := scene.run.duration):
                raise ValueError(f"a time of `at` is after the end of the run, {end} s")
            scenes[index] = scene
        except FAILS as error:
            reasons[index] = error
    friction = steady.values.get("friction_force", np.full(given.points, np.nan))
    with np.errstate(over="raise", invalid="raise", divide="raise"):
        found = (simulated if by_elements else measures).measure(plan, scenes, friction)
        if not by_elements and plan.scene.foundation.arms and plan.of_elements:
            refused = {index: scenes[index] for index in found.reasons}
            found.replace(refused, simulated.measure(plan, refused, friction))
    found.reasons |= reasons
    for name, wrong in found.errors.items():
        wrong[[*found.reasons]] = 0.0
        found.errors[name] = float(np.max(wrong))
    return found


def compile_ahead(plan: Plan, points: int, workers: int) -> None:
    """Compile the kernels here if that pays for each worker; workers share the disk.

    Two points are solved to see how long that takes.
    """
    if not plan.transient or lacks_continuum(plan.scene) or points < MEASURED:
        return
    from kvtheory.sweeps.measures import kernel_of

    kernel, begun = kernel_of(plan.scene), thread_time()
    for index in (0, plan.points - 1):
        compute(task(plan, index, index + 1))
    seconds = (thread_time() - begun) / 2.0 * points / workers
    if kernel.compiled is None and kernel.pays(seconds) and not (workers > 1 and kernel.on_disk):
        spent, kernel.spent = kernel.spent, math.inf
        try:
            for index in (0, plan.points - 1):  # one of the two may fail
                compute(task(plan, index, index + 1))
        finally:
            kernel.spent = spent
