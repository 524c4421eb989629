"""Faults that show by themselves: in a failed check, in the noise, in growth beyond all bounds."""

from collections.abc import Iterator, Sequence

import numpy as np

from kvtheory.checks.allowances import contact_extent
from kvtheory.checks.comparison_case import (
    COMMON,
    IN_STEP,
    LARGEST_SAWTOOTH,
    Case,
    common_noise,
)
from kvtheory.checks.discretization import COARSE, NUMBER
from kvtheory.checks.noise import noise
from kvtheory.results.comparison import Check, Explanation
from kvtheory.results.schemes import SCHEME_ROWS

LIKELY, READ = 0.8, 0.75
"""Ranks of what is seen but cannot be tried: a step that is not known, and a spacing that is estimated from
the sawtooth."""
LARGE, MANY = 10.0, 30.0
"""Of a scale, and of what it was at first: a difference beyond both has grown."""
UNSTABLE, FEW = "unstable time step", "too few elements"


def in_failed_checks(case: Case, failed: Sequence[Check]) -> Iterator[Explanation]:
    """Return what a failed check says by itself."""
    for check in failed:
        measured, allowed = check.measured or 0.0, check.allowed or 1.0
        if check.name == NUMBER:
            yield Explanation(
                UNSTABLE,
                f"the time step is unstable (F15): dt C L/M = {measured:.3g}, above {allowed:.4g}; take dt "
                f"below {case.resolution.time_step * allowed / measured * 1e3:.3g} ms",
                1.0, True,
            )  # fmt: skip
        elif check.name == COARSE:
            known = case.resolution.spacing_known
            density = 1e-3 / case.resolution.spacing * (1.0 if known else IN_STEP)
            yield Explanation(
                FEW,
                f"too few elements (F15): one that enters at the leading edge changes the normal force by "
                f"{2.0 * measured:.2g} of the load; take {density * measured / allowed:.2g} /mm or more "
                f"rather than {density:.3g} /mm",
                1.0 if known else READ, True,
            )  # fmt: skip


def growing(case: Case) -> Iterator[Explanation]:
    """Say so if the data look like an explicit scheme beyond its stability limit."""
    scene, time = case.theory.scene, case.series.time
    if scene.held or case.resolution.step_known:
        return
    steps = np.diff(time)
    h = float(steps[steps > 0.0].min())
    extent = float(contact_extent(case.theory, case.now).max())
    number = h * scene.foundation.damping * extent / scene.support.mass
    force, loud = "normal_force", 0.0
    if force in case.names:  # its noise is not capped here
        loud = float(np.median(noise(time, case.residual(force), case.now[force])))
    rough = loud > LARGEST_SAWTOOTH and (common_noise(case) or 0.0) > COMMON
    limits = [row.stability_limit for row in SCHEME_ROWS.values() if row.stability_limit < np.inf]
    limit = max(limits)
    if number > min(limits) and rough:
        text = (
            f"if the data hold every step: dt C L/M = {number:.3g} with their smallest interval of "
            f"{h * 1e3:.3g} ms, while an explicit scheme needs less than {limit:.4g}"
        )
    elif _grows(case):
        text = f"for the data grow beyond all bounds: an explicit scheme needs dt C L/M below {limit:.4g}"
    else:
        return
    yield Explanation(UNSTABLE, f"the time step is unstable (F15), {text}", LIKELY, True)


def _grows(case: Case) -> bool:
    """Whether the difference to theory becomes large, and began small.

    A depth may come back, for an indenter that was thrown off falls; a force jumps without growing.
    """
    quarter = max(case.series.time.size // 4, 1)
    for name, late, early in (("depth", 0, 1), ("normal_force", -quarter, quarter)):
        if name in case.names:
            off = np.abs(case.residual(name))
            if off[late:].max() > max(LARGE, MANY * off[:early].max()):
                return True
    return False
