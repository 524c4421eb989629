r"""The first rung: the paper's asymptotes, where a bound of their error allows it.

The error of each asymptote is a closed form in l = l_r/a and q = x_TE/a that is monotonic in l
(derivations "error-..."). For a fixed indenter l is known and the error exact; an indenter that can move
has its l within bounds that need no root (`kvtheory.models.steady.enclosure`), at the worse end of which the
error is taken. In units of the static state, with s = a/a_0 and 1 + e the asymptote over the truth:

    low V:   depth s^-2, half length s^-1, trailing edge 1/(s q), peak pressure 1/(s^2 + lambda^2)
    high V:  depth (g(s) + kappa)/(3/4 lambda), load (1 + kappa)/(1 + kappa - kappa s^2)
"""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady import closed_forms as cf
from kvtheory.models.steady.enclosure import FIXED, Enclosure, enclose, load_over_square
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

ROUNDING = 16 * 2.0**-52
"""Of the formulas themselves, as in the exact solution."""

UNIT = 4 * 2.0**-52
"""Rounding of s^2 where it is taken from 1."""

LOW_UP_TO, HIGH_FROM = 2.0, 0.5
"""Drive numbers, the first in units of 1 + kappa, beyond which what an asymptote alone gives has an error
of the order of one: it is not looked at."""

Bound = Callable[[Enclosure], float]


class Choice(NamedTuple):
    """The regime whose asymptotes have the lower bound, and this bound of their relative error."""

    regime: str
    error: float


def ratio(l: float) -> float:
    """Return q = x_TE/a for l = l_r/a (Eq. 27)."""
    return 1.0 / (l + math.hypot(1.0, l))


def enclosure_of(scene: Scene) -> Enclosure:
    """Return the bounds of s for a scene with a parabola; a fixed indenter has s = 1."""
    at_rest = StaticState.of(scene)
    number = abs(at_rest.drive_number)
    if at_rest.fixed:
        return Enclosure(number, math.inf, FIXED, FIXED)
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
    tried = (("low", bounds.number <= LOW_UP_TO * yielding), ("high", bounds.number >= HIGH_FROM))
    tables = ERRORS[fixed]
    choices = [
        Choice(regime, _largest(tables[regime], bounds, quantities, enough) + ROUNDING)
        for regime, near in tried
        if near
    ]
    return min(choices, key=_error)


def _largest(
    table: Mapping[str, Bound], bounds: Enclosure, quantities: tuple[str, ...], enough: float
) -> float:
    largest = 0.0
    for bound in dict.fromkeys(table[name] for name in quantities):  # several share one
        largest = max(largest, bound(bounds))
        if largest > enough:
            break
    return largest


def _error(choice: Choice) -> float:
    return choice.error


def values(scene: Scene, regime: str, quantities: tuple[str, ...]) -> dict[str, float]:
    """Return the asymptotes of the quantities, in SI."""
    given = scene.values()
    side = -1.0 if given["drive.velocity"] < 0.0 else 1.0
    limits = asymptotes.limits(given)
    found = asymptotes.quantities(limits, regime, side)
    return {name: float(found[name]) for name in quantities}


def _exactly(_: Enclosure) -> float:
    return 0.0


def _never(_: Enclosure) -> float:
    return math.inf


def _dissipated(bounds: Enclosure) -> float:
    """1/(fraction) - 1 = (3/4) t/(1 - t), t = q (1 - q), which is largest at q = 1/2 (theorem F6)."""
    nearest = min(max(0.5, ratio(bounds.largest)), ratio(bounds.least))
    t = nearest * (1.0 - nearest)
    return 0.75 * t / (1.0 - t)


def _fixed(form: Callable[[float, float], float]) -> Bound:
    """Return the exact error of a fixed indenter, a function of l and q."""
    return lambda bounds: abs(form(bounds.number, ratio(bounds.number)))


def _peak_low(bounds: Enclosure) -> float:
    """1/(s^2 + lambda^2) while the peak is inside the contact, 1/(2 lambda s) from then on (F7)."""
    peaks = [
        s * s + bounds.number**2 if bounds.number < s else 2.0 * bounds.number * s
        for s in (bounds.low, bounds.high)
    ]
    return max(abs(1.0 / peak - 1.0) for peak in peaks)


def _low_load(bounds: Enclosure) -> float:
    lifted = bounds.support_number * (1.0 - bounds.low**2 + UNIT)
    return lifted / (1.0 + lifted)


def _low_friction(bounds: Enclosure) -> float:
    """Bound the product: the errors of load and coefficient have opposite signs."""
    return max(_low_load(bounds), _low_coefficient(bounds))


def _low_coefficient(bounds: Enclosure) -> float:
    return cf.error_l1(bounds.largest, ratio(bounds.largest))


def _low_length(bounds: Enclosure) -> float:
    return 1.0 / bounds.low - 1.0


def _low_trailing(bounds: Enclosure) -> float:
    return 1.0 / (bounds.low * ratio(bounds.largest)) - 1.0


def _high_depth(bounds: Enclosure) -> float:
    gap = load_over_square(bounds.high, bounds.number) + bounds.support_number
    return gap / (0.75 * bounds.number) - 1.0


def _high_length(bounds: Enclosure) -> float:
    return math.sqrt(1.0 + _high_depth(bounds)) - 1.0


def _high_load(bounds: Enclosure) -> float:
    held = bounds.support_number * bounds.high**2
    return held / (1.0 + bounds.support_number - held)


def _high_coefficient(bounds: Enclosure) -> float:
    at_depth = cf.error_l2_fixed(ratio(bounds.least), bounds.least)
    return (1.0 + at_depth) * math.sqrt(1.0 + _high_depth(bounds)) - 1.0


def _high_friction(bounds: Enclosure) -> float:
    return (1.0 + _high_load(bounds)) * (1.0 + _high_coefficient(bounds)) - 1.0


def _high_peak(bounds: Enclosure) -> float:
    """Exact in the depth once the peak is at the leading edge, l >= 1 (F7)."""
    return _high_length(bounds) if bounds.least >= 1.0 else math.inf


MOVING: Mapping[str, Mapping[str, Bound]] = {
    "low": {
        "depth": lambda bounds: 1.0 / bounds.low**2 - 1.0,
        "half_length": _low_length,
        "retardation_length": _exactly,
        "leading_edge": _low_length,
        "trailing_edge": _low_trailing,
        "load": _low_load,
        "friction_force": _low_friction,
        "friction_coefficient": _low_coefficient,
        "peak_pressure": _peak_low,
        "dissipated_in_contact": _dissipated,
    },
    "high": {
        "depth": _high_depth,
        "half_length": _high_length,
        "retardation_length": _exactly,
        "leading_edge": _high_length,
        "trailing_edge": _never,  # Eq. 39 is zero
        "load": _high_load,
        "friction_force": _high_friction,
        "friction_coefficient": _high_coefficient,
        "peak_pressure": _high_peak,
        "dissipated_in_contact": _dissipated,
    },
}
_GIVEN = dict.fromkeys(("depth", "half_length", "retardation_length", "leading_edge"), _exactly)
HELD: Mapping[str, Mapping[str, Bound]] = {
    "low": {
        **_GIVEN,
        "trailing_edge": _low_trailing,
        "load": _fixed(cf.error_load_low),
        "friction_force": _fixed(cf.error_friction_force_low),
        "friction_coefficient": _low_coefficient,
        "peak_pressure": _peak_low,
        "dissipated_in_contact": _dissipated,
    },
    "high": {
        **_GIVEN,
        "trailing_edge": _never,
        "load": _fixed(lambda _, q: cf.error_load_high(q)),
        "friction_force": _fixed(lambda _, q: cf.error_friction_force_high(q)),
        "friction_coefficient": _fixed(lambda l, q: cf.error_l2_fixed(q, l)),
        "peak_pressure": lambda bounds: 0.0 if bounds.number >= 1.0 else math.inf,
        "dissipated_in_contact": _dissipated,
    },
}
ERRORS = {False: MOVING, True: HELD}
"""Bounds of |asymptote/truth - 1| by regime and quantity; the key says whether the indenter is fixed."""
