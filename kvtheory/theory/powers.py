"""Powers and roots of numbers, or of arrays element by element."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

SPECIAL = ((2.0, np.square), (0.5, np.sqrt), (-1.0, np.reciprocal))
"""Exponents for which NumPy may use a special routine, with other rounding."""


def power(base: Any, exponent: Any) -> Any:
    """Return base^exponent, to the same bits however many scenes are in an array."""
    if not isinstance(exponent, np.ndarray):
        return base**exponent
    special = [(exponent == value, routine) for value, routine in SPECIAL]
    for chosen, routine in special:
        if chosen.all():
            return routine(base)
    found = base**exponent
    for chosen, routine in special:
        found = np.where(chosen, routine(base), found) if chosen.any() else found
    return found


Array = NDArray[np.float64]


def converge(
    step_of: Callable[[Array], Array], value: Array, last_step: float, most_steps: int
) -> Array:
    """Return the roots from `value` > 0 by steps of the logarithm, each final after a short enough step."""
    active = value > 0.0
    for _ in range(most_steps):
        step = step_of(value)
        value = np.where(active, value * np.exp(-step), value)[()]
        active = active & (abs(step) > last_step)
        if not np.any(active):
            break
    return value


def cube_root(value: Array) -> Array:
    """Return the cube root to a unit in the last place; some C libraries are off by four."""
    root = np.cbrt(value)
    return root - (root - value / (root * root)) / 3.0


def root(base: Array, degree: Array) -> Array:
    """Return base^(1/degree), with a Newton step that corrects the rounding of 1/degree."""
    found = base ** (1.0 / degree)
    return found * (1.0 - (found**degree / base - 1.0) / degree)
