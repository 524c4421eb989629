"""A trial step: its error, and its first event."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum.collocation import balances, collocate, defect_error, imbalance
from kvtheory.models.continuum.contact import Instant, motion
from kvtheory.models.continuum.memory_chains import summit
from kvtheory.models.continuum.run import FREE, SIDES, TOUCHING, Run
from kvtheory.scene import base_motion as b_

EVENT_RESOLUTION = 1e-13
"""Resolution of the time of an event, relative to 1 + s."""
OFF_THE_ENDS = 0.01
"""Least distance of a secant step from both ends of the bracket, as a share of it, so that both ends move."""
DIPPING = 0, 1, 3
"""The monitors that may be negative briefly within a step; an edge does not return to ground it left."""
LOW = 0.5
"""A monitor may be zero between three probes if its smallest value there is below this share of the largest;
a parabola that is zero between them has at most 0.33."""
EVALUATIONS, CLOSE = 6, 1e-7
"""Most evaluations in the search for a minimum, and their least distance, as a share of the step."""
ROUNDING = 1e-15
"""Rounding error of an edge, stored as xi - Y, relative to Y and to the effect of a rounded time."""

Monitors = tuple[float, float, float, float, float]
"""Event functions, which stay positive until an event: the width (in flight, the gap), state and ground of
the left edge, and of the right one."""

NO_EVENT = (math.inf, math.inf, math.inf, math.inf, math.inf)


def sliding_now(run: Run, s: float) -> tuple[float, float, float]:
    """Return Y, lambda, lambda' of the base under the indenter at present."""
    return b_.evaluate(run.pieces[run.now.slide], s)


def begin_along(run: Run, span: float, rate: float) -> None:
    """Initialize the motion along x of a step, whose x' changes by `rate` over `span`."""
    now, along = run.now, run.along[run.now.steps]
    along.start, along.span, along.depth, along.piece = now.s, span, now.x, now.piece
    for i in range(len(along.rate)):
        along.rate[i] = 0.0
    along.rate[0], along.rate[1] = now.w, rate
    now.slide = run.given.drives + now.steps
    slide(run, along, run.pieces[now.slide])


def slide(run: Run, along: Any, row: Any) -> None:
    """Write how the base slides under the indenter: the drive of a step less the motion along x."""
    piece = run.pieces[along.piece]
    after, count = along.start - piece[b_.START], len(row)
    row[b_.START], row[b_.END] = along.start, along.start + along.span
    row[b_.DISPLACEMENT] = b_.evaluate(piece, along.start)[0] - along.depth
    for k in range(b_.POWERS, count):
        row[k] = piece[k]
    if after != 0.0:
        for first in range(b_.POWERS, count - 1):
            for k in range(count - 2, first - 1, -1):
                row[k] += after * row[k + 1]
    scale = 1.0
    for k in range(run.method.stages + 1):
        row[b_.POWERS + k] -= along.rate[k] / scale
        scale *= along.span


def attempt(run: Run, step: Any, span: float) -> tuple[float, float, Monitors]:
    """Return the error of a step relative to its tolerance, infinite if it failed, and its first event.

    The event is given by its time, infinite if there is none, and the monitors just after it.
    """
    start = run.now.s
    if not _solve(run, step, span):
        return math.inf, math.inf, NO_EVENT
    size, before, found_after, found = 0.0, start, start, math.inf
    first = second = NO_EVENT
    for probe in range(run.method.probe_count + 1):
        s = start + _place(run, probe) * span
        values, error = _probe(run, step, s, probe)
        size, slack = max(size, error), smallest(values)
        if math.isnan(slack):
            return math.inf, math.inf, NO_EVENT
        if found == math.inf and slack < 0.0:
            found_after, found = before, s
        if found == math.inf:
            found_after, found = _dip(run, step, probe, first, second, values)
        before, first, second = s, second, values
    if found == math.inf:
        return size, math.inf, NO_EVENT
    found, violated = _locate(run, step, found_after, found)
    return size, found, violated


def _place(run: Run, probe: int) -> float:
    """Return where a probe is, as a share of the step; after the last one comes the end."""
    return run.method.probes[probe] if probe < run.method.probe_count else 1.0


def _dip(
    run: Run, step: Any, probe: int, first: Monitors, second: Monitors, third: Monitors
) -> tuple[float, float]:
    """Return times before and within a negative dip of a monitor between three probes; infinite if none.

    The monitor is evaluated at the minimum of the parabola through three points, which is then updated. The
    first three probes also cover the time before them.
    """
    for k in DIPPING:
        f, g, h = first[k], second[k], third[k]
        if not min(f, g, h) < LOW * max(f, h) < math.inf:
            continue
        a, b, c = _place(run, probe - 2), _place(run, probe - 1), _place(run, probe)
        earliest = 0.0 if probe == 2 else a
        for _ in range(EVALUATIONS):
            rise = (g - f) / (b - a)
            bend = (h - g) / (c - b) - rise
            place = 0.5 * (a + b - rise * (c - a) / bend) if bend > 0.0 else math.nan
            nearest = min(abs(place - a), abs(place - b), abs(place - c))
            if not (earliest < place < c and nearest > CLOSE):
                break
            value = monitors(run, step, step.start + place * step.span)[0][k]
            if value < 0.0:
                before = b if b < place else a if a < place else earliest
                return step.start + before * step.span, step.start + place * step.span
            if place < a:
                a, b, c, f, g, h = place, a, b, value, f, g
            elif place < b:
                if value < g:
                    b, c, g, h = place, b, value, g
                else:
                    a, f = place, value
            elif value < g:
                a, b, f, g = b, place, g, value
            else:
                c, h = place, value
    return math.inf, math.inf


def _solve(run: Run, step: Any, span: float) -> bool:
    """Solve a step of length `span` from the present state; return whether it converged."""
    now, given, stages, last = run.now, run.given, run.method.stages, run.now.steps - 1
    if given.sprung:
        begin_along(run, span, 0.0)
    step.start, step.span, step.depth, step.piece = now.s, span, now.d, now.slide
    for k in range(2):
        here, side = now.sides[k], step.sides[k]
        side.state, side.node, side.X = here.state, here.node, here.X
    for i in range(len(step.rate)):
        step.rate[i] = 0.0
    step.rate[0] = now.v
    if given.fixed and not given.sprung:
        return True
    along, guess = run.along[last + 1 if given.sprung else 0], run.matrix[len(run.matrix) - 3]
    for i in range(len(guess) - 1):
        guess[i] = 0.0
    for i in range(stages if now.smooth else 0):
        s = now.s + run.method.nodes[i] * span
        guess[i] = motion(run.steps[last], s)[1] - now.v
        if given.sprung:
            guess[stages + i] = motion(run.along[last], s)[1] - now.w
    evaluations = collocate(run, step, along)
    now.evaluations += evaluations
    if given.sprung and evaluations > 0:
        slide(run, along, run.pieces[now.slide])
    return evaluations > 0


def _probe(run: Run, step: Any, s: float, probe: int) -> tuple[Monitors, float]:
    """Return the monitors at `s`, and the error there of v and x' relative to the tolerance."""
    values, F, F_d, F_v, dv = monitors(run, step, s)
    error, now, given = 0.0, run.now, run.given
    if probe < run.method.probe_count:
        scales = run.method.scales[probe]
        if not given.fixed:
            now.evaluations += 1
            error = defect_error(step.span, given.eps, dv, F, F_d, F_v, 1.0 - F_d, scales)
            error /= given.rtol * (1.0 + abs(now.v))
        if given.sprung:
            instant = motion(step, s) + sliding_now(run, s)
            x, w, dw = motion(run.along[now.steps], s)
            _, (G, _, _, G_x, G_w) = balances(run, step, s, instant, x, w)
            terms = 1.0 + given.spring * abs(x) + abs(w) * (given.damping - G_w) + abs(instant[4])
            along = defect_error(step.span, given.eps_x, dw, G, G_x, G_w, terms, scales)
            error = max(error, along / (given.rtol * (1.0 + abs(now.w))))
    return values, error


def smallest(values: Monitors) -> float:
    """Return the least of the monitors, NaN if the first is."""
    least = values[0]
    for value in values:
        least = min(least, value)
    return least


def monitors(run: Run, step: Any, s: float) -> tuple[Monitors, float, float, float, float]:
    """Return the event functions, and F, dF/dd, dF/dv and v'."""
    now = motion(step, s) + sliding_now(run, s)
    d, v, dv, Y, number, _ = now
    allowed = run.given.allowed + ROUNDING * (abs(Y) + s * (abs(number) + abs(v)))
    F, F_d, F_v, (l, _, _, _), (r, _, _, _) = imbalance(run, step, s, now)
    if step.sides[0].state == FREE:
        gap = -d if d < 0.0 else -summit(run, s, d, Y)[0]
        return (gap + allowed, math.inf, math.inf, math.inf, math.inf), F, F_d, F_v, dv
    left_state, left_ground = _slack(run, 0, s, l, now)
    right_state, right_ground = _slack(run, 1, s, r, now)
    values = (
        r - l + allowed, left_state + allowed, left_ground + allowed,
        right_state + allowed, right_ground + allowed,
    )  # fmt: skip
    return values, F, F_d, F_v, dv


def _slack(run: Run, k: int, s: float, xi: float, now: Instant) -> tuple[float, float]:
    side = run.now.sides[k]
    index = side.node
    if side.state == TOUCHING:
        index = c_.reached(run, SIDES[k], index, s, now[0], now[3])
    return c_.slack(SIDES[k], side.state, run.nodes[index], s, xi, now)


def _locate(run: Run, step: Any, low: float, high: float) -> tuple[float, Monitors]:
    """Return the time of the first violation in (low, high], and the monitors just after it."""
    violated, earliest = monitors(run, step, high)[0], low
    at_low, at_high, turn = math.nan, smallest(violated), 0
    while high - low > EVENT_RESOLUTION * (1.0 + abs(high)):
        turn += 1
        middle = 0.5 * (low + high)
        if turn % 3 != 0 and not math.isnan(at_low):  # bisect every third time: secants may stall
            secant = low + (high - low) * at_low / (at_low - at_high)
            margin = OFF_THE_ENDS * (high - low)
            middle = min(max(secant, low + margin), high - margin)
        values = monitors(run, step, middle)[0]
        value = smallest(values)
        if value < 0.0:
            high, at_high, violated = middle, value, values
        else:
            low, at_low = middle, value
    if low == run.now.s:
        return low, violated
    if run.now.sides[0].state == FREE:
        high = _touchdown(run, step, earliest, high)
    return high, violated


def _touchdown(run: Run, step: Any, earliest: float, s: float) -> float:
    """Return when the gap is zero, from a time at which it is negative by the allowed violation.

    By one Newton step: du/ds = -u on the ground, and dg/ds = p - g under the indenter.
    """
    d, v, _, Y, number, _ = motion(step, s) + sliding_now(run, s)
    depth, X, _, _, _ = summit(run, s, d, Y)
    rate = c_.pressure(X + Y, d, v, number) - depth
    return max(s - depth / rate, earliest) if rate > 0.0 else s
