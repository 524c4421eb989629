"""Fits to measurements: the foundation from moduli."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib import colormaps

from kvtheory.plots import style
from kvtheory.plots.style import BLACK, BLUE, LABELS, RED, Picture
from kvtheory.results import SHOWN_UNITS
from kvtheory.results.fits import FoundationFit, FrictionFit
from kvtheory.results.presented import with_unit
from kvtheory.scene.units import ZERO_CELSIUS, celsius

WIDTH, HEIGHT = 7.2, 2.6
"""Of a picture with two panels in a row, and of each row, in inches."""
MARKS = ("o", "s")
COLOURS = BLUE, RED
MOST_NAMED = 8
"""Most curves that a legend names."""
CURVE = 400
"""Points of a smooth curve."""


def draw_fit(fit: FoundationFit | FrictionFit) -> Picture:
    """Return the picture of a fit."""
    return draw_foundation_fit(fit) if isinstance(fit, FoundationFit) else draw_friction_fit(fit)


def draw_foundation_fit(fit: FoundationFit) -> Picture:
    """Return the picture: sweeps as measured and shifted, shift factors, data and fit, residuals, arms."""
    panels: list[Callable[[Any, FoundationFit], None]] = [_curves, _residuals, _arms]
    if len(fit.data["sweeps"]) > 1:
        panels = [_sweeps, *panels]
    if fit.data["shifted"] is not None:
        panels.append(_shifts)
    rows = math.ceil(len(panels) / 2)
    figure = Picture(WIDTH, HEIGHT * rows)
    axes = figure.subplots(rows, 2, squeeze=False).ravel()
    for ax, panel in zip(axes, panels, strict=False):
        panel(ax, fit)
    for ax in axes[len(panels) :]:
        ax.set_axis_off()
    return figure


def _axis(fit: FoundationFit) -> tuple[str, float, list[str], str, float]:
    """Return label and factor of the abscissa, names of the rows, and unit and factor of moduli."""
    unit, factor = (
        ("MPa", 1e-6) if fit.stiffness is None or fit.modulus is not None else ("N/mm$^3$", 1e-9)
    )
    if len(fit.data["measured"]) == 2:
        return "frequency [Hz]", 0.5 / math.pi, ["storage", "loss"], unit, factor
    return "time [s]", 1.0, ["relaxation"], unit, factor


def _sweeps(ax: Any, fit: FoundationFit) -> None:
    label, x_factor, names, unit, factor = _axis(fit)
    sweeps = fit.data["sweeps"]
    colours = colormaps["plasma"](np.linspace(0.0, 0.85, len(sweeps)))
    for sweep, colour in zip(sweeps, colours, strict=True):
        for row, mark in zip(sweep.moduli.values, MARKS, strict=False):
            y = row * factor * fit.data["factor"]
            ax.loglog(sweep.moduli.x * x_factor, y, mark, color=colour, markersize=2.5)
    for name, mark in zip(names, MARKS, strict=False):
        ax.plot([], [], mark, color=BLACK, markersize=2.5, label=name)
    ax.legend()
    low, high = (celsius(sweeps[i].temperature) for i in (0, -1))
    title = f"measured at {low} to {high} °C (light)"
    ax.set(xlabel=label, ylabel=f"{' and '.join(names)} modulus [{unit}]", title=title)


def _curves(ax: Any, fit: FoundationFit) -> None:
    label, x_factor, names, unit, factor = _axis(fit)
    x, order = fit.data["x"] * x_factor, np.argsort(fit.data["x"])
    for name, measured, fitted, colour, mark in zip(
        names, fit.data["measured"], fit.data["fitted"], COLOURS, MARKS, strict=False
    ):
        ax.loglog(x, measured * factor, mark, color=colour, markersize=2.5, alpha=0.5, label=name)
        ax.loglog(x[order], fitted[order] * factor, color=BLACK, linewidth=1.0)
    ax.plot([], [], color=BLACK, linewidth=1.0, label=f"{len(fit.arms)} arms")
    master = fit.data["shifted"]
    title = "data and fit"
    if master is not None:
        title = f"master curve at {celsius(master.reference)} °C"
    ax.legend()
    ax.set(xlabel=label, ylabel=f"modulus [{unit}]", title=title)


def _residuals(ax: Any, fit: FoundationFit) -> None:
    label, x_factor, names, _, _ = _axis(fit)
    for name, row, colour, mark in zip(names, fit.data["residuals"], COLOURS, MARKS, strict=False):
        x = fit.data["x"] * x_factor
        ax.semilogx(x, 100.0 * row, mark, color=colour, markersize=2.5, alpha=0.6, label=name)
    for side in (-1.0, 1.0):
        ax.axhline(100.0 * side * fit.misfit, color=BLACK, linestyle=":", linewidth=0.8)
    ax.set(xlabel=label, ylabel="fit minus data [%]", title=f"residuals, RMS {fit.misfit:.2%}")


def _arms(ax: Any, fit: FoundationFit) -> None:
    _, _, _, unit, factor = _axis(fit)
    E, tau = np.array(fit.arms).T
    ax.vlines(tau, 0.5 * E.min() * factor, E * factor, color=BLUE)
    ax.plot(tau, E * factor, "o", color=BLUE, markersize=4)
    relaxed = fit.modulus if fit.modulus is not None else fit.stiffness
    ax.axhline(
        (relaxed or 0.0) * factor, color=BLACK, linestyle="--", linewidth=0.9, label="relaxed"
    )
    ax.set(
        xscale="log",
        yscale="log",
        xlabel="relaxation time [s]",
        ylabel=f"arms [{unit}]",
        title="arms",
    )
    ax.legend()


def _shifts(ax: Any, fit: FoundationFit) -> None:
    master, law = fit.data["shifted"], fit.data["law"]
    T = master.temperatures - ZERO_CELSIUS
    ax.errorbar(
        T, master.log_shift, yerr=master.errors, fmt="o", color=BLUE, markersize=3, capsize=2
    )
    if law is not None:
        curve = np.linspace(T.min(), T.max(), CURVE)
        ax.plot(
            curve,
            law.log_shift(curve + ZERO_CELSIUS, master.reference),
            color=BLACK,
            label=law.text.replace(", ", ",\n"),
        )
        ax.legend(fontsize="small")
    ax.set(xlabel="temperature [°C]", ylabel=r"$\log_{10} a_T$", title="shift factors")


def draw_friction_fit(fit: FrictionFit) -> Picture:
    """Return the picture: measured and fitted values over velocity or time, and the residuals."""
    rows = [
        (data, name, fitted[name], 100.0 * residuals[name])
        for data, fitted, residuals in zip(
            *(fit.data[each] for each in ("sets", "fitted", "residuals")), strict=True
        )
        for name in data.measured
    ]
    figure = Picture(WIDTH, (HEIGHT + 0.4) * len(rows))
    axes = figure.subplots(len(rows), 2, squeeze=False)
    for (over, rest), (data, name, fitted, off) in zip(axes, rows, strict=True):
        if data.time is None:
            _over_velocity(fit, data, name, off, over, rest)
        else:
            _over_time(fit, data, name, fitted, off, over, rest)
        rest.axhline(0.0, color=BLACK, linewidth=0.8)
        rest.set_title(f"residuals, RMS {math.sqrt(float((off * off).mean())):.3g} %")
    axes[0, 0].set_title(f"data and fit of {fit.model}")
    return figure


def _over_velocity(fit: FrictionFit, data: Any, name: str, off: Any, over: Any, rest: Any) -> None:
    """Draw rows with equal conditions but the velocity as a curve."""
    V = np.abs(data.conditions["drive.velocity"])
    others = {key: values for key, values in data.conditions.items() if key != "drive.velocity"}
    rows = np.array([0.0 * V, *others.values()]).T
    sets, group = np.unique(rows, axis=0, return_inverse=True)
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, len(sets)))
    label, factor = style.label(name, fit.data["units"][name])
    x_label, x_factor = LABELS["velocity"]
    for i, (values, colour) in enumerate(zip(sets, colours, strict=True)):
        own = np.ravel(group) == i
        words = ", ".join(
            _condition(fit, key, value) for key, value in zip(others, values[1:], strict=True)
        )
        over.plot(
            V[own] * x_factor, np.abs(data.measured[name][own]) * factor, "o", color=colour,
            markersize=3, label=words if len(sets) <= MOST_NAMED else None,
        )  # fmt: skip
        if (V[own] > 0.0).any():
            curve = np.geomspace(V[own & (V > 0.0)].min(), V[own].max(), CURVE)
            where = {**dict(zip(others, values[1:], strict=True)), "drive.velocity": curve}
            state = fit.data["solve"](fit.scene.replace(where))
            line = np.broadcast_to(getattr(state, name), curve.shape)
            if "offset" in fit.parameters and name.startswith("friction"):
                line = line + fit.parameters["offset"].value * (
                    state.load if name.endswith("force") else 1.0
                )
            over.plot(curve * x_factor, line * factor, color=colour, linewidth=1.0)
        rest.plot(V[own] * x_factor, off[own], "o", color=colour, markersize=3)
    over.set(xscale="log", xlabel=x_label, ylabel=label)
    rest.set(xscale="log", xlabel=x_label, ylabel="fit minus data\n[% of geometric mean]")
    if len(sets) > 1:
        over.legend()


def _over_time(
    fit: FrictionFit, data: Any, name: str, fitted: Any, off: Any, over: Any, rest: Any
) -> None:
    measured = data.measured[name]
    label, factor = style.label(name, fit.data["units"][name])
    x_label, x_factor = LABELS["time"]
    over.plot(data.time * x_factor, measured * factor, "o", color=BLUE, markersize=2, alpha=0.5)
    over.plot(data.time * x_factor, fitted * factor, color=BLACK, linewidth=1.0)
    rest.plot(data.time * x_factor, off, "o", color=BLUE, markersize=2, alpha=0.5)
    over.set(xlabel=x_label, ylabel=label)
    rest.set(xlabel=x_label, ylabel="fit minus data [% of its RMS]")


def _condition(fit: FrictionFit, key: str, value: float) -> str:
    """Return a condition of a curve with its unit."""
    unit = fit.scene.replaceable[key].unit
    if unit == "K":
        return f"{celsius(value)} °C"
    return with_unit(value, unit) if unit in SHOWN_UNITS else f"{value:.4g} {unit}"
