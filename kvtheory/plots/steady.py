"""Steady sliding."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kvtheory.plots.style import LABELS
from kvtheory.results import AsymptoteReport, SteadyState


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
