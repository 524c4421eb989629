"""What should be known about a fit of friction: residuals that are not scatter, too large a contact."""

import numpy as np
from numpy.typing import NDArray

from kvtheory.fitting.friction import FINE, STEP, Problem
from kvtheory.fitting.records import Data

Array = NDArray[np.float64]

ALIKE, RARE = 0.5, 2.6
"""Least correlation of neighbouring residuals that are not scatter, as such and over its standard error."""
VISIBLE = {True: STEP[FINE] ** 2, False: 1e-4}
"""Least scatter of residuals over time, and over velocity, whose order counts: rounding is below it."""
PARABOLAS = "parabola", "sphere"
"""Shapes that stand for a cylinder and a ball near the lowest point."""
LARGE = 0.5
"""Half length of the contact over the radius from which no ball or cylinder is a parabola: 3 % in height."""


def alike(problem: Problem, point: Array) -> list[str]:
    """Return a note on each column whose residuals are alike from row to row, over time or velocity."""
    names = [(data, name) for data in problem.data for name in data.measured]
    notes = []
    for (data, name), rows in zip(names, problem.columns(point[None]), strict=True):
        r = rows[0][_order(data)]
        r = r - r.mean() if r.size else r
        correlation = float(r[1:] @ r[:-1] / max(float(r @ r), np.finfo(float).tiny))
        least = max(ALIKE, RARE / max(r.size, 1) ** 0.5)
        over_time = data.time is not None
        if correlation > least and float(np.std(r)) > VISIBLE[over_time]:
            over = "time" if over_time else "velocity"
            message = f"The residuals of {name} over {over} are alike from row to row"
            off = "the model is off, and the standard errors are too small"
            notes.append(f"{message} (correlation {correlation:.2f}): {off}.")
    return notes


def _order(data: Data) -> NDArray[np.int_]:
    """Return the rows in the order of time, or of the speed where there is one."""
    if data.time is not None:
        return np.arange(data.size)
    V = np.abs(data.conditions["drive.velocity"])
    return np.argsort(V, kind="stable")[np.count_nonzero(V == 0.0) :]


def large(problem: Problem, point: Array) -> list[str]:
    """Return a note if the contact of the fitted scene is not small against the radius."""
    own = dict(zip(problem.keys, np.exp(point).tolist(), strict=True))
    if problem.scene.indenter.shape not in PARABOLAS:
        return []
    most = 0.0
    for data in problem.data:
        V = {} if data.time is None else {"drive.velocity": 0.0}
        scene = problem.scene.replace({**data.conditions, **V, **own})
        ratio = problem.solve(scene).half_length / scene.values()["indenter.radius"]
        most = max(most, float(np.max(ratio)))
    if most <= LARGE:
        return []
    message = f"The fitted contact is up to {most:.3g} radii long on each side of the lowest point"
    return [f"{message}, where no ball or cylinder is a parabola: check radius, load and friction."]
