"""Transients of a sweep by elements: of shapes and foundations that the solver does not follow.

What they know is at instants, and no better than the elements that pass between two of them tell. The scheme
counts parts of elements at the edges, so that no sawtooth is left in what is sampled; what may lie between
two samples counts as error.
"""

from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.model import Model
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES
from kvtheory.models.elements.simulation import simulate
from kvtheory.results import Simulation
from kvtheory.results.table import scales
from kvtheory.scene.model import Scene
from kvtheory.sweeps.measures import relative
from kvtheory.sweeps.plan import FAILS, Column, Measured, Plan

Array = NDArray[np.float64]

PER_HALF_LENGTH = 200
"""Elements in half the contact at rest: about half the paper's, in less than a second a scene."""
STEPS_APART = 2.0
"""Samples are so many time steps apart, for no step is shortened then; four elements pass."""
MOST_SAMPLES = 1000
"""In a run, about: more say little more."""
SOON = np.geomspace(1e-3, 1.0, 13)[:-1]
"""Of their distance: further samples after a change of the drive."""
BETWEEN = 0.25
"""Of the difference to the next sample: twice what a parabola may rise between two samples."""
SAMPLED = f"; of largest and smallest values, and {BETWEEN:g} times what they differ from the next sample by"


def measure(plan: Plan, scenes: Mapping[int, Scene], friction: Array) -> Measured:
    """Simulate scenes one by one; as `measures.measure`, for the measures of `plan.OF_ELEMENTS`."""
    size = len(friction)
    asked = [column for column in plan.columns if column.measure != "steady"]
    values = plan.blank(size)
    errors = {column.base or "friction_force": np.zeros(size) for column in asked}
    reasons: dict[int, Exception] = {}
    statements: set[str] = set()
    sampled = any(column.measure in _TOP for column in asked)
    for index, scene in scenes.items():
        try:
            model = Model.of(scene, 0.0)
            found = _simulated(plan, scene, model.half_length / PER_HALF_LENGTH, sampled=sampled)
        except FAILS as error:
            reasons[index] = error
            continue
        statements.add(relative(found.certificate.statement + SAMPLED * sampled))
        scale, count = scales(model.at_rest), len(plan.times or ())
        for column in asked:
            name = column.base or "friction_force"
            row, between = getattr(found, name), 0.0
            if column.measure in _TOP:
                value, between = _top(column, found.time, row, scene.drive.changes)
                value /= 1.0 if column.base else abs(friction[index]) or np.nan
            else:
                value = row[count] if column.measure == "end" else row[:count]
            own = found.certificate.relative_error[name] + between / scale[name]
            values[column.name][index] = value
            errors[name][index] = max(errors[name][index], own)
    return Measured(
        {column.name: values[column.name] for column in asked}, errors, reasons, statements
    )


_TOP: Mapping[str, tuple[Callable[[Array], Array], float]] = {
    "max": (np.positive, 1.0),
    "min": (np.negative, -1.0),
    "peak_to_steady_friction": (np.abs, 1.0),
}
"""What is largest of the values, and the sign by which it is the answer."""


def _top(
    column: Column, time: Array, row: Array, changes: tuple[float, ...]
) -> tuple[float, float]:
    """Return a largest or smallest value, and by how much it may be topped between two samples."""
    order = np.argsort(time, kind="stable")
    raised, sign = _TOP[column.measure]
    height, piece = raised(row[order]), np.searchsorted(changes, time[order], side="right")
    # Just before a change and at it are two pieces; what does not exist in flight tops nothing.
    steps = np.where(np.diff(piece) == 0, np.abs(np.nan_to_num(np.diff(height))), 0.0)
    beside = np.maximum(np.append(steps, 0.0), np.append(0.0, steps))
    if np.isnan(height).all():
        return np.nan, 0.0
    top = float(np.nanmax(height))
    return sign * top, float(np.nanmax(height + BETWEEN * beside)) - top


def _simulated(plan: Plan, scene: Scene, spacing: float, *, sampled: bool) -> Simulation:
    """Simulate a scene, at the times of the plan, at the end of the run, and at samples."""
    at = [*(plan.times or ()), scene.run.duration]
    if sampled:
        at += _samples(scene, spacing)
    return simulate(scene, spacing, SCHEMES[DEFAULT], at=at, time_step=None, certify=True)


def _samples(scene: Scene, spacing: float) -> list[float]:
    """Return times evenly spread between changes of the drive, more after and one just before each."""
    begun = simulate(scene, spacing, SCHEMES[DEFAULT], at=[0.0], time_step=None, certify=False)
    end = scene.run.duration
    apart = max(STEPS_APART * begun.time_step, end / MOST_SAMPLES)
    found: set[float] = set()
    for start, stop in pairwise([*(t for t in scene.drive.changes if t < end), end]):
        even = np.arange(np.ceil((stop - start) / apart))
        offsets = apart * np.concatenate([even, SOON])
        found.update((start + offsets[offsets < stop - start]).tolist())
        found.add(stop - min(SOON[0] * apart, 0.5 * (stop - start)))
    return sorted(found)
