"""A Prony series in slow motion: the error of the equivalent Kelvin-Voigt foundation.

In a motion that changes at the rate sigma, an arm acts as a damper C_i/(1 + sigma tau_i), C_i = K_i tau_i,
which is between C_i and its value at the fastest rate. So the solution for the Kelvin-Voigt foundation with
C = sum C_i is compared with the one for the damping at the fastest rate: the sum of the rate V/a at which
elements pass half of the contact, one over the time since the last change of the drive, and on a spring
sqrt(k_x/M_x). The layer at the leading edge in which arms are loaded does not depend on this rate; its error
is taken from steady sliding, where the error of the equivalent foundation is known exactly.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from kvtheory.results import SteadyState
from kvtheory.results.table import scales
from kvtheory.scene.drives import Drive
from kvtheory.scene.foundations import Foundation
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

SAFETY = 4.0
"""Safety factor of the estimate: the largest error on random scenes was 0.6 of the estimate with it."""
LEAST_DAMPING = 0.7
"""Least damping of the arms at the fastest rate, over C, for which a first-order estimate is meaningful."""
STEADY_NAMES = {"normal_force": "load", "spring_force": "friction_force"}
"""Names in steady sliding of the quantities of a series, where they differ."""
STATEMENT = (
    "plus the error of the Kelvin-Voigt foundation with the damping sum K_i tau_i: "
    f"{SAFETY:g} times the change due to the damping at the fastest rate of the motion, and due to the "
    "arms in steady sliding"
)


def damping(scene: Scene, rate: float = 0.0) -> float:
    """Return the damping equivalent to the arms in a motion at this rate (1/s)."""
    return sum(
        arm.stiffness * arm.relaxation_time / (1.0 + rate * arm.relaxation_time)
        for arm in scene.foundation.arms
    )


def foundation(scene: Scene, rate: float = 0.0) -> Foundation:
    """Return the Kelvin-Voigt foundation with this damping."""
    K = scene.foundation.stiffness
    return Foundation(K, damping(scene, rate) / K)


def fastest_rate(steady: Callable[..., SteadyState], scene: Scene, times: Any) -> float:
    """Return the fastest rate of the motion at the times (1/s), or raise ValueError if arms are too slow."""
    changes = np.array([0.0, *scene.drive.changes])
    shortest = min(t - changes[changes <= t].max(initial=0.0) for t in times)
    fastest = max(map(abs, _velocities(scene)))
    sliding = steady(replace(scene, foundation=foundation(scene), drive=Drive(fastest)))
    swing = 0.0 if scene.drive.rigid else math.sqrt(scene.drive.stiffness / scene.drive_mass)
    passing = fastest / float(sliding.half_length)
    rate = passing + swing + (1.0 / shortest if shortest > 0.0 else np.inf)
    if damping(scene, rate) < LEAST_DAMPING * damping(scene):
        raise ValueError("the motion changes as fast as arms relax")
    return rate


def _velocities(scene: Scene) -> list[float]:
    """Return the velocities at the nodes of the piecewise linear drive."""
    return list(scene.drive.motion(scene.run.duration, 1.0).velocities)


def in_steady_sliding(
    steady: Callable[..., SteadyState], scene: Scene, names: tuple[str, ...]
) -> dict[str, float]:
    """Return the scaled error of the equivalent foundation in steady sliding, times `SAFETY`."""
    measures, errors = scales(StaticState.of(scene)), dict.fromkeys(names, 0.0)
    for V in _velocities(scene):
        sliding = replace(scene, drive=Drive(V))
        pair = steady(sliding), steady(replace(sliding, foundation=foundation(scene)))
        for name in names:
            values = [getattr(each, STEADY_NAMES.get(name, name), 0.0) for each in pair]
            errors[name] = max(errors[name], SAFETY * abs(values[0] - values[1]) / measures[name])
    return errors


def neglected(one: Any, other: Any, scene: Scene, names: tuple[str, ...]) -> dict[str, float]:
    """Return the scaled difference between the series of two dampings, times `SAFETY`."""
    measures = scales(StaticState.of(scene))
    apart = {name: np.abs(getattr(one, name) - getattr(other, name)) for name in names}
    return {
        name: SAFETY * float(np.nanmax(off, initial=0.0)) / measures[name]
        for name, off in apart.items()
    }
