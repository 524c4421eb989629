"""The row of elements over a step: one source, interpreted or compiled by numba.

Read from the top: the constants and the row; the shape of the indenter; which elements it can meet; where it
meets them; an element over a step; the implicit step; the explicit step; forces and edges at an instant,
by whole elements or up to the edges; the run.

A loop `for i in over(low, high)` is a loop over elements. Compiled, i is one element after the other;
interpreted, it is all of them at once, as a slice, so what is in such a loop holds for numbers and
arrays. A line contact is one strip. A run of elements in contact is (strip, first, one after the last),
counted from the first stored element. All that is compiled is in this file, since numba does not notice a
change in another.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.theory.laws import Array, Element, ElementStep

Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
Pair = tuple[float, float]

DEPTH, RATE, ALONG, ALONG_RATE, IMBALANCE, FORCES, LAST, GAINED, CURVED = range(9)
"""The indenter: depth, its rate, both along x; means of the forces of explicit steps and their imbalance; the
last step, and the first and second backward difference of the rate along x."""
U, HEIGHT, SLOPE, MEETS, PRESSURE = range(5)
"""Numbers of each element: its compression in contact; h and dh/dx; how far the indenter must sink from a
given depth to press it; its pressure."""
TOUCHED, LATE, PRESSED = range(3)
"""Flags of each element: in contact at the start of a step; coming into contact or leaving it in the step; in
contact at an instant."""
OLD, NEW, FALLS = range(3)
"""Of an edge of a run: kink of the surface at start and end of a step, and whether the edge moves inward."""
FIRST, LOW, HIGH, STRIPS, BEGUN, ENDED, INSIDE, UPDATES = range(8)
"""Counts: the first element stored; the range and the strips needed; the runs in contact at the start of a
step and at its end; elements in these; element updates."""
F_Z, F_X, LEFT, RIGHT, PEAK, DOUBT = 4, 5, 6, 7, 8, 11
"""Places in a report, whose order is that of `simulation.COLUMNS`."""
DONE, LACKING, OUTGROWN, THROWN_UP, THROWN_ALONG, UNBALANCED = range(6)
"""How a run ended, or why it paused."""

FAR = 1e200
"""Height (m) where the indenter has no surface."""
SPARE, UNMET = 7, 3
"""Elements beyond those that can be met, and those at each end of the window that never are: edges are
extrapolated from three."""
SMALL_FIT = 1e-2
"""Below it, the exponential fit is taken from its series, where the closed form cancels."""
NEWTON_STEPS, SLIDE_STEPS = 60, 30
"""Limits that are never reached: the iterations end after two or three."""
SLIDE_RTOL = 1e-8
"""Newton's method along x has converged when its step is below this share of the static half length."""
ROOM, MORE_ROOM = 0.02, 4.0
"""Initial bound on how far the indenter sinks in a step beyond its present rate, as a share of the static
depth, and the factor by which it grows if the indenter sinks farther."""
STANDS = 1e-12
"""Share of the static depth: an edge whose overlap falls by less in a step does not move inward."""
STRAIGHT = 0.25
"""Share of w'^2 below which w'^2 - 2 w w'' is that of a square (0), above which that of a line (1)."""
NEAR = 1e-9
"""Share of the spacing: distance from an edge or kink where the slope is taken, since it may jump there."""
WINDOW = 40
"""Steps over which the balance of forces is averaged: a jump of the drive upsets only a few."""
FAINT = 1e-100
"""Share to which a mode decays before all are stored anew."""
TINY = 1e-300
"""Instead of 0 in a division."""
BLOCK = 32
"""Flags that are looked at together."""


class Surface(NamedTuple):
    """The indenter: h = steep r (r/size)^(n - 1)/n, n the exponent; a circle of radius `size` if n is 0."""

    size: float
    exponent: float
    steep: float
    inside: float  # the largest r of the surface
    across: float  # of a ball with n = 2, which has h + across y^2
    revolved: bool  # whether r is sqrt(x^2 + y^2) and not |x|
    stretch: float  # ratio of width to length of a contact
    profile: Any  # Python functions h and h' (n < 0), always interpreted

    @property
    def ball(self) -> bool:
        """Whether h depends on y, too."""
        return self.revolved or self.across > 0.0


class Constants(NamedTuple):
    """An indenter (static depth δ_0, mass M) over elements with the spacing dx, all in SI."""

    surface: Surface
    law: Element
    kinks: Array
    parts: bool  # whether the part of an element at each edge counts
    shift: float  # at t = 0 an element is at x = shift dx
    spacing: float
    across: float  # distance dy of the strips of a ball, zero for a line contact
    mass: float  # infinite for a fixed indenter
    weight: float
    spring: float
    mass_along: float  # M_x, infinite on a rigid drive
    spring_along: float  # k_x
    damping_along: float  # c_x
    depth: float
    half_length: float
    creep: (
        float  # slower sliding counts as rest on a spring, where the drive tells which edge leads
    )


class Row(NamedTuple):
    """The stored elements, and the state of the indenter above them.

    The compression of a free element is the sum over its modes of `law.shares` times `faded` times `modes`:
    nothing changes in it while it is free, only `faded` decays. On arms, an element in contact has their
    forces there, and its compression is in `rows`.
    """

    constants: Constants
    tableau: Array
    fitted: bool
    deepest: float  # the depth that the row is made for
    state: Array
    modes: Array
    faded: Array
    rows: Array  # over kinds, strips and elements, as `flags`
    flags: Flags
    low: Integers  # the first element of each strip that is near the indenter
    high: Integers  # and that behind the last
    counts: Integers
    numbers: Array  # i + shift
    begun: Integers  # runs in contact at the start of a step
    ended: Integers  # and at its end
    edges: Array
    weights: Array
    stages: Array


# Loops over elements


def over(low: Any, high: Any) -> Any:
    """Return the elements from `low` to before `high`: one by one if compiled, else all as one slice."""
    return (slice(low, high),) if low < high else ()


def next_flag(flags: Flags, low: Any, high: Any, wanted: bool) -> Any:
    """Return the first element from `low` to before `high` whose flag is as wanted; without one, `high`."""
    part = flags[low:high]
    k = 0 if low >= high else part.argmax() if wanted else part.argmin()
    return low + k if low < high and part[k] == wanted else high


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


def profile_at(s: Surface, r: Any, x: Any) -> Any:
    """Return h and its slope away from the middle for Python functions, which are never compiled."""
    at = r if s.revolved else np.copysign(r, x)
    return s.profile.height(at), s.profile.slope(at) * np.copysign(1.0, at)


def profile_extent(s: Surface, depth: float, side: float) -> float:
    """Return the distance to one side at which h = `depth` for Python functions: by bisection."""

    def overlap(x: float) -> float:
        return float(s.profile.height(side * min(x, s.inside))) - depth

    return s.inside if overlap(s.inside) < 0.0 else bisect(overlap, min(depth, s.inside))


def bisect(function: Any, guess: float, rtol: float = 0.0) -> float:
    """Return where an increasing function of x > 0 becomes positive: to the last digit, or to `rtol`.

    >>> bisect(lambda x: x * x - 2.0, 1.0)
    1.4142135623730951
    """
    low = high = guess
    while function(high) < 0.0 and high < math.inf:
        low, high = high, 2.0 * high
    while function(low) > 0.0:
        low, high = 0.5 * low, low
    while low < (middle := 0.5 * (low + high)) < high and high - low > rtol * high:
        low, high = (low, middle) if function(middle) > 0.0 else (middle, high)
    return high


def _next_flag(flags: Flags, low: int, high: int, wanted: bool) -> int:
    while low < high:  # by blocks, which are counted many elements at a time
        stop, found = min(low + BLOCK, high), False
        for i in range(np.uint64(max(low, 0)), np.uint64(max(stop, 0))):
            found |= flags[i] == wanted
        if found:
            while flags[low] != wanted:
                low += 1
            return low
        low = stop
    return high


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
    "next_flag": _next_flag,
    "dotted": _dotted,
    "summed": _summed,
    "total": lambda value: value,
    "choose": lambda flag, yes, no: yes if flag else no,
    "profile_at": lambda s, r, x: (r, r),
    "profile_extent": lambda s, depth, side: depth,
}
"""What stands for these functions where they are compiled."""


# The shape of the indenter


def surface_at(s: Surface, x: Any, y: Any) -> Any:
    """Return h and dh/dx at (x, y): `FAR` and 0 where the indenter has no surface."""
    if s.exponent == 2.0:
        return x * x * (0.5 / s.size) + s.across * (y * y), x * (1.0 / s.size)
    r = np.hypot(x, y) if s.revolved else np.abs(x)
    near, side = np.minimum(r, s.inside), x / np.maximum(r, TINY)
    if s.exponent < 0.0:
        h, steep = profile_at(s, near, x)
    elif s.exponent == 0.0:
        rest = np.sqrt((s.size - near) * (s.size + near))
        h, steep = near * (near / (s.size + rest)), near / rest
    else:
        steep = s.steep * (near / s.size) ** (s.exponent - 1.0)
        h = near * steep / s.exponent
    return h + FAR * (r > s.inside), steep * side * (r <= s.inside)


def extent(s: Surface, depth: float, side: float) -> float:
    """Return the distance to one side, -1 or 1, at which h = depth or the surface ends."""
    if not depth > 0.0:
        return 0.0
    if s.exponent < 0.0:
        return profile_extent(s, depth, side)
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


def weigh_strips(row: Row, depth: float) -> None:
    """Write the quadrature weight of each strip of a ball; that of a line contact is 1."""
    c = row.constants
    if c.across:
        rim = c.surface.stretch * extent(c.surface, depth, 1.0) if c.parts else 0.0
        weigh(row.weights, c.across, rim)


# Which elements the indenter can meet


def set_window(row: Row, places: Pair, depth: float) -> int:
    """Find the elements that an indenter of at most this depth can meet at both places of the base."""
    if not (depth < row.deepest and math.isfinite(places[0]) and math.isfinite(places[1])):
        return OUTGROWN
    s, dx, dy = row.constants.surface, row.constants.spacing, row.constants.across
    first, (stored, width) = row.counts[FIRST], row.rows.shape[1:]
    left, right = extent(s, depth, -1.0), extent(s, depth, 1.0)
    strips, runs, r = 1 + int(s.stretch * right / dy) if dy else 1, row.counts[BEGUN], 0
    if runs:  # an element may stay in contact above the plane z = 0
        strips = max(strips, row.begun[runs - 1, 0] + 1)
    for j in range(min(strips, stored)):
        share = j * dy / max(s.stretch * right, FAINT)
        bent = math.sqrt(max(1.0 - share * share, 0.0))
        low = math.floor((-left * bent - max(places[0], places[1])) / dx) - SPARE - first
        high = math.ceil((right * bent - min(places[0], places[1])) / dx) + SPARE + 1 - first
        while r < runs and row.begun[r, 0] == j:
            low, high = min(low, row.begun[r, 1] - SPARE), max(high, row.begun[r, 2] + SPARE)
            r += 1
        fits = low >= 0 and high <= width and strips <= stored
        if j == 0 or not fits:
            row.counts[LOW], row.counts[HIGH] = low + first, high + first
            row.counts[STRIPS] = strips
        if not fits:
            return LACKING
        row.low[j], row.high[j] = low, high
        row.counts[UPDATES] += high - low
    return DONE


def press_to(row: Row, sunk: float) -> int:
    """Flag the elements that the indenter presses when it has sunk so far, and return their number."""
    found = 0
    for j in range(row.counts[STRIPS]):
        meets, pressed = row.rows[MEETS, j], row.flags[PRESSED, j]
        for i in over(row.low[j], row.high[j]):
            pressed[i] = meets[i] <= sunk
            found += total(pressed[i])
    return found


def find_runs(row: Row) -> None:
    """Find the runs of elements that are flagged as pressed."""
    count = inside = 0
    for j in range(row.counts[STRIPS]):
        pressed, high = row.flags[PRESSED, j], row.high[j]
        start = next_flag(pressed, row.low[j], high, True)
        while start < high:
            stop = next_flag(pressed, start, high, False)
            row.ended[count, 0], row.ended[count, 1], row.ended[count, 2] = j, start, stop
            count, inside = count + 1, inside + stop - start
            start = next_flag(pressed, stop, high, True)
    row.counts[ENDED], row.counts[INSIDE] = count, inside


def begin(row: Row, depth: float) -> None:
    """Take the runs at the end of a step, and their kinks, for those at the start of the next."""
    for r in range(row.counts[ENDED]):
        j, low, high = row.ended[r, 0], row.ended[r, 1], row.ended[r, 2]
        u, height, mode, grown = (
            row.rows[U, j],
            row.rows[HEIGHT, j],
            row.modes[0, j],
            1.0 / row.faded[0],
        )
        for i in over(low, high):
            u[i] = depth - height[i]
        for i in over(low, low if row.constants.law.arm_time.size else high):
            mode[i] = (depth - height[i]) * grown
        row.begun[r, 0], row.begun[r, 1], row.begun[r, 2] = j, low, high
        for side in range(2):
            row.edges[r, side, OLD] = row.edges[r, side, NEW]
    row.counts[BEGUN] = row.counts[ENDED]


# Where the indenter meets them


def approach(
    row: Row, fall: Array, place: float, depth: float, back: float = 0.0, inclined: bool = True
) -> None:
    """Write h, dh/dx, and to `MEETS` how far the indenter must sink from a depth to meet free elements.

    The base has moved by `place` under the indenter, and by `back` less where dh/dx is taken, if it is wanted
    (`inclined`). `fall` are the decay factors of the modes of free elements over the step.
    """
    c = row.constants
    s, law, numbers = c.surface, c.law, row.numbers
    for j in range(row.counts[STRIPS]):
        y, low, high = j * c.across, row.low[j], row.high[j]
        height, slope, meets = row.rows[HEIGHT, j], row.rows[SLOPE, j], row.rows[MEETS, j]
        for i in over(low, high if s.exponent == 2.0 else low):
            x = c.spacing * numbers[i] + place
            height[i] = x * x * (0.5 / s.size) + s.across * (y * y)
        for i in over(low, low if s.exponent == 2.0 else high):
            x = c.spacing * numbers[i] + place
            height[i], slope[i] = surface_at(s, x, y)
        for i in over(low, high if back or (s.exponent == 2.0 and inclined) else low):
            slope[i] = surface_at(s, c.spacing * numbers[i] + (place - back), y)[1]
        for k in range(fall.size):
            mode, share = row.modes[k, j], law.shares[k] * row.faded[k] * fall[k]
            for i in over(low, high):
                meets[i] = (meets[i] if k else height[i] - depth) + share * mode[i]


def gap(row: Row, j: int, i: int, place: float, depth: float) -> float:
    """Return the overlap w = g - u of a free element when the base has moved by `place`; of others, 0."""
    c, u = row.constants, 0.0
    for k in range(row.faded.size):
        u += c.law.shares[k] * row.faded[k] * row.modes[k, j, i]
    h = surface_at(c.surface, c.spacing * row.numbers[i] + place, j * c.across)[0]
    return 0.0 if row.flags[TOUCHED, j, i] else float(depth - h - u)


# An element over a step


def change_contact(row: Row, law: ElementStep, j: int, i: int, g: float, rise: float) -> None:
    """Complete a step for an element that leaves the indenter in it, or that it meets: u = g, up by `rise`.

    y_k = u - s_k/K_k, the compressions of the dampers of the arms, are a product of a matrix and the modes.
    An element that is met is loaded during the whole step.
    """
    arm, y, of, leaves = (
        row.modes[:, j, i],
        row.stages[6],
        row.constants.law,
        row.flags[TOUCHED, j, i],
    )
    for k in range(arm.size):
        mode = arm[k] * row.faded[k] * law.fall[k]
        y[k] = row.rows[U, j, i] - arm[k] / of.arm_stiffness[k] if leaves else mode
    for k in range(arm.size):
        new = 0.0
        for m in range(arm.size):
            new += (of.to_modes[k, m] if leaves else of.from_modes[k, m]) * y[m]
        met = of.arm_stiffness[k] * (g - rise - new) + law.ramp[k] * rise
        arm[k] = new / row.faded[k] if leaves else met


def finish(row: Row, law: ElementStep, depth: float, sunk: float) -> None:
    """Complete a step: at this depth, the elements that are flagged as pressed are on the indenter.

    `sunk` is how far the indenter sank since `MEETS` was written.
    """
    arms = law.held.size
    for j in range(row.counts[STRIPS]):
        low, high, height, meets = row.low[j], row.high[j], row.rows[HEIGHT, j], row.rows[MEETS, j]
        u, pressed, touched = row.rows[U, j], row.flags[PRESSED, j], row.flags[TOUCHED, j]
        late = row.flags[LATE, j]
        for k in range(arms):
            arm, held, ramp = row.modes[k, j], law.held[k], law.ramp[k]
            for i in over(low, high):
                loaded = held * arm[i] + ramp * (depth - height[i] - u[i])
                arm[i] = choose(touched[i] & pressed[i], loaded, arm[i])
        for i in over(low, high if arms else low):
            late[i] = pressed[i] != touched[i]
        n = next_flag(late, low, high, True) if arms else high
        while n < high:
            change_contact(row, law, j, n, depth - height[n], sunk - meets[n])
            n = next_flag(late, n + 1, high, True)
        for i in over(low, high):
            touched[i] = pressed[i]
    for k in range(row.faded.size):
        row.faded[k] *= law.fall[k]
        if row.faded[k] < FAINT:
            for j in range(row.flags.shape[1]):
                for i in over(0, row.numbers.size):
                    contact = row.flags[TOUCHED, j, i] & (arms > 0)
                    row.modes[k, j, i] *= choose(contact, 1.0, row.faded[k])
            row.faded[k] = 1.0
    begin(row, depth)


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


def implicit_step(row: Row, law: ElementStep, Y: Pair) -> int:
    """Take a step in which the depth at its end is the root of the balance of momentum.

    On a spring, so is the place along x: for every place there is one depth.
    """
    c, state, h = row.constants, row.state, law.h
    depth, along, theta, known = state[DEPTH], state[ALONG], 1.0, not c.parts
    gained = state[GAINED] * h / max(state[LAST], h)
    guess = state[ALONG_RATE] + gained / 2.0 + 5.0 / 12.0 * state[CURVED]  # Adams-Bashforth
    slid = h * guess / (1.0 + 0.25 * c.spring_along * h * h / c.mass_along)
    sunk = new_along_rate = 0.0
    weigh_strips(row, depth + 0.5 * h * state[RATE])
    for _ in range(SLIDE_STEPS):
        place = Y[1] - (along + slid)
        travel = place - (Y[0] - along)
        first = h * state[RATE]
        sinks = max(2.0 * first, 0.0) + ROOM * c.depth
        while True:
            status = set_window(row, (place, place - travel), depth + sinks)
            if status != DONE:
                return status
            find_thresholds(row, law, place, travel, depth)
            press_to(row, first)
            find_runs(row)
            if not known:
                judge_edges(row, place - travel, depth, first)
            wide = max(number_in(row, row.ended, row.counts[ENDED]),
                       number_in(row, row.begun, row.counts[BEGUN]))  # fmt: skip
            theta = (
                exponential_fit(h * law.damping * c.spacing * wide / c.mass) if row.fitted else 1.0
            )
            sunk = solve_depth(row, law, theta, first)
            if not sunk > sinks:  # if elements were missed, it sinks too deep, never too little
                break
            sinks = MORE_ROOM * sinks
        if not math.isfinite(c.mass_along):
            break
        before, known = slid, True
        slid, new_along_rate = solve_along(row, law, sunk, slid)
        if not abs(slid - before) > SLIDE_RTOL * c.half_length:
            break
    finish(row, law, depth + sunk, sunk)
    if math.isfinite(c.mass):
        state[RATE] = final_velocity(sunk, state[RATE], h, theta)
    state[DEPTH] = depth + sunk
    if math.isfinite(c.mass_along):
        gained = new_along_rate - state[ALONG_RATE]
        state[CURVED] = gained - state[GAINED] if state[LAST] == h else 0.0
        state[GAINED], state[ALONG], state[ALONG_RATE] = gained, along + slid, new_along_rate
    return DONE


def find_thresholds(row: Row, law: ElementStep, place: float, travel: float, depth: float) -> None:
    """Find how far the indenter must sink to press each element at the end of the step: `MEETS`.

    There the mean pressure would vanish: at the place of a free element then, and above that of one in
    contact now.
    """
    c = row.constants
    sprung = math.isfinite(c.mass_along)
    approach(row, law.fall, place, depth, 0.5 * travel if sprung else 0.0, sprung)
    relaxed = 1.0 - c.law.stiffness / law.stiffness
    for r in range(row.counts[BEGUN] if law.held.size else 0):
        j, low, high = row.begun[r, 0], row.begun[r, 1], row.begun[r, 2]
        u, height, meets = row.rows[U, j], row.rows[HEIGHT, j], row.rows[MEETS, j]
        for i in over(low, high):
            meets[i] = relaxed * u[i] + (height[i] - depth)
        for k in range(law.held.size):
            arm, share = row.modes[k, j], law.weights[k] / law.stiffness
            for i in over(low, high):
                meets[i] -= share * arm[i]
    for n in range(c.kinks.size if c.law.damping and not c.across and travel else 0):
        pass_kink(row, c.kinks[n], place, travel, depth, law.h)
    for j in range(row.counts[STRIPS]):
        for end in (row.low[j], row.high[j] - UNMET):
            for i in over(end, end + UNMET):
                row.rows[MEETS, j, i] = math.inf


def pass_kink(row: Row, kink: float, place: float, travel: float, depth: float, h: float) -> None:
    """Change what is known of the elements that pass a kink of the shape in a step.

    What a damper has of the compression by a tip is left at the end of the step, and so is its mean
    pressure; without this, a wedge stands on its tip at the first order in the spacing.
    """
    c, height, meets = row.constants, row.rows[HEIGHT, 0], row.rows[MEETS, 0]
    now = (kink - place) / c.spacing - row.numbers[0]
    start, end = min(now, now + travel / c.spacing), max(now, now + travel / c.spacing)
    low = max(math.floor(start + NEAR) + 1, row.low[0])
    high = min(math.ceil(end - NEAR), row.high[0])
    g = depth - surface_at(c.surface, kink, 0.0)[0]
    for i in over(low, high):
        x = c.spacing * row.numbers[i] + place
        left = g * np.exp((kink - x) / travel * h * c.law.rates[0])
        lowest = np.minimum(height[i], depth - left)
        meets[i], height[i] = meets[i] + lowest - height[i], lowest
        # It is pressed by the flank that it comes from.
        row.rows[SLOPE, 0, i] = surface_at(c.surface, x - travel, 0.0)[1]


def judge_edges(row: Row, place: float, depth: float, first: float) -> None:
    """Find where the overlap outside a run falls, so that the edge moves inward.

    It is that at the start of a step, at this place and depth, against that at its end, if the indenter sinks
    by `first`. This is decided once in a step, so that the iteration cannot oscillate.
    """
    for r in range(row.counts[ENDED]):
        for side in range(2):
            j, i = row.ended[r, 0], row.ended[r, 2] if side else row.ended[r, 1] - 1
            change = first - row.rows[MEETS, j, i] - gap(row, j, i, place, depth)
            row.edges[r, side, FALLS] = 1.0 if change < -STANDS * row.constants.depth else 0.0


def number_in(row: Row, runs: Integers, count: int) -> float:
    """Return the number of elements in runs, by the weights of their strips."""
    width = 0.0
    for r in range(count):
        width += row.weights[runs[r, 0]] * (runs[r, 2] - runs[r, 1])
    return width


def solve_depth(row: Row, law: ElementStep, theta: float, sunk: float) -> float:
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for how far the indenter sinks.

    While no element comes into contact or detaches, F_z is quadratic in the depth: one step of Newton's
    method with the second derivative is exact. Elements in contact are those with `MEETS` <= `sunk`, so that
    their number tells whether they are the same.
    """
    c, state, h, k = row.constants, row.state, law.h, law.stiffness * row.constants.spacing
    for _ in range(NEWTON_STEPS if math.isfinite(c.mass) else 0):
        area, width, bent, _ = add_kinks(row, law, sunk)
        for r in range(row.counts[ENDED]):
            j, low, high = row.ended[r, 0], row.ended[r, 1], row.ended[r, 2]
            area += row.weights[j] * (sunk * (high - low) - summed(row.rows[MEETS, j], low, high))
            width += row.weights[j] * (high - low)
        mean = state[DEPTH] - c.depth + theta * sunk
        change_of_rate = final_velocity(sunk, state[RATE], h, theta) - state[RATE]
        residual = c.mass * change_of_rate / h - c.weight + c.spring * mean + k * area
        slope = c.mass / (theta * h * h) + theta * c.spring + k * width
        root = math.sqrt(max(slope * slope - 2.0 * residual * k * bent, 0.0))
        sunk -= 2.0 * residual / (slope + root)
        if press_to(row, sunk) == row.counts[INSIDE]:
            break
        find_runs(row)
    return sunk


def add_kinks(row: Row, law: ElementStep, sunk: float) -> tuple[float, float, float, float]:
    """Return the area of the kinks at edges by dx less what relaxed, its derivatives by depth, and its push.

    A kink of the surface, at an edge between two elements, adds to the area that is pressed. It counts where
    the edge stands or moves outward over the free surface. Where the edge moves inward, the surface has no
    kink, or one that is left behind and relaxes like all free surface.
    """
    area = wider = bent = push = 0.0
    relaxed = 1.0 - row.constants.law.stiffness / law.stiffness
    for r in range(row.counts[ENDED] if row.constants.parts else 0):
        j, old = row.ended[r, 0], r < row.counts[BEGUN] and row.begun[r, 0] == row.ended[r, 0]
        weight, meets = row.weights[j], row.rows[MEETS, j]
        for side in range(2):
            edge, out = row.edges[r, side], 2 * side - 1
            i = row.ended[r, 2] if side else row.ended[r, 1] - 1
            edge[NEW] = 0.0
            if not edge[FALLS]:
                overlap = sunk - meets[i], sunk - meets[i + out], sunk - meets[i + 2 * out]
                edge[NEW], more, bend = kink_area(overlap)
                added = edge[NEW] - (relaxed * edge[OLD] if old else 0.0)
                area, wider, bent = (
                    area + weight * added,
                    wider + weight * more,
                    bent + weight * bend,
                )
                push += weight * added * row.rows[SLOPE, j, i - out]
    return area, wider, bent, push


def solve_along(row: Row, law: ElementStep, sunk: float, slid: float) -> Pair:
    """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

    An element pushes along x with its pressure times the slope halfway through the step, so that the
    mean forces do the very work by which elements of a parabola are compressed.
    """
    c, state, h = row.constants, row.state, law.h
    M_x, c_x, k_x, k = c.mass_along, c.damping_along, c.spring_along, law.stiffness * c.spacing
    width, inclined, tilted, area = 0.0, 0.0, 0.0, add_kinks(row, law, sunk)[3]
    for r in range(row.counts[ENDED]):
        j, low, high = row.ended[r, 0], row.ended[r, 1], row.ended[r, 2]
        weight, slope, meets = row.weights[j], row.rows[SLOPE, j], row.rows[MEETS, j]
        leaning = summed(slope, low, high)
        width, inclined = width + weight * (high - low), inclined + weight * leaning
        tilted += weight * dotted(slope, slope, low, high)
        area += weight * (sunk * leaning - dotted(slope, meets, low, high))
    # Oscillations too fast for the step are damped; θ - 1/2 is of the third order in h, as on arms.
    swing = h * math.sqrt(k_x / M_x)
    z = h * (c_x + law.damping * c.spacing * tilted) / M_x + swing * swing * swing
    theta = exponential_fit(z) if row.fitted else 1.0
    change_of_rate = final_velocity(slid, state[ALONG_RATE], h, theta) - state[ALONG_RATE]
    held = c_x * slid / h + k_x * (state[ALONG] + theta * slid)
    residual = M_x * change_of_rate / h + held + k * area
    # As the foundation gives way along x, the depth changes, too.
    normal = c.mass / (h * h) + c.spring + k * width
    stiff = k * tilted - (k * inclined) * (k * inclined) / normal
    slid -= residual / (M_x / (theta * h * h) + c_x / h + theta * k_x + stiff)
    return slid, final_velocity(slid, state[ALONG_RATE], h, theta)


# The explicit step


def explicit_step(
    row: Row, laws: tuple[ElementStep, ElementStep, ElementStep], Y: Array, V: Array
) -> int:
    """Take a Runge-Kutta step; which elements are in contact is decided at its end.

    `laws` are those of no time, half the step and all of it; Y and V are at these times, V just before the
    end. F_z = dx Σ p over whole elements (Eqs. 12-17). Arms are loaded along a straight line from the start
    of the step to each stage, which leaves the order two.
    """
    c, state, h = row.constants, row.state, laws[2].h
    stages, begun = row.tableau.shape[0] - 1, Y[0] - state[ALONG]
    rates, at = row.stages, row.stages[stages + 1]  # of depth, its rate, and both along x
    for i in range(stages + 1):
        n = int(2.0 * row.tableau[i, 0])
        for m in range(4):
            at[m] = state[m]
            for k in range(i):
                at[m] += h * row.tableau[i, k + 1] * rates[k, m]
        place = Y[n] - at[ALONG]
        status = set_window(row, (begun, place), max(at[DEPTH], state[DEPTH]))
        if status != DONE:
            return status
        press(row, laws[n], at, place, V[n] - at[ALONG_RATE], True)
        pull = c.weight - c.spring * (at[DEPTH] - c.depth)
        drag = -c.spring_along * at[ALONG] - c.damping_along * at[ALONG_RATE]
        for r in range(row.counts[ENDED]):
            j, low, high = row.ended[r, 0], row.ended[r, 1], row.ended[r, 2]
            p, weight = row.rows[PRESSURE, j], c.spacing * row.weights[j]
            pull -= weight * summed(p, low, high)
            drag -= weight * dotted(p, row.rows[SLOPE, j], low, high)
        rates[i, DEPTH], rates[i, RATE] = at[RATE], pull / c.mass  # Eq. 17
        rates[i, ALONG], rates[i, ALONG_RATE] = at[ALONG_RATE], drag / c.mass_along
    finish(row, laws[2], at[DEPTH], 0.0)
    for m in range(4):
        at[m] -= state[m]
        state[m] += at[m]
    for m, mass in ((RATE, c.mass), (ALONG_RATE, c.mass_along)):
        if math.isfinite(mass):
            first, last = rates[0, m], rates[stages, m]
            off = mass * abs(at[m] / h - 0.5 * (first + last))
            largest = c.weight + mass * max(abs(first), abs(last))
            state[IMBALANCE] += (off - state[IMBALANCE]) / WINDOW
            state[FORCES] += (largest - state[FORCES]) / WINDOW
    return DONE


def press(row: Row, law: ElementStep, at: Array, place: float, velocity: float, met: bool) -> None:
    """Write p = K g + C g' + Σ s_k of the elements under the indenter, and find those in contact (Eqs. 6-12).

    In contact are those that were at the start of the step and, if they may be `met`, those whose free
    surface is above the indenter, `MEETS` < 0; but only where p >= 0, since none pulls (Eqs. 20-25).
    """
    c, depth, arms = row.constants, at[DEPTH], law.held.size
    weigh_strips(row, depth)
    approach(row, law.fall, place, depth)
    glassy = c.law.stiffness + law.ramp.sum()
    for j in range(row.counts[STRIPS]):
        low, high, height, meets = row.low[j], row.high[j], row.rows[HEIGHT, j], row.rows[MEETS, j]
        p, u, slope = row.rows[PRESSURE, j], row.rows[U, j], row.rows[SLOPE, j]
        touched, pressed = row.flags[TOUCHED, j], row.flags[PRESSED, j]
        for i in over(low, high):
            g, g_rate = depth - height[i], at[RATE] - velocity * slope[i]
            p[i] = c.law.stiffness * g + c.law.damping * g_rate
        for k in range(arms):
            arm = row.modes[k, j]
            for i in over(low, high):
                loaded = law.held[k] * arm[i] + law.ramp[k] * (depth - height[i] - u[i])
                p[i] += choose(touched[i], loaded, 0.0)
        for i in over(low, high if arms else low):
            p[i] = choose(touched[i], p[i], -glassy * meets[i])
        for i in over(low, high):
            pressed[i] = (touched[i] | (met & (meets[i] < 0.0))) & (p[i] >= 0.0)
    find_runs(row)


# Forces and edges at an instant


def report(row: Row, none: ElementStep, about: Array, unsure: float, found: Array) -> int:
    """Write the report at an instant into `found`, in the order of `simulation.COLUMNS`.

    `none` is the law over no time, `about` is (time, V, whether the base moves or moved last with V >= 0, Y).
    At a kink of the shape, where p jumps, a run is divided in two. Where the pressure is highest at an edge,
    its doubt is `unsure` times what it differs by between the elements there.
    """
    c, state = row.constants, row.state
    time, V, forward, depth = about[0], about[1], about[2], state[DEPTH]
    sliding = V - state[ALONG_RATE]
    # An element on a kink is still on the flank before it.
    behind = math.copysign(NEAR * c.spacing, sliding) if c.kinks.size and sliding else 0.0
    place = about[3] - state[ALONG] - behind
    status = set_window(row, (place, place), depth)
    if status != DONE:
        return status
    press(row, none, state, place, sliding, False)
    found[:] = 0.0
    found[LEFT] = found[RIGHT] = math.nan
    for r in range(row.counts[ENDED]):
        j, low, stop = row.ended[r, 0], row.ended[r, 1], row.ended[r, 2]
        kinks, before = c.kinks.size if j == 0 and c.parts else 0, -math.inf
        for n in range(kinks + 1):
            after, high = math.inf, stop
            if n < kinks:
                after = (c.kinks[n] - place) / c.spacing - row.numbers[0]
                high = max(low, min(stop, math.floor(after) + 1))
            if high > low:
                report_run(row, (j, low, high), (before, after), place, unsure, found)
            low, before = high, after
    if state[ALONG_RATE] and abs(sliding) > c.creep:
        forward = 1.0 if sliding > 0.0 else 0.0
    left, right = found[LEFT], found[RIGHT]
    found[LEFT], found[RIGHT] = (left, right) if forward else (right, left)
    found[0], found[1], found[2], found[3] = time, V, depth, state[RATE]
    found[9] = sliding
    found[10] = c.spring_along * state[ALONG] + c.damping_along * state[ALONG_RATE]
    return DONE


def report_run(
    row: Row, run: tuple[int, int, int], kinks: Pair, place: float, unsure: float, found: Array
) -> None:
    """Add the forces of a run, or of its part between two kinks, to a report, and its peak and edges."""
    (j, low, high), c = run, row.constants
    p, slope = row.rows[PRESSURE, j], row.rows[SLOPE, j]
    top = low + int(np.argmax(p[low:high]))
    first = end_run(row, j, low, -1, place, low - kinks[0], high - low)
    last = end_run(row, j, high - 1, 1, place, kinks[1] - (high - 1), high - low)
    weight = c.spacing * row.weights[j]
    found[F_Z] += weight * (summed(p, low, high) + first[1] + last[1])
    found[F_X] -= weight * (dotted(p, slope, low, high) + first[2] + last[2])
    if p[top] > found[PEAK] or not found[PEAK]:
        reach = first[0] if top == low else 1.0, last[0] if top == high - 1 else 1.0
        if (top == low and low - kinks[0] <= 1.0) or (top == high - 1 and kinks[1] - top <= 1.0):
            reach = -1.0, -1.0  # no parabola across a kink
        found[PEAK], found[DOUBT] = find_peak(row, p, top, reach, low, high)
    for end in (first, last):
        if end[3] > found[PEAK]:
            found[PEAK], found[DOUBT] = end[3], end[4] + unsure * end[5]
    if j == 0:
        left = c.spacing * (row.numbers[low] - first[0]) + place
        found[LEFT] = left if math.isnan(found[LEFT]) else found[LEFT]
        found[RIGHT] = c.spacing * (row.numbers[high - 1] + last[0]) + place


def end_run(row: Row, j: int, i: int, out: int, place: float, kink: float, size: int) -> Any:
    """Return how far outward of the last element i of a run the edge is, in elements.

    Then what the sums of p and of p h' gain by ending there, p at the edge, its doubt, and how much p differs
    between the elements beside it. An edge peels where p falls to zero, between two elements by a straight
    line, and touches where the indenter meets the free surface. A run ends at a `kink` of the shape, so far
    outward, at the latest, and one of whole elements half an element beyond the last.
    """
    c = row.constants
    if not c.parts:
        return 0.5, 0.0, 0.0, 0.0, 0.0, 0.0
    p, slope, meets = row.rows[PRESSURE, j], row.rows[SLOPE, j], row.rows[MEETS, j]
    inside, outside, within = p[i], p[i + out], p[i - out] if size > 1 else p[i]
    share, doubt, touched = 1.0, 0.0, row.flags[TOUCHED, j, i + out]
    if c.law.arm_time.size and not touched:
        outside = 2.0 * inside - within
    peels = max(inside, 0.0) / (max(inside, 0.0) - outside) if outside < 0.0 else math.inf
    touches, straight = touching((-meets[i + out], -meets[i + 2 * out], -meets[i + 3 * out]))
    if not touched and (straight or math.isinf(peels)):
        share = 1.0 - touches
    p_kink = inside + kink * (inside - within) if kink <= share else 0.0
    p_edge = inside + share * (outside - inside) if share < peels else 0.0
    share = min(share, peels)
    if p_kink > 0.0:
        share, p_edge, doubt = kink, p_kink, abs(p_kink - inside)
    x = c.spacing * (row.numbers[i] + (share - NEAR) * out) + place
    steep = surface_at(c.surface, x, j * c.across)[1]
    gained = 0.5 * (share * (inside + p_edge) - inside)
    along = 0.5 * (share * (slope[i] * inside + steep * p_edge) - slope[i] * inside)
    return share, gained, along, p_edge, doubt, abs(inside - outside)


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


def find_peak(row: Row, p: Array, k: int, reach: Pair, low: int, high: int) -> Any:
    """Return the peak near element k, from the parabola through three, and its uncertainty.

    Arms remember where contact began, so that the pressure may have a ridge between two elements: there
    the curves meet that continue it from both sides.
    """
    before, here, after = p[k - 1], p[k], p[k + 1]
    if not row.constants.parts:
        return here, 0.0
    if row.constants.law.arm_time.size:
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
    """The steps of a run, and what is reported."""

    times: Array  # before the first step and after each
    Y: Array  # at the start of each, halfway and at its end
    V: Array  # likewise, at the end just before it
    law: ElementStep  # over steps of no length, and over half and all of each length
    which: Integers  # number of the length of each step
    after: Integers  # after which step an instant is reported
    about: Array  # argument of `report`
    unsure: float  # likewise
    limits: tuple[float, float, float]  # of rates and of the imbalance of forces, in a stable run


def law_at(of: ElementStep, k: int) -> ElementStep:
    """Return the law over one of several lengths."""
    return ElementStep(of.h[k], of.fall[k], of.held[k], of.weights[k], of.ramp[k], of.stiffness[k],
                       of.damping[k])  # fmt: skip


def advance(
    row: Row, course: Course, found: Array, step: int, reported: int, until: int
) -> tuple[int, int, int]:
    """Run from a step on; return why it ended, the steps done and the instants reported."""
    none, state = law_at(course.law, 0), row.state
    while True:
        while reported < course.after.size and course.after[reported] == step:
            about = course.about[reported]
            status = report(row, none, about, course.unsure, found[reported])
            if status != DONE:
                return status, step, reported
            reported += 1
        if step == until:
            return DONE, step, reported
        k, Y = 2 * course.which[step] + 2, course.Y[step]
        law = law_at(course.law, k)
        if row.tableau.shape[0] > 1:
            laws = none, law_at(course.law, k - 1), law
            status = explicit_step(row, laws, Y, course.V[step])
        else:
            status = implicit_step(row, law, (Y[0], Y[2]))
        if status != DONE:
            return status, step, reported
        state[LAST] = law.h
        step += 1
        # No element pulls, p >= 0, so that an indenter in contact rises at most with g/τ - V h'; beyond
        # that it has left the foundation, and only a spring can lift it faster. But an unstable step does
        # not always throw it off: when the contact gives way, the oscillation may settle at some amplitude,
        # or on a wrong state at rest, with forces that do not balance M δ'' = W - k_s (δ - δ_0) - F_z.
        if not state[RATE] >= course.limits[0]:  # NaN is not above it either
            return THROWN_UP, step, reported
        if not abs(state[ALONG_RATE]) <= course.limits[1]:
            return THROWN_ALONG, step, reported
        if step >= WINDOW and state[IMBALANCE] > course.limits[2] * state[FORCES]:
            return UNBALANCED, step, reported
