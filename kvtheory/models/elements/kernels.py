"""The row of elements over a step: one source, interpreted or compiled by numba.

Read from the top: the indenter; the row, strip by strip; an element over a step; the implicit step; the
explicit step; forces and edges at an instant, whole elements or up to the edges; the run.

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
Pair = tuple[float, float]

DEPTH, RATE, ALONG, ALONG_RATE, IMBALANCE, FORCES, LAST, GAINED, CURVED = range(9)
"""The indenter: depth, its rate, both along x; means of the forces of explicit steps and their imbalance; the
last step, and the first and second backward difference of the rate along x."""
U, HEIGHT, SLOPE, MEETS, PRESSURE = range(5)
"""Numbers of each element: its compression in contact, on arms; h and dh/dx; how far the indenter must sink
from a given depth to press it; its pressure, or the weight of its stiffness in an implicit step."""
TOUCHED, LATE = range(2)
"""Flags of each element: in contact at the start of a step; coming into contact or leaving it in the step."""
OLD, NEW, FALLS = range(3)
"""Of an edge of a run: kink of the surface at start and end of a step, and whether the edge moves inward."""
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
"""Share of the spacing: distance from an edge or kink where the slope is taken, since it may jump there."""
TIE = 1e-9
"""Relative tolerance within which an element counts as on the surface."""
AT_REST = 1e-12
"""Share of a_0/tau: slower sliding on a spring counts as rest, where the drive tells which edge leads."""
WINDOW = 40
"""Steps over which the balance of forces is judged: a jump of the drive upsets only a few."""
FAINT = 1e-100
"""Share to which a mode decays before all are stored anew."""


class Surface(NamedTuple):
    """The indenter: h = `steep` r (r/`size`)^(n - 1)/n, n the exponent; a circle of radius `size` if n is 0.

    r is |x| or, if `revolved`, sqrt(x^2 + y^2); `inside` is the largest r of the surface. A parabola (n = 2)
    has besides, if it is a ball, `across` y^2. `stretch` is the ratio of width to length of a contact.
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

    The compression of a free element is the sum over its modes of `law.shares` times `faded` times what
    `modes` holds: nothing changes in it while it is free, only `faded` decays. On arms, an element in contact
    holds the forces of its arms there, and its compression is in `rows`. `rows` and `flags` are arrays over
    kinds, strips and elements; of a strip, those from `low` to before `high` are near the indenter.
    `numbers` holds i + shift. Runs in contact at the start of a step are `begun`, at its end `ended`.
    """

    modes: Array
    faded: Array
    rows: Array
    flags: Flags
    low: Runs
    high: Runs
    counts: Runs
    numbers: Array
    begun: Runs
    ended: Runs
    edges: Array
    weights: Array
    ramps: Array
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


def crossing(values: Array, level: float, low: Any, high: Any) -> Any:
    """Return the elements before which values pass a level; compiled, all before which they may."""
    below = values[low - 1 : max(low, high)] <= level
    return low + np.flatnonzero(below[1:] != below[:-1])


def dotted(one: Array, other: Array, low: Any, high: Any) -> Any:
    """Return the sum over elements of the product of two quantities."""
    return np.dot(one[low:high], other[low:high])


def summed(values: Array, low: Any, high: Any) -> Any:
    """Return the sum over elements of a quantity."""
    return values[low:high].sum()


def total(values: Any) -> Any:
    """Return the sum over the elements of a turn of the loop."""
    return values.sum()


def choose(flags: Any, yes: Any, no: Any) -> Any:
    """Return one of two values for each element of a turn of the loop."""
    return np.where(flags, yes, no)


def _dotted(one: Array, other: Array, low: int, high: int) -> float:
    both = 0.0
    for i in range(np.uint64(max(low, 0)), np.uint64(max(high, 0))):
        both += one[i] * other[i]
    return both


def _summed(values: Array, low: int, high: int) -> float:
    whole = 0.0
    for i in range(np.uint64(max(low, 0)), np.uint64(max(high, 0))):
        whole += values[i]
    return whole


COMPILED = {
    "over": lambda low, high: range(np.uint64(max(low, 0)), np.uint64(max(high, 0))),
    "flagged": lambda flags, low, high: range(low, high),
    "crossing": lambda values, level, low, high: range(low, high),
    "dotted": _dotted,
    "summed": _summed,
    "total": lambda value: value,
    "choose": lambda flag, yes, no: yes if flag else no,
}
"""What stands for these functions where they are compiled."""


# The indenter


def surface_at(s: Surface, profile: Any, x: Any, y: float, inclined: bool = True) -> Any:
    """Return h and dh/dx at (x, y): `FAR` and 0 where the indenter has no surface.

    A slope that is not wanted (`inclined`) is not taken from Python functions, which are slow.
    """
    if s.exponent == 2.0:
        return x * x * (0.5 / s.size) + s.across * (y * y), x * (1.0 / s.size)
    r = np.hypot(x, y) if s.revolved else np.abs(x)
    near, side = np.minimum(r, s.inside), x / np.maximum(r, 1e-300)
    if profile is not None:
        at = near if s.revolved else np.copysign(near, x)
        h, steep = profile.height(at), profile.slope(at) if inclined else 0.0
        side = side if s.revolved else 1.0
    elif s.exponent == 0.0:
        rest = np.sqrt((s.size - near) * (s.size + near))
        h, steep = near * (near / (s.size + rest)), near / rest
    else:
        steep = s.steep * (near / s.size) ** (s.exponent - 1.0)
        h = near * steep / s.exponent
    return h + FAR * (r > s.inside), steep * side * (r <= s.inside)


def extent(s: Surface, profile: Any, depth: float, side: float) -> float:
    """Return the distance to one side, -1 or 1, at which h = depth or the surface ends."""
    if profile is not None:
        return float(profile.extent(depth, side))
    if not depth > 0.0:
        return 0.0
    if s.exponent == 2.0:
        return min(math.sqrt(2.0 * s.size * depth), s.inside)
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


def weigh_strips(e: Elements, depth: float) -> None:
    """Write the quadrature weight of each strip of a ball; that of a line contact is 1."""
    if e.across:
        rim = e.surface.stretch * extent(e.surface, e.profile, depth, 1.0) if e.parts else 0.0
        weigh(e.weights, e.across, rim)


# The row


def set_window(e: Elements, places: Pair, depth: float) -> int:
    """Find the elements that an indenter of at most this depth can meet at both places of the base."""
    if not (depth < e.deepest and math.isfinite(places[0]) and math.isfinite(places[1])):
        return OUTGROWN
    s, dx, first, (stored, width) = e.surface, e.spacing, e.counts[FIRST], e.rows.shape[1:]
    left, right = extent(s, e.profile, depth, -1.0), extent(s, e.profile, depth, 1.0)
    strips, runs, r = 1 + int(s.stretch * right / e.across) if e.across else 1, e.counts[BEGUN], 0
    if runs:  # an element may stay in contact above the plane z = 0
        strips = max(strips, e.begun[runs - 1, 0] + 1)
    for j in range(min(strips, stored)):
        share = j * e.across / max(s.stretch * right, FAINT)
        bent = math.sqrt(max(1.0 - share * share, 0.0))
        low = math.floor((-left * bent - max(places[0], places[1])) / dx) - SPARE - first
        high = math.ceil((right * bent - min(places[0], places[1])) / dx) + SPARE + 1 - first
        while r < runs and e.begun[r, 0] == j:
            low, high = min(low, e.begun[r, 1] - SPARE), max(high, e.begun[r, 2] + SPARE)
            r += 1
        fits = low >= 0 and high <= width and strips <= stored
        if j == 0 or not fits:
            e.counts[LOW], e.counts[HIGH], e.counts[STRIPS] = low + first, high + first, strips
        if not fits:
            return LACKING
        e.low[j], e.high[j] = low, high
        e.counts[UPDATES] += high - low
    return DONE


def find_runs(e: Elements, kind: int, level: float) -> bool:
    """Find the runs of elements where a row of numbers is at most this; return whether any changed.

    The ends of known runs are moved. If these do not hold all such elements, all elements are looked at.
    """
    changed, inside, found = False, 0, 0
    for r in range(e.counts[ENDED]):
        j, first, last = e.ended[r, 0], e.ended[r, 1], e.ended[r, 2] - 1
        values, low, high = e.rows[kind, j], max(first, e.low[j] + 1), min(last, e.high[j] - 2)
        while low <= high and values[low] > level:
            low += 1
        while low <= high and values[high] > level:
            high -= 1
        while e.low[j] + 1 < low <= high and values[low - 1] <= level:
            low -= 1
        while low <= high < e.high[j] - 2 and values[high + 1] <= level:
            high += 1
        e.ended[r, 1], e.ended[r, 2], changed = (
            low,
            high + 1,
            changed | (low != first) | (high != last),
        )
        inside += high + 1 - low if low <= high and j < e.counts[STRIPS] else -e.numbers.size
    for j in range(e.counts[STRIPS]):
        values = e.rows[kind, j]
        for i in over(e.low[j] + 1, e.high[j] - 1):
            found += total(values[i] <= level)
    if found != inside:
        scan_runs(e, kind, level)
    return changed or found != inside


def scan_runs(e: Elements, kind: int, level: float) -> None:
    """Find the runs of elements where a row of numbers is at most this."""
    count = start = 0
    for j in range(e.counts[STRIPS]):
        values = e.rows[kind, j]
        for i in crossing(values, level, e.low[j] + 1, e.high[j]):
            if values[i] <= level < values[i - 1]:
                start = i
            elif values[i - 1] <= level < values[i]:
                if count < e.ended.shape[0]:
                    e.ended[count, 0], e.ended[count, 1], e.ended[count, 2] = j, start, i
                count += 1
    e.counts[RUNS], e.counts[ENDED] = count, min(count, e.ended.shape[0])


def approach(e: Elements, fall: Array, place: float, back: float, depth: float) -> None:
    """Write h, dh/dx, and to `MEETS` how far the indenter must sink from a depth to meet free elements.

    The base has moved by `place` under the indenter, and by `back` less where dh/dx is taken; if it is not
    wanted, `back` is infinite. `fall` are the decay factors of the modes of free elements over the step.
    """
    s, numbers, inclined = e.surface, e.numbers, math.isfinite(back)
    for j in range(e.counts[STRIPS]):
        y, low, high = j * e.across, e.low[j], e.high[j]
        height, slope, meets = e.rows[HEIGHT, j], e.rows[SLOPE, j], e.rows[MEETS, j]
        for i in over(low, high if s.exponent == 2.0 else low):
            x = e.spacing * numbers[i] + place
            height[i] = x * x * (0.5 / s.size) + s.across * (y * y)
            if inclined:
                slope[i] = (x - back) * (1.0 / s.size)
        for i in over(low, low if s.exponent == 2.0 else high):
            x = e.spacing * numbers[i] + place
            height[i], slope[i] = surface_at(s, e.profile, x, y, inclined)
            if inclined and back:
                slope[i] = surface_at(s, e.profile, x - back, y, True)[1]
        for k in range(fall.size):
            mode, share = e.modes[k, j], e.law.shares[k] * e.faded[k] * fall[k]
            for i in over(low, high):
                meets[i] = (meets[i] if k else height[i] - depth) + share * mode[i]


def press(e: Elements, law: ElementStep, at: Array, V: float) -> None:
    """Write p = K g + C g' + Σ s_k of elements on the indenter, sliding at V: `PRESSURE` (Eqs. 6, 7, 12).

    The arms are those of elements in contact at the start of a step, loaded since along a straight line.
    """
    for j in range(e.counts[STRIPS]):
        low, high, p, u, touched = (
            e.low[j],
            e.high[j],
            e.rows[PRESSURE, j],
            e.rows[U, j],
            e.flags[TOUCHED, j],
        )
        height, slope = e.rows[HEIGHT, j], e.rows[SLOPE, j]
        for i in over(low, high):
            g, g_rate = at[DEPTH] - height[i], at[RATE] - V * slope[i]
            p[i] = e.law.stiffness * g + e.law.damping * g_rate
        for k in range(e.ramps.size):
            arm = e.modes[k, j]
            for i in over(low, high):
                loaded = law.held[k] * arm[i] + law.ramp[k] * (at[DEPTH] - height[i] - u[i])
                p[i] += choose(touched[i], loaded, 0.0)


def gap(e: Elements, j: int, i: int, place: float, depth: float) -> float:
    """Return the overlap w = g - u of an element when the base has moved by `place` under the indenter."""
    u = e.rows[U, j, i]
    if not (e.flags[TOUCHED, j, i] and e.law.arm_time.size):
        u = 0.0
        for k in range(e.faded.size):
            u += e.law.shares[k] * e.faded[k] * e.modes[k, j, i]
    h = surface_at(e.surface, e.profile, e.spacing * e.numbers[i] + place, j * e.across)[0]
    return float(depth - h - u)


# An element over a step


def ramp_functions(z: float) -> Pair:
    """Return phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, from 1 and 1/2 at z = 0."""
    phi_1 = -math.expm1(-z) / z if z > 0.0 else 1.0
    if z >= SMALL_RAMP:
        return phi_1, (1.0 - phi_1) / z
    series = 1.0
    for n in range(7, 2, -1):
        series = 1.0 - z * series / n
    return phi_1, 0.5 * series


def enter(e: Elements, h: float, j: int, i: int, start: Pair, rise: float) -> Pair:
    """Return the stiffness of an element that the indenter meets in a step, at its end and on average.

    It is loaded during a share of the step, by `rise`, which follows from its overlap at the `start`, place
    and depth. Of an arm, phi_1 is left in `ramps`.
    """
    before = min(gap(e, j, i, start[0], start[1]), 0.0)
    share = rise / (rise - before) if rise > 0.0 else 0.0
    end, mean = e.law.stiffness, 0.5 * e.law.stiffness
    for k in range(e.ramps.size):
        e.ramps[k], phi_2 = ramp_functions(h * share / e.law.arm_time[k])
        end += e.law.arm_stiffness[k] * e.ramps[k]
        mean += e.law.arm_stiffness[k] * phi_2
    return end, share * mean


def change_contact(
    e: Elements, law: ElementStep, j: int, i: int, start: Pair, g: float, rise: float
) -> None:
    """Complete a step for an element that leaves the indenter in it, or that it meets: u = g, up by `rise`.

    y_k = u - s_k/K_k, the compressions of the dampers of the arms, are a product of a matrix and the modes.
    """
    arm, old, stiffness, arms = e.modes[:, j, i], e.stages[6], e.law.arm_stiffness, e.ramps.size
    leaves = e.flags[TOUCHED, j, i]
    if not leaves:
        enter(e, law.h, j, i, start, rise)
    for k in range(arms):
        mode = arm[k] * e.faded[k] * law.fall[k]
        old[k] = e.rows[U, j, i] - arm[k] / stiffness[k] if leaves else mode
    for k in range(arms):
        new = 0.0
        for m in range(arms):
            new += (e.law.to_modes[k, m] if leaves else e.law.from_modes[k, m]) * old[m]
        arm[k] = new / e.faded[k] if leaves else stiffness[k] * (g - rise - new + e.ramps[k] * rise)


def finish(e: Elements, law: ElementStep, start: Pair, depth: float, sunk: float) -> None:
    """Complete a step: the elements of the runs at its end are on the indenter, at this depth.

    `start` are place and depth at its start, `sunk` is how far the indenter sank since `MEETS` was written.
    """
    arms = e.ramps.size
    for j in range(e.counts[STRIPS] if arms else 0):
        low, high, height, meets = e.low[j], e.high[j], e.rows[HEIGHT, j], e.rows[MEETS, j]
        u, touched, late = e.rows[U, j], e.flags[TOUCHED, j], e.flags[LATE, j]
        for i in over(low, high):
            late[i] = (meets[i] <= sunk) != touched[i]
        for k in range(arms):
            arm, held, ramp = e.modes[k, j], law.held[k], law.ramp[k]
            for i in over(low, high):
                loaded = held * arm[i] + ramp * (depth - height[i] - u[i])
                arm[i] = choose(touched[i] > late[i], loaded, arm[i])
        for i in flagged(late, low, high):
            if late[i]:
                change_contact(e, law, j, i, start, depth - height[i], sunk - meets[i])
        for i in over(low, high):
            u[i] = depth - height[i]
    begin(e)
    fade(e, law)
    for r in range(0 if arms else e.counts[ENDED]):
        j, grown = e.ended[r, 0], 1.0 / e.faded[0]
        mode, height = e.modes[0, j], e.rows[HEIGHT, j]
        for i in over(e.ended[r, 1], e.ended[r, 2]):
            mode[i] = (depth - height[i]) * grown


def fade(e: Elements, law: ElementStep) -> None:
    """Let the modes of free elements decay over a step."""
    for k in range(e.faded.size):
        e.faded[k] *= law.fall[k]
        if e.faded[k] < FAINT:
            for j in range(e.flags.shape[1]):
                for i in over(0, e.numbers.size):
                    e.modes[k, j, i] *= choose(e.flags[TOUCHED, j, i], 1.0, e.faded[k])
            e.faded[k] = 1.0


def begin(e: Elements) -> None:
    """Take the runs at the end of a step, and their kinks, for those at the start of the next."""
    for r in range(e.counts[BEGUN]):
        touched = e.flags[TOUCHED, e.begun[r, 0]]
        for i in over(e.begun[r, 1], e.begun[r, 2]):
            touched[i] = False
    for r in range(e.counts[ENDED]):
        for n in range(3):
            e.begun[r, n] = e.ended[r, n]
        for side in range(2):
            e.edges[r, side, OLD] = e.edges[r, side, NEW]
        touched = e.flags[TOUCHED, e.ended[r, 0]]
        for i in over(e.ended[r, 1], e.ended[r, 2]):
            touched[i] = True
    e.counts[BEGUN] = e.counts[ENDED]


# The implicit step


def exponential_fit(z: float) -> float:
    """Return θ = 1/(1 - e^(-z)) - 1/z, from 1/2 at z = 0 to 1 at infinity.

    >>> exponential_fit(0.0), round(exponential_fit(1.0), 6), exponential_fit(1e9)
    (0.5, 0.581977, 0.999999999)
    """
    return 0.5 + z / 12.0 - z * z * z / 720.0 if z < SMALL_FIT else -1.0 / math.expm1(-z) - 1.0 / z


def final_velocity(way: float, before: float, h: float, theta: float) -> float:
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


def implicit_step(e: Elements, law: ElementStep, state: Array, Y: Pair) -> int:
    """Take a step in which the depth at its end is the root of the balance of momentum.

    On a spring, so is the place along x: for every place there is one depth.
    """
    h, sprung, depth, along = law.h, math.isfinite(e.mass_along), state[DEPTH], state[ALONG]
    gained = state[GAINED] * h / max(state[LAST], h)
    guess = state[ALONG_RATE] + gained / 2.0 + 5.0 / 12.0 * state[CURVED]  # Adams-Bashforth
    slid = h * guess / (1.0 + 0.25 * e.spring_along * h * h / e.mass_along)
    most, sunk, new_along_rate, known = 0.0, 0.0, 0.0, not e.parts
    if math.isfinite(e.mass):  # how far it could sink without a foundation, at any θ from 1/2 to 1
        q = e.spring * h * h / e.mass
        pull = max(e.weight + e.spring * (e.depth - depth), 0.0)
        falls = (1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)) * pull * h * h / e.mass
        most = h * max(state[RATE], 0.0) / (1.0 + 0.25 * q) + falls
    weigh_strips(e, depth + 0.5 * h * state[RATE])
    for _ in range(SLIDE_STEPS):
        place = Y[1] - (along + slid)
        travel = place - (Y[0] - along)
        start = place - travel, depth
        sinks = min(most, ROOM * e.depth)
        while True:
            status = set_window(e, (place, place - travel), depth + sinks)
            if status != DONE:
                return status
            first = min(h * state[RATE], sinks)
            find_thresholds(e, law, place, travel, start, first)
            if not known:
                judge_edges(e, start, first)
            wide = max(
                number_in(e, e.ended, e.counts[ENDED]), number_in(e, e.begun, e.counts[BEGUN])
            )
            z = h * law.damping * e.spacing * wide / e.mass
            theta = exponential_fit(z) if e.fitted else 1.0
            sunk = solve_depth(e, law, theta, first, state)
            # If elements were missed, it sinks too deep, never too little.
            if not sunk > sinks or sinks == most:
                break
            sinks = min(most, MORE_ROOM * sinks)
        if not sprung:
            break
        before, known = slid, True
        slid, new_along_rate = solve_along(e, law, state, sunk, slid)
        if not abs(slid - before) > SLIDE_RTOL * e.half_length:
            break
    if e.counts[RUNS] > e.ended.shape[0]:
        return LACKING
    finish(e, law, start, depth + sunk, sunk)
    if math.isfinite(e.mass):
        state[RATE] = final_velocity(sunk, state[RATE], h, theta)
    state[DEPTH] = depth + sunk
    if sprung:
        gained = new_along_rate - state[ALONG_RATE]
        state[GAINED], state[CURVED] = gained, gained - state[GAINED] if state[LAST] == h else 0.0
        state[ALONG], state[ALONG_RATE] = along + slid, new_along_rate
    return DONE


def find_thresholds(
    e: Elements, law: ElementStep, place: float, travel: float, start: Pair, first: float
) -> None:  # fmt: skip
    """Find how far the indenter must sink to press each element at the end of the step: `MEETS`.

    There the mean pressure would vanish: at the place of a free element then, and above that of one in
    contact now. Then find the runs, and the weights of their elements, if it sinks by `first`.
    """
    depth, arms = start[1], e.ramps.size
    approach(e, law.fall, place, 0.5 * travel if math.isfinite(e.mass_along) else math.inf, depth)
    for n in range(e.kinks.size if e.law.damping and not e.across and travel else 0):
        pass_kink(e, e.kinks[n], place, travel, depth, law.h)
    for j in range(e.counts[STRIPS]):
        for end in (e.low[j], e.high[j] - UNMET):
            for i in over(end, end + UNMET):
                e.rows[MEETS, j, i] = math.inf
    for r in range(e.counts[BEGUN] if arms else 0):
        j, low, high = e.begun[r, 0], e.begun[r, 1], e.begun[r, 2]
        u, height, meets = e.rows[U, j], e.rows[HEIGHT, j], e.rows[MEETS, j]
        for i in over(low, high):
            meets[i] = (1.0 - e.law.stiffness / law.stiffness) * u[i] + height[i] - depth
        for k in range(arms):
            arm, share = e.modes[k, j], law.weights[k] / law.stiffness
            for i in over(low, high):
                meets[i] -= share * arm[i]
    find_runs(e, MEETS, first)
    for j in range(e.counts[STRIPS] if arms else 0):
        # Of elements that come into contact within the step, the arms are loaded during a part of it only.
        meets, weight, late = e.rows[MEETS, j], e.rows[PRESSURE, j], e.flags[LATE, j]
        for i in over(e.low[j], e.high[j]):
            late[i], weight[i] = (meets[i] <= first) > e.flags[TOUCHED, j, i], 1.0
        for i in flagged(late, e.low[j], e.high[j]):
            if late[i]:
                weight[i] = enter(e, law.h, j, i, start, first - meets[i])[1] / law.stiffness


def pass_kink(
    e: Elements, kink: float, place: float, travel: float, depth: float, h: float
) -> None:
    """Change what is known of the elements that pass a kink of the shape in a step.

    What a damper has of the compression by a tip is left at the end of the step, and so is its mean
    pressure; without this, a wedge stands on its tip at the first order in the spacing.
    """
    s, height, meets = e.surface, e.rows[HEIGHT, 0], e.rows[MEETS, 0]
    now = (kink - place) / e.spacing - e.numbers[0]
    start, end = min(now, now + travel / e.spacing), max(now, now + travel / e.spacing)
    low, high = max(math.floor(start + NEAR) + 1, e.low[0]), min(math.ceil(end - NEAR), e.high[0])
    g = depth - surface_at(s, e.profile, kink, 0.0)[0]
    for i in over(low, high):
        x = e.spacing * e.numbers[i] + place
        lowest = np.minimum(height[i], depth - g * np.exp((kink - x) / travel * h * e.law.rates[0]))
        meets[i], height[i] = meets[i] + lowest - height[i], lowest
        # It is pressed by the flank that it comes from.
        e.rows[SLOPE, 0, i] = surface_at(s, e.profile, x - travel, 0.0)[1]


def judge_edges(e: Elements, start: Pair, first: float) -> None:
    """Find where the overlap w = g - u outside a run falls, so that the edge moves inward.

    This is decided once in a step, so that the iteration cannot oscillate.
    """
    for r in range(e.edges.shape[0]):
        for side in range(2 if r < e.counts[ENDED] else 0):
            j, i = e.ended[r, 0], e.ended[r, 2] if side else e.ended[r, 1] - 1
            change = first - e.rows[MEETS, j, i] - gap(e, j, i, start[0], start[1])
            e.edges[r, side, FALLS] = 1.0 if change < -STANDS * e.depth else 0.0


def number_in(e: Elements, runs: Runs, count: int) -> float:
    """Return the number of elements in runs, by the weights of their strips."""
    width = 0.0
    for r in range(count):
        width += e.weights[runs[r, 0]] * (runs[r, 2] - runs[r, 1])
    return width


def solve_depth(e: Elements, law: ElementStep, theta: float, sunk: float, state: Array) -> float:
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for how far the indenter sinks.

    While no element comes into contact or detaches, F_z is quadratic in the depth: one step of Newton's
    method with the second derivative is exact.
    """
    h, k, arms = law.h, law.stiffness * e.spacing, e.ramps.size
    for _ in range(NEWTON_STEPS if math.isfinite(e.mass) else 0):
        area, width, bent, _ = add_kinks(e, law, sunk)
        for r in range(e.counts[ENDED]):
            j, low, high = e.ended[r, 0], e.ended[r, 1], e.ended[r, 2]
            meets, share, elements = e.rows[MEETS, j], e.rows[PRESSURE, j], 1.0 * (high - low)
            below = dotted(share, meets, low, high) if arms else summed(meets, low, high)
            elements = summed(share, low, high) if arms else elements
            area += e.weights[j] * (sunk * elements - below)
            width += e.weights[j] * elements
        mean = state[DEPTH] - e.depth + theta * sunk
        change_of_rate = final_velocity(sunk, state[RATE], h, theta) - state[RATE]
        residual = e.mass * change_of_rate / h - e.weight + e.spring * mean + k * area
        slope = e.mass / (theta * h * h) + theta * e.spring + k * width
        root = math.sqrt(max(slope * slope - 2.0 * residual * k * bent, 0.0))
        sunk -= 2.0 * residual / (slope + root)
        if not find_runs(e, MEETS, sunk):
            break
    return sunk


def add_kinks(e: Elements, law: ElementStep, sunk: float) -> tuple[float, float, float, float]:
    """Return the area of the kinks at edges by dx less what relaxed, its derivatives by depth, and its push.

    A kink of the surface, at an edge between two elements, adds to the area that is pressed. It counts where
    the edge stands or moves outward over the free surface. Where the edge moves inward, the surface has no
    kink, or one that is left behind and relaxes like all free surface.
    """
    area = wider = bent = push = 0.0
    for r in range(e.counts[ENDED] if e.parts else 0):
        j, old = e.ended[r, 0], r < e.counts[BEGUN] and e.begun[r, 0] == e.ended[r, 0]
        for side in range(2):
            edge = e.edges[r, side]
            edge[NEW] = 0.0
            if not edge[FALLS]:
                i, out = e.ended[r, 2] if side else e.ended[r, 1] - 1, 2 * side - 1
                w, far = sunk - e.rows[MEETS, j, i], sunk - e.rows[MEETS, j, i + out]
                added, more, bend = kink_area((w, far, sunk - e.rows[MEETS, j, i + 2 * out]))
                edge[NEW] = added
                added -= (1.0 - e.law.stiffness / law.stiffness) * edge[OLD] if old else 0.0
                area += e.weights[j] * added
                wider += e.weights[j] * more
                bent += e.weights[j] * bend
                push += e.weights[j] * added * e.rows[SLOPE, j, i - out]
    return area, wider, bent, push


def solve_along(e: Elements, law: ElementStep, state: Array, sunk: float, slid: float) -> Pair:
    """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

    An element pushes along x with its pressure times the slope halfway through the step, so that the
    mean forces do the very work by which elements of a parabola are compressed.
    """
    h, M_x, c_x, k_x = law.h, e.mass_along, e.damping_along, e.spring_along
    k, width, inclined, tilted, area = law.stiffness * e.spacing, 0.0, 0.0, 0.0, 0.0
    arms = e.ramps.size
    for r in range(e.counts[ENDED]):
        j, low, high = e.ended[r, 0], e.ended[r, 1], e.ended[r, 2]
        weight, slope, meets = e.weights[j], e.rows[SLOPE, j], e.rows[MEETS, j]
        width += weight * (high - low)
        inclined += weight * summed(slope, low, high)
        tilted += weight * dotted(slope, slope, low, high)
        for i in over(low, high):
            pushed = slope[i] * (sunk - meets[i])
            area += weight * total(pushed * e.rows[PRESSURE, j, i] if arms else pushed)
    area += add_kinks(e, law, sunk)[3]
    # Oscillations too fast for the step are damped; θ - 1/2 is of the third order in h, as on arms.
    swing = h * math.sqrt(k_x / M_x)
    z = h * (c_x + law.damping * e.spacing * tilted) / M_x + swing * swing * swing
    theta = exponential_fit(z) if e.fitted else 1.0
    change_of_rate = final_velocity(slid, state[ALONG_RATE], h, theta) - state[ALONG_RATE]
    held = c_x * slid / h + k_x * (state[ALONG] + theta * slid)
    residual = M_x * change_of_rate / h + held + k * area
    # As the foundation gives way along x, the depth changes, too.
    normal = e.mass / (h * h) + e.spring + k * width
    stiff = k * tilted - (k * inclined) * (k * inclined) / normal
    slid -= residual / (M_x / (theta * h * h) + c_x / h + theta * k_x + stiff)
    return slid, final_velocity(slid, state[ALONG_RATE], h, theta)


# The explicit step


def explicit_step(
    e: Elements,
    laws: tuple[ElementStep, ElementStep, ElementStep],
    state: Array,
    Y: Array,
    V: Array,
) -> int:
    """Take a Runge-Kutta step; which elements are in contact is decided at its end.

    `laws` are those of no time, half the step and all of it; Y and V are at these times, V just before the
    end. F_z = dx Σ (K g + C g'). An element in contact detaches where its pressure would be negative, relaxes
    as e^(-t/τ), and is in contact again where the indenter meets it (Eqs. 20-25). Arms are loaded along a
    straight line from the start of the step to each stage, which leaves the order two.
    """
    h, M, M_x = laws[2].h, e.mass, e.mass_along
    stages, start = e.tableau.shape[0] - 1, (Y[0] - state[ALONG], state[DEPTH])
    rates, at = e.stages, e.stages[stages + 1]  # of depth, its rate, and both along x
    for i in range(stages + 1):
        n = int(2.0 * e.tableau[i, 0])
        for m in range(4):
            at[m] = state[m]
            for k in range(i):
                at[m] += h * e.tableau[i, k + 1] * rates[k, m]
        rates[i, DEPTH], rates[i, ALONG] = at[RATE], at[ALONG_RATE]
        if i == stages or math.isfinite(M) or math.isfinite(M_x):
            within = n > 0 and i < stages
            place = start[0] if within and e.rule.still else Y[n] - at[ALONG]
            fall = laws[0 if within and e.rule.stale else n].fall
            status = set_window(e, (start[0], place), max(at[DEPTH], state[DEPTH]))
            if status != DONE:
                return status
            pull, drag = sum_forces(e, laws[n], fall, at, start, place, V[n])
            rates[i, RATE], rates[i, ALONG_RATE] = pull / M, drag / M_x
    find_runs(e, MEETS, 0.0)
    if e.counts[RUNS] > e.ended.shape[0]:
        return LACKING
    finish(e, laws[2], start, at[DEPTH], 0.0)
    if math.isfinite(M):
        mean, first, last = 0.0, rates[0, RATE], rates[stages, RATE]
        for k in range(stages):
            mean += e.tableau[stages, k + 1] * rates[k, RATE]
        forces = e.weight + M * max(abs(first), abs(last))
        state[IMBALANCE] += (M * abs(mean - 0.5 * (first + last)) - state[IMBALANCE]) / WINDOW
        state[FORCES] += (forces - state[FORCES]) / WINDOW
    for m in range(4):
        state[m] = at[m]
    return DONE


def sum_forces(
    e: Elements, law: ElementStep, fall: Array, at: Array, start: Pair, place: float,
    velocity: float,
) -> Pair:  # fmt: skip
    """Find which elements press at a stage, `MEETS` <= 0, and return M δ'' and M_x x'' there (Eq. 17)."""
    V, rule, depth, arms = velocity - at[ALONG_RATE], e.rule, at[DEPTH], e.ramps.size
    weigh_strips(e, depth)
    pull = e.weight - e.spring * (depth - e.depth)
    drag = -e.spring_along * at[ALONG] - e.damping_along * at[ALONG_RATE]
    approach(e, fall, place, 0.0, depth)
    press(e, law, at, V)
    for j in range(e.counts[STRIPS]):
        low, high, meets, p = e.low[j], e.high[j], e.rows[MEETS, j], e.rows[PRESSURE, j]
        height, touched, late = e.rows[HEIGHT, j], e.flags[TOUCHED, j], e.flags[LATE, j]
        for i in over(low, high if arms else low):
            late[i] = (meets[i] < 0.0) > touched[i]
        for i in flagged(late, low, high if arms else low):
            if late[i]:
                p[i] = -meets[i] * enter(e, law.h, j, i, start, -meets[i])[0]
        for i in over(low, high):
            g = depth - height[i]
            pressed = g > 0.0 if rule.pulls else p[i] >= 0.0
            if not rule.remembers:
                pressed = pressed & (g > 0.0)
            elif rule.flags:
                pressed = pressed & (touched[i] | (meets[i] < 0.0))
            else:
                pressed = pressed & (meets[i] <= TIE * (meets[i] + g))
            p[i] = choose(pressed, p[i], 0.0)
            meets[i] = choose(pressed, np.minimum(meets[i], 0.0), math.inf)
        pull -= e.spacing * e.weights[j] * summed(p, low, high)
        drag -= e.spacing * e.weights[j] * dotted(p, e.rows[SLOPE, j], low, high)
    return pull, drag


# Forces and edges at an instant


def report(e: Elements, none: ElementStep, state: Array, about: Array, found: Array) -> int:
    """Write the report at an instant into `found`, in the order of `simulation.COLUMNS`.

    `none` is the law over no time, `about` is (time, V, V just before it, whether the base moves or
    moved last with V >= 0, Y). An element is in contact if the indenter touches its surface and its pressure
    p >= 0 (Eq. 24). At a kink of the shape, where p jumps, a run is divided in two. Where the pressure is
    highest at an edge, its doubt is how much it differs between the elements beside that.
    """
    time, V, forward, depth = about[0], about[1], about[3], state[DEPTH]
    sliding, jump = V - state[ALONG_RATE], e.law.damping * (V - about[2])
    # An element on a kink is still on the flank before it.
    behind = math.copysign(NEAR * e.spacing, sliding) if e.kinks.size and sliding else 0.0
    place = about[4] - state[ALONG] - behind
    status = set_window(e, (place, place), depth)
    if status != DONE:
        return status
    weigh_strips(e, depth)
    approach(e, none.fall, place, 0.0, depth)
    press(e, none, state, sliding)
    for j in range(e.counts[STRIPS]):
        low, high, meets, p = e.low[j], e.high[j], e.rows[MEETS, j], e.rows[PRESSURE, j]
        height, touched = e.rows[HEIGHT, j], e.flags[TOUCHED, j]
        for i in over(low, high):
            meets[i] = choose(touched[i], 0.0, meets[i])
            height[i] = choose(touched[i] & ((p[i] >= 0.0) | e.rule.pulls), -1.0, 1.0)
    find_runs(e, HEIGHT, 0.0)
    if e.counts[RUNS] > e.ended.shape[0]:
        return LACKING
    found[4:9], found[11:] = 0.0, 0.0
    found[6] = found[7] = math.nan
    for r in range(e.counts[ENDED]):
        kink, j = 0, e.ended[r, 0]
        low, stop, before = e.ended[r, 1], e.ended[r, 2], -math.inf
        while low < stop:
            high, after = stop, math.inf
            if kink < e.kinks.size and j == 0 and e.parts:
                after = (e.kinks[kink] - place) / e.spacing - e.numbers[0]
                high = max(low, min(stop, math.floor(after) + 1))
            if high > low:
                report_run(e, (j, low, high), (before, after), place, jump, found)
            kink, low, before = kink + 1, high, after
    if state[ALONG_RATE] and abs(sliding) > AT_REST * e.rest_velocity:
        forward = 1.0 if sliding > 0.0 else 0.0
    left, right = found[6], found[7]
    found[6], found[7] = (left, right) if forward else (right, left)
    found[0], found[1], found[2], found[3] = time, V, depth, state[RATE]
    found[9] = sliding
    found[10] = e.spring_along * state[ALONG] + e.damping_along * state[ALONG_RATE]
    return DONE


def report_run(
    e: Elements, run: tuple[int, int, int], kinks: Pair, place: float, jump: float,
    found: Array,
) -> None:  # fmt: skip
    """Add the forces of a run, or of its part between two kinks, to a report, and its peak and edges."""
    (j, low, high), p, slope = run, e.rows[PRESSURE, run[0]], e.rows[SLOPE, run[0]]
    top = low + int(np.argmax(p[low:high]))
    first = end_run(e, j, low, -1, place, low - kinks[0], high - low, jump)
    last = end_run(e, j, high - 1, 1, place, kinks[1] - (high - 1), high - low, jump)
    weight = e.spacing * e.weights[j]
    found[4] += weight * (summed(p, low, high) + first[1] + last[1])
    found[5] -= weight * (dotted(p, slope, low, high) + first[2] + last[2])
    if p[top] > found[8] or not found[8]:
        reach = first[0] if top == low else 1.0, last[0] if top == high - 1 else 1.0
        if (top == low and low - kinks[0] <= 1.0) or (top == high - 1 and kinks[1] - top <= 1.0):
            reach = -1.0, -1.0  # no parabola across a kink
        (found[8], found[11]), found[12] = find_peak(e, p, top, reach, low, high), 0.0
    for end in (first, last):
        if end[3] > found[8]:
            found[8], found[11], found[12] = end[3], end[4], end[5]
    if j == 0:
        left = e.spacing * (e.numbers[low] - first[0]) + place
        found[6] = left if math.isnan(found[6]) else found[6]
        found[7] = e.spacing * (e.numbers[high - 1] + last[0]) + place


def end_run(
    e: Elements, j: int, i: int, out: int, place: float, kink: float, size: int, jump: float
) -> Any:
    """Return how far outward of the last element i of a run the edge is, in elements.

    Then what the sums of p and of p h' gain by ending there, p at the edge, its doubt, and how much p differs
    between the elements beside it. An edge peels where p falls to zero, between two elements by a straight
    line, and touches where the indenter meets the free surface. Where V jumps, by `jump`/C, an edge that
    peeled until then is still where it was, or has gone further in. A run ends at a `kink` of the shape,
    so far outward, at the latest, and one of whole elements half an element beyond the last.
    """
    if not e.parts:
        return 0.5, 0.0, 0.0, 0.0, 0.0, 0.0
    p, slope, meets = e.rows[PRESSURE, j], e.rows[SLOPE, j], e.rows[MEETS, j]
    inside, outside, within = p[i], p[i + out], p[i - out] if size > 1 else p[i]
    touched = e.flags[TOUCHED, j, i + out]
    if e.ramps.size and not touched:
        outside = 2.0 * inside - within
    now = peeling(inside, outside)
    before = peeling(inside + jump * slope[i], outside + jump * slope[i + out])
    touches, straight = touching((-meets[i + out], -meets[i + 2 * out], -meets[i + 3 * out]))
    if math.isinf(before) or straight:
        before = 1.0 if touched else 1.0 - touches
    share, doubt = min(before, now, 1.0), 0.0
    p_edge = 0.0 if now <= share else inside + share * (outside - inside)
    p_kink = inside + kink * (inside - within) if kink <= min(before, 1.0) else 0.0
    if p_kink > 0.0:
        share, p_edge, doubt = kink, p_kink, abs(p_kink - inside)
    x = e.spacing * (e.numbers[i] + (share - NEAR) * out) + place
    steep = surface_at(e.surface, e.profile, x, j * e.across)[1]
    gained = 0.5 * (share * (inside + p_edge) - inside)
    along = 0.5 * (share * (slope[i] * inside + steep * p_edge) - slope[i] * inside)
    return share, gained, along, p_edge, doubt, abs(inside - outside)


def peeling(inside: float, outside: float) -> float:
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


def find_peak(e: Elements, p: Array, k: int, reach: Pair, low: int, high: int) -> Any:
    """Return the peak near element k, from the parabola through three, and its uncertainty.

    Arms remember where contact began, so that the pressure may have a ridge between two elements: there
    the curves meet that continue it from both sides.
    """
    before, here, after = p[k - 1], p[k], p[k + 1]
    if not e.parts:
        return here, 0.0
    if e.ramps.size:
        if not low + 3 <= k < high - 3:
            return here, 0.5 * max(here - before, here - after)
        i = k - 1 if 2.0 * after - here - p[k + 2] < 2.0 * before - p[k - 2] - here else k
        back, ahead = p[i] - p[i - 1], p[i + 1] - p[i + 2]
        share = (p[i + 1] + ahead - p[i]) / (back + ahead) if back + ahead > 0.0 else 0.5
        share = min(max(share, 0.0), 1.0)
        bend = 0.5 * share * (share + 1.0) * (p[i] - 2.0 * p[i - 1] + p[i - 2])
        bend_ahead = 0.5 * (1.0 - share) * (2.0 - share) * (p[i + 1] - 2.0 * p[i + 2] + p[i + 3])
        one, other = p[i] + back * share + bend, p[i + 1] + ahead * (1.0 - share) + bend_ahead
        doubt = max(abs(bend), abs(bend_ahead)) + abs(one - other)
        return max(0.5 * (one + other), here), doubt
    bend = 2.0 * here - before - after
    if not (here >= before and here >= after and bend > 0.0):
        return here, 0.0
    ahead = 0.5 * (after - before) / bend
    far = abs(ahead) > reach[1 if ahead > 0.0 else 0]
    return here if far else here + 0.25 * (after - before) * ahead, 0.0


# The run


class Course(NamedTuple):
    """The steps of a run, and what is reported.

    `times` are those before the first step and after each, `Y` and `V` at the start of each, halfway and at
    its end, V just before that. `after` says after which step an instant is reported, `about` is that
    argument of `report`. `limits` are upper bounds, in a stable run, of the speeds upward and along, and of
    the imbalance of the forces. `law` is that of an element over steps of no length, and over half and all
    of each length, numbered by `which`.
    """

    times: Array
    Y: Array
    V: Array
    after: Runs
    about: Array
    limits: Array
    law: ElementStep
    which: Runs


def law_at(of: ElementStep, k: int) -> ElementStep:
    """Return the law over one of several lengths."""
    return ElementStep(of.h[k], of.fall[k], of.held[k], of.weights[k], of.ramp[k], of.stiffness[k],
                       of.damping[k])  # fmt: skip


def advance(
    e: Elements, state: Array, course: Course, found: Array, step: int, reported: int, until: int
) -> tuple[int, int, int]:
    """Run from a step on; return why it ended, the steps done and the instants reported."""
    none, explicit = law_at(course.law, 0), e.tableau.shape[0] > 1
    while True:
        while reported < course.after.size and course.after[reported] == step:
            status = report(e, none, state, course.about[reported], found[reported])
            if status != DONE:
                return status, step, reported
            reported += 1
        if step == until:
            return DONE, step, reported
        k, Y = 2 * course.which[step] + 2, course.Y[step]
        law = law_at(course.law, k)
        if explicit:
            laws = none, law_at(course.law, k - 1), law
            status = explicit_step(e, laws, state, Y, course.V[step])
        else:
            status = implicit_step(e, law, state, (Y[0], Y[2]))
        if status != DONE:
            return status, step, reported
        state[LAST] = law.h
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
        if step >= WINDOW and state[IMBALANCE] > course.limits[2] * state[FORCES]:
            return UNBALANCED, step, reported
