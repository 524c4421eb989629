r"""Time-temperature superposition: sweeps at several temperatures shifted to one master curve.

A sweep at T lies at x a_T (frequency) or t/a_T (time) of the reference temperature. The shift between
neighbouring temperatures is where the curves of both, interpolated in logarithms, differ least over their
overlap: least squares over storage and loss (or relaxation) moduli, and over their factor b_T too if moduli
may shift vertically. WLF's and Arrhenius' laws are fitted to the shift factors.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import curve_fit, minimize_scalar

from kvtheory.fitting.moduli import Sweep
from kvtheory.fitting.records import LARGEST, plausible
from kvtheory.fitting.spectrum import Array, Moduli
from kvtheory.scene.columns import Reader
from kvtheory.scene.foundations import GAS_CONSTANT

STEPS = 200
"""Shifts at which the difference is evaluated before the best one is refined."""
USUAL = 0.1
"""Deviation of log10 a_T from a law that is usual even for well measured shifts."""
LEAST_SCATTER = 1e-3
"""Smallest scatter of a log10 of a modulus that is used as a weight."""
FLOOR = 0.01
"""Smallest modulus whose logarithm is compared, over the scale of a misfit: a loss modulus of a thousandth of
|E*| may tell a shift that the storage modulus, nearly constant there, cannot."""
LEAST_OVERLAP = 2
"""Fewest points of each curve in the overlap."""
NEARBY, MOST_VARIANCE = 0.02, 1e4
"""Change of log10 a_T that measures the curvature of its minimum, and the largest variance of a step."""
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
        if self.name == "wlf":
            return -self.constants[0] * (T - reference) / (self.constants[1] + T - reference)
        slope = self.constants[0] / GAS_CONSTANT / math.log(10.0)
        return slope * (1.0 / T - 1.0 / reference)

    @property
    def text(self) -> str:
        """The law with its constants in words."""
        pairs = [
            f"{c:.4g} ± {float(f'{e:.2g}'):g}"
            for c, e in zip(self.constants, self.errors, strict=True)
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
            "temperature", f"{T[twice[0]] - 273.15:g} degC occurs twice", int(order[twice[0]])
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
    T = np.array([sweep.temperature for sweep in sweeps])
    if factors is None:
        steps = [_step(cold.moduli, warm.moduli, vertical) for cold, warm in pairwise(sweeps)]
        rows = np.array([(0.0, 0.0, 0.0), *steps]).cumsum(axis=0)
        first = int(np.abs(T - near).argmin()) if near is not None else T.size // 2
        rows, reference = rows - rows[first], float(T[first])
        rows[:, 2] = np.sqrt(np.abs(rows[:, 2]))
    else:
        place = np.abs(factors[0] - T[:, None]).argmin(axis=1)
        far = np.abs(factors[0][place] - T)
        if far.max() > SAME:
            worst = int(far.argmax())
            message = f"the file of shift factors has none for {T[worst] - 273.15:.4g} degC"
            raise ValueError(f"`shift_factors`: {message}")
        reference = float(factors[0][np.abs(factors[1]).argmin()])
        rows = np.column_stack([factors[1][place], np.zeros((T.size, 2))])
    parts = [
        Moduli(s.moduli.x * 10.0 ** (a if s.moduli.dynamic else -a), s.moduli.values * 10.0**b)
        for s, (a, b) in zip(sweeps, rows[:, :2], strict=True)
    ]
    x = np.concatenate([part.x for part in parts])
    order = np.argsort(x, kind="stable")
    whole = Moduli(x[order], np.concatenate([part.values for part in parts], axis=1)[:, order])
    return Shifted(whole, reference, T, *rows.T)


def _step(cold: Moduli, warm: Moduli, vertical: bool) -> tuple[float, float, float]:
    """Return the changes of log10 a_T and b_T to the next warmer sweep, and the variance of the first."""
    sign = 1.0 if cold.dynamic else -1.0  # towards the stiff end
    one, two = (
        (sign * np.log10(x[x > 0.0]), np.log10(np.maximum(values, FLOOR * scale))[:, x > 0.0])
        for x, values, scale in ((each.x, each.values, each.scale) for each in (cold, warm))
    )
    one, two = ((x[np.argsort(x)], y[:, np.argsort(x)]) for x, y in (one, two))
    scatter = np.hypot(_scatter(*one), _scatter(*two))[:, None]

    def difference(shift: float) -> tuple[float, float]:
        """Return the mean square difference over the overlap, and the mean difference."""
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

    low, high = one[0][0] - two[0][-1], one[0][-1] - two[0][0]
    tried = np.linspace(low, high, STEPS)
    score = np.array([difference(s)[0] for s in tried])
    best = int(score.argmin())
    if not math.isfinite(score[best]):
        raise ValueError("two sweeps at neighbouring temperatures cannot overlap: too few points")
    ends = tried[max(best - 1, 0)], tried[min(best + 1, STEPS - 1)]
    found = minimize_scalar(lambda s: difference(s)[0], bounds=ends, method="bounded")
    shift = float(found.x if found.fun <= score[best] else tried[best])
    least, b_T = difference(shift)
    sides: list[float] = [difference(shift + h)[0] for h in (-NEARBY, NEARBY)]
    rise: float = np.maximum(min(sides) - least, np.finfo(float).tiny)
    x = two[0] + shift
    count = int(np.count_nonzero((x >= one[0][0]) & (x <= one[0][-1]))) * len(one[1])
    variance = NEARBY * NEARBY * least / (rise * float(count - 1))
    return shift, b_T if vertical else 0.0, min(variance, MOST_VARIANCE)


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
