r"""Whether steady sliding is stable if the drive holds the indenter by a spring: closed forms (theorem F22).

Small motions in the vertical and in the sliding direction, each divided by the damping of the contact, obey

    (T_z sigma^2 + sigma + S_z) (T_x sigma^2 + sigma + S_x) = g sigma (sigma + S_c)

with sigma in 1/tau. At the onset of instability Omega = omega^2, with omega the angular frequency, is a
root of a quadratic without T_x and S_x; the critical stiffness is the one with this frequency for the mass
along x.

Per unit width a strip of half length A, with x_TE = sqrt(A^2 + l_r^2) - l_r, has

    dW/d(delta) = K (A + x_TE + l_r),                 dF/d(delta) = K (l_r/R) (A + x_TE),
    dW/d(ddelta/dt) = K tau (A + x_TE),               dF/dV = K tau (A^3 + x_TE^3)/(3 R^2),
    dW/dV = dF/d(ddelta/dt) = K tau (l_r/R) x_TE.

A parabola is one strip, a ball the sum of its strips. Strips that the motion lifts off or presses down carry
nothing to first order. With l = l_r/a and the tail T of the load of a ball (derivation F20-tail), the sums
on either side of its middle plane are, in units of a and a^3 (derivation F20-slopes),

    A_1 = pi/4,    X_1 = (l/3 + T/4)/(1 + l^2),    A_3 = 3 pi/16,    X_3 = (3 T (1 + 5 l^2)/16 - l)/(1 + l^2).

X_3 loses digits for l >> 1, where it does not count beside A_3.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import ball, exact
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf

Array = NDArray[np.float64]

ROUNDING = 2.0 * 2.0**-52
"""Relative error of each number of the rates; what follows from it for results is at least three times what
the comparison with 80 digits has shown on five hundred scenes."""


class Numbers(NamedTuple):
    """The numbers of the rates (theorem F22-numbers); `unit` is the stiffness in N/m^2 of S_x = 1.

    For a fixed indenter, which cannot move vertically, T_z is 0 and S_z infinite.
    """

    T_z: Array
    T_x: Array
    S_z: Array
    S_c: Array
    g: Array
    h: Array
    e: Array
    unit: Array


class Onset(NamedTuple):
    """A stiffness in N/m^2 at which stability is lost, the frequency in Hz there, and the error of both.

    Where there is none they are NaN.
    """

    stiffness: Array
    frequency: Array
    error: Array


def numbers(scene: Scene) -> Numbers:
    """Return the numbers of a scene that can be moved along x: a parabola, or a ball, with `unit` in N/m."""
    foundation, support, drive = scene.foundation, scene.support, scene.drive
    R, tau = scene.indenter.radius, foundation.retardation_time
    line = scene.indenter.per_width
    a = np.sqrt(2.0 * R * (exact if line else ball).depth(scene))
    l = np.abs(drive.final_velocity) * tau / a
    unit = foundation.stiffness * a
    if line:
        X_1 = cf.trailing_edge_ratio(l)
        A_1, A_3, X_3 = 1.0, 1.0, X_1 * X_1 * X_1
    else:
        _, T = ball.angle_and_tail(l)
        A_1, A_3 = np.pi / 4.0, 3.0 * np.pi / 16.0
        X_1, X_3 = cf.ball_trailing_edges(l, T), cf.ball_cubed_trailing_edges(l, T)
        unit = unit * 2.0 * a * scene.indenter.stretch
    along = tau * unit * (a / R) ** 2 * ((A_3 + X_3) / 3.0)  # dF/dV
    across = tau * unit * (A_1 + X_1)  # dW/d(ddelta/dt)
    damped = along + drive.damping
    T_x = scene.drive_mass / (damped * tau)
    S_c = (A_1 + X_1) / X_1
    g = l * X_1 / (A_1 + X_1) * (3.0 * l * X_1 / (A_3 + X_3)) * (along / damped)
    if scene.held:
        endless = np.full_like(g, np.inf)
        return Numbers(np.zeros_like(g), T_x, endless, S_c, g, 1.0 - g, endless, damped / tau)
    T_z = support.mass / (across * tau)
    S_z = (A_1 + X_1 + l) / (A_1 + X_1) + support.spring * tau / across
    return Numbers(T_z, T_x, S_z, S_c, g, 1.0 - g, S_z - g * S_c, damped / tau)


def onsets(given: Numbers, tau: Array) -> tuple[Onset, Onset]:
    """Return between which stiffnesses steady sliding is unstable: the lower one and the upper one.

    Where friction falls with the velocity, every softer spring is unstable: the lower one is then 0.
    """
    T_z, T_x, S_z, S_c, g, h, e, unit = given
    with np.errstate(invalid="ignore", divide="ignore"):  # of a fixed indenter, which is stable
        square, n = (form(T_z, g, S_c, h, e) for form in (cf.onset_square, cf.onset_sum))
        falls = e < 0.0
        some = falls | ((n < 0.0) & (square >= 0.0))
        s = np.sqrt(np.where(some, square, np.nan))
        error = _error(given, s, n)
        slow = -2.0 * S_z * e / (s + n)  # of a light indenter; else there is no difference below
        Omega = np.where(n > 0.0, slow, (s - n) / (2.0 * T_z * T_z))
        lag = cf.onset_lag(T_z, g, S_c, h, S_z, s)
        upper = Onset(unit * cf.onset_stiffness(T_x, S_c, Omega, lag), _hertz(Omega, tau), error)
        Omega = 2.0 * S_z * e / (s - n)
        lag = cf.onset_lag_of_lower(T_z, g, S_c, h, s)
        stiffness = unit * cf.onset_stiffness(T_x, S_c, Omega, lag)
        stiffness, frequency = (np.where(falls, 0.0, x) for x in (stiffness, _hertz(Omega, tau)))
    return Onset(stiffness, frequency, np.where(falls, 0.0, error)), upper


def _hertz(Omega: Array, tau: Array) -> Array:
    return np.sqrt(Omega) / (2.0 * np.pi * tau)


def _error(given: Numbers, s: Array, n: Array) -> Array:
    """Return the relative error of the roots by rounding, to first order, with a safety factor of two.

    It grows without bound at a maximum or minimum of friction, and where both roots coincide.
    """
    T_z, _, S_z, S_c, g, h, e, _ = given
    m = h - T_z * g * S_c
    of_m, of_e = h + T_z * g * S_c, S_z + g * S_c
    of_s = np.abs(m) * of_m / s + 2.0 * h * T_z * (of_e + np.abs(e)) / s
    of_sum = (of_s + of_m + 2.0 * T_z * of_e) / s
    return 2.0 * ROUNDING * (4.0 + of_sum + np.where(n > 0.0, of_e / np.abs(e), 0.0))


def is_stable(stiffness: Array, lower: Onset, upper: Onset) -> Any:
    """Return whether a stiffness is outside the interval in which steady sliding is unstable."""
    return ~((stiffness >= lower.stiffness) & (stiffness <= upper.stiffness))
