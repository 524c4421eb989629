"""How wrong independent elements with the K of the contact at rest are on a layer: the error of the model."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from kvtheory.layer.limits import limits
from kvtheory.scene.layer import REST
from kvtheory.scene.model import Scene

SMALL = 0.01
"""Error of the model up to which it is not worth a note."""


def model_error(scene: Scene) -> tuple[Any, Any] | None:
    """Return the relative errors of friction coefficient, and of depth (held: of load), on the foundation.

    They are those of steady sliding on independent elements against the layer. None where the scene is not
    given by a layer, or takes it as a thin one.
    """
    foundation, indenter = scene.foundation, scene.indenter
    if foundation.stiffness_from != REST:
        return None
    known = limits(scene)
    none = np.zeros(scene.shape)
    depth = static_depth(scene)
    h = foundation.thickness / np.sqrt(2.0 * indenter.radius * depth)
    ratio = none if known is None else np.abs(scene.drive.final_velocity) / known.critical_velocity
    width = 1.0 + sum(arm.stiffness / foundation.stiffness for arm in foundation.arms)
    given = np.broadcast_arrays(h + none, foundation.poisson_ratio, ratio, width)
    return _relative_error("line" if indenter.per_width else "ball", *given)


def static_depth(scene: Scene) -> Any:
    """Return the depth at rest."""
    if scene.held:
        return scene.support.depth
    R, K, W = scene.indenter.radius, scene.foundation.stiffness, scene.support.weight
    return (
        np.cbrt(1.5 * R * W / K) ** 2 / (2.0 * R)
        if scene.indenter.per_width
        else np.sqrt(W / (math.pi * K * R))
    )


def _relative_error(kind: str, h: Any, nu: Any, ratio: Any, width: Any) -> tuple[Any, Any]:
    bounds = np.searchsorted([2.0, 6.0], h)
    table = {"ball": ([0.06, 0.08, 0.18], [0.13, 0.25, 0.30]), "line": ([0.2] * 3, [0.35] * 3)}
    thin = h * h <= 0.1 * (1.0 - 2.0 * nu)
    mu, depth = (np.where(thin, 0.01, np.array(row)[bounds]) for row in table[kind])
    return mu, depth


def model_note(scene: Scene) -> str:
    """Return how far the foundation is from the layer, or an empty text where that is not worth a note."""
    error = model_error(scene)
    if error is None or max(np.max(each, initial=0.0) for each in error) <= SMALL:
        return ""
    mu, depth = (f"{100.0 * np.max(each):.2g} %" for each in error)
    second = "load" if scene.held else "depth"
    where = "throughout" if scene.shape else "here"
    return (
        f"The foundation gives mu within {mu}, {second} within {depth} {where}, against the layer itself, "
        "which the method `layer` of `steady` solves."
    )


def errors_of(scene: Scene) -> Mapping[str, float] | None:
    """Return the error of the model for the quantities of one scene for which it is known, or None."""
    error = model_error(scene)
    if error is None:
        return None
    mu, second = map(float, error)
    own, other = ("load", "depth") if scene.held else ("depth", "load")
    carried = 0.0 if scene.held or not np.any(scene.support.spring) else second
    force = mu + (second if scene.held else carried)
    return {"friction_coefficient": mu, "friction_force": force, own: second, other: carried}
