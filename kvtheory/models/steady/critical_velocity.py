"""The smallest velocity at which the stiffness of a spring in the drive becomes critical.

The stiffnesses between which steady sliding is unstable are closed forms of the velocity (theorem F22),
not always monotonic: a damper or a suspension makes steady sliding stable again at a high velocity, and a
heavy indenter may flutter at a low one. The first change is therefore found on a grid, then bisected.
"""

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady.stability import numbers, onsets
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]

DECADES = (-8.0, 20.0)
"""Powers of ten of the drive number V tau/a_0 between which a change is sought."""
PER_DECADE = 16
BISECTIONS = 60
"""To the last digit of a velocity, from a cell of the grid."""
NEARBY = 1e-5
"""Relative difference of velocities for the slope of the critical stiffness."""
SOFT, UNSTABLE, STIFF, NEVER = -1, 0, 1, 2
"""The stiffness of the spring relative to the critical ones: below both, between, above, or none exists."""


def critical_velocity(scene: Scene) -> tuple[Array, Array]:
    """Return the velocity in m/s for each of flat scenes, NaN if there is none, and its error."""
    if scene.held:
        nothing = np.full(scene.shape, np.nan)
        return nothing, nothing
    column = scene.flat().mapped(lambda x: x[:, np.newaxis])
    spring, tau = column.drive.stiffness, column.foundation.retardation_time
    load = column.support.weight / column.foundation.stiffness
    unit = np.log(np.cbrt(1.5 * column.indenter.radius * load) / tau)

    def state(log_velocity: Array) -> NDArray[np.int_]:
        lower, upper = onsets(numbers(column.at(np.exp(log_velocity))), tau)
        places = [spring > upper.stiffness, spring < lower.stiffness, spring <= upper.stiffness]
        return np.select(places, [STIFF, SOFT, UNSTABLE], NEVER)

    count = round((DECADES[1] - DECADES[0]) * PER_DECADE) + 1
    grid = np.broadcast_to(unit, column.shape) + np.log(10.0) * np.linspace(*DECADES, count)
    states = state(grid)
    before, after = states[:, :-1], states[:, 1:]
    changes = (after == UNSTABLE) | (before * after == SOFT * STIFF)
    first, some = changes.argmax(axis=1)[:, np.newaxis], changes.any(axis=1)
    low, high, was = (
        np.take_along_axis(each, first, axis=1) for each in (grid[:, :-1], grid[:, 1:], before)
    )
    across = np.take_along_axis(after, first, axis=1) != UNSTABLE
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        now = state(middle)
        stays = np.where(across, now == was, now != UNSTABLE)
        low, high = np.where(stays, middle, low), np.where(stays, high, middle)
    velocity = np.where(some, np.exp(high[:, 0]), np.nan)
    return velocity, np.where(some, _error(column, high)[:, 0], np.nan)


def _error(column: Scene, log_velocity: Array) -> Array:
    """Return the relative error of a velocity: that of the stiffness over its logarithmic derivative.

    It is not known where both critical stiffnesses meet.
    """
    tau, spring = column.foundation.retardation_time, column.drive.stiffness
    near = [
        onsets(numbers(column.at(np.exp(log_velocity + step))), tau) for step in (-NEARBY, NEARBY)
    ]
    found = []
    for low, high in zip(*near, strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            steepness = np.abs(np.log(high.stiffness / low.stiffness)) / (2.0 * NEARBY)
            distance = np.abs(np.log(low.stiffness / spring))
            found.append((distance, low.error / steepness))
    (of_lower, lower), (of_upper, upper) = found
    error = np.where(of_lower < of_upper, lower, upper) + 4.0 * 2.0**-52 * np.abs(log_velocity)
    return np.where(np.isfinite(error), error, np.inf)
