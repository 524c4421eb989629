"""The spacing of the elements and the time step behind a series, known or assumed."""

from typing import NamedTuple

import numpy as np

from kvtheory.checks.reading import Series
from kvtheory.checks.theory import Theory
from kvtheory.results.schemes import SCHEME_ROWS

STANDARD = 200e3
FEWEST_ASSUMED, MOST_ASSUMED = 200.0, 490.0
"""Elements per m where the density is not known: the paper's 200 /mm, but so many in the static half
length at least, and at most as many as in Table 1."""
UNKNOWN_STEP = 0.25
"""Of the fast time constant: the most that an unknown time step is taken for, unless the data are
sampled more coarsely than that."""
MOST_STEPS = 1000.0
"""Steps assumed for a base that never moves."""
SHORTEST_RUN = 20.0
"""Steps that a run must at least have, so that an assumed step does not smear all of it."""


class Resolution(NamedTuple):
    """Spacing of the elements (m) and time step (s), and whether they are known or assumed.

    `spacing_read` says that the spacing was read from the sawtooth of the data.
    """

    spacing: float
    time_step: float
    spacing_known: bool
    step_known: bool
    spacing_read: bool = False


def resolution(theory: Theory, series: Series, per_length: float | None) -> Resolution:
    """Return the spacing and the step, known or else those of the paper for this scene."""
    given = per_length or series.per_length
    half, scheme = theory.static.half_length, SCHEME_ROWS.get(series.scheme or "")
    spacing = 1.0 / (given or min(max(STANDARD, FEWEST_ASSUMED / half), MOST_ASSUMED / half))
    speed, span = theory.motion.highest_speed, float(series.time[-1] - series.time[0])
    step = 2.0 * spacing / speed if speed else span / MOST_STEPS
    if series.time_step is not None:
        return Resolution(spacing, float(series.time_step), bool(given), True)
    paper = scheme is not None and scheme.papers_step and bool(given)
    if not paper and theory.rates is not None:
        sampled = float(np.median(np.diff(series.time)))
        step = min(step, max(UNKNOWN_STEP * abs(theory.rates.fast), sampled))
    return Resolution(spacing, min(step, span / SHORTEST_RUN), bool(given), paper)
