"""A filled rubber as a Prony series, and where the paper's model is accurate for it.

The series is synthetic: eleven arms a decade apart, in the style of published series of filled rubber (a
ratio of glassy to relaxed stiffness near 200, a spectrum that falls over ten decades). It represents no
material and no measurement; replace it by your own.

Left, the exact friction coefficient, that of Kelvin-Voigt with the same damping C, and the glassy limit.
Right, the error of Kelvin-Voigt, its bound by theorem F18-voigt, and the ranges within one per cent.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, GREEN, RED
from kvtheory.scene.foundations import Arm

STIFFNESS = 1e10
"""K of the relaxed rubber, in N/m^3: that of Table 1."""
ARMS = {
    1e-8: 60.0, 1e-7: 48.0, 1e-6: 34.0, 1e-5: 22.0, 1e-4: 13.0, 1e-3: 7.0,
    1e-2: 3.6, 1e-1: 1.8, 1e0: 0.9, 1e1: 0.45, 1e2: 0.2,
}  # fmt: skip
"""K_i/K by tau_i in s: synthetic, see above."""
SPEEDS = np.geomspace(1e-10, 1e7, 341)
"""m/s."""
TOLERANCE = 0.01


@dataclass(frozen=True)
class Data:
    """mu by name, the error of Kelvin-Voigt and its proved bound on `SPEEDS`, and the ends of its range."""

    curves: dict[str, np.ndarray]
    error: np.ndarray
    bound: np.ndarray
    measured: float
    proved: float
    columns: drawing.Columns


def rubber() -> kv.Scene:
    """Return the scene of Table 1 on this rubber."""
    arms = tuple(Arm(STIFFNESS * ratio, time) for time, ratio in ARMS.items())
    return replace(kv.Scene(), foundation=kv.GeneralizedMaxwell(STIFFNESS, arms=arms))


def compute() -> Data:
    """Evaluate the formulas of `kvtheory.asymptotes` beside the exact state."""
    scene = rubber()
    over = {"drive.velocity": SPEEDS}
    state = kv.steady(scene, over=over)
    plain = replace(scene, foundation=kv.Foundation(STIFFNESS, scene.foundation.retardation_time))
    curves = {"rubber": state.friction_coefficient}
    curves["Kelvin–Voigt, same $K$ and $C$"] = kv.steady(plain, over=over).friction_coefficient
    report = kv.asymptotes(scene, tolerance=TOLERANCE)
    glassy = report.lines[2]
    curves["glassy limit"] = glassy.value * kv.Scene().drive.velocity / SPEEDS
    error = curves["Kelvin–Voigt, same $K$ and $C$"] / curves["rubber"] - 1.0
    time = sum(k * t * t for t, k in ARMS.items()) / sum(k * t for t, k in ARMS.items())
    delay = SPEEDS * time / (state.half_length + state.trailing_edge)
    bound = np.where(delay <= 0.05, 7.0 * delay / (1.0 - 7.0 * np.minimum(delay, 0.05)), np.nan)
    columns = {"V [m/s]": SPEEDS, "error of Kelvin-Voigt [1]": error, "proved bound [1]": bound} | {
        f"mu, {name.replace('$', '')} [1]": mu for name, mu in curves.items()
    }
    line = report.lines[1]
    return Data(curves, error, bound, line.velocity_max, line.velocity_proved, columns)


def draw(data: Data) -> Figure:
    """Draw friction and error side by side."""
    drawn = drawing.figure(7.2, 3.3)
    left, right = drawn.subplots(1, 2, sharex=True)
    looks: tuple[dict[str, Any], ...] = (
        {"color": BLUE, "linewidth": 2.0},
        {"color": RED, "linestyle": "--"},
        {"color": BLACK, "linestyle": ":"},
    )
    for (name, mu), look in zip(data.curves.items(), looks, strict=True):
        left.loglog(SPEEDS, mu, label=name, **look)
    left.set(
        xlabel="$V$ [m/s]", ylabel=r"$\mu$", ylim=(1e-6, 1.0), title="a synthetic filled rubber"
    )
    left.legend(loc="lower center", fontsize=8)
    right.loglog(
        SPEEDS, np.abs(data.error), color=RED, linestyle="--", label="error of Kelvin–Voigt"
    )
    right.loglog(SPEEDS, data.bound, color=GREEN, label="proved bound")
    right.axhline(TOLERANCE, color=BLACK, linewidth=0.8)
    for ax in (left, right):
        ax.axvspan(SPEEDS[0], data.proved, color=GREEN, alpha=0.2, linewidth=0)
        ax.axvspan(data.proved, data.measured, color=GREEN, alpha=0.1, linewidth=0)
    right.text(
        data.measured, 6e-3,
        f"  within 1 %\n  up to {1e9 * data.measured:.0f} nm/s,\n  proved up to {1e9 * data.proved:.0f} nm/s",
        va="top", fontsize=8,
    )  # fmt: skip
    right.set(
        xlabel="$V$ [m/s]", ylabel="relative error", ylim=(1e-4, 1e2), xlim=(SPEEDS[0], SPEEDS[-1])
    )
    right.legend(loc="upper left", fontsize=8)
    return drawn


if __name__ == "__main__":
    drawing.run("rubber", compute, draw)
