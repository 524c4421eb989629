r"""Steady sliding of an indenter of any shape, by quadrature and root finding.

Integrated over the contact (see `kvtheory.models.steady.contact` for the geometry),

    W = int p dx = K (int u dx + l_r u_TE),
    F = int -h' p dx = K (u_TE^2/2 + l_r int h'^2 dx),

by -h' = u' and u_LE = 0. No term of either sum is negative, so nothing cancels, whereas -h' p changes
its sign and integrates to a small difference where l_r is small; and h', which may grow without bound
towards an edge, stays out of W. Of the power F V, the last term is lost inside the contact;
K u_TE^2/2 is carried out by the surface that relaxes behind it.

Depth at a load: dW/d(delta) = K (x_TE - x_LE + l_r), because the pressure vanishes at a root of the
trailing edge, and the leading edge moves by d(-x_LE) = d(delta)/|h'| with p_LE = K l_r |h'|. As
W <= K delta (x_TE - x_LE + l_r), d ln W/d ln delta >= 1: the root is single, and the depth is
relatively no less accurate than the load.
"""

import math

import numpy as np
from scipy.optimize import minimize_scalar

from kvtheory.models.steady.contact import (
    ROOT_RTOL,
    Contact,
    QuadratureError,
    Surface,
    check_one_contact,
    root,
)
from kvtheory.results import STEADY_UNITS, Certificate, SteadyState
from kvtheory.scene.indenters import Indenter

ROUNDING = 6.0 * ROOT_RTOL
"""Rounding of a formula, the shape function included."""
DEPTH_STEP = 2.0**-20
"""Relative step of depth that measures sensitivities; they are needed to a digit or two."""
SENSITIVITY_MARGIN = 2.0
"""Covers that digit."""
PEAK_SAMPLES = 16
"""Intervals of each smooth piece, the best two of which are searched for the peak pressure."""

STATEMENT = (
    "error estimates of the quadratures and tolerances of the roots, carried to each quantity by its "
    "measured sensitivity to the depth; for shapes that are smooth between the kinks they name, and "
    "computed to a few units in the last place"
)


def at_depth(
    indenter: Indenter, stiffness: float, retardation_time: float, velocity: float, depth: float
) -> SteadyState:
    """Return the steady state at a given indentation depth (the paper's FI model).

    Parameters
    ----------
    indenter
        Its shape; see `kvtheory.scene.indenters`.
    stiffness, retardation_time, velocity, depth
        K in N/m^3, tau in s, V in m/s (any sign, or zero), delta in m: plain floats.

    Returns
    -------
    SteadyState
        With an estimate of the relative error of each quantity.

    Raises
    ------
    QuadratureError
        If a quadrature or a root fails, the contact goes beyond the indenter's reach, or there is
        more than one contact. Details of a callable shape that are narrower than 1/512 of the
        contact, or more than four contact lengths away, can escape the last check.

    Examples
    --------
    >>> from kvtheory.scene.indenters import Parabola
    >>> state = at_depth(Parabola(0.01), 1e10, 0.1, 0.1, 3e-4)
    >>> print(f"{state.load:.6g} {state.friction_force:.6g} {state.trailing_edge:.6g}")
    35344.6 5344.58 0.00029563
    """
    _require_positive(stiffness=stiffness, depth=depth)
    surface, l_r = _sliding(indenter, retardation_time, velocity)
    with np.errstate(all="ignore"):  # every value of the shape is checked to be finite
        return _steady_state(Contact(surface, l_r, depth), stiffness)


def at_load(
    indenter: Indenter,
    stiffness: float,
    retardation_time: float,
    velocity: float,
    weight: float,
    spring: float = 0.0,
) -> SteadyState:
    """Return the steady state under a weight (the paper's MI model), on a spring or without.

    Parameters
    ----------
    indenter, stiffness, retardation_time, velocity
        As in `at_depth`.
    weight
        M g in N/m.
    spring
        Stiffness of the suspension in N/m^2, relaxed at the static depth; 0 is a dead weight.

    Returns
    -------
    SteadyState
        As in `at_depth`.

    Raises
    ------
    QuadratureError
        As in `at_depth`, or if no depth within the indenter's reach carries the weight.

    Examples
    --------
    >>> from kvtheory.scene.indenters import Parabola
    >>> state = at_load(Parabola(0.01), 1e10, 0.1, 0.1, 9806.65)
    >>> print(f"{1e3 * state.depth:.6f} mm, mu = {state.friction_coefficient:.6f}")
    0.089661 mm, mu = 0.085709
    """
    _require_positive(stiffness=stiffness, weight=weight)
    if not 0.0 <= spring < math.inf:
        raise ValueError(f"`spring` must be finite and not negative, not {spring}")
    surface, l_r = _sliding(indenter, retardation_time, velocity)

    def load(depth: float, l_r: float) -> float:
        return _load(Contact(surface, l_r, depth), stiffness)[0]

    with np.errstate(all="ignore"):
        deepest = (
            min(surface.height(-surface.end), surface.height(surface.end))
            if indenter.reach < math.inf
            else math.inf
        )
        static = root(
            lambda d: load(d, 0.0) - weight,
            math.sqrt(weight / stiffness),
            deepest,
            "the static depth",
        )
        guess = static * (weight / load(static, l_r))  # exact where damping alone carries the load
        total = weight + spring * static
        depth = root(lambda d: load(d, l_r) + spring * d - total, guess, deepest, "the depth")
        contact = Contact(surface, l_r, depth)
        value, error = _load(contact, stiffness)
        depth_error = error / value + ROUNDING + ROOT_RTOL
        if spring:  # the static depth is a root of the same accuracy, and counts at most once
            depth_error *= 2.0
        return _steady_state(contact, stiffness, depth_error)


def _require_positive(**arguments: float) -> None:
    for name, value in arguments.items():
        if not 0.0 < value < math.inf:
            raise ValueError(f"`{name}` must be positive and finite, not {value}")


def _sliding(indenter: Indenter, retardation_time: float, velocity: float) -> tuple[Surface, float]:
    l_r = abs(velocity) * retardation_time  # Eq. 29
    if not 0.0 <= l_r < math.inf:
        raise ValueError(
            "`velocity` must be finite and `retardation_time` finite and not negative, "
            f"not {velocity} and {retardation_time}"
        )
    return Surface(indenter, -1.0 if velocity < 0.0 else 1.0), l_r


def _load(contact: Contact, stiffness: float) -> tuple[float, float]:
    """Return W and its error."""
    area, error = contact.integral(contact.compression)
    _, u_te = contact.trailing
    return stiffness * (area + contact.l_r * u_te), stiffness * (
        error + contact.l_r * _edge_error(contact)
    )


def _edge_error(contact: Contact) -> float:
    """Return the error of u_TE: where p = 0, two forms differ by what the root's tolerance does."""
    x_te, u_te = contact.trailing
    return abs(u_te - contact.compression(x_te))


def _peak(contact: Contact) -> float:
    """Return the highest p/K, with one-sided values at edges and kinks."""
    highest = 0.0
    for start, end in contact.pieces:
        points = np.linspace(
            math.nextafter(start, end), math.nextafter(end, start), PEAK_SAMPLES + 1
        ).tolist()
        values = [contact.pressure(x) for x in points]
        top = values.index(max(values))
        found = minimize_scalar(
            lambda x: -contact.pressure(x),
            bounds=(points[max(top - 1, 0)], points[min(top + 1, PEAK_SAMPLES)]),
            method="bounded",
            options={"xatol": 1e-10 * (end - start)},
        )
        if not found.success:
            raise QuadratureError(
                f"the peak pressure between {start:.6g} m and {end:.6g} m: {found.message}"
            )
        highest = max(highest, values[top], -float(found.fun))
    return highest


def _quantities(contact: Contact, stiffness: float) -> tuple[dict[str, float], dict[str, float]]:
    """Return every quantity of the mirrored contact, and its relative error at this very depth."""
    x_le, (x_te, u_te), l_r = contact.x_le, contact.trailing, contact.l_r
    load, load_error = _load(contact, stiffness)
    drag, drag_error = contact.integral(lambda x: contact.surface.slope(x) ** 2)
    friction, inside, friction_error, inside_error = 0.0, 1.0, 0.0, 0.0
    if l_r:  # F = K l_r (carried + drag)
        carried = 0.5 * u_te * (u_te / l_r)
        friction = stiffness * l_r * (drag + carried)
        inside = drag / (drag + carried)
        friction_error = (drag_error + u_te / l_r * _edge_error(contact)) / (drag + carried)
        shift = (ROUNDING + ROOT_RTOL) * x_te * contact.surface.slope(x_te) ** 2
        inside_error = friction_error + (drag_error + shift) / drag
    values = {
        "depth": contact.depth,
        "half_length": 0.5 * (contact.x_static - x_le),
        "retardation_length": l_r,
        "leading_edge": x_le,
        "trailing_edge": x_te,
        "load": load,
        "friction_force": friction,
        "friction_coefficient": friction / load,
        "peak_pressure": stiffness * _peak(contact),
        "dissipated_in_contact": inside,
    }
    errors = dict.fromkeys(values, ROOT_RTOL) | {
        "load": load_error / load,
        "friction_force": friction_error,
        "friction_coefficient": friction_error + load_error / load,
        "dissipated_in_contact": inside_error,
    }
    return values, errors


def _steady_state(contact: Contact, stiffness: float, depth_error: float = 0.0) -> SteadyState:
    """Evaluate every quantity, and carry the errors of depth and of rounding to it."""
    if not contact.surface.indenter.convex:
        check_one_contact(contact)
    values, errors = _quantities(contact, stiffness)
    nearby = Contact(contact.surface, contact.l_r, contact.depth * (1.0 - DEPTH_STEP))
    shifted, _ = _quantities(nearby, stiffness)
    # An error of x_LE acts as the error of depth that would move the edge by as much.
    leverage = abs(contact.x_le * contact.surface.slope(contact.x_le)) / contact.depth
    noise = depth_error + ROUNDING + ROOT_RTOL * leverage
    for name, value in values.items():
        if value:
            sensitivity = abs(1.0 - shifted[name] / value) / DEPTH_STEP
            errors[name] += SENSITIVITY_MARGIN * sensitivity * noise
    errors["depth"] = depth_error
    for name in ("leading_edge", "trailing_edge", "friction_force", "friction_coefficient"):
        values[name] = contact.surface.side * values[name] + 0.0  # no negative zero
    certificate = Certificate("estimated", STATEMENT, {name: errors[name] for name in STEADY_UNITS})
    return SteadyState(**values, model="quadrature", certificate=certificate)
