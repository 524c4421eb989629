"""Where methods fail: the atlas as one self-contained HTML file, and maps of stability."""

import math
import re
from collections.abc import Mapping, Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from kvtheory.charts.failures import TEXTS, Finding
from kvtheory.charts.stability import CLASSES, Map
from kvtheory.plots.files import data_json, inline, save_page, save_picture, template
from kvtheory.plots.style import BLACK, BLUE, RED, Picture
from kvtheory.results.presented import record
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

LOOKS: dict[str, dict[str, Any]] = {
    "wrong": {"color": RED, "linestyle": "-", "label": "naive"},
    "right": {"color": BLACK, "linestyle": ":", "label": "right"},
    "package": {"color": BLUE, "linestyle": "--", "label": "this package"},
}
"""How each role is drawn; on the page the numbers have the same colours."""
SIZE = 4.6, 2.7


def save_failures(findings: Sequence[Finding], path: Path) -> None:
    """Write entries of the atlas as one self-contained HTML file."""
    save_page(failures_page(findings), path)


def failures_page(findings: Sequence[Finding]) -> str:
    """Return the text of the HTML page, with its pictures as inline SVG."""
    contents = "\n".join(
        f'<a href="#{found.entry.key}">{escape(found.entry.title)}</a>' for found in findings
    )
    articles = "\n".join(map(_article, findings))
    return template("failures.html").format(contents=contents, articles=articles)


def shown(found: Finding, role: str) -> str:
    """Return a number of an entry as text with its unit."""
    value, entry = getattr(found.outcome, role) * found.entry.factor, found.entry
    return f"{value:.4g} {entry.unit}".rstrip() if math.isfinite(value) else "none"


def plot_failure(ax: Any, found: Finding) -> list[Any]:
    """Draw the naive curve and that of the package, and return them."""
    (x, x_factor, x_scale), (y, y_factor, y_scale) = found.entry.x, found.entry.y
    artists = []
    for role, curve in (("wrong", found.outcome.naive), ("package", found.outcome.ours)):
        artists += ax.plot(curve[0] * x_factor, curve[1] * y_factor, **LOOKS[role])
    ax.set(xlabel=x, ylabel=y, xscale=x_scale, yscale=y_scale)
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)  # above the curves
    return artists


def _article(found: Finding) -> str:
    def draw() -> Picture:
        figure = Picture(*SIZE)
        plot_failure(figure.subplots(), found)
        return figure

    entry = found.entry
    picture = inline(draw, f"{entry.key}-")
    numbers = "".join(
        f'<div class="{role}"><span>{look["label"]}</span><b>{_text(shown(found, role))}</b></div>'
        for role, look in LOOKS.items()
    )
    said = f'<p class="said">{escape(found.outcome.said)}</p>\n' if found.outcome.said else ""
    texts = {name: _text(getattr(entry, name)) for name in TEXTS}
    article = template("failure.html").strip()
    return article.format(numbers=numbers, picture=picture, said=said, **texts)


def _text(words: str) -> str:
    """Return text as HTML, with subscripts for symbols such as l_r."""
    return re.sub(
        r"\b([A-Za-zδ])_([A-Za-z0-9]{1,2})(?![A-Za-z0-9_])", r"\1<sub>\2</sub>", escape(words)
    )


COLOURS = "#eef3f7", "#f6c9a3", "#d55e00"
"""Colours of the classes."""
BOUNDARIES: tuple[tuple[str, str, Any], ...] = (
    ("start", "predicted_start", ":"),
    ("steady sliding", "predicted_steady", "-"),
)
"""Name, values and dashes of the predicted boundaries."""
PAPERS_TAUS = 1e-2, 0.1, 1.0
"""Retardation times (s) of Fig. 5 of the paper."""
TABLE1 = 0.1, 0.1
"""V (m/s) and tau (s) of Table 1."""
TITLES = {"paper": "paper (Runge-Kutta)", "explicit-euler": "explicit Euler"}
"""Titles of the schemes whose name alone is unclear."""


def plot_stability(ax: Any, found: Map, factors: tuple[float, float] = (1.0, 1.0)) -> Any:
    """Draw one map, with its axes multiplied by `factors`, and return the image of its classes."""
    x, y = found.x * factors[0], found.y * factors[1]
    image = ax.pcolormesh(
        x, y, found.classes, cmap=ListedColormap(COLOURS), shading="nearest", rasterized=True,
        norm=BoundaryNorm(np.arange(len(CLASSES) + 1) - 0.5, len(CLASSES)),
    )  # fmt: skip
    for _, name, dashes in BOUNDARIES:
        predicted = getattr(found, name)
        if predicted.min() < 1.0 < predicted.max():
            look: Any = {"colors": BLACK, "linestyles": dashes, "linewidths": 1.1}
            ax.contour(x, y, np.log(predicted), [0.0], **look)
    ax.set(xscale="log", yscale="log", xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    ax.grid(False)
    return image


def draw_stability(velocity_maps: Sequence[Map], step_maps: Sequence[Map]) -> Picture:
    """Return the picture: a column for each scheme, with the map over V and tau above the other."""
    drawn = Picture(11.0, 5.4)
    rows = drawn.subplots(2, len(velocity_maps), sharex="row", sharey="row", squeeze=False)
    for ax, found in zip(rows[0], velocity_maps, strict=True):
        plot_stability(ax, found, (1e3, 1.0))
        for tau in PAPERS_TAUS:
            ax.axhline(tau, color=BLUE, linewidth=0.9, alpha=0.7)
        ax.plot(1e3 * TABLE1[0], TABLE1[1], "*", color=BLUE, markersize=10, markeredgecolor="white")
        ax.set(title=TITLES.get(found.scheme, found.scheme), xlabel=r"drive velocity $V$ [mm/s]")
    for ax, found in zip(rows[1], step_maps, strict=True):
        plot_stability(ax, found)
        ax.axvline(StaticState.of(Scene()).drive_number, color=BLUE, linewidth=0.9, alpha=0.7)
        ax.set(xlabel=r"drive number $\lambda$")
    rows[0][0].set_ylabel(r"retardation time $\tau$ [s]")
    rows[1][0].set_ylabel(r"step $\Delta t$ / limit")
    measured = [
        Patch(facecolor=colour, edgecolor="#999999", label=f"measured: {name}")
        for colour, name in zip(COLOURS, CLASSES, strict=True)
    ]
    predicted = [
        Line2D([], [], color=BLACK, linestyle=dashes, label=f"predicted boundary, {name}")
        for name, _, dashes in BOUNDARIES
    ]
    words = r"$\tau$ of Fig. 5, $\lambda$ of Table 1"
    papers = Line2D([], [], color=BLUE, linewidth=0.9, label=words)
    star = Line2D([], [], color=BLUE, marker="*", linestyle="", markersize=9, label="Table 1")
    handles = [*measured, star, *predicted, papers]
    drawn.legend(handles=handles, loc="outside lower center", ncols=4)
    return drawn


def save_stability(maps: Mapping[str, Sequence[Map]], path: Path) -> None:
    """Draw the maps and write them in the format that `path` ends in, with their data as JSON beside."""
    data = {"maps": record(maps)}
    draw = partial(draw_stability, maps["velocity"], maps["step"])
    save_picture(draw, path, beside=data_json(path, data))
