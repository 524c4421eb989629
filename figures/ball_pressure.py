"""Fig. 4 of the paper for a ball: the pressure in its middle plane over position and time, with both edges.

The scenes are those of "Figs. 3 and 5 of the paper for a ball". In the contact of the middle plane
p = K (delta - x^2/(2R)) + C (d delta/dt - V x/R) at every instant, so depth, its rate and the edges suffice:
in closed form for a fixed ball, by elements in strips for one that may rise.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from figures import drawing
from figures.ball_start import TITLES, scenes, starts
from kvtheory.plots.paper import fig4

POSITIONS = np.linspace(-2.6e-3, 2.6e-3, 261)
TIMES = np.linspace(0.0, 0.1, 201)


@dataclass(frozen=True)
class MiddlePlane:
    """A series of a ball with the pressure in its middle plane, at the times of the series."""

    series: Any
    scene: Any

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the series."""
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
    found, series = scenes(), starts(TIMES)
    planes = {name: MiddlePlane(series[name], found[name]) for name in series}
    return Data(planes, fig4.columns(TIMES, series))


def draw(data: Data) -> Figure:
    """Draw both panels."""
    label = r"pressure in the middle plane $p$ [MPa]"
    return fig4.panels(data.results, TITLES, POSITIONS, TIMES, label)


if __name__ == "__main__":
    drawing.run("ball_pressure", compute, draw)
