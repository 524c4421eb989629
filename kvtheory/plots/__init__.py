"""Results drawn on matplotlib axes: each function takes axes and a result, and returns the artists."""

from kvtheory.plots.comparison import plot_comparison, save_comparison_plot
from kvtheory.plots.result import plot_result, save_plot
from kvtheory.plots.steady import plot_asymptote_errors, plot_steady
from kvtheory.plots.style import BLACK, BLUE, GREEN, LABELS, PURPLE, RED, STYLE
from kvtheory.plots.sweep import plot_sweep, save_sweep_plot
from kvtheory.plots.transient import plot_pressure, plot_transient

__all__ = [
    "BLACK",
    "BLUE",
    "GREEN",
    "LABELS",
    "PURPLE",
    "RED",
    "STYLE",
    "plot_asymptote_errors",
    "plot_comparison",
    "plot_pressure",
    "plot_result",
    "plot_steady",
    "plot_sweep",
    "plot_transient",
    "save_comparison_plot",
    "save_plot",
    "save_sweep_plot",
]
