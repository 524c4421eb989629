"""Checks of how the data settle: the two time constants of F12, and the steady limit."""

from collections.abc import Iterator

import numpy as np

from kvtheory.checks.allowances import extreme
from kvtheory.checks.comparison_case import Case
from kvtheory.checks.making import check, not_made
from kvtheory.checks.relaxation import FEWEST, fit, uncertainty
from kvtheory.results.comparison import Check

SETTLED = 7.0
"""Slow time constants after the last change of the drive: e^-7 is below a thousandth."""
NEAR, FAR = 0.3, 1e-3
"""Of the steady depth: the slow time constant is fitted while the depth is this far from it."""
FAST_SPAN = 4.0
"""Fast time constants after the start within which the fast one is fitted."""
FITTED = 0.5
"""A time constant that the data fix no better than this, relative, is not judged."""


def slow_constant(case: Case) -> Iterator[Check]:
    """Fit the slow time constant to the depth as it settles."""
    name, equation = "slow time constant", "F12"
    rates, columns, time = case.theory.rates, case.series.columns, case.series.time
    if rates is None or rates.oscillates or "depth" not in columns:
        why = "a fixed indenter has none" if rates is None else "the indenter oscillates"
        yield not_made(name, equation, why if "depth" in columns else "the data hold no depth")
        return
    steady = case.theory.steady_state.depth
    off = np.abs(case.now["depth"] / steady - 1.0)
    late = np.flatnonzero((off > NEAR) | (time < case.theory.scene.drive.last_change))
    part = slice(int(late[-1]) + 1 if late.size else 0, None)
    use = np.flatnonzero(off[part] > FAR) + part.start
    if use.size < FEWEST:
        yield not_made(name, equation, "too few samples while the depth settles")
        return
    slow = rates.slow.real
    t, sigma = time[use], case.allowance.noise["depth"]
    theory_fit = fit(t, case.now["depth"][use], slow)
    data_fit = fit(t, columns["depth"][use], slow)
    offset = np.nan_to_num(case.allowance.systematic["depth"][use])
    allowed = uncertainty(t, case.now["depth"][use], theory_fit, offset, sigma)
    yield fitted(case, name, data_fit, theory_fit, slow, allowed)


def fast_constant(case: Case) -> Iterator[Check]:
    """Fit the fast time constant to the normal force after the start."""
    name, equation = "fast time constant", "F12"
    rates, columns, time = case.theory.rates, case.series.columns, case.series.time
    if (
        rates is None
        or rates.oscillates
        or "normal_force" not in columns
        or 0.0 not in case.theory.scene.drive.jumps
    ):
        why = (
            "a fixed indenter has none" if rates is None else "there is no such decay in this scene"
        )
        yield not_made(
            name, equation, why if "normal_force" in columns else "the data hold no normal force"
        )
        return
    fast = rates.fast.real
    use = np.flatnonzero((time > 0.0) & (time < FAST_SPAN * fast))
    if use.size < FEWEST:
        yield not_made(
            name,
            equation,
            f"fewer than {FEWEST} samples within {FAST_SPAN * fast * 1e3:.3g} ms of the start",
        )
        return
    t, sigma = time[use], case.allowance.noise["normal_force"]
    theory_fit = fit(t, case.now["normal_force"][use], fast)
    data_fit = fit(t, columns["normal_force"][use], fast)
    band = case.allowance.high["normal_force"] - case.allowance.low["normal_force"]
    offset = (case.allowance.systematic["normal_force"] + 0.5 * band)[use]
    allowed = uncertainty(t, case.now["normal_force"][use], theory_fit, offset, sigma)
    yield fitted(case, name, data_fit, theory_fit, fast, allowed)


def fitted(
    case: Case, name: str, data: float, theory: float, exact: float, allowed: float
) -> Check:
    """Return the check of a fitted time constant, or why it is not made."""
    if not allowed < FITTED:
        return not_made(name, "F12", "the data do not fix it")
    note = (
        f"{data * 1e3:.4g} ms from the data, {theory * 1e3:.4g} ms from theory by the same fit, "
        f"F12: {exact * 1e3:.4g} ms"
    )
    off = abs(data / theory - 1.0)
    return check(
        case, name, off, case.tolerance * allowed, "F12", "relative difference of the fits", note
    )


def steady_limit(case: Case) -> Iterator[Check]:
    """Compare the end of the data with exact steady sliding."""
    name, equation = "steady limit", "F1"
    theory, time = case.theory, case.series.time
    if theory.rates is None:
        memory = (
            0.0
            if theory.scene.drive.last_change == 0.0
            else theory.scene.foundation.retardation_time
        )
        slow = memory
    else:
        slow = 1.0 / (1.0 / theory.rates.slow).real
    settled = theory.scene.drive.last_change + SETTLED * slow
    late = time > max(settled, 0.75 * time[-1])
    if late.sum() < 3:
        yield not_made(
            name,
            equation,
            f"the data end before {settled * 1e3:.4g} ms, when the transient is over",
        )
        return
    exact = {"depth": theory.steady_state.depth, "normal_force": theory.steady_state.load,
             "friction_force": theory.steady_state.friction_force}  # fmt: skip
    worst = (-1.0, 0.0, 0.0, "")
    for curve in (name for name in exact if name in case.series.columns):
        scale = theory.scales[curve]
        mean = float(case.series.columns[curve][late].mean())
        left = abs(float(case.now[curve][late].mean()) - exact[curve])
        random = case.allowance.noise[curve] / np.sqrt(late.sum())
        smooth = float(case.allowance.systematic[curve][late].max())
        allowed = (
            case.tolerance * (smooth + left + extreme(int(late.sum())) * random) / scale + 1e-9
        )
        off = abs(mean - exact[curve]) / scale
        if off / allowed > worst[0]:
            worst = (
                off / allowed,
                off,
                allowed,
                f"{curve} {mean:.6g}, exact {exact[curve]:.6g} in SI",
            )
    yield check(case, name, worst[1], worst[2], equation, "relative to the static state", worst[3])
