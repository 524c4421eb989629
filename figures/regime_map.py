"""Regimes of a start from rest, over drive number and inertia number (dead weight).

Each point is a solved transient, classified by its events; the line is the closed-form boundary of
oscillation about the steady state (F12), eps = 3 r/8 with r the trailing edge in units of a_0.
"""

from dataclasses import dataclass
from functools import cache
from itertools import product

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

from figures import drawing
from kvtheory.models.continuum.solver import Trajectory, solve
from kvtheory.plots import BLACK
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.theory import closed_forms as cf

CLASSES = {
    "monotone": "#dddddd",
    "oscillating": "#88ccee",
    "memory": "#ddcc77",
    "take-off": "#cc6677",
}
"""Each class adds an event to the one before: the depth oscillates, an edge moves back over its trace, the
indenter leaves the foundation. Colours after Tol, safe in colour blindness."""

NUMBERS = np.geomspace(1e-2, 1e2, 97)
INERTIAS = np.geomspace(1e-4, 1e2, 93)
BLOCK = 4
"""Points along a side of a block: where its corners and its centre are of one class, so is the block."""
RTOL = 1e-6
QUARTERS = np.arange(4) / 4
TURN = 1e-5
"""Depth rate, relative to its largest magnitude, above which a rise and fall counts as oscillation."""


@dataclass(frozen=True)
class Data:
    """Index of the class at each (eps, lambda)."""

    classes: np.ndarray
    boundary: np.ndarray
    columns: drawing.Columns


def compute() -> Data:
    """Solve and classify the points of the map, and every one near the borders of the classes."""
    classes = np.zeros((INERTIAS.size, NUMBERS.size), dtype=int)
    solved = cache(lambda i, k: _class(float(NUMBERS[k]), float(INERTIAS[i])))
    for i, k in product(range(0, INERTIAS.size - 1, BLOCK), range(0, NUMBERS.size - 1, BLOCK)):
        corners = product((i, i + BLOCK), (k, k + BLOCK))
        found = {solved(*at) for at in (*corners, (i + BLOCK // 2, k + BLOCK // 2))}
        for at in product(range(i, i + BLOCK + 1), range(k, k + BLOCK + 1)):
            classes[at] = solved(*at) if len(found) > 1 else min(found)
    names = list(CLASSES)
    grid = [(number, eps) for eps in INERTIAS for number in NUMBERS]
    columns = {
        "drive_number [1]": [number for number, _ in grid],
        "inertia_number [1]": [eps for _, eps in grid],
        "class": [names[index] for index in classes.reshape(-1)],
    }
    q = np.linspace(1e-3, 1 - 1e-6, 4000)
    s = np.cbrt(4 / (3 * cf.load_factor(q)))
    boundary = np.array([s * (1 - q * q) / (2 * q), 3 * q * s / 8])
    return Data(classes, boundary, columns)


def draw(data: Data) -> Figure:
    """Draw the classes as areas and the boundary as a line."""
    drawn = drawing.figure(5.4, 4.2)
    ax = drawn.subplots()
    colours = ListedColormap(list(CLASSES.values()))
    ax.pcolormesh(
        NUMBERS, INERTIAS, data.classes, cmap=colours, vmin=-0.5, vmax=len(CLASSES) - 0.5,
        shading="nearest", alpha=0.6, linewidth=0, rasterized=True,
    )  # fmt: skip
    for index, name in enumerate(CLASSES):
        rows, columns = np.nonzero(data.classes == index)
        if rows.size:
            at = np.median(NUMBERS[columns]), np.median(INERTIAS[rows])
            ax.text(*at, name, ha="center", va="center")
    ax.plot(*data.boundary, color=BLACK, label=r"$\epsilon = 3r/8$ (F12)")
    ax.set(
        xscale="log", yscale="log", xlabel=r"drive number $\lambda = V\tau/a_0$",
        ylabel=r"inertia number $\epsilon = M\delta_0/(W_0\tau^2)$", title="start from rest, dead weight",
        xlim=(NUMBERS[0], NUMBERS[-1]), ylim=(INERTIAS[0], INERTIAS[-1]),
    )  # fmt: skip
    ax.grid(False)
    ax.legend(loc="lower left")
    return drawn


def _class(number: float, eps: float) -> int:
    """Return the index of the class of one start from rest."""
    end = 20.0 + 10.0 * float(np.sqrt(eps))
    motion = solve(BaseMotion.constant(float(number), end), float(eps), 0.0, end, RTOL)
    kinds = {event.kind for event in motion.events[1:]}
    if any("take" in kind for kind in kinds):
        return 3
    if kinds:
        return 2
    return 1 if _turns(motion) else 0


def _turns(motion: Trajectory) -> bool:
    """Whether the indenter sinks again after it has risen."""
    starts = np.array(motion.starts)
    spans = np.diff(np.append(starts, motion.end))
    rates = motion.states((starts[:, None] + spans[:, None] * QUARTERS).reshape(-1))["depth_rate"]
    return bool(rates.max() > TURN * np.abs(rates).max())


if __name__ == "__main__":
    drawing.run("regime_map", compute, draw)
