"""Schemes on the exact memory of an element (F8 for Kelvin-Voigt), which need no rules of contact.

The force, averaged over the step, is k Σ dx max(g - r, 0), r being where the mean pressure of an element
would vanish; for Kelvin-Voigt, with the weight e^(t/τ),

    F_z = K/(1 - e^(-h/τ)) Σ dx max(g - u e^(-h/τ), 0).

It is never negative, free of elements that are left alone, and convex in the depth at the end of the step,
which therefore is the one root of a monotone function. The depth advances with the mean velocity
(1-θ) v_0 + θ v_1. With θ = 1 the damping is that of the backward Euler method; with the exponential
fit θ = 1/(1 - e^(-z)) - 1/z, z = h C L/M, the velocity falls by e^(-z) exactly as it should, and the
order is two. Both are stable at any step, since θ >= 1/2 (derivations, `element-stability`).

On a spring the place along x is found in the same way, with M_x, k_x and c_x and the force of an element
times its slope halfway through the step. The work of these forces on both motions is what elements of a
parabola store and lose, so that no step gains energy, whatever comes into contact or leaves it in the step.

On arms, an element in contact is a true element under a surface that moves along a straight line: its mean
pressure times its way is the work done on it, what its springs store and its dampers lose. With θ = 1/2 the
same holds of mass and spring, so that the energy of a step with the contact held can only fall, and more with
θ > 1/2: every step is stable. C is here the damper which, beside a spring, does to a ramp as the arms do in a
step, h Σ K_i (2 φ_2 - φ_1): K_i τ_i of fast arms, h² K_i/(6 τ_i) of slow ones; so θ - 1/2 is of the third
order in h, and the scheme of the second (derivation `element-arms`). It is so in the spacing as well: the
pressure of arms is continuous, and there is no sawtooth but that of arms faster than a step.

Sums over whole elements carry the sawtooth of theorem F15-sawtooth: on Table 1 at the paper's density
2e-3 of the force at the start, 1e-3 in steady sliding, halved with the spacing. With the kinks of the
surface at edges between two elements (`parts` of the model), it is 1e-4 and 1e-6, and quartered; the
depth is within 1e-5 of theory. Only at the very instant of a jump of the drive, where pressure is left
on an edge, is the order one too.
"""

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.edges import bend, edges_of, gaps, jump, kink_area
from kvtheory.models.elements.law import Array
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.row import ElementRow, IndenterState, Under
from kvtheory.models.elements.strips import total

NEWTON_STEPS = 60
"""The iteration ends after three or four; a monotone convex function cannot need many more."""
NEWTON_RTOL = 1e-14
SLIDE_STEPS = 30
"""On a spring: two or three are taken, since its motion within a step is nearly known."""
SLIDE_RTOL = 1e-9
"""Of the static half length: a change so small was the last, and leaves far less."""
SMALL = 1e-2
"""Below it, θ(z) is taken from its series to z^3, where the closed form would cancel."""
ROOM, MORE_ROOM = 1.0, 4.0
"""Of the static depth: so far it is at first taken to sink in a step at most; then so many times farther."""
STANDS = 1e-12
"""Of the static depth: an edge where the overlap falls by less in a step does not move inward."""

Side = tuple[int, int]
"""A strip, and -1 or 1 for its left or right side."""


def exponential_fit(z: float) -> float:
    """Return θ = 1/(1 - e^(-z)) - 1/z, from 1/2 at z = 0 to 1 at infinity.

    >>> exponential_fit(0.0), round(exponential_fit(1.0), 6), exponential_fit(1e9)
    (0.5, 0.581977, 0.999999999)
    """
    return 0.5 + z / 12.0 - z * z * z / 720.0 if z < SMALL else -1.0 / math.expm1(-z) - 1.0 / z


def implicit_step(
    row: ElementRow, now: IndenterState, h: float, *, theta: Callable[[float], float]
) -> IndenterState:
    """Take a step in which the depth at its end is the root of the balance of momentum.

    On a spring, so is the place along x: for every place there is one depth.
    """
    model = row.model
    counts: dict[Side, bool] = {}
    slid = h * now.along_rate / (1.0 + 0.25 * model.spring_along * h * h / model.mass_along)
    new = IndenterState(now.time + h, now.depth, 0.0, now.along + slid)
    for _ in range(SLIDE_STEPS):
        contact, new = _sunk(row, now, new, h, theta, counts)
        if not model.sprung:
            break
        before, new = new.along, contact.slide(new, theta)
        if abs(new.along - before) <= SLIDE_RTOL * model.half_length:
            break
    under, g = contact.under, new.depth - contact.under.height
    pressed = g >= contact.rest
    row.settle(under, np.where(pressed, row.pressed(under, now.depth, g), under.left), pressed, h)
    return new


def _sunk(
    row: ElementRow, now: IndenterState, new: IndenterState, h: float,
    theta: Callable[[float], float], counts: dict[Side, bool],
) -> "tuple[_Contact, IndenterState]":  # fmt: skip
    """Return the contact of a step that ends at a given place along x, and the depth there."""
    most = _sinking(row.model, now, h)
    sinks = min(most, ROOM * row.model.depth)
    while True:
        contact = _Contact(row, now, new, h, sinks, counts)
        found = contact.sink(new, theta) if math.isfinite(row.model.mass) else new
        if not found.depth > now.depth + sinks or sinks == most:
            return contact, found
        # Elements may have been missed, without which it sinks too deep, never too little.
        sinks = min(most, MORE_ROOM * sinks)
        counts.clear()


class _Contact:
    """The elements that the indenter may press in a step, which ends at a given place along x.

    Their mean forces follow from how far it sinks: the depths themselves cancel where the step is short.
    An element counts by its weight, and by the smaller `share` of it while it enters within the step.
    """

    def __init__(
        self, row: ElementRow, now: IndenterState, new: IndenterState, h: float, sinks: float,
        counts: dict[Side, bool],
    ) -> None:  # fmt: skip
        model, self.now, self.h = row.model, now, h
        self.model, self.first = model, min(h * now.rate, sinks)
        self.under = under = row.under(now, new, h, now.depth + sinks)
        self.rest = under.rest()
        if not (model.sprung or math.isfinite(model.mass)):
            return
        self.meets = under.height + self.rest
        self.met = self.meets <= now.depth + self.first
        halfway = now.depth + 0.5 * h * now.rate
        self.weights = model.weights(halfway, under.strips, self.meets.size)
        self.kinks = _Kinks(model, now, under, self.weights, counts) if model.parts else None
        self.shares = self.weights
        if model.law.remembers:
            new_ones, within = row.entering(under, now.depth, now.depth + self.first - self.meets)
            self.shares = self.weights.copy()
            self.shares[new_ones] *= within / h * model.law.ramps(within)[1] / under.law.stiffness

    def sink(self, new: IndenterState, theta_of: Callable[[float], float]) -> IndenterState:
        """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for the new depth by Newton's method."""
        model, now, h, law, sunk = self.model, self.now, self.h, self.under.law, self.first
        M, W, k_s, dx = model.mass, model.weight, model.spring, model.spacing
        extent = dx * max(total(self.weights, self.met), total(self.weights, self.under.touched))
        theta = theta_of(h * law.damping * extent / M)
        for _ in range(NEWTON_STEPS):
            overlap = (now.depth + sunk) - self.meets
            pressed = overlap > 0.0
            area = dx * total(self.shares, np.maximum(overlap, 0.0))
            width = dx * total(self.weights, pressed)
            for _, more, wider in self.kinks(overlap, pressed) if self.kinks else ():
                area, width = area + more, width + wider
            mean = now.depth - model.depth + theta * sunk
            change_of_rate = _velocity(sunk, now.rate, h, theta) - now.rate
            residual = M * change_of_rate / h - W + k_s * mean + law.stiffness * area
            change = residual / (M / (theta * h * h) + theta * k_s + law.stiffness * width)
            sunk -= change
            if abs(change) <= NEWTON_RTOL * model.depth:
                break
        return new._replace(depth=now.depth + sunk, rate=_velocity(sunk, now.rate, h, theta))

    def slide(self, new: IndenterState, theta_of: Callable[[float], float]) -> IndenterState:
        """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

        An element pushes along x with its pressure times the slope halfway through the step, so that the
        mean forces do the very work by which elements of a parabola are compressed.
        """
        model, now, h, under = self.model, self.now, self.h, self.under
        M, M_x, c_x, k_x = model.mass, model.mass_along, model.damping_along, model.spring_along
        slope, k = model.slope(under.x - 0.5 * under.travel, under.y), under.law.stiffness
        weights, push = model.spacing * self.weights, model.spacing * self.shares * slope
        tilt = total(weights * slope * slope, self.met | under.touched)
        # A ringing too fast for the step is damped; θ - 1/2 is of the third order in h, as on arms.
        swing = h * math.sqrt(k_x / M_x)
        theta = theta_of(h * (c_x + under.law.damping * tilt) / M_x + swing * swing * swing)
        overlap = new.depth - self.meets
        pressed = overlap > 0.0
        area = total(push, np.maximum(overlap, 0.0))
        for inner, more, _ in self.kinks(overlap, pressed) if self.kinks else ():
            area += more * slope.item(inner)
        slid, inside = new.along - now.along, k * weights * pressed
        change_of_rate = _velocity(slid, now.along_rate, h, theta) - now.along_rate
        held = c_x * slid / h + k_x * (now.along + theta * slid)
        residual = M_x * change_of_rate / h + held + k * area
        # As the foundation gives way along x, the depth changes, too.
        normal = M / (h * h) + model.spring + float(inside.sum())
        stiff = total(inside * slope, slope) - total(inside, slope) ** 2 / normal
        slid -= residual / (M_x / (theta * h * h) + c_x / h + theta * k_x + stiff)
        rate = _velocity(slid, now.along_rate, h, theta)
        return new._replace(along=now.along + slid, along_rate=rate)


def _velocity(way: float, before: float, h: float, theta: float) -> float:
    """Return the velocity at the end of a step in which the mean (1-θ) v_0 + θ v_1 goes this way."""
    return (way / h - (1.0 - theta) * before) / theta


def _sinking(model: Model, now: IndenterState, h: float) -> float:
    """Return how far the indenter could sink in a step without a foundation, at any θ from 1/2 to 1."""
    q = model.spring * h * h / model.mass
    pull = max(model.weight + model.spring * (model.depth - now.depth), 0.0)
    most = 1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)
    return h * max(now.rate, 0.0) / (1.0 + 0.25 * q) + most * pull * h * h / model.mass


class _Kinks:
    """What the kinks of the surface, at edges between two elements, add to the area that is pressed.

    A kink counts where the edge stands or moves outward over the free surface, that is, where the overlap
    w = g - u just outside does not fall. Where the edge moves inward, the surface has no kink, or one that
    is left behind and relaxes like all that is free. Each side of each strip is asked for itself.
    """

    def __init__(
        self, model: Model, now: IndenterState, under: Under, weights: Array,
        counts: dict[Side, bool],
    ) -> None:  # fmt: skip
        self.counts = counts
        self.dx, self.least = model.spacing, -STANDS * model.depth
        self.weights, self.in_strip = weights, under.x.size // under.strips
        self.before: Array = now.depth - under.state[0]
        self.before -= model.height(under.x - under.travel, under.y)
        self.relaxed: dict[Side, float] = {}
        spring, k = under.law.held_pressure[0], under.law.stiffness
        arms = under.law.held_pressure[1:] @ under.state[1:] if model.law.remembers else None
        for side, edges in self.by_side(under.touched).items():
            self.relaxed[side] = 0.0
            for edge in edges:
                found = gaps(self.before, *edge)
                if area := kink_area(self.dx, found)[0]:
                    held = spring if arms is None else spring + bend(arms, *edge) / jump(found)
                    self.relaxed[side] += (1.0 - held / k) * area

    def by_side(self, pressed: NDArray[np.bool_]) -> dict[Side, list[tuple[int, int]]]:
        """Return the edges of each side of each strip."""
        found: dict[Side, list[tuple[int, int]]] = {}
        for edge in edges_of(pressed):
            found.setdefault((edge[0] // self.in_strip, edge[1]), []).append(edge)
        return found

    def __call__(
        self, overlap: Array, pressed: NDArray[np.bool_]
    ) -> Iterator[tuple[int, float, float]]:
        """Yield where kinks are, their area at this overlap beyond what relaxed, and its rate with depth."""
        for side, edges in self.by_side(pressed).items():
            # Decided once in a step, so that Newton's method cannot go to and fro.
            if side not in self.counts:
                outer = [inner + outward for inner, outward in edges]
                falls = (self.least > overlap.item(k) - self.before.item(k) for k in outer)
                self.counts[side] = not all(falls)
            if self.counts[side]:
                found = [kink_area(self.dx, gaps(overlap, *edge)) for edge in edges]
                inner, weight = edges[0][0], self.weights.item(edges[0][0])
                area = sum(kink for kink, _ in found) - self.relaxed.get(side, 0.0)
                yield inner, weight * area, weight * sum(wider for _, wider in found)
