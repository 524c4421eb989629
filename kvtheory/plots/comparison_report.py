"""A comparison as one HTML file: verdict, diagnosis, picture, checks; nothing is loaded from elsewhere."""

import io
from html import escape
from pathlib import Path

from kvtheory.plots.comparison import draw_comparison
from kvtheory.plots.style import STYLE
from kvtheory.results import Check, Comparison
from kvtheory.results.comparison import Explanation
from kvtheory.scene import Scene, to_toml

_PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #222; margin: 2rem auto; max-width: 60rem;
  padding: 0 1rem; }}
h1 {{ font-size: 1.5rem; }} h2 {{ font-size: 1.15rem; margin-top: 2rem; }}
.verdict {{ border-left: .4rem solid {colour}; background: {tint}; padding: .8rem 1rem; }}
.verdict strong {{ color: {colour}; }}
svg {{ width: 100%; height: auto; }}
.wide {{ overflow-x: auto; }}
table {{ border-collapse: collapse; width: 100%; font-size: .9rem; }}
th, td {{ text-align: left; padding: .3rem .6rem; border-bottom: 1px solid #ddd; vertical-align: top; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }}
.yes {{ color: #00674b; }} .no {{ color: #b34700; font-weight: 600; }} .none, .note {{ color: #666; }}
pre {{ background: #f6f6f6; padding: .8rem 1rem; overflow-x: auto; }}
@media print {{ body {{ margin: 0; font-size: 11pt; }} }}
</style>
</head>
<body>
<h1>{title}</h1>
<p class="verdict"><strong>{sentence}</strong> {diagnosis}</p>
{explanations}
<h2>Data over theory</h2>
{picture}
<h2>Checks</h2>
<p class="note">A check is passed if what was measured does not exceed what theory allows{tolerance}.
A difference counts from the band that theory spans within two time steps; what is allowed beyond follows
from one element at an edge of the contact (F15), the noise and the rounding of the data.</p>
<div class="wide"><table>
<thead><tr><th>check</th><th>measured</th><th>allowed</th><th></th><th>equation</th>
<th>what is measured</th></tr></thead>
<tbody>
{checks}
</tbody></table></div>
<h2>Scene</h2>
<pre>{scene}</pre>
<p class="note">Theory after Nakano and Kono (2020), doi:10.3389/fmech.2020.00038; the equation numbers are
theirs, facts F are those of the derivations. Made by kvtheory.</p>
</body>
</html>
"""
_COLOURS = {
    "agrees": ("#00674b", "#e8f5f0"),
    "disagrees": ("#b34700", "#fdf0e7"),
    "cannot tell": ("#5c5c5c", "#f2f2f2"),
}
_SENTENCES = {
    "agrees": "The data agree with theory.",
    "disagrees": "The data disagree with theory.",
    "cannot tell": "Whether the data agree with theory cannot be told.",
}
_MARKS = {True: ("yes", "✓"), False: ("no", "✗ fails"), None: ("none", "not made")}


def save_comparison_report(comparison: Comparison, scene: Scene, path: Path) -> None:
    """Write a comparison as one self-contained HTML file."""
    from kvtheory.export import replace_file

    page = comparison_report(comparison, scene)
    replace_file(path, lambda part: part.write_text(page, encoding="utf-8"))


def comparison_report(comparison: Comparison, scene: Scene) -> str:
    """Return a comparison as the text of one HTML page, with its picture as inline SVG."""
    colour, tint = _COLOURS[comparison.verdict]
    factor = (
        "" if comparison.tolerance == 1.0 else f", times the tolerance {comparison.tolerance:g}"
    )
    return _PAGE.format(
        title=f"{escape(Path(comparison.source).name)} against theory",
        sentence=_SENTENCES[comparison.verdict],
        diagnosis=escape(comparison.diagnosis),
        explanations=_explanations(comparison),
        picture=_picture(comparison),
        checks="\n".join(_row(check) for check in comparison.checks),
        scene=escape(to_toml(scene).strip()),
        colour=colour, tint=tint, tolerance=factor,
    )  # fmt: skip


def _part(each: Explanation) -> str:
    return "a sign of it" if each.explained is None else f"{each.explained:.1%}"


def _explanations(comparison: Comparison) -> str:
    if not comparison.explanations:
        return ""
    rows = "\n".join(
        f'<tr><td>{escape(each.name)}</td><td class="number">{_part(each)}</td>'
        f"<td>{'yes' if each.enough else 'no'}</td><td>{escape(each.text)}</td></tr>"
        for each in comparison.explanations
    )
    heads = "<th>fault</th><th>explains</th><th>enough</th><th>in words</th>"
    return (
        "<h2>What would explain it</h2>\n"
        f'<div class="wide"><table><thead><tr>{heads}</tr></thead><tbody>\n{rows}\n</tbody></table></div>'
    )


def _picture(comparison: Comparison) -> str:
    """Return the curves as an SVG element."""
    import matplotlib as mpl

    with mpl.rc_context({**STYLE}):
        text = io.StringIO()
        draw_comparison(comparison, checks=False).savefig(
            text, format="svg", metadata={"Date": None}
        )
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]


def _row(check: Check) -> str:
    kind, mark = _MARKS[check.ok]
    numbers = ["" if value is None else f"{value:.3g}" for value in (check.measured, check.allowed)]
    cells = "".join(f'<td class="number">{number}</td>' for number in numbers)
    what = "; ".join(filter(None, (check.unit, check.note)))
    return (
        f'<tr><td>{escape(check.name)}</td>{cells}<td class="{kind}">{mark}</td>'
        f"<td>{escape(check.equation)}</td><td>{escape(what)}</td></tr>"
    )
