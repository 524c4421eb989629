r"""Steady sliding of a ball: its strips along x are parabolas, and their sums are closed forms.

A strip at y has the depth delta - y^2/(2R') and the half length sqrt(a^2 - y^2 R/R'). With l = l_r/a and
theta = arctan(1/l) the sums over all strips (derivations F20) are

    W = sqrt(R'/R) K delta a^2 (pi + 16 l/3 + T)/4,    F = (a/R) sqrt(R'/R) K delta a^2 l (pi + T)/4,
    T = 2 (1 + l^2)^2 theta - 2 l^3 - 10 l/3 = 2 l int_0^1 (1 - v^2)^2/(l^2 + v^2) dv.

T is positive and falls from pi to 0. Its closed form cancels for l >> 1, where the integral takes its place
(derivation F20-tail). The contact is a disc, cut at the rear by the line on which the pressure vanishes; half
length, edges and peak pressure are those of the middle plane. The half width is a sqrt(R'/R).

An indenter that can move finds its depth from f(s) + kappa (s^2 - 1) = 1 in units of its static state, as a
cylinder does, with s = a/a_0 and d ln f/d ln s between 3 and 4 (derivation F20-balance).
"""

from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from kvtheory.models.steady.roots import converge
from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import ball_stiffness
from kvtheory.theory import closed_forms as cf

Array = NDArray[np.float64]

NEAR = 1.0
"""Largest l for the closed form of T: it loses a bit of what T is added to."""
NODES = 24
"""Of Gauss's rule for the integral from -1 to 1: its error is below rounding from l = 1 on."""
V, WEIGHTS = (half[NODES // 2 :] for half in leggauss(NODES))
SQUARES, WEIGHTS = V * V, 2.0 * WEIGHTS * (1.0 - V * V) ** 2

MOST_STEPS, LAST_STEP = 12, 1e-5
"""Most iterations, of which three to five are needed; a step as small as this leaves an error of its cube."""
CERTIFICATE = Certificate(
    kind="estimated",
    statement="closed forms and a well-conditioned root in double precision; twice the worst "
    "difference to ball arithmetic on thousands of scenes over 24 decades of velocity",
    relative_error=dict.fromkeys(STEADY_UNITS, 16 * float(np.finfo(float).eps)),  # 3.6e-15
)
OWN_ERRORS = ()


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities at |V| in the order of `STEADY_UNITS`, forces in N (derivations F20).

    >>> from kvtheory.scene import DeadWeight, Sphere
    >>> found = quantities(Scene(Sphere(0.01), support=DeadWeight(mass=1.0)))
    >>> print(f"{1e3 * found[0]:.6f} mm, mu = {found[7]:.6f}")
    0.061896 mm, mu = 0.063679
    """
    R, stretch, K = scene.indenter.radius, scene.indenter.stretch, scene.foundation.stiffness
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    delta = depth(scene)
    a = np.sqrt(2.0 * R * delta)
    l = l_r / a
    _, tail = angle_and_tail(l)
    pressure, slope = K * delta, a / R
    force = pressure * a * (a * stretch)
    return (
        delta,
        a,
        l_r,
        -a,
        a * cf.trailing_edge_ratio(l),
        force * cf.ball_load_factor(l, tail),
        force * (slope * cf.ball_friction_force_factor(l, tail)),
        slope * cf.ball_friction_coefficient_factor(l, tail),
        pressure * cf.peak_pressure_factor(l),
        cf.ball_dissipated_in_contact(l, tail),
    )


def depth(scene: Scene) -> Any:
    """Return the indentation depth: that of the support, or where the load is carried."""
    R, load = scene.indenter.radius, scene.support.weight
    if scene.held:
        return scene.support.depth
    stiffness = ball_stiffness(scene.foundation.stiffness, R, scene.indenter.stretch)
    delta_0 = np.sqrt(load / stiffness)
    l_r = np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    s = scaled_root(l_r / np.sqrt(2.0 * R * delta_0), scene.support.spring * (delta_0 / load))
    return s * s * delta_0


def angle_and_tail(l: Any) -> tuple[Any, Any]:
    """Return theta = arctan(1/l) and T to a few units in the last place of pi + T, for l >= 0.

    >>> angle_and_tail(np.array([0.0, 1e8]))[1].round(12).tolist()
    [3.14159265359, 1.0667e-08]
    """
    l = np.asarray(l)
    near, far = np.minimum(l, NEAR), l > NEAR
    tail = np.asarray(cf.ball_tail(near, np.arctan2(1.0, near)))
    if far.any():
        large = l[far]
        square, total = 1.0 / (large * large), np.zeros_like(large)
        for node, weight in zip(SQUARES, WEIGHTS, strict=True):
            total += weight / (1.0 + square * node)
        tail[far] = total / large
    return np.arctan2(1.0, l), tail[()]


def scaled_root(drive_number: Array, support_number: Array) -> Array:
    """Solve f(s) + kappa (s^2 - 1) = 1 for s = a/a_0 in (0, 1], by Halley's method in logarithms.

    The first guess interpolates between the limits f -> s^4 and 8 lambda s^3/(3 pi).
    """
    lam, kappa = drive_number, support_number

    def step(s: Array) -> Array:
        theta, tail = angle_and_tail(lam / s)
        held = kappa * s * s
        total = cf.ball_scaled_load(s, lam, tail) + held
        rise = (cf.ball_scaled_load_slope(s, lam, theta) + 2.0 * held) / total
        curve = (cf.ball_scaled_load_curvature(s, lam, theta) + 4.0 * held) / total - rise * rise
        off = np.log(total / (1.0 + kappa))
        return off / (rise - 0.5 * off * (curve / rise))

    first = np.cbrt((1.0 + kappa) / (1.0 + kappa + lam * (8.0 / (3.0 * np.pi))))
    return converge(step, first, LAST_STEP, MOST_STEPS)
