"""Where the schemes of the discrete simulator are stable: predicted boundaries over measured growth."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from figures import drawing
from kvtheory.charts.stability import CLASSES, Map, stability_maps
from kvtheory.plots.failures import draw_stability


@dataclass(frozen=True)
class Data:
    """The maps by kind, and as columns."""

    maps: dict[str, list[Map]]
    columns: drawing.Columns


def compute() -> Data:
    """Measure the growth at every point of coarse maps."""
    maps = stability_maps(quick=True)
    columns: dict[str, list[Any]] = {
        name: [] for name in ("map", "scheme", "x", "y", "growth at first [1]", "growth [1]",
                              "step/limit at first [1]", "step/limit [1]", "class")
    }  # fmt: skip
    for kind, several in maps.items():
        for found in several:
            x, y = np.meshgrid(found.x, found.y)
            numbers = (
                x, y, found.start, found.steady, found.predicted_start, found.predicted_steady
            )  # fmt: skip
            values: tuple[Any, ...] = (
                [kind] * x.size,
                [found.scheme] * x.size,
                *(number.reshape(-1).tolist() for number in numbers),
                [CLASSES[k] for k in found.classes.reshape(-1)],
            )
            for name, more in zip(columns, values, strict=True):
                columns[name].extend(more)
    return Data(maps, columns)


def draw(data: Data) -> Figure:
    """Draw a column of maps for each scheme."""
    return draw_stability(data.maps["velocity"], data.maps["step"])


if __name__ == "__main__":
    drawing.run("stability_map", compute, draw)
