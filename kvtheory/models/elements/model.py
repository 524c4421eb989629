"""The scene as the simulator sees it: plain numbers in SI, and an indenter as arrays.

A line contact is one row of elements, and what acts on it is per unit width. A ball has a row, or strip,
at each y = 0, dy, 2 dy, ..., and its forces are sums over strips (`strips`).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.elements import kernels
from kvtheory.models.elements.law import RIGHT, Array, ContactRule, Law
from kvtheory.models.elements.schemes import Scheme
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.capabilities import lacks_arms, require
from kvtheory.scene.indenters import Circle, Indenter, PowerLaw, Profile, Revolved, Sphere, Wedge
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState, out_of_range

LEVEL = 1.1
"""Ratio of the depths at which the span of a Python function is found; between, a power of the depth."""
PER_STRIP = 6.0
"""Elements along as wide as a strip, on a ball that is round: then both spacings matter about as much."""
FEWEST_STRIPS = 16
"""From the middle plane to the rim at rest."""
FEWEST, MOST = 8, 2_000_000
"""Elements in contact at rest: with fewer there is no contact to speak of, with more no memory."""
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
        support, law, fixed = scene.support, Law.of_foundation(scene.foundation), scene.held
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
        return self.surface.stretch * span(self.indenter, depth)[1]

    @cached_property
    def surface(self) -> kernels.Surface:
        """The indenter as the kernels know it."""
        return surface_of(self.indenter)

    @cached_property
    def profile(self) -> "PythonProfile | None":
        """The profile if it is a Python function, which is interpreted."""
        line = self.indenter.profile if isinstance(self.indenter, Revolved) else self.indenter
        return PythonProfile(line, self.depth) if isinstance(line, Profile) else None

    def constants(self, scheme: Scheme, deepest: float) -> dict[str, Any]:
        """Return the fields of `kernels.Elements` that stay as they are, for indenters above `deepest`."""
        names = ["spacing", "shift", "across", "mass", "weight", "spring", "depth", "half_length"]
        names += ["mass_along", "spring_along", "damping_along"]
        return {name: float(getattr(self, name)) for name in names} | {
            "surface": self.surface, "profile": self.profile, "rule": self.rule, "parts": self.parts,
            "law": self.law if self.rule.relaxes else self.law._replace(rates=0.0 * self.law.rates),
            "tableau": scheme.table, "fitted": scheme.fitted, "explicit": bool(scheme.tableau),
            "per_width": self.indenter.per_width, "deepest": deepest,
            "rest_velocity": self.at_rest.velocity, "kinks": np.array(self.indenter.kinks, dtype=float),
        }  # fmt: skip

    def height(self, x: Any, y: Any = 0.0) -> Any:
        """Return h(x, y), huge where the indenter has no surface."""
        return kernels.height_at(self.surface, self.profile, x, y)

    def slope(self, x: Any, y: Any = 0.0) -> Any:
        """Return dh/dx, zero where the indenter has no surface."""
        return kernels.slope_at(self.surface, self.profile, x, y)

    def strips(self, depth: float) -> int:
        """Return how many strips can be met at this depth."""
        return 1 + int(self.half_width(depth) / self.across) if self.across else 1

    def under(self, depth: float) -> tuple[int, int]:
        """Return the range of elements, with some to spare, that can be met at this depth at Y = 0."""
        low, high = span(self.indenter, depth)
        return math.floor(low / self.spacing) - kernels.SPARE, math.ceil(
            high / self.spacing
        ) + kernels.SPARE

    def weights(self, depth: float) -> Array:
        """Return the weight of the force of each strip: 1, or its width in m."""
        if not self.across:
            return np.ones(1)
        rim = self.half_width(depth) if self.parts else 0.0
        return kernels.weights_across(self.across, self.strips(depth), rim)

    def static_load(self, depth: float) -> float:
        """Return K times the area of max(δ - h, 0), as the elements at rest carry it."""
        x, area = self.spacing * (np.arange(*self.under(depth)) + self.shift), 0.0
        for j, weight in enumerate(self.weights(depth)):
            overlap = depth - self.height(x, j * self.across)
            sums = float(overlap[overlap > 0.0].sum())
            runs = kernels.runs_of((overlap > 0.0)[None, :], [0], [x.size]) if self.parts else ()
            for _, low, high in runs:
                sums += kernels.kink_area(overlap[low - 3 : low][::-1])[0]
                sums += kernels.kink_area(overlap[high : high + 3])[0]
            area += weight * sums
        return self.law.stiffness * self.spacing * float(area)

    def tilt(self, extent: float) -> float:
        """Return the integral of h'^2 over a contact of this length or area, as steep as the one at rest."""
        x, y, weight = self.samples(self.depth)
        inside = weight * (self.height(x, y) <= self.depth)
        return extent * float(inside @ np.square(self.slope(x, y))) / float(inside.sum())

    def sliding(self, depth: float, V: float) -> tuple[float, float]:
        """Return extent and normal force of a contact that slides steadily on a continuous foundation."""
        x, y, weight = self.samples(depth)
        g = depth - self.height(x, y)
        p = self.law.pressure(g, -V * self.slope(x, y))
        pressed = (p > 0.0) & (g >= 0.0)
        return float(weight @ pressed), float(weight[pressed] @ p[pressed])

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
        return x, y, dx * np.repeat(kernels.weights_across(dy, strips, 0.0), along)

    def sliding_depth(self, V: float) -> float:
        """Return the depth at which that contact carries the load, to within a thousandth."""

        def surplus(depth: float) -> float:
            force = self.sliding(depth, V)[1] + self.spring * (depth - self.depth)
            return force / self.weight - 1.0

        return root(surplus, self.depth, 1e-9)


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


@lru_cache(maxsize=64)
def surface_of(indenter: Indenter) -> kernels.Surface:
    """Return the indenter as the kernels know it.

    >>> surface_of(Wedge(inclination=0.5)).kind == kernels.WEDGE
    True
    """
    revolved = isinstance(indenter, Revolved)
    line = indenter.profile if isinstance(indenter, (Revolved, Sphere)) else indenter
    kind, size, exponent = kernels.PARABOLA, 1.0, 2.0
    if isinstance(line, Wedge):
        kind, size = kernels.WEDGE, line.inclination
    elif isinstance(line, PowerLaw):
        kind, size, exponent = kernels.POWER_LAW, line.length, line.exponent
    elif not isinstance(line, Profile):
        kind, size = kernels.CIRCLE if isinstance(line, Circle) else kernels.PARABOLA, line.radius
    across, stretch = 0.0, 1.0
    if isinstance(indenter, Sphere):
        stretch = indenter.stretch
        across = 0.5 / (indenter.radius_across or indenter.radius)
    inside = math.nextafter(indenter.reach, 0.0) if math.isfinite(indenter.reach) else math.inf
    return kernels.Surface(
        kind, float(size), float(exponent), inside, float(across), revolved, float(stretch)
    )


class PythonProfile(NamedTuple):
    """A profile of Python functions; how far out it has a height is found at some depths only."""

    line: Profile
    depth: float

    def height(self, x: Any) -> Any:
        """Return h(x)."""
        return self.line.height(x)

    def slope(self, x: Any) -> Any:
        """Return h'(x)."""
        return self.line.slope(x)

    def extent(self, depth: float, side: float) -> float:
        """Return about how far to one side h = `depth` is."""
        level = math.log(max(depth / self.depth, 1e-6)) / math.log(LEVEL)
        below = math.floor(level)
        low, high = (
            span(self.line, self.depth * LEVEL**k)[side > 0.0] * side for k in (below, below + 1)
        )
        return float(low * (high / low) ** (level - below))


@lru_cache(maxsize=1024)
def span(indenter: Indenter, depth: float) -> tuple[float, float]:
    """Return the two places, left and right of its lowest point, where h = `depth`.

    Beyond the reach of the shape there is no surface: then the reach counts.

    >>> span(Wedge(inclination=0.5), 0.25)
    (-0.5, 0.5)
    """
    surface = surface_of(indenter)
    line = indenter.profile if isinstance(indenter, Revolved) else indenter
    if not isinstance(line, Profile):
        far = kernels.extent(surface, None, depth, 1.0)
        return -far, far
    end, ends = surface.inside, []
    for side in (-1.0, 1.0):
        if math.isfinite(end) and line.height(side * end) < depth:
            ends.append(side * end)
        else:
            height = lambda x, side=side: float(line.height(side * min(x, end))) - depth  # noqa: E731
            ends.append(side * root(height, min(depth, end)))
    return ends[0], ends[1]
