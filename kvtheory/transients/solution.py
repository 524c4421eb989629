"""The transient of a scene in SI: the scaled solution of `continuum`, put back into units."""

import math
from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from numpy.typing import ArrayLike, NDArray

from kvtheory.results import TRANSIENT_UNITS, Certificate, Event, Transient
from kvtheory.scene.model import Fixed, Scene
from kvtheory.scene.numbers import dimensionless_numbers
from kvtheory.transients.continuum import Motion, solve
from kvtheory.transients.drive import Drive
from kvtheory.transients.energy import Ledger, ledger
from kvtheory.transients.surface import height

Array = NDArray[np.float64]

COARSER = 30.0
"""The error is estimated by a second solution whose tolerance is this many times larger ..."""
MARGIN = 2.0
"""... and the difference is multiplied by this, in case that solution is hardly worse."""

LOOSEST = 1e-4
"""Looser tolerances save no more steps."""

SUBDIVISIONS = 4
"""Points shown for each step of the solver, which is long where nothing happens."""

FORCE_DEGREE = 16
"""Of the polynomial through a force on one step: twice that of the depth, for a force is not one."""
AFTER_END = 1e-12
"""Share of the run by which a time may lie after its end, from rounding."""
SAME_FORCE = 1e-10
"""Relative; of forces as equal as this, as in steady sliding, the first is the largest."""


@dataclass(frozen=True)
class Scales:
    """Units of the scaled form: a_0, delta_0, tau, W_0 and W_0 delta_0/a_0."""

    length: float
    depth: float
    time: float
    load: float

    @property
    def friction(self) -> float:
        """W_0 delta_0/a_0, in N/m."""
        return self.load * self.depth / self.length

    @property
    def energy(self) -> float:
        """W_0 delta_0, in J/m."""
        return self.load * self.depth


def scales(scene: Scene) -> Scales:
    """Return the scales of a scene with a parabolic indenter."""
    numbers = dimensionless_numbers(scene)
    return Scales(
        numbers["static_half_length"],
        numbers["static_depth"],
        scene.foundation.retardation_time,
        numbers["static_load"],
    )


def scaled_drive(scene: Scene, units: Scales) -> Drive:
    """Return the drive number over scaled time until the end of the run."""
    per_velocity = units.time / units.length
    end = scene.run.duration / units.time
    drive = scene.drive
    points = drive.history or [(0.0, drive.final_velocity)]
    return Drive.from_points([(t / units.time, v * per_velocity) for t, v in points], end)


@dataclass(frozen=True)
class Solution:
    """A solved motion and its scales; evaluates every quantity of a transient in SI."""

    motion: Motion
    drive: Drive
    units: Scales
    stiffness: float

    @cached_property
    def natural_times(self) -> Array:
        """Times (s) at which the series shows all that happens: the solver's steps, subdivided."""
        ends = np.append(np.array(self.motion.starts), self.motion.end)
        parts = np.arange(SUBDIVISIONS) / SUBDIVISIONS
        inner = (ends[:-1, None] + np.diff(ends)[:, None] * parts).reshape(-1)
        return np.unique(np.append(inner, self.motion.end)) * self.units.time

    def series(self, time: ArrayLike) -> dict[str, Any]:
        """Return the quantities and states at the given times (s)."""
        scaled = np.minimum(np.asarray(time, dtype=float) / self.units.time, self.motion.end)
        moments = [self.motion.at(float(s)) for s in scaled]
        numbers = np.array([self.drive.at(float(s))[1] for s in scaled])
        forward = _forward(numbers)
        u = self.units

        def column(name: str) -> Array:
            return np.array([getattr(moment, name) for moment in moments])

        left, right = column("left"), column("right")
        depth, rate = column("depth"), column("rate")
        xi = np.clip(-numbers, left, right)
        peak = depth + rate - xi * (xi + 2.0 * numbers)
        states = [(m.left_state, m.right_state) for m in moments]
        return {
            "time": np.asarray(time, dtype=float),
            "velocity": numbers * u.length / u.time,
            "depth": depth * u.depth,
            "depth_rate": rate * u.depth / u.time,
            "normal_force": column("normal_force") * u.load,
            "friction_force": column("friction_force") * u.friction,
            "leading_edge": np.where(forward, left, right) * u.length,
            "trailing_edge": np.where(forward, right, left) * u.length,
            "peak_pressure": np.nan_to_num(peak) * self.stiffness * u.depth,
            "leading_state": tuple(
                a if f else b for (a, b), f in zip(states, forward, strict=True)
            ),
            "trailing_state": tuple(
                b if f else a for (a, b), f in zip(states, forward, strict=True)
            ),
        }

    def pressure(self, x: ArrayLike, time: float) -> Array:
        """Return p in Pa at the positions `x` (m): K (d + d' - xi^2 - 2 lambda xi) in the contact."""
        s = self._scaled(time)
        moment, number = self.motion.at(s), self.drive.at(s)[1]
        xi = np.asarray(x, dtype=float) / self.units.length
        p = moment.depth + moment.rate - xi * (xi + 2.0 * number)
        inside = (moment.left <= xi) & (xi <= moment.right)  # false in flight, where both are NaN
        return np.where(inside, np.maximum(p, 0.0), 0.0) * self.stiffness * self.units.depth

    def surface(self, x: ArrayLike, time: float) -> Array:
        """Return the compression u in m of the foundation at the positions `x` (m)."""
        xi = np.asarray(x, dtype=float) / self.units.length
        return height(self.motion, xi, self._scaled(time)) * self.units.depth

    def energy(self, time: ArrayLike) -> Ledger:
        """Return the energy ledger in J/m at the times (s)."""
        return ledger(self.motion, self._scaled(time)).scaled(self.units.energy)

    def _scaled(self, time: Any) -> Any:
        """Return times in units of tau; those after the end by no more than rounding are the end."""
        s, end = np.asarray(time, dtype=float) / self.units.time, self.motion.end
        if not np.all((s >= 0.0) & (s <= end * (1.0 + AFTER_END))):
            raise ValueError(f"`time` must lie in [0, {end * self.units.time!r}] s, got {time!r}")
        return np.minimum(s, end)[()]


def force_maxima(motion: Motion) -> tuple[float, float]:
    """Return when f_z and |f_x| are largest: the first time of the largest value from s = 0 on.

    It is an end of a step, before or after a jump there, or a stationary point of the polynomial
    through the force on the step; on steps whose samples come near enough to the largest.
    """
    ends = [math.nextafter(s, 0.0) for s in motion.starts[1:]] + [motion.end]
    steps = np.array([motion.starts, ends]).T
    parts = np.linspace(0.0, 1.0, SUBDIVISIONS + 1)
    samples = np.array([[_forces(motion, a + (b - a) * t) for t in parts] for a, b in steps])
    largest, least = samples.max(axis=1), samples.min(axis=1)
    enough = (1.0 - SAME_FORCE) * largest.max(axis=0)
    near = np.any(2.0 * largest - least >= enough, axis=1)
    times = [s for a, b in steps[near].tolist() for s in (a, *_turns(motion, a, b), b)]
    forces = np.array([_forces(motion, s) for s in times])
    first = np.argmax(forces >= (1.0 - SAME_FORCE) * forces.max(axis=0), axis=0)
    normal, friction = (times[int(k)] for k in first)
    return normal, friction


def _turns(motion: Motion, a: float, b: float) -> list[float]:
    """Return the times within one step at which a force is stationary.

    The variable x is one in which the square roots that an edge begins or ends with are smooth.
    """
    x = 0.5 - 0.5 * np.cos(np.pi * (np.arange(FORCE_DEGREE + 1) + 0.5) / (FORCE_DEGREE + 1))
    forces = [_forces(motion, a + (b - a) * t * t * (3.0 - 2.0 * t)) for t in x.tolist()]
    found: list[float] = []
    for samples in zip(*forces, strict=True):
        slope = Chebyshev.fit(x, samples, FORCE_DEGREE, [0.0, 1.0]).deriv()
        roots = np.asarray(slope.roots(), dtype=complex)
        inside = (roots.imag == 0.0) & (roots.real > 0.0) & (roots.real < 1.0)
        found += [a + (b - a) * t * t * (3.0 - 2.0 * t) for t in roots.real[inside].tolist()]
    return sorted(found)


def _forces(motion: Motion, s: float) -> tuple[float, float]:
    now = motion.at(s)
    return now.normal_force, abs(now.friction_force)


def transient(scene: Scene, times: ArrayLike | None, rtol: float) -> Transient:
    """Solve a scene; `kvtheory.transient` documents it."""
    units = scales(scene)
    drive = scaled_drive(scene, units)
    rtol = min(rtol, LOOSEST)
    fine, coarse = (
        _solution(scene, units, drive, tolerance) for tolerance in (rtol, COARSER * rtol)
    )
    time = fine.natural_times if times is None else np.asarray(times, dtype=float).reshape(-1)
    series = fine.series(time)
    certificate = Certificate(
        "estimated",
        f"{MARGIN:g} times the largest difference to a solution with {COARSER:g} times the tolerance, "
        "relative to the static depth, half length and load",
        _differences(series, coarse.series(time), units, fine.stiffness),
    )
    kinds = ("normal force maximum", "friction force maximum")
    found = [*fine.motion.events, *zip(force_maxima(fine.motion), kinds, strict=True)]
    events = tuple(Event(s * units.time, kind) for s, kind in sorted(found, key=itemgetter(0)))
    steps, evaluations = fine.motion.steps, fine.motion.evaluations
    return Transient(
        **series, events=events, steps=steps, evaluations=evaluations,
        model="continuum", certificate=certificate, solution=fine,
    )  # fmt: skip


def _solution(scene: Scene, units: Scales, drive: Drive, rtol: float) -> Solution:
    numbers = dimensionless_numbers(scene)
    fixed = isinstance(scene.support, Fixed)
    motion = solve(
        drive,
        numbers.get("inertia_number", 1.0),
        math.inf if fixed else numbers["support_number"],
        drive.end,
        rtol,
    )
    return Solution(motion, drive, units, scene.foundation.stiffness)


def _forward(numbers: Array) -> NDArray[np.bool_]:
    """Whether the left edge leads; at rest, as it did before."""
    moving = np.where(numbers == 0.0, np.nan, numbers)
    known = np.maximum.accumulate(np.where(np.isnan(moving), 0, np.arange(numbers.size)))
    return ~(numbers[known] < 0.0)


def _differences(fine: Any, coarse: Any, units: Scales, stiffness: float) -> dict[str, float]:
    scale = {
        "time": units.time,
        "velocity": units.length / units.time,
        "depth": units.depth,
        "depth_rate": units.depth / units.time,
        "normal_force": units.load,
        "friction_force": units.friction,
        "leading_edge": units.length,
        "trailing_edge": units.length,
        "peak_pressure": stiffness * units.depth,
    }
    return {
        name: MARGIN
        * float(np.nanmax(np.abs(fine[name] - coarse[name]), initial=0.0))
        / scale[name]
        for name in TRANSIENT_UNITS
    }
