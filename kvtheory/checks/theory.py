"""Theory at the times of a series, including the rest before t = 0.

The solvers are passed in as functions (`Methods`), so that this package depends on none of them.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.results.table import QUANTITIES, SERIES_UNITS, units_for
from kvtheory.scene import Drive, Sphere
from kvtheory.scene.model import Fixed, Scene
from kvtheory.scene.start import REST, StartState
from kvtheory.scene.static_state import StaticState
from kvtheory.theory.closed_forms import trailing_edge_ratio

Array = NDArray[np.float64]
Curves = Mapping[str, Array]

CURVES = tuple(name for name in SERIES_UNITS if name != "time")
"""The curves of a series. With a rigid drive the sliding velocity is V, and the spring force the friction."""
TRIAL_RTOL = 1e-5
"""Tolerance of the theory in the trials of a diagnosis."""
DECAYED, LONGEST = 40.0, 1e9
"""Time constants after which a change has decayed, and beyond which a series is refused."""
MOST_RUNS = 10.0
"""Longest series where theory is a simulation by elements, in durations of the run."""
SHALLOWEST = 1e-3
"""Depth that stands for that of a vanishing contact, in static depths."""
NO_VELOCITY, SLOPE = 1e-9, 1e-3
"""Smallest scale of the velocity, in a_0/tau; and change of a depth for slopes, relative to it."""


def curves(found: Mapping[str, Any], scene: Scene) -> dict[str, Array]:
    """Return every curve of a solution, including those of a spring for a rigid drive."""
    if scene.drive.rigid:
        along = {"sliding_velocity": found["velocity"], "spring_force": found["friction_force"]}
        found = {**found, **along}
    return {name: np.asarray(found[name]) for name in CURVES}


class Methods(NamedTuple):
    """The functions that solve a scene; `tell` reports progress: the fraction done, and a text.

    `transient` returns curves by name for a scene, increasing times (s) and a tolerance, `steady` exact
    steady sliding, `rates` the rates (1/s) of small motions about it for a scene on a spring.
    """

    transient: Callable[[Scene, Sequence[float], float], Mapping[str, Any]]
    steady: Callable[[Scene], Any]
    rates: Callable[[Scene], NDArray[np.complex128]]
    tell: Callable[[float, str], object] = lambda _share, _words: None


class Rates(NamedTuple):
    """Shortest and longest time constant (s) near steady sliding (F12, F22); that of the last decay.

    `oscillation` is the complex time constant of the fastest oscillation, or None.
    """

    fast: complex
    slow: complex
    settling: float
    oscillation: complex | None

    @classmethod
    def of(cls, time_constants: Sequence[complex]) -> "Rates":
        """Return those of all time constants T, of motions in proportion to exp(-t/T)."""
        fast, *_, slow = sorted(time_constants, key=abs)
        slowest = min((1.0 / T).real for T in time_constants)
        turning = [T for T in time_constants if T.imag]
        settling = 1.0 / slowest if slowest > 0.0 else math.inf
        return cls(fast, slow, settling, min(turning, key=abs, default=None))


class Theory:
    """A scene and the methods that solve it.

    `static` is the scene at rest, `radius` is R in m, `units` are the SI units of the curves, and
    `last_change` is the time in s after which the drive keeps its velocity, infinite if it need not, and a
    fixed indenter its depth; `jumps` are the times at which a velocity jumps, of the base or of the depth.
    `by_elements` says whether the transient is computed with elements: for a ball, and on arms.
    """

    def __init__(self, scene: Scene, methods: Methods) -> None:
        self.scene, self.methods = scene, methods
        self.static = StaticState.of(scene)
        self.radius = float(scene.indenter.radius)  # type: ignore[union-attr]
        self.units = units_for(scene.indenter, SERIES_UNITS)
        self.by_elements = bool(scene.foundation.arms) or not scene.indenter.per_width
        kinks = [time for time, _ in scene.depths]
        self.last_change = max([scene.drive.last_change if scene.drive.ends else math.inf, *kinks])
        self.jumps = tuple(sorted({*scene.drive.jumps, *kinks}))
        self._known: dict[tuple[float, bytes], dict[str, Array]] = {}

    @cached_property
    def scales(self) -> Mapping[str, float]:
        """The scales of differences: the static state, and its products."""
        speed = max(self.motion.highest_speed, NO_VELOCITY * self.static.velocity)
        scales = {name: getattr(self.static, QUANTITIES[name].scale) for name in SERIES_UNITS}
        return {**scales, "velocity": speed, "sliding_velocity": speed}

    def width(self, depth: Any) -> Any:
        """Return the mean width of a contact (m) at depths: 1 for a line contact, which is per unit width.

        Strips of a ball are as long and as steep as the middle plane times sqrt(1 - y^2/b^2), at rest and in
        fast sliding, and nearly so between: their mean width is (pi/4) 2 b, b = sqrt(2 R' delta).
        """
        indenter, static = self.scene.indenter, self.static
        if not isinstance(indenter, Sphere):
            return 1.0
        kept = np.maximum(depth, SHALLOWEST * static.depth) / static.depth
        return 0.5 * math.pi * static.half_length * indenter.stretch * np.sqrt(kept)

    def stiffness(self, depth: Any, a: Any, l_r: Any) -> Any:
        """Return the stiffness of a contact, K A + k_s with A = sqrt(a^2 + l_r^2) + a (F12)."""
        K, k_s = self.scene.foundation.stiffness, self.scene.support.spring
        return K * self.width(depth) * (np.hypot(a, l_r) + a) + k_s

    def damping(self, duration: Any) -> Any:
        """Return C, and of arms their stress after a duration (s) over the rate of compression."""
        foundation = self.scene.foundation
        times = [(arm.stiffness, arm.relaxation_time) for arm in foundation.arms]
        return sum((-K * tau * np.expm1(-duration / tau) for K, tau in times), foundation.damping)

    @cached_property
    def motion(self) -> Any:
        """V(t) and Y(t) until the end of the run."""
        return self.scene.motion(self.scene.run.duration, self.static.velocity)

    @property
    def begun(self) -> StartState:
        """The state just after t = 0."""
        return self.scene.start.of(self.motion, self.static.depth)

    @property
    def final_velocity(self) -> float:
        """The velocity in m/s at the end of the run."""
        return float(self.motion.velocity(self.motion.end))

    @cached_property
    def swing(self) -> float:
        """The period of the mass on the spring of the drive over 2 pi, in s; infinite without one."""
        stiffness = float(self.scene.drive.stiffness or 0.0)
        return math.sqrt(self.scene.drive_mass / stiffness) if stiffness else math.inf

    @cached_property
    def steady_state(self) -> Any:
        """Steady sliding at the last velocity and given depth."""
        support = Fixed(self.scene.depths[-1][1]) if self.scene.depths else self.scene.support
        drive = Drive(self.final_velocity)
        return self.methods.steady(replace(self.scene, support=support, drive=drive, start=REST))

    @cached_property
    def slopes(self) -> tuple[float, float]:
        """The slopes of F_z and of the magnitude of F_x by the depth in steady sliding, in N/m per m."""
        depths = float(self.steady_state.depth) * np.array([1.0 - SLOPE, 1.0 + SLOPE])
        drive = Drive(self.final_velocity)
        there = replace(self.scene, support=Fixed(depths), drive=drive, start=REST)
        state, span = self.methods.steady(there), depths[1] - depths[0]
        forces = state.load, np.abs(state.friction_force)
        K_z, K_x = (float(np.diff(force)[0] / span) for force in forces)
        return K_z, K_x

    @cached_property
    def rates(self) -> Rates | None:
        """The time constants at the steady state; None if the indenter cannot move.

        Those of F22, or with a rigid drive of M s^2 + C B s + K A + k_s = 0, B = x_TE + a (F12). On arms
        the contact, of length L, acts on M as if it kept its elements, M s^2 + k_s + L (K + sum K_i tau_i s/
        (1 + tau_i s)) = 0; a decay takes no longer than elements do to pass. These and those of a ball are
        approximate; they only set windows and allowances.
        """
        M = self.scene.support.mass
        if self.scene.drive.stiffness:
            steady = self.scene.drive.changed(velocity=self.final_velocity)
            rates = self.methods.rates(replace(self.scene, drive=steady))
            return Rates.of((-1.0 / rates[rates != 0.0]).tolist())
        if self.scene.held:
            return None
        state = self.steady_state
        if arms := self.scene.foundation.arms:
            length = abs(state.trailing_edge - state.leading_edge)
            extent, law = float(self.width(state.depth)) * length, self.scene.foundation
            stiffness = self.scene.support.spring + extent * law.stiffness
            terms, product = np.poly1d([M, extent * law.damping, stiffness]), np.poly1d([1.0])
            for arm in arms:
                relaxes = np.poly1d([arm.relaxation_time, 1.0])
                damps = np.poly1d([extent * arm.stiffness * arm.relaxation_time, 0.0])
                terms, product = terms * relaxes + product * damps, product * relaxes
            passing = length / abs(self.final_velocity) if self.final_velocity else math.inf
            constants = (-1.0 / terms.roots.astype(complex)).tolist()
            return Rates.of(
                [T if T.imag or T.real < passing else complex(passing) for T in constants]
            )
        a, l_r = state.half_length, state.retardation_length
        stiffness = float(self.stiffness(state.depth, a, l_r))
        extent = float(self.width(state.depth)) * a * (trailing_edge_ratio(l_r / a) + 1.0)
        damping = self.scene.foundation.slow_damping * extent
        root = complex(damping * damping - 4.0 * M * stiffness) ** 0.5
        return Rates.of([2.0 * M / (damping + root), (damping + root) / (2.0 * stiffness)])

    def at(self, times: Array, rtol: float = 1e-6) -> dict[str, Array]:
        """Return the curves at `times` (s): held as at the start before, just after a jump of the drive."""
        key = rtol, times.tobytes()
        if key in self._known:
            return self._known[key]
        moving = np.clip(times, 0.0, self._settled(float(times.max())))
        unique, index = np.unique(moving, return_inverse=True)
        end = float(unique[-1]) or self.scene.run.duration
        scene = replace(self.scene, run=replace(self.scene.run, duration=end))
        found = curves(self.methods.transient(scene, unique.tolist(), rtol), scene)
        depth = self.begun.depth
        deeper = max(depth, 0.0) / self.static.depth
        power = 1.5 if self.scene.indenter.per_width else 2.0
        half_length = self.static.half_length * math.sqrt(deeper) if deeper else math.nan
        rest = {
            **dict.fromkeys(CURVES, 0.0),
            "depth": depth, "normal_force": self.static.load * deeper**power,
            "leading_edge": -half_length, "trailing_edge": half_length,
            "peak_pressure": self.static.pressure * deeper,
        }  # fmt: skip
        self._known[key] = {
            name: np.where(times < 0.0, rest[name], found[name][index]) for name in CURVES
        }
        return self._known[key]

    def _settled(self, end: float) -> float:
        """Return the time in s after which nothing changes, or `end`; on a spring there may be none."""
        foundation, run = self.scene.foundation, self.scene.run.duration
        if self.by_elements and end > MOST_RUNS * run:
            raise ArithmeticError(f"that is {end / run:.3g} times run.duration")
        slow = foundation.retardation_time
        if foundation.arms:  # no retardation takes longer than this
            slow += max(arm.relaxation_time for arm in foundation.arms)
        if end > LONGEST * slow:
            raise ArithmeticError(f"that is after {end / slow:.3g} retardation times")
        if end <= self.last_change + DECAYED * slow or not self.scene.drive.rigid:
            return end
        if self.rates is not None:
            slow = max(slow, self.rates.settling)
        return min(end, self.last_change + DECAYED * slow)
