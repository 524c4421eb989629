"""Steady sliding of scenes on the body itself, as a result with its errors."""

import math
from typing import Any

import numpy as np

from kvtheory.layer.body import Body, Support
from kvtheory.layer.sliding import Sliding, at_rest, slide
from kvtheory.progress import Progress
from kvtheory.results import STEADY_UNITS, Certificate, PressureField, SteadyState, units_for
from kvtheory.scene.model import Scene

RTOL = {True: 1e-3, False: 1e-2}
"""Largest relative error of depth, load and friction: of a line, of a ball."""
AT_REST = 1e-2
"""The same of the contact at rest, of which only the length is used."""
FOUND = (
    "depth", "load", "friction_force", "friction_coefficient", "leading_edge", "trailing_edge",
    "peak_pressure",
)  # fmt: skip
WITH_ERROR = (*FOUND, "half_length")
STATEMENT = (
    "boundary elements of the body, on cells that become shorter by factors of two; the errors follow from "
    "the changes between the last grids"
)
RELATIVE_TO = "the true value, of edges the length of the contact"
SINGULAR = (
    "The peak pressure is infinite: the body enters the contact on a damper without arms, or an edge of the "
    "indenter presses."
)


def solve(scene: Scene, report: Progress) -> SteadyState:
    """Return steady sliding of a scene, or of each of its arrays, on the body of its foundation.

    The half length is that of the body at rest at the depth of sliding. Where in a body power is dissipated
    is not known: `dissipated_in_contact` is NaN.
    """
    size, flat = scene.shape, scene.flat()
    scenes = [flat.rows(i) for i in range(math.prod(size))] if size else [scene]
    rows: list[list[float]] = []
    fields: list[PressureField] = []
    for each in scenes:
        shape, body = each.indenter, Body.of_foundation(each.foundation)
        velocity, support = float(each.drive.final_velocity), Support.of_scene(each.support)
        found = slide(shape, body, velocity, support, RTOL[shape.per_width])
        held = at_rest(shape, *body[:3], Support(found.depth), AT_REST)
        rows.append(_row(each, found, held))
        fields = [] if size else [_field(found)]
        report(len(rows) / len(scenes), f"{len(rows):,} of {len(scenes):,} scenes")
    names = [*WITH_ERROR, "retardation_length", *WITH_ERROR]
    table = np.array(rows, dtype=float).reshape(len(scenes), len(names)).T
    columns = [column.reshape(size) if size else float(column[0]) for column in table]
    values: dict[str, Any] = dict(zip(names, columns[: -len(WITH_ERROR)], strict=False))
    errors = dict(zip(WITH_ERROR, columns[-len(WITH_ERROR) :], strict=True))
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
    length = found.trailing_edge - found.leading_edge
    half_length = 0.5 * (held.trailing_edge - held.leading_edge)
    half_error = 0.5 * (held.errors["leading_edge"] + held.errors["trailing_edge"])
    values = [getattr(found, name) for name in FOUND]
    errors = [
        _relative(found.errors[name], length if name.endswith("edge") else value)
        for name, value in zip(FOUND, values, strict=True)
    ]
    retardation_length = abs(scene.drive.final_velocity) * scene.foundation.retardation_time
    return [*values, half_length, retardation_length, *errors, half_error / half_length]


def _field(found: Sliding) -> PressureField:
    """Return the pressure of a line, or on both halves of a ball."""
    if found.pressure.shape[1] == 1 and not found.y[0]:
        return PressureField(found.x, found.y, found.pressure)
    both = np.concatenate([found.pressure[:, ::-1], found.pressure], axis=1)
    return PressureField(found.x, np.concatenate([-found.y[::-1], found.y]), both)


def _relative(error: float, value: float) -> float:
    """Return a relative error; what is known exactly, zero or infinite, has none."""
    return error / abs(value) if error else 0.0
