"""Starts from rest in the plane of depth and depth rate, with the slow manifold and the steady state.

The drive number is that of Table 1; each curve has a different inertia number eps. For eps -> 0 the motion
drops onto the slow manifold (F13) at once and follows it; beyond the boundary of F12 it spirals.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.models.continuum.solver import solve
from kvtheory.models.slow_manifold import motion as slow_manifold
from kvtheory.plots import BLACK, BLUE, GREEN, PURPLE, RED
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.static_state import StaticState

TABLE_1 = StaticState.of(kv.Scene.table1())
STYLES: dict[float, dict[str, Any]] = {
    3e-4: {"color": BLUE, "linestyle": "-"},
    TABLE_1.inertia_number: {"color": RED, "linestyle": "--"},
    3e-2: {"color": GREEN, "linestyle": "-."},
    3e-1: {"color": PURPLE, "linestyle": ":"},
}
END, POINTS, RTOL = 12.0, 1200, 1e-8


@dataclass(frozen=True)
class Data:
    """Depth and depth rate, scaled, by inertia number; and on the slow manifold."""

    curves: dict[float, tuple[np.ndarray, np.ndarray]]
    manifold: tuple[np.ndarray, np.ndarray]
    steady_depth: float
    columns: drawing.Columns


def compute() -> Data:
    """Solve a start from rest for each inertia number."""
    number = TABLE_1.drive_number
    times = np.concatenate([[0.0], np.geomspace(1e-6, END, POINTS)])
    curves: dict[float, tuple[np.ndarray, np.ndarray]] = {}
    rows: dict[str, list[Any]] = {"inertia_number [1]": [], "s [1]": [], "d [1]": [], "d' [1]": []}
    for eps in STYLES:
        motion = solve(BaseMotion.constant(number, END), eps, 0.0, END, RTOL)
        moments = [motion.at(float(s)) for s in times]
        curves[eps] = np.array([m.depth for m in moments]), np.array([m.rate for m in moments])
        for name, column in zip(rows, ([eps] * times.size, times, *curves[eps]), strict=True):
            rows[name] += np.asarray(column).tolist()
    steady = kv.steady()
    steady_depth = float(steady.depth / TABLE_1.depth)
    depth = np.linspace(0.5 * steady_depth, 1.05, 400)
    manifold = depth, slow_manifold.depth_rate(depth, number)
    return Data(curves, manifold, steady_depth, rows)


def draw(data: Data) -> Figure:
    """Draw the curves in one plane."""
    drawn = drawing.figure(5.2, 3.8)
    ax = drawn.subplots()
    ax.plot(*data.manifold, color=BLACK, linewidth=4, alpha=0.25, label="slow manifold (F13)")
    for eps, style in STYLES.items():
        name = rf"$\epsilon = {eps:.3g}$" + (" (Table 1)" if eps == TABLE_1.inertia_number else "")
        ax.plot(*data.curves[eps], label=name, **style)
    ax.plot(data.steady_depth, 0.0, "D", color=BLACK, label="steady state")
    ax.plot(1.0, 0.0, "o", color=BLACK, fillstyle="none", label="start")
    ax.set(
        xlabel=r"depth $d = \delta/\delta_0$",
        ylabel=r"depth rate $d' = \tau\dot\delta/\delta_0$",
        title=rf"start from rest at $\lambda = {TABLE_1.drive_number:.3g}$",
    )
    ax.legend(loc="lower left")
    return drawn


if __name__ == "__main__":
    drawing.run("phase_portrait", compute, draw)
