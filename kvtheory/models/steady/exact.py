r"""Steady sliding of a parabolic indenter: closed forms and one scalar root.

Lengths are scaled by the half length a of the contact at rest, so that one number, l = l_r/a, determines the
contact (Eqs. 26-29, theorem F1). An indenter that can move finds its depth from the balance of forces, in
units of the static depth delta_0, half length a_0 and weight,

    f_z(s) + kappa (s^2 - 1) = 1,    s = a/a_0 in (0, 1],    d = delta/delta_0 = s^2,

with kappa = 0 for a dead weight (theorem "scaled-load"). Each term of f_z is positive and
d ln f_z/d ln s lies between 2 and 3: rounding moves the depth by a few units in the last place, over any
range of velocity.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf
from kvtheory.theory.powers import cube_root

HALLEY_STEPS = 2
"""The initial guess is within 3 % of the root; cubic convergence gives 1e-5, then all digits."""

HELD, CERTIFICATE = (
    Certificate(
        kind="estimated",
        statement="closed forms and a well-conditioned root in double precision; the sum of all rounding "
        "errors to first order, confirmed by ball arithmetic on more than ten thousand scenes over 24 "
        "decades of velocity",
        relative_error=dict.fromkeys(STEADY_UNITS, ulps * float(np.finfo(float).eps)),
    )
    for ulps in (9, 33)
)
"""2.0e-15 at a depth and 7.3e-15 at a load, where hypot is within a unit in the last place."""
OWN_ERRORS = ()
Array = NDArray[np.float64]


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities at |V| in the order of `STEADY_UNITS` (theorem F1, Eqs. 26-29).

    >>> print(", ".join(f"{value:.6g}" for value in quantities(Scene.table1("fixed"))[4:8]))
    0.00029563, 35344.6, 5344.58, 0.151214
    """
    K, R, delta = scene.foundation.stiffness, scene.indenter.radius, depth(scene)
    a = np.sqrt(2.0 * R * delta)  # Eq. 28
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time  # Eq. 29
    l = l_r / a
    q = cf.trailing_edge_ratio(l)
    pressure, slope = K * delta, a / R
    return (
        delta, a, l_r, -a, a * q,  # Eqs. 26, 27
        pressure * a * cf.load_factor(q),
        pressure * a * (slope * cf.friction_force_factor(l, q)),
        slope * cf.friction_coefficient_factor(l, q),
        pressure * cf.peak_pressure_factor(l),
        cf.dissipated_in_contact(q),
    )  # fmt: skip


def depth(scene: Scene) -> Any:
    """Return the indentation depth: that of the support, or where the load is carried."""
    support, R = scene.support, scene.indenter.radius
    if scene.held:
        return support.depth
    # weight = (4/3) K a_0 delta_0, delta_0 = a_0^2/(2 R)
    a_0 = cube_root(1.5 * R * (support.weight / scene.foundation.stiffness))
    delta_0 = a_0 * (a_0 / (2.0 * R))
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    s = scaled_root(l_r / a_0, support.spring * (delta_0 / support.weight))
    return s * s * delta_0


def scaled_root(drive_number: Array, support_number: Array) -> Array:
    """Solve f_z(s) + kappa (s^2 - 1) = 1 for s in (0, 1], by Halley's method, starting between its limits."""
    kappa = support_number
    s = np.sqrt((1.0 + kappa) / (kappa + np.hypot(1.0, 0.75 * drive_number)))
    for _ in range(HALLEY_STEPS):
        residual = cf.scaled_load(s, drive_number) + kappa * (s * s - 1.0) - 1.0
        slope = cf.scaled_load_slope(s, drive_number) + 2.0 * kappa * s
        curvature = cf.scaled_load_curvature(s, drive_number) + 2.0 * kappa
        s = s - residual / (slope - 0.5 * residual * (curvature / slope))
    return s
