"""Fig. 6 of the paper: the master curves of the friction coefficient and their asymptotes.

The scaled friction coefficient depends on one number: V tau (R delta)^(-1/2) for a fixed indenter and
V tau (K/(R W))^(1/3) for a dead weight. The curves are exact; the points come from quadrature on
scenes with random parameters, and fall on the curves.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from kvtheory.api import steady
from kvtheory.plots.paper.models import SUPPORTS, Columns, sliding
from kvtheory.plots.style import Picture
from kvtheory.scene import Scene
from kvtheory.theory.closed_forms import (
    ALPHA,
    CRITICAL_DRIVE_NUMBER,
    PEAK_DRIVE_NUMBER,
    PEAK_FRICTION,
)

NUMBERS = np.geomspace(1e-3, 1e3, 301)
POINTS = 24


@dataclass(frozen=True)
class Data:
    """The scaled friction coefficient by support: exact on `NUMBERS`, by quadrature, of a scene."""

    curves: dict[str, np.ndarray]
    points: dict[str, tuple[np.ndarray, np.ndarray]]
    own: dict[str, tuple[float, float]]
    columns: Columns


PANELS: dict[str, dict[str, Any]] = {
    "fixed": {
        "title": SUPPORTS["fixed"],
        "x": r"$V\tau\,(R\delta)^{-1/2}$",
        "y": r"$\mu\,(R/\delta)^{1/2}$",
        "L2": lambda x: np.full_like(x, ALPHA),
        "critical": ALPHA,
    },
    "dead-weight": {
        "title": SUPPORTS["dead-weight"],
        "x": r"$V\tau\,(K/RW)^{1/3}$",
        "y": r"$\mu\,(KR^2/W)^{1/3}$",
        "L2": lambda x: ALPHA / np.sqrt(x),
        "critical": CRITICAL_DRIVE_NUMBER,
    },
}


def compute(scene: Scene | None = None) -> Data:
    """Evaluate the exact curves, and quadrature on random scenes."""
    curves = {support: _scaled(support, NUMBERS, 1.0, 1.0, 1.0, 1.0, "exact") for support in PANELS}
    rng = np.random.default_rng(6)
    points = {}
    for support in PANELS:
        numbers = np.geomspace(2e-3, 500.0, POINTS)
        R, K, tau, grip = 10.0 ** rng.uniform(
            [[-3], [8], [-3], [-4]], [[0], [11], [1], [-3]], (4, POINTS)
        )
        grip = grip * R if support == "fixed" else grip * K * R**2  # depth in m, weight in N/m
        points[support] = numbers, _scaled(support, numbers, R, K, tau, grip, "quadrature")
    columns = {
        "V tau (R delta)^(-1/2) or V tau (K/(R W))^(1/3) [1]": NUMBERS,
        "mu (R/delta)^(1/2), fixed [1]": curves["fixed"],
        "mu (K R^2/W)^(1/3), dead weight [1]": curves["dead-weight"],
        "L1 [1]": NUMBERS,
        "L2, fixed [1]": PANELS["fixed"]["L2"](NUMBERS),
        "L2, dead weight [1]": PANELS["dead-weight"]["L2"](NUMBERS),
    }
    own = {support: _own(each) for support, each in sliding(scene).items()} if scene else {}
    for support, values in own.items():
        for axis, value in zip("xy", values, strict=True):
            columns[f"{axis} of the scene, {support} [1]"] = np.full_like(NUMBERS, value)
    return Data(curves, points, own, columns)


def draw(data: Data) -> Figure:
    """Draw both panels."""
    drawn = Picture(7.2, 3.8)
    for ax, (support, panel) in zip(drawn.subplots(1, 2, sharey=True), PANELS.items(), strict=True):
        ax.loglog(NUMBERS, data.curves[support], color="C1", linewidth=2.0, label="exact")
        ax.loglog(
            *data.points[support],
            "o",
            color="C2",
            fillstyle="none",
            markersize=4,
            label="quadrature",
        )
        ax.loglog(NUMBERS, NUMBERS, "--", color="C2", linewidth=1, label="asymptote $L_1$")
        ax.loglog(
            NUMBERS, panel["L2"](NUMBERS), "-.", color="C2", linewidth=1, label="asymptote $L_2$"
        )
        critical = panel["critical"]
        ax.axvline(critical, color="C0", linestyle=":")
        ax.text(critical, 1e-3, f"  $V^*$ at {critical:.4f}", color="C0")
        ax.set(title=panel["title"], xlabel=panel["x"], ylabel=panel["y"], ylim=(8e-4, 3.0))
        if support in data.own:
            ax.plot(*data.own[support], "*", color="C4", markersize=11, label="the scene")
    left, right = drawn.axes
    drawn.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    right.plot(PEAK_DRIVE_NUMBER, PEAK_FRICTION, "D", color="C3", markersize=6)
    right.annotate(
        f"maximum {PEAK_FRICTION:.4f}\nat {PEAK_DRIVE_NUMBER:.4f},\n$l_\\mathrm{{r}} = \\sqrt{{3}}\\,a$",
        (PEAK_DRIVE_NUMBER, PEAK_FRICTION), xytext=(2.0, 0.005), color="C3",
        arrowprops={"arrowstyle": "-", "color": "C3"},
    )  # fmt: skip
    return drawn


def _own(scene: Scene) -> tuple[float, float]:
    """Return the scaled velocity and friction coefficient of a scene of one of the two models."""
    if not scene.drive.final_velocity:
        raise ValueError("drive.velocity = 0: the scene has no place on a logarithmic axis")
    values = scene.values()
    R, K = values["indenter.radius"], values["foundation.stiffness"]
    state = steady(scene)
    fixed = scene.support.kind == "fixed"
    length = np.sqrt(R * state.depth) if fixed else np.cbrt(R * state.load / K)
    mu = abs(float(state.friction_coefficient)) * R / length
    return abs(float(state.retardation_length)) / length, mu


def _scaled(
    support: str, numbers: np.ndarray, R: Any, K: Any, tau: Any, grip: Any, method: str
) -> np.ndarray:
    """Return the scaled friction coefficient at given scaled velocities; `grip` is depth or weight."""
    fixed = support == "fixed"
    length = np.sqrt(R * grip) if fixed else np.cbrt(R * grip / K)
    over = {
        "indenter.radius": R,
        "foundation.stiffness": K,
        "foundation.retardation_time": tau,
        "drive.velocity": numbers * length / tau,
        "support.depth" if fixed else "support.mass": grip,
    }
    if not fixed:
        over["support.gravity"] = 1.0
    mu = steady(Scene.table1(support), over=over, method=method).friction_coefficient
    return np.asarray(mu) * R / length
