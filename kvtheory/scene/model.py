"""The model: an indenter on a viscoelastic foundation, its support and its drive.

Every quantity accepts SI numbers, text with a unit (``"10 mm"``), pint quantities, and arrays of these; it
holds an SI float or an array of them afterwards. The arrays of a scene broadcast against each other.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.drives import SPRING, VELOCITY, Drive, history_points
from kvtheory.scene.foundations import FOUNDATIONS, AnyFoundation, Arm, Foundation
from kvtheory.scene.indenters import SHAPES, Indenter, Parabola, Profile, Revolved
from kvtheory.scene.layer import unfit
from kvtheory.scene.mistakes import Problems, SceneError, mistake, nearest
from kvtheory.scene.quantities import (
    Part,
    Quantity,
    Value,
    as_given,
    converted,
    derive,
    free,
    given,
    is_derived,
    missing,
    quantities,
    quantity,
    validate,
)
from kvtheory.scene.start import REST, Start, misplaced
from kvtheory.scene.units import expected

STANDARD_GRAVITY = 9.80665
LOAD = "W, load instead of mass times gravity; the mass is then inertia alone"
DEPTH = Quantity("m", "depth", -math.inf, False)
MASS: dict[str, Any] = {"default": None, "needed": True, "instead": "load", "per_width": True}


class _Support(Part):
    def __post_init__(self) -> None:
        validate(self, "support")


@dataclass(frozen=True, eq=False)
class Fixed(_Support):
    """The indenter cannot move by itself (the paper's FI model): its depth is given.

    It is constant, or a `history` of pairs (time, depth), linear between them and constant after the last:
    an indentation, hold, withdrawal or oscillation. At a depth below 0 the indenter is above the flat
    surface. Up to t = 0 it has been at the first depth since ever. The `depth` is then the largest one,
    which sets the scales of the motion.

    >>> Fixed(depth="300 um").depth
    0.0003
    >>> Fixed(history=[("0 s", "0 mm"), ("1 s", "0.3 mm"), ("2 s", "-0.1 mm")]).depth
    0.0003
    """

    kind: ClassVar[str] = "fixed"
    table1: ClassVar[dict[str, float]] = {"depth": 3e-4}
    mass: ClassVar[Value] = math.inf
    weight: ClassVar[Value] = 0.0
    spring: ClassVar[Value] = math.inf
    depth: Value = quantity(
        "m", "delta, indentation depth, held constant", default=None, needed=True, instead="history"
    )
    history: Sequence[tuple[float, float]] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if self.history is None:
            super().__post_init__()
            return
        key, problems = "support.history", Problems()
        if self.depth is not None and not is_derived(self.depth):
            problems.add("support.depth", self.depth, f"cannot be given beside {key}")
            problems.report()
        example = '[["0 s", "0 mm"], ["1 s", "0.3 mm"]]'
        points = history_points(self.history, key, DEPTH, "depth", example)
        for i, ((before, _), point) in enumerate(pairwise(points), start=1):
            if point[0] == before:
                message = "the depth would jump, with an infinite rate; expected a later time"
                problems.add(f"{key}[{i}]", point, message)
        problems.report()
        object.__setattr__(self, "history", points)
        deepest = max(depth for _, depth in points)
        if not deepest > 0.0:
            raise mistake(key, deepest, "is the largest depth, in m; expected one above 0")
        derive(self, "support", "depth", deepest, key)

    def changed(self, **values: Any) -> "Fixed":
        """Return a copy with another depth; a history is multiplied so that this is its largest one.

        >>> Fixed(history=[(0.0, 1e-4), (1.0, 2e-4)]).changed(depth=1e-3).history
        ((0.0, 0.0005), (1.0, 0.001))
        """
        if self.history is None or "depth" not in values:
            return replace(self, **values)
        points = [(time, depth / self.depth * values["depth"]) for time, depth in self.history]
        return replace(self, depth=None, history=points)


class _Loaded(_Support):
    """Common base of supports with a load: mass times gravity, or a given load."""

    depth: ClassVar[Value] = None
    mass: Value
    gravity: Value
    load: Value

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.load is not None and self.mass is None:
            mass = self.load / self.gravity
            derive(self, "support", "mass", mass, "support.load/support.gravity")

    @property
    def weight(self) -> Value:
        """W, in N/m, or in N for a ball: the load, or else M g."""
        return self.mass * self.gravity if self.load is None else self.load


@dataclass(frozen=True, eq=False)
class DeadWeight(_Loaded):
    """The indenter moves freely up and down under its weight (the paper's MI model, Eq. 17).

    A `load` replaces the weight; the mass is then inertia alone, and load/gravity if not given.

    >>> DeadWeight(load="3 N/mm").mass, DeadWeight(mass="1 kg/mm", load="3 N/mm").weight
    (305.9148638933785, 3000.0)
    """

    kind: ClassVar[str] = "dead-weight"
    table1: ClassVar[dict[str, float]] = {"mass": 1000.0}
    spring: ClassVar[Value] = 0.0
    mass: Value = quantity("kg/m", "M, mass of the indenter", **MASS)
    gravity: Value = quantity("m/s^2", "g, gravity", default=STANDARD_GRAVITY)
    load: Value = quantity("N/m", LOAD, default=None, per_width=True)


@dataclass(frozen=True, eq=False)
class Suspended(_Loaded):
    """A dead weight on a spring that is relaxed at the static depth; `load` is as for a dead weight.

    M z'' = F_z - W - k_s (z - z_0): k_s -> 0 is `DeadWeight`, k_s -> oo is `Fixed` at the static depth.

    >>> Suspended(load="3 N/mm", stiffness="30 MN/m^2").weight
    3000.0
    """

    kind: ClassVar[str] = "suspended"
    table1: ClassVar[dict[str, float]] = {"mass": 1000.0, "stiffness": 3e7}
    mass: Value = quantity("kg/m", "M, mass of the indenter", **MASS)
    stiffness: Value = quantity(
        "N/m^2", "k_s, stiffness of the suspension", default=None, needed=True, per_width=True
    )
    gravity: Value = quantity("m/s^2", "g, gravity", default=STANDARD_GRAVITY)
    load: Value = quantity("N/m", LOAD, default=None, per_width=True)

    @property
    def spring(self) -> Value:
        """k_s, in N/m^2, or in N/m for a ball."""
        return self.stiffness


Support = Fixed | DeadWeight | Suspended
"""Each has the `mass` (kg/m), `weight` (N/m) and `spring` (N/m^2) of its equation of motion, and the
`depth` (m) at which it is held: mass and spring of a fixed one are infinite, a moving one has no depth.
For a ball these are in kg, N and N/m. `table1` are its values in the scene of Table 1."""
SUPPORTS: dict[str, Any] = {cls.kind: cls for cls in (Fixed, DeadWeight, Suspended)}


@dataclass(frozen=True, eq=False)
class Run(Part):
    """The duration of the transient."""

    duration: Value = quantity("s", "duration of the transient", default=0.2)

    def __post_init__(self) -> None:
        validate(self, "run")


@dataclass(frozen=True, eq=False)
class Scene(Part):
    """An indenter, a foundation, a support, a drive and a start; without arguments, the paper's Table 1.

    With arrays it stands for many scenes.

    >>> Scene(drive=Drive(velocity="50 mm/s")).drive.velocity, Scene().foundation.stiffness
    (0.05, 10000000000.0)
    >>> Scene.table1("fixed").support
    Fixed(depth=0.0003)
    >>> Scene(drive=Drive(velocity="1 mm/s:1 m/s:4:log")).shape
    (4,)
    """

    indenter: Indenter = Parabola(radius=0.01)
    foundation: AnyFoundation = Foundation(stiffness=1e10, retardation_time=0.1)
    support: Support = DeadWeight(mass=1000.0)
    drive: Drive = Drive(velocity=0.1)
    run: Run = Run()
    start: Start = REST

    def __post_init__(self) -> None:
        parts = vars(self)
        problems = Problems()
        for name, kinds in PARTS.items():
            if not isinstance(parts[name], kinds):
                message = " or ".join(kind.__name__ for kind in kinds)
                problems.add(f"`{name}`", parts[name], f"expected {message}")
        problems.report()
        inconsistencies(parts).report()
        found = self.foundation.under(self.indenter, self.support)
        object.__setattr__(self, "foundation", found)
        for name in PARTS:
            if parts[name].arrayed:
                object.__setattr__(self, "arrayed", True)
                _ = self.shape  # or raise
                break

    @cached_property
    def shape(self) -> tuple[int, ...]:
        """The shape to which the arrays of the scene broadcast; () if there are none."""
        if not self.arrayed:
            return ()
        arrays = self.arrays()
        try:
            return np.broadcast_shapes(*(each.shape for each in arrays.values()))
        except ValueError:
            message = ", ".join(f"{key} {each.shape}" for key, each in arrays.items())
            remedy = "`sweep` with `over` takes every combination"
            raise SceneError(
                [f"the arrays of the scene do not broadcast: {message}; {remedy}"]
            ) from None

    def flat(self) -> "Scene":
        """Return the scene with its arrays broadcast to one dimension."""
        found = self.mapped(lambda array: np.broadcast_to(array, self.shape).reshape(-1))
        vars(found)["shape"] = (math.prod(self.shape),)
        return found

    def rows(self, part: Any) -> "Scene":
        """Return a selection of the scenes of a flat one, by a slice or by indices."""
        found = self.mapped(lambda array: array[part])
        vars(found)["shape"] = np.broadcast_to(0.0, self.shape)[part].shape
        return found

    def at(self, velocity: Any) -> "Scene":
        """Return the scene at one drive velocity or several in m/s, which are not checked."""
        drive, scene = object.__new__(Drive), object.__new__(Scene)
        way = dict.fromkeys(("history", "function", "waveform"))
        arrayed = isinstance(velocity, np.ndarray) or self.arrayed
        vars(drive).update({**vars(self.drive), **way, "velocity": velocity, "arrayed": arrayed})
        vars(drive).pop("points", None)
        own = {name: vars(self)[name] for name in PARTS if name != "drive"}
        vars(scene).update({**own, "drive": drive, "arrayed": arrayed})
        if not self.arrayed:
            vars(scene)["shape"] = np.shape(velocity)
        return scene

    @cached_property
    def kind(self) -> tuple[str, str, str, str]:
        """Shape, law, support and drive by the names of the table `capabilities`.

        >>> Scene().kind
        ('parabola', 'kelvin-voigt', 'dead-weight', 'rigid')
        """
        drive = "rigid" if self.drive.rigid else "spring"
        return self.indenter.shape, self.foundation.law, self.support.kind, drive

    @property
    def held(self) -> bool:
        """Whether the support holds the indenter at a depth."""
        return self.support.depth is not None

    @property
    def depths(self) -> Sequence[tuple[float, float]]:
        """The points (time, depth) of a fixed indenter whose depth changes; else none."""
        return getattr(self.support, "history", None) or ()

    def motion(self, end: float, least: float) -> BaseMotion:
        """Return the motion of the base, see `Drive.motion`, and the depths of the indenter if given."""
        found = self.drive.motion(end, least)
        return found.holding(self.depths) if self.depths else found

    @property
    def changes(self) -> tuple[float, ...]:
        """The times in s at which the drive or a given depth changes abruptly, in order, with t = 0."""
        return tuple(sorted({*self.drive.changes, *(time for time, _ in self.depths)}))

    @property
    def drive_mass(self) -> Value:
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
        """Return indenter, foundation, support and start, and the parts within them, by dotted name."""
        found: dict[str, Any] = {}
        for name in ("indenter", "foundation", "support", "start"):
            found[name] = part = getattr(self, name)
            found |= {f"{name}.{inner}": each for inner, each in part.nested()}
        return found

    def values(self) -> Mapping[str, float]:
        """Return every quantity of the scene in SI by its dotted key, as ``"drive.velocity"``.

        The stiffness of a layer and the mass of a load are included; times of a foundation are those at its
        reference temperature. A drive that is a function has no velocity.
        """
        flat = {
            f"{section}.{name}": as_given(getattr(part, name))
            for section, part in self.parts().items()
            for name in quantities(part)
            if getattr(part, name) is not None
        }
        if self.drive.ends:
            flat["drive.velocity"] = self.drive.final_velocity
        if not self.drive.rigid:
            flat |= {f"drive.{name}": getattr(self.drive, name) for name in SPRING}
            flat["drive.mass"] = self.drive_mass
        return flat

    @cached_property
    def replaceable(self) -> dict[str, Quantity]:
        """Return the quantities that `replace` takes, by dotted key, in the units of the scene."""
        found = {
            f"{section}.{name}": spec
            for section, part in self.parts().items()
            for name, spec in (given if isinstance(part, Arm) else free)(part).items()
        }
        own = {} if self.drive.waveform is None else quantities(self.drive.waveform)
        springs = SPRING[:1] if self.drive.rigid else SPRING  # damper and mass need a stiffness
        specs = quantities(self.drive)
        drive = {"velocity": VELOCITY, **{name: specs[name] for name in springs}, **own}
        found |= {f"drive.{name}": spec for name, spec in drive.items()}
        found |= {f"run.{name}": spec for name, spec in quantities(self.run).items()}
        per_width = self.indenter.per_width
        return {key: spec.fitting(per_width) for key, spec in found.items()}

    def not_replaceable(self, key: str) -> str:
        """Return why a key cannot be replaced: what it needs, or the nearest one that can be."""
        section, _, name = key.rpartition(".")
        part = self.parts().get(section)
        spec = None if part is None else quantities(part).get(name)
        if spec and spec.beside:
            needed = " and ".join(f"{section}.{other}" for other in spec.beside)
            return f"the scene needs {needed} beside it"
        return f"unknown key for this scene; {nearest(key, self.replaceable)}"

    def replace(self, over: Mapping[str, Any]) -> "Scene":
        """Return the scene with some quantities replaced; derived quantities are computed again.

        A velocity replaces a history, a waveform or a function. Unknown keys and values that are out of range
        raise SceneError, which lists them all.

        >>> Scene().replace({"drive.velocity": ["1 mm/s", "1 m/s"], "support.mass": 10.0}).shape
        (2,)
        """
        specs, problems = self.replaceable, Problems()
        values: dict[str, Any] = {}
        for key, value in over.items():
            if key not in specs:
                problems.add(f"`over` {key}", value, self.not_replaceable(str(key)))
                continue
            with problems.catching(f"`over` {key}", value):
                values[key] = converted(value, specs[key])
        problems.report()
        return _replaced(self, values) if values else self


def _replaced(part: Any, values: Mapping[str, Any]) -> Any:
    """Return a part with quantities replaced, by their dotted names within it."""
    own: dict[str, Any] = {}
    inner: dict[str, dict[str, Any]] = {}
    for key, value in values.items():
        first, _, rest = key.partition(".")
        if rest:
            inner.setdefault(first, {})[rest] = value
        else:
            own[first] = value
    for key, changes in inner.items():
        name, _, index = key.rstrip("]").partition("[")
        old = own.get(name, getattr(part, name))
        if index:
            i = int(index)
            own[name] = (*old[:i], _replaced(old[i], changes), *old[i + 1 :])
        else:
            own[name] = _replaced(old, changes)
    return part.changed(**own)


PARTS: dict[str, tuple[Any, ...]] = {
    "indenter": (*SHAPES.values(), Profile, Revolved), "foundation": (*FOUNDATIONS.values(),),
    "support": (*SUPPORTS.values(),),
    "drive": (Drive,), "run": (Run,), "start": (Start,),
}  # fmt: skip
"""The parts of a scene, and what each can be."""


def inconsistencies(parts: Mapping[str, Any]) -> Problems:
    """Report parts that do not fit: totals with a line contact, no mass for a spring, a layer, a start."""
    found = misplaced(parts)
    indenter, support, drive = parts.get("indenter"), parts.get("support"), parts.get("drive")
    if indenter is not None:
        found += unfit(parts.get("foundation"), indenter)
    per_width = indenter is None or indenter.per_width
    for section, part in (("support", support), ("drive", drive)):
        for name, (value, given_per_width) in getattr(part, "written", {}).items():
            if indenter is None or given_per_width == per_width:
                continue
            unit = quantities(part)[name].fitting(per_width).unit
            what, contact = ("that of a ball", "line") if per_width else ("per unit width", "point")
            shape = f'indenter.shape = "{indenter.shape}"'
            message = f"is {what}, but {shape} has a {contact} contact; expected {expected(unit)}"
            found.add(f"{section}.{name}", value, message)
    if support and drive and not drive.rigid and drive.mass is None and support.depth is not None:
        spec = quantities(drive)["mass"].fitting(per_width)
        needed = missing("drive", "mass", spec, f' for support.kind = "{support.kind}"')
        found.append(f"{needed}, which moves along x on the spring")
    return found


SECTIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "indenter": ("shape", SHAPES), "foundation": ("kind", FOUNDATIONS), "support": ("kind", SUPPORTS),
    "drive": ("", {"drive": Drive}), "run": ("", {"run": Run}), "start": ("", {"start": Start}),
}  # fmt: skip
"""By section of a file: the key that selects a class, empty if there is only one, and the classes."""

TABLE1_SUPPORTS: dict[str, Support] = {kind: cls(**cls.table1) for kind, cls in SUPPORTS.items()}
