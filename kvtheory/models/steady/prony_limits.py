r"""The limits of steady sliding of a parabola on a Prony series, and Kelvin-Voigt in its place.

At low velocity mu -> C V/(R K), C = sum K_i tau_i; at high velocity mu -> (2/5) (a^2/R) (-G'(0)/G(0))/V with
the half length a of the glassy stiffness G(0) (theorem F18). Between them lies the paper's model with K and
C. Each is compared with the exact state, and the velocity found at which its error passes the tolerance.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

from kvtheory.models.steady.methods import TIME, arms_of, plain, solve_exact
from kvtheory.results import AsymptoteLine, AsymptoteReport, Certificate
from kvtheory.scene.foundations import Foundation
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
Values = Mapping[str, Array]

DECADES = 15.0
"""How far from where both limits meet, in powers of ten, the range of a formula is looked for."""
POINTS = 301
"""Velocities at which the error is looked at, before its place is refined."""
STATEMENT = (
    "differences to the exact state; a range ends where the error first passes the tolerance between "
    "the limit and {:g} decades beyond where both limits meet, if it grows all the way"
)
LINES = (
    ("L1", "low", 42, "C V/(R K), C = sum K_i tau_i"),
    ("Kelvin-Voigt", "low", None, "exact with K and C"),
    ("glassy", "high", None, "2/5 (a^2/R) (-G'(0)/G(0))/V, a of G(0)"),
)


def report(scene: Scene, values: Values, tolerance: float) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes` for a parabola on a Prony series."""
    V = np.abs(values["drive.velocity"])
    side = np.where(values["drive.velocity"] < 0.0, -1.0, 1.0)
    formulas = _formulas(scene, values)
    with np.errstate(divide="ignore", invalid="ignore"):
        rise, fall = formulas["L1"](np.ones_like(V)), formulas["glassy"](np.ones_like(V))
        critical = np.sqrt(fall / rise)
        truth = _exact(scene, values, V)
        lines = []
        for name, regime, equation, formula in LINES:
            value = formulas[name](V)
            edge = _edge(scene, values, name, critical, tolerance)
            low = regime == "low"
            lines.append(
                AsymptoteLine(
                    name, "friction_coefficient", regime, equation, formula,
                    value=plain(np.where(np.isfinite(value), side * value, np.nan)),
                    exact=plain(side * truth),
                    relative_error=plain(np.where(truth > 0.0, value / truth - 1.0, np.nan)),
                    velocity_min=plain(np.zeros_like(edge) if low else edge),
                    velocity_max=plain(edge if low else np.full_like(edge, np.inf)),
                )
            )  # fmt: skip
    use = np.full(V.shape, "exact", dtype=object)
    for line in reversed(lines):
        use = np.where(np.abs(line.relative_error) <= tolerance, line.name, use)
    nothing = plain(np.full_like(critical, np.nan))
    return AsymptoteReport(
        velocity=plain(values["drive.velocity"]),
        critical_velocity=plain(critical),
        peak_velocity=nothing,
        peak_friction_coefficient=nothing,
        regime=plain(np.where(critical >= V, "low", "high")),
        use=plain(use),
        tolerance=tolerance,
        lines=tuple(lines),
        model="asymptote",
        certificate=Certificate("estimated", STATEMENT.format(DECADES), {}),
    )


def _exact(scene: Scene, values: Values, V: Array) -> Array:
    state = solve_exact(scene, {**values, "drive.velocity": V})
    return np.asarray(state.friction_coefficient)


def _formulas(scene: Scene, values: Values) -> dict[str, Callable[[Array], Array]]:
    """Return the friction coefficient over |V| by each formula."""
    R, K = values["indenter.radius"], values["foundation.stiffness"]
    arms = arms_of(scene.foundation, values)
    damping = sum(stiffness * time for stiffness, time in arms)
    glassy = K + sum(stiffness for stiffness, _ in arms)
    slope = sum(stiffness / time for stiffness, time in arms)
    plainly = replace(scene, foundation=Foundation(1.0, 1.0))
    kelvin_voigt = {**values, TIME: damping / K}
    return {
        "L1": lambda V: damping * V / (R * K),
        "Kelvin-Voigt": lambda V: _exact(plainly, kelvin_voigt, V),
        "glassy": lambda V: (
            0.4 * (_glassy_half_length(values, glassy) ** 2 / R) * (slope / glassy) / V
        ),
    }


def _glassy_half_length(values: Values, glassy: Array) -> Array:
    """Return the half length on a spring as stiff as the foundation at once: g s^3 + kappa (s^2 - 1) = 1."""
    R, K = values["indenter.radius"], values["foundation.stiffness"]
    if "support.depth" in values:
        return np.asarray(np.sqrt(2.0 * R * values["support.depth"]))
    weight = values["support.weight"]
    a_0 = np.cbrt(1.5 * R * weight / K)
    kappa = values.get("support.stiffness", 0.0 * K) * (a_0 * a_0 / (2.0 * R)) / weight

    def excess(s: Array, g: Array, k: Array) -> Array:
        return g * s**3 + k * (s * s - 1.0) - 1.0

    found = elementwise.find_root(excess, (0.0 * a_0, 1.0 + 0.0 * a_0), args=(glassy / K, kappa))
    return np.asarray(a_0 * found.x)


def _edge(scene: Scene, values: Values, line: str, critical: Array, tolerance: float) -> Array:
    """Return the velocity at which the error first passes the tolerance, seen from its limit."""
    sign = -1.0 if line == "glassy" else 1.0
    steps = sign * np.linspace(-DECADES, DECADES, POINTS)
    wide = {key: np.asarray(value)[..., None] for key, value in values.items()}
    V = critical[..., None] * 10.0**steps
    wrong = np.abs(_formulas(scene, wide)[line](V) / _exact(scene, wide, V) - 1.0) > tolerance
    first = wrong.argmax(axis=-1)
    keys = list(values)

    def excess(decades: Array, *arrays: Array) -> Array:
        point = dict(zip(keys, arrays[:-1], strict=True))
        V = arrays[-1] * 10.0**decades
        off = _formulas(scene, point)[line](V) / _exact(scene, point, V) - 1.0
        return np.abs(off) - tolerance

    bracket = steps[np.maximum(first - 1, 0)], steps[np.maximum(first, 1)]
    found = elementwise.find_root(excess, bracket, args=(*values.values(), critical))
    nowhere, everywhere = (0.0, np.inf) if sign > 0.0 else (np.inf, 0.0)
    edge = np.where(found.success, critical * 10.0**found.x, np.nan)
    return np.where(wrong.any(axis=-1), np.where(first > 0, edge, nowhere), everywhere)
