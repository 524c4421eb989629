"""Fig. 5 of the paper: steady sliding over the drive velocity, for both models and three tau.

Lines are the exact solution, points the quadrature, which shares no code with it.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, RED, plot_steady

SUPPORTS = {"fixed": "FI model (fixed indenter)", "dead-weight": "MI model (dead weight)"}
QUANTITIES = {"depth": "m", "load": "N/m", "friction_force": "N/m", "friction_coefficient": "1"}
TIMES = {
    0.01: {"color": BLACK, "linestyle": "-", "label": r"$\tau = 10^{-2}$ s"},
    0.1: {"color": BLUE, "linestyle": "--", "label": r"$\tau = 10^{-1}$ s"},
    1.0: {"color": RED, "linestyle": "-.", "label": r"$\tau = 10^{0}$ s"},
}
VELOCITIES = np.geomspace(1e-4, 10.0, 201)
EVERY = 20
"""The quadrature is evaluated at every twentieth velocity."""


@dataclass(frozen=True)
class Data:
    """Exact curves and quadrature points by (support, tau), and both as one table."""

    curves: dict[tuple[str, float], Any]
    points: dict[tuple[str, float], Any]
    columns: drawing.Columns


def compute() -> Data:
    """Solve both models for each retardation time."""
    curves, points = {}, {}
    for support in SUPPORTS:
        scene = kv.Scene.table1(support)
        for tau in TIMES:
            over = {"drive.velocity": VELOCITIES, "foundation.retardation_time": tau}
            curves[support, tau] = kv.steady(scene, over=over)
            sparse = {**over, "drive.velocity": VELOCITIES[::EVERY]}
            points[support, tau] = kv.steady(scene, over=sparse, method="quadrature")
    return Data(curves, points, _columns(curves, points))


def draw(data: Data) -> Figure:
    """Draw the eight panels."""
    drawn = drawing.figure(6.4, 8.6)
    axes = drawn.subplots(4, 2, sharex=True, sharey="row")
    for column, (support, title) in zip(axes.T, SUPPORTS.items(), strict=True):
        for ax, quantity in zip(column, QUANTITIES, strict=True):
            for tau, style in TIMES.items():
                plot_steady(ax, VELOCITIES, data.curves[support, tau], quantity, **style)
                plot_steady(
                    ax, VELOCITIES[::EVERY], data.points[support, tau], quantity,
                    color=style["color"], linestyle="", marker="o", fillstyle="none", markersize=4,
                )  # fmt: skip
            ax.label_outer()
        column[0].set_title(title)
    axes[0, 0].set_ylim(1e-5, 1.0)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    (point,) = axes[0, 0].plot([], [], "ko", fillstyle="none", markersize=4)
    axes[0, 0].legend([*handles, point], [*labels, "quadrature"], loc="lower left", ncols=2)
    return drawn


def _columns(curves: dict[Any, Any], points: dict[Any, Any]) -> drawing.Columns:
    rows: dict[str, list[Any]] = {
        "support": [],
        "method": [],
        "retardation_time [s]": [],
        "velocity [m/s]": [],
    }
    rows |= {f"{name} [{unit}]": [] for name, unit in QUANTITIES.items()}
    for states, velocities in ((curves, VELOCITIES), (points, VELOCITIES[::EVERY])):
        for (support, tau), state in states.items():
            count = velocities.size
            rows["support"] += [support] * count
            rows["method"] += [state.model] * count
            rows["retardation_time [s]"] += [tau] * count
            rows["velocity [m/s]"] += velocities.tolist()
            for name, unit in QUANTITIES.items():
                rows[f"{name} [{unit}]"] += getattr(state, name).tolist()
    return rows


if __name__ == "__main__":
    drawing.run("fig5", compute, draw)
