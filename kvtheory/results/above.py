"""What results offer although it is done above them: drawing and writing, imported when asked for.

Results stand below everything that draws or writes them, so that no circle of imports is left. This
is the one place that names what is above, and `above` the one way there.
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
"""The functions that methods of results call, and the modules that hold them."""


def above(name: str) -> Callable[..., Any]:
    """Return the function of this name from its module above the results.

    >>> above("plot_sweep").__module__
    'kvtheory.plots.sweep'
    """
    found: Callable[..., Any] = getattr(import_module(ABOVE[name]), name)
    return found
