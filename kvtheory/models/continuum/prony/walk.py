"""From step to step on a Prony series: step sizes, kinks of the history, the limits of one-way sliding."""

import math
from typing import Any

from kvtheory.models.continuum.prony.contact import (
    ALONG,
    AT_REST,
    EDGE,
    OWN,
    PER_ARM,
    RATE,
    integral,
    motion,
    value,
)
from kvtheory.models.continuum.prony.step import (
    DEPTH,
    FALL,
    NUMBER,
    OFFSET,
    OLDEST,
    RISE,
    SIGMA,
    SWING,
    prepare,
    size_of,
    solve,
)
from kvtheory.scene import base_motion as b_

SAFETY, SHRINK, FAILED, TINY = 0.9, 0.2, 0.4, 1e-12
"""Margin and least factor of a step size, that after a step which did not converge, and the least error."""
SHORTEST = 1e-13
"""Least step relative to the run: a shorter one would be lost in rounding."""
OVERRUN = 1e-4
"""Share of a step that may lie beyond a kink; one that ran farther is repeated with the right length."""
BISECTIONS = 60
ALLOWED = 1e-3
"""Share of the tolerance by which an edge may seem to go back."""
BETWEEN = 4
"""Points per stage at which the leading edge is watched."""

DONE, PAUSED, FULL, STUCK, RETOUCHES, RECEDES = range(6)
"""How a walk ended: at the end; after the allowed attempts; without room for another step; with a step size
of zero, as where the contact closes; where the trailing edge would return to ground that it left; where the
leading edge would leave ground."""

Run = Any


def walk(run: Run, attempts: int) -> int:
    """Integrate to the end of the run, or for at most `attempts` steps, tried or taken; return the status."""
    now, end = run.now, run.given.end
    if now.steps == 0 and now.span == math.inf:
        now.span = _first(run)
    for _ in range(attempts):
        until = min(run.pieces[now.piece, b_.END], end)
        if now.s >= end:
            return DONE
        if now.s + SHORTEST * end >= until:
            now.s = until
            if until < end:
                _next_piece(run)
            continue
        if now.steps + 1 >= len(run.steps):
            return FULL
        status = _advance(run, until)
        if status != DONE:
            return status
    return PAUSED


def _first(run: Run) -> float:
    """Return the step size just after a change of the drive: a share of the fastest time of the motion."""
    given, now = run.given, run.now
    _, number, slope = b_.evaluate(run.pieces[now.piece], now.s)
    fast = 1.0 + abs(number) + math.sqrt(abs(slope))
    stiff = 1.5 * (1.0 + given.glass)
    if not given.fixed:
        fast += math.sqrt(stiff / given.eps)
    if given.sprung:
        fast += math.sqrt((given.spring + stiff) / given.eps_x)
    return float(given.first_step / fast)


def _next_piece(run: Run) -> None:
    """Begin a piece of the drive; where the velocity or its slope jumps, the history has a kink."""
    now = run.now
    _, last, last_slope = b_.evaluate(run.pieces[now.piece], now.s)
    now.piece += 1
    _, number, slope = b_.evaluate(run.pieces[now.piece], now.s)
    jumps = abs(number - last) > 1e-9 * (1.0 + abs(number))
    if jumps or abs(slope - last_slope) > 1e-9 * (1.0 + abs(slope)):
        now.kinked = True
        now.span = min(now.span, _first(run))


def _advance(run: Run, until: float) -> int:
    """Try one step; accept it up to its first kink, or reduce the step size for the next attempt."""
    now, n = run.now, run.given.stages
    span, whole = min(now.span, run.given.longest), until - now.s
    if span > (1.0 - 0.1 * OVERRUN) * whole:
        span = whole
    if not span > SHORTEST * run.given.end:
        return STUCK
    prepare(run, span)
    if not solve(run):
        now.rejected += 1
        now.span = FAILED * span
        return DONE
    size = size_of(run)
    if not size <= 1.0:
        now.rejected += 1
        now.span = (
            span * max(SHRINK, SAFETY * math.pow(size, -1.0 / n))
            if size < math.inf
            else FAILED * span
        )
        return DONE
    theta, kink = _passed(run, span)
    if theta < 1.0 - OVERRUN:
        now.rejected += 1
        now.span = theta * (1.0 + 0.5 * OVERRUN) * span
        return DONE
    status = _limits(run, min(theta, 1.0))
    if status != DONE:
        return status
    now.span = span * min(run.given.grow, SAFETY * math.pow(max(size, TINY), -1.0 / n))
    _commit(run, span, until, min(theta, 1.0))
    if kink >= 0:
        now.kinked = now.oldest == AT_REST
        now.oldest, now.sigma = kink, run.steps[kink].start
    return DONE


def _passed(run: Run, span: float) -> tuple[float, int]:
    """Return when the trailing edge passes a kink, as a share of the step, and the step that begins there."""
    now, at = run.now, run.now.oldest + 1
    while at <= now.steps and not run.steps[at].kinked:
        at += 1
    if at > now.steps or _ahead(run, span, at, 1.0) >= 0.0:
        return math.inf, AT_REST
    low, high = 0.0, 1.0
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if _ahead(run, span, at, middle) >= 0.0:
            low = middle
        else:
            high = middle
    return high, at


def _ahead(run: Run, span: float, at: int, theta: float) -> float:
    """Return how far the trailing edge is from the place where the leading edge was when a step began."""
    s = run.now.s + theta * span
    _, _, Y, _, _ = motion(run, run.now.steps, s)
    return value(run.rows[run.now.steps, EDGE], theta) - Y - float(run.steps[at].lead)


def _limits(run: Run, until: float) -> int:
    """Return whether an edge would go back before the share `until` of the step."""
    given, now = run.given, run.now
    for j in range(given.stages):
        place = run.places[j]
        if run.nodes[j] > until:
            break
        number = place[NUMBER] - place[SWING]
        terms = (1.0 + given.glass) * (1.0 + abs(place[FALL]) + abs(number))
        if place[RISE] > ALLOWED * given.rtol * terms:
            return RETOUCHES
    for j in range(1, BETWEEN * given.stages + 1):
        theta = until * j / (BETWEEN * given.stages)
        d, v, _, number, _ = motion(run, now.steps, now.s + theta * run.steps[now.steps].span)
        advance = v + 2.0 * number * math.sqrt(d)
        if advance < -ALLOWED * given.rtol * (1.0 + abs(v) + abs(number)):
            return RECEDES
    return DONE


def _commit(run: Run, span: float, until: float, theta: float) -> None:
    """Accept a step up to the share `theta` of it: the state there becomes the present one."""
    now, n = run.now, run.given.stages
    row, last, whole = run.rows[now.steps], run.places[n - 1], theta == 1.0
    if whole:
        end = until if now.s + span >= until else now.s + span
        now.d, now.x, now.v, now.w = last[DEPTH], last[OFFSET], last[FALL], last[SWING]
        now.r, now.sigma, now.oldest = run.stages[EDGE, n - 1], last[SIGMA], int(last[OLDEST])
    else:
        end = now.s + theta * span
        now.d += span * integral(row[RATE], theta)
        now.x += span * integral(row[ALONG], theta)
        now.v, now.w, now.r = (
            value(row[RATE], theta),
            value(row[ALONG], theta),
            value(row[EDGE], theta),
        )
    for i in range(len(run.arms)):
        for k in range(OWN):
            at = PER_ARM + OWN * i + k
            run.state[i, k] = run.stages[at, n - 1] if whole else value(row[at], theta)
    now.s, now.kinked, now.smooth = end, False, True
    now.steps += 1
