"""What is modelled: an indenter on a Kelvin-Voigt foundation, its support and its drive.

Every field accepts SI numbers, text with a unit (``"10 mm"``) and pint quantities, and holds an SI
float afterwards.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

from kvtheory.scene.fields import (
    Quantity,
    SceneError,
    convert,
    nearest,
    problem,
    quantities,
    quantity,
    settle,
)
from kvtheory.scene.indenters import Indenter, Parabola

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
    depth: float = quantity("m", "delta, indentation depth, held constant")

    def __post_init__(self) -> None:
        settle(self, "support")


@dataclass(frozen=True)
class DeadWeight:
    """The indenter moves freely up and down under its weight (the paper's MI model, Eq. 17)."""

    kind: ClassVar[str] = "dead-weight"
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
    mass: float = quantity("kg/m", "M, mass of the indenter per unit width")
    stiffness: float = quantity("N/m^2", "k_s, stiffness of the suspension per unit width")
    gravity: float = quantity("m/s^2", "g, gravity", default=STANDARD_GRAVITY)

    def __post_init__(self) -> None:
        settle(self, "support")

    @property
    def weight(self) -> float:
        """M g, in N/m."""
        return self.mass * self.gravity


Support = Fixed | DeadWeight | Suspended
SUPPORTS: dict[str, Any] = {cls.kind: cls for cls in (Fixed, DeadWeight, Suspended)}

VELOCITY = Quantity(
    "m/s", "V, drive velocity of the foundation, from rest to this at t = 0", -math.inf, True
)
TIME = Quantity("s", "time", 0.0, False)


@dataclass(frozen=True)
class Drive:
    """The motion of the foundation: one `velocity` from t = 0 on, or a `history`.

    A history holds pairs (time, velocity). It is linear between its points and jumps where a time
    stands twice; it starts at t = 0 and keeps its last velocity.
    """

    velocity: float | None = field(default=None, metadata={"quantity": VELOCITY})
    history: Sequence[tuple[float, float]] | None = None

    def __post_init__(self) -> None:
        if (self.velocity is None) == (self.history is None):
            raise SceneError(
                ['drive: expected one of velocity and history, such as velocity = "100 mm/s"']
            )
        if self.velocity is not None:
            settle(self, "drive")
        else:
            object.__setattr__(self, "history", _history(self.history))

    @property
    def final_velocity(self) -> float:
        """The velocity that the drive ends with, in m/s."""
        return self.velocity if self.history is None else self.history[-1][1]  # type: ignore[return-value]


def _history(points: Any) -> tuple[tuple[float, float], ...]:
    """Convert the points of a drive history, or report every one that is wrong."""
    key = "drive.history"
    if isinstance(points, str) or not isinstance(points, Sequence) or not points:
        raise SceneError(
            [
                problem(
                    key,
                    points,
                    'expected points such as [["0 ms", "100 mm/s"], ["50 ms", "0 mm/s"]]',
                )
            ]
        )
    problems, converted = [], []
    for index, point in enumerate(points):
        if isinstance(point, str) or not isinstance(point, Sequence) or len(point) != 2:
            problems.append(
                problem(f"{key}[{index}]", point, 'expected a pair ["time", "velocity"]')
            )
            continue
        pair = []
        for value, spec in zip(point, (TIME, VELOCITY), strict=True):
            try:
                pair.append(convert(value, spec))
            except ValueError as error:
                problems.append(problem(f"{key}[{index}]", value, str(error)))
        converted.append(tuple(pair))
    if not problems:
        times = [time for time, _ in converted]
        if times[0] != 0.0:
            problems.append(problem(f"{key}[0]", points[0], "the first time must be 0 s"))
        problems += [
            problem(
                f"{key}[{i}]",
                points[i],
                "times must not decrease, and one time may stand at most twice",
            )
            for i in range(1, len(times))
            if times[i] < times[i - 1] or (i > 1 and times[i] == times[i - 2])
        ]
    if problems:
        raise SceneError(problems)
    return tuple(converted)  # type: ignore[arg-type]


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
        """Return every quantity of the scene in SI by its dotted key, as ``"drive.velocity"``."""
        parts = {"indenter": self.indenter, "foundation": self.foundation, "support": self.support}
        flat = {
            f"{section}.{name}": getattr(part, name)
            for section, part in parts.items()
            for name in quantities(part)
        }
        return {**flat, "drive.velocity": self.drive.final_velocity}


TABLE1_SUPPORTS: dict[str, Support] = {
    "fixed": Fixed(depth=3e-4),
    "dead-weight": DeadWeight(mass=1000.0),
    "suspended": Suspended(mass=1000.0, stiffness=3e7),
}
