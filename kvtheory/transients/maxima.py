"""When the forces of a solved transient are largest."""

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import NDArray

from kvtheory.transients import states
from kvtheory.transients.continuum import Motion

Array = NDArray[np.float64]

SAMPLES = 5
"""On each step."""
DEGREE = 16
"""Of the polynomial through a force on one step: twice that of the depth, for a force is not one."""
SAME_FORCE = 1e-10
"""Relative; of forces as equal as this, as in steady sliding, the first is the largest."""


def force_maxima(motion: Motion) -> tuple[float, float]:
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


def _turns(motion: Motion, a: Array, b: Array) -> Array:
    """Return the times within steps from `a` to `b` at which a force is stationary.

    The variable x is one in which the square roots that an edge begins or ends with are smooth.
    """
    x = 0.5 - 0.5 * np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    forces = _forces(motion, a[:, None] + (b - a)[:, None] * (x * x * (3.0 - 2.0 * x)))
    found: list[float] = []
    for start, span, samples in zip(a, b - a, np.moveaxis(forces, 1, 0), strict=True):
        for force in samples:
            slope = Chebyshev.fit(x, force, DEGREE, [0.0, 1.0]).deriv()
            roots = np.asarray(slope.roots(), dtype=complex)
            t = roots.real[(roots.imag == 0.0) & (roots.real > 0.0) & (roots.real < 1.0)]
            found += (start + span * t * t * (3.0 - 2.0 * t)).tolist()
    return np.array(found)


def _forces(motion: Motion, s: Array) -> Array:
    """Return f_z and |f_x|, each of the shape of `s`."""
    found = motion.states(s.reshape(-1))[:, [states.NORMAL_FORCE, states.FRICTION_FORCE]]
    return np.abs(found.T.reshape(2, *s.shape))
