"""The scene as the simulator sees it: plain numbers in SI, and an indenter as arrays.

A line contact is one row of elements, and what acts on it is per unit width. A ball has a row, or strip,
at each y = 0, dy, 2 dy, ..., and its forces are sums over strips.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.elements import kernels
from kvtheory.models.elements.schemes import RIGHT, ContactRule
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.capabilities import lacks_arms, require
from kvtheory.scene.indenters import Circle, Indenter, PowerLaw, Profile, Revolved, Sphere, Wedge
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState, out_of_range
from kvtheory.theory.laws import Array, Element

LEVEL = 1.1
"""Ratio of the depths at which the span of a Python profile is found; a power law interpolates it."""
PER_STRIP = 6.0
"""Width of a strip in elements, on a round ball: then both spacings matter about equally."""
FEWEST_STRIPS = 16
"""From the middle plane to the rim at rest."""
FEWEST, MOST = 8, 2_000_000
"""Elements in contact at rest: fewer do not resolve the contact, more do not fit in memory."""
SAMPLES, SAMPLES_ALONG, SAMPLES_ACROSS = 2049, 257, 16
"""Of the surface, where a depth is wanted to about a thousandth; of a ball, along a strip and to its rim."""


@dataclass(frozen=True)
class Model:
    """An indenter (depth δ, mass M) over elements with the spacing dx, all in SI.

    `mass` is infinite for a fixed indenter; `depth` is the static depth δ_0; `at_rest` scales errors.
    Along x the indenter has `mass_along` M_x, infinite on a rigid drive, on a spring k_x and a damper c_x.
    At t = 0 an element is at x = `shift` dx; `parts` says whether the part of one at each edge counts.
    `across` is the distance dy of the strips of a ball, zero for a line contact.
    `rule` and `start`, the depth at t = 0 relative to δ_0, may be set wrong on purpose.
    """

    indenter: Indenter
    law: Element
    spacing: float
    mass: float
    weight: float
    spring: float
    depth: float
    parts: bool = False
    shift: float = 0.0
    across: float = 0.0
    at_rest: Any = None
    rule: ContactRule = RIGHT
    start: float = 1.0
    mass_along: float = math.inf
    spring_along: float = 0.0
    damping_along: float = 0.0

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
        law = Element.of(given.stiffness, 0.0 if arms else given.damping, arms)
        model = cls(scene.indenter, law, 1.0, support.mass, support.weight, 0.0, support.depth or 1.0,
                    parts, shift)  # fmt: skip
        if not drive.rigid:
            model = replace(model, mass_along=scene.drive_mass, spring_along=drive.stiffness or 0.0,
                            damping_along=drive.damping)  # fmt: skip
        if not all(map(math.isfinite, span(model.indenter, model.depth))):
            raise ValueError(out_of_range(scene))
        depth = model.depth if scene.held else model.sliding_depth(0.0)
        low, high = span(model.indenter, depth)
        dx = spacing or (high - low) / SAMPLES
        if not FEWEST <= (high - low) / dx <= MOST:
            raise ValueError(
                f"`per_length` = {1 / dx:.6g} 1/m: expected {FEWEST / (high - low):.3g} to "
                f"{MOST / (high - low):.3g} 1/m, so that {FEWEST} to {MOST} elements carry the indenter"
            )
        model = replace(model, spacing=coarser * dx)
        if not scene.indenter.per_width:
            dy = model.half_width(depth) * min(PER_STRIP * dx / high, 1.0 / FEWEST_STRIPS)
            model = replace(model, across=coarser * (1.0 + 0.5 * shift) * dy)
        if not scene.held:
            depth = root(lambda d: model.static_load(d) - model.weight, depth)
            model = replace(model, spring=support.spring, depth=depth)
        at_rest = StaticState.at(scene, depth, model.half_length, model.static_load(depth))
        return replace(model, at_rest=at_rest)

    @property
    def sprung(self) -> bool:
        """Whether the indenter moves along x."""
        return math.isfinite(self.mass_along)

    def fastest(self, path: BaseMotion) -> float:
        """Return the speed of sliding to expect, in m/s: that of the drive, and of a spring let go.

        Friction throws the mass along x to about F/sqrt(k_x M_x), F = W_0 δ_0/a_0, and through the
        dampers of the contact no faster than about a_0/τ.
        """
        if not self.sprung:
            return path.highest_speed
        swing = math.sqrt(self.spring_along * self.mass_along)
        thrown = self.at_rest.friction_force / swing if swing else math.inf
        return path.highest_speed + min(thrown, self.at_rest.velocity)

    def path(self, scene: Scene) -> BaseMotion:
        """Return the motion of the base until the end of the run."""
        return scene.drive.motion(scene.run.duration, self.half_length / self.law.retardation_time)

    @property
    def half_length(self) -> float:
        """Half the length of the contact at rest, in m."""
        low, high = span(self.indenter, self.depth)
        return 0.5 * (high - low)

    @property
    def extent(self) -> float:
        """The length (m) of the contact at rest, of a ball its area (m^2)."""
        across = 1.0 if self.indenter.per_width else 0.5 * math.pi * self.half_width(self.depth)
        return 2.0 * self.half_length * across

    @property
    def steepest(self) -> float:
        """The largest slope of the indenter at the edges of the contact at rest."""
        return float(abs(self.slope(np.array(span(self.indenter, self.depth)))).max())

    def half_width(self, depth: float) -> float:
        """Return half the width of a ball at a height, in m."""
        return self.surface.stretch * span(self.indenter, depth)[1]

    @cached_property
    def surface(self) -> kernels.Surface:
        """The indenter in the form that the kernels use."""
        return surface_of(self.indenter)

    @cached_property
    def profile(self) -> "PythonProfile | None":
        """The profile if it is given by Python functions; its extent is interpolated between some depths."""
        line = getattr(self.indenter, "profile", self.indenter)
        if not isinstance(line, Profile):
            return None

        def extent(depth: float, side: float) -> float:
            level = math.log(max(depth / self.depth, 1e-6)) / math.log(LEVEL)
            below = math.floor(level)
            depths = (self.depth * LEVEL**k for k in (below, below + 1))
            low, high = (side * span(line, each)[side > 0.0] for each in depths)
            return float(low * (high / low) ** (level - below))

        return PythonProfile(line.height, line.slope, extent)

    def height(self, x: Any, y: Any = 0.0) -> Any:
        """Return h(x, y), huge where the indenter has no surface."""
        return kernels.surface_at(self.surface, self.profile, x, y)[0]

    def slope(self, x: Any, y: Any = 0.0) -> Any:
        """Return dh/dx, zero where the indenter has no surface."""
        return kernels.surface_at(self.surface, self.profile, x, y)[1]

    def strips(self, depth: float) -> int:
        """Return the number of strips that can be in contact at this depth."""
        return 1 + int(self.half_width(depth) / self.across) if self.across else 1

    def static_load(self, depth: float) -> float:
        """Return K times the area of max(δ - h, 0), as the elements at rest carry it."""
        low, high = span(self.indenter, depth)
        first = math.floor(low / self.spacing) - kernels.SPARE
        numbers = np.arange(first, math.ceil(high / self.spacing) + kernels.SPARE)
        x, area, weights = self.spacing * (numbers + self.shift), 0.0, np.ones(1)
        if self.across:
            rim = self.half_width(depth) if self.parts else 0.0
            weights = kernels.weigh(np.empty(self.strips(depth)), self.across, rim)
        for j, weight in enumerate(weights):
            overlap = depth - self.height(x, j * self.across)
            pressed = overlap > 0.0
            sums = float(overlap[pressed].sum())
            for i in kernels.crossing(overlap, 0.0, 1, x.size) if self.parts else ():
                out = overlap[i : i + 3] if pressed[i - 1] else overlap[i - 3 : i][::-1]
                sums += kernels.kink_area(out)[0]
            area += weight * sums
        return self.law.stiffness * self.spacing * float(area)

    def tilt(self, extent: float) -> float:
        """Return the integral of h'^2 over a contact of this length or area, as steep as the one at rest."""
        h, slope, weight = self._samples(self.depth)
        inside = weight * (h <= self.depth)
        return extent * float(inside @ np.square(slope)) / float(inside.sum())

    def sliding(self, depth: float, V: float) -> tuple[float, float]:
        """Return extent and normal force of a contact that slides steadily on a continuous foundation."""
        h, slope, weight = self._samples(depth)
        p = self.law.pressure(depth - h, -V * slope)
        pressed = (p > 0.0) & (h <= depth)
        return float(weight @ pressed), float(weight[pressed] @ p[pressed])

    def sliding_depth(self, V: float) -> float:
        """Return the depth at which that contact carries the load, to within a thousandth."""
        force = lambda d: self.sliding(d, V)[1] + self.spring * (d - self.depth)  # noqa: E731
        return root(lambda d: force(d) / self.weight - 1.0, self.depth, 1e-9)

    def _samples(self, depth: float) -> tuple[Array, Array, Array]:
        """Return h and dh/dx at points under the indenter, and their quadrature weights, in m or m^2."""
        along, strips, across = SAMPLES, 1, np.ones(1)
        if not self.indenter.per_width:
            along, strips = SAMPLES_ALONG, SAMPLES_ACROSS
        low, high = span(self.indenter, depth)
        dx, dy = (high - low) / (along - 1), self.half_width(depth) / strips
        if strips > 1:
            across = kernels.weigh(np.empty(strips), dy, 0.0)
        x = np.tile(np.linspace(low, high, along), strips)
        y = np.repeat(dy * np.arange(strips), along)
        return self.height(x, y), self.slope(x, y), np.repeat(dx * across, along)


def root(function: Callable[[float], float], guess: float, rtol: float = 0.0) -> float:
    """Return where an increasing function of x > 0 becomes positive: to the last digit, or to `rtol`.

    Infinite if it never does. By false position (Illinois), bisecting every fourth time: SciPy's would be
    as fast, but takes longer to import than most runs.

    >>> root(lambda x: x * x - 2.0, 1.0)
    1.4142135623730951
    """
    low = high = guess
    below = above = function(guess)
    while above < 0.0 and high < math.inf:
        low, below, high = high, above, 2.0 * high
        above = function(high)
    while below > 0.0:
        high, above, low = low, below, 0.5 * low
        below = function(low)
    step, rising = 0, None
    while low < (x := 0.5 * (low + high)) < high and high - low > rtol * high:
        step += 1
        if step % 4 and 0.0 < above - below < math.inf:
            secant = low - below * ((high - low) / (above - below))
            x = min(max(secant, math.nextafter(low, high)), math.nextafter(high, low))
        value, before = function(x), rising
        rising = value > 0.0
        kept = 0.5 if before is rising else 1.0
        if rising:
            high, above, below = x, value, below * kept
        else:
            low, below, above = x, value, above * kept
    return high


@lru_cache(maxsize=64)
def surface_of(indenter: Indenter) -> kernels.Surface:
    """Return the indenter as the kernels know it.

    >>> surface_of(Wedge(inclination=0.5))[:3]
    (1.0, 1.0, 0.5)
    """
    line: Any = getattr(indenter, "profile", indenter)
    size, exponent, steep, across, stretch = 1.0, -1.0, 1.0, 0.0, 1.0
    if isinstance(line, Wedge):
        exponent, steep = 1.0, line.inclination
    elif isinstance(line, PowerLaw):
        size, exponent = line.length, line.exponent
    elif not isinstance(line, Profile):
        size, exponent = line.radius, 0.0 if isinstance(line, Circle) else 2.0
    if isinstance(indenter, Sphere):
        across, stretch = 0.5 / (indenter.radius_across or indenter.radius), indenter.stretch
    elif isinstance(indenter, Revolved) and exponent == 2.0:
        across = 0.5 / size
    inside = math.nextafter(indenter.reach, 0.0) if math.isfinite(indenter.reach) else math.inf
    return kernels.Surface(
        float(size), float(exponent), float(steep), inside, float(across),
        isinstance(indenter, Revolved), float(stretch),
    )  # fmt: skip


class PythonProfile(NamedTuple):
    """Height h(x), slope h'(x), and extent to one side at a depth, by Python functions."""

    height: Callable[[Any], Any]
    slope: Callable[[Any], Any]
    extent: Callable[[float, float], float]


@lru_cache(maxsize=1024)
def span(indenter: Indenter, depth: float) -> tuple[float, float]:
    """Return the two places, left and right of its lowest point, where h = `depth`.

    Beyond the reach of the shape there is no surface: then the reach counts.

    >>> span(Wedge(inclination=0.5), 0.25)
    (-0.5, 0.5)
    """
    line, far = getattr(indenter, "profile", indenter), surface_of(indenter).inside
    if not isinstance(line, Profile):
        reached = kernels.extent(surface_of(indenter), None, depth, 1.0)
        return -reached, reached

    def reach(side: float) -> float:
        if math.isfinite(far) and line.height(side * far) < depth:
            return far
        return root(lambda x: float(line.height(side * min(x, far))) - depth, min(depth, far))

    return -reach(-1.0), reach(1.0)
