r"""The first rung: the asymptotes of a parabola and of a ball, where a bound of their error allows it.

The error of each asymptote is a closed form that is monotonic in l = l_r/a (derivations "error-..." and
"F20-error-..."). For a fixed indenter l is known and the error exact; an indenter that can move has its l
within bounds, at the worse end of which the error is taken. In units of the static state, with s = a/a_0,
lambda = V tau/a_0, q = x_TE/a and 1 + e the asymptote over the truth:

    low V:   depth s^-2, half length s^-1, trailing edge 1/(s q), peak pressure 1/(s^2 + lambda^2)
    high V:  load (1 + kappa)/(1 + kappa - kappa s^2)

The balance of forces is f + kappa (s^2 - 1) = 1, f the load in units of the static one; d ln f/d ln s is
between 2 and 3 for a parabola and between 3 and 4 for a ball (derivations "scaled-load", "F20-balance"). From
any s, whose total f + kappa s^2 is (1 + kappa) e^r, the root is therefore between s e^(-r/2) and s e^(-r/3),
for a ball s e^(-r/4): r tells how far it is. One step of Newton's method leaves |r| below 5e-4 for a ball,
which the tests hold it to, but the bounds are right without it.

The depth for high velocity has the error g(s)/(3/4 lambda) - 1, g = f/s^2 + kappa, which grows with s, and
for a ball (1 + x)^(2/3) - 1, x = (3 pi/(8 lambda)) (s (1 + T/pi)/2 + kappa/s), as its W is the damper's
(8 lambda/(3 pi)) s^3 and s^4 (1 + T/pi)/2. Behind the contact a ball dissipates 8 l D/(pi + T) of the power;
both D and T fall with l.
"""

import math
from collections.abc import Callable, Mapping
from functools import cache
from itertools import compress
from typing import NamedTuple

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady.ball import NEAR, SQUARES, WEIGHTS
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState
from kvtheory.theory import closed_forms as cf

ROUNDING = 16 * 2.0**-52
"""Rounding of the formulas themselves: 32 operations, half a unit in the last place each."""
UNIT = 4 * 2.0**-52
"""Rounding of s^2 where it is subtracted from 1."""
LOW_UP_TO, HIGH_FROM = 2.0, 0.5
"""Drive numbers, the first in units of 1 + kappa, beyond which the asymptotes of one regime have errors of
the order of one and are not tried."""
DAMPER = {"parabola": 0.75, "sphere": 8.0 / (3.0 * math.pi)}
"""f/(lambda s^2) of a parabola for high velocity, f/(lambda s^3) of a ball."""
STEEPEST = {"parabola": 3, "sphere": 4}
"""The largest d ln f/d ln s."""
NODES = tuple(zip(SQUARES.tolist(), WEIGHTS.tolist(), strict=True))


class Enclosure(NamedTuple):
    """lambda, kappa, and bounds of s = a/a_0; kappa is infinite and s = 1 for a fixed indenter.

    From these follow bounds of l = l_r/a and of q = x_TE/a.
    """

    number: float
    support_number: float
    low: float
    high: float
    shape: str = "parabola"

    @property
    def least(self) -> float:
        """The least l."""
        return self.number / self.high

    @property
    def largest(self) -> float:
        """The largest l."""
        return self.number / self.low

    @property
    def q_least(self) -> float:
        """The least q."""
        return 1.0 / (self.largest + math.hypot(1.0, self.largest))  # Eq. 27

    @property
    def q_largest(self) -> float:
        """The largest q."""
        return 1.0 / (self.least + math.hypot(1.0, self.least))


Bound = Callable[[Enclosure], float]
"""Of the relative error of an asymptote, for all l of an enclosure."""


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
    return enclose(shape, number, at_rest.support_number)


def enclose(shape: str, number: float, kappa: float) -> Enclosure:
    """Return bounds of a/a_0 for an indenter that can move, from its drive number and support number.

    >>> found = enclose("sphere", 4.0, 0.0)
    >>> print(f"{found.low:.6f} to {found.high:.6f}")
    0.644511 to 0.644514
    """
    steepest, yielding = STEEPEST[shape], 1.0 + kappa
    s = (yielding / (kappa + math.hypot(1.0, DAMPER[shape] * number))) ** (1.0 / (steepest - 1.0))
    held = kappa * s * s
    if shape == "parabola":
        total, slope = cf.scaled_load(s, number) + held, s * cf.scaled_load_slope(s, number)
    else:
        total = cf.ball_scaled_load(s, number, tail(number / s)) + held
        slope = cf.ball_scaled_load_slope(s, number, math.atan2(s, number))
    s *= math.exp(-math.log(total / yielding) * (total / (slope + 2.0 * held)))
    load = (
        cf.scaled_load(s, number)
        if shape == "parabola"
        else cf.ball_scaled_load(s, number, tail(number / s))
    )
    off = math.log((load + kappa * s * s) / yielding)
    low, high = sorted((s * math.exp(-off / 2.0), s * math.exp(-off / steepest)))
    return Enclosure(number, kappa, low, min(high, 1.0), shape)


def tail(l: float) -> float:
    """Return T as `ball.angle_and_tail` does, of a float.

    >>> round(tail(0.0), 12), round(tail(1e8), 12)
    (3.14159265359, 1.0667e-08)
    """
    if l <= NEAR:
        return cf.ball_tail(l, math.atan2(1.0, l))
    square = 1.0 / (l * l)
    return sum(weight / (1.0 + square * node) for node, weight in NODES) / l


def choose(bounds: Enclosure, quantities: tuple[str, ...], enough: float = math.inf) -> Choice:
    """Return the better regime for all `quantities`, with a proved bound of their relative error.

    A regime is judged by the first quantity whose bound is above `enough`: its bound is returned for all.

    Examples
    --------
    >>> found = choose(enclose("parabola", 1e-3, 0.0), ("friction_coefficient",))
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
    found = asymptotes.quantities(scene, asymptotes.limits(scene)[regime == "high"])
    return {name: float(found[name]) for name in quantities}


def _high_depth(b: Enclosure) -> float:
    g = cf.scaled_load(b.high, b.number) / (b.high * b.high)
    return (g + b.support_number) / (DAMPER["parabola"] * b.number) - 1.0


def _high_depth_of_ball(b: Enclosure) -> float:
    spring = 0.5 * b.high * (1.0 + tail(b.least) / math.pi) + b.support_number / b.low
    return math.cbrt(1.0 + spring / (DAMPER["sphere"] * b.number)) ** 2 - 1.0


def _dissipated(b: Enclosure) -> float:
    """1/(fraction) - 1 = (3/4) t/(1 - t), t = q (1 - q), which is largest at q = 1/2 (theorem F6)."""
    nearest = min(max(0.5, b.q_least), b.q_largest)
    t = nearest * (1.0 - nearest)
    return 0.75 * t / (1.0 - t)


def _dissipated_by_ball(b: Enclosure) -> float:
    behind = 8.0 * b.largest * cf.ball_loss(b.least, tail(b.least))
    return behind / (math.pi + tail(b.largest) - behind)


OF_SHAPE: Mapping[str, Mapping[str, Bound]] = {
    "parabola": {
        "low coefficient": lambda b: cf.error_l1(b.largest, b.q_least),
        "high coefficient": lambda b: cf.error_l2_fixed(b.q_largest, b.least),
        "high depth": _high_depth,
        "low load": lambda b: abs(cf.error_load_low(b.largest, b.q_least)),
        "low friction": lambda b: abs(cf.error_friction_force_low(b.largest, b.q_least)),
        "high load": lambda b: abs(cf.error_load_high(b.q_least)),
        "high friction": lambda b: abs(cf.error_friction_force_high(b.q_least)),
        "dissipated": _dissipated,
    },
    "sphere": {
        "low coefficient": lambda b: cf.ball_error_l1(b.largest, tail(b.largest)),
        "high coefficient": lambda b: cf.ball_error_l2(b.least, tail(b.least)),
        "high depth": _high_depth_of_ball,
        "low load": lambda b: abs(cf.ball_error_load_low(b.largest, tail(b.largest))),
        "low friction": lambda b: cf.ball_error_friction_low(b.largest, tail(b.largest)),
        "high load": lambda b: abs(cf.ball_error_load_high(b.least, tail(b.least))),
        "high friction": lambda b: abs(cf.ball_error_friction_high(b.least, tail(b.least))),
        "dissipated": _dissipated_by_ball,
    },
}
"""Bounds that depend on the shape: of the forces and of the friction coefficient at a given depth, of the
depth for high velocity of an indenter that can move."""


def _low_peak(b: Enclosure) -> float:
    """1/(s^2 + lambda^2) while the peak is inside the contact, 1/(2 lambda s) from then on (F7)."""
    n = b.number
    peaks = (s * s + n * n if n < s else 2.0 * n * s for s in (b.low, b.high))
    return max(abs(1.0 / peak - 1.0) for peak in peaks)


def _low_length(b: Enclosure) -> float:
    return 1.0 / b.low - 1.0


def _low_load(b: Enclosure) -> float:
    lifted = b.support_number * (1.0 - b.low**2 + UNIT)
    return lifted / (1.0 + lifted)


def _high_load(b: Enclosure) -> float:
    held = b.support_number * b.high**2
    return held / (1.0 + b.support_number - held)


def _table(of: Mapping[str, Bound], fixed: bool) -> dict[str, dict[str, tuple[Bound, ...]]]:
    """Return the bounds by regime and quantity, for one shape of the indenter."""

    def high_length(b: Enclosure) -> float:
        return math.sqrt(1.0 + of["high depth"](b)) - 1.0

    def high_coefficient(b: Enclosure) -> float:
        at_depth = of["high coefficient"](b)
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
        "friction_force": (_low_load, of["low coefficient"]),
        "friction_coefficient": (of["low coefficient"],),
        "peak_pressure": (_low_peak,),
        "dissipated_in_contact": (of["dissipated"],),
    }
    high: dict[str, tuple[Bound, ...]] = {
        "depth": (of["high depth"],),
        "half_length": (high_length,),
        "retardation_length": (),
        "leading_edge": (high_length,),
        "trailing_edge": (lambda b: math.inf,),  # Eq. 39 is zero
        "load": (_high_load,),
        "friction_force": (high_friction,),
        "friction_coefficient": (high_coefficient,),
        # Exact in the depth once the peak is at the leading edge, l >= 1 (F7).
        "peak_pressure": (lambda b: high_length(b) if b.least >= 1.0 else math.inf,),
        "dissipated_in_contact": (of["dissipated"],),
    }
    if fixed:  # the errors of the forces are known exactly, and the depth has none
        low |= {"load": (of["low load"],), "friction_force": (of["low friction"],)}
        high |= {
            **dict.fromkeys(("depth", "half_length", "leading_edge"), ()),
            "load": (of["high load"],),
            "friction_force": (of["high friction"],),
            "friction_coefficient": (of["high coefficient"],),
            "peak_pressure": (lambda b: 0.0 if b.least >= 1.0 else math.inf,),
        }
    return {"low": low, "high": high}


ERRORS = {
    (shape, fixed): _table(of, fixed) for shape, of in OF_SHAPE.items() for fixed in (True, False)
}
"""Bounds of |asymptote/truth - 1| by shape and whether it is fixed, then by regime and quantity; the largest
of several counts."""
