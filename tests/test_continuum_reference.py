"""The solver of the transient against the frozen table of an independent solution, in each regime.

The table (`tests/transient_reference.py`) comes from Taylor series, SciPy's integrators on the two-state
form, and the supremum over the whole past at points of the foundation; it states its error.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from kvtheory.models.continuum.solver import solve
from kvtheory.scene.base_motion import BaseMotion

TABLE = json.loads((Path(__file__).parent / "data" / "transient_reference.json").read_text())
RTOL, ALLOWED = 1e-9, 1e-8
"""At rtol 1e-9 every quantity is within 1e-8 of the static state, or of the largest value met."""

NAMES = {
    "d": "depth",
    "v": "rate",
    "f_z": "normal_force",
    "f_x": "friction_force",
    "left": "left",
    "right": "right",
}


def drive(found, end):
    if isinstance(found, list):
        return BaseMotion.from_points(found, end)
    mean, amplitude, frequency = (found[k] for k in ("mean", "amplitude", "frequency"))
    return BaseMotion.from_function(lambda s: mean + amplitude * math.cos(frequency * s), end)


@pytest.mark.parametrize("name", TABLE)
def test_every_quantity_agrees_with_the_independent_solution(name):
    scene = TABLE[name]
    times = scene["times"]
    kappa = math.inf if scene["epsilon"] is None else scene["kappa"]
    motion = solve(
        drive(scene["drive"], times[-1]), scene["epsilon"] or 1.0, kappa, times[-1], RTOL
    )
    moments = [motion.at(s) for s in times]
    worst = 0.0
    for quantity, attribute in NAMES.items():
        truth = np.array(scene["values"][quantity], dtype=float)
        stated = np.array(scene["errors"][quantity], dtype=float)
        found = np.array([getattr(moment, attribute) for moment in moments])
        assert np.array_equal(np.isnan(found), np.isnan(truth)), quantity
        scale = max(1.0, np.nanmax(np.abs(truth), initial=0.0))
        worst = max(worst, np.nanmax(np.abs(found - truth) - stated, initial=0.0) / scale)
    assert worst <= ALLOWED
