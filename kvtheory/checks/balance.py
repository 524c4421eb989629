r"""The impulse balance of the data themselves (Eq. 17), without differentiating noisy data.

For a test function phi that vanishes at both ends of a window with its derivative, partial integration
of M z'' = F_z - W - k_s (z - z_0), with z = -delta, gives

    int phi'' M delta dt = int phi (W - F_z - k_s (delta - delta_0)) dt.

The difference of both sides, over int phi dt, is the mean force that is missing in the data.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from kvtheory.checks.theory import Array
from kvtheory.scene.model import Support

SHORTEST_WINDOW = 16
"""Samples: phi'' has to be resolved."""
OVERLAP = 2
"""Windows start at every half of their length."""
LONGEST_WINDOWS = 6
"""Lengths tried, each half the one before, from the whole series down."""


class Window(NamedTuple):
    """The samples from `start` to `stop`, weights of force and inertia, and int phi dt."""

    start: int
    stop: int
    force: Array
    inertia: Array
    impulse: float


def windows(time: Array) -> Iterator[Window]:
    """Yield windows of falling lengths with phi = (1 - s^2)^3, s from -1 to 1.

    The weights of the inertia give exactly nothing for a uniform motion, as the integral does.
    """
    size = time.size
    for halving in range(LONGEST_WINDOWS):
        length = size >> halving
        if length < SHORTEST_WINDOW:
            return
        for start in range(0, size - length + 1, max(length // OVERLAP, 1)):
            t = time[start : start + length]
            half = 0.5 * (t[-1] - t[0])
            if half <= 0.0:
                continue
            s = (t - t[0]) / half - 1.0
            rest = 1.0 - s * s
            weight = np.gradient(t)  # of the trapezoidal rule: phi is zero at both ends
            bend = weight * 6.0 * rest * (5.0 * s * s - 1.0) / half**2
            line = np.stack([np.ones_like(s), s])
            bend -= weight * (np.linalg.solve((line * weight) @ line.T, line @ bend) @ line)
            force = weight * rest**3
            yield Window(start, start + length, force, bend, float(force.sum()))


def missing_force(
    window: Window, columns: Mapping[str, Array], support: Support, depth_0: float
) -> float:
    """Return the mean force in N/m that is missing from the balance in a window."""
    part = slice(window.start, window.stop)
    depth = columns["depth"][part] - depth_0
    spring = support.spring
    force = support.weight - columns["normal_force"][part] - spring * depth
    gained = support.mass * float(window.inertia @ depth)
    return (gained - float(window.force @ force)) / window.impulse


def random_part(window: Window, sigma_depth: Array, sigma_force: Array, mass: float) -> float:
    """Return the standard error of `missing_force` from noise in the depth and the force."""
    inertia = mass * float(np.linalg.norm(sigma_depth * window.inertia))
    force = float(np.linalg.norm(sigma_force * window.force))
    return float(np.hypot(inertia, force)) / window.impulse
