"""Small motions of a parabola on G = K + C delta(t) + sum K_i e^(-t/tau_i), from histories of its elements.

The pressure of an element is that of its history since it met the indenter, p = K u + C u' + sum K_i int
e^(-(t - t')/tau_i) u' dt', by Gauss's rule; both edges are found anew at each state, where u and where p
vanish. Derivatives of the forces are differences between two motions. Nothing is shared with the package.
"""

import numpy as np
from scipy.optimize import brentq

NODES, WEIGHTS = np.polynomial.legendre.leggauss(48)
NODES, WEIGHTS = 0.5 + 0.5 * NODES, 0.5 * WEIGHTS
SMALL = 2e-5
"""Amplitude of a motion, over depth or half length."""


def forces(foundation, R, V, depth, along):
    """Return F_z and F_x at t = 0 of motions that give value and rate at times t <= 0."""
    arms = [(arm.stiffness, arm.relaxation_time) for arm in foundation.arms]
    leading = -np.sqrt(2 * R * depth(0.0)[0])

    def overlap(x, age):
        """u and u' at the time -age of the element that is at x now."""
        place = x - V * age + along(0.0)[0] - along(-age)[0]
        height, speed = depth(-age), V - along(-age)[1]
        return height[0] - place * place / (2 * R), height[1] - place / R * speed

    def pressure(x):
        age = np.maximum((x - leading) / V, 0.0)
        for _ in range(60):  # since when it has been in contact
            u, rate = overlap(x, age)
            age = np.maximum(
                age + np.where(rate > 0.0, u / np.where(rate > 0.0, rate, 1.0), 0.0), 0.0
            )
        u, rate = overlap(x, 0.0 * x)
        p = foundation.stiffness * u + foundation.damping * rate
        for stiffness, time in arms:
            ages = age[:, None] * NODES
            fading = np.exp(-ages / time) * overlap(x[:, None], ages)[1]
            p = p + stiffness * age * (fading @ WEIGHTS)
        return p

    trailing = brentq(
        lambda x: pressure(np.array([x]))[0], 0.0, -1.2 * leading, xtol=1e-18, rtol=1e-15
    )
    x = leading + (trailing - leading) * NODES
    p = (trailing - leading) * WEIGHTS * pressure(x)
    return np.array([p.sum(), -(p @ x) / R])


def response(foundation, R, V, d, omega):
    """Return the forces F_z1, F_x1 over delta_1, and those over X_1, of motions e^(i omega t)."""

    def still(value):
        return lambda t: (value + 0.0 * t, 0.0 * t)

    def wave(mean, size, phase):
        return lambda t: (
            mean + size * np.cos(omega * t + phase), -size * omega * np.sin(omega * t + phase)
        )  # fmt: skip

    found = []
    for size, vertical in ((SMALL * d, True), (SMALL * np.sqrt(2 * R * d), False)):
        parts = []
        for phase in (0.0, -0.5 * np.pi):  # the real and the imaginary part
            ends = []
            for step in (size, -size):
                motion = wave(d, step, phase), still(0.0)
                motion = motion if vertical else (still(d), wave(0.0, step, phase))
                ends.append(forces(foundation, R, V, *motion))
            parts.append((ends[0] - ends[1]) / (2 * size))
        found.append(parts[0] + 1j * parts[1])
    return found


def stiffness(scene, depth, omega):
    """Return the stiffness along x for which i omega is a rate: real at the onset of instability."""
    V, support = float(scene.drive.velocity), scene.support
    (A, C), (B, D) = response(scene.foundation, scene.indenter.radius, V, depth, omega)
    s = 1j * omega
    along = D - s * (scene.drive_mass * s + scene.drive.damping)
    return along if scene.held else along - B * C / (support.mass * s * s + support.spring + A)
