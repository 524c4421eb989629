"""Sweeps: a curve, a family of curves, or a map, depending on the dimensions."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import LogNorm
from numpy.typing import NDArray

from kvtheory.plots.style import BLUE, Picture, label, with_unit
from kvtheory.results import QUANTITIES, Stability, SteadyState, Sweep
from kvtheory.scene.mistakes import nearest
from kvtheory.sweeps.plan import Plan

Array = NDArray[np.float64]

MOST_CURVES = 8
"""Largest number of curves in a family; with more, a map is easier to read."""
DECADES = 1.5
"""Range of positive values, in powers of ten, from which an axis or colour scale is logarithmic."""
WORDS = {
    "foundation.retardation_time": r"retardation time $\tau$",
    "foundation.stiffness": r"stiffness of the foundation $K$",
    "indenter.radius": r"radius $R$",
    "foundation.temperature": r"temperature $T$",
    "drive.frequency": "frequency of the drive",
    "support.mass": r"mass $M$",
    "support.gravity": r"gravity $g$",
    "support.stiffness": r"stiffness of the support $k_s$",
    "run.duration": "duration",
    "peak_to_steady_friction": "peak friction / steady friction",
}
"""Labels of swept keys and measures; all other names are shown as they are."""
FIRST = "friction_coefficient"
"""Drawn by default, if the sweep has it."""
VELOCITY = "drive.velocity"


class Side(NamedTuple):
    """A dimension or a quantity as it is drawn."""

    label: str
    values: Array


def plot_sweep(ax: Any, result: Sweep, quantity: str | None = None, **style: Any) -> Any:
    """Draw one quantity of a sweep on `ax`, or on a new figure, and return the axes.

    Along one dimension it is a curve; along two, with at most eight values of one, a family of
    curves; else a map. Dimensions of a single value are left out. `Sweep.plot` documents the errors.
    """
    numeric = [name for name, unit in result.units.items() if unit and name in result.values]
    name = _chosen(numeric, quantity)
    sides, values = [], np.asarray(result.values[name])
    for axis in result.axes:
        key, *others = axis.values
        words, along = _side(key, result.units[key], axis.values[key])
        sides.append(Side(words + (f" (with {', '.join(others)})" if others else ""), along))
    if result.time is not None and values.ndim > len(sides):
        sides.append(_side("time", "s", result.time))
    return _draw(ax, sides, _side(name, result.units[name], values), style)


def plot_over(ax: Any, state: SteadyState | Stability, quantity: str = FIRST, **style: Any) -> Any:
    """Draw a quantity of steady sliding over what varies, as `plot_sweep` does, and return the axes.

    Where several keys vary together, the axis is the velocity if it is one of them, or else the first.

    >>> import kvtheory as kv
    >>> state = kv.steady(over={"foundation.retardation_time": [0.1, 0.2], "drive.velocity": [0.1, 0.3]})
    >>> plot_over(None, state).get_xlabel()
    'drive velocity $V$ [mm/s]'
    """
    values = np.asarray(getattr(state, quantity))
    if not values.size:
        raise ValueError("there are no values to draw: an array of `over` is empty")
    sides = []
    for axis in (axis for axis, size in enumerate(values.shape) if size > 1):
        along = {}
        for key, array in state.over.items():
            rows = np.moveaxis(array, axis, -1).reshape(-1, values.shape[axis])
            if np.all(rows == rows[0]):  # it does not vary along another axis too
                along[key] = rows[0]
        if not along:
            keys = " and ".join(key for key, array in state.over.items() if array.shape[axis] > 1)
            raise ValueError(
                f"the values of {keys} form a table, not a list; draw one row at a time"
            )
        key = max(along, key=lambda key: (np.ptp(along[key]) > 0.0, key == VELOCITY))
        sides.append(_side(key, state.units[key], along[key]))
    return _draw(ax, sides, _side(quantity, state.units[quantity], values), style)


def check_drawable(plan: Plan) -> None:
    """Raise `ValueError` unless `plot_sweep` can draw the result of a sweep."""
    _chosen([column.name for column in plan.numeric])
    drawn = [axis.name for axis in plan.axes if axis.size > 1]
    _refuse_more_than_two([*drawn, *(["time"] * (plan.series and len(plan.times or ()) > 1))])


def _chosen(numeric: Sequence[str], quantity: str | None = None) -> str:
    """Return the quantity to draw: the named one, or else the first that can be drawn."""
    name = quantity or (FIRST if FIRST in numeric else next(iter(numeric), ""))
    if not numeric:
        raise ValueError("no quantity of this sweep is numeric, so nothing can be drawn")
    if name not in numeric:
        raise ValueError(f'`quantity` = "{name}": {nearest(name, numeric)}')
    return name


def _refuse_more_than_two(dimensions: Sequence[str]) -> None:
    if len(dimensions) > 2:
        raise ValueError(
            f"a picture has two dimensions, this sweep has {len(dimensions)} "
            f"({', '.join(dimensions)}): choose a part with to_xarray().sel(...)"
        )


def _side(name: str, unit: str, values: Any) -> Side:
    base = name.rpartition(".")[2]
    if base in QUANTITIES and name not in WORDS:
        words, factor = label(base, unit)
    else:
        words, factor = with_unit(WORDS.get(name, name.replace(".", ": ").replace("_", " ")), unit)
    return Side(words, np.asarray(values, dtype=float) * factor)


def _scale(values: Array) -> str:
    """Return ``"log"`` for finite positive values that extend over decades."""
    finite = values[np.isfinite(values)]
    low, high = finite.min(initial=np.inf), finite.max(initial=0.0)
    return "log" if 0.0 < low * 10.0**DECADES <= high else "linear"


def _draw(ax: Any, sides: Sequence[Side], value: Side, style: Any) -> Any:
    """Draw a curve, a family of curves or a map."""
    sides = [side for side in sides if side.values.size > 1]
    _refuse_more_than_two([side.label for side in sides])
    ax = Picture(5.0, 3.8).subplots() if ax is None else ax
    *beside, x = sides or [Side("point", np.zeros(1))]
    values = value.values.reshape([side.values.size for side in (*beside, x)])
    ax.set(xlabel=x.label)
    if beside and min(values.shape) > MOST_CURVES:
        (y,) = beside
        down, along = np.argsort(y.values), np.argsort(x.values)
        image = ax.pcolormesh(
            x.values[along], y.values[down], np.ma.masked_invalid(values[np.ix_(down, along)]),
            **{"cmap": "cividis", "norm": LogNorm() if _scale(values) == "log" else None,
               "shading": "nearest", "rasterized": True, **style},
        )  # fmt: skip
        ax.set(ylabel=y.label, xscale=_scale(x.values), yscale=_scale(y.values))
        ax.grid(False)
        ax.figure.colorbar(image, ax=ax, label=value.label)
        return ax
    if beside and values.shape[0] >= values.shape[1]:
        beside, x, values = [x], beside[0], values.T  # the shorter side tells the curves apart
    order, rows = np.argsort(x.values), values.reshape(-1, x.values.size)
    names: Any = [f"{v:.4g}" for side in beside for v in side.values] or [None]
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(rows))) if len(rows) > 1 else [BLUE]
    marker = "o" if x.values.size == 1 else ""
    for row, name, shade in zip(rows, names, shades, strict=True):
        look = {"label": name, "color": shade, "marker": marker, **style}
        ax.plot(x.values[order], row[order], **look)
    ax.set(xlabel=x.label, ylabel=value.label, xscale=_scale(x.values), yscale=_scale(values))
    if beside:
        ax.legend(title=beside[0].label)
    return ax
