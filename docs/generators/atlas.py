"""The atlas of failures as a page, recomputed, with the machine and the versions that computed it."""

from pathlib import Path

from kvtheory.charts.failures import ATLAS, findings
from kvtheory.plots.failures import save_failures, shown
from kvtheory.plots.files import environment


def write(directory: Path) -> dict[str, str]:
    """Write the atlas as it is into the site, and return its page."""
    target = directory / "extra" / "failures.html"
    page = directory / "atlas.md"
    if page.exists() and target.exists():
        return {}
    found = list(findings(list(ATLAS)))
    target.parent.mkdir(parents=True, exist_ok=True)
    save_failures(found, target)
    roles = ("wrong", "right", "package")
    rows = [
        f'| <a href="../failures.html#{each.entry.key}">{each.entry.title}</a> | {each.entry.quantity} | '
        + " | ".join(shown(each, role) for role in roles)
        + " |"
        for each in found
    ]
    table = "\n".join(
        [
            "| how a method fails | quantity | naive | right | this package |",
            "|---|---|---|---|---|",
            *rows,
        ]
    )
    machine = "\n".join(f"- {name}: {value}" for name, value in environment().items())
    return {"atlas.md": f"{_HEAD}\n{table}\n\n## Machine and versions\n\n{machine}\n"}


_HEAD = """# Atlas of failures

Scenes in which a plausible method gives a wrong number, beside the right number from a different kind of
method. <a href="../failures.html">The full atlas</a> says why, how to notice, and what this package
does about it; `kvtheory chart failures` computes it.
"""
