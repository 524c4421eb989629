"""How a motion starts: in the air, at another depth than at rest, or with a velocity of its own."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.mistakes import Problems
from kvtheory.scene.quantities import Part, Value, given, quantity, validate

ANY: dict[str, Any] = {"minimum": -math.inf, "default": None}
VERTICAL = "gap", "depth", "depth_rate"
"""The quantities of a start that a fixed indenter has not."""


class StartState(NamedTuple):
    """Depth, its rate, the velocity of the indenter along x and its place there, just after t = 0."""

    depth: float
    rate: float
    along_rate: float
    along: float = 0.0


@dataclass(frozen=True, eq=False)
class Start(Part):
    """The motion just after t = 0; what is not given is as at rest: at the static depth, without velocity.

    Up to t = 0 the base stands still and the foundation is in equilibrium. With a `depth`, the indenter
    has been held there since ever, under the static pressure K (depth - h), and is then let go. With a
    `gap`, the surface is flat, and the lowest point of the indenter is that far above it.

    `depth_rate` is positive downward. `sliding_velocity` is that of the base under an indenter on a spring,
    which is relaxed at t = 0: without it, that of the drive, whose base is set in motion under an indenter
    that stands still; with 0, indenter and base stand still against each other, and the far end of the
    spring is drawn.

    >>> Start(gap="5 mm").at(static_depth=1e-4, velocity=0.1)
    StartState(depth=-0.005, rate=0.0, along_rate=0.0, along=0.0)
    >>> Start(sliding_velocity="0 m/s").at(static_depth=1e-4, velocity=0.1)
    StartState(depth=0.0001, rate=0.0, along_rate=0.1, along=0.0)
    """

    gap: Value = quantity(
        "m", "gap between the indenter and the flat surface, instead of a depth", exclusive=False,
        default=None, excludes=("depth",),
    )  # fmt: skip
    depth: Value = quantity(
        "m", "depth at which the indenter was held until t = 0", default=None, excludes=("gap",)
    )
    depth_rate: Value = quantity("m/s", "rate of the depth at t = 0, downward", **ANY)
    sliding_velocity: Value = quantity(
        "m/s", "velocity of the base under an indenter on a spring at t = 0", **ANY
    )

    def __post_init__(self) -> None:
        validate(self, "start")

    @property
    def at_rest(self) -> bool:
        """Whether the motion starts at rest at the static depth."""
        return not given(self)

    def at(self, static_depth: float, velocity: float) -> StartState:
        """Return the state just after t = 0, when the drive has this `velocity` (m/s)."""
        depth = static_depth if self.depth is None else self.depth
        sliding = velocity if self.sliding_velocity is None else self.sliding_velocity
        return StartState(
            depth if self.gap is None else -self.gap, self.depth_rate or 0.0, velocity - sliding
        )

    def of(self, motion: BaseMotion, static_depth: float) -> StartState:
        """Return the state just after t = 0 on a `Scene.motion`, whose depth may be given."""
        found = self.at(static_depth, motion.velocity(0.0))
        return StartState(*motion.depths[0], found.along_rate) if motion.depths else found

    def landing_speed(self, support: Any, static_depth: float) -> float:
        """Return the speed (m/s) at which an indenter of this mass, weight and spring lands from its gap."""
        gap, rate = self.gap or 0.0, self.depth_rate or 0.0
        pull = support.weight + support.spring * (static_depth + 0.5 * gap)
        return math.sqrt(rate * rate + 2.0 * gap * pull / support.mass)


@dataclass(frozen=True, eq=False)
class Drawn(Start):
    """A start with the spring in the drive drawn by `along` (m), from which the search for a cycle begins."""

    along: float = 0.0

    def at(self, static_depth: float, velocity: float) -> StartState:
        """Return the state just after t = 0, when the drive has this `velocity` (m/s)."""
        return super().at(static_depth, velocity)._replace(along=self.along)


REST = Start()
"""At rest at the static depth."""


def misplaced(parts: Mapping[str, Any]) -> Problems:
    """Report what a start cannot have: a fixed indenter no depth of its own, a rigid drive no velocity."""
    found = Problems()
    start, support, drive = parts.get("start"), parts.get("support"), parts.get("drive")
    for name in () if start is None else given(start):
        if name in VERTICAL and support is not None and support.depth is not None:
            message = f'cannot be given with support.kind = "{support.kind}", which holds the depth'
        elif name == "sliding_velocity" and drive is not None and drive.rigid:
            message = "needs drive.stiffness: on a rigid drive it is the velocity of the drive"
        else:
            continue
        found.add(f"start.{name}", getattr(start, name), message)
    return found
