"""Colours, sizes, axis labels and figures of every picture."""

import io
import re
from typing import Any

from cycler import cycler
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kvtheory.results import QUANTITIES, SHOWN_UNITS

BLACK, BLUE, RED, GREEN, PURPLE = "#000000", "#0072b2", "#d55e00", "#009e73", "#aa4499"
"""Colours that colour-blind readers can distinguish (after Okabe and Ito); lines differ in dashes too."""

STYLE: Any = {
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.prop_cycle": cycler(color=(BLUE, RED, BLACK, GREEN, PURPLE)),
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
