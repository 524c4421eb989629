"""Forces and edges at one instant, by whole elements or with a part of one at each edge.

The pressure under the indenter is p = K g + C g', with g = δ - h(x) and g' = δ' - V h'(x) (Eqs. 6, 7,
12); an element is in contact if the indenter touches its surface and p >= 0 (Eq. 24).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.model import Array, Model
from kvtheory.models.elements.row import Under


@dataclass(frozen=True)
class Contact:
    """What the elements do to the indenter: forces in N/m, edges in m (NaN in flight), pressure in Pa."""

    normal_force: float
    friction_force: float
    left: float
    right: float
    peak_pressure: float


FLIGHT = Contact(0.0, 0.0, np.nan, np.nan, 0.0)


def pressure(model: Model, under: Under, depth: float, rate: float, V: float) -> Array:
    """Return K g + C g' at the elements under the indenter."""
    g_rate = rate - V * model.slope(under.x)
    with np.errstate(invalid="ignore"):
        return model.stiffness * (depth - under.height) + model.damping * g_rate


def whole_elements(model: Model, under: Under, p: Array, pressed: NDArray[np.bool_]) -> Contact:
    """Sum over whole elements, as in the paper (Eqs. 12-15)."""
    inside = np.flatnonzero(pressed)
    if inside.size == 0:
        return FLIGHT
    dx, x, p = model.spacing, under.x[inside], p[inside]
    return Contact(
        dx * float(p.sum()),
        -dx * float(model.slope(x) @ p),
        float(x[0]) - 0.5 * dx,
        float(x[-1]) + 0.5 * dx,
        float(p.max()),
    )


@dataclass(frozen=True)
class Edges:
    """Where contact ends, from left to right: the last element inside, and which way outside is."""

    inner: NDArray[np.intp]
    outward: NDArray[np.intp]

    @classmethod
    def of(cls, pressed: NDArray[np.bool_]) -> "Edges":
        """Return the edges of one or more intervals of contact."""
        before = np.flatnonzero(pressed[1:] != pressed[:-1])
        leaves = pressed[before]
        return cls(np.where(leaves, before, before + 1), np.where(leaves, 1, -1))

    @property
    def free(self) -> NDArray[np.intp]:
        """The first element outside."""
        return self.inner + self.outward

    def gaps(self, model: Model, depth: float, x: Array, surface: Array) -> tuple[Array, ...]:
        """Return w, w', w'' for w = g - u, the overlap, at `free` inward, in units of the spacing.

        They are those of the parabola through the three nearest elements outside, where w < 0: on free
        ground w falls to the edge in a straight line, and where contact peeled off, as a square.
        """
        outside = self.free[None, :] + np.arange(3)[:, None] * self.outward
        w, far, farthest = depth - model.height(x[outside]) - surface[outside]
        with np.errstate(invalid="ignore"):
            return w, 1.5 * w - 2.0 * far + 0.5 * farthest, w - 2.0 * far + farthest


def touching(gaps: tuple[Array, ...]) -> Array:
    """Return how far inward of `free` the surfaces meet, w = 0, from 0 to 1 element."""
    w, slope, curvature = gaps
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.sqrt(np.maximum(slope * slope - 2.0 * w * curvature, 0.0))
        return np.clip(np.nan_to_num(-2.0 * w / (slope + root), nan=1.0), 0.0, 1.0)


def parts_of_elements(
    model: Model, under: Under, p: Array, p_before: Array, pressed: NDArray[np.bool_], depth: float
) -> Contact:
    """Sum by trapezoids up to the very edges.

    An edge peels where p falls to zero, between two elements by a straight line, and touches where
    the indenter meets the free surface. Where V jumps, an edge that peeled until then, by the pressure
    `p_before`, is still where it was, or has gone further in.
    """
    inside = np.flatnonzero(pressed)
    if inside.size == 0:
        return FLIGHT
    edges, dx = Edges.of(pressed), model.spacing
    p_free, p_in = p[edges.free], p[edges.inner]
    apart = 1.0 - touching(edges.gaps(model, depth, under.x, under.free))
    touch = np.where(under.touched[edges.free], 1.0, apart)
    now, before = _peeling(p, edges), _peeling(p_before, edges)
    share = np.fmin(np.where(np.isnan(before), touch, before), np.nan_to_num(now, nan=1.0))
    peels = now <= share
    x = under.x[edges.inner] + share * dx * edges.outward
    with np.errstate(invalid="ignore"):
        p_edge = np.where(peels, 0.0, p_in + share * (p_free - p_in))
    push = -model.slope(under.x) * np.where(pressed, p, 0.0)
    push_edge = -model.slope(x) * p_edge

    def total(values: Array, ends: Array) -> float:
        last = values[edges.inner]
        return dx * float(values[inside].sum() + 0.5 * (share * (last + ends) - last).sum())

    peak = max(float(p[inside].max()), float(p_edge.max()))
    return Contact(total(p, p_edge), total(push, push_edge), float(x[0]), float(x[-1]), peak)


def _peeling(p: Array, edges: Edges) -> Array:
    """Return how far outward of `inner` the pressure vanishes, from 0 to 1 element; NaN if it does not."""
    inside, outside = np.maximum(p[edges.inner], 0.0), p[edges.free]
    return np.where(outside < 0.0, inside / np.where(outside < 0.0, inside - outside, 1.0), np.nan)


def kink_area(model: Model, gaps: tuple[Array, ...]) -> tuple[Array, Array]:
    """Return what trapezoids leave out of the area of u at each edge (below zero), and d/dδ of it.

    Between `free` and the next element inside, u is the larger of two nearly straight lines, which
    cross where w = 0; the trapezoid takes the chord (theorem `element-kink`).
    """
    outside, slope, curvature = gaps
    within = outside + slope + 0.5 * curvature
    fits = (within > 0.0) & (outside < 0.0) & np.isfinite(outside)
    outside, within = np.where(fits, outside, -1.0), np.where(fits, within, 0.0)
    width, half = within - outside, 0.5 * model.spacing * fits
    return half * within * outside / width, half * (within + outside) / width
