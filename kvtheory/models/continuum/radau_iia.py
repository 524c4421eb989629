"""Radau IIA methods: collocation, so that a step is one polynomial.

They are stiffly accurate: eps v' = F keeps the form in which eps -> 0 leaves F = 0 at every stage (Hairer
and Wanner, Solving Ordinary Differential Equations II, sections IV.5, IV.8 and VI.1).

Why so many stages (`STAGES`): the error must be small all along the step, since memory is evaluated from its
polynomial, and a step has large costs besides its stages. For the start from rest of Table 1, with an error
of the depth of about 1e-4, 1e-7 and 1e-11, three stages need 198, 552 and 4965 evaluations of F, four 207,
445 and 1181, five 253, 386 and 826, seven at most 341, 341 and 634. Beyond seven, the linear algebra costs
what the evaluations save. `make benchmark` compares it with LSODA, `kvtheory chart work-precision` with
SciPy's other methods and CVODE.
"""

from fractions import Fraction
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import Legendre, Polynomial

STAGES = ((1e-3, 4), (1e-6, 5), (0.0, 7))
"""Tolerances, and the number of stages that is the cheapest above each of them, as measured."""
MOST_STAGES, MOST_PROBES = 7, 3

PLACES = (0.08, 0.25, 0.55)
"""Approximate places, as shares of a step, at which its defect is probed, besides its end."""


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
    """Return the Radau IIA method with this number of stages.

    In rational arithmetic, since the inverses are ill-conditioned. L_j are the Lagrange polynomials of the
    nodes: A_ij is the integral of L_j, its inverse the derivative of theta L_j/c_j; the powers of theta of
    v are those of V_j - v_0. The defect of a smooth step is a multiple of M = prod(theta - c_i); it is
    probed at its extremes nearest to `PLACES`, whose scales are the largest |int M|, |M| and |M'| of the
    step divided by |M| there.
    """
    legendre = Legendre.basis(stages) - Legendre.basis(stages - 1)
    roots = np.sort(np.real(legendre.roots()))[:-1]
    roots -= legendre(roots) / legendre.deriv()(roots)
    c = [*(Fraction(x) for x in (0.5 * (1.0 + roots)).tolist()), Fraction(1)]
    A, inverse, powers = ([[0.0] * stages for _ in c] for _ in range(3))
    for j, at in enumerate(c):
        lagrange = np.array([Fraction(1)])
        for other in c[:j] + c[j + 1 :]:
            lagrange = np.convolve(lagrange, [-other, Fraction(1)]) / (at - other)
        for i, place in enumerate(c):
            A[i][j] = float(sum(x * place ** (k + 1) / (k + 1) for k, x in enumerate(lagrange)))
            slope = sum(x * (k + 1) * place**k for k, x in enumerate(lagrange))
            inverse[i][j] = float(slope / at)
            powers[i][j] = float(lagrange[i] / at)
    nodes = [float(x) for x in c]
    M, theta = Polynomial.fromroots(nodes), np.linspace(0.0, 1.0, 401)
    turns = np.sort(np.real(M.deriv().roots()))
    # with few stages, one extreme may be the nearest to two places
    probes = sorted({float(turns[np.argmin(np.abs(turns - place))]) for place in PLACES})
    inner = theta[theta >= nodes[0]]
    largest = [np.abs(f).max() for f in (M.integ()(theta), M(inner), M.deriv()(inner))]
    scales = [[float(x / abs(M(p))) for x in largest] for p in probes]
    return Method(nodes, A, inverse, powers, probes, scales)


def stages_for(rtol: float) -> int:
    """Return the number of stages that is cheapest for a tolerance."""
    return next(count for above, count in STAGES if rtol > above)
