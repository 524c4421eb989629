"""A simulation held against theory: data over theory, what is left, and the checks."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.plots.files import save_picture
from kvtheory.plots.style import BLACK, BLUE, GREEN, RED
from kvtheory.results import Check, Comparison

CURVES = {
    "depth": (r"$z_\mathrm{A}$ [mm]", -1e3),
    "normal_force": (r"$F_z$ [N/mm]", 1e-3),
    "friction_force": (r"$F_x$ [N/mm]", 1e-3),
}
"""What is drawn, if the data hold it: axis label, factor from SI."""
DOTS = 200
"""More samples than this are drawn as a line."""
MARKS = {True: ("ok", GREEN), False: ("fails", RED), None: ("not made", "#777777")}
ROOM = 1.6
"""Of the band: how far the axis of the residuals goes, for the legend has its place above the band."""
LONGEST_NOTE = 74
SIZE = (7.2, 8.6)


def plot_comparison(axes: Sequence[Sequence[Any]], comparison: Comparison) -> list[Any]:
    """Draw each curve on the pair of axes (data over theory, residual) of its row.

    Returns the lines: theory, data and residual of each curve that the data hold.

    >>> import kvtheory as kv
    >>> from matplotlib.figure import Figure
    >>> found = kv.compare(data=kv.transient(at=[i * 1e-3 for i in range(200)]))
    >>> lines = plot_comparison(Figure().subplots(3, 2), found)
    >>> len(lines), bool(abs(lines[2].get_ydata()).max() < 1e-6)
    (9, True)
    """
    names = [name for name in CURVES if name in comparison.series]
    time = np.asarray(comparison.series["time"]) * 1e3
    artists: list[Any] = []
    for (over, rest), name in zip(axes, names, strict=False):
        label, factor = CURVES[name]
        data, theory = comparison.series[name] * factor, comparison.theory[name] * factor
        style = "." if time.size <= DOTS else "-"
        artists += over.plot(time, theory, color=BLACK, linewidth=0.8, label="theory", zorder=3)
        artists += over.plot(
            time, data, style, color=BLUE, markersize=4, linewidth=2.5, alpha=0.6, label="data"
        )
        over.set(ylabel=label)
        band = comparison.allowed[name] * abs(factor)
        rest.fill_between(time, -band, band, color=GREEN, alpha=0.2, linewidth=0, label="allowed")
        artists += rest.plot(
            time,
            data - theory,
            style,
            color=BLUE,
            markersize=3,
            linewidth=0.8,
            label="data - theory",
        )
        rest.set_ylim(_limits(data - theory, band))
    for row in axes[len(names) :]:
        for ax in row:
            ax.set_axis_off()
    for ax in axes[len(names) - 1]:
        ax.set(xlabel=r"time $t$ [ms]")
    axes[0][0].legend(loc="best")
    axes[0][1].legend(loc="upper right", ncols=2, fontsize=8)
    return artists


def _limits(residual: Any, band: Any) -> tuple[float, float]:
    """Return limits that show nearly all of the residual, not only its jump."""
    most = float(np.nanquantile(np.abs(residual), 0.98))
    top = ROOM * max(most, float(np.median(band)), 1e-300)
    return -top, top


def draw_comparison(comparison: Comparison, *, checks: bool = True) -> Any:
    """Return a figure of the curves and, unless left out, the list of checks below them."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    rows = sum(name in comparison.series for name in CURVES)
    height = 1.9 * rows
    table = 0.17 * (len(comparison.checks) + 3) if checks else 0.0
    figure = Figure(figsize=(SIZE[0], height + table + 0.4), layout="constrained")
    FigureCanvasAgg(figure)
    parts: Any = figure.subfigures(2, 1, height_ratios=[height, table]) if checks else [figure]
    axes = parts[0].subplots(rows, 2, sharex=True, squeeze=False)
    plot_comparison(axes, comparison)
    title = f"{Path(comparison.source).name}: {comparison.verdict}"
    parts[0].suptitle(title, fontsize=10, parse_math=False)
    axes[0][0].set_title("data over theory", fontsize=9)
    axes[0][1].set_title("data less theory", fontsize=9)
    if checks:
        _list(parts[1], comparison.checks)
    return figure


def _list(part: Any, checks: Sequence[Check]) -> None:
    """Write the checks as lines of text."""
    ax = part.subplots()
    ax.set_axis_off()
    ax.set(xlim=(0, 1), ylim=(len(checks) + 0.5, -1.0))
    columns = (
        (0.0, "check"),
        (0.25, "measured"),
        (0.355, "allowed"),
        (0.455, ""),
        (0.54, "equation, note"),
    )
    for x, head in columns:
        ax.text(x, -0.6, head, fontsize=7, fontweight="bold", va="center")
    for row, check in enumerate(checks):
        mark, colour = MARKS[check.ok]
        numbers = (
            ("", "") if check.ok is None else (f"{check.measured:.2e}", f"{check.allowed:.2e}")
        )
        note = f"{check.equation}; {check.note}" if check.note else check.equation
        short = note if len(note) <= LONGEST_NOTE else note[: LONGEST_NOTE - 3] + "..."
        cells = (check.name, *numbers, mark, short)
        for (x, _), cell in zip(columns, cells, strict=True):
            ax.text(
                x,
                row + 0.4,
                cell,
                fontsize=6.5,
                va="center",
                color=colour if cell == mark else BLACK,
            )


def save_comparison_plot(comparison: Comparison, path: Path) -> None:
    """Draw a comparison and write it as the suffix of `path` says.

    Raises
    ------
    ValueError
        If the name does not end in .png, .svg or .pdf.
    OSError
        If the file cannot be written.
    """
    save_picture(lambda: draw_comparison(comparison), path)
