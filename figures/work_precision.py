"""Speed against accuracy of every method, measured side by side: Table 1, a stop-and-go drive, and rubber.

The script writes the quick version; `kvtheory chart work-precision` makes others.
"""

import math
import os
from dataclasses import dataclass
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from matplotlib.figure import Figure

from figures import drawing
from figures.paper_scheme import compiled_loop, suits
from kvtheory.charts.collection import measure
from kvtheory.charts.methods import DENSITIES, transient_methods
from kvtheory.charts.problems import Curves, Problem, standard_scene
from kvtheory.charts.work_precision import Chart, Clock, Method
from kvtheory.models.continuum.prony import trajectory
from kvtheory.models.elements import row
from kvtheory.plots.work_precision import default_errors, draw_work_precision
from kvtheory.results import DivergenceError

SCENES = "table-1", "stop-and-go", "rubber"


@dataclass(frozen=True)
class Data:
    """The charts, and as columns."""

    charts: list[Chart]
    columns: drawing.Columns


def compute() -> Data:
    """Measure all methods; the chart of steady sliding is left to the command."""
    loop: Any = compiled_loop()
    row.KERNEL.spent = math.inf  # all elements compiled, as the C loop is
    trajectory.KERNEL.spent = math.inf  # the reference too

    def in_c(problem: Problem, density: float, _: Clock) -> tuple[Curves, int]:
        """Solve a scene by the C loop, with so many elements per static half length."""
        units = problem.units
        times, depth, friction, work = loop(
            problem.scene, density / units.half_length, problem.times[-1]
        )
        if not np.abs(depth).max() < 10.0 * depth[0]:
            raise DivergenceError("the C loop diverged")
        at = (np.interp(problem.times, times, each) for each in (depth, friction))
        return Curves(next(at) / units.depth, next(at) / units.friction_force), work

    peer = Method(
        "elements in C, paper", "elements per a_0", DENSITIES, "element updates", in_c,
        suits=lambda problem: suits(problem.scene),
    )  # fmt: skip
    methods = [*transient_methods().values(), *([peer] if loop else [])]
    problems = [Problem(name, standard_scene(name), quick=True) for name in SCENES]
    charts = measure([(each, methods) for each in problems], quick=True)
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
