r"""Steady sliding of a ball and of any profile of revolution, by quadrature over its strips.

Elements are independent: a strip along x at the distance y from the middle plane is a separate line contact,
whose shape is h(sqrt(x^2 + y^2)) - h(|y|) and whose depth is delta - h(|y|). Its load and friction force
are those of `kvtheory.models.steady.contact`, or `asperities` for a profile that need not be convex, and

    W = int W_2 dy,    F = int F_2 dy    over |y| < b,    h(b) = delta,    y = b sin t.

Strips at the rim suffer cancellation in delta - h(|y|) and carry almost nothing: strips beyond `RIM` are
omitted. As dW_2/d(delta) = K (x_TE - x_LE + l_r) is summed as well, the depth at a load is found by Newton's
method. The middle plane gives the edges and the peak pressure.
"""

import math
from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from kvtheory.models.steady import asperities, contact
from kvtheory.models.steady.cells import Surface
from kvtheory.models.steady.double_exponential import RULES
from kvtheory.results import Certificate, SteadyState
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Line, Spot

Array = NDArray[np.float64]

RIM = {True: 3e-4, False: 3e-3}
"""cos t of the last strip of a convex profile, and of one that is evaluated point by point, which is more
sensitive to rounding: the strips beyond carry less than its fourth power of the load."""
MIDDLE = 1e-10
"""y/b of the strips next to the middle plane: a tip that is any sharper makes no difference."""
NEAR = 0.02
"""Rise over y up to which h is integrated from the lowest point of a strip, where its difference cancels."""
NARROWEST = 1e-6
"""Half width of a strip, over that of the contact, from which on one that is evaluated is sought."""
GAUSS = tuple((0.5 + 0.5 * s, 0.5 * w) for s, w in zip(*leggauss(4), strict=True))

LEAST = 2e-14
"""Smallest relative error that is claimed."""
SHARP = 4e-12
"""The same for a profile with a kink, whose strips next to the middle plane have a sharp tip."""
RTOL = {True: 1e-12, False: 1e-9}
"""Estimate above which the next rule is taken."""
LIMIT = 1e-6
"""Estimate above which the result of the last rule is refused."""
MARGIN = 4.0
"""Factor on the ratio of the last two differences, by which the next one is foreseen."""
BESIDE = 1e-9
"""Share of a radius at which the slopes on both sides of a kink are taken, to see where strips change."""
MOST_STEPS = 100
"""Steps of Newton's method; they are a handful."""
STEP = 3e-8
"""Relative step of the depth after which it is found: Newton's method squares an error."""

STATEMENT = (
    "quadrature over strips, each by its own quadrature; the estimate compares two rules, and what the "
    "strips estimate of themselves"
)


class Strip:
    """The shape of a strip at the distances y, floats or a column of them, of a profile of revolution."""

    def __init__(self, profile: Any, y: Any, reach: float) -> None:
        self.profile, self.y, self.convex = profile, y, profile.convex
        self.lowest = profile.height(y)
        radii = [kink for kink in profile.kinks if kink > 0.0]
        self.clear = np.min([y, *(abs(kink - y) for kink in radii)], axis=0)
        """Distance of y from the nearest point where the profile may be singular."""
        cuts = [math.sqrt((kink - y) * (kink + y)) for kink in radii if kink > y]
        cuts += [y] if 0.0 in profile.kinks and not profile.convex else []  # a tip is rounded there
        self.kinks = tuple(side * x for x in cuts for side in (-1.0, 1.0))
        self.reach = math.inf if reach == math.inf else np.sqrt((reach - y) * (reach + y))

    def height(self, x: Any) -> Any:
        """Return h above the lowest point of the strip: next to it, as the integral of h'."""
        rho = np.hypot(x, self.y)
        rise = x * (x / (rho + self.y))  # rho - y
        near, h = rise < NEAR * self.clear, np.array(self.profile.height(rho) - self.lowest)
        mean = sum(w * self.profile.slope((self.y + s * rise)[near]) for s, w in GAUSS)
        h[near] = mean * rise[near]
        return h

    def slope(self, x: Any) -> Any:
        """Return dh/dx."""
        rho = np.hypot(x, self.y)
        return self.profile.slope(rho) * (x / rho)

    def bend(self, x: Any) -> Any:
        """Return x h''/h'."""
        rho = np.hypot(x, self.y)
        return 1.0 + (self.profile.bend(rho) - 1.0) * (x / rho) ** 2


Strips = Callable[[Array, Array, Array], tuple[Array, float]]
"""Load, its slope, friction and what is lost in strips at y, with a depth each, over K; and their error."""


class Sums(NamedTuple):
    """The sums over the strips of a contact, over the stiffness."""

    load: float
    load_slope: float
    friction: float
    lost: float
    error: float
    """Relative."""


def at_depth(
    indenter: Spot, stiffness: float, retardation_time: float, velocity: float, depth: float
) -> SteadyState:
    """Return the steady state at a given indentation depth.

    Parameters
    ----------
    indenter
        A ball, or a profile of revolution.
    stiffness, retardation_time, velocity, depth
        K in N/m^3, tau in s, V in m/s (any sign, or zero), delta in m.

    Returns
    -------
    SteadyState
        Load and friction force in N, with an estimate of the relative error of each quantity.

    Raises
    ------
    QuadratureError
        If a quadrature or a root fails, or the contact goes beyond the indenter's reach.

    Examples
    --------
    >>> from kvtheory.scene.indenters import Sphere
    >>> state = at_depth(Sphere(0.01), 1e10, 0.1, 0.1, 3e-4)
    >>> print(f"{state.load:.6g} {state.friction_force:.6g} {state.trailing_edge:.6g}")
    113.283 15.303 0.00029563
    """
    l_r = abs(velocity) * retardation_time
    with np.errstate(all="ignore"):
        return _state(indenter, stiffness, velocity, l_r, depth, 0.0)


def at_load(
    indenter: Spot,
    stiffness: float,
    retardation_time: float,
    velocity: float,
    weight: float,
    spring: float = 0.0,
) -> SteadyState:
    """Return the steady state under a weight in N, on a spring in N/m or without.

    A spring is relaxed at the static depth. The other arguments, and the state, are as in `at_depth`.

    Examples
    --------
    >>> from kvtheory.scene.indenters import Sphere
    >>> state = at_load(Sphere(0.01), 1e10, 0.1, 0.1, 9.80665)
    >>> print(f"{1e3 * state.depth:.6f} mm, mu = {state.friction_coefficient:.6f}")
    0.061896 mm, mu = 0.063679
    """
    l_r, load, k = abs(velocity) * retardation_time, weight / stiffness, spring / stiffness
    with np.errstate(all="ignore"):
        if k > 0.0:
            load += k * depth_at(indenter, _strips(indenter, 0.0), 0.0, load, 0.0)
        depth = depth_at(indenter, _strips(indenter, l_r), l_r, load, k)
        return _state(indenter, stiffness, velocity, l_r, depth, 1.0)


def depth_at(indenter: Spot, strips: Strips, l_r: float, load: float, spring: float) -> float:
    """Return the depth at which W/K + spring * depth is the load, by Newton's method in logarithms.

    The retardation length is for the first guess alone.
    """
    depth = _first(indenter, l_r, load, spring)
    for _ in range(MOST_STEPS):
        found = sums(indenter, strips, l_r, depth)
        total, slope = found.load + spring * depth, found.load_slope + spring
        factor = (load / total) ** (total / (depth * slope))
        depth *= min(max(factor, 0.25), 4.0)
        if abs(factor - 1.0) < max(STEP, found.error):
            return depth
    raise QuadratureError("no depth was found that carries the weight")


def _first(indenter: Spot, l_r: float, load: float, spring: float) -> float:
    """Return a depth that carries about the load: bisection in the half length of the contact."""
    profile, wide = indenter.profile, indenter.stretch
    low, high = -700.0, 700.0 if math.isinf(profile.reach) else math.log(profile.reach) - 1e-9
    for _ in range(80):
        middle = 0.5 * (low + high)
        a = math.exp(middle)
        depth = float(profile.height(a))
        carried = depth * (a * wide * (1.5 * a + 1.3 * l_r) + spring)
        low, high = (middle, high) if carried < load else (low, middle)
    return float(profile.height(math.exp(low)))


def _state(
    indenter: Spot, K: float, V: float, l_r: float, depth: float, at_load: float
) -> SteadyState:
    """Give the sums their units and signs; the middle plane gives the rest."""
    model, shape = _model(indenter.profile)
    middle = model.at_depth(shape, l_r, depth)
    values, errors = {}, {}
    found = sums(indenter, _strips(indenter, l_r), l_r, depth)
    error = found.error + (SHARP if indenter.kinks else LEAST)
    noise = 2.0 * (middle.noise + at_load * error)
    for name, (value, own, power) in model.quantities(shape, l_r, middle).items():
        values[name], errors[name] = value, own + LEAST + noise * abs(power)
    values |= {
        "load": K * found.load,
        "friction_force": K * found.friction,
        "friction_coefficient": found.friction / found.load,
        "peak_pressure": K * values["peak_pressure"],
        "dissipated_in_contact": found.lost / found.friction if found.friction > 0.0 else 1.0,
    }
    summed = ("load", "friction_force", "friction_coefficient", "dissipated_in_contact")
    errors |= dict.fromkeys(summed, (1.0 + 4.0 * at_load) * error + noise)
    errors["depth"] = at_load * error
    side = -1.0 if V < 0.0 else 1.0
    for name in ("leading_edge", "trailing_edge", "friction_force", "friction_coefficient"):
        values[name] = side * values[name] + 0.0
    certificate = Certificate("estimated", STATEMENT, errors)
    return SteadyState(
        **{name: float(value) for name, value in values.items()},  # type: ignore[arg-type]
        model="quadrature",
        certificate=certificate,
    )


def _model(profile: Line) -> tuple[Any, Any]:
    """Return the module that computes the contacts of a profile, and the profile in its form."""
    return (contact, profile) if profile.convex else (asperities, Surface(profile, 1.0))


def _strips(indenter: Spot, l_r: float) -> Strips:
    """Return the function that knows the strips of an indenter."""
    profile = indenter.profile
    if profile.convex:
        return partial(_columns, profile, l_r)
    return partial(_one_by_one, Surface(profile, 1.0), l_r)


def sums(indenter: Spot, strips: Strips, l_r: float, depth: float) -> Sums:
    """Sum over the strips, by finer rules until two of them agree."""
    profile = indenter.profile
    half, rim = _half_length(profile, depth), RIM[profile.convex]
    pieces = list(pairwise([0.0, *_breaks(profile, l_r, depth, half), 0.5 * math.pi]))
    for number in range(1 + profile.convex, len(RULES)):
        nodes, rule = _rule(number)
        t = np.concatenate([start + (end - start) * nodes for start, end in pieces])
        weights = np.concatenate([(end - start) * rule for start, end in pieces], axis=1)
        kept = np.cos(t) > rim
        t, weights = t[kept], weights[:, kept]
        y = half * np.maximum(np.sin(t), MIDDLE)
        deep = np.maximum(depth - profile.height(y), np.finfo(float).tiny)
        weights *= 2.0 * half * indenter.stretch * np.cos(t)
        rows, own = strips(y, deep, weights[0])
        each = np.einsum("ij,kj->ik", rows, weights)
        apart = np.abs(np.diff(each)[[0, 2]]) / np.maximum(each[[0, 2], :1], np.finfo(float).tiny)
        last, before = apart.max(axis=0).tolist()
        # An analytic integrand squares its error with each rule; any other one divides it.
        estimate = last**1.5 if profile.convex else last * min(MARGIN * last / before, 1.0)
        error = estimate + own + rim**4
        if estimate < RTOL[profile.convex]:
            break
    if not error < LIMIT:
        raise QuadratureError("quadrature over the strips fails: the indenter's reach is too close")
    load, slope, friction, lost = each[:, 0].tolist()
    return Sums(load, slope, friction, lost, error)


def _rule(number: int) -> tuple[Array, Array]:
    """Return nodes from 0 to 1, and weights of the rule, of its half and of its quarter."""
    nodes, _, weights = RULES[number]
    count, every = weights.shape[1], np.array([[1], [2], [4]])
    taken = (np.arange(count) - count // 2) % every == 0
    return nodes[:count], weights[0] * np.where(taken, every, 0)


def _breaks(profile: Any, l_r: float, depth: float, half: float) -> list[float]:
    """Return t of the strips that touch a kink of the profile, or whose pressure vanishes there."""
    breaks = set()
    for kink in profile.kinks:
        if 0.0 < kink < half:
            slopes = [l_r * abs(profile.slope(kink * (1.0 + side * BESIDE))) for side in (-1, 1)]
            rise = depth - profile.height(kink)
            shares = [0.0, *(rise / slope for slope in slopes if 0.0 < rise < slope)]
            breaks |= {math.asin(kink / half * math.sqrt(1.0 - share**2)) for share in shares}
    return sorted(breaks)


def _half_length(profile: Any, depth: float) -> float:
    if profile.convex:
        return float(contact.half_length(profile, depth))
    surface = Surface(profile, 1.0)
    patch = asperities.at_depth(surface, 0.0, depth).patches[-1]
    return float(patch.x_te)


def _columns(
    profile: Line, l_r: float, y: Array, depth: Array, weights: Array
) -> tuple[Array, float]:
    """Return load, its slope, friction and what is lost in each strip of a convex profile."""
    column = np.full((y.size, 1), l_r)
    strip: Any = Strip(profile, y[:, None], profile.reach)
    found = contact.at_depth(strip, column, depth[:, None])
    named = contact.quantities(strip, column, found)
    (load, own, _), (friction, rubbed, _) = named["load"], named["friction_force"]
    lost = named["dissipated_in_contact"][0] * friction
    rows = np.array([part[:, 0] for part in (load, found.load_slope, friction, lost)])
    size = np.abs(np.array([load * own, friction * rubbed])).sum(axis=(1, 2))
    whole = np.maximum(np.array([load, friction]).sum(axis=(1, 2)), np.finfo(float).tiny)
    return rows, float((size / whole).max())


def _one_by_one(
    surface: Surface, l_r: float, y: Array, depth: Array, weights: Array
) -> tuple[Array, float]:
    """Return the same of a profile that is a pair of Python functions."""
    profile: Any = surface.indenter
    reach = float(surface.cells(float(depth[0]) + surface.height(y[0])).end.max())
    least = 2.0 ** math.floor(math.log2(NARROWEST * y.max()))
    rows, errors = np.empty((4, y.size)), np.empty((2, y.size))
    for column, (at, deep) in enumerate(zip(y.tolist(), depth.tolist(), strict=True)):
        found = asperities.at_depth(Surface(Strip(profile, at, reach), 1.0, least), l_r, deep)
        named, own = asperities.integrals_of(found)
        load, friction = named["load"], named["friction_force"]
        lost = named["dissipated_in_contact"] * friction
        rows[:, column] = load, found.load_slope, friction, lost
        errors[:, column] = own["load"] * load, own["friction_force"] * friction
    whole = np.maximum((rows[[0, 2]] * weights).sum(axis=1), np.finfo(float).tiny)
    return rows, float(((errors * weights).sum(axis=1) / whole).max())
