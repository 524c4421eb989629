"""Fig. 4 of the paper: the contact pressure over position and time, with both edges."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import plot_pressure

SUPPORTS = {"fixed": "FI model (fixed indenter)", "dead-weight": "MI model (dead weight)"}
POSITIONS = np.linspace(-2.6e-3, 2.6e-3, 261)
TIMES = np.linspace(0.0, 0.1, 201)


@dataclass(frozen=True)
class Data:
    """The transient of each model at `TIMES`."""

    results: dict[str, kv.Transient]
    columns: drawing.Columns


def compute() -> Data:
    """Solve both models of Table 1."""
    results = {s: kv.transient(kv.Scene.table1(s), at=TIMES, rtol=1e-9) for s in SUPPORTS}
    return Data(results, columns(TIMES, results))


def columns(times: np.ndarray, results: dict[str, Any]) -> drawing.Columns:
    """Return edges and peak pressure of both transients."""
    found: dict[str, Any] = {"time [s]": times}
    for support, result in results.items():
        for name, unit in (("leading_edge", "m"), ("trailing_edge", "m"), ("peak_pressure", "Pa")):
            found[f"{name}, {support} [{unit}]"] = getattr(result, name)
    return found


def draw(data: Data) -> Figure:
    """Draw both panels."""
    return panels(data.results, SUPPORTS, POSITIONS, TIMES, r"pressure $p$ [MPa]")


def panels(
    results: dict[str, Any],
    titles: dict[str, str],
    positions: np.ndarray,
    times: np.ndarray,
    label: str,
) -> Figure:
    """Draw the pressure of both transients on one scale, by support."""
    drawn = drawing.figure(7.2, 3.6)
    axes = drawn.subplots(1, 2, sharey=True)
    images = []
    for ax, (support, title) in zip(axes, titles.items(), strict=True):
        images.append(plot_pressure(ax, results[support], positions, times))
        ax.set_title(title)
        ax.label_outer()
    highest = max(image.get_clim()[1] for image in images)
    for image in images:
        image.set_clim(0.0, highest)
    axes[1].legend(loc="upper right")
    drawn.colorbar(images[1], ax=axes, label=label)
    return drawn


if __name__ == "__main__":
    drawing.run("fig4", compute, draw)
