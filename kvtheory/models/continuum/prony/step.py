"""One step on a Prony series by a Radau IIA method: the equations of motion, and linear filters for each arm.

At each stage the rates d' and x' are unknown. Given them, the accumulators follow from linear equations, the
trailing edges from the history, the moments from linear equations again, and the forces from these. The
residuals of the equations of motion are solved by Broyden's method, which starts from the Jacobian for edges
that do not move: without a damper the pressure vanishes at both edges, so that they do not matter to first
order (F24).
"""

import math
from typing import Any

import numpy as np

from kvtheory.models.continuum.prony import contact as c_
from kvtheory.models.continuum.prony.contact import Motion
from kvtheory.models.continuum.prony.records import Run
from kvtheory.models.continuum.run import FREE, PEELING
from kvtheory.scene.base_motion import END

ITERATIONS, SHARE, STALL = 30, 0.02, 0.5
"""Iteration limit; share of the tolerance below which a correction is the last one, and that below which it
may be the last if it does not fall any more."""

EDGE_SHARE, TINY = 0.03, 1e-12
"""Largest error of an edge as a share of the width. Relative to the tolerance it is weighted by the width,
for the pressure vanishes at an edge."""
SHIFT = 4e-14
"""Rounding of the time, relative to the run, where errors are estimated."""


def moments(l: float, r: float) -> tuple[float, float, float, float]:
    """Return the integrals of 1, xi, xi^2 and xi^3 from `l` to `r`."""
    a, b = l * l, r * r
    return r - l, (b - a) / 2.0, (b * r - a * l) / 3.0, (b * b - a * a) / 4.0


def forces(
    l: float, r: float, d: float, damped: tuple[float, float], first: float, second: float
) -> tuple[float, float]:
    """Return f_z and f_x; `damped` is c d' and 2 c lambda, the last two are the moments of all arms."""
    I_0, I_1, I_2, I_3 = moments(l, r)
    d, slope = d + damped[0], damped[1]  # p = d + c d' - 2 c lambda xi - xi^2 + sum s_i
    f_z = 0.75 * (d * I_0 - slope * I_1 - I_2 + first)
    return f_z, -1.5 * (d * I_1 - slope * I_2 - I_3 + second)


def prepare(run: Run, span: float) -> None:
    """Begin a step of length `span` from the present state, and make the filters of the arms."""
    now, n, step = run.now, run.given.stages, run.steps[run.now.steps]
    step.start, step.span, step.depth, step.along, step.piece = now.s, span, now.d, now.x, now.piece
    step.time = c_.time_at(run, now.piece, now.s)
    step.lasts = 0.0 if run.clock.paused[now.piece] else span
    step.first, step.count, step.restart = now.first, now.count, now.restart
    for k in range(2):
        side, kept = now.sides[k], step.sides[k]
        step.kinked[k] = now.kinked[k]
        kept.state, kept.segment, kept.own, kept.xi = side.state, side.segment, side.own, side.xi
    stages = run.stages
    for j in range(n):
        after = stages.node[j] * span
        stages.s[j] = now.s + after
        stages.time[j] = c_.time_at(run, now.piece, now.s + after)
        for k in range(2):
            side = now.sides[k]
            stages.entry_step[j, k] = side.index
            stages.entry_time[j, k] = side.sigma + side.pace * after
            stages.edges[j, k] = side.xi
    for i in c_.over(run.given.arms):
        filter_of(run, i, step.lasts)


def filter_of(run: Run, i: Any, span: float) -> None:
    """Write the inverse of A^-1 + span/T_i, by Gauss-Jordan elimination; it needs no pivoting."""
    n, found = run.given.stages, run.filters
    for j in range(n):
        for k in range(n):
            found[i, j, k] = run.method.inverse[j, k]
        found[i, j, j] += span / run.arms.relaxation_time[i]
    for k in range(n):
        pivot = 1.0 / found[i, k, k]
        found[i, k, k] = 1.0
        for j in range(n):
            found[i, k, j] *= pivot
        for m in range(n):
            if m != k:
                factor = 1.0 * found[i, m, k]
                found[i, m, k] = 0.0
                for j in range(n):
                    found[i, m, j] -= factor * found[i, k, j]


def invert(square: Any, n: int, inverse: Any) -> bool:
    """Write the inverse of the first `n` rows and columns, which are overwritten; false if it is singular."""
    for i in range(n):
        for j in range(n):
            inverse[i, j] = 1.0 if i == j else 0.0
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(square[i, k]) > abs(square[best, k]):
                best = i
        if not 0.0 < abs(square[best, k]) < math.inf:
            return False
        for j in range(n):
            square[k, j], square[best, j] = square[best, j], square[k, j]
            inverse[k, j], inverse[best, j] = inverse[best, j], inverse[k, j]
        pivot = square[k, k]
        for j in range(n):
            square[k, j] /= pivot
            inverse[k, j] /= pivot
        for i in range(n):
            factor = square[i, k]
            if i != k and factor != 0.0:
                for j in range(n):
                    square[i, j] -= factor * square[k, j]
                    inverse[i, j] -= factor * inverse[k, j]
    return True


def relax(run: Run, i: Any, values: Any, begin: Any) -> None:
    """Solve y' = q - y/T_i at the stages, from `begin`; q times the step is the `source`, y the `values`."""
    n, source = run.given.stages, run.arm_stages.source
    for j in range(n):
        source[i, j] += run.stages.of_start[j] * begin
    for j in range(n):
        values[i, j] = 0.0
        for k in range(n):
            values[i, j] += run.filters[i, j, k] * source[i, k]


def interpolate_arm(run: Run, i: Any, found: Any, values: Any, begin: Any) -> Any:
    """Write the polynomial of an arm through `begin` and the stages; return its error."""
    n, change = run.given.stages, 0.0
    found[i, 0] = begin
    for k in range(n):
        found[i, k + 1] = 0.0
        for j in range(n):
            change = values[i, j] - begin
            found[i, k + 1] += run.method.powers[k, j] * change
    return np.maximum(uncertain(run, found[i, n], change), 0.0)


def interpolate(run: Run, found: Any, values: Any, begin: float) -> float:
    """Write the polynomial through `begin` and the stages; return its error."""
    n = run.given.stages
    found[0] = begin
    for k in range(n):
        found[k + 1] = 0.0
        for j in range(n):
            found[k + 1] += run.method.powers[k, j] * (values[j] - begin)
    return max(uncertain(run, found[n], values[n - 1] - begin), 0.0)


def uncertain(run: Run, last: Any, change: Any) -> Any:
    """Return the last coefficient in Legendre's polynomials, less what a shift of the time changes.

    An edge may run through a layer on a fast arm: it is as uncertain as the time, and no shorter step helps.
    """
    shift = SHIFT * run.given.end / run.steps[run.now.steps].span
    return run.given.last_power * abs(last) - shift * abs(change)


def solve(run: Run) -> bool:
    """Solve the stages of a step that is prepared; return whether Broyden's method converged."""
    given, now = run.given, run.now
    free, change, move = 0 if given.fixed else given.stages, run.unknowns.change, run.unknowns.move
    residual, inverse = run.unknowns.residual, run.inverse_jacobian
    size = free + (given.stages if given.sprung else 0)
    guess(run, free)
    if not evaluate_stages(run, free):
        return False
    if size == 0:
        return True
    linearize(run, free, size)
    if not invert(run.jacobian, size, inverse):
        return False
    balance(run, free)
    allowed, previous = given.rtol * (1.0 + max(abs(now.v), abs(now.w))), math.inf
    for _ in range(ITERATIONS):
        largest = 0.0
        for i in range(size):
            move[i] = 0.0
            for j in range(size):
                move[i] -= inverse[i, j] * residual[j]
            change[i] += move[i]
            largest = max(largest, abs(move[i]))
        if not largest < math.inf or not evaluate_stages(run, free):
            return False
        if largest <= SHARE * allowed or 0.5 * previous <= largest <= STALL * allowed:
            return True
        previous = largest
        update(run, free, size)
    return False


def update(run: Run, free: int, size: int) -> None:
    """Evaluate the residuals after a move, and update the inverse Jacobian by Broyden's formula."""
    inverse, unknowns = run.inverse_jacobian, run.unknowns
    move, residual, before = unknowns.move, unknowns.residual, unknowns.before
    image, back = unknowns.image, unknowns.back
    for i in range(size):
        before[i] = residual[i]
    balance(run, free)
    product = 0.0
    for i in range(size):
        changed = returned = 0.0
        for j in range(size):
            changed += inverse[i, j] * (residual[j] - before[j])
            returned += move[j] * inverse[j, i]
        image[i], back[i] = changed, returned
        product += move[i] * changed
    for i in range(size):
        factor = (move[i] - image[i]) / product
        for j in range(size):
            inverse[i, j] += factor * back[j]


def gained(run: Run) -> float:
    """Return the share of its first velocities that the indenter gains in a step of the first pause."""
    if run.now.piece > 0 or not run.clock.paused[0]:
        return 0.0
    return float(run.steps[run.now.steps].span / run.pieces[0, END])


def guess(run: Run, free: int) -> None:
    """Write initial changes of d' and x' over the stages: those that continue the last step smoothly."""
    now, given, begun = run.now, run.given, gained(run)
    if not given.fixed:
        rates = run.polynomials.depth_rate[now.steps - 1]
        guess_rate(run, 0, rates, now.v, begun * given.start_rate)
    if given.sprung:
        rates = run.polynomials.offset_rate[now.steps - 1]
        guess_rate(run, free, rates, now.w, begun * given.start_along)


def guess_rate(run: Run, first: int, powers: Any, begin: float, gain: float) -> None:
    """Write the changes of one rate, the unknowns from `first` on; `powers` are those of the last step.

    In a pause they are known: `gain` at its end.
    """
    now, change = run.now, run.unknowns.change
    paused = run.steps[now.steps].lasts == 0.0
    for j in range(run.given.stages):
        change[first + j] = gain * float(run.stages.node[j])
        if now.smooth and not paused:
            last = run.steps[now.steps - 1]
            theta = (float(run.stages.s[j]) - last.start) / last.span
            change[first + j] = c_.value(powers, theta) - begin


def evaluate_stages(run: Run, free: int) -> bool:
    """Evaluate everything at the stages from the changes of d' and x'; return whether there is a contact."""
    run.now.evaluations += run.given.stages
    if not place(run, free):
        return False
    if run.now.sides[0].state == FREE:
        return True
    touching = run.now.sides[0].state != PEELING
    first = (
        0 if touching else 1
    )  # a peeling edge may be among elements that just entered at the other
    if not find_edge(run, first) or not find_edge(run, 1 - first):
        return False
    for j in range(run.given.stages):
        if not run.stages.edges[j, 0] < run.stages.edges[j, 1]:
            return False
    collect(run)
    return True


def place(run: Run, free: int) -> bool:
    """Evaluate the motion at the stages, and the accumulators; return whether the depth is positive."""
    now, given, n, change = run.now, run.given, run.given.stages, run.unknowns.change
    span, stages, arm, state = run.steps[now.steps].lasts, run.stages, run.arm_stages, run.state
    flies = now.sides[0].state == FREE
    for j in range(n):
        node = span * stages.node[j]
        d, x = now.d + node * now.v, now.x + node * now.w
        for k in range(n):
            if free:
                d += span * run.method.A[j, k] * change[k]
            if given.sprung:
                x += span * run.method.A[j, k] * change[free + k]
        stages.depth_rate[j] = now.v + (change[j] if free else 0.0)
        if len(run.depths) > 0:
            stages.depth_rate[j] += run.depths[now.piece, 2] * (stages.s[j] - now.s)
        stages.offset_rate[j] = now.w + (change[free + j] if given.sprung else 0.0)
        Y, number, _ = c_.base(run, now.piece, stages.s[j])
        stages.depth[j], stages.offset[j] = d, x
        stages.way[j], stages.sliding_velocity[j] = Y - x, number - stages.offset_rate[j]
        if not (d > 0.0 or flies) or not abs(d) < math.inf:
            return False
    interpolate_rates(run)
    memory, index = run.memory, now.steps
    for i in c_.over(given.arms):
        depth, slide = state.accumulated_depth[i], state.accumulated_slide[i]
        for j in range(n):
            arm.source[i, j] = span * 2.0 * stages.sliding_velocity[j]
        relax(run, i, arm.accumulated_slide, slide)
        for j in range(n):
            moved = stages.sliding_velocity[j] * arm.accumulated_slide[i, j]
            arm.source[i, j] = span * (stages.depth_rate[j] + moved)
        relax(run, i, arm.accumulated_depth, depth)
        interpolate_arm(run, i, memory.accumulated_slide[index], arm.accumulated_slide, slide)
        interpolate_arm(run, i, memory.accumulated_depth[index], arm.accumulated_depth, depth)
    return True


def interpolate_rates(run: Run) -> float:
    """Write the polynomials of d' and x'; return the larger error, relative to the rate."""
    now, polynomials, stages = run.now, run.polynomials, run.stages
    rate = interpolate(run, polynomials.depth_rate[now.steps], stages.depth_rate, now.v)
    along = interpolate(run, polynomials.offset_rate[now.steps], stages.offset_rate, now.w)
    return max(rate / (1.0 + abs(now.v)), along / (1.0 + abs(now.w)))


def interpolate_edge(run: Run, k: int) -> float:
    """Write the polynomial of an edge; return its error."""
    found = run.polynomials.edges[run.now.steps, :, k]
    return interpolate(run, found, run.stages.edges[:, k], run.now.sides[k].xi)


def find_edge(run: Run, k: int) -> bool:
    """Find an edge at the stages, what is there, and its velocity through the material."""
    n, stages, arm, element = run.given.stages, run.stages, run.arm_stages, run.element
    side, index, everything = run.now.sides[k], run.now.steps, c_.over(run.given.arms)
    for j in range(n):
        for i in everything:
            element.accumulated_depth[i] = arm.accumulated_depth[i, j]
            element.accumulated_slide[i] = arm.accumulated_slide[i, j]
        at = Motion(
            stages.s[j], stages.time[j], stages.depth[j], stages.depth_rate[j], stages.way[j],
            stages.sliding_velocity[j], stages.node[j],
        )  # fmt: skip
        xi, step, sigma = c_.edge_at(
            run, k, at, stages.edges[j, k], int(stages.entry_step[j, k]), stages.entry_time[j, k]
        )
        if not abs(xi) < math.inf:
            return False
        stages.edges[j, k], stages.entry_step[j, k], stages.entry_time[j, k] = xi, step, sigma
        stages.compression[j, k], stages.rise[j, k] = run.now.compression, run.now.rise
        if side.state == PEELING:
            stages.compression[j, k], stages.rise[j, k] = at.d - xi * xi, side.rise
        for i in everything:
            arm.stress_at_edge[i, j, k] = element.stress[i]
    interpolate_edge(run, k)
    polynomials = run.polynomials
    compression, rise = polynomials.compression[index, :, k], polynomials.rise[index, :, k]
    interpolate(run, compression, stages.compression[:, k], side.compression)
    interpolate(run, rise, stages.rise[:, k], side.rise)
    found, values = run.memory.stress_at_edge[index, :, :, k], arm.stress_at_edge[:, :, k]
    for i in everything:
        interpolate_arm(run, i, found, values, run.state.stress_at_edge[i, k])
    for j in range(n):
        speed = 0.0
        for m in range(n):
            speed += run.method.inverse[j, m] * (stages.edges[m, k] - side.xi)
        stages.edge_shift[j, k] = speed - run.steps[index].lasts * stages.sliding_velocity[j]
    return True


def collect(run: Run) -> None:
    """Evaluate the moments at the stages: first F_i, of which M_i has a share."""
    arm, state = run.arm_stages, run.state
    collect_sources(run, False)
    for i in c_.over(run.given.arms):
        relax(run, i, arm.force, state.force[i])
    collect_sources(run, True)
    for i in c_.over(run.given.arms):
        relax(run, i, arm.moment, state.moment[i])


def collect_sources(run: Run, of_moments: bool) -> None:
    """Write the sources of F_i, or of M_i, at the stages."""
    stages, arm, span = run.stages, run.arm_stages, run.steps[run.now.steps].lasts
    for j in range(run.given.stages):
        l, r = stages.edges[j, 0], stages.edges[j, 1]
        v, number = stages.depth_rate[j], stages.sliding_velocity[j]
        I_0, I_1, I_2, _ = moments(l, r)
        first, second = -stages.edge_shift[j, 0], stages.edge_shift[j, 1]
        change = v * I_0 - 2.0 * number * I_1
        if of_moments:
            first, second, change = l * first, r * second, v * I_1 - 2.0 * number * I_2
        for i in c_.over(run.given.arms):
            at_edges = first * arm.stress_at_edge[i, j, 0] + second * arm.stress_at_edge[i, j, 1]
            arm.source[i, j] = run.arms.stiffness[i] * (span * change) + at_edges
            if of_moments:
                arm.source[i, j] += span * number * arm.force[i, j]


def balance(run: Run, free: int) -> None:
    """Write the residuals of the equations of motion at the stages."""
    given, n = run.given, run.given.stages
    change, residual = run.unknowns.change, run.unknowns.residual
    span, stages, arm, c = run.steps[run.now.steps].lasts, run.stages, run.arm_stages, given.damper
    begun = gained(run)
    for j in range(n):
        first = second = 0.0
        for i in c_.over(given.arms):
            first += c_.total(arm.force[i, j])
            second += c_.total(arm.moment[i, j])
        d, x = float(stages.depth[j]), float(stages.offset[j])
        damped = c * stages.depth_rate[j], 2.0 * c * stages.sliding_velocity[j]
        f_z, f_x = forces(stages.edges[j, 0], stages.edges[j, 1], d, damped, first, second)
        down = along = 0.0
        for k in range(n):
            if free:
                down += run.method.inverse[j, k] * change[k]
            if given.sprung:
                along += run.method.inverse[j, k] * change[free + k]
        if free:
            residual[j] = given.eps * (down - begun * given.start_rate)
            residual[j] -= span * (1.0 - f_z - given.kappa * (d - 1.0))
        if given.sprung:
            held = given.damping * stages.offset_rate[j] + given.spring * x
            residual[free + j] = given.eps_x * (along - begun * given.start_along)
            residual[free + j] -= span * (f_x - held)


def linearize(run: Run, free: int, size: int) -> None:
    """Write the derivatives of the residuals by the changes, for edges that do not move."""
    given, n, square, edges = run.given, run.given.stages, run.jacobian, run.stages.edges
    span = run.steps[run.now.steps].lasts
    for j in range(size):
        for k in range(size):
            square[j, k] = 0.0
    for j in range(n):
        I_0, I_1, _, _ = moments(edges[j, 0], edges[j, 1])
        for k in range(n):
            share = given.damper if j == k else 0.0
            J_0, J_1, J_2, _ = moments(edges[k, 0], edges[k, 1])
            for i in c_.over(given.arms):
                share += span * c_.total(run.arms.stiffness[i] * run.filters[i, j, k])
            of_v, across, of_w = share * J_0, share * J_1, share * J_2
            step = span * run.method.A[j, k]
            if free:
                square[j, k] = given.eps * run.method.inverse[j, k]
                square[j, k] += span * (given.kappa * step + 0.75 * (I_0 * step + of_v))
            if given.sprung:
                along = given.eps_x * run.method.inverse[j, k]
                along += span * (given.spring * step + 3.0 * of_w)
                square[free + j, free + k] = along + (span * given.damping if j == k else 0.0)
            if free and given.sprung:
                square[j, free + k] = span * 1.5 * across
                square[free + j, k] = span * 1.5 * (I_1 * step + across)


def size_of(run: Run) -> float:
    """Write the other polynomials of a step; return its error relative to the tolerance.

    The error is estimated by the last coefficients of the polynomials in Legendre's: of the rates, the edges,
    the compressions that the arms remember, and the moments.
    """
    now, given, largest, moving, farthest = run.now, run.given, 0.0, 0.0, 0.0
    rates, memory, state, arm = interpolate_rates(run), run.memory, run.state, run.arm_stages
    width, index = now.sides[1].xi - now.sides[0].xi, now.steps
    for k in range(2):
        largest = max(largest, interpolate_edge(run, k))
        moving = max(moving, abs(now.sides[k].xi))
    at = c_.present(run)
    edge_pressure = given.damper * (abs(at.v) + 2.0 * abs(at.number) * moving)
    largest *= min(1.0, max(width, edge_pressure, given.rtol / (EDGE_SHARE * max(width, TINY))))
    remembered = first = second = 0.0
    for i in c_.over(given.arms):
        depth, slide = arm.accumulated_depth, arm.accumulated_slide
        A, B = state.accumulated_depth[i], state.accumulated_slide[i]
        compressed = interpolate_arm(run, i, memory.accumulated_depth[index], depth, A)
        compressed += moving * interpolate_arm(run, i, memory.accumulated_slide[index], slide, B)
        remembered += c_.total(run.arms.stiffness[i] * compressed)
        farthest += c_.total(abs(depth[i, given.stages - 1]))
        first += c_.total(interpolate_arm(run, i, memory.force[index], arm.force, state.force[i]))
        second += c_.total(
            interpolate_arm(run, i, memory.moment[index], arm.moment, state.moment[i])
        )
    narrow = min(1.0, width)  # what they remember of a narrow contact matters less
    error = max(rates, largest, remembered, narrow * first, narrow * second) / given.rtol
    return max(error, math.pow(farthest / given.farthest, 0.5 * given.stages))  # as it is a square
