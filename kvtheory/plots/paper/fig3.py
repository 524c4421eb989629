"""Fig. 3 of the paper: the onset of sliding, for both models, from the exact transient."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from kvtheory.api import transient
from kvtheory.plots.paper.models import SUPPORTS, Columns, models
from kvtheory.plots.result import plot_transient
from kvtheory.plots.style import Picture
from kvtheory.results import TRANSIENT_UNITS, Transient
from kvtheory.scene import Scene


@dataclass(frozen=True)
class Data:
    """The transient of each model."""

    results: dict[str, Transient]
    columns: Columns


def compute(scene: Scene | None = None) -> Data:
    """Solve both models."""
    results = {s: transient(each, rtol=1e-9) for s, each in models(scene).items()}
    columns: dict[str, Any] = {
        "support": [s for s, result in results.items() for _ in np.asarray(result.time)]
    }
    for name, unit in TRANSIENT_UNITS.items():
        columns[f"{name} [{unit}]"] = np.concatenate([getattr(r, name) for r in results.values()])
    return Data(results, columns)


def draw(data: Data) -> Figure:
    """Draw the eight panels."""
    drawn = Picture(6.8, 7.2)
    axes = drawn.subplots(4, 2, sharex=True, sharey="row")
    for column, (support, title) in zip(axes.T, SUPPORTS.items(), strict=True):
        plot_transient(column, data.results[support], color="C1")
        column[0].set_title(title)
        column[0].lines[0].set_color("C0")
        for ax in column:
            ax.label_outer()
    return drawn
