"""Where the friction curve of Fig. 6 can be measured on a drive of given stiffness.

The exact friction coefficient of a dead weight over velocity (Table 1). Beyond the circle steady sliding
is unstable on a drive of that stiffness: the indenter does not follow the curve (theorem F22).
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, GREEN, PURPLE, RED

VELOCITIES = np.geomspace(1e-3, 10.0, 401)
STIFFNESSES = (1e5, 1e7, 1e9)
"""Stiffness per unit width, in N/m^2: of a finger, of a good tribometer, of a rigid frame."""
COLOURS = (RED, PURPLE, GREEN)


@dataclass(frozen=True)
class Data:
    """The friction coefficient over `VELOCITIES`, and the critical velocity of each stiffness."""

    friction: np.ndarray
    velocities: np.ndarray
    columns: drawing.Columns


def compute() -> Data:
    """Evaluate the curve, and where it ends on each spring."""
    over = {"drive.velocity": VELOCITIES}
    friction = kv.steady(over=over).friction_coefficient
    springs = {"drive.stiffness": np.array(STIFFNESSES)}
    ends = kv.stability(over=springs, quantity="critical_velocity").critical_velocity
    stable = {
        f"stable at {k:g} N/m^2": (ends[i] > VELOCITIES).astype(int)
        for i, k in enumerate(STIFFNESSES)
    }
    columns = {"velocity [m/s]": VELOCITIES, "friction_coefficient [1]": friction, **stable}
    return Data(friction, ends, columns)


def draw(data: Data) -> Figure:
    """Draw the whole curve, and beside it the part that is stable on each stiffness."""
    drawn = drawing.figure(5.2, 3.4)
    ax = drawn.subplots()
    ax.loglog(VELOCITIES * 1e3, data.friction, ":", color=BLACK, label="steady sliding, exact")
    widths = np.linspace(2.0, 7.0, len(STIFFNESSES))
    for k, end, colour, width in zip(STIFFNESSES, data.velocities, COLOURS, widths, strict=True):
        lasts = end > VELOCITIES
        ax.loglog(
            VELOCITIES[lasts] * 1e3, data.friction[lasts], color=colour, linewidth=width, alpha=0.7,
            zorder=3 - width / 10, label=f"stable on $k_x$ = {k / 1e6:g} MN/m$^2$",
        )  # fmt: skip
        there = kv.steady(over={"drive.velocity": end}).friction_coefficient
        ax.plot(end * 1e3, there, "o", color=colour, fillstyle="none", markersize=9)
    peak = kv.asymptotes()
    ax.plot(peak.peak_velocity * 1e3, peak.peak_friction_coefficient, "D", color=BLUE, markersize=4,
            zorder=5, label="friction maximum")  # fmt: skip
    ax.set(xlabel="velocity $V$ [mm/s]", ylabel=r"friction coefficient $\mu$", xlim=(1.0, 1e4))
    ax.legend(loc="lower center")
    return drawn


if __name__ == "__main__":
    drawing.run("measurable_friction", compute, draw)
