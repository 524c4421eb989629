"""The segments of ground that the edges pass: how they begin and end, and in which one an edge moves."""

import math

from kvtheory.models.continuum.prony.contact import (
    at_present,
    derivative,
    motion,
    over,
    present,
    pressed,
    total,
)
from kvtheory.models.continuum.prony.records import NEVER, Run
from kvtheory.models.continuum.run import PEELING, TOUCHING

INSTANT, SHORT = 1e-13, 0.1
"""Length of a segment in time, relative to the run, or in space, as a share of the tolerance, below which it
counts as none."""


def here(run: Run, k: int) -> float:
    """Return X of an edge at present."""
    return float(run.now.sides[k].xi - present(run).Y)


def begin(run: Run, k: int, outward: int) -> None:
    """Begin the segment that an edge writes; `outward` is the next one on free ground."""
    now, number = run.now, run.now.segments
    segment = run.segments[number]
    segment.edge, segment.step, segment.next = k, now.steps, outward
    segment.a, segment.b, segment.X_a, segment.X_b = now.s, math.inf, here(run, k), 0.0
    now.sides[k].own, now.segments, now.kinked[k] = number, number + 1, 1


def end(run: Run, k: int) -> int:
    """End the segment that an edge writes; return it, or the next one outward if it is empty."""
    now, number = run.now, run.now.sides[k].own
    segment = run.segments[number]
    segment.b, segment.X_b = now.s, here(run, k)
    empty = now.s - segment.a <= INSTANT * run.given.end
    empty = empty or abs(segment.X_b - segment.X_a) <= SHORT * run.given.rtol
    if now.sides[k].state == TOUCHING:
        if empty:
            pop(run, k)
        return int(number)
    return int(segment.next) if empty else int(number)


def pop(run: Run, k: int) -> None:
    """Remove the contact's last segment at an edge."""
    run.now.count -= 1
    if k == 0:
        run.now.first += 1


def last(run: Run, k: int) -> int:
    """Return the contact's last segment at an edge."""
    now = run.now
    return int(run.chain[now.first + (now.count - 1 if k == 1 else 0)])


def renew(run: Run) -> None:
    """Copy the contact's sequence of segments behind all entries; earlier steps keep the old one."""
    now, old = run.now, run.now.first
    lay(run, now.count)
    for i in range(now.count):
        run.chain[now.first + i] = run.chain[old + i]


def lay(run: Run, count: int) -> None:
    """Let the contact's sequence have `count` entries behind all others.

    The room at both ends is as long, so that a sequence that grows is copied a few times only.
    """
    now, room = run.now, count + 2
    now.block, now.first, now.count = now.chain, now.chain + room, count
    now.unused[0], now.unused[1] = now.first - 1, now.first + count
    now.chain = now.first + count + room


def push(run: Run, k: int) -> None:
    """Add the segment that an edge writes to the contact, in an entry that no earlier step has."""
    now = run.now
    if k == 0:
        if not now.block <= now.first - 1 <= now.unused[0]:
            renew(run)
        now.first -= 1
        now.unused[0] = now.first - 1
    else:
        if not now.unused[1] <= now.first + now.count < now.chain:
            renew(run)
        now.unused[1] = now.first + now.count + 1
    now.count += 1
    run.chain[now.first + (now.count - 1 if k == 1 else 0)] = now.sides[k].own


def cut(run: Run, k: int, number: int) -> int:
    """Return a copy of a segment that ends where the edge in it is now."""
    side = run.now.sides[k]
    if number == NEVER:
        return NEVER
    found = copy(run, number, int(run.segments[number].next))
    new = run.segments[found]
    if new.edge == k:
        new.b, new.X_b = side.sigma, here(run, k)
    else:
        new.a, new.X_a = side.sigma, here(run, k)
    return found


def copy(run: Run, number: int, outward: int) -> int:
    """Return a copy of a segment with another one next to it outward."""
    old, new = run.segments[number], run.segments[run.now.segments]
    new.edge, new.step, new.next = old.edge, old.step, outward
    new.a, new.b, new.X_a, new.X_b = old.a, old.b, old.X_a, old.X_b
    run.now.segments += 1
    return int(run.now.segments - 1)


def aim(run: Run, k: int, number: int) -> None:
    """Let an edge move in a segment, from its near end."""
    side, run.now.sides[k].segment = run.now.sides[k], number
    if number == NEVER:
        return
    segment = run.segments[number]
    if segment.edge == k:
        side.sigma, side.pace, side.index = segment.b, -1.0, segment.step
        while side.index + 1 < run.now.steps and run.steps[side.index + 1].start < segment.b:
            side.index += 1
    else:
        side.sigma, side.pace, side.index = segment.a, 1.0, segment.step
        while side.index + 1 < run.now.steps and run.steps[side.index + 1].start <= segment.a:
            side.index += 1
    side.near = side.sigma


def turn(run: Run, k: int) -> None:
    """Let a peeling edge touch, or a touching one peel."""
    now, side, other = run.now, run.now.sides[k], run.now.sides[1 - k]
    if side.state == PEELING:
        ground, old = end(run, k), last(run, k)
        new = cut(run, k, old)
        if other.state == PEELING and other.segment == old:
            other.segment = new
        if other.own == old:  # the other edge goes on to write the copy
            other.own, run.segments[old].b, run.segments[old].X_b = new, now.s, here(run, 1 - k)
        renew(run)
        run.chain[now.first + (now.count - 1 if k == 1 else 0)] = new
        begin(run, k, NEVER)
        side.rise = left_behind(run, k)
        side.state = TOUCHING
        push(run, k)
        aim(run, k, ground)
    else:
        end(run, k)
        ground = cut(run, k, side.segment)
        begin(run, k, ground)
        side.state = PEELING
        aim(run, k, last(run, k))


def left_behind(run: Run, k: int) -> float:
    """Return u' of the free ground at a peeling edge, where p = 0: with a damper, that of the indenter."""
    at, relaxing = present(run), 0.0
    if run.given.damper > 0.0:
        return float(at.v - 2.0 * at.number * run.now.sides[k].xi)
    for i in over(run.given.arms):
        relaxing += total(run.state.stress_at_edge[i, k] / run.arms.relaxation_time[i])
    return float(relaxing / (1.0 + run.given.glass))


def split(run: Run, k: int) -> None:
    """Begin a new segment where the history of an edge has a kink."""
    side = run.now.sides[k]
    written = end(run, k)
    begin(run, k, written if side.state == PEELING else NEVER)
    if side.state == TOUCHING:
        push(run, k)


def cross(run: Run, k: int) -> None:
    """Let an edge move on to the next segment."""
    side, now = run.now.sides[k], run.now
    segment = run.segments[side.segment]
    if side.state == TOUCHING:
        outward = int(segment.next)
        split(run, k)
        aim(run, k, outward)
        return
    pop(run, k)
    if now.count > 0:
        split(run, k)
        if segment.step == NEVER and now.sides[1 - k].state == TOUCHING:
            split(run, 1 - k)  # the motion has a kink too
        aim(run, k, last(run, k))


LARGE = 0.06
"""Share of the largest A_i that a step may reach, from which on it is restarted."""


def in_contact(run: Run, number: int) -> tuple[float, float]:
    """Return between which instants those elements of a segment entered that are in contact, or their X."""
    segment = run.segments[number]
    low, high = segment.a, min(segment.b, run.now.s)
    if segment.step == NEVER:
        low, high = segment.X_a, segment.X_b
    for k in range(2):
        side = run.now.sides[k]
        if side.state == PEELING and side.segment == number:
            at = here(run, k) if segment.step == NEVER else side.sigma
            low, high = (low, at) if segment.edge == k else (at, high)
    return low, high


def restart_accumulators(run: Run) -> None:
    """Restart the accumulators of slow arms from zero if they are large, and their moments.

    On an arm that is slow beside the motion, A_i grows as the square of the distance slid, and stresses are
    small differences of it. F_i and M_i add up the rounding, the latter twice. So where A_i is large, it and
    B_i begin again from zero, and F_i and M_i from their integrals over the contact, by Radau's rule between
    the ends of steps. An element in contact keeps the stress k_i (A_i - xi B_i) of that instant.
    """
    now, state, many = run.now, run.state, range(run.given.arms)
    most, large = 0.0, LARGE * run.given.farthest
    for i in many:
        most = max(most, abs(state.accumulated_depth[i]))
        if abs(state.accumulated_depth[i]) > large:
            state.force[i] = state.moment[i] = 0.0
    if not most > large:
        return
    at_present(run)
    for n in range(now.first, now.first + now.count):
        number = run.chain[n]
        segment = run.segments[number]
        low, high = in_contact(run, number)
        if segment.step == NEVER:
            integrate(run, NEVER, segment.edge, low, high, large)
            continue
        index = segment.step
        while low < high:
            while index + 1 < now.steps and run.steps[index + 1].start <= low:
                index += 1
            end = min(high, run.steps[index + 1].start) if index + 1 < now.steps else high
            integrate(run, index, segment.edge, low, end, large)
            low = end
    for i in many:
        if abs(state.accumulated_depth[i]) > large:
            state.accumulated_depth[i] = state.accumulated_slide[i] = 0.0
    now.restart = now.steps


def integrate(run: Run, index: int, edge: int, low: float, high: float, large: float) -> None:
    """Add the integrals over elements that entered between two instants of a step to F_i and M_i."""
    n = run.given.stages
    at = present(run)
    for j in range(n):
        x, weight = low + (high - low) * run.stages.node[j], high - low
        if index != NEVER:
            then, step = motion(run, index, x), run.steps[index]
            rate = derivative(run.polynomials.edges[index, :, edge], then.theta)
            weight *= abs(rate - step.lasts * then.number) / step.span
        _, xi = pressed(run, at, x + at.Y, edge, index, x)
        for i in range(run.given.arms):
            if abs(run.state.accumulated_depth[i]) > large:
                force = weight * run.method.A[n - 1, j] * run.element.stress[i]
                run.state.force[i] += force
                run.state.moment[i] += xi * force
