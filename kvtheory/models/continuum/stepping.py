"""The walk from step to step: step lengths, events, and what the edges leave behind."""

import math
from typing import Any

from kvtheory.models.continuum import contact as c_
from kvtheory.models.continuum import dense_output as h_
from kvtheory.models.continuum import memory_chains as m_
from kvtheory.models.continuum import run as r_
from kvtheory.models.continuum.contact import FREE, PEELING, TOUCHING
from kvtheory.models.continuum.dense_output import motion
from kvtheory.models.continuum.run import SIDES, Run, has_room
from kvtheory.models.continuum.trial_step import Monitors, attempt, sliding_now, take_up
from kvtheory.scene import base_motion as b_

SAFETY = 0.9
SHORTEST = 1e-14
"""First step after a jump, relative to 1 + s: a shorter one would be lost in the rounding of the time."""
SHRINK, TINY = 0.2, 1e-12
OVERRUN = 1e-4
"""Share of a step that may lie beyond an event: the states of the edges change there, and a step that
ran farther is repeated with the right length."""
SEEN = 0.1
"""Of a step, or of what may lie beyond an event: a rest of the way so short is not worth a step, and a step
of which so much is lost in the rounding of the time cannot be made."""
BRIEF = 1e-10
"""A piece of a step up to an event so close to its start that it needs no repetition."""
REMAINDER = 1.1
"""Of what the step before left of its own way: a way no longer than this is taken whole."""
FORGOTTEN, QUIET = 40.0, 1e-3
"""After so many retardation times the foundation has forgotten, to the last digit, what was before; a depth
rate below this share of the tolerance is none."""
RELIEF = 0.25
"""How far the ground may slide in a step of the flight above it, in units of a_0."""
SMOOTH = 1e-9
"""Relative difference of lambda or lambda' at a joint of the drive that is only rounding."""
TOGGLE_LIMIT = 12
"""Changes of state at one instant; more than a few would mean that no state is consistent."""

DONE, PAUSED, FULL, STUCK, INCONSISTENT = range(5)
"""How a walk ended: at the end; after the attempts it was given; without room for another step; with
a step length of zero; without a consistent state of the edges."""

PEELS, TOUCHES, CROSSES, TAKE_OFF, LANDING = 0.0, 2.0, 4.0, 6.0, 7.0
"""Kinds of events, those of the left edge; the right edge adds 1."""
CHANGES = "peels", "touches", "crosses to older ground"
KINDS = (
    *(f"{side} edge {what}" for what in CHANGES for side in ("left", "right")),
    "take-off",
    "landing",
)


def walk(run: Run, attempts: int) -> int:
    """Walk to the end of the run, or for so many attempts at a step; say how it ended."""
    now = run.now
    for _ in range(attempts):
        if run.counts[r_.MET] == 0:
            if not has_room(run):
                return FULL
            _meet_drive(run)
            run.counts[r_.MET] = 1
        until = min(run.pieces[run.counts[r_.PIECE]][b_.END], run.given.end)
        if now[r_.S] >= run.given.end:
            return DONE
        if now[r_.S] >= until:
            run.counts[r_.PIECE] += 1
            run.counts[r_.MET] = 0
            continue
        if not has_room(run):
            return FULL
        status = _step(run, until)
        if status != DONE:
            return status
    return PAUSED


def _meet_drive(run: Run) -> None:
    """Let a jump of lambda detach strips, or turn peeling edges where the pressure rises."""
    now, index = run.now, run.counts[r_.PIECE]
    _, number, slope = b_.evaluate(run.pieces[index], now[r_.S])
    last = last_slope = rate = 0.0
    if index > 0:
        _, last, last_slope = b_.evaluate(run.pieces[index - 1], now[r_.S])
    jumps = abs(number - last) > SMOOTH * (1.0 + abs(number))
    changes = jumps or abs(slope - last_slope) > SMOOTH * (1.0 + abs(slope))
    run.counts[r_.SLIDE] = index
    if run.given.sprung:
        if run.counts[r_.SMOOTH] != 0:
            rate = motion(run.along[run.counts[r_.RECORDS] - 1], now[r_.S])[2]
        take_up(run, 1.0, rate)
    if jumps or index == 0:
        _restart(run)
    if changes:
        _begin_briefly(run, number, slope)
    Y, number, slope = sliding_now(run, now[r_.S])
    if run.states[0] != FREE:
        _detach(run, Y, number)
    if run.counts[r_.SMOOTH] != 0:
        _meet_kink(run, Y, number, slope)


def _begin_briefly(run: Run, number: float, slope: float) -> None:
    """After a kink or jump, let a step be no longer than lambda takes to change, and what came before lasted.

    A steep ramp from rest, and ground that was left in a short pulse, make the forces change in so short a
    time that a longer step would not see it.
    """
    now = run.now
    brief = (1.0 + abs(number)) / max(abs(slope), TINY)
    if now[r_.S] > now[r_.KINK]:
        brief = min(brief, now[r_.S] - now[r_.KINK])
    brief = max(run.given.control.first_step * brief, SHORTEST * (1.0 + now[r_.S]))
    now[r_.SPAN], now[r_.KINK] = min(now[r_.SPAN], brief), now[r_.S]


def _meet_kink(run: Run, Y: float, number: float, slope: float) -> None:
    """Let a peeling edge touch where a new slope of lambda lets the pressure rise, however briefly.

    The second derivative of the depth is known as well as the tolerance says.
    """
    now = run.now
    dv = motion(run.records[run.counts[r_.RECORDS] - 1], now[r_.S])[2]
    instant = now[r_.D], now[r_.V], dv, Y, number, slope
    for k in range(2):
        if run.states[k] == PEELING:
            row, xi = run.nodes[run.tops[k]], run.edges[k] + Y
            if c_.slack(SIDES[k], PEELING, row, now[r_.S], xi, instant)[0] < -run.given.rtol:
                _turn(run, k)


def _detach(run: Run, Y: float, number: float) -> None:
    now = run.now
    left, right = run.edges[0], run.edges[1]
    for k in range(2):
        side, X = SIDES[k], run.edges[k]
        p = c_.pressure(X + Y, now[r_.D], now[r_.V], number)
        allowed = run.given.allowed * (1.0 + abs(number) + abs(now[r_.V]))
        if p < -allowed:
            limit = c_.root(side, number, now[r_.D] + now[r_.V])[0] - Y
            if k == 0:
                left = max(limit, X)
            else:
                right = min(limit, X)
        elif p > allowed and run.states[k] == PEELING:
            _turn(run, k)
    if left >= right:
        _leave(run, Y)
        return
    for k, X in enumerate((left, right)):
        if run.edges[k] != X:
            if run.states[k] == TOUCHING:
                m_.trim(run, k, Y)
                _note(run, PEELS + k)
            run.states[k] = PEELING
            m_.push_strip(run, k, X, run.edges[k], Y)
            run.edges[k] = X


def _restart(run: Run) -> None:
    """Forget the step length, for v' jumps or is singular here."""
    now = run.now
    _, number, _ = sliding_now(run, now[r_.S])
    width = run.edges[1] - run.edges[0] if run.states[0] != FREE else 1.0
    fast = 1.0
    if not run.given.fixed:
        fast = run.given.eps / (run.given.eps + 0.75 * max(width, 1e-3))
    if run.given.sprung:
        eps = run.given.eps_x
        fast = min(fast, eps / (eps + run.given.damping + max(width, 1e-3)))
    span = run.given.control.first_step * fast / (1.0 + abs(number))
    now[r_.SPAN], run.counts[r_.SMOOTH] = max(span, SHORTEST * (1.0 + now[r_.S])), 0


def _note(run: Run, kind: float) -> None:
    event = run.events[run.counts[r_.EVENTS]]
    event[0], event[1] = run.now[r_.S], kind
    run.counts[r_.EVENTS] += 1


def _step(run: Run, until: float) -> int:
    """Try one step; keep it up to its first event, or try a shorter one next time."""
    now = run.now
    span, whole = min(now[r_.SPAN], _longest(run)), until - now[r_.S]
    if span >= whole:
        span = _share(run, whole) * whole
    if not now[r_.S] + SEEN * span > now[r_.S]:
        return STUCK
    if whole - span < SEEN * OVERRUN * span:
        span = whole
    record = run.records[run.counts[r_.RECORDS]]
    size, found, violated = attempt(run, record, span)
    until_event = found - now[r_.S]
    if BRIEF * (1.0 + now[r_.S]) < until_event < span / (1.0 + OVERRUN):
        run.counts[r_.REJECTED] += 1
        now[r_.SPAN] = _share(run, until_event) * (1.0 + 0.5 * OVERRUN) * until_event
        return DONE
    power = -1.0 / (len(run.given.method.nodes) + 1)
    factor = min(run.given.control.grow, max(SHRINK, SAFETY * math.pow(max(size, TINY), power)))
    if size > 1.0:
        run.counts[r_.REJECTED] += 1
        now[r_.SPAN] = span * factor
        return DONE
    now[r_.SPAN] = max(now[r_.SPAN], span * factor) if factor > 1.0 else span * factor
    end = until if span == whole else now[r_.S] + span
    if found < math.inf:
        end = found
    if end > now[r_.S]:
        if end - now[r_.S] > BRIEF * (1.0 + now[r_.S]):  # another instant: toggles are counted anew
            run.counts[r_.TOGGLES] = 0
        _commit(run, record, end)
    if found < math.inf:
        return _change(run, violated)
    run.counts[r_.TOGGLES] = 0
    return DONE


def _share(run: Run, way: float) -> float:
    """Return the share of the way to an event, or to the end of a piece, that a step takes at most.

    Not all of it if the motion began anew, by an event or on another piece, or if the way is long.
    """
    now, straight = run.now, run.given.control.straight
    at_piece = now[r_.S] == run.pieces[run.counts[r_.PIECE]][b_.START]
    if not at_piece and run.counts[r_.SMOOTH] != 0 and run.counts[r_.TOGGLES] == 0:
        left = (1.0 - straight) * run.records[run.counts[r_.RECORDS] - 1][h_.SPAN]
        if straight * way <= REMAINDER * left:
            return 1.0
    return straight


def _longest(run: Run) -> float:
    now, longest = run.now, run.given.control.longest
    if run.states[0] != FREE:
        return math.inf if _quiet(run) else longest
    _, number, slope = sliding_now(run, now[r_.S])
    speed = 0.5 * (abs(number) + math.sqrt(number * number + 2.0 * RELIEF * abs(slope)))
    slide = RELIEF / (RELIEF + speed)
    if now[r_.D] < 0.0:
        slide = max(slide, -0.5 * now[r_.D] / (abs(now[r_.V]) + 1e-3))
    return min(longest, slide)


def _quiet(run: Run) -> bool:
    """Whether nothing happens any more: steady sliding or rest, over ground that has been forgotten."""
    counts, piece = run.counts, run.pieces[run.counts[r_.PIECE]]
    changed = max(piece[b_.START], 0.0)
    if counts[r_.EVENTS] > 0:
        changed = max(changed, run.events[counts[r_.EVENTS] - 1][0])
    if counts[r_.SMOOTH] == 0 or run.now[r_.S] - changed < FORGOTTEN:
        return False
    for k in range(b_.POWERS + 1, len(piece)):
        if piece[k] != 0.0:
            return False
    last = counts[r_.RECORDS] - 1
    rate = _fastest(run.records[last])
    if run.given.sprung:
        rate = max(rate, _fastest(run.along[last]))
    return rate <= QUIET * run.given.rtol


def _fastest(record: Any) -> float:
    """Return the largest of the powers of a rate."""
    rate = 0.0
    for k in range(h_.POWERS, len(record)):
        rate = max(rate, abs(record[k]))
    return rate


def _commit(run: Run, record: Any, end: float) -> None:
    """Keep `record` up to `end`, and what the peeling edges swept meanwhile."""
    now = run.now
    Y_0, _, _ = sliding_now(run, now[r_.S])
    then = motion(record, end) + sliding_now(run, end)
    d, v, _, Y, _, _ = then
    if run.given.sprung:
        now[r_.X], now[r_.W], _ = motion(run.along[run.counts[r_.RECORDS]], end)
    index = run.counts[r_.RECORDS]
    run.counts[r_.RECORDS] += 1
    if run.states[0] != FREE:
        for k in range(2):
            xi, _, _, node = c_.edge(run, SIDES[k], run.states[k], run.tops[k], end, then)
            if run.states[k] == PEELING:
                row = run.nodes[m_.free_row(run)]
                m_.set_end(row, c_.IN_X, xi - Y, end, d, Y)
                m_.set_end(row, c_.OUT_X, run.edges[k], now[r_.S], now[r_.D], Y_0)
                m_.push(run, k, index, SIDES[k])
            else:
                run.tops[k] = node
            run.edges[k] = xi - Y
    now[r_.S], now[r_.D], now[r_.V], run.counts[r_.SMOOTH] = end, d, v, 1


def _change(run: Run, violated: Monitors) -> int:
    """Change the states that the event at the present time violates."""
    now = run.now
    # An edge that runs outward over ground that is there in many pieces leaves fewer each time.
    crosses = run.states[0] != FREE and violated[0] >= 0.0 and min(violated[2], violated[4]) < 0.0
    run.counts[r_.TOGGLES] = 1 if crosses else run.counts[r_.TOGGLES] + 1
    if run.counts[r_.TOGGLES] > TOGGLE_LIMIT:
        return INCONSISTENT
    Y, _, _ = sliding_now(run, now[r_.S])
    if run.states[0] == FREE:
        m_.land(run, Y)
        _note(run, LANDING)
        _restart(run)
    elif violated[0] < 0.0:
        _leave(run, Y)
    else:
        for k in range(2):
            state, ground = violated[2 * k + 1], violated[2 * k + 2]
            if ground < 0.0:
                run.tops[k] = int(run.nodes[run.tops[k]][c_.NEXT])
                _note(run, CROSSES + k)
            elif state < 0.0 and run.states[k] != FREE:
                _change_side(run, k, Y)
    return DONE


def _change_side(run: Run, k: int, Y: float) -> None:
    now = run.now
    if run.states[k] == PEELING:
        _turn(run, k)
        return
    if SIDES[k] * (run.edges[k] + Y + sliding_now(run, now[r_.S])[1]) <= 0.0:
        _leave(run, Y)  # the pressure fell to zero at the root of the other side
        return
    m_.trim(run, k, Y)
    run.states[k] = PEELING
    _note(run, PEELS + k)


def _turn(run: Run, k: int) -> None:
    run.states[k] = TOUCHING
    _note(run, TOUCHES + k)


def _leave(run: Run, Y: float) -> None:
    m_.leave(run, Y)
    _note(run, TAKE_OFF)
    _restart(run)
