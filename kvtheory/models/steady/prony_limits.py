r"""The limits of steady sliding of a parabola on a Prony series, and its approximation by Kelvin-Voigt.

At low velocity mu -> C V/(R K), C = sum K_i tau_i; at high velocity mu -> (2/5) (a^2/R) (-G'(0)/G(0))/V with
the half length a of the glassy stiffness G(0) (theorem F18). Between them lies the paper's model with K and
C. Each is compared with the exact state, to find the velocity at which its error exceeds the tolerance.

A shorter range is also proved for each: mu is within 7 V t/c of Kelvin-Voigt, t = sum K_i
tau_i^2/C, c the length of the contact, where V t/c <= 1/20 (theorem F18-voigt), and within 2 c/(V s) of the
glassy limit, s = (sum K_i/tau_i)/(sum K_i/tau_i^2), where c/(V s) <= 1/5 (theorem F18-glassy). On every
support V/c grows with V, as the contact grows with the load (theorem F17-growth).
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import elementwise

from kvtheory.models.steady.foundation_limits import (
    Array,
    At,
    Line,
    crossing,
    exact_friction,
)
from kvtheory.models.steady.foundation_limits import report as _report
from kvtheory.models.steady.methods import solve_exact
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
VOIGT, MOST_DELAY = 7.0, 0.05
"""Relative error over V t/c, and the largest V t/c (theorem F18-voigt)."""
GLASSY, MOST_HASTE = 2.0, 0.2
"""Relative error over c/(V s), and the largest c/(V s) (theorem F18-glassy)."""


def report(scene: Scene, tolerance: float, maxima: Mapping[str, Any]) -> AsymptoteReport:
    """Make the report of `kvtheory.asymptotes` for a parabola on a Prony series."""
    unit = np.ones(scene.shape)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        critical = np.sqrt(_glassy(scene, unit) / _slow(scene, unit))
        lines = [
            Line(
                *(name, regime, equation, formula, at),
                _edge(scene, at, regime, critical, tolerance),
                _proved(scene, bound, regime, critical, tolerance),
            )
            for name, regime, equation, formula, at, bound in LINES
        ]
        certificate = Certificate("estimated", STATEMENT.format(DECADES), {})
        return _report(scene, tolerance, critical, lines, certificate, maxima)


def _sum(scene: Scene, power: int) -> Any:
    """Return sum K_i tau_i^power."""
    return sum(arm.stiffness * arm.relaxation_time**power for arm in scene.foundation.arms)


def _slow(scene: Scene, V: Array) -> Any:
    """Return Eq. 42."""
    return _sum(scene, 1) * V / (scene.indenter.radius * scene.foundation.stiffness)


def _voigt(scene: Scene, V: Array) -> Array:
    """Return the friction coefficient on the Kelvin-Voigt foundation with the same K and C."""
    foundation = scene.foundation
    plain = Foundation(foundation.stiffness, foundation.retardation_time)
    return exact_friction(replace(scene, foundation=plain), V)


def _glassy(scene: Scene, V: Array) -> Any:
    """Return the limit for V -> oo."""
    stiff = scene.foundation.stiffness + _sum(scene, 0)
    a = _glassy_half_length(scene, stiff)
    return 0.4 * (a * a / scene.indenter.radius) * (_sum(scene, -1) / stiff) / V


def _length(scene: Scene, V: Array) -> Array:
    state = solve_exact(scene.at(V))
    return np.asarray(state.half_length + state.trailing_edge)


def _voigt_bound(scene: Scene, V: Array) -> Array:
    """Return the proved bound of the relative error; infinite where none holds."""
    delay = V * (_sum(scene, 2) / _sum(scene, 1)) / _length(scene, V)
    off = VOIGT * np.minimum(delay, MOST_DELAY)
    return np.where(delay <= MOST_DELAY, off / (1.0 - off), np.inf)


def _slow_bound(scene: Scene, V: Array) -> Array:
    plain = _slow(scene, V) / _voigt(scene, V)
    return plain * (1.0 + _voigt_bound(scene, V)) - 1.0


def _glassy_bound(scene: Scene, V: Array) -> Array:
    haste = _length(scene, V) * (_sum(scene, -2) / _sum(scene, -1)) / V
    off = GLASSY * np.minimum(haste, MOST_HASTE)
    return np.where(haste <= MOST_HASTE, off / (1.0 - off), np.inf)


LINES: tuple[tuple[str, str, int | None, str, At, At], ...] = (
    ("L1", "low", 42, "C V/(R K), C = sum K_i tau_i", _slow, _slow_bound),
    ("Kelvin-Voigt", "low", None, "exact with K and C", _voigt, _voigt_bound),
    ("glassy", "high", None, "2/5 (a^2/R) (-G'(0)/G(0))/V, a of G(0)", _glassy, _glassy_bound),
)
"""The formulas of the friction coefficient, each with the proved bound of its error."""


def _proved(scene: Scene, bound: At, regime: str, critical: Array, tolerance: float) -> Array:
    """Return the velocity at which the bound, which is monotonic in V, passes the tolerance."""

    def excess(scene: Scene, V: Array) -> Array:
        return np.minimum(bound(scene, V), 2.0) - tolerance

    ends = np.full_like(critical, -DECADES), np.full_like(critical, DECADES)
    return crossing(excess, scene, critical, ends, 0.0 if regime == "low" else np.inf)


def _glassy_half_length(scene: Scene, glassy: Array) -> Array:
    """Return the half length on a spring with the glassy stiffness: g s^3 + kappa (s^2 - 1) = 1."""
    R, K, support = scene.indenter.radius, scene.foundation.stiffness, scene.support
    if scene.held:
        return np.asarray(np.sqrt(2.0 * R * support.depth))
    a_0 = np.cbrt(1.5 * R * support.weight / K)
    kappa = support.spring * (a_0 * a_0 / (2.0 * R)) / support.weight

    def excess(s: Array, g: Array, k: Array) -> Array:
        return g * s**3 + k * (s * s - 1.0) - 1.0

    found = elementwise.find_root(excess, (0.0, 1.0), args=(glassy / K, kappa))
    return np.asarray(a_0 * found.x)


def _edge(scene: Scene, formula: At, regime: str, critical: Array, tolerance: float) -> Array:
    """Return the velocity at which the error first passes the tolerance, seen from its limit."""

    def excess(scene: Scene, V: Array) -> Array:
        return np.abs(formula(scene, V) / exact_friction(scene, V) - 1.0) - tolerance

    steps = (1.0 if regime == "low" else -1.0) * np.linspace(-DECADES, DECADES, POINTS)
    wide = scene.mapped(lambda x: np.broadcast_to(x, scene.shape)[..., np.newaxis])
    wrong = excess(wide, critical[..., None] * 10.0**steps) > 0.0
    first = wrong.argmax(axis=-1)
    nowhere, everywhere = (0.0, np.inf) if regime == "low" else (np.inf, 0.0)
    bracket = steps[np.maximum(first - 1, 0)], steps[np.maximum(first, 1)]
    edge = crossing(excess, scene, critical, bracket, np.nan)
    return np.where(wrong.any(axis=-1), np.where(first > 0, edge, nowhere), everywhere)
