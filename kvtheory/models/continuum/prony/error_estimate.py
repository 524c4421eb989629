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
from kvtheory.models.continuum.prony.records import (
    ARM,
    ARM_STATE,
    METHOD,
    POLYNOMIAL,
    together,
)
from kvtheory.models.continuum.prony.trajectory import Trajectory
from kvtheory.models.continuum.prony.walk import least_violation
from kvtheory.models.continuum.run import FREE, StepControl
from kvtheory.records import readable
from kvtheory.results import AT_REST, Certificate
from kvtheory.results.table import scales
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

ROUNDING = 4e-16
"""Rounding of the moments, relative to A_i (1 + A_i) of the largest accumulator."""
SAFETY = 3.0
"""Factor on the vibration that the steps lose."""
LESS_TIGHT = 10.0
"""First over second tolerance where a solution with the one over `TIGHTER` fails."""
OTHERS = TIGHTER, LESS_TIGHT
STATEMENT = (
    f"{MARGIN:g} times the difference to a solution with at most {1 / LESS_TIGHT:g} times the tolerance and "
    "other step sizes, which for rates includes what steps lose of the vibration of the masses on the "
    "contact, plus a bound of rounding; `jump_time` is the error of the time of a take-off or "
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
    errors, widths, lost = {"time": 0.0}, np.zeros_like(s), _lost(other)
    given = readable(run.given[0])
    tension = given.damper * least_violation(given.rtol)  # at an edge, which no event sees
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
        apart = MARGIN * apart + SAFETY * lost.get(name, 0.0)
        errors[name] = max(apart, FLOOR * rtol * least) + rounding
        if "edge" in name:
            errors[name] += tension  # p rises by 1 or more per unit of xi
    errors = {name: error * (own[name] / measures[name]) for name, error in errors.items()}
    everywhere, jump_time = _anywhere(fine, other, lost, rtol, scene.drive.tolerance)
    for name, error in everywhere.items():
        errors[name] = error + rounding
    errors["jump_time"] = jump_time * (own["time"] / measures["time"])
    velocity = float(np.max(np.abs(here["velocity"]), initial=0.0)) * own["velocity"]
    errors["velocity"] = scene.drive.tolerance * (1.0 + velocity / measures["velocity"])
    if fine.units.fixed and not fine.drive.depths:
        errors |= {"depth": 0.0, "depth_rate": 0.0}
    return Certificate("estimated", STATEMENT, errors, AT_REST)


def _series(states: NDArray[Any], own: Mapping[str, float]) -> dict[str, Array]:
    return {name: states[name] for name in SERIES if name in own}


def _lost(motion: Trajectory) -> dict[str, float]:
    """Return how much of the vibration of each mass on the contact the steps lose, as a scaled rate.

    Steps may be longer than the period of light masses. They then follow the mean motion, and so may those of
    another solution: both agree on what they leave out. Where the acceleration jumps by a from one step to
    the next, this vibration e^(sigma t) has the amplitude a/|sigma| as a rate, and a step h makes of it R(z),
    z = sigma h, instead of e^z, R being the stability function of the method. The masses are those on the
    contact at rest, sigma of eps sigma^2 + (3/4) c I_0 sigma + (3/4) G(0)/K I_0 + kappa = 0, and along x with
    3 I_2.
    """
    given, run, steps = readable(motion.run.given[0]), motion.run, motion.steps
    n, glass = given.stages, 1.0 + given.glass
    passes = steps["lasts"] > 0.0
    span = steps["span"][passes, None]
    ends = np.append(steps["start"][1:], motion.counts.s)[passes, None]
    share, powers = (ends - steps["start"][passes, None]) / span, np.arange(1, n + 1)
    A, rates = together(run.method, METHOD)["A"], together(run.polynomials, POLYNOMIAL)
    masses = []
    if not given.fixed:
        masses.append(("depth_rate", rates["depth_rate"], given.eps, 0.0, given.kappa, 1.5))
    if given.sprung:
        along = rates["offset_rate"], given.eps_x, given.damping, given.spring, 2.0
        masses.append(("sliding_velocity", *along))
    found = {}
    for name, rate, eps, damping, stiffness, below in masses:
        slopes = powers * rate[: motion.counts.steps][passes, 1:] / span
        jumps = slopes[1:, 0] - np.sum(slopes * share ** (powers - 1), axis=1)[:-1]
        damped = damping + below * given.damper
        root = np.sqrt(damped * damped - 4.0 * eps * (stiffness + below * glass) + 0j)
        sigma = -(damped + root) / (2.0 * eps)
        z = sigma * span[1:, :, None]
        kept = np.linalg.solve(np.eye(n) - z * A, np.ones((n, 1)))[:, -1, 0]
        missing = np.abs(kept - np.exp(z[:, 0, 0])) * np.abs(jumps / sigma)
        found[name] = float(np.sum(missing))
    return found


def _anywhere(
    fine: Any, other: Trajectory, lost: Mapping[str, float], rtol: float, tolerance: float
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
        apart = MARGIN * apart + SAFETY * lost.get(name, 0.0)
        return float(max(apart, FLOOR * rtol * (1.0 + largest)))

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
