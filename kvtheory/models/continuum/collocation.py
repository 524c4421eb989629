r"""One step of the equations of motion by a Radau IIA method.

    eps d'' = F = 1 - f_z - kappa (d - 1),    eps_x x'' = G = f_x - c_x x' - kappa_x x,

the second one if a spring holds the indenter along x (fact F22): the base then slides under it with
lambda = lambda_0 - x', by Y = Y_0 - x. The stages are collocation points, so that the step is one polynomial
of v over the whole step. F has a known Jacobian, and eps d'' keeps the form in which eps -> 0 leaves F = 0 at
every stage: the method is stiffly accurate, see `run.radau`.
"""

import math
from typing import Any

from kvtheory.models.continuum.contact import Instant, edge, forces, pressure
from kvtheory.models.continuum.run import FREE, Run
from kvtheory.scene.base_motion import evaluate

NEWTON_STEPS, NEWTON_SHARE, NEWTON_STALL = 8, 1e-3, 0.5
"""Iteration limit; share of the tolerance below which a correction is the last one (convergence is
quadratic, the error far smaller), and that below which it may be the last if rounding stalls it."""
ROUNDING = 1e-15
"""Rounding of F, relative to its terms and its largest derivative: a stiff spring amplifies that of d."""

Balance = tuple[float, float, float, float, float]
"""A residual force, and its derivatives by d, d', x and x'."""
IN_FLIGHT = math.nan, math.nan, math.nan, -1
"""An edge in flight, see `contact.edge`."""


def imbalance(run: Run, step: Any, s: float, now: Instant) -> tuple[float, float, float, Any, Any]:
    """Return F, dF/dd, dF/dv, and both edges as `contact.edge` gives them, with the states of `step`.

    The pressure vanishes at a peeling edge and does not move a touching one, so that dF/dv is only the width.
    """
    d, v, kappa = now[0], now[1], run.given.kappa
    F, F_d, F_v = 1.0 - kappa * (d - 1.0), -kappa, 0.0
    if step.sides[0].state == FREE:
        return F, F_d, F_v, IN_FLIGHT, IN_FLIGHT
    left, right = edge(run, 0, step.sides[0], s, now), edge(run, 1, step.sides[1], s, now)
    l, r = left[0], right[0]
    if l < r:
        f_z, _ = forces(l, r, d, v, now[4])
        F -= f_z
        F_v = -0.75 * (r - l)
        p_l, p_r = pressure(l, d, v, now[4]), pressure(r, d, v, now[4])
        F_d -= 0.75 * (r - l + p_r * right[1] - p_l * left[1])
    elif not l >= r:
        F = math.nan
    return F, F_d, F_v, left, right


def balances(
    run: Run, step: Any, s: float, now: Instant, x: float, w: float
) -> tuple[Balance, Balance]:
    """Return F and G on a spring, each with its derivatives.

    The pressure vanishes at a peeling edge; a touching one moves with d and, on deformed ground, with Y.
    """
    given, (d, v, _, _, number, _) = run.given, now
    F, F_d, F_v, (l, l_d, l_Y, _), (r, r_d, r_Y, _) = imbalance(run, step, s, now)
    F_x = F_w = G_d = G_v = 0.0
    G, G_x, G_w = -given.damping * w - given.spring * x, -given.spring, -given.damping
    if l < r:  # false in flight, where both are NaN
        _, f_x = forces(l, r, d, v, number)
        p_l, p_r = pressure(l, d, v, number), pressure(r, d, v, number)
        G, width, squares = G + f_x, r - l, (r - l) * (r + l)
        F_w = G_v = -0.75 * squares
        F_x = 0.75 * (p_r * r_Y - p_l * l_Y)
        G_d = G_v - 1.5 * (r * p_r * r_d - l * p_l * l_d)
        G_x += 1.5 * (r * p_r * r_Y - l * p_l * l_Y)
        G_w -= width * (r * r + r * l + l * l)
    if given.fixed:
        F = F_d = F_v = F_x = F_w = 0.0
    return (F, F_d, F_v, F_x, F_w), (G, G_d, G_v, G_x, G_w)


def collocate(run: Run, step: Any, along: Any) -> int:
    """Solve for the stages of a step whose start is set, and write its powers of v.

    The n unknowns are v at the stages less v at the start; row n of `matrix` holds an initial guess, the rest
    is workspace. With a spring there are as many unknowns along x, and the powers of x' are written to
    `along`. Newton's method with the exact Jacobian of all stages; return the number of evaluations of
    F, or 0 if it does not converge.
    """
    method, matrix, sprung, stages = run.method, run.matrix, run.given.sprung, run.method.stages
    unknowns = len(matrix[0]) - 1
    change, places, numbers = matrix[unknowns], matrix[unknowns + 1], matrix[unknowns + 2]
    size, drive = 1.0 + abs(step.rate[0]), step.piece
    if sprung:
        size, drive = size + abs(along.rate[0]), along.piece
    for i in range(stages):
        s = step.start + step.span * method.nodes[i]
        places[i], numbers[i], _ = evaluate(run.pieces[drive], s)
    allowed, previous = run.given.rtol * size, math.inf
    for iteration in range(1, NEWTON_STEPS + 1):
        if not _linearize(run, step, along):
            return 0
        largest = eliminate(matrix)
        for i in range(unknowns):
            change[i] += matrix[i][unknowns]
        stalled = 0.5 * previous <= largest <= NEWTON_STALL * allowed
        if largest <= NEWTON_SHARE * allowed or stalled:
            _write_powers(method, change, 0, step.rate)
            if sprung:
                _write_powers(method, change, stages, along.rate)
            return iteration * stages
        if not largest < math.inf:
            return 0
        previous = largest
    return 0


def _linearize(run: Run, step: Any, along: Any) -> bool:
    """Write the equations of Newton's method for all stages; return whether they are finite."""
    given, method, matrix, stages = run.given, run.method, run.matrix, run.method.stages
    unknowns, span = len(matrix[0]) - 1, step.span
    change, places, numbers = matrix[unknowns], matrix[unknowns + 1], matrix[unknowns + 2]
    eps = 1.0 if given.fixed else given.eps  # a fixed indenter on a spring keeps d' = 0
    for i in range(stages):
        s, row = step.start + span * method.nodes[i], matrix[i]
        a, inverse = method.A[i], method.inverse[i]
        d, inertia = step.depth + span * method.nodes[i] * step.rate[0], 0.0
        for j in range(stages):
            d += span * a[j] * change[j]
            inertia += eps * inverse[j] * change[j]
        v = step.rate[0] + change[i]
        if given.sprung:
            row_x, w = matrix[stages + i], along.rate[0] + change[stages + i]
            x, inertia_x = along.depth + span * method.nodes[i] * along.rate[0], 0.0
            for j in range(stages):
                x += span * a[j] * change[stages + j]
                inertia_x += given.eps_x * inverse[j] * change[stages + j]
            now = d, v, 0.0, places[i] - x, numbers[i] - w, 0.0
            (F, F_d, F_v, F_x, F_w), (G, G_d, G_v, G_x, G_w) = balances(run, step, s, now, x, w)
            for j in range(stages):
                squared = span * span * a[j]
                row[stages + j], row_x[j] = -squared * F_x, -squared * G_d
                row_x[stages + j] = given.eps_x * inverse[j] - squared * G_x
            row[stages + i] -= span * F_w
            row_x[i] -= span * G_v
            row_x[stages + i] -= span * G_w
            row_x[unknowns] = span * G - inertia_x
            if not math.isfinite(G):
                return False
        else:
            now = d, v, 0.0, places[i], numbers[i], 0.0
            F, F_d, F_v, _, _ = imbalance(run, step, s, now)
        if not math.isfinite(F):
            return False
        factor = span * span * F_d
        for j in range(stages):
            row[j] = eps * inverse[j] - factor * a[j]
        row[i] -= span * F_v
        row[unknowns] = span * F - inertia
    return True


def _write_powers(method: Any, change: Any, first: int, rate: Any) -> None:
    """Write the powers of a rate, from its changes at the stages."""
    for k in range(method.stages):
        power, powers = 0.0, method.powers[k]
        for j in range(method.stages):
            power += powers[j] * change[first + j]
        rate[1 + k] = power


def eliminate(matrix: Any) -> float:
    """Solve the augmented system in place, into its last column; return the largest magnitude there."""
    stages = len(matrix[0]) - 1
    for k in range(stages):
        best = k
        for i in range(k + 1, stages):
            if abs(matrix[i][k]) > abs(matrix[best][k]):
                best = i
        if not abs(matrix[best][k]) > 0.0:
            return math.inf
        pivot, other = matrix[k], matrix[best]
        if best != k:
            for j in range(k, stages + 1):
                pivot[j], other[j] = other[j], pivot[j]
        for i in range(k + 1, stages):
            row = matrix[i]
            factor = row[k] / pivot[k]
            for j in range(k + 1, stages + 1):
                row[j] -= factor * pivot[j]
    largest = 0.0
    for k in range(stages - 1, -1, -1):
        row = matrix[k]
        for j in range(k + 1, stages):
            row[stages] -= row[j] * matrix[j][stages]
        row[stages] /= row[k]
        largest = max(largest, abs(row[stages]))
    return largest


def defect_error(
    span: float, eps: float, dv: float, F: float, F_d: float, F_v: float,
    rounding: float, scales: Any,
) -> float:  # fmt: skip
    """Estimate the error of v over the step from the defect eps v' - F at one of the probes.

    The error e obeys eps e' = F_v e + F_d int e - defect. It is the integral of the defect where
    inertia dominates, the defect itself where damping does, its derivative where stiffness does.
    `rounding` is the size of the terms of F.
    """
    integral, value, derivative = scales[0], scales[1], scales[2]
    defect = max(abs(eps * dv - F) - ROUNDING * rounding, 0.0)
    resistance = eps / integral - span * F_v / value - span * span * F_d / derivative
    return defect * span / resistance
