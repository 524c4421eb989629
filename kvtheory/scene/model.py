"""What is modelled: an indenter on a Kelvin-Voigt foundation, its support and its drive.

Every field accepts SI numbers, text with a unit (``"10 mm"``) and pint quantities, and holds an SI
float afterwards.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from kvtheory.scene.drives import Drive
from kvtheory.scene.indenters import Indenter, Parabola
from kvtheory.scene.quantities import (
    SceneError,
    nearest,
    problem,
    quantities,
    quantity,
    settle,
)

STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class Foundation:
    """Independent Kelvin-Voigt elements: stiffness K and damping C = K tau, both per unit area."""

    stiffness: float = quantity("N/m^3", "K, stiffness of the foundation per unit area")
    retardation_time: float = quantity(
        "s", "tau = C/K, retardation time of the foundation (Eq. 22)"
    )

    def __post_init__(self) -> None:
        settle(self, "foundation")

    @property
    def damping(self) -> float:
        """C = K tau, damping per unit area, in N s/m^3 (Eq. 22)."""
        return self.stiffness * self.retardation_time


@dataclass(frozen=True)
class Fixed:
    """The indenter cannot move (the paper's FI model): a constant depth is given."""

    kind: ClassVar[str] = "fixed"
    mass: ClassVar[float] = math.inf
    weight: ClassVar[float] = 0.0
    spring: ClassVar[float] = math.inf
    depth: float = quantity("m", "delta, indentation depth, held constant")

    def __post_init__(self) -> None:
        settle(self, "support")


@dataclass(frozen=True)
class DeadWeight:
    """The indenter moves freely up and down under its weight (the paper's MI model, Eq. 17)."""

    kind: ClassVar[str] = "dead-weight"
    spring: ClassVar[float] = 0.0
    depth: ClassVar[None] = None
    mass: float = quantity("kg/m", "M, mass of the indenter per unit width")
    gravity: float = quantity("m/s^2", "g, gravity", default=STANDARD_GRAVITY)

    def __post_init__(self) -> None:
        settle(self, "support")

    @property
    def weight(self) -> float:
        """M g, in N/m."""
        return self.mass * self.gravity


@dataclass(frozen=True)
class Suspended:
    """A dead weight on a spring that is relaxed at the static depth."""

    kind: ClassVar[str] = "suspended"
    depth: ClassVar[None] = None
    mass: float = quantity("kg/m", "M, mass of the indenter per unit width")
    stiffness: float = quantity("N/m^2", "k_s, stiffness of the suspension per unit width")
    gravity: float = quantity("m/s^2", "g, gravity", default=STANDARD_GRAVITY)

    def __post_init__(self) -> None:
        settle(self, "support")

    @property
    def weight(self) -> float:
        """M g, in N/m."""
        return self.mass * self.gravity

    @property
    def spring(self) -> float:
        """k_s, in N/m^2."""
        return self.stiffness


Support = Fixed | DeadWeight | Suspended
"""Each answers for `mass` (kg/m), `weight` (N/m) and `spring` (N/m^2) that act on its motion, and for the
`depth` (m) at which it is held: mass and spring of a fixed one are infinite, a moving one has no depth."""
SUPPORTS: dict[str, Any] = {cls.kind: cls for cls in (Fixed, DeadWeight, Suspended)}


@dataclass(frozen=True)
class Run:
    """How long the transient is followed."""

    duration: float = quantity("s", "time to follow the transient", default=0.2)

    def __post_init__(self) -> None:
        settle(self, "run")


@dataclass(frozen=True)
class Scene:
    """An indenter, a foundation, a support and a drive; without arguments, the paper's Table 1.

    Examples
    --------
    >>> scene = Scene(drive=Drive(velocity="50 mm/s"))
    >>> scene.drive.velocity
    0.05
    >>> scene.foundation.stiffness
    10000000000.0
    >>> Scene.table1("fixed").support
    Fixed(depth=0.0003)
    """

    indenter: Indenter = Parabola(radius=0.01)
    foundation: Foundation = Foundation(stiffness=1e10, retardation_time=0.1)
    support: Support = DeadWeight(mass=1000.0)
    drive: Drive = Drive(velocity=0.1)
    run: Run = Run()

    def __post_init__(self) -> None:
        parts: dict[str, Any] = {
            "indenter": Indenter, "foundation": Foundation, "support": Support, "drive": Drive, "run": Run,
        }  # fmt: skip
        problems = [
            problem(
                name,
                getattr(self, name),
                f"expected {getattr(kind, '__name__', 'one of ' + str(kind))}",
            )
            for name, kind in parts.items()
            if not isinstance(getattr(self, name), kind)
        ]
        if problems:
            raise SceneError(problems)

    @property
    def held(self) -> bool:
        """Whether the support holds the indenter at its depth, so that it cannot move."""
        return math.isinf(self.support.spring)

    @classmethod
    def table1(cls, support: str = "dead-weight") -> "Scene":
        """Return the standard scene of Table 1 with one of its supports.

        The paper has no suspended indenter; its spring here, 30 MN/m^2, is about as stiff as the
        foundation under the indenter.
        """
        if support not in TABLE1_SUPPORTS:
            raise ValueError(f'`support` = "{support}": {nearest(support, TABLE1_SUPPORTS)}')
        return cls(support=TABLE1_SUPPORTS[support])

    def values(self) -> Mapping[str, float]:
        """Return every quantity of the scene in SI by its dotted key, as ``"drive.velocity"``.

        A drive that is a function has no velocity to give.
        """
        parts = {"indenter": self.indenter, "foundation": self.foundation, "support": self.support}
        flat = {
            f"{section}.{name}": getattr(part, name)
            for section, part in parts.items()
            for name in quantities(part)
        }
        if not self.drive.ends:
            return flat
        return {**flat, "drive.velocity": self.drive.final_velocity}


TABLE1_SUPPORTS: dict[str, Support] = {
    "fixed": Fixed(depth=3e-4),
    "dead-weight": DeadWeight(mass=1000.0),
    "suspended": Suspended(mass=1000.0, stiffness=3e7),
}
