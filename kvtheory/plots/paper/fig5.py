"""Fig. 5 of the paper: steady sliding over the drive velocity, for both models and three tau.

Lines are the exact solution, points the quadrature, which shares no code with it.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from kvtheory.api import steady
from kvtheory.plots.paper.models import SUPPORTS, Columns, sliding
from kvtheory.plots.result import plot_steady
from kvtheory.plots.style import Picture
from kvtheory.scene import Scene
from kvtheory.scene.static_state import StaticState

QUANTITIES = {"depth": "m", "load": "N/m", "friction_force": "N/m", "friction_coefficient": "1"}
STYLES: tuple[dict[str, Any], ...] = (
    {"color": "C2", "linestyle": "-"},
    {"color": "C0", "linestyle": "--"},
    {"color": "C1", "linestyle": "-."},
)
"""Of a tenth of the retardation time of the scene, of the time itself, and of ten times it."""
VELOCITIES = np.geomspace(1e-4, 10.0, 201)
"""Velocities (m/s) of Table 1; of another scene, a power of ten times these, by its a_0/tau."""
EVERY = 20
"""The quadrature is evaluated at every twentieth velocity."""


@dataclass(frozen=True)
class Data:
    """Exact curves and quadrature points by (support, tau), and both as one table."""

    velocities: np.ndarray
    curves: dict[tuple[str, float], Any]
    points: dict[tuple[str, float], Any]
    columns: Columns


def compute(scene: Scene | None = None) -> Data:
    """Solve both models for each retardation time."""
    curves, points, found = {}, {}, sliding(scene)
    first, own = (StaticState.of(each) for each in (Scene(), found["fixed"]))
    larger = own.half_length / own.time / (first.half_length / first.time)
    velocities = VELOCITIES * 10.0 ** round(math.log10(larger))
    for support, each in found.items():
        for tau in (own.time / 10.0, own.time, 10.0 * own.time):
            over = {"drive.velocity": velocities, "foundation.retardation_time": tau}
            curves[support, tau] = steady(each, over=over)
            sparse = {**over, "drive.velocity": velocities[::EVERY]}
            points[support, tau] = steady(each, over=sparse, method="quadrature")
    return Data(velocities, curves, points, _columns(velocities, curves, points))


def draw(data: Data) -> Figure:
    """Draw the eight panels."""
    drawn = Picture(6.4, 8.6)
    axes = drawn.subplots(4, 2, sharex=True, sharey="row")
    for column, (support, title) in zip(axes.T, SUPPORTS.items(), strict=True):
        for ax, quantity in zip(column, QUANTITIES, strict=True):
            taus = [tau for kind, tau in data.curves if kind == support]
            for tau, style in zip(taus, STYLES, strict=True):
                key, words = (support, tau), rf"$\tau = {tau:.6g}$ s"
                plot_steady(ax, data.velocities, data.curves[key], quantity, label=words, **style)
                plot_steady(
                    ax, data.velocities[::EVERY], data.points[key], quantity,
                    color=style["color"], linestyle="", marker="o", fillstyle="none", markersize=4,
                )  # fmt: skip
            ax.label_outer()
        column[0].set_title(title)
    handles, labels = axes[0, 0].get_legend_handles_labels()
    (point,) = axes[0, 0].plot([], [], "o", color="C2", fillstyle="none", markersize=4)
    drawn.legend([*handles, point], [*labels, "quadrature"], loc="outside lower center", ncols=2)
    return drawn


def _columns(velocities: np.ndarray, curves: dict[Any, Any], points: dict[Any, Any]) -> Columns:
    rows: dict[str, list[Any]] = {
        "support": [],
        "method": [],
        "retardation_time [s]": [],
        "velocity [m/s]": [],
    }
    rows |= {f"{name} [{unit}]": [] for name, unit in QUANTITIES.items()}
    for states, at in ((curves, velocities), (points, velocities[::EVERY])):
        for (support, tau), state in states.items():
            count = at.size
            rows["support"] += [support] * count
            rows["method"] += [state.model] * count
            rows["retardation_time [s]"] += [tau] * count
            rows["velocity [m/s]"] += at.tolist()
            for name, unit in QUANTITIES.items():
                rows[f"{name} [{unit}]"] += getattr(state, name).tolist()
    return rows
