"""Transients, as in Figs. 3 and 4 of the paper."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kvtheory.plots.style import BLUE
from kvtheory.results import Transient
from kvtheory.results.transient import TimeSeries

TRANSIENT_ROWS = (
    ("velocity", r"$V$ [mm/s]", 1e3),
    ("depth", r"$z_\mathrm{A}$ [mm]", -1e3),
    ("normal_force", r"$F_z$ [N/mm]", 1e-3),
    ("friction_force", r"$F_x$ [N/mm]", 1e-3),
)
"""The rows of Fig. 3 of the paper: quantity, axis label, factor from SI."""


def plot_transient(axes: Sequence[Any], result: TimeSeries, **style: Any) -> list[Any]:
    """Draw velocity, position, normal and friction force over time on four axes, as in Fig. 3.

    The rest before t = 0 is drawn too, for a twentieth of the time shown: V and F_x are zero there.
    """
    time = np.asarray(result.time) * 1e3
    before = np.array([-0.05 * time[-1], 0.0])
    rest = {"velocity": 0.0, "friction_force": 0.0, "depth": result.depth[0]}
    rest["normal_force"] = result.solution.units.load if isinstance(result, Transient) else math.nan
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
