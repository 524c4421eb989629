"""The transient of a scene in SI units, from the scaled solution of `continuum`."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum import maxima
from kvtheory.models.continuum.energy import Impulses, Ledger
from kvtheory.models.continuum.error_estimate import (
    FLOOR,
    LOOSEST,
    MARGIN,
    NOT_ASKED,
    NOTHING,
    TIGHTEST,
    certificate,
    methods,
)
from kvtheory.models.continuum.evaluation import SERIES, STATE
from kvtheory.models.continuum.run import STATE_NAMES, Beginning, Spring, StepControl
from kvtheory.models.continuum.solver import STEP_LIMIT, solve
from kvtheory.progress import Progress
from kvtheory.records import structured
from kvtheory.results import Certificate, Event, SprungTransient, Transient
from kvtheory.results.cycles import Cycle, cycle, note, sampled
from kvtheory.results.errors import TransientError
from kvtheory.results.table import scales
from kvtheory.results.transient import STOPPED
from kvtheory.scene.base_motion import SAME_TIME, BaseMotion
from kvtheory.scene.model import Scene
from kvtheory.scene.start import REST, Start
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

AFTER_END = 1e-12
"""Share of the run by which a time may exceed its end because of rounding."""
TO_A_CHANGE = 0.5 * AFTER_END
"""Share of the run by which it is extended if the drive changes so close to its end that both count as one
time: the solver then includes the change."""
STEPS_A_PIECE = 100
"""Upper bound on the steps for one piece of a drive; a stop takes 25."""


def end_of(scene: Scene) -> float:
    """Return the time (s) at which the solution ends: the end of the run, or of a longer history."""
    return max(scene.run.duration, last_change(scene))


def last_change(scene: Scene) -> float:
    """Return the time (s) of the last point of the histories of the drive and of the depth; 0 of others."""
    drive = scene.drive
    depth = scene.depths[-1][0] if scene.depths else 0.0
    return max(depth, drive.last_change if drive.function is None else 0.0)


def scaled_drive(scene: Scene, units: StaticState) -> BaseMotion:
    """Return the drive number over scaled time to the end, or just beyond it if a history changes there."""
    end, last = end_of(scene), last_change(scene)
    if end - last <= SAME_TIME * math.ulp(end):
        end *= 1.0 + TO_A_CHANGE
    return scene.motion(end, units.velocity).scaled(units.time, units.half_length, units.depth)


@dataclass(frozen=True)
class SolvedScene:
    """A solved motion and its scales; evaluates every quantity of a transient in SI.

    `motion` is a `Trajectory`, on a Prony series one of `prony.trajectory`. `end` is that of the run in
    scaled time; the motion may extend slightly beyond it. `coasts` is of the drive.
    """

    motion: Any
    drive: BaseMotion
    units: StaticState
    end: float
    start: Start = REST
    coasts: bool = False
    other: Any = None
    """The motion with another tolerance, with which this one is compared."""

    @property
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

    @property
    def events(self) -> tuple[Event, ...]:
        """The events of the contact, and the force maxima, in order of time (s)."""
        found: list[tuple[float, str]] = [*self.motion.events]
        moves = self.drive.highest_speed > 0.0 or self.drive.depths or not self.start.at_rest
        if moves:
            times = zip(force_maxima(self.motion), ("normal", "friction"), strict=True)
            found += [(s, f"{force} force maximum") for s, force in times]
        found.sort(key=lambda event: event[0])
        return tuple(Event(s * self.units.time, kind) for s, kind in found)

    def series(self, time: ArrayLike) -> dict[str, Any]:
        """Return the quantities and states at the given times (s)."""
        found, own = self.motion.states(np.atleast_1d(self.scaled(time))), scales(self.units)
        left, right = found["edge_states"].T
        leads = found["leading_edge"] == found["edges"][:, 0]
        leading, trailing = np.where(leads, left, right), np.where(leads, right, left)
        return {
            "time": np.asarray(time, dtype=float),
            **{name: found[name] * own[name] for name in SERIES if name in own},
            "leading_state": tuple(map(STATE_NAMES.__getitem__, leading.tolist())),
            "trailing_state": tuple(map(STATE_NAMES.__getitem__, trailing.tolist())),
        }

    @cached_property
    def landmarks(self) -> dict[str, Any]:
        """Return restitution and contact time of a drop, and where and when a coasting indenter stops."""
        motion, unit, found = self.motion, self.units, dict[str, float]()
        hops = {kind: s for s, kind in reversed(motion.events) if kind in ("landing", "take-off")}
        if self.start.gap is not None and len(hops) == 2:
            down, up = motion.states([hops["landing"], hops["take-off"]])["depth_rate"]
            found["restitution"] = float(-up / down)
            found["contact_time"] = (hops["take-off"] - hops["landing"]) * unit.time
        if self.coasts:
            found |= self._stop()
        return found

    @cached_property
    def cycle(self) -> Cycle:
        """The cycle in which a motion on a spring ends, compared with that of the other motion."""
        found, *others = map(self._cycle, filter(None, (self.motion, self.other)))
        return found.beside(others, MARGIN)

    @property
    def notes(self) -> tuple[str, ...]:
        """What the end of a motion on a spring is not."""
        if self.units.rigid_drive or self.coasts:
            return ()
        times, found, count = self.motion.samples
        time, found = np.array(times[:count]) * self.units.time, structured(found[:count], STATE)
        rate, slides = (
            found[name] / self.units.time for name in ("offset_rate", "sliding_velocity")
        )
        said = note(time, sampled(time, found["offset"], rate, sliding_velocity=slides))
        return (said,) if said else ()

    def _cycle(self, motion: Any) -> Cycle:
        """Return the cycle of a motion."""
        if self.units.rigid_drive or self.coasts:
            raise ValueError("a cycle needs a drive with a spring: `drive.stiffness`")
        units, (s, _, count) = self.units, motion.samples
        scale = {
            "offset": units.half_length, "offset_rate": units.velocity,
            "sliding_velocity": units.velocity, "friction_force": units.friction_force,
        }  # fmt: skip

        def states(time: Array) -> dict[str, Array]:
            found = motion.states(np.minimum(time / units.time, motion.end), peaks=False)
            return {name: found[name] * own for name, own in scale.items()}

        return cycle(np.array(s[:count]) * units.time, states)

    def _stop(self) -> dict[str, float]:
        """Return when the sliding velocity stays below a share of the first one, and the distance slid."""
        motion = self.motion
        times, states, count = motion.samples
        speed = np.abs(np.array(structured(states[:count], STATE)["sliding_velocity"]))
        late = np.flatnonzero(speed > STOPPED * speed[0])
        if not late.size or late[-1] == count - 1:
            return {}
        low, high = times[late[-1]], times[late[-1] + 1]
        for _ in range(maxima.BISECTIONS):
            middle = 0.5 * (low + high)
            slides = abs(motion.states([middle])["sliding_velocity"][0]) > STOPPED * speed[0]
            low, high = (middle, high) if slides else (low, middle)
        way = abs(float(motion.states([high])["way"][0]))
        return {
            "stopping_time": float(high) * self.units.time,
            "stopping_distance": way * self.units.half_length,
        }

    def pressure(self, x: ArrayLike, time: float) -> Array:
        """Return p in Pa at the positions `x` (m)."""
        p: Array = self.motion.pressure(self._xi(x), self.scaled(time))
        return p * self.units.pressure

    def surface(self, x: ArrayLike, time: float) -> Array:
        """Return the compression u in m of the foundation at the positions `x` (m)."""
        u: Array = self.motion.compression(self._xi(x), self.scaled(time))
        return u * self.units.depth

    def _xi(self, x: ArrayLike) -> Array:
        return np.asarray(x, dtype=float) / self.units.half_length

    def energy(self, time: ArrayLike) -> Ledger:
        """Return the energy ledger in J/m at the times (s)."""
        books: Ledger = self.motion.ledger(self.scaled(time))
        return books.scaled(self.units.energy)

    def impulse(self, time: ArrayLike) -> Impulses:
        """Return the vertical impulses in N s/m until the times (s)."""
        found: Impulses = self.motion.impulses(self.scaled(time))
        return found.scaled(self.units.load * self.units.time)


def transient(
    scene: Scene, times: ArrayLike | None, rtol: float, progress: Progress | None = None,
    *, certify: bool = True, max_steps: int | None = None,
) -> Transient:  # fmt: skip
    """Solve a scene; `kvtheory.transient` documents it."""
    return result(*certified(scene, times, rtol, progress, certify=certify, max_steps=max_steps))


def result(solution: SolvedScene, time: Array, errors: Certificate) -> Transient:
    """Return the answer for a solved scene at the times (s)."""
    motion = solution.motion
    kind = Transient if solution.units.rigid_drive else SprungTransient
    return kind(
        **solution.series(time), events=solution.events, steps=motion.counts.steps,
        evaluations=motion.counts.evaluations, compiled=motion.compiled, model="continuum",
        certificate=errors, solution=solution, notes=solution.notes, **solution.landmarks,
    )  # fmt: skip


def spring_of(units: StaticState) -> Spring | None:
    """Return the spring of a drive, or None if it is rigid."""
    if units.rigid_drive:
        return None
    return Spring(
        units.drive_inertia_number, units.drive_damping_number, units.drive_stiffness_number
    )


def beginning(scene: Scene, units: StaticState, drive: BaseMotion) -> Beginning:
    """Return the scaled state just after t = 0."""
    depth, rate, along, _ = scene.start.at(units.depth, drive.velocity(0.0) * units.velocity)
    if drive.depths:
        return Beginning(*drive.depths[0], along / units.velocity)
    return Beginning(depth / units.depth, rate / units.depth_rate, along / units.velocity)


def force_maxima(motion: Any) -> tuple[float, float]:
    """Return the times at which f_z and |f_x| are largest, each the first one from s = 0 on."""
    forces = ((name, maxima.MAGNITUDE) for name in ("normal_force", "friction_force"))
    normal, friction = motion.largest(*forces)["time"].tolist()
    return normal, friction


class Method(NamedTuple):
    """How scenes of a law are solved: in which units, by what, with which tolerances and steps."""

    units: StaticState
    solve: Callable[..., Any]
    """Of a drive, both numbers, the end and a tolerance."""
    steps: int
    first: tuple[float, StepControl]
    others: tuple[tuple[float, StepControl], ...]
    """Tolerance and steps of the solution that it is compared with: the first that succeeds."""
    certificate: Callable[..., Certificate]
    """Of a solved scene, another solution or None, the times asked, and why there is no other."""


def method_of(scene: Scene, rtol: float) -> Method:
    """Return how a scene is solved: on arms by `prony`, else by the closed forms of Kelvin-Voigt."""
    if scene.foundation.arms:
        return _on_arms(scene, rtol)
    first, second = methods(rtol)

    def errors(fine: SolvedScene, other: Any, s: Array | None, why: str) -> Certificate:
        return certificate(fine.motion, other, s, scene.drive.tolerance, why)

    return Method(StaticState.of(scene), solve, STEP_LIMIT, first, (second,), errors)


def _on_arms(scene: Scene, rtol: float) -> Method:
    """Return how a scene whose foundation has arms is solved; ValueError if that fails."""
    from kvtheory.models.continuum.prony import error_estimate, trajectory

    units, rtol, foundation = own_units(scene), min(rtol, LOOSEST), scene.foundation
    stiffness = foundation.stiffness
    arms = [
        (arm.stiffness / stiffness, arm.relaxation_time / units.time) for arm in foundation.arms
    ]
    damper = foundation.damping / (stiffness * units.time)

    def solved(drive: BaseMotion, eps: float, kappa: float, *given: Any, **how: Any) -> Any:
        try:
            return trajectory.solve(drive, arms, (eps, kappa), *given, damper=damper, **how)
        except ValueError as error:
            why, s = error.args
            message = (
                f"fails numerically at t = {s * units.time:.6g} s: {why}; try another tolerance"
            )
            raise ValueError(f"the transient on a Prony series {message}") from None

    first, second = (rtol, error_estimate.FIRST), error_estimate.SECOND
    others = tuple((max(rtol / each, TIGHTEST), second) for each in error_estimate.OTHERS)
    errors = partial(error_estimate.certificate, scene, rtol)
    return Method(units, solved, trajectory.STEP_LIMIT, first, others, errors)


def own_units(scene: Scene) -> StaticState:
    """Return the static state with a unit of time of the motion: that of the foundation may be far from it.

    It is that of the run, or that in which the base moves by a half length, or an indenter that is held by
    the static depth, if this is shorter.
    """
    units, end = StaticState.of(scene), end_of(scene)
    motion = scene.motion(end, units.velocity)
    speed, sinks = motion.highest_speed, max((abs(rate) for _, rate in motion.depths), default=0.0)
    time = min(end, units.half_length / speed) if speed > 0.0 else end
    time = min(time, units.depth / sinks) if sinks > 0.0 else time
    ratio = units.time / time
    return replace(
        units, time=time, drive_number=units.drive_number / ratio,
        inertia_number=units.inertia_number * ratio**2,
        drive_inertia_number=units.drive_inertia_number * ratio**2,
        drive_damping_number=units.drive_damping_number * ratio,
    )  # fmt: skip


def certified(
    scene: Scene, times: ArrayLike | None, rtol: float, progress: Progress | None = None,
    *, certify: bool = True, max_steps: int | None = None,
) -> tuple[SolvedScene, Array, Certificate]:  # fmt: skip
    """Solve a scene, then again with a tighter tolerance; also return the times (s) of the certificate.

    Without `times`, these are the natural ones.
    """
    method = method_of(scene, rtol)
    units = method.units
    drive, spring = scaled_drive(scene, units), spring_of(units)
    start = beginning(scene, units, drive)
    limit = max_steps or method.steps + STEPS_A_PIECE * len(drive.pieces)

    def solved(part: int, tolerance: float, control: StepControl) -> Any:
        def report(s: float) -> None:
            if progress is not None:
                progress((part + s / drive.end) / (1 + certify), "")

        return method.solve(
            drive, units.inertia_number, units.support_number, drive.end, tolerance,
            spring=spring, start=start, control=control, progress=report, max_steps=limit,
        )  # fmt: skip

    try:
        motion = solved(0, *method.first)
    except TransientError as error:
        lasts = drive.end * (units.time / scene.foundation.retardation_time)
        reason = f"{error.reason}, in a run of {lasts:.4g} retardation times,"
        raise TransientError(reason, error.s * units.time, "t", " s") from None
    fine = SolvedScene(
        motion, drive, units, end_of(scene) / units.time, scene.start, scene.drive.coasts
    )
    time = fine.natural_times if times is None else np.asarray(times, dtype=float).reshape(-1)
    other = None
    for each in method.others if certify else ():
        with suppress(ValueError, ArithmeticError):  # it may fail where the first one did not
            other = solved(1, *each)
            break
    s = None if times is None else fine.scaled(time)
    fine = replace(fine, other=other)
    errors = method.certificate(fine, other, s, NOTHING if certify else NOT_ASKED)
    if other is None or not fine.landmarks:
        return fine, time, errors
    beside = replace(fine, motion=other).landmarks
    marks = {
        name: max(MARGIN * abs(beside.get(name, math.inf) / value - 1.0), FLOOR * rtol)
        for name, value in fine.landmarks.items()
    }
    statement = f"{errors.statement}; those of {' and '.join(marks)} are relative to their value"
    marks = {**errors.relative_error, **marks}
    return fine, time, replace(errors, statement=statement, relative_error=marks)
