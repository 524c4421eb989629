"""Results drawn on matplotlib axes: each function takes axes and a result, and returns the artists."""

from kvtheory.plots.comparison import plot_comparison
from kvtheory.plots.result import (
    plot_asymptote_errors,
    plot_pressure,
    plot_result,
    plot_steady,
    plot_transient,
    save_plot,
)
from kvtheory.plots.style import BLACK, BLUE, GREEN, LABELS, PURPLE, RED, STYLE
from kvtheory.plots.sweep import plot_sweep

__all__ = [
    "BLACK", "BLUE", "GREEN", "LABELS", "PURPLE", "RED", "STYLE", "plot_asymptote_errors",
    "plot_comparison", "plot_pressure", "plot_result", "plot_steady", "plot_sweep", "plot_transient",
    "save_plot",
]  # fmt: skip
