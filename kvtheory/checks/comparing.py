"""Reading, theory, checks and diagnosis put together."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from kvtheory.checks.checklist import judge
from kvtheory.checks.comparison_case import COARSEST, LARGEST_SAWTOOTH, make_case
from kvtheory.checks.diagnosis import diagnose, verdict
from kvtheory.checks.discretization import COARSE
from kvtheory.checks.reading import Series
from kvtheory.checks.theory import Methods, Theory
from kvtheory.results import TRANSIENT_UNITS
from kvtheory.results.comparison import Check, Comparison, Explanation
from kvtheory.scene.model import Scene

MOST_NAMED = 20
"""Unused columns that are named in the diagnosis."""


@np.errstate(over="ignore", invalid="ignore")  # data that diverge overflow when squared
def compare(
    scene: Scene,
    series: Series,
    methods: Methods,
    per_length: float | None,
    scheme: str | None,
    tolerance: float,
) -> Comparison:
    """Compare a series with theory; `kvtheory.compare` documents it."""
    theory, series = Theory(scene, methods), replace(series, scheme=scheme or series.scheme)
    try:
        case = make_case(theory, series, per_length, tolerance, COARSEST)
    except ArithmeticError as error:
        raise ArithmeticError(
            f"{series.source}: the theory cannot be computed up to t = {series.time[-1]:.6g} s, where the "
            f"data end ({error}); is the unit of the time right?"
        ) from None
    checks = judge(case)
    others = {check.name for check in checks if check.ok is False} - {COARSE}
    if others and case.resolution.spacing_read:  # a large noise is then not that of elements alone
        case = make_case(theory, series, per_length, tolerance, LARGEST_SAWTOOTH)
        checks = judge(case)
    text, explanations = diagnose(case, checks)
    if series.ignored:
        several = series.ignored[:MOST_NAMED]
        more = f" and {len(series.ignored) - len(several)} more" * (several != series.ignored)
        text += f" Columns that were not used: {', '.join(several)}{more}."
    allowed = {name: case.limit(name) * case.theory.scales[name] for name in case.names}
    return Comparison(
        verdict(checks), checks, text, explanations, series.source, tolerance,
        dict(series.columns), dict(case.now), allowed, theory.units,
    )  # fmt: skip


def broken_off(
    scene: Scene,
    rows: Sequence[Sequence[float]],
    reason: str,
    methods: Methods,
    scheme: str | None,
    tolerance: float,
) -> Comparison:
    """Return the verdict on a simulation that diverged, which is not compared with theory.

    `rows` are its results until then, in the order of `TRANSIENT_UNITS`.
    """
    series = dict(zip(TRANSIENT_UNITS, np.array(rows).T, strict=True))
    judge_of = Theory(scene, methods)
    theory = dict(judge_of.at(series["time"]))
    missing = 1.0 - float(series["time"][-1]) / scene.run.duration
    unit = "part of the duration that is missing"
    check = Check("run to the end", missing, 0.0, False, "F15", unit)
    name = "unstable time step"
    fault = Explanation(name, f"the time step is unstable (F15): {reason}", 1.0, True)
    text = f"{fault.text[0].upper()}{fault.text[1:]}. Failed: {check.name} (F15)."
    allowed = {name: np.zeros_like(theory[name]) for name in series if name in theory}
    return Comparison(
        "disagrees", (check,), text, (fault,), scheme or "our own simulation", tolerance,
        series, theory, allowed, judge_of.units,
    )  # fmt: skip
