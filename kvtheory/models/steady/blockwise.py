"""A formula of steady sliding on whole arrays: broadcast, block by block, with its certificate."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.results import STEADY_UNITS, Certificate, SteadyState

BLOCK = 16384
"""Scenes treated at a time: the intermediate arrays of a block stay in the processor's cache."""

QUANTITIES = tuple(STEADY_UNITS)
ZERO_AT_REST = ("retardation_length", "friction_force", "friction_coefficient")

Array = NDArray[np.float64]


def evaluate(
    formula: Callable[..., tuple[Array, ...]],
    arguments: Sequence[ArrayLike],
    velocity: ArrayLike,
    certificate: Certificate,
    own_errors: tuple[str, ...] = (),
) -> SteadyState:
    """Return the steady state that `formula` gives for the broadcast arguments.

    The formula returns the quantities in the order of `STEADY_UNITS` and then the relative errors
    of those in `own_errors`, which replace what the certificate says of them.

    Raises
    ------
    FloatingPointError
        If a value leaves the range of double precision. A value with its own error may become
        zero, as its error then says.
    """
    arrays = np.broadcast_arrays(
        *(np.asarray(argument, dtype=float) for argument in (*arguments, velocity))
    )
    shape, size = arrays[0].shape, arrays[0].size
    flat = [array.reshape(-1) for array in arrays]
    result = np.empty((len(QUANTITIES) + len(own_errors), size))
    with np.errstate(over="raise", divide="raise", invalid="raise", under="ignore"):
        for start in range(0, size, BLOCK):
            part = slice(start, start + BLOCK)
            # NumPy takes a power otherwise where one exponent is repeated than where each has its own.
            values = formula(*(np.ascontiguousarray(array[part]) for array in flat[:-1]))
            for row, found in zip(result, values, strict=True):
                row[part] = found
    _check_underflow(result[: len(QUANTITIES)], flat[-1], own_errors)
    rows = [row.reshape(shape) if shape else float(row[0]) for row in result]
    quantities: dict[str, Any] = dict(zip(QUANTITIES, rows, strict=False))
    own_rows = dict(zip(own_errors, rows[len(QUANTITIES) :], strict=True))
    own = replace(certificate, relative_error={**certificate.relative_error, **own_rows})
    return SteadyState(**quantities, model="exact", certificate=own)


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


def _check_underflow(result: Array, velocity: Array, own_errors: tuple[str, ...]) -> None:
    """Raise if digits were lost below the smallest normal number; zero is correct only at rest."""
    lost = np.abs(result) < np.finfo(float).tiny
    lost[[QUANTITIES.index(name) for name in ZERO_AT_REST]] &= velocity != 0.0
    lost[[QUANTITIES.index(name) for name in own_errors]] = False
    if lost.any():
        raise FloatingPointError(f"underflow in {QUANTITIES[int(lost.any(axis=1).argmax())]}")
