"""Which asymptote holds, and how wrong it is: `asymptotes`."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kvtheory.api._edge import double_precision, scene_of
from kvtheory.api._model_error import layer_notes
from kvtheory.api._steady import method_for
from kvtheory.models.steady.methods import METHODS
from kvtheory.results import AsymptoteReport
from kvtheory.results.presented import with_unit
from kvtheory.scene.arguments import a_scene, checked, number, replacements
from kvtheory.scene.foundations import EXTRAPOLATED, beyond, extrapolates
from kvtheory.scene.model import Scene

MINIMUM_TOLERANCE = 1e-10
"""Below it an asymptote cannot be distinguished from rounding."""


@checked(scene=a_scene, over=replacements, tolerance=number(MINIMUM_TOLERANCE, 1.0))
def asymptotes(
    scene: Scene | None = None,
    *,
    over: Mapping[str, Any] | None = None,
    tolerance: float = 0.05,
) -> AsymptoteReport:
    """Return which asymptote holds for a scene, its error and its range, and the friction maxima.

    Parameters
    ----------
    scene, over
        As in `steady`. The limits are known for a parabola and a ball on any foundation, and for a power law
        and a wedge on Kelvin-Voigt; on a Prony series they are those of F18, and the exact state of the
        Kelvin-Voigt foundation with the same K and C. The maxima are found for every scene; those of a
        profile of revolution beyond Kelvin-Voigt take minutes.
    tolerance
        Relative error up to which an asymptote is accepted, from 1e-10 to 1.

    Returns
    -------
    AsymptoteReport
        The velocity V* at which the asymptotes cross (Eqs. 47, 48; F5, F19-crossing), the regime, a line for
        each asymptote, and all maxima of friction over velocity, with their errors; of a parabola or a ball
        on a foundation given by a layer also the limits on the layer itself, in `layer`: mu -> tau_bar V/R
        and mu -> (r/V) 2 U_g/W, with the elastic energy U_g of the glassy contact.

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

    A fixed indenter has maxima too where the glassy stiffness is finite:

    >>> rubber = kv.GeneralizedMaxwell(1e10, arms=[["10 GN/m^3", "1 ms"], ["10 GN/m^3", "1 s"]])
    >>> found = kv.asymptotes(kv.Scene(foundation=rubber, support=kv.Fixed(depth="0.3 mm"))).maxima
    >>> [f"{mu:.4f} at {V:.4g} m/s" for V, mu in found]
    ['0.0341 at 0.0009755 m/s', '0.0202 at 1.138 m/s']

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038, Eqs. 40-48 and Table 2.
    """
    scene = scene_of(scene).replace(over or {})
    method = method_for(scene, None)
    from kvtheory.models.steady import maxima, regimes  # SciPy takes a while to import

    with double_precision(scene):
        found = maxima.report(scene, method)
        report = regimes.report(scene, tolerance, found, method)
        notes = [*report.notes, *_extrapolated(scene, report, method), beyond(scene.foundation)]
        if scene.foundation.modulus is not None:  # else no state need be solved again
            from kvtheory.layer.limits import limits

            state = METHODS[method](scene)
            notes += layer_notes(scene, state.depth, state.half_length)
            report = replace(report, layer=limits(scene))
        return replace(report, notes=tuple(filter(None, notes)))


def _extrapolated(scene: Scene, report: AsymptoteReport, method: str) -> list[str]:
    """Return a note on the maxima at which V/c is outside the frequencies of the measured foundation."""
    foundation, places = scene.foundation, []
    for V, _ in report.maxima if foundation.lowest_frequency is not None else ():
        # NaN for scenes of an array with fewer maxima
        state = METHODS[method](scene.at(np.where(np.isnan(V), 1.0, V)[()]))
        if extrapolates(foundation, V, state.trailing_edge - state.leading_edge):
            places.append(with_unit(V, "m/s"))
    message = f"At the friction maximum at V = {'; '.join(places)}, V/c is {EXTRAPOLATED}."
    return [message] if places else []
