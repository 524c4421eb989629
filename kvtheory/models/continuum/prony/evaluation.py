"""The state at any time of a motion on a Prony series: depth, edges, forces, pressure, free surface."""

import math
from typing import Any, NamedTuple

from kvtheory.models.continuum.evaluation import forward
from kvtheory.models.continuum.prony import contact as c_
from kvtheory.models.continuum.prony.contact import Motion
from kvtheory.models.continuum.prony.records import NEVER, Run
from kvtheory.models.continuum.prony.step import forces
from kvtheory.models.continuum.prony.walk import walk
from kvtheory.models.continuum.run import FREE, PEELING, step_at
from kvtheory.scene.base_motion import evaluate


class Contact(NamedTuple):
    """The motion at an instant, and both edges."""

    motion: Motion
    l: float
    r: float


REFINED, BISECTIONS, SAMPLES, LAYER = 12, 60, 3, 0.25
"""Golden sections in the search for the peak between two samples, before a parabola; bisections for the
instant at which an edge passed a place; samples in each step of the history, but in the layer where arms are
loaded, at half of the age, down to this share of the shortest relaxation time."""
MANY = 64
"""Segments of a contact from which on the peak is sought among fewer of them first."""
GOLDEN = 0.6180339887498949
ROUNDING = 1e-12


def states(run: Run, times: Any, found: Any, peaks: bool) -> None:
    """Write the state at each of the `times` into `found`, with peak pressures if wanted."""
    for i in range(len(times)):
        s = times[i]
        index = step_at(run, s)
        step, memory = run.steps[index], run.memory
        at, c = c_.motion(run, index, s), run.given.damper
        theta = at.theta
        first = second = 0.0
        for k in c_.over(run.given.arms):
            first += c_.total(c_.past(memory.force, index, k, theta))
            second += c_.total(c_.past(memory.moment, index, k, theta))
        edges, along = run.polynomials.edges[index], run.polynomials.offset_rate[index]
        l, r = c_.value(edges[:, 0], theta), c_.value(edges[:, 1], theta)
        found.depth[i], found.depth_rate[i] = at.d, at.v
        found.sliding_velocity[i], found.way[i] = at.number, at.Y
        found.velocity[i] = evaluate(run.pieces[step.piece], s)[1]
        found.offset[i] = step.along + step.lasts * c_.integral(along, theta)
        found.offset_rate[i] = c_.value(along, theta)
        damped = c * at.v, 2.0 * c * at.number
        f_z, f_x = forces(l, r, at.d, damped, first, second)
        found.normal_force[i], found.friction_force[i] = f_z, f_x
        spring, damping = run.given.spring, run.given.damping
        found.spring_force[i] = spring * found.offset[i] + damping * found.offset_rate[i]
        if step.sides[0].state == FREE:
            l = r = math.nan
        leads = at.number > 0.0 or (at.number == 0.0 and forward(run.pieces, 0, step.piece, s))
        found.leading_edge[i], found.trailing_edge[i] = (l, r) if leads else (r, l)
        found.edges[i, 0], found.edges[i, 1] = l, r
        for side in range(2):
            found.edge_states[i, side] = step.sides[side].state
        found.peak_pressure[i] = 0.0
        if peaks:
            c_.accumulated(run, index, theta)
            found.peak_pressure[i] = peak(run, index, Contact(at, l, r))


def pressure_of(run: Run, at: Contact, number: int, place: float) -> float:
    """Return p of an element of a segment, -inf outside of the contact; `element` has the accumulators.

    The place is the instant at which the element entered, or X if it was in contact at rest.
    """
    segment = run.segments[number]
    at_rest = segment.step == NEVER
    index = NEVER if at_rest else step_at(run, place)
    p, xi = c_.pressed(run, at.motion, place + at.motion.Y, segment.edge, index, place)
    slack = 1e-12 * (1.0 + abs(at.motion.Y))
    return p if at.l - slack <= xi <= at.r + slack else -math.inf


def peak(run: Run, index: int, at: Contact) -> float:
    """Return the largest pressure: of samples in each segment, refined by golden sections about the best."""
    largest, step, fastest, s, Y = 0.0, run.steps[index], math.inf, at.motion.s, at.motion.Y
    for i in range(run.given.arms):
        fastest = min(fastest, LAYER * run.arms.relaxation_time[i])
    first, end = about_peak(run, at, step.first, step.first + step.count)
    for i in range(first, end):
        number = run.chain[i]
        segment = run.segments[number]
        at_rest = segment.step == NEVER
        low = max(segment.X_a, at.l - Y) if at_rest else segment.a
        high = min(segment.X_b, at.r - Y) if at_rest else min(segment.b, s)
        if not at_rest:
            low, high = inside(run, at, number, low, high)
        if not high - low > ROUNDING * s:
            continue
        j = NEVER if at_rest else step_at(run, low)
        best, before, after, last, place = -math.inf, low, high, low, low
        while True:
            p = pressure_of(run, at, number, place)
            if p > best:
                best, before, after = p, last, math.inf
            elif after == math.inf:
                after = place
            if place >= high:
                break
            last = place
            width = (high - low) / (2 * SAMPLES)
            if not at_rest:
                while j < index and run.steps[j + 1].start <= place:
                    j += 1
                width = min(run.steps[j].span, high - low) / SAMPLES
                width = min(width, max(0.5 * (s - place), fastest))
            # not twice, but for rounding
            place = place + width if place + 1.5 * width < high else high
        largest = max(largest, best)
        if best > 0.0:
            largest = max(largest, golden(run, at, number, before, min(after, high)))
    return largest


def about_peak(run: Run, at: Contact, first: int, end: int) -> tuple[int, int]:
    """Return between which entries of the contact the pressure is largest, where it has many segments.

    A drive with many kinks makes many. The pressure and its slope along the ground have no jump at a kink.
    """
    while end - first > MANY:
        apart, top, largest = 2 + 2 * (end - first) // MANY, first, -math.inf
        for i in range(first, end, apart):
            number = run.chain[i]
            segment = run.segments[number]
            low, high = segment.a, min(segment.b, at.motion.s)
            if segment.step == NEVER:
                low, high = segment.X_a, segment.X_b
            for half in range(2):
                p = pressure_of(run, at, number, low + 0.5 * half * (high - low))
                if p > largest:
                    top, largest = i, p
        first, end = max(first, top - apart), min(end, top + apart + 1)
    return first, end


def inside(run: Run, at: Contact, number: int, low: float, high: float) -> tuple[float, float]:
    """Return the instants between which the elements of a segment entered that are in contact."""
    first, last = (at.l, at.r) if run.segments[number].edge == 1 else (at.r, at.l)
    if pressure_of(run, at, number, low) == -math.inf:
        low = instant_of(run, number, at.motion.s, first - at.motion.Y)
    if pressure_of(run, at, number, high) == -math.inf:
        high = instant_of(run, number, at.motion.s, last - at.motion.Y)
    return low, high


def golden(run: Run, at: Contact, number: int, low: float, high: float) -> float:
    """Return the largest pressure between two places of a segment: by golden sections, then a parabola."""
    one, two = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    f, g = (pressure_of(run, at, number, one), pressure_of(run, at, number, two))
    beside, h = two, g
    for _ in range(REFINED):
        if f > g:
            beside, h, high, two, g = two, g, two, one, f
            one = high - GOLDEN * (high - low)
            f = pressure_of(run, at, number, one)
        else:
            beside, h, low, one, f = one, f, one, two, g
            two = low + GOLDEN * (high - low)
            g = pressure_of(run, at, number, two)
    largest = max(f, g)
    fall, rise = (f - h) * (one - two), (f - g) * (one - beside)
    if min(f, g, h) > -math.inf and fall != rise:
        top = one - 0.5 * (fall * (one - two) - rise * (one - beside)) / (fall - rise)
        largest = max(largest, pressure_of(run, at, number, min(max(top, low), high)))
    return largest


def instant_of(run: Run, number: int, s: float, X: float) -> float:
    """Return when an edge passed `X`, within a segment; NaN if it did not before `s`."""
    segment = run.segments[number]
    low, high = segment.a, min(segment.b, s)
    ends = _place(run, segment.edge, low), _place(run, segment.edge, high)
    slack = 1e-12 * (1.0 + abs(X))
    if not min(ends[0], ends[1]) - slack <= X <= max(ends[0], ends[1]) + slack:
        return math.nan
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if (_place(run, segment.edge, middle) < X) == (ends[0] < ends[1]):
            low = middle
        else:
            high = middle
    return high


def _place(run: Run, edge: int, s: float) -> float:
    index = step_at(run, s)
    at = c_.motion(run, index, s)
    return c_.value(run.polynomials.edges[index, :, edge], at.theta) - at.Y


def pressure(run: Run, at: Contact, xi: float) -> float:
    """Return the pressure at one place, zero outside of the contact."""
    s = at.motion.s
    index, X = step_at(run, s), xi - at.motion.Y
    step = run.steps[index]
    if not at.l <= xi <= at.r:
        return 0.0
    c_.accumulated(run, index, (s - step.start) / step.span)
    largest = 0.0
    for i in range(step.first, step.first + step.count):
        segment = run.segments[run.chain[i]]
        if segment.step == NEVER:
            if segment.X_a <= X <= segment.X_b:
                largest = max(largest, pressure_of(run, at, run.chain[i], X))
        else:
            sigma = instant_of(run, run.chain[i], s, X)
            if not math.isnan(sigma):
                largest = max(largest, pressure_of(run, at, run.chain[i], sigma))
    return largest


def compression(run: Run, at: Contact, xi: float) -> float:
    """Return the compression at one place: under the indenter, or where an edge left the ground."""
    s, d = at.motion.s, at.motion.d
    index, X = step_at(run, s), xi - at.motion.Y
    if at.l <= xi <= at.r:
        return float(d - xi * xi)
    for k in range(2):
        side = run.steps[index].sides[k]
        if side.state != FREE and (xi < at.l) != (k == 0):
            continue
        number = side.own if side.state == PEELING else side.segment
        while number != NEVER:
            segment = run.segments[number]
            sigma = math.nan if segment.step == NEVER else instant_of(run, number, s, X)
            if not math.isnan(sigma):
                gap, _ = c_.free(run, at.motion, segment.edge, step_at(run, sigma), sigma)
                return gap + d - xi * xi
            number = segment.next
    return 0.0


WALK, STATES, WITHOUT_PEAKS, PRESSURE, COMPRESSION = range(5)
"""Tasks of `perform`."""


def perform(task: int, run: Run, attempts: int, times: Any, found: Any, profile: Any) -> int:
    """Perform a task, the only entry to the kernels: walk, or write states at times, or p or u at places.

    These places follow one time, whose state `found` has; p or u, in the `profile`, nothing.
    """
    one = Run(run.given[0], run.now[0], *run[2:])
    if task == WALK:
        return walk(one, attempts)
    if task in (STATES, WITHOUT_PEAKS):
        states(one, times, found, task == STATES)
    else:
        l, r = found.edges[0, 0], found.edges[0, 1]
        at = Contact(c_.motion(one, step_at(one, times[0]), times[0]), l, r)
        for i in range(1, len(times)):
            if task == PRESSURE:
                profile[i] = pressure(one, at, times[i])
            else:
                profile[i] = compression(one, at, times[i])
    return 0
