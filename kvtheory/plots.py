"""Results drawn on matplotlib axes: each function takes axes and a result, and returns the artists."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kvtheory.results import AsymptoteReport, SteadyState, Transient

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


TRANSIENT_ROWS = (
    ("velocity", r"$V$ [mm/s]", 1e3),
    ("depth", r"$z_\mathrm{A}$ [mm]", -1e3),
    ("normal_force", r"$F_z$ [N/mm]", 1e-3),
    ("friction_force", r"$F_x$ [N/mm]", 1e-3),
)
"""The rows of Fig. 3 of the paper: quantity, axis label, factor from SI."""


def plot_transient(axes: Sequence[Any], result: Transient, **style: Any) -> list[Any]:
    """Draw velocity, position, normal and friction force over time on four axes, as in Fig. 3.

    The rest before t = 0 is drawn too, for a twentieth of the time shown: V and F_x are zero there.
    """
    time = np.asarray(result.time) * 1e3
    before = np.array([-0.05 * time[-1], 0.0])
    rest = {"velocity": 0.0, "friction_force": 0.0, "depth": result.depth[0]}
    rest["normal_force"] = result.solution.units.load
    artists = []
    for ax, (name, label, factor) in zip(axes, TRANSIENT_ROWS, strict=True):
        values = np.concatenate([[rest[name]] * 2, getattr(result, name)]) * factor
        artists += ax.plot(np.concatenate([before, time]), values, **style)
        ax.set(ylabel=label)
    axes[-1].set(xlabel=r"time $t$ [ms]")
    return artists


def plot_pressure(ax: Any, result: Transient, positions: ArrayLike, times: ArrayLike) -> Any:
    """Shade the contact pressure over position (m) and time (s), with both edges, as in Fig. 4."""
    x, t = np.asarray(positions), np.asarray(times)
    p = np.array([result.pressure(x, float(time)) for time in t])
    image = ax.pcolormesh(
        x * 1e3, t * 1e3, p / 1e6, cmap="Reds", shading="gouraud", rasterized=True
    )
    for edge, dashes, name in (
        ("leading_edge", "-", "leading edge"),
        ("trailing_edge", "--", "trailing edge"),
    ):
        edges = np.asarray(getattr(result, edge)) * 1e3
        ax.plot(edges, np.asarray(result.time) * 1e3, color=BLUE, linestyle=dashes, label=name)
    ax.set(xlabel=r"position $x$ [mm]", ylabel=r"time $t$ [ms]")
    return image


def save_transient_plot(result: Transient, path: Path) -> None:
    """Draw a transient as in Fig. 3 and write it as the suffix of `path` says.

    Raises
    ------
    ValueError
        If matplotlib does not know the suffix.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    from kvtheory.export import replace_file

    with mpl.rc_context({**STYLE}):
        figure = Figure(figsize=(5.0, 6.4), layout="constrained")
        if path.suffix[1:] not in figure.canvas.get_supported_filetypes():
            raise ValueError(f'--plot "{path}": expected a name that ends in .png, .svg or .pdf')
        plot_transient(figure.subplots(4, 1, sharex=True), result, color=BLUE)
        replace_file(path, figure.savefig)
