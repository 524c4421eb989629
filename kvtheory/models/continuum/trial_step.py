"""A step on trial: its error, and its first event."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import coupled
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.contact import FREE, TOUCHING
from kvtheory.models.continuum.dense_output import Instant, motion
from kvtheory.models.continuum.memory_chains import summit
from kvtheory.models.continuum.radau_iia import collocate, defect_error, imbalance
from kvtheory.models.continuum.run import SIDES, Run
from kvtheory.scene.base_motion import evaluate

EVENT_RESOLUTION = 1e-13
"""Of the time of an event, relative to 1 + s."""
OFF_THE_ENDS = 0.01
"""Share of a bracket by which a secant keeps off its ends, so that both of them move."""
DIPPING = 0, 1, 3
"""The monitors that may be negative for a moment within a step; an edge does not return to ground it left."""
LOW = 0.5
"""A monitor may be zero between three probes if its smallest value there is below this share of the largest;
a parabola that is zero between them has at most 0.33."""
LOOKS, CLOSE = 6, 1e-7
"""Most evaluations in search of one minimum, and the least distance between two, as a share of the step."""
ROUNDING = 1e-15
"""Of an edge, whose material coordinate is xi - Y, relative to Y and to what a rounded time does to it."""

Monitors = tuple[float, float, float, float, float]
"""What must stay positive: the width (in flight, the gap), state and ground of the left edge, and of
the right one."""

NO_EVENT = (math.inf, math.inf, math.inf, math.inf, math.inf)


def sliding_now(run: Run, s: float) -> tuple[float, float, float]:
    """Return Y, lambda, lambda' of the base under the indenter at present."""
    return evaluate(run.pieces[run.counts[r_.SLIDE]], s)


def take_up(run: Run, span: float, rate: float) -> None:
    """Let the base slide under a sprung indenter from now on, whose x' changes by `rate` in a `span`."""
    now, along = run.now, run.along[run.counts[r_.RECORDS]]
    for i in range(len(along)):
        along[i] = 0.0
    along[h_.START], along[h_.SPAN], along[h_.PIECE] = now[r_.S], span, run.counts[r_.PIECE]
    along[h_.DEPTH], along[h_.POWERS], along[h_.POWERS + 1] = now[r_.X], now[r_.W], rate
    run.counts[r_.SLIDE] = run.given.drives + run.counts[r_.RECORDS]
    coupled.slide(run, along, run.pieces[run.counts[r_.SLIDE]])


def attempt(run: Run, record: Any, span: float) -> tuple[float, float, Monitors]:
    """Return the error of a step by its tolerance, infinite if it failed, and its first event.

    The event is given by its time, infinite if there is none, and the monitors just after it.
    """
    _begin(run, record, span)
    start = run.now[r_.S]
    if run.given.sprung or not run.given.fixed:
        evaluations = _solve(run, record)
        run.counts[r_.EVALUATIONS] += evaluations
        if evaluations == 0:
            return math.inf, math.inf, NO_EVENT
    size, before, found_after, found = 0.0, start, start, math.inf
    probes = run.given.method.probes
    first = second = NO_EVENT
    for probe in range(len(probes) + 1):
        s = start + (probes[probe] if probe < len(probes) else 1.0) * span
        values, error = _probe(run, record, s, probe)
        size, slack = max(size, error), smallest(values)
        if math.isnan(slack):
            return math.inf, math.inf, NO_EVENT
        if found == math.inf and slack < 0.0:
            found_after, found = before, s
        if found == math.inf and _low(first, second, values):
            found_after, found = _dip(run, record, probe, first, second, values)
        before, first, second = s, second, values
    if found == math.inf:
        return size, math.inf, NO_EVENT
    found, violated = _locate(run, record, found_after, found)
    return size, found, violated


def _low(first: Monitors, second: Monitors, third: Monitors) -> bool:
    """Whether a monitor is so low at one of three probes that it may be negative between them."""
    low = False
    for k in DIPPING:
        low = low or min(first[k], second[k], third[k]) < LOW * max(first[k], third[k]) < math.inf
    return low


def _dip(
    run: Run, record: Any, probe: int, first: Monitors, second: Monitors, third: Monitors
) -> tuple[float, float]:
    """Return a time before, and one when, a monitor is negative between three probes where none is.

    The parabola through three points is lowest near where the monitor is: it is evaluated there, and the
    parabola drawn anew. The first three probes stand for what is before them, too.
    """
    start, span, probes = record[h_.START], record[h_.SPAN], run.given.method.probes
    for k in DIPPING:
        f, g, h = first[k], second[k], third[k]
        if not min(f, g, h) < LOW * max(f, h) < math.inf:
            continue
        a, b = probes[probe - 2], probes[probe - 1]
        c = probes[probe] if probe < len(probes) else 1.0
        earliest = 0.0 if probe == 2 else a
        for _ in range(LOOKS):
            rise = (g - f) / (b - a)
            bend = (h - g) / (c - b) - rise
            place = 0.5 * (a + b - rise * (c - a) / bend) if bend > 0.0 else math.nan
            nearest = min(abs(place - a), abs(place - b), abs(place - c))
            if not (earliest < place < c and nearest > CLOSE):
                break
            value = monitors(run, record, start + place * span)[0][k]
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


def _begin(run: Run, record: Any, span: float) -> None:
    """Begin a record: a step of the length `span`, its powers of v still zero."""
    now = run.now
    if run.given.sprung:
        take_up(run, span, 0.0)
    record[h_.START], record[h_.SPAN] = now[r_.S], span
    record[h_.DEPTH], record[h_.PIECE] = now[r_.D], run.counts[r_.SLIDE]
    record[h_.LEFT_STATE], record[h_.LEFT_NODE] = run.states[0], run.tops[0]
    record[h_.RIGHT_STATE], record[h_.RIGHT_NODE] = run.states[1], run.tops[1]
    record[h_.LEFT_X], record[h_.RIGHT_X] = run.edges[0], run.edges[1]
    record[h_.POWERS] = now[r_.V]
    for i in range(h_.POWERS + 1, len(record)):
        record[i] = 0.0


def _solve(run: Run, record: Any) -> int:
    now, stages, sprung = run.now, len(run.given.method.nodes), run.given.sprung
    guess, last = run.matrix[len(run.matrix) - 3], run.counts[r_.RECORDS] - 1
    along = run.along[last + 1 if sprung else 0]
    for i in range(len(guess) - 1):
        guess[i] = 0.0
    for i in range(stages if run.counts[r_.SMOOTH] != 0 else 0):
        s = now[r_.S] + run.given.method.nodes[i] * record[h_.SPAN]
        guess[i] = motion(run.records[last], s)[1] - now[r_.V]
        if sprung:
            guess[stages + i] = motion(run.along[last], s)[1] - now[r_.W]
    evaluations = collocate(run, record, along)
    if sprung and evaluations > 0:
        coupled.slide(run, along, run.pieces[run.counts[r_.SLIDE]])
    return evaluations


def _probe(run: Run, record: Any, s: float, probe: int) -> tuple[Monitors, float]:
    """Return the monitors at `s`, and the error there by the tolerance."""
    values, F, F_d, F_v, dv = monitors(run, record, s)
    error = 0.0
    if probe < len(run.given.method.probes):
        scales = run.given.method.scales[probe]
        if not run.given.fixed:
            run.counts[r_.EVALUATIONS] += 1
            error = defect_error(record[h_.SPAN], run.given.eps, dv, F, F_d, F_v, 1.0 - F_d, scales)
            error /= run.given.rtol * (1.0 + abs(run.now[r_.V]))
        if run.given.sprung:
            error = max(error, _error_along(run, record, s, scales))
    return values, error


def _error_along(run: Run, record: Any, s: float, scales: Any) -> float:
    """Return the error of x' from the defect at `s`, by the tolerance."""
    given, now = run.given, motion(record, s) + sliding_now(run, s)
    x, w, dw = motion(run.along[run.counts[r_.RECORDS]], s)
    _, (G, _, _, G_x, G_w) = coupled.balances(run, record[h_.LEFT_STATE : h_.LEFT_X], s, now, x, w)
    rounding = 1.0 + given.spring * abs(x) + abs(w) * (given.damping - G_w) + abs(now[4])
    error = defect_error(record[h_.SPAN], given.eps_x, dw, G, G_x, G_w, rounding, scales)
    return error / (given.rtol * (1.0 + abs(run.now[r_.W])))


def smallest(values: Monitors) -> float:
    """Return the least of the monitors, NaN if the first is."""
    least = values[0]
    for value in values:
        least = min(least, value)
    return least


def monitors(run: Run, record: Any, s: float) -> tuple[Monitors, float, float, float, float]:
    """Return what must stay positive, and F, dF/dd, dF/dv and v'."""
    now = motion(record, s) + sliding_now(run, s)
    d, v, dv, Y, number, _ = now
    allowed = run.given.allowed + ROUNDING * (abs(Y) + s * (abs(number) + abs(v)))
    sides = record[h_.LEFT_STATE : h_.LEFT_X]
    F, F_d, F_v, l, r = imbalance(run, sides, s, now)
    if sides[0] == FREE:
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
    state, node = run.states[k], run.tops[k]
    if state == TOUCHING:
        node = c_.reached(run, SIDES[k], node, s, now[0], now[3])
    return c_.slack(SIDES[k], state, run.nodes[node], s, xi, now)


def _locate(run: Run, record: Any, low: float, high: float) -> tuple[float, Monitors]:
    """Return the time of the first violation in (low, high], and the monitors just after it."""
    violated, earliest = monitors(run, record, high)[0], low
    at_low, at_high, turn = math.nan, smallest(violated), 0
    while high - low > EVENT_RESOLUTION * (1.0 + abs(high)):
        turn += 1
        middle = 0.5 * (low + high)
        if turn % 3 != 0 and not math.isnan(at_low):  # by halves now and then: secants may crawl
            secant = low + (high - low) * at_low / (at_low - at_high)
            margin = OFF_THE_ENDS * (high - low)
            middle = min(max(secant, low + margin), high - margin)
        values = monitors(run, record, middle)[0]
        value = smallest(values)
        if value < 0.0:
            high, at_high, violated = middle, value, values
        else:
            low, at_low = middle, value
    if low == run.now[r_.S]:
        return low, violated
    return (_touchdown(run, record, earliest, high) if run.states[0] == FREE else high), violated


def _touchdown(run: Run, record: Any, earliest: float, s: float) -> float:
    """Return when the gap is zero, from a time when it is negative by what a monitor allows.

    By a step of Newton's method: du/ds = -u on the ground, and dg/ds = p - g under the indenter.
    """
    d, v, _, Y, number, _ = motion(record, s) + sliding_now(run, s)
    depth, X, _, _, _ = summit(run, s, d, Y)
    rate = c_.pressure(X + Y, d, v, number) - depth
    return max(s - depth / rate, earliest) if rate > 0.0 else s
