"""Steady sliding: `steady`, and the footprint of a ball: `footprint`."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kvtheory.api._edge import double_precision, layer_note, one_scene, scene_of
from kvtheory.models.steady.ball import Footprint
from kvtheory.models.steady.methods import METHODS
from kvtheory.models.steady.stable_sliding import lasts
from kvtheory.results import SteadyState
from kvtheory.scene.arguments import a_scene, checked, choice, replacements
from kvtheory.scene.capabilities import (
    lacks_asymptotes,
    lacks_ball,
    lacks_closed_form,
    lacks_quadrature,
    require,
)
from kvtheory.scene.foundations import beyond, extrapolates
from kvtheory.scene.model import Scene

LACKS = {"exact": lacks_closed_form, "quadrature": lacks_quadrature, "asymptote": lacks_asymptotes}
"""By method, why it does not apply to a scene."""


@checked(scene=a_scene, over=replacements, method=choice(LACKS))
def steady(
    scene: Scene | None = None,
    *,
    over: Mapping[str, Any] | None = None,
    method: str | None = None,
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
        others) or ``"asymptote"`` (of the regime of the velocity; shapes as ``"exact"``, on Kelvin-Voigt).

    Returns
    -------
    SteadyState
        Floats, or arrays of the broadcast shape, in SI, with a certificate; with a spring in the drive also
        whether steady sliding is stable, as in `stability`. Its `notes` say if it is not, if a foundation
        given as a layer is not thin for its contact, and if V/c is outside the frequencies, or the
        temperature outside the temperatures, at which the foundation was measured.

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
    scene = scene_of(scene).replace(over or {})
    solve = METHODS[method_for(scene, method)]
    with double_precision(scene):
        state = solve(scene)
        if not scene.drive.rigid:
            state = replace(state, stable=lasts(scene))
            state = replace(state, notes=tuple(filter(None, [state.unstable])))
        if scene.shape:
            specs, arrays = scene.replaceable, scene.arrays()
            units = {**state.units, **{key: specs[key].unit for key in arrays}}
            varied = {key: np.broadcast_to(array, scene.shape) for key, array in arrays.items()}
            state = replace(state, over=varied, units=units)
        length = state.trailing_edge - state.leading_edge
        notes = [
            extrapolates(scene.foundation, scene.drive.final_velocity, length),
            layer_note(scene, state.half_length),
            beyond(scene.foundation),
        ]
        return replace(state, notes=(*state.notes, *filter(None, notes))) if any(notes) else state


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


def method_for(scene: Scene, method: str | None) -> str:
    """Return the requested method of steady sliding, or by default the one that suits the scene."""
    lacking = {name: lacks(scene) for name, lacks in LACKS.items()}
    method = method or ("quadrature" if lacking["exact"] else "exact")
    if lacking[method]:
        others = [name for name in ("exact", "quadrature") if not lacking[name]]
        hint = f'; use `method` = "{others[0]}"' if others else ""
        raise ValueError(f'`method` = "{method}" {lacking[method]}{hint}')
    return method
