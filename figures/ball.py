"""The ball beside the cylinder: master curves, and the footprint with its pressure at three velocities.

The scaled friction coefficient mu R/a_0 depends on V tau/a_0 alone, a_0 being the half length at rest.
Under a dead weight that of a ball falls more slowly, as V^(-1/3), than that of a cylinder, as V^(-1/2). The
footprint is a disc, cut at the rear by the line on which the pressure vanishes; its shape depends on l_r/a
alone.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.models.steady.ball import SHORTER, Footprint
from kvtheory.plots import BLACK, BLUE, RED

NUMBERS = np.geomspace(1e-3, 1e3, 241)
POINTS = 13
RATIOS = (0.1, 1.0, 5.0)
"""l_r/a of the footprints."""
FINE = 241
TITLES = {"fixed": "given depth", "dead-weight": "dead weight"}


@dataclass(frozen=True)
class Data:
    """The scaled friction coefficients by support and shape; footprints in units of a and K a^2/(2 R)."""

    curves: dict[tuple[str, str], np.ndarray]
    points: dict[str, tuple[np.ndarray, np.ndarray]]
    footprints: tuple[Footprint, ...]
    columns: drawing.Columns


def compute() -> Data:
    """Evaluate the exact curves, quadrature over the strips of the ball, and the footprints."""
    shapes = {"ball": kv.Sphere(1.0), "cylinder": kv.Parabola(1.0)}
    curves = {
        (support, name): _scaled(support, shape, NUMBERS, "exact")
        for support in TITLES
        for name, shape in shapes.items()
    }
    few = np.geomspace(2e-3, 500.0, POINTS)
    points = {
        support: (few, _scaled(support, shapes["ball"], few, "quadrature")) for support in TITLES
    }
    # K = 2 and R = 1, so that pressures are in units of K a^2/(2 R).
    footprints = tuple(Footprint(1.0, 2.0, 1.0, 1.0, ratio) for ratio in RATIOS)
    columns = {"V tau/a_0 [1]": NUMBERS} | {
        f"mu R/a_0, {name}, {TITLES[support]} [1]": curve
        for (support, name), curve in curves.items()
    }
    return Data(curves, points, footprints, columns)


def draw(data: Data) -> Figure:
    """Draw the curves above and the footprints below."""
    drawn = drawing.figure(7.2, 6.0)
    parts: Any = drawn.subfigures(2, 1, height_ratios=(1.15, 1.0))
    above, below = parts
    for ax, (support, title) in zip(above.subplots(1, 2, sharey=True), TITLES.items(), strict=True):
        for name, color in (("ball", RED), ("cylinder", BLUE)):
            ax.loglog(NUMBERS, data.curves[support, name], color=color, label=name)
        look = {"color": BLACK, "fillstyle": "none", "markersize": 4, "linestyle": "none"}
        ax.loglog(*data.points[support], marker="o", label="ball, quadrature", **look)
        ax.set(title=title, xlabel=r"$V\tau/a_0$", ylim=(8e-4, 2.0))
    left, right = above.axes
    left.set(ylabel=r"$\mu R/a_0$")
    left.text(60.0, 0.5 * SHORTER * 2 / 3, r"$\frac{3\pi}{16}$ and $\frac{2}{3}$", color=BLACK)
    right.text(60.0, 0.25, r"$V^{-1/3}$", color=RED)
    right.text(30.0, 0.03, r"$V^{-1/2}$", color=BLUE)
    left.legend(loc="lower right")
    for ax, found in zip(below.subplots(1, len(RATIOS), sharey=True), data.footprints, strict=True):
        image = _footprint(ax, found)
        bar = below.colorbar(image, ax=ax, orientation="horizontal", shrink=0.8, aspect=14)
        bar.set_label(r"$p/(K\delta)$")
    below.axes[0].set(ylabel=r"$y/a$")
    return drawn


def _footprint(ax: Any, found: Footprint) -> Any:
    """Shade the pressure and draw the disc of the contact at rest and the edges."""
    side = np.linspace(-1.0, 1.0, FINE)
    x, y = np.meshgrid(side, side)
    p = np.ma.masked_equal(found.pressure(x, y), 0.0)
    image = ax.pcolormesh(x, y, p, cmap="Reds", shading="gouraud", vmin=0.0, rasterized=True)
    t = np.linspace(0.0, 2.0 * np.pi, FINE)
    ax.plot(np.cos(t), np.sin(t), ":", color=BLACK, linewidth=0.8)
    leading, trailing = found.edges(side)
    ax.plot(leading, side, color=BLUE)
    ax.plot(trailing, side, "--", color=BLUE)
    ax.set(
        title=rf"$l_\mathrm{{r}}/a = {found.retardation_length:g}$", xlabel="$x/a$", aspect="equal"
    )
    ax.set(xlim=(-1.06, 1.06), ylim=(-1.06, 1.06))
    ax.grid(visible=False)
    return image


def _scaled(support: str, shape: Any, numbers: np.ndarray, method: str) -> np.ndarray:
    """Return mu R/a_0 at given V tau/a_0, with R = K = tau = 1 and a_0 = 1."""
    rest = np.pi / 4.0 if isinstance(shape, kv.Sphere) else 2.0 / 3.0  # W_0 at a_0 = 1
    grip = kv.Fixed(depth=0.5) if support == "fixed" else kv.DeadWeight(load=float(rest))
    scene = kv.Scene(indenter=shape, foundation=kv.Foundation(1.0, 1.0), support=grip)
    state = kv.steady(scene, over={"drive.velocity": numbers}, method=method)
    return np.asarray(state.friction_coefficient)


if __name__ == "__main__":
    drawing.run("ball", compute, draw)
