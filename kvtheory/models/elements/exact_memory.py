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
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.edges import (
    BEYOND,
    INSIDE,
    Runs,
    bend,
    kink_area,
    runs_of,
    sums_over,
)
from kvtheory.models.elements.law import Array
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.row import ElementRow, IndenterState

NEWTON_STEPS = 60
"""The iteration ends after one or two; a monotone convex function cannot need many more."""
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

UNMET = 3
"""Elements at either end of a strip that are never met, so that there are three beyond every edge."""

Falling = list[NDArray[np.bool_]]
"""One array, once it is known, of whether the overlap falls at both sides of each strip in a step."""


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
    falling: Falling = []
    slid = h * now.along_rate / (1.0 + 0.25 * model.spring_along * h * h / model.mass_along)
    new = IndenterState(now.time + h, now.depth, 0.0, now.along + slid)
    for _ in range(SLIDE_STEPS):
        contact, new = _sunk(row, now, new, h, theta, falling)
        if not model.sprung:
            break
        before, new = new.along, contact.slide(new, theta)
        if abs(new.along - before) <= SLIDE_RTOL * model.half_length:
            break
    under, g = contact.under, new.depth - contact.under.height
    pressed = contact.meets <= new.depth - now.depth
    row.settle(under, np.where(pressed, row.pressed(under, now.depth, g), under.left), pressed, h)
    return new


def _sunk(
    row: ElementRow, now: IndenterState, new: IndenterState, h: float,
    theta: Callable[[float], float], falling: Falling,
) -> "tuple[_Contact, IndenterState]":  # fmt: skip
    """Return the contact of a step that ends at a given place along x, and the depth there."""
    most = _sinking(row.model, now, h)
    sinks = min(most, ROOM * row.model.depth)
    while True:
        contact = _Contact(row, now, new, h, sinks, falling)
        found = contact.sink(new, theta) if math.isfinite(row.model.mass) else new
        if not found.depth > now.depth + sinks or sinks == most:
            return contact, found
        # Elements may have been missed, without which it sinks too deep, never too little.
        sinks = min(most, MORE_ROOM * sinks)
        falling.clear()


class _Contact:
    """The elements that the indenter may press in a step, which ends at a given place along x.

    Their mean forces follow from how far it sinks: the depths themselves cancel where the step is short. An
    element is pressed if the indenter sinks farther than to where it `meets` it. One that it enters within
    the step answers less, which is what it `lacks` of its weight.
    """

    def __init__(
        self, row: ElementRow, now: IndenterState, new: IndenterState, h: float, sinks: float,
        falling: Falling,
    ) -> None:  # fmt: skip
        self.model, self.now, self.h, self.first = row.model, now, h, min(h * now.rate, sinks)
        self.under = under = row.under(now, new, h, now.depth + sinks)
        self.passed = list[NDArray[np.intp]]()
        if row.model.indenter.per_width and row.model.law.damping:
            for kink in row.model.indenter.kinks:
                self._pass(kink)
        self.meets = under.height + under.rest()
        self.meets -= now.depth
        ends = self.meets.reshape(under.strips, -1)
        ends[:, :UNMET] = ends[:, -UNMET:] = math.inf
        self.weights = row.model.weights(now.depth + 0.5 * h * now.rate, under.strips)
        self.begun, self.falling = runs_of(under.touched), falling
        self.late = self._late(row) if row.model.law.remembers else None
        arms = under.law.held_pressure[1:] @ under.state[1:] if self.late else None
        self.bent = None if arms is None else bend(arms, self.begun)
        self.before = partial(row.before, under, now.depth)

    def _pass(self, kink: float) -> None:
        """Let elements that pass a kink of the shape in the step be pressed as far as it pressed them.

        What a damper has of that compression until the end of the step, g e^(-t/τ), is left, and so is its
        mean pressure; without this, a wedge stands on its tip at the first order in the spacing.
        """
        under, law = self.under, self.model.law
        x, travel = under.along[0], under.travel
        passed: NDArray[np.intp] = ((x - kink) * (x - travel - kink) < 0.0).nonzero()[0]
        self.passed.append(passed)
        since = self.h * (x[passed] - kink) / travel if passed.size else np.zeros(0)
        tip = float(self.model.height(np.array(kink)))
        g = (self.now.depth - tip) * np.exp(-since / law.retardation_time)
        under.height[passed] = np.minimum(under.height[passed], self.now.depth - g)

    def _late(self, row: ElementRow) -> tuple[NDArray[np.intp], Array]:
        """Return the elements that are entered within the step, and what they lack."""
        under, law = self.under, self.model.law
        elements, within = row.entering(under, self.now.depth, self.first - self.meets)
        share = within / self.h * law.ramps(within)[1] / under.law.stiffness
        return elements, (1.0 - share) * self.weights[elements // under.along.size]

    def lacking(self, sunk: float) -> tuple[NDArray[np.intp], Array, Array]:
        """Return what is lacking in the area, element by element, and its derivative by depth."""
        elements, lack = self.late or (np.zeros(0, dtype=np.intp), np.zeros(0))
        overlap = sunk - self.meets[elements]
        return elements, lack * np.maximum(overlap, 0.0), lack * (overlap > 0.0)

    def runs(self, sunk: float) -> tuple[Runs, Array]:
        """Return the runs of elements that are pressed, and their weights."""
        runs = runs_of(self.meets < sunk)
        return runs, self.weight(runs)

    def weight(self, runs: Runs) -> Array:
        """Return the weight of each run."""
        weight: Array = self.weights[runs[:, 0] // self.under.along.size]
        return weight

    def sink(self, new: IndenterState, theta_of: Callable[[float], float]) -> IndenterState:
        """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for the new depth.

        While no element is met or let go, F_z is of the second order in the depth: one step of Newton's
        method with the second derivative is exact.
        """
        model, now, h, sunk = self.model, self.now, self.h, self.first
        M, W, k_s, k = (
            model.mass,
            model.weight,
            model.spring,
            self.under.law.stiffness * model.spacing,
        )
        runs, weight = self.runs(sunk)
        held = float(self.weight(self.begun) @ (self.begun[:, 1] - self.begun[:, 0]))
        extent = max(float(weight @ (runs[:, 1] - runs[:, 0])), held)
        theta = theta_of(h * self.under.law.damping * model.spacing * extent / M)
        for _ in range(NEWTON_STEPS):
            width, bent = float(weight @ (runs[:, 1] - runs[:, 0])), 0.0
            area = sunk * width - float(weight @ sums_over(runs, self.meets))
            if self.late:
                _, less, narrower = self.lacking(sunk)
                area, width = area - float(less.sum()), width - float(narrower.sum())
            if model.parts:
                _, *kinks = self.kinks(sunk, runs, weight)
                added, wider, bent = (float(np.add.reduce(each, axis=None)) for each in kinks)
                area, width = area + added, width + wider
            mean = now.depth - model.depth + theta * sunk
            change_of_rate = _velocity(sunk, now.rate, h, theta) - now.rate
            residual = M * change_of_rate / h - W + k_s * mean + k * area
            slope = M / (theta * h * h) + theta * k_s + k * width
            root = math.sqrt(max(slope * slope - 2.0 * residual * k * bent, 0.0))
            sunk -= 2.0 * residual / (slope + root)
            before = runs
            runs, weight = self.runs(sunk)
            if runs.tobytes() == before.tobytes():
                break
        return new._replace(depth=now.depth + sunk, rate=_velocity(sunk, now.rate, h, theta))

    def slide(self, new: IndenterState, theta_of: Callable[[float], float]) -> IndenterState:
        """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

        An element pushes along x with its pressure times the slope halfway through the step, so that the
        mean forces do the very work by which elements of a parabola are compressed.
        """
        model, now, h, under = self.model, self.now, self.h, self.under
        M, M_x, c_x, k_x = model.mass, model.mass_along, model.damping_along, model.spring_along
        k, sunk = under.law.stiffness * model.spacing, new.depth - now.depth
        slope = under.slope(model, 0.5 * under.travel)
        for passed in self.passed:  # pressed by the flank that they come from
            slope[passed] = model.slope(under.along[0, passed] - under.travel)
        steep = slope * slope
        held_or_met = runs_of((self.meets < self.first) | under.touched)
        tilt = model.spacing * float(self.weight(held_or_met) @ sums_over(held_or_met, steep))
        # A ringing too fast for the step is damped; θ - 1/2 is of the third order in h, as on arms.
        swing = h * math.sqrt(k_x / M_x)
        theta = theta_of(h * (c_x + under.law.damping * tilt) / M_x + swing * swing * swing)
        runs, weight = self.runs(sunk)
        width, inclined, tilted = (
            float(weight @ each)
            for each in (runs[:, 1] - runs[:, 0], sums_over(runs, slope), sums_over(runs, steep))
        )
        area = sunk * inclined - float(weight @ sums_over(runs, slope * self.meets))
        elements, less, _ = self.lacking(sunk)
        area -= float(slope[elements] @ less)
        if model.parts:
            edges, kinks = self.kinks(sunk, runs, weight)[:2]
            area += float((kinks * slope[edges + INSIDE]).sum())
        slid = new.along - now.along
        change_of_rate = _velocity(slid, now.along_rate, h, theta) - now.along_rate
        held = c_x * slid / h + k_x * (now.along + theta * slid)
        residual = M_x * change_of_rate / h + held + k * area
        # As the foundation gives way along x, the depth changes, too.
        normal = M / (h * h) + model.spring + k * width
        stiff = k * tilted - (k * inclined) ** 2 / normal
        slid -= residual / (M_x / (theta * h * h) + c_x / h + theta * k_x + stiff)
        rate = _velocity(slid, now.along_rate, h, theta)
        return new._replace(along=now.along + slid, along_rate=rate)

    def kinks(self, sunk: float, runs: Runs, weight: Array) -> tuple[Runs, Array, Array, Array]:
        """Return edges, the area of the kinks there by dx less what relaxed, and its derivatives by depth.

        A kink of the surface, at an edge between two elements, adds to the area that is pressed. It counts
        where the edge stands or moves outward over the free surface, that is, where the overlap w = g - u
        just outside does not fall. Where the edge moves inward, the surface has no kink, or one that is left
        behind and relaxes like all that is free. Each side of each strip is asked for itself.
        """
        count, law, edges = len(runs), self.under.law, np.concatenate([runs, self.begun])
        beyond, strip = edges + BEYOND, edges[:, 0] // self.under.along.size
        overlap = self.before(beyond)
        now = sunk - self.meets[beyond[:, :count]]
        # Decided once in a step, so that no iteration can go to and fro.
        if not self.falling:
            falls = now[0] - overlap[0, :count] < -STANDS * self.model.depth
            found = np.zeros((self.under.strips, 2), dtype=bool)
            found[strip[:count]] = falls
            k, side = (~falls).nonzero()
            found[strip[k], side] = False
            self.falling.append(found)
        overlap[:, :count] = now
        counted = np.zeros((self.under.strips, 2))
        counted[strip[:count]] = np.where(self.falling[0][strip[:count]], 0.0, weight[:, None])
        area, wider, bent, rise = kink_area(overlap)
        held = (
            law.held_pressure[0]
            if self.bent is None
            else law.held_pressure[0] + self.bent / rise[count:]
        )
        area[count:] *= held / law.stiffness - 1.0
        counted = counted[strip]
        return (
            edges,
            counted * area,
            counted[:count] * wider[:count],
            counted[:count] * bent[:count],
        )


def _velocity(way: float, before: float, h: float, theta: float) -> float:
    """Return the velocity at the end of a step in which the mean (1-θ) v_0 + θ v_1 goes this way."""
    return (way / h - (1.0 - theta) * before) / theta


def _sinking(model: Model, now: IndenterState, h: float) -> float:
    """Return how far the indenter could sink in a step without a foundation, at any θ from 1/2 to 1."""
    q = model.spring * h * h / model.mass
    pull = max(model.weight + model.spring * (model.depth - now.depth), 0.0)
    most = 1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)
    return h * max(now.rate, 0.0) / (1.0 + 0.25 * q) + most * pull * h * h / model.mass
