"""Where steady sliding is stable on a spring in the drive: over velocity and stiffness, for several tau.

The line is the critical stiffness in closed form (theorem F22), the shade the growth rate of small
disturbances, from the roots of the quartic. Marks are motions from rest, which end in steady sliding or in
stick-slip; their solver does not use the theorem.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE

TIMES = (0.01, 0.1, 1.0)
"""Retardation times in s; the rest is Table 1 under a dead weight, whose mass also moves along x."""
VELOCITIES = np.geomspace(1e-3, 10.0, 161)
STIFFNESSES = np.geomspace(1e3, 1e11, 121)
SIMULATED_VELOCITIES, SIMULATED_STIFFNESSES = VELOCITIES[10::10], STIFFNESSES[30::15]
DURATION, SWINGS, RTOL = 15.0, 200.0, 1e-3
"""Duration of the motions in units of the slowest time constant, and largest number of cycles; motions with
more cycles are omitted."""
SLOWEST, FASTEST = 1e-3, 1e2
"""Growth rates in 1/s between which the shade changes."""


@dataclass(frozen=True)
class Data:
    """By retardation time: critical stiffness over the velocity, growth in 1/s, and how motions ended.

    `settled` holds V, k_x and whether the motion settled to steady sliding, or else to stick-slip.
    """

    critical: dict[float, np.ndarray]
    growth: dict[float, np.ndarray]
    peak: dict[float, float]
    settled: dict[float, list[tuple[float, float, bool]]]
    columns: drawing.Columns


def ends_steadily(scene: kv.Scene) -> bool | None:
    """Compute the motion from rest; None if it takes too long to end in steady sliding or in a cycle."""
    rates = np.abs(kv.stability(scene, quantity="rates").rates)
    duration = DURATION / rates[:, 0].min()
    if duration * rates[:, 1].max() > 2.0 * np.pi * SWINGS:
        return None
    long = replace(scene, run=kv.Run(duration))
    end = kv.transient(long, at=[0.0], rtol=RTOL, certify=False).solution.cycle
    return bool(end.amplitude == 0.0) if end.settles else None


def compute(settles: Callable[[kv.Scene], bool | None] = ends_steadily) -> Data:
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
            (V, k, did)
            for V in SIMULATED_VELOCITIES.tolist()
            for k in SIMULATED_STIFFNESSES.tolist()
            if (did := settles(_scene(tau, V, k))) is not None
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
        for end, mark, label in ((True, "o", "ends steadily"), (False, "x", "ends in stick–slip")):
            points = [(V, k) for V, k, did in data.settled[tau] if did is end]
            x, y = np.reshape(points, (-1, 2)).T
            ax.plot(x * 1e3, y / 1e6, mark, color=BLUE, markersize=3, label=label)
        ax.set(
            xscale="log", yscale="log", xlim=(1.0, 1e4), ylim=(1e-3, 1e5),
            title=rf"$\tau$ = {tau * 1e3:g} ms", xlabel="velocity $V$ [mm/s]",
        )  # fmt: skip
        ax.grid(False)
    first = drawn.axes[0]
    first.set_ylabel("stiffness $k_x$ [MN/m$^2$]")
    first.legend(loc="upper left", fontsize=6.5, handlelength=1.5)
    drawn.axes[1].text(0.05, 0.9, "stable", transform=drawn.axes[1].transAxes)
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
