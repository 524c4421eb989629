r"""Steady sliding of an indenter of any shape, by quadrature and root finding.

Integrated over the contact (see `kvtheory.models.steady.contact` for its geometry, and
`kvtheory.models.steady.asperities` for shapes that may touch in several places),

    W = int p dx = K (int u dx + l_r u_TE),
    F = int -h' p dx = K (u_TE^2/2 + l_r int h'^2 dx),

by -h' = u' and u_LE = 0. No term of either sum is negative, so nothing cancels, whereas -h' p changes
its sign and integrates to a small difference where l_r is small; and h', which may grow without bound
towards an edge, does not occur in W. Of the power F V, the last term is dissipated inside the contact;
K u_TE^2/2 is dissipated in the surface that relaxes behind it.

Depth at a load: dW/d(delta) = K (x_TE - x_LE + l_r), because the pressure vanishes at a root of the
trailing edge, and the leading edge moves by d(-x_LE) = d(delta)/|h'| with p_LE = K l_r |h'|; likewise
dF/d(delta) = K (u_TE + p_LE/K). As W is convex in the depth and vanishes with it,
d ln W/d ln delta >= 1: the root is single, and the depth is relatively no less accurate than the load.
"""

import math
from typing import Any

import numpy as np

from kvtheory.models.steady import asperities, contact
from kvtheory.models.steady.cells import Surface
from kvtheory.models.steady.contact import ROUNDING
from kvtheory.models.steady.double_exponential import Value, largest
from kvtheory.results import Certificate, SteadyState
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Indenter

CARRIED = 1e-6
"""Relative error of the load carried above which the result is refused."""
MARGIN = 2.0
"""Safety factor on errors propagated by derivatives, which hold for small errors."""

STATEMENT = (
    "error estimates of the quadratures and tolerances of the roots, carried to each quantity by its "
    "derivative to the depth; for shapes computed to a few units in the last place"
)
OF_ANY_SHAPE = (
    f"{STATEMENT}, smooth between the kinks that they name, without details that are narrower than "
    "1/100 of the contact or of their distance from the lowest point, or a million times its length "
    "away; all contacts are summed"
)
ODD = {"leading_edge", "trailing_edge", "friction_force", "friction_coefficient"}
"""Quantities that change their sign with the velocity."""
FORCES = {"load", "friction_force", "peak_pressure"}
"""Quantities proportional to the stiffness."""


def at_depth(
    indenter: Indenter, stiffness: Value, retardation_time: Value, velocity: Value, depth: Value
) -> SteadyState:
    """Return the steady state at a given indentation depth (the paper's FI model).

    Parameters
    ----------
    indenter
        Its shape; see `kvtheory.scene.indenters`. Its parameters may be columns too.
    stiffness, retardation_time, velocity, depth
        K in N/m^3, tau in s, V in m/s (any sign, or zero), delta in m: plain floats, or, for the
        shapes that are convex, all of them columns of floats, of shape (n, 1).

    Returns
    -------
    SteadyState
        With an estimate of the relative error of each quantity.

    Raises
    ------
    QuadratureError
        If a quadrature or a root fails, the contact goes beyond the indenter's reach, or a callable
        shape is not smooth where it touches. Such a shape may touch in several places: they are
        summed, and the edges and the half length are the outermost.

    Examples
    --------
    >>> from kvtheory.scene.indenters import Parabola
    >>> state = at_depth(Parabola(0.01), 1e10, 0.1, 0.1, 3e-4)
    >>> print(f"{state.load:.6g} {state.friction_force:.6g} {state.trailing_edge:.6g}")
    35344.6 5344.58 0.00029563
    """
    _require_positive(stiffness=stiffness, depth=depth)
    l_r = _retardation_length(retardation_time, velocity)
    shape, model = _model(indenter, velocity)
    with np.errstate(all="ignore"):
        found = model.at_depth(shape, l_r, depth)
        return _state(model, shape, stiffness, velocity, l_r, found, 0.0 * depth)


def at_load(
    indenter: Indenter,
    stiffness: Value,
    retardation_time: Value,
    velocity: Value,
    weight: Value,
    spring: Value = 0.0,
) -> SteadyState:
    """Return the steady state under a weight (the paper's MI model), on a spring or without.

    The weight M g is in N/m, the stiffness of the suspension in N/m^2: it is relaxed at the static depth,
    and 0 for a dead weight. The other arguments, the state and the errors are as in `at_depth`; it is an
    error, too, if no depth within the indenter's reach carries the weight.

    Examples
    --------
    >>> from kvtheory.scene.indenters import Parabola
    >>> state = at_load(Parabola(0.01), 1e10, 0.1, 0.1, 9806.65)
    >>> print(f"{1e3 * state.depth:.6f} mm, mu = {state.friction_coefficient:.6f}")
    0.089661 mm, mu = 0.085709
    """
    _require_positive(stiffness=stiffness, weight=weight)
    if not (largest(-spring) <= 0.0 and largest(spring) < math.inf):
        raise ValueError(f"`spring` must be finite and not negative, not {spring}")
    l_r = _retardation_length(retardation_time, velocity)
    shape, model = _model(indenter, velocity)
    with np.errstate(all="ignore"):
        load, k, static_error = weight / stiffness, spring / stiffness, 0.0
        if largest(k) > 0.0:
            static = model.at_load(shape, 0.0 * l_r, load, 0.0 * k)
            static_error = static.load_error + abs(static.load / load - 1.0) + ROUNDING
            load = load + k * static.depth
        found = model.at_load(shape, l_r, load, k)
        # d ln W/d ln delta >= 1: the depth is no less accurate than the load that it carries.
        error = found.load_error + abs((found.load + k * found.depth) / load - 1.0)
        error = error + static_error + ROUNDING
        if not largest(error) < CARRIED:
            raise QuadratureError("the depth that was found does not carry the weight")
        return _state(model, shape, stiffness, velocity, l_r, found, error)


def _require_positive(**arguments: Value) -> None:
    for name, value in arguments.items():
        if not (largest(-value) < 0.0 and largest(value) < math.inf):
            raise ValueError(f"`{name}` must be positive and finite, not {value}")


def _retardation_length(retardation_time: Value, velocity: Value) -> Value:
    l_r = abs(velocity) * retardation_time  # Eq. 29
    if not (largest(-l_r) <= 0.0 and largest(l_r) < math.inf):
        raise ValueError(
            "`velocity` must be finite and `retardation_time` finite and not negative, "
            f"not {velocity} and {retardation_time}"
        )
    return l_r


def _model(indenter: Indenter, velocity: Value) -> tuple[Any, Any]:
    """Return the shape, and the module that computes its contacts."""
    if indenter.convex:
        return indenter, contact
    return Surface(indenter, -1.0 if velocity < 0.0 else 1.0), asperities


def _state(
    model: Any,
    shape: Any,
    stiffness: Value,
    velocity: Value,
    l_r: Value,
    found: Any,
    depth_error: Value,
) -> SteadyState:
    """Give every quantity its unit and sign, and propagate the errors of depth and of rounding to it."""
    side = 1.0 - 2.0 * (velocity < 0.0)
    noise = MARGIN * (depth_error + found.noise)
    values, errors = {}, {}
    for name, (value, own, power) in model.quantities(shape, l_r, found).items():
        values[name] = value
        errors[name] = own + ROUNDING + noise * abs(power)
    for name in ODD:
        values[name] = side * values[name] + 0.0  # no negative zero
    for name in FORCES:
        values[name] = stiffness * values[name]
    errors["depth"] = depth_error
    statement = STATEMENT if model is contact else OF_ANY_SHAPE
    return SteadyState(
        **values, model="quadrature", certificate=Certificate("estimated", statement, errors)
    )
