"""`kvtheory derive`: the derivations, checked and printed."""

import os
from pathlib import Path

import click

from kvtheory.cli.console import Examples, print_json, split, teaching
from kvtheory.cli.group import main


@main.command(
    cls=Examples, example="kvtheory derive -o derivations-out --format tex,html --only eq27,F3"
)
@click.option(
    "-o",
    "--output",
    type=click.Path(file_okay=False, path_type=Path),
    default=Path("paper/derivations"),
    show_default=True,
    help="Directory to write to.",
)
@click.option(
    "--format",
    "formats",
    default=None,
    metavar="tex,html,pdf,json",
    help="Default: all; pdf where a LaTeX engine is found.",
)
@click.option(
    "--only", default="", metavar="eq27,F3,...", help="Labels of the derivations to print."
)
@click.option(
    "--json", "as_json", is_flag=True, help="Print one JSON object about what was written."
)
@teaching
def derive(output: Path, formats: str | None, only: str, as_json: bool) -> None:
    """Derive the equations, check every step, and print them as LaTeX, HTML, PDF and JSON."""
    from derivations.catalogue import catalogue
    from derivations.render import latex_engine, write

    if formats is None:
        formats = "tex,html,pdf,json"
        if latex_engine() is None:
            formats = "tex,html,json"
            click.echo(
                "kvtheory: no LaTeX engine (pdflatex) found, so no PDF; the rest is written",
                err=True,
            )
    derived = catalogue()
    paths = write(derived, output, split(formats), split(only))
    counts: dict[str, int] = {}
    for derivation in derived:
        counts[derivation.status] = counts.get(derivation.status, 0) + 1
    if as_json:
        print_json(
            {
                "directory": str(output),
                "files": [str(path) for path in paths],
                "derivations": counts,
            }
        )
        return
    click.echo("Derived and checked: " + ", ".join(f"{n} {status}" for status, n in counts.items()))
    for path in paths:
        if path.parent == output:
            click.echo(f"  {path}")
    fragments = [path for path in paths if path.parent != output]
    if fragments:
        click.echo(f"  {fragments[0].parent}{os.sep} ({len(fragments)} equations for \\input)")
