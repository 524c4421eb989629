"""Fig. 4 of the paper: the contact pressure over position and time, with both edges."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from kvtheory.api import transient
from kvtheory.plots.paper.models import SUPPORTS, Columns, models
from kvtheory.plots.result import plot_pressure
from kvtheory.plots.style import Picture
from kvtheory.results import Transient
from kvtheory.scene import Scene

DURATION = 0.1
"""Time (s) that is shown of Table 1; of another scene, it is the whole run."""
WIDE = 1.06
"""Positions that are shown on each side, over the furthest edge."""


@dataclass(frozen=True)
class Data:
    """The transient of each model."""

    results: dict[str, Transient]
    columns: Columns


def compute(scene: Scene | None = None) -> Data:
    """Solve both models."""
    times = np.linspace(0.0, scene.run.duration if scene else DURATION, 201)
    results = {s: transient(each, at=times, rtol=1e-9) for s, each in models(scene).items()}
    return Data(results, columns(times, results))


def columns(times: np.ndarray, results: dict[str, Any]) -> Columns:
    """Return edges and peak pressure of both transients."""
    found: dict[str, Any] = {"time [s]": times}
    for support, result in results.items():
        for name, unit in (("leading_edge", "m"), ("trailing_edge", "m"), ("peak_pressure", "Pa")):
            found[f"{name}, {support} [{unit}]"] = getattr(result, name)
    return found


def draw(data: Data) -> Figure:
    """Draw both panels."""
    results = data.results.values()
    edges = [(each.leading_edge, each.trailing_edge) for each in results]
    wide = WIDE * np.nanmax(np.abs(edges))
    positions, times = np.linspace(-wide, wide, 261), next(iter(results)).time
    return panels(data.results, SUPPORTS, positions, times, r"pressure $p$ [MPa]")


def panels(
    results: dict[str, Any],
    titles: dict[str, str],
    positions: np.ndarray,
    times: np.ndarray,
    label: str,
) -> Figure:
    """Draw the pressure of both transients on one scale, by support."""
    drawn = Picture(7.2, 3.6)
    axes = drawn.subplots(1, 2, sharey=True)
    images = []
    for ax, (support, title) in zip(axes, titles.items(), strict=True):
        images.append(plot_pressure(ax, results[support], positions, times))
        ax.set_title(title)
        ax.label_outer()
    highest = max(image.get_clim()[1] for image in images)
    for image in images:
        image.set_clim(0.0, highest)
    drawn.legend(*axes[1].get_legend_handles_labels(), loc="outside lower center", ncols=2)
    drawn.colorbar(images[1], ax=axes, label=label)
    return drawn
