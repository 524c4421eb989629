"""One step on a Prony series by a Radau IIA method: the equations of motion, and linear filters for each arm.

At each stage the rates d' and x' are unknown. Given them, the accumulators follow from linear equations, the
trailing edges from the history, the moments from linear equations again, and the forces from these. The
residuals of the equations of motion are solved by Broyden's method, which starts from the Jacobian for edges
that do not move: the pressure vanishes at both edges, so that they do not matter to first order (F24).
"""

import math
from typing import Any

import numpy as np

from kvtheory.models.continuum.prony.contact import (
    ALONG,
    DEPTHS,
    EDGES,
    FORCES,
    FREE,
    MOMENTS,
    PEELING,
    RATE,
    ROWS,
    SLIDES,
    STRESSES,
    edge_at,
    over,
    total,
    value,
)
from kvtheory.models.continuum.prony.contact import STIFFNESS as STIFF
from kvtheory.models.continuum.prony.contact import TIME as RELAXATION
from kvtheory.scene.base_motion import evaluate

MOMENT, WAY, SPEED, DEPTH, OFFSET, SIGMA, INDEX, FLUX = 0, 1, 2, 3, 4, 5, 7, 9
"""What else belongs to a stage: s; Y and lambda of the base under the indenter; d, x; of both edges the
instant and the step of the element there, and the velocity through the material."""
CHANGE, MOVE, RESIDUAL, BEFORE, IMAGE, BACK = range(6)
"""Vectors of Broyden's method."""
ITERATIONS, SHARE, STALL = 30, 0.02, 0.5
"""Iteration limit; share of the tolerance below which a correction is the last one, and that below which it
may be the last if it does not fall any more."""

EDGE_SHARE, TINY = 0.03, 1e-12
"""Largest error of an edge as a share of the width. Relative to the tolerance it is weighted by the width,
for the pressure vanishes at an edge."""
SHIFT = 4e-14
"""Rounding of the time, relative to the run, where errors are estimated."""

Run = Any


A, INVERSE, POWERS, OTHER = range(4)
LAST = 2
"""Tables of `Run.method`; the rows of the last are the nodes, the sums of the rows of the inverse, and, in
`LAST`, the last coefficient of a polynomial in Legendre's over that of its last power."""


def moments(l: float, r: float) -> tuple[float, float, float, float]:
    """Return the integrals of 1, xi, xi^2 and xi^3 from `l` to `r`."""
    a, b = l * l, r * r
    return r - l, (b - a) / 2.0, (b * r - a * l) / 3.0, (b * b - a * a) / 4.0


def forces(l: float, r: float, d: float, first: float, second: float) -> tuple[float, float]:
    """Return f_z and f_x; `first` and `second` are the sums of the moments of the arms."""
    I_0, I_1, I_2, I_3 = moments(l, r)
    return 0.75 * (d * I_0 - I_2 + first), -1.5 * (d * I_1 - I_3 + second)


def at(run: Run, what: int, j: int) -> float:
    """Return what else belongs to a stage."""
    return float(run.stages[ROWS + what, j])


def prepare(run: Run, span: float) -> None:
    """Begin a step of length `span` from the present state, and make the filters of the arms."""
    now, n, step = run.now, run.given.stages, run.steps[run.now.steps]
    step.start, step.span, step.depth, step.along, step.piece = now.s, span, now.d, now.x, now.piece
    step.first, step.count, step.since = now.first, now.count, now.since
    for k in range(2):
        side, kept = now.sides[k], step.sides[k]
        step.kinked[k] = now.kinked[k]
        kept.state, kept.segment, kept.own, kept.xi = side.state, side.segment, side.own, side.xi
    other = run.stages[ROWS:]
    for j in range(n):
        after = run.method[OTHER, 0, j] * span
        other[MOMENT, j] = now.s + after
        for k in range(2):
            side = now.sides[k]
            other[INDEX + k, j], other[SIGMA + k, j] = side.index, side.sigma + side.pace * after
            run.stages[EDGES + k, j] = side.xi
    for i in over(len(run.arms)):
        filter_of(run, i, span)


def filter_of(run: Run, i: Any, span: float) -> None:
    """Write the inverse of A^-1 + span/T_i, by Gauss-Jordan elimination; it needs no pivoting."""
    n, found = run.given.stages, run.filters
    for j in range(n):
        for k in range(n):
            found[i, j, k] = run.method[INVERSE, j, k]
        found[i, j, j] += span / run.arms[i, RELAXATION]
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


def relax(run: Run, i: Any, row: int) -> None:
    """Solve y' = q - y/T_i for a row of an arm at the stages, with q in `sources`."""
    source, n, span = run.sources, run.given.stages, run.steps[run.now.steps].span
    for j in range(n):
        source[i, j] = span * source[i, j] + run.method[OTHER, 1, j] * run.state[i, row]
    for j in range(n):
        run.arm_stages[i, row, j] = 0.0
        for k in range(n):
            run.arm_stages[i, row, j] += run.filters[i, j, k] * source[i, k]


def interpolate_arm(run: Run, i: Any, row: int) -> Any:
    """Write the polynomial of an arm through the stages; return its error, as `interpolate` does."""
    n, found, change = run.given.stages, run.memory[run.now.steps], 0.0
    found[i, row, 0] = run.state[i, row]
    for k in range(n):
        found[i, row, k + 1] = 0.0
        for j in range(n):
            change = run.arm_stages[i, row, j] - run.state[i, row]
            found[i, row, k + 1] += run.method[POWERS, k, j] * change
    return np.maximum(uncertain(run, found[i, row, n], change), 0.0)


def interpolate(run: Run, row: int, begin: float) -> float:
    """Write the polynomial of a row through the stages; return its error."""
    values, n = run.stages[row], run.given.stages
    found = run.rows[run.now.steps, row]
    found[0] = begin
    for k in range(n):
        found[k + 1] = 0.0
        for j in range(n):
            found[k + 1] += run.method[POWERS, k, j] * (values[j] - begin)
    return max(uncertain(run, found[n], values[n - 1] - begin), 0.0)


def uncertain(run: Run, last: Any, change: Any) -> Any:
    """Return the last coefficient in Legendre's polynomials, less what a shift of the time changes.

    An edge may run through a layer on a fast arm: it is as uncertain as the time, and no shorter step helps.
    """
    shift = SHIFT * run.given.end / run.steps[run.now.steps].span
    return run.method[OTHER, LAST, 0] * abs(last) - shift * abs(change)


def solve(run: Run) -> bool:
    """Solve the stages of a step that is prepared; return whether Broyden's method converged."""
    given, now = run.given, run.now
    free, change, move = 0 if given.fixed else given.stages, run.vectors[CHANGE], run.vectors[MOVE]
    size, inverse = free + (given.stages if given.sprung else 0), run.squares[1]
    guess(run, free)
    if not evaluate_stages(run, free):
        return False
    if size == 0:
        return True
    linearize(run, free, size)
    if not invert(run.squares[0], size, inverse):
        return False
    balance(run, free)
    allowed, previous = given.rtol * (1.0 + max(abs(now.v), abs(now.w))), math.inf
    for _ in range(ITERATIONS):
        largest = 0.0
        for i in range(size):
            move[i] = 0.0
            for j in range(size):
                move[i] -= inverse[i, j] * run.vectors[RESIDUAL, j]
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
    inverse, move, residual = run.squares[1], run.vectors[MOVE], run.vectors[RESIDUAL]
    before, image, back = run.vectors[BEFORE], run.vectors[IMAGE], run.vectors[BACK]
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


def guess(run: Run, free: int) -> None:
    """Write initial changes of d' and x' over the stages: those that continue the last step smoothly."""
    now, given, change, last = run.now, run.given, run.vectors[CHANGE], run.now.steps - 1
    for first, row, begin, moves in (
        (0, RATE, now.v, not given.fixed), (free, ALONG, now.w, given.sprung)
    ):  # fmt: skip
        if moves:
            for j in range(given.stages):
                change[first + j] = 0.0
                if now.smooth:
                    theta = (at(run, MOMENT, j) - run.steps[last].start) / run.steps[last].span
                    change[first + j] = value(run.rows[last, row], theta) - begin


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
        if not run.stages[EDGES, j] < run.stages[EDGES + 1, j]:
            return False
    collect(run)
    return True


def place(run: Run, free: int) -> bool:
    """Evaluate the motion at the stages, and the accumulators; return whether the depth is positive."""
    now, given, n, change = run.now, run.given, run.given.stages, run.vectors[CHANGE]
    span, stages, source = run.steps[now.steps].span, run.stages, run.sources
    other, flies = stages[ROWS:], now.sides[0].state == FREE
    for j in range(n):
        node = span * run.method[OTHER, 0, j]
        d, x = now.d + node * now.v, now.x + node * now.w
        for k in range(n):
            if free:
                d += span * run.method[A, j, k] * change[k]
            if given.sprung:
                x += span * run.method[A, j, k] * change[free + k]
        stages[RATE, j] = now.v + (change[j] if free else 0.0)
        stages[ALONG, j] = now.w + (change[free + j] if given.sprung else 0.0)
        Y, number, _ = evaluate(run.pieces[now.piece], other[MOMENT, j])
        other[DEPTH, j], other[OFFSET, j] = d, x
        other[WAY, j], other[SPEED, j] = Y - x, number - stages[ALONG, j]
        if not (d > 0.0 or flies) or not abs(d) < math.inf:
            return False
    interpolate(run, RATE, now.v)
    interpolate(run, ALONG, now.w)
    for i in over(len(run.arms)):
        for j in range(n):
            source[i, j] = 2.0 * other[SPEED, j]
        relax(run, i, SLIDES)
        for j in range(n):
            source[i, j] = stages[RATE, j] + other[SPEED, j] * run.arm_stages[i, SLIDES, j]
        relax(run, i, DEPTHS)
        interpolate_arm(run, i, SLIDES)
        interpolate_arm(run, i, DEPTHS)
    return True


def find_edge(run: Run, k: int) -> bool:
    """Find an edge at the stages, its stresses, and its velocity through the material."""
    n, stages, side = run.given.stages, run.stages, run.now.sides[k]
    span, other, everything = run.steps[run.now.steps].span, stages[ROWS:], over(len(run.arms))
    for j in range(n):
        for i in everything:
            for row in range(STRESSES):
                run.here[i, row] = run.arm_stages[i, row, j]
        xi, index, sigma = edge_at(
            run, k, other[MOMENT, j], other[DEPTH, j], other[WAY, j], stages[EDGES + k, j],
            int(other[INDEX + k, j]), other[SIGMA + k, j],
        )  # fmt: skip
        if not abs(xi) < math.inf:
            return False
        stages[EDGES + k, j], other[INDEX + k, j], other[SIGMA + k, j] = xi, index, sigma
        for i in everything:
            run.arm_stages[i, STRESSES + k, j] = run.here[i, STRESSES]
    interpolate(run, EDGES + k, side.xi)
    for i in everything:
        interpolate_arm(run, i, STRESSES + k)
    for j in range(n):
        speed = 0.0
        for m in range(n):
            speed += run.method[INVERSE, j, m] * (stages[EDGES + k, m] - side.xi)
        other[FLUX + k, j] = speed / span - other[SPEED, j]
    return True


def collect(run: Run) -> None:
    """Evaluate the moments at the stages."""
    n, stages, arm = run.given.stages, run.stages, run.arm_stages
    other = stages[ROWS:]
    for row in (FORCES, MOMENTS):
        for j in range(n):
            l, r, v, number = (
                stages[EDGES, j],
                stages[EDGES + 1, j],
                stages[RATE, j],
                other[SPEED, j],
            )
            I_0, I_1, I_2, _ = moments(l, r)
            first, second, change = (
                -other[FLUX, j],
                other[FLUX + 1, j],
                v * I_0 - 2.0 * number * I_1,
            )
            if row == MOMENTS:
                first, second, change = l * first, r * second, v * I_1 - 2.0 * number * I_2
            for i in over(len(run.arms)):
                run.sources[i, j] = run.arms[i, STIFF] * change
                run.sources[i, j] += first * arm[i, STRESSES, j] + second * arm[i, STRESSES + 1, j]
                if row == MOMENTS:
                    run.sources[i, j] += number * arm[i, FORCES, j]
        for i in over(len(run.arms)):
            relax(run, i, row)


def balance(run: Run, free: int) -> None:
    """Write the residuals of the equations of motion at the stages."""
    given, n, change = run.given, run.given.stages, run.vectors[CHANGE]
    span, residual = run.steps[run.now.steps].span, run.vectors[RESIDUAL]
    for j in range(n):
        first = second = 0.0
        for i in over(len(run.arms)):
            first += total(run.arm_stages[i, FORCES, j])
            second += total(run.arm_stages[i, MOMENTS, j])
        d, x = at(run, DEPTH, j), at(run, OFFSET, j)
        f_z, f_x = forces(run.stages[EDGES, j], run.stages[EDGES + 1, j], d, first, second)
        down = along = 0.0
        for k in range(n):
            if free:
                down += run.method[INVERSE, j, k] * change[k]
            if given.sprung:
                along += run.method[INVERSE, j, k] * change[free + k]
        if free:
            residual[j] = given.eps * down - span * (1.0 - f_z - given.kappa * (d - 1.0))
        if given.sprung:
            held = given.damping * run.stages[ALONG, j] + given.spring * x
            residual[free + j] = given.eps_x * along - span * (f_x - held)


def linearize(run: Run, free: int, size: int) -> None:
    """Write the derivatives of the residuals by the changes, for edges that do not move."""
    given, n, square = run.given, run.given.stages, run.squares[0]
    span = run.steps[run.now.steps].span
    for j in range(size):
        for k in range(size):
            square[j, k] = 0.0
    for j in range(n):
        I_0, I_1, _, _ = moments(run.stages[EDGES, j], run.stages[EDGES + 1, j])
        for k in range(n):
            share = 0.0
            J_0, J_1, J_2, _ = moments(run.stages[EDGES, k], run.stages[EDGES + 1, k])
            for i in over(len(run.arms)):
                share += span * total(run.arms[i, STIFF] * run.filters[i, j, k])
            of_v, across, of_w = share * J_0, share * J_1, share * J_2
            step = span * run.method[A, j, k]
            if free:
                square[j, k] = given.eps * run.method[INVERSE, j, k]
                square[j, k] += span * (given.kappa * step + 0.75 * (I_0 * step + of_v))
            if given.sprung:
                along = given.eps_x * run.method[INVERSE, j, k]
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
    now, given, largest, moving, counted = run.now, run.given, 0.0, 0.0, 0.0
    rate = interpolate(run, RATE, now.v) / (1.0 + abs(now.v))
    along = interpolate(run, ALONG, now.w) / (1.0 + abs(now.w))
    width = now.sides[1].xi - now.sides[0].xi
    for k in range(2):
        largest = max(largest, interpolate(run, EDGES + k, now.sides[k].xi))
        moving = max(moving, abs(now.sides[k].xi))
    largest *= min(1.0, max(width, given.rtol / (EDGE_SHARE * max(width, TINY))))
    remembered = first = second = 0.0
    for i in over(len(run.arms)):
        compressed = interpolate_arm(run, i, DEPTHS) + moving * interpolate_arm(run, i, SLIDES)
        remembered += total(run.arms[i, STIFF] * compressed)
        counted += total(abs(run.arm_stages[i, DEPTHS, given.stages - 1]))
        first += total(interpolate_arm(run, i, FORCES))
        second += total(interpolate_arm(run, i, MOMENTS))
    narrow = min(1.0, width)  # what they remember of a narrow contact matters less
    error = max(rate, along, largest, remembered, narrow * first, narrow * second) / given.rtol
    return max(error, math.pow(counted / given.counted, 0.5 * given.stages))  # as it is a square
