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

from kvtheory.records import record
from kvtheory.results.table import SERIES_UNITS
from kvtheory.theory.laws import Array, Element, ElementStep

Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
Pair = tuple[float, float]

DONE, LACKING, OUTGROWN, THROWN_UP, THROWN_ALONG, UNBALANCED = range(6)
"""How a run ended, or why it paused: elements are lacking, the indenter sank deeper than the row was made
for, it is thrown up or along x, or the forces do not balance its motion."""

FAR = 1e200
"""Height (m) where the indenter has no surface."""
SPARE = 7
"""Elements of the window beyond those that can be met."""
UNMET = 3
"""Padding at both ends of the window, of elements that are never met: edges are extrapolated from three."""
SMALL_FIT = 1e-2
"""Below it, the exponential fit is taken from its series, where the closed form cancels."""
NEWTON_STEPS = 60
"""Limit on the iteration for the depth, never reached: it ends after two or three steps."""
SLIDE_STEPS = 30
"""Likewise for the place along x."""
SLIDE_RTOL = 1e-8
"""Newton's method along x has converged when its step is below this share of the static half length."""
ROOM = 0.02
"""Initial bound on how far the indenter sinks in a step beyond its present rate, as a share of the static
depth."""
MORE_ROOM = 4.0
"""Factor by which this bound grows if the indenter sinks farther."""
STANDS = 1e-12
"""Share of the static depth: an edge whose overlap falls by less in a step does not move inward."""
STRAIGHT = 0.25
"""Share of w'^2 below which w'^2 - 2 w w'' is that of a square (0), above which that of a line (1)."""
NEAR = 1e-9
"""Share of the spacing: distance from an edge or kink where the slope is taken, since it may jump there."""
WINDOW = 40
"""Steps over which the balance of forces is averaged: a jump of the drive upsets only a few."""
BENT = 1.3
"""Ratio of falls of w from element to element from which on it falls as a square: 1.4 to 3 if it does."""
FAINT = 1e-100
"""Share to which a mode decays before all are stored anew."""
TINY = 1e-300
"""Replaces a zero divisor."""
BLOCK = 32
"""Flags that are looked at together."""

INDENTER = record(
    depth="f8", rate="f8", along="f8", along_rate="f8", mean_force="f8", mean_imbalance="f8",
    last_step="f8", difference="f8", second_difference="f8", jump="f8",
)  # fmt: skip
"""Depth of the indenter and its rate, both along x; means over explicit steps of the largest force and of the
imbalance of forces; the length of the last step, and the backward differences of the rate along x; the jump
of a given rate of the depth at this instant."""
COUNTS = record(
    low="i8", high="i8", strips="i8", begun="i8", ended="i8", inside="i8", updates="i8"
)  # fmt: skip
"""The range of elements needed, and the strips; the runs in contact at the start of a step and at its end;
elements in these; updates of elements."""
REPORT = record(
    **dict.fromkeys((*SERIES_UNITS, "doubt", "at_edge", "unloaded", "left", "right"), "f8")
)
"""The columns of a time series as on a spring, the doubt about the peak pressure and the highest pressure at
an edge (Pa), by how much arms at edges may press less, and the left and right edge, whichever leads."""


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


class Elements(NamedTuple):
    """What is known of each element, over strips and elements."""

    u: Array  # compression in contact
    height: Array  # h, the height of the indenter above its lowest point
    slope: Array  # dh/dx
    threshold: Array  # how far the indenter must sink from a given depth to press the element
    pressure: Array
    touched: Flags  # in contact at the start of a step
    changed: Flags  # comes into contact or leaves it in the step
    pressed: Flags  # in contact at an instant


class Runs(NamedTuple):
    """Runs of elements in contact: of each its strip, its first element, and one after its last."""

    strip: Integers
    low: Integers
    high: Integers


class Edges(NamedTuple):
    """What is known of each edge, over runs and sides."""

    kink_before: Array  # of the surface, at the start of a step
    kink_after: Array  # and at its end
    inward: Flags  # whether the edge moves inward


class Motion(NamedTuple):
    """Depth and its rate, and both along x, or what these change by in a unit of time, at each stage."""

    depth: Array
    rate: Array
    along: Array
    along_rate: Array


class Row(NamedTuple):
    """The stored elements, and the state of the indenter above them.

    The compression of a free element is the sum over its modes of `law.shares` times `faded` times `modes`:
    nothing changes in it while it is free, only `faded` decays. On arms, an element in contact has their
    forces there, and its compression is in `elements`.
    """

    constants: Constants
    tableau: Array
    fitted: bool
    deepest: float  # the depth that the row is made for
    now: Any  # an `INDENTER`
    modes: Array
    faded: Array
    elements: Elements
    low: Integers  # the first element of each strip that is near the indenter
    high: Integers  # and that behind the last
    first: int  # the first element stored
    counts: Any  # `COUNTS`
    numbers: Array  # i + shift
    begun: Runs  # in contact at the start of a step
    ended: Runs  # and at its end
    edges: Edges
    weights: Array
    rates: Motion
    dampers: Array  # work space for the compressions of the dampers of an element


def over(low: Any, high: Any) -> Any:
    """Return the elements from `low` to before `high`: one by one if compiled, else all as one slice."""
    return (slice(low, high),) if low < high else ()


def run_at(runs: Runs, r: int) -> tuple[int, int, int]:
    """Return the strip of a run, its first element, and one after its last."""
    return runs.strip[r], runs.low[r], runs.high[r]


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


def set_window(row: Row, places: Pair, depth: float) -> int:
    """Find the elements that an indenter of at most this depth can meet at both places of the base."""
    if not (depth < row.deepest and math.isfinite(places[0]) and math.isfinite(places[1])):
        return OUTGROWN
    s, dx, dy = row.constants.surface, row.constants.spacing, row.constants.across
    first, (stored, width) = row.first, row.elements.u.shape
    left, right = extent(s, depth, -1.0), extent(s, depth, 1.0)
    strips, runs, r = 1 + int(s.stretch * right / dy) if dy else 1, row.counts.begun, 0
    if runs:  # an element may stay in contact above the plane z = 0
        strips = max(strips, row.begun.strip[runs - 1] + 1)
    for j in range(min(strips, stored)):
        share = j * dy / max(s.stretch * right, FAINT)
        bent = math.sqrt(max(1.0 - share * share, 0.0))
        low = math.floor((-left * bent - max(places[0], places[1])) / dx) - SPARE - first
        high = math.ceil((right * bent - min(places[0], places[1])) / dx) + SPARE + 1 - first
        while r < runs and row.begun.strip[r] == j:
            low, high = min(low, row.begun.low[r] - SPARE), max(high, row.begun.high[r] + SPARE)
            r += 1
        fits = low >= 0 and high <= width and strips <= stored
        if j == 0 or not fits:
            row.counts.low, row.counts.high = low + first, high + first
            row.counts.strips = strips
        if not fits:
            return LACKING
        row.low[j], row.high[j] = low, high
        row.counts.updates += high - low
    return DONE


def press_to(row: Row, sunk: float) -> int:
    """Flag the elements that the indenter presses when it has sunk so far, and return their number."""
    found = 0
    for j in range(row.counts.strips):
        threshold, pressed = row.elements.threshold[j], row.elements.pressed[j]
        for i in over(row.low[j], row.high[j]):
            pressed[i] = threshold[i] <= sunk
            found += total(pressed[i])
    return found


def find_runs(row: Row) -> None:
    """Find the runs of elements that are flagged as pressed."""
    count = inside = 0
    for j in range(row.counts.strips):
        pressed, high = row.elements.pressed[j], row.high[j]
        start = next_flag(pressed, row.low[j], high, True)
        while start < high:
            stop = next_flag(pressed, start, high, False)
            row.ended.strip[count], row.ended.low[count], row.ended.high[count] = j, start, stop
            count, inside = count + 1, inside + stop - start
            start = next_flag(pressed, stop, high, True)
    row.counts.ended, row.counts.inside = count, inside


def begin(row: Row, depth: float) -> None:
    """Take the runs at the end of a step, and their kinks, for those at the start of the next."""
    for r in range(row.counts.ended):
        j, low, high = run_at(row.ended, r)
        u, height = row.elements.u[j], row.elements.height[j]
        mode, grown = row.modes[0, j], 1.0 / row.faded[0]
        for i in over(low, high):
            u[i] = depth - height[i]
        for i in over(low, low if row.constants.law.arm_time.size else high):
            mode[i] = (depth - height[i]) * grown
        row.begun.strip[r], row.begun.low[r], row.begun.high[r] = j, low, high
        for side in range(2):
            row.edges.kink_before[r, side] = row.edges.kink_after[r, side]
    row.counts.begun = row.counts.ended


def approach(
    row: Row, fall: Array, place: float, depth: float, back: float = 0.0, inclined: bool = True
) -> None:
    """Write h, dh/dx, and to `threshold` how far the indenter must sink from a depth to meet free elements.

    The base has moved by `place` under the indenter, and by `back` less where dh/dx is taken, if it is wanted
    (`inclined`). `fall` are the decay factors of the modes of free elements over the step.
    """
    c = row.constants
    s, law, numbers = c.surface, c.law, row.numbers
    for j in range(row.counts.strips):
        y, low, high = j * c.across, row.low[j], row.high[j]
        at = row.elements
        height, slope, threshold = at.height[j], at.slope[j], at.threshold[j]
        for i in over(low, high if s.exponent == 2.0 else low):
            x = c.spacing * numbers[i] + place
            height[i] = x * x * (0.5 / s.size) + s.across * (y * y)
        for i in over(low, low if s.exponent == 2.0 else high):
            x = c.spacing * numbers[i] + place
            height[i], slope[i] = surface_at(s, x, y)
        for i in over(low, high if back or (s.exponent == 2.0 and inclined) else low):
            _, slope[i] = surface_at(s, c.spacing * numbers[i] + (place - back), y)
        for k in range(fall.size):
            mode, share = row.modes[k, j], law.shares[k] * row.faded[k] * fall[k]
            for i in over(low, high):
                threshold[i] = (threshold[i] if k else height[i] - depth) + share * mode[i]


def gap(row: Row, j: int, i: int, place: float, depth: float) -> float:
    """Return the overlap w = g - u of a free element when the base has moved by `place`; of others, 0."""
    c, u = row.constants, 0.0
    for k in range(row.faded.size):
        u += c.law.shares[k] * row.faded[k] * row.modes[k, j, i]
    h, _ = surface_at(c.surface, c.spacing * row.numbers[i] + place, j * c.across)
    return 0.0 if row.elements.touched[j, i] else float(depth - h - u)


def change_contact(row: Row, law: ElementStep, j: int, i: int, g: float, rise: float) -> None:
    """Complete a step for an element that leaves the indenter in it, or that it meets: u = g, up by `rise`.

    y_k = u - s_k/K_k, the compressions of the dampers of the arms, and u of a damper beside them, are a
    product of a matrix and the modes. An element that is met is loaded during the whole step.
    """
    arm, y, of = row.modes[:, j, i], row.dampers, row.constants.law
    leaves, arms = row.elements.touched[j, i], of.arm_stiffness.size
    for k in range(arm.size):
        y[k] = row.elements.u[j, i] if leaves else arm[k] * row.faded[k] * law.fall[k]
        y[k] -= arm[k] / of.arm_stiffness[k] if leaves and k < arms else 0.0
    for k in range(arm.size if leaves else arms):
        new = 0.0
        for m in range(arm.size):
            new += (of.to_modes[k, m] if leaves else of.from_modes[k, m]) * y[m]
        if leaves:
            arm[k] = new / row.faded[k]
        else:
            arm[k] = of.arm_stiffness[k] * (g - rise - new) + law.ramp[k] * rise


def finish(row: Row, law: ElementStep, depth: float, sunk: float) -> None:
    """Complete a step: at this depth, the elements that are flagged as pressed are on the indenter.

    `sunk` is how far the indenter sank since `threshold` was written.
    """
    arms, of = law.held.size, row.elements
    for j in range(row.counts.strips):
        low, high = row.low[j], row.high[j]
        u, height, threshold = of.u[j], of.height[j], of.threshold[j]
        pressed, touched, changed = of.pressed[j], of.touched[j], of.changed[j]
        for k in range(arms):
            arm, held, ramp = row.modes[k, j], law.held[k], law.ramp[k]
            for i in over(low, high):
                loaded = held * arm[i] + ramp * (depth - height[i] - u[i])
                arm[i] = choose(touched[i] & pressed[i], loaded, arm[i])
        for i in over(low, high if arms else low):
            changed[i] = pressed[i] != touched[i]
        n = next_flag(changed, low, high, True) if arms else high
        while n < high:
            change_contact(row, law, j, n, depth - height[n], sunk - threshold[n])
            n = next_flag(changed, n + 1, high, True)
        for i in over(low, high):
            touched[i] = pressed[i]
    for k in range(row.faded.size):
        row.faded[k] *= law.fall[k]
        if row.faded[k] < FAINT:
            for j in range(row.low.size):
                for i in over(0, row.numbers.size):
                    contact = row.elements.touched[j, i] & (arms > 0)
                    row.modes[k, j, i] *= choose(contact, 1.0, row.faded[k])
            row.faded[k] = 1.0
    begin(row, depth)


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
    c, now, h = row.constants, row.now, law.h
    depth, along, theta, known = now.depth, now.along, 1.0, not c.parts
    gained = now.difference * h / max(now.last_step, h)
    guess = now.along_rate + gained / 2.0 + 5.0 / 12.0 * now.second_difference  # Adams-Bashforth
    slid = h * guess / (1.0 + 0.25 * c.spring_along * h * h / c.mass_along)
    sunk = new_along_rate = 0.0
    weigh_strips(row, depth + 0.5 * h * now.rate)
    for _ in range(SLIDE_STEPS):
        place = Y[1] - (along + slid)
        travel = place - (Y[0] - along)
        first = h * now.rate
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
            wide = max(number_in(row, row.ended, row.counts.ended),
                       number_in(row, row.begun, row.counts.begun))  # fmt: skip
            z = h * law.damping * c.spacing * wide / c.mass
            theta = exponential_fit(z) if row.fitted else 1.0
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
        now.rate = final_velocity(sunk, now.rate, h, theta)
    now.depth = depth + sunk
    if math.isfinite(c.mass_along):
        gained = new_along_rate - now.along_rate
        now.second_difference = gained - now.difference if now.last_step == h else 0.0
        now.difference, now.along, now.along_rate = gained, along + slid, new_along_rate
    return DONE


def find_thresholds(row: Row, law: ElementStep, place: float, travel: float, depth: float) -> None:
    """Find how far the indenter must sink to press each element at the end of the step: `threshold`.

    There the mean pressure would vanish: at the place of a free element then, and above that of one in
    contact now.
    """
    c = row.constants
    sprung = math.isfinite(c.mass_along)
    approach(row, law.fall, place, depth, 0.5 * travel if sprung else 0.0, sprung)
    relaxed = 1.0 - c.law.stiffness / law.stiffness
    for r in range(row.counts.begun if law.held.size else 0):
        j, low, high = run_at(row.begun, r)
        u, height, threshold = row.elements.u[j], row.elements.height[j], row.elements.threshold[j]
        for i in over(low, high):
            threshold[i] = relaxed * u[i] + (height[i] - depth)
        for k in range(law.held.size):
            arm, share = row.modes[k, j], law.weights[k] / law.stiffness
            for i in over(low, high):
                threshold[i] -= share * arm[i]
    for n in range(c.kinks.size if c.law.damping and not c.across and travel else 0):
        pass_kink(row, c.kinks[n], place, travel, depth, law.h)
    for j in range(row.counts.strips):
        for end in (row.low[j], row.high[j] - UNMET):
            for i in over(end, end + UNMET):
                row.elements.threshold[j, i] = math.inf


def pass_kink(row: Row, kink: float, place: float, travel: float, depth: float, h: float) -> None:
    """Change what is known of the elements that pass a kink of the shape in a step.

    What a damper has of the compression by a tip is left at the end of the step, and so is its mean
    pressure; without this, a wedge stands on its tip at the first order in the spacing. Arms are at the tip
    as they were at the start of the step.
    """
    c, of, law = row.constants, row.elements, row.constants.law
    height, slope, threshold = of.height[0], of.slope[0], of.threshold[0]
    passed = (kink - place) / c.spacing - row.numbers[0]
    start, end = min(passed, passed + travel / c.spacing), max(passed, passed + travel / c.spacing)
    low = max(math.floor(start + NEAR) + 1, row.low[0])
    high = min(math.ceil(end - NEAR), row.high[0])
    h_kink, _ = surface_at(c.surface, kink, 0.0)
    g = depth - h_kink
    for i in over(low, high):
        x = c.spacing * row.numbers[i] + place
        left = 0.0
        for k in range(law.rates.size):
            mode = law.to_modes[k, law.rates.size - 1] * g
            for m in range(law.arm_stiffness.size):
                y = of.u[0, i] - row.modes[m, 0, i] / law.arm_stiffness[m]
                mode = mode + law.to_modes[k, m] * choose(of.touched[0, i], y, 0.0)
            left = left + law.shares[k] * mode * np.exp((kink - x) / travel * h * law.rates[k])
        lowest = np.minimum(height[i], depth - left)
        threshold[i], height[i] = threshold[i] + lowest - height[i], lowest
        # It is pressed by the flank that it comes from.
        _, slope[i] = surface_at(c.surface, x - travel, 0.0)


def judge_edges(row: Row, place: float, depth: float, first: float) -> None:
    """Find where the overlap outside a run falls, so that the edge moves inward.

    It is that at the start of a step, at this place and depth, against that at its end, if the indenter sinks
    by `first`. This is decided once in a step, so that the iteration cannot oscillate.
    """
    for r in range(row.counts.ended):
        for side in range(2):
            j, i = row.ended.strip[r], row.ended.high[r] if side else row.ended.low[r] - 1
            change = first - row.elements.threshold[j, i] - gap(row, j, i, place, depth)
            row.edges.inward[r, side] = change < -STANDS * row.constants.depth


def number_in(row: Row, runs: Runs, count: int) -> float:
    """Return the number of elements in runs, by the weights of their strips."""
    width = 0.0
    for r in range(count):
        width += row.weights[runs.strip[r]] * (runs.high[r] - runs.low[r])
    return width


def solve_depth(row: Row, law: ElementStep, theta: float, sunk: float) -> float:
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for how far the indenter sinks.

    While no element comes into contact or detaches, F_z is quadratic in the depth: one step of Newton's
    method with the second derivative is exact. Elements in contact are those with `threshold` <= `sunk`, so
    that their number tells whether they are the same.
    """
    c, now, h, k = row.constants, row.now, law.h, law.stiffness * row.constants.spacing
    for _ in range(NEWTON_STEPS if math.isfinite(c.mass) else 0):
        area, width, bent, _ = add_kinks(row, law, sunk)
        for r in range(row.counts.ended):
            j, low, high = run_at(row.ended, r)
            threshold = row.elements.threshold[j]
            area += row.weights[j] * (sunk * (high - low) - summed(threshold, low, high))
            width += row.weights[j] * (high - low)
        mean = now.depth - c.depth + theta * sunk
        change_of_rate = final_velocity(sunk, now.rate, h, theta) - now.rate
        residual = c.mass * change_of_rate / h - c.weight + c.spring * mean + k * area
        slope = c.mass / (theta * h * h) + theta * c.spring + k * width
        root = math.sqrt(max(slope * slope - 2.0 * residual * k * bent, 0.0))
        sunk -= 2.0 * residual / (slope + root)
        if press_to(row, sunk) == row.counts.inside:
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
    edges = row.edges
    for r in range(row.counts.ended if row.constants.parts else 0):
        j = row.ended.strip[r]
        old = r < row.counts.begun and row.begun.strip[r] == j
        weight, slope = row.weights[j], row.elements.slope[j]
        threshold = row.elements.threshold[j]
        for side in range(2):
            out = 2 * side - 1
            i = row.ended.high[r] if side else row.ended.low[r] - 1
            edges.kink_after[r, side] = 0.0
            if not edges.inward[r, side]:
                w, far, farthest = threshold[i], threshold[i + out], threshold[i + 2 * out]
                kink, more, bend = kink_area((sunk - w, sunk - far, sunk - farthest))
                added = kink - (relaxed * edges.kink_before[r, side] if old else 0.0)
                edges.kink_after[r, side] = kink
                area, wider = area + weight * added, wider + weight * more
                bent, push = bent + weight * bend, push + weight * added * slope[i - out]
    return area, wider, bent, push


def solve_along(row: Row, law: ElementStep, sunk: float, slid: float) -> Pair:
    """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

    An element pushes along x with its pressure times the slope halfway through the step, so that the
    mean forces do the very work by which elements of a parabola are compressed.
    """
    c, now, h = row.constants, row.now, law.h
    M_x, c_x, k_x, k = c.mass_along, c.damping_along, c.spring_along, law.stiffness * c.spacing
    width = inclined = tilted = 0.0
    _, _, _, area = add_kinks(row, law, sunk)
    for r in range(row.counts.ended):
        j, low, high = run_at(row.ended, r)
        weight, slope, threshold = row.weights[j], row.elements.slope[j], row.elements.threshold[j]
        leaning = summed(slope, low, high)
        width, inclined = width + weight * (high - low), inclined + weight * leaning
        tilted += weight * dotted(slope, slope, low, high)
        area += weight * (sunk * leaning - dotted(slope, threshold, low, high))
    # Oscillations too fast for the step are damped; θ - 1/2 is of the third order in h, as on arms.
    swing = h * math.sqrt(k_x / M_x)
    z = h * (c_x + law.damping * c.spacing * tilted) / M_x + swing * swing * swing
    theta = exponential_fit(z) if row.fitted else 1.0
    change_of_rate = final_velocity(slid, now.along_rate, h, theta) - now.along_rate
    held = c_x * slid / h + k_x * (now.along + theta * slid)
    residual = M_x * change_of_rate / h + held + k * area
    # As the foundation gives way along x, the depth changes, too.
    normal = c.mass / (h * h) + c.spring + k * width
    stiff = k * tilted - (k * inclined) * (k * inclined) / normal
    slid -= residual / (M_x / (theta * h * h) + c_x / h + theta * k_x + stiff)
    return slid, final_velocity(slid, now.along_rate, h, theta)


def explicit_step(
    row: Row, laws: tuple[ElementStep, ElementStep, ElementStep], Y: Array, V: Array
) -> int:
    """Take a Runge-Kutta step; which elements are in contact is decided at its end.

    `laws` are those of no time, half the step and all of it; Y and V are at these times, V just before the
    end. F_z = dx Σ p over whole elements (Eqs. 12-17). Arms are loaded along a straight line from the start
    of the step to each stage, which leaves the order two.
    """
    c, now, h = row.constants, row.now, laws[2].h
    rates, stages, begun = row.rates, row.tableau.shape[0] - 1, Y[0] - now.along
    for i in range(stages + 1):
        n = int(2.0 * row.tableau[i, 0])
        depth, rate, along, along_rate = now.depth, now.rate, now.along, now.along_rate
        for k in range(i):
            share = h * row.tableau[i, k + 1]
            depth, rate = depth + share * rates.depth[k], rate + share * rates.rate[k]
            along += share * rates.along[k]
            along_rate += share * rates.along_rate[k]
        place = Y[n] - along
        status = set_window(row, (begun, place), max(depth, now.depth))
        if status != DONE:
            return status
        press(row, laws[n], (depth, rate), place, V[n] - along_rate, True)
        pull = c.weight - c.spring * (depth - c.depth)
        drag = -c.spring_along * along - c.damping_along * along_rate
        for r in range(row.counts.ended):
            j, low, high = run_at(row.ended, r)
            p, weight = row.elements.pressure[j], c.spacing * row.weights[j]
            pull -= weight * summed(p, low, high)
            drag -= weight * dotted(p, row.elements.slope[j], low, high)
        rates.depth[i], rates.rate[i] = rate, pull / c.mass  # Eq. 17
        rates.along[i], rates.along_rate[i] = along_rate, drag / c.mass_along
    finish(row, laws[2], depth, 0.0)
    gained, gained_along = rate - now.rate, along_rate - now.along_rate
    now.depth += depth - now.depth
    now.along += along - now.along
    now.rate += gained
    now.along_rate += gained_along
    pulls, drags = rates.rate, rates.along_rate
    judge_balance(now, c.weight, c.mass, gained / h, (pulls[0], pulls[stages]))
    judge_balance(now, c.weight, c.mass_along, gained_along / h, (drags[0], drags[stages]))
    return DONE


def judge_balance(now: Any, weight: float, mass: float, mean: float, ends: Pair) -> None:
    """Average the imbalance of forces in a step, by accelerations: the mean one, and those at its ends."""
    if math.isfinite(mass):
        off = mass * abs(mean - 0.5 * (ends[0] + ends[1]))
        largest = weight + mass * max(abs(ends[0]), abs(ends[1]))
        now.mean_imbalance += (off - now.mean_imbalance) / WINDOW
        now.mean_force += (largest - now.mean_force) / WINDOW


def press(
    row: Row, law: ElementStep, sinking: Pair, place: float, velocity: float, met: bool
) -> None:
    """Write p = K g + C g' + Σ s_k of the elements under the indenter, and find those in contact (Eqs. 6-12).

    On arms, a free element would have the pressure of what it is compressed by beyond its free motion.

    `sinking` is the depth and its rate, `velocity` that of sliding. In contact are those that were at the
    start of the step and, if they may be `met`, those whose free surface is above the indenter, `threshold`
    < 0; but only where p >= 0, since none pulls (Eqs. 20-25).
    """
    c, of, arms, (depth, rate) = row.constants, row.elements, law.held.size, sinking
    weigh_strips(row, depth)
    approach(row, law.fall, place, depth)
    glassy = c.law.stiffness + law.ramp.sum()
    for j in range(row.counts.strips):
        low, high, touched, pressed = row.low[j], row.high[j], of.touched[j], of.pressed[j]
        p, u, threshold = of.pressure[j], of.u[j], of.threshold[j]
        height, slope = of.height[j], of.slope[j]
        for i in over(low, high):
            g, g_rate = depth - height[i], rate - velocity * slope[i]
            p[i] = c.law.stiffness * g + c.law.damping * g_rate
        for k in range(arms):
            arm = row.modes[k, j]
            for i in over(low, high):
                loaded = law.held[k] * arm[i] + law.ramp[k] * (depth - height[i] - u[i])
                p[i] += choose(touched[i], loaded, 0.0)
        for k in range(row.faded.size if arms and c.law.damping else 0):
            mode = row.modes[k, j]
            yields = c.law.damping * c.law.rates[k] * c.law.shares[k] * row.faded[k] * law.fall[k]
            for i in over(low, high):
                p[i] += choose(touched[i], 0.0, yields * mode[i])
        for i in over(low, high if arms else low):
            free = p[i] - c.law.stiffness * (depth - height[i]) - glassy * threshold[i]
            p[i] = choose(touched[i], p[i], free)
        for i in over(low, high):
            pressed[i] = (touched[i] | (met & (threshold[i] < 0.0))) & (p[i] >= 0.0)
    find_runs(row)


def report(
    row: Row, none: ElementStep, instants: "Instants", n: int, unsure: float, found: Any
) -> int:
    """Write the report at an instant into `found`, a `REPORT`.

    `none` is the law over no time. At a kink of the shape, where p jumps, a run is divided in two. Where the
    pressure is highest at an edge, its doubt is `unsure` times what it differs by between the elements there.
    """
    c, now = row.constants, row.now
    V, forward, depth = instants.velocity[n], instants.forward[n], now.depth
    sliding = V - now.along_rate
    # An element on a kink is still on the flank before it.
    behind = math.copysign(NEAR * c.spacing, sliding) if c.kinks.size and sliding else 0.0
    place = instants.displacement[n] - now.along - behind
    status = set_window(row, (place, place), depth)
    if status != DONE:
        return status
    press(row, none, (depth, now.rate), place, sliding, False)
    found.normal_force = found.friction_force = found.peak_pressure = found.doubt = 0.0
    found.at_edge = found.unloaded = 0.0
    found.left = found.right = math.nan
    for r in range(row.counts.ended):
        j, low, stop = run_at(row.ended, r)
        kinks, before = c.kinks.size if j == 0 and c.parts else 0, -math.inf
        for k in range(kinks + 1):
            after, high = math.inf, stop
            if k < kinks:
                after = (c.kinks[k] - place) / c.spacing - row.numbers[0]
                high = max(low, min(stop, math.floor(after) + 1))
            if high > low:
                report_run(row, (j, low, high), (before, after), (place, sliding), unsure, found)
            low, before = high, after
    if now.along_rate and abs(sliding) > c.creep:
        forward = 1.0 if sliding > 0.0 else 0.0
    found.leading_edge = found.left if forward else found.right
    found.trailing_edge = found.right if forward else found.left
    found.time, found.velocity = instants.time[n], V
    found.depth, found.depth_rate, found.sliding_velocity = depth, now.rate, sliding
    found.spring_force = c.spring_along * now.along + c.damping_along * now.along_rate
    return DONE


def report_run(
    row: Row, run: tuple[int, int, int], kinks: Pair, base: Pair, unsure: float, found: Any
) -> None:
    """Add the forces of a run, or of its part between two kinks, to a report, and its peak and edges.

    `base` is how far the base has moved under the indenter, and its velocity there.
    """
    (j, low, high), (before, after), (place, _), c = run, kinks, base, row.constants
    p, slope = row.elements.pressure[j], row.elements.slope[j]
    top = low + int(np.argmax(p[low:high]))
    first = end_run(row, j, low, -1, base, low - before, high - low)
    last = end_run(row, j, high - 1, 1, base, after - (high - 1), high - low)
    weight = c.spacing * row.weights[j]
    found.normal_force += weight * (summed(p, low, high) + first.gained + last.gained)
    along = dotted(p, slope, low, high) + first.gained_along + last.gained_along
    found.friction_force -= weight * along
    found.unloaded += weight * (first.unloaded + last.unloaded)
    if p[top] > found.peak_pressure or not found.peak_pressure:
        reach = first.outward if top == low else 1.0, last.outward if top == high - 1 else 1.0
        if (top == low and low - before <= 1.0) or (top == high - 1 and after - top <= 1.0):
            reach = -1.0, -1.0  # no parabola across a kink
        found.peak_pressure, found.doubt = find_peak(row, p, top, reach, low, high)
    for end, nearest in ((first, p[low]), (last, p[high - 1])):
        found.at_edge = max(found.at_edge, end.pressure, nearest)
        if end.pressure > found.peak_pressure:
            found.peak_pressure, found.doubt = end.pressure, end.doubt + unsure * end.jump
    if j == 0:
        left = c.spacing * (row.numbers[low] - first.outward) + place
        found.left = left if math.isnan(found.left) else found.left
        found.right = c.spacing * (row.numbers[high - 1] + last.outward) + place


class End(NamedTuple):
    """The end of a run."""

    outward: float  # how far outward of the last element the edge is, in elements
    gained: float  # what the sum of p gains by ending there
    gained_along: float  # and that of p h'
    pressure: float  # at the edge
    doubt: float  # about it
    jump: float  # how much p differs between the elements beside it
    unloaded: float  # by how much arms may press less up to it


def end_run(row: Row, j: int, i: int, out: int, base: Pair, kink: float, size: int) -> End:
    """Return how a run ends beyond its last element i, to the left (`out` = -1) or to the right (1).

    An edge peels where p falls to zero, between two elements by a straight line, and touches where the
    indenter meets the free surface. A run ends at a `kink` of the shape, so far outward, at the latest, and
    one of whole elements half an element beyond the last.
    """
    c, of, (place, velocity) = row.constants, row.elements, base
    if not c.parts:
        return End(0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    p, slope, threshold = of.pressure[j], of.slope[j], of.threshold[j]
    inside, outside, within = p[i], p[i + out], p[i - out] if size > 1 else p[i]
    share, doubt, touched = 1.0, 0.0, of.touched[j, i + out]
    if c.law.arm_time.size and not touched:
        outside = 2.0 * inside - within
    peels = max(inside, 0.0) / (max(inside, 0.0) - outside) if outside < 0.0 else math.inf
    more = c.law.damping * row.now.jump
    w, far, farthest = -threshold[i + out], -threshold[i + 2 * out], -threshold[i + 3 * out]
    touches, straight = touching((w, far, farthest))
    if not touched and (straight or math.isinf(peels)):
        share = 1.0 - touches
    bent = far - farthest > BENT * (w - far)
    if more > 0.0 and bent and outside < min(more, inside):
        # It peeled until now, and a jump of the rate moves no edge outward.
        share = max((inside - more) / (inside - outside), -1.0)
    p_kink = inside + kink * (inside - within) if kink <= share else 0.0
    p_edge = inside + share * (outside - inside) if share < peels else 0.0
    share = min(share, peels)
    if p_kink > 0.0:
        share, p_edge, doubt = kink, p_kink, abs(p_kink - inside)
    x = c.spacing * (row.numbers[i] + (share - NEAR) * out) + place
    _, steep = surface_at(c.surface, x, j * c.across)
    gained = 0.5 * (share * (inside + p_edge) - inside)
    along = 0.5 * (share * (slope[i] * inside + steep * p_edge) - slope[i] * inside)
    less = 0.0
    if c.law.arm_time.size and p_edge > 0.0 and not touched:
        rise = row.now.rate - velocity * steep
        passing = c.spacing * share * abs(steep) / rise if rise > 0.0 else 0.0
        less = share * unloaded(row, (j, i, i - out if size > 1 else i, i + out), share, passing)
    return End(share, gained, along, p_edge, doubt, abs(inside - outside), less)


def unloaded(row: Row, at: tuple[int, int, int, int], share: float, passing: float) -> float:
    """Return how much less arms may press on average up to an edge than if continued from inside.

    They enter as they are on free ground and tend to that continuation as 1 - e^(-t/τ_i). The edge goes from
    the last element to where it is, `share` elements farther, in the time `passing`; if it stands or goes
    back it is unknown when it came, and zero. `at` are a strip, this element, its neighbour inside, and that
    outside.
    """
    law, (j, i, within, outside) = row.constants.law, at
    free = less = 0.0
    for m in range(row.faded.size):
        free += law.shares[m] * row.faded[m] * row.modes[m, j, outside]
    for k in range(law.arm_time.size):
        arm, stretched = row.modes[k, j], free
        for m in range(row.faded.size):
            stretched -= law.from_modes[k, m] * row.faded[m] * row.modes[m, j, outside]
        over = arm[i] + share * (arm[i] - arm[within]) - law.arm_stiffness[k] * stretched
        less += (1.0 - exponential_fit(passing / law.arm_time[k])) * over
    return max(less, 0.0)


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
    the curves meet that continue it from both sides. Of whole elements the highest one is the peak, and a
    ridge beside it is higher by at most what they differ by.
    """
    before, here, after = p[k - 1], p[k], p[k + 1]
    arms = row.constants.law.arm_time.size > 0
    if not row.constants.parts:
        fall = max(here - before if k > low else 0.0, here - after if k < high - 1 else 0.0)
        return here, 0.5 * fall if arms else 0.0
    if arms:
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


class Instants(NamedTuple):
    """Instants that are reported."""

    after: Integers  # the step after which each is
    time: Array
    velocity: Array  # V, of the base
    forward: Array  # 1 if the base moves, or moved last, with V >= 0, else 0
    displacement: Array  # Y, of the base


class Limits(NamedTuple):
    """What no stable run reaches."""

    rate: float  # of the depth, downward positive
    along_rate: float
    imbalance: float  # of forces, as a share of the largest


class Course(NamedTuple):
    """The steps of a run, and what is reported."""

    times: Array  # before the first step and after each
    Y: Array  # at the start of each, halfway and at its end
    V: Array  # likewise, at the end just before it
    held: Array  # depth and its rate just after each of the times, if they are given
    law: ElementStep  # over steps of no length, and over half and all of each length
    which: Integers  # number of the length of each step
    instants: Instants
    unsure: float  # argument of `report`
    limits: Limits


def law_at(of: ElementStep, k: int) -> ElementStep:
    """Return the law over one of several lengths."""
    return ElementStep(of.h[k], of.fall[k], of.held[k], of.weights[k], of.ramp[k], of.stiffness[k],
                       of.damping[k])  # fmt: skip


def advance(
    row: Row, course: Course, found: Any, step: int, reported: int, until: int
) -> tuple[int, int, int]:
    """Run from a step on; return why it ended, the steps done and the instants reported."""
    none, now, instants = law_at(course.law, 0), row.now, course.instants
    while True:
        if len(course.held) > 0:
            now.jump = course.held[step, 1] - course.held[max(step - 1, 0), 1]
            now.depth, now.rate = course.held[step, 0], course.held[step, 1]
        while reported < instants.after.size and instants.after[reported] == step:
            status = report(row, none, instants, reported, course.unsure, found[reported])
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
        now.last_step = law.h
        step += 1
        # No element pulls, p >= 0, so that an indenter in contact rises at most with g/τ - V h'; beyond
        # that it has left the foundation, and only a spring can lift it faster. But an unstable step does
        # not always throw it off: when the contact gives way, the oscillation may settle at some amplitude,
        # or on a wrong state at rest, with forces that do not balance M δ'' = W - k_s (δ - δ_0) - F_z.
        if not now.rate >= course.limits.rate:  # NaN is not above it either
            return THROWN_UP, step, reported
        if not abs(now.along_rate) <= course.limits.along_rate:
            return THROWN_ALONG, step, reported
        if step >= WINDOW and now.mean_imbalance > course.limits.imbalance * now.mean_force:
            return UNBALANCED, step, reported
