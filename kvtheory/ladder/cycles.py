"""The rungs of the cycle in which a motion on a spring ends: continuum, elements."""

import math
from dataclasses import replace
from functools import partial
from typing import Any

from kvtheory.ladder.climbing import Answer, Offer, Request, Rung, need
from kvtheory.ladder.series import (
    DIMENSIONS,
    LEAST_FINER,
    LOOSEST,
    MOST_FINER,
    MOST_UPDATES,
    SPARE,
    TIGHTEST,
    Models,
)
from kvtheory.models.continuum.error_estimate import MARGIN
from kvtheory.models.steady.stable_sliding import ended
from kvtheory.results import Certificate
from kvtheory.results.cycles import cycle_statement
from kvtheory.scene.capabilities import lacks_arms, lacks_continuum
from kvtheory.scene.model import Scene

STEP = 1e-2
"""Tolerance of a step of the continuum over that of the cycle."""
ELEMENTS = 120.0
"""Elements in the contact at rest in the first run."""
GAINS = 0.7
"""Share to which a finer run must reduce the error: else it is that of the limit, for a longer run."""
STEADY = "The motion ends in steady sliding: there is no stick-slip."
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
    """Refine until the errors are within the tolerance, no longer fall, or the work would be too much."""
    need(lacks_arms(scene))

    def run() -> Answer:
        # They are slow to import.
        from kvtheory.models.elements.model import Model
        from kvtheory.models.elements.simulation import SAFETY

        line = scene.indenter.per_width
        density, before = ELEMENTS / (2.0 * Model.of(scene).at_rest.half_length), math.inf
        while True:
            result = models.elements(scene, per_length=density, at=[scene.run.duration])
            answer = _answer(scene, result, request, SAFETY)
            error = max(answer.certificate.relative_error[name] for name in request.quantities)
            finer = min(max(SPARE * math.sqrt(error / request.rtol), LEAST_FINER), MOST_FINER[line])
            work = result.element_updates * finer ** DIMENSIONS[line]
            if error <= request.rtol or error > GAINS * before or work > MOST_UPDATES[line]:
                need(UNSURE if error == math.inf else "")
                return answer
            density, before = density * finer, error

    return Offer(math.nan, run)


def _answer(scene: Scene, result: Any, request: Request, safety: float) -> Answer:
    """Return the requested quantities of the cycle of a motion, or raise ValueError if it shows none."""
    found = ended(scene, result.cycle)
    if not found.settles:
        raise ValueError(". ".join([UNSETTLED, *result.notes]))
    errors = {name: found.relative_errors[name] for name in request.quantities}
    certificate = Certificate("estimated", cycle_statement(safety), errors, "the cycle itself")
    if found.amplitude == 0.0:
        result = replace(result, notes=(*result.notes, STEADY))
    return Answer(
        {name: found.quantities[name] for name in request.quantities}, certificate, result
    )
