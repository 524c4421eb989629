"""Checks of how the data settle: the two time constants of F12, the steady limit, or the phase of a cycle."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.comparison_case import SMALLEST, Case, not_made, rms
from kvtheory.checks.noise import SURE
from kvtheory.checks.relaxation import FEWEST, fit, uncertainty
from kvtheory.results.comparison import Check

Array = NDArray[np.float64]

SETTLED = 7.0
"""Slow time constants after the last change of the drive: e^-7 is below a thousandth."""
NEAR, FAR = 0.3, 1e-3
"""Of the steady depth: the slow time constant is fitted while the depth is this far from it."""
FAST_SPAN = 4.0
"""Fast time constants after the start within which the fast one is fitted."""
LAST_PART, FEWEST_LATE = 0.75, 3
"""Of the data: the mean of the rest is taken for the limit, if it has so many samples."""
FITTED = 0.5
"""A time constant that the data fix no better than this, relative, is not judged."""
PHASE = "phase of the cycle"
"""The check whose failure alone says nothing against the data: theory cannot say where they should be."""
LOST = 0.25
"""Of the sliding velocity: where so much is allowed, the phase is lost."""


def slow_constant(case: Case) -> Iterator[Check]:
    """Fit the slow time constant to the depth as it settles."""
    name, rates = "slow time constant", case.theory.rates
    why = _why_not(case, "depth")
    if why or rates is None:
        yield not_made(name, "F12", why)
        return
    off = np.abs(case.now["depth"] / case.theory.steady_state.depth - 1.0)
    late = np.flatnonzero((off > NEAR) | (case.series.time < case.theory.last_change))
    start = int(late[-1]) + 1 if late.size else 0
    use = np.flatnonzero(off[start:] > FAR) + start
    yield _fitted(case, name, "depth", use, rates.slow.real)


def fast_constant(case: Case) -> Iterator[Check]:
    """Fit the fast time constant to the normal force after the start."""
    name, rates, time = "fast time constant", case.theory.rates, case.series.time
    why = _why_not(case, "normal_force")
    if not why and 0.0 not in case.theory.scene.drive.jumps:
        why = "there is no such decay in this scene"
    if why or rates is None:
        yield not_made(name, "F12", why)
        return
    use = np.flatnonzero((time > 0.0) & (time < FAST_SPAN * rates.fast.real))
    yield _fitted(case, name, "normal_force", use, rates.fast.real)


def _why_not(case: Case, curve: str) -> str:
    """Say why a curve has no time constants to fit; nothing if it has."""
    if curve not in case.series.columns:
        return f"the data hold no {curve.replace('_', ' ')}"
    if case.theory.rates is None:
        return "a fixed indenter has none"
    if case.theory.scene.foundation.arms:
        return "F12 holds for Kelvin-Voigt"
    if not (case.theory.scene.drive.rigid and case.theory.scene.indenter.per_width):
        return "F12 holds for a line contact on a rigid drive"
    return "the indenter oscillates" if case.theory.rates.oscillates else ""


def _fitted(case: Case, name: str, curve: str, use: NDArray[np.intp], exact: float) -> Check:
    """Fit a time constant to rows of a curve, of data and of theory, unless the data do not fix it."""
    if use.size < FEWEST:
        return not_made(name, "F12", f"fewer than {FEWEST} samples while the {curve} settles")
    t, allowed = case.series.time[use], case.allowance
    theory, data = (fit(t, c[curve][use], exact) for c in (case.now, case.series.columns))
    offset = np.nan_to_num(
        allowed.systematic[curve] - allowed.rounding[curve]
        + 0.5 * (allowed.high[curve] - allowed.low[curve])
    )[use]  # fmt: skip
    errors = offset, allowed.rounding[curve][use], allowed.noise[curve][use]
    most = uncertainty(t, case.now[curve][use], theory, *errors)
    if not most < FITTED:
        return not_made(name, "F12", "the data do not fix it")
    note = (
        f"{data * 1e3:.4g} ms from the data, {theory * 1e3:.4g} ms from theory by the same fit, "
        f"F12: {exact * 1e3:.4g} ms"
    )
    off, unit = abs(data / theory - 1.0), "relative difference of the fits"
    return case.check(name, off, case.tolerance * most, "F12", unit, note)


def steady_limit(case: Case) -> Iterator[Check]:
    """Compare the end of the data with exact steady sliding."""
    theory, time, columns = case.theory, case.series.time, case.series.columns
    ours = "F1" if theory.scene.indenter.per_width else "F20"
    name, equation = "steady limit", "F17" if theory.scene.foundation.arms else ours
    if math.isinf(theory.last_change):
        yield not_made(name, equation, "the drive is a function, which need not settle")
        return
    if theory.by_elements and not theory.scene.drive.rigid:
        why = "steady sliding on a spring is compared for a parabola on Kelvin-Voigt only"
        yield not_made(name, equation, why)
        return
    if theory.rates is not None:
        slow = theory.rates.settling
    else:
        slow = theory.scene.foundation.retardation_time if theory.last_change else 0.0
    if math.isinf(slow):
        yield not_made(name, equation, "steady sliding is unstable on this spring (F22)")
        return
    settled = theory.last_change + SETTLED * slow
    late = time > max(settled, LAST_PART * time[-1])
    if late.sum() < FEWEST_LATE:
        why = f"the data end before {settled * 1e3:.4g} ms, when the transient is over"
        yield not_made(name, equation, why)
        return
    friction = theory.steady_state.friction_force
    exact = {"depth": theory.steady_state.depth, "normal_force": theory.steady_state.load,
             "friction_force": friction, "spring_force": friction}  # fmt: skip
    found = []
    for curve in (name for name in exact if name in columns):
        scale, mean = theory.scales[curve], float(columns[curve][late].mean())
        left = abs(float(case.now[curve][late].mean()) - exact[curve])
        random = rms(case.allowance.noise[curve][late]) / math.sqrt(late.sum())
        smooth = float(case.allowance.systematic[curve][late].max())
        allowed = case.tolerance * ((smooth + left + SURE * random) / scale + SMALLEST)
        note = f"{curve} {mean:.6g}, exact {exact[curve]:.6g} in SI"
        found.append((abs(mean - exact[curve]) / scale, allowed, note))
    off, allowed, note = max(found, key=lambda each: each[0] / each[1])
    yield case.check(name, off, allowed, equation, "relative to the static state", note)


def phase(case: Case) -> Iterator[Check]:
    """Compare what is allowed of the sliding velocity with itself, where steady sliding is unstable.

    A disturbance shifts the phase of a cycle for good: where that may be half of a swing that is half of the
    mean, no agreement says anything.
    """
    theory, curve = case.theory, "sliding_velocity"
    if theory.scene.drive.rigid:
        return
    if theory.rates is not None and math.isfinite(theory.rates.settling):
        yield not_made(PHASE, "F22", "steady sliding is stable")
        return
    may_be = case.tolerance * rms(case.allowance.systematic[curve])
    unit = "what elements and steps may change of the sliding velocity, relative to it"
    yield case.check(PHASE, may_be / rms(case.now[curve]), LOST, "F22", unit)
