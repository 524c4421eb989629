r"""The limits of steady sliding at low and at high velocity: one table over law and shape.

In a limit load and friction coefficient are powers. With the half length a of the contact at rest, the depth
delta that belongs to it and l = V tau/a,

    W = load K delta a l^rise,    mu = friction (delta/a) l^slope.

`of_line` has these numbers for h = slope |x|^n/(n L^(n-1)) on Kelvin-Voigt (derivations "F19-low" and
"F19-high"; with n = 2 the paper's Eqs. 38-49) and for a parabola on the other laws: at low velocity a
Kelvin-Voigt foundation with C = int (G - K) dt (F18), or a power of its own for a springpot (F18-springpot);
at high velocity a damper, whatever is beside it, else a spring of the glassy stiffness G(0), whose friction
follows from -G'(0) (F18), or a springpot. A ball is the sum of its strips: a power p of their half length
becomes S(p) = int cos(t)^(p+1) dt over the half circle, for every law.

The balance of forces gives depth and load. For V -> 0 both are as at rest. For V -> oo a spring lifts the
indenter by its whole static depth, W -> M g + k_s delta_0, unless the foundation is a glassy spring itself.
"""

from typing import Any, NamedTuple

import numpy as np

from kvtheory.scene.indenters import Parabola, Sphere
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf
from kvtheory.theory.powers import root

Value = Any
"""An array, or a float."""


class Limit(NamedTuple):
    """The numbers of a limit: W = load K delta a l^rise and mu = friction (delta/a) l^slope."""

    load: Value
    rise: Value
    friction: Value
    slope: Value
    slow: bool


def limits(scene: Scene) -> tuple[Limit, Limit]:
    """Return the limits for V -> 0 and for V -> oo."""
    strips = of_line(scene)
    if scene.indenter.per_width:
        return strips

    from scipy.special import beta  # slow to import

    found = []
    for strip in strips:
        powers = 3.0 - strip.rise, 4.0 - strip.rise - strip.slope
        load, push = (beta(0.5, 0.5 * p + 1.0) for p in powers)  # S(p)
        share = {"load": strip.load * scene.indenter.stretch * load}
        found.append(strip._replace(**share, friction=strip.friction * push / load))
    return found[0], found[1]


def of_line(scene: Scene) -> tuple[Limit, Limit]:
    """Return the limits of a line contact, for a strip of a ball those of its parabola."""
    foundation = scene.foundation
    _, _, n = _shape(scene)
    static = cf.power_law_static_load(n)
    low = Limit(static, 0.0, cf.power_law_low(n), 1.0, slow=True)
    if foundation.springpot:
        from scipy.special import rgamma  # slow to import

        A = foundation.order
        share = 12.0 * A * rgamma(3.0 - A) / (4.0 - A) * 2.0**-A
        stiff = 2.0 * (2.0 - A) ** (2.0 - A) * rgamma(4.0 - A)
        fast = Limit(stiff, A, 2.0 * A * (3.0 - A) / (4.0 - A), 0.0, slow=False)
        return low._replace(friction=share, slope=A), fast
    if not foundation.arms:
        return low, Limit(1.0, 1.0, cf.power_law_high(n), 0.0, slow=False)
    glassy = foundation.stiffness + sum(arm.stiffness for arm in foundation.arms)
    falls = sum(arm.stiffness / arm.relaxation_time for arm in foundation.arms)  # -G'(0)
    friction = 0.8 * falls / glassy * foundation.retardation_time
    spring = static * glassy / foundation.stiffness, 0.0, friction, -1.0
    if not np.any(damped := foundation.damping > 0.0):
        return low, Limit(*spring, slow=False)
    damper = foundation.damping / foundation.slow_damping, 1.0, cf.power_law_high(n), 0.0
    each = [np.where(damped, *pair)[()] for pair in zip(damper, spring, strict=True)]
    return low, Limit._make([*each, False])


def _shape(scene: Scene) -> tuple[Value, Value, Value]:
    if isinstance(scene.indenter, Parabola | Sphere):
        return 1.0, scene.indenter.radius, 2.0
    slope, L, n = scene.indenter.power
    return np.asarray(slope), np.asarray(L), np.asarray(n)


def _carrying(scene: Scene, limit: Limit, load: Value) -> tuple[Value, Value]:
    """Return depth and half length at which the foundation of a limit carries a load."""
    slope, L, n = _shape(scene)
    across = 0.0 if scene.indenter.per_width else 1.0
    unit = limit.load * scene.foundation.stiffness * slope * L ** (2.0 + across)
    unit = unit if limit.slow else unit * (_retardation_length(scene) / L) ** limit.rise
    a = L * root(n * load / unit, n + 1.0 + across - limit.rise)
    return slope * L / n * (a / L) ** n, a


def _retardation_length(scene: Scene) -> Value:
    return np.abs(scene.drive.final_velocity) * scene.foundation.retardation_time


def at_rest(scene: Scene, low: Limit | None = None) -> tuple[Value, Value]:
    """Return depth and half length at rest; `low` is the limit for V -> 0, if already known."""
    if scene.held:
        depth, (slope, L, n) = scene.support.depth, _shape(scene)
        return depth, L * root(n * depth / (slope * L), n)
    return _carrying(scene, low or limits(scene)[0], scene.support.weight)


def contact(scene: Scene, limit: Limit) -> tuple[Value, Value, Value]:
    """Return depth, half length and load in a limit, on the support of a scene."""
    support = scene.support
    depth, a = static = at_rest(scene, limit if limit.slow else None)
    if scene.held:
        viscous = (_retardation_length(scene) / a) ** limit.rise
        across = 1.0 if scene.indenter.per_width else a
        return *static, limit.load * scene.foundation.stiffness * depth * a * across * viscous
    if limit.slow:
        return *static, support.weight
    lift = support.weight + support.spring * depth
    viscous = *_carrying(scene, limit, lift), lift
    if np.all((limit.rise > 0.0) | np.equal(support.spring, 0.0)):  # a power of the load
        return viscous

    from scipy.optimize import elementwise  # slow to import

    # A glassy spring: s = a/a_0 from g s^p + kappa (s^2 - 1) = 1.
    def excess(s: Value, g: Value, kappa: Value) -> Value:
        return g * s**power + kappa * (s * s - 1.0) - 1.0

    power = 3 if scene.indenter.per_width else 4
    given = limit.load / limits(scene)[0].load, support.spring * depth / support.weight
    s = elementwise.find_root(excess, (0.0, 1.0), args=given).x
    glassy = s * s * depth, s * a, lift - support.spring * s * s * depth
    pairs = zip(viscous, glassy, strict=True)
    depth, a, load = (np.where(limit.rise > 0.0, *pair)[()] for pair in pairs)
    return depth, a, load


def quantity(scene: Scene, limit: Limit, name: str = "friction_coefficient") -> Value:
    """Return the limit of one of depth, load, friction force and friction coefficient, at |V| of a scene."""
    depth, a, load = contact(scene, limit)
    if name in ("depth", "load"):
        return depth if name == "depth" else load
    mu = depth / a * limit.friction * (_retardation_length(scene) / a) ** limit.slope
    return mu if name == "friction_coefficient" else load * mu


def critical_velocity(scene: Scene) -> Value:
    """Return V* of the limits, powers of V (Eqs. 47, 48; F19-crossing, F19-crossing-weight, F20-crossing)."""
    _, _, n = _shape(scene)
    low, high = limits(scene)
    unit = at_rest(scene)[1] / scene.foundation.retardation_time
    there = scene.at(unit)
    ratio = quantity(there, high) / quantity(there, low)
    across = 1.0 if scene.indenter.per_width else 2.0
    shrinks = 0.0 if scene.held else high.rise / (n + across - high.rise)
    falls = high.slope - (n - 1.0 - high.slope) * shrinks
    return unit * ratio ** (1.0 / (low.slope - falls))


def quantities(scene: Scene, limit: Limit) -> dict[str, Value]:
    """Return the limit of every quantity on Kelvin-Voigt; for high velocity, infinite or zero at V = 0."""
    _, _, n = _shape(scene)
    K, V = scene.foundation.stiffness, scene.drive.final_velocity
    side = (V >= 0.0) * 2.0 - 1.0
    l_r = _retardation_length(scene)
    depth, a, load = contact(scene, limit)
    mu = depth / a * limit.friction * (l_r / a) ** limit.slope
    return {
        "depth": depth, "half_length": a, "retardation_length": l_r, "leading_edge": -side * a,
        "trailing_edge": side * a if limit.slow else 0.0 * a, "load": load,  # Eqs. 38, 39
        "friction_force": side * (load * mu) + 0.0, "friction_coefficient": side * mu + 0.0,  # not -0
        "peak_pressure": K * depth if limit.slow else K * depth * (n * l_r / a),
        "dissipated_in_contact": 0.0 * a + 1.0,
    }  # fmt: skip


def error(limit: Value, exact: Value) -> Value:
    """Return limit/exact - 1, or 0 where both are equal, as at rest."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(limit == exact, 0.0, limit / np.asarray(exact) - 1.0)
