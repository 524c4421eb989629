"""Checks of elements and steps (F15): the sawtooth, the density, the stability number."""

import math
from collections.abc import Iterator

import numpy as np

from kvtheory.checks.allowances import contact_extent
from kvtheory.checks.comparison_case import (
    COARSEST,
    COMMON,
    IN_STEP,
    LARGEST_SAWTOOTH,
    Case,
    common_noise,
    not_made,
)
from kvtheory.results.comparison import Check
from kvtheory.results.schemes import SCHEME_ROWS

ROUNDED = 1e-9
"""Of the load: noise that is none."""
COARSE = "elements enough"
"""The check of the density."""


def sawtooth(case: Case) -> Iterator[Check]:
    """Noise of the normal force against that of elements entering at the leading edge."""
    name, equation, columns = "discretization noise", "F15", case.series.columns
    if "normal_force" not in columns:
        yield not_made(name, equation, "the data hold no normal force")
        return
    W = case.theory.static.load
    sigma, b = case.random_force / W, float(np.median(case.allowance.force)) / W
    unit = "standard deviation, relative to the load"
    if not case.resolution.spacing_known:
        shared = common_noise(case)
        sound = shared is None or shared < COMMON
        limit = LARGEST_NOISE_ALLOWED if sound else COARSEST
        kind = "not that of elements" if sound else "common to both forces, as that of elements"
        how = "read from them" if case.resolution.spacing_read else "assumed"
        note = f"{kind}; {1e-3 / case.resolution.spacing:.3g} elements per mm, {how}"
        yield case.check(name, sigma, case.tolerance * limit, equation, unit, note)
        return
    allowed = case.tolerance * (2.0 * float(case.allowance.force.max()) / W + ROUNDED)
    note = f"N = {1e-3 / case.resolution.spacing:.4g} /mm, sawtooth +-{b:.2g} of the load"
    yield case.check(name, sigma, allowed, equation, unit, note)


LARGEST_NOISE_ALLOWED = 0.09
"""Of the load: a little below where noise ceases to be allowed for."""


def elements(case: Case) -> Iterator[Check]:
    """One element at the leading edge against the load."""
    name, equation = COARSE, "F15"
    known, read = case.resolution.spacing_known, case.resolution.spacing_read
    if not known and not read:
        why = "the element density is not given (per_length), nor can it be read from the forces"
        yield not_made(name, equation, why)
        return
    b = float(np.median(case.allowance.force)) / case.theory.static.load
    b /= 1.0 if known else IN_STEP
    note = (
        ""
        if known
        else f"about {1e-3 * IN_STEP / case.resolution.spacing:.2g} /mm, read from the sawtooth"
    )
    unit = "half an element's force, relative to the load"
    yield case.check(name, b, case.tolerance * LARGEST_SAWTOOTH, equation, unit, note)


def stability(case: Case) -> Iterator[Check]:
    """Compare dt C L/M of an explicit scheme with its limit."""
    name, equation, scene = "stability number", "F15", case.theory.scene
    scheme = case.series.scheme or ""
    limit = SCHEME_ROWS[scheme].stability_limit if scheme in SCHEME_ROWS else math.nan
    if scene.held:
        yield not_made(name, equation, "the indenter is fixed")
    elif scene.foundation.arms:
        yield not_made(name, equation, "F15 holds for Kelvin-Voigt")
    elif not case.resolution.step_known:
        yield not_made(name, equation, "the time step is not known")
    elif math.isinf(limit):
        yield not_made(name, equation, f'the scheme "{scheme}" is stable at any time step')
    elif math.isnan(limit):
        yield not_made(name, equation, f'no limit is known of the scheme "{scheme}"')
    else:
        extent = float(contact_extent(case.theory, case.now).max())
        number = case.resolution.time_step * scene.foundation.damping * extent / scene.support.mass
        yield case.check(name, number, limit, equation, "dt C L/M", f"scheme {scheme}")
