"""Derivations printed as LaTeX, HTML, PDF and JSON."""

from derivations.render.pdf import RenderError, latex_engine
from derivations.render.write import FORMATS, write

__all__ = ["FORMATS", "RenderError", "latex_engine", "write"]
