"""Pictures and pages as files: pictures by their suffix, pages of HTML that hold all they need."""

import io
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any

from kvtheory.export import replace_file
from kvtheory.plots.style import STYLE


def check_picture(path: Path) -> None:
    """Raise `ValueError` unless matplotlib can write a picture with this suffix, `OSError` if not there."""
    from matplotlib.backend_bases import FigureCanvasBase

    if path.suffix[1:] not in FigureCanvasBase.get_supported_filetypes():
        raise ValueError(f'"{path}": expected a name that ends in .png, .svg or .pdf')
    if not path.parent.is_dir():
        raise OSError(f'"{path}": there is no directory "{path.parent}"')


def save_picture(draw: Callable[[], Any], path: Path) -> None:
    """Draw a figure in the style of the package and write it as the suffix of `path` says.

    Raises
    ------
    ValueError, OSError
        If matplotlib does not know the suffix, or there is no such directory.
    """
    import matplotlib as mpl

    check_picture(path)
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
