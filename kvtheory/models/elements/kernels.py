"""The elements over a step: one source that runs interpreted and, where it pays, compiled by numba.

Read it from top to bottom. The row: which elements are near the indenter, strip by strip. The law of one
element over a step. What both kinds of schemes share: where elements are, and what is left of them at the end
of a step. The implicit step: the balance of momentum, solved for the depth. The explicit step of Runge and
Kutta. The sums over elements at an instant, whole elements or up to the very edges. Last, the run.

Loops over the elements of a strip are array expressions, which are fast both ways; loops over strips, edges
and arms are scalar. Positions along a strip count from the first stored element. A run of elements in contact
is (strip, first, one after the last). A line contact is one strip. `profile` is None but for a shape that is
a Python function, which is interpreted.

All that is compiled is in this file, since numba does not notice a change in another.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.elements.law import Array, ContactRule, Law

PARABOLA, CIRCLE, WEDGE, POWER_LAW = range(4)
"""Kinds of profiles."""
DEPTH, RATE, ALONG, ALONG_RATE, IMBALANCE, FORCE, LAST = range(7)
"""The indenter: depth (m) and rate, the same along x, two forces to judge an explicit step by, the last step."""
FIRST, LOW, HIGH, STRIPS, UPDATES = range(5)
"""Counts of a row: its first element, the elements and strips that it lacks, and updates of single elements."""
DONE, LACKING, OUTGROWN, THROWN_UP, THROWN_ALONG, UNBALANCED = range(6)
"""How a run ended, or why it paused."""

FAR = 1e300
"""The height beyond the reach of a shape: no indenter is that deep."""
SPARE, UNMET = 7, 3
"""Elements beyond those that can be met: the surface is extended from three, and three more never are met."""
SMALL_FIT, SMALL_RAMP = 1e-2, 2e-2
"""Below these, θ(z) and the mean of a ramp are taken from their series, where the closed forms would cancel."""
NEWTON_STEPS, SLIDE_STEPS = 60, 30
"""The iterations end after two or three."""
SLIDE_RTOL = 1e-9
"""Of the static half length: a change so small was the last, and leaves far less."""
ROOM, MORE_ROOM = 0.25, 4.0
"""Of the static depth: so far it is at first taken to sink in a step at most; then so many times farther."""
STANDS = 1e-12
"""Of the static depth: an edge where the overlap falls by less in a step does not move inward."""
STRAIGHT = 0.25
"""Of w'^2: the least w'^2 - 2 w w'', which is w'^2 where w is a straight line and 0 where it is a square."""
NEAR = 1e-9
"""Of the spacing: so far inside an edge is the slope there, which may jump at the edge."""
TIE = 1e-9
"""Relative: an element in contact is on the surface, up to rounding."""
AT_REST = 1e-12
"""Of a_0/τ: slower on a spring, it stands but for rounding, and the edges are those of the drive."""
WINDOW = 40
"""Steps over which the balance of forces is judged: a sudden change of the drive upsets only a few."""


class Surface(NamedTuple):
    """The indenter: h(r) of one of four kinds, r being x or, if `revolved`, sqrt(x² + y²).

    `size` is R, L or the inclination, `inside` the last place that has a surface, `across` is 1/(2 R') of a
    ball, `stretch` the ratio of width to length of a contact.
    """

    kind: int
    size: float
    exponent: float
    inside: float
    across: float
    revolved: bool
    stretch: float


class Constants(NamedTuple):
    """What stays as it is in a run, in SI; the symbols are those of `Model` and `Law`."""

    surface: Surface
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
    at_rest_velocity: float
    kinks: Array
    law: Law
    fitted: bool
    explicit: bool
    tableau: Array
    rule: ContactRule


class Row(NamedTuple):
    """The stored elements: arrays over strips and elements.

    `u` is the compression; of an element in contact, `arms` are the forces s_i of its arms, of a free one its
    modes. Those of a strip from `low` to `high` are near the indenter and up to date; a free one elsewhere is
    as it was at the time `since`. `rest`, `height`, `meets`, `slope` and `pressed` are work space of a step.
    """

    u: Array
    arms: Array
    since: Array
    touched: NDArray[np.bool_]
    low: NDArray[np.int64]
    high: NDArray[np.int64]
    counts: NDArray[np.int64]
    rest: Array
    height: Array
    meets: Array
    slope: Array
    pressed: NDArray[np.bool_]


class StepLaw(NamedTuple):
    """The law of an element over a step of the length h: all is linear in its state.

    `fall` are the factors of the modes of a free element, `held` those of the arms of one that is held where
    it is, `weights` those of the mean force of arms then; `free` gives the latter from the modes of a free
    element. A unit ramp adds `ramp` to the arms and `stiffness` to the mean pressure; `damping` is that of
    the damper which, beside a spring, does to a ramp as the step does.
    """

    h: float
    fall: Array
    held: Array
    weights: Array
    ramp: Array
    stiffness: float
    damping: float
    free: Array


# The indenter


def height_at(s: Surface, profile: Any, x: Any, y: float) -> Any:
    """Return h(x, y), `FAR` where the indenter has no surface."""
    if s.revolved:
        return _height(s, profile, np.hypot(x, y))
    return _height(s, profile, x) + s.across * (y * y)


def _height(s: Surface, profile: Any, r: Any) -> Any:
    if s.kind == PARABOLA and profile is None:
        return r * (r / (2.0 * s.size))
    near = np.minimum(np.maximum(r, -s.inside), s.inside)
    if profile is not None:
        h = profile.height(near)
    elif s.kind == CIRCLE:
        h = near * (near / (s.size + np.sqrt((s.size - near) * (s.size + near))))
    elif s.kind == WEDGE:
        h = s.size * np.abs(near)
    else:
        h = np.abs(near) * (np.abs(near) / s.size) ** (s.exponent - 1.0) / s.exponent
    return h + FAR * (np.abs(r) > s.inside)


def slope_at(s: Surface, profile: Any, x: Any, y: float) -> Any:
    """Return dh/dx, zero where the indenter has no surface."""
    if s.revolved:
        r = np.hypot(x, y)
        return _slope(s, profile, r) * (x / np.maximum(r, 1e-300))
    return _slope(s, profile, x)


def _slope(s: Surface, profile: Any, r: Any) -> Any:
    if s.kind == PARABOLA and profile is None:
        return r / s.size
    near = np.minimum(np.maximum(r, -s.inside), s.inside)
    if profile is not None:
        slope = profile.slope(near)
    elif s.kind == CIRCLE:
        slope = near / np.sqrt((s.size - near) * (s.size + near))
    elif s.kind == WEDGE:
        slope = s.size * np.sign(near)
    else:
        slope = np.sign(near) * (np.abs(near) / s.size) ** (s.exponent - 1.0)
    return slope * (np.abs(r) <= s.inside)


def extent(s: Surface, profile: Any, depth: float, side: float) -> float:
    """Return how far to one side, -1 or 1, h = depth is, or the surface ends."""
    if profile is not None:
        return float(profile.extent(depth, side))
    if not depth > 0.0:
        return 0.0
    if s.kind == PARABOLA:
        far = math.sqrt(2.0 * s.size * depth)
    elif s.kind == CIRCLE:
        far = math.sqrt(min(depth, s.size) * (2.0 * s.size - min(depth, s.size)))
    elif s.kind == WEDGE:
        far = depth / s.size
    else:
        far = s.size * (s.exponent * (depth / s.size)) ** (1.0 / s.exponent)
    return min(far, s.inside)


def weights_across(dy: float, count: int, rim: float) -> Array:
    """Return the width for which each strip counts, on both sides, in m; corrected at a `rim` above zero.

    >>> y, b = np.arange(8.0), 5.0
    >>> [round(float(weights_across(1.0, 8, rim) @ np.maximum(b * b - y * y, 0.0)), 2) for rim in (0.0, b)]
    [165.0, 166.5]
    >>> round(4.0 / 3.0 * b**3, 2)
    166.67
    """
    weights = np.full(count, 2.0 * dy)
    weights[0] = dy
    last = math.floor(rim / dy)
    s = rim / dy - last
    if 1 <= last <= count:
        weights[last - 1] += dy * (s * s - s + 1.0 / 6.0) / (1.0 + s)
    return weights


def _weights(c: Constants, profile: Any, depth: float, strips: int) -> Array:
    """Return by what the force of each strip counts: 1, or its width in m."""
    if not c.across:
        return np.ones(strips)
    rim = c.surface.stretch * extent(c.surface, profile, depth, 1.0) if c.parts else 0.0
    return weights_across(c.across, strips, rim)


# The row


def attend(
    c: Constants, profile: Any, row: Row, now: float, places: tuple[float, float], depth: float
) -> int:
    """Bring up to date the elements that an indenter of at most this depth can meet at both places."""
    if not (depth < c.deepest and math.isfinite(places[0]) and math.isfinite(places[1])):
        return OUTGROWN
    s, dx, first, (stored, width) = c.surface, c.spacing, row.counts[FIRST], row.u.shape
    left, right = extent(s, profile, depth, -1.0), extent(s, profile, depth, 1.0)
    strips = 1 + int(s.stretch * right / c.across) if c.across else 1
    for j in range(stored):
        low = high = row.low[j]
        if j < strips:
            bent = 1.0
            if j:
                share = j * c.across / (s.stretch * right)
                bent = math.sqrt(max(1.0 - share * share, 0.0))
            low = math.floor((-left * bent - max(places[0], places[1])) / dx) - SPARE - first
            high = math.ceil((right * bent - min(places[0], places[1])) / dx) + SPARE + 1 - first
            if j == 0 and (low < 0 or high > width or strips > stored):
                row.counts[LOW], row.counts[HIGH] = low + first, high + first
                row.counts[STRIPS] = strips
                return LACKING
            row.counts[UPDATES] += high - low
        before, after = row.low[j], row.high[j]
        row.since[j, before : min(low, after)] = now
        row.since[j, max(high, before) : after] = now
        _relax(c, row, j, low, min(before, high), now)
        _relax(c, row, j, max(after, low), high, now)
        row.low[j], row.high[j] = low, high
    return DONE


def _relax(c: Constants, row: Row, j: int, low: int, high: int, now: float) -> None:
    """Bring free elements up to date that were left alone for a while."""
    if low >= high:
        return
    past, u = now - row.since[j, low:high], row.u[j, low:high]
    if not row.arms.shape[0]:
        u *= np.exp(-c.law.rates[0] * past)
        return
    u[:] = 0.0
    for k in range(row.arms.shape[0]):
        row.arms[k, j, low:high] *= np.exp(-c.law.rates[k] * past)
        u += c.law.shares[k] * row.arms[k, j, low:high]


def runs_of(flags: NDArray[np.bool_], low: Any, high: Any) -> NDArray[np.int64]:
    """Return the runs of flagged elements; those at both ends of the strips are taken to be out of them.

    >>> runs_of(np.array([[False, True, True, False]]), [0], [4]).tolist()
    [[0, 1, 3]]
    """
    count = 0
    for j in range(flags.shape[0]):
        part = flags[j, low[j] : high[j]]
        count += (part[1:] != part[:-1]).sum() // 2
    runs = np.empty((count, 3), dtype=np.int64)
    k = 0
    for j in range(flags.shape[0]):
        part = flags[j, low[j] : high[j]]
        changes = np.flatnonzero(part[1:] != part[:-1])
        for i in range(0, changes.size - 1, 2):
            runs[k, 0] = j
            runs[k, 1], runs[k, 2] = low[j] + changes[i] + 1, low[j] + changes[i + 1] + 1
            k += 1
    return runs


# The law of one element over a step


def ramp_functions(z: Array) -> tuple[Array, Array]:
    """Return phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, from 1 and 1/2 at z = 0.

    >>> [value.round(6).tolist() for value in ramp_functions(np.array([0.0, 1.0, 1e9]))]
    [[1.0, 0.632121, 0.0], [0.5, 0.367879, 0.0]]
    """
    phi_1, phi_2 = np.ones_like(z), np.full_like(z, 0.5)
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


def law_of(law: Law, h: float) -> StepLaw:
    """Return the law of a step of the length h.

    The mean pressure of a damper is that with the weight e^(t/tau): k (g - u e^(-h/tau)), k =
    K/(1 - e^(-h/tau)), whatever the history of u between. That of arms is the plain mean: with
    z_i = h/tau_i, phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, an arm has over a ramp the mean
    phi_1 s_i + phi_2 K_i (u_1 - u_0) and ends at e^(-z) s_i + phi_1 K_i (u_1 - u_0).
    """
    z = h / law.arm_time
    phi_1, phi_2 = ramp_functions(z)
    stiffness = 0.5 * law.stiffness
    if law.damping:
        stiffness = -law.stiffness / math.expm1(-h * law.stiffness / law.damping) if h else math.inf
    loaded = phi_1 * law.arm_stiffness
    free = loaded.sum() * law.shares
    for i in range(z.size):
        free -= loaded[i] * law.from_modes[i]
    return StepLaw(
        h, np.exp(-h * law.rates), np.exp(-z), phi_1, loaded,
        stiffness + (phi_2 * law.arm_stiffness).sum(),
        law.damping + h * (law.arm_stiffness * (2.0 * phi_2 - phi_1)).sum(), free,
    )  # fmt: skip


def _left(c: Constants, row: Row, law: StepLaw, j: int, i: Any) -> Any:
    """Return u of elements at the end of a step, had they been left alone from its start."""
    if not row.arms.shape[0]:
        return law.fall[0] * row.u[j, i]
    left = (c.law.shares[0] * law.fall[0]) * row.arms[0, j, i]
    for k in range(1, row.arms.shape[0]):
        left = left + (c.law.shares[k] * law.fall[k]) * row.arms[k, j, i]
    return left


def _release(c: Constants, row: Row, j: int, i: int) -> None:
    """Take an element out of contact: its arms become modes."""
    y = row.u[j, i] - row.arms[:, j, i] / c.law.arm_stiffness
    for k in range(y.size):
        row.arms[k, j, i] = (c.law.to_modes[k] * y).sum()


def _enter(c: Constants, row: Row, j: int, i: int, within: float, rise: float) -> None:
    """Take a free element into contact: its modes become arms, which are then loaded within the step."""
    modes = row.arms[:, j, i].copy()
    u = (c.law.shares * modes).sum()
    phi_1, _ = ramp_functions(within / c.law.arm_time)
    for k in range(modes.size):
        y = (c.law.from_modes[k] * modes).sum()
        row.arms[k, j, i] = c.law.arm_stiffness[k] * (u - y + phi_1[k] * rise)


def settle(
    c: Constants, profile: Any, row: Row, law: StepLaw, place: float, travel: float, depths: tuple[float, float]
) -> None:  # fmt: skip
    """Let a step pass: `pressed` elements are where the indenter is at its end, all others were left alone."""
    for j in range(row.u.shape[0]):
        low, high = row.low[j], row.high[j]
        if low == high:
            continue
        u, pressed, touched = row.u[j, low:high], row.pressed[j, low:high], row.touched[j, low:high]
        g = depths[1] - row.height[j, low:high]
        if not row.arms.shape[0]:
            u[:] = np.where(pressed, g, law.fall[0] * u)
        else:
            for i in np.flatnonzero(touched & ~pressed):
                _release(c, row, j, low + i)
            new = np.flatnonzero(pressed & ~touched)
            gaps = np.empty(new.size)
            for k in range(new.size):
                gaps[k] = gap_before(c, profile, row, j, low + new[k], place - travel, depths[0])
            kept = touched & pressed
            left = np.zeros(high - low)
            for k in range(row.arms.shape[0]):
                arm = row.arms[k, j, low:high]
                arm[:] = np.where(
                    kept, law.held[k] * arm + law.ramp[k] * (g - u), law.fall[k] * arm
                )
                left += c.law.shares[k] * arm
            for k in range(new.size):
                rise = g[new[k]] - left[new[k]]
                within = law.h * rise / (rise - min(gaps[k], 0.0)) if rise > 0.0 else 0.0
                _enter(c, row, j, low + new[k], within, rise)
            u[:] = np.where(pressed, g, left)
        touched[:] = pressed


def gap_before(
    c: Constants, profile: Any, row: Row, j: int, i: int, place: float, depth: float
) -> float:
    """Return how far the indenter was below an element at the start of a step."""
    x = c.spacing * (row.counts[FIRST] + i + c.shift) + place
    return depth - height_at(c.surface, profile, x, j * c.across) - row.u[j, i]  # type: ignore[no-any-return]


def positions(c: Constants, row: Row, low: int, high: int, place: float) -> Array:
    """Return x of elements when the base has moved by `place` under the indenter."""
    first = row.counts[FIRST]
    x: Array = c.spacing * (np.arange(first + low, first + high) + c.shift) + place
    return x


# Implicit schemes


def exponential_fit(z: float) -> float:
    """Return θ = 1/(1 - e^(-z)) - 1/z, from 1/2 at z = 0 to 1 at infinity.

    >>> exponential_fit(0.0), round(exponential_fit(1.0), 6), exponential_fit(1e9)
    (0.5, 0.581977, 0.999999999)
    """
    return 0.5 + z / 12.0 - z * z * z / 720.0 if z < SMALL_FIT else -1.0 / math.expm1(-z) - 1.0 / z


def _velocity(way: float, before: float, h: float, theta: float) -> float:
    """Return the velocity at the end of a step in which the mean (1-θ) v_0 + θ v_1 goes this way."""
    return (way / h - (1.0 - theta) * before) / theta


def kink_area(overlap: Any) -> Any:
    """Return what trapezoids leave out of the area of u at an edge by dx, its d/dδ and d²/dδ², and the bend.

    `overlap` is w at the three nearest elements outside. Between the first of them and the next inside, u
    is the larger of two nearly straight lines, which cross where w = 0; the trapezoid takes the chord
    (theorem `element-kink`). Besides, the jump of the slope leaves a twelfth of it times dx^2, as at every
    end of a smooth piece (Euler-Maclaurin). The bend is that jump, as a difference of two elements.

    >>> x = 0.1 * np.arange(-5.0, 6.0) + 0.03
    >>> sums = 0.1 * np.maximum(x, 0.0).sum() - 0.05 * x[-1] - 0.01 / 12.0
    >>> bool(abs(sums + 0.1 * kink_area(x[4:1:-1])[0] - 0.5 * x[-1] ** 2) < 1e-15)
    True
    """
    w, far, farthest = overlap
    rise = 2.0 * w - 3.0 * far + farthest
    within = w + rise
    if not (w < 0.0 and within >= 0.0):
        return 0.0, 0.0, 0.0, math.inf
    half = 0.5 / rise
    return half * within * w + rise / 12.0, half * (within + w), 2.0 * half, rise


def sinking(c: Constants, state: Array, h: float) -> float:
    """Return how far the indenter could sink in a step without a foundation, at any θ from 1/2 to 1."""
    if math.isinf(c.mass):
        return 0.0
    q = c.spring * h * h / c.mass
    pull = max(c.weight + c.spring * (c.depth - state[DEPTH]), 0.0)
    most = 1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)
    return float(h * max(state[RATE], 0.0) / (1.0 + 0.25 * q) + most * pull * h * h / c.mass)


class Step(NamedTuple):
    """A step of an implicit scheme: `place` of the base at its end, and how far it moved under the indenter.

    `begun` are the runs in contact at its start; `bends` say how the mean pressure of arms bends at their
    edges, `falling` whether the overlap falls at both sides of each strip, `late` are the elements that are
    entered within the step, (strip, element), and `lack` what they lack of their weight.
    """

    place: float
    travel: float
    first: float
    theta: float
    weights: Array
    begun: NDArray[np.int64]
    bends: Array
    falling: NDArray[np.bool_]
    late: NDArray[np.int64]
    lack: Array


def implicit_step(
    c: Constants, profile: Any, row: Row, law: StepLaw, begun: NDArray[np.int64], state: Array,
    now: float, Y: tuple[float, float],
) -> tuple[int, NDArray[np.int64]]:  # fmt: skip
    """Take a step in which the depth at its end is the root of the balance of momentum.

    On a spring, so is the place along x: for every place there is one depth. Return the status, and the
    runs in contact at the end.
    """
    h, sprung = law.h, math.isfinite(c.mass_along)
    depth, rate = state[DEPTH], state[RATE]
    along, along_rate = state[ALONG], state[ALONG_RATE]
    slid = h * along_rate / (1.0 + 0.25 * c.spring_along * h * h / c.mass_along)
    most = sinking(c, state, h)
    falling = np.zeros((row.u.shape[0], 3), dtype=np.bool_)
    sunk, new_rate, new_along_rate, tilt = 0.0, rate, along_rate, -1.0
    runs, place, travel = begun, 0.0, 0.0
    for _ in range(SLIDE_STEPS):
        place = Y[1] - (along + slid)
        travel = place - (Y[0] - along)
        sinks = min(most, ROOM * c.depth)
        while True:
            status = attend(c, profile, row, now, (place, place - travel), depth + sinks)
            if status != DONE:
                return status, begun
            _lay(c, profile, row, law, begun, place, travel, depth)
            first = min(h * rate, sinks)
            runs = begun.copy()
            for k in range(runs.shape[0]):  # none is outside but where a caller changed the depth
                low, high = row.low[runs[k, 0]] + UNMET, row.high[runs[k, 0]] - UNMET
                runs[k, 1], runs[k, 2] = (
                    min(max(runs[k, 1], low), high),
                    max(min(runs[k, 2], high), low),
                )
            sums = _sums(row, runs)
            runs, sums, _ = _walk(row, runs, sums, first)
            weights = _weights(c, profile, depth + 0.5 * h * rate, row.u.shape[0])
            late, lack = _late(c, profile, row, law, runs, weights, place - travel, depth, first)
            step = Step(place, travel, first, _theta(c, law, runs, begun, weights), weights, begun,
                        _bends(c, row, law, begun), falling, late, lack)  # fmt: skip
            runs, sums, sunk = _sink(c, profile, row, law, step, runs, sums, state)
            if not sunk > sinks or sinks == most:
                break
            # Elements may have been missed, without which it sinks too deep, never too little.
            sinks = min(most, MORE_ROOM * sinks)
            falling[:] = False
        if math.isfinite(c.mass):
            new_rate = _velocity(sunk, rate, h, step.theta)
        if not sprung:
            break
        if tilt < 0.0:
            tilt = _tilt(c, profile, row, step)
        before = slid
        slid, new_along_rate = _slide(c, profile, row, law, step, runs, state, sunk, slid, tilt)
        if not abs(slid - before) > SLIDE_RTOL * c.half_length:
            break
    settle(c, profile, row, law, place, travel, (depth, depth + sunk))
    state[DEPTH], state[RATE] = depth + sunk, new_rate
    if sprung:
        state[ALONG], state[ALONG_RATE] = along + slid, new_along_rate
    return DONE, runs[runs[:, 1] < runs[:, 2]]


def _lay(
    c: Constants, profile: Any, row: Row, law: StepLaw, begun: NDArray[np.int64], place: float, travel: float,
    depth: float,
) -> None:  # fmt: skip
    """Find how far the indenter must sink from `depth` to press each element at the end of the step.

    That is to where the mean pressure would vanish: where a free element is then, and above where one in
    contact is now.
    """
    for j in range(row.u.shape[0]):
        low, high = row.low[j], row.high[j]
        if low < high:
            x = positions(c, row, low, high, place)
            row.height[j, low:high] = height_at(c.surface, profile, x, j * c.across)
            row.rest[j, low:high] = _left(c, row, law, j, slice(low, high))
    if row.arms.shape[0]:
        for k in range(begun.shape[0]):
            j, low, high = begun[k, 0], begun[k, 1], begun[k, 2]
            p = c.law.stiffness * row.u[j, low:high]
            for i in range(row.arms.shape[0]):
                p += law.weights[i] * row.arms[i, j, low:high]
            row.rest[j, low:high] = row.u[j, low:high] - p / law.stiffness
    elif c.per_width:
        _pass_kinks(c, profile, row, law, place, travel, depth)
    for j in range(row.u.shape[0]):
        low, high = row.low[j], row.high[j]
        if low < high:
            row.meets[j, low:high] = row.height[j, low:high] + row.rest[j, low:high] - depth
            row.meets[j, low : low + UNMET] = math.inf
            row.meets[j, high - UNMET : high] = math.inf


def _pass_kinks(
    c: Constants, profile: Any, row: Row, law: StepLaw, place: float, travel: float, depth: float
) -> None:
    """Let elements that pass a kink of the shape in the step be pressed as far as it pressed them.

    What a damper has of that compression until the end of the step, g e^(-t/τ), is left, and so is its
    mean pressure; without this, a wedge stands on its tip at the first order in the spacing.
    """
    for kink in c.kinks:
        low, high = _passed(c, row, kink, place, travel)
        for i in range(low, high):
            x = c.spacing * (row.counts[FIRST] + i + c.shift) + place
            if (x - kink) * (x - travel - kink) < 0.0:
                tip = height_at(c.surface, profile, float(kink), 0.0)
                g = (depth - tip) * math.exp(-law.h * (x - kink) / travel * c.law.rates[0])
                row.height[0, i] = min(row.height[0, i], depth - g)


def _passed(c: Constants, row: Row, kink: float, place: float, travel: float) -> tuple[int, int]:
    """Return a range that holds all elements that pass a kink in a step."""
    start = (kink + min(travel, 0.0) - place) / c.spacing - row.counts[FIRST]
    stop = (kink + max(travel, 0.0) - place) / c.spacing - row.counts[FIRST]
    return max(math.floor(start) - 1, row.low[0]), min(math.ceil(stop) + 2, row.high[0])


def _sums(row: Row, runs: NDArray[np.int64]) -> Array:
    """Return the sum of `meets` over each run."""
    sums = np.zeros(runs.shape[0])
    for k in range(runs.shape[0]):
        sums[k] = row.meets[runs[k, 0], runs[k, 1] : runs[k, 2]].sum()
    return sums


def _walk(
    row: Row, runs: NDArray[np.int64], sums: Array, sunk: float
) -> tuple[NDArray[np.int64], Array, bool]:
    """Move the ends of runs to where elements begin and cease to be pressed; tell whether any moved.

    If runs met, or others appeared, they are all found anew.
    """
    meets, moved, count = row.meets, False, 0
    for k in range(runs.shape[0]):
        j, low, high, total = runs[k, 0], runs[k, 1], runs[k, 2], sums[k]
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
        moved = moved or low != runs[k, 1] or high != runs[k, 2]
        runs[k, 1], runs[k, 2], sums[k] = low, high, total
        count += high - low
    found = 0
    for j in range(row.u.shape[0]):
        low, high = row.low[j], row.high[j]
        row.pressed[j, low:high] = meets[j, low:high] <= sunk
        found += row.pressed[j, low:high].sum()
    if found == count:
        return runs, sums, moved
    runs = runs_of(row.pressed, row.low, row.high)
    return runs, _sums(row, runs), True


def _late(
    c: Constants, profile: Any, row: Row, law: StepLaw, runs: NDArray[np.int64], weights: Array, place: float,
    depth: float, first: float,
) -> tuple[NDArray[np.int64], Array]:  # fmt: skip
    """Return the elements that are entered within the step, and what they lack of their weight.

    Their arms are loaded for a part of it only.
    """
    late, lack = np.empty((0, 2), dtype=np.int64), np.empty(0)
    if not row.arms.shape[0]:
        return late, lack
    count = 0
    for fill in (False, True):
        if fill:
            late, lack, count = np.empty((count, 2), dtype=np.int64), np.empty(count), 0
        for k in range(runs.shape[0]):
            j, low = runs[k, 0], runs[k, 1]
            for i in np.flatnonzero(~row.touched[j, low : runs[k, 2]]):
                if fill:
                    rise = first - row.meets[j, low + i]
                    gap = gap_before(c, profile, row, j, low + i, place, depth)
                    share = rise / (rise - min(gap, 0.0))
                    _, phi_2 = ramp_functions(law.h * share / c.law.arm_time)
                    stiff = 0.5 * c.law.stiffness + (c.law.arm_stiffness * phi_2).sum()
                    late[count, 0], late[count, 1] = j, low + i
                    lack[count] = (1.0 - share * stiff / law.stiffness) * weights[j]
                count += 1
    return late, lack


def _extent(runs: NDArray[np.int64], weights: Array) -> float:
    total = 0.0
    for k in range(runs.shape[0]):
        total += weights[runs[k, 0]] * (runs[k, 2] - runs[k, 1])
    return total


def _theta(
    c: Constants, law: StepLaw, runs: NDArray[np.int64], begun: NDArray[np.int64], weights: Array
) -> float:
    if not c.fitted:
        return 1.0
    wide = max(_extent(runs, weights), _extent(begun, weights))
    return exponential_fit(law.h * law.damping * c.spacing * wide / c.mass)


def _bends(c: Constants, row: Row, law: StepLaw, begun: NDArray[np.int64]) -> Array:
    """Return by how much the mean force of arms bends at each edge of the runs."""
    bends = np.zeros((begun.shape[0], 2))
    if not row.arms.shape[0]:
        return bends
    for k in range(begun.shape[0]):
        for side in range(2):
            j, out = begun[k, 0], 1 - 2 * side
            inner = begun[k, 1] if side == 0 else begun[k, 2] - 1
            held = row.arms[:, j, inner + out] - row.arms[:, j, inner]
            free = row.arms[:, j, inner - out] - row.arms[:, j, inner - 2 * out]
            bends[k, side] = (law.weights * held).sum() - (law.free * free).sum()
    return bends


def _sink(
    c: Constants, profile: Any, row: Row, law: StepLaw, step: Step, runs: NDArray[np.int64], sums: Array,
    state: Array,
) -> tuple[NDArray[np.int64], Array, float]:  # fmt: skip
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for how far the indenter sinks.

    While no element is met or let go, F_z is of the second order in the depth: one step of Newton's
    method with the second derivative is exact.
    """
    h, theta, k, sunk = law.h, step.theta, law.stiffness * c.spacing, step.first
    if math.isinf(c.mass):
        return runs, sums, 0.0
    for _ in range(NEWTON_STEPS):
        width, area, bent = _extent(runs, step.weights), 0.0, 0.0
        for r in range(runs.shape[0]):
            area -= step.weights[runs[r, 0]] * sums[r]
        area += sunk * width
        for i in range(step.lack.size):
            overlap = sunk - row.meets[step.late[i, 0], step.late[i, 1]]
            if overlap > 0.0:
                area -= step.lack[i] * overlap
                width -= step.lack[i]
        if c.parts:
            added, wider, bent, _ = _kinks(c, profile, row, law, step, runs, sunk, state[DEPTH])
            area, width = area + added, width + wider
        mean = state[DEPTH] - c.depth + theta * sunk
        change_of_rate = _velocity(sunk, state[RATE], h, theta) - state[RATE]
        residual = c.mass * change_of_rate / h - c.weight + c.spring * mean + k * area
        slope = c.mass / (theta * h * h) + theta * c.spring + k * width
        root = math.sqrt(max(slope * slope - 2.0 * residual * k * bent, 0.0))
        sunk -= 2.0 * residual / (slope + root)
        runs, sums, moved = _walk(row, runs, sums, sunk)
        if not moved:
            break
    return runs, sums, sunk


def _kinks(
    c: Constants, profile: Any, row: Row, law: StepLaw, step: Step, runs: NDArray[np.int64], sunk: float,
    depth: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return the area of the kinks at edges by dx less what relaxed, its derivatives by depth, and its push.

    A kink of the surface, at an edge between two elements, adds to the area that is pressed. It counts
    where the edge stands or moves outward over the free surface, that is, where the overlap w = g - u
    just outside does not fall. Where the edge moves inward, the surface has no kink, or one that is left
    behind and relaxes like all that is free. Each side of each strip is asked for itself.
    """
    before, falling = step.place - step.travel, step.falling
    met = np.zeros(row.u.shape[0], dtype=np.bool_)
    known = falling[0, 2]  # decided once in a step, so that no iteration can go to and fro
    falling[0, 2] = True
    area = wider = bent = push = 0.0
    for r in range(runs.shape[0]):
        j, low, high = runs[r, 0], runs[r, 1], runs[r, 2]
        for side in range(2):
            if not known and low < high:
                i = low - 1 if side == 0 else high
                gap = gap_before(c, profile, row, j, i, before, depth)
                falls = sunk - row.meets[j, i] - gap < -STANDS * c.depth
                falling[j, side] = falls and (falling[j, side] or not met[j])
        met[j] = met[j] or low < high
    for r in range(runs.shape[0]):
        j, low, high = runs[r, 0], runs[r, 1], runs[r, 2]
        for side in range(2):
            if low < high and not falling[j, side]:
                i, out = (low - 1, -1) if side == 0 else (high, 1)
                w = (
                    sunk - row.meets[j, i],
                    sunk - row.meets[j, i + out],
                    sunk - row.meets[j, i + 2 * out],
                )
                added, more, bend, _ = kink_area(w)
                area += step.weights[j] * added
                wider += step.weights[j] * more
                bent += step.weights[j] * bend
                if row.slope.size:
                    push += step.weights[j] * added * row.slope[j, i - out]
    for r in range(step.begun.shape[0]):
        j, low, high = step.begun[r, 0], step.begun[r, 1], step.begun[r, 2]
        for side in range(2):
            if met[j] and not falling[j, side]:
                i, out = (low - 1, -1) if side == 0 else (high, 1)
                w = (gap_before(c, profile, row, j, i, before, depth),
                     gap_before(c, profile, row, j, i + out, before, depth),
                     gap_before(c, profile, row, j, i + 2 * out, before, depth))  # fmt: skip
                added, _, _, rise = kink_area(w)
                relaxed = (c.law.stiffness + step.bends[r, side] / rise) / law.stiffness - 1.0
                area += step.weights[j] * added * relaxed
                if row.slope.size:
                    push += step.weights[j] * added * relaxed * row.slope[j, i - out]
    return area, wider, bent, push


def _tilt(c: Constants, profile: Any, row: Row, step: Step) -> float:
    """Find h'(x) halfway through the step, and return dx Σ h'² over elements that are or may be pressed."""
    total = 0.0
    for j in range(row.u.shape[0]):
        low, high = row.low[j], row.high[j]
        if low < high:
            _incline(c, profile, row, j, step.place, step.travel)
            steep = row.slope[j, low:high] * row.slope[j, low:high]
            held = (row.meets[j, low:high] < step.first) | row.touched[j, low:high]
            total += step.weights[j] * (steep * held).sum()
    return c.spacing * total


def _incline(c: Constants, profile: Any, row: Row, j: int, place: float, travel: float) -> None:
    """Find h'(x) of a strip halfway through the step; of elements that pass a kink, before it."""
    low, high, y = row.low[j], row.high[j], j * c.across
    x = positions(c, row, low, high, place - 0.5 * travel)
    row.slope[j, low:high] = slope_at(c.surface, profile, x, y)
    if c.per_width and c.law.damping:
        for kink in c.kinks:
            start, stop = _passed(c, row, kink, place, travel)
            for i in range(start, stop):
                x_i = c.spacing * (row.counts[FIRST] + i + c.shift) + place
                if (x_i - kink) * (x_i - travel - kink) < 0.0:
                    row.slope[j, i] = slope_at(c.surface, profile, x_i - travel, y)


def _slide(
    c: Constants, profile: Any, row: Row, law: StepLaw, step: Step, runs: NDArray[np.int64], state: Array,
    sunk: float, slid: float, tilt: float,
) -> tuple[float, float]:  # fmt: skip
    """Take a step of Newton's method to M_x (v_1 - v_0)/h = F_x - c_x (x_1 - x_0)/h - k_x x.

    An element pushes along x with its pressure times the slope halfway through the step, so that the
    mean forces do the very work by which elements of a parabola are compressed.
    """
    h, M_x, c_x, k_x = law.h, c.mass_along, c.damping_along, c.spring_along
    k, width, inclined, tilted, area = law.stiffness * c.spacing, 0.0, 0.0, 0.0, 0.0
    for j in range(row.u.shape[0]):
        if row.low[j] < row.high[j]:
            _incline(c, profile, row, j, step.place, step.travel)
    for r in range(runs.shape[0]):
        j, weight = runs[r, 0], step.weights[runs[r, 0]]
        slope = row.slope[j, runs[r, 1] : runs[r, 2]]
        width += weight * slope.size
        inclined += weight * slope.sum()
        tilted += weight * np.dot(slope, slope)
        area -= weight * np.dot(slope, row.meets[j, runs[r, 1] : runs[r, 2]])
    area += sunk * inclined
    for i in range(step.lack.size):
        j, e = step.late[i, 0], step.late[i, 1]
        area -= step.lack[i] * max(sunk - row.meets[j, e], 0.0) * row.slope[j, e]
    if c.parts:
        area += _kinks(c, profile, row, law, step, runs, sunk, state[DEPTH])[3]
    # A ringing too fast for the step is damped; θ - 1/2 is of the third order in h, as on arms.
    swing = h * math.sqrt(k_x / M_x)
    z = h * (c_x + law.damping * tilt) / M_x + swing * swing * swing
    theta = exponential_fit(z) if c.fitted else 1.0
    change_of_rate = _velocity(slid, state[ALONG_RATE], h, theta) - state[ALONG_RATE]
    held = c_x * slid / h + k_x * (state[ALONG] + theta * slid)
    residual = M_x * change_of_rate / h + held + k * area
    # As the foundation gives way along x, the depth changes, too.
    normal = c.mass / (h * h) + c.spring + k * width
    stiff = k * tilted - (k * inclined) * (k * inclined) / normal
    slid -= residual / (M_x / (theta * h * h) + c_x / h + theta * k_x + stiff)
    return slid, _velocity(slid, state[ALONG_RATE], h, theta)


# Explicit schemes


def explicit_step(
    c: Constants, profile: Any, row: Row, laws: tuple[StepLaw, StepLaw, StepLaw], state: Array, now: float,
    Y: Array, V: Array,
) -> int:  # fmt: skip
    """Take a step of Runge and Kutta; which elements are in contact is settled at its end.

    `laws` are those of no time, half the step and all of it; Y and V are at these times, V just before the
    end. F_z = dx Σ (K g + C g'). An element in contact detaches where its pressure would be negative, relaxes
    as e^(-t/τ), and is in contact again where the indenter meets it (Eqs. 20-25). Arms are loaded along a
    straight line from the start of the step to each stage, which leaves the order two.
    """
    h, M, M_x = laws[2].h, c.mass, c.mass_along
    stages, begin = c.tableau.shape[0] - 1, Y[0] - state[ALONG]
    pulls, drags = np.zeros(stages + 1), np.zeros(stages + 1)
    rates, slides = np.zeros(stages + 1), np.zeros(stages + 1)
    depth = along = 0.0
    moves = math.isfinite(M) or math.isfinite(M_x)
    for i in range(stages + 1):
        share = c.tableau[i, 0] if i < stages else 1.0
        depth, rate, along, along_rate = state[DEPTH], state[RATE], state[ALONG], state[ALONG_RATE]
        for k in range(i):
            part = h * c.tableau[i, k + 1]
            depth += part * rates[k]
            rate += part * pulls[k] / M
            along += part * slides[k]
            along_rate += part * drags[k] / M_x
        rates[i], slides[i] = rate, along_rate
        if moves or i == stages:
            n = int(2.0 * share)
            status = _press(c, profile, row, laws[n], state, (depth, rate, along, along_rate), now,
                            (begin, Y[n] - along), V[n], 0.0 < share and i < stages)  # fmt: skip
            if status != DONE:
                return status
            pulls[i], drags[i] = _pull(c, profile, row, depth, along, along_rate)
    settle(c, profile, row, laws[2], Y[2] - along, Y[2] - along - begin, (state[DEPTH], depth))
    state[DEPTH], state[RATE] = depth, rates[stages]
    state[ALONG], state[ALONG_RATE] = along, slides[stages]
    if math.isfinite(M):
        mean = 0.0
        for k in range(stages):
            mean += c.tableau[stages, k + 1] * pulls[k]
        state[IMBALANCE] = abs(mean - 0.5 * (pulls[0] + pulls[stages]))
        state[FORCE] = c.weight + max(abs(pulls[0]), abs(pulls[stages]))
    return DONE


def _press(
    c: Constants, profile: Any, row: Row, law: StepLaw, state: Array, at: tuple[float, float, float, float],
    now: float, places: tuple[float, float], velocity: float, within: bool,
) -> int:  # fmt: skip
    """Find which elements press at a stage, with what pressure (`rest`), and the slope there."""
    place = places[0] if within and c.rule.still else places[1]
    status = attend(c, profile, row, now, (places[0], place), max(at[0], state[DEPTH]))
    if status != DONE:
        return status
    V = velocity - at[3]
    for j in range(row.u.shape[0]):
        low, high, y = row.low[j], row.high[j], j * c.across
        if low == high:
            continue
        x, u, touched = (
            positions(c, row, low, high, place),
            row.u[j, low:high],
            row.touched[j, low:high],
        )
        height, slope = height_at(c.surface, profile, x, y), slope_at(c.surface, profile, x, y)
        g, left = at[0] - height, _left(c, row, law, j, slice(low, high))
        p = c.law.stiffness * g + c.law.damping * (at[1] - V * slope)
        for k in range(row.arms.shape[0]):
            p += np.where(
                touched, law.held[k] * row.arms[k, j, low:high] + law.ramp[k] * (g - u), 0.0
            )
        if row.arms.shape[0]:
            for i in np.flatnonzero((g > left) & ~touched):
                gap = gap_before(c, profile, row, j, low + i, places[0], state[DEPTH])
                rise = g[i] - left[i]
                phi_1, _ = ramp_functions(law.h * rise / (rise - min(gap, 0.0)) / c.law.arm_time)
                p[i] += rise * (c.law.arm_stiffness * phi_1).sum() - c.law.stiffness * left[i]
        if c.rule.remembers:
            free = u if c.rule.stale and within else left
            met = touched | (g > free) if c.rule.flags else g >= free * (1.0 - TIE)
            pressed = met & ((g > 0.0) if c.rule.pulls else (p >= 0.0))
        else:
            pressed = (g > 0.0) & (p >= 0.0)
        row.height[j, low:high], row.slope[j, low:high] = height, slope
        row.rest[j, low:high], row.pressed[j, low:high] = p, pressed
    return DONE


def _pull(
    c: Constants, profile: Any, row: Row, depth: float, along: float, along_rate: float
) -> tuple[float, float]:
    """Return M δ'' and M_x x'' (Eq. 17)."""
    pull = c.weight - c.spring * (depth - c.depth)
    drag = -c.spring_along * along - c.damping_along * along_rate
    weights = _weights(c, profile, depth, row.u.shape[0])
    for j in range(row.u.shape[0]):
        low, high = row.low[j], row.high[j]
        if low < high:
            each = np.where(row.pressed[j, low:high], row.rest[j, low:high], 0.0)
            pull -= c.spacing * weights[j] * each.sum()
            drag -= c.spacing * weights[j] * np.dot(row.slope[j, low:high], each)
    return pull, drag


# Forces and edges at an instant


def report(
    c: Constants, profile: Any, row: Row, state: Array, now: float, about: Array, found: Array
) -> int:
    """Put what is reported at an instant into `found`, in the order of `error_estimate.COLUMNS`.

    `about` is (time, V, V just before it, whether the base moves or moved last with V >= 0, Y). An element is
    in contact if the indenter touches its surface and its pressure p >= 0 (Eq. 24).
    """
    time, V, V_before, forward, Y = about
    depth, place = state[DEPTH], Y - state[ALONG]
    status = attend(c, profile, row, now, (place, place), depth)
    if status != DONE:
        return status
    sliding, before = V - state[ALONG_RATE], V_before - state[ALONG_RATE]
    weights = _weights(c, profile, depth, row.u.shape[0])
    force = push = 0.0
    left = right = math.nan
    peak, at_edge = (-math.inf, 0.0, 0.0), (-math.inf, 0.0, 0.0)
    highest = -math.inf
    for j in range(row.u.shape[0]):
        low, high = row.low[j], row.high[j]
        if low == high:
            continue
        touched = row.touched[j, low:high]
        p, slope = _pressure(c, profile, row, state, j, place, sliding)
        p_before = (
            p if before == sliding else _pressure(c, profile, row, state, j, place, before)[0]
        )
        flags = (touched & ((p >= 0.0) | c.rule.pulls)).reshape(1, -1)
        runs = runs_of(flags, np.zeros(1, np.int64), np.full(1, high - low))
        for k in range(runs.shape[0]):
            start, stop = runs[k, 1], runs[k, 2]
            p_in = p[start:stop]
            sums, pushed = p_in.sum(), 0.0
            ends, reach = (0.0, 0.0), (1.0, 1.0)
            top = start + np.argmax(p_in)
            if c.parts:
                pushed = np.dot(p_in, slope[start:stop])
                for side in range(2):
                    i = start if side == 0 else stop - 1
                    share, p_edge, x = _edge(
                        c, profile, row, j, low, i, p, p_before, depth, place, side
                    )
                    steep = slope_at(
                        c.surface, profile, x - NEAR * c.spacing * (2 * side - 1), j * c.across
                    )
                    sums += 0.5 * (share * (p[i] + p_edge) - p[i])
                    pushed += 0.5 * (share * (slope[i] * p[i] + steep * p_edge) - slope[i] * p[i])
                    ends = (x, ends[1]) if side == 0 else (ends[0], x)
                    if i == top:
                        reach = (share, reach[1]) if side == 0 else (reach[0], share)
                    if p_edge > at_edge[0]:
                        out = i + 2 * side - 1
                        at_edge = p_edge, 0.0, abs(p[i] - p[out])
                if c.per_width:
                    more = _split(
                        c, profile, p, (start, stop), row.counts[FIRST] + low, place, sliding
                    )
                    sums, pushed = sums + more[0], pushed + more[1]
            else:
                x = positions(c, row, low + start, low + stop, place)
                pushed = np.dot(p_in, slope_at(c.surface, profile, x, j * c.across))
                ends = x[0] - 0.5 * c.spacing, x[-1] + 0.5 * c.spacing
            force += weights[j] * sums
            push += weights[j] * pushed
            if j == 0:
                left = ends[0] if math.isnan(left) else left
                right = ends[1]
            if p[top] > highest:
                highest = p[top]
                peak = _peak(c, p, top, reach, flags[0]) if c.parts else (highest, 0.0, 0.0)
    if highest == -math.inf:
        peak = (0.0, 0.0, 0.0)
    elif at_edge[0] > peak[0]:
        peak = at_edge
    if state[ALONG_RATE] and abs(sliding) > AT_REST * c.at_rest_velocity:
        forward = 1.0 if sliding > 0.0 else 0.0
    held = c.spring_along * state[ALONG] + c.damping_along * state[ALONG_RATE]
    found[:] = np.array([
        time, V, depth, state[RATE], c.spacing * force, -c.spacing * push,
        left if forward else right, right if forward else left,
        peak[0], sliding, held, peak[1], peak[2],
    ])  # fmt: skip
    return DONE


def _behind(c: Constants, V: float) -> float:
    """Return how far back the slope is taken: an element on a kink is still on the flank before it."""
    return math.copysign(NEAR * c.spacing, V) if c.kinks.size and V else 0.0


def _pressure(
    c: Constants, profile: Any, row: Row, state: Array, j: int, place: float, V: float
) -> tuple[Array, Array]:
    """Return p of the elements of a strip, g = δ - h(x), g' = δ' - V h'(x) (Eqs. 6, 7, 12), and the slope.

    Of one that is not in contact, it is what it would be had it followed the indenter in the last step: it
    is brought down by the gap at the start of that time, and then moves with the indenter.
    """
    low, high, y = row.low[j], row.high[j], j * c.across
    x, u = positions(c, row, low, high, place), row.u[j, low:high]
    slope = slope_at(c.surface, profile, x - _behind(c, V), y)
    g = state[DEPTH] - height_at(c.surface, profile, x, y)
    g_rate = state[RATE] - V * slope
    p = c.law.stiffness * g + c.law.damping * g_rate
    if row.arms.shape[0]:
        z = state[LAST] / c.law.arm_time
        brought = (c.law.arm_stiffness * np.exp(-z)).sum()
        moved = (c.law.arm_stiffness * ramp_functions(z)[0]).sum()
        free = brought * (g - u) + (moved - brought) * state[LAST] * g_rate - c.law.stiffness * u
        arms = np.zeros(high - low)
        for k in range(row.arms.shape[0]):
            arms += row.arms[k, j, low:high]
        p += np.where(row.touched[j, low:high], arms, free)
    return p, slope


def _edge(
    c: Constants, profile: Any, row: Row, j: int, low: int, i: int, p: Array, p_before: Array, depth: float,
    place: float, side: int,
) -> tuple[float, float, float]:  # fmt: skip
    """Return how far outward of its last element i a run ends, of the spacing, p and x there.

    An edge peels where p falls to zero, between two elements by a straight line, and touches where
    the indenter meets the free surface. Where V jumps, an edge that peeled until then, by the pressure
    before, `p_before`, is still where it was, or has gone further in.
    """
    out = 2 * side - 1
    now = _peeling(p[i], p[i + out])
    before = _peeling(p_before[i], p_before[i + out])
    w = (gap_before(c, profile, row, j, low + i + out, place, depth),
         gap_before(c, profile, row, j, low + i + 2 * out, place, depth),
         gap_before(c, profile, row, j, low + i + 3 * out, place, depth))  # fmt: skip
    if math.isinf(before) or straight(w):
        before = 1.0 if row.touched[j, low + i + out] else 1.0 - touching(w)
    share = min(before, now, 1.0)
    p_edge = 0.0 if now <= share else p[i] + share * (p[i + out] - p[i])
    x = c.spacing * (row.counts[FIRST] + low + i + c.shift) + place
    if c.per_width:
        for kink in c.kinks:
            # There p falls at once, by -C V times the jump of h'.
            ahead = (kink - x) / c.spacing * out
            p_kink = p[i] + ahead * (p[i] - p[i - out])
            if -NEAR <= ahead < min(before, 1.0) and p[i + out] < 0.0 and p_kink > 0.0:
                share, p_edge = ahead, p_kink
    return share, p_edge, x + share * c.spacing * out


def _peeling(inside: float, outside: float) -> float:
    """Return how far outward of the last element the pressure vanishes; infinite if it does not."""
    return max(inside, 0.0) / (max(inside, 0.0) - outside) if outside < 0.0 else math.inf


def touching(overlap: tuple[float, float, float]) -> float:
    """Return how far inward of the first element outside w = 0 is, from 0 to 1 element.

    w is that of the three nearest elements outside, and continued as their parabola.
    """
    w, slope, bend = _parabola(overlap)
    fall = slope + math.sqrt(max(slope * slope - 2.0 * w * bend, 0.0))
    return min(max(-2.0 * w / fall, 0.0), 1.0) if fall else 1.0


def straight(overlap: tuple[float, float, float]) -> bool:
    """Whether w falls to the edge in a straight line, as on free ground, or as a square, where it peeled.

    >>> straight((-0.5, -1.5, -2.5)), straight((-0.25, -2.25, -6.25))
    (True, False)
    """
    w, slope, bend = _parabola(overlap)
    return slope * slope - 2.0 * w * bend > STRAIGHT * slope * slope


def _parabola(overlap: tuple[float, float, float]) -> tuple[float, float, float]:
    w, far, farthest = overlap
    return w, 1.5 * w - 2.0 * far + 0.5 * farthest, w - 2.0 * far + farthest


def _split(
    c: Constants, profile: Any, p: Array, run: tuple[int, int], first: int, place: float, V: float
) -> tuple[float, float]:
    """Split the element in which a kink of the shape is: h' jumps there, and p by -C V times as much.

    Without this, the forces under a wedge are of the first order in the spacing.
    """
    force = push = 0.0
    for kink in c.kinks:
        x_0 = c.spacing * (first + c.shift) + place
        k = round((kink - x_0) / c.spacing)
        if not run[0] < k < run[1] - 1:
            continue
        x = x_0 + k * c.spacing
        here = slope_at(c.surface, profile, x - _behind(c, V), 0.0)
        back = slope_at(c.surface, profile, kink - NEAR * c.spacing, 0.0)
        ahead = slope_at(c.surface, profile, kink + NEAR * c.spacing, 0.0)
        p_back, p_ahead = (
            p[k] - c.law.damping * V * (back - here),
            p[k] - c.law.damping * V * (ahead - here),
        )
        share = (kink - x) / c.spacing + 0.5
        if p_back >= 0.0 and p_ahead >= 0.0:
            force += share * p_back + (1.0 - share) * p_ahead - p[k]
            push += share * p_back * back + (1.0 - share) * p_ahead * ahead - p[k] * here
    return force, push


def _peak(
    c: Constants, p: Array, k: int, reach: tuple[float, float], pressed: NDArray[np.bool_]
) -> tuple[float, float, float]:
    """Return the peak near element k, of the parabola through three, and both doubts.

    A shape with kinks has no such parabola: there the peak is known to the next element. Arms remember
    where contact began, so that the pressure itself may have a kink between two elements.
    """
    before, here, after = p[k - 1], p[k], p[k + 1]
    doubt = 0.5 * max(here - before, here - after) if c.law.arm_time.size else 0.0
    if c.kinks.size:
        return here, min(abs(here - before), abs(here - after)), 0.0
    bend = 2.0 * here - before - after
    if not (here >= before and here >= after and bend > 0.0):
        return here, 0.0, 0.0
    if doubt and pressed[k - 3 : k + 4].all():
        smooth, ridge = _smooth(p[k - 3 : k + 4]), _ridge(p[k - 3 : k + 4])
        best = smooth if smooth[1] <= ridge[1] else ridge
        return best[0], best[1], 0.0
    ahead = 0.5 * (after - before) / bend
    if abs(ahead) > reach[1 if ahead > 0.0 else 0]:
        return here, doubt, 0.0
    return here + 0.25 * (after - before) * ahead, doubt, 0.0


def _smooth(p: Array) -> tuple[float, float]:
    """Return the peak of the parabola through the middle three of seven pressures, and its doubt.

    A kink beside the middle adds to one or two of the second differences at the middle three.
    """
    peak = p[3] + 0.125 * (p[4] - p[2]) * (p[4] - p[2]) / (2.0 * p[3] - p[2] - p[4])
    bends = p[1:4] - 2.0 * p[2:5] + p[3:6]
    return peak, 0.5 * (bends.max() - bends.min())


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

    `times` are those before the first step and after each; `steps` their lengths; `Y` and `V` are at the start
    of each, halfway and at its end, V just before that. `after` says after which step an instant is
    reported, `about` what `report` wants to know of it. `limits` are the speeds, upward and along, that no
    stable run reaches, and the imbalance of the forces that it stays below.
    """

    times: Array
    steps: Array
    Y: Array
    V: Array
    after: NDArray[np.int64]
    about: Array
    limits: Array


def advance(
    c: Constants, profile: Any, row: Row, state: Array, course: Course, balances: Array, found: Array,
    step: int, reported: int, until: int,
) -> tuple[int, int, int]:  # fmt: skip
    """Run from a step on; return why it ended, the steps done and the instants reported."""
    law = half = none = law_of(c.law, 0.0)
    begun = runs_of(row.touched, row.low, row.high)
    while True:
        while reported < course.after.size and course.after[reported] == step:
            about, now = course.about[reported], course.times[step]
            status = report(c, profile, row, state, now, about, found[reported])
            if status != DONE:
                return status, step, reported
            reported += 1
        if step == until:
            return DONE, step, reported
        h, now = course.steps[step], course.times[step]
        if h != law.h:
            law = law_of(c.law, h)
            if c.explicit:
                half = law_of(c.law, 0.5 * h)
        if c.explicit:
            Y, V = course.Y[step], course.V[step]
            status = explicit_step(c, profile, row, (none, half, law), state, now, Y, V)
        else:
            Y_ends = course.Y[step, 0], course.Y[step, 2]
            status, begun = implicit_step(c, profile, row, law, begun, state, now, Y_ends)
        if status != DONE:
            return status, step, reported
        state[LAST] = h
        balances[0, step % WINDOW], balances[1, step % WINDOW] = state[IMBALANCE], state[FORCE]
        step += 1
        status = _watch(c, state, course.limits, balances)
        if status != DONE:
            return status, step, reported


def _watch(c: Constants, state: Array, limits: Array, balances: Array) -> int:
    """Tell whether the last step shows that the run is unstable.

    No element pulls, p >= 0, so that an indenter in contact rises at most with g/τ - V h'; beyond that
    it has left the foundation, and only a spring can lift it faster. But an unstable step does not
    always throw it off: when the contact gives way, the oscillation may settle at some amplitude, or
    on a wrong state at rest, with forces that do not balance the motion. So the balance over each
    step, M δ'' = W - k_s (δ - δ_0) - F_z, is checked too.
    """
    if not state[RATE] >= limits[0]:  # NaN is not above it either
        return THROWN_UP
    if not abs(state[ALONG_RATE]) <= limits[1]:
        return THROWN_ALONG
    if c.explicit and balances[1].min() > 0.0 and balances[0].sum() > limits[2] * balances[1].sum():
        return UNBALANCED
    return DONE
