"""Which model the ladder chooses, over drive number or inertia number and tolerance (dead weight).

Areas show the choice of `kvtheory.solve`; the lines are the true errors of the cheaper models, by their
closed forms and relative to the continuum: a perfect choice would change colour on them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

import kvtheory as kv
from figures import drawing
from kvtheory.models.slow_manifold import motion as slow_motion
from kvtheory.models.slow_manifold import start as slow_start
from kvtheory.plots import BLACK

Array = NDArray[np.float64]

MODELS = {
    "asymptote": "#ddcc77",
    "exact": "#dddddd",
    "slow manifold": "#88ccee",
    "continuum": "#44aa99",
}
"""Colours after Tol, safe in colour blindness."""

TOLERANCES = np.geomspace(1e-8, 1e-1, 29)
NUMBERS = np.geomspace(1e-9, 1e7, 97)
INERTIAS = np.geomspace(1e-10, 1.0, 41)
NUMBER = 4.0
"""Drive number of the second panel, about that of Table 1."""
TIMES = (0.2, 0.5, 1.0, 2.0)
"""Times of its series, in units of tau."""
STEADY, SERIES = "friction_coefficient", "friction_force"


@dataclass(frozen=True)
class Panel:
    """Index of the model chosen for each (tolerance, x), and true errors of cheaper models over x."""

    x: Array
    chosen: NDArray[np.int64]
    errors: tuple[Array, ...]


@dataclass(frozen=True)
class Data:
    """Both panels."""

    steady: Panel
    series: Panel
    columns: drawing.Columns


def compute() -> Data:
    """Let the ladder choose at every point, and compute the true errors of the models."""
    steady = Panel(NUMBERS, _chosen(map(_sliding, NUMBERS), {"quantity": STEADY}), _asymptotes())
    asked = {"quantity": SERIES, "at": TIMES}
    series = Panel(INERTIAS, _chosen(map(_starting, INERTIAS), asked), (_neglected(),))
    names = list(MODELS)
    panels = {"steady, over drive_number": steady, "series, over inertia_number": series}
    rows = [
        (name, x, rtol, names[panel.chosen[i, j]])
        for name, panel in panels.items()
        for i, rtol in enumerate(TOLERANCES)
        for j, x in enumerate(panel.x)
    ]
    heads = ("panel", "number [1]", "rtol [1]", "model")
    return Data(steady, series, dict(zip(heads, zip(*rows, strict=True), strict=True)))


def draw(data: Data) -> Figure:
    """Draw the choice as areas and the true errors as lines."""
    drawn = drawing.figure(7.2, 3.6)
    left, right = drawn.subplots(1, 2, sharey=True)
    _panel(left, data.steady, r"drive number $\lambda = V\tau/a_0$")
    _panel(right, data.series, r"inertia number $\epsilon = M\delta_0/(W_0\tau^2)$")
    left.set(ylabel="requested tolerance", title="steady friction coefficient")
    right.set(
        title=rf"friction force at {TIMES[0]} to {TIMES[-1]:g} $\tau$, $\lambda$ = {NUMBER:g}"
    )
    for text, x, ax in (("low $V$", 1e-6, left), ("high $V$", 1e5, left)):
        ax.text(x, 2e-2, text, ha="center", fontsize=8)
    line = right.lines[0]
    handles = [Patch(color=colour, label=name) for name, colour in MODELS.items()]
    line.set_label("true error of the cheaper model")
    drawn.legend(handles=[*handles, line], loc="outside lower center", ncols=5, columnspacing=1.2)
    return drawn


def _panel(ax: Axes, panel: Panel, label: str) -> None:
    ax.pcolormesh(
        panel.x, TOLERANCES, panel.chosen, cmap=ListedColormap(list(MODELS.values())),
        vmin=-0.5, vmax=len(MODELS) - 0.5, shading="nearest", linewidth=0, rasterized=True,
    )  # fmt: skip
    for error in panel.errors:
        ax.plot(panel.x, error, color=BLACK, linewidth=1.0)
    ax.set(
        xscale="log", yscale="log", xlabel=label,
        xlim=(panel.x[0], panel.x[-1]), ylim=(TOLERANCES[0], TOLERANCES[-1]),
    )  # fmt: skip
    ax.grid(False)


def _sliding(number: float) -> kv.Scene:
    """Return a steady scene in scaled units."""
    return kv.Scene(
        kv.Parabola(0.5), kv.Foundation(0.75, 1.0), kv.DeadWeight(1.0, 1.0), kv.Drive(float(number))
    )


def _starting(inertia: float) -> kv.Scene:
    """Return a start from rest in scaled units."""
    weight = kv.DeadWeight(mass=float(inertia), gravity=1.0 / float(inertia))
    drive, run = kv.Drive(NUMBER), kv.Run(TIMES[-1])
    return kv.Scene(kv.Parabola(0.5), kv.Foundation(0.75, 1.0), weight, drive, run)


def _chosen(scenes: Any, asked: dict[str, Any]) -> NDArray[np.int64]:
    names = list(MODELS)
    return np.array(
        [[names.index(_model(scene, asked, rtol)) for rtol in TOLERANCES] for scene in scenes]
    ).T


def _model(scene: kv.Scene, asked: dict[str, Any], rtol: float) -> str:
    return kv.solve(scene, rtol=float(rtol), **asked).model


def _asymptotes() -> tuple[Array, ...]:
    """Return the magnitudes of the errors of L1 and L2."""
    report = kv.asymptotes(_sliding(1.0), over={"drive.velocity": NUMBERS})
    lines: Sequence[Any] = report.lines
    return tuple(np.abs(line.relative_error) for line in lines if line.quantity == STEADY)


def _neglected() -> Array:
    """Return the largest error of the slow manifold at the times, in units of the static friction scale."""
    times, errors = np.array(TIMES), []
    for inertia in INERTIAS:
        start = slow_start.start(NUMBER, float(inertia), 0.0)
        slow = slow_motion.follow(start, times, TOLERANCES[0]).values[SERIES]
        truth = kv.transient(_starting(inertia), at=TIMES, rtol=1e-12).friction_force
        errors.append(float(np.max(np.abs(slow - truth))))
    return np.array(errors)


if __name__ == "__main__":
    drawing.run("ladder", compute, draw)
