r"""One step of the equation of motion, eps v' = F(s, d, v), d' = v, by a Radau IIA method.

The stages are collocation points, so that the step is one polynomial of v over the whole step. F has
a known Jacobian, and eps d'' keeps the form in which eps -> 0 leaves F = 0 at every stage: the method
is stiffly accurate (Hairer and Wanner, Solving Ordinary Differential Equations II, sections IV.5, IV.8
and VI.1).

Why seven stages, of order 13: the error must be small all along the step, for memory is read off it.
Table 1 at a tolerance of 1e-9, with an error of d' below 1.5e-9 everywhere, takes 320, 107, 57, 31 and
20 steps and 2883, 1203, 812, 764 and 573 evaluations of F with 3, 4, 5, 7 and 9 stages; beyond seven,
the linear algebra takes what the evaluations save. SciPy needs for an error of 2e-9 everywhere 870
evaluations with LSODA, 1800 with BDF, more than 2000 with Radau, and more than 2900 with DOP853, which
is not for small eps.
"""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from numpy.polynomial import Legendre, Polynomial

from kvtheory.transients import history as h_
from kvtheory.transients.contact import FREE, edge, forces, pressure
from kvtheory.transients.drive import Piece, evaluate
from kvtheory.transients.history import Rows

STAGES = 7
NEWTON_STEPS = 8
NEWTON_SHARE = 1e-3
"""Of the tolerance, for the last correction; convergence is quadratic, what is left is far below."""
NEWTON_STALL = 0.5
"""Of the tolerance, for a correction that rounding keeps from becoming smaller."""
ROUNDING = 1e-15
"""Of F, by its largest derivative: a stiff spring feels the last digit of the depth."""
PROBES = (0.08, 0.25, 0.55, 1.0)
"""Where each step is examined: between the stages, where the defect is largest, and at the end."""


def _times(p: list[Fraction], root: Fraction) -> list[Fraction]:
    """Return the coefficients of p(theta) (theta - root), lowest first."""
    return [
        low - root * high for low, high in zip([Fraction(0), *p], [*p, Fraction(0)], strict=True)
    ]


def _tableau(
    stages: int,
) -> tuple[list[float], list[list[float]], list[list[float]], list[list[float]]]:
    """Return nodes c, matrix A, its inverse, and the powers of theta of v from V_j - v_0.

    In rational arithmetic, for the inverses are badly conditioned. L_j are the Lagrange polynomials of
    the nodes: A_ij is the integral of L_j, its inverse the derivative of theta L_j/c_j.
    """
    radau = Legendre.basis(stages) - Legendre.basis(stages - 1)
    roots = np.sort(np.real(radau.roots()))
    roots[:-1] -= radau(roots[:-1]) / radau.deriv()(roots[:-1])
    c = [*(Fraction(x) for x in (0.5 * (1.0 + roots[:-1])).tolist()), Fraction(1)]
    A = [[0.0] * stages for _ in c]
    inverse = [[0.0] * stages for _ in c]
    powers = [[0.0] * stages for _ in c]
    for j, at in enumerate(c):
        lagrange = [Fraction(1)]
        for other in c[:j] + c[j + 1 :]:
            lagrange = [x / (at - other) for x in _times(lagrange, other)]
        for i, theta in enumerate(c):
            A[i][j] = float(sum(x * theta ** (k + 1) / (k + 1) for k, x in enumerate(lagrange)))
            slope = sum(x * (k + 1) * theta**k for k, x in enumerate(lagrange))
            inverse[i][j] = float(slope / at)
            powers[i][j] = float(lagrange[i] / at)
    return [float(x) for x in c], A, inverse, powers


def _scales(c: list[float]) -> tuple[tuple[float, float, float], ...]:
    """For each probe but the last: largest |int M|, |M| and |M'| of the step, by |M| at the probe.

    The defect of a smooth step is a multiple of M = prod(theta - c_i).
    """
    theta = np.linspace(0.0, 1.0, 401)
    M = Polynomial.fromroots(c)
    inner = theta[theta >= c[0]]
    largest = [np.abs(f).max() for f in (M.integ()(theta), M(inner), M.deriv()(inner))]
    return tuple(tuple(float(x / abs(M(p))) for x in largest) for p in PROBES[:-1])  # type: ignore[misc]


NODES, A, A_INVERSE, TO_POWERS = _tableau(STAGES)
DEFECT_SCALES = _scales(NODES)


def imbalance(
    s: float,
    d: float,
    v: float,
    Y: float,
    number: float,
    sides: Sequence[float],
    kappa: float,
    nodes: Rows,
    records: Rows,
    pieces: Sequence[Piece],
) -> tuple[float, float, float, float, float]:
    """Return F = 1 - f_z - kappa (d - 1), dF/dd, dF/dv, and both edges.

    `sides` holds state and node of the left edge, then of the right one. The pressure vanishes at a
    peeling edge and does not move a touching one, so that dF/dv is only the width.
    """
    F, F_d, F_v = 1.0 - kappa * (d - 1.0), -kappa, 0.0
    if sides[0] == FREE:
        return F, F_d, F_v, math.nan, math.nan
    l, l_d, _ = edge(-1.0, sides[0], int(sides[1]), s, d, v, Y, number, nodes, records, pieces)
    r, r_d, _ = edge(1.0, sides[2], int(sides[3]), s, d, v, Y, number, nodes, records, pieces)
    if l < r:
        f_z, _ = forces(l, r, d, v, number)
        F -= f_z
        F_v = -0.75 * (r - l)
        F_d -= 0.75 * (r - l + pressure(r, d, v, number) * r_d - pressure(l, d, v, number) * l_d)
    elif not l >= r:
        F = math.nan
    return F, F_d, F_v, l, r


def collocate(
    record: list[float],
    guess: Sequence[float],
    eps: float,
    kappa: float,
    tolerance: float,
    nodes: Rows,
    records: Rows,
    pieces: Sequence[Piece],
) -> int:
    """Solve for the stages of the step that `record` begins, and write its powers of v.

    `guess` holds v at the stages minus v at the start. Newton's method with the exact Jacobian of all
    stages; return the number of evaluations of F, or 0 if it does not converge.
    """
    start, span, depth, rate = (
        record[h_.START],
        record[h_.SPAN],
        record[h_.DEPTH],
        record[h_.POWERS],
    )
    piece = pieces[int(record[h_.PIECE])]
    sides = record[h_.LEFT_STATE : h_.LEFT_X]
    times = [start + c * span for c in NODES]
    drive = [evaluate(piece, s) for s in times]
    change = list(guess)
    previous = math.inf
    matrix = [[0.0] * (STAGES + 1) for _ in NODES]
    for iteration in range(1, NEWTON_STEPS + 1):
        for i in range(STAGES):
            a, inverse, row = A[i], A_INVERSE[i], matrix[i]
            d, inertia = depth + span * NODES[i] * rate, 0.0
            for j in range(STAGES):
                d += span * a[j] * change[j]
                inertia += eps * inverse[j] * change[j]
            Y, number, _ = drive[i]
            F, F_d, F_v, _, _ = imbalance(
                times[i], d, rate + change[i], Y, number, sides, kappa, nodes, records, pieces
            )
            if not math.isfinite(F):
                return 0
            for j in range(STAGES):
                row[j] = eps * inverse[j] - span * span * F_d * a[j]
            row[i] -= span * F_v
            row[STAGES] = span * F - inertia
        largest = eliminate(matrix)
        for i in range(STAGES):
            change[i] += matrix[i][STAGES]
        allowed = tolerance * (1.0 + abs(rate))
        stalled = 0.5 * previous <= largest <= NEWTON_STALL * allowed
        if largest <= NEWTON_SHARE * allowed or stalled:
            for k in range(STAGES):
                record[h_.POWERS + 1 + k] = sum(TO_POWERS[k][j] * change[j] for j in range(STAGES))
            return iteration * STAGES
        if not largest < math.inf:
            return 0
        previous = largest
    return 0


def eliminate(matrix: list[list[float]]) -> float:
    """Solve the augmented system in place, its last column; return the largest solution."""
    n = len(matrix)
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(matrix[i][k]) > abs(matrix[best][k]):
                best = i
        if not abs(matrix[best][k]) > 0.0:
            return math.inf
        matrix[k], matrix[best] = matrix[best], matrix[k]
        pivot = matrix[k]
        for i in range(k + 1, n):
            row = matrix[i]
            factor = row[k] / pivot[k]
            for j in range(k + 1, n + 1):
                row[j] -= factor * pivot[j]
    largest = 0.0
    for k in range(n - 1, -1, -1):
        row = matrix[k]
        for j in range(k + 1, n):
            row[n] -= row[j] * matrix[j][n]
        row[n] /= row[k]
        largest = max(largest, abs(row[n]))
    return largest


def defect_error(
    span: float, eps: float, F_d: float, F_v: float, inertia: float, F: float, probe: int
) -> float:
    """Estimate the error of v over the step from the defect eps v' - F at one of the `PROBES`.

    The error e obeys eps e' = F_v e + F_d int e - defect. It is the integral of the defect where
    inertia rules, the defect itself where damping does, its derivative where stiffness does.
    """
    integral, value, derivative = DEFECT_SCALES[probe]
    defect = max(abs(inertia - F) - ROUNDING * (1.0 - F_d), 0.0)
    resistance = eps / integral - span * F_v / value - span * span * F_d / derivative
    return defect * span / resistance
