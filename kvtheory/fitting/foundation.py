"""A Prony series from measured moduli: master curve, fewest arms within the scatter, remarks."""

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import nnls
from scipy.stats import chi2

from kvtheory.fitting import cards, creep, moduli, shifting
from kvtheory.fitting.shifting import USUAL, Law, Shifted
from kvtheory.fitting.spectrum import FINEST, Moduli, Series, arms_of, best, clustered, refined, rms
from kvtheory.scene.units import in_celsius

CONFIDENCE = 0.95
"""Probability with which the scatter of the data alone makes the sum of squares as large as is allowed."""
SYSTEMATIC = 2.0
"""Ratio of the least misfit of any series to the scatter from which the data violate Kramers-Kronig."""
VISIBLE = 0.01
"""Least misfit below which they are never said to."""
UNRELAXED = 1e-6
"""Sum of the arms over the relaxed modulus below which there are none."""
UNSEEN, DOUBTFUL = 1e-3, 0.1
"""Relaxed modulus over the least storage or relaxation modulus below which the data do not show it, and below
which they have to by their misfit."""
WINDOW = 5
"""Points of the running mean that shows where."""
LOWEST = 3
"""Frequencies at which the loss shows whether the material flows."""
BEYOND_CARD, CARD_POINTS = 10.0, 100
"""Factor beyond the times of a card up to which its moduli hold, and the points at which they are drawn."""
VAGUE = 0.3
"""Standard error of log10 a_T from which a shift is reported as vague."""
MISSED = 2.0
"""Distance of a shift factor from the law, over its error and the usual one, from which it is reported."""


class Fitted(NamedTuple):
    """A series fitted to the master curve `data`, the dual bound on misfits, the shifts, remarks.

    `reference` is the temperature (K) at which the series holds, NaN without a law.
    """

    measured: moduli.Measured
    data: Moduli
    series: Series
    least_misfit: float
    shifted: Shifted | None
    law: Law | None
    reference: float
    notes: tuple[str, ...]


def fit(
    data: Any, modulus: str | None, near: float | None, shift_factors: Any, *, vertical: bool,
    arms: int | None, rtol: float | None,
) -> Fitted:  # fmt: skip
    """Return the series that fits a file of moduli; `near` is the temperature (K) of interest."""
    measured = moduli.read(data, modulus)
    notes, master, law = list(measured.notes), None, None
    factors = None if shift_factors is None else shifting.read_factors(shift_factors)
    sweeps = measured.sweeps
    if vertical and not sweeps[0].moduli.dynamic:
        message = "a relaxation modulus alone cannot tell a vertical shift from one in time"
        raise ValueError(f"`vertical`: {message}; expected dynamic moduli")
    whole = sweeps[0].moduli
    if len(sweeps) > 1:
        master = shifting.shifted(sweeps, near, factors, vertical=vertical)
        whole = master.moduli
    elif factors is not None:  # of data that are a master curve already
        T, log_shift = factors
        reference = float(T[np.abs(log_shift).argmin()])
        master = Shifted(whole, reference, T, log_shift, 0.0 * T, 0.0 * T)
    if master is not None:
        law = shifting.law_of(master)
        notes += [*master.notes, *_about_shifts(master, law)]
    thin = whole.thinned
    if thin.x.size < whole.x.size:
        notes.append(
            f"{whole.x.size:,} values were averaged to {thin.x.size:,}; misfits are of these."
        )
    spectrum, least = best(thin)
    start, target = clustered(thin, spectrum), 0.0
    if arms is None:
        start = refined(thin, start)
        target = max(_target(thin, start, least, rtol), 0.0 if rtol else measured.scatter)
    series = arms_of(thin, start, arms, target)
    if series.modulus.sum() <= UNRELAXED * series.relaxed:
        message = "the moduli do not relax: no series with arms above 0 is closer than a constant"
        raise ValueError(f"{measured.source}: {message}")
    noise = max(start.misfit(thin), measured.scatter)
    if _no_plateau(thin, series) or (
        series.relaxed < DOUBTFUL * float(thin.values[0].min())
        and not _needs_spring(thin, series, noise)
    ):
        series = _with_plateau(thin, series, measured.source)
        notes.append("The data show no relaxed modulus: the slowest arm was taken as the spring.")
    elif not _needs_spring(thin, series, noise) or _flows(thin):
        notes.append(
            "The data hardly show a relaxed modulus, which extrapolates: they would have to go on to lower "
            "frequencies or longer times, until the loss is small."
        )
    if arms is not None and series.time.size < arms:
        notes.append(f"{series.time.size} arms fit best; {arms} would be no better.")
    notes += _inconsistent(thin, spectrum, least, sweeps)
    if measured.creep is not None:
        off = creep.misfit(series, *measured.creep)
        notes.append(
            f"The creep compliance of the series is off by {off:.2g} (root mean square, relative)."
        )
    reference = math.nan if law is None or master is None else master.reference
    return Fitted(measured, thin, series, least, master, law, reference, tuple(notes))


def of_card(path: Path) -> tuple[Fitted, float]:
    """Return the series of a card of Abaqus or ANSYS, sampled over its times, and Poisson's ratio."""
    series, poisson_ratio, thermal, notes = cards.read(path)
    low, high = (1.0 / series.time[[-1, 0]]).tolist()
    omega = np.geomspace(low / BEYOND_CARD, high * BEYOND_CARD, CARD_POINTS)
    data = Moduli(omega, series.values(omega, dynamic=True))
    measured = moduli.Measured(str(path), (moduli.Sweep(math.nan, data),), "E", tuple(notes))
    law = None if thermal is None else Law("wlf", thermal.constants)
    reference = math.nan if thermal is None else thermal.reference
    return Fitted(measured, data, series, 0.0, None, law, reference, tuple(notes)), poisson_ratio


def _target(data: Moduli, start: Series, least: float, rtol: float | None) -> float:
    """Return the misfit that is allowed: `rtol`, or what the scatter about the best series makes likely."""
    if rtol is not None:
        if least > rtol:
            message = f"no Prony series is as close: the least misfit of any is {least:.3g}"
            raise ValueError(f"`rtol` = {rtol:g}: {message}")
        return rtol
    count = data.target.size
    free = max(count - 2 * start.time.size - 1, 0.5 * count)
    variance = max((start.misfit(data) * math.sqrt(count / free)) ** 2, FINEST**2)
    return math.sqrt(variance * float(chi2.ppf(CONFIDENCE, free)) / count)


def _no_plateau(data: Moduli, series: Series) -> bool:
    """Whether the relaxed modulus is not seen in the data."""
    return series.relaxed < UNSEEN * float(data.values[0].min())


def _needs_spring(data: Moduli, series: Series, noise: float) -> bool:
    """Whether the arms alone, with other moduli, are further off than noise explains."""
    _, norm = nnls(data.kernel(series.time), data.target)
    size = data.target.size
    rise = norm**2 - size * series.misfit(data) ** 2
    return rise > max(noise, FINEST) ** 2 * float(chi2.ppf(CONFIDENCE, 1))


def _flows(data: Moduli) -> bool:
    """Whether the loss is above the storage modulus at the lowest frequencies."""
    low = np.argsort(data.x)[:LOWEST]
    return data.dynamic and bool(np.median(data.values[1, low] - data.values[0, low]) > 0.0)


def _with_plateau(data: Moduli, series: Series, source: str) -> Series:
    """Return a series with a relaxed modulus for data that do not reach it."""
    found = Series(0.0, series.modulus, series.time)
    while _no_plateau(data, found) and found.time.size and found.time[-1] > data.times[1]:
        found = refined(data, Series(float(found.modulus[-1]), found.modulus[:-1], found.time[:-1]))
    if _no_plateau(data, found) or not found.time.size:
        message = "the moduli relax to zero within the data, or stiffen as they relax"
        expected = "expected data that show a relaxed modulus above 0, such as the rubber plateau"
        raise ValueError(f"{source}: {message}; {expected}")
    return found


def _about_shifts(master: Shifted, law: Law | None) -> list[str]:
    notes = []
    vague = [f"{in_celsius(T):.4g}" for T in master.temperatures[master.errors > VAGUE]]
    if vague:
        message = "The sweeps overlap too little, or are too flat, to tell their shift factors"
        notes.append(f"{message} to {VAGUE} decades at {', '.join(vague)} degC.")
    if law is None:
        notes.append("Neither WLF's nor Arrhenius' law fits the shift factors.")
        return notes
    off = np.abs(law.log_shift(master.temperatures, master.reference) - master.log_shift)
    worst = int(np.argmax(off / np.hypot(USUAL, master.errors)))
    if off[worst] > MISSED * math.hypot(USUAL, master.errors[worst]):
        name, T = law.text.split(":")[0], in_celsius(master.temperatures[worst])
        notes.append(f"{name} misses the shift factor at {T:.4g} degC by {off[worst]:.2g} decades.")
    return notes


def _inconsistent(data: Moduli, series: Series, least: float, sweeps: Any) -> list[str]:
    """Return a remark if no Prony series fits within the scatter between neighbours, and where not.

    Sweeps that have a series each, and none together, contradict superposition alone.
    """
    r = series.residuals(data)
    if r.shape[1] < 2 * WINDOW:
        return []
    steps = r[:, 1:-1] - 0.5 * (r[:, :-2] + r[:, 2:])
    scatter = np.median(np.abs(steps), axis=1) / 0.6745 / math.sqrt(1.5)
    if least < max(SYSTEMATIC * rms(scatter), VISIBLE):
        return []
    if len(sweeps) > 1:
        sizes = np.array([each.moduli.target.size for each in sweeps])
        own = np.array([best(each.moduli.thinned)[1] for each in sweeps])
        alone = math.sqrt(float(np.average(own**2, weights=sizes)))
        if alone < max(SYSTEMATIC * rms(scatter), VISIBLE):
            return [
                f"The sweeps do not fall onto one curve: no series has a misfit below {least:.2%} with these "
                f"shifts, and each sweep by itself has one of {alone:.2%} or more. Moduli may shift "
                "vertically, or times by different factors."
            ]
    mean = np.apply_along_axis(np.convolve, 1, r, np.full(WINDOW, 1.0 / WINDOW), "same")
    row, at = np.unravel_index(np.abs(mean).argmax(), mean.shape)
    off = np.abs(mean[row]) > 0.5 * abs(mean[row, at])
    low, high = at, at
    while low > 0 and off[low - 1]:
        low -= 1
    while high < off.size - 1 and off[high + 1]:
        high += 1
    ends = data.x[[low, high]] / (2.0 * math.pi if data.dynamic else 1.0)
    unit = "Hz" if data.dynamic else "s"
    which = ("storage", "loss")[row] if data.dynamic else "relaxation"
    rule = "Kramers-Kronig's relations" if data.dynamic else "decreasing convex relaxation"
    return [
        f"The data do not obey {rule}: no series with arms above 0 has a misfit below {least:.2%} (dual "
        f"bound), and the scatter is {rms(scatter):.2%}. The {which} modulus is off most from "
        f"{ends[0]:.3g} to {ends[1]:.3g} {unit}, by {-mean[row, at]:+.1%}."
    ]
