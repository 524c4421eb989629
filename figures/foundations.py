"""Friction on foundations beyond Kelvin-Voigt: master curves, and the pressure below the indenter.

Left, the standard linear solid: an arm beta times as stiff as the spring, with the same damping C = K tau
for every beta. At low velocity all of them are Kelvin-Voigt, Eq. (42); beyond their glass transition they are
springs again (their glassy limit is dotted). The high-velocity asymptote of the paper, L2, holds only in a
window, no wider than 1 << V tau/a << beta (theorem F18-window), drawn for the stiffest arm. Right, the
springpot of order alpha; for one order both limits are dotted (theorem F18-springpot). Every curve is exact.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.models.steady import asymptotes, viscoelastic
from kvtheory.plots import BLACK
from kvtheory.scene.foundations import Arm
from kvtheory.theory.closed_forms import ALPHA

NUMBERS = np.geomspace(1e-4, 1e5, 361)
"""V tau/a_0."""
RATIOS = (1.0, 10.0, 100.0, 1e3, 1e4)
ORDERS = (0.2, 0.4, 0.6, 0.8, 1.0)
SHOWN = r"$\alpha = 0.4$"
"""The springpot whose limits are drawn."""
PROFILE = 3.0
"""V tau/a_0 of the profiles."""
SHARES = np.concatenate(([1e-9], np.linspace(0.0, 1.0, 201)[1:]))
ROWS = {"fixed": "fixed indenter", "dead-weight": "dead weight"}


@dataclass(frozen=True)
class Data:
    """mu R/a_0 by support and foundation on `NUMBERS`; x/a_0 and p/(K delta_0) by foundation."""

    curves: dict[str, dict[str, np.ndarray]]
    limits: dict[str, dict[str, tuple[np.ndarray, ...]]]
    profiles: dict[str, tuple[np.ndarray, np.ndarray]]
    columns: drawing.Columns


def _foundations() -> dict[str, dict[str, kv.Scene]]:
    """Return the scenes of each column by their labels: R = K = tau = 1 and a_0 = 1."""
    at_rest: dict[str, Any] = {"fixed": kv.Fixed(0.5), "dead-weight": kv.DeadWeight(load=2.0 / 3.0)}
    kinds: dict[str, Any] = {
        rf"$\beta = {ratio:g}$": kv.GeneralizedMaxwell(1.0, arms=(Arm(ratio, 1.0 / ratio),))
        for ratio in RATIOS
    }
    kinds |= {
        rf"$\alpha = {order:g}$": kv.FractionalKelvinVoigt(1.0, 1.0, order) for order in ORDERS
    }
    kinds["Kelvin–Voigt"] = kv.Foundation(1.0, 1.0)
    return {
        support: {name: kv.Scene(kv.Parabola(1.0), kind, held) for name, kind in kinds.items()}
        for support, held in at_rest.items()
    }


def compute() -> Data:
    """Evaluate the exact steady states, and the pressure in the contact at one velocity."""
    scenes = _foundations()
    over = {"drive.velocity": NUMBERS}
    curves = {
        support: {
            name: kv.steady(scene, over=over).friction_coefficient for name, scene in family.items()
        }
        for support, family in scenes.items()
    }
    profiles = {name: _profile(scene) for name, scene in scenes["dead-weight"].items()}
    columns = {"V tau/a_0 [1]": NUMBERS} | {
        f"mu R/a_0, {support}, {name.replace('$', '')} [1]": mu
        for support, family in curves.items() for name, mu in family.items()
    }  # fmt: skip
    limits = {support: _limits(family) for support, family in scenes.items()}
    return Data(curves, limits, profiles, columns)


def _limits(family: dict[str, kv.Scene]) -> dict[str, tuple[np.ndarray, ...]]:
    """Return the limits that are drawn: glassy of each arm, which falls as 1/V, and both of one springpot."""
    found: dict[str, tuple[np.ndarray, ...]] = {}
    for name, scene in family.items():
        if scene.foundation.arms:
            glassy = kv.asymptotes(scene, over={"drive.velocity": 1.0}).lines[-1].value
            found[name] = (glassy / NUMBERS,)
        elif name == SHOWN:
            there = scene.at(NUMBERS)
            found[name] = tuple(
                asymptotes.quantity(there, limit) for limit in asymptotes.limits(there)
            )
    return found


def _profile(scene: kv.Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return x and the pressure between the edges."""
    state = kv.steady(replace(scene, drive=kv.Drive(PROFILE)))
    a = float(state.half_length)
    X = SHARES * (a + float(state.trailing_edge))
    M = viscoelastic.law(scene.at(np.full(1, PROFILE))).moments(X)
    return X - a, 2.0 * X * (a * (M.P + M.Q) - X * M.P)


def draw(data: Data) -> Figure:
    """Draw both families: fixed, dead weight, and the profiles."""
    drawn = drawing.figure(7.2, 8.0)
    axes = drawn.subplots(3, 2, sharex="row", sharey="row")
    colors = ["#08306b", "#2171b5", "#41ab5d", "#fe9929", "#cb181d"]
    for column, letter in enumerate((r"\beta", r"\alpha")):
        axes[0, column].set_title(
            "standard linear solid, $\\beta = K_1/K$"
            if column == 0
            else "springpot of order $\\alpha$"
        )
        names = [name for name in data.profiles if letter in name]
        for row, (support, words) in enumerate(ROWS.items()):
            ax = axes[row, column]
            for name, color in zip(names, colors, strict=True):
                ax.loglog(NUMBERS, data.curves[support][name], color=color, label=name)
                for limit in data.limits[support].get(name, ()):
                    ax.loglog(NUMBERS, limit, ":", color=color, linewidth=1)
            if column == 0:
                lifted = support == "dead-weight"  # (a/a_0)^2 -> 4 a_0/(3 V tau)
                end = (RATIOS[-1] * np.sqrt(4.0 / 3.0)) ** (2.0 / 3.0) if lifted else RATIOS[-1]
                ax.axvspan(1.0, end, color="0.92", zorder=0)
                L2 = ALPHA * np.sqrt(2.0 / (3.0 * NUMBERS) if lifted else 0.5 + 0.0 * NUMBERS)
                ax.loglog(NUMBERS, L2, "-.", color=BLACK, linewidth=0.8)
                ax.text(1.5e4, 0.0 + L2[-60], "$L_2$", va="bottom")
            plain = data.curves[support]["Kelvin–Voigt"]
            ax.loglog(NUMBERS, plain, "--", color=BLACK, linewidth=1, label="Kelvin–Voigt")
            ax.set(ylim=(1e-4, 1.5), xlabel=r"$V\tau/a_0$")
            if column == 0:
                ax.set_ylabel(rf"{words}: $\mu R/a_0$")
        ax = axes[2, column]
        for name, color in zip([*names, "Kelvin–Voigt"], [*colors, BLACK], strict=True):
            line = {"linestyle": "--", "linewidth": 1} if color == BLACK else {}
            ax.plot(*data.profiles[name], color=color, **line)
        ax.set(xlabel="$x/a_0$", ylim=(0.0, 4.2))
        if column == 0:
            ax.set_ylabel(rf"$p/(K\delta_0)$ at $V\tau = {PROFILE:g}\,a_0$")
        handles, labels = axes[0, column].get_legend_handles_labels()
        ax.legend(handles, labels, loc="upper right", fontsize=8)
    return drawn


if __name__ == "__main__":
    drawing.run("foundations", compute, draw)
