r"""First rung of the ladder: asymptotes on Kelvin-Voigt, where the bound of their error allows it.

Lengths along x are in units of a_0, loads in units of the static one: s = a/a_0, delta/delta_0 = s^n,
lambda = V tau/a_0. The balance of forces is f + kappa (s^n - 1) = 1, with d ln f/d ln s between n and n + 1
for a line contact h ~ |x|^n, and between 3 and 4 for a ball, n = 2 (derivations "scaled-load", "F19-balance",
"F20-balance"). From any s, whose total f + kappa s^n is (1 + kappa) e^r, the root is therefore between
s e^(-r/n) and s e^(-r/(n + 1)), for a ball s e^(-r/2) and s e^(-r/4). Newton's method makes |r| small; the
bounds hold for any r.

At a given lambda, with l = lambda/s, these grow with s: depth, half length, x_TE = s q(l), and the peak
pressure, s^n + (n - 1)^(n - 1) lambda^n or n lambda s^(n - 1) (F7, F19-peak). The load is 1 + kappa -
kappa s^n. The friction coefficient s^(n - 1) m(l) grows with s if n >= 2, as l/m grows with l (derivations
"error-L1", "F19-monotonic", "F20-error-L1"); otherwise it is bounded by its factors, as m grows with l. So
the asymptotes are compared with the exact values at both ends. The friction force is the product of two of
them; the dissipated part has its own bound.
"""

import math
from collections.abc import Callable
from functools import lru_cache, partial
from itertools import compress
from typing import NamedTuple

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady.ball import angle_and_tail
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState
from kvtheory.theory import closed_forms as cf

ROUNDING = 32 * 2.0**-52
"""Rounding of an asymptote and of the exact value that it is compared with."""
UNIT = 4 * 2.0**-52
"""Rounding of s^2 where it is subtracted from 1."""
LOW_UP_TO, HIGH_FROM = 2.0, 0.5
"""Drive numbers, the first over 1 + kappa, beyond which the asymptotes of a regime are not tried."""
ENCLOSED, MOST_STEPS = 1e-6, 10
"""Largest |r| at the end of Newton's method, which takes one to three steps, and most of them."""
LAST_STEP = 1e-8
"""Of ln q, in Newton's method for the trailing edge, which squares the error."""


class Shape(NamedTuple):
    """Steady sliding of a shape over l = V tau/a, in units of the state at rest with the same a."""

    exponent: float
    """n of delta ~ a^n."""
    steepest: float
    """The largest d ln f/d ln s; for high velocity it is one less."""
    damper: float
    """f/(lambda s^(steepest - 1)) for high velocity."""
    slow: float
    """m/l for low velocity, where mu = (delta/a) m."""
    fast: float
    """m for high velocity."""
    load: Callable[[float, float], float]
    """f at s and lambda."""
    load_slope: Callable[[float, float], float]
    """df/d ln s, likewise."""
    coefficient: Callable[[float], float]
    edge: Callable[[float], float]
    """q = x_TE/a."""
    peak: Callable[[float], float]
    """p/(K delta)."""
    behind: Callable[[float, float], float]
    """Bound of the energy dissipated behind the contact over that in it, for l between two values."""


@lru_cache(maxsize=64)
def line(n: float) -> Shape:
    """Return a power law of exponent n, or a wedge, n = 1."""

    def scaled(form: Callable[..., float], s: float, number: float) -> float:
        return float(form(n, s, s * trailing_edge(n, number / s), number))

    def of_contact(form: Callable[..., float], l: float) -> float:
        q = trailing_edge(n, l)
        return float(form(n, l, q, 1.0 / (q + n * l)))

    def behind(least: float, largest: float) -> float:
        """Bound l Q^2 (n - 1/2)/(1 + Q^2 q), Q = q^(n-1): q and Q fall with l (theorem F19-energy)."""
        q, last = trailing_edge(n, least), trailing_edge(n, largest)
        Q, least_Q = 1.0 / (q + n * least), 1.0 / (last + n * largest)
        return largest * Q * Q * (n - 0.5) / (1.0 + least_Q * least_Q * last)

    return Shape(
        n, n + 1.0, 1.0 / cf.power_law_static_load(n), cf.power_law_low(n), cf.power_law_high(n),
        partial(scaled, cf.power_law_scaled_load),
        lambda s, number: s * scaled(cf.power_law_scaled_load_slope, s, number),
        partial(of_contact, cf.power_law_friction_coefficient), partial(trailing_edge, n),
        lambda l: float(cf.power_law_peak_pressure(n, l)), behind,
    )  # fmt: skip


def trailing_edge(n: float, l: float) -> float:
    """Return q = x_TE/a, the root of q^n + n l q^(n-1) = 1, by Newton's method in ln q (derivation F19-edge).

    >>> [trailing_edge(n, 0.75) for n in (1.0, 2.0)]
    [0.25, 0.5]
    """
    if n == 2.0:
        return 1.0 / (l + math.hypot(1.0, l))  # Eq. 27 of a float, faster than of an array
    c, m = n * l, n - 1.0
    if m == 0.0:
        return max(0.0, 1.0 - l)
    t, step = -max(math.log(c), 0.0) / m if c else 0.0, math.inf
    while step > LAST_STEP * max(1.0, -t):
        q = math.exp(t)
        step = (m * t + math.log(q + c)) / (m + q / (q + c))
        t -= step
    return math.exp(t)


def _of_parabola() -> Shape:
    def behind(least: float, largest: float) -> float:
        """Bound (3/4) t/(1 - t), t = q (1 - q), which is largest at q = 1/2 (theorem F6)."""
        q = min(max(0.5, trailing_edge(2.0, largest)), trailing_edge(2.0, least))
        t = q * (1.0 - q)
        return 0.75 * t / (1.0 - t)

    return line(2.0)._replace(
        load=cf.scaled_load,
        load_slope=lambda s, number: s * cf.scaled_load_slope(s, number),
        coefficient=lambda l: 2.0 * cf.friction_coefficient_factor(l, trailing_edge(2.0, l)),
        behind=behind,
    )


def _of_ball() -> Shape:
    def behind(least: float, largest: float) -> float:
        """Bound 8 l D/(pi + T - 8 l D); both D and T fall with l (theorem F20-energy)."""
        most = 8.0 * largest * cf.ball_loss(least, angle_and_tail(least)[1])
        return float(most / (math.pi + angle_and_tail(largest)[1] - most))

    return line(2.0)._replace(
        steepest=4.0, damper=8.0 / (3.0 * math.pi), fast=3.0 * math.pi / 8.0,
        load=lambda s, number: cf.ball_scaled_load(s, number, angle_and_tail(number / s)[1]),
        load_slope=lambda s, number: cf.ball_scaled_load_slope(s, number, math.atan2(s, number)),
        coefficient=lambda l: 2.0 * cf.ball_friction_coefficient_factor(l, angle_and_tail(l)[1]),
        behind=behind,
    )  # fmt: skip


PARABOLA, BALL = _of_parabola(), _of_ball()


def shape_of(scene: Scene) -> Shape:
    """Return the shape of a parabola, a ball, a power law or a wedge."""
    known = {"parabola": PARABOLA, "sphere": BALL}.get(scene.indenter.shape)
    return known or line(float(scene.indenter.power[2]))


class Enclosure(NamedTuple):
    """lambda, kappa, and bounds of s = a/a_0; kappa is infinite and s = 1 for a fixed indenter."""

    number: float
    support_number: float
    low: float
    high: float
    shape: Shape = PARABOLA


class Choice(NamedTuple):
    """The regime whose asymptotes have the lower bound, and this bound of their relative error."""

    regime: str
    error: float


def enclosure_of(scene: Scene) -> Enclosure:
    """Return the bounds of s for a scene."""
    shape = shape_of(scene)
    if shape in (PARABOLA, BALL):
        at_rest = StaticState.of(scene)
    else:
        depth, a = (float(each) for each in asymptotes.at_rest(scene))
        load = scene.foundation.stiffness * depth * a / shape.damper
        at_rest = StaticState.at(scene, depth, a, load)
    number = abs(at_rest.drive_number)
    if at_rest.fixed:
        return Enclosure(number, math.inf, 1.0, 1.0, shape)
    return enclose(shape, number, at_rest.support_number)


def enclose(shape: Shape, number: float, kappa: float) -> Enclosure:
    """Return bounds of s for an indenter that can move, from its drive number and support number.

    >>> found = enclose(BALL, 4.0, 0.0)
    >>> print(f"{found.low:.6f} to {found.high:.6f}")
    0.644513 to 0.644513
    """
    n, power, yielding = shape.exponent, shape.steepest - 1.0, 1.0 + kappa
    s = (yielding / (kappa + math.hypot(1.0, shape.damper * number))) ** (1.0 / power)
    for _ in range(MOST_STEPS):
        held = kappa * s**n
        total = shape.load(s, number) + held
        off = math.log(total / yielding)
        if abs(off) < ENCLOSED:
            break
        s *= math.exp(-off * (total / (shape.load_slope(s, number) + n * held)))
    low, high = sorted((s * math.exp(-off / min(n, power)), s * math.exp(-off / shape.steepest)))
    return Enclosure(number, kappa, low, min(high, 1.0), shape)


def choose(bounds: Enclosure, quantities: tuple[str, ...], enough: float = math.inf) -> Choice:
    """Return the better regime for all `quantities`, with a proved bound of their relative error.

    A regime whose bound is above `enough` may be left out.

    >>> choose(enclose(PARABOLA, 1e-3, 0.0), ("friction_coefficient",)).regime
    'low'
    """
    fixed = math.isinf(bounds.support_number)
    yielding = 1.0 if fixed else 1.0 + bounds.support_number
    near = bounds.number <= LOW_UP_TO * yielding, bounds.number >= HIGH_FROM
    best = Choice("", math.inf)
    for regime in compress(("low", "high"), near):
        largest = max(errors(bounds, regime, quantities).values())
        if not best.regime or largest < best.error:
            best = Choice(regime, largest)
        if largest <= enough:
            break
    return best


def values(scene: Scene, regime: str, quantities: tuple[str, ...]) -> dict[str, float]:
    """Return the asymptotes of the quantities, in SI."""
    found = asymptotes.quantities(scene, asymptotes.limits(scene)[regime == "high"])
    return {name: float(found[name]) for name in quantities}


def errors(bounds: Enclosure, regime: str, quantities: tuple[str, ...]) -> dict[str, float]:
    """Return bounds of |asymptote/truth - 1| by quantity, `ROUNDING` included."""
    number, kappa, low, high, shape = bounds
    n, fixed, slow = shape.exponent, math.isinf(kappa), regime == "low"
    s = 1.0  # of the asymptote
    if not (slow or fixed):
        s = ((1.0 + kappa) / (shape.damper * number)) ** (1.0 / (shape.steepest - 1.0))
    load = 1.0 if slow else shape.damper * number if fixed else 1.0 + kappa
    mu = shape.slow * number if slow else shape.fast * s ** (n - 1.0)  # in units of delta_0/a_0

    def off(asymptote: float, one: float, other: float) -> float:
        if asymptote == one == other:
            return ROUNDING
        if not (one and other):
            return math.inf
        return max(abs(asymptote / one - 1.0), abs(asymptote / other - 1.0)) + ROUNDING

    def loads() -> tuple[float, float]:
        if fixed:
            return (shape.load(1.0, number),) * 2
        return 1.0 + kappa * (1.0 - high**n - UNIT), 1.0 + kappa * (1.0 - low**n + UNIT)

    def coefficients() -> tuple[float, float]:
        ends = (low, high) if n >= 2.0 else (high, low)
        least, most = (shape.coefficient(number / end) for end in ends)
        return least * low ** (n - 1.0), most * high ** (n - 1.0)

    def edge(s: float) -> float:
        return s * shape.edge(number / s)

    def peak(s: float) -> float:
        return s**n * shape.peak(number / s)

    def force() -> float:
        (less, more), (least, most) = loads(), coefficients()
        return off(load * mu, less * least, more * most)

    def length() -> float:
        return off(s, low, high)

    table: dict[str, Callable[[], float]] = {
        "depth": lambda: off(s**n, low**n, high**n),
        "half_length": length,
        "retardation_length": lambda: ROUNDING,
        "leading_edge": length,
        "trailing_edge": lambda: off(1.0 if slow else 0.0, edge(low), edge(high)),  # Eqs. 38, 39
        "load": lambda: off(load, *loads()),
        "friction_force": lambda: force() if number else ROUNDING,
        "friction_coefficient": lambda: off(mu, *coefficients()) if number else ROUNDING,
        "peak_pressure": lambda: off(
            s**n if slow else n * number * s ** (n - 1.0), peak(low), peak(high)
        ),
        "dissipated_in_contact": lambda: shape.behind(number / high, number / low) + ROUNDING,
    }
    return {name: float(table[name]()) for name in quantities}
