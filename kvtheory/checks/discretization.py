"""Elements and time steps (F15): the checks of both, and the faults that show in them or in growth."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from kvtheory.checks.allowances import contact_extent
from kvtheory.checks.comparison_case import (
    COARSEST,
    COMMON,
    IN_STEP,
    LARGEST_SAWTOOTH,
    Case,
    NotMade,
    common_noise,
)
from kvtheory.checks.noise import noise
from kvtheory.results.comparison import Check, Explanation
from kvtheory.results.schemes import SCHEME_ROWS

NOISE, COARSE, NUMBER = "discretization noise", "elements enough", "stability number"
"""The names of the checks."""
ROUNDED, LARGEST_UNCORRELATED = 1e-9, 0.09
"""Of the load: smaller noise is none; and a little below where noise ceases to be allowed for."""
LIKELY, READ = 0.8, 0.75
"""Ranks of what is seen but cannot be tried: a step that is not known, and a spacing that is estimated from
the sawtooth."""
LARGE, MANY = 10.0, 30.0
"""Of a scale, and of what it was at first: a difference beyond both has grown."""
UNSTABLE, FEW = "unstable time step", "too few elements"
"""The names of the faults."""


def sawtooth(case: Case) -> tuple[float, float, str]:
    """Compare the noise of the normal force with that of elements entering at the leading edge."""
    W, fine = case.theory.static.load, case.resolution
    sigma, density = float(np.median(case.bands["normal_force"].noise)) / W, 1e-3 / fine.spacing
    if not fine.spacing_known:
        sound = (common_noise(case) or 0.0) < COMMON
        limit = LARGEST_UNCORRELATED if sound else COARSEST
        kind = "not that of elements" if sound else "common to both forces, as that of elements"
        how = "estimated from them" if fine.spacing_read else "assumed"
        return sigma, case.tolerance * limit, f"{kind}; {density:.3g} elements per mm, {how}"
    allowed = case.tolerance * (2.0 * float(case.edge_force.max()) / W + ROUNDED)
    b = float(np.median(case.edge_force)) / W
    return sigma, allowed, f"N = {density:.4g} /mm, sawtooth +-{b:.2g} of the load"


def elements(case: Case) -> tuple[float, float, str]:
    """Compare one element at the leading edge with the load.

    For a ball that force is known as an upper bound only, by which no simulation can be rejected.
    """
    fine, b = case.resolution, float(np.median(case.edge_force)) / case.theory.static.load
    if not fine.spacing_known and not fine.spacing_read:
        raise NotMade(
            "the element density is not given (per_length), and cannot be estimated from the forces"
        )
    if not case.theory.scene.indenter.per_width:
        raise NotMade(
            f"for a ball only an upper bound is known, {b:.2g} of the load if all strips gain an element at "
            "the same time"
        )
    if fine.spacing_known:
        return b, case.tolerance * LARGEST_SAWTOOTH, ""
    note = f"about {1e-3 * IN_STEP / fine.spacing:.2g} /mm, estimated from the sawtooth"
    return b / IN_STEP, case.tolerance * LARGEST_SAWTOOTH, note


def _stability_number(case: Case, step: float) -> float:
    """Return dt C L/M of a time step in s, with the longest contact."""
    extent = float(contact_extent(case.theory, case.now).max())
    return step * case.theory.scene.foundation.damping * extent / case.theory.scene.support.mass


def stability(case: Case) -> tuple[float, float, str]:
    """Compare dt C L/M of an explicit scheme with its limit."""
    scene, scheme = case.theory.scene, case.series.scheme or ""
    limit = SCHEME_ROWS[scheme].stability_limit if scheme in SCHEME_ROWS else math.nan
    for reason, holds in (
        ("the indenter is fixed", scene.held),
        ("F15 holds for Kelvin-Voigt", bool(scene.foundation.arms)),
        ("the time step is not known", not case.resolution.step_known),
        (f'the scheme "{scheme}" is stable at any time step', math.isinf(limit)),
        (f'no limit is known of the scheme "{scheme}"', math.isnan(limit)),
    ):
        if holds:
            raise NotMade(reason)
    return _stability_number(case, case.resolution.time_step), limit, f"scheme {scheme}"


def symptoms(case: Case, failed: Sequence[Check]) -> Iterator[Explanation]:
    """Yield the faults that show by themselves: in a failed check of elements or steps, or in growth."""
    known, density = case.resolution.spacing_known, 1e-3 / case.resolution.spacing
    if not known:
        density *= IN_STEP
    for check in failed:
        measured, allowed = check.measured or 0.0, check.allowed or 1.0
        if check.name == NUMBER:
            longest = case.resolution.time_step * allowed / measured
            text = (
                f"the time step is unstable (F15): dt C L/M = {measured:.3g}, above {allowed:.4g}; take dt "
                f"below {longest * 1e3:.3g} ms"
            )
            yield Explanation(UNSTABLE, text, 1.0, True)
        elif check.name == COARSE:
            text = (
                f"too few elements (F15): one that enters at the leading edge changes the normal force by "
                f"{2.0 * measured:.2g} of the load; take {density * measured / allowed:.2g} /mm or more "
                f"rather than {density:.3g} /mm"
            )
            yield Explanation(FEW, text, 1.0 if known else READ, True)
    if not case.theory.scene.held and not case.resolution.step_known:
        yield from _growing(case)


def _growing(case: Case) -> Iterator[Explanation]:
    """Say so if the data look like an explicit scheme beyond its stability limit."""
    steps = np.diff(case.time)
    h = float(steps[steps > 0.0].min())
    number, force, loud = _stability_number(case, h), "normal_force", 0.0
    if force in case.names:  # its noise is not capped here
        loud = float(np.median(noise(case.time, case.residual(force), case.now[force])))
    rough = loud > LARGEST_SAWTOOTH and (common_noise(case) or 0.0) > COMMON
    limits = [row.stability_limit for row in SCHEME_ROWS.values() if row.stability_limit < np.inf]
    if number > min(limits) and rough:
        text = (
            f"if the data hold every step: dt C L/M = {number:.3g} with their smallest interval of "
            f"{h * 1e3:.3g} ms, while an explicit scheme needs less than {max(limits):.4g}"
        )
    elif _grows(case):
        text = (
            "for the data grow beyond all bounds: an explicit scheme needs dt C L/M below "
            f"{max(limits):.4g}"
        )
    else:
        return
    yield Explanation(UNSTABLE, f"the time step is unstable (F15), {text}", LIKELY, True)


def _grows(case: Case) -> bool:
    """Whether the difference to theory becomes large, and began small.

    A depth may come back, for an indenter that was thrown off falls; a force jumps without growing.
    """
    quarter = max(case.time.size // 4, 1)
    for name, late, early in (("depth", 0, 1), ("normal_force", -quarter, quarter)):
        if name in case.names:
            off = np.abs(case.residual(name))
            if off[late:].max() > max(LARGE, MANY * off[:early].max()):
                return True
    return False
