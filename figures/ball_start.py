"""Figs. 3 and 5 of the paper for a ball: the onset of sliding, and steady sliding over the velocity.

The ball has the radius and the foundation of Table 1, and the depth of its fixed indenter; the dead weight
is the one that rests at that depth. A ball at constant depth slides steadily at every instant (`solve`). One
that may rise is simulated by elements in strips (`elements`), and approaches exact steady sliding, drawn
dotted.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, RED, plot_steady, plot_transient
from kvtheory.results import TRANSIENT_UNITS, units_for

TITLES = {"fixed": "given depth", "dead-weight": "dead weight"}
TIMES = np.concatenate([[0.0], np.geomspace(1e-5, 0.2, 200)])
VELOCITIES = np.geomspace(1e-4, 10.0, 201)
DENSITY = 60e3
"""Elements per metre."""


@dataclass(frozen=True)
class Data:
    """By support: the start from rest, exact steady sliding at its end, and over the velocity."""

    starts: dict[str, Any]
    ends: dict[str, Any]
    steady: dict[str, Any]
    columns: drawing.Columns


def scenes() -> dict[str, kv.Scene]:
    """Return both scenes: at rest they are the same."""
    held = replace(kv.Scene.table1("fixed"), indenter=kv.Sphere(0.01))
    rest = kv.steady(held, over={"drive.velocity": 0.0})
    return {"fixed": held, "dead-weight": replace(held, support=kv.DeadWeight(load=rest.load))}


def starts(times: np.ndarray) -> dict[str, Any]:
    """Return the start from rest of both scenes, by support."""
    held, free = scenes().values()
    rising = kv.elements(free, per_length=DENSITY, at=times, certify=False)
    return {"fixed": kv.solve(held, at=times), "dead-weight": rising}


def compute() -> Data:
    """Compute both starts, and steady sliding at every velocity."""
    found, begun = scenes(), starts(TIMES)
    over = {"drive.velocity": VELOCITIES}
    ends = {name: kv.steady(scene) for name, scene in found.items()}
    steady = {name: kv.steady(scene, over=over) for name, scene in found.items()}
    columns: dict[str, Any] = {"support": [name for name in begun for _ in TIMES]}
    for name, unit in units_for(found["fixed"].indenter, TRANSIENT_UNITS).items():
        columns[f"{name} [{unit}]"] = np.concatenate([getattr(r, name) for r in begun.values()])
    return Data(begun, ends, steady, columns)


def draw(data: Data) -> Figure:
    """Draw the starts in four rows, and friction over the velocity in the last."""
    drawn = drawing.figure(6.8, 8.6)
    parts: Any = drawn.subfigures(2, 1, height_ratios=(4.0, 1.25))
    axes = parts[0].subplots(4, 2, sharex=True, sharey="row")
    for column, (support, title) in zip(axes.T, TITLES.items(), strict=True):
        plot_transient(column, data.starts[support], color=RED)
        column[0].set_title(title)
        column[0].lines[0].set_color(BLUE)
        end = data.ends[support]
        for ax, value in zip(
            column[1:], (-1e3 * end.depth, end.load, end.friction_force), strict=True
        ):
            ax.axhline(value, color=BLACK, linestyle=":", linewidth=0.9)
        for ax in column:
            ax.label_outer()
    below = parts[1].subplots(1, 2, sharey=True)
    for ax, support in zip(below, TITLES, strict=True):
        plot_steady(ax, VELOCITIES, data.steady[support], "friction_coefficient", color=RED)
        ax.label_outer()
    return drawn


if __name__ == "__main__":
    drawing.run("ball_start", compute, draw)
