"""The error of the parabola for a true circle of the same radius, at the same depth or load.

Circle over parabola is 1 + c (a/R)^2 + O((a/R)^4) with coefficients c that depend on l_r/a alone;
the points come from quadrature of the circle itself.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, GREEN, RED
from kvtheory.theory import closed_forms as cf

SLOPES = np.geomspace(0.01, 0.8, 12)
"""a/R, the slope of the parabola at the edge of the stationary contact."""
RATIO = 1.0
"""l_r/a in the left panel."""
RATIOS = np.geomspace(1e-3, 1e3, 121)


@dataclass(frozen=True)
class Quantity:
    """A quantity, what is held the same, and the coefficient of the leading term."""

    name: str
    held: str
    label: str
    coefficient: Callable[[Any], Any]
    style: dict[str, Any]


QUANTITIES = (
    Quantity("load", "depth", "$W$, same depth", cf.circle_load, {"color": BLACK, "linestyle": ":"}),
    Quantity(
        "friction_force", "depth", "$F$, same depth",
        cf.circle_friction_force, {"color": BLUE, "linestyle": "--"},
    ),
    Quantity(
        "friction_coefficient", "depth", r"$\mu$, same depth",
        cf.circle_friction_coefficient, {"color": RED, "linestyle": "-."},
    ),
    Quantity(
        "friction_coefficient", "load", r"$\mu$, same load",
        cf.circle_friction_coefficient_at_load, {"color": GREEN, "linestyle": "-"},
    ),
)  # fmt: skip


@dataclass(frozen=True)
class Data:
    """Circle/parabola - 1 by quantity, measured and to leading order."""

    measured: list[np.ndarray]
    leading: list[np.ndarray]
    coefficients: list[np.ndarray]
    columns: drawing.Columns


def compute() -> Data:
    """Integrate circle and parabola at the same depth or the same load."""
    q = cf.trailing_edge_ratio(RATIO)
    measured = [_measured(quantity) for quantity in QUANTITIES]
    leading = [quantity.coefficient(q) * SLOPES**2 for quantity in QUANTITIES]
    coefficients = [quantity.coefficient(cf.trailing_edge_ratio(RATIOS)) for quantity in QUANTITIES]
    columns: dict[str, Any] = {f"a/R at l_r/a = {RATIO:g} [1]": SLOPES}
    for quantity, difference, term in zip(QUANTITIES, measured, leading, strict=True):
        name = f"{quantity.name}, same {quantity.held}"
        columns[f"{name}: circle/parabola - 1 [1]"] = difference
        columns[f"{name}: leading term [1]"] = term
    return Data(measured, leading, coefficients, columns)


def draw(data: Data) -> Figure:
    """Draw the difference over a/R, and the coefficients over l_r/a."""
    drawn = drawing.figure(7.2, 3.4)
    left, right = drawn.subplots(1, 2)
    rows = zip(QUANTITIES, data.measured, data.leading, data.coefficients, strict=True)
    for quantity, difference, term, coefficient in rows:
        left.loglog(SLOPES, np.abs(term), **quantity.style)
        left.loglog(
            SLOPES,
            np.abs(difference),
            "o",
            color=quantity.style["color"],
            fillstyle="none",
            markersize=4,
        )
        right.semilogx(RATIOS, coefficient, label=quantity.label, **quantity.style)
    left.plot([], [], color=BLACK, label="leading term")
    left.plot([], [], "ko", fillstyle="none", markersize=4, label="quadrature")
    left.set(
        title=rf"difference at $l_\mathrm{{r}} = {'' if RATIO == 1 else RATIO}a$",
        xlabel="$a/R$", ylabel="| circle/parabola − 1 |",
    )  # fmt: skip
    left.legend(loc="upper left")
    right.set(
        title="coefficient of $(a/R)^2$",
        xlabel=r"$l_\mathrm{r}/a = V\tau/a$",
        xlim=(RATIOS[0], RATIOS[-1]),
    )
    right.axhline(0.0, color=BLACK, linewidth=0.8)
    right.legend(loc="center right")
    return drawn


def _measured(quantity: Quantity) -> np.ndarray:
    """Return circle/parabola - 1 for scenes with R = K = tau = 1 and every a/R of `SLOPES`."""
    over: dict[str, Any] = {
        "indenter.radius": 1.0,
        "foundation.stiffness": 1.0,
        "foundation.retardation_time": 1.0,
        "drive.velocity": RATIO * SLOPES,
    }
    depth = SLOPES**2 / 2
    if quantity.held == "depth":
        support = "fixed"
        over["support.depth"] = depth
    else:
        support = "dead-weight"
        weight = kv.steady(kv.Scene.table1("fixed"), over={**over, "support.depth": depth}).load
        over |= {"support.mass": weight, "support.gravity": 1.0}
    scene = kv.Scene.table1(support)
    circle = kv.Scene(kv.Circle(radius=1.0), scene.foundation, scene.support)
    parabola_value, circle_value = (
        getattr(kv.steady(each, over=over), quantity.name) for each in (scene, circle)
    )
    return np.asarray(circle_value / parabola_value - 1)


if __name__ == "__main__":
    drawing.run("circle_error", compute, draw)
