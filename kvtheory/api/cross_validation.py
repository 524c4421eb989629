"""A simulation held against theory: `compare`."""

import math
from typing import Any

from kvtheory.api.edge import scene_of
from kvtheory.api.steady_sliding import steady
from kvtheory.api.whole_transient import transient
from kvtheory.results.comparison import Comparison
from kvtheory.scene.fields import Quantity, SceneError, convert, problem
from kvtheory.scene.indenters import Parabola
from kvtheory.scene.model import Scene

EVEN, DENSE = 401, 60
"""Samples of our own simulation: over the run, and more after each change of the drive."""
SOONEST, SOON = 1e-4, 0.1
"""Of the duration: where the latter begin and end."""
TICKS = 6
"""Digits of these times, in units of the duration: closer ones are one."""
PER_LENGTH = Quantity("1/m", "N, elements per unit length", 0.0, True)


def compare(
    scene: Scene | None = None,
    data: Any = None,
    *,
    per_length: Any = None,
    scheme: str | None = None,
    tolerance: float = 1.0,
) -> Comparison:
    """Hold a simulation against theory, across the whole transient, and say what is wrong with it.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. The indenter must be a
        parabola, and the drive a velocity or a history.
    data
        A path to a CSV with named columns and bracketed units (``t [ms], z_A [mm], F_z [N/mm]``), a
        result with the names of `kvtheory.transient`, or a mapping of arrays (by those names in SI,
        or with a bracketed unit). Without it, `kvtheory.elements` simulates the scene.
    per_length
        Elements per unit length of the simulation, in 1/m or as text such as ``"200 /mm"``, if known.
    scheme
        Its scheme, if known: ``"paper"`` fixes the time step at 2 dx/V.
    tolerance
        Multiplies what theory allows.

    Returns
    -------
    Comparison
        The verdict, each check with what was measured and what is allowed, and a diagnosis in words.

    Raises
    ------
    ValueError
        If the data cannot be read, saying what is wrong with them, or an argument is out of range.
    TypeError
        If `data` is nothing that can hold a series.
    ArithmeticError
        If the theory cannot be followed to the end of the data.

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
    scene = scene_of(scene)
    if not isinstance(scene.indenter, Parabola):
        raise ValueError(
            f"the theory of the transient holds for the parabola only, not for indenter.shape = "
            f'"{scene.indenter.shape}"'
        )
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise ValueError(f"`tolerance` = {tolerance!r}: expected a positive number")
    density = None if per_length is None else _density(per_length)
    from kvtheory.checks.comparing import compare as hold_against
    from kvtheory.checks.reading import read

    series = read(_simulated(scene, per_length, scheme) if data is None else data)
    return hold_against(scene, series, transient, steady, density, scheme, tolerance)


def _density(per_length: Any) -> float:
    try:
        return convert(per_length, PER_LENGTH)
    except ValueError as error:
        raise SceneError([problem("`per_length`", per_length, str(error))]) from None


def _simulated(scene: Scene, per_length: Any, scheme: str | None) -> Any:
    """Simulate the scene by our own elements."""
    from kvtheory.api.discrete import elements

    given = {"per_length": per_length, "scheme": scheme}
    chosen = {key: value for key, value in given.items() if value is not None}
    return elements(scene, at=_times(scene), certify=False, **chosen)


def _times(scene: Scene) -> list[float]:
    """Return the times at which our own simulation is judged: dense after each change of the drive."""
    import numpy as np

    end = scene.run.duration
    changes = sorted({time for time, _ in scene.drive.points if time < end})
    after = [time / end + np.geomspace(SOONEST, SOON, DENSE) for time in changes]
    ticks = np.unique(np.concatenate([np.linspace(0.0, 1.0, EVEN), *after]).round(TICKS))
    near = {round(time / end, TICKS): time for time in changes}  # the same time, up to rounding
    return [near.get(tick, tick * end) for tick in ticks.tolist() if tick <= 1.0]
