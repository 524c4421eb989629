"""The rungs of the cycle in which a motion on a spring ends: continuum, elements."""

import math
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

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
    "runs with fewer elements, or another tolerance, end otherwise, as happens near the onset of "
    "instability; choose a velocity or stiffness farther from it"
)
UNSETTLED = (
    "the run shows neither a cycle, in four equal or eight similar periods, nor steady sliding; choose a "
    "longer run.duration"
)


def rungs(models: Models) -> tuple[Rung, ...]:
    """Return the rungs in order of cost."""
    return (
        Rung("continuum", "a parabola", partial(_continuum, models)),
        Rung("elements", "none", partial(_elements, models)),
    )


def _continuum(models: Models, scene: Scene, request: Request) -> Offer:
    need(lacks_continuum(scene))
    step = min(max(STEP * request.rtol, TIGHTEST), LOOSEST)

    def run() -> Answer:
        result = models.transient(scene, at=[scene.run.duration], rtol=step)
        return _known(scene, request, _answer(scene, result, request, MARGIN))

    return Offer(math.nan, run)


def _elements(models: Models, scene: Scene, request: Request) -> Offer:
    """Refine; where the run approaches a cycle too slowly, find that from short runs on both sides of it."""
    need(lacks_arms(scene))

    def run() -> Answer:
        # They are slow to import.
        from kvtheory.models.elements.limit_cycle import MOST_RUNS, limit_cycle
        from kvtheory.models.elements.model import Model
        from kvtheory.models.elements.simulation import SAFETY

        length, rates = 2.0 * Model.of(scene).at_rest.half_length, rates_of(scene)
        near = math.nan

        def solved(count: float, finer: float) -> tuple[Answer, float]:
            nonlocal near
            result: Any = models.elements(scene, per_length=count / length, at=[scene.run.duration])
            work = result.element_updates
            if not result.cycle.settles:
                if not (result.ripples and scene.drive.ends):
                    raise ValueError(_unsettled(scene, request, result))
                found = limit_cycle(scene, result, rates, near, models.progress)
                result, work = replace(result, cycle=found), work * MOST_RUNS
                near = found.amplitude or math.nan
            return _answer(scene, result, request, SAFETY), work

        return _known(scene, request, refined(scene, request, solved, gains=GAINS))

    return Offer(math.nan, run)


def _answer(scene: Scene, result: Any, request: Request, safety: float) -> Answer:
    """Return the requested quantities of the cycle of a motion; if it shows none, with infinite errors."""
    found, known = result.cycle, result.cycle.relative_errors
    errors = {name: known[name] if found.settles else math.inf for name in request.quantities}
    certificate = Certificate("estimated", cycle_statement(safety), errors, "the cycle itself")
    if found.amplitude == 0.0:
        result = replace(result, notes=(STEADY,))
    elif found.settles and lasts(scene):
        result = replace(result, notes=(*result.notes, EITHER))
    return Answer(
        {name: found.quantities[name] for name in request.quantities}, certificate, result
    )


def _known(scene: Scene, request: Request, answer: Answer) -> Answer:
    """Return the answer, or raise ValueError if it is not known how the motion ends."""
    if math.inf in answer.certificate.relative_error.values():
        raise ValueError(_unsettled(scene, request, answer.result))
    return answer


def _unsettled(scene: Scene, request: Request, result: Any) -> str:
    """Return why it is not known how a motion ends, and how long small ripples take."""
    rates = rates_of(scene)
    reasons = [UNSURE] if result.cycle.settles else [UNSETTLED, *result.notes]
    turning = rates[rates[:, 1] > 0.0] if rates is not None else np.zeros((0, 2))
    if turning.any():
        rate = float(turning[:, 0].max())
        wait = -math.log(min(request.rtol, LEAST)) / abs(rate)
        reasons.append(
            f"Small ripples change at {rate:.3g} 1/s, and the run would have to last about {wait:.3g} s"
        )
    return ". ".join(each.rstrip(".") for each in reasons)
