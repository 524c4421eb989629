"""The rungs of the cycle in which a motion on a spring ends: continuum, elements."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from kvtheory.ladder.climbing import Answer, Offer, Request, Rung, need
from kvtheory.ladder.series import LOOSEST, TIGHTEST, Models, refined
from kvtheory.models.continuum.error_estimate import MARGIN
from kvtheory.models.steady.stable_sliding import lasts, rates_of
from kvtheory.results import Certificate
from kvtheory.results.cycles import cycle_statement
from kvtheory.scene.capabilities import lacks_arms, lacks_continuum
from kvtheory.scene.model import Scene

STEP = 1e-2
"""Tolerance of a step of the continuum over that of the cycle."""
LEAST = 0.1
"""Share to which a ripple has to approach its cycle, at most."""
GAINS = 0.7
"""Share to which a finer run must reduce the error: else it is that of the limit, for a longer run."""
STEADY = "The motion ends in steady sliding: there is no stick-slip."
EITHER = (
    "Steady sliding is stable as well, against small disturbances: from a gentle start the motion may end "
    "there."
)
UNSURE = (
    "runs with fewer elements end otherwise, as happens near the onset of instability; choose a velocity or "
    "stiffness farther from it"
)
UNSETTLED = (
    "the run shows neither a cycle, in four equal or eight similar periods, nor steady sliding; choose a "
    "longer run.duration"
)


def rungs(models: Models) -> tuple[Rung, ...]:
    """Return the rungs in order of cost."""
    table = ("continuum", "a parabola", _continuum), ("elements", "none", _elements)
    return tuple(Rung(name, assumed, partial(judge, models)) for name, assumed, judge in table)


def _continuum(models: Models, scene: Scene, request: Request) -> Offer:
    need(lacks_continuum(scene))
    step = min(max(STEP * request.rtol, TIGHTEST), LOOSEST)
    end = [scene.run.duration]
    return Offer(
        math.nan,
        lambda: _answer(scene, models.transient(scene, at=end, rtol=step), request, MARGIN),
    )


def _elements(models: Models, scene: Scene, request: Request) -> Offer:
    """Refine; where the run approaches a cycle too slowly, find that from short runs on both sides of it."""
    need(lacks_arms(scene))

    def run() -> Answer:
        # They are slow to import.
        from kvtheory.models.elements.limit_cycle import limit_cycle
        from kvtheory.models.elements.model import Model
        from kvtheory.models.elements.simulation import SAFETY

        length, rates = 2.0 * Model.of(scene).at_rest.half_length, rates_of(scene)

        def solved(count: float, finer: float) -> tuple[Answer, float]:
            result = models.elements(scene, per_length=count / length, at=[scene.run.duration])
            if result.ripples and not result.cycle.settles:
                result = replace(result, cycle=limit_cycle(scene, result, rates))
            return _answer(scene, result, request, SAFETY), result.element_updates

        answer = refined(scene, request, solved, gains=GAINS)
        errors = answer.certificate.relative_error
        need(UNSURE if max(errors[name] for name in request.quantities) == math.inf else "")
        return answer

    return Offer(math.nan, run)


def _wait(scene: Scene, rtol: float) -> Iterator[str]:
    """Tell how long small ripples take, to say that a longer run may be long indeed."""
    rates = rates_of(scene)
    if rates is not None and (turning := rates[rates[:, 1] > 0.0]).size:
        rate = float(turning[:, 0].max())
        wait = -math.log(min(rtol, LEAST)) / abs(rate) if rate else math.inf
        yield f"Small ripples change at {rate:.3g} 1/s, and the run would have to last about {wait:.3g} s."


def _answer(scene: Scene, result: Any, request: Request, safety: float) -> Answer:
    """Return the requested quantities of the cycle of a motion, or raise ValueError if it shows none."""
    found = result.cycle
    if not found.settles:
        raise ValueError(". ".join([UNSETTLED, *result.notes, *_wait(scene, request.rtol)]))
    errors = {name: found.relative_errors[name] for name in request.quantities}
    certificate = Certificate("estimated", cycle_statement(safety), errors, "the cycle itself")
    if found.amplitude == 0.0:
        result = replace(result, notes=(STEADY,))
    elif lasts(scene):
        result = replace(result, notes=(*result.notes, EITHER))
    return Answer(
        {name: found.quantities[name] for name in request.quantities}, certificate, result
    )
