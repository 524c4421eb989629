"""The scene as the simulator sees it: plain numbers in SI, and an indenter as arrays."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.indenters import Indenter
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

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
    """

    indenter: Indenter
    stiffness: float
    retardation_time: float
    spacing: float
    mass: float
    weight: float
    spring: float
    depth: float
    at_rest: Any = None

    @classmethod
    def of(cls, scene: Scene, spacing: float | None = None) -> "Model":
        """Return the model of a scene; without a spacing, with `SAMPLES` elements in contact at rest.

        Raises
        ------
        ValueError
            If there are too few or too many elements in the contact.
        """
        support, foundation = scene.support, scene.foundation
        fixed = scene.held
        model = cls(
            scene.indenter, foundation.stiffness, foundation.retardation_time, spacing or 1.0,
            support.mass, support.weight, 0.0 if fixed else support.spring, support.depth or 1.0,
        )  # fmt: skip
        rough = model.depth if fixed else model._rough_depth()
        low, high = span(model.indenter, rough)
        if spacing is None:
            spacing = (high - low) / SAMPLES
            model = replace(model, spacing=spacing)
        if not FEWEST <= (high - low) / spacing <= MOST:
            raise ValueError(
                f"`per_length` = {1 / spacing:.6g} 1/m: expected {FEWEST / (high - low):.3g} to "
                f"{MOST / (high - low):.3g} 1/m, so that {FEWEST} to {MOST} elements carry the indenter"
            )
        depth = rough if fixed else model._static_depth(rough)
        model = replace(model, depth=depth)
        at_rest = StaticState.at(scene, depth, model.half_length, model.static_load(depth))
        return replace(model, at_rest=at_rest)

    def path(self, scene: Scene) -> BaseMotion:
        """Return the motion of the base until the end of the run."""
        least = self.half_length / self.retardation_time
        return scene.drive.motion(scene.run.duration, least)

    @property
    def damping(self) -> float:
        """C = K τ, in N s/m^3."""
        return self.stiffness * self.retardation_time

    @property
    def half_length(self) -> float:
        """Half the length of the contact at rest, in m."""
        low, high = span(self.indenter, self.depth)
        return 0.5 * (high - low)

    def height(self, x: Array) -> Array:
        """Return h(x), infinite where the indenter has no surface."""
        if math.isinf(self.indenter.reach):
            return np.asarray(self.indenter.height(x))
        inside = np.abs(x) < self.indenter.reach
        return np.where(inside, self.indenter.height(np.where(inside, x, 0.0)), math.inf)

    def slope(self, x: Array) -> Array:
        """Return h'(x), zero where the indenter has no surface."""
        if math.isinf(self.indenter.reach):
            return np.asarray(self.indenter.slope(x))
        inside = np.abs(x) < self.indenter.reach
        return np.where(inside, self.indenter.slope(np.where(inside, x, 0.0)), 0.0)

    def under(self, Y: float, depth: float) -> tuple[int, int]:
        """Return the range of elements, with some to spare at each end, that can be met at this depth."""
        level = math.ceil(math.log(max(depth / self.depth, 1e-6)) / math.log(LEVEL))
        low, high = span(self.indenter, self.depth * LEVEL**level)
        dx = self.spacing
        return math.floor((low - Y) / dx) - SPARE, math.ceil((high - Y) / dx) + SPARE + 1

    def static_load(self, depth: float) -> float:
        """Return K times the sum of max(δ - h, 0) dx over the elements at rest."""
        first, last = (round(end / self.spacing) for end in span(self.indenter, depth))
        x: Array = self.spacing * np.arange(first - 1, last + 2, dtype=np.float64)
        g = np.maximum(depth - self.height(x), 0.0)
        return self.stiffness * self.spacing * float(g.sum())

    def _rough_depth(self) -> float:
        """Return a depth at which a continuous foundation carries the weight to within a thousandth."""

        def surplus(depth: float) -> float:
            low, high = span(self.indenter, depth)
            x: Array = np.linspace(low, high, SAMPLES, dtype=np.float64)
            area = float(np.trapezoid(depth - self.height(x), x))
            return self.stiffness * area / self.weight - 1.0

        depth = 1.0
        while surplus(depth) < 0.0:
            depth *= 2.0
        while surplus(0.5 * depth) > 0.0:
            depth *= 0.5
        return float(brentq(surplus, 0.5 * depth, depth, rtol=1e-12, xtol=1e-300))

    def _static_depth(self, rough: float) -> float:
        """Return the depth at which the elements at rest carry the weight."""
        return float(
            brentq(lambda depth: self.static_load(depth) - self.weight, 0.25 * rough, 4.0 * rough,
                   rtol=1e-15, xtol=1e-300)
        )  # fmt: skip


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
    x = min(depth, end)
    while indenter.height(side * x) < depth:
        if x == end:
            return end
        x = min(2.0 * x, end)
    low = x
    while indenter.height(side * low) > depth:
        low *= 0.5
    if low == x:
        return x
    return float(
        brentq(lambda y: float(indenter.height(side * y)) - depth, low, x, rtol=1e-15, xtol=1e-300)
    )
