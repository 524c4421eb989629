"""The rungs of a time series: exact (where nothing moves), slow manifold, continuum, elements."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.ladder import equivalent, stiff_drive
from kvtheory.ladder.climbing import Answer, Judgement, Request, Rung
from kvtheory.models.slow_manifold import motion as slow_motion
from kvtheory.models.slow_manifold import start as slow_start
from kvtheory.models.strips import held
from kvtheory.results import TRANSIENT_UNITS, Certificate, Simulation, SteadyState, Transient
from kvtheory.results.certificate import AT_REST
from kvtheory.results.table import scales
from kvtheory.scene.capabilities import (
    lacks_arms,
    lacks_kelvin_voigt,
    lacks_paper_model,
    lacks_quadratic,
    lacks_rigid_drive,
    lacks_rigid_paper_model,
    lacks_strips,
)
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Derived
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

GIVEN = ("time", "velocity")
"""Known before anything is solved."""
SOLVED = tuple(name for name in TRANSIENT_UNITS if name not in GIVEN)

ON_RIGID = {"sliding_velocity": "velocity", "spring_force": "friction_force"}
"""On a rigid drive the indenter slides at its velocity, and it bears the friction."""

OWN_TIMES = 201
"""Of a series whose times are not given, where the model has no steps of its own."""

LOOSEST, TIGHTEST = 1e-4, 1e-12
"""Tolerances of a step of the continuum."""
FIRST = 0.02
"""Tolerance of its steps at first, in units of that asked for: nineteen certificates in twenty are
then met at once."""
NEXT = 0.1
"""When it is not met, the tolerance of the steps is scaled by what is missing and by this."""

ELEMENTS = 120.0
"""Elements in the contact at rest, at first."""
LEAST_FINER, MOST_FINER, SPARE = 2.0, {True: 8.0, False: 3.0}, 1.3
"""Then there are so many times more, within these bounds, as second order in their spacing asks for, and
somewhat more. The work grows as the square, of a ball as the cube."""
MOST_UPDATES = {True: 5e7, False: 1e9}
"""Updates of elements in one run, about a minute and a half: of a line contact, and of a ball, which has
thousands of them in a step."""
OF_AN_ARM = 0.4
"""The work of an arm of an element, in updates."""
DIMENSIONS = {True: 2, False: 3}
"""What is refined together: elements, steps, and strips of a ball."""

BEST_OF_ELEMENTS = 1e-6
"""With the most work, they come to about this in a start from rest: nothing is run where less is asked."""


@dataclass(frozen=True)
class Models:
    """The public functions that run the models: `kvtheory.steady`, `transient` and `elements`."""

    steady: Callable[..., SteadyState]
    transient: Callable[..., Transient]
    elements: Callable[..., Simulation]


def rungs(models: Models) -> tuple[Rung, ...]:
    """Return the rungs in order of cost; those of a ball are exact, strips and elements."""
    at_once = partial(_at_once, models.steady)
    return (
        Rung("exact", "steady from the first instant: the depth cannot change", _steady, at_once),
        Rung("slow manifold", "a start from rest, inertia that is soon overcome", _slow, _follow),
        Rung("strips", "a ball held at its depth, no memory", _held, partial(_strips, models.transient)),
        Rung("continuum", "a parabola, a drive so stiff that it counts as rigid",
             _stiff, partial(_rigid, models.transient)),
        Rung("continuum", "a parabola", _parabola, partial(_continuum, models.transient)),
        Rung("continuum", "a parabola, arms much faster than the motion",
             partial(_replaceable, models.steady), partial(_equivalent, models)),
        Rung("elements", "none", _anything, partial(_elements, models.elements)),
    )  # fmt: skip


def _parabola(scene: Scene, request: Request) -> Judgement:
    return Judgement(lacks_paper_model(scene))


def _held(scene: Scene, request: Request) -> Judgement:
    return Judgement(lacks_strips(scene) or held.remembers(scene))


def _strips(transient: Callable[..., Transient], scene: Scene, request: Request, _: Any) -> Answer:
    result = transient(scene, at=request.times)
    return _asked(result, result.certificate, request, result)


def _solved(request: Request) -> tuple[str, ...]:
    return tuple(name for name in request.units if name not in GIVEN)


def _replaceable(steady: Callable[..., SteadyState], scene: Scene, request: Request) -> Judgement:
    return equivalent.judge(steady, scene, request, _solved(request))


def _anything(scene: Scene, request: Request) -> Judgement:
    if lacking := lacks_arms(scene):
        return Judgement(lacking)
    return Judgement(error=BEST_OF_ELEMENTS if request.rtol < BEST_OF_ELEMENTS else math.nan)


def _steady(scene: Scene, request: Request) -> Judgement:
    """Admit what is steady at once: a fixed indenter (Eqs. 26, 33 with d' = 0), and rest."""
    reason = lacks_quadratic(scene) or lacks_kelvin_voigt(scene) or lacks_rigid_drive(scene)
    if not scene.drive.constant:
        reason = reason or "the drive changes"
    elif scene.drive.final_velocity != 0.0 and not scene.held:
        reason = reason or "the indenter rises"
    return Judgement(reason, math.nan if reason else 0.0)


def _at_once(steady: Callable[..., SteadyState], scene: Scene, request: Request, _: Any) -> Answer:
    state, times = steady(scene), _times(scene, request)
    constant = {
        "velocity": scene.drive.final_velocity,
        "depth": state.depth,
        "depth_rate": 0.0,
        "normal_force": state.load,
        "friction_force": state.friction_force,
        "leading_edge": state.leading_edge,
        "trailing_edge": state.trailing_edge,
        "peak_pressure": state.peak_pressure,
    }
    values = {name: np.full(times.size, value) for name, value in constant.items()}
    measures = scales(StaticState.of(scene))
    rounding = max(state.certificate.relative_error.values())
    errors = {name: rounding * abs(constant[name]) / measures[name] for name in SOLVED}
    own = state.certificate
    certificate = Certificate(own.kind, own.statement, errors, AT_REST)
    return _asked({"time": times, **values}, certificate, request, state)


def _slow(scene: Scene, request: Request) -> Judgement:
    """Judge by scalars: the ratio of the rates, the layer at the first time, the first delay."""
    reason = lacks_rigid_paper_model(scene)
    if reason or not scene.drive.constant or scene.held:
        return Judgement(
            reason or ("it cannot rise" if scene.drive.constant else "the drive changes")
        )
    at_rest = StaticState.of(scene)
    given = slow_start.start(
        abs(at_rest.drive_number), at_rest.inertia_number, at_rest.support_number
    )
    if given.ratio > slow_motion.LARGEST_RATIO:
        return Judgement(f"inertia counts: slow over fast rate {given.ratio:.2g}")
    if given.goes_back:
        return Judgement("an edge would move back over ground that it left")
    times = request.times
    first = 0.0 if times is None else min(times) / scene.foundation.retardation_time
    moving = [name for name in request.quantities if name not in ("depth", "leading_edge", *GIVEN)]
    error = float(given.layer(first)) if moving else 0.0
    fading = math.exp(-first * max(given.relaxation, 1.0))
    return Judgement(error=max(error, given.least_error * fading), known=given)


def _follow(scene: Scene, request: Request, given: slow_start.Start) -> Answer:
    times, measures = _times(scene, request), scales(StaticState.of(scene))
    found = slow_motion.follow(given, times / scene.foundation.retardation_time, request.rtol)
    if found.ratio > slow_motion.LARGEST_RATIO:
        raise ArithmeticError(f"inertia counts: slow over fast rate {found.ratio:.2g}")
    velocity = scene.drive.final_velocity
    side = -1.0 if velocity < 0.0 else 1.0
    odd = ("friction_force", "leading_edge", "trailing_edge")
    values = {
        name: (side if name in odd else 1.0) * measures[name] * found.values[name]
        for name in SOLVED
    }
    errors = {name: float(np.max(found.errors[name])) for name in SOLVED}
    statement = (
        f"{slow_motion.SAFETY:g} times what the slow manifold neglects to first order in the inertia "
        "number"
    )
    known = {"time": times, "velocity": np.full(times.size, velocity)}
    return _asked(
        {**known, **values}, Certificate("estimated", statement, errors, AT_REST), request
    )


def _continuum(
    transient: Callable[..., Transient], scene: Scene, request: Request, _: Any
) -> Answer:
    """Tighten the steps until the certificate is met, or they can be no tighter."""
    step = min(max(FIRST * request.rtol, TIGHTEST), LOOSEST)
    while True:
        result = transient(scene, at=request.times, rtol=step)
        answer = _asked(result, result.certificate, request, result)
        error = max(answer.certificate.relative_error[name] for name in request.quantities)
        if error <= request.rtol or step <= TIGHTEST or error == math.inf:
            return answer
        step = max(step * NEXT * request.rtol / error, TIGHTEST)


def _stiff(scene: Scene, request: Request) -> Judgement:
    if reason := lacks_paper_model(scene):
        return Judgement(reason)
    if scene.drive.rigid:
        return Judgement("the drive is rigid")
    first = 0.0 if request.times is None else min(request.times) / scene.foundation.retardation_time
    moving = [name for name in request.quantities if name not in ("depth", *GIVEN)]
    at_once = scene.drive.constant and moving
    return Judgement(
        error=stiff_drive.ringing(StaticState.of(scene), first) if at_once else math.nan
    )


def _rigid(transient: Callable[..., Transient], scene: Scene, request: Request, _: Any) -> Answer:
    """Solve on a rigid drive, and count what the spring would change."""
    drive = replace(scene.drive, stiffness=None, damping=Derived(0.0), mass=None)
    answer = _continuum(transient, replace(scene, drive=drive), request, None)
    solution, asked = answer.result.solution, np.asarray(answer.values["time"])
    times = np.unique(np.concatenate([solution.natural_times, asked]))
    found = stiff_drive.neglected(solution.series(times), StaticState.of(scene))
    wanted = np.searchsorted(times, asked)
    own = answer.certificate
    errors = {
        name: error + float(np.max(found[name][wanted])) if name in found else error
        for name, error in own.relative_error.items()
    }
    statement = f"{own.statement}; {stiff_drive.STATEMENT}"
    return answer._replace(certificate=Certificate("estimated", statement, errors, AT_REST))


def _equivalent(models: Models, scene: Scene, request: Request, rate: float) -> Answer:
    """Solve with the equivalent damping, and count what that of the fastest rate would change."""
    answer, other = (
        _continuum(models.transient, replace(scene, foundation=each), request, None)
        for each in (equivalent.foundation(scene), equivalent.foundation(scene, rate))
    )
    own, solved = answer.certificate, _solved(request)
    parts = (
        own.relative_error,
        equivalent.neglected(answer.result, other.result, scene, solved),
        equivalent.in_steady_sliding(models.steady, scene, solved),
    )
    errors = {name: sum(part.get(name, 0.0) for part in parts) for name in own.relative_error}
    certificate = Certificate(
        "estimated", f"{own.statement}; {equivalent.STATEMENT}", errors, AT_REST
    )
    return answer._replace(certificate=certificate)


def _elements(
    elements: Callable[..., Simulation], scene: Scene, request: Request, _: Any
) -> Answer:
    """Refine until the certificate is met, or until that would be too much work.

    A certificate compares with half as many elements, and both may be too coarse to see what is fast:
    what a run differs from the coarser one before it counts too, divided by the ratio of their elements.
    """
    from kvtheory.models.elements.model import SAMPLES, Model

    length = SAMPLES * Model.of(scene).spacing
    count, finer, before = ELEMENTS, math.nan, None
    while True:
        result = elements(scene, per_length=count / length, at=request.times)
        answer = _asked(result, result.certificate, request, result)
        if before is not None and request.times is not None:
            answer = _compared(answer, before, finer, scales(Model.of(scene).at_rest))
        error = max(answer.certificate.relative_error[name] for name in request.quantities)
        enough = error <= request.rtol and before is not None
        line = scene.indenter.per_width
        needed = max(SPARE * math.sqrt(error / request.rtol), LEAST_FINER)
        finer = min(needed, MOST_FINER[line])
        ratio = finer if before is None else needed  # the first run may be too coarse to tell
        work = result.element_updates * (1.0 + OF_AN_ARM * len(scene.foundation.arms))
        if enough or work * ratio ** DIMENSIONS[line] > MOST_UPDATES[line]:
            return answer
        count, before = count * finer, answer


def _compared(answer: Answer, before: Answer, finer: float, scales: dict[str, float]) -> Answer:
    """Let the difference to a coarser run count in the errors."""
    own, errors = answer.certificate, dict(answer.certificate.relative_error)
    for name in errors.keys() & scales.keys():
        difference = np.abs(np.asarray(answer.values[name]) - before.values[name])
        change = float(np.nanmax(difference, initial=0.0)) / scales[name]
        errors[name] = max(errors[name], change / finer)
    statement = (
        own.statement + "; or what the elements before, fewer, differed by, over their ratio"
    )
    return answer._replace(certificate=Certificate(own.kind, statement, errors, AT_REST))


def _asked(series: Any, certificate: Certificate, request: Request, result: Any = None) -> Answer:
    """Return the series with NaN for what was not asked for, and the errors of what was."""
    held = series if isinstance(series, dict) else vars(series)
    known = {**certificate.relative_error, **dict.fromkeys(GIVEN, 0.0)}
    wanted = [name for name in request.units if name in (*GIVEN, *request.quantities)]
    source = {name: name if name in held else ON_RIGID[name] for name in wanted}
    values = {name: np.full(np.size(held["time"]), np.nan) for name in request.units}
    values |= {name: held[source[name]] for name in wanted}
    errors = {name: known[source[name]] for name in wanted}
    return Answer(values, replace(certificate, relative_error=errors), result)


def _times(scene: Scene, request: Request) -> Array:
    if request.times is None:
        return np.linspace(0.0, scene.run.duration, OWN_TIMES)
    return np.asarray(request.times, dtype=float)
