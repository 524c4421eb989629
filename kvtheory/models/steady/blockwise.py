"""A formula of steady sliding on all scenes of arrays, block by block, with its certificate."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results import STEADY_UNITS, Certificate, SteadyState, units_for
from kvtheory.scene.model import Scene

BLOCK = 16384
"""Scenes treated at a time: the intermediate arrays of a block stay in the processor's cache."""

QUANTITIES = tuple(STEADY_UNITS)
SMALLEST = float(np.finfo(float).tiny)
ZERO_AT_REST = ("retardation_length", "friction_force", "friction_coefficient")

Array = NDArray[np.float64]


Formula = Callable[[Scene], Sequence[Any]]


def evaluate(
    formula: Formula,
    scene: Scene,
    certificate: Certificate,
    own_errors: tuple[str, ...] = (),
    *,
    floats: bool = False,
    model: str = "exact",
    block: int | None = None,
) -> SteadyState:
    """Return the steady state that `formula` gives for a scene, or for each of its arrays.

    The formula returns the quantities in the order of `STEADY_UNITS` and then the relative errors
    of those in `own_errors`, which replace what the certificate says of them. With `floats` it takes
    floats as well as arrays, which hold at most `block` scenes.

    Raises
    ------
    FloatingPointError
        If a value leaves the range of double precision. A value with its own error may become
        zero, as its error then says.
    """
    shape = scene.shape
    with np.errstate(over="raise", divide="raise", invalid="raise", under="ignore"):
        if shape:
            flat = _arrays(formula, scene.flat(), own_errors, block or BLOCK)
            rows: list[Any] = [row.reshape(shape) for row in flat]
        elif floats:
            rows = [float(each) for each in formula(scene)]
        else:
            one = scene.at(np.array([scene.drive.final_velocity]))
            rows = [float(np.ravel(each)[0]) for each in formula(one)]
    values = rows[: len(QUANTITIES)]
    if shape or not all(SMALLEST <= abs(each) < math.inf for each in values):
        _check_range(np.array(values), scene.drive.final_velocity, own_errors)
    own = dict(zip(own_errors, rows[len(QUANTITIES) :], strict=True))
    errors = {**certificate.relative_error, **own}  # not shared between results
    certificate = Certificate(certificate.kind, certificate.statement, errors)
    units = units_for(scene.indenter, STEADY_UNITS)
    named: dict[str, Any] = dict(zip(QUANTITIES, values, strict=True))
    return SteadyState(**named, model=model, certificate=certificate, units=units)


def converge(
    step_of: Callable[[Array], Array], value: Array, last_step: float, most_steps: int
) -> Array:
    """Return the roots from `value`, element by element, by steps of the logarithm.

    An element is left alone after its first step that is no longer than `last_step`, so that no result
    depends on the others of its block.
    """
    active = np.full(value.shape, True)
    for _ in range(most_steps):
        step = step_of(value)
        value = np.where(active, value * np.exp(-step), value)
        active &= np.abs(step) > last_step
        if not active.any():
            break
    return value


def cube_root(value: Array) -> Array:
    """Return the cube root to a unit in the last place: that of some C libraries is four off.

    >>> float(cube_root(np.array(27.0)))
    3.0
    """
    root = np.cbrt(value)
    return root - (root - value / (root * root)) / 3.0


def _arrays(formula: Formula, flat: Scene, own_errors: tuple[str, ...], block: int) -> Array:
    """Return what the formula gives for flat scenes, block by block."""
    (size,) = flat.shape
    result = np.empty((len(QUANTITIES) + len(own_errors), size))
    for start in range(0, size, block):
        part = slice(start, start + block)
        for row, found in zip(result, formula(flat.rows(part)), strict=True):
            row[part] = found
    return result


def _check_range(values: Array, velocity: Any, own_errors: tuple[str, ...]) -> None:
    """Raise if a value is not finite, or lost digits below the smallest normal number.

    Zero is correct only at rest, or where the value's own error covers it.
    """
    size = np.abs(values)
    if not size.size or (size.min() >= SMALLEST and size.max() < math.inf):
        return
    lost = size < SMALLEST
    lost[[QUANTITIES.index(name) for name in ZERO_AT_REST]] &= velocity != 0.0
    lost[[QUANTITIES.index(name) for name in own_errors]] = False
    for wrong, what in ((~np.isfinite(values), "overflow"), (lost, "underflow")):
        if wrong.any():
            row = wrong.reshape(len(values), -1).any(axis=1).argmax()
            raise FloatingPointError(f"{what} in {QUANTITIES[int(row)]}")
