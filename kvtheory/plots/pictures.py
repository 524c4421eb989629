"""What every picture has in common: colours, sizes, labels, and the files that are written."""

import io
import json
import os
import platform
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib import metadata
from importlib.resources import files
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kvtheory.export import PICTURES, check_path, replace_file, replace_files
from kvtheory.results import QUANTITIES, SHOWN_UNITS

BLACK, BLUE, RED, GREEN, PURPLE = "#000000", "#0072b2", "#d55e00", "#009e73", "#aa4499"
"""Colours that colour-blind readers can distinguish (after Okabe and Ito); lines differ in dashes too."""

STYLE: Any = {
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 10,
    "font.size": 9,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "mathtext.fontset": "dejavusans",
    "savefig.dpi": 200,
    "svg.fonttype": "path",
    "svg.hashsalt": "kvtheory",
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
}
"""For `matplotlib.rc_context`."""

TRANSIENT_ROWS = (
    ("velocity", r"$V$", 1.0),
    ("depth", r"$z_\mathrm{A}$", -1.0),
    ("normal_force", r"$F_z$", 1.0),
    ("friction_force", r"$F_x$", 1.0),
)
"""The rows of Fig. 3 of the paper: quantity, symbol, sign."""


class Picture(Figure):
    """A figure without a window, which a notebook displays whether or not pyplot was imported."""

    def __init__(self, width: float, height: float) -> None:
        super().__init__(figsize=(width, height), layout="constrained")
        FigureCanvasAgg(self)

    def _repr_png_(self) -> bytes:
        drawn = io.BytesIO()
        self.savefig(drawn, format="png", dpi=100)
        return drawn.getvalue()


def with_unit(words: str, unit: str) -> tuple[str, float]:
    """Return an axis label with the customary unit, and the factor to it from the SI unit.

    >>> with_unit("stiffness $K$", "N/m^3")
    ('stiffness $K$ [N/mm$^3$]', 1e-09)
    """
    shown, factor = SHOWN_UNITS.get(unit, (unit, 1.0))
    powers = re.sub(r"\^([0-9])", r"$^\1$", shown)
    return words + (f" [{powers}]" if shown else ""), factor


def label(name: str, unit: str) -> tuple[str, float]:
    """Return the axis label of a quantity of a result, and the factor from its SI unit.

    >>> label("load", "N")
    ('load $W$ [N]', 1.0)
    """
    row = QUANTITIES[name]
    return with_unit(f"{row.words} ${row.symbol}$" if row.symbol else row.words, unit)


LABELS = {row.name: label(row.name, row.unit) for row in QUANTITIES.values()}
"""Axis label of each quantity of a line contact, in the paper's units, and the factor from SI."""


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
