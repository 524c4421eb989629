"""Pictures and pages as files: pictures by their suffix, pages of HTML that hold all they need."""

import io
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

from kvtheory.export import PICTURES, check_path, replace_file
from kvtheory.plots.style import STYLE


def save_picture(draw: Callable[[], Any], path: Path) -> None:
    """Draw a figure in the style of the package and write it as the suffix of `path` says.

    Raises
    ------
    ValueError, OSError
        If the name does not end in .png, .svg or .pdf, or the file cannot be written.
    """
    import matplotlib as mpl

    check_path(path, PICTURES)
    with mpl.rc_context({**STYLE}):
        replace_file(path, draw().savefig)


def inline(draw: Callable[[], Any]) -> str:
    """Return the figure that `draw` makes as an SVG element."""
    import matplotlib as mpl

    with mpl.rc_context({**STYLE}):
        text = io.StringIO()
        draw().savefig(text, format="svg", metadata={"Date": None})
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]


def template(name: str) -> str:
    """Return a page or a part of it, in which names in braces are still to be filled in."""
    return files("kvtheory.plots").joinpath(name).read_text(encoding="utf-8")


def save_page(text: str, path: Path) -> None:
    """Write a page of HTML."""
    replace_file(path, lambda part: part.write_text(text, encoding="utf-8"))
