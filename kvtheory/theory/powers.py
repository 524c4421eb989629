"""Powers of numbers and arrays."""

from typing import Any

import numpy as np

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
