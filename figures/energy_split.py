"""Where the power F V is dissipated: inside the contact, or in the surface that relaxes behind it (F6)."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, RED

RATIOS = np.geomspace(1e-3, 1e3, 301)
"""l_r/a."""


@dataclass(frozen=True)
class Data:
    """The fraction dissipated inside the contact, exact and by quadrature."""

    exact: np.ndarray
    sparse: np.ndarray
    points: np.ndarray
    columns: drawing.Columns


def compute() -> Data:
    """Evaluate a fixed indenter at velocities that give the wanted ratios."""
    scene = kv.Scene.table1("fixed")
    per_ratio = kv.steady(scene).half_length / scene.foundation.retardation_time
    sparse = RATIOS[::15]
    exact = kv.steady(scene, over={"drive.velocity": RATIOS * per_ratio}).dissipated_in_contact
    points = kv.steady(
        scene, over={"drive.velocity": sparse * per_ratio}, method="quadrature"
    ).dissipated_in_contact
    columns = {"l_r/a [1]": RATIOS, "inside [1]": exact, "behind [1]": 1 - exact}
    return Data(exact, sparse, points, columns)


def draw(data: Data) -> Figure:
    """Draw both shares over l_r/a."""
    drawn = drawing.figure(5.0, 3.2)
    ax = drawn.subplots()
    ax.fill_between(RATIOS, data.exact, 1.0, color=RED, alpha=0.18, linewidth=0)
    ax.fill_between(RATIOS, 0.6, data.exact, color=BLUE, alpha=0.12, linewidth=0)
    ax.semilogx(RATIOS, data.exact, color=BLUE, label="exact")
    ax.plot(
        data.sparse,
        data.points,
        "o",
        color=BLACK,
        fillstyle="none",
        markersize=4,
        label="quadrature",
    )
    ax.plot(0.75, 0.8, "D", color=RED, label=r"minimum $4/5$ at $l_\mathrm{r} = 3a/4$")
    ax.text(0.75, 0.95, "behind the contact", ha="center", color=RED)
    ax.text(0.75, 0.69, "inside the contact", ha="center", color=BLUE)
    ax.set(
        xlabel=r"$l_\mathrm{r}/a = V\tau/a$", ylabel=r"share of the power $FV$",
        xlim=(RATIOS[0], RATIOS[-1]), ylim=(0.6, 1.01),
    )  # fmt: skip
    ax.legend(loc="lower right")
    return drawn


if __name__ == "__main__":
    drawing.run("energy_split", compute, draw)
