"""Reading, theory, checks and diagnosis put together."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from kvtheory.checks.case import make_case
from kvtheory.checks.diagnosis import diagnose
from kvtheory.checks.judgements import judge
from kvtheory.checks.reading import Series
from kvtheory.checks.theory import Theory
from kvtheory.results.comparison import Comparison
from kvtheory.scene.model import Scene


def compare(
    scene: Scene,
    series: Series,
    transient: Callable[..., Any],
    steady: Callable[..., Any],
    per_length: float | None,
    scheme: str | None,
    tolerance: float,
) -> Comparison:
    """Hold a series against theory; `kvtheory.compare` documents it."""
    series = replace(series, scheme=scheme or series.scheme)
    with np.errstate(over="ignore", invalid="ignore"):  # data that diverge overflow when squared
        return _compare(Theory(scene, transient, steady), series, per_length, tolerance)


def _compare(
    theory: Theory, series: Series, per_length: float | None, tolerance: float
) -> Comparison:
    case = make_case(theory, series, per_length, tolerance)
    checks = judge(case)
    wrong = [check for check in checks if check.ok is False]
    text, explanations = diagnose(case, checks)
    allowed = {name: case.most(name) * case.theory.scales[name] for name in case.names}
    return Comparison(
        "disagrees" if wrong else "agrees", checks, text, explanations, series.source, tolerance,
        dict(series.columns), dict(case.now), allowed,
    )  # fmt: skip
