"""Pictures of results: those of the paper, and those drawn by `plot` of a result."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import simpson

from kvtheory.models.steady.ball import angle_and_tail
from kvtheory.plots.comparison import draw_comparison
from kvtheory.plots.files import save_picture
from kvtheory.plots.fits import draw_fit
from kvtheory.plots.style import BLUE, LABELS, RED, TRANSIENT_ROWS, Picture, label, with_unit
from kvtheory.plots.sweep import plot_over, plot_sweep
from kvtheory.results import (
    QUANTITIES,
    AsymptoteReport,
    Comparison,
    FoundationFit,
    FrictionFit,
    Stability,
    SteadyState,
    Sweep,
    Transient,
)
from kvtheory.results.transient import TimeSeries
from kvtheory.theory.closed_forms import ball_friction_coefficient_factor

SERIES, STEADY = (5.0, 6.4), (5.0, 3.4)
"""Sizes of the pictures, in inches."""
POINTS = 201
"""Points of the pressure over the contact."""
SMOOTH, JUST_BEFORE = 401, 1e-12
"""Times at which a transient is drawn, beside its own, and the share of a time that is just before it."""
CONSTANT = 1e-6
"""Relative range of a series that is drawn as a constant one."""
BESIDE = {"velocity": "sliding_velocity", "friction_force": "spring_force"}
"""Quantity that is drawn together with another one if the drive has a spring."""
WHOLE: dict[Any, Any] = {Comparison: draw_comparison, FoundationFit | FrictionFit: draw_fit}
"""Results that are drawn as a whole figure of their own."""
MISMATCH = 1e-6
"""Relative difference of the integral of the pressure from the load beyond which the indenter is not a
parabola, and of the friction coefficient from its closed form beyond which it is not a ball."""


def plot_steady(
    ax: Any, velocity: ArrayLike, state: SteadyState, quantity: str, **style: Any
) -> list[Any]:
    """Draw a quantity of steady sliding over the drive velocity (m/s), on logarithmic axes.

    >>> import kvtheory as kv
    >>> from matplotlib.figure import Figure
    >>> V = [0.01, 0.1, 1.0]
    >>> (line,) = plot_steady(Figure().subplots(), V, kv.steady(over={"drive.velocity": V}), "depth")
    >>> line.get_ydata().round(4).tolist()
    [0.2814, 0.0897, 0.0098]
    """
    x_label, x_factor = LABELS["velocity"]
    y_label, y_factor = label(quantity, state.units[quantity])
    x, y = np.asarray(velocity) * x_factor, np.asarray(getattr(state, quantity)) * y_factor
    ax.set(xlabel=x_label, ylabel=y_label, xscale="log", yscale="log")
    artists: list[Any] = ax.plot(x, y, **style)
    return artists


def plot_asymptote_errors(ax: Any, report: AsymptoteReport, styles: Mapping[str, Any]) -> list[Any]:
    """Draw |asymptote/exact - 1| over V/V* for each line of the report that `styles` names."""
    ratio = np.abs(report.velocity) / report.critical_velocity
    artists = []
    for line in report.lines:
        if line.name in styles:
            artists += ax.plot(ratio, np.abs(line.relative_error), **styles[line.name])
    ax.set(xlabel=r"$V/V^*$", ylabel="relative error of the asymptote", xscale="log", yscale="log")
    return artists


def plot_transient(axes: Sequence[Any], result: TimeSeries, **style: Any) -> list[Any]:
    """Draw velocity, position, normal and friction force over time on four axes, as in Fig. 3.

    The state of rest before t = 0 is drawn too, for a twentieth of the time shown: V and F_x are zero there.
    With a spring in the drive, the sliding velocity and the spring force are also drawn. Without markers
    the curves of a transient are those of its solution, between its times too.
    """
    smooth = hasattr(getattr(result, "solution", None), "series") and "marker" not in style
    series = _between(result) if smooth else {n: getattr(result, n) for n in result.units}
    time = np.asarray(series["time"]) * 1e3
    before = np.array([-0.05 * time[-1], 0.0])
    rest = {"velocity": 0.0, "friction_force": 0.0, "depth": result.depth[0]}
    rest["normal_force"] = result.solution.units.load if isinstance(result, Transient) else math.nan
    artists = []
    for ax, (name, symbol, sign) in zip(axes, _rows(result), strict=True):
        words, factor = with_unit(symbol, result.units[name])
        values = np.concatenate([[rest[name]] * 2, series[name]]) * (sign * factor)
        artists += ax.plot(np.concatenate([before, time]), values, **style)
        low, high = np.nanmin(values), np.nanmax(values)
        if high - low < CONSTANT * max(abs(low), abs(high)):  # else the axis would show rounding
            ax.update_datalim([(0.0, 0.95 * low), (0.0, 1.05 * low)])
            ax.autoscale_view()
        ax.set(ylabel=words)
        if _there(result, BESIDE.get(name, "")):
            beside = np.asarray(series[BESIDE[name]]) * (sign * factor)
            artists += ax.plot(
                time, beside, color=RED, linewidth=0.8, label=QUANTITIES[BESIDE[name]].words
            )
            ax.legend(loc="lower right", bbox_to_anchor=(1.0, 0.95))  # above the curves
    axes[-1].set(xlabel=r"time $t$ [ms]")
    return artists


def _between(result: Any) -> Mapping[str, Any]:
    """Return the series of a transient, also between its times and just before each jump of the drive."""
    t, solution = result.time, result.solution
    jumps = np.array(solution.drive.changes) * solution.units.time * (1.0 - JUST_BEFORE)
    jumps = jumps[(jumps > t[0]) & (jumps < t[-1])]
    times = np.unique(np.concatenate([t, jumps, np.linspace(t[0], t[-1], SMOOTH)]))
    found: Mapping[str, Any] = solution.series(times)
    return found


def _there(result: TimeSeries, name: str) -> bool:
    """Whether a result has values of a quantity: `solve` may have been asked for another one."""
    return bool(np.isfinite(getattr(result, name, np.nan)).any())


def _rows(result: TimeSeries) -> list[tuple[str, str, float]]:
    """Return the rows of Fig. 3 in which there is anything to draw."""
    return [
        (name, symbol, sign)
        for name, symbol, sign in TRANSIENT_ROWS
        if _there(result, name) or _there(result, BESIDE.get(name, ""))
    ]


def plot_pressure(ax: Any, result: Transient, positions: ArrayLike, times: ArrayLike) -> Any:
    """Shade the contact pressure over position (m) and time (s), with both edges, as in Fig. 4."""
    x, t = np.asarray(positions), np.asarray(times)
    p = np.array([result.pressure(x, float(time)) for time in t])
    settings: Any = {"cmap": "Reds", "shading": "gouraud", "rasterized": True}
    image = ax.pcolormesh(x * 1e3, t * 1e3, p / 1e6, **settings)
    time = np.asarray(result.time) * 1e3
    for edge, dashes in (("leading", "-"), ("trailing", "--")):
        x_edge = np.asarray(getattr(result, f"{edge}_edge")) * 1e3
        ax.plot(x_edge, time, color=BLUE, linestyle=dashes, label=f"{edge} edge")
    ax.set(xlabel=r"position $x$ [mm]", ylabel=r"time $t$ [ms]")
    return image


def plot_result(result: Any, axes: Any = None, **style: Any) -> Any:
    """Draw a time series, steady sliding, a comparison or a sweep, and return the figure."""
    for kinds, draw in WHOLE.items():
        if isinstance(result, kinds):
            return draw(result)
    if isinstance(result, Stability):
        return plot_stability(axes, result, **style)
    if isinstance(result, Sweep):
        return plot_sweep(axes, result, **style).figure
    if hasattr(result, "time"):
        if axes is None:
            picture = Picture(*SERIES)
            axes = picture.subplots(len(_rows(result)), 1, sharex=True, squeeze=False)[:, 0]
            picture.align_ylabels(axes)
        return plot_transient(axes, result, **{"color": BLUE, **style})[0].figure
    if np.ndim(result.depth):
        return plot_over(axes, result, **style).figure
    axes = Picture(*STEADY).subplots() if axes is None else axes
    return _plot_contact_pressure(axes, result, {"color": BLUE, **style})


def plot_stability(axes: Any, result: Stability, **style: Any) -> Any:
    """Draw the fastest growth and its frequency over what varies, or the rates of one scene."""
    motions = result.motions
    if np.isnan(motions).all():
        raise ValueError("there are no rates to draw: nothing can move, or they were not requested")
    if motions.ndim > 2:
        axes = Picture(*SERIES).subplots(2, 1) if axes is None else axes
        for ax, name in zip(axes, ("growth_rate", "growth_frequency"), strict=True):
            plot_over(ax, result, name, **style)
        axes[0].axhline(0.0, color=RED, linestyle="--", linewidth=0.8)
        return axes[0].figure
    ax = Picture(*STEADY).subplots() if axes is None else axes
    growth, frequency = motions.T
    for sign in (1.0, -1.0):
        ax.plot(
            growth, sign * frequency, **{"color": BLUE, "marker": "x", "linestyle": "", **style}
        )
    ax.axvline(0.0, color=RED, linestyle="--", linewidth=0.8)
    ax.set_xscale("symlog", linthresh=np.abs(growth[growth != 0.0]).min(initial=math.inf))
    ax.set(xlabel="growth rate [1/s], stable below 0", ylabel="frequency [Hz]")
    return ax.figure


def _plot_contact_pressure(ax: Any, state: SteadyState, style: dict[str, Any]) -> Any:
    """Draw p = K delta (1 - x^2/a^2 - 2 l_r x/a^2) from edge to edge (Eqs. 8 and 12, for V >= 0).

    For a ball it is the pressure in the middle plane. On a layer it is that of the cells.
    """
    sphere = state.units["load"] == "N"
    if state.pressure_field is not None:
        field = state.pressure_field
        return _draw_pressure(ax, field.x, field.pressure[:, field.y.size // 2], sphere, style)
    a, l = float(state.half_length), float(state.retardation_length / state.half_length)
    low, high = sorted((float(state.leading_edge), float(state.trailing_edge)))
    x = np.linspace(low, high, POINTS)
    forward = -1.0 if state.leading_edge > 0.0 else 1.0
    peak = 1.0 + l * l if l < 1.0 else 2.0 * l  # theorem F7
    p = state.peak_pressure / peak * (1.0 - (x / a) ** 2 - 2.0 * l * forward * x / a)
    if not sphere:
        off = abs(simpson(p, x) / state.load - 1.0)
    elif l == 0.0:  # there is no friction, and only a ball is exact
        off = 0.0 if state.model == "exact" else math.inf
    else:  # the friction coefficient of a ball is (a/R) m(l) (derivation F20)
        _, tail = angle_and_tail(np.array([l]))
        m = ball_friction_coefficient_factor(np.array([l]), tail)[0]
        off = abs(abs(state.friction_coefficient) / (2.0 * state.depth / a * m) - 1.0)
    if off > MISMATCH:
        raise ValueError(
            "the pressure is drawn for a parabola and for a ball on independent Kelvin-Voigt elements only; "
            'give several velocities, such as drive.velocity = "1 mm/s:1 m/s:50:log", for a curve of friction'
        )
    return _draw_pressure(ax, x, p, sphere, style)


def _draw_pressure(ax: Any, x: Any, p: Any, sphere: bool, style: dict[str, Any]) -> Any:
    """Draw the pressure (Pa) over the position (m), of a ball in its middle plane."""
    ax.plot(x * 1e3, p * 1e-6, **style)
    place = "pressure in the middle plane" if sphere else "pressure"
    ax.set(xlabel=r"position $x$ [mm]", ylabel=rf"{place} $p$ [MPa]")
    return ax.figure


def save_plot(result: Any, path: Path) -> None:
    """Draw a result and write it in the format given by the suffix of `path`, or raise with the reason."""
    save_picture(lambda: plot_result(result), path)
