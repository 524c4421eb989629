"""Time stepping: step sizes, events, and the ground that the edges leave behind."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import memory_chains as m_
from kvtheory.models.continuum.contact import motion
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
    Run,
    has_room,
    set_off,
)
from kvtheory.models.continuum.trial_step import Monitors, attempt, begin_along, sliding_now
from kvtheory.scene import base_motion as b_

SAFETY = 0.9
SHORTEST = 1e-14
"""Least first step after a jump, relative to 1 + s: a shorter one would be lost in rounding."""
SHRINK, TINY = 0.2, 1e-12
OVERRUN = 1e-4
"""Share of a step that may lie beyond an event: the states of the edges change there, and a step that
ran farther is repeated with the right length."""
SEEN = 0.1
"""Share of a step, or of its allowed overrun: a shorter remainder is not worth a step. No step is possible if
this share of it is lost in the rounding of the time."""
BRIEF = 1e-10
"""A step with an event this soon after its start need not be repeated."""
REMAINDER = 1.1
"""Factor on the distance to an event that the previous step left: up to this, one step covers it."""
DECAYED, STEADY = 40.0, 1e-3
"""Retardation times after which memory has decayed to the last digit; share of the tolerance below which a
rate counts as zero."""
RELIEF = 0.25
"""How far the ground may slide in a step of the flight above it, in units of a_0."""
SMOOTH = 1e-9
"""Relative difference of lambda or lambda' between pieces of the drive that counts as rounding."""
TOGGLE_LIMIT = 12
"""Most changes of state at one instant; more than a few mean that no state is consistent."""

PEELS, TOUCHES, CROSSES, TAKE_OFF, LANDING = 0, 2, 4, 6, 7
"""Kinds of events, those of the left edge; the right edge adds 1."""
KINDS = (
    "left edge peels", "right edge peels", "left edge touches", "right edge touches",
    "left edge crosses to older ground", "right edge crosses to older ground", "take-off", "landing",
)  # fmt: skip


def walk(run: Run, attempts: int) -> int:
    """Integrate to the end of the run, or for at most `attempts` steps, tried or taken; return the status."""
    now, end = run.now, run.given.end
    if now.nodes == 0:
        set_off(run)
    for _ in range(attempts):
        if not now.met:
            if not has_room(run):
                return FULL
            _start_piece(run)
            now.met = True
        until = min(run.pieces[now.piece][b_.END], end)
        if now.s >= end:
            return DONE
        if now.s >= until:
            now.piece += 1
            now.met = False
            continue
        if not has_room(run):
            return FULL
        status = _advance(run, until)
        if status != DONE:
            return status
    return PAUSED


def _start_piece(run: Run) -> None:
    """Start a piece of the drive: a jump of lambda or a given d' detaches strips, or peeling edges touch.

    The step after a kink is limited by the time in which lambda changes, and by the time since the last
    kink: a steep ramp from rest, and ground that was left in a short pulse, make the forces change in so
    short a time that a longer step would miss it.
    """
    now, index = run.now, run.now.piece
    _, number, slope = b_.evaluate(run.pieces[index], now.s)
    last = last_slope = rate = 0.0
    if index > 0:
        _, last, last_slope = b_.evaluate(run.pieces[index - 1], now.s)
    jumps = abs(number - last) > SMOOTH * (1.0 + abs(number))
    if len(run.depths) > 0:
        jumps = jumps or run.depths[index][1] != now.v
        now.d, now.v = run.depths[index][0], run.depths[index][1]
    now.slide = index
    if run.given.sprung:
        if now.smooth:
            rate = motion(run.along[now.steps - 1], now.s)[2]
        begin_along(run, 1.0, rate)
    if jumps or index == 0:
        _restart(run)
    if jumps or abs(slope - last_slope) > SMOOTH * (1.0 + abs(slope)):
        brief = (1.0 + abs(number)) / max(abs(slope), TINY)
        if now.s > now.kink:
            brief = min(brief, now.s - now.kink)
        brief = max(run.given.first_step * brief, SHORTEST * (1.0 + now.s))
        now.span, now.kink = min(now.span, brief), now.s
    Y, number, slope = sliding_now(run, now.s)
    if now.sides[0].state != FREE:
        _detach(run, Y, number)
    if now.smooth:
        _turn_at_kink(run, Y, number, slope)


def _turn_at_kink(run: Run, Y: float, number: float, slope: float) -> None:
    """Let a peeling edge touch if a new slope of lambda makes the pressure rise, however briefly.

    The second derivative of the depth is known only to the tolerance.
    """
    now = run.now
    dv = motion(run.steps[now.steps - 1], now.s)[2]
    instant = now.d, now.v, dv, Y, number, slope
    for k in range(2):
        side = now.sides[k]
        if side.state == PEELING:
            slack = c_.slack(SIDES[k], PEELING, run.nodes[side.node], now.s, side.X + Y, instant)
            if slack[0] < -run.given.rtol:
                _turn(run, k)


def _detach(run: Run, Y: float, number: float) -> None:
    """Detach strips, or let peeling edges touch, where a jump of lambda changes the pressure."""
    now = run.now
    left, right = now.sides[0].X, now.sides[1].X
    allowed = run.given.allowed * (1.0 + abs(number) + abs(now.v))
    for k in range(2):
        X = now.sides[k].X
        p = c_.pressure(X + Y, now.d, now.v, number)
        if p < -allowed:
            limit = c_.root(SIDES[k], number, now.d + now.v)[0] - Y
            if k == 0:
                left = max(limit, X)
            else:
                right = min(limit, X)
        elif p > allowed and now.sides[k].state == PEELING:
            _turn(run, k)
    if left >= right:
        _leave(run, Y)
        return
    for k, X in enumerate((left, right)):
        side = now.sides[k]
        if side.X != X:
            if side.state == TOUCHING:
                m_.trim(run, k, Y)
                _note(run, PEELS + k)
            side.state = PEELING
            m_.push_strip(run, k, X, side.X, Y)
            side.X = X


def _restart(run: Run) -> None:
    """Reset the step size, for v' jumps or is singular here."""
    now, given = run.now, run.given
    _, number, _ = sliding_now(run, now.s)
    width = now.sides[1].X - now.sides[0].X if now.sides[0].state != FREE else 1.0
    fast = 1.0
    if not given.fixed:
        fast = given.eps / (given.eps + 0.75 * max(width, 1e-3))
    if given.sprung:
        fast = min(fast, given.eps_x / (given.eps_x + given.damping + max(width, 1e-3)))
    span = given.first_step * fast / (1.0 + abs(number))
    now.span, now.smooth = max(span, SHORTEST * (1.0 + now.s)), False


def _note(run: Run, kind: int) -> None:
    event = run.events[run.now.events]
    event.s, event.kind = run.now.s, kind
    run.now.events += 1


def _advance(run: Run, until: float) -> int:
    """Try one step; accept it up to its first event, or reduce the step size for the next attempt."""
    now = run.now
    span, whole = min(now.span, _longest(run)), until - now.s
    if span >= whole:
        span = _share(run, whole) * whole
    if not now.s + SEEN * span > now.s:
        return STUCK
    if whole - span < SEEN * OVERRUN * span:
        span = whole
    step = run.steps[now.steps]
    size, found, violated = attempt(run, step, span)
    until_event = found - now.s
    if BRIEF * (1.0 + now.s) < until_event < span / (1.0 + OVERRUN):
        now.rejected += 1
        now.span = _share(run, until_event) * (1.0 + 0.5 * OVERRUN) * until_event
        return DONE
    power = -1.0 / (run.method.stages + 1)
    factor = min(run.given.grow, max(SHRINK, SAFETY * math.pow(max(size, TINY), power)))
    if size > 1.0:
        now.rejected += 1
        now.span = span * factor
        return DONE
    now.span = max(now.span, span * factor) if factor > 1.0 else span * factor
    end = until if span == whole else now.s + span
    if found < math.inf:
        end = found
    if end > now.s:
        if end - now.s > BRIEF * (1.0 + now.s):  # another instant: restart the count of toggles
            now.toggles = 0
        _commit(run, step, end)
    if found < math.inf:
        return _change(run, violated)
    now.toggles = 0
    return DONE


def _share(run: Run, way: float) -> float:
    """Return the largest share of the time to an event, or to the end of a piece, that a step takes.

    It is below 1 just after an event, on a new piece, or if that time is long.
    """
    now, straight = run.now, run.given.straight
    at_piece = now.s == run.pieces[now.piece][b_.START]
    if not at_piece and now.smooth and now.toggles == 0:
        left = (1.0 - straight) * run.steps[now.steps - 1].span
        if straight * way <= REMAINDER * left:
            return 1.0
    return straight


def _longest(run: Run) -> float:
    """Return the upper bound of the step size."""
    now, longest = run.now, run.given.longest
    if now.sides[0].state != FREE:
        return math.inf if _steady(run) else longest
    _, number, slope = sliding_now(run, now.s)
    speed = 0.5 * (abs(number) + math.sqrt(number * number + 2.0 * RELIEF * abs(slope)))
    slide = RELIEF / (RELIEF + speed)
    if now.d < 0.0:
        slide = max(slide, -0.5 * now.d / (abs(now.v) + 1e-3))
    return min(longest, slide)


def _steady(run: Run) -> bool:
    """Whether the motion is steady, sliding or at rest, and memory has decayed."""
    now, piece, last = run.now, run.pieces[run.now.piece], run.now.steps - 1
    changed = max(piece[b_.START], 0.0)
    if now.events > 0:
        changed = max(changed, run.events[now.events - 1].s)
    if not now.smooth or now.s - changed < DECAYED:
        return False
    for k in range(b_.POWERS + 1, len(piece)):
        if piece[k] != 0.0:
            return False
    fastest = 0.0
    for k in range(len(run.steps[last].rate)):
        fastest = max(fastest, abs(run.steps[last].rate[k]))
        if run.given.sprung:
            fastest = max(fastest, abs(run.along[last].rate[k]))
    return fastest <= STEADY * run.given.rtol


def _commit(run: Run, step: Any, end: float) -> None:
    """Accept a step up to `end`, and store the ground that the peeling edges swept in it."""
    now, index = run.now, run.now.steps
    Y_0, _, _ = sliding_now(run, now.s)
    then = motion(step, end) + sliding_now(run, end)
    d, v, _, Y, _, _ = then
    if run.given.sprung:
        now.x, now.w, _ = motion(run.along[index], end)
    now.steps += 1
    if now.sides[0].state != FREE:
        for k in range(2):
            side = now.sides[k]
            xi, _, _, reached = c_.edge(run, k, side, end, then)
            if side.state == PEELING:
                node = run.nodes[now.nodes]
                m_.set_place(node.inner, xi - Y, end, d, Y)
                m_.set_place(node.outer, side.X, now.s, now.d, Y_0)
                m_.push(run, k, index, SIDES[k])
            else:
                side.node = reached
            side.X = xi - Y
    now.s, now.d, now.v, now.smooth = end, d, v, True


def _change(run: Run, violated: Monitors) -> int:
    """Change the edge states that are violated by the event at the present time."""
    now = run.now
    flies = now.sides[0].state == FREE
    # An edge that runs outward over ground in many pieces crosses each of them only once.
    crosses = not flies and violated[0] >= 0.0 and min(violated[2], violated[4]) < 0.0
    now.toggles = 1 if crosses else now.toggles + 1
    if now.toggles > TOGGLE_LIMIT:
        return INCONSISTENT
    Y, number, _ = sliding_now(run, now.s)
    if flies:
        m_.land(run, Y)
        _note(run, LANDING)
        _restart(run)
    elif violated[0] < 0.0:
        _leave(run, Y)
    else:
        for k in range(2):
            side, state, ground = now.sides[k], violated[2 * k + 1], violated[2 * k + 2]
            if ground < 0.0:
                side.node = run.nodes[side.node].next
                _note(run, CROSSES + k)
            elif not state < 0.0 or side.state == FREE:
                continue
            elif side.state == PEELING:
                _turn(run, k)
            elif SIDES[k] * (side.X + Y + number) <= 0.0:
                _leave(run, Y)  # the pressure fell to zero at the root of the other side
            else:
                m_.trim(run, k, Y)
                side.state = PEELING
                _note(run, PEELS + k)
    return DONE


def _turn(run: Run, k: int) -> None:
    run.now.sides[k].state = TOUCHING
    _note(run, TOUCHES + k)


def _leave(run: Run, Y: float) -> None:
    m_.leave(run, Y)
    _note(run, TAKE_OFF)
    _restart(run)
