"""The cheapest sufficient model: `solve`."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from kvtheory.api._edge import double_precision, one_scene, times_of
from kvtheory.api._elements import elements
from kvtheory.api._fewer_arms import fewer_arms
from kvtheory.api._model_error import errors_of, layer_notes
from kvtheory.api._stability import stability
from kvtheory.api._steady import by_method, steady
from kvtheory.api._transient import transient
from kvtheory.progress import Progress, silent
from kvtheory.results import STEADY_UNITS, Solution, ToleranceError
from kvtheory.results.cycles import CYCLE
from kvtheory.results.steady import UNKNOWN, UNSTABLE
from kvtheory.results.table import LANDMARKS, SERIES_UNITS, SPRING_UNITS, series_units
from kvtheory.scene.arguments import a_scene, callback, checked, flag, names, number, times
from kvtheory.scene.capabilities import lacks_stability
from kvtheory.scene.mistakes import Problems, nearest
from kvtheory.scene.model import Scene

MINIMUM_RTOL, MAXIMUM_RTOL = 1e-14, 1.0
"""Below this range rounding dominates; above it any number would do."""

SPRUNG = "needs drive.stiffness, of a spring"
COASTS = "With drive.stiffness = 0 the indenter coasts to rest, and does not slide steadily."


@checked(
    scene=a_scene, at=times, quantity=names, rtol=number(MINIMUM_RTOL, MAXIMUM_RTOL), over_time=flag,
    progress=callback,
)  # fmt: skip
def solve(
    scene: Scene | None = None,
    *,
    quantity: Any = None,
    at: Any = None,
    rtol: float = 1e-3,
    over_time: bool = False,
    progress: Progress | None = None,
) -> Solution:
    """Solve a scene by the cheapest model that is known to be within a tolerance.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight.
    quantity
        Name of a quantity, or a list of names: of steady sliding as in `SteadyState`, or of a time series as
        in `Transient` or `SprungTransient`; without it, all of them, of steady sliding on a layer friction,
        load and depth. On a spring in the drive also of the cycle in which the run ends, as in `sweep`:
        ``stick_slip_amplitude`` (0 of steady sliding), ``stick_slip_period`` (NaN of it), and
        ``sliding_velocity`` and ``friction_force`` with ``.cycle_max`` and ``.cycle_min``; or
        ``restitution`` and ``contact_time`` of a drop, ``stopping_time`` and ``stopping_distance`` of an
        indenter that coasts.
    at
        Times of a series, in s or as text with a unit; without it, steady sliding at the final velocity of
        the drive is solved.
    rtol
        Largest error allowed, from 1e-14 to 1: for a series relative to the static depth, half length and
        load; for a cycle to its amplitude, period and ranges; for all other quantities to their value.
    over_time
        Solve for a time series even without `at`, at times chosen by the model.
    progress
        Called as in `transient`, from 0 to 1 for each run of a model over time.

    Returns
    -------
    Solution
        The values, the model, its certificate, and the models tried: asymptote, exact, quadrature for steady
        sliding, where a layer gives the foundation with its error against the layer, and then the layer
        itself, on cells as fine as `rtol` asks, down to 1e-6, under a ball 1e-4; exact (where nothing moves),
        slow manifold, continuum, elements for a series.

    Raises
    ------
    SceneError
        If a quantity or a time is wrong; every mistake is listed.
    ValueError
        If `rtol` is out of range.
    ToleranceError
        If no model is known to be within the tolerance, with how close each came; or if steady sliding is
        asked for and not known to be stable on the spring in the drive; or if the run ends before its cycle.

    Examples
    --------
    >>> import kvtheory as kv
    >>> scene = kv.Scene(drive=kv.Drive(velocity="1 mm/s"))
    >>> for rtol in (0.1, 1e-3):
    ...     found = kv.solve(scene, quantity="friction_coefficient", rtol=rtol)
    ...     print(found.model, found.certificate.kind, round(found.friction_coefficient, 4))
    asymptote proved 0.01
    exact estimated 0.0097
    >>> series = kv.solve(at=["1 ms", "200 ms"], rtol=1e-4)
    >>> series.model, (series.friction_force / 1e3).round(2).tolist()
    ('continuum', [2.35, 0.84])

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038; facts F1-F13 of the derivations.
    """
    from kvtheory.ladder import climbing, cycles, series  # these import the models over time

    scene = one_scene(scene, "`solve`")
    over_time, problems = over_time or at is not None, Problems()
    units = series_units(rigid_drive=scene.drive.rigid) if over_time else STEADY_UNITS
    of_cycle = not over_time and bool(CYCLE.keys() & (quantity or ()))
    if of_cycle:
        units = CYCLE
        if scene.drive.rigid or scene.drive.coasts:
            problems.add("`quantity`", quantity[0], SPRUNG)
    if quantity and not over_time and not set(quantity) - set(LANDMARKS):
        over_time, units = True, {name: LANDMARKS[name] for name in quantity}
    names = _names(quantity, units, over_time, problems)
    with problems.catching("`at`", at):
        times_of(scene, at)
    problems.report()
    follow, simulate = partial(transient, progress=progress), partial(elements, progress=progress)
    models = series.Models(steady, follow, simulate, fewer_arms, progress)
    if over_time or of_cycle:
        rungs = (cycles if of_cycle else series).rungs(models)
    else:
        scene.drive.final_velocity  # noqa: B018  # it raises if the drive has none
        if scene.drive.coasts:
            raise ToleranceError(f"{COASTS} Ask for a series, with `at`.")
        known = not lacks_stability(scene)
        if not (scene.drive.rigid or (known and stability(scene, quantity="stable").stable)):
            reason = UNSTABLE.format("") if known else UNKNOWN
            raise ToleranceError(f"{reason} Ask for a series, with `at`.")
        own = partial(by_method, progress=progress or silent)
        rungs = climbing.rungs(own)
        if (error := errors_of(scene)) is not None:
            rungs = climbing.beside_layer(rungs, error, own)
            names = names if quantity is not None else tuple(error)
    with double_precision(scene):
        found = climbing.climb(scene, climbing.Request(names, rtol, at, units), rungs)
        return found if found.answer is not None else replace(found, notes=layer_notes(scene))


def _names(
    names: Sequence[str] | None, units: Mapping[str, str], over_time: bool, problems: Problems
) -> tuple[str, ...]:
    """Return the requested quantities, and append mistakes to the problems."""
    if names is None:
        return tuple(units)
    if not names:
        problems.append("`quantity` is empty: expected a name such as friction_force")
    other = STEADY_UNITS if over_time else SERIES_UNITS
    for name in names:
        if name in units:
            continue
        if name in LANDMARKS:
            what = "is of a whole motion; ask for it without others, and without times"
        elif over_time and name in SPRING_UNITS:
            what = SPRUNG
        elif over_time and name in CYCLE:
            what = "belongs to the cycle in which the whole motion ends; leave out the times"
        elif units is CYCLE and name in (STEADY_UNITS | SERIES_UNITS):
            what = "does not belong to the cycle: ask for it apart"
        elif name in other:
            hint = "leave out the times" if over_time else 'give the times, such as `at` = "1 ms"'
            what = f"belongs to {'steady sliding' if over_time else 'a time series'}; {hint}"
        else:
            what = nearest(name, (*units, *LANDMARKS))
        problems.add("`quantity`", name, what)
    return tuple(dict.fromkeys(names))
