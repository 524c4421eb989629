"""A trial step: its error, and its first event."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import coupled
from kvtheory.models.continuum.contact import FREE, SIDES, TOUCHING, Instant, motion
from kvtheory.models.continuum.memory_chains import summit
from kvtheory.models.continuum.radau_iia import collocate, defect_error, imbalance
from kvtheory.models.continuum.run import Run
from kvtheory.scene.base_motion import evaluate

EVENT_RESOLUTION = 1e-13
"""Of the time of an event, relative to 1 + s."""
OFF_THE_ENDS = 0.01
"""Share of a bracket by which a secant keeps off its ends, so that both of them move."""
DIPPING = 0, 1, 3
"""The monitors that may be negative briefly within a step; an edge does not return to ground it left."""
LOW = 0.5
"""A monitor may be zero between three probes if its smallest value there is below this share of the largest;
a parabola that is zero between them has at most 0.33."""
EVALUATIONS, CLOSE = 6, 1e-7
"""Most evaluations in the search of a minimum, and their least distance, as a share of the step."""
ROUNDING = 1e-15
"""Of an edge, whose material coordinate is xi - Y, relative to Y and to the effect of a rounded time."""

Monitors = tuple[float, float, float, float, float]
"""Event functions, which stay positive until an event: the width (in flight, the gap), state and ground of
the left edge, and of the right one."""

NO_EVENT = (math.inf, math.inf, math.inf, math.inf, math.inf)


def sliding_now(run: Run, s: float) -> tuple[float, float, float]:
    """Return Y, lambda, lambda' of the base under the indenter at present."""
    return evaluate(run.pieces[run.now.slide], s)


def take_up(run: Run, span: float, rate: float) -> None:
    """Let the base slide under a sprung indenter from now on, whose x' changes by `rate` in a `span`."""
    now, along = run.now, run.along[run.now.steps]
    along.start, along.span, along.depth, along.piece = now.s, span, now.x, now.piece
    for i in range(len(along.rate)):
        along.rate[i] = 0.0
    along.rate[0], along.rate[1] = now.w, rate
    now.slide = run.given.drives + now.steps
    coupled.slide(run, along, run.pieces[now.slide])


def attempt(run: Run, step: Any, span: float) -> tuple[float, float, Monitors]:
    """Return the error of a step relative to its tolerance, infinite if it failed, and its first event.

    The event is given by its time, infinite if there is none, and the monitors just after it.
    """
    _begin(run, step, span)
    start = run.now.s
    if run.given.sprung or not run.given.fixed:
        evaluations = _solve(run, step)
        run.now.evaluations += evaluations
        if evaluations == 0:
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
        if found == math.inf and _low(first, second, values):
            found_after, found = _dip(run, step, probe, first, second, values)
        before, first, second = s, second, values
    if found == math.inf:
        return size, math.inf, NO_EVENT
    found, violated = _locate(run, step, found_after, found)
    return size, found, violated


def _place(run: Run, probe: int) -> float:
    """Return where a probe is, as a share of the step; behind the last one is the end."""
    return run.method.probes[probe] if probe < run.method.probe_count else 1.0


def _low(first: Monitors, second: Monitors, third: Monitors) -> bool:
    """Whether a monitor is so low at one of three probes that it may be negative between them."""
    low = False
    for k in DIPPING:
        low = low or min(first[k], second[k], third[k]) < LOW * max(first[k], third[k]) < math.inf
    return low


def _dip(
    run: Run, step: Any, probe: int, first: Monitors, second: Monitors, third: Monitors
) -> tuple[float, float]:
    """Return a time before, and one when, a monitor is negative between three probes where none is.

    The parabola through three points is lowest near where the monitor is: it is evaluated there, and the
    parabola drawn anew. The first three probes stand for what is before them, too.
    """
    start, span = step.start, step.span
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
            value = monitors(run, step, start + place * span)[0][k]
            if value < 0.0:
                before = b if b < place else a if a < place else earliest
                return start + before * span, start + place * span
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


def _begin(run: Run, step: Any, span: float) -> None:
    """Begin a step of the length `span`; its powers of v are still zero."""
    now = run.now
    if run.given.sprung:
        take_up(run, span, 0.0)
    step.start, step.span, step.depth, step.piece = now.s, span, now.d, now.slide
    for k in range(2):
        here, side = now.sides[k], step.sides[k]
        side.state, side.node, side.X = here.state, here.node, here.X
    for i in range(len(step.rate)):
        step.rate[i] = 0.0
    step.rate[0] = now.v


def _solve(run: Run, step: Any) -> int:
    """Solve for a step; return the number of evaluations, or 0 if that failed."""
    now, stages, sprung = run.now, run.method.stages, run.given.sprung
    guess, last = run.matrix[len(run.matrix) - 3], now.steps - 1
    along = run.along[last + 1 if sprung else 0]
    for i in range(len(guess) - 1):
        guess[i] = 0.0
    for i in range(stages if now.smooth else 0):
        s = now.s + run.method.nodes[i] * step.span
        guess[i] = motion(run.steps[last], s)[1] - now.v
        if sprung:
            guess[stages + i] = motion(run.along[last], s)[1] - now.w
    evaluations = collocate(run, step, along)
    if sprung and evaluations > 0:
        coupled.slide(run, along, run.pieces[now.slide])
    return evaluations


def _probe(run: Run, step: Any, s: float, probe: int) -> tuple[Monitors, float]:
    """Return the monitors at `s`, and the error there relative to the tolerance."""
    values, F, F_d, F_v, dv = monitors(run, step, s)
    error = 0.0
    if probe < run.method.probe_count:
        scales = run.method.scales[probe]
        if not run.given.fixed:
            run.now.evaluations += 1
            error = defect_error(step.span, run.given.eps, dv, F, F_d, F_v, 1.0 - F_d, scales)
            error /= run.given.rtol * (1.0 + abs(run.now.v))
        if run.given.sprung:
            error = max(error, _error_along(run, step, s, scales))
    return values, error


def _error_along(run: Run, step: Any, s: float, scales: Any) -> float:
    """Return the error of x' from the defect at `s`, relative to the tolerance."""
    given, now = run.given, motion(step, s) + sliding_now(run, s)
    x, w, dw = motion(run.along[run.now.steps], s)
    _, (G, _, _, G_x, G_w) = coupled.balances(run, step, s, now, x, w)
    rounding = 1.0 + given.spring * abs(x) + abs(w) * (given.damping - G_w) + abs(now[4])
    error = defect_error(step.span, given.eps_x, dw, G, G_x, G_w, rounding, scales)
    return error / (given.rtol * (1.0 + abs(run.now.w)))


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
    F, F_d, F_v, l, r = imbalance(run, step, s, now)
    if step.sides[0].state == FREE:
        gap = -d if d < 0.0 else -summit(run, s, d, Y)[0]
        return (gap + allowed, math.inf, math.inf, math.inf, math.inf), F, F_d, F_v, dv
    left_state, left_ground = _slack(run, 0, s, l, now)
    right_state, right_ground = _slack(run, 1, s, r, now)
    values = (
        r - l + allowed,
        left_state + allowed,
        left_ground + allowed,
        right_state + allowed,
        right_ground + allowed,
    )
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
    return (
        _touchdown(run, step, earliest, high) if run.now.sides[0].state == FREE else high
    ), violated


def _touchdown(run: Run, step: Any, earliest: float, s: float) -> float:
    """Return when the gap is zero, from a time when it is negative by what a monitor allows.

    By a step of Newton's method: du/ds = -u on the ground, and dg/ds = p - g under the indenter.
    """
    d, v, _, Y, number, _ = motion(step, s) + sliding_now(run, s)
    depth, X, _, _, _ = summit(run, s, d, Y)
    rate = c_.pressure(X + Y, d, v, number) - depth
    return max(s - depth / rate, earliest) if rate > 0.0 else s
