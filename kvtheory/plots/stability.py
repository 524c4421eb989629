"""Stability maps: the measured classes, overlaid with the predicted boundaries."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from kvtheory.charts.stability import CLASSES, Map
from kvtheory.plots.files import save_chart
from kvtheory.plots.style import BLACK, BLUE, Picture
from kvtheory.results.certificate import record
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

COLOURS = "#eef3f7", "#f6c9a3", "#d55e00"
"""Colours of the classes."""
BOUNDARIES: tuple[tuple[str, str, Any], ...] = (
    ("start", "predicted_start", ":"),
    ("steady sliding", "predicted_steady", "-"),
)
"""Name, values and dashes of the predicted boundaries."""
PAPERS_TAUS = 1e-2, 0.1, 1.0
"""Retardation times (s) of Fig. 5 of the paper."""
TABLE1 = 0.1, 0.1
"""V (m/s) and tau (s) of Table 1."""
TITLES = {"paper": "paper (Runge-Kutta)", "explicit-euler": "explicit Euler"}
"""Titles of the schemes whose name alone is unclear."""


def plot_stability(ax: Any, found: Map, factors: tuple[float, float] = (1.0, 1.0)) -> Any:
    """Draw one map, with its axes multiplied by `factors`, and return the image of its classes."""
    x, y = found.x * factors[0], found.y * factors[1]
    image = ax.pcolormesh(
        x, y, found.classes, cmap=ListedColormap(COLOURS), shading="nearest", rasterized=True,
        norm=BoundaryNorm(np.arange(len(CLASSES) + 1) - 0.5, len(CLASSES)),
    )  # fmt: skip
    for _, name, dashes in BOUNDARIES:
        predicted = getattr(found, name)
        if predicted.min() < 1.0 < predicted.max():
            look: Any = {"colors": BLACK, "linestyles": dashes, "linewidths": 1.1}
            ax.contour(x, y, np.log(predicted), [0.0], **look)
    ax.set(xscale="log", yscale="log", xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    ax.grid(False)
    return image


def draw_stability(velocity_maps: Sequence[Map], step_maps: Sequence[Map]) -> Picture:
    """Return the picture: a column for each scheme, with the map over V and tau above the other."""
    drawn = Picture(11.0, 5.4)
    rows = drawn.subplots(2, len(velocity_maps), sharex="row", sharey="row", squeeze=False)
    for ax, found in zip(rows[0], velocity_maps, strict=True):
        plot_stability(ax, found, (1e3, 1.0))
        for tau in PAPERS_TAUS:
            ax.axhline(tau, color=BLUE, linewidth=0.9, alpha=0.7)
        ax.plot(1e3 * TABLE1[0], TABLE1[1], "*", color=BLUE, markersize=10, markeredgecolor="white")
        ax.set(title=TITLES.get(found.scheme, found.scheme), xlabel=r"drive velocity $V$ [mm/s]")
    for ax, found in zip(rows[1], step_maps, strict=True):
        plot_stability(ax, found)
        ax.axvline(StaticState.of(Scene()).drive_number, color=BLUE, linewidth=0.9, alpha=0.7)
        ax.set(xlabel=r"drive number $\lambda$")
    rows[0][0].set_ylabel(r"retardation time $\tau$ [s]")
    rows[1][0].set_ylabel(r"step $\Delta t$ / limit")
    measured = [
        Patch(facecolor=colour, edgecolor="#999999", label=f"measured: {name}")
        for colour, name in zip(COLOURS, CLASSES, strict=True)
    ]
    predicted = [
        Line2D([], [], color=BLACK, linestyle=dashes, label=f"predicted boundary, {name}")
        for name, _, dashes in BOUNDARIES
    ]
    words = r"$\tau$ of Fig. 5, $\lambda$ of Table 1"
    papers = Line2D([], [], color=BLUE, linewidth=0.9, label=words)
    star = Line2D([], [], color=BLUE, marker="*", linestyle="", markersize=9, label="Table 1")
    handles = [*measured, star, *predicted, papers]
    drawn.legend(handles=handles, loc="outside lower center", ncols=4)
    return drawn


def save_stability(maps: Mapping[str, Sequence[Map]], path: Path) -> None:
    """Draw the maps and write them in the format that `path` ends in, with their data as JSON beside."""
    data = {"maps": record(maps)}
    save_chart(lambda: draw_stability(maps["velocity"], maps["step"]), data, path)
