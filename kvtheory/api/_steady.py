"""Steady sliding: `steady` and `asymptotes`."""

from collections.abc import Mapping
from typing import Any

from kvtheory.api._edge import double_precision, scene_of
from kvtheory.models.steady.methods import METHODS
from kvtheory.results import AsymptoteReport, SteadyState
from kvtheory.scene.broadcasting import values
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import nearest
from kvtheory.scene.requirements import lacks_parabola, require_parabola

MINIMUM_TOLERANCE = 1e-10
"""Asymptotes that must be closer than this are not told apart from rounding."""


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
        is taken at its final velocity; for one that is a function, `over` must give the velocity.
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
    QuadratureError
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
    scene = scene_of(scene)
    chosen = method_for(scene, method)
    with double_precision():
        return METHODS[chosen](scene, values(scene, over))


def method_for(scene: Scene, method: str | None) -> str:
    """Return the method of steady sliding that is asked for, or else the one that suits the shape."""
    lacking = lacks_parabola(scene)
    method = method or ("quadrature" if lacking else "exact")
    if method not in METHODS:
        raise ValueError(f'`method` = "{method}": {nearest(method, METHODS)}')
    if method != "quadrature" and lacking:
        raise ValueError(f'`method` = "{method}" {lacking}; use method = "quadrature"')
    return method


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
    scene = scene_of(scene)
    if not MINIMUM_TOLERANCE <= tolerance <= 1.0:
        raise ValueError(
            f"`tolerance` = {tolerance!r}: expected a number from {MINIMUM_TOLERANCE} to 1"
        )
    require_parabola(scene, "the theory of asymptotes")
    from kvtheory.models.steady import regimes  # it imports SciPy, which takes a while

    with double_precision():
        return regimes.report(scene, values(scene, over), tolerance)
