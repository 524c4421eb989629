r"""The transient of a ball at a constant depth, from strips with closed-form edges; no elements, no memory.

A strip at y is a parabola of the half length A, A^2 = a^2 - y^2 R/R'. Its leading edge stays at -A, on
undisturbed surface; its trailing edge peels, x_TE = sqrt(A^2 + l_r^2) - l_r with l_r = |V| tau of that
instant (fact F10 with a constant depth). This holds as long as no strip's trailing edge outruns the
foundation that moves away under it, dx_TE/dt <= |V|: a drive that slows down must satisfy

    tau |dV/dt| (1 - l_r/sqrt(A^2 + l_r^2)) <= |V|,

which binds first where A = a, the middle plane, and at the slow end of a linear piece of drive. Forces are
sums over y = b sin t by Gauss's rule, each strip by F11.

A ball that can rise is left to elements: d' < 0 lifts the rim off the surface at once, where
sqrt(d - y^2) < -d'/(2 lambda), and the rim later lands on surface that has not yet recovered.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import ArrayLike, NDArray

from kvtheory.results import AT_REST, TRANSIENT_UNITS, Certificate, Event, Transient, units_for
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState
from kvtheory.theory.closed_forms import peak_pressure_factor, trailing_edge_ratio

Array = NDArray[np.float64]

NODES = 128
"""Nodes of Gauss's rule over the strips; its error is estimated with half as many."""
OWN_TIMES = 401
"""Number of times of the series if none are given."""
ROUNDING = 1e-13
FORCES = {"normal_force": "load", "friction_force": "friction_force"}
"""The forces, and their scales in the static state."""

STATEMENT = (
    "strips with edges in closed form, summed by Gauss's rule: ten times the difference to a rule with half "
    "as many strips, of the scene at rest"
)


@dataclass(frozen=True)
class HeldBall:
    """A ball at a constant depth; evaluates its pressure, in SI."""

    scene: Scene
    units: StaticState

    def pressure(self, x: ArrayLike, time: float) -> Any:
        """Return the pressure in the middle plane."""
        x, a = np.asarray(x, dtype=float), self.units.half_length
        end = self.scene.run.duration
        if not 0.0 <= time <= end:
            raise ValueError(f"`time` must lie in [0, {end!r}] s, got {time!r}")
        path = self.scene.drive.motion(end, 1.0)
        l_r = path.velocity(time) * self.scene.foundation.retardation_time
        ahead = -x if l_r < 0.0 else x
        bent = a * a - x * x - 2.0 * l_r * x
        stiffness = 0.5 * self.scene.foundation.stiffness / self.scene.indenter.radius  # type: ignore[union-attr]
        return stiffness * np.where((ahead >= -a) & (bent > 0.0), bent, 0.0)

    def surface(self, x: ArrayLike, time: float) -> Any:
        """Refuse: the strips do not follow the surface."""
        raise ValueError("`surface` holds for line contacts only, not for a ball")

    def energy(self, time: ArrayLike) -> Any:
        """Refuse: the strips do not follow the energies."""
        raise ValueError("`energy` holds for line contacts only, not for a ball")


def transient(scene: Scene, at: ArrayLike | None, *, certify: bool = True) -> Transient:
    """Return the transient of a ball whose depth is constant, at the times `at` (s).

    ValueError if an edge re-enters surface that it left: the drive slows down too fast, stops or reverses.

    >>> from kvtheory.scene import Fixed, Scene, Sphere
    >>> found = transient(Scene(indenter=Sphere("10 mm"), support=Fixed(depth="0.3 mm")), [0.0, 0.2])
    >>> found.normal_force.round(3).tolist()
    [113.283, 113.283]
    """
    if why := remembers(scene):
        raise ValueError(f"the transient of a ball {why}; `elements` follows it")
    units = StaticState.of(scene)
    time = np.linspace(0.0, scene.run.duration, OWN_TIMES) if at is None else np.asarray(at, float)
    path = scene.drive.motion(scene.run.duration, 1.0)
    velocity = np.array([path.velocity(float(t)) for t in np.ravel(time)])
    l_r = np.abs(velocity) * scene.foundation.retardation_time
    side = np.where(velocity < 0.0, -1.0, 1.0)
    load, friction = _forces(scene, units, l_r, NODES)
    a, count = units.half_length, len(l_r)
    series: dict[str, Any] = {
        "time": time,
        "velocity": velocity,
        "depth": np.full_like(l_r, units.depth),
        "depth_rate": np.zeros_like(l_r),
        "normal_force": load,
        "friction_force": side * friction + 0.0,
        "leading_edge": -side * a,
        "trailing_edge": side * a * trailing_edge_ratio(l_r / a),
        "peak_pressure": units.pressure * peak_pressure_factor(l_r / a),
    }
    kind, errors = ("estimated", dict.fromkeys(series, ROUNDING)) if certify else ("none", {})
    if certify:
        coarse = _forces(scene, units, l_r, NODES // 2)
        for name, fine, rough in zip(FORCES, (load, friction), coarse, strict=True):
            apart = float(np.max(np.abs(fine - rough), initial=0.0))
            errors[name] = 10.0 * apart / getattr(units, FORCES[name]) + ROUNDING
    return Transient(
        **series, leading_state=("touching",) * count, trailing_state=("peeling",) * count,
        events=(Event(0.0, "drive jumps"),) if scene.drive.points[0][1] != 0.0 else (),
        steps=0, evaluations=count * NODES, compiled=False, model="strips",
        certificate=Certificate(kind, STATEMENT, errors, AT_REST),
        solution=HeldBall(scene, units), units=units_for(scene.indenter, TRANSIENT_UNITS),
    )  # fmt: skip


def remembers(scene: Scene) -> str:
    """Return why and when an edge re-enters surface that it left; an empty text if it does not."""
    if scene.drive.function is not None:
        return "follows a drive with a velocity or a history only"
    a, tau = StaticState.of(scene).half_length, scene.foundation.retardation_time
    for (before, fast), (after, slow) in pairwise(scene.drive.points):
        if abs(slow) >= abs(fast) and fast * slow >= 0.0:
            continue
        l_r = abs(slow) * tau
        rate = math.inf if before == after else (abs(fast) - abs(slow)) / (after - before)
        if fast * slow <= 0.0 or tau * rate * (1.0 - l_r / math.hypot(a, l_r)) > abs(slow):
            return (
                "holds while no edge re-enters surface that it left earlier: the drive slows down too fast, "
                f"stops or reverses before t = {after:.6g} s"
            )
    return ""


def _forces(scene: Scene, units: StaticState, l_r: Array, nodes: int) -> tuple[Array, Array]:
    """Return normal and friction force: sums of -h' p and p over strips (fact F11), for V >= 0."""
    R, stretch = scene.indenter.radius, scene.indenter.stretch  # type: ignore[union-attr]
    place, weight = (each[nodes // 2 :] for each in leggauss(nodes))
    t, w = 0.5 * np.pi * place, np.pi * weight
    A = units.half_length * np.cos(t)
    l = l_r[:, None]
    right = A * trailing_edge_ratio(l / A)
    sums = [(right**n - (-A) ** n) / n for n in range(1, 5)]
    strips = 0.5 * w * 2.0 * units.half_length * stretch * np.cos(t)
    bent = 0.5 * scene.foundation.stiffness / R
    load = bent * ((A * A * sums[0] - sums[2] - 2.0 * l * sums[1]) @ strips)
    friction = bent / R * ((sums[3] + 2.0 * l * sums[2] - A * A * sums[1]) @ strips)
    return load, friction
