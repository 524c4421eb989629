"""Quantities of a scene from measured friction: `fit`."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.api._compare import METHODS
from kvtheory.api._edge import one_scene
from kvtheory.api._model_error import largest, layer_numbers, notes_of
from kvtheory.api._solve import solve as cheapest
from kvtheory.api._steady import method_for
from kvtheory.models.steady.methods import METHODS as STEADY
from kvtheory.progress import Progress
from kvtheory.results import STEADY_UNITS, units_for
from kvtheory.results.fits import FrictionFit, Parameter, WeighedModel
from kvtheory.results.table import SERIES_UNITS
from kvtheory.scene.arguments import a_scene, callback, checked, flag, names
from kvtheory.scene.capabilities import (
    lacks_arms,
    lacks_continuum,
    lacks_quadratic_on_arms,
    require,
)
from kvtheory.scene.foundations import MEASURED
from kvtheory.scene.mistakes import Problems, nearest, shown
from kvtheory.scene.model import Fixed, Scene

DIGITS = 6
"""Significant digits of a fitted number."""
WEIGHED = 0.5
"""Share of the points that are refined while models are weighed, as only the lowest minimum counts."""
SIMULATED = 1e-3
"""Tolerance of a transient that only elements give."""
MANY = 7
"""Unknowns, those of three arms, beyond which twice as many values are needed: friction tells hardly more."""
NOT_FREE = "drive.velocity", "run.duration", *(f"foundation.{name}" for name in MEASURED)
"""Quantities that the data give, and that no friction tells."""


@checked(scene=a_scene, free=names, models=flag, offset=flag, progress=callback)
def fit(
    scene: Scene | None = None,
    data: Any = None,
    *,
    free: Iterable[str] = (),
    models: bool = False,
    offset: bool = False,
    progress: Progress | None = None,
) -> FrictionFit:
    """Fit quantities of a scene to measured friction over velocity, or to a time series, or to both.

    Least squares of the relative residuals over the exact theory of steady sliding, or over the transient. No
    initial values are needed, and those of the scene are not used for the foundation: the whole range around
    the estimates of fact F26 is searched.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. Its values are kept where they
        are not free.
    data
        A file, or a mapping of arrays by header, with the columns velocity and friction coefficient or
        friction force (``{"V [mm/s]": ..., "mu": ...}``). Other columns vary quantities from row to row:
        the load (``F_z [N]``), the temperature (``T [degC]``), or any key of the scene (``indenter.radius
        [mm]``). With a column time (``{"t [ms]": ..., "F_x [N/mm]": ..., "z_A [mm]": ...}``) it is a time
        series: of friction, forces or depth in the transient of the scene, with its drive, from rest at
        t = 0. A list of these is fitted together, each column weighed by its scatter.
    free
        Keys of the quantities to be fitted, as in the scene file; ``"foundation.arms"`` stands for all
        arms.
    models
        Weigh foundations instead: Kelvin-Voigt, a springpot, and one to three arms, each with all its
        quantities free, by Akaike's criterion for small samples. The best one is the result.
    offset
        One unknown more: a friction coefficient that does not depend on velocity (adhesion, bearings),
        beside that of the foundation, with the sign of the velocity. With `models`, each is tried with it
        and without.
    progress
        Called with the fraction done and a text.

    Returns
    -------
    FrictionFit
        Values with standard errors, 95 % intervals and correlations, what the data cannot tell, the misfit,
        and the scene with the fitted values.

    Raises
    ------
    ValueError
        If the data cannot be read, with column and line; if a key cannot be free; or if there are fewer
        values than unknowns.

    Examples
    --------
    >>> import numpy as np
    >>> import kvtheory as kv
    >>> V = np.geomspace(1e-3, 1.0, 12)
    >>> mu = kv.steady(over={"drive.velocity": V}).friction_coefficient
    >>> keys = ["foundation.stiffness", "foundation.retardation_time"]
    >>> found = kv.fit(data={"V [m/s]": V, "mu": mu}, free=keys)
    >>> found.parameters["foundation.stiffness"].value, found.not_identifiable
    (10000000000.0, ())
    >>> slow = kv.fit(data={"V [m/s]": 1e-4 * V, "mu": 1e-4 * V}, free=keys)
    >>> slow.not_identifiable
    (('foundation.stiffness',),)

    References
    ----------
    Facts F3, F18, F25 and F26 of the derivations; Burnham and Anderson (2002), Model Selection.
    """
    from kvtheory.fitting import confidence, friction
    from kvtheory.fitting.records import read

    scene = one_scene(scene, "a fit")
    given = list(data) if isinstance(data, (list, tuple)) else [data]
    if not given or any(each is None for each in given):
        message = "missing; expected a file or arrays with velocity and friction coefficient"
        raise ValueError(f"`data`: {message}, or time and forces")
    solve = _steady_of(scene)
    if models == bool(list(free)):
        message = "expected the keys of free quantities, or `models`"
        raise ValueError(f"`free`: {message}, which frees all of the foundation")
    tried = _tried(scene, free, models=models, offset=offset)
    found: dict[str, Any] = {}
    for count, (name, (each, keys)) in enumerate(tried.items()):

        def report(done: float, name: str = name, count: int = count) -> None:
            if progress:
                progress((count + done) / len(tried), f"fitting {name}")

        report(0.0)
        sets = tuple(
            sorted((read(one, each) for one in given), key=lambda one: one.time is not None)
        )
        for one in sets:
            if both := [key for key in keys if key in one.conditions]:
                raise ValueError(f"`free` {both[0]}: a column of {one.source} gives it")
        if few := _untimed(each, sets) or _too_few(sets, keys):
            if models and found:
                continue
            raise ValueError(few)
        if any(one.time is not None for one in sets):
            if friction.OFFSET in keys and not each.drive.rigid:
                message = "an offset would change the motion on the spring of the drive"
                raise ValueError(
                    f"`offset`: {message}; expected a rigid drive, or friction over velocity"
                )
            if models and lacks_arms(each):
                continue
            require(lacks_arms, each, "a time series")
        law = _steady_of(each) if models else solve
        problem = friction.Problem(
            each, keys, sets, law, _followed, precise=not lacks_continuum(each)
        )
        solved = friction.solve(problem, report=report, share=WEIGHED if models else 1.0)
        found[name] = *solved, friction.information(*solved)
    name = min(found, key=lambda each: found[each][2])
    if models:
        solved = friction.solve(found[name][0])
        found[name] = *solved, friction.information(*solved)
    least = min(each[2] for each in found.values())
    weighed = [
        (each, best.point.size, _misfit(problem, best.point), aicc - least if aicc > least else 0.0)
        for each, (problem, best, aicc) in found.items()
    ]
    systematic = confidence.alike(found[name][0], found[name][1].point)
    total = sum(math.exp(-0.5 * row[3]) for row in weighed) if not systematic else math.nan
    problem, best, _ = found[name]
    values = [float(f"{math.exp(y):.{DIGITS}g}") for y in best.point]
    limits = confidence.intervals(problem, best)
    fitted = [
        {name: rows[0] for name, rows in each.items()}
        for each in problem.theory(np.log(values)[None])
    ]
    scale = np.sqrt(np.outer(*[np.diag(best.covariance)] * 2))
    return FrictionFit(
        parameters={
            key: Parameter(value, float(value * error), *_pieces(pieces))
            for key, value, error, pieces in zip(
                problem.keys, values, confidence.standard_errors(best, limits), limits, strict=True
            )
        },
        correlations=tuple(map(tuple, (best.covariance / np.where(scale > 0.0, scale, 1.0)).tolist())),
        not_identifiable=tuple(map(tuple, best.open(problem.keys))),
        misfit=_misfit(problem, best.point),
        model=name,
        models=tuple(
            WeighedModel(*row, math.exp(-0.5 * row[3]) / total) for row in weighed if models
        ),
        source=" and ".join(
            each.source if each.source == "`data`" else Path(each.source).name for each in problem.data
        ),
        notes=(
            *dict.fromkeys(note for each in problem.data for note in each.notes),
            *systematic,
            *(["No model fits to the scatter, so that none has a weight."] if models and systematic else []),
            *confidence.large(problem, best.point),
            *confidence.unseen(problem, best.point),
            *confidence.others(problem, best, limits),
            *_on_layer(problem, dict(zip(problem.keys, values, strict=True))),
        ),
        scene=problem.of(dict(zip(problem.keys, values, strict=True))),
        data={
            "sets": problem.data, "fitted": fitted, "residuals": [
                {name: friction.relative(each, name, own[name]) for name in each.measured}
                for each, own in zip(problem.data, fitted, strict=True)
            ],
            "units": units_for(scene.indenter, {**STEADY_UNITS, **SERIES_UNITS}), "solve": problem.solve,
        },
    )  # fmt: skip


def _on_layer(problem: Any, values: dict[str, float]) -> tuple[str, ...]:
    """Return notes on the layer of the fitted scene, under the conditions of all data."""
    numbers: dict[str, float] = {}
    for data in problem.data:
        for name, number in largest(
            layer_numbers(problem.of({**data.conditions, **values}))
        ).items():
            numbers[name] = max(number, numbers.get(name, 0.0))
    return notes_of(numbers, problem.scene, several=True)


def _tried(
    scene: Scene, free: Iterable[str], *, models: bool, offset: bool
) -> dict[str, tuple[Scene, tuple[str, ...]]]:
    """Return the scene and the keys of each model that is fitted."""
    from kvtheory.fitting import friction

    tried = (
        friction.models(scene) if models else {scene.foundation.kind: (scene, _keys(scene, free))}
    )
    if not offset:
        return tried
    lifted = {
        name + " + offset" * models: (each, (*keys, friction.OFFSET))
        for name, (each, keys) in tried.items()
    }
    return {**tried, **lifted} if models else lifted


def _too_few(sets: Any, keys: Sequence[str]) -> str:
    """Return why there are too few values for the unknowns, or an empty text."""
    size = sum(one.size * len(one.measured) for one in sets)
    needed = len(keys) + 1 if len(keys) <= MANY else 2 * len(keys)
    sources = " and ".join(one.source for one in sets)
    message = f"{len(keys)} unknowns need more than {needed - 1} values"
    return f"{sources}: holds {size} values; {message}" if size < needed else ""


def _pieces(limits: Any) -> tuple[Any, Any]:
    """Return the interval of the best value, and the pieces apart from it."""
    own, *others = [tuple(np.exp(ends).tolist()) for ends in limits]
    return own, tuple(others)


def _misfit(problem: Any, point: Any) -> float:
    """Return the root mean square of the residuals without weights."""
    return math.sqrt(float(np.mean(np.concatenate(problem.columns(point[None]), axis=1) ** 2)))


def _followed(scene: Scene, time: Any, rtol: float) -> dict[str, Any]:
    """Return the transient at times (s) within a tolerance, with the friction coefficient."""
    if lacks_quadratic_on_arms(scene) and lacks_continuum(scene):
        series = cheapest(scene, at=time, rtol=SIMULATED)
        found = {name: getattr(series, name) for name in SERIES_UNITS if hasattr(series, name)}
    else:
        found = dict(METHODS.transient(scene, time, rtol))
    with np.errstate(all="ignore"):
        found["friction_coefficient"] = found["friction_force"] / found["normal_force"]
    return found


def _untimed(scene: Scene, sets: Any) -> str:
    """Return a message if the depth changes, and data have no time."""
    without = [one.source for one in sets if one.time is None] if scene.depths else []
    return f"{without[0]}: support.history needs a column of time" if without else ""


def _steady_of(scene: Scene) -> Any:
    """Return what solves steady sliding; of a depth that changes, at the largest one."""
    if scene.depths:
        one = replace(scene, support=Fixed(float(scene.support.depth)))
        solve = STEADY[method_for(one, None)]
        return lambda each: solve(replace(each, support=Fixed(float(each.support.depth))))
    return STEADY[method_for(scene, None)]


def _keys(scene: Scene, free: Iterable[str]) -> tuple[str, ...]:
    """Return the free keys; that of all arms stands for each of them."""
    known = [key for key in scene.replaceable if key not in NOT_FREE]
    problems, keys = Problems(), []
    for key in free:
        own = [key] if key in known else [each for each in known if each.startswith(f"{key}[")]
        value = scene.values().get(own[0]) if own else None
        if not own:
            message = (
                "is given by the data" if key in NOT_FREE else "is not a quantity of this scene"
            )
            problems.append(f"`free` {shown(key)}: {message}; {nearest(key, known)}")
        elif not value or value < 0.0:
            problems.append(
                f"`free` {shown(key)}: is not above 0 in the scene, so that it has no scale"
            )
        keys += [each for each in own if each not in keys]
    problems.report()
    return tuple(keys)
