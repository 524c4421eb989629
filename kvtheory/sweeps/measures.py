"""What a sweep keeps of transients: series, maxima, the time to settle, hops, events, of many scenes at once.

The compiled kernel measures all scenes of a block in one call. Those that it leaves, and all of them where
nothing is compiled or events are asked for, are followed one by one, into the same arrays.
"""

import json
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.continuum import bulk, compiled, deviation, maxima
from kvtheory.models.continuum import error_estimate as estimate
from kvtheory.models.continuum import evaluation as e_
from kvtheory.models.continuum.cycles import cycle
from kvtheory.models.continuum.run import GIVEN, ROOM, Run, begin, readable, with_more_room
from kvtheory.models.continuum.solved_scene import certified, left_leads, scaled_drive
from kvtheory.models.continuum.solver import STEP_LIMIT
from kvtheory.models.continuum.stepping import DONE
from kvtheory.results.certificate import AT_REST
from kvtheory.results.table import QUANTITIES
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState
from kvtheory.sweeps.plan import CYCLE, EVENTS, FAILS, Column, Measured, Plan

Array = NDArray[np.float64]

COLUMNS = {
    "velocity": e_.DRIVE,
    "sliding_velocity": e_.NUMBER,
    "spring_force": e_.SPRING_FORCE,
    "depth": e_.DEPTH,
    "depth_rate": e_.RATE,
    "normal_force": e_.NORMAL_FORCE,
    "friction_force": e_.FRICTION_FORCE,
    "peak_pressure": e_.PEAK_PRESSURE,
    "leading_edge": maxima.LEADING_EDGE,
    "trailing_edge": maxima.TRAILING_EDGE,
}
"""Columns of the states."""
SENSES = {"max": maxima.LARGEST, "time_of_max": maxima.LARGEST, "min": maxima.SMALLEST}
PEAK = e_.FRICTION_FORCE, maxima.MAGNITUDE
SETTLED = 0.01
"""Share of the steady friction force within which the motion counts as settled."""
STEPS = 40
"""That a certified scene takes, about: so many of them are worth to compile."""
DOUBLINGS = 2
"""Of the room of a single motion: few scenes then need more, and are followed alone."""


def measure(plan: Plan, scenes: Mapping[int, Scene], friction: Array) -> Measured:
    """Follow scenes, by their index in a block; return the columns of the plan that belong to transients.

    The scenes differ in values, not in the kinds of their parts. `friction` is the steady friction force
    in N/m at each index of the block, where it is needed. The result has rows for all indices. The errors
    are those of the series; a maximum has that of the quantity itself.
    """
    block = _Block(plan, len(friction))
    for index, scene in scenes.items():
        block.add(index, scene, friction[index])
    block.follow()
    return block.measured()


def compile_ahead(plan: Plan, scene: Scene) -> None:
    """Compile what `measure` calls for a plan, by beginning one of its scenes."""
    block = _Block(plan, 1)
    block.add(0, scene, math.nan)
    if block.alike:
        block.follow_together(1)
    else:
        compiled.Tally.steps += compiled.WORTHWHILE
        block.follow_alone(0)


class _Block:
    """A block of scenes on its way: what is asked, and arrays with a row for each index."""

    def __init__(self, plan: Plan, size: int) -> None:
        self.plan = plan
        wanted = {(COLUMNS[c.base], SENSES[c.measure]) for c in plan.columns if c.measure in SENSES}
        if any(c.measure == "peak_to_steady_friction" for c in plan.columns):
            wanted.add(PEAK)
        self.wanted, times = sorted(wanted), len(plan.times or ())
        self.scenes: dict[int, tuple[Scene, StaticState, BaseMotion]] = {}
        self.friction = np.full(size, np.nan)
        self.reasons: dict[int, Exception] = {}
        self.statements: set[str] = set()
        self.texts = [""] * size
        known = estimate.unknown("", sprung=True).relative_error
        self.errors = {name: np.zeros(size) for name in known}
        self.cycles = np.full((size, len(CYCLE)), np.nan)
        self.found = bulk.Results(
            status=np.full(size, -1),
            other=np.full(size, -1),
            deviations=np.zeros((size, deviation.SIZE)),
            largest=np.full((size, len(self.wanted), 2), np.nan),
            states=np.full((size, times, e_.SIZE), np.nan),
            settled=np.full(size, np.nan),
            take_offs=np.zeros(size, dtype=np.int64),
            last=np.full((size, e_.SIZE), np.nan),
        )

    def add(self, index: int, scene: Scene, friction: float) -> None:
        """Add a scene, or the reason why it cannot be followed."""
        try:
            units = StaticState.of(scene)
            self.scenes[index] = scene, units, scaled_drive(scene, units)
            self.friction[index] = friction / units.friction_force
        except FAILS as error:
            self.reasons[index] = error

    def follow(self) -> None:
        """Follow the scenes, as many as possible in one call."""
        worthwhile = compiled.worthwhile() or STEPS * len(self.scenes) >= compiled.WORTHWHILE
        if self.scenes and self.alike and worthwhile and compiled.available():
            self.follow_together(STEP_LIMIT)
        for index in self.scenes:
            if not (self.found.status[index] == self.found.other[index] == DONE):
                try:
                    self.follow_alone(index)
                except FAILS as error:
                    self.reasons[index] = error

    @property
    def alike(self) -> bool:
        """Whether one call follows all scenes: the drives are rigid, and no texts are asked for."""
        rigid = all(units.rigid_drive for _, units, _ in self.scenes.values())
        return rigid and not self.plan.texts

    def follow_together(self, limit: int) -> None:
        """Follow all scenes in one call, each for so many steps at most."""
        indices = list(self.scenes)
        units, drives = [self.scenes[i][1] for i in indices], [self.scenes[i][2] for i in indices]
        fine, other = self._room(drives[0], units[0])
        at = np.array(self.plan.times or (), dtype=float)
        ends = np.array([drive.end for drive in drives])
        times = np.minimum(at / np.array([[u.time] for u in units]), ends[:, None])
        scenes = bulk.Scenes(
            np.array([float(u.inertia_number) for u in units]),
            np.array([0.0 if u.fixed else float(u.support_number) for u in units]),
            ends,
            self.friction[indices],
            np.cumsum([0, *(len(drive.pieces) for drive in drives)]),
            np.concatenate([drive.rows for drive in drives]),
        )
        columns = np.array(self.wanted, dtype=np.int64).reshape(-1, 2).T.copy()
        request = bulk.Request(columns[0], columns[1], times, SETTLED)
        samples = (maxima.SAMPLES + 1) * ROOM * 2**DOUBLINGS
        one, two = (np.zeros((samples, e_.SIZE)) for _ in range(2))
        rows = np.zeros((2, e_.SIZE))
        room = bulk.Workspace(np.zeros(samples), one, np.zeros(samples), two, rows)
        found = bulk.Results(*(array[indices] for array in self.found))
        compiled.follow(bulk.Bulk(scenes, request, room, found), fine, other, limit)
        for whole, part in zip(self.found, found, strict=True):
            whole[indices] = part
        told = found.deviations.T
        given = readable(fine.given[0], GIVEN)
        tolerance = max(self.scenes[index][0].drive.tolerance for index in indices)
        errors = estimate.errors(
            told, told, given.rtol, given.fixed, sprung=False, tolerance=tolerance
        )
        for name, error in errors.items():
            self.errors[name][indices] = error
        self.statements.add(relative(estimate.STATEMENT))

    def _room(self, drive: BaseMotion, units: StaticState) -> list[Run]:
        runs, numbers = [], (float(units.inertia_number), float(units.support_number))
        for tolerance, control in estimate.methods(self.plan.rtol):
            run = begin(drive, numbers, None, drive.end, tolerance, control, arrays=True)
            for _ in range(DOUBLINGS):
                run = with_more_room(run)
            runs.append(run)
        return runs

    def follow_alone(self, index: int) -> None:
        """Follow one scene."""
        scene, _, _ = self.scenes[index]
        solution, _, errors = certified(scene, None, self.plan.rtol)
        motion, found = solution.motion, self.found
        for name, error in errors.relative_error.items():
            self.errors[name][index] = error
        for k, (column, sense) in enumerate(self.wanted):
            found.largest[index, k] = motion.largest(column, sense)
        found.settled[index] = motion.settled(self.friction[index], SETTLED)
        if self.plan.times:
            found.states[index] = solution.states(self.plan.times).T
        found.last[index] = motion.last
        found.take_offs[index] = sum(event.kind == "take-off" for event in motion.events)
        if not solution.units.rigid_drive:
            self.cycles[index] = cycle(motion)
        if self.plan.texts:
            self.texts[index] = json.dumps([event._asdict() for event in solution.events])
        self.statements.add(relative(errors.statement))

    def measured(self) -> Measured:
        """Return what was found, in SI."""
        values = {
            column.name: _VALUES[column.measure](self, column)
            for column in self.plan.columns
            if column.measure in _VALUES
        }
        return Measured(values, self.errors, self.reasons, self.statements)

    def scales(self, name: str) -> Array:
        """Return what measures a quantity of each scene, by the name of the scale or of the quantity."""
        scale = QUANTITIES[name].scale if name in QUANTITIES else name
        scales = np.full(len(self.friction), np.nan)
        for index, (_, units, _) in self.scenes.items():
            scales[index] = getattr(units, scale)
        return scales


def _series(block: _Block, column: Column) -> Array:
    """Return a quantity at the times: a row for each scene."""
    found, name = block.found.states, column.base
    if COLUMNS[name] < e_.SIZE:
        row = found[..., COLUMNS[name]]
    else:
        times, leads = np.array(block.plan.times), found[..., e_.NUMBER] >= 0.0
        for index, (_, units, drive) in block.scenes.items():
            leads[index] = left_leads(found[index, :, e_.NUMBER], drive, times / units.time)
        left = leads == (name == "leading_edge")
        row = np.where(left, found[..., e_.LEFT], found[..., e_.RIGHT])
    return row * block.scales(name)[:, None]


def _largest(block: _Block, column: Column) -> Array:
    """Return a largest or smallest value, or its time."""
    key = COLUMNS[column.base], SENSES[column.measure]
    times, values = np.moveaxis(block.found.largest[:, block.wanted.index(key)], -1, 0)
    if column.measure == "time_of_max":
        return times * block.scales("time")
    return values * block.scales(column.base)


def _peak_to_steady(block: _Block, _: Column) -> Array:
    """Return max |F_x| over |steady F_x|; NaN at rest."""
    peak, steady = block.found.largest[:, block.wanted.index(PEAK), 1], np.abs(block.friction)
    return peak / np.where(steady == 0.0, np.nan, steady)


def _settling_time(block: _Block, column: Column) -> Array:
    """Return how long after its last change of the drive the friction stays settled; NaN if never."""
    changes = np.zeros(len(block.friction))
    for index, (scene, _, _) in block.scenes.items():
        changes[index] = scene.drive.last_change
    return np.maximum(block.found.settled * block.scales("time") - changes, 0.0)


def _of_cycle(block: _Block, column: Column) -> Array:
    """Return a value of the cycle at the end."""
    scale = {"1": None, "m": "half_length", "s": "time", "m/s": "velocity", "N/m": "friction_force"}
    values = block.cycles[:, list(CYCLE).index(column.measure)]
    name = scale[column.unit]
    return values if name is None else values * block.scales(name)


def relative(statement: str) -> str:
    """Return a statement on errors for a table that holds values of other models, too."""
    return f"{statement}; relative to {AT_REST}"


_VALUES: Mapping[str, Callable[[_Block, Column], Any]] = {
    "series": _series,
    "end": lambda block, of: block.found.last[:, COLUMNS[of.base]] * block.scales(of.base),
    "max": _largest,
    "min": _largest,
    "time_of_max": _largest,
    "peak_to_steady_friction": _peak_to_steady,
    "settling_time": _settling_time,
    "hops": lambda block, _: block.found.take_offs.astype(float),
    EVENTS: lambda block, _: block.texts,
    **dict.fromkeys(CYCLE, _of_cycle),
}
"""Values of the columns, by their measure; the units of single ones are in `plan.WHOLE`."""
