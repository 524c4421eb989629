"""What is modelled: an indenter on a viscoelastic foundation, its support and its drive.

Every field accepts SI numbers, text with a unit (``"10 mm"``) and pint quantities, and holds an SI
float afterwards.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from kvtheory.scene.drives import SPRING, Drive
from kvtheory.scene.foundations import AnyFoundation, Foundation
from kvtheory.scene.indenters import Indenter, Parabola
from kvtheory.scene.quantities import (
    SceneError,
    derive,
    misfits,
    missing,
    nearest,
    problem,
    quantities,
    quantity,
    settle,
)

STANDARD_GRAVITY = 9.80665
LOAD = "W, load instead of mass times gravity; the mass is then inertia alone"


@dataclass(frozen=True)
class Fixed:
    """The indenter cannot move (the paper's FI model): a constant depth is given.

    >>> Fixed(depth="300 um").depth
    0.0003
    """

    kind: ClassVar[str] = "fixed"
    mass: ClassVar[float] = math.inf
    weight: ClassVar[float] = 0.0
    spring: ClassVar[float] = math.inf
    depth: float = quantity("m", "delta, indentation depth, held constant")

    def __post_init__(self) -> None:
        settle(self, "support")


MASS: dict[str, Any] = {"default": None, "needed": True, "instead": "load", "per_width": True}


class _Loaded:
    """The common part of supports with a load: mass times gravity, or a load that is given."""

    mass: float
    gravity: float
    load: float | None

    def __post_init__(self) -> None:
        settle(self, "support")
        if self.load is not None and self.mass is None:
            mass = self.load / self.gravity
            derive(self, "support", "mass", mass, "support.load/support.gravity")

    @property
    def weight(self) -> float:
        """W, in N/m, or in N for a ball: the load, or else M g."""
        return self.mass * self.gravity if self.load is None else self.load


@dataclass(frozen=True)
class DeadWeight(_Loaded):
    """The indenter moves freely up and down under its weight (the paper's MI model, Eq. 17).

    A `load` replaces the weight; the mass is then inertia alone, and load/gravity if not given.

    >>> DeadWeight(load="3 N/mm").mass, DeadWeight(mass="1 kg/mm", load="3 N/mm").weight
    (305.9148638933785, 3000.0)
    """

    kind: ClassVar[str] = "dead-weight"
    spring: ClassVar[float] = 0.0
    depth: ClassVar[None] = None
    mass: float = quantity("kg/m", "M, mass of the indenter", **MASS)
    gravity: float = quantity("m/s^2", "g, gravity", default=STANDARD_GRAVITY)
    load: float | None = quantity("N/m", LOAD, default=None, per_width=True)


@dataclass(frozen=True)
class Suspended(_Loaded):
    """A dead weight on a spring that is relaxed at the static depth; `load` is as for a dead weight.

    M z'' = F_z - W - k_s (z - z_0): k_s -> 0 is `DeadWeight`, k_s -> oo is `Fixed` at the static depth.

    >>> Suspended(load="3 N/mm", stiffness="30 MN/m^2").weight
    3000.0
    """

    kind: ClassVar[str] = "suspended"
    depth: ClassVar[None] = None
    mass: float = quantity("kg/m", "M, mass of the indenter", **MASS)
    stiffness: float = quantity(
        "N/m^2", "k_s, stiffness of the suspension", default=None, needed=True, per_width=True
    )
    gravity: float = quantity("m/s^2", "g, gravity", default=STANDARD_GRAVITY)
    load: float | None = quantity("N/m", LOAD, default=None, per_width=True)

    @property
    def spring(self) -> float:
        """k_s, in N/m^2, or in N/m for a ball."""
        return self.stiffness


Support = Fixed | DeadWeight | Suspended
"""Each has the `mass` (kg/m), `weight` (N/m) and `spring` (N/m^2) of its equation of motion, and the
`depth` (m) at which it is held: mass and spring of a fixed one are infinite, a moving one has no depth.
For a ball these are in kg, N and N/m."""
SUPPORTS: dict[str, Any] = {cls.kind: cls for cls in (Fixed, DeadWeight, Suspended)}


@dataclass(frozen=True)
class Run:
    """The duration of the transient."""

    duration: float = quantity("s", "duration of the transient", default=0.2)

    def __post_init__(self) -> None:
        settle(self, "run")


WEIGHED = ("support", "drive")
"""Parts of a scene whose masses, loads and springs a line contact has per unit width."""


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
    foundation: AnyFoundation = Foundation(stiffness=1e10, retardation_time=0.1)
    support: Support = DeadWeight(mass=1000.0)
    drive: Drive = Drive(velocity=0.1)
    run: Run = Run()

    def __post_init__(self) -> None:
        parts: dict[str, Any] = {
            "indenter": Indenter, "foundation": AnyFoundation, "support": Support, "drive": Drive, "run": Run,
        }  # fmt: skip
        problems = []
        for name, kind in parts.items():
            if not isinstance(getattr(self, name), kind):
                told = getattr(kind, "__name__", f"one of {kind}")
                problems.append(problem(f"`{name}`", getattr(self, name), f"expected {told}"))
        for name in () if problems else WEIGHED:
            problems += misfits(name, getattr(self, name), self.indenter)
        problems = problems or lacks_mass(self.support, self.drive, self.indenter.per_width)
        if problems:
            raise SceneError(problems)

    @property
    def held(self) -> bool:
        """Whether the support holds the indenter at its depth, so that it cannot move."""
        return math.isinf(self.support.spring)

    @property
    def drive_mass(self) -> float:
        """M_x, in kg/m: the mass that moves along x, that of the support unless the drive gives another."""
        return self.support.mass if self.drive.mass is None else self.drive.mass

    @classmethod
    def table1(cls, support: str = "dead-weight") -> "Scene":
        """Return the standard scene of Table 1 with one of its supports.

        The paper has no suspended indenter; its spring here, 30 MN/m^2, is about as stiff as the
        foundation under the indenter.
        """
        if support not in TABLE1_SUPPORTS:
            raise ValueError(f'`support` = "{support}": {nearest(support, TABLE1_SUPPORTS)}')
        return cls(support=TABLE1_SUPPORTS[support])

    def parts(self) -> dict[str, Any]:
        """Return what holds the quantities of the scene at rest, by its dotted name, each arm by its own."""
        arms = enumerate(self.foundation.arms)
        return {
            "indenter": self.indenter,
            "foundation": self.foundation,
            **{f"foundation.arms[{number}]": arm for number, arm in arms},
            "support": self.support,
        }

    def values(self) -> Mapping[str, float]:
        """Return every quantity of the scene in SI by its dotted key, as ``"drive.velocity"``.

        What follows from others is there too: the ``"support.weight"``, and the stiffness of a layer.

        A drive that is a function has no velocity to give.
        """
        flat = {
            f"{section}.{name}": getattr(part, name)
            for section, part in self.parts().items()
            for name in quantities(part)
            if getattr(part, name) is not None
        }
        if not self.held:
            flat["support.weight"] = self.support.weight
        if self.drive.ends:
            flat["drive.velocity"] = self.drive.final_velocity
        if not self.drive.rigid:
            flat |= {f"drive.{name}": getattr(self.drive, name) for name in SPRING}
            flat["drive.mass"] = self.drive_mass
        return flat


def lacks_mass(support: Support, drive: Drive, per_width: bool) -> list[str]:
    """Return that a fixed indenter on a spring needs a mass, as its support has none; or nothing."""
    if drive.rigid or drive.mass is not None or math.isfinite(support.mass):
        return []
    spec = quantities(drive)["mass"].fitting(per_width)
    needed = missing("drive", "mass", spec, f' for support.kind = "{support.kind}"')
    return [f"{needed}, which moves along x on the spring"]


TABLE1_SUPPORTS: dict[str, Support] = {
    "fixed": Fixed(depth=3e-4),
    "dead-weight": DeadWeight(mass=1000.0),
    "suspended": Suspended(mass=1000.0, stiffness=3e7),
}
