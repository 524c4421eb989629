r"""The contact of a parabola with a Prony series: accumulators, and the history of both edges (F23).

Scaled form, with k_i = K_i/K, T_i = tau_i/tau and c = C/(K tau): u = d - xi^2 in the contact, u' = d' - 2
lambda xi, p = u + c u' + sum s_i. An element at
X = xi - Y that entered at sigma, where an edge was at xi_e = X + Y(sigma), and its arms had the stresses s_e,
has

    s_i = k_i (A_i - xi B_i) + e^-(s - sigma)/T_i [s_e - k_i (A_i - xi_e B_i)](sigma),

    A_i' = d' + lambda B_i - A_i/T_i,   B_i' = 2 lambda - B_i/T_i,

A_i and B_i starting at zero; those in contact at rest lack the term in brackets. Where A_i and B_i were
restarted at s_0 (see `segments`), elements that entered before also have the stress carried over from before,
e^-(s - s_0)/T_i k_i (A_i - xi B_i)(s_0). The moments F_i and M_i of s_i over the contact, from which both
forces follow (F33), obey, with I_n = int xi^n dxi, summed over both edges,

    F_i' = k_i (d' I_0 - 2 lambda I_1) - F_i/T_i +- s_e X_e',
    M_i' = lambda F_i + k_i (d' I_1 - 2 lambda I_2) - M_i/T_i +- xi_e s_e X_e'.

An edge peels at p = 0, or touches the free surface, d - xi^2 = u: zero on ground that was never touched, and
where an edge left it at sigma, the solution of u + c u' + sum s_i = 0, a sum of N modes, N + 1 with a damper.
It peels as long as p of the element there would fall, and touches as long as the indenter presses faster than
the free surface there would rise. Where lambda jumps, the pressure of a damper does, see
`records.with_pauses`.

A step stores `polynomials` over its length, and those of each arm in `memory`. A loop
`for i in over(count)` runs over arms: compiled, i is one after the other; interpreted, all at once, as a
slice. The memory is evaluated from them, also within the step that is being solved. A segment is ground
over which one edge passed one way without a kink: it is told from the polynomials of this edge, and the
instants at its ends. The contact is a sequence of segments from left to right; the free ground on each side
is a list that begins at the edge. An edge that passes the end of a segment, or turns, ends a step.
"""

import math
from typing import Any, NamedTuple

import numpy as np

from kvtheory.models.continuum.prony.records import NEVER, Run
from kvtheory.models.continuum.run import PEELING, SIDES, TOUCHING
from kvtheory.scene.base_motion import DISPLACEMENT, START, evaluate

ITERATIONS, EDGE_ERROR, STALLED = 40, 4e-15, 1e-11
"""Iteration limit, and allowed error of an edge, relative to 1 + |Y|; that at the limit, due to rounding."""

FIRST_MOVE, AT_REST_MOVE, FASTER = 1e-3, 1e-4, 4.0
"""First move of the search for an edge, as a share of the time since the step began, or of the width; the
factor by which the limit of moves grows until the root is bracketed."""
FARTHEST = 0.1
"""How far an edge is continued beyond the end of a segment, and the first limit of moves in xi."""
GOLDEN = 0.3819660112501051

SEVERAL = 4
"""Arms from which on they are evaluated as an array where the kernels are interpreted."""


def over(count: int) -> Any:
    """Return the arms: one by one if compiled or few, else all as one slice."""
    return (slice(0, count),) if count >= SEVERAL else range(count)


def total(values: Any) -> Any:
    """Return the sum over the arms of a turn of such a loop."""
    return values.sum()


class Motion(NamedTuple):
    """Clock, time, d, d', Y and lambda of the base under the indenter, and the share of the step."""

    s: float
    time: float
    d: float
    v: float
    Y: float
    number: float
    theta: float


COMPILED = {"over": lambda count: range(count), "total": lambda value: value}  # noqa: PLW0108 - numba needs it
"""What stands for these functions where they are compiled."""


def value(row: Any, theta: float) -> float:
    """Return a polynomial at `theta`."""
    total = 0.0
    for k in range(len(row) - 1, -1, -1):
        total = total * theta + row[k]
    return total


def derivative(row: Any, theta: float) -> float:
    """Return the derivative of a polynomial by theta."""
    total = 0.0
    for k in range(len(row) - 1, 0, -1):
        total = total * theta + k * row[k]
    return total


def past(powers: Any, index: int, i: Any, theta: float) -> Any:
    """Return a quantity of an arm in a step at `theta`; `powers` are (steps, arms, coefficients)."""
    last = powers.shape[2] - 1
    found = 0.0 * theta + powers[index, i, last]
    for k in range(last - 1, -1, -1):
        found = found * theta + powers[index, i, k]
    return found


def past_stress(run: Run, index: int, i: Any, edge: int, theta: float) -> Any:
    """Return s_i of the element at an edge in the step `index` at `theta`."""
    powers, last = run.memory.stress_at_edge, run.given.stages
    found = 0.0 * theta + powers[index, i, last, edge]
    for k in range(last - 1, -1, -1):
        found = found * theta + powers[index, i, k, edge]
    return found


def accumulated(run: Run, index: int, theta: float) -> None:
    """Write A_i and B_i at a time of a step into `element`, and when they were restarted."""
    run.now.restart = run.steps[index].restart
    memory, element = run.memory, run.element
    for i in over(run.given.arms):
        element.accumulated_depth[i] = past(memory.accumulated_depth, index, i, theta)
        element.accumulated_slide[i] = past(memory.accumulated_slide, index, i, theta)


def at_present(run: Run) -> None:
    """Write A_i and B_i at present into `element`."""
    for i in over(run.given.arms):
        run.element.accumulated_depth[i] = run.state.accumulated_depth[i]
        run.element.accumulated_slide[i] = run.state.accumulated_slide[i]


def integral(row: Any, theta: float) -> float:
    """Return the integral of a polynomial from 0 to `theta`."""
    total = 0.0
    for k in range(len(row) - 1, -1, -1):
        total = total * theta + row[k] / (k + 1)
    return total * theta


def time_at(run: Run, piece: int, s: float) -> float:
    """Return the time at a clock in a piece of the drive."""
    since = run.clock.since[piece]
    return float(since if run.clock.paused[piece] else since + (s - run.pieces[piece][START]))


def base(run: Run, piece: int, s: float) -> tuple[float, float, float]:
    """Return Y, lambda and lambda' of the drive; in a pause, the base stands still while lambda changes."""
    row = run.pieces[piece]
    Y, number, slope = evaluate(row, s)
    return float(row[DISPLACEMENT] if run.clock.paused[piece] else Y), number, slope


def motion(run: Run, index: int, s: float) -> Motion:
    """Return the motion at a clock, from a step."""
    step = run.steps[index]
    theta = (s - step.start) / step.span
    Y, number, _ = base(run, step.piece, s)
    rate = run.polynomials.depth_rate[index]
    d = step.depth + step.lasts * integral(rate, theta)
    if run.given.sprung:
        along = run.polynomials.offset_rate[index]
        Y -= step.along + step.lasts * integral(along, theta)
        number -= value(along, theta)
    return Motion(s, time_at(run, step.piece, s), d, value(rate, theta), Y, number, theta)


def present(run: Run) -> Motion:
    """Return the motion at present."""
    now = run.now
    Y, number, _ = base(run, now.piece, now.s)
    time = time_at(run, now.piece, now.s)
    return Motion(now.s, time, now.d, now.v, Y - now.x, number - now.w, 0.0)


def step_of(run: Run, edge: int, index: int, sigma: float) -> int:
    """Return the step of an instant, between the same kinks of an edge as the step `index`."""
    steps, last = run.steps, run.now.steps
    while index < last and sigma >= steps[index + 1].start and steps[index + 1].kinked[edge] == 0:
        index += 1
    while index > 0 and sigma < steps[index].start and steps[index].kinked[edge] == 0:
        index -= 1
    return index


def pressed(
    run: Run, at: Motion, xi: float, edge: int, index: int, sigma: float
) -> tuple[float, float]:
    """Return p and xi of an element in contact, and write its s_i into `element`, which has A_i and B_i.

    It entered at `sigma`, in the step `index`, at this edge; at `xi` if it was in contact at rest. Between
    the stages of that step the polynomials leave a gap or an overlap there. The indenter closes it at once,
    and an arm keeps the share of this stress that it would keep over the step.
    """
    theta = xi_e = deeper = fades = 0.0
    memory, element, polynomials = run.memory, run.element, run.polynomials
    if index != NEVER:
        then = motion(run, index, sigma)
        theta, fades = then.theta, then.time - at.time
        xi_e = value(polynomials.edges[index, :, edge], theta)
        xi = xi_e - then.Y + at.Y
        deeper = then.d - xi_e * xi_e - value(polynomials.compression[index, :, edge], theta)
        for i in over(run.given.arms):
            element.stress_at_edge[i] = past_stress(run, index, i, edge, theta)
    p = at.d - xi * xi + run.given.damper * (at.v - 2.0 * at.number * xi)
    for i in over(run.given.arms):
        k = run.arms.stiffness[i]
        element.stress[i] = k * (element.accumulated_depth[i] - xi * element.accumulated_slide[i])
        if index != NEVER:
            A = past(memory.accumulated_depth, index, i, theta)
            strain = A - xi_e * past(memory.accumulated_slide, index, i, theta)
            T = run.arms.relaxation_time[i]
            strain -= T / (T + run.steps[index].lasts) * deeper
            left = element.stress_at_edge[i] - k * strain
            element.stress[i] += left * np.exp(np.minimum(fades / T, 1.0))
        p += total(element.stress[i])
    if run.now.restart > 0:
        p += carried_over(
            run, at.time, xi - at.Y, 0 if index == NEVER else run.steps[index].restart
        )
    return p, xi


def carried_over(run: Run, time: float, X: float, entered: int) -> float:
    """Add to the s_i of the element at `X` the stress carried over from before the last restart.

    `entered` is the last restart when the element entered. Return the sum of this stress.
    """
    j, added, memory = run.now.restart, 0.0, run.memory
    while j > entered:
        then = motion(run, j - 1, run.steps[j].start)
        Y, theta = then.Y, then.theta
        depth, slide = memory.accumulated_depth, memory.accumulated_slide
        for i in over(run.given.arms):
            A = past(depth, j - 1, i, theta) - depth[j, i, 0]
            B = past(slide, j - 1, i, theta) - slide[j, i, 0]
            stress = run.arms.stiffness[i] * (A - (X + Y) * B)
            stress = stress * np.exp((then.time - time) / run.arms.relaxation_time[i])
            run.element.stress[i] += stress
            added += total(stress)
        j = run.steps[j - 1].restart
    return added


def free(run: Run, at: Motion, edge: int, index: int, sigma: float) -> tuple[float, float]:
    """Return the gap u - (d - xi^2) above an element that an edge left at `sigma`, and xi.

    Write its s_i, u and u'. If the polynomials left it with a pressure, and no damper, it rises at once.
    """
    then, arms, modes, element = motion(run, index, sigma), run.arms, run.modes, run.element
    xi_e = value(run.polynomials.edges[index, :, edge], then.theta)
    xi, count = xi_e - then.Y + at.Y, len(run.to_modes)
    p_e = u_e = then.d - xi_e * xi_e
    for i in over(run.given.arms):
        element.stress_at_edge[i] = past_stress(run, index, i, edge, then.theta)
        p_e += total(element.stress_at_edge[i])
    if run.given.damper == 0.0:
        higher = p_e / (1.0 + run.given.glass)
        u_e -= higher
        for i in over(run.given.arms):
            element.stress_at_edge[i] -= arms.stiffness[i] * higher
    u = rise = 0.0
    for m in range(count):
        mode = run.to_modes[m, count - 1] * u_e if run.given.damper > 0.0 else 0.0
        for i in over(run.given.arms):
            strain = element.stress_at_edge[i] / arms.stiffness[i]
            mode += total(run.to_modes[m, i] * (u_e - strain))
        mode *= math.exp(min((then.time - at.time) * modes.rate[m], 1.0))
        u += modes.share[m] * mode
        rise -= modes.rate[m] * modes.share[m] * mode
        modes.amplitude[m] = mode
    for i in over(run.given.arms):
        element.stress[i] = 0.0
        for m in range(count):
            element.stress[i] += run.from_modes[i, m] * modes.amplitude[m]
    run.now.compression, run.now.rise = u, rise
    return u - at.d + xi * xi, xi


def untouched(run: Run) -> None:
    """Write s_i, u and u' of an element that was never touched."""
    for i in over(run.given.arms):
        run.element.stress[i] = 0.0
    run.now.compression = run.now.rise = 0.0


def edge_at(
    run: Run, k: int, at: Motion, xi: float, index: int, sigma: float
) -> tuple[float, int, float]:
    """Return xi of an edge, the step and the instant of the element there; write its s_i, and u' if free.

    From a guess of `xi`, of elements that were in contact at rest, or else of `sigma`: the nearest root of p,
    or of the gap, by a secant method with limited steps until the root is bracketed. Beyond the end of its
    segment, or its beginning if it peels, an edge is continued as if all elements there had passed with the
    last one. NaN if it does not converge.
    """
    side, state = run.now.sides[k], run.now.sides[k].state
    if side.segment == NEVER or (state == TOUCHING and run.segments[side.segment].step == NEVER):
        untouched(run)
        return SIDES[k] * math.sqrt(max(at.d, 0.0)), index, sigma
    if state == TOUCHING and run.clock.paused[run.now.piece]:  # both surfaces stand still
        free(run, at, run.segments[side.segment].edge, side.index, side.sigma)
        return float(side.xi), int(side.index), float(side.sigma)
    segment, span, Y = run.segments[side.segment], at.s - run.now.s, at.Y
    edge, middle = segment.edge, 0.5 * (run.now.sides[0].xi + run.now.sides[1].xi)
    inward, low, high = (
        (-1.0, segment.a, side.near) if edge == k else (1.0, side.near, min(segment.b, at.s))
    )
    end = segment.a if edge == k else segment.b
    start, x, move = side.sigma, sigma, FIRST_MOVE * span
    reach = max(abs(x - start), span)
    if segment.step == NEVER:
        end, inward = (segment.X_b if k == 0 else segment.X_a) + Y, -SIDES[k]
        low, high = (-math.inf, end) if k == 0 else (end, math.inf)
        move = AT_REST_MOVE * (run.now.sides[1].xi - run.now.sides[0].xi)
        index, start, x, reach = NEVER, side.xi, xi, FARTHEST
    before = previous = last = inner = outer = math.nan
    secant = False  # whether the last move was not limited: a small one means little where X stands still
    stiff, still = _rounding(run, at, state, middle)
    flat = still * (1.0 + abs(Y))
    for _ in range(ITERATIONS):
        x = max(min(x, high), low)
        if index != NEVER:
            index = step_of(run, edge, index, x)
        f, xi = _margin(run, state, at, edge, index, x)
        settled = (secant and abs(f) <= flat) or x == previous or abs(f) <= EDGE_ERROR * stiff
        if abs(f) <= EDGE_ERROR or (settled and abs(xi - last) <= EDGE_ERROR * (1.0 + abs(Y))):
            return xi, index, x
        passes = x == end and f < 0.0 and math.isnan(inner)
        if passes and state == PEELING and SIDES[k] * (xi - middle) <= 0.0:
            x = 0.5 * (start + x)  # the other edge passed this end
            continue
        returns = state == PEELING and index != NEVER and x == side.near and f > 0.0
        if passes or (returns and math.isnan(outer)):
            return _beyond_end(run, k, at, xi, f), index, x
        toward, inner, outer = (inward, inner, x) if f < 0.0 else (-inward, x, outer)
        bracketed, secant = not math.isnan(inner + outer), not math.isnan(last)
        if secant:
            move = -f * (x - previous) / (f - before) if f != before else 0.0
        else:
            move *= toward
        before, previous, last = f, x, xi
        stands = move == 0.0 and abs(f) > still  # X does, where sliding began
        if not bracketed and (stands or toward * move < 0.0 or abs(move) >= reach):
            move, reach, secant = toward * reach, FASTER * reach, False
        elif bracketed and not min(inner, outer) <= x + move <= max(inner, outer):
            move = 0.5 * (inner + outer) - x
        x += move
    return (xi if abs(xi - last) <= STALLED else math.nan), index, x


def _rounding(run: Run, at: Motion, state: int, middle: float) -> tuple[float, float]:
    """Return the size of the terms of p, or of the gap, and the largest value of it where X stands still.

    A larger one is not that of a root. With a damper, a gap grows as the square of X.
    """
    given = run.given
    if state == PEELING:
        terms = 1.0 + given.glass + given.damper * (abs(at.v) + 2.0 * abs(at.number * middle))
        return terms, STALLED * terms
    return 1.0, EDGE_ERROR if given.damper > 0.0 else STALLED


def _beyond_end(run: Run, k: int, at: Motion, xi: float, f: float) -> float:
    """Return xi of an edge beyond the end of its segment, where p, or the gap, is `f`."""
    slope, outward = 2.0 * xi, SIDES[k]
    if run.now.sides[k].state == PEELING:
        outward, slope = -SIDES[k], slope + 2.0 * run.given.damper * at.number
        for i in over(run.given.arms):
            slope += total(run.arms.stiffness[i] * run.element.accumulated_slide[i])
    return xi - outward * max(min(f / abs(slope), FARTHEST), -FARTHEST)


def ends_never(run: Run, k: int) -> bool:
    """Whether an edge does not come to an end of its segment; in a pause one that touches stands still."""
    side = run.now.sides[k]
    stands = side.state == TOUCHING and run.clock.paused[run.now.piece]
    return bool(side.segment == NEVER or stands)


def at_far_end(run: Run, k: int, at: Motion, middle: float) -> float:
    """Return p, or the gap if the edge touches, where the segment of an edge ends; `element` has A_i and B_i.

    An end that is beyond the `middle` of the contact is passed by the other edge.
    """
    side, never, Y = run.now.sides[k], math.inf, at.Y
    if ends_never(run, k):
        return never
    segment, touches = run.segments[side.segment], side.state == TOUCHING
    far, X = (segment.a, segment.X_a) if segment.edge == k else (segment.b, segment.X_b)
    if far == math.inf or (not touches and SIDES[k] * (X + Y - middle) < 0.0):
        return never
    if segment.step == NEVER:
        if touches:
            return (X + Y) * (X + Y) - at.d
        return pressed(run, at, X + Y, segment.edge, NEVER, 0.0)[0]
    index = step_of(run, segment.edge, segment.step, far)
    return _margin(run, side.state, at, segment.edge, index, far)[0]


def _margin(
    run: Run, state: int, at: Motion, edge: int, index: int, x: float
) -> tuple[float, float]:
    """Return p, or the gap if the edge touches, and xi."""
    if state == PEELING:
        return pressed(run, at, x, edge, index, x)
    return free(run, at, edge, index, x)
