r"""Stability of steady sliding on Kelvin-Voigt, on a spring in the drive: closed forms (theorem F22).

Small motions in the vertical and in the sliding direction, each divided by the damping of the contact, obey

    (T_z sigma^2 + sigma + S_z) (T_x sigma^2 + sigma + S_x) = g sigma (sigma + S_c)

with sigma in 1/tau. At the onset of instability Omega = omega^2, with omega the angular frequency, is a
root of a quadratic without T_x and S_x; the critical stiffness is the one with this frequency for the mass
along x. With a rigid drive only the first factor is left (theorem F12).

Per unit width a strip of half length A, with x_TE = sqrt(A^2 + l_r^2) - l_r, has

    dW/d(delta) = K (A + x_TE + l_r),                 dF/d(delta) = K (l_r/R) (A + x_TE),
    dW/d(ddelta/dt) = K tau (A + x_TE),               dF/dV = K tau (A^3 + x_TE^3)/(3 R^2),
    dW/dV = dF/d(ddelta/dt) = K tau (l_r/R) x_TE.

A parabola is one strip, a ball the sum of its strips. Strips that the motion detaches or attaches carry
nothing to first order. With l = l_r/a and the tail T of the load of a ball (derivation F20-tail), the sums
on either side of its middle plane are, in units of a and a^3 (derivation F20-slopes),

    A_1 = pi/4,    X_1 = (l/3 + T/4)/(1 + l^2),    A_3 = 3 pi/16,    X_3 = (3 T (1 + 5 l^2)/16 - l)/(1 + l^2).

X_3 loses digits for l >> 1, where it is negligible beside A_3.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval
from numpy.typing import NDArray

from kvtheory.models.steady import ball, exact
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf

Array = NDArray[np.float64]

STATEMENT = (
    "closed forms (theorem F22) in double precision, with first-order bounds of rounding; "
    "rates from their polynomial; velocity by bisection on the critical stiffness"
)
ROUNDING = 2.0 * 2.0**-52
"""Relative error of each coefficient. The errors of results that follow from it are at least three times
those found by comparison with 80 digits on five hundred scenes."""
POLISHES = 3
"""Newton steps after the eigenvalues of the companion matrix, which lose digits of the slow rates."""
DECADES, PER_DECADE = (-8.0, 20.0), 16
"""Powers of ten of the drive number V tau/a_0 between which the critical velocity is searched for."""
BISECTIONS = 50
"""Enough to find a velocity in a cell of the grid to the last digit."""
NEARBY = 1e-5
"""Relative step of velocity in the difference quotient of the critical stiffness."""
SOFT, UNSTABLE, STIFF, NEVER = -1, 0, 1, 2
"""Spring stiffness below both critical ones, between them, above both; or no critical stiffness exists."""


class Onset(NamedTuple):
    """A critical stiffness in N/m^2, the frequency there in Hz, and their relative error; NaN without one."""

    stiffness: Array
    frequency: Array
    error: Array


class SmallMotions:
    """The coefficients of the small motions of flat scenes (theorem F22-numbers).

    `unit` is the stiffness in N/m^2 (of a ball in N/m) for which S_x = 1. A fixed indenter cannot move
    vertically: T_z is 0 and S_z infinite.
    """

    def __init__(self, scene: Scene) -> None:
        foundation, support, drive = scene.foundation, scene.support, scene.drive
        R, tau = scene.indenter.radius, foundation.retardation_time
        line, self.held = scene.indenter.per_width, scene.held
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
        T_x, S_c = scene.drive_mass / (damped * tau), (A_1 + X_1) / X_1
        g = l * X_1 / (A_1 + X_1) * (3.0 * l * X_1 / (A_3 + X_3)) * (along / damped)
        T_z, S_z = 0.0, np.inf
        if not self.held:
            T_z = support.mass / (across * tau)
            S_z = (A_1 + X_1 + l) / (A_1 + X_1) + support.spring * tau / across
        e = S_z - g * S_c  # its sign is that of dF/dV + c_x
        self.unit, self.tau, self.T_z, self.T_x, self.S_z, self.S_c, self.g, self.h, self.e = (
            np.broadcast_arrays(damped / tau, tau, T_z, T_x, S_z, S_c, g, 1.0 - g, e)
        )

    def onsets(self) -> tuple[Onset, Onset]:
        """Return lower and upper critical stiffness; the lower is 0 where friction falls with velocity."""
        T_z, T_x, S_z, S_c, g, h, e = (
            self.T_z, self.T_x, self.S_z, self.S_c, self.g, self.h, self.e,
        )  # fmt: skip
        with np.errstate(invalid="ignore", divide="ignore"):  # of a fixed indenter, which is stable
            square, n = (form(T_z, g, S_c, h, e) for form in (cf.onset_square, cf.onset_sum))
            falls = e < 0.0
            some = falls | ((n < 0.0) & (square >= 0.0))
            s = np.sqrt(np.where(some, square, np.nan))
            # Rounding to first order: without bound at an extremum of friction, and at a double root.
            m, of_m, of_e = h - T_z * g * S_c, h + T_z * g * S_c, S_z + g * S_c
            of_s = np.abs(m) * of_m / s + 2.0 * h * T_z * (of_e + np.abs(e)) / s
            of_sum = (of_s + of_m + 2.0 * T_z * of_e) / s
            error = 2.0 * ROUNDING * (4.0 + of_sum + np.where(n > 0.0, of_e / np.abs(e), 0.0))
            slow = -2.0 * S_z * e / (s + n)  # without cancellation, of a light indenter
            Omega = np.where(n > 0.0, slow, (s - n) / (2.0 * T_z * T_z))
            lag = cf.onset_lag(T_z, g, S_c, h, S_z, s)
            stiffness = self.unit * cf.onset_stiffness(T_x, S_c, Omega, lag)
            upper = Onset(stiffness, np.sqrt(Omega) / (2.0 * np.pi * self.tau), error)
            Omega = 2.0 * S_z * e / (s - n)
            lag = cf.onset_lag_of_lower(T_z, g, S_c, h, s)
            stiffness = self.unit * cf.onset_stiffness(T_x, S_c, Omega, lag)
            frequency = np.sqrt(Omega) / (2.0 * np.pi * self.tau)
        return Onset(*(np.where(falls, 0.0, x) for x in (stiffness, frequency, error))), upper

    def critical(self) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        """Return upper and lower critical stiffness, the frequency at the upper one, and their errors."""
        self.lower, self.upper = self.onsets()
        values = self.upper.stiffness, self.lower.stiffness, self.upper.frequency
        return values, (self.upper.error, self.lower.error, self.upper.error)

    def stable(self, spring: Array) -> Any:
        """Return whether a stiffness is outside the interval in which steady sliding is unstable."""
        return ~((spring >= self.lower.stiffness) & (spring <= self.upper.stiffness))

    def rates(self, spring: Array | None) -> tuple[NDArray[np.complex128], Array]:
        """Return the rates in 1/s along a new last axis, fastest growth first; no spring: a rigid drive."""
        T_z, T_x, S_z, e = self.T_z, self.T_x, self.S_z, self.e
        if spring is None:
            terms = sizes = np.stack([S_z, np.ones_like(T_z), T_z], axis=-1)
        elif self.held:
            terms = sizes = np.stack([spring / self.unit, np.ones_like(T_x), T_x], axis=-1)
        else:
            S_x = spring / self.unit
            middle = T_z * S_x + self.h + S_z * T_x
            terms = np.stack([S_z * S_x, S_x + e, middle, T_z + T_x, T_z * T_x], axis=-1)
            sizes = terms.copy()
            sizes[..., 1] = S_x + S_z + self.g * self.S_c  # e is a small difference
        found, error = _roots(terms, sizes)
        return found / self.tau[..., np.newaxis], error


def _roots(coefficients: Array, sizes: Array) -> tuple[NDArray[np.complex128], Array]:
    """Return the roots of polynomials, from the constant coefficient on, and their relative errors.

    `sizes` are those of the terms of which each coefficient is a sum. A polynomial of degree n has a
    root within n |P/P'| of any number; the rounding of P is added to |P|.
    """
    degree = coefficients.shape[-1] - 1
    unit = (coefficients[..., :1] / coefficients[..., -1:]) ** (1.0 / degree)  # of the mean root
    powers = unit ** np.arange(degree + 1)
    scaled, bounds = (each * powers for each in (coefficients, sizes))
    largest = np.max(bounds, axis=-1, keepdims=True)
    scaled, bounds = scaled / largest, bounds / largest
    companion = np.zeros((*scaled.shape[:-1], degree, degree))
    companion[..., range(1, degree), range(degree - 1)] = 1.0
    companion[..., -1] = -scaled[..., :-1] / scaled[..., -1:]
    found = np.linalg.eigvals(companion).astype(complex)
    terms, sizes = (np.moveaxis(each, -1, 0)[..., np.newaxis] for each in (scaled, bounds))
    pair = terms, polyder(terms)
    for _ in range(POLISHES):
        value, slope = (polyval(found, each, tensor=False) for each in pair)
        step = np.divide(value, slope, out=np.zeros_like(found), where=slope != 0.0)
        better = np.abs(polyval(found - step, terms, tensor=False)) < np.abs(value)
        found = np.where(better, found - step, found)
    value, slope = (np.abs(polyval(found, each, tensor=False)) for each in pair)
    value = value + ROUNDING * polyval(np.abs(found), sizes, tensor=False)
    with np.errstate(divide="ignore", over="ignore"):  # infinite for a double root
        error = degree * value / (slope * np.abs(found))
    order = np.lexsort((found.imag, -found.real))
    found, error = (np.take_along_axis(each, order, axis=-1) for each in (found, error))
    return found * unit, error


def critical_velocity(scene: Scene) -> tuple[Array, Array]:
    """Return the smallest velocity in m/s at which each of flat scenes becomes unstable, and its error.

    Critical stiffnesses are not always monotonic in the velocity: the first change is found on a grid.
    """
    if scene.held:
        nothing = np.full(scene.shape, np.nan)
        return nothing, nothing
    column = scene.flat().mapped(lambda x: x[:, np.newaxis])
    spring, tau = column.drive.stiffness, column.foundation.retardation_time
    load = column.support.weight / column.foundation.stiffness
    unit = np.log(np.cbrt(1.5 * column.indenter.radius * load) / tau)

    def onsets(log_velocity: Array) -> tuple[Onset, Onset]:
        return SmallMotions(column.at(np.exp(log_velocity))).onsets()

    def state(log_velocity: Array) -> NDArray[np.int_]:
        lower, upper = onsets(log_velocity)
        places = [spring > upper.stiffness, spring < lower.stiffness, spring <= upper.stiffness]
        return np.select(places, [STIFF, SOFT, UNSTABLE], NEVER)

    count = round((DECADES[1] - DECADES[0]) * PER_DECADE) + 1
    grid = np.broadcast_to(unit, column.shape) + np.log(10.0) * np.linspace(*DECADES, count)
    states = state(grid)
    before, after = states[:, :-1], states[:, 1:]
    changes = (after == UNSTABLE) | (before * after == SOFT * STIFF)
    first, some = changes.argmax(axis=1)[:, np.newaxis], changes.any(axis=1)
    low, high, was, now = (
        np.take_along_axis(each, first, axis=1)
        for each in (grid[:, :-1], grid[:, 1:], before, after)
    )
    across = now != UNSTABLE
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        here = state(middle)
        stays = np.where(across, here == was, here != UNSTABLE)
        low, high = np.where(stays, middle, low), np.where(stays, high, middle)

    # The error is that of the stiffness over its slope; it is not known where both stiffnesses meet.
    near = zip(*(onsets(high + step) for step in (-NEARBY, NEARBY)), strict=True)
    pairs = []
    with np.errstate(divide="ignore", invalid="ignore"):
        for left, right in near:
            steepness = np.abs(np.log(right.stiffness / left.stiffness)) / (2.0 * NEARBY)
            pairs.append((np.abs(np.log(left.stiffness / spring)), left.error / steepness))
    (of_lower, lower), (of_upper, upper) = pairs
    error = np.where(of_lower < of_upper, lower, upper) + 4.0 * 2.0**-52 * np.abs(high)
    error = np.where(np.isfinite(error), error, np.inf)
    return tuple(np.where(some, each[:, 0], np.nan) for each in (np.exp(high), error))  # type: ignore[return-value]
