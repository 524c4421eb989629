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

At low and at high velocity a cylinder of the radius R has the forces of the ball if its half length at rest
is (9 pi/32) a, with a that of the ball, and its width (4/3)(32/(9 pi))^2 a sqrt(R'/R) (derivations F20, F1):
two numbers satisfy four limits. In between the difference is small.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike, NDArray

from kvtheory.results import STEADY_UNITS, Certificate, SteadyState
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import ball_stiffness
from kvtheory.theory import closed_forms as cf
from kvtheory.theory.powers import converge

Array = NDArray[np.float64]

NEAR = 1.0
"""Largest l for the closed form of T: cancellation costs a bit of the sums that contain T."""
NODES = 24
"""Nodes of Gauss's rule for the integral from -1 to 1, whose error is below rounding from l = 1 on."""
RULE = [
    (v * v, 2.0 * weight * (1.0 - v * v) ** 2)
    for v, weight in zip(*(half[NODES // 2 :].tolist() for half in leggauss(NODES)), strict=True)
]
"""v^2 and weight of its nodes v > 0."""

MOST_STEPS, LAST_STEP = 12, 1e-5
"""Most iterations, of which three to five are needed; a step as small as this leaves an error of its cube."""
CERTIFICATE = Certificate(
    kind="estimated",
    statement="closed forms and a well-conditioned root in double precision; twice the worst "
    "difference to ball arithmetic on thousands of scenes over 24 decades of velocity",
    relative_error=dict.fromkeys(STEADY_UNITS, 16 * float(np.finfo(float).eps)),  # 3.6e-15
)
OWN_ERRORS = ()

SHORTER = 9.0 * math.pi / 32.0
WIDTH = 4.0 / 3.0 / SHORTER**2
"""At rest: half length of the equivalent line over the ball's, and its width over the ball's half width."""
LOAD_ERROR, FRICTION_COEFFICIENT_ERROR = 0.002, 0.0025
"""The largest differences relative to the ball, rounded up from 0.00192 and 0.00236."""


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities at |V| in the order of `STEADY_UNITS`, forces in N (derivations F20)."""
    R, stretch, K = scene.indenter.radius, scene.indenter.stretch, scene.foundation.stiffness
    l_r = abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    delta = depth(scene)
    a = np.sqrt(2.0 * R * delta)
    l = l_r / a
    _, tail = angle_and_tail(l)
    pressure, slope = K * delta, a / R
    force = pressure * a * (a * stretch)
    return (
        delta, a, l_r, -a, a * cf.trailing_edge_ratio(l),
        force * cf.ball_load_factor(l, tail),
        force * (slope * cf.ball_friction_force_factor(l, tail)),
        slope * cf.ball_friction_coefficient_factor(l, tail),
        pressure * cf.peak_pressure_factor(l),
        cf.ball_dissipated_in_contact(l, tail),
    )  # fmt: skip


def depth(scene: Scene) -> Any:
    """Return the indentation depth: that of the support, or where the load is carried."""
    R, load = scene.indenter.radius, scene.support.weight
    if scene.held:
        return scene.support.depth
    stiffness = ball_stiffness(scene.foundation.stiffness, R, scene.indenter.stretch)
    delta_0 = np.sqrt(load / stiffness)
    l_r = abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    s = scaled_root(l_r / np.sqrt(2.0 * R * delta_0), scene.support.spring * (delta_0 / load))
    return s * s * delta_0


def angle_and_tail(l: Any) -> tuple[Any, Any]:
    """Return theta = arctan(1/l) and T to a few units in the last place of pi + T, for l >= 0."""
    if not (isinstance(l, np.ndarray) and l.ndim):
        number = float(l)
        angle = math.atan2(1.0, number)
        return angle, cf.ball_tail(number, angle) if number <= NEAR else _integrated_tail(number)
    theta, far = np.arctan2(1.0, l), l > NEAR
    tail: Array = cf.ball_tail(np.minimum(l, NEAR), theta)
    tail[far] = _integrated_tail(l[far])
    return theta, tail


def _integrated_tail(l: Any) -> Any:
    square = 1.0 / (l * l)
    return sum(weight / (1.0 + square * node) for node, weight in RULE) / l


def scaled_root(drive_number: Array, support_number: Array) -> Array:
    """Solve f(s) + kappa (s^2 - 1) = 1 for s in (0, 1], by Halley in logarithms from between its limits."""
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


@dataclass(frozen=True)
class Footprint:
    """The contact area of a ball in steady sliding: a disc, cut at the rear where the pressure vanishes.

    Lengths in m, `stiffness` in N/m^3. `retardation_length` has the sign of the velocity, along whose
    direction the foundation moves through x; y is across, up to the `half_width` a sqrt(R'/R).
    """

    radius: float
    stiffness: float
    half_length: float
    half_width: float
    retardation_length: float

    def edges(self, y: ArrayLike) -> tuple[Array, Array]:
        """Return leading and trailing edge of the strips at y, as x; NaN outside the contact.

        With the half length A = sqrt(a^2 - y^2 R/R') of a strip, for V > 0 they are -A and
        sqrt(A^2 + l_r^2) - l_r (derivation F20-load).

        >>> found = Footprint(0.01, 1e10, 4e-3, 4e-3, 3e-3)
        >>> [edge.round(6).tolist() for edge in found.edges([0.0, 4e-3, 5e-3])]
        [[-0.004, -0.0, nan], [0.002, 0.0, nan]]
        """
        share = np.asarray(y, dtype=float) / self.half_width
        inside = np.abs(share) <= 1.0
        A = self.half_length * np.sqrt(np.where(inside, (1.0 - share) * (1.0 + share), np.nan))
        l_r, side = abs(self.retardation_length), math.copysign(1.0, self.retardation_length)
        beyond = np.hypot(A, l_r) + l_r
        return -side * A, side * A * (A / np.where(beyond > 0.0, beyond, 1.0))

    def pressure(self, x: ArrayLike, y: ArrayLike) -> Any:
        """Return the pressure in Pa, zero outside; x and y broadcast.

        p = K (A^2 - x^2 - 2 l_r x)/(2 R) between the edges.

        >>> float(Footprint(1.0, 2.0, 1.0, 1.0, 0.5).pressure(-0.5, 0.0))
        1.25
        """
        x = np.asarray(x, dtype=float)
        leading, trailing = self.edges(y)
        inside = (x >= np.minimum(leading, trailing)) & (x <= np.maximum(leading, trailing))
        rise = leading * leading - x * x - 2.0 * self.retardation_length * x
        return np.where(inside, 0.5 * self.stiffness / self.radius * rise, 0.0)


def equivalent_line(ball: SteadyState, stretch: float) -> tuple[float, float, float]:
    """Return width, depth and load per unit width of a line contact equivalent to a ball in steady sliding.

    It has the radius R; `stretch` is sqrt(R'/R), 1 for a ball. The friction coefficient is that of the ball,
    within `FRICTION_COEFFICIENT_ERROR`, at every velocity if the depth is kept; under a dead weight depth and
    width change with velocity.

    >>> import kvtheory as kv
    >>> ball = kv.steady(kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg")))
    >>> print("{:.4g} m, {:.4g} m, {:.4g} N/m".format(*equivalent_line(ball, 1.0)))
    0.0019 m, 4.832e-05 m, 5161 N/m
    """
    width = WIDTH * ball.half_length * stretch
    return width, SHORTER**2 * ball.depth, ball.load / width
