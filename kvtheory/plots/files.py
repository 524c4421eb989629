"""Output files: pictures by suffix, charts with their data beside them, self-contained HTML pages."""

import io
import json
import os
import platform
from collections.abc import Callable, Mapping
from importlib import metadata
from importlib.resources import files
from pathlib import Path
from typing import Any

from kvtheory.export import PICTURES, check_path, replace_file, replace_files
from kvtheory.plots.style import STYLE

PACKAGES = "kvtheory", "numpy", "scipy", "numba", "scikit-sundae"
"""The packages whose versions are recorded with a chart."""


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


def save_chart(draw: Callable[[], Any], data: Mapping[str, Any], path: Path) -> None:
    """Draw and write a picture, and its data as JSON beside it, with machine and versions."""
    text = json.dumps({"environment": environment(), **data}, indent=1, allow_nan=False)
    picture, page = path, path.with_suffix(".json")
    replace_files({
        picture: lambda part: save_picture(draw, part),
        page: lambda part: save_page(text + "\n", part),
    })  # fmt: skip


def environment() -> dict[str, str | int]:
    """Return machine, processors, and versions; a package that is not installed is ``"-"``.

    >>> sorted(environment())[:3]
    ['kvtheory', 'machine', 'numba']
    """
    return {
        "machine": platform.machine(),
        "system": platform.system(),
        "processor": _processor(),
        "processors": os.cpu_count() or 1,
        "python": platform.python_version(),
        **{name: _version(name) for name in PACKAGES},
    }


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "-"


def _processor() -> str:
    """Return the name of the processor, if the system provides it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor())


def inline(draw: Callable[[], Any]) -> str:
    """Return the figure that `draw` makes as an SVG element."""
    import matplotlib as mpl

    with mpl.rc_context({**STYLE}):
        text = io.StringIO()
        draw().savefig(text, format="svg", metadata={"Date": None})
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]


def template(name: str) -> str:
    """Return the template of a page or of a part of it, with names in braces to be filled in."""
    return files("kvtheory.plots").joinpath(name).read_text(encoding="utf-8")


def save_page(text: str, path: Path) -> None:
    """Write a page of HTML, or any text."""
    replace_file(path, lambda part: part.write_text(text, encoding="utf-8"))
