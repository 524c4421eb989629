"""The methods of steady sliding, and the choice among them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np

from kvtheory.models.steady import (
    asymptotes,
    ball,
    ball_asymptotes,
    ball_viscoelastic,
    exact,
    power_law,
    viscoelastic,
)
from kvtheory.models.steady.blockwise import evaluate
from kvtheory.results import STEADY_UNITS, Certificate, SteadyState, units_for
from kvtheory.scene.capabilities import lacks_kelvin_voigt
from kvtheory.scene.model import Scene

CLOSED: Mapping[str, Any] = {
    "parabola": exact,
    "power-law": power_law,
    "wedge": power_law,
    "sphere": ball,
}
"""The closed forms on Kelvin-Voigt by shape; `kvtheory.scene.capabilities` lists the same shapes."""
MOMENTS: Mapping[str, Any] = {"parabola": viscoelastic, "sphere": ball_viscoelastic}
"""The shapes that need no more than the moments of the relaxation function, on any foundation."""

COLUMN = 256
"""Scenes that are integrated at once: their nodes then fit into the second-level cache of a core."""
ROUNDING = 64 * 2.0**-52
"""Rounding error of an asymptote and of its error, about twenty operations each."""


def asymptotes_of(scene: Scene) -> ModuleType:
    """Return the asymptotes that hold for a scene, and their errors."""
    return asymptotes if scene.indenter.per_width else ball_asymptotes


def solve_exact(scene: Scene) -> SteadyState:
    """Evaluate the closed forms, or the moments of the relaxation function."""
    family = (MOMENTS if lacks_kelvin_voigt(scene) else CLOSED)[scene.indenter.shape]
    return evaluate(
        family.quantities,
        scene,
        family.HELD if scene.held else family.CARRIED,
        family.OWN_ERRORS,
        floats=family is exact,
    )


def solve_quadrature(scene: Scene) -> SteadyState:
    """Integrate the pressure of any indenter: in columns if it is a convex line, else scene by scene.

    A scene that fails fails the call.
    """
    shape = scene.shape
    if not shape:
        return _integrated(scene)
    if 0 in shape:
        return solve_exact(Scene().at(np.empty(shape)))
    flat, count = scene.flat(), math.prod(shape)
    line = scene.indenter.per_width and scene.indenter.convex
    if line and not lacks_kelvin_voigt(scene):
        parts = [
            flat.rows(slice(i, i + COLUMN)).mapped(lambda x: x.reshape(-1, 1))
            for i in range(0, count, COLUMN)
        ]
    else:
        parts = [_one(flat, i) for i in range(count)]
    return _joined(parts, [_integrated(part) for part in parts], shape)


def _one(flat: Scene, index: int) -> Scene:
    return flat.mapped(lambda x: float(x[index]))


def _integrated(scene: Scene) -> SteadyState:
    """Integrate one scene of floats, or a column of scenes."""
    # Not needed by the other methods, and slow to import
    from kvtheory.models.steady import convolution, quadrature, revolved, revolved_convolution

    foundation, support = scene.foundation, scene.support
    if foundation.kind == "kelvin-voigt":
        method: Any = quadrature if scene.indenter.per_width else revolved
        law: tuple[Any, ...] = ()
    else:
        method = convolution if scene.indenter.per_width else revolved_convolution
        law = (convolution.memory_of(scene),)
    grip = (support.depth,) if scene.held else (support.weight, support.spring)
    given: tuple[Any, ...] = (
        foundation.stiffness,
        foundation.retardation_time,
        scene.drive.final_velocity,
        *grip,
    )
    if scene.shape:
        given = tuple(np.broadcast_to(each, scene.shape) for each in given)
    solve = method.at_depth if scene.held else method.at_load
    state = solve(*law, scene.indenter, *given)
    return replace(state, units=units_for(scene.indenter, STEADY_UNITS))


def solve_asymptote(scene: Scene) -> SteadyState:
    """Evaluate the asymptote of the regime in which each velocity lies, with its error in closed form."""
    asymptotes = asymptotes_of(scene)
    truth, limits = solve_exact(scene), asymptotes.limits(scene)
    V = scene.drive.final_velocity
    slow = np.abs(V) <= asymptotes.critical_velocity(limits, scene.foundation.retardation_time)
    side = np.where(V < 0.0, -1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):  # at V = 0 the high one is not chosen
        low, high = (asymptotes.quantities(limits, regime, side) for regime in ("low", "high"))
        lows, highs = (asymptotes.errors(limits, regime, truth) for regime in ("low", "high"))
    found: dict[str, Any] = {
        name: plain(np.broadcast_to(np.where(slow, low[name], high[name]), scene.shape))
        for name in STEADY_UNITS
    }
    wrong = {name: np.abs(np.where(slow, lows[name], highs[name])) for name in STEADY_UNITS}
    certificate = Certificate(
        "proved",
        f"closed forms of the asymptotes' errors (derivations {asymptotes.PROVED})",
        {name: plain(error + ROUNDING * (1.0 + error)) for name, error in wrong.items()},
    )
    units = units_for(scene.indenter, STEADY_UNITS)
    return SteadyState(**found, model="asymptote", certificate=certificate, units=units)


METHODS: dict[str, Callable[[Scene], SteadyState]] = {
    "exact": solve_exact,
    "quadrature": solve_quadrature,
    "asymptote": solve_asymptote,
}


def plain(array: Any) -> Any:
    """Return an array without dimensions as a plain value."""
    return array if array.ndim else array.item()


def _joined(
    scenes: Sequence[Scene], states: Sequence[SteadyState], shape: tuple[int, ...]
) -> SteadyState:
    """Join the states of single scenes or of columns into one of arrays."""

    def joined(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        return {
            name: np.concatenate(
                [
                    np.broadcast_to(p[name], s.shape).ravel()
                    for p, s in zip(parts, scenes, strict=True)
                ]
            ).reshape(shape)
            for name in STEADY_UNITS
        }

    own = states[0].certificate
    errors = joined([state.certificate.relative_error for state in states])
    return replace(
        states[0],
        **joined([vars(state) for state in states]),
        certificate=replace(own, relative_error=errors),
    )
