"""Where steady sliding is stable on a spring in the drive: over velocity and stiffness, for several tau.

The line is the critical stiffness in closed form (theorem F22), the shade how fast small motions grow, by the
roots of the quartic. What a simulation of the motion did, given by `compute(settles=...)`, is drawn over it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, RED

TIMES = (0.01, 0.1, 1.0)
"""Retardation times in s; the rest is Table 1 under a dead weight, its mass along x too."""
VELOCITIES = np.geomspace(1e-3, 10.0, 161)
STIFFNESSES = np.geomspace(1e3, 1e11, 121)
SIMULATED = slice(10, None, 20)
"""Which velocities and stiffnesses are simulated."""
SLOWEST, FASTEST = 1e-3, 1e2
"""Growth in 1/s between which the shade changes."""


@dataclass(frozen=True)
class Data:
    """By retardation time: critical stiffness over the velocity, growth in 1/s, and what motions did.

    `settled` holds V, k_x and whether the motion settled to steady sliding.
    """

    critical: dict[float, np.ndarray]
    growth: dict[float, np.ndarray]
    peak: dict[float, float]
    settled: dict[float, list[tuple[float, float, bool]]]
    columns: drawing.Columns


def compute(settles: Callable[[kv.Scene], bool] | None = None) -> Data:
    """Evaluate boundary and growth; `settles` says whether the motion of a scene ends in steady sliding."""
    critical, growth, peak, settled = {}, {}, {}, {}
    columns: dict[str, list[float]] = {
        "retardation_time [s]": [], "velocity [m/s]": [],
        "critical_stiffness [N/m^2]": [], "frequency [Hz]": [],
    }  # fmt: skip
    for tau in TIMES:
        line = {"drive.velocity": VELOCITIES, "foundation.retardation_time": tau}
        found = kv.stability(over=line, quantity=["critical_stiffness", "frequency"])
        critical[tau] = found.critical_stiffness
        grid = {**line, "drive.stiffness": STIFFNESSES[:, np.newaxis]}
        growth[tau] = kv.stability(over=grid, quantity="rates").rates[..., 0, 0]
        peak[tau] = kv.asymptotes(over={"foundation.retardation_time": tau}).peak_velocity
        settled[tau] = [
            (V, k, settles(_scene(tau, V, k)))
            for V in VELOCITIES[SIMULATED].tolist()
            for k in STIFFNESSES[SIMULATED].tolist()
            if settles is not None
        ]
        some = np.isfinite(found.critical_stiffness)
        rows = VELOCITIES, found.critical_stiffness, found.frequency
        columns["retardation_time [s]"] += [tau] * np.count_nonzero(some)
        for name, values in zip(list(columns)[1:], rows, strict=True):
            columns[name] += values[some].tolist()
    return Data(critical, growth, peak, settled, columns)


def draw(data: Data) -> Figure:
    """Draw a map for each retardation time."""
    drawn = drawing.figure(7.4, 3.0)
    shade: Any = None
    for ax, tau in zip(drawn.subplots(1, len(TIMES), sharey=True), TIMES, strict=True):
        growing = np.ma.masked_less_equal(data.growth[tau], 0.0)
        shade = ax.pcolormesh(
            VELOCITIES * 1e3, STIFFNESSES / 1e6, growing, norm=LogNorm(SLOWEST, FASTEST),
            cmap="Oranges", shading="nearest", linewidth=0, rasterized=True,
        )  # fmt: skip
        ax.plot(VELOCITIES * 1e3, data.critical[tau] / 1e6, color=BLACK, label="critical stiffness")
        ax.axvline(data.peak[tau] * 1e3, color=BLUE, linestyle=":", label="friction maximum")
        for settled, mark in ((True, "o"), (False, "x")):
            points = [(V * 1e3, k / 1e6) for V, k, did in data.settled[tau] if did is settled]
            if points:
                ax.plot(*zip(*points, strict=True), mark, color=RED, markersize=3, fillstyle="none")
        ax.set(
            xscale="log", yscale="log", xlim=(1.0, 1e4), ylim=(1e-3, 1e5),
            title=rf"$\tau$ = {tau * 1e3:g} ms", xlabel="velocity $V$ [mm/s]",
        )  # fmt: skip
        ax.grid(False)
    first = drawn.axes[0]
    first.set_ylabel("stiffness $k_x$ [MN/m$^2$]")
    first.text(0.05, 0.9, "stable", transform=first.transAxes)
    first.legend(loc="center left", fontsize=6.5, handlelength=1.5, borderpad=0.0)
    drawn.axes[1].text(0.97, 0.06, "unstable", transform=drawn.axes[1].transAxes, ha="right")
    drawn.colorbar(shade, ax=drawn.axes, label="growth [1/s]", extend="both", pad=0.01)
    return drawn


def _scene(tau: float, velocity: float, stiffness: float) -> kv.Scene:
    return kv.Scene(
        foundation=kv.Foundation(stiffness=1e10, retardation_time=tau),
        drive=kv.Drive(velocity=velocity, stiffness=stiffness),
    )


if __name__ == "__main__":
    drawing.run("spring_stability", compute, draw)
