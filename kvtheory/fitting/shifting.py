r"""Time-temperature superposition: sweeps at several temperatures shifted to one master curve.

A sweep at T lies at x a_T (frequency) or t/a_T (time) of the reference temperature. The shift between
neighbouring temperatures is the one at which one non-negative spectrum (NNLS) fits both sweeps best, so that
sweeps that hardly overlap tell it, too. Its standard error is half of the distance over which the sum of
squares rises by four times the variance of a residual. If moduli may shift vertically, their factor b_T is
the mean difference of both sweeps, interpolated in logarithms, over their overlap. WLF's and Arrhenius'
laws are fitted to the shift factors.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import curve_fit, minimize_scalar, nnls

from kvtheory.fitting.moduli import Sweep
from kvtheory.fitting.records import LARGEST, plausible
from kvtheory.fitting.spectrum import Array, Moduli, grid
from kvtheory.scene.columns import Reader
from kvtheory.scene.foundations import GAS_CONSTANT, log_shift
from kvtheory.scene.units import in_celsius

STEPS = 200
"""Shifts at which the interpolated sweeps are compared for the first guess."""
AROUND, TRIED = 1.0, 21
"""Decades around the first guess over which spectra are tried, and at how many shifts."""
PER_DECADE, BEYOND = {False: 6, True: 12}, 2.0
"""Times of a spectrum per decade, for the search and for the result, and decades beyond the sweeps."""
RESOLVED, FIRST_STEP, HALVINGS = 1e-4, 3e-3, 6
"""Precision of a shift, the first step to the limits of its error, and how often the last one is halved."""
SIGMAS = 2.0
"""Standard errors at which the limits are."""
FINEST = 3e-3
"""Smallest standard deviation of a residual, as the times of a spectrum are a grid."""
USUAL = 0.1
"""Deviation of log10 a_T from a law that is usual even for well measured shifts."""
LEAST_SCATTER = 1e-3
"""Smallest scatter of a log10 of a modulus that is used as a weight."""
FLOOR = 0.01
"""Smallest modulus whose logarithm is compared, over the scale of a misfit: a loss modulus of a thousandth of
|E*| may tell a shift that the storage modulus, nearly constant there, cannot."""
LEAST_OVERLAP = 2
"""Fewest points of each curve in the overlap."""
BETTER = 4.0
"""Ratio of sums of squares from which a vertical shift, or a reversal of shift factors, is not by chance."""
LEAST_C_2, MOST_C_2 = 1.0, 1e4
"""Least distance in K of the WLF pole from the temperatures, and the largest C_2 that is meant."""
SAME = 1.5
"""Difference in K up to which a temperature of a file of shift factors is that of a sweep."""
SHIFTS = Reader(
    {
        "temperature": "T, temp, temperature, Temperatur",
        "log10 a_T": "log_aT, log a_T, log10 a_T, log10(a_T), log(a_T), log10_aT, lg a_T",
        "a_T": "a_T, aT, shift factor, Verschiebungsfaktor",
    },
    lambda found: "temperature" in found and bool(found & {"log10 a_T", "a_T"}),
    "a row such as T [degC],log10 a_T",
)  # fmt: skip


class Law(NamedTuple):
    """A law of the shift factor: its constants with standard errors, and the misfit of log10 a_T (RMS)."""

    name: str
    constants: tuple[float, ...]
    errors: tuple[float, ...] = ()
    misfit: float = 0.0

    def log_shift(self, T: Any, reference: float) -> Any:
        """Return log10 a_T."""
        return log_shift(T, reference, *self.constants)

    @property
    def text(self) -> str:
        """The law with its constants in words."""
        pairs = [f"{c:.4g}" for c in self.constants]
        if self.errors:
            pairs = [
                f"{c} ± {float(f'{e:.2g}'):g}" for c, e in zip(pairs, self.errors, strict=True)
            ]
        if self.name == "wlf":
            return f"WLF: C_1 = {pairs[0]}, C_2 = {pairs[1]} K"
        c, e = self.constants[0] / 1e3, self.errors[0] / 1e3
        return f"Arrhenius: E_a = {c:.4g} ± {e:.2g} kJ/mol"


class Shifted(NamedTuple):
    """The master curve at its reference temperature (K), and temperature, shifts and errors of each sweep."""

    moduli: Moduli
    reference: float
    temperatures: Array
    log_shift: Array
    log_vertical: Array
    errors: Array
    notes: tuple[str, ...] = ()


def read_factors(data: Any) -> tuple[Array, Array]:
    """Return temperatures in K and log10 a_T of a file; one of them is the reference, with a_T = 1."""
    table = SHIFTS.read(data)
    T = plausible(table, "temperature", table.si("temperature", "K")[0])
    if "log10 a_T" in table:
        log_shift = table.number("log10 a_T")
    else:
        a_T = table.number("a_T")
        table.require("a_T", a_T > 0.0, "is not above 0")
        log_shift = np.log10(a_T)
    name, most = ("log10 a_T" if "log10 a_T" in table else "a_T"), math.log10(LARGEST)
    order, small = np.argsort(T), np.abs(log_shift) <= most
    T, log_shift = T[order], log_shift[order]
    twice = np.flatnonzero(np.diff(T) == 0.0)
    if twice.size:
        raise table.error(
            "temperature", f"{in_celsius(T[twice[0]]):.4g} degC occurs twice", int(order[twice[0]])
        )
    if np.abs(log_shift).min() > 1e-6:
        message = "holds no temperature with a_T = 1, the reference"
        raise ValueError(f"{table.source}: {message}")
    table.require(name, small, f"is not plausible; expected log10 a_T from {-most:g} to {most:g}")
    return T, log_shift


def shifted(
    sweeps: Sequence[Sweep],
    near: float | None,
    factors: tuple[Array, Array] | None,
    *,
    vertical: bool,
) -> Shifted:
    """Return the master curve of sweeps in order of temperature, at that nearest to `near` or midway."""
    T, notes = np.array([sweep.temperature for sweep in sweeps]), []
    pairs = [Pair(cold.moduli, warm.moduli) for cold, warm in pairwise(sweeps)]
    if factors is None:
        steps = [pair.best(vertical=vertical) for pair in pairs]
        variance = _variance(steps)
        errors = [pair.error(step, variance) for pair, step in zip(pairs, steps, strict=True)]
        rows = np.array([(step.shift, step.vertical) for step in steps])
        rows = np.concatenate([np.zeros((1, 2)), rows.cumsum(axis=0)])
        spread = np.append(0.0, np.square(errors).cumsum())
        first = int(np.abs(T - near).argmin()) if near is not None else T.size // 2
        rows, reference = rows - rows[first], float(T[first])
        sigma = np.sqrt(np.abs(spread - spread[first]))
        if not vertical and sweeps[0].moduli.dynamic:
            notes = _proposed(pairs, steps)
    else:
        place = np.abs(factors[0] - T[:, None]).argmin(axis=1)
        far = np.abs(factors[0][place] - T)
        if far.max() > SAME:
            worst = int(far.argmax())
            message = f"the file of shift factors has none for {in_celsius(T[worst]):.4g} degC"
            raise ValueError(f"`shift_factors`: {message}")
        reference = float(factors[0][np.abs(factors[1]).argmin()])
        shifts = factors[1][place]
        given, other = (
            sum(
                pair.off(way * step).squares
                for pair, step in zip(pairs, np.diff(shifts), strict=True)
            )
            for way in (1.0, -1.0)
        )
        if given > BETTER * other:
            message = "the sweeps fall onto each other with their negatives, and not with these"
            hint = "expected log10 a_T, which falls as the temperature rises, with f a_T on the master curve"
            raise ValueError(f"`shift_factors`: are reversed: {message}; {hint}")
        rows, sigma = np.column_stack([shifts, 0.0 * shifts]), 0.0 * shifts
    parts = [
        Moduli(s.moduli.x * 10.0 ** (a if s.moduli.dynamic else -a), s.moduli.values * 10.0**b)
        for s, (a, b) in zip(sweeps, rows, strict=True)
    ]
    x = np.concatenate([part.x for part in parts])
    order = np.argsort(x, kind="stable")
    whole = Moduli(x[order], np.concatenate([part.values for part in parts], axis=1)[:, order])
    return Shifted(whole, reference, T, rows[:, 0], rows[:, 1], sigma, tuple(notes))


class Step(NamedTuple):
    """Changes of log10 a_T and log10 b_T to the next warmer sweep, the sum of squares, and its freedom."""

    shift: float
    vertical: float
    squares: float
    freedom: float


@dataclass(frozen=True)
class Pair:
    """Sweeps at neighbouring temperatures."""

    cold: Moduli
    warm: Moduli

    def off(self, shift: float, vertical: float = 0.0, *, fine: bool = False) -> Step:
        """Return the least sum of squares of both sweeps at a shift, over all non-negative spectra."""
        x = self.warm.x * 10.0 ** (shift if self.warm.dynamic else -shift)
        values = np.concatenate([self.cold.values, self.warm.values * 10.0**vertical], axis=1)
        both = Moduli(np.append(self.cold.x, x), values)
        times = np.append(np.inf, grid(both, BEYOND, PER_DECADE[fine]))
        squares, freedom = 0.0, 0.0
        rows = both.kernel(times).reshape(len(values), x.size + self.cold.x.size, -1)
        for kernel, target in zip(rows, both.target.reshape(len(values), -1), strict=True):
            held, norm = nnls(kernel, target, maxiter=30 * (times.size + 10))
            lines = 1 + np.count_nonzero(
                np.diff(np.flatnonzero(held)) > 1
            )  # neighbours are one arm
            squares += norm * norm
            freedom += max(target.size - 2.0 * lines - 1.0, 0.25 * target.size)
        return Step(shift, vertical, squares, freedom)

    @property
    def ends(self) -> tuple[float, float]:
        """The shifts between which the sweeps overlap."""
        (a, b), (c, d) = self.cold.times, self.warm.times
        return math.log10(c / b), math.log10(d / a)

    def best(self, *, vertical: bool) -> Step:
        """Return the step of the least sum of squares; it is infinite where only sweeps apart agree."""
        lift = _interpolated(self.cold, self.warm, vertical=vertical)
        low, high = self.ends
        tried = np.linspace(low, high, STEPS)
        score = np.array([lift(shift)[0] for shift in tried])
        guess = 0.5 * (low + high)
        if np.isfinite(score).any():
            guess = float(tried[score.argmin()])
            low, high = max(low, guess - AROUND), min(high, guess + AROUND)

        def off(shift: float, *, fine: bool = True) -> Step:
            return self.off(shift, lift(shift)[1] if vertical else 0.0, fine=fine)

        tried = np.linspace(low, high, TRIED)
        score = np.array([off(shift, fine=False).squares for shift in tried])
        place = int(np.abs(tried - guess).argmin())
        while (
            near := max(place - 1, 0) + int(score[max(place - 1, 0) : place + 2].argmin())
        ) != place:
            place = near  # the minimum there, as sweeps apart from each other always agree
        if place in (0, TRIED - 1):
            return off(guess)._replace(squares=math.inf)
        found = minimize_scalar(
            lambda shift: off(shift).squares, bounds=tried[[place - 1, place + 1]], method="bounded",
            options={"xatol": RESOLVED},
        )  # fmt: skip
        return min((off(float(found.x)), off(float(tried[place]))), key=lambda step: step.squares)

    def error(self, best: Step, variance: float) -> float:
        """Return the standard error of a shift, by the longer side of its profile.

        Where sweeps do not tell it, it is half of the range of shifts at which they overlap.
        """
        if math.isinf(best.squares):
            return 0.5 * (self.ends[1] - self.ends[0])
        rise = SIGMAS**2 * max(variance, best.squares / best.freedom, FINEST**2)
        return max(self._limit(best, side, best.squares + rise) for side in (-1.0, 1.0)) / SIGMAS

    def _limit(self, best: Step, side: float, most: float) -> float:
        def above(move: float) -> bool:
            return self.off(best.shift + side * move, best.vertical, fine=True).squares > most

        low, high = 0.0, FIRST_STEP
        while not above(high):
            low, high = high, 2.0 * high
            if not self.ends[0] - AROUND <= best.shift + side * high <= self.ends[1] + AROUND:
                return SIGMAS * 0.5 * (self.ends[1] - self.ends[0])
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if above(middle) else (middle, high)
        return high


def _variance(steps: Sequence[Step]) -> float:
    """Return the variance of a residual."""
    told = [step for step in steps if math.isfinite(step.squares)]
    return sum(step.squares for step in told) / max(sum(step.freedom for step in told), 1.0)


def _proposed(pairs: Sequence[Pair], steps: Sequence[Step]) -> list[str]:
    """Return a note if vertical shifts make the sweeps fall onto each other much better."""
    if math.sqrt(_variance(steps)) < FINEST:
        return []
    free = [pair.best(vertical=True) for pair in pairs]
    gain = _variance(steps) / max(_variance(free), FINEST**2)
    if gain < BETTER:
        return []
    ends = np.append(0.0, np.cumsum([step.vertical for step in free]))
    b_T = 10.0 ** (ends.max() - ends.min())
    message = (
        f"With vertical shifts the sweeps fall onto each other {math.sqrt(gain):.2g} times better"
    )
    return [
        f"{message}: moduli change by a factor of {b_T:.3g} over the temperatures. Try `vertical`."
    ]


def _interpolated(cold: Moduli, warm: Moduli, *, vertical: bool) -> Any:
    """Return a function of a shift: the mean square difference of sweeps over their overlap, and the mean."""
    sign = 1.0 if cold.dynamic else -1.0  # towards the stiff end
    one, two = (
        (sign * np.log10(x[x > 0.0]), np.log10(np.maximum(values, FLOOR * scale))[:, x > 0.0])
        for x, values, scale in ((each.x, each.values, each.scale) for each in (cold, warm))
    )
    one, two = ((x[np.argsort(x)], y[:, np.argsort(x)]) for x, y in (one, two))
    scatter = np.hypot(_scatter(*one), _scatter(*two))[:, None]

    def difference(shift: float) -> tuple[float, float]:
        gaps = []
        for (x, y), (u, v), side in ((two, one, 1.0), (one, two, -1.0)):
            at = x + side * shift
            inside = (at >= u[0]) & (at <= u[-1])
            if np.count_nonzero(inside) < LEAST_OVERLAP:
                return math.inf, 0.0
            pairs = zip(v, y, strict=True)
            gaps.append([side * (np.interp(at, u, row) - own)[inside] for row, own in pairs])
        gap = np.concatenate(gaps, axis=1)
        weight = np.broadcast_to(scatter**-2, gap.shape) / gap.size
        mean = float((weight * gap).sum() / weight.sum())
        return float((weight * gap * gap).sum()) - vertical * mean * mean * weight.sum(), mean

    return difference


def _scatter(x: Array, y: Array) -> Array:
    """Return the scatter of each row about straight lines from neighbour to neighbour."""
    if x.size < 3:
        return np.full(len(y), LEAST_SCATTER)
    share = (x[1:-1] - x[:-2]) / np.maximum(x[2:] - x[:-2], 1e-300)
    off = y[:, 1:-1] - (1.0 - share) * y[:, :-2] - share * y[:, 2:]
    return np.maximum(np.sqrt(np.mean(off * off, axis=1) / 1.5), LEAST_SCATTER)


def law_of(master: Shifted) -> Law | None:
    """Return the law that fits shift factors better for its number of constants; None if none does."""
    T, log_shift, reference = master.temperatures, master.log_shift, master.reference
    off = np.abs(T - reference) > 0.0
    if not off.any():
        return None
    sigma, slope = np.hypot(USUAL, master.errors), 1.0 / T - 1.0 / reference
    start = max(float(slope @ log_shift / (slope @ slope)) * GAS_CONSTANT * math.log(10.0), 1.0)
    tried: list[tuple[str, list[float], Any]] = [("arrhenius", [start], 0.0)]
    if np.count_nonzero(off) > 2:  # from the law made linear in its constants
        x, pole = T - reference, max(float((reference - T).max()), 0.0) + LEAST_C_2
        first = np.linalg.lstsq(np.column_stack([-x, -log_shift]), x * log_shift)[0]
        tried.append(("wlf", [max(first[0], 1.0), max(first[1], pole + 10.0)], (1e-3, pole)))
    laws = []
    for name, guess, low in tried:
        found, covariance = curve_fit(
            lambda T, *constants, name=name: Law(name, constants).log_shift(T, reference),
            T, log_shift, guess, sigma, bounds=(low, np.inf), x_scale=guess,
        )  # fmt: skip
        off_law = Law(name, tuple(found)).log_shift(T, reference) - log_shift
        free = T.size - found.size
        misfit = math.sqrt(float(np.average(off_law**2, weights=sigma**-2)) * T.size / free)
        errors_ = tuple(np.sqrt(np.diag(covariance)).tolist())
        laws.append(Law(name, tuple(found.tolist()), errors_, misfit))
    if len(laws) > 1 and laws[1].constants[1] > MOST_C_2:  # a straight line in T
        del laws[1]
    best: Law = min(laws, key=lambda law: law.misfit)
    return best if best.misfit < float(np.std(log_shift)) else None
