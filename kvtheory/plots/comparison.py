"""A simulation compared with theory: data over theory, residuals, checks, and a page with all of them."""

from collections.abc import Sequence
from functools import partial
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.plots.files import inline, save_page, template
from kvtheory.plots.style import BLACK, BLUE, GREEN, RED, TRANSIENT_ROWS, Picture, with_unit
from kvtheory.results.comparison import HEADS, Comparison
from kvtheory.results.presented import aligned
from kvtheory.results.table import QUANTITIES, SPRING_UNITS
from kvtheory.scene import Scene, to_toml

CURVES = {
    **{name: (symbol, sign) for name, symbol, sign in TRANSIENT_ROWS if name != "velocity"},
    **{
        name: (f"${QUANTITIES[name].symbol}$", 1.0)
        for name in (*SPRING_UNITS, "friction_coefficient")
    },
}
"""Curves that are drawn if the data contain them: symbol, sign."""
DOTS = 200
"""With more samples than this the data are drawn as a line."""
LOOKS = {"ok": ("yes", BLACK), "NO": ("no", RED), "not made": ("none", "#777777")}
"""Class on the page and colour in the picture of each mark of a check."""
HTML_VERDICTS = {
    "agrees": ("#00674b", "#e8f5f0", "The data agree with theory."),
    "disagrees": ("#b34700", "#fdf0e7", "The data disagree with theory."),
    "cannot tell": ("#5c5c5c", "#f2f2f2", "The data are inconclusive."),
}
"""Colours of text and background, and the verdict in a sentence."""
EXPLANATIONS = """<h2>Possible explanations</h2>
<div class="wide"><table>
<thead><tr><th>fault</th><th class="number">explains</th><th>enough</th><th>description</th></tr></thead>
<tbody>
{}
</tbody></table></div>"""
ALLOWANCES = (
    "A curve may differ as much as its own scatter allows.",
    "A difference is measured from the band that theory spans within two time steps; the allowance beyond it "
    "follows from one element at an edge of the contact (F15), the noise and the rounding of the data.",
)
"""What a check of a curve over velocity, or of a time series, allows."""
TITLES = "data over theory", "data minus theory"
MARGIN = 1.6
"""Limit of the axis of residuals, relative to the band, which leaves space for the legend above it."""
WIDTH, HEIGHT, LONGEST = 7.2, 1.9, 154
"""Width of a picture and height of a row of it in inches, and most characters of a line."""


def plot_comparison(axes: Sequence[Sequence[Any]], comparison: Comparison) -> list[Any]:
    """Draw each curve on the pair of axes (data over theory, residual) of its row.

    Returns the lines: theory, data and residual of each curve that the data contain.

    >>> import kvtheory as kv
    >>> from matplotlib.figure import Figure
    >>> found = kv.compare(data=kv.transient(at=[i * 1e-3 for i in range(200)]))
    >>> lines = plot_comparison(Figure().subplots(3, 2), found)
    >>> len(lines), bool(abs(lines[2].get_ydata()).max() < 1e-6)
    (9, True)
    """
    names = [name for name in CURVES if name in comparison.series]
    axis = next(iter(comparison.series))
    time = np.asarray(comparison.series[axis]) * 1e3
    artists: list[Any] = []
    for (over, rest), name in zip(axes, names, strict=False):
        symbol, sign = CURVES[name]
        label, factor = with_unit(symbol, comparison.units[name])
        factor *= sign
        data, theory = comparison.series[name] * factor, comparison.theory[name] * factor
        style = "." if time.size <= DOTS else "-"
        artists += over.plot(time, theory, color=BLACK, linewidth=0.8, label="theory", zorder=3)
        artists += over.plot(
            time, data, style, color=BLUE, markersize=4, linewidth=2.5, alpha=0.6, label="data"
        )
        over.set(ylabel=label)
        band = comparison.allowed[name] * abs(factor)
        rest.fill_between(time, -band, band, color=GREEN, alpha=0.2, linewidth=0, label="allowed")
        left = data - theory
        artists += rest.plot(
            time, left, style, color=BLUE, markersize=3, linewidth=0.8, label="data - theory"
        )
        # Limits that show nearly all of the residual, not only its jump.
        most = float(np.nanquantile(np.abs(left), 0.98))
        top = MARGIN * max(most, float(np.median(band)), 1e-300)
        rest.set_ylim(-top, top)
    for row in axes[len(names) :]:
        for ax in row:
            ax.set_axis_off()
    log = axis != "time" and bool((time > 0.0).all())
    for ax in axes[len(names) - 1]:
        ax.set(xlabel=r"time $t$ [ms]" if axis == "time" else r"velocity $V$ [mm/s]")
        ax.set(xscale="log" if log else "linear")
    axes[0][0].legend(loc="best")
    axes[0][1].legend(loc="upper right", ncols=2, fontsize=8)
    return artists


def draw_comparison(comparison: Comparison) -> Any:
    """Return a figure of the curves, and the list of checks below them."""
    rows, table = _rows(comparison), 0.17 * (len(comparison.checks) + 3)
    figure = Picture(WIDTH, HEIGHT * rows + table + 0.4)
    parts: Any = figure.subfigures(2, 1, height_ratios=[HEIGHT * rows, table])
    above, below = parts
    _draw(above.subplots(rows, 2, sharex=True, squeeze=False), comparison)
    title = f"{Path(comparison.source).name}: {comparison.verdict}"
    above.suptitle(title, fontsize=10, parse_math=False)
    _list_checks(below.subplots(), comparison)
    return figure


def _half(comparison: Comparison, which: int) -> Picture:
    """Return the figure of the curves, or that of the residuals, for a page that may be narrow."""
    rows = _rows(comparison)
    halves = [Picture(WIDTH / 2.0, HEIGHT * rows + 0.2) for _ in TITLES]
    axes = [each.subplots(rows, 1, sharex=True, squeeze=False) for each in halves]
    _draw(np.hstack(axes), comparison)
    return halves[which]


def _rows(comparison: Comparison) -> int:
    return sum(name in comparison.series for name in CURVES)


def _draw(axes: Any, comparison: Comparison) -> None:
    plot_comparison(axes, comparison)
    for ax, title in zip(axes[0], TITLES, strict=True):
        ax.set_title(title, fontsize=9)


def _list_checks(ax: Any, comparison: Comparison) -> None:
    """Write the checks as lines of text."""
    ax.set_axis_off()
    looks = [BLACK, *(LOOKS[row[3]][1] for row in comparison.rows)]
    ax.set(ylim=(len(looks), 0.0))
    for row, (line, colour) in enumerate(zip(aligned(HEADS, comparison.rows), looks, strict=True)):
        shown = line if len(line) <= LONGEST else f"{line[: LONGEST - 1]}…"
        ax.text(0.0, row, shown, fontsize=5.5, family="monospace", color=colour)


def save_comparison_report(comparison: Comparison, scene: Scene, path: Path) -> None:
    """Write a comparison as one self-contained HTML file."""
    save_page(comparison_report(comparison, scene), path)


def comparison_report(comparison: Comparison, scene: Scene) -> str:
    """Return a comparison as the text of one HTML page, with its picture as inline SVG."""
    colour, tint, sentence = HTML_VERDICTS[comparison.verdict]
    checks = [
        _row(row, ("", "number", "number", LOOKS[row[3]][0], "", "")) for row in comparison.rows
    ]
    explanations = []
    for each in comparison.explanations:
        part = "a symptom" if each.explained is None else f"{each.explained:.1%}"
        cells = each.name, part, "yes" if each.enough else "no", each.text
        explanations.append(_row(cells, ("", "number", "", "")))
    tolerance = comparison.tolerance
    return template("comparison.html").format(
        title=f"{escape(Path(comparison.source).name)} against theory",
        sentence=sentence, colour=colour, tint=tint,
        diagnosis=escape(comparison.diagnosis),
        explanations=EXPLANATIONS.format("\n".join(explanations)) if explanations else "",
        pictures="\n".join(
            inline(partial(_half, comparison, k), f"half-{k}-") for k in range(len(TITLES))
        ),
        checks="\n".join(checks),
        allowance=ALLOWANCES["time" in comparison.series],
        scene=escape(to_toml(scene).strip()),
        tolerance="" if tolerance == 1.0 else f", times the tolerance {tolerance:g}",
    )  # fmt: skip


def _row(cells: Sequence[str], classes: Sequence[str]) -> str:
    """Return a row of an HTML table."""
    named = [f' class="{name}"' if name else "" for name in classes]
    pairs = zip(named, cells, strict=True)
    return f"<tr>{''.join(f'<td{name}>{escape(cell)}</td>' for name, cell in pairs)}</tr>"
