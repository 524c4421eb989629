"""When the forces of a solved transient are largest."""

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from kvtheory.models.continuum import evaluation
from kvtheory.models.continuum.solver import Trajectory

Array = NDArray[np.float64]

SAMPLES = 5
"""On each step."""
DEGREE = 16
"""Of the polynomial through a force on one step: twice that of the depth, for a force is not one."""
NODES = chebyshev.chebpts1(DEGREE + 1)
TO_SLOPE = (
    np.linalg.inv(chebyshev.chebvander(NODES, DEGREE)).T @ chebyshev.chebder(np.eye(DEGREE + 1)).T
)
"""From the force at the nodes to the Chebyshev coefficients of its slope."""
GRID, NEWTON_STEPS = np.linspace(-1.0, 1.0, 65), 5
"""Where the slope changes its sign between two of these points, Newton's method finds its root."""
SAME_FORCE = 1e-10
"""Relative; of forces as equal as this, as in steady sliding, the first is the largest."""


def force_maxima(motion: Trajectory) -> tuple[float, float]:
    """Return when f_z and |f_x| are largest: the first time of the largest value from s = 0 on.

    It is an end of a step, before or after a jump there, or a stationary point of the polynomial
    through the force on the step; on steps whose samples come near enough to the largest.
    """
    starts = np.array(motion.starts)
    ends = np.append(np.nextafter(starts[1:], 0.0), motion.end)
    parts = np.linspace(0.0, 1.0, SAMPLES)
    samples = _forces(motion, starts[:, None] + (ends - starts)[:, None] * parts)
    largest, least = samples.max(axis=2), samples.min(axis=2)
    enough = (1.0 - SAME_FORCE) * largest.max(axis=1, keepdims=True)
    near = np.any(2.0 * largest - least >= enough, axis=0)
    found = _turns(motion, starts[near], ends[near])
    times = np.sort(np.concatenate([starts[near], found, ends[near]]))
    forces = _forces(motion, times)
    first = np.argmax(forces >= (1.0 - SAME_FORCE) * forces.max(axis=1, keepdims=True), axis=1)
    normal, friction = times[first].tolist()
    return normal, friction


def _turns(motion: Trajectory, a: Array, b: Array) -> Array:
    """Return the times within steps from `a` to `b` at which a force is stationary.

    They are the roots of the slope of the polynomial through the force, over a variable x in which the
    square roots that an edge begins or ends with are smooth.
    """
    forces = _forces(motion, a[:, None] + (b - a)[:, None] * _share(NODES))
    slopes = (forces.reshape(-1, DEGREE + 1) @ TO_SLOPE).T
    row, k = np.nonzero(np.diff(np.sign(chebyshev.chebval(GRID, slopes)), axis=1))
    low, high, slopes = GRID[k], GRID[k + 1], slopes[:, row]
    curvatures, x = chebyshev.chebder(slopes), 0.5 * (low + high)
    for _ in range(NEWTON_STEPS if x.size else 0):
        curvature = chebyshev.chebval(x, curvatures, tensor=False)
        step = chebyshev.chebval(x, slopes, tensor=False) / np.where(curvature, curvature, np.inf)
        x = np.clip(x - step, low, high)
    owner = row % a.size
    return np.asarray(a[owner] + (b - a)[owner] * _share(x))


def _share(x: Array) -> Array:
    """Return the share of a step at x in [-1, 1]."""
    y = 0.5 * (1.0 + x)
    return y * y * (3.0 - 2.0 * y)


def _forces(motion: Trajectory, s: Array) -> Array:
    """Return f_z and |f_x|, each of the shape of `s`."""
    inside = np.minimum(s.reshape(-1), motion.end)  # beyond it by rounding
    found = motion.states(inside)[:, [evaluation.NORMAL_FORCE, evaluation.FRICTION_FORCE]]
    return np.abs(found.T.reshape(2, *s.shape))
