"""The indenter leaves the foundation and lands: a contact closes to a point, and opens from one.

The width of a contact that closes falls to zero as the root of the time that is left; that of one that opens
grows like this. The last step of the former and the first of the latter are short, without forces, and with
edges that move uniformly: the force that is neglected is of the order of the cube of the width. In flight the
lists of free ground on both sides begin where the contact closed. The indenter lands where the gap above an
element of them, or above ground that was never touched, vanishes first.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum.prony import contact as c_
from kvtheory.models.continuum.prony.contact import Motion
from kvtheory.models.continuum.prony.records import NEVER, Run
from kvtheory.models.continuum.prony.segments import aim, begin, copy, cut, end, here, lay, turn
from kvtheory.models.continuum.prony.step import prepare, solve
from kvtheory.models.continuum.run import FREE, SIDES, TOUCHING

CLOSED = 0.03
"""Width of a contact that counts as closed, relative to the cubic root of the tolerance; a contact opens to
it in one step. The pressure on ground that is met again there is wrong in proportion to it, the forces as its
cube. As edges move uniformly in that step, the pressure may seem largest beside the middle, but within half
of the width: a contact that withdraws is closed before."""
SHORTEST_OPENING = 4e-13
"""Least step in which a contact opens, relative to the run."""
BRIEF = 100.0
"""A contact that closes within so many of the shortest steps is closed too."""
SAMPLES, REFINED, BISECTIONS = 3, 40, 60
"""Samples of the free ground for each step in which it was left, golden sections about the best one, and
bisections for the instant at which the gap vanishes."""
SAME = 1e-12
"""Relative distance of two places that counts as rounding."""


class Gap(NamedTuple):
    """A gap, on which side it is, in which segment, or beyond all, and at which instant, or X, there."""

    size: float
    side: int
    segment: int
    at: float


def closed(run: Run) -> float:
    """Return the width of a contact that is closed."""
    light = run.given.damper / run.given.eps if run.given.eps > 0.0 else 0.0
    return float(CLOSED * np.cbrt(run.given.rtol / (1.0 + light)))


def flies(run: Run) -> bool:
    """Whether there is no contact."""
    return bool(run.now.sides[0].state == FREE)


def time_left(run: Run) -> float:
    """Return the time after which the contact closes if its width is as the root of this time."""
    now = run.now
    if now.steps == 0:
        return math.inf
    edges = run.polynomials.edges[now.steps - 1]
    rate = c_.derivative(edges[:, 1], 1.0) - c_.derivative(edges[:, 0], 1.0)
    if not rate < 0.0 or not now.smooth:
        return math.inf
    width = now.sides[1].xi - now.sides[0].xi
    return float(-0.5 * width / rate * run.steps[now.steps - 1].span)


def closes(run: Run, left: float, shortest: float) -> bool:
    """Whether the contact is about to close; `left` is the time until then."""
    width = run.now.sides[1].xi - run.now.sides[0].xi
    return bool(left < math.inf and (width <= closed(run) or left <= BRIEF * shortest))


def close(run: Run, span: float) -> bool:
    """Take the step of length `span` in which the contact closes; return whether it is solved."""
    now, l, r = run.now, run.now.sides[0].xi, run.now.sides[1].xi
    for k in range(2):
        if now.sides[k].state == TOUCHING:
            turn(run, k)
    prepare(run, span)
    X = 0.5 * (here(run, 0) + here(run, 1))
    stages, j = run.arm_stages, run.given.stages - 1
    if not _without_forces(run, 0.5 * (l + r)):
        return False
    for i in c_.over(run.given.arms):
        mean = 0.5 * (run.state.stress_at_edge[i, 0] + run.state.stress_at_edge[i, 1])
        stages.stress_at_edge[i, j, 0] = stages.stress_at_edge[i, j, 1] = mean
        stages.force[i, j] = stages.moment[i, j] = 0.0 * mean
    Y = c_.motion(run, now.steps, now.s + span).Y
    end_with(run, l, r, X + Y, X + Y)
    return True


def fly(run: Run) -> None:
    """Begin a flight, after the step in which the contact closes."""
    now = run.now
    for k in range(2):
        side = now.sides[k]
        side.segment, side.own, side.near = end(run, k), NEVER, here(run, k)
        side.state, now.kinked[k] = FREE, 1
    now.count, now.smooth = 0, False
    for i in c_.over(run.given.arms):
        run.state.force[i] = run.state.moment[i] = 0.0
        for k in range(2):
            run.state.stress_at_edge[i, k] = 0.0


def _without_forces(run: Run, xi: float) -> bool:
    """Solve the step without a contact."""
    now, n = run.now, run.given.stages
    for k in range(2):
        now.sides[k].state = FREE
        for j in range(n):
            run.stages.edges[j, k] = xi
    for i in c_.over(run.given.arms):
        for j in range(n):
            run.arm_stages.force[i, j] = run.arm_stages.moment[i, j] = 0.0
            for k in range(2):
                run.arm_stages.stress_at_edge[i, j, k] = 0.0
    return solve(run)


def end_with(run: Run, l: float, r: float, l_end: float, r_end: float) -> None:
    """Let edges, stresses and moments change uniformly over a step, to those at the last stage."""
    now, n, state, last = run.now, run.given.stages, run.state, run.arm_stages
    edges = run.polynomials.edges[now.steps]
    for k, first, end_of in ((0, l, l_end), (1, r, r_end)):
        _uniform(edges[:, k], first, end_of)
        run.stages.edges[n - 1, k] = end_of
        side, of_stage, powers = now.sides[k], run.stages, run.polynomials
        compression, rise = powers.compression[now.steps, :, k], powers.rise[now.steps, :, k]
        _uniform(compression, side.compression, of_stage.compression[n - 1, k])
        _uniform(rise, side.rise, of_stage.rise[n - 1, k])
    memory, index = run.memory, now.steps
    for i in range(run.given.arms):
        _uniform(memory.force[index, i], state.force[i], last.force[i, n - 1])
        _uniform(memory.moment[index, i], state.moment[i], last.moment[i, n - 1])
        for k in range(2):
            first, end_of = state.stress_at_edge[i, k], last.stress_at_edge[i, n - 1, k]
            _uniform(memory.stress_at_edge[index, i, :, k], first, end_of)
    now.smooth = False


def _uniform(powers: Any, first: float, last: float) -> None:
    """Write the polynomial that changes uniformly over a step."""
    for m in range(len(powers)):
        powers[m] = 0.0
    powers[0], powers[1] = first, last - first


def distance(run: Run) -> float:
    """Return how far the ground that was touched is from below the indenter, along it."""
    least = math.inf
    for k in range(2):
        if run.now.sides[k].segment != NEVER:
            X = run.now.sides[k].near
            least = min(least, max(SIDES[k] * (X - here(run, k) + run.now.sides[k].xi), 0.0))
    return least


def least_gap(run: Run, at: Motion) -> Gap:
    """Return the least gap between the indenter and the ground, at a time in flight."""
    found = Gap(math.inf, 0, NEVER, 0.0)
    for k in range(2):
        segment, outer = run.now.sides[k].segment, run.now.sides[k].near
        while segment != NEVER:
            gap, x = _gap_above(run, segment, at, found.size)
            if gap < found.size:
                found = Gap(gap, k, segment, x)
            outer, segment = far_end(run.segments[segment], k), int(run.segments[segment].next)
        xi = SIDES[k] * max(SIDES[k] * (outer + at.Y), 0.0)
        if xi * xi - at.d < found.size:
            found = Gap(xi * xi - at.d, k, NEVER, xi - at.Y)
    return found


def _gap_above(run: Run, number: int, at: Motion, enough: float) -> tuple[float, float]:
    """Return the least gap above a segment if it is below `enough`, and the instant, or X, of the element."""
    part, d = run.segments[number], at.d
    l, r = min(part.X_a, part.X_b) + at.Y, max(part.X_a, part.X_b) + at.Y
    xi = min(max(0.0, l), r)
    if xi * xi - d >= enough:
        return math.inf, 0.0
    if part.step == NEVER:
        return xi * xi - d, xi - at.Y
    found, best, index, x = math.inf, part.a, part.step, part.a
    before, low, high = part.a, part.a, part.b
    while True:
        index = c_.step_of(run, part.edge, index, x)
        gap, _ = c_.free(run, at, part.edge, index, x)
        if gap < found:
            found, best, low, high = gap, x, before, math.inf
        high = min(high, x) if x > best else high
        if x >= part.b:
            break
        before, x = x, min(x + run.steps[index].span / SAMPLES, part.b)
    return _refined(run, number, at, (low, best, min(high, part.b)), found)


def _refined(
    run: Run, number: int, at: Motion, between: tuple[float, float, float], found: float
) -> tuple[float, float]:  # fmt: skip
    """Return the least gap, and its instant, by golden sections about the second of three instants."""
    part, (low, best, high) = run.segments[number], between
    for _ in range(REFINED):
        wide = high - best > best - low
        x = best + c_.GOLDEN * (high - best if wide else low - best)
        gap, _ = c_.free(run, at, part.edge, c_.step_of(run, part.edge, part.step, x), x)
        if gap < found:
            low, high = (best, high) if wide else (low, best)
            found, best = gap, x
        elif wide:
            high = x
        else:
            low = x
    return found, best


def touches_at(run: Run, theta: float, number: int, x: float) -> float:
    """Return the share of the step at which the element first touches that is penetrated at `theta`."""
    step, low, high = run.steps[run.now.steps], 0.0, theta
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        at = c_.motion(run, run.now.steps, step.start + middle * step.span)
        if _gap_at(run, number, x, at) > 0.0:
            low = middle
        else:
            high = middle
    return low


def _gap_at(run: Run, number: int, x: float, at: Motion) -> float:
    """Return the gap above an element, and write its state."""
    if number == NEVER or run.segments[number].step == NEVER:
        c_.untouched(run)
        return float((x + at.Y) * (x + at.Y) - at.d)
    part = run.segments[number]
    return c_.free(run, at, part.edge, c_.step_of(run, part.edge, part.step, x), x)[0]


def land(run: Run, side: int, number: int, x: float) -> None:
    """Begin a contact of no width above an element; both edges touch, and move over the free ground."""
    now = run.now
    Y = c_.present(run).Y
    _gap_at(run, number, x, c_.present(run))
    X = x
    if number != NEVER and run.segments[number].step != NEVER:
        part = run.segments[number]
        index = c_.step_of(run, part.edge, part.step, x)
        then = c_.motion(run, index, x)
        X = c_.value(run.polynomials.edges[index, :, part.edge], then.theta) - then.Y
    for k in range(2):
        now.sides[k].xi, now.sides[k].sigma = X + Y, x
        now.sides[k].compression, now.sides[k].rise = now.compression, now.rise
        for i in c_.over(run.given.arms):
            run.state.stress_at_edge[i, k] = run.element.stress[i]
    inward, part_of = now.sides[1 - side].segment, now.sides[side].segment
    outer = now.sides[side].near
    while part_of != number:  # the ground between, met in the other direction
        old = run.segments[part_of]
        inward, outer, part_of = copy(run, part_of, inward), far_end(old, side), int(old.next)
    outward = NEVER
    if number != NEVER:
        outward = _beyond(run, side, number, int(run.segments[number].next))
        inward = _beyond(run, 1 - side, number, inward)
    elif SIDES[side] * (X - outer) > SAME * (1.0 + abs(Y)):
        inward = copy(run, -1, inward)
        virgin = run.segments[inward]
        virgin.edge, virgin.step, virgin.X_a, virgin.X_b = side, NEVER, X, outer
    for k in range(2):
        now.sides[k].state = TOUCHING
        begin(run, k, NEVER)
        aim(run, k, outward if k == side else inward)
    lay(run, 2)
    for k in range(2):
        run.chain[now.first + k] = now.sides[k].own


def _beyond(run: Run, k: int, number: int, outward: int) -> int:
    """Return a copy of the part of a segment that is beyond an edge, or `outward` if it is empty."""
    old, X = run.segments[number], here(run, k)
    if SIDES[k] * (far_end(old, k) - X) <= SAME * (1.0 + abs(X)):
        return outward
    new = cut(run, k, number)
    run.segments[new].next = outward
    return new


def far_end(segment: Any, k: int) -> float:
    """Return X of the outer end of a segment on a side."""
    return float(segment.X_a if segment.edge == k else segment.X_b)


def open_contact(run: Run, longest: float) -> bool:
    """Take the step in which a contact opens, on ground that fits the indenter a shorter one than `longest`.

    Return whether it is solved.
    """
    now, first = run.now, (int(run.now.sides[0].segment), int(run.now.sides[1].segment))
    now.span = longest
    opened = _open(run, longest)
    width = run.stages.edges[run.given.stages - 1, 1] - run.stages.edges[run.given.stages - 1, 0]
    if opened and width > closed(run):
        for k in range(2):
            aim(run, k, first[k])
        share = closed(run) / width  # it grows as the root of the time
        now.span = max(share * share * longest, SHORTEST_OPENING * run.given.end)
        opened = _open(run, now.span)
    return opened


def _open(run: Run, span: float) -> bool:
    """Try the step of length `span` in which a contact opens; return whether it is solved."""
    now, n, xi = run.now, run.given.stages, run.now.sides[0].xi
    prepare(run, span)
    if not _without_forces(run, xi):
        return False
    stages, arm_stages, j = run.stages, run.arm_stages, n - 1
    at = c_.motion(run, now.steps, now.s + span)
    for k in range(2):
        side = now.sides[k]
        side.state = TOUCHING
        while c_.at_far_end(run, k, at, xi) < 0.0:  # it opens over more than one segment
            aim(run, k, int(run.segments[side.segment].next))
        run.steps[now.steps].sides[k].segment = side.segment  # over this one most of all
        place, index, sigma = c_.edge_at(run, k, at, xi, side.index, side.sigma)
        if not abs(place) < math.inf:
            return False
        stages.edges[j, k], stages.entry_step[j, k], stages.entry_time[j, k] = place, index, sigma
        stages.compression[j, k], stages.rise[j, k] = now.compression, now.rise
        for i in c_.over(run.given.arms):
            arm_stages.stress_at_edge[i, j, k] = run.element.stress[i]
    l, r = stages.edges[j, 0], stages.edges[j, 1]
    for i in c_.over(run.given.arms):
        first, second = arm_stages.stress_at_edge[i, j, 0], arm_stages.stress_at_edge[i, j, 1]
        arm_stages.force[i, j] = 0.5 * (r - l) * (first + second)
        arm_stages.moment[i, j] = 0.5 * (r - l) * (l * first + r * second)
    end_with(run, xi, xi, l, r)
    return bool(l < r)
