"""A formula of steady sliding on all scenes of arrays, block by block, with its certificate."""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results import STEADY_UNITS, Certificate, SteadyState, units_for
from kvtheory.scene.model import Scene

BLOCK = 16384
"""Scenes treated at a time: the intermediate arrays of a block stay in the processor's cache."""

QUANTITIES = tuple(STEADY_UNITS)
ZERO_AT_REST = ("retardation_length", "friction_force", "friction_coefficient")

Array = NDArray[np.float64]


def evaluate(
    formula: Callable[[Scene], Sequence[Any]],
    scene: Scene,
    certificate: Certificate,
    own_errors: tuple[str, ...] = (),
    *,
    floats: bool = False,
) -> SteadyState:
    """Return the steady state that `formula` gives for a scene, or for each of its arrays.

    The formula returns the quantities in the order of `STEADY_UNITS` and then the relative errors
    of those in `own_errors`, which replace what the certificate says of them. With `floats` it takes
    floats as well as arrays.

    Raises
    ------
    FloatingPointError
        If a value leaves the range of double precision. A value with its own error may become
        zero, as its error then says.
    """
    shape = scene.shape
    with np.errstate(over="raise", divide="raise", invalid="raise", under="ignore"):
        if shape:
            flat = _arrays(formula, scene.flat(), own_errors)
            rows: list[Any] = [row.reshape(shape) for row in flat]
        elif floats:
            rows = [float(each) for each in formula(scene)]
        else:
            one = scene.at(np.array([scene.drive.final_velocity]))
            rows = [float(np.ravel(each)[0]) for each in formula(one)]
    if not shape:
        _check_range(rows, scene.drive.final_velocity, own_errors)
    quantities: dict[str, Any] = dict(zip(QUANTITIES, rows, strict=False))
    own = dict(zip(own_errors, rows[len(QUANTITIES) :], strict=True))
    certificate = replace(certificate, relative_error={**certificate.relative_error, **own})
    units = units_for(scene.indenter, STEADY_UNITS)
    return SteadyState(**quantities, model="exact", certificate=certificate, units=units)


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


def _arrays(formula: Any, flat: Scene, own_errors: tuple[str, ...]) -> Array:
    """Return what the formula gives for flat scenes, block by block."""
    (size,) = flat.shape
    result = np.empty((len(QUANTITIES) + len(own_errors), size))
    for start in range(0, size, BLOCK):
        part = slice(start, start + BLOCK)
        for row, found in zip(result, formula(flat.rows(part)), strict=True):
            row[part] = found
    _check_underflow(result[: len(QUANTITIES)], flat.drive.final_velocity, own_errors)
    return result


def _check_range(values: Sequence[float], velocity: float, own_errors: tuple[str, ...]) -> None:
    """Raise if a value is not finite, or lost digits below the smallest normal number."""
    for name, value in zip(QUANTITIES, values, strict=False):
        if not math.isfinite(value):
            raise FloatingPointError(f"overflow in {name}")
        small = abs(value) < SMALLEST and name not in own_errors
        if small and (name not in ZERO_AT_REST or velocity != 0.0):
            raise FloatingPointError(f"underflow in {name}")


SMALLEST = float(np.finfo(float).tiny)


def _check_underflow(result: Array, velocity: Any, own_errors: tuple[str, ...]) -> None:
    """Raise if digits were lost below the smallest normal number; zero is correct only at rest."""
    lost = np.abs(result) < SMALLEST
    lost[[QUANTITIES.index(name) for name in ZERO_AT_REST]] &= velocity != 0.0
    lost[[QUANTITIES.index(name) for name in own_errors]] = False
    if lost.any():
        raise FloatingPointError(f"underflow in {QUANTITIES[int(lost.any(axis=1).argmax())]}")
