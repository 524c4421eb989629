"""Checks of elements and steps (F15): the sawtooth, the density, the stability number."""

import math

import numpy as np

from kvtheory.checks.allowances import contact_extent
from kvtheory.checks.comparison_case import (
    COARSEST,
    COMMON,
    IN_STEP,
    LARGEST_SAWTOOTH,
    Case,
    Measured,
    NotMade,
    check,
    common_noise,
)
from kvtheory.results.schemes import SCHEME_ROWS

ROUNDED = 1e-9
"""Of the load: noise that is none."""
NOISE, COARSE, NUMBER = "discretization noise", "elements enough", "stability number"
"""The names of the checks."""
LARGEST_UNCORRELATED = 0.09
"""Of the load: a little below where noise ceases to be allowed for."""


@check(NOISE, "F15", "standard deviation, relative to the load")
def sawtooth(case: Case) -> Measured:
    """Compare the noise of the normal force with that of elements entering at the leading edge."""
    case.columns("normal_force")
    W, fine = case.theory.static.load, case.resolution
    sigma = float(np.median(case.allowance.noise["normal_force"])) / W
    if not fine.spacing_known:
        shared = common_noise(case)
        sound = shared is None or shared < COMMON
        limit = LARGEST_UNCORRELATED if sound else COARSEST
        kind = "not that of elements" if sound else "common to both forces, as that of elements"
        how = "estimated from them" if fine.spacing_read else "assumed"
        note = f"{kind}; {1e-3 / fine.spacing:.3g} elements per mm, {how}"
        return sigma, case.tolerance * limit, note
    allowed = case.tolerance * (2.0 * float(case.allowance.force.max()) / W + ROUNDED)
    b = float(np.median(case.allowance.force)) / W
    return sigma, allowed, f"N = {1e-3 / fine.spacing:.4g} /mm, sawtooth +-{b:.2g} of the load"


@check(COARSE, "F15", "half an element's force, relative to the load")
def elements(case: Case) -> Measured:
    """Compare one element at the leading edge with the load.

    Of a ball that force is known as an upper bound only, with which no simulation can be rejected.
    """
    fine, known = case.resolution, case.resolution.spacing_known
    if not known and not fine.spacing_read:
        raise NotMade(
            "the element density is not given (per_length), and cannot be estimated from the forces"
        )
    b = float(np.median(case.allowance.force)) / case.theory.static.load
    if not case.theory.scene.indenter.per_width:
        raise NotMade(
            f"for a ball only an upper bound is known, {b:.2g} of the load if all strips gain an element at "
            "the same time"
        )
    if known:
        return b, case.tolerance * LARGEST_SAWTOOTH, ""
    note = f"about {1e-3 * IN_STEP / fine.spacing:.2g} /mm, estimated from the sawtooth"
    return b / IN_STEP, case.tolerance * LARGEST_SAWTOOTH, note


@check(NUMBER, "F15", "dt C L/M")
def stability(case: Case) -> Measured:
    """Compare dt C L/M of an explicit scheme with its limit."""
    scene, scheme = case.theory.scene, case.series.scheme or ""
    limit = SCHEME_ROWS[scheme].stability_limit if scheme in SCHEME_ROWS else math.nan
    if scene.held:
        raise NotMade("the indenter is fixed")
    if scene.foundation.arms:
        raise NotMade("F15 holds for Kelvin-Voigt")
    if not case.resolution.step_known:
        raise NotMade("the time step is not known")
    if math.isinf(limit):
        raise NotMade(f'the scheme "{scheme}" is stable at any time step')
    if math.isnan(limit):
        raise NotMade(f'no limit is known of the scheme "{scheme}"')
    extent = float(contact_extent(case.theory, case.now).max())
    number = case.resolution.time_step * scene.foundation.damping * extent / scene.support.mass
    return number, limit, f"scheme {scheme}"
