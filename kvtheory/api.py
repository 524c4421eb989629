"""What users call: a scene in, a result out, by the method asked for."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from kvtheory.results import AsymptoteReport, SteadyState, Transient
from kvtheory.scene.fields import SceneError, convert, nearest, problem
from kvtheory.scene.indenters import Parabola
from kvtheory.scene.model import TIME, Scene
from kvtheory.scene.over import values
from kvtheory.steady_state.methods import METHODS

MINIMUM_TOLERANCE = 1e-10
"""Asymptotes that must be closer than this are not told apart from rounding."""

MINIMUM_RTOL, MAXIMUM_RTOL = 1e-12, 1e-2
"""Beyond these, rounding or the first step would decide."""


def steady(
    scene: Scene | None = None,
    *,
    over: Mapping[str, Any] | None = None,
    method: str | None = None,
) -> SteadyState:
    """Return the state of steady sliding.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. A drive with a history
        is taken at its final velocity.
    over
        Values that replace those of the scene, by dotted key as in the scene file, such as
        ``{"drive.velocity": np.geomspace(1e-3, 10)}``: SI numbers, arrays of them, or text with a
        unit. Arrays broadcast against each other.
    method
        ``"exact"`` (parabola; the default for it), ``"quadrature"`` (any shape; the default for the
        others) or ``"asymptote"`` (parabola; the one of the regime in which the velocity lies).

    Returns
    -------
    SteadyState
        Floats, or arrays of the broadcast shape, in SI units, with a certificate.

    Raises
    ------
    SceneError
        If a value or a key of `over` is wrong; every mistake is listed.
    ValueError
        If the method does not exist or does not cover the shape of the indenter.
    kvtheory.steady_state.quadrature.QuadratureError
        If a quadrature or a root finder does not reach its tolerance.

    Examples
    --------
    >>> import kvtheory as kv
    >>> print(f"{kv.steady().friction_coefficient:.6f}")
    0.085709
    >>> kv.steady(over={"drive.velocity": [0.0, 0.1, -0.1]}).friction_force.round(3).tolist()
    [0.0, 840.521, -840.521]

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038, Eqs. 26-49.
    """
    scene = _scene(scene)
    parabolic = isinstance(scene.indenter, Parabola)
    method = method or ("exact" if parabolic else "quadrature")
    if method not in METHODS:
        raise ValueError(f'`method` = "{method}": {nearest(method, METHODS)}')
    if method != "quadrature" and not parabolic:
        raise ValueError(
            f'`method` = "{method}" holds for the parabola only, not for indenter.shape = '
            f'"{scene.indenter.shape}"; use method = "quadrature"'
        )
    with _double_precision():
        return METHODS[method](scene, values(scene, over))


def asymptotes(
    scene: Scene | None = None,
    *,
    over: Mapping[str, Any] | None = None,
    tolerance: float = 0.05,
) -> AsymptoteReport:
    """Say which asymptote holds for a scene, how wrong it is, and over which velocities.

    Parameters
    ----------
    scene, over
        As in `steady`; the indenter must be a parabola.
    tolerance
        Relative error up to which an asymptote counts as good, from 1e-10 to 1.

    Returns
    -------
    AsymptoteReport
        The critical velocity V* (theorem F5), the regime, and a line for each asymptote: its value,
        the exact value, the relative error and the velocities where that is within the tolerance.

    Raises
    ------
    SceneError, ValueError
        As in `steady`, or if the tolerance is out of range.

    Examples
    --------
    >>> import kvtheory as kv
    >>> report = kv.asymptotes(over={"drive.velocity": "1 mm/s"})
    >>> report.regime, report.use
    ('low', 'L1')
    >>> l1 = report.lines[0]
    >>> print(f"{l1.value:.6f} {l1.exact:.6f} {l1.relative_error:.4f} {l1.velocity_max:.6f} m/s")
    0.010000 0.009694 0.0315 0.001559 m/s

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038, Eqs. 40-48 and Table 2.
    """
    scene = _scene(scene)
    if not MINIMUM_TOLERANCE <= tolerance <= 1.0:
        raise ValueError(
            f"`tolerance` = {tolerance!r}: expected a number from {MINIMUM_TOLERANCE} to 1"
        )
    if not isinstance(scene.indenter, Parabola):
        raise ValueError(
            "the asymptotes hold for the parabola only, not for indenter.shape = "
            f'"{scene.indenter.shape}"'
        )
    from kvtheory.steady_state import regimes  # it imports SciPy, which takes a while

    with _double_precision():
        return regimes.report(scene, values(scene, over), tolerance)


def transient(scene: Scene | None = None, *, at: Any = None, rtol: float = 1e-6) -> Transient:
    """Follow the transient of a scene, exactly: no discretized foundation.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. The indenter must be
        a parabola. At t < 0 it rests at its static depth.
    at
        Times at which the result is wanted, in s or as text with a unit; without it, the steps of
        the solver, subdivided.
    rtol
        Error allowed in a step, relative to the static state, from 1e-12 to 1e-2.

    Returns
    -------
    Transient
        Arrays over time in SI, the events of the contact, and a certificate whose errors are
        relative to the static depth, half length and load.

    Raises
    ------
    SceneError
        If a time is wrong; every mistake is listed.
    ValueError
        If the indenter is not a parabola, or a time or `rtol` is out of range.
    ArithmeticError
        If the motion cannot be followed to its end; the message says when and why.

    Examples
    --------
    >>> import kvtheory as kv
    >>> result = kv.transient(at=["0 ms", "1 ms", "200 ms"])
    >>> (result.normal_force / 1e3).round(2).tolist()
    [35.37, 12.73, 9.81]
    >>> (result.friction_force / 1e3).round(2).tolist()
    [5.35, 2.35, 0.84]

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038, Eqs. 1-33 and Figs. 3, 4.
    """
    scene = _scene(scene)
    if not MINIMUM_RTOL <= rtol <= MAXIMUM_RTOL:
        raise ValueError(
            f"`rtol` = {rtol!r}: expected a number from {MINIMUM_RTOL} to {MAXIMUM_RTOL}"
        )
    if not isinstance(scene.indenter, Parabola):
        raise ValueError(
            "the transient is solved for the parabola only, not for indenter.shape = "
            f'"{scene.indenter.shape}"'
        )
    from kvtheory.transients import solution

    with _double_precision():
        return solution.transient(scene, None if at is None else _times(scene, at), rtol)


def _scene(scene: Scene | None) -> Scene:
    if scene is not None and not isinstance(scene, Scene):
        raise TypeError(
            f"expected a Scene, got {scene!r}; kvtheory.load_scene reads one from a file"
        )
    return Scene() if scene is None else scene


def _times(scene: Scene, at: Any) -> Any:
    """Return the times in s, checked against the duration of the run."""
    problems, times = [], []
    for value in [at] if isinstance(at, str) or np.ndim(at) == 0 else at:
        try:
            times.append(convert(value, TIME))
            if times[-1] > scene.run.duration:
                raise ValueError(
                    f"is after the end of the run, run.duration = {scene.run.duration} s"
                )
        except ValueError as error:
            problems.append(problem("`at`", value, str(error)))
    if not times and not problems:
        problems.append('`at` is empty: expected times such as "0 ms,1 ms"')
    if problems:
        raise SceneError(problems)
    return times


@contextmanager
def _double_precision() -> Iterator[None]:
    """Turn an overflow anywhere in a calculation into an error about the scene."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (FloatingPointError, OverflowError, ZeroDivisionError) as error:
        raise ValueError(f"the scene leaves the range of double precision: {error}") from None
