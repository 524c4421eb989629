"""The scene as the simulator sees it: constants in SI, the indenter at rest, and contacts of its elements.

A line contact is one row of elements, and what acts on it is per unit width. A ball has a row, or strip,
at each y = 0, dy, 2 dy, ..., and its forces are sums over strips.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.elements import kernels
from kvtheory.models.elements.kernels import Constants, Surface
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.capabilities import lacks_arms, require
from kvtheory.scene.indenters import Circle, Indenter, Revolved, Sphere
from kvtheory.scene.model import Scene
from kvtheory.scene.start import REST, Drawn, Start, StartState
from kvtheory.scene.static_state import StaticState, out_of_range
from kvtheory.theory.laws import Element

PER_STRIP = 6.0
"""Width of a strip in elements, on a round ball: then both spacings matter about equally."""
FEWEST_STRIPS = {False: 16, True: 64}
"""From the middle plane to the rim at rest, and where the growth of a ripple is sought (True): it is a small
difference, to which the rim matters most."""
FEWEST = 8
"""Elements in contact at rest, at least: fewer do not resolve the contact."""
MOST = 2_000_000
"""Elements in contact at rest, at most: more do not fit in memory."""
SAMPLES = {False: 4096, True: 256}
"""Elements in a line contact, and along a ball, without a spacing: sizes are known to a thousandth then."""
CREEP = 1e-12
"""Share of a_0/tau that counts as rest."""
DEPTH_RTOL = 1e-12
"""The iteration for a depth ends when a step is below this share of it: the next one would be of the order of
rounding errors."""
NO_SPRING = 1e-6
"""Share of the load below which a spring does not change the time of a fall."""
STALLED = 0.9
"""It also ends when a step is not below this share of the previous one."""


class Contact(NamedTuple):
    """A contact: its length in m (of a ball, its area in m^2), normal force, and integral of h'^2."""

    extent: float
    force: float
    tilt: float


@dataclass(frozen=True)
class Model:
    """A scene in SI, as `constants` for the kernels, what it is at rest, and how it starts."""

    constants: Constants
    contact: Contact
    at_rest: StaticState
    start: Start = REST

    @classmethod
    def of(
        cls, scene: Scene, spacing: float | None = None, *,
        parts: bool = False, shift: float = 0.0, coarser: float = 1.0,
    ) -> "Model":  # fmt: skip
        """Return the model of a scene; without a spacing, with `SAMPLES` elements in contact at rest.

        The elements are `coarser` times as far apart as the spacing says, and so are strips; of a run whose
        elements are shifted, a quarter more, so that their rims are elsewhere too.

        Raises
        ------
        ValueError
            If there are too few or too many elements in the contact, or if the scene leaves the range of
            double precision.
        """
        require(lacks_arms, scene, "the simulator")
        support, given, drive = scene.support, scene.foundation, scene.drive
        arms = [(arm.stiffness, arm.relaxation_time) for arm in given.arms]
        c = Constants(
            surface=surface_of(scene.indenter), kinks=np.array(scene.indenter.kinks, dtype=float),
            law=Element.of(given.stiffness, given.damping, arms), parts=False,
            shift=0.0, spacing=0.0, across=0.0, mass=float(support.mass), weight=float(support.weight),
            spring=0.0, mass_along=math.inf if drive.rigid else float(scene.drive_mass),
            spring_along=float(drive.stiffness or 0.0), damping_along=float(drive.damping),
            depth=float(support.depth or 1.0), half_length=0.0, creep=0.0,
        )  # fmt: skip
        if not all(map(math.isfinite, span(c.surface, c.depth))):
            raise ValueError(out_of_range(scene))
        depth = c.depth if scene.held else sunk_depth(c)
        low, high = span(c.surface, depth)
        dx = spacing or (high - low) / SAMPLES[c.surface.ball]
        # Of a ball, the strips increase with the elements along it.
        most = math.isqrt(int(2.0 * PER_STRIP * MOST)) if c.surface.ball else MOST
        if not FEWEST <= (high - low) / dx <= most:
            raise ValueError(
                f"`per_length` = {1 / dx:.6g} 1/m: expected {FEWEST / (high - low):.3g} to "
                f"{most / (high - low):.3g} 1/m, so that {FEWEST} to {most} elements carry the indenter"
                + " along its middle"
                * c.surface.ball
            )
        dy = (
            coarser
            * (1.0 + 0.5 * shift)
            * strip_width(c.surface, depth, dx, FEWEST_STRIPS[isinstance(scene.start, Drawn)])
        )
        c = c._replace(parts=parts, shift=shift, spacing=coarser * dx, across=dy, depth=depth)
        depth = depth if scene.held else sunk_depth(c)
        low, high = span(c.surface, depth)
        c = c._replace(depth=depth, half_length=0.5 * (high - low))
        if not scene.held:
            c = c._replace(spring=float(support.spring))
        at_rest = contact(c, depth)
        static = StaticState.at(scene, depth, c.half_length, at_rest.force)
        return cls(c._replace(creep=CREEP * static.velocity), at_rest, static, scene.start)

    @property
    def sprung(self) -> bool:
        """Whether the indenter moves along x."""
        return math.isfinite(self.constants.mass_along)

    def path(self, scene: Scene) -> BaseMotion:
        """Return the motion of the base until the end of the run."""
        return scene.motion(scene.run.duration, self.at_rest.velocity).shifted(
            self.start.at(0.0, 0.0).along
        )

    def fastest(self, path: BaseMotion) -> float:
        """Return the speed of sliding to expect, in m/s: that of the drive, and of a spring let go.

        Friction throws M_x to about F/sqrt(k_x M_x), and through the dampers no faster than about a_0/τ.
        """
        if not self.sprung:
            return path.highest_speed
        swing = math.sqrt(self.constants.spring_along * self.constants.mass_along)
        thrown = self.at_rest.friction_force / swing if swing else math.inf
        own = abs(self.begun(path).along_rate)
        return path.highest_speed + own + min(thrown, self.at_rest.velocity)

    def begun(self, path: BaseMotion) -> StartState:
        """Return the state just after t = 0."""
        return self.start.of(path, self.constants.depth)

    def impact(self, path: BaseMotion) -> tuple[float, float]:
        """Return the speed of the indenter to expect after a start that is not at rest, and the depth."""
        begun = self.begun(path)
        return (0.0, self.constants.depth) if self.start.at_rest else self.at_rest.impact(begun)

    def landing(self, path: BaseMotion) -> float:
        """Return the time (s) at which an indenter lands that starts above the ground, or infinity."""
        c, (depth, rate, *_) = self.constants, self.begun(path)
        if depth > 0.0 or math.isinf(c.mass):
            return math.inf
        if c.spring * -depth <= NO_SPRING * c.weight:
            speed = math.sqrt(rate * rate - 2.0 * depth * c.weight / c.mass)
            return (
                -2.0 * depth / (rate + speed) if rate > 0.0 else (speed - rate) * c.mass / c.weight
            )
        turns, sags = math.sqrt(c.spring / c.mass), c.depth + c.weight / c.spring
        swing, phase = (
            math.hypot(depth - sags, rate / turns),
            math.atan2(-rate / turns, depth - sags),
        )
        return (-math.acos(max(-sags / swing, -1.0)) - phase) % (2.0 * math.pi) / turns

    @property
    def steepest(self) -> float:
        """The largest slope of the indenter at the edges of the contact at rest."""
        edges = np.array(span(self.constants.surface, self.at_rest.depth))
        return float(abs(kernels.surface_at(self.constants.surface, edges, 0.0)[1]).max())

    def height(self, x: Any, y: Any = 0.0) -> Any:
        """Return h(x, y)."""
        return kernels.surface_at(self.constants.surface, x, y)[0]


def contact(c: Constants, depth: float, V: float = 0.0) -> Contact:
    """Return the contact of elements at a depth that slide steadily; without a spacing, of `SAMPLES`."""
    (low, high), law = span(c.surface, depth), c.law
    dx = c.spacing or (high - low) / SAMPLES[c.surface.ball]
    dy = c.across or strip_width(c.surface, depth, dx)
    wide = c.surface.stretch * high
    numbers = np.arange(math.floor(low / dx) - kernels.SPARE, math.ceil(high / dx) + kernels.SPARE)
    x, weights = dx * (numbers + c.shift), np.ones(1)
    extent = force = tilt = 0.0
    if dy:
        weights = kernels.weigh(np.empty(1 + int(wide / dy)), dy, wide if c.parts else 0.0)
    for j, weight in enumerate(weights):
        h, slope = kernels.surface_at(c.surface, x, j * dy)
        p = law.pressure(depth - h, -V * slope)
        pressed = (h <= depth) & (p >= 0.0)
        area = weight * dx
        extent, force = extent + area * pressed.sum(), force + area * p[pressed].sum()
        tilt += area * np.square(slope[pressed]).sum()
        for i in np.flatnonzero(np.diff(pressed)) + 1 if c.parts else ():
            out = depth - (h[i : i + 3] if pressed[i - 1] else h[i - 3 : i][::-1])
            kink, *_ = kernels.kink_area(out)
            force += area * law.stiffness * kink
    return Contact(float(extent), float(force), float(tilt))


def sunk_depth(c: Constants, V: float = 0.0) -> float:
    """Return the depth at which this contact carries the load: to the last digit at rest.

    By Newton's method for ln(force) over ln(depth), which is nearly straight: for a power law it needs one
    step from anywhere. The steps stall where the force jumps with the number of elements.
    """
    depth, step, width, law = c.depth, math.inf, 1.0, c.law
    while True:
        before, found = step, contact(c, depth, V)
        if c.surface.ball:
            width = 2.0 * c.surface.stretch * span(c.surface, depth)[1]
        force, wanted = found.force + c.spring * depth, c.weight + c.spring * c.depth
        slope = law.stiffness * found.extent + law.damping * abs(V) * width + c.spring
        step = depth * math.expm1(math.log(wanted / force) * force / (slope * depth))
        depth += step
        if not DEPTH_RTOL * depth < abs(step) < STALLED * abs(before):
            return depth


def strip_width(s: Surface, depth: float, dx: float, fewest: int = FEWEST_STRIPS[False]) -> float:
    """Return the width of a strip of a ball, and 0 of a line contact."""
    right = span(s, depth)[1]
    return s.stretch * min(PER_STRIP * dx, right / fewest) if s.ball else 0.0


@lru_cache(maxsize=64)
def surface_of(indenter: Indenter) -> Surface:
    """Return the indenter as the kernels know it.

    >>> from kvtheory.scene.indenters import Wedge
    >>> surface_of(Wedge(inclination=0.5))[:3]
    (1.0, 1.0, 0.5)
    """
    line: Any = getattr(indenter, "profile", indenter)
    across, stretch = 0.0, 1.0
    if isinstance(line, Circle):
        steep, size, exponent = 1.0, line.radius, 0.0
    else:  # a shape without a power is called, and not compiled
        steep, size, exponent = getattr(line, "power", (1.0, 1.0, -1.0))
    if isinstance(indenter, Sphere):
        across, stretch = 0.5 / (indenter.radius_across or indenter.radius), indenter.stretch
    elif isinstance(indenter, Revolved) and exponent == 2.0:
        across = 0.5 / size
    inside = math.nextafter(indenter.reach, 0.0) if math.isfinite(indenter.reach) else math.inf
    return Surface(
        float(size), float(exponent), float(steep), inside, float(across), isinstance(indenter, Revolved),
        float(stretch), line if exponent < 0.0 else None,
    )  # fmt: skip


@lru_cache(maxsize=1024)
def span(s: Surface, depth: float) -> tuple[float, float]:
    """Return the places, left and right of the lowest point, where h = `depth`, at most the reach.

    >>> from kvtheory.scene.indenters import Wedge
    >>> span(surface_of(Wedge(inclination=0.5)), 0.25)
    (-0.5, 0.5)
    """
    return -kernels.extent(s, depth, -1.0), kernels.extent(s, depth, 1.0)
