"""Steady sliding of scenes on the body itself, as a result with its errors."""

import math
from typing import Any

import numpy as np

from kvtheory.layer.body import Body, Support
from kvtheory.layer.sliding import CONVERGED, Sliding, at_rest, slide
from kvtheory.progress import Progress
from kvtheory.results import STEADY_UNITS, Certificate, PressureField, SteadyState, units_for
from kvtheory.scene.model import Scene

RTOL = {True: 1e-3, False: 1e-2}
"""Largest relative error of depth, load and friction where none is given: of a line, of a ball."""
SMALLEST = {True: 1e-6, False: 1e-4}
"""Relative error that the finest grid reaches at best."""
AT_REST = 1e-2
"""Largest relative error of the contact at rest, where only its length is told."""
FOUND = (
    "depth", "load", "friction_force", "friction_coefficient", "leading_edge", "trailing_edge",
    "peak_pressure",
)  # fmt: skip
EDGES, HALF_LENGTH = FOUND[4:6], "half_length"
WITH_ERROR = (*FOUND, HALF_LENGTH)
STATEMENT = (
    "boundary elements of the body, on cells that become shorter by factors of two; the errors follow from "
    "the changes between the last grids"
)
RELATIVE_TO = "the true value, of edges the length of the contact"
SINGULAR = (
    "The peak pressure is infinite: the body enters the contact on a damper without arms, or an edge of the "
    "indenter presses."
)


def solve(
    scene: Scene, report: Progress, rtol: float | None = None, names: tuple[str, ...] = CONVERGED
) -> SteadyState:
    """Return steady sliding of a scene, or of each of its arrays, on the body of its foundation.

    The quantities `names` are within `rtol`. The half length is that of the body at rest at the depth of
    sliding. Where in a body power is dissipated is not known: `dissipated_in_contact` is NaN.
    """
    size, flat = scene.shape, scene.flat()
    scenes = [flat.rows(i) for i in range(math.prod(size))] if size else [scene]
    rows: list[list[float]] = []
    fields: list[PressureField] = []
    moving = tuple(name for name in names if name != HALF_LENGTH)

    def within(share: float, words: str) -> None:
        report((len(rows) + share) / len(scenes), words)

    for each in scenes:
        shape, body = each.indenter, Body.of_foundation(each.foundation)
        velocity, support = float(each.drive.final_velocity), Support.of_scene(each.support)
        wanted = rtol or RTOL[shape.per_width]
        found = slide(shape, body, velocity, support, wanted, moving or CONVERGED, within)
        rest = (0.5 * wanted, EDGES) if HALF_LENGTH in names else (AT_REST,)
        held = at_rest(shape, body[:3], Support(found.depth), *rest)
        rows.append(_row(each, found, held))
        fields = [] if size else [_field(found)]
        report(len(rows) / len(scenes), f"{len(rows):,} of {len(scenes):,} scenes")
    known = *WITH_ERROR, "retardation_length"
    table = np.array(rows, dtype=float).reshape(len(scenes), len(known) + len(WITH_ERROR)).T
    columns = [column.reshape(size) if size else float(column[0]) for column in table]
    values: dict[str, Any] = dict(zip(known, columns, strict=False))
    errors = dict(zip(WITH_ERROR, columns[len(known) :], strict=True))
    return SteadyState(
        **values,
        dissipated_in_contact=np.full(size, math.nan) if size else math.nan,
        model="layer",
        certificate=Certificate("estimated", STATEMENT, errors, RELATIVE_TO),
        pressure_field=fields[0] if fields else None,
        units=units_for(scene.indenter, STEADY_UNITS),
        notes=(SINGULAR,) if np.isinf(values["peak_pressure"]).any() else (),
    )


def _row(scene: Scene, found: Sliding, held: Sliding) -> list[float]:
    """Return the quantities of one scene, and then the relative errors of those `WITH_ERROR`."""
    values = [getattr(found, name) for name in FOUND]
    errors = [found.relative_error(name) for name in FOUND]
    half_length = 0.5 * (held.trailing_edge - held.leading_edge)
    half_error = sum(held.relative_error(name) for name in EDGES)
    retardation_length = abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    return [*values, half_length, retardation_length, *errors, half_error]


def _field(found: Sliding) -> PressureField:
    """Return the pressure of a line, or on both halves of a ball."""
    if found.pressure.shape[1] == 1 and not found.y[0]:
        return PressureField(found.x, found.y, found.pressure)
    both = np.concatenate([found.pressure[:, ::-1], found.pressure], axis=1)
    return PressureField(found.x, np.concatenate([-found.y[::-1], found.y]), both)
