"""The atlas of failures as one self-contained HTML file: each entry with its numbers and its picture."""

import math
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from kvtheory.charts.failures import TEXTS, Finding
from kvtheory.plots.files import inline, save_page, template
from kvtheory.plots.style import BLACK, BLUE, RED, Picture

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
    # No two pictures of the page may share an id.
    picture = re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{entry.key}-", inline(draw))
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
