"""Results drawn on matplotlib axes: each function takes axes and a result, and returns the artists."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kvtheory.results import AsymptoteReport, SteadyState

BLACK, BLUE, RED, GREEN, PURPLE = "#000000", "#0072b2", "#d55e00", "#009e73", "#aa4499"
"""Colours that stay apart in colour blindness (after Okabe and Ito); lines differ in dashes too."""

STYLE: Any = {
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 10,
    "font.size": 9,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "mathtext.fontset": "dejavusans",
    "savefig.dpi": 200,
    "svg.fonttype": "path",
    "svg.hashsalt": "kvtheory",
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
}
"""For `matplotlib.rc_context`."""

LABELS = {
    "velocity": (r"drive velocity $V$ [mm/s]", 1e3),
    "depth": (r"depth $\delta$ [mm]", 1e3),
    "load": (r"load $W$ [N/mm]", 1e-3),
    "friction_force": (r"friction force $F$ [N/mm]", 1e-3),
    "friction_coefficient": (r"friction coefficient $\mu$", 1.0),
}
"""Axis label of a quantity, in the paper's units, and the factor from SI."""


def plot_steady(
    ax: Any, velocity: ArrayLike, state: SteadyState, quantity: str, **style: Any
) -> list[Any]:
    """Draw a quantity of steady sliding over the drive velocity (m/s), on logarithmic axes.

    >>> import kvtheory as kv
    >>> from matplotlib.figure import Figure
    >>> V = [0.01, 0.1, 1.0]
    >>> (line,) = plot_steady(Figure().subplots(), V, kv.steady(over={"drive.velocity": V}), "depth")
    >>> line.get_ydata().round(4).tolist()
    [0.2814, 0.0897, 0.0098]
    """
    (x_label, x_factor), (y_label, y_factor) = LABELS["velocity"], LABELS[quantity]
    x, y = np.asarray(velocity) * x_factor, np.asarray(getattr(state, quantity)) * y_factor
    ax.set(xlabel=x_label, ylabel=y_label, xscale="log", yscale="log")
    artists: list[Any] = ax.plot(x, y, **style)
    return artists


def plot_asymptote_errors(ax: Any, report: AsymptoteReport, styles: Mapping[str, Any]) -> list[Any]:
    """Draw |asymptote/exact - 1| over V/V* for each line of the report that `styles` names."""
    ratio = np.abs(report.velocity) / report.critical_velocity
    artists = []
    for line in report.lines:
        if line.name in styles:
            artists += ax.plot(ratio, np.abs(line.relative_error), **styles[line.name])
    ax.set(xlabel=r"$V/V^*$", ylabel="relative error of the asymptote", xscale="log", yscale="log")
    return artists
