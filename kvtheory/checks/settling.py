"""Checks of how the data end: in steady sliding, or in a cycle whose phase is known."""

import math

from kvtheory.checks.comparison_case import SMALLEST, Case, NotMade, rms
from kvtheory.checks.noise import SURE

SETTLED = 7.0
"""Slow time constants from the last change of the drive to steady sliding: e^-7 is below a thousandth."""
LAST_PART, FEWEST_LATE = 0.75, 3
"""Fraction of the time after which the mean is taken for the limit, and the fewest samples for it."""
PHASE = "phase of the cycle"
"""The check whose failure alone is no evidence against the data: theory cannot predict the phase."""
LOST = 0.25
"""Allowance, relative to the sliding velocity, from which the phase is lost."""


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
