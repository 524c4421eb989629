"""Fig. 4 of the paper for a ball: the pressure in its middle plane over position and time, with both edges.

The scenes are those of "Figs. 3 and 5 of the paper for a ball". In the contact of the middle plane
p = K (delta - x^2/(2R)) + C (d delta/dt - V x/R) at every instant, so that depth, its rate and the edges are
enough: of a ball that is held in closed form, of one that may rise by elements in strips.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from figures.ball_start import DENSITY, TITLES, scenes
from kvtheory.plots import plot_pressure

POSITIONS = np.linspace(-2.6e-3, 2.6e-3, 261)
TIMES = np.linspace(0.0, 0.1, 201)


@dataclass(frozen=True)
class MiddlePlane:
    """A series of a ball with the pressure in its middle plane, at the times of the series."""

    series: Any
    scene: Any

    def __getattr__(self, name: str) -> Any:
        """Return what the series has."""
        return getattr(self.series, name)

    def pressure(self, positions: np.ndarray, time: float) -> np.ndarray:
        """Return the pressure from edge to edge, and zero elsewhere."""
        run, K, R = self.series, self.scene.foundation.stiffness, self.scene.indenter.radius
        row = int(np.argmin(np.abs(run.time - time)))
        tau = self.scene.foundation.retardation_time
        ends = sorted((run.leading_edge[row], run.trailing_edge[row]))
        x = np.asarray(positions)
        bent = x * x / 2.0 + run.velocity[row] * tau * x
        p = K * (run.depth[row] + tau * run.depth_rate[row] - bent / R)
        return np.where((x >= ends[0]) & (x <= ends[1]), p, 0.0)


@dataclass(frozen=True)
class Data:
    """The start of both scenes at `TIMES`."""

    results: dict[str, Any]
    columns: drawing.Columns


def compute() -> Data:
    """Follow both scenes."""
    found = scenes()
    series = {
        "fixed": kv.transient(found["fixed"], at=TIMES),
        "dead-weight": kv.elements(
            found["dead-weight"], per_length=DENSITY, at=TIMES, certify=False
        ),
    }
    columns: dict[str, Any] = {"time [s]": TIMES}
    for support, result in series.items():
        for name, unit in (("leading_edge", "m"), ("trailing_edge", "m"), ("peak_pressure", "Pa")):
            columns[f"{name}, {support} [{unit}]"] = getattr(result, name)
    return Data({name: MiddlePlane(series[name], found[name]) for name in series}, columns)


def draw(data: Data) -> Figure:
    """Draw both panels on one scale of pressure."""
    drawn = drawing.figure(7.2, 3.6)
    axes = drawn.subplots(1, 2, sharey=True)
    images = []
    for ax, (support, title) in zip(axes, TITLES.items(), strict=True):
        images.append(plot_pressure(ax, data.results[support], POSITIONS, TIMES))
        ax.set_title(title)
        ax.label_outer()
    highest = max(image.get_clim()[1] for image in images)
    for image in images:
        image.set_clim(0.0, highest)
    axes[1].legend(loc="upper right")
    drawn.colorbar(images[1], ax=axes, label=r"pressure in the middle plane $p$ [MPa]")
    return drawn


if __name__ == "__main__":
    drawing.run("ball_pressure", compute, draw)
