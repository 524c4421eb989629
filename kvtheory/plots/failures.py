"""The atlas of failures as one HTML file: an entry, its numbers and its picture; nothing is loaded."""

import io
import math
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path
from typing import Any

from kvtheory.charts.entry import Finding, Picture
from kvtheory.plots.style import BLACK, BLUE, RED, STYLE

LOOKS: dict[str, dict[str, Any]] = {
    "wrong": {"color": RED, "linestyle": "-", "label": "as written"},
    "right": {"color": BLACK, "linestyle": ":", "label": "right"},
    "package": {"color": BLUE, "linestyle": "--", "label": "this package"},
}
"""How each role is drawn; on the page the numbers have the same colours."""
SIZE = 4.6, 2.7

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Where methods fail</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #222;
  margin: 2rem auto; max-width: 66rem; padding: 0 1rem; }}
h1 {{ font-size: 1.7rem; margin-bottom: .3rem; }}
h2 {{ font-size: 1.2rem; margin: 0 0 .3rem; }}
sub {{ font-size: .7em; line-height: 0; }}
nav {{ columns: 17rem; margin: 1.5rem 0; }}
nav a {{ display: block; color: #0072b2; text-decoration: none; padding: .1rem 0; }}
nav a:hover {{ text-decoration: underline; }}
article {{ border-top: 1px solid #ddd; padding: 1.8rem 0 .8rem; display: grid; gap: 0 2rem;
  grid-template-columns: minmax(0, 1fr) minmax(0, 1fr); align-items: start; }}
article > * {{ min-width: 0; }}
.scene, .note {{ color: #555; }}
.scene {{ margin: 0 0 .6rem; }}
dl {{ margin: .8rem 0; }}
dt {{ font-weight: 600; font-size: .85rem; color: #555; margin-top: .5rem; }} dd {{ margin: 0; }}
.numbers {{ display: flex; gap: .5rem; margin: 0 0 .6rem; }}
.numbers div {{ flex: 1; border-top: .25rem solid; padding: .4rem .1rem 0; min-width: 0; }}
.numbers span {{ display: block; font-size: .8rem; color: #555; }}
.numbers b {{ font-size: 1rem; font-variant-numeric: tabular-nums; }}
.wrong {{ border-color: #d55e00 !important; }}
.right {{ border-color: #000 !important; }}
.package {{ border-color: #0072b2 !important; }}
svg {{ width: 100%; height: auto; display: block; }}
.said {{ background: #f6f6f6; padding: .6rem .8rem; font: .85rem/1.45 ui-monospace, monospace;
  overflow-wrap: anywhere; grid-column: 1 / -1; margin: .6rem 0; }}
code {{ font-size: .85em; background: #f6f6f6; padding: .1rem .3rem; }}
@media (max-width: 46rem) {{ article {{ display: block; }} }}
@media print {{ body {{ margin: 0; font-size: 10pt; }} article {{ break-inside: avoid; }} }}
</style>
</head>
<body>
<h1>Where methods fail</h1>
<p class="note">Each entry is a scene in which a method that looks right gives a wrong number, computed
anew for this page beside the right number and that of this package. The right number is a formula, or
comes from a method that shares no code with the one that is shown for the package.</p>
<nav>
{contents}
</nav>
{articles}
<p class="note">After Nakano and Kono (2020), doi:10.3389/fmech.2020.00038; the equation numbers are
theirs, facts F are those of the derivations. Made by kvtheory.</p>
</body>
</html>
"""
_ARTICLE = """<article id="{key}">
<div>
<h2>{title}</h2>
<p class="scene">{scene}</p>
<div class="numbers">{numbers}</div>
<dl><dt>Why</dt><dd>{why}</dd>
<dt>How to notice</dt><dd>{notice}</dd>
<dt>What this package does</dt><dd>{package}</dd></dl>
</div>
<figure style="margin:0">{picture}
<figcaption class="note"><code>kvtheory chart failures --only {key}</code></figcaption></figure>
{said}</article>"""


def save_failures(findings: Sequence[Finding], path: Path) -> None:
    """Write entries of the atlas as one self-contained HTML file."""
    from kvtheory.export import replace_file

    page = failures_page(findings)
    replace_file(path, lambda part: part.write_text(page, encoding="utf-8"))


def failures_page(findings: Sequence[Finding]) -> str:
    """Return the text of the HTML page, with its pictures as inline SVG."""
    contents = "\n".join(
        f'<a href="#{found.entry.key}">{escape(found.entry.title)}</a>' for found in findings
    )
    return _PAGE.format(contents=contents, articles="\n".join(map(_article, findings)))


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
    ax.set(xlabel=picture.x, ylabel=picture.y)
    if picture.log_x:
        ax.set_xscale("log")
    if picture.log_y:
        ax.set_yscale("log")
    ax.legend(loc="best")
    return artists


def _article(found: Finding) -> str:
    entry = found.entry
    heads = {"wrong": "as written", "right": "right", "package": "this package"}
    numbers = "".join(
        f'<div class="{role}"><span>{head}</span><b>{_text(shown(found, role))}</b></div>'
        for role, head in heads.items()
    )
    said = f'<p class="said">{escape(found.outcome.said)}</p>\n' if found.outcome.said else ""
    texts = {
        name: _text(getattr(entry, name))
        for name in ("key", "title", "scene", "why", "notice", "package")
    }
    texts["scene"] += f". Asked for: {entry.quantity}."
    return _ARTICLE.format(numbers=numbers, picture=_svg(found), said=said, **texts)


def _svg(found: Finding) -> str:
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context({**STYLE}):
        figure = Figure(figsize=SIZE, layout="constrained")
        plot_failure(figure.subplots(), found.outcome.picture)
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
    drawn = text.getvalue()
    # So that no two pictures of the page share an id.
    return re.sub(
        r'(\bid="|href="#|url\(#)', rf"\g<1>{found.entry.key}-", drawn[drawn.index("<svg") :]
    )


def _text(words: str) -> str:
    """Return words as HTML, with the subscripts of symbols such as l_r."""
    return re.sub(
        r"\b([A-Za-zδ])_([A-Za-z0-9]{1,2})(?![A-Za-z0-9_])", r"\1<sub>\2</sub>", escape(words)
    )
