"""The transient of a scene on a Prony series in SI units, and its error, estimated as on Kelvin-Voigt."""

import math
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum.error_estimate import (
    COMPARISON,
    FLOOR,
    LOOSEST,
    MARGIN,
    NOT_ASKED,
    NOTHING,
    TIGHTER,
    TIGHTEST,
)
from kvtheory.models.continuum.prony import evaluation as e_
from kvtheory.models.continuum.prony.trajectory import STEP_LIMIT, Trajectory, solve
from kvtheory.models.continuum.run import Spring, StepControl
from kvtheory.models.continuum.solved_scene import AFTER_END, end_of, scaled_drive
from kvtheory.progress import Progress
from kvtheory.results import AT_REST, Certificate, Event, SprungTransient, Transient
from kvtheory.results.errors import TransientError
from kvtheory.results.table import scales
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

COLUMNS = {
    "velocity": e_.DRIVE, "sliding_velocity": e_.NUMBER, "depth": e_.DEPTH, "depth_rate": e_.RATE,
    "normal_force": e_.NORMAL_FORCE, "friction_force": e_.FRICTION_FORCE, "leading_edge": e_.LEFT,
    "trailing_edge": e_.RIGHT, "peak_pressure": e_.PEAK_PRESSURE,
}  # fmt: skip
"""Column of each quantity in the states; the force of a spring follows from x and x'."""
MIRRORED = {
    "velocity", "sliding_velocity", "friction_force", "leading_edge", "trailing_edge", "spring_force"
}  # fmt: skip
"""Quantities that change their sign with the velocity."""
ROUNDING = 4e-15
"""Rounding of the moments, relative to the largest accumulator: it is large on arms that hardly relax."""
STATEMENT = (
    f"{MARGIN:g} times the difference to a solution with {1 / TIGHTER:g} times the tolerance and other "
    "step sizes, plus a bound of rounding"
)
FIRST = StepControl(longest=math.inf)
SECOND = COMPARISON._replace(longest=math.inf)


@dataclass(frozen=True)
class SolvedPronyScene:
    """A solved motion and its scales; evaluates every quantity of a transient in SI.

    `side` is the sign of the velocity: the motion is that of its mirror image.
    """

    motion: Trajectory
    units: StaticState
    side: float
    end: float

    @cached_property
    def natural_times(self) -> Array:
        """Times (s) that show the whole series: the solver's steps, subdivided."""
        s = self.motion.natural
        s = s[: np.searchsorted(s, self.end) + 1].copy()
        s[-1] = self.end
        return s * self.units.time

    def scaled(self, time: Any) -> Any:
        """Return times in units of tau; those beyond the end by rounding only are set to the end."""
        s, end = np.asarray(time, dtype=float) / self.units.time, self.end
        if not ((s >= 0.0) & (s <= end * (1.0 + AFTER_END))).all():
            raise ValueError(f"`time` must lie in [0, {end * self.units.time!r}] s, got {time!r}")
        return np.minimum(s, end)[()]

    def series(self, time: ArrayLike) -> dict[str, Any]:
        """Return the quantities and the states of the edges at the given times (s)."""
        found, own = self.scaled_series(self.motion, self.scaled(time)), scales(self.units)
        count = len(found["depth"])
        return {
            "time": np.asarray(time, dtype=float),
            **{name: value * own[name] * (self.side if name in MIRRORED else 1.0)
               for name, value in found.items() },
            "leading_state": ("touching",) * count,
            "trailing_state": ("peeling",) * count,
        }  # fmt: skip

    def scaled_series(self, motion: Trajectory, s: Any) -> dict[str, Array]:
        """Return the scaled quantities of a motion at scaled times, for a velocity above zero."""
        states, units = motion.states(s), self.units
        found = {name: states[at] for name, at in COLUMNS.items() if name in scales(units)}
        if not units.rigid_drive:
            spring, damping = units.drive_stiffness_number, units.drive_damping_number
            found["spring_force"] = spring * states[e_.ALONG_X] + damping * states[e_.ALONG_RATE]
        return found

    @property
    def events(self) -> tuple[Event, ...]:
        """The maxima of the forces, in order of time (s)."""
        s = self.motion.natural
        found = []
        for name, at in (("normal", e_.NORMAL_FORCE), ("friction", e_.FRICTION_FORCE)):
            k = int(np.argmax(np.abs(self.motion.states(s)[at])))
            low, high = s[max(k - 1, 0)], s[min(k + 1, len(s) - 1)]
            fine = np.linspace(low, high, 65)
            k = int(np.argmax(np.abs(self.motion.states(fine)[at])))
            found.append(Event(float(fine[k]) * self.units.time, f"{name} force maximum"))
        return tuple(sorted(found, key=lambda event: event.time))

    def pressure(self, x: ArrayLike, time: float) -> Array:
        """Return p in Pa at the positions `x` (m)."""
        s, xi = (
            self.scaled(time),
            self.side * np.atleast_1d(np.asarray(x, float)) / self.units.half_length,
        )
        l, r = self.motion.states([s])[[e_.LEFT, e_.RIGHT], 0]
        inside = (l <= xi) & (xi <= r)
        p = np.zeros(xi.shape)
        p[inside] = np.maximum(self.motion.pressure(xi[inside], s), 0.0)
        return (p * self.units.pressure).reshape(np.shape(x))

    def surface(self, x: ArrayLike, time: float) -> Array:
        """Refuse: the free surface behind the contact is not evaluated."""
        raise ValueError("`surface` holds for Kelvin-Voigt only; on a Prony series `pressure` does")

    def energy(self, time: ArrayLike) -> Any:
        """Refuse: the energies behind the contact are not evaluated."""
        raise ValueError("`energy` holds for Kelvin-Voigt only")


def own_units(scene: Scene) -> StaticState:
    """Return the static state with a unit of time of the motion: that of the foundation may be far from it.

    It is that of the run, or that in which the base moves by a half length if this is shorter.
    """
    units, end = StaticState.of(scene), end_of(scene)
    speed = scene.drive.motion(end, units.velocity).highest_speed
    time = min(end, units.half_length / speed) if speed > 0.0 else end
    ratio = units.time / time
    return replace(
        units, time=time, drive_number=units.drive_number / ratio,
        inertia_number=units.inertia_number * ratio**2,
        drive_inertia_number=units.drive_inertia_number * ratio**2,
        drive_damping_number=units.drive_damping_number * ratio,
    )  # fmt: skip


def mirrored(drive: BaseMotion) -> tuple[BaseMotion, float]:
    """Return a drive that moves one way with V >= 0, and the sign of the velocity of the given one."""
    speeds = drive.velocities
    if speeds[0] >= 0.0:
        return drive, 1.0
    if speeds[-1] > 0.0:
        raise ValueError("the drive reverses")
    pieces = tuple((a, b, *(-c for c in rest)) for a, b, *rest in drive.pieces)
    return BaseMotion(pieces, drive.changes), -1.0


def transient(
    scene: Scene, times: ArrayLike | None, rtol: float, progress: Progress | None = None,
    *, certify: bool = True, max_steps: int | None = None,
) -> Transient:  # fmt: skip
    """Solve a scene whose foundation is a Prony series; `kvtheory.transient` documents it.

    ValueError if an edge returns to ground that it left: a stop, a reversal, a hop.
    """
    units = own_units(scene)
    drive, side = mirrored(scaled_drive(scene, units))
    foundation, spring = scene.foundation, None
    arms = [
        (arm.stiffness / foundation.stiffness, arm.relaxation_time / units.time)
        for arm in foundation.arms
    ]
    if not units.rigid_drive:
        spring = Spring(
            units.drive_inertia_number, units.drive_damping_number, units.drive_stiffness_number
        )

    def solved(part: int, tolerance: float, control: StepControl) -> Trajectory:
        def report(s: float) -> None:
            if progress is not None:
                progress((part + s / drive.end) / (1 + certify), "")

        return solve(
            drive, arms, (units.inertia_number, units.support_number), drive.end, tolerance,
            spring=spring, control=control, progress=report, max_steps=max_steps or STEP_LIMIT,
        )  # fmt: skip

    rtol = min(rtol, LOOSEST)
    try:
        motion = solved(0, rtol, FIRST)
    except TransientError as error:
        raise TransientError(error.reason, error.s * units.time, "t", " s") from None
    except ValueError as error:
        why, s = error.args
        at = f"{why} at t = {s * units.time:.6g} s"
        raise ValueError(f"on a Prony series holds for sliding one way: {at}") from None
    fine = SolvedPronyScene(motion, units, side, end_of(scene) / units.time)
    time = fine.natural_times if times is None else np.asarray(times, dtype=float).reshape(-1)
    other, why = None, NOTHING if certify else NOT_ASKED
    if certify:
        with suppress(
            ValueError, ArithmeticError
        ):  # a tighter solution may fail where this one did not
            other = solved(1, max(rtol / TIGHTER, TIGHTEST), SECOND)
    kind = Transient if units.rigid_drive else SprungTransient
    return kind(
        **fine.series(time), events=fine.events, steps=motion.counts.steps,
        evaluations=motion.counts.evaluations, compiled=motion.compiled, model="continuum",
        certificate=certificate(fine, other, fine.scaled(time), rtol, scene, why),
        solution=fine,
    )  # fmt: skip


def certificate(
    fine: SolvedPronyScene, other: Trajectory | None, s: Array, rtol: float, scene: Scene, why: str
) -> Certificate:
    """Return the certificate of the states at scaled times, from a solution with a tighter tolerance."""
    here = fine.scaled_series(fine.motion, s)
    if other is None:
        errors = dict.fromkeys(here, math.inf)
        return Certificate("estimated", why, {"time": 0.0, **errors}, AT_REST)
    there = fine.scaled_series(other, s)
    rounding = ROUNDING * float(
        np.abs(fine.motion.run.arms[:, :1] * fine.motion.run.state[:, :2]).sum()
    )
    errors = {"time": 0.0}
    for name, values in here.items():
        apart = float(np.max(np.abs(values - there[name]), initial=0.0))
        least = FLOOR * rtol * (1.0 + float(np.max(np.abs(values), initial=0.0)))
        errors[name] = max(MARGIN * apart, least) + rounding
    own, measures = scales(fine.units), scales(StaticState.of(scene))  # other units of time
    errors = {name: error * (own[name] / measures[name]) for name, error in errors.items()}
    velocity = float(np.max(np.abs(here["velocity"]), initial=0.0)) * own["velocity"]
    errors["velocity"] = scene.drive.tolerance * (1.0 + velocity / measures["velocity"])
    if fine.units.fixed:
        errors |= {"depth": 0.0, "depth_rate": 0.0}
    return Certificate("estimated", STATEMENT, errors, AT_REST)
