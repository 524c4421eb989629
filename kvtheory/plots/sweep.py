"""Sweeps: a curve, a family of curves, or a map, depending on the dimensions."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.plots.style import BLUE, label, with_unit
from kvtheory.results import QUANTITIES, SteadyState, Sweep
from kvtheory.scene.quantities import nearest
from kvtheory.sweeps.plan import Plan

Array = NDArray[np.float64]

MOST_CURVES = 8
"""Values of the second dimension up to which curves are drawn; beyond, a map is easier to read."""
DECADES = 1.5
"""Range of positive values, in powers of ten, from which an axis or colour scale is logarithmic."""


class Side(NamedTuple):
    """A dimension or a quantity as it is drawn."""

    label: str
    values: Array


WORDS = {
    "foundation.retardation_time": r"retardation time $\tau$",
    "foundation.stiffness": r"stiffness of the foundation $K$",
    "indenter.radius": r"radius $R$",
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


def plot_sweep(ax: Any, result: Sweep, quantity: str | None = None, **style: Any) -> Any:
    """Draw one quantity of a sweep on `ax`, or on a new figure, and return the axes.

    Along one dimension it is a curve; along two, with at most eight values of one, a family of
    curves; else a map. Dimensions of a single value are left out. `Sweep.plot` documents the errors.
    """
    numeric = [name for name, unit in result.units.items() if unit and name in result.values]
    name = _chosen(numeric, quantity)
    sides, values = _drawn(result, name)
    return _picture(ax, sides, _side(name, result.units[name], values), style)


def plot_over(ax: Any, state: SteadyState, quantity: str = FIRST, **style: Any) -> Any:
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
        along = {
            key: rows for key, array in state.over.items() if (rows := _along(array, axis)).size
        }
        if not along:
            raise ValueError(
                "two keys vary along the same two dimensions: draw one dimension at a time"
            )
        key = max(along, key=lambda key: (np.ptp(along[key]) > 0.0, key == VELOCITY))
        sides.append(_side(key, state.units[key], along[key]))
    value = _side(quantity, state.units[quantity], values.reshape([s.values.size for s in sides]))
    return _picture(ax, sides, value, style)


def _along(values: Array, axis: int) -> Array:
    """Return the values along an axis, or none if they vary along another one too."""
    rows = np.moveaxis(values, axis, -1).reshape(-1, values.shape[axis])
    return rows[0] if np.all(rows == rows[0]) else np.empty(0)


def _picture(ax: Any, sides: list[Side], value: Side, style: Any) -> Any:
    """Draw a curve, a family of curves or a map."""
    _refuse_more_than_two([side.label for side in sides])
    if ax is None:
        from kvtheory.plots.canvas import Picture

        ax = Picture(5.0, 3.8).subplots()
    if len(sides) == 2 and min(side.values.size for side in sides) > MOST_CURVES:
        _map(ax, sides, value, style)
    else:
        _curves(ax, sides, value, style)
    return ax


def check_drawable(plan: Plan) -> None:
    """Raise `ValueError` unless `plot_sweep` can draw the result of a sweep."""
    _chosen([column.name for column in plan.numeric])
    drawn = [axis.name for axis in plan.axes if axis.size > 1]
    _refuse_more_than_two([*drawn, *(["time"] * (plan.series and len(plan.times or ()) > 1))])


def _chosen(numeric: Sequence[str], quantity: str | None = None) -> str:
    """Return the quantity to draw: the named one, or else the first that can be drawn."""
    name = quantity or (FIRST if FIRST in numeric else next(iter(numeric), ""))
    if not numeric:
        raise ValueError("no quantity of this sweep is a number, so that nothing can be drawn")
    if name not in numeric:
        raise ValueError(f'`quantity` = "{name}": {nearest(name, numeric)}')
    return name


def _refuse_more_than_two(dimensions: Sequence[str]) -> None:
    if len(dimensions) > 2:
        raise ValueError(
            f"a picture has two dimensions, this sweep has {len(dimensions)} "
            f"({', '.join(dimensions)}): choose a part with to_xarray().sel(...)"
        )


def _drawn(result: Sweep, name: str) -> tuple[list[Side], Array]:
    """Return the dimensions with more than one value, and the values over them."""
    values = np.asarray(result.values[name])
    sides = []
    for axis in result.axes:
        key, array = next(iter(axis.values.items()))
        side = _side(key, result.units[key], array)
        together = ", ".join(other for other in axis.values if other != key)
        sides.append(Side(f"{side.label} (with {together})", side.values) if together else side)
    if result.time is not None and values.ndim > len(sides):
        sides.append(_side("time", "s", result.time))
    kept = [side for side in sides if side.values.size > 1]
    return kept, values.reshape([side.values.size for side in kept])


def _side(name: str, unit: str, values: Array) -> Side:
    base = name.rpartition(".")[2]
    if base in QUANTITIES:
        words, factor = label(base, unit)
    else:
        words, factor = with_unit(WORDS.get(name, name.replace(".", ": ").replace("_", " ")), unit)
    return Side(words, np.asarray(values, dtype=float) * factor)


def _scale(values: Array) -> str:
    """Return ``"log"`` for finite positive values that extend over decades."""
    finite = values[np.isfinite(values)]
    low, high = finite.min(initial=np.inf), finite.max(initial=0.0)
    return "log" if 0.0 < low * 10.0**DECADES <= high else "linear"


def _map(ax: Any, sides: Sequence[Side], value: Side, style: Any) -> None:
    from matplotlib.colors import LogNorm

    y, x = sides
    norm = LogNorm() if _scale(value.values) == "log" else None
    settings = {"cmap": "cividis", "norm": norm, "shading": "nearest", "rasterized": True, **style}
    down, along = np.argsort(y.values), np.argsort(x.values)
    shown = np.ma.masked_invalid(value.values[np.ix_(down, along)])
    image = ax.pcolormesh(x.values[along], y.values[down], shown, **settings)
    ax.set(xlabel=x.label, ylabel=y.label, xscale=_scale(x.values), yscale=_scale(y.values))
    ax.grid(False)
    ax.figure.colorbar(image, ax=ax, label=value.label)


def _curves(ax: Any, sides: Sequence[Side], value: Side, style: Any) -> None:
    from matplotlib import colormaps

    sides = list(sides) or [Side("point", np.zeros(1))]
    values = value.values
    if len(sides) == 2 and sides[0].values.size >= sides[1].values.size:
        sides, values = sides[::-1], values.T  # the shorter side tells the curves apart
    x = sides[-1]
    order = np.argsort(x.values)
    marker = "o" if x.values.size == 1 else ""
    rows = values.reshape(-1, x.values.size)
    names = [None] if len(sides) == 1 else [f"{v:.4g}" for v in sides[0].values]
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(rows)))
    for row, name, shade in zip(rows, names, shades if len(rows) > 1 else [BLUE], strict=True):
        look = {"label": name, "color": shade, "marker": marker, **style}
        ax.plot(x.values[order], row[order], **look)
    ax.set(xlabel=x.label, ylabel=value.label, xscale=_scale(x.values), yscale=_scale(values))
    if len(sides) == 2:
        ax.legend(title=sides[0].label)
