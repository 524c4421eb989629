"""The row of elements over a step: one source, interpreted or compiled by numba.

Read from the top: the indenter; the row, strip by strip; an element over a step; the implicit step; the
explicit step; sums over the elements at an instant, whole elements or up to the edges; the run.

Loops over elements are array expressions, fast both ways; loops over strips, edges and arms are scalar.
A line contact is one strip. A run of elements in contact is (strip, first, one after the last), counted from
the first stored element. All that is compiled is in this file, since numba does not notice a change in
another. `profile` is None but for a shape given by Python functions, which is interpreted.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.schemes import ContactRule
from kvtheory.theory.laws import Array, Element, ElementStep

Runs = NDArray[np.int64]
Flags = NDArray[np.bool_]

DEPTH, RATE, ALONG, ALONG_RATE, IMBALANCE, FORCE, LAST, GAINED = range(8)
"""The indenter: depth, its rate, both along x, the two forces that judge an explicit step, the last step and
the change of the rate along x in it."""
FIRST, LOW, HIGH, STRIPS, UPDATES = range(5)
"""Counts: the first element stored, the range that is lacking, strips near the indenter, element updates."""
DONE, LACKING, OUTGROWN, THROWN_UP, THROWN_ALONG, UNBALANCED = range(6)
"""How a run ended, or why it paused."""

FAR = 1e200
"""Height (m) where the indenter has no surface."""
SPARE, UNMET = 7, 3
"""Elements beyond those that can be met, and those at each end of the window that never are: edges are
extrapolated from three."""
SMALL_FIT, SMALL_RAMP = 1e-2, 2e-2
"""Below these, the exponential fit and phi_2 are taken from series, where the closed forms cancel."""
NEWTON_STEPS, SLIDE_STEPS = 60, 30
"""Limits that are never reached: the iterations end after two or three."""
SLIDE_RTOL = 1e-9
"""Newton's method along x has converged when its step is below this share of the static half length."""
ROOM, MORE_ROOM = 0.25, 4.0
"""Initial bound on how far the indenter sinks in a step, as a share of the static depth, and the factor by
which it grows if the indenter sinks farther."""
STANDS = 1e-12
"""Share of the static depth: an edge whose overlap falls by less in a step does not move inward."""
STRAIGHT = 0.25
"""Share of w'^2 below which w'^2 - 2 w w'' is that of a square (0), above which that of a line (1)."""
NEAR = 1e-9
"""Share of the spacing: distance inside an edge at which the slope is taken, since it may jump there."""
TIE = 1e-9
"""Relative tolerance within which an element counts as on the surface."""
AT_REST = 1e-12
"""Share of a_0/tau: slower sliding on a spring counts as rest, where the drive tells which edge leads."""
WINDOW = 40
"""Steps over which the balance of forces is judged: a jump of the drive upsets only a few."""


class Surface(NamedTuple):
    """The indenter: h = `steep` r (r/`size`)^(n - 1)/n, n the exponent; a circle of radius `size` if n is 0.

    r is |x| or, if `revolved`, sqrt(x^2 + y^2); `inside` is the largest r of the surface, `across` 1/(2 R')
    of a ball, `stretch` the ratio of width to length of a contact.
    """

    size: float
    exponent: float
    steep: float
    inside: float
    across: float
    revolved: bool
    stretch: float


class Elements(NamedTuple):
    """The stored elements, and what stays constant in a run, in SI; symbols as in `Model`.

    Arrays over strips and elements: `u` is the compression, `touched` whether an element is in contact;
    `arms` are then the forces of its arms, else its modes. Elements `low` to `high` of a strip are near the
    indenter and up to date; one elsewhere is as it was at `since`. An element may stay in contact above the
    plane z = 0, so that all in contact are in `first` to `last`. `height`, `meets`, `slope`, `before` and
    `pressed` are work space. `numbers` holds i + shift of the elements of a strip.
    """

    u: Array
    arms: Array
    since: Array
    touched: Flags
    low: Runs
    high: Runs
    first: Runs
    last: Runs
    counts: Runs
    height: Array
    meets: Array
    slope: Array
    before: Array
    pressed: Flags
    numbers: Array
    surface: Surface
    profile: Any
    law: Element
    rule: ContactRule
    tableau: Array
    fitted: bool
    explicit: bool
    spacing: float
    shift: float
    across: float
    parts: bool
    per_width: bool
    mass: float
    weight: float
    spring: float
    mass_along: float
    spring_along: float
    damping_along: float
    depth: float
    deepest: float
    half_length: float
    rest_velocity: float
    kinks: Array


# The indenter


def height_at(s: Surface, profile: Any, x: Any, y: float) -> Any:
    """Return h(x, y), `FAR` where the indenter has no surface."""
    r = np.hypot(x, y) if s.revolved else x
    if profile is None and s.exponent == 2.0:
        return r * r * (0.5 / s.size) + s.across * (y * y)
    near = np.minimum(np.abs(r), s.inside)
    if profile is not None:
        h = profile.height(np.copysign(near, r))
    elif s.exponent == 0.0:
        h = near * (near / (s.size + np.sqrt((s.size - near) * (s.size + near))))
    else:
        h = s.steep / s.exponent * near * (near / s.size) ** (s.exponent - 1.0)
    return h + FAR * (np.abs(r) > s.inside) + s.across * (y * y)


def slope_at(s: Surface, profile: Any, x: Any, y: float) -> Any:
    """Return dh/dx, zero where the indenter has no surface."""
    if profile is None and s.exponent == 2.0:
        return x * (1.0 / s.size)
    r, side = np.hypot(x, y) if s.revolved else x, np.sign(x)
    near = np.minimum(np.abs(r), s.inside)
    if profile is not None:
        steep = profile.slope(np.copysign(near, r)) * np.copysign(1.0, r)
        side = np.copysign(1.0, x)
    elif s.exponent == 0.0:
        steep = near / np.sqrt((s.size - near) * (s.size + near))
    else:
        steep = s.steep * (near / s.size) ** (s.exponent - 1.0)
    steep = steep * (np.abs(r) <= s.inside)
    return steep * (x / np.maximum(r, 1e-300)) if s.revolved else steep * side


def extent(s: Surface, profile: Any, depth: float, side: float) -> float:
    """Return the distance to one side, -1 or 1, at which h = depth or the surface ends."""
    if profile is not None:
        return float(profile.extent(depth, side))
    if not depth > 0.0:
        return 0.0
    if s.exponent == 2.0:
        return math.sqrt(2.0 * s.size * depth)
    if s.exponent == 0.0:
        return min(math.sqrt(min(depth, s.size) * (2.0 * s.size - min(depth, s.size))), s.inside)
    return min(s.size * (s.exponent * (depth / s.size) / s.steep) ** (1.0 / s.exponent), s.inside)


def weights_across(dy: float, count: int, rim: float) -> Array:
    """Return the quadrature weight of each strip, both sides together, in m; corrected at a `rim` > 0."""
    weights, last = np.full(count, 2.0 * dy), math.floor(rim / dy)
    weights[0], s = dy, rim / dy - last
    if 1 <= last <= count:
        weights[last - 1] += dy * (s * s - s + 1.0 / 6.0) / (1.0 + s)
    return weights


def _weights(e: Elements, depth: float) -> Array:
    """Return the quadrature weight of each strip: 1, or its width in m."""
    strips = e.u.shape[0]
    if not e.across:
        return np.ones(strips)
    rim = e.surface.stretch * extent(e.surface, e.profile, depth, 1.0) if e.parts else 0.0
    return weights_across(e.across, strips, rim)


# The row


def attend(e: Elements, now: float, places: tuple[float, float], depth: float) -> int:
    """Bring up to date the elements that an indenter of at most this depth can meet at both places."""
    if not (depth < e.deepest and math.isfinite(places[0]) and math.isfinite(places[1])):
        return OUTGROWN
    s, dx, first, (stored, width) = e.surface, e.spacing, e.counts[FIRST], e.u.shape
    left, right = extent(s, e.profile, depth, -1.0), extent(s, e.profile, depth, 1.0)
    strips = 1 + int(s.stretch * right / e.across) if e.across else 1
    for j in range(strips, stored):
        strips = j + 1 if e.first[j] < e.last[j] else strips
    for j in range(stored):
        low = high = e.low[j]
        if j < strips:
            share = j * e.across / (s.stretch * right) if right > 0.0 else 1.0
            bent = math.sqrt(max(1.0 - share * share, 0.0))
            low = math.floor((-left * bent - max(places[0], places[1])) / dx) - SPARE - first
            high = math.ceil((right * bent - min(places[0], places[1])) / dx) + SPARE + 1 - first
            if e.first[j] < e.last[j]:
                low, high = min(low, e.first[j] - SPARE), max(high, e.last[j] + SPARE)
            if low < 0 or high > width or strips > stored:
                e.counts[LOW], e.counts[HIGH], e.counts[STRIPS] = low + first, high + first, strips
                return LACKING
            e.counts[UPDATES] += high - low
        before, after = e.low[j], e.high[j]
        e.since[j, before : min(low, after)] = now
        e.since[j, max(high, before) : after] = now
        for new in ((low, min(before, high)), (max(after, low), high)):
            if new[0] < new[1]:  # these were left alone for a while
                past, u = now - e.since[j, new[0] : new[1]], e.u[j, new[0] : new[1]]
                if not e.arms.shape[0]:
                    u *= np.exp(-e.law.rates[0] * past)
                    continue
                u[:] = 0.0
                for k in range(e.arms.shape[0]):
                    mode = e.arms[k, j, new[0] : new[1]]
                    mode *= np.exp(-e.law.rates[k] * past)
                    u += e.law.shares[k] * mode
        e.low[j], e.high[j] = low, high
    e.counts[STRIPS] = strips
    return DONE


def runs_of(flags: Flags, low: Runs, high: Runs) -> Runs:
    """Return the runs of flagged elements; those at both ends of the strips are taken to be out of them."""
    runs, k = np.empty((4, 3), dtype=np.int64), 0
    for j in range(low.size):
        part = flags[j, low[j] : high[j]]
        changes = low[j] + 1 + np.flatnonzero(part[1:] != part[:-1])
        for i in range(0, changes.size - 1, 2):
            if k == runs.shape[0]:
                more = np.empty((2 * k, 3), dtype=np.int64)
                more[:k] = runs
                runs = more
            runs[k, 0], runs[k, 1], runs[k, 2] = j, changes[i], changes[i + 1]
            k += 1
    return runs[:k]


def positions(e: Elements, low: int, high: int, place: float) -> Array:
    """Return x of elements when the base has moved by `place` under the indenter."""
    x: Array = e.spacing * e.numbers[low:high] + place
    return x


def gaps(
    e: Elements, j: int, i: int, out: int, place: float, depth: float
) -> tuple[float, float, float]:
    """Return g - u of element i and the next two in the direction `out`, -1 or 1."""
    first = min(i, i + 2 * out)
    x = e.spacing * e.numbers[first : first + 3] + place
    w = depth - height_at(e.surface, e.profile, x, j * e.across) - e.u[j, first : first + 3]
    return (w[0], w[1], w[2]) if out > 0 else (w[2], w[1], w[0])


# An element over a step


def ramp_functions(z: Array) -> tuple[Array, Array]:
    """Return phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, from 1 and 1/2 at z = 0."""
    phi_1, phi_2 = np.full(z.size, 1.0), np.full(z.size, 0.5)
    for i in range(z.size):
        if z[i] > 0.0:
            phi_1[i] = -math.expm1(-z[i]) / z[i]
            phi_2[i] = (1.0 - phi_1[i]) / z[i]
        if z[i] < SMALL_RAMP:
            series = 1.0
            for n in range(7, 2, -1):
                series = 1.0 - z[i] * series / n
            phi_2[i] = 0.5 * series
    return phi_1, phi_2


def entered(gap: float, rise: float) -> float:
    """Return the share of a step in which an element was in contact, from its overlap at start and end."""
    return rise / (rise - min(gap, 0.0)) if rise > 0.0 else 0.0


def left_alone(e: Elements, step: ElementStep, j: int, low: int, high: int) -> Array:
    """Return u at the end of a step for elements that are detached throughout it."""
    if not e.arms.shape[0]:
        u: Array = step.fall[0] * e.u[j, low:high]
        return u
    left = (e.law.shares[0] * step.fall[0]) * e.arms[0, j, low:high]
    for k in range(1, e.arms.shape[0]):
        left += (e.law.shares[k] * step.fall[k]) * e.arms[k, j, low:high]
    return left


def finish(
    e: Elements, step: ElementStep, runs: Runs, before: float, depths: tuple[float, float]
) -> None:
    """Complete a step: elements in `runs` end on the indenter, all others relax freely.

    `before` is where the base was under the indenter at its start.
    """
    for j in range(e.counts[STRIPS]):
        e.pressed[j, e.low[j] : e.high[j]] = False
        e.first[j] = e.last[j] = 0
    for r in range(runs.shape[0]):
        j, low, high = runs[r, 0], runs[r, 1], runs[r, 2]
        e.pressed[j, low:high] = True
        if low < high:
            e.first[j], e.last[j] = e.first[j] if e.last[j] else low, high
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        if e.arms.shape[0]:
            _pass_arms(e, step, j, before, depths)
        else:
            e.u[j, low:high] *= step.fall[0]
        e.touched[j, low:high] = e.pressed[j, low:high]
    for r in range(runs.shape[0]):
        j, low, high = runs[r, 0], runs[r, 1], runs[r, 2]
        e.u[j, low:high] = depths[1] - e.height[j, low:high]


def _pass_arms(
    e: Elements, step: ElementStep, j: int, before: float, depths: tuple[float, float]
) -> None:
    """Complete a step for the arms of a strip: held ones are loaded, those of free elements are modes."""
    low, law = e.low[j], e.law
    high, u = e.high[j], e.u[j, low : e.high[j]]
    pressed, touched = e.pressed[j, low:high], e.touched[j, low:high]
    changes = np.flatnonzero(pressed != touched)
    gap = np.full(changes.size, 0.0)
    for n in range(changes.size):
        i = low + changes[n]
        if pressed[changes[n]]:
            gap[n] = gaps(e, j, i, 1, before, depths[0])[0]
            continue
        y = e.u[j, i] - e.arms[:, j, i] / law.arm_stiffness
        for k in range(y.size):
            e.arms[k, j, i] = (law.to_modes[k] * y).sum()
    kept, rise = 1.0 * (pressed & touched), depths[1] - e.height[j, low : e.high[j]] - u
    u[:] = 0.0
    for k in range(law.shares.size):
        arm = e.arms[k, j, low : e.high[j]]
        arm *= step.fall[k] + (step.held[k] - step.fall[k]) * kept
        arm += step.ramp[k] * (kept * rise)
        u += law.shares[k] * arm
    for n in range(changes.size):
        i = low + changes[n]
        if pressed[changes[n]]:
            sunk, modes = depths[1] - e.height[j, i] - e.u[j, i], e.arms[:, j, i].copy()
            phi_1, _ = ramp_functions(step.h * entered(gap[n], sunk) / law.arm_time)
            for k in range(modes.size):
                y_k = (law.from_modes[k] * modes).sum()
                e.arms[k, j, i] = law.arm_stiffness[k] * (e.u[j, i] - y_k + phi_1[k] * sunk)


# The implicit step


def exponential_fit(z: float) -> float:
    """Return θ = 1/(1 - e^(-z)) - 1/z, from 1/2 at z = 0 to 1 at infinity.

    >>> exponential_fit(0.0), round(exponential_fit(1.0), 6), exponential_fit(1e9)
    (0.5, 0.581977, 0.999999999)
    """
    return 0.5 + z / 12.0 - z * z * z / 720.0 if z < SMALL_FIT else -1.0 / math.expm1(-z) - 1.0 / z


def _velocity(way: float, before: float, h: float, theta: float) -> float:
    """Return v_1, the velocity at the end of a step with the mean velocity (1-θ) v_0 + θ v_1 = way/h."""
    return (way / h - (1.0 - theta) * before) / theta


def kink_area(overlap: Any) -> Any:
    """Return the area of u at an edge that the trapezoidal rule omits, by dx, and its d/dδ and d²/dδ².

    `overlap` is w at the three nearest elements outside. Between the first of them and the next inside, u
    is the larger of two nearly straight lines, which cross where w = 0; the trapezoid takes the chord
    (theorem `element-kink`). Besides, the jump of the slope leaves a twelfth of it times dx^2, as at every
    end of a smooth piece (Euler-Maclaurin).
    """
    w, far, farthest = overlap
    rise = 2.0 * w - 3.0 * far + farthest
    within = w + rise
    if not (w < 0.0 and within >= 0.0):
        return 0.0, 0.0, 0.0
    half = 0.5 / rise
    return half * within * w + rise / 12.0, half * (within + w), 2.0 * half


class Step(NamedTuple):
    """An implicit step: where the base is under the indenter at its end, and how far it moved there.

    `first` is an initial guess of how far the indenter sinks; `begun` are the runs in contact at the start,
    `relaxed` the area of the kinks at their edges less what relaxes of it, NaN where that was not needed yet;
    `falling` says at which sides of each strip the overlap falls; `late` are the elements (strip, element)
    that come into contact within the step, and `lack` the deficits of their weights.
    """

    place: float
    travel: float
    first: float
    theta: float
    weights: Array
    begun: Runs
    relaxed: Array
    falling: Flags
    late: Runs
    lack: Array


def implicit_step(
    e: Elements, law: ElementStep, begun: Runs, state: Array, now: float, Y: tuple[float, float]
) -> tuple[int, Runs]:
    """Take a step in which the depth at its end is the root of the balance of momentum.

    On a spring, so is the place along x: for every place there is one depth. Return the status, and the
    runs in contact at the end.
    """
    h, sprung, depth, along = law.h, math.isfinite(e.mass_along), state[DEPTH], state[ALONG]
    guess = state[ALONG_RATE] + 0.5 * state[GAINED] * h / max(state[LAST], h)
    slid = h * guess / (1.0 + 0.25 * e.spring_along * h * h / e.mass_along)
    most, sunk, new_rate, new_along_rate = _deepest_fall(e, state, h), 0.0, state[RATE], 0.0
    weights = _weights(e, depth + 0.5 * h * state[RATE])
    falling, runs = np.zeros((e.u.shape[0], 3), dtype=np.bool_), begun
    for _ in range(SLIDE_STEPS):
        place = Y[1] - (along + slid)
        travel = place - (Y[0] - along)
        sinks = min(most, ROOM * e.depth)
        while True:
            status = attend(e, now, (place, place - travel), depth + sinks)
            if status != DONE:
                return status, begun
            first = min(h * state[RATE], sinks)
            step, runs, sums = _lay(e, law, begun, falling, weights, state, (place, travel), first)
            runs, sunk = _sink(e, law, step, runs, sums, state)
            if not sunk > sinks or sinks == most:
                break
            # If elements were missed, it sinks too deep, never too little.
            sinks = min(most, MORE_ROOM * sinks)
            falling[:] = False
        if not sprung:
            break
        before = slid
        slid, new_along_rate = _slide(e, law, step, runs, state, sunk, slid)
        if not abs(slid - before) > SLIDE_RTOL * e.half_length:
            break
    if math.isfinite(e.mass):
        new_rate = _velocity(sunk, state[RATE], h, step.theta)
    finish(e, law, runs, step.place - step.travel, (depth, depth + sunk))
    state[DEPTH], state[RATE] = depth + sunk, new_rate
    if sprung:
        state[GAINED] = new_along_rate - state[ALONG_RATE]
        state[ALONG], state[ALONG_RATE] = along + slid, new_along_rate
    count = 0
    for r in range(runs.shape[0]):
        if runs[r, 1] < runs[r, 2]:
            runs[count] = runs[r]
            count += 1
    return DONE, runs[:count]


def _deepest_fall(e: Elements, state: Array, h: float) -> float:
    """Return how far the indenter could sink in a step without a foundation, at any θ from 1/2 to 1."""
    if math.isinf(e.mass):
        return 0.0
    q = e.spring * h * h / e.mass
    pull = max(e.weight + e.spring * (e.depth - state[DEPTH]), 0.0)
    most = 1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)
    return float(h * max(state[RATE], 0.0) / (1.0 + 0.25 * q) + most * pull * h * h / e.mass)


def _lay(
    e: Elements, law: ElementStep, begun: Runs, falling: Flags, weights: Array, state: Array,
    way: tuple[float, float], first: float,
) -> tuple[Step, Runs, Array]:  # fmt: skip
    """Find how far the indenter must sink to press each element at the end of the step: `meets`.

    There the mean pressure would vanish: at the place of a free element then, and above that of one in
    contact now. An element that passes a kink of the shape is pressed as far as the kink pressed it. Return
    the step, the runs that are pressed if the indenter sinks by `first`, and the sums of `meets` over them.
    """
    depth, (place, travel) = state[DEPTH], way
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        x = positions(e, low, high, place)
        e.height[j, low:high] = height_at(e.surface, e.profile, x, j * e.across)
        e.meets[j, low:high] = left_alone(e, law, j, low, high) - depth
    for r in range(begun.shape[0] if e.arms.shape[0] else 0):
        j, low, high = begun[r, 0], begun[r, 1], begun[r, 2]
        p = e.law.stiffness * e.u[j, low:high]
        for k in range(e.arms.shape[0]):
            p += law.weights[k] * e.arms[k, j, low:high]
        e.meets[j, low:high] = e.u[j, low:high] - p / law.stiffness - depth
    if e.law.damping and e.per_width and travel:
        for n in range(e.kinks.size):
            # What a damper has of the compression by the tip is left at the end of the step, and so is its
            # mean pressure; without this, a wedge stands on its tip at the first order in the spacing.
            kink, passed = e.kinks[n], _passed(e, e.kinks[n], place, travel)
            g = depth - height_at(e.surface, e.profile, np.full(1, kink), 0.0)[0]
            for i in range(passed[0], passed[1]):
                since = law.h * (e.spacing * e.numbers[i] + place - kink) / travel
                pressed = depth - g * math.exp(-since * e.law.rates[0])
                e.height[0, i] = min(e.height[0, i], pressed)
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        e.meets[j, low:high] += e.height[j, low:high]
        e.meets[j, low : low + UNMET] = math.inf
        e.meets[j, high - UNMET : high] = math.inf
    runs = begun.copy()
    for r in range(runs.shape[0]):  # outside only if a caller changed the depth
        low, high = e.low[runs[r, 0]] + UNMET, e.high[runs[r, 0]] - UNMET
        runs[r, 1] = min(max(runs[r, 1], low), high)
        runs[r, 2] = max(min(runs[r, 2], high), low)
    runs, sums, _ = _walk(e, runs, _sums(e, runs), first)
    late, lack = _late(e, law, runs, weights, place - travel, depth, first)
    wide = e.spacing * max(_extent(runs, weights), _extent(begun, weights))
    theta = exponential_fit(law.h * law.damping * wide / e.mass) if e.fitted else 1.0
    relaxed = np.full((begun.shape[0], 2), math.nan)
    step = Step(place, travel, first, theta, weights, begun, relaxed, falling, late, lack)
    return step, runs, sums


def _passed(e: Elements, kink: float, place: float, travel: float) -> tuple[int, int]:
    """Return the range of elements that pass a kink of the shape in a step."""
    at = (kink - place) / e.spacing - e.shift - e.counts[FIRST]
    start, end = min(at, at + travel / e.spacing), max(at, at + travel / e.spacing)
    return max(math.floor(start + NEAR) + 1, e.low[0]), min(math.ceil(end - NEAR), e.high[0])


def _sums(e: Elements, runs: Runs) -> Array:
    """Return the sum of `meets` over each run."""
    sums = np.zeros(runs.shape[0])
    for r in range(runs.shape[0]):
        sums[r] = e.meets[runs[r, 0], runs[r, 1] : runs[r, 2]].sum()
    return sums


def _extent(runs: Runs, weights: Array) -> float:
    """Return the number of elements in runs, by the weights of their strips."""
    total = 0.0
    for r in range(runs.shape[0]):
        total += weights[runs[r, 0]] * (runs[r, 2] - runs[r, 1])
    return total


def _walk(e: Elements, runs: Runs, sums: Array, sunk: float) -> tuple[Runs, Array, bool]:
    """Move the ends of runs to their first and last pressed elements; return whether any moved.

    If runs merged, or new ones appeared, all runs are found again.
    """
    meets, moved, count = e.meets, False, 0
    for r in range(runs.shape[0]):
        j, low, high, total = runs[r, 0], runs[r, 1], runs[r, 2], sums[r]
        while meets[j, low - 1] <= sunk:
            low -= 1
            total += meets[j, low]
        while low < high and not meets[j, low] <= sunk:
            total -= meets[j, low]
            low += 1
        while meets[j, high] <= sunk:
            total += meets[j, high]
            high += 1
        while low < high and not meets[j, high - 1] <= sunk:
            high -= 1
            total -= meets[j, high]
        moved = moved or low != runs[r, 1] or high != runs[r, 2]
        runs[r, 1], runs[r, 2], sums[r] = low, high, total
        count += high - low
    for j in range(e.counts[STRIPS]):
        count -= int(np.count_nonzero(meets[j, e.low[j] : e.high[j]] <= sunk))
    if count == 0:
        return runs, sums, moved
    for j in range(e.counts[STRIPS]):
        e.pressed[j, e.low[j] : e.high[j]] = meets[j, e.low[j] : e.high[j]] <= sunk
    runs = runs_of(e.pressed, e.low, e.high)
    return runs, _sums(e, runs), True


def _late(
    e: Elements, law: ElementStep, runs: Runs, weights: Array, place: float, depth: float, first: float
) -> tuple[Runs, Array]:  # fmt: skip
    """Return the elements that come into contact within the step, and the deficits of their weights.

    Their arms are loaded during part of the step only.
    """
    count = 0
    for r in range(runs.shape[0] if e.arms.shape[0] else 0):
        count += (~e.touched[runs[r, 0], runs[r, 1] : runs[r, 2]]).sum()
    late, lack = np.empty((count, 2), dtype=np.int64), np.empty(count)
    for r in range(runs.shape[0] if count else 0):
        j, low = runs[r, 0], runs[r, 1]
        for i in low + np.flatnonzero(~e.touched[j, low : runs[r, 2]]):
            count -= 1
            share = entered(gaps(e, j, i, 1, place, depth)[0], first - e.meets[j, i])
            _, phi_2 = ramp_functions(law.h * share / e.law.arm_time)
            stiff = 0.5 * e.law.stiffness + (e.law.arm_stiffness * phi_2).sum()
            late[count, 0], late[count, 1] = j, i
            lack[count] = (1.0 - share * stiff / law.stiffness) * weights[j]
    return late, lack


def _sink(
    e: Elements, law: ElementStep, step: Step, runs: Runs, sums: Array, state: Array
) -> tuple[Runs, float]:
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for how far the indenter sinks.

    While no element comes into contact or detaches, F_z is quadratic in the depth: one step of Newton's
    method with the second derivative is exact.
    """
    h, theta, k, sunk = law.h, step.theta, law.stiffness * e.spacing, step.first
    if math.isinf(e.mass):
        return runs, 0.0
    for _ in range(NEWTON_STEPS):
        width, area, bent = _extent(runs, step.weights), 0.0, 0.0
        for r in range(runs.shape[0]):
            area -= step.weights[runs[r, 0]] * sums[r]
        area += sunk * width
        for i in range(step.lack.size):
            overlap = sunk - e.meets[step.late[i, 0], step.late[i, 1]]
            if overlap > 0.0:
                area -= step.lack[i] * overlap
                width -= step.lack[i]
        if e.parts:
            kinks = _kinks(e, law, step, runs, sunk, state[DEPTH])
            area, width, bent = area + kinks[0], width + kinks[1], kinks[2]
        mean = state[DEPTH] - e.depth + theta * sunk
        change_of_rate = _velocity(sunk, state[RATE], h, theta) - state[RATE]
        residual = e.mass * change_of_rate / h - e.weight + e.spring * mean + k * area
        slope = e.mass / (theta * h * h) + theta * e.spring + k * width
        root = math.sqrt(max(slope * slope - 2.0 * residual * k * bent, 0.0))
        sunk -= 2.0 * residual / (slope + root)
        runs, sums, moved = _walk(e, runs, sums, sunk)
        if not moved:
            break
    return runs, sunk


def _kinks(
    e: Elements, law: ElementStep, step: Step, runs: Runs, sunk: float, depth: float
) -> tuple[float, float, float, float]:
    """Return the area of the kinks at edges by dx less what relaxed, its derivatives by depth, and its push.

    A kink of the surface, at an edge between two elements, adds to the area that is pressed. It counts
    where the edge stands or moves outward over the free surface, that is, where the overlap w = g - u
    just outside does not fall. Where the edge moves inward, the surface has no kink, or one that is left
    behind and relaxes like all free surface. Each side of each strip is decided separately.
    """
    falling, place = step.falling, step.place - step.travel
    met = np.zeros(e.u.shape[0], dtype=np.bool_)
    known = falling[0, 2]  # decided once in a step, so that the iteration cannot oscillate
    falling[0, 2] = True
    area = wider = bent = push = 0.0
    for r in range(runs.shape[0]):
        j, low, high = runs[r, 0], runs[r, 1], runs[r, 2]
        for side in range(2 if not known and low < high else 0):
            i = high if side else low - 1
            gap = gaps(e, j, i, 2 * side - 1, place, depth)[0]
            falls = sunk - e.meets[j, i] - gap < -STANDS * e.depth
            falling[j, side] = falls and (falling[j, side] or not met[j])
        met[j] = met[j] or low < high
    for r in range(runs.shape[0] + step.begun.shape[0]):
        ended = r < runs.shape[0]
        q = r if ended else r - runs.shape[0]
        ends = runs[q] if ended else step.begun[q]
        j, low, high = ends[0], ends[1], ends[2]
        for side in range(2 if met[j] and low < high else 0):
            if falling[j, side]:
                continue
            i, out = high if side else low - 1, 2 * side - 1
            if ended:
                w, far = sunk - e.meets[j, i], sunk - e.meets[j, i + out]
                added, more, bend = kink_area((w, far, sunk - e.meets[j, i + 2 * out]))
                wider += step.weights[j] * more
                bent += step.weights[j] * bend
            else:
                if math.isnan(step.relaxed[q, side]):
                    start = kink_area(gaps(e, j, i, out, place, depth))[0]
                    step.relaxed[q, side] = start * (e.law.stiffness / law.stiffness - 1.0)
                added = step.relaxed[q, side]
            area += step.weights[j] * added
            push += step.weights[j] * added * e.slope[j, i - out]
    return area, wider, bent, push


def _slide(
    e: Elements, law: ElementStep, step: Step, runs: Runs, state: Array, sunk: float, slid: float
) -> tuple[float, float]:
    """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

    An element pushes along x with its pressure times the slope halfway through the step, so that the
    mean forces do the very work by which elements of a parabola are compressed.
    """
    h, M_x, c_x, k_x = law.h, e.mass_along, e.damping_along, e.spring_along
    k, width, inclined, tilted, area = law.stiffness * e.spacing, 0.0, 0.0, 0.0, 0.0
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        x = positions(e, low, high, step.place - 0.5 * step.travel)
        e.slope[j, low:high] = slope_at(e.surface, e.profile, x, j * e.across)
    for n in range(e.kinks.size if e.per_width and e.law.damping and step.travel else 0):
        passed = _passed(e, e.kinks[n], step.place, step.travel)
        if passed[0] < passed[1]:  # pressed by the flank that they come from
            x = positions(e, passed[0], passed[1], step.place - step.travel)
            e.slope[0, passed[0] : passed[1]] = slope_at(e.surface, e.profile, x, 0.0)
    for r in range(runs.shape[0]):
        j, weight = runs[r, 0], step.weights[runs[r, 0]]
        slope = e.slope[j, runs[r, 1] : runs[r, 2]]
        width += weight * slope.size
        inclined += weight * slope.sum()
        tilted += weight * np.dot(slope, slope)
        area -= weight * np.dot(slope, e.meets[j, runs[r, 1] : runs[r, 2]])
    area += sunk * inclined
    for i in range(step.lack.size):
        place = step.late[i, 0], step.late[i, 1]
        area -= step.lack[i] * max(sunk - e.meets[place], 0.0) * e.slope[place]
    if e.parts:
        area += _kinks(e, law, step, runs, sunk, state[DEPTH])[3]
    # Oscillations too fast for the step are damped; θ - 1/2 is of the third order in h, as on arms.
    swing = h * math.sqrt(k_x / M_x)
    z = h * (c_x + law.damping * e.spacing * tilted) / M_x + swing * swing * swing
    theta = exponential_fit(z) if e.fitted else 1.0
    change_of_rate = _velocity(slid, state[ALONG_RATE], h, theta) - state[ALONG_RATE]
    held = c_x * slid / h + k_x * (state[ALONG] + theta * slid)
    residual = M_x * change_of_rate / h + held + k * area
    # As the foundation gives way along x, the depth changes, too.
    normal = e.mass / (h * h) + e.spring + k * width
    stiff = k * tilted - (k * inclined) * (k * inclined) / normal
    slid -= residual / (M_x / (theta * h * h) + c_x / h + theta * k_x + stiff)
    return slid, _velocity(slid, state[ALONG_RATE], h, theta)


# The explicit step


def explicit_step(
    e: Elements, laws: tuple[ElementStep, ElementStep, ElementStep], state: Array, now: float,
    Y: Array, V: Array,
) -> int:  # fmt: skip
    """Take a Runge-Kutta step; which elements are in contact is decided at its end.

    `laws` are those of no time, half the step and all of it; Y and V are at these times, V just before the
    end. F_z = dx Σ (K g + C g'). An element in contact detaches where its pressure would be negative, relaxes
    as e^(-t/τ), and is in contact again where the indenter meets it (Eqs. 20-25). Arms are loaded along a
    straight line from the start of the step to each stage, which leaves the order two.
    """
    h, M, M_x = laws[2].h, e.mass, e.mass_along
    stages, begin = e.tableau.shape[0] - 1, Y[0] - state[ALONG]
    rates = np.zeros((stages + 1, 4))  # of depth, its rate, and both along x, at each stage
    now_at = state[:4].copy()
    for i in range(stages + 1):
        share = e.tableau[i, 0] if i < stages else 1.0
        now_at[:] = state[:4]
        for k in range(i):
            now_at += h * e.tableau[i, k + 1] * rates[k]
        rates[i, DEPTH], rates[i, ALONG] = now_at[RATE], now_at[ALONG_RATE]
        if i == stages or math.isfinite(M) or math.isfinite(M_x):
            n = int(2.0 * share)
            places, within = (begin, Y[n] - now_at[ALONG]), share > 0.0 and i < stages
            status, pull, drag = _press(e, laws[n], state, now_at, now, places, V[n], within)
            if status != DONE:
                return status
            rates[i, RATE], rates[i, ALONG_RATE] = pull / M, drag / M_x
    runs = runs_of(e.pressed, e.low, e.high)
    finish(e, laws[2], runs, begin, (state[DEPTH], now_at[DEPTH]))
    if math.isfinite(M):
        mean, first, last = 0.0, rates[0, RATE], rates[stages, RATE]
        for k in range(stages):
            mean += e.tableau[stages, k + 1] * rates[k, RATE]
        state[IMBALANCE] = M * abs(mean - 0.5 * (first + last))
        state[FORCE] = e.weight + M * max(abs(first), abs(last))
    state[:4] = now_at
    return DONE


def _press(
    e: Elements, law: ElementStep, state: Array, at: Array, now: float,
    places: tuple[float, float], velocity: float, within: bool,
) -> tuple[int, float, float]:  # fmt: skip
    """Find which elements press at a stage, and return M δ'' and M_x x'' there, after the status (Eq. 17)."""
    place = places[0] if within and e.rule.still else places[1]
    status = attend(e, now, (places[0], place), max(at[DEPTH], state[DEPTH]))
    if status != DONE:
        return status, 0.0, 0.0
    V, weights = velocity - at[ALONG_RATE], _weights(e, at[DEPTH])
    pull = e.weight - e.spring * (at[DEPTH] - e.depth)
    drag = -e.spring_along * at[ALONG] - e.damping_along * at[ALONG_RATE]
    for j in range(e.counts[STRIPS]):
        low, high, y = e.low[j], e.high[j], j * e.across
        u, touched = e.u[j, low:high], e.touched[j, low:high]
        x = positions(e, low, high, place)
        height, slope = height_at(e.surface, e.profile, x, y), slope_at(e.surface, e.profile, x, y)
        g, left = at[DEPTH] - height, left_alone(e, law, j, low, high)
        p = e.law.stiffness * g + e.law.damping * (at[RATE] - V * slope)
        for k in range(e.arms.shape[0]):
            p += touched * (law.held[k] * e.arms[k, j, low:high] + law.ramp[k] * (g - u))
        if e.arms.shape[0]:
            for i in np.flatnonzero((g > left) & ~touched):
                gap, rise = gaps(e, j, low + i, 1, places[0], state[DEPTH])[0], g[i] - left[i]
                phi_1, _ = ramp_functions(law.h * entered(gap, rise) / e.law.arm_time)
                p[i] += rise * (e.law.arm_stiffness * phi_1).sum() - e.law.stiffness * left[i]
        free = u if e.rule.stale and within else left
        if not e.rule.remembers:
            pressed = (g > 0.0) & (p >= 0.0)
        else:
            pressed = g > 0.0 if e.rule.pulls else p >= 0.0
            pressed &= touched | (g > free) if e.rule.flags else g >= free * (1.0 - TIE)
        e.height[j, low:high], e.pressed[j, low:high] = height, pressed
        each = p * pressed
        pull -= e.spacing * weights[j] * each.sum()
        drag -= e.spacing * weights[j] * np.dot(slope, each)
    return DONE, pull, drag


# Forces and edges at an instant


def report(
    e: Elements, state: Array, law: ElementStep, now: float, about: Array, found: Array
) -> int:
    """Write the report at an instant into `found`, in the order of `error_estimate.COLUMNS`.

    `law` is that of the last step, `about` is (time, V, V just before it, whether the base moves or moved
    last with V >= 0, Y). An element is in contact if the indenter touches its surface and its pressure
    p >= 0 (Eq. 24). Where the pressure is highest at an edge, its doubt is how much it differs between the
    elements beside that.
    """
    time, V, V_before, forward = about[0], about[1], about[2], about[3]
    place = about[4] - state[ALONG]
    status = attend(e, now, (place, place), state[DEPTH])
    if status != DONE:
        return status
    sliding, weights = V - state[ALONG_RATE], _weights(e, state[DEPTH])
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        if V_before != V:
            e.before[j, low:high] = _pressure(e, state, law, j, place, V_before - state[ALONG_RATE])
        p = _pressure(e, state, law, j, place, sliding)
        e.meets[j, low:high] = p
        e.pressed[j, low:high] = e.touched[j, low:high] & ((p >= 0.0) | e.rule.pulls)
    runs = runs_of(e.pressed, e.low, e.high)
    force, push, sums, peak, edge = 0.0, 0.0, np.zeros(4), np.zeros(2), np.zeros(2)
    left = right = math.nan
    for r in range(runs.shape[0]):
        j, low, high = runs[r, 0], runs[r, 1], runs[r, 2]
        p, slope = e.meets[j], e.slope[j]
        sums[0], sums[1] = p[low:high].sum(), np.dot(p[low:high], slope[low:high])
        top = low + np.argmax(p[low:high])
        if e.parts:
            reach = np.full(2, 1.0)
            for side in range(2):
                p_before = e.meets[j] if V_before == V else e.before[j]
                share = _end(e, j, low, high, side, p_before, place, state[DEPTH], sums, edge)
                reach[side] = share if top == (high - 1 if side else low) else 1.0
            if e.per_width:
                _split(e, low, high, place, sliding, sums)
            if p[top] > peak[0] or not peak[0]:
                peak[0], peak[1] = _peak(e, p, top, reach, low, high)
        else:
            x = positions(e, low, high, place)
            sums[1] = np.dot(p[low:high], slope_at(e.surface, e.profile, x, j * e.across))
            sums[2], sums[3] = x[0] - 0.5 * e.spacing, x[-1] + 0.5 * e.spacing
            peak[0] = max(peak[0], p[top])
        force += weights[j] * sums[0]
        push += weights[j] * sums[1]
        if j == 0:
            left, right = sums[2] if math.isnan(left) else left, sums[3]
    if state[ALONG_RATE] and abs(sliding) > AT_REST * e.rest_velocity:
        forward = 1.0 if sliding > 0.0 else 0.0
    found[0], found[1], found[2], found[3] = time, V, state[DEPTH], state[RATE]
    found[4], found[5] = e.spacing * force, -e.spacing * push
    found[6], found[7] = (left, right) if forward else (right, left)
    found[8] = max(peak[0], edge[0])
    found[9] = sliding
    found[10] = e.spring_along * state[ALONG] + e.damping_along * state[ALONG_RATE]
    found[11], found[12] = (0.0, edge[1]) if edge[0] > peak[0] else (peak[1], 0.0)
    return DONE


def _behind(e: Elements, V: float) -> float:
    """Return how far back the slope is taken: an element on a kink is still on the flank before it."""
    return math.copysign(NEAR * e.spacing, V) if e.kinks.size and V else 0.0


def _pressure(e: Elements, state: Array, law: ElementStep, j: int, place: float, V: float) -> Array:
    """Return p of the elements of a strip, g = δ - h(x), g' = δ' - V h'(x) (Eqs. 6, 7, 12); set `slope`.

    For a detached element, it is the pressure it would have had it followed the indenter in the last step:
    brought down by the gap at the start of the step, and then moving with the indenter.
    """
    low, high, y = e.low[j], e.high[j], j * e.across
    x, u = positions(e, low, high, place), e.u[j, low:high]
    slope = slope_at(e.surface, e.profile, x - _behind(e, V), y)
    g, g_rate = state[DEPTH] - height_at(e.surface, e.profile, x, y), state[RATE] - V * slope
    p: Array = e.law.stiffness * g + e.law.damping * g_rate
    for k in range(e.arms.shape[0]):
        brought = e.law.arm_stiffness[k] * law.held[k]
        moved = (law.ramp[k] - brought) * law.h
        touched, followed = 1.0 * e.touched[j, low:high], brought * (g - u) + moved * g_rate
        p += touched * e.arms[k, j, low:high] + (1.0 - touched) * followed
    if e.arms.shape[0]:
        p -= e.law.stiffness * (~e.touched[j, low:high] * u)
    e.slope[j, low:high] = slope
    return p


def _end(
    e: Elements, j: int, low: int, high: int, side: int, p_before: Array, place: float, depth: float,
    sums: Array, edge: Array,
) -> float:  # fmt: skip
    """Extend the sums over a run to its very edge; return how far outward of the last element that is.

    An edge peels where p falls to zero, between two elements by a straight line, and touches where
    the indenter meets the free surface. Where V jumps, an edge that peeled until then, by the pressure
    before, is still where it was, or has gone further in.
    """
    i, out, p, slope = high - 1 if side else low, 2 * side - 1, e.meets[j], e.slope[j]
    now, before = _peeling(p[i], p[i + out]), _peeling(p_before[i], p_before[i + out])
    touches, straight = touching(gaps(e, j, i + out, out, place, depth))
    if math.isinf(before) or straight:
        before = 1.0 if e.touched[j, i + out] else 1.0 - touches
    share = min(before, now, 1.0)
    p_edge = 0.0 if now <= share else p[i] + share * (p[i + out] - p[i])
    x = e.spacing * e.numbers[i] + place
    for n in range(e.kinks.size if e.per_width else 0):
        # There p falls at once, by -C V times the jump of h'.
        ahead = (e.kinks[n] - x) / e.spacing * out
        p_kink = p[i] + ahead * (p[i] - p[i - out])
        if -NEAR <= ahead < min(before, 1.0) and p[i + out] < 0.0 and p_kink > 0.0:
            share, p_edge = ahead, p_kink
    x += share * e.spacing * out
    steep = _slope_of(e, x - NEAR * e.spacing * out, j)
    sums[0] += 0.5 * (share * (p[i] + p_edge) - p[i])
    sums[1] += 0.5 * (share * (slope[i] * p[i] + steep * p_edge) - slope[i] * p[i])
    sums[2 + side] = x
    if p_edge > edge[0]:
        edge[0], edge[1] = p_edge, abs(p[i] - p[i + out])
    return float(share)


def _slope_of(e: Elements, x: float, j: int) -> float:
    """Return dh/dx at one place of a strip."""
    return float(slope_at(e.surface, e.profile, np.full(1, x), j * e.across)[0])


def _peeling(inside: float, outside: float) -> float:
    """Return how far outward of the last element the pressure vanishes; infinite if it does not."""
    return max(inside, 0.0) / (max(inside, 0.0) - outside) if outside < 0.0 else math.inf


def touching(overlap: Any) -> tuple[float, bool]:
    """Return how far inward of the first element outside w = 0 is, from 0 to 1 element, and how w falls.

    w is that of the three nearest elements outside, and continued as their parabola. It falls in a straight
    line, as on free ground, or as a square, where the edge peeled.
    """
    w, far, farthest = overlap
    slope, bend = 1.5 * w - 2.0 * far + 0.5 * farthest, w - 2.0 * far + farthest
    square = slope * slope - 2.0 * w * bend
    fall = slope + math.sqrt(max(square, 0.0))
    share = min(max(-2.0 * w / fall, 0.0), 1.0) if fall else 1.0
    return share, square > STRAIGHT * slope * slope


def _split(e: Elements, low: int, high: int, place: float, V: float, sums: Array) -> None:
    """Split the element that contains a kink of the shape: h' jumps there, and p by -C V times as much.

    Without this, the forces under a wedge are of the first order in the spacing.
    """
    for n in range(e.kinks.size):
        kink, x_0 = e.kinks[n], e.spacing * e.numbers[0] + place
        k = round((kink - x_0) / e.spacing)
        if not low < k < high - 1:
            continue
        x, p = x_0 + k * e.spacing, e.meets[0, k]
        here = _slope_of(e, x - _behind(e, V), 0)
        back = _slope_of(e, kink - NEAR * e.spacing, 0)
        ahead = _slope_of(e, kink + NEAR * e.spacing, 0)
        p_back = p - e.law.damping * V * (back - here)
        p_ahead = p - e.law.damping * V * (ahead - here)
        share = (kink - x) / e.spacing + 0.5
        if p_back >= 0.0 and p_ahead >= 0.0:
            sums[0] += share * p_back + (1.0 - share) * p_ahead - p
            sums[1] += share * p_back * back + (1.0 - share) * p_ahead * ahead - p * here


def _peak(e: Elements, p: Array, k: int, reach: Array, low: int, high: int) -> tuple[float, float]:
    """Return the peak near element k, from the parabola through three, and its uncertainty.

    A shape with kinks has no such parabola: there the peak is known to within one element. Arms remember
    where contact began, so that the pressure itself may have a kink between two elements: then the more
    certain of a parabola and a ridge counts.
    """
    before, here, after = p[k - 1], p[k], p[k + 1]
    doubt = 0.5 * max(here - before, here - after) if e.law.arm_time.size else 0.0
    if e.kinks.size:
        return here, min(abs(here - before), abs(here - after))
    bend = 2.0 * here - before - after
    if not (here >= before and here >= after and bend > 0.0):
        return here, 0.0
    ahead = 0.5 * (after - before) / bend
    height = here + 0.25 * (after - before) * ahead
    if doubt and low + 3 <= k < high - 3:
        # A kink beside the middle adds to one or two of the second differences at the middle three.
        bends = (p[k - 2] - 2.0 * p[k - 1] + p[k], -bend, p[k] - 2.0 * p[k + 1] + p[k + 2])
        smooth, ridge = 0.5 * (max(bends) - min(bends)), _ridge(p[k - 3 : k + 4])
        return (height, smooth) if smooth <= ridge[1] else ridge
    return (here, doubt) if abs(ahead) > reach[1 if ahead > 0.0 else 0] else (height, doubt)


def _ridge(p: Array) -> tuple[float, float]:
    """Return the peak where the curves from both sides meet beside the middle of seven, and its doubt."""
    i = 2 if 2.0 * p[4] - p[3] - p[5] < 2.0 * p[2] - p[1] - p[3] else 3
    back, ahead = p[i] - p[i - 1], p[i + 1] - p[i + 2]
    if not back + ahead > 0.0:
        return p[3], math.inf
    share = min(max((p[i + 1] + ahead - p[i]) / (back + ahead), 0.0), 1.0)
    bend = 0.5 * share * (share + 1.0) * (p[i] - 2.0 * p[i - 1] + p[i - 2])
    bend_ahead = 0.5 * (1.0 - share) * (2.0 - share) * (p[i + 1] - 2.0 * p[i + 2] + p[i + 3])
    one, other = p[i] + back * share + bend, p[i + 1] + ahead * (1.0 - share) + bend_ahead
    doubt = max(abs(bend), abs(bend_ahead)) + abs(one - other)
    return max(0.5 * (one + other), p[3]), doubt


# The run


class Course(NamedTuple):
    """The steps of a run, and what is reported.

    `times` are those before the first step and after each, `steps` their lengths, `Y` and `V` at the start of
    each, halfway and at its end, V just before that. `after` says after which step an instant is
    reported, `about` is that argument of `report`. `limits` are upper bounds, in a stable run, of the speeds
    upward and along, and of the imbalance of the forces. `law` is that of an element over
    steps of no length, and over half and all of each length, numbered by `which`.
    """

    times: Array
    steps: Array
    Y: Array
    V: Array
    after: Runs
    about: Array
    limits: Array
    law: ElementStep
    which: Runs


def _law_at(of: ElementStep, k: int) -> ElementStep:
    """Return the law over one of several lengths."""
    return ElementStep(of.h[k], of.fall[k], of.held[k], of.weights[k], of.ramp[k], of.stiffness[k],
                       of.damping[k])  # fmt: skip


def advance(
    e: Elements, state: Array, course: Course, balances: Array, found: Array,
    step: int, reported: int, until: int,
) -> tuple[int, int, int]:  # fmt: skip
    """Run from a step on; return why it ended, the steps done and the instants reported."""
    none = _law_at(course.law, 0)
    law = _law_at(course.law, 2 * course.which[step - 1] + 2) if step else none
    begun = runs_of(e.touched, e.low, e.high)
    while True:
        now = course.times[step]
        while reported < course.after.size and course.after[reported] == step:
            status = report(e, state, law, now, course.about[reported], found[reported])
            if status != DONE:
                return status, step, reported
            reported += 1
        if step == until:
            return DONE, step, reported
        law, Y = _law_at(course.law, 2 * course.which[step] + 2), course.Y[step]
        if e.explicit:
            half = _law_at(course.law, 2 * course.which[step] + 1)
            status = explicit_step(e, (none, half, law), state, now, Y, course.V[step])
        else:
            status, begun = implicit_step(e, law, begun, state, now, (Y[0], Y[2]))
        if status != DONE:
            return status, step, reported
        state[LAST] = law.h
        balances[0, step % WINDOW], balances[1, step % WINDOW] = state[IMBALANCE], state[FORCE]
        step += 1
        # No element pulls, p >= 0, so that an indenter in contact rises at most with g/τ - V h'; beyond
        # that it has left the foundation, and only a spring can lift it faster. But an unstable step does
        # not always throw it off: when the contact gives way, the oscillation may settle at some amplitude,
        # or on a wrong state at rest, with forces that do not balance the motion. So the balance over each
        # step, M δ'' = W - k_s (δ - δ_0) - F_z, is checked too.
        if not state[RATE] >= course.limits[0]:  # NaN is not above it either
            return THROWN_UP, step, reported
        if not abs(state[ALONG_RATE]) <= course.limits[1]:
            return THROWN_ALONG, step, reported
        forces = balances[1].sum() if e.explicit and balances[1].min() > 0.0 else 0.0
        if forces and balances[0].sum() > course.limits[2] * forces:
            return UNBALANCED, step, reported
