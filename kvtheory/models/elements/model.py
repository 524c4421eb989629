"""The scene as the simulator sees it: plain numbers in SI, and an indenter as arrays."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from kvtheory.models.elements.edges import edges_of, gaps, kink_area
from kvtheory.models.elements.law import RIGHT, Array, ContactRule, Law
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.indenters import Indenter
from kvtheory.scene.model import Scene
from kvtheory.scene.requirements import lacks_arms, require
from kvtheory.scene.static_state import StaticState

LEVEL = 1.1
"""Ratio of the depths for which the span of the indenter is kept: a tenth more elements than needed."""
FEWEST, MOST = 8, 2_000_000
"""Elements in contact at rest: with fewer there is no contact to speak of, with more no memory."""
SPARE = 4
"""Elements beyond those that can be met: the surface is extended from three of them."""
SAMPLES = 2049
"""Of the surface, where a depth is wanted to about a thousandth."""


@dataclass(frozen=True)
class Model:
    """An indenter (depth δ, mass M) over elements with the spacing dx, all in SI.

    `mass` is infinite for a fixed indenter; `depth` is the static depth δ_0; `at_rest` measures errors.
    Along x the indenter has `mass_along` M_x, infinite on a rigid drive, on a spring k_x and a damper c_x.
    At t = 0 an element is at x = `shift` dx; `parts` says whether the part of one at each edge counts.
    `rule` and `start`, the depth at t = 0 relative to δ_0, may be wrong on request.
    """

    indenter: Indenter
    law: Law
    spacing: float
    mass: float
    weight: float
    spring: float
    depth: float
    parts: bool = False
    shift: float = 0.0
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

        The elements are `coarser` times as far apart as the spacing says.

        Raises
        ------
        ValueError
            If there are too few or too many elements in the contact.
        """
        require(lacks_arms, scene, "the simulator")
        support, law, fixed = scene.support, Law.of(scene.foundation), scene.held
        model = cls(
            scene.indenter, law, 1.0, support.mass, support.weight, 0.0,
            support.depth or 1.0, parts, shift,
        )  # fmt: skip
        rough = model.depth if fixed else model.sliding_depth(0.0)
        low, high = span(model.indenter, rough)
        dx = spacing or (high - low) / SAMPLES
        if not FEWEST <= (high - low) / dx <= MOST:
            raise ValueError(
                f"`per_length` = {1 / dx:.6g} 1/m: expected {FEWEST / (high - low):.3g} to "
                f"{MOST / (high - low):.3g} 1/m, so that {FEWEST} to {MOST} elements carry the indenter"
            )
        model = replace(model, spacing=coarser * dx, spring=0.0 if fixed else support.spring)
        depth = rough if fixed else root(lambda d: model.static_load(d) - model.weight, rough)
        model = replace(model, depth=depth)
        at_rest = StaticState.at(scene, depth, model.half_length, model.static_load(depth))
        model = replace(model, at_rest=at_rest)
        return model if scene.drive.rigid else model.on_spring(scene)

    def on_spring(self, scene: Scene) -> "Model":
        """Return the model with the indenter held along x as the drive of the scene does."""
        drive = scene.drive
        return replace(
            self, mass_along=scene.drive_mass, spring_along=drive.stiffness or 0.0,
            damping_along=drive.damping,
        )  # fmt: skip

    @cached_property
    def sprung(self) -> bool:
        """Whether the indenter moves along x."""
        return math.isfinite(self.mass_along)

    def fastest(self, path: BaseMotion) -> float:
        """Return the speed of sliding to expect, in m/s: that of the drive, and of a spring let go.

        Friction throws the mass along x to about F/sqrt(k_x M_x), F = W_0 δ_0/a_0, and through the
        dampers of the contact no faster than about a_0/τ.
        """
        at_rest, own = self.at_rest, 0.0
        if self.sprung:
            swing = math.sqrt(self.spring_along * self.mass_along)
            own = min(at_rest.friction_force / swing if swing else math.inf, at_rest.velocity)
        return path.highest_speed + own

    def path(self, scene: Scene) -> BaseMotion:
        """Return the motion of the base until the end of the run."""
        return scene.drive.motion(scene.run.duration, self.half_length / self.law.retardation_time)

    @property
    def half_length(self) -> float:
        """Half the length of the contact at rest, in m."""
        low, high = span(self.indenter, self.depth)
        return 0.5 * (high - low)

    def height(self, x: Any) -> Any:
        """Return h(x), infinite where the indenter has no surface."""
        return self._within_reach(self.indenter.height, x, math.inf)

    def slope(self, x: Any) -> Any:
        """Return h'(x), zero where the indenter has no surface."""
        return self._within_reach(self.indenter.slope, x, 0.0)

    def places(self, low: int, high: int, Y: float = 0.0) -> Array:
        """Return x of the elements `low` to `high` when the base has moved by Y."""
        x: Array = self.spacing * (np.arange(low, high, dtype=np.float64) + self.shift) + Y
        return x

    def under(self, Y: float, before: float, depth: float) -> tuple[int, int]:
        """Return the range of elements, with some to spare, that can be met at this depth at both places."""
        level = math.ceil(math.log(max(depth / self.depth, 1e-6)) / math.log(LEVEL))
        low, high = span(self.indenter, self.depth * LEVEL**level)
        dx = self.spacing
        first = math.floor((low - max(Y, before)) / dx) - SPARE
        return first, math.ceil((high - min(Y, before)) / dx) + SPARE + 1

    def static_load(self, depth: float) -> float:
        """Return K times the area of max(δ - h, 0), as the elements at rest carry it."""
        low, high = (round(end / self.spacing) for end in span(self.indenter, depth))
        overlap = depth - self.height(self.places(low - SPARE, high + SPARE + 1))
        pressed = overlap > 0.0
        area = self.spacing * float(overlap[pressed].sum())
        if self.parts:
            ends = edges_of(pressed)
            area += sum(kink_area(self.spacing, gaps(overlap, *edge))[0] for edge in ends)
        return self.law.stiffness * area

    def tilt(self, length: float) -> float:
        """Return ∫ h'^2 dx of a contact of this length, as steep as the one at rest."""
        x = np.linspace(*span(self.indenter, self.depth), SAMPLES)
        return length * float(np.square(self.slope(x)).mean())

    def sliding(self, depth: float, V: float) -> tuple[float, float]:
        """Return length and normal force of a contact that slides steadily on a continuous foundation."""
        x = np.linspace(*span(self.indenter, depth), SAMPLES)
        g = depth - self.height(x)
        p = self.law.pressure(self.law.at_rest(g), g, -V * self.slope(x))
        pressed, step = p > 0.0, x[1] - x[0]
        return step * np.count_nonzero(pressed), step * float(p[pressed].sum())

    def sliding_depth(self, V: float) -> float:
        """Return the depth at which that contact carries the load, to within a thousandth."""

        def surplus(depth: float) -> float:
            force = self.sliding(depth, V)[1] + self.spring * (depth - self.depth)
            return force / self.weight - 1.0

        return root(surplus, self.depth, 1e-9)

    def _within_reach(self, function: Callable[[Any], Any], x: Any, beyond: float) -> Any:
        if math.isinf(self.indenter.reach):
            return function(x)
        inside = np.abs(x) < self.indenter.reach
        return np.where(inside, function(np.where(inside, x, 0.0)), beyond)


def root(function: Callable[[float], float], guess: float, rtol: float = 0.0) -> float:
    """Return where an increasing function of x > 0 becomes positive: to the last digit, or to `rtol`.

    SciPy's would be faster, but takes longer to import than most runs.

    >>> root(lambda x: x * x - 2.0, 1.0)
    1.4142135623730951
    """
    low = high = guess
    while function(high) < 0.0:
        low, high = high, 2.0 * high
    while function(low) > 0.0:
        low *= 0.5
    while low < (middle := 0.5 * (low + high)) < high and high - low > rtol * high:
        low, high = (low, middle) if function(middle) > 0.0 else (middle, high)
    return high


@lru_cache(maxsize=512)
def span(indenter: Indenter, depth: float) -> tuple[float, float]:
    """Return the two places, left and right of its lowest point, where h = `depth`.

    Beyond the reach of the shape there is no surface: then the reach counts.

    >>> from kvtheory.scene.indenters import Wedge
    >>> span(Wedge(inclination=0.5), 0.25)
    (-0.5, 0.5)
    """
    return -_extent(indenter, depth, -1.0), _extent(indenter, depth, 1.0)


def _extent(indenter: Indenter, depth: float, side: float) -> float:
    end = math.nextafter(indenter.reach, 0.0)
    if math.isfinite(indenter.reach) and indenter.height(side * end) < depth:
        return end
    return root(lambda x: float(indenter.height(side * min(x, end))) - depth, min(depth, end))
