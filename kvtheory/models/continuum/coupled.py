r"""An indenter that its drive holds by a spring: both equations of motion in one collocation (fact F22).

    eps d'' = F = 1 - f_z - kappa (d - 1),    eps_x x'' = G = f_x - c_x x' - kappa_x x,

x(0) = x'(0) = 0. The base under the indenter slides with lambda = lambda_0 - x', by Y = Y_0 - x. For each
step, x' is a polynomial like d', kept in the record `along`, which is like that of the step; the difference
of drive and indenter is one more piece in `Run.pieces`: edges and memory are computed as for a rigid drive.
"""

import math
from typing import Any

from kvtheory.models.continuum.contact import FREE, Instant, Run, edge, forces, pressure
from kvtheory.scene import base_motion as b_

Balance = tuple[float, float, float, float, float]
"""A residual force, and its derivatives by d, d', x and x'."""


def slide(run: Run, along: Any, row: Any) -> None:
    """Write how the base slides under the indenter: the drive of a step less the motion along x."""
    piece = run.pieces[along.piece]
    after, count = along.start - piece[b_.START], len(row)
    row[b_.START], row[b_.END] = along.start, along.start + along.span
    row[b_.DISPLACEMENT] = b_.evaluate(piece, along.start)[0] - along.depth
    for k in range(b_.POWERS, count):
        row[k] = piece[k]
    if after != 0.0:
        for first in range(b_.POWERS, count - 1):
            for k in range(count - 2, first - 1, -1):
                row[k] += after * row[k + 1]
    scale = 1.0
    for k in range(run.method.stages + 1):
        row[b_.POWERS + k] -= along.rate[k] / scale
        scale *= along.span


def balances(
    run: Run, step: Any, s: float, now: Instant, x: float, w: float
) -> tuple[Balance, Balance]:
    """Return F and G, each with its derivatives.

    The pressure vanishes at a peeling edge; a touching one moves with d and, over what was left, with Y.
    """
    given = run.given
    d, v, number = now[0], now[1], now[4]
    F, F_d, F_v, F_x, F_w = 1.0 - given.kappa * (d - 1.0), -given.kappa, 0.0, 0.0, 0.0
    G, G_d, G_v = -given.damping * w - given.spring * x, 0.0, 0.0
    G_x, G_w = -given.spring, -given.damping
    left, right = step.sides[0], step.sides[1]
    if left.state != FREE:
        l, l_d, l_Y, _ = edge(run, 0, left, s, now)
        r, r_d, r_Y, _ = edge(run, 1, right, s, now)
        if l < r:
            f_z, f_x = forces(l, r, d, v, number)
            p_l, p_r = pressure(l, d, v, number), pressure(r, d, v, number)
            width, squares = r - l, (r - l) * (r + l)
            F, G = F - f_z, G + f_x
            F_d -= 0.75 * (width + p_r * r_d - p_l * l_d)
            F_v, F_w = -0.75 * width, -0.75 * squares
            F_x = 0.75 * (p_r * r_Y - p_l * l_Y)
            G_v = -0.75 * squares
            G_d = G_v - 1.5 * (r * p_r * r_d - l * p_l * l_d)
            G_x += 1.5 * (r * p_r * r_Y - l * p_l * l_Y)
            G_w -= width * (r * r + r * l + l * l)
        elif not l >= r:
            F = math.nan
    if given.fixed:
        F, F_d, F_v, F_x, F_w = 0.0, 0.0, 0.0, 0.0, 0.0
    return (F, F_d, F_v, F_x, F_w), (G, G_d, G_v, G_x, G_w)


def linearize(run: Run, step: Any, along: Any) -> bool:
    """Write the equations of Newton's method for all stages; return whether they are finite.

    The unknowns are the corrections of d' at the stages, then those of x'.
    """
    given, method, matrix, stages = run.given, run.method, run.matrix, run.method.stages
    change, places, numbers = matrix[2 * stages], matrix[2 * stages + 1], matrix[2 * stages + 2]
    span, v_0, w_0 = step.span, step.rate[0], along.rate[0]
    eps, eps_x = 1.0 if given.fixed else given.eps, given.eps_x
    for i in range(stages):
        a, inverse, F_row, G_row = method.A[i], method.inverse[i], matrix[i], matrix[stages + i]
        d = step.depth + span * method.nodes[i] * v_0
        x = along.depth + span * method.nodes[i] * w_0
        inertia = inertia_x = 0.0
        for j in range(stages):
            d += span * a[j] * change[j]
            x += span * a[j] * change[stages + j]
            inertia += eps * inverse[j] * change[j]
            inertia_x += eps_x * inverse[j] * change[stages + j]
        w = w_0 + change[stages + i]
        now = d, v_0 + change[i], 0.0, places[i] - x, numbers[i] - w, 0.0
        s = step.start + span * method.nodes[i]
        (F, F_d, F_v, F_x, F_w), (G, G_d, G_v, G_x, G_w) = balances(run, step, s, now, x, w)
        if not (math.isfinite(F) and math.isfinite(G)):
            return False
        for j in range(stages):
            squared = span * span * a[j]
            F_row[j] = eps * inverse[j] - squared * F_d
            F_row[stages + j] = -squared * F_x
            G_row[j] = -squared * G_d
            G_row[stages + j] = eps_x * inverse[j] - squared * G_x
        F_row[i] -= span * F_v
        F_row[stages + i] -= span * F_w
        G_row[i] -= span * G_v
        G_row[stages + i] -= span * G_w
        F_row[2 * stages] = span * F - inertia
        G_row[2 * stages] = span * G - inertia_x
    return True
