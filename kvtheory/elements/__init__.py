"""The discrete simulator: point elements that move with the base, any shape, support and drive.

Its names are loaded when they are asked for: `kvtheory` loads this package at once, so that its name
there can stand for the function `kvtheory.elements`, and SciPy takes a while.
"""

from importlib import import_module
from typing import Any

_PLACES = {
    "DEFAULT": "schemes",
    "DivergenceError": "watch",
    "SCHEMES": "schemes",
    "Scheme": "schemes",
    "contact_lengths": "stability",
    "simulate": "simulation",
    "stability_limit": "stability",
}


def __getattr__(name: str) -> Any:
    """Return one of the names of this package."""
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
