"""The atlas of failures as one self-contained HTML file: each entry with its numbers and its picture."""

import math
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from kvtheory.charts.entry import TEXTS, Finding, Picture
from kvtheory.plots.files import inline, save_page, template
from kvtheory.plots.style import BLACK, BLUE, RED

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
    if not math.isfinite(value):
        return "none"
    return f"{value:.4g} {entry.unit}".rstrip()


def plot_failure(ax: Any, picture: Picture) -> list[Any]:
    """Draw the curves of an entry and return them."""
    artists = [
        ax.plot(line.x, line.y, **LOOKS[line.role])[0] for line in picture.lines if line.x.size
    ]
    x, y = ("log" if logarithmic else "linear" for logarithmic in (picture.log_x, picture.log_y))
    ax.set(xlabel=picture.x, ylabel=picture.y, xscale=x, yscale=y)
    ax.legend(loc="best")
    return artists


def _article(found: Finding) -> str:
    entry = found.entry
    numbers = "".join(
        f'<div class="{role}"><span>{look["label"]}</span><b>{_text(shown(found, role))}</b></div>'
        for role, look in LOOKS.items()
    )
    said = f'<p class="said">{escape(found.outcome.said)}</p>\n' if found.outcome.said else ""
    texts = {name: _text(getattr(entry, name)) for name in TEXTS}
    article = template("failure.html").strip()
    return article.format(numbers=numbers, picture=_svg(found), said=said, **texts)


def _svg(found: Finding) -> str:
    from matplotlib.figure import Figure

    def draw() -> Figure:
        figure = Figure(figsize=SIZE, layout="constrained")
        plot_failure(figure.subplots(), found.outcome.picture)
        return figure

    # No two pictures of the page may share an id.
    return re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{found.entry.key}-", inline(draw))


def _text(words: str) -> str:
    """Return text as HTML, with subscripts for symbols such as l_r."""
    return re.sub(
        r"\b([A-Za-zδ])_([A-Za-z0-9]{1,2})(?![A-Za-z0-9_])", r"\1<sub>\2</sub>", escape(words)
    )
