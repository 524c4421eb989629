"""The part of the error budget that is due to motion along x, by theory of a disturbed scene.

Motions along x last long, and grow if steady sliding is unstable (F22), up to a cycle in which a disturbance
shifts the phase more and more. No linear response covers that, but theory of a disturbed scene does:

- the force b at an edge acts as a load that is larger by b; on a fixed indenter, whose forces are in
  proportion to the stiffness of the foundation, as one that is stiffer;
- a first-order step h damps an oscillation, or excites it, as a damper c_x = h k_x;
- the friction b a/R that goes with b acts on the spring at once: it stretches the spring, and accelerates
  the indenter.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from kvtheory.checks.theory import CURVES, Array, Curves, Theory
from kvtheory.scene.model import Fixed, Scene

QUARTER = 0.5 * math.pi
"""Of a period, in radians: a disturbed oscillation crosses the other, and is far off so much later."""
SWING = 2.0
"""A sudden force stretches a spring by up to so many times what the force does if it lasts."""


def spring_response(
    theory: Theory, now: Curves, time: Array, force: Array, step: float, rtol: float
) -> Curves:
    """Return by how much the force b (N/m) at an edge, and steps of `step` s, move each curve.

    `step` is 0 for a scheme of higher order, whose error is far smaller.
    """
    scene, static = theory.scene, theory.static
    inertia, stiffness = scene.drive_mass, float(scene.drive.stiffness or 0.0)
    span = float(time[-1] - time[0])
    lasting = float(np.trapezoid(force, time)) / span / static.load
    swing = math.sqrt(inertia / stiffness)  # the period by 2 pi, in s
    moved = {name: np.zeros_like(time) for name in CURVES}
    for other in _disturbed(scene, lasting, step):
        found = replace(theory, scene=other).at(time, rtol)
        for name in CURVES:
            moved[name] += _nearby(
                time, np.nan_to_num(np.abs(found[name] - now[name])), QUARTER * swing
            )
    kick = SWING * force * static.half_length / theory.scene.indenter.radius  # type: ignore[union-attr]
    turned = np.clip(time / swing, 0.0, 1.0)  # a force needs time to move a mass
    moved["spring_force"] += kick * turned**2
    moved["sliding_velocity"] += kick * turned * swing / inertia
    return moved


def _disturbed(scene: Scene, share: float, step: float) -> Iterator[Scene]:
    """Yield the scene with a load that is larger by a share, and with the damping of first-order steps."""
    support, foundation = scene.support, scene.foundation
    if isinstance(support, Fixed):
        factor = 1.0 + share
        yield replace(scene, foundation=foundation.plain(factor))
    else:
        yield replace(scene, support=replace(support, load=(1.0 + share) * support.weight))
    if step > 0.0:
        damping = scene.drive.damping + step * float(scene.drive.stiffness or 0.0)
        yield replace(scene, drive=scene.drive.changed(damping=damping))


def _nearby(time: Array, values: Array, reach: float) -> Array:
    """Return the largest of the values within `reach` before and after each time.

    >>> _nearby(np.arange(5.0), np.array([1.0, 0.0, 0.0, 5.0, 0.0]), 1.0).tolist()
    [1.0, 1.0, 5.0, 5.0, 5.0]
    """
    first = np.searchsorted(time, time - reach, side="left")
    after = np.searchsorted(time, time + reach, side="right")
    ends = np.stack([first, after], axis=1).reshape(-1)
    return np.asarray(np.maximum.reduceat(np.append(values, 0.0), ends)[::2])
