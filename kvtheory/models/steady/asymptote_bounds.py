r"""The first rung: the paper's asymptotes, where a bound of their error allows it.

The error of each asymptote is a closed form in l = l_r/a and q = x_TE/a that is monotonic in l
(derivations "error-..."). For a fixed indenter l is known and the error exact; an indenter that can move
has its l within bounds that need no root, at the worse end of which the error is taken. With s = a/a_0,
lambda = V tau/a_0 and r = sqrt(lambda^2 + s^2) the load is f = s^2 g(s) in units of the static one (theorem
"scaled-load"), g = (lambda^2/(lambda + r) + r + s)/2, and the balance of forces f + kappa (s^2 - 1) = 1 says

    s = T(s),    T(s)^2 = (1 + kappa)/(g(s) + kappa).

g grows with s, for d(lambda^2/(lambda + r) + r)/dr = 1 - lambda^2/(lambda + r)^2 > 0, and so T falls: it
sends an upper bound of the root to a lower one and back. g > (3/4) lambda gives the first.
In units of the static state, with 1 + e the asymptote over the truth:

    low V:   depth s^-2, half length s^-1, trailing edge 1/(s q), peak pressure 1/(s^2 + lambda^2)
    high V:  depth (g(s) + kappa)/(3/4 lambda), load (1 + kappa)/(1 + kappa - kappa s^2)
"""

import math
from collections.abc import Callable
from functools import cache
from itertools import compress
from typing import NamedTuple

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady import closed_forms as cf
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

ROUNDING = 16 * 2.0**-52
"""Of the formulas themselves, as in the exact solution."""

UNIT = 4 * 2.0**-52
"""Rounding of s^2 where it is taken from 1."""

LOW_UP_TO, HIGH_FROM = 2.0, 0.5
"""Drive numbers, the first in units of 1 + kappa, beyond which what an asymptote alone gives has an error
of the order of one: it is not looked at."""


class Enclosure(NamedTuple):
    """lambda, kappa, and bounds of s = a/a_0; kappa is infinite and s = 1 for a fixed indenter."""

    number: float
    support_number: float
    low: float
    high: float

    @property
    def least(self) -> float:
        """The least l = l_r/a."""
        return self.number / self.high

    @property
    def largest(self) -> float:
        """The largest l = l_r/a."""
        return self.number / self.low

    @property
    def q_least(self) -> float:
        """The least q = x_TE/a."""
        return 1.0 / (self.largest + math.hypot(1.0, self.largest))  # Eq. 27

    @property
    def q_largest(self) -> float:
        """The largest q = x_TE/a."""
        return 1.0 / (self.least + math.hypot(1.0, self.least))


Bound = Callable[[Enclosure], float]


def _load_over_square(s: float, number: float) -> float:
    """Return g = f/s^2, f the load in units of the static one."""
    r = math.hypot(number, s)
    return 0.5 * (number * number / (number + r) + r + s)


def enclose(number: float, support_number: float) -> Enclosure:
    """Return bounds of a/a_0 in steady sliding of an indenter that can move.

    Parameters
    ----------
    number, support_number
        lambda >= 0 and kappa >= 0.

    Examples
    --------
    >>> found = enclose(4.0, 0.0)
    >>> print(f"{found.low:.5f} to {found.high:.5f}")
    0.55133 to 0.55138
    """
    kappa = support_number

    def image(s: float) -> float:
        return math.sqrt((1.0 + kappa) / (_load_over_square(s, number) + kappa))

    first = math.sqrt((1.0 + kappa) / max(0.75 * number + kappa, 1.0 + kappa))
    high = min(first, image(image(first)))  # at low velocity this halves the width
    return Enclosure(number, kappa, image(high), high)


class Choice(NamedTuple):
    """The regime whose asymptotes have the lower bound, and this bound of their relative error."""

    regime: str
    error: float


def enclosure_of(scene: Scene) -> Enclosure:
    """Return the bounds of s for a scene with a parabola; a fixed indenter has s = 1."""
    at_rest = StaticState.of(scene)
    number = abs(at_rest.drive_number)
    if at_rest.fixed:
        return Enclosure(number, math.inf, 1.0, 1.0)
    return enclose(number, at_rest.support_number)


def choose(bounds: Enclosure, quantities: tuple[str, ...], enough: float = math.inf) -> Choice:
    """Return the better regime for all `quantities`, with a proved bound of their relative error.

    One quantity whose bound is above `enough` decides about a regime: its bound stands for all.

    Examples
    --------
    >>> found = choose(enclose(1e-3, 0.0), ("friction_coefficient",))
    >>> found.regime, round(found.error, 7)
    ('low', 0.0007506)
    """
    fixed = math.isinf(bounds.support_number)
    yielding = 1.0 if fixed else 1.0 + bounds.support_number
    near = bounds.number <= LOW_UP_TO * yielding, bounds.number >= HIGH_FROM
    best = Choice("", math.inf)
    for regime in compress(("low", "high"), near):
        largest = 0.0
        for bound in _distinct(fixed, regime, quantities):
            largest = max(largest, bound(bounds))
            if largest > enough:
                break
        if not best.regime or largest + ROUNDING < best.error:
            best = Choice(regime, largest + ROUNDING)
    return best


@cache
def _distinct(fixed: bool, regime: str, quantities: tuple[str, ...]) -> tuple[Bound, ...]:
    """Return the bounds of the quantities, of which several share one."""
    table = ERRORS[fixed][regime]
    return tuple(dict.fromkeys(bound for name in quantities for bound in table[name]))


def values(scene: Scene, regime: str, quantities: tuple[str, ...]) -> dict[str, float]:
    """Return the asymptotes of the quantities, in SI."""
    given = scene.values()
    side = -1.0 if given["drive.velocity"] < 0.0 else 1.0
    limits = asymptotes.limits(given)
    found = asymptotes.quantities(limits, regime, side)
    return {name: float(found[name]) for name in quantities}


def _dissipated(b: Enclosure) -> float:
    """1/(fraction) - 1 = (3/4) t/(1 - t), t = q (1 - q), which is largest at q = 1/2 (theorem F6)."""
    nearest = min(max(0.5, b.q_least), b.q_largest)
    t = nearest * (1.0 - nearest)
    return 0.75 * t / (1.0 - t)


def _low_peak(b: Enclosure) -> float:
    """1/(s^2 + lambda^2) while the peak is inside the contact, 1/(2 lambda s) from then on (F7)."""
    return max(abs(1.0 / _peak(b.low, b.number) - 1.0), abs(1.0 / _peak(b.high, b.number) - 1.0))


def _peak(s: float, number: float) -> float:
    return s * s + number * number if number < s else 2.0 * number * s


def _low_length(b: Enclosure) -> float:
    return 1.0 / b.low - 1.0


def _low_load(b: Enclosure) -> float:
    lifted = b.support_number * (1.0 - b.low**2 + UNIT)
    return lifted / (1.0 + lifted)


def _low_coefficient(b: Enclosure) -> float:
    return cf.error_l1(b.largest, b.q_least)


def _high_depth(b: Enclosure) -> float:
    if math.isinf(b.support_number):
        return 0.0
    return (_load_over_square(b.high, b.number) + b.support_number) / (0.75 * b.number) - 1.0


def _high_length(b: Enclosure) -> float:
    return math.sqrt(1.0 + _high_depth(b)) - 1.0


def _high_load(b: Enclosure) -> float:
    held = b.support_number * b.high**2
    return held / (1.0 + b.support_number - held)


def _high_coefficient(b: Enclosure) -> float:
    at_depth = cf.error_l2_fixed(b.q_largest, b.least)
    return at_depth + _high_length(b) * (1.0 + at_depth)


MOVING: dict[str, dict[str, tuple[Bound, ...]]] = {
    "low": {
        "depth": (lambda b: 1.0 / b.low**2 - 1.0,),
        "half_length": (_low_length,),
        "retardation_length": (),
        "leading_edge": (_low_length,),
        "trailing_edge": (lambda b: 1.0 / (b.low * b.q_least) - 1.0,),
        "load": (_low_load,),
        # Of the product: the errors of load and coefficient have opposite signs.
        "friction_force": (_low_load, _low_coefficient),
        "friction_coefficient": (_low_coefficient,),
        "peak_pressure": (_low_peak,),
        "dissipated_in_contact": (_dissipated,),
    },
    "high": {
        "depth": (_high_depth,),
        "half_length": (_high_length,),
        "retardation_length": (),
        "leading_edge": (_high_length,),
        "trailing_edge": (lambda b: math.inf,),  # Eq. 39 is zero
        "load": (_high_load,),
        "friction_force": (lambda b: (1.0 + _high_load(b)) * (1.0 + _high_coefficient(b)) - 1.0,),
        "friction_coefficient": (_high_coefficient,),
        # Exact in the depth once the peak is at the leading edge, l >= 1 (F7).
        "peak_pressure": (lambda b: _high_length(b) if b.least >= 1.0 else math.inf,),
        "dissipated_in_contact": (_dissipated,),
    },
}
HELD: dict[str, dict[str, tuple[Bound, ...]]] = {
    "low": {
        **MOVING["low"],
        "load": (lambda b: abs(cf.error_load_low(b.largest, b.q_least)),),
        "friction_force": (lambda b: abs(cf.error_friction_force_low(b.largest, b.q_least)),),
    },
    "high": {
        **MOVING["high"],
        "load": (lambda b: abs(cf.error_load_high(b.q_least)),),
        "friction_force": (lambda b: abs(cf.error_friction_force_high(b.q_least)),),
    },
}
"""For a fixed indenter the errors of its forces are known exactly, and its depth has none."""
ERRORS = {False: MOVING, True: HELD}
"""Bounds of |asymptote/truth - 1| by regime and quantity, of which the largest counts.

The key says whether the indenter is fixed.
"""
