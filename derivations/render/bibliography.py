"""What to cite: the paper, and the derivations with the version that made them, as BibTeX."""

from . import frame
from .edition import Edition
from .latex_words import escape

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
        f"  note    = {{Made by \\texttt{{{escape(edition.command)}}}}},\n"
        if edition.command
        else ""
    )
    return (
        f"{_PAPER}\n@misc{{kvtheory-derivations,\n  author  = {{{{The kvtheory developers}}}},\n"
        f"  title   = {{{{{edition.title.replace('–', '--')}}}}},\n{version}{note}"
        "  howpublished = {Software}\n}\n"
    )
