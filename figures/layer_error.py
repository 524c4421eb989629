"""How wrong independent elements are for a layer: bounds of the error of the model.

The stiffness of the elements gives the depth at rest of the layer under the load. Left and middle: the
error of friction coefficient and depth of a standard linear solid that stiffens by a factor of six, at
Poisson's ratio 0.49, over V/V* and the thickness over the half length at rest. At low velocity the elements
are right, whatever the layer. The levels are those of the colour bar. Right: the largest error of friction
at any velocity, for several Poisson's ratios, and for a wide spectrum (dashed, six decades of relaxation
times).
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from figures import drawing
from kvtheory.layer.model_error import relative_error

VELOCITIES = np.geomspace(1e-2, 1e3, 101)
THICKNESSES = np.geomspace(0.1, 100.0, 61)
RATIOS = {0.3: "#2171b5", 0.45: "#41ab5d", 0.5: "#cb181d"}
STIFFENING, WIDTHS, NEARLY = 6.0, {0.0: ("-", "one arm"), 6.0: ("--", "six decades")}, 0.49
LEVELS = [0.03, 0.05, 0.1, 0.2, 0.5, 1.0]
KINDS = {"line": "cylinder", "ball": "ball"}


@dataclass(frozen=True)
class Data:
    """Errors of friction and depth over thickness and velocity; the largest of friction over thickness."""

    maps: dict[str, tuple[np.ndarray, np.ndarray]]
    largest: dict[tuple[str, float, float], np.ndarray]
    columns: drawing.Columns


def compute() -> Data:
    """Evaluate the map."""
    h, v = THICKNESSES[:, None], VELOCITIES
    maps = {kind: relative_error(kind, h, NEARLY, v, 0.0, STIFFENING) for kind in KINDS}
    wide = np.geomspace(1e-6, 1e6, 241)
    largest = {
        (kind, nu, width): relative_error(kind, h, nu, wide, width, STIFFENING)[0].max(axis=1)
        for kind in KINDS for nu in RATIOS for width in WIDTHS
    }  # fmt: skip
    columns = {"H/a [1]": np.repeat(THICKNESSES, v.size), "V/V* [1]": np.tile(v, h.size)}
    for kind, found in maps.items():
        for name, error in zip(("friction coefficient", "depth"), found, strict=True):
            columns[f"largest error of {name}, {kind} [1]"] = error.ravel()
    return Data(maps, largest, columns)


def draw(data: Data) -> Figure:
    """Draw the levels of the error, and the largest error of friction."""
    drawn = drawing.figure(9.6, 5.4)
    axes = drawn.subplots(2, 3, sharey=True)
    for row, (kind, words) in zip(axes, KINDS.items(), strict=True):
        for ax, error, name in zip(row, data.maps[kind], ("friction", "depth"), strict=False):
            filled = ax.contourf(VELOCITIES, THICKNESSES, error, levels=LEVELS, cmap="YlOrRd",
                                 norm="log", extend="both")  # fmt: skip
            ax.contour(
                VELOCITIES, THICKNESSES, error, levels=LEVELS, colors="black", linewidths=0.5
            )
            ax.set(xscale="log", yscale="log", title=f"{words}: {name}")
        row[0].set_ylabel("$H/a$")
        for (name, nu, width), largest in data.largest.items():
            if name == kind:
                label = rf"$\nu = {nu:g}$, {WIDTHS[width][1]}"
                style = {"linestyle": WIDTHS[width][0], "color": RATIOS[nu], "linewidth": 1}
                row[2].plot(largest, THICKNESSES, label=label, **style)
        row[2].set(xlim=(0.0, None), title=f"{words}: friction, any velocity")
        row[2].xaxis.set_major_formatter("{x:.0%}")
    axes[0, 2].legend(fontsize=7, loc="lower right")
    bar = drawn.colorbar(filled, ax=axes[:, 1].tolist(), format="{x:.0%}", label="largest error")
    bar.minorticks_off()
    for ax in axes[1, :2]:
        ax.set_xlabel("$V/V^*$")
    axes[1, 2].set_xlabel("largest error")
    return drawn


if __name__ == "__main__":
    drawing.run("layer_error", compute, draw)
