"""The ways to compute steady sliding, and the one place that chooses among them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import asymptotes, exact
from kvtheory.results import STEADY_UNITS, Certificate, SteadyState
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
Values = Mapping[str, Array]


def solve_exact(scene: Scene, values: Values) -> SteadyState:
    """Evaluate the closed forms on whole arrays."""
    return _solve(exact, values, values["indenter.radius"])


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
    """Evaluate the asymptote of the regime in which each velocity lies, with its error."""
    truth = solve_exact(scene, values)
    limits = asymptotes.limits(values)
    V, tau = values["drive.velocity"], values["foundation.retardation_time"]
    slow = np.abs(V) <= asymptotes.critical_velocity(limits, tau)
    with np.errstate(
        divide="ignore", invalid="ignore"
    ):  # the high asymptote at V = 0 is not chosen
        low, high = asymptotes.low(limits), asymptotes.high(limits)
    chosen = {name: np.where(slow, low[name], high[name]) for name in low}
    side = np.where(V < 0.0, -1.0, 1.0)
    a = np.sqrt(2 * limits.radius * chosen["depth"])
    l_r, pressure = limits.retardation_length, limits.stiffness * chosen["depth"]
    result = {
        **chosen,
        "half_length": a,
        "retardation_length": l_r,
        "leading_edge": -side * a,
        "trailing_edge": side * np.where(slow, a, 0.0) + 0.0,  # Eqs. 38, 39; no negative zero
        "friction_force": side * chosen["friction_force"],
        "friction_coefficient": side * chosen["friction_coefficient"],
        "peak_pressure": pressure * np.where(slow, 1.0, 2 * l_r / a),
        "dissipated_in_contact": np.ones_like(a),
    }
    errors = {name: _relative_error(result[name], getattr(truth, name)) for name in STEADY_UNITS}
    certificate = Certificate(
        "estimated", "difference to the exact closed form, which is known to 3.6e-15", errors
    )
    return SteadyState(
        **{name: _scalar(result[name]) for name in STEADY_UNITS},
        model="asymptote",
        certificate=certificate,
    )


METHODS: dict[str, Callable[[Scene, Values], SteadyState]] = {
    "exact": solve_exact,
    "quadrature": solve_quadrature,
    "asymptote": solve_asymptote,
}


def _solve(method: ModuleType, values: Mapping[str, Any], indenter: Any) -> SteadyState:
    """Call the function of `method` that fits the support; `indenter` is its first argument."""
    first = (
        indenter,
        values["foundation.stiffness"],
        values["foundation.retardation_time"],
        values["drive.velocity"],
    )
    if "support.depth" in values:
        return method.at_depth(*first, values["support.depth"])
    weight = values["support.mass"] * values["support.gravity"]
    return method.at_load(*first, weight, values.get("support.stiffness", 0.0))


def _relative_error(value: Array, truth: Any) -> Any:
    truth = np.asarray(truth)
    scale = np.where(truth == 0.0, 1.0, np.abs(truth))
    return _scalar(np.abs(value - truth) / scale + exact.RELATIVE_ERROR)


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
