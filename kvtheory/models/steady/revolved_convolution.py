r"""Steady sliding of a ball, and of a convex profile of revolution, on any linear viscoelastic foundation.

The strips are those of `kvtheory.models.steady.revolved`, each a line contact by
`kvtheory.models.steady.convolution`. With the length c of the contact of a strip, dW_2/d(delta) =
int_0^c G dX gives Newton's method for the depth that carries a load.
"""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import convolution, revolved
from kvtheory.models.steady.branches import Memory
from kvtheory.results import Certificate, SteadyState
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Spot

Array = NDArray[np.float64]

LEAST = 1e-12
"""Relative error below which nothing is claimed: five times that of a strip."""
STATEMENT = (
    "quadrature over strips, each by convolution; the estimate compares two rules, and what the strips "
    "estimate of themselves"
)


def at_depth(
    memory: Memory,
    indenter: Spot,
    stiffness: float,
    retardation_time: float,
    velocity: float,
    depth: float,
) -> SteadyState:
    """Return the steady state at a given indentation depth.

    The arguments are those of `convolution.at_depth`, with a ball or a convex profile of revolution for the
    shape; load and friction force are in N.

    Raises
    ------
    QuadratureError
        If a quadrature fails, the profile is not convex, or the contact goes beyond its reach.

    Examples
    --------
    >>> from kvtheory.models.steady.branches import Springpot
    >>> from kvtheory.scene.indenters import Sphere
    >>> state = at_depth(Springpot(1e10, 0.1 * 0.1, 1.0), Sphere(0.01), 1e10, 0.1, 0.1, 3e-4)
    >>> print(f"{state.load:.6g} {state.friction_force:.6g} {state.trailing_edge:.6g}")
    113.283 15.303 0.00029563
    """
    given = memory, indenter, stiffness, retardation_time, velocity
    _refuse(indenter)
    with np.errstate(all="ignore"):
        return _state(*given, depth)


def at_load(
    memory: Memory,
    indenter: Spot,
    stiffness: float,
    retardation_time: float,
    velocity: float,
    weight: float,
    spring: float = 0.0,
) -> SteadyState:
    """Return the steady state under a weight in N, on a spring in N/m or without.

    The other arguments, and the state, are as in `at_depth`; a spring is relaxed at the static depth.
    """
    given = memory, indenter, stiffness, retardation_time, velocity
    _refuse(indenter)
    load, k, l_r = weight / stiffness, spring / stiffness, abs(velocity) * retardation_time
    with np.errstate(all="ignore"):
        if k > 0.0:
            at_rest = partial(_strips, memory, indenter, stiffness, retardation_time, 0.0)
            load += k * revolved.depth_at(indenter, at_rest, 0.0, load, 0.0)
        strips = partial(_strips, *given)
        depth = revolved.depth_at(indenter, strips, l_r, load, k)
        return _state(*given, depth, found=True)


def _refuse(indenter: Spot) -> None:
    if not indenter.profile.convex:
        raise QuadratureError(
            "of a profile of revolution beyond Kelvin-Voigt, a shape that is known to be convex is "
            "expected, not functions"
        )


def _strips(
    memory: Memory,
    indenter: Spot,
    K: float,
    tau: float,
    velocity: float,
    y: Array,
    depth: Array,
    weights: Array,
) -> tuple[Array, float]:
    """Return load, its slope, friction and what is lost in strips, over K, and their own error."""
    rows, worst = np.empty((4, y.size)), 0.0
    for column, (at, deep) in enumerate(zip(y.tolist(), depth.tolist(), strict=True)):
        strip: Any = revolved.Strip(indenter.profile, at, indenter.reach)
        strip.kinks = indenter.kinks  # next to a tip, the strip has one nearly as sharp
        found = convolution.at_depth(memory, strip, K, tau, abs(velocity), deep)
        length = np.array([found.trailing_edge - found.leading_edge])
        slope = K * float(length[0])
        if velocity != 0.0:
            slope += float(memory.amount(length).sum())
        lost = found.dissipated_in_contact * found.friction_force
        rows[:, column] = found.load, slope, found.friction_force, lost
        worst = max(worst, float(found.certificate.relative_error["load"]))
    return rows / K, worst


def _state(
    memory: Memory,
    indenter: Spot,
    K: float,
    tau: float,
    velocity: float,
    depth: float,
    found: bool = False,
) -> SteadyState:
    """Sum the strips; the middle plane gives the rest. `found` says that the depth was found for a load."""
    middle = convolution.at_depth(memory, indenter.profile, K, tau, velocity, depth)
    strips = partial(_strips, memory, indenter, K, tau, velocity)
    summed = revolved.sums(indenter, strips, abs(velocity) * tau, depth)
    side = -1.0 if velocity < 0.0 else 1.0
    error = summed.error + (revolved.SHARP if indenter.kinks else LEAST)
    errors = dict.fromkeys(middle.certificate.relative_error, (5.0 if found else 1.0) * error)
    for name in ("trailing_edge", "peak_pressure"):
        errors[name] += middle.certificate.relative_error[name]
    return replace(
        middle,
        load=K * summed.load,
        friction_force=side * K * summed.friction + 0.0,
        friction_coefficient=side * summed.friction / summed.load + 0.0,
        dissipated_in_contact=summed.lost / summed.friction if summed.friction > 0.0 else 1.0,
        certificate=Certificate("estimated", STATEMENT, errors),
    )
