"""Stick-slip though nothing sticks: Table 1 on a spring of 1 MN/m^2, and the cycles that it ends in.

At 91 mm/s steady sliding is past the friction maximum, and unstable on a spring softer than 6.9 MN/m^2. The
indenter creeps with the base while the spring is stretched, and slips as friction falls with velocity.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, GREEN, PURPLE, RED

STIFFNESS = 1e6
SHOWN, END, LAST, POINTS, RTOL = 91, 1.2, 0.5, 1200, 1e-7
STYLES: dict[int, dict[str, Any]] = {
    60: {"color": GREEN, "linestyle": "-."},
    SHOWN: {"color": BLUE, "linestyle": "-"},
    130: {"color": RED, "linestyle": "--"},
    180: {"color": PURPLE, "linestyle": ":"},
}
"""Velocities in mm/s."""
LONG = 4.0
"""Seconds after which the motion has settled to its cycle."""


@dataclass(frozen=True)
class Data:
    """A transient, and the cycles at the end by velocity: x, sliding velocity, depth in mm and mm/s."""

    series: Any
    cycles: dict[int, np.ndarray]
    columns: drawing.Columns


def followed(velocity: float, end: float, first: float) -> Any:
    """Return the transient of Table 1 on the spring, from the time `first` to the `end`."""
    drive = kv.Drive(velocity=velocity * 1e-3, stiffness=STIFFNESS)
    times = np.linspace(first, end, POINTS).tolist()
    return kv.transient(kv.Scene(drive=drive, run=kv.Run(end)), at=times, rtol=RTOL, certify=False)


def compute() -> Data:
    """Compute the time series, and the cycle at each velocity."""
    rows: dict[str, list[Any]] = {
        "V [mm/s]": [],
        "t [ms]": [],
        "x [mm]": [],
        "v [mm/s]": [],
        "depth [mm]": [],
    }
    cycles = {}
    for velocity in STYLES:
        found = followed(velocity, LONG, LONG - LAST)
        x, v, depth = (
            1e3 * np.asarray(column)
            for column in (found.spring_force / STIFFNESS, found.sliding_velocity, found.depth)
        )
        peaks = 1 + np.flatnonzero((x[1:-1] > x[:-2]) & (x[1:-1] >= x[2:]))
        once = slice(peaks[-2], peaks[-1] + 1)
        cycles[velocity] = np.array([x, v, depth])[:, once]
        time = 1e3 * found.time[once]
        for name, column in zip(
            rows, ([velocity] * time.size, time, *cycles[velocity]), strict=True
        ):
            rows[name] += np.asarray(column).tolist()
    return Data(followed(SHOWN, END, 0.0), cycles, rows)


def draw(data: Data) -> Figure:
    """Draw the time series to the left, the cycles to the right."""
    drawn = drawing.figure(7.2, 4.4)
    grid = drawn.add_gridspec(6, 2, width_ratios=(1.35, 1.0))
    top, middle, low = (drawn.add_subplot(grid[2 * k : 2 * k + 2, 0]) for k in range(3))
    series, t = data.series, 1e3 * data.series.time
    top.plot(t, 1e3 * series.velocity, color=BLACK, linewidth=0.8, label="drive")
    top.plot(t, 1e3 * series.sliding_velocity, color=BLUE, label="sliding")
    middle.plot(t, 1e3 * series.depth, color=BLUE)
    low.plot(t, 1e-3 * series.friction_force, color=BLUE, label="friction")
    low.plot(t, 1e-3 * series.spring_force, color=RED, linestyle="--", label="spring")
    for ax, label in (
        (top, "velocity [mm/s]"), (middle, r"depth $\delta$ [mm]"), (low, "force [N/mm]"),
    ):  # fmt: skip
        ax.set(ylabel=label, xlim=(0.0, 1e3 * END))
    for ax in (top, middle):
        ax.tick_params(labelbottom=False)
    low.set(xlabel=r"time $t$ [ms]", ylim=(-2.7, 5.6))
    top.set(ylim=(-10.0, 215.0), title=f"Table 1 at {SHOWN} mm/s on a spring of 1 MN/m$^2$")
    top.legend(loc="upper left", ncols=2)
    low.legend(loc="upper right", ncols=2)
    along, across = drawn.add_subplot(grid[:3, 1]), drawn.add_subplot(grid[3:, 1])
    for velocity, style in STYLES.items():
        x, v, depth = data.cycles[velocity]
        along.plot(x, v, **style)
        across.plot(depth, v, label=f"{velocity} mm/s", **style)
    along.set(xlabel="indenter position $x$ [mm]", ylabel="sliding $v$ [mm/s]", title="cycles")
    across.set(xlabel=r"depth $\delta$ [mm]", ylabel="sliding $v$ [mm/s]")
    across.legend(loc="upper right", fontsize=7)
    return drawn


if __name__ == "__main__":
    drawing.run("stick_slip", compute, draw)
