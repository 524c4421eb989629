r"""The limits of steady sliding of a parabola on a Prony series, and its approximation by Kelvin-Voigt.

At low velocity mu -> C V/(R K), C = sum K_i tau_i; at high velocity mu -> (2/5) (a^2/R) (-G'(0)/G(0))/V with
the half length a of the glassy stiffness G(0) (theorem F18). Between them lies the paper's model with K and
C. Each is compared with the exact state, to find the velocity at which its error exceeds the tolerance.

A shorter range is also proved for each: mu is within 7 V t/c of Kelvin-Voigt, t = sum K_i
tau_i^2/C, c the length of the contact, where V t/c <= 1/20 (theorem F18-voigt), and within 2 c/(V s) of the
glassy limit, s = (sum K_i/tau_i)/(sum K_i/tau_i^2), where c/(V s) <= 1/5 (theorem F18-glassy). On every
support V/c grows with V, as the contact grows with the load (theorem F17-growth).
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import elementwise

from kvtheory.models.steady.foundation_limits import (
    Array,
    At,
    Line,
    Values,
    crossing,
    exact_friction,
)
from kvtheory.models.steady.foundation_limits import report as _report
from kvtheory.models.steady.methods import TIME, arms_of, solve_exact
from kvtheory.results import AsymptoteReport, Certificate
from kvtheory.scene.foundations import Foundation
from kvtheory.scene.model import Scene

DECADES = 15.0
"""How far from the crossing of both limits, in powers of ten, the end of a range is sought."""
POINTS = 301
"""Velocities at which the error is evaluated, before the end of the range is refined."""
STATEMENT = (
    "differences to the exact state; a range ends where the error first passes the tolerance between "
    "the limit and {:g} decades beyond where both limits meet, if it grows all the way; up to (high: from) "
    "`velocity_proved` it is proved (derivations F18-voigt, F18-glassy)"
)
LINES = (
    ("L1", "low", 42, "C V/(R K), C = sum K_i tau_i"),
    ("Kelvin-Voigt", "low", None, "exact with K and C"),
    ("glassy", "high", None, "2/5 (a^2/R) (-G'(0)/G(0))/V, a of G(0)"),
)
VOIGT, MOST_DELAY = 7.0, 0.05
"""Relative error over V t/c, and the largest V t/c (theorem F18-voigt)."""
GLASSY, MOST_HASTE = 2.0, 0.2
"""Relative error over c/(V s), and the largest c/(V s) (theorem F18-glassy)."""


def report(scene: Scene, values: Values, tolerance: float) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes` for a parabola on a Prony series."""
    formulas, bounds = _formulas(scene), _bounds(scene)
    unit = np.ones_like(values["drive.velocity"])
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        critical = np.sqrt(formulas["glassy"](values, unit) / formulas["L1"](values, unit))
        lines = [
            Line(
                *(name, regime, equation, formula, formulas[name]),
                _edge(scene, values, formulas[name], regime, critical, tolerance),
                _proved(values, bounds[name], regime, critical, tolerance),
            )
            for name, regime, equation, formula in LINES
        ]
        certificate = Certificate("estimated", STATEMENT.format(DECADES), {})
        return _report(scene, values, tolerance, critical, lines, certificate)


def _sums(scene: Scene, values: Values) -> list[Array]:
    """Return sum K_i tau_i^n for n from 2 to -2."""
    arms = arms_of(scene.foundation, values)
    return [sum(k * time**n for k, time in arms) for n in (2, 1, 0, -1, -2)]


def _formulas(scene: Scene) -> dict[str, At]:
    """Return the friction coefficient over |V| by each formula."""
    plainly = replace(scene, foundation=Foundation(1.0, 1.0))

    def slow(values: Values, V: Array) -> Array:
        damping = _sums(scene, values)[1]
        return damping * V / (values["indenter.radius"] * values["foundation.stiffness"])

    def voigt(values: Values, V: Array) -> Array:
        damping = _sums(scene, values)[1]
        return exact_friction(
            plainly, {**values, TIME: damping / values["foundation.stiffness"]}, V
        )

    def glassy(values: Values, V: Array) -> Array:
        _, _, stiff, slope, _ = _sums(scene, values)
        stiff = values["foundation.stiffness"] + stiff
        a = _glassy_half_length(values, stiff)
        return 0.4 * (a * a / values["indenter.radius"]) * (slope / stiff) / V

    return {"L1": slow, "Kelvin-Voigt": voigt, "glassy": glassy}


def _bounds(scene: Scene) -> dict[str, At]:
    """Return the proved bound of the relative error of each formula; infinite where none holds."""
    formulas = _formulas(scene)

    def length(values: Values, V: Array) -> Array:
        state = solve_exact(scene, {**values, "drive.velocity": V})
        return np.asarray(state.half_length + state.trailing_edge)

    def voigt(values: Values, V: Array) -> Array:
        second, first = _sums(scene, values)[:2]
        delay = V * (second / first) / length(values, V)
        off = VOIGT * np.minimum(delay, MOST_DELAY)
        return np.where(delay <= MOST_DELAY, off / (1.0 - off), np.inf)

    def slow(values: Values, V: Array) -> Array:
        plain = formulas["L1"](values, V) / formulas["Kelvin-Voigt"](values, V)
        return plain * (1.0 + voigt(values, V)) - 1.0

    def glassy(values: Values, V: Array) -> Array:
        slope, bend = _sums(scene, values)[3:]
        haste = length(values, V) * (bend / slope) / V
        off = GLASSY * np.minimum(haste, MOST_HASTE)
        return np.where(haste <= MOST_HASTE, off / (1.0 - off), np.inf)

    return {"L1": slow, "Kelvin-Voigt": voigt, "glassy": glassy}


def _proved(values: Values, bound: At, regime: str, critical: Array, tolerance: float) -> Array:
    """Return the velocity at which the bound, which is monotonic in V, passes the tolerance."""

    def excess(point: Values, V: Array) -> Array:
        return np.minimum(bound(point, V), 2.0) - tolerance

    ends = np.full_like(critical, -DECADES), np.full_like(critical, DECADES)
    return crossing(excess, values, critical, ends, 0.0 if regime == "low" else np.inf)


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


def _edge(
    scene: Scene, values: Values, formula: At, regime: str, critical: Array, tolerance: float
) -> Array:
    """Return the velocity at which the error first passes the tolerance, seen from its limit."""

    def excess(point: Values, V: Array) -> Array:
        return np.abs(formula(point, V) / exact_friction(scene, point, V) - 1.0) - tolerance

    steps = (1.0 if regime == "low" else -1.0) * np.linspace(-DECADES, DECADES, POINTS)
    wide = {key: np.asarray(value)[..., None] for key, value in values.items()}
    wrong = excess(wide, critical[..., None] * 10.0**steps) > 0.0
    first = wrong.argmax(axis=-1)
    nowhere, everywhere = (0.0, np.inf) if regime == "low" else (np.inf, 0.0)
    bracket = steps[np.maximum(first - 1, 0)], steps[np.maximum(first, 1)]
    edge = crossing(excess, values, critical, bracket, np.nan)
    return np.where(wrong.any(axis=-1), np.where(first > 0, edge, nowhere), everywhere)
