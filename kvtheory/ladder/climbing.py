"""The climb: models from cheap to general, until one is known to meet the tolerance.

The rungs of steady sliding are here: asymptote, exact, quadrature.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from time import perf_counter
from typing import Any, NamedTuple

from kvtheory.models.steady import asymptote_bounds
from kvtheory.results import STEADY_UNITS, Certificate, ClimbStep, Solution, SteadyState, units_for
from kvtheory.results.errors import ToleranceError, Value
from kvtheory.scene.capabilities import (
    lacks_asymptotes,
    lacks_body,
    lacks_closed_form,
    lacks_kelvin_voigt,
    lacks_quadratic,
    lacks_quadrature,
)
from kvtheory.scene.model import Scene

TOO_LARGE, USED = "error too large", "used"
"""Outcomes of a rung; any other is the reason why it does not apply."""
LOOSEST = 1.0
"""Largest tolerance of a request."""


@dataclass(frozen=True)
class Request:
    """Quantities to be within `rtol`, times (s) of a series or None, and units of all of the answer."""

    quantities: tuple[str, ...]
    rtol: float
    times: Sequence[float] | None = None
    units: Mapping[str, str] = field(default_factory=lambda: STEADY_UNITS)


class Answer(NamedTuple):
    """The values of a model, with an error for each of the requested quantities."""

    values: Mapping[str, Value]
    certificate: Certificate
    result: Any = None


class Offer(NamedTuple):
    """What a model offers: a bound or an estimate of its error (NaN if unknown), and a run that may raise."""

    error: float
    run: Callable[[], Answer]


@dataclass(frozen=True)
class Rung:
    """A model: name, assumptions, and a cheap offer for a scene and a request, or a reason against."""

    name: str
    assumed: str
    judge: Callable[[Scene, Request], Offer]


def need(*reasons: str) -> None:
    """Raise ValueError with the first reason that is not empty."""
    for reason in filter(None, reasons):
        raise ValueError(reason)


def climb(scene: Scene, request: Request, rungs: Sequence[Rung]) -> Solution:
    """Return the answer of the first rung known to be within the tolerance, or raise `ToleranceError`."""
    steps: list[ClimbStep] = []
    for rung in rungs:
        begun = judged = perf_counter()
        answer, error, outcome = None, math.nan, TOO_LARGE
        try:
            error, run = rung.judge(scene, request)
            judged = perf_counter()
            if not error > request.rtol:  # it may be NaN
                error = math.nan
                answer = run()
                errors = answer.certificate.relative_error
                error = max(errors[name] for name in request.quantities)
                outcome = USED if error <= request.rtol else TOO_LARGE
        except (ValueError, ArithmeticError) as failed:
            outcome = str(failed)
            judged = judged if judged > begun else perf_counter()
        margin = math.inf if error == 0.0 else request.rtol / error
        times = judged - begun, perf_counter() - judged
        steps.append(ClimbStep(rung.name, rung.assumed, outcome, error, margin, *times))
        if answer is not None and outcome == USED:
            return Solution(
                values=answer.values, rtol=request.rtol, model=rung.name,
                certificate=answer.certificate, climb=tuple(steps), answer=answer.result,
                units=units_for(scene.indenter, request.units),
                notes=getattr(answer.result, "notes", ()),
            )  # fmt: skip
    raise ToleranceError(_failure(request, steps))


def _failure(request: Request, steps: Sequence[ClimbStep]) -> str:
    """State the error that each model reached, and each reason once, with its models."""
    reached, reasons = [], dict[str, list[str]]()
    for step in steps:
        reason = step.outcome
        if reason == TOO_LARGE and step.error < math.inf:
            reached.append(step.error)
            reason += f" ({step.error:.1e})"
        models = reasons.setdefault(reason, [])
        if step.rung not in models:
            models.append(step.rung)
    best = min(reached, default=math.inf)
    hint = f"; try a tolerance from {best:.1e}" if best <= LOOSEST else ""
    tried = "; ".join(f"{', '.join(models)}: {reason}" for reason, models in reasons.items())
    return f"no model is known to be within rtol = {request.rtol:g}{hint}; {tried}"


Steady = Callable[..., SteadyState]
"""`kvtheory.steady`."""

BEST = {
    "exact": 1.9e-15, "exact, power law": 8.0e-15, "exact, any foundation": 5.3e-15,
    "quadrature": 1e-14, "convolution": 2e-13,
}  # fmt: skip
"""Smallest certified error of each method; none is run for a smaller tolerance."""

CLOSED = "steady sliding of a parabola, power law, wedge or ball"
PROVED = (
    "asymptotes against the closed forms at both ends of proved bounds of the steady half length, between "
    "which these are monotonic, or a product of such (derivations scaled-load, error-L1, F19-balance, "
    "F19-monotonic, F20-balance, F20-error-L1), relative to the truth"
)


def rungs(steady: Steady) -> tuple[Rung, ...]:
    """Return the rungs in order of cost; `steady` runs the last two."""
    exact, quadrature = (partial(_steady, steady, name) for name in ("exact", "quadrature"))
    return (
        Rung("asymptote", f"{CLOSED}, V far from V*", _asymptote),
        Rung("exact", CLOSED, exact),
        Rung("quadrature", "steady sliding of any shape", quadrature),
    )


def beside_layer(
    rungs: Sequence[Rung], error: Mapping[str, float], steady: Steady
) -> tuple[Rung, ...]:
    """Return rungs for a scene by a layer: those of its foundation, and then the layer itself.

    `error` is that of the foundation, by quantity; others are not known on the layer.
    """

    def judge(rung: Rung, scene: Scene, request: Request) -> Offer:
        known = {name: error.get(name, math.inf) for name in request.quantities}
        name = max(known, key=known.__getitem__)
        far = f"within {known[name]:.2g}" if known[name] < math.inf else "not known how far off"
        reason = f"{name} on independent elements is {far}, against the layer"
        need(reason if known[name] > request.rtol else "")
        offer = rung.judge(scene, request)
        return Offer(offer.error + known[name], lambda: _added(offer.run(), known))

    own = [
        replace(
            rung, assumed=f"{rung.assumed}, of independent elements", judge=partial(judge, rung)
        )
        for rung in rungs
    ]
    return *own, Rung("layer", "steady sliding on the layer itself", partial(_on_layer, steady))


def _added(answer: Answer, error: Mapping[str, float]) -> Answer:
    """Return the answer of a foundation with the error of the model added to its own."""
    own = answer.certificate
    errors = {name: value + error[name] for name, value in own.relative_error.items()}
    statement = f"{own.statement}; and the error of independent elements against the layer"
    certificate = replace(own, kind="estimated", statement=statement, relative_error=errors)
    return answer._replace(certificate=certificate)


def _on_layer(steady: Steady, scene: Scene, request: Request) -> Offer:
    from kvtheory.layer.answer import SMALLEST, WITH_ERROR

    need(lacks_body(scene))
    unknown = [name for name in request.quantities if name not in WITH_ERROR]
    need(f"{unknown[0]} on the layer is not known" if unknown else "")
    within = partial(steady, rtol=request.rtol, names=request.quantities)
    return Offer(SMALLEST[scene.indenter.per_width], partial(_run, within, "layer", scene, request))


def _asymptote(scene: Scene, request: Request) -> Offer:
    need(lacks_asymptotes(scene))
    bounds, names = asymptote_bounds.enclosure_of(scene), request.quantities
    regime, error = asymptote_bounds.choose(bounds, names, request.rtol)

    def run() -> Answer:
        values = asymptote_bounds.values(scene, regime, names)
        return Answer(values, Certificate("proved", PROVED, dict.fromkeys(names, error)))

    return Offer(error, run)


def _steady(steady: Steady, method: str, scene: Scene, request: Request) -> Offer:
    """Offer a method of `steady`."""
    need((lacks_closed_form if method == "exact" else lacks_quadrature)(scene))
    known = method
    if lacks_kelvin_voigt(scene):
        known = "exact, any foundation" if method == "exact" else "convolution"
    elif method == "exact" and lacks_quadratic(scene):
        known = "exact, power law"

    return Offer(BEST[known], partial(_run, steady, method, scene, request))


def _run(steady: Steady, method: str, scene: Scene, request: Request) -> Answer:
    state, names = steady(scene, method=method), request.quantities
    errors = {name: state.certificate.relative_error[name] for name in names}
    own = replace(state.certificate, relative_error=errors)
    return Answer({name: getattr(state, name) for name in names}, own, state)
