"""Derivations printed as LaTeX, HTML, PDF, JSON, Markdown, a notebook and BibTeX."""

from .edition import Edition, edition
from .pdf import RenderError, latex_engine
from .write import FORMATS, check_directory, check_formats, write, write_edition

__all__ = [
    "FORMATS",
    "Edition",
    "RenderError",
    "check_directory",
    "check_formats",
    "edition",
    "latex_engine",
    "write",
    "write_edition",
]
