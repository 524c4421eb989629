"""Error of a transient on a Prony series, estimated as on Kelvin-Voigt."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.continuum.error_estimate import (
    COMPARISON,
    FLOOR,
    MARGIN,
    TIGHTER,
)
from kvtheory.models.continuum.evaluation import SERIES
from kvtheory.models.continuum.prony.records import ARM, ARM_STATE, together
from kvtheory.models.continuum.prony.trajectory import Trajectory
from kvtheory.models.continuum.run import FREE, StepControl
from kvtheory.records import readable
from kvtheory.results import AT_REST, Certificate
from kvtheory.results.table import scales
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

ROUNDING = 4e-16
"""Rounding of the moments, relative to A_i (1 + A_i) of the largest accumulator."""
LESS_TIGHT = 10.0
"""First over second tolerance where a solution with the one over `TIGHTER` fails."""
OTHERS = TIGHTER, LESS_TIGHT
STATEMENT = (
    f"{MARGIN:g} times the difference to a solution with at most {1 / LESS_TIGHT:g} times the tolerance and "
    "other step sizes, plus a bound of rounding; `jump_time` is the error of the time of a take-off or "
    "landing, relative to the retardation time; `pressure` holds inside the contact, `surface` for the whole "
    "foundation"
)
ANYWHERE = "pressure", "surface", "jump_time"
"""Errors besides those of the series."""
FIRST = StepControl(longest=math.inf)
SECOND = COMPARISON._replace(longest=math.inf)


def certificate(
    scene: Scene, rtol: float, fine: Any, other: Trajectory | None, s: Array | None, why: str
) -> Certificate:  # fmt: skip
    """Return the certificate of the states of a `SolvedScene` at scaled times, by default the natural ones.

    Where only one of them flies, the contact of the other is narrow: its width is the error of an edge.
    """
    own = scales(fine.units)
    if other is None:
        errors = dict.fromkeys([*own, *ANYWHERE], math.inf)
        return Certificate("estimated", why, {**errors, "time": 0.0}, AT_REST)
    s = fine.scaled(fine.natural_times) if s is None else s
    here, there = _series(fine.motion.states(s), own), _series(other.states(s), own)
    run = other.run
    depths = together(run.memory, ARM_STATE)["accumulated_depth"][: other.counts.steps, :, 0]
    stiffness, deepest = together(run.arms, ARM)["stiffness"], np.abs(depths).max(axis=0)
    rounding = ROUNDING * float(np.sum(stiffness * deepest * (1.0 + deepest)))
    measures = scales(StaticState.of(scene))  # in other units of time
    errors, widths = {"time": 0.0}, np.zeros_like(s)
    for each in (here, there):
        widths += np.nan_to_num(np.abs(each["leading_edge"] - each["trailing_edge"]))
    for name, values in here.items():
        flies, other_flies = np.isnan(values), np.isnan(there[name])
        off = np.where(flies == other_flies, np.nan_to_num(np.abs(values - there[name])), widths)
        apart = float(np.max(off, initial=0.0))
        least = min(
            1.0, measures[name] / own[name]
        )  # of a very short run that of velocity is large
        least += float(np.max(np.abs(np.nan_to_num(values)), initial=0.0))
        errors[name] = max(MARGIN * apart, FLOOR * rtol * least) + rounding
    errors = {name: error * (own[name] / measures[name]) for name, error in errors.items()}
    everywhere, jump_time = _anywhere(fine, other, rtol, scene.drive.tolerance)
    for name, error in everywhere.items():
        errors[name] = error + rounding
    errors["jump_time"] = jump_time * (own["time"] / measures["time"])
    velocity = float(np.max(np.abs(here["velocity"]), initial=0.0)) * own["velocity"]
    errors["velocity"] = scene.drive.tolerance * (1.0 + velocity / measures["velocity"])
    if fine.units.fixed:
        errors |= {"depth": 0.0, "depth_rate": 0.0}
    return Certificate("estimated", STATEMENT, errors, AT_REST)


def _series(states: NDArray[Any], own: Mapping[str, float]) -> dict[str, Array]:
    return {name: states[name] for name in SERIES if name in own}


def _anywhere(
    fine: Any, other: Trajectory, rtol: float, tolerance: float
) -> tuple[dict[str, float], float]:
    """Return the scaled errors of pressure and surface, and that of the times of take-offs and landings.

    An element at xi was compressed by d - (xi + Y(s') - Y(s))^2 in contact, so that the errors of depth and
    way over the whole run bound that of its history; an edge that is off by as much as an error of the way
    leaves or meets the ground where u differs by no more. On free ground u is a mean of its history, with
    weights that are positive and at most one in sum, and the pressure is G(0) u + int G'(s - s') u ds': its
    error is at most 2 G(0) - G(oo) times that of u.
    """
    motion = fine.motion
    s = motion.natural
    here, there = (each.states(s, peaks=False) for each in (motion, other))

    def error(name: str) -> float:
        apart = np.nanmax(np.abs(here[name] - there[name]), initial=0.0)
        largest = np.nanmax(np.abs(here[name]), initial=0.0)
        return float(max(MARGIN * apart, FLOOR * rtol * (1.0 + largest)))

    arm = float(np.nanmax(np.abs(here["edges"]), initial=1.0))
    way = tolerance * (1.0 + fine.drive.highest_speed) * fine.drive.end
    way += 0.0 if fine.units.rigid_drive else 2.0 * error("way")
    way += error("edges")
    surface = (0.0 if fine.units.fixed else error("depth")) + 2.0 * arm * way
    pressure = (1.0 + 2.0 * float(np.sum(together(motion.run.arms, ARM)["stiffness"]))) * surface
    rate = 0.0 if fine.units.fixed else error("depth_rate")
    number = tolerance * (1.0 + fine.drive.highest_speed)
    number += 0.0 if fine.units.rigid_drive else error("sliding_velocity")
    fastest = np.nanmax(np.abs(here["sliding_velocity"]), initial=0.0)
    damper = readable(motion.run.given[0]).damper
    pressure += damper * (rate + 2.0 * (arm * number + float(fastest) * way))
    hops, others = (_hops(each) for each in (motion, other))
    jump = 0.0
    if len(hops) != len(others):
        jump = fine.drive.end
    elif hops.size:
        jump = max(MARGIN * float(np.max(np.abs(hops - others))), FLOOR * rtol * fine.drive.end)
    return {"pressure": pressure, "surface": surface}, jump


def _hops(motion: Trajectory) -> Array:
    """Return the scaled times of take-offs and landings."""
    flies = motion.steps["sides"]["state"][:, 0] == FREE
    return np.asarray(motion.steps["time"][1:][flies[1:] != flies[:-1]], dtype=float)
