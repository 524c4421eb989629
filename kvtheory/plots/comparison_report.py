"""A comparison as one HTML file: verdict, diagnosis, picture, checks; nothing is loaded from elsewhere."""

from html import escape
from pathlib import Path

from kvtheory.plots.comparison import draw_comparison
from kvtheory.plots.files import inline, save_page, template
from kvtheory.results import Check, Comparison
from kvtheory.results.comparison import Explanation
from kvtheory.scene import Scene, to_toml

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
    save_page(comparison_report(comparison, scene), path)


def comparison_report(comparison: Comparison, scene: Scene) -> str:
    """Return a comparison as the text of one HTML page, with its picture as inline SVG."""
    colour, tint = _COLOURS[comparison.verdict]
    factor = (
        "" if comparison.tolerance == 1.0 else f", times the tolerance {comparison.tolerance:g}"
    )
    return template("comparison.html").format(
        title=f"{escape(Path(comparison.source).name)} against theory",
        sentence=_SENTENCES[comparison.verdict],
        diagnosis=escape(comparison.diagnosis),
        explanations=_explanations(comparison),
        picture=inline(lambda: draw_comparison(comparison, checks=False)),
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


def _row(check: Check) -> str:
    kind, mark = _MARKS[check.ok]
    numbers = ["" if value is None else f"{value:.3g}" for value in (check.measured, check.allowed)]
    cells = "".join(f'<td class="number">{number}</td>' for number in numbers)
    what = "; ".join(filter(None, (check.unit, check.note)))
    return (
        f'<tr><td>{escape(check.name)}</td>{cells}<td class="{kind}">{mark}</td>'
        f"<td>{escape(check.equation)}</td><td>{escape(what)}</td></tr>"
    )
