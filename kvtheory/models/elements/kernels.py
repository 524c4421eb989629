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
"""The indenter: depth and rate, the same along x, two forces to judge an explicit step by, its last step."""
FIRST, LOW, HIGH, STRIPS, UPDATES = range(5)
"""Counts: the first element, the elements that are lacking, strips near the indenter, updates of elements."""
DONE, LACKING, OUTGROWN, THROWN_UP, THROWN_ALONG, UNBALANCED = range(6)
"""How a run ended, or why it paused."""

FAR = 1e300
"""The height beyond the reach of a shape: no indenter is that deep."""
SPARE, UNMET = 7, 3
"""Elements beyond those that can be met: the surface is extended from three, and three more never are met."""
SMALL_FIT, SMALL_RAMP = 1e-2, 2e-2
"""Below these, θ(z) and the mean of a ramp are taken from series, where the closed forms would cancel."""
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


class Elements(NamedTuple):
    """The stored elements, and what stays as it is in a run, in SI; symbols as in `Model` and `Law`.

    Arrays over strips and elements: `u` is the compression; of an element in contact, which is `touched`,
    `arms` are the forces s_i of its arms, of a free one its modes. Those of a strip from `low` to `high` are
    near the indenter and up to date; a free one elsewhere is as it was at the time `since`. With arms, and by
    explicit schemes, an element may stay in contact above the plane z = 0: all that are in contact are then
    from `first` to before `last`. `rest`, `height`, `meets`, `slope` and `pressed` are work space of a step.
    `numbers` holds i + shift of the elements of a strip.
    """

    u: Array
    arms: Array
    since: Array
    touched: NDArray[np.bool_]
    low: NDArray[np.int64]
    high: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    counts: NDArray[np.int64]
    rest: Array
    height: Array
    meets: Array
    slope: Array
    pressed: NDArray[np.bool_]
    numbers: Array
    surface: Surface
    profile: Any
    law: Law
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
        return r * r * (0.5 / s.size)
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
        return r * (1.0 / s.size)
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


def _weights(e: Elements, depth: float, strips: int) -> Array:
    """Return by what the force of each strip counts: 1, or its width in m."""
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
        _relax(e, j, low, min(before, high), now)
        _relax(e, j, max(after, low), high, now)
        e.low[j], e.high[j] = low, high
    e.counts[STRIPS] = strips
    return DONE


def _relax(e: Elements, j: int, low: int, high: int, now: float) -> None:
    """Bring free elements up to date that were left alone for a while."""
    if low >= high:
        return
    past, u = now - e.since[j, low:high], e.u[j, low:high]
    if not e.arms.shape[0]:
        u *= np.exp(-e.law.rates[0] * past)
        return
    u[:] = 0.0
    for k in range(e.arms.shape[0]):
        e.arms[k, j, low:high] *= np.exp(-e.law.rates[k] * past)
        u += e.law.shares[k] * e.arms[k, j, low:high]


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


def _left(e: Elements, law: StepLaw, j: int, i: Any) -> Any:
    """Return u of elements at the end of a step, had they been left alone from its start."""
    if not e.arms.shape[0]:
        return law.fall[0] * e.u[j, i]
    left = (e.law.shares[0] * law.fall[0]) * e.arms[0, j, i]
    for k in range(1, e.arms.shape[0]):
        left = left + (e.law.shares[k] * law.fall[k]) * e.arms[k, j, i]
    return left


def _release(e: Elements, j: int, i: int) -> None:
    """Take an element out of contact: its arms become modes."""
    y = e.u[j, i] - e.arms[:, j, i] / e.law.arm_stiffness
    for k in range(y.size):
        e.arms[k, j, i] = (e.law.to_modes[k] * y).sum()


def _enter(e: Elements, j: int, i: int, within: float, rise: float) -> None:
    """Take a free element into contact: its modes become arms, which are then loaded within the step."""
    modes = e.arms[:, j, i].copy()
    u = (e.law.shares * modes).sum()
    phi_1, _ = ramp_functions(within / e.law.arm_time)
    for k in range(modes.size):
        y = (e.law.from_modes[k] * modes).sum()
        e.arms[k, j, i] = e.law.arm_stiffness[k] * (u - y + phi_1[k] * rise)


def settle(e: Elements, law: StepLaw, before: float, depths: tuple[float, float]) -> None:
    """Let a step pass: `pressed` elements end where the indenter is, all others were left alone.

    `before` is where the base was under the indenter at its start.
    """
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        u, pressed, touched = e.u[j, low:high], e.pressed[j, low:high], e.touched[j, low:high]
        g = depths[1] - e.height[j, low:high]
        if not e.arms.shape[0]:
            u[:] = np.where(pressed, g, law.fall[0] * u)
        else:
            for i in np.flatnonzero(touched & ~pressed):
                _release(e, j, low + i)
            new = np.flatnonzero(pressed & ~touched)
            gaps = np.empty(new.size)
            for k in range(new.size):
                gaps[k] = gap_before(e, j, low + new[k], before, depths[0])
            kept = touched & pressed
            left = np.zeros(high - low)
            for k in range(e.arms.shape[0]):
                arm = e.arms[k, j, low:high]
                arm[:] = np.where(
                    kept, law.held[k] * arm + law.ramp[k] * (g - u), law.fall[k] * arm
                )
                left += e.law.shares[k] * arm
            for k in range(new.size):
                rise = g[new[k]] - left[new[k]]
                within = law.h * rise / (rise - min(gaps[k], 0.0)) if rise > 0.0 else 0.0
                _enter(e, j, low + new[k], within, rise)
            u[:] = np.where(pressed, g, left)
        touched[:] = pressed
        if e.explicit or e.arms.shape[0]:
            inside = low + np.flatnonzero(pressed)
            e.first[j], e.last[j] = (inside[0], inside[-1] + 1) if inside.size else (0, 0)


def gap_before(e: Elements, j: int, i: int, place: float, depth: float) -> float:
    """Return how far the indenter was below an element at the start of a step."""
    x = e.spacing * e.numbers[i] + place
    return depth - height_at(e.surface, e.profile, x, j * e.across) - e.u[j, i]


def positions(e: Elements, low: int, high: int, place: float) -> Array:
    """Return x of elements when the base has moved by `place` under the indenter."""
    x: Array = e.spacing * e.numbers[low:high] + place
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


def sinking(e: Elements, state: Array, h: float) -> float:
    """Return how far the indenter could sink in a step without a foundation, at any θ from 1/2 to 1."""
    if math.isinf(e.mass):
        return 0.0
    q = e.spring * h * h / e.mass
    pull = max(e.weight + e.spring * (e.depth - state[DEPTH]), 0.0)
    most = 1.0 / (1.0 + q) if q < 1.0 else 0.5 / math.sqrt(q)
    return float(h * max(state[RATE], 0.0) / (1.0 + 0.25 * q) + most * pull * h * h / e.mass)


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
    e: Elements, law: StepLaw, begun: NDArray[np.int64], state: Array,
    now: float, Y: tuple[float, float],
) -> tuple[int, NDArray[np.int64]]:  # fmt: skip
    """Take a step in which the depth at its end is the root of the balance of momentum.

    On a spring, so is the place along x: for every place there is one depth. Return the status, and the
    runs in contact at the end.
    """
    h, sprung = law.h, math.isfinite(e.mass_along)
    depth, rate = state[DEPTH], state[RATE]
    along, along_rate = state[ALONG], state[ALONG_RATE]
    slid = h * along_rate / (1.0 + 0.25 * e.spring_along * h * h / e.mass_along)
    most = sinking(e, state, h)
    falling = np.zeros((e.u.shape[0], 3), dtype=np.bool_)
    sunk, new_rate, new_along_rate = 0.0, rate, along_rate
    runs, place, travel = begun, 0.0, 0.0
    for _ in range(SLIDE_STEPS):
        place = Y[1] - (along + slid)
        travel = place - (Y[0] - along)
        sinks = min(most, ROOM * e.depth)
        while True:
            status = attend(e, now, (place, place - travel), depth + sinks)
            if status != DONE:
                return status, begun
            _lay(e, law, begun, place, travel, depth)
            first = min(h * rate, sinks)
            runs = begun.copy()
            for k in range(runs.shape[0]):  # none is outside but where a caller changed the depth
                low, high = e.low[runs[k, 0]] + UNMET, e.high[runs[k, 0]] - UNMET
                runs[k, 1], runs[k, 2] = (
                    min(max(runs[k, 1], low), high),
                    max(min(runs[k, 2], high), low),
                )
            runs, sums, _ = _walk(e, runs, _sums(e, runs), first)
            weights = _weights(e, depth + 0.5 * h * rate, e.u.shape[0])
            late, lack = _late(e, law, runs, weights, place - travel, depth, first)
            wide = e.spacing * max(_extent(runs, weights), _extent(begun, weights))
            theta = exponential_fit(h * law.damping * wide / e.mass) if e.fitted else 1.0
            step = Step(
                place,
                travel,
                first,
                theta,
                weights,
                begun,
                _bends(e, law, begun),
                falling,
                late,
                lack,
            )
            runs, sums, sunk = _sink(e, law, step, runs, sums, state)
            if not sunk > sinks or sinks == most:
                break
            # Elements may have been missed, without which it sinks too deep, never too little.
            sinks = min(most, MORE_ROOM * sinks)
            falling[:] = False
        if math.isfinite(e.mass):
            new_rate = _velocity(sunk, rate, h, step.theta)
        if not sprung:
            break
        before = slid
        slid, new_along_rate = _slide(e, law, step, runs, state, sunk, slid)
        if not abs(slid - before) > SLIDE_RTOL * e.half_length:
            break
    for j in range(e.counts[STRIPS]):
        e.pressed[j, e.low[j] : e.high[j]] = False
    for k in range(runs.shape[0]):
        e.pressed[runs[k, 0], runs[k, 1] : runs[k, 2]] = True
    settle(e, law, place - travel, (depth, depth + sunk))
    state[DEPTH], state[RATE] = depth + sunk, new_rate
    if sprung:
        state[ALONG], state[ALONG_RATE] = along + slid, new_along_rate
    return DONE, runs[runs[:, 1] < runs[:, 2]]


def _lay(
    e: Elements, law: StepLaw, begun: NDArray[np.int64], place: float, travel: float,
    depth: float,
) -> None:  # fmt: skip
    """Find how far the indenter must sink from `depth` to press each element at the end of the step.

    That is to where the mean pressure would vanish: where a free element is then, and above where one in
    contact is now. An element that passes a kink of the shape is pressed as far as that pressed it.
    """
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        x = positions(e, low, high, place)
        e.height[j, low:high] = height_at(e.surface, e.profile, x, j * e.across)
        e.rest[j, low:high] = _left(e, law, j, slice(low, high))
    if e.arms.shape[0]:
        for k in range(begun.shape[0]):
            j, low, high = begun[k, 0], begun[k, 1], begun[k, 2]
            p = e.law.stiffness * e.u[j, low:high]
            for i in range(e.arms.shape[0]):
                p += law.weights[i] * e.arms[i, j, low:high]
            e.rest[j, low:high] = e.u[j, low:high] - p / law.stiffness
    elif e.per_width:
        for kink in e.kinks:
            # What a damper has of the compression by the tip is left at the end of the step, and so is its
            # mean pressure; without this, a wedge stands on its tip at the first order in the spacing.
            for i in _passed(e, kink, place, travel):
                since = law.h * (positions(e, i, i + 1, place)[0] - kink) / travel
                g = depth - height_at(e.surface, e.profile, float(kink), 0.0)
                pressed = depth - g * math.exp(-since * e.law.rates[0])
                e.height[0, i] = min(e.height[0, i], pressed)
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        e.meets[j, low:high] = e.height[j, low:high] + e.rest[j, low:high] - depth
        e.meets[j, low : low + UNMET] = math.inf
        e.meets[j, high - UNMET : high] = math.inf


def _passed(e: Elements, kink: float, place: float, travel: float) -> NDArray[np.int64]:
    """Return the elements that pass a kink of the shape in a step."""
    x = positions(e, e.low[0], e.high[0], place) - kink
    return e.low[0] + np.flatnonzero(x * (x - travel) < 0.0)


def _sums(e: Elements, runs: NDArray[np.int64]) -> Array:
    """Return the sum of `meets` over each run."""
    sums = np.zeros(runs.shape[0])
    for k in range(runs.shape[0]):
        sums[k] = e.meets[runs[k, 0], runs[k, 1] : runs[k, 2]].sum()
    return sums


def _walk(
    e: Elements, runs: NDArray[np.int64], sums: Array, sunk: float
) -> tuple[NDArray[np.int64], Array, bool]:
    """Move the ends of runs to where elements begin and cease to be pressed; tell whether any moved.

    If runs met, or others appeared, they are all found anew.
    """
    meets, moved, count = e.meets, False, 0
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
    for j in range(e.counts[STRIPS]):
        found += int(np.count_nonzero(meets[j, e.low[j] : e.high[j]] <= sunk))
    if found == count:
        return runs, sums, moved
    for j in range(e.counts[STRIPS]):
        e.pressed[j, e.low[j] : e.high[j]] = meets[j, e.low[j] : e.high[j]] <= sunk
    runs = runs_of(e.pressed, e.low, e.high)
    return runs, _sums(e, runs), True


def _late(
    e: Elements, law: StepLaw, runs: NDArray[np.int64], weights: Array, place: float,
    depth: float, first: float,
) -> tuple[NDArray[np.int64], Array]:  # fmt: skip
    """Return the elements that are entered within the step, and what they lack of their weight.

    Their arms are loaded for a part of it only.
    """
    count = 0
    for k in range(runs.shape[0] if e.arms.shape[0] else 0):
        count += (~e.touched[runs[k, 0], runs[k, 1] : runs[k, 2]]).sum()
    late, lack = np.empty((count, 2), dtype=np.int64), np.empty(count)
    for k in range(runs.shape[0] if count else 0):
        j, low = runs[k, 0], runs[k, 1]
        for i in low + np.flatnonzero(~e.touched[j, low : runs[k, 2]]):
            count -= 1
            rise = first - e.meets[j, i]
            share = (
                rise / (rise - min(gap_before(e, j, i, place, depth), 0.0)) if rise > 0.0 else 0.0
            )
            _, phi_2 = ramp_functions(law.h * share / e.law.arm_time)
            stiff = 0.5 * e.law.stiffness + (e.law.arm_stiffness * phi_2).sum()
            late[count, 0], late[count, 1] = j, i
            lack[count] = (1.0 - share * stiff / law.stiffness) * weights[j]
    return late, lack


def _extent(runs: NDArray[np.int64], weights: Array) -> float:
    total = 0.0
    for k in range(runs.shape[0]):
        total += weights[runs[k, 0]] * (runs[k, 2] - runs[k, 1])
    return total


def _bends(e: Elements, law: StepLaw, begun: NDArray[np.int64]) -> Array:
    """Return by how much the mean force of arms bends at each edge of the runs."""
    bends = np.zeros((begun.shape[0], 2))
    if not e.arms.shape[0]:
        return bends
    for k in range(begun.shape[0]):
        for side in range(2):
            j, out = begun[k, 0], 1 - 2 * side
            inner = begun[k, 1] if side == 0 else begun[k, 2] - 1
            held = e.arms[:, j, inner + out] - e.arms[:, j, inner]
            free = e.arms[:, j, inner - out] - e.arms[:, j, inner - 2 * out]
            bends[k, side] = (law.weights * held).sum() - (law.free * free).sum()
    return bends


def _sink(
    e: Elements, law: StepLaw, step: Step, runs: NDArray[np.int64], sums: Array,
    state: Array,
) -> tuple[NDArray[np.int64], Array, float]:  # fmt: skip
    """Solve M (v_1 - v_0)/h = W - k_s (d - δ_0) - F_z for how far the indenter sinks.

    While no element is met or let go, F_z is of the second order in the depth: one step of Newton's
    method with the second derivative is exact.
    """
    h, theta, k, sunk = law.h, step.theta, law.stiffness * e.spacing, step.first
    if math.isinf(e.mass):
        return runs, sums, 0.0
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
            added, wider, bent, _ = _kinks(e, law, step, runs, sunk, state[DEPTH])
            area, width = area + added, width + wider
        mean = state[DEPTH] - e.depth + theta * sunk
        change_of_rate = _velocity(sunk, state[RATE], h, theta) - state[RATE]
        residual = e.mass * change_of_rate / h - e.weight + e.spring * mean + k * area
        slope = e.mass / (theta * h * h) + theta * e.spring + k * width
        root = math.sqrt(max(slope * slope - 2.0 * residual * k * bent, 0.0))
        sunk -= 2.0 * residual / (slope + root)
        runs, sums, moved = _walk(e, runs, sums, sunk)
        if not moved:
            break
    return runs, sums, sunk


def _kinks(
    e: Elements, law: StepLaw, step: Step, runs: NDArray[np.int64], sunk: float,
    depth: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Return the area of the kinks at edges by dx less what relaxed, its derivatives by depth, and its push.

    A kink of the surface, at an edge between two elements, adds to the area that is pressed. It counts
    where the edge stands or moves outward over the free surface, that is, where the overlap w = g - u
    just outside does not fall. Where the edge moves inward, the surface has no kink, or one that is left
    behind and relaxes like all that is free. Each side of each strip is asked for itself.
    """
    before, falling = step.place - step.travel, step.falling
    met = np.zeros(e.u.shape[0], dtype=np.bool_)
    known = falling[0, 2]  # decided once in a step, so that no iteration can go to and fro
    falling[0, 2] = True
    area = wider = bent = push = 0.0
    for r in range(runs.shape[0]):
        j, low, high = runs[r, 0], runs[r, 1], runs[r, 2]
        for side in range(2):
            if not known and low < high:
                i = low - 1 if side == 0 else high
                gap = gap_before(e, j, i, before, depth)
                falls = sunk - e.meets[j, i] - gap < -STANDS * e.depth
                falling[j, side] = falls and (falling[j, side] or not met[j])
        met[j] = met[j] or low < high
    for begun in (False, True):
        ends = step.begun if begun else runs
        for r in range(ends.shape[0]):
            j, low, high = ends[r, 0], ends[r, 1], ends[r, 2]
            for side in range(2):
                if falling[j, side] or not met[j] or low == high:
                    continue
                i, out = (low - 1, -1) if side == 0 else (high, 1)
                w, far, farthest = (
                    (
                        gap_before(e, j, i, before, depth),
                        gap_before(e, j, i + out, before, depth),
                        gap_before(e, j, i + 2 * out, before, depth),
                    )
                    if begun
                    else (
                        sunk - e.meets[j, i],
                        sunk - e.meets[j, i + out],
                        sunk - e.meets[j, i + 2 * out],
                    )
                )
                added, more, bend, rise = kink_area((w, far, farthest))
                weight = step.weights[j]
                if begun:
                    added *= (e.law.stiffness + step.bends[r, side] / rise) / law.stiffness - 1.0
                else:
                    wider += weight * more
                    bent += weight * bend
                area += weight * added
                if e.slope.size:
                    push += weight * added * e.slope[j, i - out]
    return area, wider, bent, push


def _slide(
    e: Elements, law: StepLaw, step: Step, runs: NDArray[np.int64], state: Array,
    sunk: float, slid: float,
) -> tuple[float, float]:  # fmt: skip
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
    for kink in e.kinks:
        if e.per_width and e.law.damping:  # pressed by the flank that they come from
            for i in _passed(e, kink, step.place, step.travel):
                x = positions(e, i, i + 1, step.place - step.travel)
                e.slope[0, i] = slope_at(e.surface, e.profile, x, 0.0)[0]
    for r in range(runs.shape[0]):
        j, weight = runs[r, 0], step.weights[runs[r, 0]]
        slope = e.slope[j, runs[r, 1] : runs[r, 2]]
        width += weight * slope.size
        inclined += weight * slope.sum()
        tilted += weight * np.dot(slope, slope)
        area -= weight * np.dot(slope, e.meets[j, runs[r, 1] : runs[r, 2]])
    area += sunk * inclined
    for i in range(step.lack.size):
        j, k_i = step.late[i, 0], step.late[i, 1]
        area -= step.lack[i] * max(sunk - e.meets[j, k_i], 0.0) * e.slope[j, k_i]
    if e.parts:
        area += _kinks(e, law, step, runs, sunk, state[DEPTH])[3]
    # A ringing too fast for the step is damped; θ - 1/2 is of the third order in h, as on arms.
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


# Explicit schemes


def explicit_step(
    e: Elements, laws: tuple[StepLaw, StepLaw, StepLaw], state: Array, now: float,
    Y: Array, V: Array,
) -> int:  # fmt: skip
    """Take a step of Runge and Kutta; which elements are in contact is settled at its end.

    `laws` are those of no time, half the step and all of it; Y and V are at these times, V just before the
    end. F_z = dx Σ (K g + C g'). An element in contact detaches where its pressure would be negative, relaxes
    as e^(-t/τ), and is in contact again where the indenter meets it (Eqs. 20-25). Arms are loaded along a
    straight line from the start of the step to each stage, which leaves the order two.
    """
    h, M, M_x = laws[2].h, e.mass, e.mass_along
    stages, begin = e.tableau.shape[0] - 1, Y[0] - state[ALONG]
    pulls, drags = np.zeros(stages + 1), np.zeros(stages + 1)
    rates, slides = np.zeros(stages + 1), np.zeros(stages + 1)
    depth = along = 0.0
    moves = math.isfinite(M) or math.isfinite(M_x)
    for i in range(stages + 1):
        share = e.tableau[i, 0] if i < stages else 1.0
        depth, rate, along, along_rate = state[DEPTH], state[RATE], state[ALONG], state[ALONG_RATE]
        for k in range(i):
            part = h * e.tableau[i, k + 1]
            depth += part * rates[k]
            rate += part * pulls[k] / M
            along += part * slides[k]
            along_rate += part * drags[k] / M_x
        rates[i], slides[i] = rate, along_rate
        if moves or i == stages:
            n = int(2.0 * share)
            status, pulls[i], drags[i] = _press(
                e, laws[n], state, (depth, rate, along, along_rate), now, (begin, Y[n] - along), V[n],
                share > 0.0 and i < stages,
            )  # fmt: skip
            if status != DONE:
                return status
    settle(e, laws[2], begin, (state[DEPTH], depth))
    state[DEPTH], state[RATE] = depth, rates[stages]
    state[ALONG], state[ALONG_RATE] = along, slides[stages]
    if math.isfinite(M):
        mean = 0.0
        for k in range(stages):
            mean += e.tableau[stages, k + 1] * pulls[k]
        state[IMBALANCE] = abs(mean - 0.5 * (pulls[0] + pulls[stages]))
        state[FORCE] = e.weight + max(abs(pulls[0]), abs(pulls[stages]))
    return DONE


def _press(
    e: Elements, law: StepLaw, state: Array, at: tuple[float, float, float, float],
    now: float, places: tuple[float, float], velocity: float, within: bool,
) -> tuple[int, float, float]:  # fmt: skip
    """Find which elements press at a stage, and return M δ'' and M_x x'' there, after the status (Eq. 17)."""
    place = places[0] if within and e.rule.still else places[1]
    status = attend(e, now, (places[0], place), max(at[0], state[DEPTH]))
    if status != DONE:
        return status, 0.0, 0.0
    V, weights = velocity - at[3], _weights(e, at[0], e.u.shape[0])
    pull = e.weight - e.spring * (at[0] - e.depth)
    drag = -e.spring_along * at[2] - e.damping_along * at[3]
    for j in range(e.counts[STRIPS]):
        low, high, y = e.low[j], e.high[j], j * e.across
        x, u, touched = (
            positions(e, low, high, place),
            e.u[j, low:high],
            e.touched[j, low:high],
        )
        height, slope = height_at(e.surface, e.profile, x, y), slope_at(e.surface, e.profile, x, y)
        g, left = at[0] - height, _left(e, law, j, slice(low, high))
        p = e.law.stiffness * g + e.law.damping * (at[1] - V * slope)
        for k in range(e.arms.shape[0]):
            p += np.where(
                touched, law.held[k] * e.arms[k, j, low:high] + law.ramp[k] * (g - u), 0.0
            )
        if e.arms.shape[0]:
            for i in np.flatnonzero((g > left) & ~touched):
                gap = gap_before(e, j, low + i, places[0], state[DEPTH])
                rise = g[i] - left[i]
                phi_1, _ = ramp_functions(law.h * rise / (rise - min(gap, 0.0)) / e.law.arm_time)
                p[i] += rise * (e.law.arm_stiffness * phi_1).sum() - e.law.stiffness * left[i]
        if e.rule.remembers:
            free = u if e.rule.stale and within else left
            met = touched | (g > free) if e.rule.flags else g >= free * (1.0 - TIE)
            pressed = met & ((g > 0.0) if e.rule.pulls else (p >= 0.0))
        else:
            pressed = (g > 0.0) & (p >= 0.0)
        e.height[j, low:high], e.pressed[j, low:high] = height, pressed
        each = np.where(pressed, p, 0.0)
        pull -= e.spacing * weights[j] * each.sum()
        drag -= e.spacing * weights[j] * np.dot(slope, each)
    return DONE, pull, drag


# Forces and edges at an instant


def report(e: Elements, state: Array, now: float, about: Array, found: Array) -> int:
    """Put what is reported at an instant into `found`, in the order of `error_estimate.COLUMNS`.

    `about` is (time, V, V just before it, whether the base moves or moved last with V >= 0, Y). An element is
    in contact if the indenter touches its surface and its pressure p >= 0 (Eq. 24). Where the pressure is
    highest at an edge, its doubt is how much it differs between the elements beside that.
    """
    time, V, V_before, forward, Y = about
    place = Y - state[ALONG]
    status = attend(e, now, (place, place), state[DEPTH])
    if status != DONE:
        return status
    sliding, before = V - state[ALONG_RATE], V_before - state[ALONG_RATE]
    weights = _weights(e, state[DEPTH], e.u.shape[0])
    force = push = 0.0
    left = right = math.nan
    sums, peak, edge = np.zeros(4), np.zeros(3), np.zeros(3)
    for j in range(e.counts[STRIPS]):
        low, high = e.low[j], e.high[j]
        p, slope = _pressure(e, state, j, place, sliding)
        p_before = p if before == sliding else _pressure(e, state, j, place, before)[0]
        flags = (e.touched[j, low:high] & ((p >= 0.0) | e.rule.pulls)).reshape(1, -1)
        runs = runs_of(flags, np.zeros(1, np.int64), np.full(1, high - low))
        for k in range(runs.shape[0]):
            run = runs[k, 1], runs[k, 2]
            if e.parts:
                _parts(e, state, j, run, (p, p_before, slope), place, sliding, sums, peak, edge)
            else:
                _whole(e, j, run, p, place, sums, peak)
            force += weights[j] * sums[0]
            push += weights[j] * sums[1]
            if j == 0:
                left = sums[2] if math.isnan(left) else left
                right = sums[3]
    if edge[0] > peak[0]:
        peak = edge
    if state[ALONG_RATE] and abs(sliding) > AT_REST * e.rest_velocity:
        forward = 1.0 if sliding > 0.0 else 0.0
    held = e.spring_along * state[ALONG] + e.damping_along * state[ALONG_RATE]
    found[:] = np.array([
        time, V, state[DEPTH], state[RATE], e.spacing * force, -e.spacing * push,
        left if forward else right, right if forward else left,
        peak[0], sliding, held, peak[1], peak[2],
    ])  # fmt: skip
    return DONE


def _whole(
    e: Elements, j: int, run: tuple[int, int], p: Array, place: float, sums: Array, peak: Array
) -> None:
    """Sum over the whole elements of a run, as in the paper (Eqs. 12-15)."""
    x, inside = positions(e, e.low[j] + run[0], e.low[j] + run[1], place), p[run[0] : run[1]]
    sums[0], sums[1] = inside.sum(), np.dot(inside, slope_at(e.surface, e.profile, x, j * e.across))
    sums[2], sums[3] = x[0] - 0.5 * e.spacing, x[-1] + 0.5 * e.spacing
    peak[0] = max(peak[0], inside.max())


def _parts(
    e: Elements, state: Array, j: int, run: tuple[int, int], fields: tuple[Array, Array, Array],
    place: float, V: float, sums: Array, peak: Array, edge: Array,
) -> None:  # fmt: skip
    """Sum over a run by trapezoids up to its very edges."""
    p, p_before, slope = fields
    inside, reach = p[run[0] : run[1]], np.ones(2)
    top = run[0] + int(np.argmax(inside))
    sums[0], sums[1] = inside.sum(), np.dot(inside, slope[run[0] : run[1]])
    for side in range(2):
        i = run[0] if side == 0 else run[1] - 1
        share, p_edge, x = _edge(e, j, e.low[j], i, p, p_before, state[DEPTH], place, side)
        just_inside = x - NEAR * e.spacing * (2 * side - 1)
        steep = slope_at(e.surface, e.profile, just_inside, j * e.across)
        sums[0] += 0.5 * (share * (p[i] + p_edge) - p[i])
        sums[1] += 0.5 * (share * (slope[i] * p[i] + steep * p_edge) - slope[i] * p[i])
        sums[2 + side], reach[side] = x, share if i == top else 1.0
        if p_edge > edge[0]:
            edge[0], edge[2] = p_edge, abs(p[i] - p[i + 2 * side - 1])
    if e.per_width:
        more = _split(e, p, run, e.counts[FIRST] + e.low[j], place, V)
        sums[0], sums[1] = sums[0] + more[0], sums[1] + more[1]
    if p[top] > peak[0] or not peak[0]:
        peak[0], peak[1] = _peak(e, p, top, reach, run)


def _behind(e: Elements, V: float) -> float:
    """Return how far back the slope is taken: an element on a kink is still on the flank before it."""
    return math.copysign(NEAR * e.spacing, V) if e.kinks.size and V else 0.0


def _pressure(e: Elements, state: Array, j: int, place: float, V: float) -> tuple[Array, Array]:
    """Return p of the elements of a strip, g = δ - h(x), g' = δ' - V h'(x) (Eqs. 6, 7, 12), and the slope.

    Of one that is not in contact, it is what it would be had it followed the indenter in the last step: it
    is brought down by the gap at the start of that time, and then moves with the indenter.
    """
    low, high, y = e.low[j], e.high[j], j * e.across
    x, u = positions(e, low, high, place), e.u[j, low:high]
    slope = slope_at(e.surface, e.profile, x - _behind(e, V), y)
    g = state[DEPTH] - height_at(e.surface, e.profile, x, y)
    g_rate = state[RATE] - V * slope
    p = e.law.stiffness * g + e.law.damping * g_rate
    if e.arms.shape[0]:
        z = state[LAST] / e.law.arm_time
        brought = (e.law.arm_stiffness * np.exp(-z)).sum()
        moved = (e.law.arm_stiffness * ramp_functions(z)[0]).sum()
        free = brought * (g - u) + (moved - brought) * state[LAST] * g_rate - e.law.stiffness * u
        arms = np.zeros(high - low)
        for k in range(e.arms.shape[0]):
            arms += e.arms[k, j, low:high]
        p += np.where(e.touched[j, low:high], arms, free)
    return p, slope


def _edge(
    e: Elements, j: int, low: int, i: int, p: Array, p_before: Array, depth: float,
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
    w = (gap_before(e, j, low + i + out, place, depth),
         gap_before(e, j, low + i + 2 * out, place, depth),
         gap_before(e, j, low + i + 3 * out, place, depth))  # fmt: skip
    if math.isinf(before) or straight(w):
        before = 1.0 if e.touched[j, low + i + out] else 1.0 - touching(w)
    share = min(before, now, 1.0)
    p_edge = 0.0 if now <= share else p[i] + share * (p[i + out] - p[i])
    x = e.spacing * (e.counts[FIRST] + low + i + e.shift) + place
    if e.per_width:
        for kink in e.kinks:
            # There p falls at once, by -C V times the jump of h'.
            ahead = (kink - x) / e.spacing * out
            p_kink = p[i] + ahead * (p[i] - p[i - out])
            if -NEAR <= ahead < min(before, 1.0) and p[i + out] < 0.0 and p_kink > 0.0:
                share, p_edge = ahead, p_kink
    return share, p_edge, x + share * e.spacing * out


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
    e: Elements, p: Array, run: tuple[int, int], first: int, place: float, V: float
) -> tuple[float, float]:
    """Split the element in which a kink of the shape is: h' jumps there, and p by -C V times as much.

    Without this, the forces under a wedge are of the first order in the spacing.
    """
    force = push = 0.0
    for kink in e.kinks:
        x_0 = e.spacing * (first + e.shift) + place
        k = round((kink - x_0) / e.spacing)
        if not run[0] < k < run[1] - 1:
            continue
        x = x_0 + k * e.spacing
        here = slope_at(e.surface, e.profile, x - _behind(e, V), 0.0)
        back = slope_at(e.surface, e.profile, kink - NEAR * e.spacing, 0.0)
        ahead = slope_at(e.surface, e.profile, kink + NEAR * e.spacing, 0.0)
        p_back, p_ahead = (
            p[k] - e.law.damping * V * (back - here),
            p[k] - e.law.damping * V * (ahead - here),
        )
        share = (kink - x) / e.spacing + 0.5
        if p_back >= 0.0 and p_ahead >= 0.0:
            force += share * p_back + (1.0 - share) * p_ahead - p[k]
            push += share * p_back * back + (1.0 - share) * p_ahead * ahead - p[k] * here
    return force, push


def _peak(e: Elements, p: Array, k: int, reach: Array, run: tuple[int, int]) -> tuple[float, float]:
    """Return the peak near element k, of the parabola through three, and its doubt.

    A shape with kinks has no such parabola: there the peak is known to the next element. Arms remember
    where contact began, so that the pressure itself may have a kink between two elements.
    """
    before, here, after = p[k - 1], p[k], p[k + 1]
    doubt = 0.5 * max(here - before, here - after) if e.law.arm_time.size else 0.0
    if e.kinks.size:
        return here, min(abs(here - before), abs(here - after))
    bend = 2.0 * here - before - after
    if not (here >= before and here >= after and bend > 0.0):
        return here, 0.0
    if doubt and run[0] + 3 <= k < run[1] - 3:
        smooth, ridge = _smooth(p[k - 3 : k + 4]), _ridge(p[k - 3 : k + 4])
        return smooth if smooth[1] <= ridge[1] else ridge
    ahead = 0.5 * (after - before) / bend
    if abs(ahead) > reach[1 if ahead > 0.0 else 0]:
        return here, doubt
    return here + 0.25 * (after - before) * ahead, doubt


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

    `times` are those before the first step and after each, `steps` their lengths, `Y` and `V` at the start of
    each, halfway and at its end, V just before that. `after` says after which step an instant is
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
    e: Elements, state: Array, course: Course, balances: Array, found: Array,
    step: int, reported: int, until: int,
) -> tuple[int, int, int]:  # fmt: skip
    """Run from a step on; return why it ended, the steps done and the instants reported."""
    law = half = none = law_of(e.law, 0.0)
    begun = runs_of(e.touched, e.low, e.high)
    while True:
        while reported < course.after.size and course.after[reported] == step:
            about, now = course.about[reported], course.times[step]
            status = report(e, state, now, about, found[reported])
            if status != DONE:
                return status, step, reported
            reported += 1
        if step == until:
            return DONE, step, reported
        h, now = course.steps[step], course.times[step]
        if h != law.h:
            law = law_of(e.law, h)
            if e.explicit:
                half = law_of(e.law, 0.5 * h)
        if e.explicit:
            Y, V = course.Y[step], course.V[step]
            status = explicit_step(e, (none, half, law), state, now, Y, V)
        else:
            Y_ends = course.Y[step, 0], course.Y[step, 2]
            status, begun = implicit_step(e, law, begun, state, now, Y_ends)
        if status != DONE:
            return status, step, reported
        state[LAST] = h
        balances[0, step % WINDOW], balances[1, step % WINDOW] = state[IMBALANCE], state[FORCE]
        step += 1
        status = _watch(e, state, course.limits, balances)
        if status != DONE:
            return status, step, reported


def _watch(e: Elements, state: Array, limits: Array, balances: Array) -> int:
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
    if e.explicit and balances[1].min() > 0.0 and balances[0].sum() > limits[2] * balances[1].sum():
        return UNBALANCED
    return DONE
