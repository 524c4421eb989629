"""A series beside theory, and what all checks have in common."""

import math
from dataclasses import dataclass

import numpy as np

from kvtheory.checks.allowances import Band, Resolution, allowance, resolution
from kvtheory.checks.noise import SURE, gaps
from kvtheory.checks.reading import Series
from kvtheory.checks.theory import CURVES, Array, Curves, Theory

THEORY_RTOL = 1e-7
"""Tolerance of the theory: its error is far below every allowance."""
SMALLEST = 1e-9
"""Of a scale: smaller differences are ignored."""
LARGEST_SAWTOOTH, COARSEST = 0.025, 0.1
"""Of the load: if half an element at the edge matters more, the contact is not resolved; if it would have to
matter more than the second, the data are wrong rather than coarse."""
MARGIN, IN_STEP = 1.4, 1.75
"""Factors by which the spacing may exceed the one assumed, or that of an even sawtooth; and that of an uneven
one, for samples that are nearly in step with the elements that enter see little of it."""
MEDIAN_GAP, LARGE_GAP, QUANTILE = 0.43, 1.08, 0.95
"""Of b: median and 95th percentile of the gaps of a sawtooth of +-b that is sampled at random."""
EVEN = 0.6
"""Of the ratio of both that is expected: below it, a part of the samples is in step."""
FINEST = 0.1
"""Of the spacing assumed: a smaller sawtooth is that of samples all in step, or of rounding if the digits are
as coarse."""
ROUNDED = 1.64
"""Of half the last digit: how far rounding takes a value from its neighbours, in the units of `gaps`."""
COMMON = 0.5
"""Squared correlation of the noise of both forces, from which on it is taken for the sawtooth of F15."""
LOUD = 4.0
"""Times the median: larger differences are jumps, and are clipped to this."""


class NotMade(Exception):  # noqa: N818
    """A check cannot be made, for the reason that its text gives."""


@dataclass(frozen=True)
class Case:
    """A series, theory at its times (`now`), and the allowed differences.

    `names` are the curves that count, and `edge_force` is the force b of half an element at an edge, in N/m.
    """

    theory: Theory
    series: Series
    names: tuple[str, ...]
    resolution: Resolution
    now: Curves
    bands: dict[str, Band]
    edge_force: Array
    tolerance: float

    @property
    def time(self) -> Array:
        """The times in s."""
        return self.series.time

    @property
    def columns(self) -> Curves:
        """The data, in SI."""
        return self.series.columns

    def residual(self, name: str) -> Array:
        """Return data less theory, relative to the scale of the curve."""
        return (self.columns[name] - self.now[name]) / self.theory.scales[name]

    def excess(self, name: str) -> Array:
        """Return how far the data lie outside the band of theory, relative to the scale."""
        values = self.bands[name].excess(self.columns[name])
        return np.asarray(np.nan_to_num(values) / self.theory.scales[name])

    def limit(self, name: str) -> Array:
        """Return how far a single value may lie outside the band, relative to the scale."""
        values = np.nan_to_num(self.bands[name].limit(), nan=0.0) / self.theory.scales[name]
        return np.asarray(self.tolerance * (values + SMALLEST))

    def allowed(self, name: str) -> Array:
        """Return the same in the unit of the curve."""
        return np.asarray(self.limit(name) * self.theory.scales[name])

    def rms_limit(self, name: str) -> float:
        """Return the largest root mean square of a curve that is allowed, relative to the scale."""
        band, scale = self.bands[name], self.theory.scales[name]
        random = rms(band.noise) / scale * (1.0 + SURE * math.sqrt(2.0 / self.time.size))
        return self.tolerance * (rms(band.systematic) / scale + random + SMALLEST)


def make_case(
    theory: Theory, series: Series, per_length: float | None, tolerance: float, coarsest: float
) -> Case:
    """Compare a series with theory.

    Where the element density is not known, and the noise is that of elements, it is estimated from that:
    up to a force of half an element of `coarsest`, relative to the load.
    """
    names = tuple(name for name in CURVES if name in series.columns)

    def of(fine: Resolution) -> Case:
        budget = allowance(theory, series, fine, THEORY_RTOL)
        return Case(theory, series, names, fine, *budget, tolerance)

    fine = resolution(theory, series, per_length)
    case = of(fine)
    if fine.spacing_known:
        return case
    largest = coarsest * theory.static.load / float(np.median(case.edge_force))
    seen = _coarser(case) if (common_noise(case) or 0.0) >= COMMON else MARGIN
    wider = min(seen, max(largest, MARGIN))
    return of(fine._replace(spacing=wider * fine.spacing, spacing_read=wider != MARGIN))


def _coarser(case: Case) -> float:
    """Return how much wider the spacing is than assumed, by the sawtooth of +-b in the normal force (F15).

    A sawtooth of which samples in step with the elements show little is no evidence against as many as are
    assumed, nor is the lack of one.
    """
    force = "normal_force"
    gap, rows = gaps(case.time, case.columns[force] - case.now[force])
    b, digits = case.edge_force[rows], case.bands[force].rounding[rows]
    gap = np.maximum(gap - ROUNDED * digits, 0.0)
    median, large = np.quantile(gap[b > 0.0] / b[b > 0.0], [0.5, QUANTILE])
    median, large = float(median) / MEDIAN_GAP, float(large) / LARGE_GAP
    shown = float(np.median(digits)) <= FINEST * float(np.median(b))
    even = shown and FINEST <= EVEN * large <= median
    return MARGIN * max(median, large) if even else max(IN_STEP * large, MARGIN)


def common_noise(case: Case) -> float | None:
    """Return the squared correlation of the noise of both forces, if both are there.

    An element that enters at the leading edge adds to both; what a file or a sensor adds does not.
    """
    if not {"normal_force", "friction_force"} <= set(case.columns):
        return None
    parts = []
    for name in ("normal_force", "friction_force"):
        rough = np.diff(case.residual(name), 2)
        loud = LOUD * float(np.median(np.abs(rough)))
        parts.append(np.clip(rough, -loud, loud))
    norms = [float(np.linalg.norm(part)) for part in parts]
    if min(norms) == 0.0:
        return None
    return float((parts[0] @ parts[1]) / (norms[0] * norms[1])) ** 2


def rms(values: Array) -> float:
    """Return the root mean square of the finite values."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known * known))) if known.size else 0.0
