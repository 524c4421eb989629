"""The row of elements over a step: one source, interpreted or compiled by numba.

Read from the top: the indenter; the row, strip by strip; an element over a step; the implicit step; the
explicit step; sums over the elements at an instant, whole elements or up to the edges; the run.

A loop `for i in over(low, high)` is a loop over elements. Compiled, i is one element after the other;
interpreted, it is all of them at once, as a slice, so that what is in such a loop holds for numbers and
arrays. A line contact is one strip. A run of elements in contact is (strip, first, one after the last),
counted from the first stored element. All that is compiled is in this file, since numba does not notice a
change in another. `profile` is None but for a shape given by Python functions, which is interpreted.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.schemes import ContactRule
from kvtheory.theory.laws import Array, Element, ElementStep

Runs = NDArray[np.int64]
Flags = NDArray[np.bool_]

DEPTH, RATE, ALONG, ALONG_RATE, IMBALANCE, FORCE, LAST, GAINED, CURVED = range(9)
"""The indenter: depth, its rate, both along x, the two forces that judge an explicit step, the last step, and
the first and second backward difference of the rate along x."""
FIRST, LOW, HIGH, STRIPS, RUNS, BEGUN, ENDED, UPDATES = range(8)
"""Counts: the first element stored; the range, strips and runs that are needed; the runs in contact at the
start of a step and at its end; element updates."""
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
SLIDE_RTOL = 1e-8
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
    indenter and up to date; one elsewhere is as it was at `since`. `numbers` holds i + shift of the elements
    of a strip, `ones` as many ones. From `height` on all is work space, so that a step allocates nothing.
    """

    u: Array
    arms: Array
    since: Array
    touched: Flags
    low: Runs
    high: Runs
    counts: Runs
    numbers: Array
    ones: Array
    height: Array
    meets: Array
    slope: Array
    before: Array
    pressed: Flags
    late: Flags
    falling: Flags
    weights: Array
    begun: Runs
    ended: Runs
    relaxed: Array
    modes: Array
    stages: Array
    surface: Surface
    profile: Any
    law: Element
    rule: ContactRule
    tableau: Array
    fitted: bool
    spacing: float
    across: float
    parts: bool
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


# Loops over elements


def over(low: Any, high: Any) -> Any:
    """Return the elements from `low` to before `high`: one by one if compiled, else all as one slice."""
    return (slice(low, high),) if low < high else ()


def flagged(flags: Flags, low: Any, high: Any) -> Any:
    """Return which elements are flagged; compiled, all that may be."""
    return low + np.flatnonzero(flags[low:high])


def changed(flags: Flags, low: Any, high: Any) -> Any:
    """Return which elements are flagged while the one before is not, or the reverse; or all that may be."""
    return low + np.flatnonzero(flags[low:high] != flags[low - 1 : max(low, high) - 1])


def dotted(one: Array, other: Array, low: Any, high: Any) -> Any:
    """Return the sum over elements of the product of two quantities."""
    return np.dot(one[low:high], other[low:high])


def total(values: Any) -> Any:
    """Return the sum over the elements of a turn of the loop."""
    return values.sum()


def choose(flags: Any, yes: Any, no: Any) -> Any:
    """Return one of two values for each element of a turn of the loop."""
    return np.where(flags, yes, no)


def _dotted(one: Array, other: Array, low: int, high: int) -> float:
    both = 0.0
    for i in range(max(low, 0), high):
        both += one[i] * other[i]
    return both


COMPILED = {
    "over": lambda low, high: range(max(low, 0), high),
    "flagged": lambda flags, low, high: range(low, high),
    "changed": lambda flags, low, high: range(low, high),
    "dotted": _dotted,
    "total": lambda value: value,
    "choose": lambda flag, yes, no: yes if flag else no,
}
"""What stands for these functions where they are compiled."""


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
    deep = min(depth, s.size)
    far = math.sqrt(deep * (2.0 * s.size - deep))
    if s.exponent:
        far = s.size * (s.exponent * (depth / s.size) / s.steep) ** (1.0 / s.exponent)
    return min(far, s.inside)


def weigh(weights: Array, dy: float, rim: float) -> Array:
    """Write the quadrature weight of each strip, both sides together, in m; corrected at a `rim` > 0."""
    last = math.floor(rim / dy)
    s = rim / dy - last
    for j in range(weights.size):
        weights[j] = 2.0 * dy if j else dy
    if 1 <= last <= weights.size:
        weights[last - 1] += dy * (s * s - s + 1.0 / 6.0) / (1.0 + s)
    return weights


def _weigh(e: Elements, depth: float) -> None:
    """Write the quadrature weight of each strip of a ball; that of a line contact is 1."""
    if e.across:
        rim = e.surface.stretch * extent(e.surface, e.profile, depth, 1.0) if e.parts else 0.0
        weigh(e.weights, e.across, rim)


def heights(e: Elements, j: int, place: float) -> None:
    """Write h at the elements of a strip when the base has moved by `place` under the indenter."""
    s, y, numbers, height = e.surface, j * e.across, e.numbers, e.height[j]
    if e.profile is None and s.exponent == 2.0 and not s.revolved:
        for i in over(e.low[j], e.high[j]):
            x = e.spacing * numbers[i] + place
            height[i] = x * x * (0.5 / s.size) + s.across * (y * y)
    else:
        for i in over(e.low[j], e.high[j]):
            height[i] = height_at(s, e.profile, e.spacing * numbers[i] + place, y)


def slopes(e: Elements, j: int, low: int, high: int, place: float) -> None:
    """Write dh/dx at elements of a strip."""
    s, numbers, slope = e.surface, e.numbers, e.slope[j]
    if e.profile is None and s.exponent == 2.0:
        for i in over(low, high):
            slope[i] = (e.spacing * numbers[i] + place) * (1.0 / s.size)
    else:
        for i in over(low, high):
            slope[i] = slope_at(s, e.profile, e.spacing * numbers[i] + place, j * e.across)


# The row


def update_window(e: Elements, now: float, places: tuple[float, float], depth: float) -> int:
    """Bring up to date the elements that an indenter of at most this depth can meet at both places."""
    if not (depth < e.deepest and math.isfinite(places[0]) and math.isfinite(places[1])):
        return OUTGROWN
    s, dx, first, (stored, width) = e.surface, e.spacing, e.counts[FIRST], e.u.shape
    left, right = extent(s, e.profile, depth, -1.0), extent(s, e.profile, depth, 1.0)
    strips, runs, r = 1 + int(s.stretch * right / e.across) if e.across else 1, e.counts[BEGUN], 0
    if runs:  # an element may stay in contact above the plane z = 0
        strips = max(strips, e.begun[runs - 1, 0] + 1)
    for j in range(stored):
        low = high = e.low[j]
        if j < strips:
            share = j * e.across / (s.stretch * right) if right > 0.0 else 1.0
            bent = math.sqrt(max(1.0 - share * share, 0.0))
            low = math.floor((-left * bent - max(places[0], places[1])) / dx) - SPARE - first
            high = math.ceil((right * bent - min(places[0], places[1])) / dx) + SPARE + 1 - first
            while r < runs and e.begun[r, 0] == j:
                low, high = min(low, e.begun[r, 1] - SPARE), max(high, e.begun[r, 2] + SPARE)
                r += 1
            if low < 0 or high > width or strips > stored:
                e.counts[LOW], e.counts[HIGH], e.counts[STRIPS] = low + first, high + first, strips
                return LACKING
            e.counts[UPDATES] += high - low
        before, after = e.low[j], e.high[j]
        for old in ((before, min(low, after)), (max(high, before), after)):
            for i in over(old[0], old[1]):
                e.since[j, i] = now
        for new in ((low, min(before, high)), (max(after, low), high)):
            for i in over(new[0], new[1]):  # these were left alone for a while
                past = now - e.since[j, i]
                u = e.u[j, i] * np.exp(-e.law.rates[0] * past)
                for k in range(e.arms.shape[0]):
                    mode = e.arms[k, j, i] * np.exp(-e.law.rates[k] * past)
                    u = e.law.shares[k] * mode + (u if k else 0.0)
                    e.arms[k, j, i] = mode
                e.u[j, i] = u
        e.low[j], e.high[j] = low, high
    e.counts[STRIPS] = strips
    return DONE


def find_runs(e: Elements) -> None:
    """Write the runs of pressed elements; the first and last element of a strip belong to none."""
    count = start = 0
    for j in range(e.counts[STRIPS]):
        pressed = e.pressed[j]
        for i in changed(pressed, e.low[j] + 1, e.high[j]):
            if pressed[i] and not pressed[i - 1]:
                start = i
            elif pressed[i - 1] and not pressed[i]:
                if count < e.ended.shape[0]:
                    e.ended[count, 0], e.ended[count, 1], e.ended[count, 2] = j, start, i
                count += 1
    e.counts[RUNS] = max(e.counts[RUNS], count)
    e.counts[ENDED] = min(count, e.ended.shape[0])


def _too_many_runs(e: Elements) -> bool:
    """Whether there are more runs than the arrays hold."""
    e.counts[LOW], e.counts[HIGH] = e.low[0] + e.counts[FIRST], e.high[0] + e.counts[FIRST]
    return bool(e.counts[RUNS] > e.ended.shape[0])


def gap(e: Elements, j: int, i: int, place: float, depth: float) -> float:
    """Return the overlap w = g - u of an element when the base has moved by `place` under the indenter."""
    x = e.spacing * e.numbers[i] + place
    w: float = depth - height_at(e.surface, e.profile, x, j * e.across) - e.u[j, i]
    return w


def gaps(e: Elements, j: int, i: int, out: int, place: float, depth: float) -> Any:
    """Return the overlap of an element and of the next two in the direction `out`, -1 or 1."""
    w, far = gap(e, j, i, place, depth), gap(e, j, i + out, place, depth)
    return w, far, gap(e, j, i + 2 * out, place, depth)


# An element over a step


def _follow(e: Elements, j: int, at: Array, places: tuple[float, float], V: float) -> None:
    """Write height and slope at two places, and to `meets` p = K g + C g' of elements on the indenter.

    g = δ - h(x), g' = δ' - V h'(x) (Eqs. 6, 7, 12).
    """
    height, slope, p = e.height[j], e.slope[j], e.meets[j]
    heights(e, j, places[0])
    slopes(e, j, e.low[j], e.high[j], places[1])
    for i in over(e.low[j], e.high[j]):
        g, g_rate = at[DEPTH] - height[i], at[RATE] - V * slope[i]
        p[i] = e.law.stiffness * g + e.law.damping * g_rate


def ramp_functions(z: float) -> tuple[float, float]:
    """Return phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, from 1 and 1/2 at z = 0."""
    phi_1 = -math.expm1(-z) / z if z > 0.0 else 1.0
    if z >= SMALL_RAMP:
        return phi_1, (1.0 - phi_1) / z
    series = 1.0
    for n in range(7, 2, -1):
        series = 1.0 - z * series / n
    return phi_1, 0.5 * series


def share_in_contact(before: float, rise: float) -> float:
    """Return the share of a step in which an element was in contact, from its overlap at start and end."""
    return rise / (rise - min(before, 0.0)) if rise > 0.0 else 0.0


def relax(e: Elements, step: ElementStep, j: int, low: int, high: int, left: Array) -> None:
    """Write u at the end of a step for elements that are detached throughout it."""
    u, arms = e.u[j], e.arms.shape[0]
    fall = 0.0 if arms else step.fall[0]
    for i in over(low, high):
        left[i] = fall * u[i]
    for k in range(arms):
        arm, fall = e.arms[k, j], e.law.shares[k] * step.fall[k]
        for i in over(low, high):
            left[i] += fall * arm[i]


def finish(e: Elements, step: ElementStep, before: float, depths: tuple[float, float]) -> None:
    """Complete a step: elements that are `pressed` end on the indenter, all others relax freely.

    `before` is where the base was under the indenter at its start.
    """
    for j in range(e.counts[STRIPS]):
        low, high, late = e.low[j], e.high[j], e.late[j]
        u, height, pressed, touched = e.u[j], e.height[j], e.pressed[j], e.touched[j]
        if not e.arms.shape[0]:
            for i in over(low, high):
                u[i] = choose(pressed[i], depths[1] - height[i], step.fall[0] * u[i])
                touched[i] = pressed[i]
            continue
        rise, free = e.slope[j], e.meets[j]
        for i in over(low, high):
            late[i], rise[i], free[i] = pressed[i] != touched[i], depths[1] - height[i] - u[i], 0.0
        for k in range(e.arms.shape[0]):
            arm, share = e.arms[k, j], e.law.shares[k]
            held, ramp, fall = step.held[k], step.ramp[k], step.fall[k]
            for i in over(low, high):
                new = choose(touched[i], held * arm[i] + ramp * rise[i], fall * arm[i])
                arm[i] = choose(late[i], arm[i], new)
                free[i] += share * new
        for i in over(low, high):
            u[i] = choose(late[i], u[i], choose(pressed[i], depths[1] - height[i], free[i]))
        for i in flagged(late, low, high):
            if late[i]:
                _change_contact(e, step, j, i, before, depths)
    begin(e)


def begin(e: Elements) -> None:
    """Take the runs at the end of a step for those at the start of the next."""
    for r in range(e.counts[ENDED]):
        for n in range(3):
            e.begun[r, n] = e.ended[r, n]
    e.counts[BEGUN] = e.counts[ENDED]


def _change_contact(
    e: Elements, step: ElementStep, j: int, i: int, before: float, depths: tuple[float, float]
) -> None:
    """Complete a step for an element that comes into contact in it or detaches.

    The arms of an element in contact are loaded; free, they are modes.
    """
    law, old, free = e.law, e.modes, 0.0
    for k in range(old.size):
        old[k] = e.arms[k, j, i]
    if e.pressed[j, i]:
        relax(e, step, j, i, i + 1, e.meets[j])
        g, left = depths[1] - e.height[j, i], e.meets[j, i]
        share = share_in_contact(gap(e, j, i, before, depths[0]), g - left)
        for k in range(old.size):
            y = 0.0
            for m in range(old.size):
                y += law.from_modes[k, m] * step.fall[m] * old[m]
            phi_1, _ = ramp_functions(step.h * share / law.arm_time[k])
            e.arms[k, j, i] = law.arm_stiffness[k] * (left - y + phi_1 * (g - left))
        e.u[j, i] = g
    else:
        for k in range(old.size):
            mode = 0.0
            for m in range(old.size):
                mode += law.to_modes[k, m] * (e.u[j, i] - old[m] / law.arm_stiffness[m])
            e.arms[k, j, i] = step.fall[k] * mode
            free += law.shares[k] * step.fall[k] * mode
        e.u[j, i] = free
    e.touched[j, i] = e.pressed[j, i]


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


def implicit_step(
    e: Elements, law: ElementStep, state: Array, now: float, Y: tuple[float, float]
) -> int:
    """Take a step in which the depth at its end is the root of the balance of momentum.

    On a spring, so is the place along x: for every place there is one depth.
    """
    h, sprung, depth, along = law.h, math.isfinite(e.mass_along), state[DEPTH], state[ALONG]
    gained = state[GAINED] * h / max(state[LAST], h)
    guess = state[ALONG_RATE] + gained / 2.0 + 5.0 / 12.0 * state[CURVED]  # Adams-Bashforth
    slid = h * guess / (1.0 + 0.25 * e.spring_along * h * h / e.mass_along)
    most, sunk, new_along_rate, known = 0.0, 0.0, 0.0, False
    if math.isfinite(e.mass):  # how far it could sink without a foundation, at any θ from 1/2 to 1
        q = e.spring * h * h / e.mass
        pull = max(e.weight + e.spring * (e.depth - depth), 0.0)
        falls = (1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)) * pull * h * h / e.mass
        most = h * max(state[RATE], 0.0) / (1.0 + 0.25 * q) + falls
    _weigh(e, depth + 0.5 * h * state[RATE])
    for _ in range(SLIDE_STEPS):
        place = Y[1] - (along + slid)
        travel = place - (Y[0] - along)
        sinks = min(most, ROOM * e.depth)
        while True:
            status = update_window(e, now, (place, place - travel), depth + sinks)
            if status != DONE:
                return status
            first = min(h * state[RATE], sinks)
            theta = _thresholds(e, law, known, depth, (place, travel), first)
            sunk = _solve_depth(e, law, theta, first, state)
            # If elements were missed, it sinks too deep, never too little.
            known = not sunk > sinks or sinks == most
            if known:
                break
            sinks = min(most, MORE_ROOM * sinks)
        if not sprung:
            break
        before = slid
        slid, new_along_rate = _solve_along(e, law, (place, travel), state, sunk, slid)
        if not abs(slid - before) > SLIDE_RTOL * e.half_length:
            break
    if _too_many_runs(e):
        return LACKING
    finish(e, law, place - travel, (depth, depth + sunk))
    if math.isfinite(e.mass):
        state[RATE] = _velocity(sunk, state[RATE], h, theta)
    state[DEPTH] = depth + sunk
    if sprung:
        gained = new_along_rate - state[ALONG_RATE]
        state[GAINED], state[CURVED] = gained, gained - state[GAINED] if state[LAST] == h else 0.0
        state[ALONG], state[ALONG_RATE] = along + slid, new_along_rate
    return DONE


def _thresholds(
    e: Elements, law: ElementStep, known: bool, depth: float, way: tuple[float, float], first: float
) -> float:  # fmt: skip
    """Find how far the indenter must sink to press each element at the end of the step: `meets`.

    There the mean pressure would vanish: at the place of a free element then, and above that of one in
    contact now. An element that passes a kink of the shape is pressed as far as the kink pressed it. Return
    θ, which depends on the elements that are pressed if the indenter sinks by `first`.
    """
    (place, travel), arms = way, e.arms.shape[0]
    tip = e.law.damping > 0.0 and not e.across and travel != 0.0
    for j in range(e.counts[STRIPS]):
        low, high, height, meets = e.low[j], e.high[j], e.height[j], e.meets[j]
        heights(e, j, place)
        for n in range(e.kinks.size if tip else 0):
            # What a damper has of the compression by the tip is left at the end of the step, and so is its
            # mean pressure; without this, a wedge stands on its tip at the first order in the spacing.
            passed, kink = _passed(e, e.kinks[n], place, travel), e.kinks[n]
            g = depth - height_at(e.surface, e.profile, kink, 0.0)
            for i in over(passed[0], passed[1]):
                since = law.h * (e.spacing * e.numbers[i] + place - kink) / travel
                height[i] = np.minimum(height[i], depth - g * np.exp(-since * e.law.rates[0]))
        relax(e, law, j, low, high, meets)
        for i in over(low, high):
            meets[i] += height[i] - depth
        for end in (low, high - UNMET):
            for i in over(end, end + UNMET):
                meets[i] = math.inf
    for r in range(e.counts[BEGUN] if arms else 0):
        j, low, high = e.begun[r, 0], e.begun[r, 1], e.begun[r, 2]
        u, height, meets = e.u[j], e.height[j], e.meets[j]
        for i in over(low, high):
            meets[i] = (1.0 - e.law.stiffness / law.stiffness) * u[i] + height[i] - depth
        for k in range(arms):
            arm, share = e.arms[k, j], law.weights[k] / law.stiffness
            for i in over(low, high):
                meets[i] -= share * arm[i]
    _press(e, first)
    find_runs(e)
    if arms:
        _weigh_entering(e, law, place - travel, depth, first)
    if e.parts:
        _judge_edges(e, law, known, place - travel, depth, first)
    wide = max(_extent(e, e.ended, e.counts[ENDED]), _extent(e, e.begun, e.counts[BEGUN]))
    return exponential_fit(law.h * law.damping * e.spacing * wide / e.mass) if e.fitted else 1.0


def _judge_edges(
    e: Elements, law: ElementStep, known: bool, place: float, depth: float, first: float
) -> None:
    """Find, unless it is `known`, where the overlap w = g - u outside falls, so that the edge moves inward.

    This is decided once in a step, so that the iteration cannot oscillate. At the other edges, find what
    relaxes of the kinks at the start.
    """
    for j in range(0 if known else e.counts[STRIPS]):
        e.falling[j, 0] = e.falling[j, 1] = False
    for r in range(0 if known else e.counts[ENDED]):
        j, only = e.ended[r, 0], r == 0 or e.ended[r, 0] != e.ended[r - 1, 0]
        for side in range(2):
            i = e.ended[r, 2] if side else e.ended[r, 1] - 1
            falls = first - e.meets[j, i] - gap(e, j, i, place, depth) < -STANDS * e.depth
            e.falling[j, side] = falls and (only or e.falling[j, side])
    for r in range(e.counts[BEGUN]):
        for side in range(2):
            i, kink = e.begun[r, 2] if side else e.begun[r, 1] - 1, 0.0
            if not e.falling[e.begun[r, 0], side]:
                kink = kink_area(gaps(e, e.begun[r, 0], i, 2 * side - 1, place, depth))[0]
            e.relaxed[r, side] = kink * (e.law.stiffness / law.stiffness - 1.0)


def _press(e: Elements, sunk: float) -> bool:
    """Flag the elements that are pressed if the indenter sinks so far; return whether any flag changed."""
    moved = 0
    for j in range(e.counts[STRIPS]):
        meets, pressed = e.meets[j], e.pressed[j]
        for i in over(e.low[j], e.high[j]):
            new = meets[i] <= sunk
            moved += total(new != pressed[i])
            pressed[i] = new
    return moved > 0


def _passed(e: Elements, kink: float, place: float, travel: float) -> tuple[int, int]:
    """Return the range of elements that pass a kink of the shape in a step."""
    at = (kink - place) / e.spacing - e.numbers[0]
    start, end = min(at, at + travel / e.spacing), max(at, at + travel / e.spacing)
    return max(math.floor(start + NEAR) + 1, e.low[0]), min(math.ceil(end - NEAR), e.high[0])


def _extent(e: Elements, runs: Runs, count: int) -> float:
    """Return the number of elements in runs, by the weights of their strips."""
    width = 0.0
    for r in range(count):
        width += e.weights[runs[r, 0]] * (runs[r, 2] - runs[r, 1])
    return width


def _weigh_entering(
    e: Elements, law: ElementStep, place: float, depth: float, first: float
) -> None:
    """Write to `before` the weight of each element: below 1 if it comes into contact within the step.

    Its arms are loaded during part of the step only.
    """
    for j in range(e.counts[STRIPS]):
        for i in over(e.low[j], e.high[j]):
            e.late[j, i] = e.pressed[j, i] > e.touched[j, i]
            e.before[j, i] = 1.0
        for i in flagged(e.late[j], e.low[j], e.high[j]):
            if e.late[j, i]:
                share = share_in_contact(gap(e, j, i, place, depth), first - e.meets[j, i])
                stiff = 0.5 * e.law.stiffness
                for k in range(e.arms.shape[0]):
                    _, phi_2 = ramp_functions(law.h * share / e.law.arm_time[k])
                    stiff += e.law.arm_stiffness[k] * phi_2
                e.before[j, i] = share * stiff / law.stiffness


def _solve_depth(e: Elements, law: ElementStep, theta: float, sunk: float, state: Array) -> float:
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for how far the indenter sinks.

    While no element comes into contact or detaches, F_z is quadratic in the depth: one step of Newton's
    method with the second derivative is exact.
    """
    h, k, arms = law.h, law.stiffness * e.spacing, e.arms.shape[0]
    for _ in range(NEWTON_STEPS if math.isfinite(e.mass) else 0):
        width = area = 0.0
        for r in range(e.counts[ENDED]):
            j, low, high = e.ended[r, 0], e.ended[r, 1], e.ended[r, 2]
            weight = e.before[j] if arms else e.ones
            elements = dotted(weight, e.ones, low, high) if arms else 1.0 * (high - low)
            area += e.weights[j] * (sunk * elements - dotted(weight, e.meets[j], low, high))
            width += e.weights[j] * elements
        kinks = _kinks(e, sunk) if e.parts else (0.0, 0.0, 0.0, 0.0)
        mean = state[DEPTH] - e.depth + theta * sunk
        change_of_rate = _velocity(sunk, state[RATE], h, theta) - state[RATE]
        held = e.mass * change_of_rate / h - e.weight + e.spring * mean
        residual, width = held + k * (area + kinks[0]), width + kinks[1]
        slope = e.mass / (theta * h * h) + theta * e.spring + k * width
        root = math.sqrt(max(slope * slope - 2.0 * residual * k * kinks[2], 0.0))
        sunk -= 2.0 * residual / (slope + root)
        if not _press(e, sunk):
            break
        find_runs(e)
    return sunk


def _kinks(e: Elements, sunk: float) -> tuple[float, float, float, float]:
    """Return the area of the kinks at edges by dx less what relaxed, its derivatives by depth, and its push.

    A kink of the surface, at an edge between two elements, adds to the area that is pressed. It counts where
    the edge stands or moves outward over the free surface. Where the edge moves inward, the surface has no
    kink, or one that is left behind and relaxes like all free surface.
    """
    area = wider = bent = push = 0.0
    for r in range(e.counts[ENDED]):
        j = e.ended[r, 0]
        for side in range(2):
            if not e.falling[j, side]:
                i, out = e.ended[r, 2] if side else e.ended[r, 1] - 1, 2 * side - 1
                w, far = sunk - e.meets[j, i], sunk - e.meets[j, i + out]
                added, more, bend = kink_area((w, far, sunk - e.meets[j, i + 2 * out]))
                area += e.weights[j] * added
                wider += e.weights[j] * more
                bent += e.weights[j] * bend
                push += e.weights[j] * added * e.slope[j, i - out]
    n = 0
    for r in range(e.counts[BEGUN]):
        j = e.begun[r, 0]
        while n < e.counts[ENDED] and e.ended[n, 0] < j:
            n += 1
        for side in range(2 if n < e.counts[ENDED] and e.ended[n, 0] == j else 0):
            i = e.begun[r, 2] - 1 if side else e.begun[r, 1]
            area += e.weights[j] * e.relaxed[r, side]
            push += e.weights[j] * e.relaxed[r, side] * e.slope[j, i]
    return area, wider, bent, push


def _solve_along(
    e: Elements, law: ElementStep, way: tuple[float, float], state: Array, sunk: float, slid: float
) -> tuple[float, float]:  # fmt: skip
    """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

    An element pushes along x with its pressure times the slope halfway through the step, so that the
    mean forces do the very work by which elements of a parabola are compressed.
    """
    h, M_x, c_x, k_x = law.h, e.mass_along, e.damping_along, e.spring_along
    k, width, inclined, tilted, area = law.stiffness * e.spacing, 0.0, 0.0, 0.0, 0.0
    (place, travel), arms = way, e.arms.shape[0]
    for j in range(e.counts[STRIPS]):
        slopes(e, j, e.low[j], e.high[j], place - 0.5 * travel)
    for n in range(e.kinks.size if not e.across and e.law.damping and travel else 0):
        passed = _passed(e, e.kinks[n], place, travel)
        # These are pressed by the flank that they come from.
        slopes(e, 0, passed[0], passed[1], place - travel)
    for r in range(e.counts[ENDED]):
        j, weight = e.ended[r, 0], e.weights[e.ended[r, 0]]
        width += weight * (e.ended[r, 2] - e.ended[r, 1])
        for i in over(e.ended[r, 1], e.ended[r, 2]):
            slope, overlap = e.slope[j, i], sunk - e.meets[j, i]
            inclined += weight * total(slope)
            tilted += weight * total(slope * slope)
            area += weight * total(slope * (overlap * e.before[j, i] if arms else overlap))
    if e.parts:
        area += _kinks(e, sunk)[3]
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
    rates, at = e.stages, e.stages[stages + 1]  # of depth, its rate, and both along x
    for i in range(stages + 1):
        share = e.tableau[i, 0] if i < stages else 1.0
        for n in range(4):
            at[n] = state[n]
            for k in range(i):
                at[n] += h * e.tableau[i, k + 1] * rates[k, n]
        rates[i, DEPTH], rates[i, ALONG] = at[RATE], at[ALONG_RATE]
        if i == stages or math.isfinite(M) or math.isfinite(M_x):
            n = int(2.0 * share)
            places, within = (begin, Y[n] - at[ALONG]), share > 0.0 and i < stages
            status, pull, drag = _stage(e, laws[n], state, at, now, places, V[n], within)
            if status != DONE:
                return status
            rates[i, RATE], rates[i, ALONG_RATE] = pull / M, drag / M_x
    find_runs(e)
    if _too_many_runs(e):
        return LACKING
    finish(e, laws[2], begin, (state[DEPTH], at[DEPTH]))
    if math.isfinite(M):
        mean, first, last = 0.0, rates[0, RATE], rates[stages, RATE]
        for k in range(stages):
            mean += e.tableau[stages, k + 1] * rates[k, RATE]
        state[IMBALANCE] = M * abs(mean - 0.5 * (first + last))
        state[FORCE] = e.weight + M * max(abs(first), abs(last))
    for n in range(4):
        state[n] = at[n]
    return DONE


def _stage(
    e: Elements, law: ElementStep, state: Array, at: Array, now: float,
    places: tuple[float, float], velocity: float, within: bool,
) -> tuple[int, float, float]:  # fmt: skip
    """Find which elements press at a stage, and return M δ'' and M_x x'' there, after the status (Eq. 17)."""
    place = places[0] if within and e.rule.still else places[1]
    status = update_window(e, now, (places[0], place), max(at[DEPTH], state[DEPTH]))
    if status != DONE:
        return status, 0.0, 0.0
    V, rule, arms = velocity - at[ALONG_RATE], e.rule, e.arms.shape[0]
    _weigh(e, at[DEPTH])
    pull = e.weight - e.spring * (at[DEPTH] - e.depth)
    drag = -e.spring_along * at[ALONG] - e.damping_along * at[ALONG_RATE]
    for j in range(e.counts[STRIPS]):
        low, high, left, p = e.low[j], e.high[j], e.before[j], e.meets[j]
        u, height, slope, held = e.u[j], e.height[j], e.slope[j], e.touched[j]
        _follow(e, j, at, (place, place), V)
        relax(e, law, j, low, high, left)
        for k in range(arms):
            arm = e.arms[k, j]
            for i in over(low, high):
                loaded = law.held[k] * arm[i] + law.ramp[k] * (at[DEPTH] - height[i] - u[i])
                p[i] += choose(held[i], loaded, 0.0)
        for i in over(low, high if arms else low):
            e.late[j, i] = (at[DEPTH] - height[i] > left[i]) > held[i]
        for i in flagged(e.late[j], low, high if arms else 0):
            if not e.late[j, i]:
                continue
            rise, stiff = at[DEPTH] - height[i] - left[i], 0.0
            share = share_in_contact(gap(e, j, i, places[0], state[DEPTH]), rise)
            for k in range(arms):
                phi_1, _ = ramp_functions(law.h * share / e.law.arm_time[k])
                stiff += e.law.arm_stiffness[k] * phi_1
            p[i] += rise * stiff - e.law.stiffness * left[i]
        free = u if rule.stale and within else left
        for i in over(low, high):
            g = at[DEPTH] - height[i]
            if not rule.remembers:
                pressed = (g > 0.0) & (p[i] >= 0.0)
            else:
                pressed = g > 0.0 if rule.pulls else p[i] >= 0.0
                met = held[i] | (g > free[i]) if rule.flags else g >= free[i] * (1.0 - TIE)
                pressed = pressed & met
            e.pressed[j, i] = pressed
            p[i] = choose(pressed, p[i], 0.0)
        pull -= e.spacing * e.weights[j] * dotted(p, e.ones, low, high)
        drag -= e.spacing * e.weights[j] * dotted(p, slope, low, high)
    return DONE, pull, drag


# Forces and edges at an instant


def report(
    e: Elements, state: Array, law: ElementStep, now: float, about: Array, found: Array
) -> int:
    """Write the report at an instant into `found`, in the order of `simulation.COLUMNS`.

    `law` is that of the last step, `about` is (time, V, V just before it, whether the base moves or moved
    last with V >= 0, Y). An element is in contact if the indenter touches its surface and its pressure
    p >= 0 (Eq. 24). Where the pressure is highest at an edge, its doubt is how much it differs between the
    elements beside that.
    """
    time, V, V_before, forward = about[0], about[1], about[2], about[3]
    place = about[4] - state[ALONG]
    status = update_window(e, now, (place, place), state[DEPTH])
    if status != DONE:
        return status
    sliding, peak, doubt, at_edge, edge_doubt = V - state[ALONG_RATE], 0.0, 0.0, 0.0, 0.0
    _weigh(e, state[DEPTH])
    _pressure(e, state, law, place, V_before - state[ALONG_RATE])
    for j in range(e.counts[STRIPS]):
        for i in over(e.low[j], e.high[j]):
            e.before[j, i] = e.meets[j, i]
    if V_before != V:
        _pressure(e, state, law, place, sliding)
    force, push, left, right = 0.0, 0.0, math.nan, math.nan
    find_runs(e)
    if _too_many_runs(e):
        return LACKING
    for r in range(e.counts[ENDED]):
        j, low, high = e.ended[r, 0], e.ended[r, 1], e.ended[r, 2]
        p, top = e.meets[j], low + np.argmax(e.meets[j, low:high])
        if not e.parts:
            slopes(e, j, low, high, place)
        first = _end(e, j, low, -1, place, state[DEPTH])
        last = _end(e, j, high - 1, 1, place, state[DEPTH])
        split = _split(e, low, high, place, sliding)
        normal = dotted(p, e.ones, low, high) + first[1] + last[1] + split[0]
        along = dotted(p, e.slope[j], low, high) + first[2] + last[2] + split[1]
        for end in (first, last):
            if end[3] > at_edge:
                at_edge, edge_doubt = end[3], end[4]
        if p[top] > peak or not peak:
            reach = first[0] if top == low else 1.0, last[0] if top == high - 1 else 1.0
            peak, doubt = _peak(e, p, top, reach, low, high)
        force += e.weights[j] * normal
        push += e.weights[j] * along
        if j == 0:
            left = e.spacing * (e.numbers[low] - first[0]) + place if math.isnan(left) else left
            right = e.spacing * (e.numbers[high - 1] + last[0]) + place
    if state[ALONG_RATE] and abs(sliding) > AT_REST * e.rest_velocity:
        forward = 1.0 if sliding > 0.0 else 0.0
    found[0], found[1], found[2], found[3] = time, V, state[DEPTH], state[RATE]
    found[4], found[5] = e.spacing * force, -e.spacing * push
    found[6], found[7] = (left, right) if forward else (right, left)
    found[8] = max(peak, at_edge)
    found[9] = sliding
    found[10] = e.spring_along * state[ALONG] + e.damping_along * state[ALONG_RATE]
    found[11], found[12] = (0.0, edge_doubt) if at_edge > peak else (doubt, 0.0)
    return DONE


def _behind(e: Elements, V: float) -> float:
    """Return how far back the slope is taken: an element on a kink is still on the flank before it."""
    return math.copysign(NEAR * e.spacing, V) if e.kinks.size and V else 0.0


def _pressure(e: Elements, state: Array, law: ElementStep, place: float, V: float) -> None:
    """Write p of the elements to `meets`.

    For a detached element, it is the pressure it would have had it followed the indenter in the last step:
    brought down by the gap at the start of the step, and then moving with the indenter.
    """
    for j in range(e.counts[STRIPS]):
        low, high, p = e.low[j], e.high[j], e.meets[j]
        u, height, slope, held = e.u[j], e.height[j], e.slope[j], e.touched[j]
        _follow(e, j, state, (place, place - _behind(e, V)), V)
        for k in range(e.arms.shape[0]):
            arm, brought = e.arms[k, j], e.law.arm_stiffness[k] * law.held[k]
            moved = (law.ramp[k] - brought) * law.h
            for i in over(low, high):
                g, g_rate = state[DEPTH] - height[i], state[RATE] - V * slope[i]
                p[i] += choose(held[i], arm[i], brought * (g - u[i]) + moved * g_rate)
        lost = e.law.stiffness if e.arms.shape[0] else 0.0
        for i in over(low, high):
            p[i] -= choose(held[i], 0.0, lost * u[i])
            e.pressed[j, i] = held[i] & ((p[i] >= 0.0) | e.rule.pulls)


def _end(e: Elements, j: int, i: int, out: int, place: float, depth: float) -> Any:
    """Return how far outward of the last element i of a run the edge is, in elements.

    Then what the sums of p and of p h' gain by ending there, p at the edge, and how much p differs between
    the elements beside it. An edge peels where p falls to zero, between two elements by a straight line,
    and touches where the indenter meets the free surface. Where V jumps, an edge that peeled until then, by
    the pressure before, is still where it was, or has gone further in. A run of whole elements ends half an
    element beyond the last.
    """
    if not e.parts:
        return 0.5, 0.0, 0.0, 0.0, 0.0
    p, p_before, slope = e.meets[j], e.before[j], e.slope[j]
    now, before = _peeling(p[i], p[i + out]), _peeling(p_before[i], p_before[i + out])
    touches, straight = touching(gaps(e, j, i + out, out, place, depth))
    if math.isinf(before) or straight:
        before = 1.0 if e.touched[j, i + out] else 1.0 - touches
    share = min(before, now, 1.0)
    p_edge = 0.0 if now <= share else p[i] + share * (p[i + out] - p[i])
    x = e.spacing * e.numbers[i] + place
    for n in range(e.kinks.size if not e.across else 0):
        # There p falls at once, by -C V times the jump of h'.
        ahead = (e.kinks[n] - x) / e.spacing * out
        p_kink = p[i] + ahead * (p[i] - p[i - out])
        if -NEAR <= ahead < min(before, 1.0) and p[i + out] < 0.0 and p_kink > 0.0:
            share, p_edge = ahead, p_kink
    steep = slope_at(e.surface, e.profile, x + (share - NEAR) * e.spacing * out, j * e.across)
    gained = 0.5 * (share * (p[i] + p_edge) - p[i])
    along = 0.5 * (share * (slope[i] * p[i] + steep * p_edge) - slope[i] * p[i])
    return share, gained, along, p_edge, abs(p[i] - p[i + out])


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


def _split(e: Elements, low: int, high: int, place: float, V: float) -> tuple[float, float]:
    """Split the element that contains a kink of the shape: h' jumps there, and p by -C V times as much.

    Return what the sums of p and of p h' gain by that. Without this, the forces under a wedge are of the
    first order in the spacing.
    """
    normal = along = 0.0
    for n in range(e.kinks.size if e.parts and not e.across else 0):
        kink, x_0 = e.kinks[n], e.spacing * e.numbers[0] + place
        k = round((kink - x_0) / e.spacing)
        if not low < k < high - 1:
            continue
        x, p = x_0 + k * e.spacing, e.meets[0, k]
        here = slope_at(e.surface, e.profile, x - _behind(e, V), 0.0)
        back = slope_at(e.surface, e.profile, kink - NEAR * e.spacing, 0.0)
        ahead = slope_at(e.surface, e.profile, kink + NEAR * e.spacing, 0.0)
        p_back = p - e.law.damping * V * (back - here)
        p_ahead = p - e.law.damping * V * (ahead - here)
        share = (kink - x) / e.spacing + 0.5
        if p_back >= 0.0 and p_ahead >= 0.0:
            normal += share * p_back + (1.0 - share) * p_ahead - p
            along += share * p_back * back + (1.0 - share) * p_ahead * ahead - p * here
    return normal, along


def _peak(e: Elements, p: Array, k: int, reach: tuple[float, float], low: int, high: int) -> Any:
    """Return the peak near element k, from the parabola through three, and its uncertainty.

    A shape with kinks has no such parabola: there the peak is known to within one element. Arms remember
    where contact began, so that the pressure itself may have a kink between two elements: then the more
    certain of a parabola and a ridge counts.
    """
    before, here, after = p[k - 1], p[k], p[k + 1]
    doubt = 0.5 * max(here - before, here - after) if e.law.arm_time.size else 0.0
    if not e.parts:
        return here, 0.0
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
    none, explicit = _law_at(course.law, 0), e.tableau.shape[0] > 1
    law = _law_at(course.law, 2 * course.which[step - 1] + 2) if step else none
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
        if explicit:
            half = _law_at(course.law, 2 * course.which[step] + 1)
            status = explicit_step(e, (none, half, law), state, now, Y, course.V[step])
        else:
            status = implicit_step(e, law, state, now, (Y[0], Y[2]))
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
        imbalance = forces = 0.0
        for n in range(WINDOW if explicit else 0):
            known = balances[1, n] > 0.0
            imbalance += balances[0, n]
            forces += balances[1, n] if known else math.inf
        if explicit and imbalance > course.limits[2] * forces:
            return UNBALANCED, step, reported
