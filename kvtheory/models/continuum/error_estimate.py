"""How wrong a transient may be: measured against solutions with a looser tolerance and other steps."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.continuum import evaluation
from kvtheory.models.continuum.run import StepControl
from kvtheory.results import Certificate

Array = NDArray[np.float64]

COARSER = 10.0
"""The tolerance of the solutions that this one is compared with is so many times larger ..."""
COMPARISONS = (
    StepControl(),
    StepControl(first_step=0.17, longest=0.3, grow=6.0, straight=0.5),
)
"""... and one of them also takes other steps where the tolerance does not set them: after a jump, before
an event, on the pieces of the drive."""
MARGIN = 8.0
"""The largest difference is multiplied by this, in case those solutions are hardly worse."""
FLOOR = 1e-4
"""In units of the tolerance: what lies below it is luck."""

STATEMENT = (
    f"{MARGIN:g} times the largest difference to solutions with {COARSER:g} times the tolerance, one of "
    "them with other steps, and what rounding may do; relative to the static depth, half length and load"
)
NOTHING = "not known: the solutions with a looser tolerance could not be followed to the end"


def certificate(found: Array, others: Sequence[Array], rtol: float) -> Certificate:
    """Return the certificate of the states `found`: rows of `states`, a column for each time."""
    if not others:
        return Certificate("estimated", NOTHING, dict.fromkeys(scaled_quantities(found), np.inf))
    values, compared = scaled_quantities(found), [scaled_quantities(other) for other in others]
    differences = {
        name: max(float(np.max(np.abs(value - other[name]), initial=0.0)) for other in compared)
        for name, value in values.items()
    }
    rounding = _rounding(found)
    return Certificate(
        "estimated",
        STATEMENT,
        {
            name: max(MARGIN * difference, FLOOR * rtol) + rounding.get(name, 0.0)
            if name not in EXACT
            else 0.0
            for name, difference in differences.items()
        },
    )


EXACT = ("time", "velocity")
"""Quantities that are given, not solved for."""


def scaled_quantities(found: Array) -> dict[str, Array]:
    """Return the scaled quantities; in flight both edges are at the axis, where no contact is."""
    edges = np.nan_to_num(found[[evaluation.LEFT, evaluation.RIGHT]])
    zero = np.zeros(1)
    return {
        "time": zero,
        "velocity": zero,
        "depth": found[evaluation.DEPTH],
        "depth_rate": found[evaluation.RATE],
        "normal_force": found[evaluation.NORMAL_FORCE],
        "friction_force": found[evaluation.FRICTION_FORCE],
        "leading_edge": edges,
        "trailing_edge": edges,
        "peak_pressure": found[evaluation.PEAK_PRESSURE],
    }


def _rounding(found: Array) -> dict[str, float]:
    """Return what rounding of the edges may do to them, and to the forces: the pressure there acts."""
    edge, pressure = found[evaluation.ROUNDING], found[evaluation.PEAK_PRESSURE]
    arm = np.nan_to_num(np.maximum(np.abs(found[evaluation.LEFT]), np.abs(found[evaluation.RIGHT])))
    largest = [
        np.max(x, initial=0.0) for x in (edge, 0.75 * pressure * edge, 1.5 * arm * pressure * edge)
    ]
    at_edge, normal, friction = map(float, largest)
    return {
        "leading_edge": at_edge,
        "trailing_edge": at_edge,
        "normal_force": normal,
        "friction_force": friction,
    }
