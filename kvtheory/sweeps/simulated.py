"""Transients of a sweep by elements: of shapes and foundations that the solver does not follow."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.model import Model
from kvtheory.models.elements.schemes import DEFAULT, SCHEMES
from kvtheory.models.elements.simulation import simulate
from kvtheory.results import Simulation
from kvtheory.scene.model import Scene
from kvtheory.sweeps.measures import Measured, relative
from kvtheory.sweeps.plan import Plan

PER_HALF_LENGTH = 200
"""Elements in half the contact at rest: about half the paper's, in less than a second a scene."""


def measure(
    plan: Plan, scenes: Mapping[int, Scene], friction: NDArray[np.float64],
    fails: tuple[type[Exception], ...],
) -> Measured:  # fmt: skip
    """Simulate scenes one by one; as `measures.measure`, for series and values at the end.

    >>> from kvtheory.scene import Circle, Foundation
    >>> from kvtheory.sweeps.columns import columns_of
    >>> circle = Scene(Circle(0.01))
    >>> plan = Plan(circle, (), columns_of("depth.end", series=False), None, "quadrature", 1e-6)
    >>> measure(plan, {0: circle}, np.zeros(1), ()).values["depth.end"].round(6)
    array([9.e-05])
    """
    size = len(friction)
    asked = [column for column in plan.columns if not column.steady]
    values = {column.name: np.full((size, *plan.shape(column)), np.nan) for column in asked}
    errors = {column.base: np.zeros(size) for column in asked}
    reasons: dict[int, Exception] = {}
    statements: set[str] = set()
    for index, scene in scenes.items():
        try:
            found = _simulated(plan, scene)
        except fails as error:
            reasons[index] = error
            continue
        statements.add(relative(found.certificate.statement))
        for column in asked:
            row = getattr(found, column.base)
            values[column.name][index] = row[-1] if column.measure == "end" else row[:-1]
            errors[column.base][index] = found.certificate.relative_error[column.base]
    return Measured(values, {}, reasons, statements, errors)


def _simulated(plan: Plan, scene: Scene) -> Simulation:
    """Simulate a scene, at the times of the plan and at the end of the run."""
    spacing, at = Model.of(scene, 0.0).half_length / PER_HALF_LENGTH, [*(plan.times or ())]
    at.append(scene.run.duration)
    return simulate(scene, spacing, SCHEMES[DEFAULT], at=at, time_step=None, certify=True)
