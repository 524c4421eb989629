"""What to cite: the paper, and the derivations with the version that made them, as BibTeX."""

from . import frame
from .edition import Edition

_PAPER = rf"""@article{{NakanoKono2020,
  author  = {{Nakano, Ken and Kono, Masaharu}},
  title   = {{Transient and steady sliding friction of elastomers: impact of vertical lift}},
  journal = {{Frontiers in Mechanical Engineering}},
  volume  = {{6}},
  pages   = {{38}},
  year    = {{2020}},
  doi     = {{{frame.DOI}}}
}}
"""


def document(edition: Edition) -> str:
    """Return both entries; `version` and the command say how to reproduce the derivations."""
    version = f"  version = {{{edition.version}}},\n" if edition.version else ""
    note = (
        f"  note    = {{Made by \\texttt{{{_escaped(edition.command)}}}}},\n"
        if edition.command
        else ""
    )
    return (
        f"{_PAPER}\n@misc{{kvtheory-derivations,\n  author  = {{{{The kvtheory developers}}}},\n"
        f"  title   = {{{{{edition.title.replace('–', '--')}}}}},\n{version}{note}"
        "  howpublished = {Software}\n}\n"
    )


def _escaped(command: str) -> str:
    return "".join(rf"\{char}" if char in "_%&#$" else char for char in command)
