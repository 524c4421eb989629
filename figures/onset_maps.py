"""Apparent "static friction" at the onset of sliding, over drive number and inertia number.

Three maps of one sweep of transients from rest, under a dead weight. First, the ratio of the largest friction
force to the steady one: a peak although nothing sticks, independent of inertia because it occurs at the first
instant. Second, the time until the friction force stays within 1 % of the steady one. Third, how often the
indenter hops. Only lambda and epsilon matter; they are set by the velocity, and by the mass at a
constant weight.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

import kvtheory as kv
from figures import drawing
from kvtheory.scene.static_state import StaticState

NUMBERS = np.geomspace(1e-2, 1e2, 33)
INERTIAS = np.geomspace(1e-4, 1e1, 31)
RTOL = 1e-6
LATEST, PERIODS = 40.0, 130.0
"""A run ends after this many tau, plus this many sqrt(epsilon) tau, in which oscillations die out."""
RATIOS = (1.01, 1.1, 2.0, 10.0, 100.0)
"""Contour lines of the ratio."""
HOPS = {0: "none", 1: "1", 2: "2", 3: "3-4", 5: "5-9", 10: "10-19", 20: "20 or more"}
"""Classes of hops by their lower ends."""
HOP_COLOURS = ("#f4f4f4", "#d6e6f4", "#abcfe5", "#6aaed6", "#3787c0", "#105ba4", "#08306b")
AT_ONCE, LATER = "#f4f4f4", "#bbbbbb"


@dataclass(frozen=True)
class Data:
    """The maps, rows over the inertia number, columns over the drive number."""

    ratio: NDArray[np.float64]
    settling: NDArray[np.float64]
    hops: NDArray[np.float64]
    columns: drawing.Columns


def compute() -> Data:
    """Compute the motion at every point of the map."""
    scene = kv.Scene()
    own = StaticState.of(scene)
    tau, load = scene.foundation.retardation_time, own.load
    mass = INERTIAS * load * tau**2 / own.depth
    axis = ("support.mass", "support.gravity", "run.duration")
    result = kv.sweep(
        scene,
        over={
            axis: (mass, load / mass, tau * (LATEST + PERIODS * np.sqrt(INERTIAS))),
            "drive.velocity": NUMBERS * own.half_length / tau,
        },
        quantities=["peak_to_steady_friction", "settling_time", "hops"],
        rtol=RTOL,
    )
    ratio, settling = result["peak_to_steady_friction"], result["settling_time"] / tau
    inertia, number = np.meshgrid(INERTIAS, NUMBERS, indexing="ij")
    told = ["later" if np.isnan(time) else repr(time) for time in settling.reshape(-1).tolist()]
    columns = {
        "drive_number [1]": number.reshape(-1),
        "inertia_number [1]": inertia.reshape(-1),
        "peak_to_steady_friction [1]": ratio.reshape(-1),
        "settling_time/tau [1]": told,
        "hops [1]": result["hops"].reshape(-1),
    }
    return Data(ratio, settling, result["hops"], columns)


def draw(data: Data) -> Figure:
    """Draw the three maps side by side."""
    drawn = drawing.figure(9.6, 3.5)
    axes = drawn.subplots(1, 3, sharey=True)
    style = {"shading": "nearest", "rasterized": True}
    drawn.colorbar(
        axes[0].pcolormesh(NUMBERS, INERTIAS, data.ratio, cmap="cividis", norm=LogNorm(vmin=1.0), **style),
        ax=axes[0],
    )  # fmt: skip
    look: dict[str, Any] = {
        "color": "white",
        "fontsize": 7,
        "rotation": 90,
        "va": "bottom",
        "ha": "right",
    }
    for ratio in RATIOS:
        number = np.exp(np.interp(np.log(ratio), np.log(data.ratio[0]), np.log(NUMBERS)))
        axes[0].axvline(number, color="white", linewidth=0.8)
        axes[0].text(number, 1.3 * INERTIAS[0], f"{ratio:g}", **look)
    _settling(axes[1], data.settling, style)
    classes = BoundaryNorm([low - 0.5 for low in (*HOPS, 10_000)], len(HOPS))
    colours = ListedColormap(HOP_COLOURS)
    hops = axes[2].pcolormesh(NUMBERS, INERTIAS, data.hops, cmap=colours, norm=classes, **style)
    bounds = np.array([*HOPS, 10_000]) - 0.5
    bar = drawn.colorbar(hops, ax=axes[2], spacing="uniform", ticks=(bounds[1:] + bounds[:-1]) / 2)
    bar.ax.set_yticklabels(HOPS.values())
    bar.ax.minorticks_off()
    titles = "peak friction / steady friction", r"settling time / $\tau$", "hops"
    for ax, title in zip(axes, titles, strict=True):
        ax.set(
            xscale="log", yscale="log", title=title, xlabel=r"drive number $\lambda = V\tau/a_0$",
            xlim=(NUMBERS[0], NUMBERS[-1]), ylim=(INERTIAS[0], INERTIAS[-1]),
        )  # fmt: skip
        ax.grid(False)
    axes[0].set_ylabel(r"inertia number $\epsilon = M\delta_0/(W_0\tau^2)$")
    return drawn


def _settling(ax: Any, settling: NDArray[np.float64], style: dict[str, Any]) -> None:
    """Draw the settling time, with the areas settled from the start and not settled within the run."""
    ax.set_facecolor(LATER)
    for values, look in (
        (settling, {"cmap": "viridis", "norm": LogNorm(vmin=1e-3)}),
        (np.where(settling == 0.0, 1.0, np.nan), {"cmap": ListedColormap([AT_ONCE])}),
    ):
        shown = np.ma.masked_where(~(values > 0.0), values)
        image = ax.pcolormesh(NUMBERS, INERTIAS, shown, **look, **style)
        if values is settling:
            ax.figure.colorbar(image, ax=ax, extend="min")
    ax.text(0.0115, 0.02, "settled\nfrom the\nstart", fontsize=7)
    ax.text(
        0.97,
        0.96,
        "not settled\nin the run",
        fontsize=7,
        transform=ax.transAxes,
        ha="right",
        va="top",
    )


if __name__ == "__main__":
    drawing.run("onset_maps", compute, draw)
