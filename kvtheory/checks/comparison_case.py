"""A series beside theory, and what all checks have in common."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import wraps

import numpy as np

from kvtheory.checks.allowances import Allowance, allowance
from kvtheory.checks.noise import SURE, gaps
from kvtheory.checks.reading import Series
from kvtheory.checks.resolution import Resolution, resolution
from kvtheory.checks.theory import CURVES, Array, Curves, Theory
from kvtheory.results.comparison import Check

THEORY_RTOL = 1e-7
"""Tolerance of the theory: its error is far below every allowance."""
SMALLEST = 1e-9
"""Of a scale: smaller differences are ignored."""
LARGEST_SAWTOOTH = 0.025
"""Of the load: if half an element at the edge matters more, the contact is not resolved."""
COARSEST = 0.1
"""Of the load: if half an element would have to matter more, the data are wrong rather than coarse."""
SOME, IN_STEP = 1.4, 1.75
"""Elements may be so much fewer than assumed, or than an even sawtooth shows; and than an uneven one shows,
for samples that are nearly in step with the elements that enter see little of it."""
USUAL, LARGE, OFTEN = 0.43, 1.08, 0.95
"""Of b: median and 95th percentile of the gaps of a sawtooth of +-b that is sampled at random."""
EVEN = 0.6
"""Of the ratio of both that is expected: below it, a part of the samples is in step."""
FINEST = 0.1
"""Of the spacing assumed: a smaller sawtooth is that of samples all in step, and of the digits if these leave
out as much."""
COMMON = 0.5
"""Squared correlation of the noise of both forces, from which on it is taken for the sawtooth of F15."""
LOUD = 4.0
"""Times the median: larger differences are jumps, which count as much as this."""


@dataclass(frozen=True)
class Case:
    """A series, theory at its times (`now`), and the allowed differences."""

    theory: Theory
    series: Series
    resolution: Resolution
    now: Curves
    allowance: Allowance
    tolerance: float

    @property
    def names(self) -> tuple[str, ...]:
        """The curves that the series holds."""
        return tuple(name for name in CURVES if name in self.series.columns)

    def columns(self, *names: str) -> tuple[Array, ...]:
        """Return columns of the data, without which a check is not made."""
        for name in names:
            if name not in self.series.columns:
                raise NotMade(f"the data hold no {name.replace('_', ' ')}")
        return tuple(self.series.columns[name] for name in names)

    def rows(self, rows: Array) -> "Case":
        """Return the case of some of its rows."""
        columns = {name: values[rows] for name, values in self.series.columns.items()}
        now = {name: values[rows] for name, values in self.now.items()}
        series, allowed = replace(self.series, columns=columns), self.allowance.rows(rows)
        return replace(self, series=series, now=now, allowance=allowed)

    def residual(self, name: str) -> Array:
        """Return data less theory, relative to the scale of the curve."""
        return (self.series.columns[name] - self.now[name]) / self.theory.scales[name]

    def excess(self, name: str) -> Array:
        """Return how far the data lie outside the band of theory, relative to the scale."""
        values = self.allowance.excess(name, self.series.columns[name])
        return np.asarray(np.nan_to_num(values) / self.theory.scales[name])

    def limit(self, name: str) -> Array:
        """Return how far a single value may lie outside the band, relative to the scale."""
        values = np.nan_to_num(self.allowance.limit(name), nan=0.0) / self.theory.scales[name]
        return np.asarray(self.tolerance * (values + SMALLEST))

    def rms_limit(self, name: str) -> float:
        """Return the largest root mean square of a curve that is allowed, relative to the scale."""
        scale = self.theory.scales[name]
        smooth = rms(self.allowance.systematic[name]) / scale
        sigma = rms(self.allowance.noise[name]) / scale
        random = sigma * (1.0 + SURE * math.sqrt(2.0 / self.series.time.size))
        return self.tolerance * (smooth + random + SMALLEST)


Measured = tuple[float, float, str]
"""What a check measures, what is allowed (with the tolerance), and a note."""


class NotMade(Exception):  # noqa: N818
    """A check cannot be made, for the reason that its text gives."""


def made(
    name: str, equation: str, unit: str, measured: float, allowed: float, note: str = ""
) -> Check:
    """Return a check that was made."""
    ok = bool(measured <= allowed)
    return Check(name, float(measured), float(allowed), ok, equation, unit, note)


def check(
    name: str, equation: str | Callable[[Case], str], unit: str
) -> Callable[[Callable[[Case], Measured]], Callable[[Case], Iterator[Check]]]:
    """Make a check of a function that returns what it measured or raises `NotMade`."""

    def of(measure: Callable[[Case], Measured]) -> Callable[[Case], Iterator[Check]]:
        @wraps(measure)
        def checked(case: Case) -> Iterator[Check]:
            basis = equation if isinstance(equation, str) else equation(case)
            try:
                yield made(name, basis, unit, *measure(case))
            except NotMade as reason:
                yield Check(name, None, None, None, basis, "", f"not made: {reason}")

        return checked

    return of


def make_case(
    theory: Theory, series: Series, per_length: float | None, tolerance: float, coarsest: float
) -> Case:
    """Compare a series with theory.

    Where the element density is not known, and the noise is that of elements, it is estimated from that:
    up to a force of half an element of `coarsest`, relative to the load.
    """
    fine = resolution(theory, series, per_length)
    case = Case(theory, series, fine, *allowance(theory, series, fine, THEORY_RTOL), tolerance)
    if fine.spacing_known:
        return case
    largest = coarsest * theory.static.load / float(np.median(case.allowance.force))
    seen = _coarser(case) if (common_noise(case) or 0.0) >= COMMON else SOME
    wider = min(seen, max(largest, SOME))
    fine = fine._replace(spacing=wider * fine.spacing, spacing_read=wider != SOME)
    return Case(theory, series, fine, *allowance(theory, series, fine, THEORY_RTOL), tolerance)


ROUNDED = 1.64
"""Of the last digit's half: how far rounding takes a value from its neighbours, in the units of `gaps`."""


def _coarser(case: Case) -> float:
    """Return how much wider the spacing is than assumed, by the sawtooth of +-b in the normal force (F15).

    A sawtooth of which samples in step with the elements show little says nothing against as many as are
    assumed, nor does none.
    """
    force = "normal_force"
    gap, rows = gaps(case.series.time, case.series.columns[force] - case.now[force])
    b, digits = case.allowance.force[rows], case.allowance.rounding[force][rows]
    gap = np.maximum(gap - ROUNDED * digits, 0.0)
    usual, large = np.quantile(gap[b > 0.0] / b[b > 0.0], [0.5, OFTEN])
    usual, large = float(usual) / USUAL, float(large) / LARGE
    shown = float(np.median(digits)) <= FINEST * float(np.median(b))
    even = shown and FINEST <= EVEN * large <= usual
    return SOME * max(usual, large) if even else max(IN_STEP * large, SOME)


def common_noise(case: Case) -> float | None:
    """Return the squared correlation of the noise of both forces, if both are there.

    An element that enters at the leading edge adds to both; what a file or a sensor adds does not.
    """
    if not all(name in case.series.columns for name in ("normal_force", "friction_force")):
        return None
    parts = []
    for name in ("normal_force", "friction_force"):
        rough = np.diff(case.residual(name), 2)
        usual = LOUD * float(np.median(np.abs(rough)))
        parts.append(np.clip(rough, -usual, usual))
    norms = [float(np.linalg.norm(part)) for part in parts]
    if min(norms) == 0.0:
        return None
    return float((parts[0] @ parts[1]) / (norms[0] * norms[1])) ** 2


def rms(values: Array) -> float:
    """Return the root mean square of the finite values."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known * known))) if known.size else 0.0
