"""Output files: pictures by suffix, charts with their data beside them, self-contained HTML pages."""

import io
import json
import os
import platform
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib import metadata
from importlib.resources import files
from pathlib import Path
from typing import Any

import matplotlib as mpl

from kvtheory.export import PICTURES, check_path, replace_file, replace_files
from kvtheory.plots.style import STYLE

PACKAGES = "kvtheory", "numpy", "scipy", "numba", "scikit-sundae"
"""The packages whose versions are recorded with a chart."""


def save_picture(draw: Callable[[], Any], path: Path) -> None:
    """Draw a figure in the style of the package and write it in the format of the suffix, or raise."""
    check_path(path, PICTURES)
    with mpl.rc_context({**STYLE}):
        replace_file(path, draw().savefig)


def save_chart(draw: Callable[[], Any], data: Mapping[str, Any], path: Path) -> None:
    """Draw and write a picture, and its data as JSON beside it, with machine and versions."""
    text = json.dumps({"environment": environment(), **data}, indent=1, allow_nan=False)
    replace_files({
        path: lambda part: save_picture(draw, part),
        path.with_suffix(".json"): lambda part: save_page(text + "\n", part),
    })  # fmt: skip


def environment() -> dict[str, str | int]:
    """Return machine, processors, and versions; a package that is not installed is ``"-"``.

    >>> sorted(environment())[:3]
    ['kvtheory', 'machine', 'numba']
    """
    versions, processor = dict.fromkeys(PACKAGES, "-"), platform.processor()
    for name in PACKAGES:
        with suppress(metadata.PackageNotFoundError):
            versions[name] = metadata.version(name)
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
        processor = next(names, processor)
    return {
        "machine": platform.machine(),
        "system": platform.system(),
        "processor": processor,
        "processors": os.cpu_count() or 1,
        "python": platform.python_version(),
        **versions,
    }


def inline(draw: Callable[[], Any]) -> str:
    """Return the figure that `draw` makes as an SVG element."""
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
