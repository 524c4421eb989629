r"""Steady sliding of any shape on any foundation, by quadrature and root finding.

Integrated over the contact of a line,

    W = int p dx,    F = int -h' p dx,

in forms without cancellation. The line contact is solved by one of three methods, which have the same
interface: `ConvexLine` (`contact`) and `AnyLine` (`asperities`) on Kelvin-Voigt, `ViscoelasticLine`
(`convolution`) beyond it. A ball is a sum of their strips (`revolved`). For Kelvin-Voigt

    W = K (int u dx + l_r u_TE),    F = K (u_TE^2/2 + l_r int h'^2 dx),

by -h' = u' and u_LE = 0. No term of either sum is negative, whereas -h' p changes its sign and integrates to
a small difference where l_r is small; and h', which may grow without bound towards an edge, does not occur
in W. Of the power F V, the last term is dissipated inside the contact; K u_TE^2/2 is dissipated in the
surface that relaxes behind it.

The balance of forces gives the depth. W is convex in the depth, zero at zero depth: d ln W/d ln delta >= 1,
so every load is carried at one depth, and the depth is relatively no less accurate than the load.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from kvtheory.models.steady.asperities import AnyLine
from kvtheory.models.steady.cells import ConvexProfile, Surface
from kvtheory.models.steady.contact import ConvexLine
from kvtheory.models.steady.convolution import ViscoelasticLine, memory_of
from kvtheory.models.steady.double_exponential import ROUNDING, Value, largest, pick, some
from kvtheory.models.steady.revolved import Strips
from kvtheory.results import STEADY_UNITS, Certificate
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.capabilities import lacks_kelvin_voigt
from kvtheory.scene.model import Scene

UNBALANCED, MARGIN = 1e-6, 2.0
"""Relative error of the load above which a result is refused; safety factor on errors by derivatives."""
MOST_STEPS = 200
"""Most trial depths; a few suffice unless the reach or the start of another contact is close."""
LAST_STEP, ULPS = {True: 1e-5, False: 3e-8}, 2.0**-49
"""Relative step of the depth after which a cubic and a quadratic method have converged; the least step."""
SHALLOWER, SHALLOWEST, NARROW = 8.0, 1e-12, 1e-9
"""Divisor of a depth without a solution, if none is known to be too shallow; share of the first trial depth
at which the search ends; least relative distance of a depth without a solution from one too shallow."""

FORCES = "load", "friction_force", "peak_pressure"
"""Quantities proportional to the stiffness."""

LINE = (
    "error estimates of the quadratures and tolerances of the roots, carried to each quantity by its "
    "derivative with respect to the depth; for shapes computed to a few units in the last place"
)
ANY_SHAPE = (
    f"{LINE}, smooth between the kinks that they name, without details that are narrower than "
    "1/100 of the contact or of their distance from the lowest point, or a million times its length "
    "away; all contacts are summed"
)
CONVOLUTION = (
    "differences of three double-exponential rules, for the memory and for the contact, carried to each "
    "quantity; for shapes computed to a few units in the last place"
)
STRIPS = "two rules compared over strips, and the estimate of each strip, by {}"


def certificate(scene: Scene) -> Certificate:
    """Return the certificate of a scene, without errors."""
    remembers = bool(lacks_kelvin_voigt(scene))
    if not scene.indenter.per_width:
        text = STRIPS.format("convolution" if remembers else "its own quadrature")
    elif remembers:
        text = CONVOLUTION
    else:
        text = LINE if scene.indenter.convex else ANY_SHAPE
    return Certificate("estimated", text, {})


def quantities(scene: Scene) -> tuple[Any, ...]:
    """Return the quantities at |V| in the order of `STEADY_UNITS`, and the relative error of each.

    Scenes of arrays are solved in columns where the shape is a convex line on Kelvin-Voigt, else one by one.
    `QuadratureError` if a quadrature or a root fails, contact or load go beyond the reach of the indenter,
    or a callable shape is not smooth where it touches.
    """
    size, indenter = scene.shape, scene.indenter
    if size and indenter.convex and indenter.per_width and not lacks_kelvin_voigt(scene):
        scene = scene.mapped(lambda x: x[:, None])
    elif size:
        rows = [scene.mapped(lambda x, i=i: float(x[i])) for i in range(*size)]  # type: ignore[misc]
        return tuple(np.transpose([quantities(row) for row in rows]))
    support = scene.support
    l_r = abs(scene.drive.final_velocity) * scene.foundation.retardation_time  # Eq. 29
    K, l_r, load, spring, depth = (
        np.broadcast_to(x, scene.shape) if scene.shape else x
        for x in (scene.foundation.stiffness, l_r, support.weight, support.spring, support.depth)
    )
    with np.errstate(all="ignore"):
        line_at = _lines(scene)
        if scene.held:
            line = line_at(l_r)
            contact, depth_error = line.at(depth), 0.0 * depth
        else:
            line, contact, depth_error = _carrying(line_at, l_r, load / K, spring / K)
        values, own, powers = contact.quantities()
        values |= {"depth": contact.depth, "retardation_length": l_r}
        values["friction_coefficient"] = values["friction_force"] / values["load"]
        own.setdefault("friction_coefficient", own["load"] + own["friction_force"])
        own.setdefault("dissipated_in_contact", own["friction_force"])
        powers.setdefault("friction_coefficient", powers["friction_force"] - powers["load"])
        noise = MARGIN * (depth_error + contact.noise)
        errors = {
            name: own.get(name, 0.0) + line.floor + noise * abs(power)
            for name, power in powers.items()
        }
    errors |= {"depth": depth_error, "retardation_length": ROUNDING}
    for name in FORCES:
        values[name] = K * values[name]
    found = [each[name] for each in (values, errors) for name in STEADY_UNITS]
    return tuple(np.broadcast_to(x, scene.shape).ravel() if size else x for x in found)


def _lines(scene: Scene) -> Callable[[Value], Any]:
    """Return the method for the shape and the foundation of a scene, as a function of l_r (0 for rest)."""
    indenter: Any = scene.indenter
    shape = indenter if indenter.per_width else indenter.profile
    memory = memory_of(scene) if (remembers := lacks_kelvin_voigt(scene)) else None
    if not shape.convex:  # it may differ ahead and behind; a body of revolution does not
        side = -1.0 if indenter.per_width and scene.drive.final_velocity < 0.0 else 1.0
        shape = ConvexProfile(shape, side) if remembers else Surface(shape, side)

    def line_at(l_r: Value) -> Any:
        if remembers:
            line: Any = ViscoelasticLine(shape, memory if l_r else None, l_r)
        else:
            line = (AnyLine if isinstance(shape, Surface) else ConvexLine)(shape, l_r)
        return line if indenter.per_width else Strips(indenter, line)

    return line_at


def _carrying(line_at: Any, l_r: Value, load: Value, spring: Value) -> tuple[Any, Any, Value]:
    """Return the line, its contact at a load, and the error of the depth, no larger than that of the load."""
    relaxed_error = 0.0
    if largest(spring) > 0.0:
        rest = _contact(line_at(0.0 * l_r), load, 0.0 * spring)
        relaxed = spring * rest.depth
        relaxed_error = relaxed * (rest.load_error + abs(rest.load / load - 1.0) + ROUNDING)
        load = load + relaxed
    line = line_at(l_r)
    contact = _contact(line, load, spring)
    carried = contact.load + spring * contact.depth
    error = (contact.load * contact.load_error + relaxed_error) / load
    error = error + abs(carried / load - 1.0) + ROUNDING
    if not largest(error) < UNBALANCED:
        raise QuadratureError("load balance not converged")
    return line, contact, error


def _contact(line: Any, load: Value, spring: Value) -> Any:
    """Return the contact where W/K + spring * depth is the load.

    As d ln W/d ln delta is 1 to 2, Newton's method in logarithms converges, between depths that carry too
    little and too much; the second derivative of W, where known, makes it cubic (Chebyshev).
    """
    depth, guess = line.first(load, spring)
    low, high, least = 0.0 * depth, line.deepest, SHALLOWEST * depth
    active, step, failure = load > 0.0, math.inf, None
    for _ in range(MOST_STEPS):
        try:
            contact = line.at(depth, guess)
        except QuadratureError as error:  # the depth may be too large
            failure = failure or error
            if isinstance(depth, np.ndarray) or depth < least or depth < low * (1.0 + NARROW):
                raise failure from None
            high, new, step = depth, math.inf, math.inf
        else:
            total, slope = contact.load + spring * depth, contact.load_slope + spring
            power = depth * slope / total
            share, cubic = 1.0, contact.load_curvature is not None
            if cubic:
                bend = 1.0 - power + depth * contact.load_curvature / slope
                missing = (load - total) / (0.5 * (load + total))  # nearly ln(load/total)
                share = 1.0 - 0.5 * missing / (1.0 + missing * missing) * bend / power
            factor = (load / total) ** (share / power)
            step, last = abs(factor - 1.0), step
            active = active & (last >= LAST_STEP[cubic]) & (step >= ULPS)
            if not some(active):
                return contact  # converged values were evaluated again from the same guesses
            new, light = depth * factor, total < load
            low, high = pick(light, depth, low), pick(light, high, depth)
            guess = tuple(map(lambda now, was: pick(active, now, was), contact.guess, guess))
        between = pick(low > 0.0, (low * high) ** 0.5, high / SHALLOWER)
        depth = pick(active, pick((low < new) & (new < high), new, between), depth)
    raise failure or QuadratureError(
        "no depth was found that carries the weight: it lies beyond the indenter's reach"
    )
