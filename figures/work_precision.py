"""Speed against accuracy of every method, measured side by side: Table 1, and a stop-and-go drive.

The script writes the quick version; `kvtheory chart work-precision` makes others.
"""

import os
from dataclasses import dataclass
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

from matplotlib.figure import Figure

from figures import drawing
from kvtheory.charts.collection import chosen, measure
from kvtheory.charts.work_precision import Chart
from kvtheory.plots.work_precision import default_errors, draw_work_precision
from kvtheory.scene.model import Scene

SCENES = "table-1", "stop-and-go"


@dataclass(frozen=True)
class Data:
    """The charts, and as columns."""

    charts: list[Chart]
    columns: drawing.Columns


def compute() -> Data:
    """Measure all methods; the chart of steady sliding is left to the command."""
    charts = measure(chosen(Scene(), SCENES, quick=True)[1:], quick=True)
    rows: list[tuple[Any, ...]] = []
    for chart, error in zip(charts, default_errors(charts), strict=True):
        for series in chart.series:
            for point in series.points:
                achieved = point.errors.get(error)
                told = "none" if achieved is None else repr(achieved)
                rows.append(
                    (chart.name, series.method, series.kind, series.knob, point.knob, told,
                     point.seconds, *point.quartiles, point.work, point.reason or "-")
                )  # fmt: skip
    heads = (
        "scene", "method", "kind", "knob", "setting", "largest error of depth [1]", "time [s]",
        "first quartile [s]", "third quartile [s]", "work", "failed",
    )  # fmt: skip
    return Data(charts, dict(zip(heads, zip(*rows, strict=True), strict=True)))


def draw(data: Data) -> Figure:
    """Draw time and work over the error, with a rail for what failed."""
    return draw_work_precision(data.charts, default_errors(data.charts))


if __name__ == "__main__":
    drawing.run("work_precision", compute, draw)
