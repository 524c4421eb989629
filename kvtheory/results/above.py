"""Methods of results that are implemented in higher rooms: drawing and writing, imported on call.

Results are below everything that draws or writes them, which avoids circular imports. Only this module
names the functions above, and only `above` imports them.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Any

ABOVE = {
    "compared": "kvtheory.export",
    "dataset": "kvtheory.export",
    "plot_result": "kvtheory.plots.result",
    "plot_sweep": "kvtheory.plots.sweep",
    "save_compared": "kvtheory.export",
    "save_csv": "kvtheory.export",
    "save_result": "kvtheory.export",
    "save_sweep": "kvtheory.sweeps.files",
}
"""The functions that methods of results call, and their modules."""


def above(name: str) -> Callable[..., Any]:
    """Return the function of this name from its module above the results.

    >>> above("plot_sweep").__module__
    'kvtheory.plots.sweep'
    """
    found: Callable[..., Any] = getattr(import_module(ABOVE[name]), name)
    return found
