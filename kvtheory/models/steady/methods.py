"""The methods of steady sliding, and the choice among them."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from kvtheory.models.steady import (
    asymptotes,
    ball,
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
"""Rounding error of an asymptote and of the exact state it is compared with, about twenty operations each."""


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
    """Integrate the pressure of any indenter; a scene that fails fails the call."""
    from kvtheory.models.steady import quadrature  # slow to import

    return evaluate(
        quadrature.quantities,
        scene,
        quadrature.certificate(scene),
        quadrature.OWN_ERRORS,
        floats=True,
        model="quadrature",
        block=COLUMN,
    )


def solve_asymptote(scene: Scene) -> SteadyState:
    """Evaluate the asymptote of the regime of each velocity; the exact state tells its error."""
    truth, limits = solve_exact(scene), asymptotes.limits(scene)
    slow = np.abs(scene.drive.final_velocity) <= asymptotes.critical_velocity(scene)
    with np.errstate(divide="ignore", invalid="ignore"):  # at V = 0 the high one is not chosen
        low, high = (asymptotes.quantities(scene, limit) for limit in limits)
        lows, highs = (
            asymptotes.errors(scene, limit, values, truth)
            for limit, values in zip(limits, (low, high), strict=True)
        )
    found: dict[str, Any] = {
        name: plain(np.broadcast_to(np.where(slow, low[name], high[name]), scene.shape))
        for name in STEADY_UNITS
    }
    wrong = {name: np.abs(np.where(slow, lows[name], highs[name])) for name in STEADY_UNITS}
    certificate = Certificate(
        truth.certificate.kind,
        "asymptote over exact state, which is known to 1e-14",
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
