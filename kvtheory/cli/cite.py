"""`kvtheory cite`: how to cite the package and the paper it rests on."""

import click

from kvtheory.cli.console import Examples, report_errors
from kvtheory.cli.group import main

PAPER = """@article{nakano2020,
  author  = {Nakano, Ken and Kono, Masaharu},
  title   = {Transient and Steady Sliding Friction of Elastomers: Impact of Vertical Lift},
  journal = {Frontiers in Mechanical Engineering},
  volume  = {6},
  pages   = {38},
  year    = {2020},
  doi     = {10.3389/fmech.2020.00038},
}"""
SOFTWARE = """@software{{kvtheory,
  author  = {{{{The kvtheory developers}}}},
  title   = {{kvtheory: the sliding friction of elastomers, derived, exact and checked}},
  version = {{{version}}},
  year    = {{2026}},
}}"""


@main.command(cls=Examples, example="kvtheory cite >> references.bib")
@report_errors
def cite() -> None:
    """Print BibTeX entries for this version of the package, and for the paper it rests on."""
    from kvtheory import __version__

    click.echo(f"{SOFTWARE.format(version=__version__)}\n\n{PAPER}")
