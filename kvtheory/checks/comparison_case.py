"""A series beside theory: all that the checks and the diagnosis look at."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from kvtheory.checks.allowances import Allowance, Resolution, allowance, extreme, resolution
from kvtheory.checks.reading import Series
from kvtheory.checks.theory import CURVES, Theory

Array = NDArray[np.float64]

THEORY_RTOL = 1e-7
"""Tolerance of the theory: its error is far below every allowance."""
SMALLEST = 1e-9
"""Of a scale: below this, theory and data are not told apart."""


LARGEST_SAWTOOTH = 0.025
"""Of the load: elements so coarse that half of one at the edge matters more do not resolve the contact."""
IN_STEP = 1.4
"""Where the density is not known, elements may be so much fewer than assumed, or than their noise shows:
samples that are nearly in step with the elements that enter see little of the sawtooth."""
COMMON = 0.5
"""Correlation of the noise of both forces, squared, from which on it is taken for the sawtooth of F15."""
LOUD = 4.0
"""Times the median: larger differences are jumps, which count as much as this."""


@dataclass(frozen=True)
class Case:
    """A series, theory at its times, and what is allowed between them."""

    theory: Theory
    series: Series
    resolution: Resolution
    now: Mapping[str, Array]
    allowance: Allowance
    tolerance: float

    @property
    def names(self) -> tuple[str, ...]:
        """The curves that the series holds."""
        return tuple(name for name in CURVES if name in self.series.columns)

    def residual(self, name: str) -> Array:
        """Return data less theory, relative to the scale of the curve."""
        return (self.series.columns[name] - self.now[name]) / self.theory.scales[name]

    def excess(self, name: str) -> Array:
        """Return how far the data lie outside the band of theory, relative to the scale."""
        values = self.allowance.excess(name, self.series.columns[name])
        return np.asarray(np.nan_to_num(values) / self.theory.scales[name])

    def most(self, name: str) -> Array:
        """Return what one value may lie outside, relative to the scale."""
        scale = self.theory.scales[name]
        values = np.nan_to_num(self.allowance.most(name), nan=0.0) / scale
        return np.asarray(self.tolerance * (values + SMALLEST))

    @cached_property
    def together(self) -> Mapping[str, float]:
        """What the root mean square of each curve may be, relative to the scale."""
        found = {}
        for name in self.names:
            smooth = np.nan_to_num(self.allowance.systematic[name]) / self.theory.scales[name]
            sigma = self.allowance.noise[name] / self.theory.scales[name]
            count = max(smooth.size, 1)
            random = sigma * (1.0 + extreme(count) / np.sqrt(2.0 * count))
            found[name] = self.tolerance * (float(np.sqrt(np.mean(smooth**2))) + random + SMALLEST)
        return found


def make_case(theory: Theory, series: Series, per_length: float | None, tolerance: float) -> Case:
    """Hold a series against theory.

    Where the element density is not known, and the noise is that of elements, it is estimated from that.
    """
    fine = resolution(theory, series, per_length)
    now, allowed = allowance(theory, series, fine, THEORY_RTOL)
    case = Case(theory, series, fine, now, allowed, tolerance)
    if fine.spacing_known:
        return case
    load, b = theory.static.load, float(np.median(allowed.force))
    # A sawtooth of +-b has sigma = b/sqrt(3).
    common = (common_noise(case) or 0.0) >= COMMON
    seen = math.sqrt(3.0) * allowed.noise["normal_force"] if common else 0.0
    wider = min(IN_STEP * max(seen, b), LARGEST_SAWTOOTH * load) / b if b else 0.0
    if wider <= 1.0:
        return case
    fine = replace(fine, spacing=wider * fine.spacing)
    now, allowed = allowance(theory, series, fine, THEORY_RTOL)
    return Case(theory, series, fine, now, allowed, tolerance)


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
    """Return the root mean square of what exists."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known * known))) if known.size else 0.0
