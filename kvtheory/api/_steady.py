"""Steady sliding: `steady`, and the footprint of a ball: `footprint`."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from kvtheory.api._edge import double_precision, one_scene, scene_of, varied
from kvtheory.api._model_error import layer_notes
from kvtheory.models.steady.ball import Footprint
from kvtheory.models.steady.methods import METHODS
from kvtheory.models.steady.stable_sliding import lasts
from kvtheory.progress import Progress, silent
from kvtheory.results import SteadyState
from kvtheory.scene.arguments import a_scene, callback, checked, choice, replacements
from kvtheory.scene.capabilities import (
    lacks_asymptotes,
    lacks_ball,
    lacks_body,
    lacks_closed_form,
    lacks_quadrature,
    require,
)
from kvtheory.scene.foundations import beyond, extrapolates
from kvtheory.scene.model import Scene

BODY = "layer"
"""The method that solves the body itself, not its foundation."""
LACKS = {
    "exact": lacks_closed_form, "quadrature": lacks_quadrature, "asymptote": lacks_asymptotes,
    BODY: lacks_body,
}  # fmt: skip
"""By method, why it does not apply to a scene."""


@checked(scene=a_scene, over=replacements, method=choice(LACKS), progress=callback)
def steady(
    scene: Scene | None = None,
    *,
    over: Mapping[str, Any] | None = None,
    method: str | None = None,
    progress: Progress | None = None,
) -> SteadyState:
    """Return the state of steady sliding.

    With the pressure p = K (delta - h(x) - V tau h'(x)) on Kelvin-Voigt between the edges, the load is
    W = int p dx, the friction force F = -int h' p dx, and the friction coefficient F/W.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. A history is taken at its final
        velocity; for a drive that is a function, `over` must give the velocity.
    over
        Values that replace those of the scene, by dotted key as in the scene file, such as
        ``{"drive.velocity": np.geomspace(1e-3, 10)}``: SI numbers, arrays of them, or text with a unit.
        Arrays broadcast against each other.
    method
        ``"exact"`` (parabola and ball on any foundation, power law and wedge on Kelvin-Voigt; the default for
        them), ``"quadrature"`` (any shape on Kelvin-Voigt; beyond it shapes that are convex where they
        touch, also revolved, which takes seconds, of functions with kinks minutes; the default for the
        others), ``"asymptote"`` (of the regime of the velocity; shapes as ``"exact"``, on Kelvin-Voigt) or
        ``"layer"``: the body itself instead of independent elements, a bonded layer of any thickness, by
        boundary elements (convex shapes; a foundation given by modulus, thickness and Poisson's ratio, with a
        damper or arms). It takes up to a second for a line contact and some seconds for a ball.
    progress
        Called with the share done and a text by ``"layer"``: `kvtheory.progress.progress_bar` provides one.

    Returns
    -------
    SteadyState
        Floats, or arrays of the broadcast shape, in SI, with a certificate; with a spring in the drive also
        whether steady sliding is stable, as in `stability`. Its `notes` say if it is not, how far a
        foundation given by a layer is from the layer itself, or, taken as thin, that it is not, if the layer
        is strained beyond linear theory, and if V/c is outside the frequencies, or the temperature outside
        the temperatures, at which the foundation was measured. By ``"layer"`` the half length is that of the
        body at rest at this depth, stability on a spring is not known, and `dissipated_in_contact` is NaN.

    Raises
    ------
    SceneError
        If a value or a key of `over` is wrong; every mistake is listed.
    ValueError
        If the method does not exist or does not cover the shape of the indenter.
    QuadratureError
        If a quadrature or a root finder does not reach its tolerance.
    ToleranceError
        If the finest cells of ``"layer"`` leave an error above 0.1 %, of a ball 1 %.

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
    scene = scene_of(scene).replace(over or {})
    return by_method(scene, method_for(scene, method), progress=progress or silent)


def by_method(scene: Scene, method: str, **wanted: Any) -> SteadyState:
    """Return `steady` by a method that applies; `wanted` is what `"layer"` takes beside the scene."""
    with double_precision(scene):
        state = _on_body(scene, **wanted) if method == BODY else METHODS[method](scene)
        if not scene.drive.rigid:
            state = replace(state, stable=None if method == BODY else lasts(scene))
            state = replace(state, notes=(*state.notes, *filter(None, [state.unstable])))
        if scene.shape:
            state = replace(state, **varied(scene, state.units))
        length = state.trailing_edge - state.leading_edge
        notes = [
            extrapolates(scene.foundation, scene.drive.final_velocity, length),
            *layer_notes(scene, state.depth, state.half_length, on_body=method == BODY),
            beyond(scene.foundation),
            _of_function(scene),
        ]
        return replace(state, notes=(*state.notes, *filter(None, notes))) if any(notes) else state


def _of_function(scene: Scene) -> str:
    """Return how far a series may be from the relaxation function that it stands for, or an empty text."""
    known = scene.indenter.shape == "parabola" and scene.support.kind == "dead-weight"
    bound = getattr(scene.foundation, "friction_bound", 0.0) if known else 0.0
    of = "mu of the relaxation function itself, under this load, differs by at most"
    return f"{of} {bound:.2g} of it (F27)." if bound else ""


@checked(scene=a_scene, over=replacements)
def footprint(scene: Scene | None = None, *, over: Mapping[str, Any] | None = None) -> Footprint:
    """Return the contact area of a ball in steady sliding, and the pressure in it.

    Parameters
    ----------
    scene, over
        As in `steady`, without arrays; the indenter must be a ball on a Kelvin-Voigt foundation.

    Returns
    -------
    Footprint
        With `edges(y)`, the leading and trailing edge of the strip at y, and `pressure` at any point, in SI.

    Raises
    ------
    SceneError, ValueError
        As in `steady`, or if the indenter is not a ball.

    Examples
    --------
    >>> import kvtheory as kv
    >>> ball = kv.Scene(indenter=kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
    >>> found = kv.footprint(ball)
    >>> [f"{float(edge) * 1e3:.4f} mm" for edge in found.edges(0.5 * found.half_width)]
    ['-0.9636 mm', '0.0463 mm']

    References
    ----------
    Theorem F20 of the derivations.
    """
    scene = one_scene(scene_of(scene).replace(over or {}), "the footprint")
    require(lacks_ball, scene, "the footprint")
    state, sign = steady(scene), -1.0 if scene.drive.final_velocity < 0.0 else 1.0
    return Footprint(
        radius=scene.indenter.radius, stiffness=scene.foundation.stiffness,
        half_length=state.half_length, half_width=state.half_length * scene.indenter.stretch,
        retardation_length=state.retardation_length * sign,
    )  # fmt: skip


def _on_body(scene: Scene, progress: Progress, **wanted: Any) -> SteadyState:
    """Solve the body itself."""
    from kvtheory.layer.answer import solve  # SciPy takes a while to import

    return solve(scene, progress, **wanted)


def method_for(scene: Scene, method: str | None) -> str:
    """Return the requested method of steady sliding, or by default the one that suits the scene."""
    lacking = {name: lacks(scene) for name, lacks in LACKS.items()}
    asked, method = method, method or ("quadrature" if lacking["exact"] else "exact")
    if lacking[method]:
        others = [name for name in ("exact", "quadrature") if not lacking[name]]
        hint = f'; use `method` = "{others[0]}"' if others else ""
        what = f'`method` = "{asked}"' if asked else "steady sliding on independent elements"
        raise ValueError(f"{what} {lacking[method]}{hint}")
    return method
