"""The rungs of a time series: exact (fixed or at rest), slow manifold, continuum, elements."""

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.ladder.climbing import Answer, Offer, Request, Rung, need
from kvtheory.models.slow_manifold import motion as slow_motion
from kvtheory.models.slow_manifold import start as slow_start
from kvtheory.progress import Progress
from kvtheory.results import (
    TRANSIENT_UNITS,
    Certificate,
    FewerArms,
    Simulation,
    SteadyState,
    Transient,
)
from kvtheory.results.errors import AT_REST, THE_TRUTH
from kvtheory.results.table import LANDMARKS, scales
from kvtheory.scene.capabilities import (
    lacks_arms,
    lacks_closed_form,
    lacks_continuum,
    lacks_kelvin_voigt,
    lacks_quadratic,
    lacks_rigid_drive,
    lacks_rigid_paper_model,
)
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

GIVEN = ("time", "velocity")
"""Known before anything is solved."""
SOLVED = tuple(name for name in TRANSIENT_UNITS if name not in GIVEN)
ODD = ("friction_force", "leading_edge", "trailing_edge")
"""Quantities that change their sign with the velocity."""
ON_RIGID = {"sliding_velocity": "velocity", "spring_force": "friction_force"}
"""Quantities of a spring, and what they equal on a rigid drive."""
STEADY_NAMES = {"normal_force": "load", "spring_force": "friction_force"}
"""Names in steady sliding of the quantities of a series, where they differ."""
OWN_TIMES = 201
"""Number of times of a series, if none are given and the model has no steps of its own."""

LOOSEST, TIGHTEST = 1e-4, 1e-12
"""Largest and smallest tolerance of a step of the continuum."""
RETRIED, AGAIN = 1e-7, 0.01
"""Tolerance of a step down to which one that fails on a Prony series is reduced, and the least factor on it
there: layers on fast arms are harder to pass if they are not resolved."""
FIRST, NEXT = {False: 0.02, True: 0.5}, 0.1
"""First tolerance of a step over the requested one, on Kelvin-Voigt and on a Prony series (True): it suffices
for nineteen certificates in twenty, there of depth and forces, and for half of those of everything. If not,
it is scaled by the requested over the achieved error, and by the second number."""

ELEMENTS = 120.0
"""Elements in the contact at rest in the first run."""
LEAST_FINER, MOST_FINER, SPARE = 2.0, {True: 8.0, False: 3.0}, 1.3
"""Bounds of the refinement factor (upper: line contact or ball), and margin on the factor that second-order
convergence requires. The work grows as its square, for a ball as its cube."""
MOST_UPDATES = {True: 5e7, False: 1e9}
"""Most element updates in one run, about a minute and a half, of a line contact and of a ball."""
OF_AN_ARM = 0.4
"""Work of one arm of an element, in element updates."""
DIMENSIONS = {True: 2, False: 3}
"""Number of dimensions refined together: elements, steps, and for a ball strips."""
MANY_ARMS, SHARE_OF_ARMS, SAFETY_OF_ARMS = 4, 0.1, 2.0
"""Arms from which fewer are tried on elements, their share of the tolerance, and a safety factor."""
SLOWER = np.geomspace(0.03, 1.0, 8)
"""Velocities, over the largest one, at which fewer arms must give the friction."""
BY_FEWER_ARMS = (
    "plus {:g} times the change, in the coarsest run, by {} arms instead of {} (at least {:g} rtol)"
)
BEST_OF_ELEMENTS = 1e-6
"""Approximate error of elements with the most updates, from rest; they are not run for less."""

COARSER = (
    "or the difference from the previous, coarser run, divided by the ratio of their element counts"
)

NOT_AT_REST = "the motion does not start at rest"


@dataclass(frozen=True)
class Models:
    """The public functions: `kvtheory.steady`, `transient`, `elements` and `fewer_arms`; and progress."""

    steady: Callable[..., SteadyState]
    transient: Callable[..., Transient]
    elements: Callable[..., Simulation]
    fewer_arms: Callable[..., FewerArms]
    progress: Progress | None = None


def rungs(models: Models) -> tuple[Rung, ...]:
    """Return the rungs in order of cost; those of a ball are exact and elements."""
    table = (
        ("exact", "steady at every instant: the depth cannot change, no memory", _exact),
        ("slow manifold", "a start from rest, small inertia", _slow),
        ("continuum", "a parabola", _parabola),
        ("elements", "none", _elements),
    )
    return tuple(Rung(name, assumed, partial(judge, models)) for name, assumed, judge in table)


def _exact(models: Models, scene: Scene, request: Request) -> Offer:
    """Accept what is steady at every instant: a fixed indenter (Eqs. 26, 33 with d' = 0), and rest."""
    need(never_steady(scene))

    def run() -> Answer:
        values, state = throughout(models.steady, scene, _times(scene, request))
        measures = scales(StaticState.of(scene))
        rounding = max(map(np.max, state.certificate.relative_error.values()))
        errors = {
            name: float(rounding * np.max(np.abs(values[name]), initial=0.0)) / measures[name]
            for name in SOLVED
        }
        own = Certificate(state.certificate.kind, state.certificate.statement, errors, AT_REST)
        return _series(scene, values, own, request, state)

    return Offer(0.0, run)


def never_steady(scene: Scene) -> str:
    """Return why a parabola or a ball does not slide steadily at every instant; an empty text if it does.

    At a constant depth the leading edge of a strip of half length A stays at -A, on undisturbed surface, and
    its trailing edge peels at sqrt(A^2 + l_r^2) - l_r, l_r = |V| tau of that instant (fact F10), as long as
    it does not outrun the foundation, dx_TE/dt <= |V|. So where the drive slows down,

        tau |dV/dt| (1 - l_r/sqrt(A^2 + l_r^2)) <= |V|,

    which binds first in the middle plane, A = a, and at the slow end of a linear piece of the drive.
    """
    if why := lacks_quadratic(scene) or lacks_kelvin_voigt(scene) or lacks_rigid_drive(scene):
        return why
    if not scene.start.at_rest:
        return NOT_AT_REST
    if scene.depths or not scene.held:
        resting = scene.drive.constant and scene.drive.final_velocity == 0.0
        return "" if resting and not scene.held else "the depth changes"
    if scene.drive.function is not None:
        return "the drive is a function"
    a, tau = StaticState.of(scene).half_length, scene.foundation.retardation_time
    for (before, fast), (after, slow) in itertools.pairwise(scene.drive.points):
        if abs(slow) >= abs(fast) and fast * slow >= 0.0:
            continue
        l_r = abs(slow) * tau
        rate = math.inf if before == after else (abs(fast) - abs(slow)) / (after - before)
        if fast * slow <= 0.0 or tau * rate * (1.0 - l_r / math.hypot(a, l_r)) > abs(slow):
            return f"the drive slows down too fast, stops or reverses before t = {after:.6g} s"
    return ""


def throughout(
    steady: Callable[..., SteadyState], scene: Scene, times: Array
) -> tuple[dict[str, Any], SteadyState]:
    """Return the series of a scene that slides steadily at every instant, and the steady states."""
    path = scene.drive.motion(scene.run.duration, 1.0)
    V = np.array([path.velocity(float(time)) for time in times])
    state = steady(scene, over={"drive.velocity": V})
    zero = np.zeros_like(V)
    values = {name: getattr(state, STEADY_NAMES.get(name, name), zero) for name in SOLVED}
    return {"time": times, "velocity": V, **values}, state


def _slow(models: Models, scene: Scene, request: Request) -> Offer:
    """Judge by scalars: the ratio of the rates, the initial layer at the first time, the least error."""
    need(lacks_rigid_paper_model(scene), "" if scene.drive.constant else "the drive changes")
    need("the indenter is fixed" if scene.held else "")
    need("" if scene.start.at_rest else NOT_AT_REST)
    at_rest = StaticState.of(scene)
    number, tau = abs(at_rest.drive_number), scene.foundation.retardation_time
    given = slow_start.start(number, at_rest.inertia_number, at_rest.support_number)

    def check(ratio: float) -> None:
        if ratio > slow_motion.LARGEST_RATIO:
            raise ArithmeticError(f"inertia is not small: ratio of slow to fast rate {ratio:.2g}")

    check(given.ratio)
    need("the trailing edge would re-enter deformed foundation" if given.goes_back else "")
    first = 0.0 if request.times is None else min(request.times) / tau
    moving = [name for name in request.quantities if name not in ("depth", "leading_edge", *GIVEN)]
    error = float(given.layer(first)) if moving else 0.0
    fading = math.exp(-first * max(given.relaxation, 1.0))

    def run() -> Answer:
        times, measures = _times(scene, request), scales(at_rest)
        found = slow_motion.follow(given, times / tau, request.rtol)
        check(found.ratio)
        velocity = scene.drive.final_velocity
        side = dict.fromkeys(ODD, -1.0 if velocity < 0.0 else 1.0)
        values = {
            name: side.get(name, 1.0) * measures[name] * found.values[name] for name in SOLVED
        }
        statement = (
            f"{slow_motion.SAFETY:g} times the error of the slow manifold to first order in the "
            "inertia number"
        )
        errors = {name: float(np.max(found.errors[name])) for name in SOLVED}
        own = Certificate("estimated", statement, errors, AT_REST)
        return _series(scene, {"velocity": velocity, **values}, own, request)

    return Offer(max(error, given.least_error * fading), run)


def _parabola(models: Models, scene: Scene, request: Request) -> Offer:
    need(lacks_continuum(scene))
    return Offer(math.nan, lambda: _continuum(models, scene, request))


def _continuum(models: Models, scene: Scene, request: Request) -> Answer:
    """Reduce the tolerance of the steps until the request is met, or the smallest is reached."""
    arms = bool(scene.foundation.arms)
    first, least = FIRST[arms], AGAIN if arms else 0.0
    step = min(max(first * request.rtol, TIGHTEST), LOOSEST)
    while True:
        retried = arms and step > RETRIED
        try:
            answer = _picked(models.transient(scene, at=request.times, rtol=step), request)
        except (ValueError, ArithmeticError):
            if not retried:
                raise
            step *= AGAIN
            continue
        error = max(answer.certificate.relative_error[name] for name in request.quantities)
        if error <= request.rtol or step <= TIGHTEST or (error == math.inf and not retried):
            return answer
        step = max(step * max(NEXT * request.rtol / error, least), TIGHTEST)


def _widened(answer: Answer, statement: str, more: dict[str, float]) -> Answer:
    """Add the error of the model to the errors of an answer."""
    own = answer.certificate
    errors = {name: error + more.get(name, 0.0) for name, error in own.relative_error.items()}
    statement = f"{own.statement}; {statement}"
    return answer._replace(certificate=Certificate("estimated", statement, errors, AT_REST))


def _elements(models: Models, scene: Scene, request: Request) -> Offer:
    """Refine until the certificate is within the tolerance, or the work would be too much.

    The difference from the previous, coarser run, divided by the ratio of elements, counts too.
    """
    need(lacks_arms(scene))
    marks = " and ".join(name for name in request.quantities if name in LANDMARKS)
    need(f"the error of {marks} by elements is not known; ask `elements`" if marks else "")

    def run() -> Answer:
        from kvtheory.models.elements.model import Model  # slow to import

        at_rest = Model.of(scene).at_rest
        length, measures = 2.0 * at_rest.half_length, scales(at_rest)
        before, held, effect, message = None, scene, dict[str, float](), ""

        def solved(count: float, finer: float) -> tuple[Answer, float]:
            nonlocal before, held, effect, message
            result = models.elements(held, per_length=count / length, at=request.times)
            answer = _picked(result, request)
            if before is None:
                held, effect, message = _with_fewer_arms(models, scene, request, answer, result)
            elif request.times is not None:
                own, apart = answer.certificate, _apart(answer, before, measures)
                errors = {
                    name: max(error, apart.get(name, 0.0) / finer)
                    for name, error in own.relative_error.items()
                }
                own = Certificate(own.kind, f"{own.statement}; {COARSER}", errors, AT_REST)
                answer = answer._replace(certificate=own)
            if message:
                answer = _widened(answer, message, effect)
            before = answer
            return answer, result.element_updates * (1.0 + OF_AN_ARM * len(held.foundation.arms))

        return refined(scene, request, solved, fewest=2)

    return Offer(BEST_OF_ELEMENTS if request.rtol < BEST_OF_ELEMENTS else math.nan, run)


def refined(
    scene: Scene, request: Request, solved: Callable[[float, float], tuple[Answer, float]], *,
    fewest: int = 1, gains: float = math.inf,
) -> Answer:  # fmt: skip
    """Refine elements until the errors are within the tolerance, or the work would be too much.

    `solved`, of the elements in the contact at rest and of how many times as many they are as before, returns
    an answer and its work in element updates. There are at least so many runs; the refinement also ends
    where the error is not reduced to the share `gains`.
    """
    line, count, finer, before = scene.indenter.per_width, ELEMENTS, math.nan, math.inf
    for runs in itertools.count(1):
        answer, work = solved(count, finer)
        error = max(answer.certificate.relative_error[name] for name in request.quantities)
        needed = max(SPARE * math.sqrt(error / request.rtol), LEAST_FINER)
        finer = min(needed, MOST_FINER[line])
        ratio = finer if runs == 1 else needed  # the first run may be too coarse to tell
        enough = (error <= request.rtol and runs >= fewest) or error > gains * before
        if enough or work * ratio ** DIMENSIONS[line] > MOST_UPDATES[line]:
            break
        count, before = count * finer, error
    return answer


def _with_fewer_arms(
    models: Models, scene: Scene, request: Request, answer: Answer, run: Simulation
) -> tuple[Scene, dict[str, float], str]:
    """Return the scene with fewer arms, if that changes little and pays, what it changes, and a statement."""
    arms, V = len(scene.foundation.arms), np.abs(run.velocity).max(initial=0.0)
    if arms < MANY_ARMS or request.times is None or V == 0.0 or lacks_closed_form(scene):
        return scene, {}, ""
    least = SHARE_OF_ARMS * request.rtol
    fewer = models.fewer_arms(scene, velocities=V * SLOWER, rtol=least, proved=False)
    if len(fewer.arms) == arms:
        return scene, {}, ""
    other = _picked(
        models.elements(fewer.scene, per_length=run.per_length, at=request.times), request
    )
    apart = _apart(answer, other, scales(StaticState.of(scene)))
    change = {name: max(SAFETY_OF_ARMS * each, least) for name, each in apart.items()}
    if max(change.values(), default=0.0) > SAFETY_OF_ARMS * least:
        return scene, {}, ""
    statement = BY_FEWER_ARMS.format(SAFETY_OF_ARMS, len(fewer.arms), arms, SHARE_OF_ARMS)
    return fewer.scene, change, statement


def _apart(answer: Answer, other: Answer, measures: dict[str, float]) -> dict[str, float]:
    """Return the largest differences of two answers, of quantities with a measure."""
    names = [name for name in answer.certificate.relative_error if name in measures]
    apart = [np.abs(np.asarray(answer.values[name]) - other.values[name]) for name in names]
    return {
        name: float(np.nanmax(each, initial=0.0)) / measures[name]
        for name, each in zip(names, apart, strict=True)
    }


def _series(
    scene: Scene, values: dict[str, Any], own: Certificate, request: Request, result: Any = None
) -> Answer:
    """Return the requested quantities from constants or from values at the requested times."""
    times = _times(scene, request)
    held = {name: np.full(times.shape, value) for name, value in values.items()}
    return _answer({**held, "time": times}, own, request, result)


def _picked(result: Any, request: Request) -> Answer:
    """Return the requested quantities of a transient or of a simulation."""
    return _answer(vars(result), result.certificate, request, result)


def _answer(series: Any, own: Certificate, request: Request, result: Any) -> Answer:
    """Return the series, NaN where a quantity was not requested, and the errors of those that were."""
    known = {**own.relative_error, **dict.fromkeys(GIVEN, 0.0)}
    if marks := {name: series.get(name) for name in request.units if name in LANDMARKS}:
        missing = " and no ".join(name for name, value in marks.items() if value is None)
        need(f"there is no {missing} within run.duration" if missing else "")
        errors = {name: known.get(name, math.inf) for name in marks}
        return Answer(marks, replace(own, relative_error=errors, relative_to=THE_TRUTH), result)
    wanted = [name for name in request.units if name in (*GIVEN, *request.quantities)]
    source = {name: name if name in series else ON_RIGID[name] for name in wanted}
    values = {
        name: series[source[name]] if name in source else np.full(np.size(series["time"]), np.nan)
        for name in request.units
    }
    errors = {name: known[source[name]] for name in wanted}
    return Answer(values, replace(own, relative_error=errors), result)


def _times(scene: Scene, request: Request) -> Array:
    if request.times is None:
        return np.linspace(0.0, scene.run.duration, OWN_TIMES)
    return np.asarray(request.times, dtype=float)
