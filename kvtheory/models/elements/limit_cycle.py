"""The cycle near the onset of stick-slip, which a motion approaches too slowly to wait for.

The ripple along x is then the only slow motion, and how much it grows in a period depends on its amplitude A
alone: G(A) = ln(A_n+1/A_n) = g - c A^2 - e A^4. Runs of a few periods, from starts with the spring drawn,
measure G at any amplitude. The cycle is where G falls through zero: it is approached from both sides.

Near the onset g vanishes, and the error of elements in g does not. So g is also taken from theory, where it
is known, and only c and e from elements; of both cycles that with the smaller error is the answer.
"""

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from kvtheory.models.elements.schemes import DEFAULT, SCHEMES
from kvtheory.models.elements.simulation import SAFETY, simulate
from kvtheory.progress import Progress
from kvtheory.results.cycles import Cycle, Ripple, known_cycle, scale_of
from kvtheory.results.transient import SprungSimulation
from kvtheory.scene.model import Run, Scene
from kvtheory.scene.start import Drawn
from kvtheory.theory.laws import Array

PERIODS, LATE = 14.0, 10
"""Periods of a short run, and how many of them count: in the others all motions but the ripple fade."""
HALF, FAINTER = 0.5, (0.2, 0.05)
"""Amplitudes of other runs as shares: of the cycle, for its fit; of the first ripple, if it fades."""
BESIDE = 0.08
"""Share of its amplitude by which runs start below the cycle and above it."""
FARTHEST, TRIES = 1.5, 3
"""Largest factor from one amplitude to the next, and most of these: each costs three runs."""
MOST_RUNS, ENOUGH, MUCH = 4, {True: 1e7, False: 1e8}, 10.0
"""Runs of a search, and updates of elements, of a line contact and of a ball, after which it makes no other
run: so many take about two seconds, and with fewer elements the amplitude is looked for. After so many times
as many it ends in any case."""
WEAK = 0.05
"""Largest growth of small ripples in a period that is taken from theory: larger, it is far less in error by
elements, and no such polynomial any more down to small ripples."""
TINY = 1e-300
"""Replaces amplitudes that are none, where a ripple is rounding."""
BENT = 0.25
"""Of the amplitude, by which a value is bent between both, over the square of what they differ by."""


class Growth(NamedTuple):
    """How much a ripple grows from period to period: amplitudes in each, growths, and the last period."""

    sizes: Array
    growths: Array
    last: Ripple

    @classmethod
    def of(cls, ripple: Ripple) -> "Growth":
        """Return the growths of a ripple in the last periods of a run."""
        sizes = np.maximum(ripple.sizes[-LATE:], TINY)
        return cls(np.sqrt(sizes[1:] * sizes[:-1]), np.diff(np.log(sizes)), ripple)


def limit_cycle(
    scene: Scene, found: SprungSimulation, rates: Array | None, near: float = math.nan,
    progress: Progress | None = None,
) -> Cycle:  # fmt: skip
    """Return the cycle to which the ripple at the end of a run tends; unknown if it is not found.

    `rates` are those of small motions by theory, see `Stability`, None if they are not known; `near` is the
    amplitude with fewer elements, if known.
    """
    if not found.ripples or scene.depths or not scene.drive.ends:
        return Cycle(0.0)
    with suppress(ArithmeticError):  # of a run that fails, or is too much work
        return _search(scene, found, rates, near, progress)
    return Cycle(0.0)


def _search(
    scene: Scene, found: SprungSimulation, rates: Array | None, near: float,
    progress: Progress | None,
) -> Cycle:  # fmt: skip
    """Look for the cycle of a ripple, or raise ArithmeticError if that is too much work."""
    (given, *_), scale = found.ripples, 1.0
    end, size = PERIODS * given.period, float(given.sizes[-1])
    plain = replace(scene.at(scene.drive.final_velocity), run=Run(end))
    runs, work, enough = 0, 0, ENOUGH[scene.indenter.per_width]
    turning = rates[rates[:, 1] > 0.0].tolist() if rates is not None else []
    rate, _ = min(
        turning,
        key=lambda pair: abs(pair[1] * given.period - 2.0 * math.pi),
        default=(math.nan, 0.0),
    )
    theory = rate if abs(rate) * given.period <= WEAK else math.nan

    def follow(amplitude: float) -> list[Growth]:
        """Return the growths from about this amplitude on: with all elements, and in the coarse runs."""
        nonlocal scale, runs, work
        if work > enough * (1.0 if runs >= MOST_RUNS else MUCH):
            raise ArithmeticError("the search takes too long")
        along = given.centre + amplitude / scale
        start = Drawn(depth=None if scene.held else given.depth, along=along)
        run = simulate(
            replace(plain, start=start), 1.0 / found.per_length, SCHEMES[DEFAULT], at=[end],
            time_step=None, certify=True, progress=progress,
        )  # fmt: skip
        runs, work = runs + 1, work + run.element_updates
        growths = [Growth.of(each) for each in getattr(run, "ripples", ())]
        if not growths:
            raise ArithmeticError("there is no ripple")
        # The contact that forms at first adds to the ripple.
        first = growths[0]
        begun = first.sizes[0] * math.exp(-first.growths[0] * (PERIODS - LATE))
        scale = min(max(scale * float(begun) / amplitude, 1.0 / FARTHEST), FARTHEST)
        return growths

    ended = [Growth.of(each) for each in found.ripples]
    fainter = [share * given.sizes.max() for share in FAINTER if share * given.sizes.max() < size]
    if not fainter:
        return _faded([ended], rate, np.zeros(len(ended)))
    size = size if math.isnan(near) else near
    known = [ended, follow(HALF * size)]
    near = _amplitude([each[0] for each in known], theory) if math.isnan(near) else near
    for _ in range(TRIES):
        if not near > 0.0:
            break
        near = min(max(near, size / FARTHEST), size * FARTHEST)
        known = [follow(share * near) for share in (HALF, 1.0 - BESIDE, 1.0 + BESIDE)]
        size, near = near, _amplitude([each[0] for each in known], theory)
        low, high = (float(each[0].sizes.mean()) for each in known[1:])
        if low < near < high:
            ways = [
                [_cycle(each, g) for each in zip(*known, strict=True)] for g in (theory, math.nan)
            ]
            cycles = [first.beside(others, SAFETY) for first, *others in ways]
            best = min(cycles, key=lambda each: each.errors[0] if each.settles else math.inf)
            return best if best.settles and best.errors[0] < 1.0 else Cycle(0.0)
    off = [_fit(each, theory)[-1] - _fit(each, math.nan)[-1] for each in zip(*known, strict=True)]
    larger = [each for each in known if each[0].sizes[0] > fainter[-1]]  # the others are rounding
    return _faded([*larger, *map(follow, fainter)], rate, np.nan_to_num(off) * (rate < 0.0))


def _faded(runs: Sequence[list[Growth]], rate: float, off: Array) -> Cycle:
    """Return steady sliding if ripples fade at all amplitudes of the runs; `off` is added to growths."""
    means = np.array([[each.growths.mean() for each in run] for run in runs]) + off
    apart = np.abs(means[:, 1:] - means[:, :1]).max(axis=1)
    if rate >= 0.0 or np.any(means[:, 0] + SAFETY * apart >= 0.0):
        return Cycle(0.0)
    steady = [_steady(each) for each in runs[-1]]
    return steady[0].beside(steady[1:], SAFETY)


def _fit(runs: Sequence[Growth], rate: float) -> Array:
    """Return the growth in a period as a polynomial of the squared amplitude, from the highest power down."""
    squares, growths = (
        np.concatenate(each)
        for each in zip(*((run.sizes**2, run.growths) for run in runs), strict=True)
    )
    known = rate * runs[-1].last.period
    powers = np.polyfit(squares, growths, min(len(runs), 2))
    if not math.isnan(known):
        powers[-1] = known
    return powers


def _amplitude(runs: Sequence[Growth], rate: float) -> float:
    """Return the least amplitude at which the growth falls through zero, or NaN."""
    powers = _fit(runs, rate)
    roots = np.roots(powers)
    falls = (
        (roots.imag == 0.0)
        & (roots.real > 0.0)
        & (np.polyval(np.polyder(powers), roots).real < 0.0)
    )
    return math.sqrt(roots[falls].real.min()) if falls.any() else math.nan


def _cycle(runs: Sequence[Growth], theory: float) -> Cycle:
    """Return the cycle of one of the runs, by its growths from three amplitudes on."""
    amplitude, powers = _amplitude(runs, theory), _fit(runs, math.nan)
    if math.isnan(amplitude):
        return Cycle(0.0)
    square = amplitude * amplitude
    steep = 2.0 * square * abs(np.polyval(np.polyder(powers), square))
    scatter = math.sqrt(
        max(np.mean((each.growths - np.polyval(powers, each.sizes**2)) ** 2) for each in runs)
    )
    # What lies beyond the last power matters where the growth is followed down to small ripples.
    beyond = 0.0 if math.isnan(theory) else abs(powers[0] * square * square) ** 2 / abs(powers[-1])
    low, high = (each.last.values for each in runs[-2:])
    apart = high[0] - low[0]
    values = low + (high - low) * (amplitude - low[0]) / apart
    change = np.abs(high - low) / apart * amplitude / scale_of(values)
    doubt, bent = (scatter + beyond) / steep, BENT * (apart / amplitude) ** 2
    return known_cycle(values, change * (doubt + np.array([0.0, *[bent] * 5])))


def _steady(faint: Growth) -> Cycle:
    """Return steady sliding in the middle of a faint ripple."""
    high, low = faint.last.values[2::2], faint.last.values[3::2]
    middle = np.repeat(0.5 * (high + low), 2)
    swing = np.repeat(0.5 * (high - low), 2) / np.abs(np.where(middle, middle, 1.0))
    return known_cycle([0.0, math.nan, *middle], [0.0, 0.0, *swing])
