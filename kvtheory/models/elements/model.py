"""The scene as the simulator sees it: plain numbers in SI, and an indenter as arrays.

A line contact is one row of elements, and what acts on it is per unit width. A ball has a row, or strip,
at each y = 0, dy, 2 dy, ..., and its forces are sums over strips (`strips`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np

from kvtheory.models.elements.edges import BEYOND, kink_area, runs_of
from kvtheory.models.elements.law import RIGHT, Array, ContactRule, Law
from kvtheory.models.elements.strips import FEWEST_STRIPS, PER_STRIP, total, weights_across
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.capabilities import lacks_arms, require
from kvtheory.scene.indenters import Indenter
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState, out_of_range

LEVEL = 1.1
"""Ratio of the depths for which the span of the indenter is kept: a tenth more elements than needed."""
FEWEST, MOST = 8, 2_000_000
"""Elements in contact at rest: with fewer there is no contact to speak of, with more no memory."""
SPARE = 7
"""Elements beyond those that can be met: the surface is extended from three, and three more never are."""
SAMPLES = 2049
"""Of the surface, where a depth is wanted to about a thousandth."""
SAMPLES_ALONG, SAMPLES_ACROSS = 257, 16
"""The same of a ball, along a strip and from its middle plane to its rim."""


@dataclass(frozen=True)
class Model:
    """An indenter (depth δ, mass M) over elements with the spacing dx, all in SI.

    `mass` is infinite for a fixed indenter; `depth` is the static depth δ_0; `at_rest` measures errors.
    Along x the indenter has `mass_along` M_x, infinite on a rigid drive, on a spring k_x and a damper c_x.
    At t = 0 an element is at x = `shift` dx; `parts` says whether the part of one at each edge counts.
    `across` is the distance dy of the strips of a ball, zero for a line contact.
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
        support, law, fixed = scene.support, Law.of(scene.foundation), scene.held
        model = cls(
            scene.indenter, law, 1.0, support.mass, support.weight, 0.0,
            support.depth or 1.0, parts, shift,
        )  # fmt: skip
        if not all(map(math.isfinite, span(model.indenter, model.depth))):
            raise ValueError(out_of_range(scene))
        rough = model.depth if fixed else model.sliding_depth(0.0)
        low, high = span(model.indenter, rough)
        dx = spacing or (high - low) / SAMPLES
        if not FEWEST <= (high - low) / dx <= MOST:
            raise ValueError(
                f"`per_length` = {1 / dx:.6g} 1/m: expected {FEWEST / (high - low):.3g} to "
                f"{MOST / (high - low):.3g} 1/m, so that {FEWEST} to {MOST} elements carry the indenter"
            )
        model = replace(model, spacing=coarser * dx, spring=0.0 if fixed else support.spring)
        if not scene.indenter.per_width:
            dy = model.half_width(rough) * min(PER_STRIP * dx / high, 1.0 / FEWEST_STRIPS)
            model = replace(model, across=coarser * (1.0 + 0.5 * shift) * dy)
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

    @property
    def extent(self) -> float:
        """The length (m) of the contact at rest, of a ball its area (m^2)."""
        length = 2.0 * self.half_length
        if self.indenter.per_width:
            return length
        return 0.5 * math.pi * length * self.half_width(self.depth)

    def half_width(self, depth: float) -> float:
        """Return half the width of a ball at a height, in m."""
        stretch: float = self.indenter.stretch  # type: ignore[union-attr]
        return stretch * _extent(self.indenter, depth, 1.0) if depth > 0.0 else 0.0

    def height(self, x: Any, y: Any = 0.0) -> Any:
        """Return h(x, y), infinite where the indenter has no surface."""
        return self._within_reach(self.indenter.height, (x, y), math.inf)

    def slope(self, x: Any, y: Any = 0.0) -> Any:
        """Return dh/dx, zero where the indenter has no surface."""
        return self._within_reach(self.indenter.slope, (x, y), 0.0)

    def places(self, low: int, high: int, Y: float = 0.0) -> Array:
        """Return x of the elements `low` to `high` when the base has moved by Y."""
        x: Array = self.spacing * (np.arange(low, high, dtype=np.float64) + self.shift) + Y
        return x

    def grid(self, low: int, high: int, strips: int, Y: float = 0.0) -> tuple[Array, Array]:
        """Return x of the elements `low` to `high`, as a row, and y of the strips, as a column."""
        y = self.across * np.arange(strips, dtype=np.float64)
        return self.places(low, high, Y)[None, :], y[:, None]

    def level(self, depth: float) -> float:
        """Return the next of a few depths, so that spans need not be found anew."""
        level = math.ceil(math.log(max(depth / self.depth, 1e-6)) / math.log(LEVEL))
        return self.depth * LEVEL**level

    def strips(self, depth: float) -> int:
        """Return how many strips can be met at this depth."""
        return 1 + int(self.half_width(self.level(depth)) / self.across) if self.across else 1

    def weights(self, depth: float, strips: int) -> Array:
        """Return by what the force of the elements of each strip counts: 1, or the width of the strip in m.

        `depth` says where the rim is.
        """
        if not self.across:
            return np.ones(1)
        return weights_across(self.across, strips, self.half_width(depth) if self.parts else 0.0)

    def under(self, Y: float, before: float, depth: float) -> tuple[int, int]:
        """Return the range of elements, with some to spare, that can be met at this depth at both places."""
        low, high = span(self.indenter, self.level(depth))
        dx = self.spacing
        first = math.floor((low - max(Y, before)) / dx) - SPARE
        return first, math.ceil((high - min(Y, before)) / dx) + SPARE + 1

    @np.errstate(invalid="ignore")  # beyond the reach of a shape
    def static_load(self, depth: float) -> float:
        """Return K times the area of max(δ - h, 0), as the elements at rest carry it."""
        low, high = (round(end / self.spacing) for end in span(self.indenter, depth))
        strips = self.strips(depth)
        overlap = depth - self.height(*self.grid(low - SPARE, high + SPARE + 1, strips))
        weights = self.weights(depth, strips)
        area = self.spacing * float(weights @ np.maximum(overlap, 0.0).sum(axis=1))
        if self.parts:
            runs = runs_of(overlap.ravel() > 0.0)
            weight = weights[runs[:, :1] // overlap.shape[1]]
            kinks = weight * kink_area(overlap.ravel()[runs + BEYOND])[0]
            area += self.spacing * float(kinks.sum())
        return self.law.stiffness * area

    def tilt(self, extent: float) -> float:
        """Return the integral of h'^2 over a contact of this length or area, as steep as the one at rest."""
        x, y, weight = self.samples(self.depth)
        inside = weight * (self.height(x, y) <= self.depth)
        return extent * total(inside, np.square(self.slope(x, y))) / float(inside.sum())

    def sliding(self, depth: float, V: float) -> tuple[float, float]:
        """Return extent and normal force of a contact that slides steadily on a continuous foundation."""
        x, y, weight = self.samples(depth)
        g = depth - self.height(x, y)
        p = self.law.pressure(self.law.at_rest(g), g, -V * self.slope(x, y))
        pressed = (p > 0.0) & (g >= 0.0)
        return total(weight, pressed), total(weight, np.where(pressed, p, 0.0))

    def samples(self, depth: float) -> tuple[Array, Array, Array]:
        """Return x and y of places under the indenter, and for what length (m) or area (m^2) each counts."""
        low, high = span(self.indenter, depth)
        if self.indenter.per_width:
            each = (high - low) / (SAMPLES - 1)
            return np.linspace(low, high, SAMPLES), np.zeros(SAMPLES), np.full(SAMPLES, each)
        along, strips = SAMPLES_ALONG, SAMPLES_ACROSS
        dx, dy = (high - low) / (along - 1), self.half_width(depth) / strips
        x = np.tile(np.linspace(low, high, along), strips)
        y = np.repeat(dy * np.arange(strips), along)
        return x, y, dx * np.repeat(weights_across(dy, strips, 0.0), along)

    def sliding_depth(self, V: float) -> float:
        """Return the depth at which that contact carries the load, to within a thousandth."""

        def surplus(depth: float) -> float:
            force = self.sliding(depth, V)[1] + self.spring * (depth - self.depth)
            return force / self.weight - 1.0

        return root(surplus, self.depth, 1e-9)

    def _within_reach(
        self, function: Callable[..., Any], place: tuple[Any, Any], beyond: float
    ) -> Any:
        needed = place[:1] if self.indenter.per_width else place
        if math.isinf(self.indenter.reach):
            return function(*needed)
        inside = np.hypot(*place) < self.indenter.reach
        return np.where(inside, function(*(np.where(inside, each, 0.0) for each in needed)), beyond)


def root(function: Callable[[float], float], guess: float, rtol: float = 0.0) -> float:
    """Return where an increasing function of x > 0 becomes positive: to the last digit, or to `rtol`.

    Infinite if it nowhere does.

    By false position (Illinois), every fourth step by halves. SciPy's would be as fast, but takes longer to
    import than most runs.

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
    step, side = 0, 0
    while low < (x := 0.5 * (low + high)) < high and high - low > rtol * high:
        step += 1
        if step % 4 and 0.0 < above - below < math.inf:
            secant = low - below * ((high - low) / (above - below))
            x = min(max(secant, math.nextafter(low, high)), math.nextafter(high, low))
        value = function(x)
        if value > 0.0:
            high, above, below = x, value, below * (0.5 if side > 0 else 1.0)
            side = 1
        else:
            low, below, above = x, value, above * (0.5 if side < 0 else 1.0)
            side = -1
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
