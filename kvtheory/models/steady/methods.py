"""The methods of steady sliding, and the choice among them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import (
    asymptotes,
    ball,
    ball_asymptotes,
    ball_viscoelastic,
    exact,
    power_law,
    viscoelastic,
)
from kvtheory.models.steady.power_law_contact import shape_of
from kvtheory.models.steady.spots import stretch_of
from kvtheory.results import STEADY_UNITS, Certificate, SteadyState, units_for
from kvtheory.scene.broadcasting import values as broadcast
from kvtheory.scene.foundations import AnyFoundation
from kvtheory.scene.model import Scene
from kvtheory.scene.requirements import lacks_kelvin_voigt

Array = NDArray[np.float64]
Values = Mapping[str, Array]


def _cylinder(values: Values) -> tuple[Array, ...]:
    return (values["indenter.radius"],)


def _ball(values: Values) -> tuple[Array, ...]:
    return values["indenter.radius"], stretch_of(values)


Families = dict[str, tuple[ModuleType, Callable[[Values], tuple[Array, ...]]]]
FAMILIES: Families = {
    "parabola": (exact, _cylinder),
    "power-law": (power_law, shape_of),
    "wedge": (power_law, shape_of),
    "sphere": (ball, _ball),
}
"""For each shape, by name, its closed forms and their first arguments; `kvtheory.scene.requirements`
lists the same shapes."""
ON_ANY: Families = {"parabola": (viscoelastic, _cylinder), "sphere": (ball_viscoelastic, _ball)}
"""The same on foundations that are not Kelvin-Voigt."""

TIME = "foundation.retardation_time"

COLUMN = 256
"""Scenes that are integrated at once: their nodes then fit into the second-level cache of a core."""
ROUNDING = 64 * 2.0**-52
"""Rounding error of an asymptote and of its error, about twenty operations each."""


def asymptotes_of(scene: Scene) -> ModuleType:
    """Return the asymptotes that hold for a scene, and their errors."""
    return asymptotes if scene.indenter.per_width else ball_asymptotes


def solve_exact(scene: Scene, values: Values) -> SteadyState:
    """Evaluate the closed forms on whole arrays."""
    if lacks_kelvin_voigt(scene):
        state = _solve_on(scene, values)
    else:
        method, parameters = FAMILIES[scene.indenter.shape]
        state = _solve(method, values, *parameters(values))
    return _in_units(scene, state)


def _in_units(scene: Scene, state: SteadyState) -> SteadyState:
    """Return a state with its units: per unit width, or those of a ball."""
    if scene.indenter.per_width:
        return state
    return replace(state, units=units_for(scene.indenter, STEADY_UNITS))


def _solve_on(scene: Scene, values: Values) -> SteadyState:
    """Evaluate the moments of a foundation that is not Kelvin-Voigt, under a parabola or a ball."""
    foundation, values = scene.foundation, _with_time(scene.foundation, values)
    method, parameters = ON_ANY[scene.indenter.shape]
    shape = parameters(values)
    if foundation.arms:
        arms = list(chain(*arms_of(foundation, values)))
        return _solve(method, values, viscoelastic.Prony, arms, *shape)
    springpot = values[TIME], values["foundation.order"]
    return _solve(method, values, viscoelastic.Fractional, springpot, *shape)


def _convolved(scene: Scene, values: Mapping[str, float], indenter: Any) -> SteadyState:
    """Integrate one scene on a foundation that is not Kelvin-Voigt."""
    from kvtheory.models.steady import branches, convolution, revolved_convolution  # as seldom

    values = _with_time(scene.foundation, values)
    speed, stiffness = abs(values["drive.velocity"]), values["foundation.stiffness"]
    memory: branches.Memory
    if scene.foundation.arms:
        arms = np.array(arms_of(scene.foundation, values))
        memory = branches.Arms(arms[:, 0], speed * arms[:, 1])
    else:
        length = speed * values[TIME]
        memory = branches.Springpot(stiffness, length, values["foundation.order"])
    method = convolution if scene.indenter.per_width else revolved_convolution
    return _in_units(scene, _solve(method, values, memory, indenter))


def arms_of(foundation: AnyFoundation, values: Mapping[str, Any]) -> list[list[Any]]:
    """Return stiffness and relaxation time of each arm."""
    return [
        [values[f"foundation.arms[{number}].{name}"] for name in ("stiffness", "relaxation_time")]
        for number in range(len(foundation.arms))
    ]


def _with_time(foundation: AnyFoundation, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values with C/K of a Prony series."""
    damping = sum(stiffness * time for stiffness, time in arms_of(foundation, values))
    own = {TIME: damping / values["foundation.stiffness"]} if foundation.arms else {}
    return {**values, **own}


def solve_quadrature(scene: Scene, values: Values) -> SteadyState:
    """Integrate the pressure of any indenter: in columns if it is a convex line, else scene by scene.

    A scene that fails fails the call.
    """
    shape = values["drive.velocity"].shape
    if 0 in shape:
        none = solve_exact(Scene(), broadcast(Scene(), {"drive.velocity": np.empty(shape)}))
        return _in_units(scene, none)
    if not shape:
        return _integrated(scene, {key: float(array) for key, array in values.items()})
    count = math.prod(shape)
    line = scene.indenter.per_width and scene.indenter.convex
    if line and not lacks_kelvin_voigt(scene):
        columns: dict[str, Any] = {key: array.reshape(-1, 1) for key, array in values.items()}
        parts: list[Any] = [slice(start, start + COLUMN) for start in range(0, count, COLUMN)]
    else:
        columns = {key: array.ravel() for key, array in values.items()}
        parts = list(range(count))
    states = [
        _integrated(scene, {key: column[part] for key, column in columns.items()}) for part in parts
    ]
    return _joined(states, shape)


def _integrated(scene: Scene, values: Mapping[str, Any]) -> SteadyState:
    """Integrate one scene of floats, or a column of scenes."""
    from kvtheory.models.steady import quadrature, revolved  # not needed by the other methods

    # Bypasses the check of the indenter: the values have been checked, and it does not accept columns.
    indenter = object.__new__(type(scene.indenter))
    vars(indenter).update(vars(scene.indenter))
    for key, value in values.items():
        if key.startswith("indenter."):
            vars(indenter)[key.removeprefix("indenter.")] = value
    if lacks_kelvin_voigt(scene):
        return _convolved(scene, values, indenter)
    method = quadrature if scene.indenter.per_width else revolved
    return _in_units(scene, _solve(method, values, indenter))


def solve_asymptote(scene: Scene, values: Values) -> SteadyState:
    """Evaluate the asymptote of the regime in which each velocity lies, with its error in closed form."""
    asymptotes = asymptotes_of(scene)
    truth, limits = solve_exact(scene, values), asymptotes.limits(values)
    V, tau = values["drive.velocity"], values["foundation.retardation_time"]
    slow = np.abs(V) <= asymptotes.critical_velocity(limits, tau)
    side = np.where(V < 0.0, -1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):  # at V = 0 the high one is not chosen
        low, high = (asymptotes.quantities(limits, regime, side) for regime in ("low", "high"))
        lows, highs = (asymptotes.errors(limits, regime, truth) for regime in ("low", "high"))
    found: dict[str, Any] = {
        name: plain(np.where(slow, low[name], high[name])) for name in STEADY_UNITS
    }
    wrong = {name: np.abs(np.where(slow, lows[name], highs[name])) for name in STEADY_UNITS}
    certificate = Certificate(
        "proved",
        f"closed forms of the asymptotes' errors (derivations {asymptotes.PROVED})",
        {name: plain(error + ROUNDING * (1.0 + error)) for name, error in wrong.items()},
    )
    return _in_units(scene, SteadyState(**found, model="asymptote", certificate=certificate))


METHODS: dict[str, Callable[[Scene, Values], SteadyState]] = {
    "exact": solve_exact,
    "quadrature": solve_quadrature,
    "asymptote": solve_asymptote,
}


def _solve(method: ModuleType, values: Mapping[str, Any], *indenter: Any) -> SteadyState:
    """Call the function of `method` that fits the support; `indenter` are its first arguments."""
    first = (
        *indenter,
        values["foundation.stiffness"],
        values["foundation.retardation_time"],
        values["drive.velocity"],
    )
    if "support.depth" in values:
        return method.at_depth(*first, values["support.depth"])
    weight = values["support.weight"]
    return method.at_load(*first, weight, values.get("support.stiffness", 0.0))


def plain(array: Any) -> Any:
    """Return an array without dimensions as a plain value."""
    return array if array.ndim else array.item()


def _joined(states: Sequence[SteadyState], shape: tuple[int, ...]) -> SteadyState:
    """Join the states of single scenes or of columns into one of arrays."""

    def joined(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
        return {
            name: np.concatenate([np.ravel(part[name]) for part in parts]).reshape(shape)
            for name in STEADY_UNITS
        }

    own = states[0].certificate
    errors = joined([state.certificate.relative_error for state in states])
    return replace(
        states[0],
        **joined([vars(state) for state in states]),
        certificate=replace(own, relative_error=errors),
    )
