"""Whether steady sliding is stable if the drive holds the indenter by a spring: closed forms (theorem F22).

Small motions in the vertical and in the sliding direction, each divided by the damping of the contact, obey

    (T_z sigma^2 + sigma + S_z) (T_x sigma^2 + sigma + S_x) = g sigma (sigma + S_c)

with sigma in 1/tau. At the onset of instability Omega = omega^2, with omega the angular frequency, is a
root of a quadratic without T_x and S_x; the critical stiffness is the one with this frequency for the mass
along x.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import exact
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
    """Return the numbers of a scene that can be moved along x."""
    foundation, support, drive = scene.foundation, scene.support, scene.drive
    R, K, tau = scene.indenter.radius, foundation.stiffness, foundation.retardation_time
    a = np.sqrt(2.0 * R * exact.depth(scene))
    l = np.abs(drive.final_velocity) * tau / a
    q = cf.trailing_edge_ratio(l)
    along = K * tau * cf.damping_along(a / R, q) * R / 3.0  # dF/dV, in N s/m^2
    damped = along + drive.damping
    n_x = drive.damping / along
    unit, T_x = damped / tau, scene.drive_mass / (damped * tau)
    g, h, S_c = cf.coupling(l, q, n_x), cf.uncoupled(q, n_x), cf.coupling_rate(q)
    if scene.held:
        endless = np.full_like(q, np.inf)
        return Numbers(np.zeros_like(q), T_x, endless, S_c, g, h, endless, unit)
    across = K * tau * cf.damping_across(a, q) * (4.0 / 3.0)  # dF_z/d(ddelta/dt), in N s/m^2
    S_s = support.spring * tau / across
    return Numbers(
        T_z=support.mass / (across * tau),
        T_x=T_x,
        S_z=cf.relaxation_rate(q, S_s),
        S_c=S_c,
        g=g,
        h=h,
        e=cf.friction_rise(q, n_x, S_s),
        unit=unit,
    )


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
