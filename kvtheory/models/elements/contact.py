"""Forces and edges at one instant, by whole elements or with a part of one at each edge.

An element is in contact if the indenter touches its surface and its pressure p >= 0 (Eq. 24).
"""

import math
from operator import itemgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.edges import (
    BEYOND,
    INSIDE,
    OUTSIDE,
    OUTWARD,
    gaps,
    runs_of,
    straight,
    sums_over,
    touching,
)
from kvtheory.models.elements.law import Array
from kvtheory.models.elements.model import Model
from kvtheory.models.elements.row import ElementRow, IndenterState, Under

AT_REST = 1e-12
"""Of a_0/τ: slower on a spring, it stands but for rounding, and the edges are those of the drive."""


NEAR = 1e-9
"""Of the spacing: so far inside an edge is the slope there, which may jump at the edge."""


class ContactSums(NamedTuple):
    """What the elements do to the indenter: forces in N/m, edges in m (NaN in flight), pressure in Pa.

    Of a ball, forces are in N, and edges those in its middle plane.
    The last two say by how much the pressure differs between the elements beside its peak: inside the
    contact, where that matters, or at its edge.
    """

    normal_force: float
    friction_force: float
    left: float
    right: float
    peak_pressure: float
    peak_doubt: float = 0.0
    edge_doubt: float = 0.0


NOWHERE: tuple[float, float] = (math.nan, math.nan)
FLIGHT = ContactSums(0.0, 0.0, *NOWHERE, 0.0)


def report(row: ElementRow, at: IndenterState, time: float) -> tuple[float, ...]:
    """Return the columns at a time, for which the state `at` stands; where V jumps, just after it.

    They are in the order of `error_estimate.COLUMNS`.
    """
    model, V = row.model, row.path.velocity(time)
    under = row.under(at, at, 0.0, max(at.depth, model.depth))
    sliding = V - at.along_rate
    p = pressure(row, under, at, sliding)
    pressed = under.touched & (model.rule.pulls | (p >= 0.0))
    before = row.path.velocity(at.time, before=True) - at.along_rate
    p_before = p if before == sliding else pressure(row, under, at, before)
    weights = model.weights(at.depth, under.strips)
    if not pressed.any():
        found = FLIGHT
    elif model.parts:
        found = _parts_of_elements(model, under, (p, p_before), weights, pressed, at.depth, sliding)
        if model.indenter.per_width:
            found = _kinked(model, under, p, pressed, sliding, found)
    else:
        found = _whole_elements(model, under, p, weights, pressed)
    slides = at.along_rate and abs(sliding) > AT_REST * model.at_rest.velocity
    forward = sliding > 0.0 if slides else row.path.forward(time)
    edges = found[2:4] if forward else found[3:1:-1]
    held = model.spring_along * at.along + model.damping_along * at.along_rate
    return time, V, at.depth, at.rate, *found[:2], *edges, found[4], sliding, held, *found[5:]


def pressure(row: ElementRow, under: Under, at: IndenterState, V: float) -> Array:
    """Return p of elements under the indenter, g = δ - h(x), g' = δ' - V h'(x) (Eqs. 6, 7, 12).

    Of one that is not in contact, it is what it would be had it followed the indenter in the last step.
    """
    law, state, g = row.model.law, under.state, at.depth - under.height
    g_rate = at.rate - V * under.slope(row.model, _behind(row.model, V))
    p = law.pressure(state, g, g_rate)
    if law.remembers:
        p += np.where(under.touched, 0.0, law.followed(g - state[0], g_rate, row.last))
    return p


def _behind(model: Model, V: float) -> float:
    """Return how far back the slope is taken: an element on a kink is still on the flank before it."""
    return math.copysign(NEAR * model.spacing, V) if model.indenter.kinks and V else 0.0


def _whole_elements(
    model: Model, under: Under, p: Array, weights: Array, pressed: NDArray[np.bool_]
) -> ContactSums:
    """Sum over whole elements, as in the paper (Eqs. 12-15)."""
    runs, dx, slope = runs_of(pressed), model.spacing, under.slope(model)
    weight, middle = weights[runs[:, 0] // under.along.size], runs[runs[:, 0] < under.along.size]
    left, right = (under.along[0, middle[[0, -1], [0, 1]]] + 0.5 * dx) if middle.size else NOWHERE
    force, push = (float(weight @ sums_over(runs, each)) for each in (p, slope * p))
    return ContactSums(dx * force, -dx * push, float(left), float(right), float(p[pressed].max()))


def _parts_of_elements(
    model: Model, under: Under, pressures: tuple[Array, Array], weights: Array,
    pressed: NDArray[np.bool_], depth: float, V: float,
) -> ContactSums:  # fmt: skip
    """Sum by trapezoids up to the very edges.

    An edge peels where p falls to zero, between two elements by a straight line, and touches where
    the indenter meets the free surface. Where V jumps, an edge that peeled until then, by the pressure
    before, the second of `pressures`, is still where it was, or has gone further in.
    """
    runs, dx, (p, p_before) = runs_of(pressed), model.spacing, pressures
    inner, outer = runs + INSIDE, runs + OUTSIDE
    weight = weights[runs[:, 0] // under.along.size]
    slope = under.slope(model, _behind(model, V))
    force, push = (float(weight @ sums_over(runs, each)) for each in (p, p * slope))
    p_in, p_out = p[inner], p[outer]
    now = _peeling(p_in, p_out)
    before = now if p_before is p else _peeling(p_before[inner], p_before[outer])
    beyond = runs + BEYOND
    free = gaps(*(depth - under.height[beyond] - under.left[0, beyond]))
    touches = np.isinf(before) | straight(free)
    before = np.where(touches, np.where(under.touched[outer], 1.0, 1.0 - touching(free)), before)
    share = np.minimum(np.minimum(before, now), 1.0)
    p_edge = np.where(now <= share, 0.0, p_in + share * (p_out - p_in))
    x, y = under.at(inner)
    for kink in model.indenter.kinks if model.indenter.per_width else ():
        # There p falls at once, by -C V times the jump of h'.
        ahead = (kink - x) / dx * OUTWARD
        p_kink = p_in + ahead * (p_in - p[2 * inner - outer])
        stops = (
            (ahead >= -NEAR) & (ahead < np.minimum(before, 1.0)) & (p_out < 0.0) & (p_kink > 0.0)
        )
        share, p_edge = np.where(stops, ahead, share), np.where(stops, p_kink, p_edge)
    x = x + share * dx * OUTWARD
    half = 0.5 * weight[:, None]
    force += float((half * (share * (p_in + p_edge) - p_in)).sum())
    ends = slope[inner] * p_in, model.slope(x - NEAR * dx * OUTWARD, y) * p_edge
    push += float((half * (share * (ends[0] + ends[1]) - ends[0])).sum())
    middle = x[runs[:, 0] < under.along.size]
    left, right = (middle.item(0), middle.item(-1)) if middle.size else NOWHERE
    best = int(p_edge.argmax())
    at_edge = p_edge.item(best), 0.0, abs(p_in - p_out).item(best)
    highest = int(np.where(pressed, p, -math.inf).argmax())
    reach = np.where(inner == highest, share, 1.0).min(axis=0)
    peak = max(_peak(model, p, highest, reach, pressed), at_edge)
    return ContactSums(dx * force, -dx * push, left, right, *peak)


def _kinked(
    model: Model, under: Under, p: Array, pressed: NDArray[np.bool_], V: float, found: ContactSums
) -> ContactSums:
    """Split the element in which a kink of the shape is: h' jumps there, and p by -C V times as much.

    Without this, the forces under a wedge are of the first order in the spacing.
    """
    x, dx = under.along[0], model.spacing
    for kink in model.indenter.kinks:
        k = round((kink - x.item(0)) / dx)
        if not (0 < k < x.size - 1 and pressed[k - 1 : k + 2].all()):
            continue
        places = np.array([x[k] - _behind(model, V), kink - NEAR * dx, kink + NEAR * dx])
        here, *slope = model.slope(places)
        p_each = p[k] - model.law.damping * V * (np.array(slope) - here)
        left = (kink - x.item(k)) / dx + 0.5
        share = np.array([left, 1.0 - left])
        if (p_each >= 0.0).all():
            force = found.normal_force + dx * float(share @ (p_each - p[k]))
            push = found.friction_force - dx * float(share @ (p_each * slope - p[k] * here))
            found = found._replace(normal_force=force, friction_force=push)
    return found


def _peeling(inside: Array, outside: Array) -> Array:
    """Return how far outward of the last element the pressure vanishes; infinite if it does not."""
    positive = np.maximum(inside, 0.0)
    return np.where(outside < 0.0, positive / (positive - outside), math.inf)


def _peak(
    model: Model, p: Array, k: int, reach: Array, pressed: NDArray[np.bool_]
) -> tuple[float, float, float]:
    """Return the peak near element k, of the parabola through three, and both doubts.

    A shape with kinks has no such parabola: there the peak is known to the next element. Arms remember
    where contact began, so that the pressure itself may have a kink between two elements.
    """
    before, here, after = (p.item(i) for i in (k - 1, k, k + 1))
    doubt = 0.5 * max(here - before, here - after) if model.law.remembers else 0.0
    if model.indenter.kinks:
        return here, min(abs(here - before), abs(here - after)), 0.0
    bend = 2.0 * here - before - after
    if not (here >= before > -math.inf and here >= after > -math.inf and bend > 0.0):
        return here, 0.0, 0.0
    if doubt and pressed[k - 3 : k + 4].all():
        return *min(_smooth(p[k - 3 : k + 4]), _ridge(p[k - 3 : k + 4]), key=itemgetter(1)), 0.0
    ahead = 0.5 * (after - before) / bend
    if abs(ahead) > reach[1 if ahead > 0.0 else 0]:
        return here, doubt, 0.0
    return here + 0.25 * (after - before) * ahead, doubt, 0.0


def _smooth(p: Array) -> tuple[float, float]:
    """Return the peak of the parabola through the middle three of seven pressures, and its doubt.

    A kink beside the middle adds to one or two of the second differences at the middle three.
    """
    _, _, before, here, after, _, _ = p.tolist()
    peak = here + 0.125 * (after - before) ** 2 / (2.0 * here - before - after)
    return peak, 0.5 * float(np.ptp(np.diff(p[1:6], n=2)))


def _ridge(p: Array) -> tuple[float, float]:
    """Return the peak where the curves from both sides meet beside the middle of seven, and its doubt."""
    i = 2 + int(2.0 * p[4] - p[3] - p[5] >= 2.0 * p[2] - p[1] - p[3])
    sides = p[[i, i - 1, i - 2]], p[[i + 1, i + 2, i + 3]]
    rises = [float(side[0] - side[1]) for side in sides]
    if not sum(rises) > 0.0:
        return float(p[3]), math.inf
    share = min(max(float(p[i + 1] + rises[1] - p[i]) / sum(rises), 0.0), 1.0)
    peaks, bends = [], []
    for side, rise, far in zip(sides, rises, (share, 1.0 - share), strict=True):
        bends.append(0.5 * far * (far + 1.0) * float(side[0] - 2.0 * side[1] + side[2]))
        peaks.append(float(side[0]) + rise * far + bends[-1])
    doubt = max(map(abs, bends)) + abs(peaks[0] - peaks[1])
    return max(0.5 * sum(peaks), float(p[3])), doubt
