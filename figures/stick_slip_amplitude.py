"""Amplitude of stick-slip on a spring over the drive velocity, Table 1: zero, then that of a cycle.

Stick-slip sets in where steady sliding becomes unstable past the friction maximum, at a higher velocity for a
stiffer spring. Motions near the onset that have not settled by the end of the run are omitted.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLUE, GREEN, RED

STYLES: dict[float, dict[str, Any]] = {
    1e6: {"color": BLUE, "marker": "o"},
    3e6: {"color": RED, "marker": "s"},
    1e7: {"color": GREEN, "marker": "^"},
}
"""By stiffness in N/m^2."""
VELOCITIES, END, RTOL = np.geomspace(0.03, 0.2, 15), 8.0, 1e-5
NAMES = (
    "stick_slip_settles",
    "stick_slip_amplitude",
    "sliding_velocity.cycle_max",
    "sliding_velocity.cycle_min",
)


@dataclass(frozen=True)
class Data:
    """Amplitude, largest and smallest sliding velocity over velocity, where the motion settles."""

    curves: dict[float, np.ndarray]
    columns: drawing.Columns


def compute() -> Data:
    """Sweep velocity and stiffness."""
    drive = kv.Drive(velocity=0.1, stiffness=1e6)
    found = kv.sweep(
        kv.Scene(drive=drive, run=kv.Run(END)),
        over={"drive.stiffness": list(STYLES), "drive.velocity": VELOCITIES},
        quantities=NAMES, rtol=RTOL,
    )  # fmt: skip
    settles, *values = (np.asarray(found[name]) for name in NAMES)
    curves: dict[float, np.ndarray] = {}
    rows: dict[str, list[Any]] = {
        name: []
        for name in ("k_x [N/m^2]", "V [m/s]", "amplitude [m]", "v_max [m/s]", "v_min [m/s]")
    }
    for k, stiffness in enumerate(STYLES):
        known = settles[k] == 1.0
        curves[stiffness] = np.array([VELOCITIES[known], *(value[k][known] for value in values)])
        for name, column in zip(rows, ([stiffness] * known.sum(), *curves[stiffness]), strict=True):
            rows[name] += np.asarray(column).tolist()
    return Data(curves, rows)


def draw(data: Data) -> Figure:
    """Draw the amplitude, and below it the extremes of the sliding velocity."""
    drawn = drawing.figure(4.6, 4.6)
    top, low = drawn.subplots(2, 1, sharex=True)
    for stiffness, style in STYLES.items():
        V, amplitude, largest, smallest = 1e3 * data.curves[stiffness]
        label = f"{stiffness * 1e-6:g} MN/m$^2$"
        top.plot(V, amplitude, label=label, markersize=3, **style)
        for extreme in (largest, smallest):
            low.plot(V, extreme, markersize=3, **style)
    low.plot(1e3 * VELOCITIES, 1e3 * VELOCITIES, color="0.6", linewidth=0.8, label="drive")
    low.axhline(0.0, color="0.8", linewidth=0.6)
    top.set(ylabel="amplitude along $x$ [mm]", title="Table 1 on a spring")
    low.set(
        xlabel="drive velocity $V$ [mm/s]", ylabel="largest, smallest sliding [mm/s]", xscale="log"
    )
    ticks = [30, 50, 100, 200]
    low.set_xticks(ticks, [str(tick) for tick in ticks])
    low.minorticks_off()
    top.legend()
    low.legend(loc="upper left")
    return drawn


if __name__ == "__main__":
    drawing.run("stick_slip_amplitude", compute, draw)
