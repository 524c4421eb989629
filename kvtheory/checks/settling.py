"""Checks of how the data settle: the two time constants of F12, the steady limit, or the phase of a cycle.

The depth settles with the slow time constant, the force right after a jump with the fast one. The same fit is
made to theory at the same times, so that its own error cancels.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from kvtheory.checks.comparison_case import SMALLEST, Case, NotMade, rms
from kvtheory.checks.noise import SURE
from kvtheory.checks.theory import Array, Rates

SETTLED = 7.0
"""Slow time constants from the last change of the drive to steady sliding: e^-7 is below a thousandth."""
NEAR, FAR, FAST_SPAN = 0.3, 1e-3, 4.0
"""The slow time constant is fitted while the relative distance of the depth from the steady one is in this
range, the fast one within this many of it after the start."""
LAST_PART, FEWEST_LATE = 0.75, 3
"""Fraction of the time after which the mean is taken for the limit, and the fewest samples for it."""
FITTED = 0.5
"""Largest relative uncertainty of a time constant that is judged."""
PHASE = "phase of the cycle"
"""The check whose failure alone is no evidence against the data: theory cannot predict the phase."""
LOST = 0.25
"""Allowance, relative to the sliding velocity, from which the phase is lost."""
FEWEST, RANGE, LOG_PRECISE = 6, 5.0, 1e-6
"""Fewest samples to fit three unknowns, the factor above and below the expected time constant to search, and
the precision of its logarithm, far finer than any data determine it."""


def slow_constant(case: Case) -> tuple[float, float, str]:
    """Fit the slow time constant to the depth as it settles."""
    rates = _rates(case)
    off = np.abs(case.now["depth"] / case.theory.steady_state.depth - 1.0)
    late = np.flatnonzero((off > NEAR) | (case.time < case.theory.last_change))
    start = int(late[-1]) + 1 if late.size else 0
    use = np.flatnonzero(off[start:] > FAR) + start
    return _fitted(case, "depth", use, rates.slow.real)


def fast_constant(case: Case) -> tuple[float, float, str]:
    """Fit the fast time constant to the normal force after the start."""
    rates = _rates(case)
    if 0.0 not in case.theory.scene.drive.jumps:
        raise NotMade("there is no such decay in this scene")
    use = np.flatnonzero((case.time > 0.0) & (case.time < FAST_SPAN * rates.fast.real))
    return _fitted(case, "normal_force", use, rates.fast.real)


def _rates(case: Case) -> Rates:
    """Return the time constants, if they can be fitted."""
    scene, rates = case.theory.scene, case.theory.rates
    if rates is None:
        raise NotMade("a fixed indenter has none")
    if scene.foundation.arms:
        raise NotMade("F12 holds for Kelvin-Voigt")
    if not (scene.drive.rigid and scene.indenter.per_width):
        raise NotMade("F12 holds for a line contact on a rigid drive")
    if rates.oscillates:
        raise NotMade("the indenter oscillates")
    return rates


def _fitted(
    case: Case, curve: str, use: NDArray[np.intp], exact: float
) -> tuple[float, float, str]:
    """Fit a time constant to rows of a curve, of data and of theory, unless the data do not fix it."""
    if use.size < FEWEST:
        raise NotMade(f"fewer than {FEWEST} samples while the {curve} settles")
    t, band = case.time[use], case.bands[curve]
    theory, data = (fit(t, c[curve][use], exact) for c in (case.now, case.columns))
    smooth = np.nan_to_num(band.systematic - band.rounding + 0.5 * (band.high - band.low))
    errors = smooth[use], band.rounding[use], band.noise[use]
    limit = uncertainty(t, case.now[curve][use], theory, *errors)
    if not limit < FITTED:
        raise NotMade("the data do not fix it")
    note = f"{data * 1e3:.4g} ms from the data, {theory * 1e3:.4g} ms from theory by the same fit"
    note += f", F12: {exact * 1e3:.4g} ms"
    return abs(data / theory - 1.0), case.tolerance * limit, note


def _basis(time: Array, T: float) -> Array:
    """Return the columns 1 and exp(-t/T)."""
    return np.stack([np.ones_like(time), np.exp((time[0] - time) / T)], axis=1)


def fit(time: Array, values: Array, expected: float) -> float:
    """Return T of the best c_0 + c_1 exp(-t/T), for T within a factor of five of the expected one."""

    def left(log_T: float) -> float:
        basis = _basis(time, np.exp(log_T))
        rest = values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]
        return float(rest @ rest)

    bounds = np.log(expected) - np.log(RANGE), np.log(expected) + np.log(RANGE)
    options = {"xatol": LOG_PRECISE}
    return float(np.exp(minimize_scalar(left, bounds=bounds, method="bounded", options=options).x))


def uncertainty(
    time: Array, values: Array, T: float, offset: Array, digits: Array, sigma: Array
) -> float:
    """Return the uncertainty of T, relative to T.

    `offset` bounds a smooth error of the values, `digits` one of any sign at each of them, and `sigma` are
    the standard deviations of a random one; all go through the linear least squares about the fit.
    """
    age, basis = time - time[0], _basis(time, T)
    amplitude = np.linalg.lstsq(basis, values, rcond=None)[0][1]
    to_parameter = np.linalg.pinv(np.column_stack([basis, amplitude * basis[:, 1] * age / T]))[2]
    smooth = abs(to_parameter @ offset) + abs(to_parameter @ (offset * age / age[-1]))
    rough = np.abs(to_parameter) @ digits + SURE * np.linalg.norm(sigma * to_parameter)
    return float(smooth + rough)


def steady_limit(case: Case) -> tuple[float, float, str]:
    """Compare the end of the data with exact steady sliding."""
    theory, time = case.theory, case.time
    if math.isinf(theory.last_change):
        raise NotMade("the drive is a function, which need not settle")
    if theory.rates is not None:
        slow = theory.rates.settling
    else:
        slow = theory.scene.foundation.retardation_time if theory.last_change else 0.0
    if math.isinf(slow):
        raise NotMade("steady sliding is unstable on this spring (F22)")
    settled = theory.last_change + SETTLED * slow
    late = time > max(settled, LAST_PART * time[-1])
    if late.sum() < FEWEST_LATE:
        raise NotMade(f"the data end before {settled * 1e3:.4g} ms, when the transient is over")
    steady = theory.steady_state
    exact = {"depth": steady.depth, "normal_force": steady.load,
             "friction_force": steady.friction_force, "spring_force": steady.friction_force}  # fmt: skip
    found = []
    for curve in (name for name in exact if name in case.columns):
        scale, mean = theory.scales[curve], float(case.columns[curve][late].mean())
        left = abs(float(case.now[curve][late].mean()) - exact[curve])
        random = rms(case.bands[curve].noise[late]) / math.sqrt(late.sum())
        smooth = float(case.bands[curve].systematic[late].max())
        allowed = case.tolerance * ((smooth + left + SURE * random) / scale + SMALLEST)
        note = f"{curve} {mean:.6g}, exact {exact[curve]:.6g} in SI"
        found.append((abs(mean - exact[curve]) / scale, allowed, note))
    return max(found, key=lambda each: each[0] / each[1])


def phase(case: Case) -> tuple[float, float, str]:
    """Compare the allowance for the sliding velocity with that velocity, where steady sliding is unstable.

    A disturbance shifts the phase of a cycle permanently: once the allowance is half of an oscillation whose
    amplitude is half of the mean, agreement proves nothing.
    """
    theory, curve = case.theory, "sliding_velocity"
    if theory.rates is not None and math.isfinite(theory.rates.settling):
        raise NotMade("steady sliding is stable")
    may_be = case.tolerance * rms(case.bands[curve].systematic)
    return may_be / rms(case.now[curve]), LOST, ""
