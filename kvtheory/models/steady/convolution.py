r"""Steady sliding of a convex shape on any linear viscoelastic foundation, by convolution.

With X the distance from the leading edge, where h = delta, and u' = -h' the rate of compression,

    p(X) = K u + sum over branches m(X) <u'>,   m = int_0^X g(s) ds,   g = G - K,

where <u'> is the mean of u' over the memory of the branch: with v = (int_0^s g)/m in (0, 1) the past is
u'(X - s(v)), however fast the branch relaxes, and the integrand has no boundary layer that the
double-exponential rule would not resolve. The trailing edge is the first zero of the pressure, and

    W = int p dX,   F = int u' p dX,   dW/d(delta) = int_0^c G dX,

as a greater depth adds a step of compression at the leading edge, which relaxes with G. There is one zero:
where p = 0 behind the lowest point, p' <= -|u'| G(X) < 0, because |u'| rises and G does not.
"""

import math
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from kvtheory.models.steady.branches import Arms, Memory, Springpot
from kvtheory.models.steady.contact import half_length
from kvtheory.models.steady.double_exponential import RULES
from kvtheory.models.steady.profile_series import ConvexProfile
from kvtheory.results import Certificate, SteadyState
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.foundations import FractionalKelvinVoigt
from kvtheory.scene.indenters import Convex, Profile
from kvtheory.scene.model import Scene

Array = Any
"""Of floats."""

Shape = Convex | ConvexProfile

_NODES, _WEIGHTS = RULES[3][0], RULES[3][2]
NODES = _NODES[: _NODES.size // 2]
FINE, COARSE = _WEIGHTS
"""A double-exponential rule from 0 to 1, and the one of twice its step."""
STEPS = 60
"""Newton steps on the depth; a handful is needed."""
CLOSE = 1e-9
"""Newton's method squares an error."""
LONGEST = 20.0
"""Longest step of ln(delta)."""
ROOT, TINY = 8.9e-16, 1e-300
"""Tolerances of edges: all digits, however small they are."""
VERTEX = 1e-290
"""Share of the half length at which the pressure is that behind the lowest point."""
STRIDE = 1e-6
"""Relative step of x for the slope of the pressure at its zero."""
PEAK_RTOL = 1e-6
"""Tolerance of the position of the peak between two nodes; the error of its value is of second order."""
MARGIN = 8.0
"""Safety factor on the differences of both rules."""
FLOOR = 2e-13
"""Relative rounding of a result."""
JUMP = 1e-6
"""Pressure at the trailing edge, over that of the depth, from which it is a jump."""
LIMIT = 1e-6
"""Relative error above which a result is refused."""

STATEMENT = (
    "differences of two double-exponential rules, for the memory and for the contact, carried to each "
    "quantity; for shapes computed to a few units in the last place"
)


class Contact(NamedTuple):
    """A contact at one depth: its extent ahead, its extent behind at rest, and its trailing edge."""

    depth: float
    a: float
    back: float
    x_te: float


class Sliding:
    """One contact, with the values at the nodes of both rules."""

    def __init__(self, shape: Shape, K: float, memory: Memory | None, contact: Contact) -> None:
        self.shape, self.K, self.memory, self.contact = shape, K, memory, contact
        a, x_te = contact.a, contact.x_te
        cuts = sorted({0.0, *shape.kinks})
        pieces = list(pairwise([-a, *(cut for cut in cuts if -a < cut < x_te), x_te]))
        pieces = pieces if x_te > 0.0 else [*pieces, (0.0, 0.0)]
        self.x = np.concatenate([_nodes(*piece) for piece in pieces])
        self.ahead = np.concatenate(
            [x_te - end + (end - start) * NODES[::-1] for start, end in pieces]
        )
        """Distances from the trailing edge: the rule is symmetric."""
        self.weights = np.concatenate(
            [(end - start) * np.stack((FINE, COARSE)) for start, end in pieces], axis=1
        )
        self.rate = -shape.slope(self.x)
        self.rows, self.noise = remembered(shape, memory, a, self.x)
        self.pressure = self.K * (contact.depth - shape.height(self.x)) + self.rows.sum(axis=0)

    def total(self, values: Array) -> tuple[float, float]:
        """Return the integral over the contact, and the difference of both rules."""
        fine, coarse = (float(weights @ values) for weights in self.weights)
        return fine, abs(fine - coarse)


def _nodes(start: float, end: float) -> Array:
    """Return the nodes from start to end, exact towards the end that is closer to the lowest point."""
    if abs(start) < abs(end):
        return start + (end - start) * NODES
    return end - (end - start) * NODES[::-1]


def memory_of(scene: Scene) -> Memory:
    """Return the memory of the branches of a foundation at the velocity of a scene."""
    foundation, speed = scene.foundation, abs(scene.drive.final_velocity)
    if isinstance(foundation, FractionalKelvinVoigt):
        length = speed * foundation.retardation_time
        return Springpot(foundation.stiffness, length, foundation.order)
    arms = np.array([(arm.stiffness, arm.relaxation_time) for arm in foundation.arms])
    return Arms(arms[:, 0], speed * arms[:, 1])


def sides(shape: Shape, depth: float) -> tuple[float, float]:
    """Return the extent of the contact at rest ahead and behind: h(-a) = h(back) = depth."""
    if isinstance(shape, ConvexProfile):
        return shape.sides(depth)
    a = half_length(shape, depth)
    return a, a


def remembered(shape: Shape, memory: Memory | None, a: float, x: Array) -> tuple[Array, float]:
    """Return the pressure of each branch at the positions x, and the difference of both rules."""
    if memory is None:
        return np.zeros((1, x.size)), 0.0
    X = np.maximum(a + x, 0.0)  # not below by rounding
    amount = memory.amount(X)
    cuts = [np.zeros_like(amount), np.ones_like(amount)]
    for kink in shape.kinks:  # one rule on either side of each that has been passed
        if kink > -a:
            share = memory.share(np.maximum(x - kink, 0.0), X) + 0.0 * amount
            cuts.insert(1, np.where(x > kink, share, 0.0))
    means = []
    for first, last in pairwise(cuts):
        width = last - first
        if not width.any():
            continue
        past = memory.delay(first[..., None] + width[..., None] * NODES, X)
        rate = -shape.slope(np.maximum(x[:, None] - past, -a))
        means.append(width[..., None] * (rate @ np.column_stack((FINE, COARSE))))
    fine, coarse = np.moveaxis(sum(means), -1, 0)
    size = np.abs(amount * fine).sum(axis=0)
    apart = np.abs(amount * (fine - coarse)).sum(axis=0)
    return amount * fine, float((apart / np.maximum(size.max(), TINY)).max())


def contact_at(shape: Shape, K: float, memory: Memory | None, depth: float) -> Contact:
    """Return the contact at a depth: h(a) = depth, and the first zero of the pressure."""
    a, back = sides(shape, depth)
    rest = Contact(depth, a, back, back)
    if memory is None:
        return rest
    pressure = partial(_pressure, shape, K, memory, rest)
    near = VERTEX * back
    if pressure(near) <= 0.0:  # beyond the vertex of a wedge
        return rest._replace(x_te=0.0)
    if pressure(back) >= 0.0:  # nothing is remembered that counts
        return rest
    found = brentq(pressure, near, back, xtol=TINY, rtol=ROOT, maxiter=2000)
    return rest._replace(x_te=found)


def _pressure(shape: Shape, K: float, memory: Memory | None, contact: Contact, x: float) -> float:
    """Return the pressure at x."""
    rows, _ = remembered(shape, memory, contact.a, np.array([x]))
    return float(K * (contact.depth - shape.height(np.array([x]))[0]) + rows.sum())


def depth_at(shape: Shape, K: float, memory: Memory | None, load: float, spring: float) -> Contact:
    """Return the contact where W + spring * depth is the load, by Newton's method in logarithms."""
    end = math.nextafter(shape.reach, 0.0)
    deepest = min(float(shape.height(side * end)) for side in (-1.0, 1.0))
    if isinstance(shape, ConvexProfile):
        depth = min(shape.shallow(load / K), 0.5 * deepest)
    else:  # where the contact is 1 m long; steps are exact for a power
        depth = min(load / K, 0.5 * deepest)
    for _ in range(STEPS):
        contact = contact_at(shape, K, memory, depth)
        sliding = Sliding(shape, K, memory, contact)
        total = sliding.total(sliding.pressure)[0] + spring * depth
        slope = K * (contact.a + contact.x_te) + spring
        if memory is not None:
            slope += float(memory.amount(np.array([contact.a + contact.x_te])).sum())
        step = math.log(load / total) * total / (depth * slope)
        depth = min(depth * math.exp(min(step, LONGEST)), 0.5 * (depth + deepest))
        if abs(step) < CLOSE:
            return contact_at(shape, K, memory, depth)
    raise QuadratureError(
        "no depth was found that carries the weight: it lies beyond the indenter's reach"
    )


def at_depth(
    memory: Memory,
    indenter: Convex | Profile,
    stiffness: float,
    retardation_time: float,
    velocity: float,
    depth: float,
) -> SteadyState:
    """Return the steady state at a given indentation depth.

    Parameters
    ----------
    memory
        The memory of the foundation besides its spring.
    indenter
        A convex shape, or a profile that proves to be convex; see `kvtheory.scene.indenters`.
    stiffness, retardation_time, velocity, depth
        K in N/m^3, C/K in s for the retardation length alone, V in m/s (any sign, or zero), delta in m.

    Returns
    -------
    SteadyState
        With an estimate of the relative error of each quantity.

    Raises
    ------
    QuadratureError
        If a quadrature fails, or the contact goes beyond the indenter's reach.

    Examples
    --------
    Kelvin-Voigt is the springpot of order 1, which has no memory:

    >>> from kvtheory.models.steady.branches import Springpot
    >>> from kvtheory.scene.indenters import Parabola
    >>> state = at_depth(Springpot(1e10, 0.1 * 0.1, 1.0), Parabola(0.01), 1e10, 0.1, 0.1, 3e-4)
    >>> print(f"{state.load:.6g} {state.friction_force:.6g} {state.trailing_edge:.6g}")
    35344.6 5344.58 0.00029563
    """
    shape = _framed(indenter, velocity)
    given = shape, stiffness, memory if velocity != 0.0 else None
    with np.errstate(all="ignore"):
        return _state(Sliding(*given, contact_at(*given, depth)), velocity, retardation_time)


def at_load(
    memory: Memory,
    indenter: Convex | Profile,
    stiffness: float,
    retardation_time: float,
    velocity: float,
    weight: float,
    spring: float = 0.0,
) -> SteadyState:
    """Return the steady state under a weight in N/m, on a spring in N/m^2 or without.

    The other arguments, and the state, are as in `at_depth`; a spring is relaxed at the static depth.

    Examples
    --------
    >>> from kvtheory.models.steady.branches import Arms
    >>> from kvtheory.scene.indenters import Parabola
    >>> zener = Arms([3e10], [0.1 * 0.01])
    >>> state = at_load(zener, Parabola(0.01), 1e10, 0.03, 0.1, 9806.65)
    >>> print(f"{1e3 * state.depth:.6f} mm, mu = {state.friction_coefficient:.6f}")
    0.203372 mm, mu = 0.048083
    """
    shape = _framed(indenter, velocity)
    given = shape, stiffness, memory if velocity != 0.0 else None
    with np.errstate(all="ignore"):
        if spring > 0.0:
            weight = weight + spring * depth_at(shape, stiffness, None, weight, 0.0).depth
        contact = depth_at(*given, weight, spring)
        return _state(Sliding(*given, contact), velocity, retardation_time)


def _framed(indenter: Convex | Profile, velocity: float) -> Shape:
    """Return the shape in the direction of sliding."""
    if isinstance(indenter, Profile):
        return ConvexProfile(indenter, -1.0 if velocity < 0.0 else 1.0)
    return indenter


def _state(sliding: Sliding, velocity: float, retardation_time: float) -> SteadyState:
    """Give every quantity its sign and its error."""
    depth, a, back, x_te = contact = sliding.contact
    side = -1.0 if velocity < 0.0 else 1.0
    load, apart = sliding.total(sliding.pressure)
    work, inside = 0.0, 0.0
    if sliding.memory is not None:
        left, _ = remembered(sliding.shape, sliding.memory, a, np.array([x_te]))
        work, inside = sliding.memory.works(sliding, sliding.rows, left)
        # K u = -(memory) at the trailing edge, unless the pressure jumps there.
        rest, held = -float(left.sum()) / sliding.K, depth - float(sliding.shape.height(x_te))
        rest = held if abs(rest - held) > JUMP * depth else rest
        work += 0.5 * sliding.K * rest * rest
    values: dict[str, Any] = {
        "depth": depth,
        "half_length": 0.5 * (a + back),
        "retardation_length": abs(velocity) * retardation_time,
        "leading_edge": -side * a,
        "trailing_edge": side * x_te + 0.0,
        "load": load,
        "friction_force": side * work + 0.0,
        "friction_coefficient": side * work / load + 0.0,
        "peak_pressure": _peak(sliding),
        "dissipated_in_contact": inside / work if work > 0.0 else 1.0,
    }
    error, shape = sliding.noise + apart / load, sliding.shape
    if isinstance(shape, ConvexProfile):
        error = MARGIN * (error ** (1.0 if shape.bent else 1.5) + shape.noise) + FLOOR
    else:
        error = MARGIN * error**1.5 + FLOOR
    if not error < LIMIT:
        raise QuadratureError(
            "quadrature of the shape does not converge: the indenter's reach is too close, or `kinks` "
            "does not name every kink"
        )
    errors = dict.fromkeys(values, error)
    errors["trailing_edge"] += _edge_error(sliding, contact)
    certificate = Certificate("estimated", STATEMENT, errors)
    return SteadyState(**values, model="quadrature", certificate=certificate)


def _edge_error(sliding: Sliding, contact: Contact) -> float:
    """Return the shift of the zero of the pressure by rounding, over the trailing edge."""
    x = contact.x_te
    if x in (0.0, contact.back):
        return 0.0
    args = sliding.shape, sliding.K, sliding.memory, contact
    fall = (_pressure(*args, x * (1.0 - STRIDE)) - _pressure(*args, x * (1.0 + STRIDE))) / STRIDE
    return FLOOR * float(np.abs(sliding.pressure).max()) / fall


def _peak(sliding: Sliding) -> float:
    """Return the greatest pressure: at the highest node, or between its neighbours."""
    x, best = sliding.x, int(sliding.pressure.argmax())
    low, high = x[max(best - 1, 0)], x[min(best + 1, x.size - 1)]
    pressure = partial(_pressure, sliding.shape, sliding.K, sliding.memory, sliding.contact)
    found = minimize_scalar(lambda x: -pressure(x), bounds=(low, high), method="bounded",
                            options={"xatol": PEAK_RTOL * (high - low)})  # fmt: skip
    return max(float(sliding.pressure[best]), -float(found.fun))
