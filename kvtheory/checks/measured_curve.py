"""A measured curve, friction over velocity, compared with steady sliding and judged by its own scatter.

It is a case whose "time" is the velocity, so that faults are tried as for a time series.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property, partial
from itertools import product
from typing import Any

import numpy as np

from kvtheory.checks import comparing
from kvtheory.checks.allowances import Band, Resolution
from kvtheory.checks.checklist import (
    RELATIVE,
    Measured,
    Row,
    column_means,
    judge,
    largest,
    root_mean_square,
    worst_mean,
)
from kvtheory.checks.comparison_case import Case, rms
from kvtheory.checks.contact_rules import mistakes
from kvtheory.checks.detectable import detectable
from kvtheory.checks.noise import noise, rounded
from kvtheory.checks.theory import CURVES, Array, Theory
from kvtheory.checks.trial_elements import steady_changes
from kvtheory.fitting.series import Series
from kvtheory.results.comparison import Comparison

NAMES = ("friction_coefficient", "friction_force", "normal_force", "depth", "leading_edge", "trailing_edge",
         "peak_pressure")  # fmt: skip
"""The columns that are compared."""
SMOOTH = 1e-3
"""Relative error allowed beside the scatter: no experiment is better, and few simulations are."""
LARGEST_SCATTER = 0.2
"""Scatter, relative to the curve, beyond which the points cannot test it."""
FAMILIES = [
    (words, partial(mistakes, changes=steady_changes) if family is mistakes else family)
    for words, family in comparing.FAMILIES if words not in comparing.OF_TIME
]  # fmt: skip
"""The faults that are tried for steady sliding."""
STEADY_ONLY = (
    " Steady sliding tests neither the inertia nor the memory of the free surface: the problems "
    "heavy-mass and reversal do."
)


class SteadyTheory(Theory):
    """Steady sliding of a scene at given velocities."""

    @cached_property
    def scales(self) -> Any:
        """The scales of differences: the static state, and its products."""
        static = self.static
        return {**super().scales, "friction_coefficient": static.depth / static.half_length}

    def at(self, times: Array, rtol: float = 1e-6) -> dict[str, Array]:
        """Return the curves at velocities, which stand in the place of the times."""
        state = self.methods.steady(self.scene.at(times))
        moving = {name: np.zeros_like(times) for name in CURVES}
        known = {name: getattr(state, name, None) for name in NAMES} | {"normal_force": state.load}
        sizes = {n: np.broadcast_to(x, times.shape) for n, x in known.items() if x is not None}
        return {**moving, "velocity": times, "sliding_velocity": times, **sizes}


def compare(theory: Theory, series: Series, tolerance: float) -> Comparison:
    """Compare a curve over the velocity with steady sliding; `kvtheory.compare` documents it."""
    steady = SteadyTheory(theory.scene, theory.methods)
    now = steady.at(series.time)
    names = tuple(name for name in NAMES if name in series.columns and name in now)
    order, bands, zero = np.arange(series.time.size, dtype=float), {}, np.zeros_like(series.time)
    for name in now:
        digits = sigma = zero
        if name in names:
            values = series.columns[name]
            digits, sigma = rounded(values), _scatter(order, values, now[name])
        smooth = SMOOTH * np.abs(now[name]) + digits
        bands[name] = Band(now[name], now[name], smooth, sigma, digits)
    case = Case(
        steady, series, names, Resolution(1.0, 1.0, True, True), now, bands, zero, tolerance
    )
    checks = tuple(
        replace(check, note=check.note.replace(" ms", " mm/s"))  # the "time" is the velocity
        for check in judge(case, _rows(case))
    )
    text, explanations = comparing.diagnose(case, checks, FAMILIES)
    known = comparing.verdict(checks)
    limits, shown = ({}, "") if known == "disagrees" else detectable(case)
    text += (STEADY_ONLY if known == "agrees" else "") + shown
    columns = {"velocity": series.time, **{name: series.columns[name] for name in names}}
    return Comparison(
        known, checks, text + comparing.unused(series), explanations, series.source,
        tolerance, columns, now, {name: case.allowed(name) for name in names},
        {**steady.units, "friction_coefficient": "1"}, limits,
    )  # fmt: skip


def _scatter(order: Array, values: Array, curve: Array) -> Array:
    """Return sigma without what is smooth: a wrong curve may be theory times a factor, or flat."""
    square = float(curve @ curve)
    factors = 1.0, float(values @ curve) / square if square else 0.0, 0.0
    found = [noise(order, values - factor * curve, curve) for factor in factors]
    return min(found, key=rms)


def _rows(case: Case) -> Iterator[Row]:
    """Yield the scatter, and for each column the largest difference, the root mean square and the mean."""
    equation = "F17" if case.theory.scene.foundation.arms else "F1"
    unit = "root mean square, relative to the curve"
    yield Row(comparing.SCATTER, "F1", unit, _loudest)
    kinds = {"largest": largest, "RMS": root_mean_square, "mean difference": _mean}
    for name, (kind, measure) in product(case.names, kinds.items()):
        title = f"{name.replace('_', ' ')}, {kind}"
        yield Row(title, equation, RELATIVE, partial(measure, name=name))


def _loudest(case: Case) -> tuple[float, float, str]:
    """Compare the scatter of the noisiest column with what still tests a curve."""
    loud = max(rms(case.bands[name].noise) / rms(case.now[name]) for name in case.names)
    return loud, case.tolerance * LARGEST_SCATTER, ""


def _mean(case: Case, name: str) -> Measured:
    """Compare the mean of a column."""
    return worst_mean(case, lambda case: [m for m in column_means(case) if name in m.weights])
