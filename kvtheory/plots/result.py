"""Any result as a picture: what `plot` of a result and the option of a command draw."""

from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import simpson

from kvtheory.plots.comparison import draw_comparison
from kvtheory.plots.files import save_picture
from kvtheory.plots.style import BLUE, LABELS
from kvtheory.plots.transient import TRANSIENT_ROWS, plot_transient
from kvtheory.results import Comparison, SteadyState

SERIES, STEADY = (5.0, 6.4), (5.0, 3.4)
"""Sizes of the pictures, in inches."""
POINTS = 201
"""Of the pressure over the contact."""
NOT_ITS_LOAD = 1e-6
"""A pressure whose integral, by Simpson's rule, is as far from the load is not that of a parabola."""


def plot_result(result: Any, axes: Any = None, **style: Any) -> Any:
    """Draw a time series, steady sliding or a comparison, and return the figure."""
    if isinstance(result, Comparison):
        return draw_comparison(result)
    steady = isinstance(result, SteadyState)
    if axes is None:
        from matplotlib.figure import Figure

        figure = Figure(figsize=STEADY if steady else SERIES, layout="constrained")
        axes = figure.subplots() if steady else figure.subplots(len(TRANSIENT_ROWS), 1, sharex=True)
    style = {"color": BLUE, **style}
    if not steady:
        plot_transient(axes, result, **style)
        return axes[0].figure
    if np.ndim(result.depth):
        _over_velocity(axes, result, style)
    else:
        _over_contact(axes, result, style)
    return axes.figure


def _over_velocity(ax: Any, state: SteadyState, style: dict[str, Any]) -> None:
    """Draw the friction coefficient over the retardation length."""
    (x_label, x_factor), (y_label, y_factor) = (
        LABELS[name] for name in ("retardation_length", "friction_coefficient")
    )
    x, y = np.ravel(state.retardation_length), np.ravel(state.friction_coefficient)
    order = np.argsort(x)
    ax.plot(x[order] * x_factor, y[order] * y_factor, **style)
    scale = "log" if x.min() > 0.0 and y.min() > 0.0 else "linear"
    ax.set(xlabel=x_label, ylabel=y_label, xscale=scale, yscale=scale)


def _over_contact(ax: Any, state: SteadyState, style: dict[str, Any]) -> None:
    """Draw p = K delta (1 - x^2/a^2 - 2 l_r x/a^2) from edge to edge (Eqs. 8 and 12, for V >= 0)."""
    a, l = float(state.half_length), float(state.retardation_length / state.half_length)
    low, high = sorted((float(state.leading_edge), float(state.trailing_edge)))
    x = np.linspace(low, high, POINTS)
    forward = -1.0 if state.leading_edge > 0.0 else 1.0
    peak = 1.0 + l * l if l < 1.0 else 2.0 * l  # theorem F7
    p = state.peak_pressure / peak * (1.0 - (x / a) ** 2 - 2.0 * l * forward * x / a)
    if abs(simpson(p, x) / state.load - 1.0) > NOT_ITS_LOAD:
        raise ValueError(
            "the pressure is drawn for a parabola only; give several velocities to `over`"
        )
    ax.plot(x * 1e3, p * 1e-6, **style)
    ax.set(xlabel=r"position $x$ [mm]", ylabel=r"pressure $p$ [MPa]")


def save_plot(result: Any, path: Path) -> None:
    """Draw a result and write it as the suffix of `path` says.

    Raises
    ------
    ValueError
        If the name does not end in .png, .svg or .pdf, or the result has no picture.
    OSError
        If the file cannot be written.
    """
    save_picture(lambda: plot_result(result), path)
