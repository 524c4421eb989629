"""Colours, sizes and axis labels of every picture."""

from typing import Any

BLACK, BLUE, RED, GREEN, PURPLE = "#000000", "#0072b2", "#d55e00", "#009e73", "#aa4499"
"""Colours that stay apart in colour blindness (after Okabe and Ito); lines differ in dashes too."""

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

LABELS = {
    "velocity": (r"drive velocity $V$ [mm/s]", 1e3),
    "depth": (r"depth $\delta$ [mm]", 1e3),
    "load": (r"load $W$ [N/mm]", 1e-3),
    "friction_force": (r"friction force $F$ [N/mm]", 1e-3),
    "friction_coefficient": (r"friction coefficient $\mu$", 1.0),
}
"""Axis label of a quantity, in the paper's units, and the factor from SI."""
