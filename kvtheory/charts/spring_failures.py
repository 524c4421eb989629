"""Entries of the atlas about a drive that holds the indenter by a spring."""

from typing import cast

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from kvtheory.api import elements, steady, transient
from kvtheory.charts.entry import Outcome, Picture
from kvtheory.charts.naive import four_states, mirrored_closed_forms
from kvtheory.results import SprungTransient
from kvtheory.scene.drives import Drive
from kvtheory.scene.indenters import Parabola
from kvtheory.scene.model import DeadWeight, Foundation, Run, Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

RTOL = 1e-9
PATH = 3000
"""Points of the path along which elements are drawn."""


def _followed(
    number: float, epsilon: float, spring: tuple[float, float], s: Array
) -> NDArray[np.float64]:
    """Return (d, d', x, x') by SciPy's Radau, with edges that assume undisturbed ground."""
    law = four_states(number, epsilon, spring)
    run = solve_ivp(
        law, (0.0, s[-1]), (1.0, 0.0, 0.0, 0.0), "Radau", t_eval=s, rtol=1e-8, atol=1e-10
    )  # fmt: skip
    return np.asarray(run.y)


def _on_spring(scene: Scene, times: Array) -> SprungTransient:
    return cast(SprungTransient, transient(scene, at=times, rtol=RTOL, certify=False))


def _past_the_maximum() -> Outcome:
    V, end = 0.091, 0.8
    scene = Scene(drive=Drive(velocity=V, stiffness=1e6), run=Run(end))
    own, t = StaticState.of(scene), np.linspace(0.0, end, 401)
    # Sliding goes on forward here, so that no ground is met again: closed forms are enough.
    spring = own.drive_inertia_number, own.drive_stiffness_number
    w = _followed(own.drive_number, own.inertia_number, spring, t / own.time)[3]
    right = V - own.velocity * w
    ours = _on_spring(scene, t)
    slowest = int(np.argmin(right))
    curve = steady(scene).friction_force
    return Outcome(
        V, float(right[slowest]), float(ours.sliding_velocity[slowest]),
        Picture.of("t [ms]", "sliding velocity [mm/s]",
                   (1e3 * t, np.full(t.size, 1e3 * V)), (1e3 * t, 1e3 * ours.sliding_velocity)),
        f"steady friction force {curve / 1e3:.3g} N/mm, on a curve that says nothing of its stability",
    )  # fmt: skip


def _reversal_forgotten() -> Outcome:
    number, epsilon, spring, end = 3.0, 0.05, (0.01, 2.0), 1.4
    load = 4.0 / 3.0
    s = np.linspace(0.0, end, 351)
    drive = Drive(velocity=number, stiffness=load * spring[1], mass=load * spring[0])
    support = DeadWeight(load * epsilon, 1.0 / epsilon)
    scene = Scene(Parabola(0.5), Foundation(1.0, 1.0), support, drive, Run(end))
    ours = _on_spring(scene, s)
    d, v, _, w = _followed(number, epsilon, spring, s)
    naive = load * np.array(
        [mirrored_closed_forms(*now)[1] for now in zip(d, v, number - w, strict=True)]
    )
    # Elements along the very path: they remember anyway.
    fine = np.linspace(0.0, end, PATH)
    path = _on_spring(scene, fine).sliding_velocity
    history = list(zip(fine.tolist(), np.asarray(path).tolist(), strict=True))
    rigid = Scene(scene.indenter, scene.foundation, support, Drive(history=history), Run(end))
    at = int(np.argmax(np.abs(naive - ours.friction_force)))
    right = elements(rigid, per_length=120.0, at=[float(s[at])], certify=False)
    return Outcome(
        float(naive[at]), float(right.friction_force[0]), float(ours.friction_force[at]),
        Picture.of("t/τ", "friction force / unit", (s, naive / load), (s, ours.friction_force / load)),
        ", ".join(f"{e.kind} at {e.time:.3f} τ" for e in ours.events if e.kind == "sliding reverses"),
    )  # fmt: skip
