"""Fig. 3 of the paper: the onset of sliding, for both models, from the exact transient."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLUE, RED, plot_transient
from kvtheory.results import TRANSIENT_UNITS

SUPPORTS = {"fixed": "FI model (fixed indenter)", "dead-weight": "MI model (dead weight)"}


@dataclass(frozen=True)
class Data:
    """The transient of each model."""

    results: dict[str, kv.Transient]
    columns: drawing.Columns


def compute() -> Data:
    """Solve both models of Table 1."""
    results = {s: kv.transient(kv.Scene.table1(s), rtol=1e-9) for s in SUPPORTS}
    columns: dict[str, Any] = {
        "support": [s for s, result in results.items() for _ in np.asarray(result.time)]
    }
    for name, unit in TRANSIENT_UNITS.items():
        columns[f"{name} [{unit}]"] = np.concatenate([getattr(r, name) for r in results.values()])
    return Data(results, columns)


def draw(data: Data) -> Figure:
    """Draw the eight panels."""
    drawn = drawing.figure(6.8, 7.2)
    axes = drawn.subplots(4, 2, sharex=True, sharey="row")
    for column, (support, title) in zip(axes.T, SUPPORTS.items(), strict=True):
        plot_transient(column, data.results[support], color=RED)
        column[0].set_title(title)
        column[0].lines[0].set_color(BLUE)
        for ax in column:
            ax.label_outer()
    return drawn


if __name__ == "__main__":
    drawing.run("fig3", compute, draw)
