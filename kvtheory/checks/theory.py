"""What theory says at the times of a series, the rest before t = 0 included.

The transient and the steady state come in as functions, so that this package holds two things against
each other without being a part of either.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.model import Fixed, Scene, Suspended
from kvtheory.scene.numbers import dimensionless_numbers

Array = NDArray[np.float64]
Curves = Mapping[str, Array]

CURVES = (
    *("velocity", "depth", "depth_rate", "normal_force", "friction_force"),
    *("leading_edge", "trailing_edge", "peak_pressure"),
)


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
    def static(self) -> Mapping[str, float]:
        """Depth, half length and load at rest, and the numbers of the scene, in SI."""
        return dimensionless_numbers(self.scene)

    @cached_property
    def scales(self) -> Mapping[str, float]:
        """What a difference is compared with: the static state, and its products."""
        depth, half = self.static["static_depth"], self.static["static_half_length"]
        load, tau = self.static["static_load"], self.scene.foundation.retardation_time
        return {
            "velocity": max(abs(self.top_velocity), half / tau * 1e-9),
            "depth": depth,
            "depth_rate": depth / tau,
            "normal_force": load,
            "friction_force": load * depth / half,
            "leading_edge": half,
            "trailing_edge": half,
            "peak_pressure": self.scene.foundation.stiffness * depth,
        }

    @property
    def top_velocity(self) -> float:
        """The velocity of the largest magnitude in the drive, in m/s."""
        return max((velocity for _, velocity in self.scene.drive.points), key=abs)

    @property
    def jumps(self) -> tuple[float, ...]:
        """The times in s at which the drive jumps."""
        points = self.scene.drive.points
        first = (0.0,) if points[0][1] != 0.0 else ()
        times = [time for time, _ in points]
        return (*first, *(b for a, b in pairwise(times) if a == b))

    @property
    def last_change(self) -> float:
        """The time in s after which the drive keeps its velocity."""
        return self.scene.drive.points[-1][0]

    @cached_property
    def steady_state(self) -> Any:
        """Steady sliding at the last velocity."""
        return self.steady(self.scene)

    @cached_property
    def rates(self) -> Rates | None:
        """The rates at the steady state; None if the indenter cannot move."""
        support, foundation = self.scene.support, self.scene.foundation
        if isinstance(support, Fixed):
            return None
        state = self.steady_state
        a, l_r = (
            state.half_length,
            abs(self.scene.drive.final_velocity) * foundation.retardation_time,
        )
        x_te = a * a / (l_r + math.hypot(a, l_r))
        spring = support.stiffness if isinstance(support, Suspended) else 0.0
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
        depth, half = self.static["static_depth"], self.static["static_half_length"]
        return {
            "velocity": 0.0,
            "depth": depth,
            "depth_rate": 0.0,
            "normal_force": self.static["static_load"],
            "friction_force": 0.0,
            "leading_edge": -half,
            "trailing_edge": half,
            "peak_pressure": self.scene.foundation.stiffness * depth,
        }
