"""One step on a Prony series by a Radau IIA method: the equations of motion, and linear filters for each arm.

At each stage the rates d' and x' are unknown. Given them, the accumulators follow from linear equations, the
trailing edges from the history, the moments from linear equations again, and the forces from these. The
residuals of the equations of motion are solved by Broyden's method, which starts from the Jacobian for edges
that do not move: the pressure vanishes at both edges, so that they do not matter to first order (F24).
"""

import math
from typing import Any

from kvtheory.models.continuum.prony.contact import (
    ALONG,
    DEPTHS,
    EDGE,
    FORCES,
    MOMENTS,
    OWN,
    PER_ARM,
    RATE,
    SLIDES,
    STRESSES,
    trailing,
)
from kvtheory.scene.base_motion import evaluate

TIME, DISPLACEMENT, NUMBER, DEPTH, FALL, OFFSET, SWING, SIGMA, OLDEST, FLUX, RISE = range(11)
"""Columns of a place: s; Y and lambda of the drive; d, d', x, x'; sigma and step of the element at the
trailing edge, the velocity of that edge through the material, and p' of the element."""
CHANGE, MOVE, RESIDUAL, BEFORE, IMAGE, BACK, SOURCE = range(7)
"""Vectors of Broyden's method, and the source of a filter."""
ITERATIONS, SHARE, STALL = 30, 0.02, 0.5
"""Iteration limit; share of the tolerance below which a correction is the last one, and that below which it
may be the last if it does not fall any more."""

Run = Any


def moments(l: float, r: float) -> tuple[float, float, float, float]:
    """Return the integrals of 1, xi, xi^2 and xi^3 from `l` to `r`."""
    a, b = l * l, r * r
    return r - l, (b - a) / 2.0, (b * r - a * l) / 3.0, (b * b - a * a) / 4.0


def forces(l: float, r: float, d: float, first: float, second: float) -> tuple[float, float]:
    """Return f_z and f_x; `first` and `second` are the sums of the moments of the arms."""
    I_0, I_1, I_2, I_3 = moments(l, r)
    return 0.75 * (d * I_0 - I_2 + first), -1.5 * (d * I_1 - I_3 + second)


def prepare(run: Run, span: float) -> None:
    """Begin a step of length `span` from the present state, and make the filters of the arms."""
    now, given, step = run.now, run.given, run.steps[run.now.steps]
    Y, _, _ = evaluate(run.pieces[now.piece], now.s)
    step.start, step.span, step.depth, step.along, step.piece = now.s, span, now.d, now.x, now.piece
    step.kinked, step.oldest, step.lead = now.kinked, now.oldest, -math.sqrt(now.d) - Y + now.x
    for j in range(given.stages):
        place = run.places[j]
        place[TIME] = now.s + run.nodes[j] * span
        place[DISPLACEMENT], place[NUMBER], _ = evaluate(run.pieces[now.piece], place[TIME])
        place[OLDEST], place[SIGMA] = now.oldest, now.sigma + (place[TIME] - now.s)
        run.stages[EDGE, j] = now.r
    for i in range(len(run.arms)):
        for j in range(given.stages):
            for k in range(given.stages):
                run.square[j, k] = run.inverse[j, k]
            run.square[j, j] += span / run.arms[i, 1]
        invert(run.square, given.stages, run.filters[i])


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


def relax(run: Run, i: int, row: int) -> None:
    """Solve y' = q - y/T_i for a row of an arm at the stages, with q in `SOURCE`."""
    source, n, begin = run.vectors[SOURCE], run.given.stages, run.state[i, row]
    span, found = run.steps[run.now.steps].span, run.stages[PER_ARM + OWN * i + row]
    for j in range(n):
        source[j] = span * source[j] + run.sums[j] * begin
    for j in range(n):
        total = 0.0
        for k in range(n):
            total += run.filters[i, j, k] * source[k]
        found[j] = total


def interpolate(run: Run, row: int, begin: float) -> float:
    """Write the polynomial of a row through the stages; return its last coefficient in Legendre's."""
    values, n = run.stages[row], run.given.stages
    found, share = run.rows[run.now.steps, row], 1.0
    found[0] = begin
    for k in range(n):
        total = 0.0
        for j in range(n):
            total += run.powers[k, j] * (values[j] - begin)
        found[k + 1] = total
        share *= (4.0 * k + 2.0) / (k + 1.0)  # binomial (2 n, n)
    return abs(found[n]) / share


def solve(run: Run) -> bool:
    """Solve the stages of a step that is prepared; return whether Broyden's method converged."""
    given, now = run.given, run.now
    free, change, move = 0 if given.fixed else given.stages, run.vectors[CHANGE], run.vectors[MOVE]
    size = free + (given.stages if given.sprung else 0)
    guess(run, free)
    if size == 0 or not evaluate_stages(run, free):
        return size == 0 and evaluate_stages(run, free)
    linearize(run, free, size)
    if not invert(run.square, size, run.inverted):
        return False
    balance(run, free)
    allowed, previous = given.rtol * (1.0 + max(abs(now.v), abs(now.w))), math.inf
    for _ in range(ITERATIONS):
        largest = 0.0
        for i in range(size):
            move[i] = 0.0
            for j in range(size):
                move[i] -= run.inverted[i, j] * run.vectors[RESIDUAL, j]
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
    inverse, move, residual = run.inverted, run.vectors[MOVE], run.vectors[RESIDUAL]
    before, image, back = run.vectors[BEFORE], run.vectors[IMAGE], run.vectors[BACK]
    for i in range(size):
        before[i] = residual[i]
    balance(run, free)
    product = 0.0
    for i in range(size):
        image[i] = back[i] = 0.0
        for j in range(size):
            image[i] += inverse[i, j] * (residual[j] - before[j])
            back[i] += move[j] * inverse[j, i]
        product += move[i] * image[i]
    for i in range(size):
        factor = (move[i] - image[i]) / product
        for j in range(size):
            inverse[i, j] += factor * back[j]


def guess(run: Run, free: int) -> None:
    """Write initial changes of d' and x' over the stages: those that continue the last step smoothly."""
    now, given, change = run.now, run.given, run.vectors[CHANGE]
    last = now.steps - 1
    for j in range(given.stages):
        if free:
            change[j] = 0.0
        if given.sprung:
            change[free + j] = 0.0
        if now.smooth:
            theta = (run.places[j, TIME] - run.steps[last].start) / run.steps[last].span
            for first, row, begin in ((0, RATE, now.v), (free, ALONG, now.w)):
                if (row == RATE and free) or (row == ALONG and given.sprung):
                    total = 0.0
                    for k in range(given.stages, -1, -1):
                        total = total * theta + run.rows[last, row, k]
                    change[first + j] = total - begin


def evaluate_stages(run: Run, free: int) -> bool:
    """Evaluate everything at the stages from the changes of d' and x'; return whether there is a contact."""
    run.now.evaluations += run.given.stages
    return place(run, free) and find_edges(run)


def place(run: Run, free: int) -> bool:
    """Evaluate the motion at the stages, and the accumulators; return whether the depth is positive."""
    now, given, n, change = run.now, run.given, run.given.stages, run.vectors[CHANGE]
    span, stages = run.steps[now.steps].span, run.stages
    for j in range(n):
        here = run.places[j]
        d, x = now.d + span * run.nodes[j] * now.v, now.x + span * run.nodes[j] * now.w
        v = now.v + (change[j] if free else 0.0)
        w = now.w + (change[free + j] if given.sprung else 0.0)
        for k in range(n):
            d += span * run.A[j, k] * change[k] if free else 0.0
            x += span * run.A[j, k] * change[free + k] if given.sprung else 0.0
        here[DEPTH], here[FALL], here[OFFSET], here[SWING] = d, v, x, w
        stages[RATE, j], stages[ALONG, j] = v, w
        if not 0.0 < d < math.inf:
            return False
    interpolate(run, RATE, now.v)
    interpolate(run, ALONG, now.w)
    source = run.vectors[SOURCE]
    for i in range(len(run.arms)):
        first = PER_ARM + OWN * i
        for j in range(n):
            source[j] = 2.0 * (run.places[j, NUMBER] - run.places[j, SWING])
        relax(run, i, SLIDES)
        for j in range(n):
            number = run.places[j, NUMBER] - run.places[j, SWING]
            source[j] = run.places[j, FALL] + number * stages[first + SLIDES, j]
        relax(run, i, DEPTHS)
        interpolate(run, first + SLIDES, run.state[i, SLIDES])
        interpolate(run, first + DEPTHS, run.state[i, DEPTHS])
    return True


def find_edges(run: Run) -> bool:
    """Find the trailing edge at the stages, and the moments; return whether there is a contact."""
    n, stages, source = run.given.stages, run.stages, run.vectors[SOURCE]
    for j in range(n):
        here = run.places[j]
        for i in range(len(run.arms)):
            for row in range(STRESSES):
                run.here[i, row] = stages[PER_ARM + OWN * i + row, j]
        r, flux, oldest, sigma, rise = trailing(
            run, here[TIME], here[DEPTH], here[FALL], here[DISPLACEMENT] - here[OFFSET],
            here[NUMBER] - here[SWING], stages[EDGE, j], int(here[OLDEST]), here[SIGMA], run.here,
        )  # fmt: skip
        if not r > -math.sqrt(here[DEPTH]):
            return False
        stages[EDGE, j], here[FLUX], here[SIGMA], here[RISE] = r, flux, sigma, rise
        here[OLDEST] = oldest
        for i in range(len(run.arms)):
            stages[PER_ARM + OWN * i + STRESSES, j] = run.here[i, STRESSES]
    for i in range(len(run.arms)):
        k, first = run.arms[i, 0], PER_ARM + OWN * i
        for row in (FORCES, MOMENTS):
            for j in range(n):
                here, r = run.places[j], stages[EDGE, j]
                v, number = here[FALL], here[NUMBER] - here[SWING]
                I_0, I_1, I_2, _ = moments(-math.sqrt(here[DEPTH]), r)
                lost = stages[first + STRESSES, j] * here[FLUX]
                if row == FORCES:
                    source[j] = k * (v * I_0 - 2.0 * number * I_1) + lost
                else:
                    source[j] = k * (v * I_1 - 2.0 * number * I_2) + r * lost
                    source[j] += number * stages[first + FORCES, j]
            relax(run, i, row)
    return True


def balance(run: Run, free: int) -> None:
    """Write the residuals of the equations of motion at the stages."""
    given, n, change = run.given, run.given.stages, run.vectors[CHANGE]
    span, residual = run.steps[run.now.steps].span, run.vectors[RESIDUAL]
    for j in range(n):
        place, first, second = run.places[j], 0.0, 0.0
        for i in range(len(run.arms)):
            first += run.stages[PER_ARM + OWN * i + FORCES, j]
            second += run.stages[PER_ARM + OWN * i + MOMENTS, j]
        d = place[DEPTH]
        f_z, f_x = forces(-math.sqrt(d), run.stages[EDGE, j], d, first, second)
        if free:
            inertia = 0.0
            for k in range(n):
                inertia += run.inverse[j, k] * change[k]
            residual[j] = given.eps * inertia - span * (1.0 - f_z - given.kappa * (d - 1.0))
        if given.sprung:
            inertia = 0.0
            for k in range(n):
                inertia += run.inverse[j, k] * change[free + k]
            held = given.damping * place[SWING] + given.spring * place[OFFSET]
            residual[free + j] = given.eps_x * inertia - span * (f_x - held)


def linearize(run: Run, free: int, size: int) -> None:
    """Write the derivatives of the residuals by the changes, for edges that do not move."""
    given, n, square = run.given, run.given.stages, run.square
    span = run.steps[run.now.steps].span
    for j in range(size):
        for k in range(size):
            square[j, k] = 0.0
    for j in range(n):
        place, r = run.places[j], run.stages[EDGE, j]
        I_0, I_1, _, _ = moments(-math.sqrt(place[DEPTH]), r)
        for k in range(n):
            of_v = of_w = across = 0.0
            J_0, J_1, J_2, _ = moments(-math.sqrt(run.places[k, DEPTH]), run.stages[EDGE, k])
            for i in range(len(run.arms)):
                share = span * run.arms[i, 0] * run.filters[i, j, k]
                of_v, across, of_w = of_v + share * J_0, across + share * J_1, of_w + share * J_2
            step = span * run.A[j, k]
            if free:
                square[j, k] = given.eps * run.inverse[j, k]
                square[j, k] += span * (given.kappa * step + 0.75 * (I_0 * step + of_v))
            if given.sprung:
                square[free + j, free + k] = given.eps_x * run.inverse[j, k]
                square[free + j, free + k] += span * (given.spring * step + 3.0 * of_w)
                if j == k:
                    square[free + j, free + k] += span * given.damping
            if free and given.sprung:
                square[j, free + k] = span * 1.5 * across
                square[free + j, k] = span * 1.5 * (I_1 * step + across)


def size_of(run: Run) -> float:
    """Write the other polynomials of a step; return its error relative to the tolerance.

    The error is estimated by the last coefficients of the polynomials in Legendre's: of the rates, the edge,
    the compressions that the arms remember, and the moments.
    """
    now, given = run.now, run.given
    rate = interpolate(run, RATE, now.v) / (1.0 + abs(now.v))
    along = interpolate(run, ALONG, now.w) / (1.0 + abs(now.w))
    largest = max(rate, along, interpolate(run, EDGE, now.r))
    remembered = first = second = 0.0
    for i in range(len(run.arms)):
        k, row, state = run.arms[i, 0], PER_ARM + OWN * i, run.state[i]
        remembered += k * interpolate(run, row + DEPTHS, state[DEPTHS])
        remembered += k * abs(now.r) * interpolate(run, row + SLIDES, state[SLIDES])
        interpolate(run, row + STRESSES, state[STRESSES])
        first += interpolate(run, row + FORCES, state[FORCES])
        second += interpolate(run, row + MOMENTS, state[MOMENTS])
    return max(largest, remembered, first, second) / given.rtol
