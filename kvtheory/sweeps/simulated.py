"""Transients of a sweep by elements: shapes and foundations that the solver does not cover.

The result is sampled, and elements enter and leave between samples. The scheme counts parts of elements at
the edges, so that samples carry no sawtooth; what may lie between two samples counts as error.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from kvtheory.models.elements.limit_cycle import limit_cycle
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES
from kvtheory.models.elements.simulation import SAFETY, simulate
from kvtheory.models.steady.stable_sliding import ended, rates_of
from kvtheory.results.cycles import CYCLE, cycle_statement
from kvtheory.results.table import scales
from kvtheory.scene.model import Scene
from kvtheory.sweeps.measures import SETTLED, relative
from kvtheory.sweeps.plan import FAILS, NO_CYCLE, UNSETTLED, Array, Measured, Plan

PER_HALF_LENGTH = 200
"""Elements in half the contact at rest: about half the paper's, in less than a second per scene."""
OF_A_BALL = 60
"""The same of a ball whose cycle is sought: many periods have to pass, and the work grows as the cube."""
STEPS_APART = 2.0
"""Time steps between samples: no step is shortened then, and four elements pass."""
MOST_SAMPLES = 1000
"""Approximate largest number of samples in a run: more improve little."""
SOON = np.geomspace(1e-3, 1.0, 13)[:-1]
"""Additional samples after a change of the drive, as fractions of the distance between samples."""
BETWEEN = 0.25
"""Fraction of the difference to the next sample: twice what a parabola may rise between both."""
SAMPLED = f"; of largest and smallest values, and {BETWEEN:g} times what they differ from the next sample by"
EXTREMES = "max", "min", "peak_to_steady_friction"


def measure(plan: Plan, scenes: Mapping[int, Scene], friction: Array) -> Measured:
    """Simulate scenes one by one; as `measures.measure`, for the measures in `plan.OF_ELEMENTS`."""
    blank, asked = plan.blank(len(friction)), [c for c in plan.columns if c.measure != "steady"]
    found = Measured({column.name: blank[column.name] for column in asked})
    found.errors = {column.base or "friction_force": np.zeros(len(friction)) for column in asked}
    found.errors |= {c.name: np.zeros(len(friction)) for c in asked if c.measure in CYCLE}
    sampled, times = any(c.measure in EXTREMES for c in asked), list(plan.times or ())
    cycles = any(c.measure in CYCLE for c in asked)
    for index, scene in scenes.items():
        try:
            model = Model.of(scene, 0.0)
            coarse = cycles and model.constants.surface.ball
            spacing = model.at_rest.half_length / (OF_A_BALL if coarse else PER_HALF_LENGTH)
            at = [*times, scene.run.duration, *(_samples(scene, spacing) if sampled else ())]
            run: Any = simulate(
                scene, spacing, SCHEMES[DEFAULT], at=at, time_step=None, certify=True
            )
        except FAILS as error:
            found.reasons[index] = error
            continue
        found.statements.add(relative(run.certificate.statement + SAMPLED * sampled))
        scale = scales(model.at_rest)
        if cycle := getattr(run, "cycle", None) if cycles else None:
            cycle = ended(scene, cycle).known
            if run.ripples and not cycle.settles:
                cycle = limit_cycle(scene, run, rates_of(scene)).known
            found.statements |= {cycle_statement(SAFETY), *[NO_CYCLE] * (not cycle.settles)}
        for column in asked:
            if column.measure in CYCLE:
                if cycle:
                    found.values[column.name][index] = cycle.quantities[column.name]
                    found.errors[column.name][index] = cycle.relative_errors[column.name]
                continue
            name = column.base or "friction_force"
            row, between = getattr(run, name), 0.0
            if column.measure in EXTREMES:
                value, between = _extreme(column.measure, run.time, row, scene.changes)
                steady = 1.0 if column.base else abs(friction[index]) or np.nan
                value /= steady
                if not column.base and abs(row[len(times)] - friction[index]) > SETTLED * steady:
                    found.statements.add(UNSETTLED)
            else:
                value = row[len(times)] if column.measure == "end" else row[: len(times)]
            wrong = run.certificate.relative_error[name] + between / scale[name]
            found.values[column.name][index] = value
            found.errors[name][index] = max(found.errors[name][index], wrong)
    return found


def _extreme(
    measure: str, time: Array, row: Array, changes: tuple[float, ...]
) -> tuple[float, float]:
    """Return an extreme of the samples, and by how much it may be exceeded between two of them."""
    order = np.argsort(time, kind="stable")
    sign, row = -1.0 if measure == "min" else 1.0, row[order]
    height = np.abs(row) if measure == "peak_to_steady_friction" else sign * row
    piece = np.searchsorted(changes, time[order], side="right")
    # Samples just before a change and at it are not neighbours; nor are those in flight, without edges.
    steps = np.where(np.diff(piece) == 0, np.abs(np.nan_to_num(np.diff(height))), 0.0)
    beside = np.maximum(np.append(steps, 0.0), np.append(0.0, steps))
    if np.isnan(height).all():
        return np.nan, 0.0
    top = float(np.nanmax(height))
    return sign * top, float(np.nanmax(height + BETWEEN * beside)) - top


def _samples(scene: Scene, spacing: float) -> list[float]:
    """Return times evenly spread between changes of the drive, more after and one just before each."""
    begun = simulate(scene, spacing, SCHEMES[DEFAULT], at=[0.0], time_step=None, certify=False)
    end = scene.run.duration
    apart = max(STEPS_APART * begun.time_step, end / MOST_SAMPLES)
    found: set[float] = set()
    for start, stop in pairwise([*(t for t in scene.changes if t < end), end]):
        even = np.arange(np.ceil((stop - start) / apart))
        offsets = apart * np.concatenate([even, SOON])
        found.update((start + offsets[offsets < stop - start]).tolist())
        found.add(stop - min(SOON[0] * apart, 0.5 * (stop - start)))
    return sorted(found)
