"""Error of a run, estimated from runs with half as many elements in two placements."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from kvtheory.models.elements.model import Model
from kvtheory.models.elements.schemes import DEFAULT
from kvtheory.results import SERIES_UNITS, Certificate
from kvtheory.results.certificate import AT_REST
from kvtheory.results.table import scales
from kvtheory.scene.base_motion import POWERS, BaseMotion

SAFETY = 4.0
"""Factor on the estimated errors: a difference can be small by chance. With one coarse run a bound was
exceeded in one of a hundred random scenes, by any factor; two, whose elements are half a spacing apart,
are seldom both small by chance."""
KNOWN = 0.5
"""Uncertainty of an edge, in elements, after a change of the drive, if a damper leaves pressure on it."""
KINKED = 0.05
"""Uncertainty of an edge, in elements, under a shape with kinks, whose overlap is straight anywhere."""
ROUNDING = 1e-12
"""Least error, due to rounding, where a method is exact."""
SHIFTS = (0.0, 0.5)
"""Offsets of the elements of the coarse runs, in spacings."""
RELATIVE_TO = (
    "of the scene at rest: depth relative to δ_0, its rate to δ_0/τ, edges to a_0, normal force to W_0, "
    "friction force to W_0 δ_0/a_0, pressure to K δ_0"
)
ON_SPRING = ", sliding velocity to a_0/τ, spring force as friction"
UNKNOWN = Certificate("none", "no error was estimated, since certify=False", {}, AT_REST)

Rows = dict[str, Any]
DOUBTS = ("peak_doubt", "edge_doubt")
COLUMNS = (*SERIES_UNITS, *DOUBTS)
"""Of a report: a time series as on a spring, and by how much the pressure differs between the elements
beside its peak, inside the contact and at its edge (Pa)."""


def estimate(
    model: Model, path: BaseMotion, h: float, rows: Rows, coarse: Sequence[Rows], fine: Sequence[Rows]
) -> Certificate:  # fmt: skip
    """Compare with other runs of the best scheme; an edge that exists in one of two is not compared.

    Let the error of this run be e and that of the best scheme at this density c, at half of it 4 c: the
    sum of both differences, |e - 4 c| + |e - c|, is at least 3/4 |e|. For the best scheme it is 3 |e|.
    """
    scale = scales(model.at_rest)
    differences = {
        name: max(_apart(rows, other, name) for other in coarse)
        + sum(_apart(rows, other, name) for other in fine)
        for name in scale
    }
    changes = len(path.pieces) > 1 or any(path.pieces[0][POWERS + 1 :])
    known = KNOWN if (model.law.damping > 0.0 or (model.law.arm_time < h).any()) else 0.0
    jump = known if changes else 0.0
    # On a spring, edges stop and turn without a jump of the pressure.
    edge = (
        max(jump, known if model.sprung else 0.0) + (KINKED if model.indenter.kinks else 0.0)
    ) * model.spacing
    width = 1.0 if model.indenter.per_width else 2.0 * model.half_width(model.depth)
    force = jump * model.spacing * width * float(rows["peak_pressure"].max())
    differences["leading_edge"] += edge
    differences["trailing_edge"] += edge
    differences["normal_force"] += force
    differences["friction_force"] += force * model.steepest
    differences["peak_pressure"] += float(
        rows["peak_doubt"].max() + jump * rows["edge_doubt"].max()
    )
    runs = "half as many elements and steps" + ", and as many" * bool(fine)
    return Certificate(
        "estimated",
        f'{SAFETY:g} times the largest difference to the scheme "{DEFAULT}" with {runs}, {RELATIVE_TO}'
        + ON_SPRING * model.sprung,
        {name: max(SAFETY * d / scale[name], ROUNDING) for name, d in differences.items()},
        AT_REST,
    )


def _apart(rows: Rows, other: Rows, name: str) -> float:
    return float(np.nanmax(np.abs(rows[name] - other[name]), initial=0.0))
