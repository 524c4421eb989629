"""Quantities of a scene from measured friction: `fit`."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.api._edge import one_scene
from kvtheory.api._steady import method_for
from kvtheory.models.steady.methods import METHODS
from kvtheory.progress import Progress
from kvtheory.results import STEADY_UNITS, units_for
from kvtheory.results.fits import FrictionFit, Parameter, WeighedModel
from kvtheory.scene.arguments import a_scene, callback, checked, flag, names
from kvtheory.scene.mistakes import Problems, nearest
from kvtheory.scene.model import Scene

DIGITS = 6
"""Significant digits of a fitted number."""
NOT_FREE = "drive.velocity", "run.duration"
"""Quantities that no friction curve tells."""


@checked(scene=a_scene, free=names, models=flag, progress=callback)
def fit(
    scene: Scene | None = None,
    data: Any = None,
    *,
    free: Iterable[str] = (),
    models: bool = False,
    progress: Progress | None = None,
) -> FrictionFit:
    """Fit quantities of a scene to measured friction over velocity.

    Least squares of the relative residuals over the exact theory of steady sliding. No initial values are
    needed, and those of the scene are not used for the foundation: the whole range around the estimates of
    fact F26 is searched.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. Its values are kept where they
        are not free.
    data
        A file, or a mapping of arrays by header, with the columns velocity and friction coefficient or
        friction force (``{"V [mm/s]": ..., "mu": ...}``). Other columns vary quantities from row to row:
        the load (``F_z [N]``), the temperature (``T [degC]``), or any key of the scene (``indenter.radius
        [mm]``).
    free
        Keys of the quantities to be fitted, as in the scene file; ``"foundation.arms"`` stands for all
        arms.
    models
        Weigh foundations instead: Kelvin-Voigt, a springpot, and one to three arms, each with all its
        quantities free, by Akaike's criterion for small samples. The best one is the result.
    progress
        Called with the fraction done and a text.

    Returns
    -------
    FrictionFit
        Values with standard errors and correlations, what the data cannot tell, the misfit, and the scene
        with the fitted values.

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
    from kvtheory.fitting import friction

    scene = one_scene(scene, "a fit")
    if data is None:
        raise ValueError(
            "`data`: missing; expected a file or arrays with velocity and friction coefficient"
        )
    solve = METHODS[method_for(scene, None)]
    if models == bool(list(free)):
        told = "expected the keys of free quantities, or `models`"
        raise ValueError(f"`free`: {told}, which frees all of the foundation")
    tried = (
        friction.models(scene) if models else {scene.foundation.kind: (scene, _keys(scene, free))}
    )
    found: dict[str, Any] = {}
    weighed: list[tuple[str, int, float, float]] = []
    for count, (name, (each, keys)) in enumerate(tried.items()):
        if progress:
            progress(count / len(tried), f"fitting {name}")
        read = friction.read(data, each)
        if both := [key for key in keys if key in read.conditions]:
            raise ValueError(f"`free` {both[0]}: a column of {read.source} gives it")
        if read.size * len(read.measured) <= len(keys):
            if models and found:
                continue
            told = f"{len(keys)} unknowns need more than {len(keys)} values"
            raise ValueError(f"{read.source}: holds {read.size} rows; {told}")
        law = METHODS[method_for(each, None)] if models else solve
        problem = friction.Problem(each, keys, read, law)
        best = friction.solve(problem)
        found[name] = problem, best, friction.information(best)
    least = min(each[2] for each in found.values())
    for name, (_, best, aicc) in found.items():
        own = math.sqrt(float(np.mean(best.residuals**2)))
        weighed.append((name, best.point.size, own, aicc - least if aicc > least else 0.0))
    total = sum(math.exp(-0.5 * row[3]) for row in weighed)
    name = min(found, key=lambda each: found[each][2])
    problem, best, _ = found[name]
    values = [float(f"{math.exp(y):.{DIGITS}g}") for y in best.point]
    errors = np.sqrt(np.diag(best.covariance))
    size = np.outer(errors, errors)
    fitted = problem.theory(np.log(values)[None])
    return FrictionFit(
        parameters={
            key: Parameter(value, float(value * error))
            for key, value, error in zip(problem.keys, values, errors, strict=True)
        }, correlations=tuple(map(tuple, (best.covariance / np.where(size > 0.0, size, 1.0)).tolist())),
        not_identifiable=tuple(map(tuple, best.open(problem.keys))),
        misfit=math.sqrt(float(np.mean(best.residuals**2))), model=name, models=tuple(WeighedModel(*row,
        math.exp(-0.5 * row[3]) / total) for row in weighed) if models else (),
        source=Path(problem.data.source).name if isinstance(data, (str, Path)) else problem.data.source,
        notes=problem.data.notes, scene=problem.scene.replace(dict(zip(problem.keys, values, strict=True))),
        data={
            "conditions": problem.data.conditions, "measured": problem.data.measured,
            "fitted": {each: rows[0] for each, rows in fitted.items()},
            "units": units_for(scene.indenter, STEADY_UNITS), "solve": problem.solve,
        },
    )  # fmt: skip


def _keys(scene: Scene, free: Iterable[str]) -> tuple[str, ...]:
    """Return the free keys; that of all arms stands for each of them."""
    known = [key for key in scene.replaceable if key not in NOT_FREE]
    problems, keys = Problems(), []
    for key in free:
        own = [key] if key in known else [each for each in known if each.startswith(f"{key}[")]
        value = scene.values().get(own[0]) if own else None
        if not own:
            problems.append(f"`free` {key}: is not a quantity of this scene; {nearest(key, known)}")
        elif not value or value < 0.0:
            problems.append(f"`free` {key}: is not above 0 in the scene, so that it has no scale")
        keys += [each for each in own if each not in keys]
    problems.report()
    return tuple(keys)
