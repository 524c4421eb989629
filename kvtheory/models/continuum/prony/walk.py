"""From step to step on a Prony series: step sizes, and events: edges turn, or pass to other ground."""

import math
from typing import NamedTuple

from kvtheory.models.continuum.prony import contact as c_
from kvtheory.models.continuum.prony import hops as h_
from kvtheory.models.continuum.prony.contact import Motion, pressed
from kvtheory.models.continuum.prony.records import NEVER, SMOOTH, Run
from kvtheory.models.continuum.prony.segments import (
    cross,
    in_contact,
    left_behind,
    restart_accumulators,
    split,
    turn,
)
from kvtheory.models.continuum.prony.step import prepare, size_of, solve
from kvtheory.models.continuum.run import (
    DONE,
    FREE,
    FULL,
    INCONSISTENT,
    PAUSED,
    PEELING,
    SIDES,
    STUCK,
    TOUCHING,
)
from kvtheory.scene import base_motion as b_

SAFETY, SHRINK, FAILED, TINY = 0.9, 0.2, 0.4, 1e-12
"""Margin and least factor of a step size, that after a step which did not converge, and the least error."""
SHORTEST, SHARP = 1e-13, 8.0
"""Least step relative to the run: a shorter one would be lost in rounding. A step of at most
`SHARP` of these is accepted with any error: past the layer of a fast arm, an edge moves abruptly."""
OVERRUN, PASSED, NEAR = 1e-6, 1e-12, 1e-13
"""Share of a step that may lie beyond an event, that beyond the end of an edge's segment, and share of the
run; a step that ran farther is repeated with the right length. Where an edge passes the end of its segment
within a step, the polynomials smooth out a kink, so the stresses that they remember jump at the event. An
edge that passes there later jumps too, much farther where the pressure hardly changes along the ground, and
no step size makes that smaller."""
BISECTIONS = 60
ALLOWED, ROUNDING, MORE = 1e-3, 1e-13, 8.0
"""Share of the tolerance, and least violation, that an event needs, and the factor on it after each change at
the same instant: where the pressure hardly changes at an edge, both states are right within the tolerance."""
LATE = 0.9
"""Share of a step before which an event, rather than the error, sets the length of the next attempt."""
PROBES = 3
"""Instants per stage at which events are looked for."""
TOGGLES = 12
"""Most changes at one instant; more than a few mean that no state of the edges is consistent."""

DEEPEST, LEAST, WATCHED, INSIDE = 100.0, 1e-8, 8, 24
"""Largest tension in the contact, or penetration outside, in units of the tolerance and G(0)/K; the least
tolerance there, which allows for rounding; segments of free ground that are watched on each side, and those
of the contact that are watched after a step: of more, all in turn."""
COPIES = 6
"""Copies of the contact's sequence of segments that one step and a change of the drive may need."""

APPROACH = 0.85
"""Largest share of the time until the contact closes that a step takes."""
RELIEF = 0.25
"""How far the ground may slide in a step of the flight above it, in units of a_0, if it is not far away."""


class Monitors(NamedTuple):
    """Event functions, which stay positive until an event: the width, and state and ground of both edges."""

    width: float
    state: tuple[float, float]
    ground: tuple[float, float]


NOTHING = Monitors(math.inf, (math.inf, math.inf), (math.inf, math.inf))


def walk(run: Run, attempts: int) -> int:
    """Integrate to the end of the run, or for at most `attempts` steps, tried or taken; return the status."""
    now, end = run.now, run.given.end
    if now.steps == 0 and now.span == math.inf:
        now.span = _first(run)
        if not h_.flies(run):
            _jump(run)
    for _ in range(attempts):
        until = min(run.pieces[now.piece, b_.END], end)
        if now.s >= end:
            return DONE
        if not _has_room(run):
            return FULL
        if now.s + SHORTEST * end >= until:
            now.s = until
            if until < end:
                _next_piece(run)
            continue
        restart_accumulators(run)
        status = _next_step(run, until)
        if status != DONE:
            return status
    return PAUSED


def _has_room(run: Run) -> bool:
    """Whether one more step is certain to fit, with its events."""
    now = run.now
    copied = now.segments if h_.flies(run) else 0
    fits = now.steps + 2 < len(run.steps) and now.segments + copied + 8 < len(run.segments)
    return fits and now.chain + COPIES * (3 * now.count + 8) < len(run.chain)


def _first(run: Run) -> float:
    """Return the step size just after a change of the drive: a share of the fastest time of the motion."""
    given, now = run.given, run.now
    if run.clock.paused[now.piece]:
        return float(run.pieces[now.piece, b_.END] - now.s)
    _, number, slope = b_.evaluate(run.pieces[now.piece], now.s)
    fast = 1.0 + abs(number) + math.sqrt(abs(slope))
    stiff = 1.5 * (1.0 + given.glass)
    if not given.fixed:
        fast += math.sqrt(stiff / given.eps) + 1.5 * given.damper / given.eps
    if given.sprung:
        fast += math.sqrt((given.spring + stiff) / given.eps_x)
    return float(given.first_step / fast)


def _next_piece(run: Run) -> None:
    """Begin a piece of the drive; where the velocity or its slope jumps, histories have a kink."""
    now, paused = run.now, run.clock.paused[run.now.piece]
    _, last, last_slope = b_.evaluate(run.pieces[now.piece], now.s)
    now.piece += 1
    _, number, slope = b_.evaluate(run.pieces[now.piece], now.s)
    jumps = paused or run.clock.paused[now.piece]
    jumps = jumps or abs(number - last) > SMOOTH * (1.0 + abs(number))
    if len(run.depths) > 0:
        jumps = jumps or run.depths[now.piece, 1] != now.v
        now.d, now.v = run.depths[now.piece, 0], run.depths[now.piece, 1]
    if jumps or abs(slope - last_slope) > SMOOTH * (1.0 + abs(slope)):
        now.span = _first(run) if paused else min(now.span, _first(run))
        if not h_.flies(run):
            for k in range(2):
                split(run, k)
            _jump(run)


def _jump(run: Run) -> None:
    """Let edges turn where a jump of the drive changes the rate of the pressure."""
    now, damped, at = run.now, run.given.damper > 0.0, c_.present(run)
    _, _, slope = b_.evaluate(run.pieces[now.piece], now.s)
    faster = 0.0  # d'' and lambda' while the clock runs in a pause
    if now.piece == 0 and run.clock.paused[0]:
        faster = run.given.start_rate / run.pieces[0, b_.END]
        slope -= run.given.start_along / run.pieces[0, b_.END]
    if len(run.depths) > 0:
        faster = run.depths[now.piece, 2]
    for k in range(2):
        side = now.sides[k]
        peels = side.state == PEELING
        if peels and damped and not run.clock.paused[now.piece]:
            continue  # its motion tells, see `_keeps`
        rise = left_behind(run, k) if peels else side.rise
        rises, terms = _pressing(side.xi, at.v, at.number, rise)
        if damped and abs(rises) <= _allowed(run) * terms:  # p = 0, and its rate tells
            rises = faster - 2.0 * side.xi * slope
            terms = 1.0 + abs(faster) + abs(slope)
        if (-rises if peels else rises) < -_allowed(run) * terms:
            turn(run, k)


def _pressing(xi: float, v: float, number: float, rise: float) -> tuple[float, float]:
    """Return how much faster the indenter presses at an edge than free ground rises there, and the terms."""
    pressed = v - 2.0 * xi * number
    return pressed - rise, 1.0 + abs(v) + 2.0 * abs(xi * number) + abs(rise)


def _allowed(run: Run) -> float:
    """Return the violation that an event needs."""
    return least_violation(run.given.rtol) * math.pow(MORE, run.now.toggles)


def least_violation(rtol: float) -> float:
    """Return the least violation that an event needs, of rates relative to 1 + their size."""
    return float(max(ALLOWED * rtol, ROUNDING))


def monitors(run: Run, theta: float, exact: bool) -> Monitors:
    """Return the event functions at a share of the step; in flight the gap is in the place of the width.

    Where an edge passes the end of its segment within the step, its polynomial has a kink to follow, but p,
    or the gap, at this end has none: with `exact` it is the event function.
    """
    now, index = run.now, run.now.steps
    at = c_.motion(run, index, now.s + theta * run.steps[index].span)
    if h_.flies(run):
        gap = h_.least_gap(run, at).size + h_.closed(run) * h_.closed(run)
        return Monitors(gap, NOTHING.state, NOTHING.ground)
    edges = run.polynomials.edges[index]
    l, r = c_.value(edges[:, 0], theta), c_.value(edges[:, 1], theta)
    l_ground, r_ground = _ahead(run, 0, l, at.Y), _ahead(run, 1, r, at.Y)
    if exact:
        c_.accumulated(run, index, theta)
        middle = 0.5 * (l + r)
        l_ground, r_ground = c_.at_far_end(run, 0, at, middle), c_.at_far_end(run, 1, at, middle)
    l_state, r_state = _keeps(run, 0, at), _keeps(run, 1, at)
    return Monitors(r - l, (l_state, r_state), (l_ground, r_ground))


def _keeps(run: Run, k: int, at: Motion) -> float:
    """Return a number that is positive as long as an edge may keep its state.

    It touches as long as the indenter presses faster than the free surface there rises. One that peels moves
    inward over the ground, but for the error of its polynomial: its p' has the right
    sign then, but is lost in the terms of a stiff arm.
    """
    now, n, index = run.now, run.given.stages, run.now.steps
    powers, theta = run.polynomials.edges[index, :, k], at.theta
    if now.sides[k].state == PEELING:
        outward = SIDES[k] * (c_.derivative(powers, theta) - run.steps[index].lasts * at.number)
        error = n * (n + 1) * run.given.last_power * abs(powers[n])
        return error + _allowed(run) - outward
    rise = c_.value(run.polynomials.rise[index, :, k], theta)
    rises, terms = _pressing(c_.value(powers, theta), at.v, at.number, rise)
    return rises / terms + _allowed(run)


def _ahead(run: Run, k: int, xi: float, Y: float) -> float:
    """Return how far an edge is from the end of its segment."""
    side = run.now.sides[k]
    if c_.ends_never(run, k):
        return math.inf
    segment = run.segments[side.segment]
    if segment.edge != k and segment.b == math.inf:
        return math.inf
    inward = SIDES[k] if side.state == PEELING else -SIDES[k]
    end = segment.X_a if segment.edge == k else segment.X_b
    return float(inward * (xi - Y - end) + ROUNDING * (1.0 + abs(Y)))


def _smallest(values: Monitors) -> float:
    state, ground = values.state, values.ground
    return min(values.width, state[0], ground[0], state[1], ground[1])


def _event(run: Run) -> tuple[float, Monitors]:
    """Return the first event as a share of the step, infinite if there is none, and the monitors after it."""
    count, low = PROBES * run.given.stages, 0.0
    for m in range(1, count + 1):
        high = m / count
        violated = monitors(run, high, False)
        if _smallest(violated) < 0.0:
            precise = monitors(run, high, True)
            exact = _smallest(precise) < 0.0 and not h_.flies(run)
            if exact:
                low, violated = 0.0, precise
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                values = monitors(run, middle, exact)
                if _smallest(values) < 0.0:
                    high, violated = middle, values
                else:
                    low = middle
            return high, violated
        low = high
    return math.inf, violated


def _next_step(run: Run, until: float) -> int:
    """Try one step, in contact or in flight, or close the contact."""
    if h_.flies(run):
        return _fly(run, until)
    left, shortest = h_.time_left(run), SHORTEST * run.given.end
    if h_.closes(run, left, shortest):
        return _close(run, min(max(left, 4.0 * shortest), until - run.now.s), until)
    return _advance(run, until, APPROACH * left)


def _advance(run: Run, until: float, longest: float) -> int:
    """Try one step; accept it up to its first event, or reduce the step size for the next attempt."""
    now, shortest = run.now, SHORTEST * run.given.end
    span = min(_length(run, until, longest), now.limit)
    if not span > shortest:
        return STUCK
    size, limited = _attempt(run, span), now.limit < math.inf
    now.limit = math.inf
    theta, violated = _event(run) if size < math.inf else (math.inf, NOTHING)
    resolved = span > SHARP * shortest or size == math.inf
    if resolved and size > 1.0 and not theta < LATE:
        return _reject(run, span, size)
    if theta * span <= shortest:
        now.rejected += 1
        return _change(run, violated)
    overrun = PASSED if min(violated.ground[0], violated.ground[1]) < 0.0 else OVERRUN
    if theta < 1.0 - overrun and (1.0 - theta) * span > NEAR * run.given.end:
        now.limit = theta * (1.0 + 0.5 * overrun) * span
        if size > 1.0:  # what lies beyond the event is no better
            return _reject(run, span, size)
        now.rejected += 1
        return DONE
    longer = max(_longer(run, span, size), SHARP * shortest)
    now.span = max(now.span, longer) if limited and theta <= 1.0 else longer
    if size > 1.0 and not h_.flies(run):  # no polynomial follows what is that abrupt
        l, r, edges = now.sides[0].xi, now.sides[1].xi, run.stages.edges
        h_.end_with(run, l, r, edges[run.given.stages - 1, 0], edges[run.given.stages - 1, 1])
    _commit(run, span, until, min(theta, 1.0))
    return _after(run, theta, violated)


def _after(run: Run, theta: float, violated: Monitors) -> int:
    """Check the contact after a step, and handle its event."""
    interval = _one_interval(run)
    run.now.steps, run.now.toggles = run.now.steps + 1, 0
    if not interval:
        return INCONSISTENT
    return _change(run, violated) if theta <= 1.0 else DONE


def _length(run: Run, until: float, longest: float) -> float:
    """Return the length of the next step, at most `longest`; one that almost ends at `until` does.

    Not one that an event limits: if this lies just before `until`, the step would pass it again and again.
    """
    now = run.now
    span, whole = min(now.span, run.given.longest, longest), until - now.s
    return float(whole if span > (1.0 - 0.1 * OVERRUN) * whole else span)


def _attempt(run: Run, span: float) -> float:
    """Try a step; return its error relative to the tolerance, infinite if it is not solved."""
    prepare(run, span)
    return float(size_of(run) if solve(run) else math.inf)


def _reject(run: Run, span: float, size: float) -> int:
    """Reject a step whose error is too large; the next one is shorter."""
    run.now.rejected += 1
    shorter = FAILED
    if size < math.inf:
        shorter = max(SHRINK, SAFETY * math.pow(size, -1.0 / run.given.stages))
    run.now.span = shorter * span
    return DONE


def _longer(run: Run, span: float, size: float) -> float:
    """Return the length of the step after one with an error `size`."""
    factor = SAFETY * math.pow(max(size, TINY), -1.0 / run.given.stages)
    return float(span * min(run.given.grow, factor))


def _close(run: Run, span: float, until: float) -> int:
    """Take the step in which the contact closes, and begin a flight."""
    if not h_.close(run, span):
        return STUCK
    _commit(run, span, until, 1.0)
    run.now.steps, run.now.toggles = run.now.steps + 1, 0
    h_.fly(run)
    run.now.span = _first(run)
    return DONE


def _fly(run: Run, until: float) -> int:
    """Try one step in flight; accept it up to the landing."""
    now, shortest = run.now, SHORTEST * run.given.end
    _, drive, slope = b_.evaluate(run.pieces[now.piece], now.s)
    relief = max(RELIEF, 0.5 * h_.distance(run))
    slides = relief / (abs(drive - now.w) + math.sqrt(relief * abs(slope)) + TINY)
    span = _length(run, until, max(slides, -0.5 * now.d / (abs(now.v) + 1e-3)))
    if not span > shortest:
        return STUCK
    size = _attempt(run, span)
    if not size <= 1.0:
        return _reject(run, span, size)
    theta, _ = _event(run)
    side, number, x, touches = 0, NEVER, 0.0, theta
    if theta <= 1.0:
        at = c_.motion(run, now.steps, now.s + theta * span)
        _, side, number, x = h_.least_gap(run, at)
        touches = h_.touches_at(run, theta, number, x)
    now.span = _longer(run, span, size)
    if touches * span > shortest:
        _commit(run, span, until, min(touches, 1.0))
        now.steps += 1
    if theta > 1.0:
        return DONE
    h_.land(run, side, number, x)
    if not h_.open_contact(run, max((theta - touches) * span, h_.SHORTEST_OPENING * run.given.end)):
        return STUCK
    _commit(run, now.span, until, 1.0)
    now.steps += 1
    return DONE


def _change(run: Run, violated: Monitors) -> int:
    """Change what the event at the present time violates."""
    now = run.now
    now.toggles += 1
    if violated.width < 0.0:
        return _close(run, 4.0 * SHORTEST * run.given.end, math.inf)
    if now.toggles > TOGGLES:
        return STUCK
    for k in range(2):
        if violated.ground[k] < 0.0:
            cross(run, k)
            if now.count == 0:
                return _close(run, 4.0 * SHORTEST * run.given.end, math.inf)
        elif violated.state[k] < 0.0:
            turn(run, k)
    return DONE


def _one_interval(run: Run) -> bool:
    """Whether the pressure is positive within the contact and the ground is free outside, at some elements.

    It is so on any number of arms (theorem F17-interval): a violation beyond the tolerance is a numerical
    failure. The elements are the first, the middle and the last of each segment.
    """
    now, l, r = run.now, run.now.sides[0].xi, run.now.sides[1].xi
    least = -DEEPEST * max(run.given.rtol, LEAST) * (1.0 + run.given.glass)
    at, Y = c_.present(run), c_.present(run).Y
    c_.at_present(run)
    apart = 1 + now.count // INSIDE
    for i in range(now.first + now.steps % apart, now.first + now.count, apart):
        segment = run.segments[run.chain[i]]
        low, high = in_contact(run, run.chain[i])
        for half in range(3):
            share = 0.5 * half
            if segment.step == NEVER:
                x = low + share * (high - low) + Y
                p, xi = pressed(run, at, x, segment.edge, NEVER, 0.0)
            else:
                x = low + share * (high - low)
                index = c_.step_of(run, segment.edge, segment.step, x)
                p, xi = pressed(run, at, 0.0, segment.edge, index, x)
            if l < xi < r and p < least:
                return False
    for k in range(2):
        side = now.sides[k]
        number, count = side.own if side.state == PEELING else side.segment, 0
        while number != NEVER and count < WATCHED:
            segment = run.segments[number]
            for half in range(3 if segment.step != NEVER else 0):
                x = segment.a + 0.5 * half * (min(segment.b, now.s) - segment.a)
                index = c_.step_of(run, segment.edge, segment.step, x)
                gap, xi = c_.free(run, at, segment.edge, index, x)
                if SIDES[k] * (xi - side.xi) > 0.0 and gap < least:
                    return False
            number, count = segment.next, count + 1
    return True


def _commit(run: Run, span: float, until: float, theta: float) -> None:
    """Accept a step up to the share `theta` of it: the state there becomes the present one."""
    now, begun, stages, polynomials = run.now, run.now.s, run.stages, run.polynomials
    last, index, whole = run.given.stages - 1, now.steps, theta == 1.0
    rate, along = polynomials.depth_rate[index], polynomials.offset_rate[index]
    end = until if whole and now.s + span >= until else now.s + theta * span
    if whole:
        now.d, now.x = float(stages.depth[last]), float(stages.offset[last])
    else:
        now.d += run.steps[index].lasts * c_.integral(rate, theta)
        now.x += run.steps[index].lasts * c_.integral(along, theta)
    now.v = stages.depth_rate[last] if whole else c_.value(rate, theta)
    now.w = stages.offset_rate[last] if whole else c_.value(along, theta)
    _commit_arms(run, theta)
    at = c_.motion(run, index, end)
    for k in range(2):
        side, before = now.sides[k], now.sides[k].sigma
        step, sigma = int(stages.entry_step[last, k]), float(stages.entry_time[last, k])
        edge = polynomials.edges[index, :, k]
        side.xi = stages.edges[last, k] if whole else c_.value(edge, theta)
        side.compression, side.rise = stages.compression[last, k], stages.rise[last, k]
        if not whole:
            side.compression = c_.value(polynomials.compression[index, :, k], theta)
            side.rise = c_.value(polynomials.rise[index, :, k], theta)
        if not whole and side.segment != NEVER and side.state != FREE:
            c_.at_present(run)
            guess = before + theta * (sigma - before)
            xi, step, sigma = c_.edge_at(run, k, at, side.xi, step, guess)
            if abs(xi) < math.inf:
                side.xi = xi
                if side.state == TOUCHING:
                    side.compression, side.rise = now.compression, now.rise
                for i in c_.over(run.given.arms):
                    run.state.stress_at_edge[i, k] = run.element.stress[i]
        side.index, side.sigma = step, sigma
        if side.segment != NEVER:
            side.pace = (sigma - before) / (end - begun)
    now.s, now.smooth = end, True
    now.kinked[0] = now.kinked[1] = 0


def _commit_arms(run: Run, theta: float) -> None:
    """Let the state of the arms be that at the share `theta` of the step."""
    state, memory, stages, index = run.state, run.memory, run.arm_stages, run.now.steps
    last = run.given.stages - 1
    for i in c_.over(run.given.arms):
        if theta == 1.0:
            state.accumulated_depth[i] = stages.accumulated_depth[i, last]
            state.accumulated_slide[i] = stages.accumulated_slide[i, last]
            state.force[i], state.moment[i] = stages.force[i, last], stages.moment[i, last]
        else:
            state.accumulated_depth[i] = c_.past(memory.accumulated_depth, index, i, theta)
            state.accumulated_slide[i] = c_.past(memory.accumulated_slide, index, i, theta)
            state.force[i] = c_.past(memory.force, index, i, theta)
            state.moment[i] = c_.past(memory.moment, index, i, theta)
        for k in range(2):
            at_end = stages.stress_at_edge[i, last, k]
            state.stress_at_edge[i, k] = (
                at_end if theta == 1.0 else c_.past_stress(run, index, i, k, theta)
            )
