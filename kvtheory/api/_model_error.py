"""How far the foundation of a scene that is given by a layer is from the layer itself, in steady sliding."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from kvtheory.models.steady import asymptotes
from kvtheory.scene.indenters import Parabola
from kvtheory.scene.layer import REST
from kvtheory.scene.model import Scene

MU = "friction_coefficient"
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


def model_note(scene: Scene) -> str:
    """Return how far the foundation is from the layer, or an empty text where that is not worth a note."""
    return note_of(errors_of(scene), scene, "throughout" if scene.shape else "here")


def note_of(errors: Mapping[str, float] | None, scene: Scene, where: str = "throughout") -> str:
    """Return the note that gives the errors of `errors_of`."""
    second = "load" if scene.held else "depth"
    mu, other = (errors[name] for name in (MU, second)) if errors else (0.0, 0.0)
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
