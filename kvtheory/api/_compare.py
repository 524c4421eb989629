"""A simulation compared with theory: `compare`."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.api._edge import double_precision, one_scene
from kvtheory.api._elements import PER_LENGTH, elements
from kvtheory.api._model_error import layer_notes
from kvtheory.api._stability import stability
from kvtheory.api._steady import steady
from kvtheory.checks.theory import TRIAL_RTOL, Methods, Theory
from kvtheory.progress import Progress
from kvtheory.results import SERIES_UNITS, DivergenceError, units_for
from kvtheory.results.comparison import Comparison
from kvtheory.results.table import SCHEME_ROWS
from kvtheory.scene.arguments import a_scene, callback, checked, choice, measured, number
from kvtheory.scene.capabilities import lacks_continuum, lacks_quadratic_on_arms, require
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

EVEN, DENSE = 401, 60
"""Output times of our simulation: evenly over the run, and more after each change of the drive."""
SOONEST, SOON = 1e-4, 0.1
"""First and last of the additional times after a change, as fractions of the duration."""
MAXIMUM_STEPS = 1e8
"""Largest number of time steps of our simulation: an hour or two."""
PER_HALF_LENGTH, OF_BALL = 400.0, 160.0
"""Elements per static half length where theory is a simulation: on refused arms, of a ball."""
COARSENING = 4.0
"""Factor by which trials of a diagnosis have fewer elements, as only their differences count."""
MINIMUM_TIMES = 16
"""Smallest number of output times, even if the time step has to be shortened for them."""


def _theory(scene: Scene, times: Sequence[float], rtol: float) -> Mapping[str, Any]:
    """Compute a transient without a certificate, as theory is needed for many trial scenes.

    A ball needs elements, unless it slides steadily at every instant. So do arms where the continuum refuses,
    as at a take-off, and in trials, where coarse elements are cheaper.
    """
    from kvtheory.ladder.series import never_steady, throughout
    from kvtheory.models.continuum import solved_scene

    ball = not scene.indenter.per_width
    if ball and not never_steady(scene):
        return throughout(steady, scene, np.asarray(times, dtype=float))[0]
    if scene.foundation.arms and not lacks_continuum(scene) and rtol < TRIAL_RTOL:
        with suppress(ValueError, ArithmeticError), double_precision(scene):
            return vars(solved_scene.transient(scene, times, rtol, certify=False))
    if ball or scene.foundation.arms:
        density = (OF_BALL if ball else PER_HALF_LENGTH) / StaticState.of(scene).half_length
        density /= COARSENING if rtol >= TRIAL_RTOL else 1.0
        return vars(elements(scene, per_length=density, at=times, certify=False))
    with double_precision(scene):
        return solved_scene.certified(scene, times, rtol, certify=False)[0].series(times)


def _rates(scene: Scene) -> NDArray[np.complex128]:
    """Return the rates of small motions about steady sliding (F22), in 1/s."""
    pairs = stability(scene, quantity="rates").rates
    return np.asarray(pairs[:, 0] + 1j * pairs[:, 1])


METHODS = Methods(_theory, steady, _rates)
"""The functions that compute theory."""


@checked(
    scene=a_scene, per_length=measured(PER_LENGTH), scheme=choice(SCHEME_ROWS), tolerance=number(0.0),
    progress=callback,
)  # fmt: skip
def compare(
    scene: Scene | None = None,
    data: Any = None,
    *,
    per_length: Any = None,
    scheme: str | None = None,
    tolerance: float = 1.0,
    progress: Progress | None = None,
) -> Comparison:
    """Compare a simulation with theory over the whole transient, and diagnose a disagreement.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. The indenter must be a parabola
        or a ball. For a ball, theory is a simulation with many elements, and `steady` at the end. A diagnosis
        of a ball, or on a Prony series, takes seconds: faults are tried with elements. With a spring in the
        drive the data may also hold ``sliding_velocity`` and ``spring_force``.
    data
        A path to a CSV with named columns and bracketed units (``t [ms], z_A [mm], F_z [N/mm]``), a result
        with the names of `transient`, or a mapping of arrays (by those names in SI, or with a bracketed
        unit). Without it, `elements` simulates the scene. Data with the columns velocity and friction
        coefficient, forces or depth, but no time, are steady states: each is compared with steady sliding at
        its velocity.
    per_length
        Elements per unit length of the simulation, in 1/m or as text such as ``"200 /mm"``, if known.
    scheme
        Its scheme, if known: ``"paper"`` fixes the time step at 2 dx/V.
    tolerance
        Factor on the differences that theory allows, above 0.
    progress
        Called as in `transient`, for our simulation and then for the faults that are tried.

    Returns
    -------
    Comparison
        The verdict, each check with its measured and its allowed value, and a diagnosis in words, which ends
        with how far a foundation given by a layer is from the layer.

    Raises
    ------
    ValueError
        If the data cannot be read, with the reason, or an argument is out of range.
    TypeError
        If `data` is of a type that cannot hold a series.
    ArithmeticError
        If the motion cannot be computed to the end of the data.

    Examples
    --------
    >>> import kvtheory as kv
    >>> sound = kv.transient(at=[i * 1e-3 for i in range(200)])
    >>> kv.compare(data=sound).verdict
    'agrees'
    >>> wrong = {"time": sound.time, "depth": sound.depth, "friction_force": -sound.friction_force}
    >>> found = kv.compare(data=wrong)
    >>> found.verdict, found.explanations[0].name
    ('disagrees', 'sign of friction_force')

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038; facts F8-F15 of the derivations.
    """
    scene = one_scene(scene, "a comparison")
    require(lacks_quadratic_on_arms, scene, "the theory of the transient")
    from kvtheory.checks.comparing import broken_off
    from kvtheory.checks.comparing import compare as compare_series
    from kvtheory.checks.measured_curve import compare as compare_curve
    from kvtheory.fitting.series import read

    report = progress or METHODS.tell
    own = 0.5 if data is None else 0.0
    methods = METHODS._replace(tell=lambda share, words: report(own + (1.0 - own) * share, words))
    theory = Theory(replace(scene, foundation=scene.foundation.elements), methods)

    def begun(share: float, words: str) -> None:
        report(own * share, words)

    try:
        found = _own_simulation(scene, per_length, scheme, begun) if data is None else data
    except DivergenceError as error:
        return broken_off(theory, error, scheme, tolerance)
    series = read(found, units_for(scene.indenter, SERIES_UNITS))
    if series.curve:
        judged, there = compare_curve(theory, series, tolerance), scene.at(series.time)
    else:
        judged, there = compare_series(theory, series, per_length, scheme, tolerance), scene
    return replace(judged, diagnosis=" ".join([judged.diagnosis, *layer_notes(there)]))


def _own_simulation(scene: Scene, per_length: Any, scheme: str | None, progress: Progress) -> Any:
    """Simulate the scene by elements, at times that are dense after each change of the drive.

    After each change they are an even number of steps apart, so that no step is shortened for them.
    """
    given = {"per_length": per_length, "scheme": scheme}
    chosen = {key: value for key, value in given.items() if value is not None}
    step = elements(scene, at=0.0, certify=False, **chosen).time_step  # no step is taken
    end = scene.run.duration
    if end > MAXIMUM_STEPS * step:
        raise ValueError(
            f"run.duration = {end!r} s is too long for our own simulation, by steps of "
            f"{step:.3g} s: give a shorter one, or `data`"
        )
    stride = min(2.0 * step, end / MINIMUM_TIMES)
    changes = [*(time for time in scene.changes if time < end), end]
    ticks = np.concatenate([[0.0], np.geomspace(SOONEST, SOON, DENSE), np.linspace(0.0, 1.0, EVEN)])
    times = {end}
    for start, stop in pairwise(changes):
        after = start + stride * np.unique(np.round(ticks * end / stride))
        times.update(after[after < stop - 0.5 * stride].tolist())
    return elements(scene, at=sorted(times), certify=False, progress=progress, **chosen)
