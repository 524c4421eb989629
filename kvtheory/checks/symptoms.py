"""Faults that show by themselves: in a failed check, in the noise, in a motion that ignores its forces."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.allowances import contact_extent
from kvtheory.checks.checklist import judge
from kvtheory.checks.comparison_case import (
    COARSEST,
    COMMON,
    IN_STEP,
    LARGEST_SAWTOOTH,
    Case,
    common_noise,
    make_case,
)
from kvtheory.checks.discretization import COARSE
from kvtheory.checks.noise import noise
from kvtheory.results.comparison import Check, Explanation
from kvtheory.results.schemes import SCHEME_ROWS

COARSER = 2.0
"""Factor by which the spacing may be wider than assumed: data that are coarser show a sawtooth."""
LIKELY, READ, POSSIBLE = 0.8, 0.75, 0.55
"""Explained part given to what is seen but cannot be tried: a step that is not known, a spacing that is read
from the sawtooth, and one that is not known."""


def seen(case: Case, failed: Sequence[Check]) -> Iterator[Explanation]:
    """Return what a failed check says by itself."""
    by_name = {check.name: check for check in failed}
    if "stability number" in by_name:
        number = by_name["stability number"]
        yield Explanation(
            "unstable time step",
            f"the time step is unstable (F15): dt C L/M = {number.measured:.3g}, above "
            f"{number.allowed:.4g}; take dt below {case.resolution.time_step / ratio(number) * 1e3:.3g} ms",
            1.0, True,
        )  # fmt: skip
    if COARSE in by_name:
        density = (
            1e-3 / case.resolution.spacing * (1.0 if case.resolution.spacing_known else IN_STEP)
        )
        coarse_by = by_name[COARSE]
        yield Explanation(
            "too few elements",
            f"too few elements (F15): one that enters at the leading edge changes the normal force by "
            f"{2.0 * (coarse_by.measured or 0.0):.2g} of the load; take {density * ratio(coarse_by):.2g} /mm "
            f"or more rather than {density:.3g} /mm",
            1.0 if case.resolution.spacing_known else READ, True,
        )  # fmt: skip


def ratio(check: Check) -> float:
    """Return measured/allowed."""
    return (check.measured or 0.0) / (check.allowed or 1.0)


def unmoved(case: Case, failed: Sequence[Check]) -> Iterator[Explanation]:
    """Say so if the forces are right for the motion (F11), but do not move the indenter (Eq. 17).

    The excess of F_z over the load is then lost from the equation of motion while the indenter rises.
    """
    columns, static = case.series.columns, case.theory.static
    if (
        not any(check.name == "impulse balance" for check in failed)
        or case.theory.last_change > 0.0
        or not case.theory.scene.drive.rigid
    ):
        return
    if case.theory.final_velocity == 0.0 or not case.theory.scene.indenter.per_width:
        return
    late = case.series.time > FIRST_PART * case.series.time[-1]
    depth, time = columns["depth"][late], case.series.time[late]
    lift = float(np.polyfit(time, depth, 1)[0])
    expected = contact_force(case, depth, lift)
    given = columns["normal_force"][late]
    off = float(np.median(np.abs(given - expected))) / static.load
    pushed = float(np.median(given)) / static.load - 1.0
    if pushed > PUSHED and off < FORCE_RIGHT * pushed:
        yield Explanation(
            "contact lost while rising",
            f"F_z is that of the contact at the depth and rate of the data (F11), but stays {pushed:.2g} "
            "loads above the weight without lifting the indenter as Eq. 17 demands: contact is lost from "
            "the equation of motion while the indenter rises, as where an element counts as free once the "
            "indenter is above the surface of the last step (Eqs. 24 and 25, F8)",
            CERTAIN, True,
        )  # fmt: skip


def contact_force(case: Case, depth: NDArray[np.float64], rate: float) -> NDArray[np.float64]:
    """Return F_z of the contact at a depth and its rate, after a start from rest (F11), in N/m."""
    scene, static = case.theory.scene, case.theory.static
    tau, unit = scene.foundation.retardation_time, static.depth
    number = abs(case.theory.final_velocity) * tau / static.half_length
    d, v = np.maximum(depth / unit, 0.0), rate * tau / unit
    l, r = -np.sqrt(d), np.sqrt(np.maximum(d + v + number * number, 0.0)) - number
    width = np.maximum(r - l, 0.0)
    f_z = 0.75 * width * (d + v - (r * r + r * l + l * l) / 3.0 - number * (r + l))
    return np.asarray(static.load * f_z)


FIRST_PART = 0.3
"""Of the data: left out where the rate of the depth is taken as the mean of the rest."""
PUSHED = 0.2
"""Of the load: an excess of F_z that would have to move the indenter."""
FORCE_RIGHT = 0.25
"""Of that excess: a smaller difference between F_z and the contact's force leaves the motion to blame."""
CERTAIN = 0.9
"""Explained part given to it."""


def rattling(case: Case) -> Iterator[Explanation]:
    """Say so if the data look like an explicit scheme beyond its stability limit."""
    scene, time = case.theory.scene, case.series.time
    if scene.held or case.resolution.step_known:
        return
    steps = np.diff(time)
    h = float(steps[steps > 0.0].min())
    extent = float(contact_extent(case.theory, case.now).max())
    number = h * scene.foundation.damping * extent / scene.support.mass
    force = "normal_force"  # its noise is not capped here
    loud = (
        np.median(noise(time, case.residual(force), case.now[force]))
        if force in case.names
        else 0.0
    )
    rough = loud > LARGEST_SAWTOOTH and (common_noise(case) or 0.0) > COMMON
    limits = [row.stability_limit for row in SCHEME_ROWS.values() if row.stability_limit < np.inf]
    limit = max(limits)
    if number > min(limits) and rough:
        text = (
            f"if the data hold every step: dt C L/M = {number:.3g} with their smallest interval of "
            f"{h * 1e3:.3g} ms, while an explicit scheme needs less than {limit:.4g}"
        )
    elif grows(case):
        text = f"for the data grow beyond all bounds: an explicit scheme needs dt C L/M below {limit:.4g}"
    else:
        return
    name = "unstable time step"
    yield Explanation(name, f"the time step is unstable (F15), {text}", LIKELY, True)


def grows(case: Case) -> bool:
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


LARGE, MANY = 10.0, 30.0
"""Of a scale, and of what it was at first: a difference beyond both has grown."""


def coarse(case: Case, failed: Sequence[Check]) -> Iterator[Explanation]:
    """Say so if the data are as theory allows for fewer elements than assumed, and the forces show it."""
    shown = any(check.name.startswith(("normal", "friction", "discretization")) for check in failed)
    if case.resolution.spacing_known or not shown:
        return
    spacing = COARSER * case.resolution.spacing
    wider = make_case(case.theory, case.series, 1.0 / spacing, case.tolerance, COARSEST)
    wider = replace(wider, resolution=wider.resolution._replace(spacing_known=False))
    left = {check.name for check in judge(wider) if check.ok is False}
    if left - {"discretization noise"}:
        return
    shared = (common_noise(case) or 0.0) >= COMMON
    note = ", and their noise is common to both forces as that of elements" if shared else ""
    yield Explanation(
        "too few elements",
        f"too few elements (F15): the differences are as those of about {1e-3 / spacing:.3g} /mm, where "
        f"{1e-3 / case.resolution.spacing:.3g} /mm are assumed{note}; if so few are meant, say "
        "so with `per_length`",
        POSSIBLE, True,
    )  # fmt: skip
