r"""First rung of the ladder: asymptotes for a parabola and a ball, where the bound of their error allows it.

The balance of forces is f + kappa (s^2 - 1) = 1, with s = a/a_0, lambda = V tau/a_0 and the load f in units
of the static one; d ln f/d ln s is between 2 and 3 for a parabola and between 3 and 4 for a ball (derivations
"scaled-load", "F20-balance"). From any s, whose total f + kappa s^2 is (1 + kappa) e^r, the root is therefore
between s e^(-r/2) and s e^(-r/3), for a ball s e^(-r/4). One step of Newton's method leaves |r|
below 5e-4 for a ball, as the tests check; the bounds hold for any r.

At a given lambda every quantity but the friction force and the dissipated part is monotonic in s: depth and
half length, x_TE = sqrt(lambda^2 + s^2) - lambda, the peak pressure s^2 + lambda^2 or 2 lambda s (F7), the
load 1 + kappa - kappa s^2, and the friction coefficient, as l/m grows with l = lambda/s (derivations
"error-L1", "F20-error-L1"). So the asymptotes are compared with the exact values at both ends. The friction
force is the product of two of them; the dissipated part has its own bound.
"""

import math
from collections.abc import Callable
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
STEEPEST = {"parabola": 3, "sphere": 4}
"""The largest d ln f/d ln s; for high velocity it is one less."""
DAMPER = {"parabola": 0.75, "sphere": 8.0 / (3.0 * math.pi)}
"""f/(lambda s^2) of a parabola for high velocity, f/(lambda s^3) of a ball."""
PLATEAU = {"parabola": 4.0 / 3.0, "sphere": 3.0 * math.pi / 8.0}
"""mu/(s delta_0/a_0) for high velocity."""


class Enclosure(NamedTuple):
    """lambda, kappa, and bounds of s = a/a_0; kappa is infinite and s = 1 for a fixed indenter."""

    number: float
    support_number: float
    low: float
    high: float
    shape: str = "parabola"


class Choice(NamedTuple):
    """The regime whose asymptotes have the lower bound, and this bound of their relative error."""

    regime: str
    error: float


def enclosure_of(scene: Scene) -> Enclosure:
    """Return the bounds of s for a scene with a parabola or a ball."""
    at_rest, shape = StaticState.of(scene), scene.indenter.shape
    number = abs(at_rest.drive_number)
    if at_rest.fixed:
        return Enclosure(number, math.inf, 1.0, 1.0, shape)
    return enclose(shape, number, at_rest.support_number)


def enclose(shape: str, number: float, kappa: float) -> Enclosure:
    """Return bounds of s for an indenter that can move, from its drive number and support number.

    >>> found = enclose("sphere", 4.0, 0.0)
    >>> print(f"{found.low:.6f} to {found.high:.6f}")
    0.644511 to 0.644514
    """
    steepest, yielding = STEEPEST[shape], 1.0 + kappa
    s = (yielding / (kappa + math.hypot(1.0, DAMPER[shape] * number))) ** (1.0 / (steepest - 1.0))
    if shape == "parabola":
        slope = s * cf.scaled_load_slope(s, number)
    else:
        slope = cf.ball_scaled_load_slope(s, number, math.atan2(s, number))
    held = kappa * s * s
    total = _load(shape, number, s) + held
    s *= math.exp(-math.log(total / yielding) * (total / (slope + 2.0 * held)))
    off = math.log((_load(shape, number, s) + kappa * s * s) / yielding)
    low, high = sorted((s * math.exp(-off / 2.0), s * math.exp(-off / steepest)))
    return Enclosure(number, kappa, low, min(high, 1.0), shape)


def _load(shape: str, number: float, s: float) -> float:
    if shape == "parabola":
        return cf.scaled_load(s, number)
    return cf.ball_scaled_load(s, number, angle_and_tail(number / s)[1])


def _edge_ratio(l: float) -> float:
    return 1.0 / (l + math.hypot(1.0, l))  # Eq. 27 of a float, faster than of an array


def choose(bounds: Enclosure, quantities: tuple[str, ...], enough: float = math.inf) -> Choice:
    """Return the better regime for all `quantities`, with a proved bound of their relative error.

    A regime whose bound is above `enough` may be left out.

    >>> choose(enclose("parabola", 1e-3, 0.0), ("friction_coefficient",)).regime
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
    fixed, slow = math.isinf(kappa), regime == "low"
    s = 1.0  # of the asymptote
    if not (slow or fixed):
        s = ((1.0 + kappa) / (DAMPER[shape] * number)) ** (1.0 / (STEEPEST[shape] - 1.0))
    load = 1.0 if slow else DAMPER[shape] * number if fixed else 1.0 + kappa
    mu = 2.0 * number if slow else PLATEAU[shape] * s  # in units of delta_0/a_0

    def off(asymptote: float, one: float, other: float) -> float:
        return max(abs(asymptote / one - 1.0), abs(asymptote / other - 1.0)) + ROUNDING

    def loads() -> tuple[float, float]:
        if fixed:
            return (_load(shape, number, 1.0),) * 2
        return 1.0 + kappa * (1.0 - high**2 - UNIT), 1.0 + kappa * (1.0 - low**2 + UNIT)

    def coefficient(s: float) -> float:
        l = number / s
        if shape == "parabola":
            return 2.0 * s * cf.friction_coefficient_factor(l, _edge_ratio(l))
        return 2.0 * s * cf.ball_friction_coefficient_factor(l, angle_and_tail(l)[1])

    def edge(s: float) -> float:
        return s * _edge_ratio(number / s)

    def peak(s: float) -> float:
        return s * s + number * number if number < s else 2.0 * number * s  # F7

    def force() -> float:
        less, more = loads()
        return off(load * mu, less * coefficient(low), more * coefficient(high))

    def length() -> float:
        return off(s, low, high)

    table: dict[str, Callable[[], float]] = {
        "depth": lambda: off(s * s, low * low, high * high),
        "half_length": length,
        "retardation_length": lambda: ROUNDING,
        "leading_edge": length,
        "trailing_edge": lambda: off(1.0, edge(low), edge(high)) if slow else math.inf,  # Eq. 39
        "load": lambda: off(load, *loads()),
        "friction_force": lambda: force() if number else ROUNDING,
        "friction_coefficient": lambda: (
            off(mu, coefficient(low), coefficient(high)) if number else ROUNDING
        ),
        "peak_pressure": lambda: off(1.0 if slow else 2.0 * number * s, peak(low), peak(high)),
        "dissipated_in_contact": lambda: _dissipated(shape, number / high, number / low) + ROUNDING,
    }
    return {name: float(table[name]()) for name in quantities}


def _dissipated(shape: str, least: float, largest: float) -> float:
    """Return a bound of 1/(fraction) - 1, for l between two values.

    For a parabola it is (3/4) t/(1 - t), t = q (1 - q), which is largest at q = 1/2 (theorem F6). Behind the
    contact a ball dissipates 8 l D/(pi + T) of the power; both D and T fall with l (theorem F20-energy).
    """
    if shape == "parabola":
        q = min(max(0.5, _edge_ratio(largest)), _edge_ratio(least))
        t = q * (1.0 - q)
        return 0.75 * t / (1.0 - t)
    behind = 8.0 * largest * cf.ball_loss(least, angle_and_tail(least)[1])
    return behind / (math.pi + angle_and_tail(largest)[1] - behind)
