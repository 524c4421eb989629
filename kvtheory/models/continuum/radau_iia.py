r"""One step of the equation of motion, eps v' = F(s, d, v), d' = v, by a Radau IIA method.

The stages are collocation points, so that the step is one polynomial of v over the whole step. F has
a known Jacobian, and eps d'' keeps the form in which eps -> 0 leaves F = 0 at every stage: the method
is stiffly accurate (Hairer and Wanner, Solving Ordinary Differential Equations II, sections IV.5, IV.8
and VI.1).

Why so many stages (`STAGES`): the error must be small all along the step, for memory is read off it, and
a step costs much beside its stages. Steps and evaluations of F that the start from rest of Table 1 takes,
for an error of the depth of about 1e-4 (seven stages give less than that at any tolerance), 1e-7 and
1e-11:

    stages   about 1e-4   about 1e-7    about 1e-11
    3        16, 198      54, 552       548, 4965
    4        13, 207      30, 445       106, 1181
    5        11, 253      22, 386       56, 826
    7        11, 341      11, 341       27, 634

Beyond seven, the linear algebra takes what the evaluations save. `make benchmark` holds it against LSODA,
`kvtheory chart work-precision` against SciPy's other methods and CVODE.
"""

import math
from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Legendre, Polynomial

from kvtheory.models.continuum import coupled
from kvtheory.models.continuum.contact import FREE, Instant, Run, edge, forces, pressure
from kvtheory.scene.base_motion import evaluate

STAGES = ((1e-3, 4), (1e-6, 5), (0.0, 7))
"""Number of stages for tolerances above each of these: the cheapest, as measured."""
MOST_STAGES, MOST_PROBES = 7, 3

NEWTON_STEPS = 8
NEWTON_SHARE = 1e-3
"""Of the tolerance, for the last correction; convergence is quadratic, what is left is far below."""
NEWTON_STALL = 0.5
"""Of the tolerance, for a correction that rounding keeps from becoming smaller."""
ROUNDING = 1e-15
"""Of F, relative to its terms and its largest derivative: a stiff spring multiplies rounding of the depth."""
PLACES = (0.08, 0.25, 0.55)
"""About where the defect of each step is probed, besides its end."""


Matrix = list[list[float]]


def _tableau(stages: int) -> tuple[list[float], Matrix, Matrix, Matrix]:
    """Return nodes c, matrix A, its inverse, and the powers of theta of v from V_j - v_0.

    In rational arithmetic, for the inverses are badly conditioned. L_j are the Lagrange polynomials of
    the nodes: A_ij is the integral of L_j, its inverse the derivative of theta L_j/c_j.
    """
    radau = Legendre.basis(stages) - Legendre.basis(stages - 1)
    roots = np.sort(np.real(radau.roots()))
    roots[:-1] -= radau(roots[:-1]) / radau.deriv()(roots[:-1])
    c = [*(Fraction(x) for x in (0.5 * (1.0 + roots[:-1])).tolist()), Fraction(1)]
    A, inverse, powers = ([[0.0] * stages for _ in c] for _ in range(3))
    for j, at in enumerate(c):
        lagrange = np.array([Fraction(1)])
        for other in c[:j] + c[j + 1 :]:
            lagrange = np.convolve(lagrange, [-other, Fraction(1)]) / (at - other)
        for i, theta in enumerate(c):
            A[i][j] = float(sum(x * theta ** (k + 1) / (k + 1) for k, x in enumerate(lagrange)))
            slope = sum(x * (k + 1) * theta**k for k, x in enumerate(lagrange))
            inverse[i][j] = float(slope / at)
            powers[i][j] = float(lagrange[i] / at)
    return [float(x) for x in c], A, inverse, powers


def _probes(c: list[float]) -> list[float]:
    """Return the extremes of the defect between the stages that are nearest to `PLACES`."""
    M = Polynomial.fromroots(c)
    turns = np.sort(np.real(M.deriv().roots()))
    nearest = [float(turns[np.argmin(np.abs(turns - place))]) for place in PLACES]
    return sorted(set(nearest))  # with few stages, one may be the nearest to two places


def _scales(c: list[float], probes: list[float]) -> list[list[float]]:
    """For each probe: largest |int M|, |M| and |M'| of the step, by |M| at the probe.

    The defect of a smooth step is a multiple of M = prod(theta - c_i).
    """
    theta = np.linspace(0.0, 1.0, 401)
    M = Polynomial.fromroots(c)
    inner = theta[theta >= c[0]]
    largest = [np.abs(f).max() for f in (M.integ()(theta), M(inner), M.deriv()(inner))]
    return [[float(x / abs(M(p))) for x in largest] for p in probes]


class Method(NamedTuple):
    """Nodes c, matrix A, its inverse, the powers of theta from the stages; probes, and their scales."""

    nodes: Any
    A: Any
    inverse: Any
    powers: Any
    probes: Any
    scales: Any


@cache
def radau(stages: int) -> Method:
    """Return the Radau IIA method of so many stages."""
    tableau = _tableau(stages)
    probes = _probes(tableau[0])
    return Method(*tableau, probes, _scales(tableau[0], probes))


def stages_for(rtol: float) -> int:
    """Return the number of stages that is cheapest for a tolerance."""
    return next(count for above, count in STAGES if rtol > above)


def imbalance(
    run: Run, step: Any, s: float, now: Instant
) -> tuple[float, float, float, float, float]:
    """Return F = 1 - f_z - kappa (d - 1), dF/dd, dF/dv, and both edges, which have the states of `step`.

    The pressure vanishes at a peeling edge and does not move a touching one, so that dF/dv is only the width.
    """
    d, v, kappa = now[0], now[1], run.given.kappa
    F, F_d, F_v = 1.0 - kappa * (d - 1.0), -kappa, 0.0
    left, right = step.sides[0], step.sides[1]
    if left.state == FREE:
        return F, F_d, F_v, math.nan, math.nan
    l, l_d, _, _ = edge(run, 0, left, s, now)
    r, r_d, _, _ = edge(run, 1, right, s, now)
    if l < r:
        f_z, _ = forces(l, r, d, v, now[4])
        F -= f_z
        F_v = -0.75 * (r - l)
        F_d -= 0.75 * (r - l + pressure(r, d, v, now[4]) * r_d - pressure(l, d, v, now[4]) * l_d)
    elif not l >= r:
        F = math.nan
    return F, F_d, F_v, l, r


def collocate(run: Run, step: Any, along: Any) -> int:
    """Solve for the stages of a step that has begun, and write its powers of v.

    Of n unknowns, v at the stages, row n of `matrix` holds a guess of them less v at the start; the rest is
    work space. With a spring there are as many unknowns along x, and the powers of x' are written to
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
        finite = coupled.linearize(run, step, along) if sprung else linearize(run, step)
        if not finite:
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


def linearize(run: Run, step: Any) -> bool:
    """Write the equations of Newton's method for all stages; return whether they are finite."""
    eps, method, matrix, stages = run.given.eps, run.method, run.matrix, run.method.stages
    change, places, numbers = matrix[stages], matrix[stages + 1], matrix[stages + 2]
    span, rate = step.span, step.rate[0]
    for i in range(stages):
        a, inverse, row = method.A[i], method.inverse[i], matrix[i]
        d, inertia = step.depth + span * method.nodes[i] * rate, 0.0
        for j in range(stages):
            d += span * a[j] * change[j]
            inertia += eps * inverse[j] * change[j]
        now = d, rate + change[i], 0.0, places[i], numbers[i], 0.0
        F, F_d, F_v, _, _ = imbalance(run, step, step.start + span * method.nodes[i], now)
        if not math.isfinite(F):
            return False
        for j in range(stages):
            row[j] = eps * inverse[j] - span * span * F_d * a[j]
        row[i] -= span * F_v
        row[stages] = span * F - inertia
    return True


def _write_powers(method: Any, change: Any, first: int, rate: Any) -> None:
    """Write the powers of a rate, from its changes at the stages."""
    for k in range(method.stages):
        power, powers = 0.0, method.powers[k]
        for j in range(method.stages):
            power += powers[j] * change[first + j]
        rate[1 + k] = power


def eliminate(matrix: Any) -> float:
    """Solve the augmented system of all stages in place, its last column; return the largest solution."""
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
