r"""The first rung: the asymptotes of a parabola and of a ball, where a bound of their error allows it.

The error of each asymptote is a closed form that is monotonic in l = l_r/a (derivations "error-..." and
"F20-error-..."). For a fixed indenter l is known and the error exact; an indenter that can move has its l
within bounds (`parabola_bounds`, `ball_bounds`), at the worse end of which the error is taken. In units of
the static state, with s = a/a_0, lambda = V tau/a_0, q = x_TE/a and 1 + e the asymptote over the truth:

    low V:   depth s^-2, half length s^-1, trailing edge 1/(s q), peak pressure 1/(s^2 + lambda^2)
    high V:  load (1 + kappa)/(1 + kappa - kappa s^2)
"""

import math
from functools import cache
from itertools import compress
from typing import NamedTuple

from kvtheory.models.steady.ball_bounds import BALL
from kvtheory.models.steady.enclosure import Bound, Enclosure, Known
from kvtheory.models.steady.parabola_bounds import PARABOLA
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

KNOWN = {"parabola": PARABOLA, "sphere": BALL}
"""By the name of the shape."""

ROUNDING = 16 * 2.0**-52
"""Rounding of the formulas themselves: 32 operations, half a unit in the last place each."""

UNIT = 4 * 2.0**-52
"""Rounding of s^2 where it is subtracted from 1."""

LOW_UP_TO, HIGH_FROM = 2.0, 0.5
"""Drive numbers, the first in units of 1 + kappa, beyond which the asymptotes of one regime have errors of
the order of one and are not tried."""


class Choice(NamedTuple):
    """The regime whose asymptotes have the lower bound, and this bound of their relative error."""

    regime: str
    error: float


def enclosure_of(scene: Scene) -> Enclosure:
    """Return the bounds of s for a scene with a parabola or a ball; a fixed indenter has s = 1."""
    at_rest, shape = StaticState.of(scene), scene.indenter.shape
    number = abs(at_rest.drive_number)
    if at_rest.fixed:
        return Enclosure(number, math.inf, 1.0, 1.0, shape)
    return KNOWN[shape].enclose(number, at_rest.support_number)


def choose(bounds: Enclosure, quantities: tuple[str, ...], enough: float = math.inf) -> Choice:
    """Return the better regime for all `quantities`, with a proved bound of their relative error.

    A regime is judged by the first quantity whose bound is above `enough`: its bound is returned for all.

    Examples
    --------
    >>> found = choose(PARABOLA.enclose(1e-3, 0.0), ("friction_coefficient",))
    >>> found.regime, round(found.error, 7)
    ('low', 0.0007506)
    """
    fixed = math.isinf(bounds.support_number)
    yielding = 1.0 if fixed else 1.0 + bounds.support_number
    near = bounds.number <= LOW_UP_TO * yielding, bounds.number >= HIGH_FROM
    best = Choice("", math.inf)
    for regime in compress(("low", "high"), near):
        largest = 0.0
        for bound in _distinct(bounds.shape, fixed, regime, quantities):
            largest = max(largest, bound(bounds))
            if largest > enough:
                break
        if not best.regime or largest + ROUNDING < best.error:
            best = Choice(regime, largest + ROUNDING)
    return best


@cache
def _distinct(
    shape: str, fixed: bool, regime: str, quantities: tuple[str, ...]
) -> tuple[Bound, ...]:
    """Return the bounds of the quantities, of which several share one."""
    table = ERRORS[shape, fixed][regime]
    return tuple(dict.fromkeys(bound for name in quantities for bound in table[name]))


def values(scene: Scene, regime: str, quantities: tuple[str, ...]) -> dict[str, float]:
    """Return the asymptotes of the quantities, in SI."""
    given = scene.values()
    side = -1.0 if given["drive.velocity"] < 0.0 else 1.0
    asymptotes = KNOWN[scene.indenter.shape].asymptotes
    limits = asymptotes.limits(given)
    found = asymptotes.quantities(limits, regime, side)
    return {name: float(found[name]) for name in quantities}


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


def _high_load(b: Enclosure) -> float:
    held = b.support_number * b.high**2
    return held / (1.0 + b.support_number - held)


def _table(known: Known, fixed: bool) -> dict[str, dict[str, tuple[Bound, ...]]]:
    """Return the bounds by regime and quantity."""

    def high_length(b: Enclosure) -> float:
        return math.sqrt(1.0 + known.high_depth(b)) - 1.0

    def high_coefficient(b: Enclosure) -> float:
        at_depth = known.high_coefficient(b)
        return at_depth + high_length(b) * (1.0 + at_depth)

    def high_friction(b: Enclosure) -> float:
        return (1.0 + _high_load(b)) * (1.0 + high_coefficient(b)) - 1.0

    low: dict[str, tuple[Bound, ...]] = {
        "depth": (lambda b: 1.0 / b.low**2 - 1.0,),
        "half_length": (_low_length,),
        "retardation_length": (),
        "leading_edge": (_low_length,),
        "trailing_edge": (lambda b: 1.0 / (b.low * b.q_least) - 1.0,),
        "load": (_low_load,),
        # Of the product: the errors of load and coefficient have opposite signs.
        "friction_force": (_low_load, known.low_coefficient),
        "friction_coefficient": (known.low_coefficient,),
        "peak_pressure": (_low_peak,),
        "dissipated_in_contact": (known.dissipated,),
    }
    high: dict[str, tuple[Bound, ...]] = {
        "depth": (known.high_depth,),
        "half_length": (high_length,),
        "retardation_length": (),
        "leading_edge": (high_length,),
        "trailing_edge": (lambda b: math.inf,),  # Eq. 39 is zero
        "load": (_high_load,),
        "friction_force": (high_friction,),
        "friction_coefficient": (high_coefficient,),
        # Exact in the depth once the peak is at the leading edge, l >= 1 (F7).
        "peak_pressure": (lambda b: high_length(b) if b.least >= 1.0 else math.inf,),
        "dissipated_in_contact": (known.dissipated,),
    }
    if fixed:  # the errors of the forces are known exactly, and the depth has none
        exact = dict.fromkeys(("depth", "half_length", "leading_edge"), ())
        low |= {"load": (known.low_load,), "friction_force": (known.low_friction,)}
        high |= exact | {
            "load": (known.high_load,),
            "friction_force": (known.high_friction,),
            "friction_coefficient": (known.high_coefficient,),
            "peak_pressure": (lambda b: 0.0 if b.least >= 1.0 else math.inf,),
        }
    return {"low": low, "high": high}


ERRORS = {
    (shape, fixed): _table(known, fixed)
    for shape, known in KNOWN.items()
    for fixed in (True, False)
}
"""Bounds of |asymptote/truth - 1| by regime and quantity, of which the largest counts.

The key is the shape, and whether the indenter is fixed.
"""
