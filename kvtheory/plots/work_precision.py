"""Work-precision charts: time and work over the achieved error, with a strip for failures, the rail."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullFormatter

from kvtheory.charts.work_precision import REASONS, Chart
from kvtheory.plots.files import data_json, save_picture
from kvtheory.plots.style import BLACK, BLUE, GREEN, PURPLE, RED, Picture

RESOLVED = 100.0
"""Multiple of the floor above which an error is significant; points below it are hollow."""
LEAST = 1e-17
"""Smaller errors are drawn at this value."""
GREY, OCHRE, SKY = "#777777", "#b8860b", "#56b4e9"
LOOKS = {
    "asymptote": (BLACK, "v"), "slow manifold": (BLACK, "D"),
    "exact": (PURPLE, "o"), "exact, 10 000 at once": (PURPLE, "s"), "quadrature": (OCHRE, "o"),
    "brentq over quad": (RED, "o"),
    "continuum, compiled": (BLUE, "o"), "continuum, interpreted": (SKY, "o"),
    "two states, RK45": (RED, "^"), "two states, DOP853": (RED, "v"), "two states, Radau": (OCHRE, "^"),
    "two states, BDF": (OCHRE, "v"), "two states, LSODA": (PURPLE, "^"), "two states, CVODE": (PURPLE, "v"),
    "method of lines": (GREY, "x"),
    "elements, paper": (GREY, "s"), "elements, explicit-euler": (GREY, "D"),
    "elements, semi-implicit": (GREEN, "s"), "elements, exponential": (GREEN, "D"),
    "elements, edge-corrected": (GREEN, "o"), "elements in C, paper": (BLACK, "s"),
}  # fmt: skip
"""Colour and marker of each method, which no other has."""
OWN, MARKS = "#e6007e", ("*", "P", "X", "p", "h", "<", ">", "d")
"""Colour and markers of the methods that a user adds."""
SHORT = {"not converged": "no conv.", "wrong but reported success": "wrong, “success”"}
"""Short forms of the reasons that are too long for the rail."""


def plot_work_precision(
    ax: Any, rail: Any, chart: Chart, error: str, *, work: bool = False
) -> list[Any]:
    """Draw time, or `work`, over one of the errors on `ax`, failures on `rail`, and return the lines."""
    floor = chart.floor[error]
    artists, marks = [], iter(MARKS)
    for series in chart.series:
        own = series.method not in LOOKS
        colour, marker = (OWN, next(marks)) if own else LOOKS[series.method]
        style: Any = {"color": colour, "marker": marker, "markersize": 9.0 if own else 4.5}
        x, y, good = [], [], []
        for p in series.points:
            cost = float(p.work) if work else p.seconds
            if p.reason and cost > 0.0:
                rail.plot(REASONS.index(p.reason), cost, **style)
            elif not p.reason and (p.work > 0 or not work):
                x.append(max(p.errors[error], floor, LEAST))
                y.append(cost)
                good.append(p)
        model = series.kind == "model"
        artists += ax.plot(
            x, y, ":" if model else "-", linewidth=1.0, label=series.method.replace("$", r"\$"),
            markerfacecolor="white" if model else colour, **style,
        )  # fmt: skip
        for p, a, b in zip(good, x, y, strict=True):
            if not work:
                ax.plot([a, a], p.quartiles, color=colour, linewidth=0.8)
            if p.errors[error] < RESOLVED * floor:
                ax.plot(a, b, markerfacecolor="white", **style)
    if floor > 0.0:
        ax.axvspan(LEAST, max(floor, LEAST), color="#dddddd", zorder=0)
    ax.set(xscale="log", yscale="log")
    if np.ptp(np.log10(ax.get_xlim())) > 1.0:  # else labels would overlap
        ax.xaxis.set_minor_formatter(NullFormatter())
    ax.invert_xaxis()
    rail.set(xlim=(-0.6, len(REASONS) - 0.4), xticks=range(len(REASONS)))
    rail.set_xticklabels([SHORT.get(reason, reason) for reason in REASONS], rotation=90)
    rail.tick_params(labelleft=False, left=False)
    rail.set_facecolor("#faf1ea")
    return artists


def draw_work_precision(charts: Sequence[Chart], errors: Sequence[str]) -> Picture:
    """Return the picture: a row for each chart, the time on the left and the work on the right."""
    drawn = Picture(11.0, 1.9 + 2.9 * len(charts))
    grid = drawn.subplots(len(charts), 4, width_ratios=(5, 1.3, 5, 1.3), squeeze=False)
    methods: dict[str, Any] = {}
    for row, chart, error in zip(grid, charts, errors, strict=True):
        for (ax, rail), work in ((row[:2], False), (row[2:], True)):
            rail.sharey(ax)
            for line in plot_work_precision(ax, rail, chart, error, work=work):
                methods.setdefault(line.get_label(), line)
            ordinate = "evaluations or element updates" if work else "time [s]"
            ax.set(xlabel=f"achieved error of {error}", ylabel=ordinate)
            rail.set_title("failed", fontsize=8)
        if chart is not charts[-1]:
            for rail in row[1::2]:
                rail.tick_params(labelbottom=False)
        row[0].set_title(f"{chart.name}: time", loc="left")
        row[2].set_title(f"{chart.name}: work", loc="left")
    hollow = Line2D([], [], color=BLACK, marker="o", linestyle="", markerfacecolor="white",
                    label="hollow: model error, or not resolved")  # fmt: skip
    grey = Patch(facecolor="#dddddd", label="grey: where the two references differ")
    drawn.legend(handles=[*methods.values(), hollow, grey], loc="outside lower center", ncols=5)
    return drawn


def default_errors(charts: Sequence[Chart]) -> list[str]:
    """Return the error over which each chart is drawn by default: that of the depth, if it is not given."""
    names = "depth, maximum", "friction, maximum", "friction coefficient"
    return [
        next((name for name in names if chart.floor.get(name)), next(iter(chart.floor)))
        for chart in charts
    ]


def save_work_precision(charts: Sequence[Chart], path: Path) -> None:
    """Draw the charts and write them in the format that `path` ends in, with their data as JSON beside."""
    data = {"charts": [chart.as_dict() for chart in charts]}
    draw = partial(draw_work_precision, charts, default_errors(charts))
    save_picture(draw, path, beside=data_json(path, data))
