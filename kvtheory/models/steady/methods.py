"""The ways to compute steady sliding, and the one place that chooses among them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import asymptotes, exact, power_law, power_law_asymptotes
from kvtheory.models.steady.power_law_contact import shape_of
from kvtheory.results import STEADY_UNITS, Certificate, SteadyState
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
Values = Mapping[str, Array]


class Family(NamedTuple):
    """Shapes whose steady sliding is in closed form."""

    exact: ModuleType
    asymptotes: Any
    """A module with the names of `kvtheory.models.steady.asymptotes`."""
    parameters: Callable[[Values], tuple[Array, ...]]
    """What the functions of `exact` take first."""


_POWER_LAW = Family(power_law, power_law_asymptotes, shape_of)
FAMILIES = {
    "parabola": Family(exact, asymptotes, lambda values: (values["indenter.radius"],)),
    "power-law": _POWER_LAW,
    "wedge": _POWER_LAW,
}
"""By the name of the shape; `kvtheory.scene.requirements` knows the same names."""

ROUNDING = 64 * 2.0**-52
"""Of an asymptote and of its error, which are of some twenty operations each."""


def solve_exact(scene: Scene, values: Values) -> SteadyState:
    """Evaluate the closed forms on whole arrays."""
    family = FAMILIES[scene.indenter.shape]
    return _solve(family.exact, values, *family.parameters(values))


def solve_quadrature(scene: Scene, values: Values) -> SteadyState:
    """Integrate the pressure of any indenter, point by point."""
    from kvtheory.models.steady import quadrature  # it imports SciPy, which takes a while

    shape = values["drive.velocity"].shape
    if 0 in shape:
        return solve_exact(Scene(), dict.fromkeys(Scene().values(), np.empty(shape)))
    states = []
    for index in np.ndindex(shape):
        point = {key: float(array[index]) for key, array in values.items()}
        own = {
            key.split(".")[1]: value for key, value in point.items() if key.startswith("indenter.")
        }
        indenter: Any = scene.indenter
        states.append(_solve(quadrature, point, replace(indenter, **own)))
    return _stack(states, shape) if shape else states[0]


def solve_asymptote(scene: Scene, values: Values) -> SteadyState:
    """Evaluate the asymptote of the regime in which each velocity lies, with its error in closed form."""
    truth = solve_exact(scene, values)
    asymptotes = FAMILIES[scene.indenter.shape].asymptotes
    limits = asymptotes.limits(values)
    V, tau = values["drive.velocity"], values["foundation.retardation_time"]
    slow = np.abs(V) <= asymptotes.critical_velocity(limits, tau)
    side = np.where(V < 0.0, -1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):  # at V = 0 the high one is not chosen
        low, high = (asymptotes.quantities(limits, regime, side) for regime in ("low", "high"))
        errors = asymptotes.low_errors(limits, truth), asymptotes.high_errors(limits, truth)
    found = {name: np.where(slow, low[name], high[name]) for name in STEADY_UNITS}
    wrong = {name: np.abs(np.where(slow, errors[0][name], errors[1][name])) for name in found}
    statement = f"closed forms of the asymptotes' errors (derivations {asymptotes.PROVED})"
    errors_of = {name: _scalar(error + ROUNDING * (1.0 + error)) for name, error in wrong.items()}
    certificate = Certificate("proved", statement, errors_of)
    return SteadyState(
        **{name: _scalar(found[name]) for name in STEADY_UNITS},
        model="asymptote",
        certificate=certificate,
    )


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
    weight = values["support.mass"] * values["support.gravity"]
    return method.at_load(*first, weight, values.get("support.stiffness", 0.0))


def _scalar(array: Array) -> Any:
    return array if array.ndim else float(array)


def _stack(states: Sequence[SteadyState], shape: tuple[int, ...]) -> SteadyState:
    """Join the states of single points into one of arrays."""

    def joined(pick: Callable[[SteadyState, str], Any]) -> dict[str, Array]:
        return {
            name: np.array([pick(state, name) for state in states]).reshape(shape)
            for name in STEADY_UNITS
        }

    errors = joined(lambda state, name: state.certificate.relative_error[name])
    certificate = replace(states[0].certificate, relative_error=errors)
    return SteadyState(**joined(getattr), model=states[0].model, certificate=certificate)
