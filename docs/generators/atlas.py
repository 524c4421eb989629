"""The atlas of failures as a page, recomputed, with the machine and the versions that computed it."""

from collections.abc import Sequence
from pathlib import Path

from generators.files import put
from kvtheory.charts.failures import Finding, findings
from kvtheory.plots.failures import save_failures, shown
from kvtheory.plots.files import environment


def write(directory: Path, found: Sequence[Finding] = ()) -> None:
    """Write the atlas as it is into the site, and its page, from these findings or computed anew."""
    found = found or list(findings())
    target = directory / "extra" / "failures.html"
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
    put(directory / "atlas.md", f"{_HEAD}\n{table}\n\n## Machine and versions\n\n{machine}\n")


_HEAD = """# Atlas of failures

Scenes in which a plausible method gives a wrong number, beside the right number from a different kind of
method. <a href="../failures.html">The full atlas</a> says why, how to notice, and what this package
does about it; `kvtheory chart failures` computes it.
"""
