"""Two contact engines, Drake (hydroelastic contact) and MuJoCo, compared with theory.

A hard cylinder on a compliant ground without Coulomb friction, under a dead weight. The series of the engines
are stored in `engines.csv`; `python -m figures.benchmark_engines` judges them, or computes them anew.
"""

import csv
from collections import defaultdict
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import brentq

import kvtheory as kv
from figures import drawing
from kvtheory.plots import BLACK, BLUE, GREEN, RED

STORED = Path(drawing.__file__).with_name("engines.csv")
SERIES = "time", "depth", "normal_force", "friction_force"
R, K, TAU, G = 0.1, 1e9, 0.02, 9.80665
LOAD = 10.0 * G
REST = (0.75 * LOAD / K) ** (2 / 3) / (2 * R) ** (1 / 3)
LIKE_TAU = 5 * TAU / (2 * REST)
"""Dissipation of Hunt and Crossley, in s/m, that has the friction of TAU in slow sliding."""
SPEEDS = 0.0, 0.01, 0.03, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0
STEPS = 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5


@dataclass(frozen=True)
class Run:
    """What is simulated: velocity from a time on, solver, time step, elements per m, stored rows, radius."""

    history: tuple[tuple[float, float], ...] = ((0.0, 0.5),)
    duration: float = 0.2
    solver: str = "sap"
    step: float = 1e-4
    per_length: float = 4e4
    rows: int = 1
    ball: bool = False
    radius: float = R

    @property
    def mass(self) -> float:
        """In kg, of the cylinder on 1 m of width."""
        return 0.1 if self.ball else 10.0

    @property
    def scene(self) -> kv.Scene:
        """The same for the package."""
        starts, V = zip(*self.history, strict=True)
        ends = [*starts[1:], self.duration]
        points = [(t, v) for *span, v in zip(starts, ends, V, strict=True) for t in span]
        shape = (kv.Sphere if self.ball else kv.Parabola)(self.radius)
        support, drive = kv.DeadWeight(mass=self.mass), kv.Drive(history=points)
        return kv.Scene(shape, kv.Foundation(K, TAU), support, drive, kv.Run(self.duration))


RUNS = {
    "start": Run(duration=0.04, rows=80),
    "start, step of 1 ms": Run(duration=0.04, step=1e-3, rows=40),
    "start, Hunt-Crossley": Run(duration=0.04, solver="lagged", rows=80),
    "start, MuJoCo": Run(duration=0.04, solver="mujoco", rows=80),
    "start of a ball": Run(duration=0.04, rows=80, ball=True, per_length=1e3),
    "reversal": Run(((0.0, 0.5), (0.03, -0.5)), 0.06, rows=120),
    **{f"steady {V:g}": Run(((0.0, V),), 0.3) for V in SPEEDS},
    **{f"Hunt-Crossley {V:g}": Run(((0.0, V),), 0.3, "lagged") for V in SPEEDS},
    **{f"Similar {V:g}": Run(((0.0, V),), 0.3, "similar") for V in (0.1, 0.5)},
    **{f"MuJoCo {V:g}": Run(((0.0, V),), 0.3, "mujoco") for V in SPEEDS},
    **{f"step {h:g}": Run(step=h) for h in STEPS},
    **{f"mesh {n:g}": Run(per_length=n) for n in (5e3, 1e4, 2e4, 4e4, 8e4)},
    **{
        f"ball {n:g}": Run(duration=0.1, ball=True, per_length=n) for n in (125, 250, 500, 1e3, 2e3)
    },
    "Hunt-Crossley 0.5, step 2e-05": Run(((0.0, 0.5),), 0.3, "lagged", 2e-5),
    "steady 2, step 2e-05": Run(((0.0, 2.0),), 0.3, step=2e-5),
    "radius 0.01": Run(((0.0, 0.02),), 0.3, radius=0.01),
}


@dataclass(frozen=True)
class Data:
    """Friction over velocity, series and friction over the step, of the engines and by theory."""

    stored: dict[str, dict[str, np.ndarray]]
    velocity: np.ndarray
    steady: dict[str, np.ndarray]
    theory: dict[str, kv.Transient]
    stepped: np.ndarray
    columns: drawing.Columns


def stored() -> dict[str, dict[str, np.ndarray]]:
    """Return the columns of each run."""
    with STORED.open(encoding="utf-8") as file:
        lines = list(csv.reader(file))[1:]
    rows = defaultdict(list)
    for name, *cells in lines:
        rows[name].append([float(cell) for cell in cells])
    return {name: dict(zip(SERIES, np.array(r).T, strict=True)) for name, r in rows.items()}


def hunt_crossley(V: float) -> float:
    """Return the steady friction coefficient of p = K u (1 + c u') by quadrature."""

    def forces(depth: float) -> np.ndarray:
        a = np.sqrt(2 * R * depth)
        x, dx = np.linspace(-a, a, 4001, retstep=True)
        p = K * (depth - x * x / (2 * R)) * np.maximum(1 - LIKE_TAU * V * x / R, 0.0)
        return np.array([p.sum(), (-p * x / R).sum()]) * dx

    F_z, F_x = forces(brentq(lambda depth: forces(depth)[0] - LOAD, 1e-3 * REST, 2 * REST))
    return float(F_x / F_z)


def compute() -> Data:
    """Read the series of the engines, and compute the same by theory."""
    start, V = RUNS["start"].scene, np.linspace(0.0, 2.0, 201)
    curves = {
        "Kelvin–Voigt": kv.steady(start, over={"drive.velocity": V}).friction_coefficient,
        "Hunt–Crossley": np.array([hunt_crossley(v) for v in V]),
    }
    theory = {name: kv.transient(RUNS[name].scene) for name in ("start", "reversal")}
    later = replace(start, drive=kv.Drive(0.5))
    over = {"foundation.retardation_time": [TAU, *(TAU + h for h in STEPS)]}
    mu = kv.steady(later, over=over).friction_coefficient
    columns = {"V [m/s]": V} | {f"mu, {name} [1]": mu for name, mu in curves.items()}
    return Data(stored(), V, curves, theory, mu, columns)


def draw(data: Data) -> Figure:
    """Draw friction over velocity, a start, a reversal, and what the time step changes."""
    drawn = drawing.figure(7.2, 6.0)
    steady, start, back, step = drawn.subplots(2, 2).flat
    for (name, mu), color in zip(data.steady.items(), (BLACK, RED), strict=True):
        steady.plot(data.velocity, mu, color=color, label=f"theory, {name}")
    for name, color, mark in (
        ("steady", BLUE, "o"),
        ("Hunt-Crossley", RED, "x"),
        ("MuJoCo", GREEN, "s"),
    ):
        F = [data.stored[f"{name} {V:g}"]["friction_force"][-1] for V in SPEEDS]
        words = {"steady": "Drake, SAP", "Hunt-Crossley": "Drake, Lagged"}.get(name, name)
        steady.plot(SPEEDS, np.array(F) / LOAD, mark, color=color, markersize=4, label=words)
    steady.set(
        xlabel="velocity [m/s]", ylabel=r"friction coefficient $\mu$", title="steady sliding"
    )
    steady.legend(fontsize=7, loc="upper right", bbox_to_anchor=(1.0, 0.42))
    for ax, name in ((start, "start"), (back, "reversal")):
        exact = data.theory[name]
        ax.plot(1e3 * exact.time, 1e3 * exact.depth, color=BLACK, label="theory")
        for run, color, words in (
            (name, BLUE, "Drake, SAP"),
            (f"{name}, Hunt-Crossley", RED, "Drake, Lagged"),
            (f"{name}, MuJoCo", GREEN, "MuJoCo"),
        ):
            if run in data.stored:
                t, depth = (data.stored[run][key] for key in ("time", "depth"))
                ax.plot(1e3 * t, 1e3 * depth, ".", color=color, markersize=3, label=words)
        ax.set(xlabel="time [ms]", ylabel=r"depth $\delta$ [mm]", title=name)
        ax.legend(fontsize=7)
    found = [data.stored[f"step {h:g}"]["friction_force"][-1] / LOAD for h in STEPS]
    shown = np.array(STEPS) * 1e3
    step.loglog(shown, 1 - np.array(found) / data.stepped[0], "o", color=BLUE, label="Drake, SAP")
    step.loglog(
        shown,
        1 - data.stepped[1:] / data.stepped[0],
        color=BLACK,
        label=r"theory for $\tau + \Delta t$",
    )
    step.set(
        xlabel=r"$\Delta t$ [ms]",
        ylabel=r"$1 - \mu/\mu_{\Delta t = 0}$",
        title="time step, 0.5 m/s",
    )
    step.legend(fontsize=7)
    return drawn


if __name__ == "__main__":
    drawing.run("engines", compute, draw)
