"""The limit cycle of an indenter on a spring: steady sliding, or periodic stick-slip.

Nothing sticks: "stick" is slow creep while the spring is stretched; "slip" follows from the fall of the
friction force with the sliding velocity.

A motion need not last until its cycle has settled. Near the limit of stability the amplitude A obeys
dA/dn = g A - c A^3 over the number n of cycles, so that 1/A^2 tends to its limit as exp(-2 g n): three cycles
at equal distances give that limit (Aitken). Near any cycle the approach is geometric, too. The limit is
accepted where two such triples agree; its error was then up to 1.1 %. From rest, with Table 1 and six springs
at 39 to 214 mm/s, this took 5 to 117 cycles; the amplitude itself was within 1 % of it after up to 971.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.results.presented import Recorded, record

Array = NDArray[np.float64]
States = Callable[[Array], Mapping[str, Array]]
"""The motion at some times: `offset` of the indenter along x, its rate, sliding velocity, and friction."""

CYCLE = {
    "stick_slip_settles": "1", "stick_slip_amplitude": "m", "stick_slip_period": "s",
    "sliding_velocity.cycle_max": "m/s", "sliding_velocity.cycle_min": "m/s",
    "friction_force.cycle_max": "N/m", "friction_force.cycle_min": "N/m",
}  # fmt: skip
"""The quantities of a cycle and their units; those of forces of a line contact."""

REPEATS, MOST_PEAKS = 0.01, 4
"""Share of the swing, and of the period, by which a cycle may differ from the one before it; peaks in one."""
RECENT, CHANGES = 3, 1e-3
"""Swings whose growth counts as that at the end of a motion, and the share by which it must differ from 1."""
BISECTIONS = 30
"""Halvings of the time between two samples: a turn is flat, and its value then known to the last digit."""
STEADY, LATE = 1e-3, (0.75, 0.875, 1.0)
"""A rate along x counts as zero if it stays below this share of the largest sliding velocity in the last
quarter of the motion, given by its two parts."""
GROWS, NOISE = 1.2, 0.1
"""Factor on the root mean square of the rate from one part to the next from which even such a motion grows,
and share of that share above which a rate is no noise."""
FALLEN = 1e-2
"""Share to which a rate falls where motions fade, of its largest value since the velocity is kept: the end of
a ramp sets all of them going, and one that grows is then seen."""
DRIFTS = 4.0
"""Times the range in that quarter, by which steady sliding may drift further."""
FEWEST = 8
"""Least number of cycles for two triples, the wider of which spans the last half of the motion."""
AGREE, DOUBT, FAR = 1e-3, 12.0, 1.5
"""Share of the amplitude by which both limits may differ, how many times that their error may be, and largest
ratio between amplitude and limit: beyond it, a triple may belong to another stage of the motion."""
QUIET, FADES = 1e-4, 0.5
"""Share of the amplitude below which differences between cycles are integration errors, unless all of them go
one way and do not fade to the second share: the ripple then changes slowly, and may do so for ever."""
LEVEL = {False: 1e-6, True: 1e-8}
"""Share below which even those are errors: where they are few, and go one way by chance, or many (True)."""
SEVERAL = 4
"""Differences that are many."""
POINTS = 4000
"""Samples of a cycle for its extremes, which are parabolic between samples: accurate to 1e-6."""


@dataclass(frozen=True)
class Cycle(Recorded):
    """The cycle at the end of a motion, in SI; its values are those of the limit.

    `settles` is 1 for steady sliding and for a cycle whose limit is known, else 0, and all values are NaN.
    `amplitude` is half the travel of the indenter along x; steady sliding has none, and no `period`. The
    others are the extremes of the sliding velocity and of the friction force. `errors` has one for each
    value, relative to the amplitude, the period, and the range of the velocity or force (of steady sliding
    its size); infinite where they are not known. `fell` is whether the motion was shown to fade to steady
    sliding, since the drive keeps its velocity.
    """

    settles: float
    amplitude: float = math.nan
    period: float = math.nan
    largest_slide: float = math.nan
    smallest_slide: float = math.nan
    largest_friction: float = math.nan
    smallest_friction: float = math.nan
    errors: tuple[float, ...] = (math.nan,) * 6
    fell: bool = True

    @property
    def values(self) -> Array:
        """The six values, in the order of `CYCLE`."""
        return np.array(astuple(self)[1:-2])

    @property
    def known(self) -> "Cycle":
        """The cycle; one whose errors are infinite is none."""
        return Cycle(0.0) if math.inf in self.errors else self

    @property
    def quantities(self) -> dict[str, float]:
        """All quantities, by the names of `CYCLE`."""
        return dict(zip(CYCLE, [self.settles, *self.values.tolist()], strict=True))

    @property
    def relative_errors(self) -> dict[str, float]:
        """The errors by the names of `CYCLE`; what does not exist has none."""
        found = zip(self.values, self.errors, strict=True)
        errors = [0.0 if math.isnan(value) else error for value, error in found]
        return dict(zip(CYCLE, [0.0, *errors], strict=True))

    def as_dict(self) -> dict[str, Any]:
        """Return the quantities, and their errors, by the names of `CYCLE`, ready for JSON."""
        return dict(record({**self.quantities, "relative_error": self.relative_errors}))

    def beside(self, others: Sequence["Cycle"], safety: float) -> "Cycle":
        """Return the cycle with `safety` times the largest difference to others added to its errors.

        They are infinite without another one, or if one ends otherwise.
        """
        ways = {(each.settles, each.amplitude == 0.0) for each in (self, *others)}
        if not others or len(ways) > 1:
            return replace(self, errors=(math.inf,) * 6)
        apart = np.max([abs(self.values - each.values) for each in others], axis=0)
        errors = self.errors + safety * apart / scale_of(self.values)
        return replace(self, errors=tuple(errors.tolist()))


class Ripple(NamedTuple):
    """The ripple along x in the last periods of a motion: its amplitudes, and the last period."""

    sizes: Array
    period: float
    centre: float  # of x
    depth: float
    values: Array  # as those of a `Cycle`


def ripple(times: Array, states: States) -> Ripple | None:
    """Return the ripple of a motion, or None of fewer than `RECENT` periods."""
    turns, x = _turns(states, times, states(times)["offset_rate"])
    sizes = 0.5 * (x[:-1:2] - x[1::2])
    if sizes.size < RECENT:
        return None
    depth = states(np.linspace(turns[-3], turns[-1], POINTS))["depth"].mean()
    centre, period = float(0.25 * (x[-3] + 2.0 * x[-2] + x[-1])), turns[-1] - turns[-3]
    return Ripple(
        sizes, float(period), centre, float(depth), _measured(states, turns[-3], turns[-1])
    )


def scale_of(values: Array) -> Array:
    """Return what errors of the values are relative to."""
    amplitude, period, *extremes = values
    high, low = extremes[::2], extremes[1::2]
    ranges = [a - b if amplitude else abs(a) or 1.0 for a, b in zip(high, low, strict=True)]
    return np.array([amplitude or 1.0, period, *np.repeat(ranges, 2)])


def cycle(times: Array, states: States) -> Cycle:
    """Return the cycle in which a motion on a spring ends; `times` are dense samples of all of it."""
    found, end = states(times), times[-1]
    rates, speed = found["offset_rate"], STEADY * np.abs(found["sliding_velocity"]).max()
    parts = [rates[(times >= a * end) & (times <= b * end)] for a, b in pairwise(LATE)]
    first, second = (math.sqrt(np.square(part).mean()) if part.size else 0.0 for part in parts)
    quiet = max(np.abs(part).max(initial=0.0) for part in parts) <= speed
    if quiet and second <= max(GROWS * first, NOISE * speed):
        late = [
            found[name][times >= LATE[0] * end] for name in ("sliding_velocity", "friction_force")
        ]
        drifts = [DRIFTS * np.ptp(each) / (abs(each[-1]) or 1.0) for each in late]
        slide, force = (each[-1] for each in late)
        V = found["sliding_velocity"] + rates
        changing = np.flatnonzero(np.abs(V - V[-1]) > STEADY * np.abs(V).max())
        since = np.abs(rates[np.append(changing, -1).max() + 1 :])
        steady = known_cycle(
            [0.0, math.nan, slide, slide, force, force], [0.0, 0.0, *np.repeat(drifts, 2)]
        )
        return replace(steady, fell=bool(not speed or second < FALLEN * since.max(initial=0.0)))
    turns, x = _turns(states, times, rates)
    ends, sizes = _cycles(turns, x)
    stride, limit, doubt = _limit(sizes)
    if math.isnan(limit):
        return Cycle(0.0)
    now = _measured(states, ends[-2], ends[-1])
    if 2.0 * math.pi * now[0] <= speed * now[1]:  # noise, while the motion still drifts
        return Cycle(0.0)
    step = now - _measured(states, ends[-2 - stride], ends[-1 - stride])
    change = sizes[-1] - sizes[-1 - stride]
    share = (limit - sizes[-1]) / change if limit != sizes[-1] else 0.0
    values = now + share * step
    # As far as the amplitude is in doubt, so is how far the others go on.
    beside = abs(step / change) * limit / scale_of(values) if change else 1.0
    return known_cycle(values, doubt * np.maximum(1.0, beside) * np.ones(6))


def known_cycle(values: Sequence[float] | Array, errors: Sequence[float] | Array) -> Cycle:
    """Return a cycle, or steady sliding, that is known."""
    amplitude, period, fast, slow, strong, weak = map(float, values)
    return Cycle(1.0, amplitude, period, fast, slow, strong, weak, tuple(map(float, errors)))


def note(times: Array, states: States) -> str:
    """Return a note if the ripple still grows or shrinks at the end of a motion, else an empty text.

    >>> t = np.linspace(0.0, 5.0, 500)
    >>> growing = np.sin(6.0 * t) * np.exp(0.2 * t), np.exp(0.2 * t) * np.cos(6.0 * t) * 6.0
    >>> note(t, sampled(t, *growing, sliding_velocity=1.0 - growing[1]))[:74]
    'The ripple along x still grows at the end of the run, by a factor of 1.233'
    """
    found = states(times)
    turns, x = _turns(states, times, found["offset_rate"])
    swings = (x[:-1:2] - x[1::2])[-RECENT:]
    speed = STEADY * np.abs(found["sliding_velocity"]).max()
    if swings.size < RECENT or math.pi * swings.min() <= speed * (
        period := float(turns[-1] - turns[-3])
    ):
        return ""
    ratios = swings[1:] / swings[:-1]
    growth = float(ratios.prod() ** (1.0 / ratios.size))
    if abs(growth - 1.0) <= CHANGES or not (np.all(ratios > 1.0) or np.all(ratios < 1.0)):
        return ""
    way = "grows" if growth > 1.0 else "shrinks"
    return (
        f"The ripple along x still {way} at the end of the run, by a factor of {growth:.4g} per period of "
        f"{period:.4g} s: this is not yet the cycle, or steady sliding, in which the motion ends."
    )


def sampled(time: Array, x: Array, rate: Array, **others: Array) -> States:
    """Return a motion from dense samples: x between two of them as a cubic, the others straight."""
    once = np.append(np.diff(time) > 0.0, True)  # a step begins where the one before it ends
    time, x, rate = time[once], x[once], rate[once]
    others = {name: row[once] for name, row in others.items()}

    def states(at: Array) -> dict[str, Array]:
        k = np.clip(np.searchsorted(time, at, side="right") - 1, 0, time.size - 2)
        h, (begin, end) = np.diff(time)[k], (x[k], x[k + 1])
        s, slope, turn = (at - time[k]) / h, rate[k] * h, (rate[k] + rate[k + 1]) * h
        cubic = turn - 2.0 * (end - begin)
        square = end - begin - slope - cubic
        found = {name: np.interp(at, time, row) for name, row in others.items()}
        offset = begin + s * (slope + s * (square + s * cubic))
        return {
            **found, "offset": offset,
            "offset_rate": (slope + s * (2.0 * square + s * 3.0 * cubic)) / h,
        }  # fmt: skip

    return states


def _turns(states: States, s: Array, rate: Array) -> tuple[Array, Array]:
    """Return times and values of the extremes of x, alternating; the first and the last are maxima."""
    up = rate > 0.0
    k = np.flatnonzero(up[:-1] != up[1:])
    k = k[np.argmax(up[k]) :] if up[k].any() else k[:0]
    k = k[: len(k) - 1 + len(k) % 2]
    low, high = s[k], s[k + 1]
    for _ in range(BISECTIONS if k.size else 0):
        middle = 0.5 * (low + high)
        same = (states(middle)["offset_rate"] > 0.0) == up[k]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return high, states(high)["offset"]


def _cycles(turns: Array, x: Array) -> tuple[Array, Array]:
    """Return the ends of the cycles and their amplitudes; none if the last two cycles differ."""
    for size in range(2, 2 * MOST_PEAKS + 1, 2):
        count = (len(x) - 1) // size
        if count < 2:
            break
        first = len(x) - 1 - size * count
        way, gaps = x[first:-1].reshape(-1, size), np.diff(turns[first:]).reshape(-1, size)
        swings = np.ptp(way, axis=1)
        if all(
            np.all(np.abs(each[-1] - each[-2]) <= REPEATS * whole)
            for each, whole in ((way, swings[-1]), (gaps, gaps[-1].sum()))
        ):
            return turns[first::size], 0.5 * swings
    return turns[:0], x[:0]


def _limit(sizes: Array) -> tuple[int, float, float]:
    """Return the stride of the wider of two triples, the limit of the amplitude if both agree, and its error.

    >>> n = np.arange(40)
    >>> stride, limit, error = _limit(2.0 / np.sqrt(1.0 + 0.5 * np.exp(-0.02 * n)))
    >>> stride, round(limit, 6), error < 1e-9
    (10, 2.0, True)
    >>> _limit(np.exp(-0.02 * n))
    (10, nan, nan)
    """
    count = len(sizes)
    stride = max(1, count // 4)
    last = sizes[-1 - 2 * stride :: stride]
    if len(last) == 3 and np.ptp(last) <= QUIET * last[-1]:
        (first, second), steps = np.diff(last), np.diff(sizes[-1 - 2 * stride :])
        one_way = abs(np.sign(steps).sum()) == steps.size and abs(second) > FADES * abs(first)
        if one_way and np.ptp(last) > LEVEL[steps.size >= SEVERAL] * last[-1]:
            return stride, math.nan, math.nan
        return stride, float(last[-1]), DOUBT * float(np.ptp(last) / last[-1])
    if count < FEWEST:
        return stride, math.nan, math.nan
    wide, near = (_aitken(sizes[-1 - 2 * m :: m] ** -2.0) for m in (stride, stride // 2))
    if min(wide, near) <= 0.0:
        return stride, math.nan, math.nan
    limit = wide**-0.5
    apart = abs(near**-0.5 / limit - 1.0)
    close = max(limit / sizes[-1], sizes[-1] / limit) <= FAR
    return (
        (stride, limit, DOUBT * apart) if apart <= AGREE and close else (stride, math.nan, math.nan)
    )


def _aitken(values: Array) -> float:
    """Return the limit of a geometric approach from its last three values."""
    first, second = np.diff(values)
    turn = first - second
    return float(values[-1] + second * second / turn) if turn else math.nan


def _measured(states: States, start: float, end: float) -> Array:
    """Return the amplitude, the period and the extremes of one cycle."""
    within = states(np.linspace(start, end, POINTS))
    x, number, force = (within[name] for name in ("offset", "sliding_velocity", "friction_force"))
    extremes = number.max(), number.min(), force.max(), force.min()
    return np.array([0.5 * np.ptp(x), end - start, *extremes])


def cycle_statement(safety: float) -> str:
    """Return what the errors of cycles are, with the `safety` of `beside`."""
    return (
        f"of cycles {DOUBT:g} times the difference of two limits to which the amplitude tends (near the "
        "onset how much the growths of ripples scatter beside it, over how steeply they fall), plus "
        f"{safety:g} times the difference to the cycles of the other solutions, relative to amplitude, "
        "period, and range of velocity or friction force in a cycle"
    )
