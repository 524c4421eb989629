"""The scene at rest, and the dimensionless numbers that govern its motion."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from kvtheory.scene.capabilities import lacks_one_scene, lacks_quadratic, require
from kvtheory.scene.model import TABLE1_SUPPORTS, Scene
from kvtheory.scene.start import StartState

IMPACT = 0.4
"""Power of the energy of an impact, over that stored at rest, with which the depth grows that it reaches, and
that energy over W_0 delta_0: of a parabola; of a ball both are a third."""


@dataclass(frozen=True)
class StaticState:
    """The indenter at rest, in SI, its dimensionless numbers, and the scales of errors.

    With the static depth delta_0, half length a_0 = sqrt(2 R delta_0) and load W_0 = (4/3) K a_0
    delta_0, of a ball (pi/2) K a_0^2 delta_0 sqrt(R'/R): the drive number lambda = V tau/a_0 at the final
    velocity (NaN if the drive is a function), the inertia number epsilon = M delta_0/(W_0 tau^2) and the
    support number kappa = k_s delta_0/W_0, both infinite for a fixed indenter. A drive with a spring has
    three more, along x (fact F22): eps_x = M_x a_0^2/(W_0 delta_0 tau^2), c_x a_0^2/(W_0 delta_0 tau) and
    kappa_x = k_x a_0^2/(W_0 delta_0), infinite for a rigid drive. The other attributes are products of these.

    >>> at_rest = StaticState.of(Scene())
    >>> round(at_rest.drive_number, 5), round(at_rest.inertia_number, 5), at_rest.support_number
    (4.08128, 0.00306, 0.0)
    """

    depth: float
    half_length: float
    load: float
    drive_number: float
    inertia_number: float
    support_number: float
    time: float
    stiffness: float
    drive_inertia_number: float
    drive_damping_number: float
    drive_stiffness_number: float

    @classmethod
    def of(cls, scene: Scene) -> "StaticState":
        """Return the static state of one scene with a parabola or a ball, or raise ValueError."""
        require(lacks_one_scene, scene, "the static state")
        require(lacks_quadratic, scene, "the static state in closed form")
        R, K = scene.indenter.radius, scene.foundation.stiffness
        depth, load = scene.support.depth, scene.support.weight
        try:
            if scene.indenter.per_width:
                if depth is None:
                    half_length = (1.5 * R * load / K) ** (1 / 3)
                    depth = half_length**2 / (2 * R)
                else:
                    half_length = math.sqrt(2 * R * depth)
                    load = 4 / 3 * K * half_length * depth
            else:
                stiffness = ball_stiffness(K, R, scene.indenter.stretch)
                if depth is None:
                    depth = math.sqrt(load / stiffness)
                else:
                    load = stiffness * depth**2
                half_length = math.sqrt(2 * R * depth)
            found = cls.at(scene, depth, half_length, load)
        except ArithmeticError:
            found = None
        if found is None or not found.in_range:
            raise ValueError(out_of_range(scene))
        return found

    @classmethod
    def at(cls, scene: Scene, depth: float, half_length: float, load: float) -> "StaticState":
        """Return the static state of any shape, whose depth, half length and load are known."""
        tau, support, drive = scene.foundation.retardation_time, scene.support, scene.drive
        velocity = drive.final_velocity if drive.ends else math.nan
        along = half_length**2 / (load * depth)
        spring = math.inf if drive.stiffness is None else drive.stiffness * along
        return cls(
            depth=depth,
            half_length=half_length,
            load=load,
            drive_number=velocity * tau / half_length,
            inertia_number=support.mass * depth / (load * tau**2),
            support_number=support.spring * depth / load,
            time=tau,
            stiffness=scene.foundation.stiffness,
            drive_inertia_number=scene.drive_mass * along / tau**2,
            drive_damping_number=drive.damping * along / tau,
            drive_stiffness_number=spring,
        )

    @property
    def fixed(self) -> bool:
        """Whether the indenter cannot move."""
        return math.isinf(self.support_number)

    @property
    def rigid_drive(self) -> bool:
        """Whether the indenter cannot move along x: its drive has no spring."""
        return math.isinf(self.drive_stiffness_number)

    @property
    def in_range(self) -> bool:
        """Whether every number is in the range of double precision."""
        held = 0.0 < self.depth < math.inf and self.half_length > 0.0 and 0.0 < self.load < math.inf
        finite = self.fixed or (self.inertia_number < math.inf and self.support_number < math.inf)
        along = self.drive_inertia_number + self.drive_damping_number + self.drive_stiffness_number
        carried = self.rigid_drive or (self.drive_inertia_number > 0.0 and along < math.inf)
        return held and finite and carried and not math.isinf(self.drive_number)

    velocity = property(lambda self: self.half_length / self.time, doc="a_0/tau, in m/s.")
    depth_rate = property(lambda self: self.depth / self.time, doc="delta_0/tau, in m/s.")
    friction_force = property(
        lambda self: self.load * self.depth / self.half_length,
        doc="W_0 delta_0/a_0, in N/m (in N for a ball).",
    )
    pressure = property(lambda self: self.stiffness * self.depth, doc="K delta_0, in Pa.")
    energy = property(
        lambda self: self.load * self.depth, doc="W_0 delta_0, in J/m (J for a ball)."
    )

    def impact(self, begun: StartState) -> tuple[float, float]:
        """Return the speed and the depth to expect after a start that is not at rest.

        The indenter has the energy of its motion, of its weight and spring, and of the foundation under it. A
        fixed one stays where it is.

        >>> speed, depth = StaticState.of(Scene()).impact(StartState(-5e-3, 0.0, 0.0))
        >>> round(speed, 3), round(depth * 1e3, 3)  # m/s, from sqrt(2 g (5 mm + delta_0)), and mm
        (0.322, 1.366)
        """
        if self.fixed:
            return 0.0, self.depth
        mass = self.inertia_number * self.load * self.time**2 / self.depth
        spring, off = self.support_number * self.load / self.depth, begun.depth - self.depth
        energy = 0.5 * (mass * begun.rate**2 + spring * off**2) + self.load * abs(off)
        deep, stored = max(begun.depth, 0.0) / self.depth, IMPACT * self.energy
        energy += stored * deep ** (1.0 / IMPACT)
        deepest = self.depth * max(1.0, deep, (energy / stored) ** IMPACT)
        return math.sqrt(2.0 * energy / mass), deepest

    def named(self) -> dict[str, float]:
        """Return the values that exist by plain names, as ``"static_depth"`` and ``"drive_number"``."""
        found = asdict(self)
        numbers = ["drive_number", "inertia_number", "support_number"]
        if not self.rigid_drive:
            numbers += [f"drive_{name}_number" for name in ("inertia", "damping", "stiffness")]
        shown = {f"static_{name}": found[name] for name in ("depth", "half_length", "load")}
        return shown | {name: found[name] for name in numbers if math.isfinite(found[name])}


def ball_stiffness(stiffness: Any, radius: Any, stretch: Any) -> Any:
    """Return W_0/delta_0^2 = pi K R sqrt(R'/R) of a ball at rest in N/m^2, of floats or arrays (fact F20)."""
    return math.pi * stiffness * radius * stretch


FAR = 10.0
"""Powers of ten from Table 1 from which a value is named as suspicious, or half of those of the farthest."""


def out_of_range(scene: Scene, why: str = "") -> str:
    """Return the message that a scene leaves double precision; it names values far from those of Table 1."""
    usual: dict[str, float] = {}
    for support in TABLE1_SUPPORTS:
        usual |= Scene.table1(support).values()
    units = {key: spec.unit.removeprefix("1") for key, spec in scene.replaceable.items()}
    shift = {"a_T of foundation.temperature": scene.foundation.shift_factor}
    values = {**scene.values(), **shift, "run.duration": scene.run.duration}
    far = {
        f"{key} = {size:g} {units.get(key, '')}".strip(): abs(
            math.log10(size / usual.get(key, 1.0))
        )
        for key, value in values.items()
        for size in (float(abs(each)) for each in (np.min(value), np.max(value)))
        if 0.0 < size < math.inf
    }
    least = min(FAR, 0.5 * max(far.values()))
    message = ", ".join(text for text, distance in far.items() if distance >= least > 0.0)
    return (
        "the scene leaves the range of double precision: "
        f"{why and f'{why}; '}check {message or 'its values'}"
    )
