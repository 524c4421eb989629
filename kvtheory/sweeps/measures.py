"""Transients of a sweep by the solver: series, extremes, settling time, hops and events of many scenes.

The compiled kernel solves all scenes of a block in one call. Those that it leaves unfinished, and all of them
where nothing is compiled or events are requested, are solved one by one, into the same arrays.
"""

import json
import math
from collections.abc import Callable, Mapping
from time import thread_time
from typing import Any

import numpy as np

from kvtheory.compilation import ALIKE, Kernel
from kvtheory.models.continuum import bulk, compiled, maxima
from kvtheory.models.continuum import error_estimate as estimate
from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum.deviation import DEVIATION
from kvtheory.models.continuum.error_estimate import MARGIN
from kvtheory.models.continuum.evaluation import STATE
from kvtheory.models.continuum.prony import trajectory
from kvtheory.models.continuum.run import DONE, ROOM, Beginning, begin, with_more_room
from kvtheory.models.continuum.solved_scene import (
    SERIES,
    beginning,
    certified,
    last_change,
    method_of,
    scaled_drive,
)
from kvtheory.models.continuum.solver import STEP_LIMIT
from kvtheory.models.steady.stable_sliding import ended
from kvtheory.records import readable
from kvtheory.results.cycles import CYCLE, cycle_statement
from kvtheory.results.errors import AT_REST
from kvtheory.results.table import LANDMARKS, QUANTITIES
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState
from kvtheory.sweeps.plan import (
    EVENTS,
    FAILS,
    NO_CYCLE,
    UNSETTLED,
    Array,
    Column,
    Measured,
    Plan,
)

SENSES = {"max": maxima.LARGEST, "time_of_max": maxima.LARGEST, "min": maxima.SMALLEST}
PEAK = "friction_force", maxima.MAGNITUDE
SETTLED = 0.01
"""Share of the steady friction force within which the motion counts as settled."""
DOUBLINGS = 2
"""Doublings of the workspace of a single run: few scenes need more, and are solved alone."""


def measure(plan: Plan, scenes: Mapping[int, Scene], friction: Array) -> Measured:
    """Solve scenes, by their index in a block; return the columns of transients, with rows for all indices.

    `friction` is the steady friction force (N/m) at each index. A maximum has the error of the quantity.
    """
    block = _Motions(plan, scenes, friction)
    block.follow()
    asked = [column for column in plan.columns if column.measure != "steady"]
    block.measured.values = {column.name: block.values(column) for column in asked}
    return block.measured


def kernel_of(scene: Scene) -> Kernel:
    """Return the kernel that solves a scene."""
    return trajectory.KERNEL if scene.foundation.arms else compiled.KERNEL


def unknown(shape: tuple[int, ...]) -> Any:
    """Return states of which no quantity is known."""
    found = np.zeros(shape, STATE)
    for name in SERIES:
        found[name] = math.nan
    return found


def relative(statement: str) -> str:
    """Return a statement on errors for a table that also holds values of other models."""
    return f"{statement}; relative to {AT_REST}"


class _Motions:
    """The transients of a block: the request, and arrays of results with a row for each index."""

    def __init__(self, plan: Plan, scenes: Mapping[int, Scene], friction: Array) -> None:
        size = len(friction)
        wanted = {(c.base, SENSES[c.measure]) for c in plan.columns if c.measure in SENSES}
        wanted |= {PEAK for c in plan.columns if c.measure == "peak_to_steady_friction"}
        self.plan, self.wanted = plan, sorted(wanted)
        names = estimate.unknown("", sprung=True).relative_error
        self.measured = Measured(errors={name: np.zeros(size) for name in (*names, *CYCLE)})
        self.scenes: dict[int, tuple[Scene, StaticState, BaseMotion]] = {}
        self.friction = np.full(size, np.nan)
        self.texts = np.full(size, "", object)
        self.own = {name: np.full(size, np.nan) for name in (*LANDMARKS, *CYCLE)}
        self.found = bulk.Results(
            status=np.full(size, -1),
            other=np.full(size, -1),
            deviations=np.zeros(size, DEVIATION),
            largest=np.zeros((size, len(self.wanted)), maxima.EXTREME),
            states=unknown((size, len(plan.times or ()))),
            settled=np.full(size, np.nan),
            take_offs=np.zeros(size, dtype=np.int64),
            last=unknown((size,)),
        )
        extremes = self.found.largest
        extremes["time"] = extremes["value"] = np.nan
        extremes["quantity"] = [e_.MEASURED.index(name) for name, _ in self.wanted]
        extremes["sense"] = [sense for _, sense in self.wanted]
        for index, scene in scenes.items():
            try:
                units = method_of(scene, plan.rtol).units
                self.scenes[index] = scene, units, scaled_drive(scene, units)
                self.friction[index] = friction[index] / units.friction_force
            except FAILS as error:
                self.measured.reasons[index] = error

    def follow(self) -> None:
        """Solve the scenes one by one, and in one call of compiled kernels from where on that pays."""
        kernel, begun = kernel_of(self.plan.scene), thread_time()
        alone = any(column.measure in LANDMARKS for column in self.plan.columns)
        alone = alone or bool(self.plan.scene.depths)
        plain = not (self.plan.scene.foundation.arms or self.plan.texts or alone)
        together = plain and all(units.rigid_drive for _, units, _ in self.scenes.values())
        waiting = list(self.scenes)
        while waiting:
            done = len(self.scenes) - len(waiting)
            left = (thread_time() - begun) / max(done, 1) * len(waiting)
            if together and kernel.worthwhile(left, ALIKE):
                together = False
                if self.follow_together(waiting):
                    waiting = [i for i in waiting if not self.finished(i)]
                continue
            index = waiting.pop(0)
            try:
                with kernel.followed_by(left - left / (len(waiting) + 1)):
                    self.follow_alone(index)
            except FAILS as error:
                self.measured.reasons[index] = error

    def finished(self, index: int) -> bool:
        """Whether a scene was solved together with others."""
        return bool(self.found.status[index] == self.found.other[index] == DONE)

    def follow_together(self, indices: list[int]) -> bool:
        """Solve scenes in one call of the compiled kernel; return whether it could be compiled."""
        kept = [self.scenes[index] for index in indices]
        units, drives = [u for _, u, _ in kept], [drive for _, _, drive in kept]
        numbers = float(units[0].inertia_number), float(units[0].support_number)
        runs = []
        for rtol, control in estimate.methods(self.plan.rtol):
            run = begin(
                drives[0], numbers, None, drives[0].end, rtol, control, Beginning(), arrays=True
            )
            for _ in range(DOUBLINGS):
                run = with_more_room(run)
            runs.append(run)
        if not compiled.prepared(runs[0]):
            return False
        ends = np.array([drive.end for drive in drives])
        scenes = bulk.Scenes(
            np.array([float(u.inertia_number) for u in units]),
            np.array([0.0 if u.fixed else float(u.support_number) for u in units]),
            ends,
            self.friction[indices],
            np.array([beginning(*each)[:2] for each in kept]),
            np.cumsum([0, *(len(drive.pieces) for drive in drives)]),
            np.concatenate([drive.rows for drive in drives]),
        )
        at = np.array(self.plan.times or (), dtype=float)
        times = np.minimum(at / np.array([[u.time] for u in units]), ends[:, None])
        samples = (maxima.SAMPLES + 1) * ROOM * 2**DOUBLINGS
        instants, states = np.zeros((2, samples)), np.zeros((2, samples), STATE)
        rows = np.zeros(2, STATE)
        room = bulk.Workspace(instants[0], states[0], instants[1], states[1], rows)
        found = bulk.Results(*(array[indices] for array in self.found))
        request = bulk.Request(times, SETTLED)
        compiled.follow(bulk.Bulk(scenes, request, room, found), runs[0], runs[1], STEP_LIMIT)
        for whole, part in zip(self.found, found, strict=True):
            whole[indices] = part
        deviations, given = found.deviations, readable(runs[0].given[0])
        tolerance = max(scene.drive.tolerance for scene, _, _ in kept)
        errors = estimate.errors(
            deviations, deviations, given.rtol, given.fixed, sprung=False, tolerance=tolerance
        )
        self.tell(indices, errors, estimate.STATEMENT)
        return True

    def follow_alone(self, index: int) -> None:
        """Solve one scene."""
        scene, units, _ = self.scenes[index]
        solution, _, errors = certified(scene, None, self.plan.rtol)
        motion, found = solution.motion, self.found
        found.largest[index] = motion.largest(*self.wanted)
        found.settled[index] = motion.settled(self.friction[index], SETTLED)
        if self.plan.times:
            found.states[index] = motion.states(solution.scaled(self.plan.times))
        found.last[index] = motion.states([motion.end])[0]
        found.take_offs[index] = sum(event.kind == "take-off" for event in motion.events)
        own = dict(solution.landmarks)
        if any(column.measure in CYCLE for column in self.plan.columns) and not units.rigid_drive:
            cycle = ended(scene, solution.cycle).known
            own |= cycle.quantities
            for name, error in cycle.relative_errors.items():
                self.measured.errors[name][index] = error
            self.measured.statements |= {cycle_statement(MARGIN), *[NO_CYCLE] * (not cycle.settles)}
        for name, value in own.items():
            self.own[name][index] = value
        if self.plan.texts:
            self.texts[index] = json.dumps([event._asdict() for event in solution.events])
        self.tell(index, errors.relative_error, errors.statement)

    def tell(self, where: Any, errors: Mapping[str, Any], statement: str) -> None:
        """Keep the errors of scenes, but for landmarks, and what the certificate states of them."""
        for name in errors.keys() - LANDMARKS.keys():
            self.measured.errors[name][where] = errors[name]
        self.measured.statements.add(relative(statement))

    def values(self, column: Column) -> Any:
        """Return a column in SI: a value, or a series, for each index."""
        found, name, measure = self.found, column.base, column.measure
        scale = QUANTITIES[name].scale if name else ""
        if measure == EVENTS:
            return self.texts
        if measure in self.own:  # in SI
            return self.own[measure]
        if measure == "series":
            values = found.states[name]
        elif measure == "end":
            values = found.last[name]
        elif measure in SENSES:
            extreme = found.largest[:, self.wanted.index((name, SENSES[measure]))]
            values = extreme["value"]
            if measure == "time_of_max":
                values, scale = extreme["time"], "time"
        elif measure == "peak_to_steady_friction":  # not defined at rest
            steady = np.where(self.friction == 0.0, np.nan, np.abs(self.friction))
            values = found.largest["value"][:, self.wanted.index(PEAK)] / steady
            if np.isnan(found.settled[np.isfinite(values)]).any():
                self.measured.statements.add(UNSETTLED)
        elif measure == "settling_time":  # counted from the last change of the drive
            changes = self.each(lambda scene, units: last_change(scene) / units.time)
            values, scale = np.maximum(found.settled - changes, 0.0), "time"
        else:
            values = found.take_offs.astype(float)
        return (values.T * self.each(lambda _, units: getattr(units, scale) if scale else 1.0)).T

    def each(self, value: Callable[[Scene, StaticState], Any]) -> Array:
        """Return a value of each scene, NaN where none was solved."""
        values = np.full(len(self.friction), np.nan)
        for index, (scene, units, _) in self.scenes.items():
            values[index] = value(scene, units)
        return values
