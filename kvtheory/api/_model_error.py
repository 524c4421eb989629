"""How far the foundation of a scene is from the layer that gives it, and that layer from small strains."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kvtheory.models.steady import asymptotes
from kvtheory.models.steady.methods import METHODS
from kvtheory.scene.capabilities import lacks_closed_form
from kvtheory.scene.drives import Drive
from kvtheory.scene.indenters import Parabola
from kvtheory.scene.layer import (
    REST,
    THIN_WAY,
    deformation,
    large_deformation,
    layer_number,
    thick_layer,
)
from kvtheory.scene.model import Fixed, Scene
from kvtheory.scene.start import REST as AT_REST

MU = "friction_coefficient"
LAYER_NUMBER = "layer_number"
SMALL = 0.03
"""Error of the model up to which it is not worth a note: the map adds 2 % to what it finds."""


def model_error(scene: Scene) -> tuple[Any, Any] | None:
    """Return bounds of the relative errors of friction coefficient, and of depth (held: of load).

    They are those of steady sliding on independent elements against the layer, by the map of
    `kvtheory.layer.model_error`; infinite where no bound is known. None where the scene is not given by a
    layer, or takes it as a thin one.
    """
    foundation, none = scene.foundation, np.zeros(scene.shape)
    if foundation.stiffness_from != REST:
        return None
    if foundation.springpot or foundation.stiffness is None:
        return none + math.inf, none + math.inf
    from kvtheory.layer.model_error import relative_error, spectrum, stiffening_at

    if scene.indenter.per_width:  # a circle is taken as its parabola
        scene = replace(scene, indenter=Parabola(scene.indenter.radius))
    _, half_length = asymptotes.at_rest(scene)
    arms = [(arm.stiffness / foundation.stiffness, arm.relaxation_time) for arm in foundation.arms]
    V = np.abs(scene.drive.final_velocity)
    kind = "line" if scene.indenter.per_width else "ball"
    given = (
        kind,
        foundation.thickness / half_length,
        foundation.poisson_ratio,
        V / asymptotes.critical_velocity(scene),
        *spectrum(arms),
        stiffening_at(arms, V / half_length),
    )
    friction, second = relative_error(*given, held=scene.held)
    if not scene.held and np.any(scene.support.spring):  # between a dead weight and a given depth
        other = relative_error(*given, held=True)
        friction, second = np.maximum(friction, other[0]), np.maximum(second, other[1])
    return friction + none, second + none


def layer_notes(
    scene: Scene, depth: Any = None, half_length: Any = None, *, on_body: bool = False
) -> tuple[str, ...]:
    """Return notes on a scene that is given by a layer; arguments as in `layer_numbers`."""
    return notes_of(layer_numbers(scene, depth, half_length, on_body=on_body), scene)


def layer_numbers(
    scene: Scene, depth: Any = None, half_length: Any = None, *, on_body: bool = False
) -> dict[str, Any]:
    """Return the numbers from which notes on a layer follow, by name, or none for a scene without a layer.

    These are strain and slope of a contact, by default of that at rest; and, unless the layer itself is
    solved (`on_body`), how thin it is for that contact, or the errors of `errors_of`.
    """
    foundation = scene.foundation
    if foundation.modulus is None:
        return {}
    if not scene.drive.ends:
        scene = replace(scene, drive=Drive(velocity=0.0))
    if depth is None:
        if foundation.stiffness is None:  # of a shape whose contact at rest is not known
            return dict(errors_of(scene) or {})
        depth, half_length = _at_rest(scene)
    found = deformation(scene.indenter, foundation.thickness, depth, half_length)
    if on_body:
        return found
    if foundation.stiffness_from == THIN_WAY:
        shortest = half_length * np.minimum(1.0, getattr(scene.indenter, "stretch", 1.0))
        given = foundation.thickness, shortest, foundation.poisson_ratio
        return found | {LAYER_NUMBER: layer_number(*given)}
    return found | dict(errors_of(scene) or {})


def largest(numbers: Mapping[str, Any]) -> dict[str, float]:
    """Return the largest of each of the numbers of several scenes; NaN, without a contact, does not count."""
    return {name: float(np.nanmax(values)) for name, values in numbers.items()}


def _at_rest(scene: Scene) -> tuple[Any, Any]:
    """Return depth and half length at rest, of a given depth over time at the largest one."""
    support = Fixed(+scene.support.depth) if scene.depths else scene.support
    still = replace(scene, drive=Drive(velocity=0.0), start=AT_REST, support=support)
    state = METHODS["quadrature" if lacks_closed_form(still) else "exact"](still)
    return state.depth, state.half_length


def notes_of(numbers: Mapping[str, Any], scene: Scene, several: bool = False) -> tuple[str, ...]:
    """Return the notes that numbers of `layer_numbers` give, or the largest ones of `several` scenes."""
    if not numbers:
        return ()
    where = "throughout" if several or scene.shape else "here"
    notes = (
        large_deformation(numbers.get("strain", 0.0), numbers.get("slope", 0.0), several),
        thick_layer(numbers.get(LAYER_NUMBER, 0.0), several),
        _error_note(numbers, scene, where) if MU in numbers else "",
    )
    return tuple(filter(None, notes))


def _error_note(errors: Mapping[str, float], scene: Scene, where: str) -> str:
    """Return the note that gives the errors of `errors_of`, or an empty text where they are small."""
    second = "load" if scene.held else "depth"
    mu, other = errors[MU], errors[second]
    if max(mu, other) <= SMALL:
        return ""
    layer = "the method `layer` of `steady` solves the layer itself."
    if math.isinf(mu):
        return f"How far the foundation is from its layer is not known here; {layer}"
    within = f"mu within {100.0 * mu:.2g} %, {second} within {100.0 * other:.2g} %"
    return f"The foundation gives {within} {where}; {layer}"


def errors_of(scene: Scene) -> Mapping[str, float] | None:
    """Return the error of the model by quantity, the largest of several scenes, or None if it has none."""
    error = model_error(scene)
    if error is None:
        return None
    mu, second = (float(np.max(each, initial=0.0)) for each in error)
    own, other = ("load", "depth") if scene.held else ("depth", "load")
    carried = second if not scene.held and np.any(scene.support.spring) else 0.0
    force = mu + (second if scene.held else carried)
    return {MU: mu, "friction_force": force, own: second, other: carried}
