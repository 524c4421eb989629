"""The climb: rungs from cheap to general, until one is known to be enough."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, NamedTuple

from kvtheory.results import STEADY_UNITS, Certificate, ClimbStep, Solution, units_for
from kvtheory.results.certificate import Value
from kvtheory.results.errors import ToleranceError
from kvtheory.scene.model import Scene


@dataclass(frozen=True)
class Request:
    """What is asked of a scene.

    `quantities` must be within `rtol`; `times` (s) are those of a series, None for its own times;
    `units` has all quantities that the answer holds, those of a series or of steady sliding.
    """

    quantities: tuple[str, ...]
    rtol: float
    times: Sequence[float] | None = None
    units: Mapping[str, str] = field(default_factory=lambda: STEADY_UNITS)


class Judgement(NamedTuple):
    """What is known of a model before it runs.

    `reason` is not empty where it does not apply; `error` is a bound or an estimate of its error, NaN
    where only running it tells; `known` is handed on to the run.
    """

    reason: str = ""
    error: float = math.nan
    known: Any = None


class Answer(NamedTuple):
    """What a model found, with an error for each of the quantities that were asked for."""

    values: Mapping[str, Value]
    certificate: Certificate
    result: Any = None


@dataclass(frozen=True)
class Rung:
    """One model: what it assumes, how that is judged, and how it runs.

    `judge` costs little, whatever the scene; `solve` may raise ValueError or ArithmeticError where an
    assumption turns out wrong on the way.
    """

    name: str
    assumed: str
    judge: Callable[[Scene, Request], Judgement]
    solve: Callable[[Scene, Request, Any], Answer]


TOO_LARGE = "error too large"
USED = "used"


def climb(scene: Scene, request: Request, rungs: Sequence[Rung]) -> Solution:
    """Return the answer of the first rung that is known to be within the tolerance.

    Raises
    ------
    ToleranceError
        If none is.
    """
    steps: list[ClimbStep] = []
    for rung in rungs:
        step, answer = _try(rung, scene, request)
        steps.append(step)
        if answer is not None:
            return Solution(
                values=answer.values, rtol=request.rtol, model=rung.name,
                certificate=answer.certificate, climb=tuple(steps), answer=answer.result,
                units=units_for(scene.indenter, request.units),
            )  # fmt: skip
    raise ToleranceError(_failure(request, steps))


def _try(rung: Rung, scene: Scene, request: Request) -> tuple[ClimbStep, Answer | None]:
    """Judge a model and, if it may be enough, run it; give its answer only if it is enough."""

    def step(outcome: str, error: float, solving: float = 0.0) -> ClimbStep:
        margin = math.inf if error == 0.0 else request.rtol / error
        return ClimbStep(
            rung.name, rung.assumed, outcome, error, margin, judged_at - begun, solving
        )

    begun = perf_counter()
    try:
        judged = rung.judge(scene, request)
    except (ValueError, ArithmeticError) as failed:
        judged = Judgement(str(failed))
    judged_at = perf_counter()
    if judged.reason:
        return step(judged.reason, judged.error), None
    if judged.error > request.rtol:
        return step(TOO_LARGE, judged.error), None
    try:
        answer = rung.solve(scene, request, judged.known)
    except (ValueError, ArithmeticError) as failed:
        return step(str(failed), math.nan, perf_counter() - judged_at), None
    solving = perf_counter() - judged_at
    error = max(answer.certificate.relative_error[name] for name in request.quantities)
    if error <= request.rtol:  # never with a NaN
        return step(USED, error, solving), answer
    return step(TOO_LARGE, error, solving), None


def _failure(request: Request, steps: Sequence[ClimbStep]) -> str:
    reached = [step.error for step in steps if step.outcome == TOO_LARGE and step.error < math.inf]
    hint = f"; try a tolerance from {min(reached):.1e}" if reached else ""
    reasons: dict[str, list[str]] = {}  # each once, with the models that it holds for
    for step in steps:
        known = step.outcome == TOO_LARGE and step.error < math.inf
        reached_by = f" ({step.error:.1e})" if known else ""
        models = reasons.setdefault(step.outcome + reached_by, [])
        if step.rung not in models:
            models.append(step.rung)
    tried = "; ".join(f"{', '.join(models)}: {reason}" for reason, models in reasons.items())
    return f"no model is known to be within rtol = {request.rtol:g}{hint}; {tried}"
