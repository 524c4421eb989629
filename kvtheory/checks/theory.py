"""What theory says at the times of a series, the rest before t = 0 included.

The transient and the steady state come in as functions, so that this package holds two things against
each other without being a part of either.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results.table import scales
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]
Curves = Mapping[str, Array]

CURVES = (
    *("velocity", "depth", "depth_rate", "normal_force", "friction_force"),
    *("leading_edge", "trailing_edge", "peak_pressure"),
)


NO_VELOCITY = 1e-9
"""In units of a_0/tau: a slower drive does not move."""


@dataclass(frozen=True)
class Rates:
    """The two rates of F12 near steady sliding, as times in s; they are complex if it oscillates.

    `stiffness` is dF_z/d(depth) with the spring, K A + k_s, and `damping` is dF_z/d(rate), C B, with
    A = sqrt(a^2 + l_r^2) + a and B = x_TE + a.
    """

    fast: complex
    slow: complex
    stiffness: float
    damping: float

    @property
    def oscillates(self) -> bool:
        """Whether the indenter swings about its steady depth."""
        return self.slow.imag != 0.0


@dataclass(frozen=True)
class Theory:
    """A scene and the methods that solve it: `transient` and `steady` as users call them."""

    scene: Scene
    transient: Callable[..., Any]
    steady: Callable[..., Any]

    @cached_property
    def static(self) -> StaticState:
        """The scene at rest, and its numbers."""
        return StaticState.of(self.scene)

    @cached_property
    def scales(self) -> Mapping[str, float]:
        """What a difference is compared with: the static state, and its products."""
        slowest = NO_VELOCITY * self.static.velocity
        return {**scales(self.static), "velocity": max(self.top_speed, slowest)}

    @cached_property
    def top_speed(self) -> float:
        """The largest |V| of the drive, in m/s."""
        drive, end = self.scene.drive, self.scene.run.duration
        return drive.motion(end, self.static.velocity).highest_speed

    @cached_property
    def steady_state(self) -> Any:
        """Steady sliding at the last velocity."""
        return self.steady(self.scene)

    @cached_property
    def rates(self) -> Rates | None:
        """The rates at the steady state; None if the indenter cannot move."""
        support, foundation = self.scene.support, self.scene.foundation
        if self.scene.held:
            return None
        state = self.steady_state
        a, l_r = (
            state.half_length,
            abs(self.scene.drive.final_velocity) * foundation.retardation_time,
        )
        x_te = a * a / (l_r + math.hypot(a, l_r))
        spring = support.spring
        stiffness = foundation.stiffness * (math.hypot(a, l_r) + a) + spring
        damping = foundation.damping * (x_te + a)
        root = complex(damping * damping - 4.0 * support.mass * stiffness) ** 0.5
        return Rates(2.0 * support.mass / (damping + root), (damping + root) / (2.0 * stiffness),
                     stiffness, damping)  # fmt: skip

    def at(self, times: Array, rtol: float = 1e-6) -> dict[str, Array]:
        """Return the curves at `times` (s): at rest before t = 0, just after a jump of the drive."""
        moving = np.maximum(times, 0.0)
        unique, index = np.unique(moving, return_inverse=True)
        end = float(unique[-1]) or self.scene.run.duration
        scene = replace(self.scene, run=replace(self.scene.run, duration=end))
        result = self.transient(scene, at=unique.tolist(), rtol=rtol)
        rest = self.rest
        return {
            name: np.where(times < 0.0, rest[name], np.asarray(getattr(result, name))[index])
            for name in CURVES
        }

    @cached_property
    def rest(self) -> Mapping[str, float]:
        """The state before t = 0."""
        depth, half = self.static.depth, self.static.half_length
        return {
            "velocity": 0.0,
            "depth": depth,
            "depth_rate": 0.0,
            "normal_force": self.static.load,
            "friction_force": 0.0,
            "leading_edge": -half,
            "trailing_edge": half,
            "peak_pressure": self.scene.foundation.stiffness * depth,
        }
