"""Which asymptote holds, and how wrong it is: `asymptotes`."""

from collections.abc import Mapping
from typing import Any

from kvtheory.api._edge import double_precision, scene_of
from kvtheory.results import AsymptoteReport
from kvtheory.scene.arguments import a_scene, checked, number, replacements
from kvtheory.scene.broadcasting import values
from kvtheory.scene.foundations import FractionalKelvinVoigt, GeneralizedMaxwell
from kvtheory.scene.model import Scene
from kvtheory.scene.requirements import lacks_limits, require

MINIMUM_TOLERANCE = 1e-10
"""Smallest tolerance: below it an asymptote cannot be distinguished from rounding."""


@checked(scene=a_scene, over=replacements, tolerance=number(MINIMUM_TOLERANCE, 1.0))
def asymptotes(
    scene: Scene | None = None,
    *,
    over: Mapping[str, Any] | None = None,
    tolerance: float = 0.05,
) -> AsymptoteReport:
    """Return which asymptote holds for a scene, its error, and the velocities at which it holds.

    Parameters
    ----------
    scene, over
        As in `steady`; the indenter must be a parabola, a power law, a wedge or a ball on a Kelvin-Voigt
        foundation, or a parabola on any foundation. On a Prony series the lines are the limits of F18, and
        the exact state of the Kelvin-Voigt foundation with the same K and C.
    tolerance
        Relative error up to which an asymptote is accepted, from 1e-10 to 1.

    Returns
    -------
    AsymptoteReport
        The velocity V* at which the asymptotes cross (Eqs. 47, 48; F5, F19-crossing), the regime, and a line
        for each asymptote: its value, the exact value, the relative error and the velocities where that is
        within the tolerance. For a dead weight also the friction maximum, unless the indenter is a wedge.

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
    require(lacks_limits, scene, "the theory of asymptotes")
    # SciPy takes a while to import
    from kvtheory.models.steady import fractional_limits, prony_limits, regimes

    reports = {GeneralizedMaxwell: prony_limits, FractionalKelvinVoigt: fractional_limits}
    with double_precision(scene, over):
        report = reports.get(type(scene.foundation), regimes).report
        return report(scene, values(scene, over), tolerance)
