"""The transient of a ball by the memory (F8) as it stands, on a sheet of points: no contact, no edges.

Scaled form: lengths along by a_0, across by b_0 = a_0 sqrt(R'/R), depths by delta_0, times by tau, forces by
W_0 = (pi/2) K a_0 b_0 delta_0. There are `points` in a half length, and as many across.
"""

import math

import numpy as np

from tests.transient_history import Scene
from tests.transient_reference import elements


def sheet(pieces, epsilon, kappa, points, step):
    """Return s, d and f_z at every step; `pieces` are (end, number), from rest."""
    drive, begun = [], 0.0
    for end, number in pieces:
        drive += [(begun, number), (end, number)]
        begun = end
    scene = Scene(drive, epsilon, (0.0, begun), kappa)
    found = elements(scene, 1.0 / points, step=step, across=True)
    s, U = found["s"], found["U"]
    return s, found["d"], 2.0 / math.pi * (U + np.gradient(U, s))


def sheet_on_spring(at_rest, end, points, step):
    """Return s, d, the sliding velocity in a_0/tau and the spring force after every step, from rest."""
    number, stiffness = at_rest.drive_number, at_rest.drive_stiffness_number
    scene = Scene(
        [(0.0, number)], at_rest.inertia_number, (0.0, end), at_rest.support_number,
        at_rest.drive_inertia_number, at_rest.drive_damping_number, stiffness,
    )  # fmt: skip
    s, d, x, w, _, _ = (
        values[1:] for values in elements(scene, 1.0 / points, step=step, across=True).values()
    )
    return s, d, number - w, stiffness * x + scene.damping * w
