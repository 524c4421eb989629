"""The transient of a scene in SI: the scaled solution of `continuum`, put back into units."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from operator import itemgetter
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kvtheory.models.continuum import evaluation
from kvtheory.models.continuum.energy import Ledger, ledger
from kvtheory.models.continuum.error_estimate import COARSER, COMPARISONS, certificate
from kvtheory.models.continuum.maxima import force_maxima
from kvtheory.models.continuum.radau_iia import stages_for
from kvtheory.models.continuum.run import StepControl
from kvtheory.models.continuum.solver import STATE_NAMES, Trajectory, solve
from kvtheory.models.continuum.surface import height
from kvtheory.results import Certificate, Event, Transient
from kvtheory.results.errors import TransientError
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

LOOSEST = 1e-4
"""Looser tolerances save no more steps."""

SUBDIVISIONS = 4
"""Points shown for each step of the solver, which is long where nothing happens."""

AFTER_END = 1e-12
"""Share of the run by which a time may lie after its end, from rounding."""
FORCE_MAXIMA = "normal force maximum", "friction force maximum"
"""Kinds of events."""


def scaled_drive(scene: Scene, units: StaticState) -> BaseMotion:
    """Return the drive number over scaled time until the end of the run."""
    motion = scene.drive.motion(scene.run.duration, units.velocity)
    return motion.scaled(units.time, units.half_length)


@dataclass(frozen=True)
class SolvedScene:
    """A solved motion and its scales; evaluates every quantity of a transient in SI."""

    motion: Trajectory
    drive: BaseMotion
    units: StaticState

    @cached_property
    def natural_times(self) -> Array:
        """Times (s) at which the series shows all that happens: the solver's steps, subdivided."""
        ends = np.append(np.array(self.motion.starts), self.motion.end)
        parts = np.arange(SUBDIVISIONS) / SUBDIVISIONS
        inner = (ends[:-1, None] + np.diff(ends)[:, None] * parts).reshape(-1)
        return np.unique(np.append(inner, self.motion.end)) * self.units.time

    def series(self, time: ArrayLike) -> dict[str, Any]:
        """Return the quantities and states at the given times (s)."""
        found, u = self.states(time), self.units
        numbers = found[evaluation.NUMBER]
        forward = _forward(numbers)
        left, right = found[evaluation.LEFT], found[evaluation.RIGHT]
        names = [
            [STATE_NAMES[state] for state in found[side].tolist()]
            for side in (evaluation.LEFT_STATE, evaluation.RIGHT_STATE)
        ]
        pairs = list(zip(*names, forward.tolist(), strict=True))
        return {
            "time": np.asarray(time, dtype=float),
            "velocity": numbers * u.velocity,
            "depth": found[evaluation.DEPTH] * u.depth,
            "depth_rate": found[evaluation.RATE] * u.depth_rate,
            "normal_force": found[evaluation.NORMAL_FORCE] * u.load,
            "friction_force": found[evaluation.FRICTION_FORCE] * u.friction_force,
            "leading_edge": np.where(forward, left, right) * u.half_length,
            "trailing_edge": np.where(forward, right, left) * u.half_length,
            "peak_pressure": found[evaluation.PEAK_PRESSURE] * u.pressure,
            "leading_state": tuple(l if leads else r for l, r, leads in pairs),
            "trailing_state": tuple(r if leads else l for l, r, leads in pairs),
        }

    def states(self, time: ArrayLike) -> Array:
        """Return the scaled states at the times (s): a row for each quantity of `states`."""
        s = np.asarray(time, dtype=float) / self.units.time
        return self.motion.states(np.minimum(s, self.motion.end)).T

    def pressure(self, x: ArrayLike, time: float) -> Array:
        """Return p in Pa at the positions `x` (m): K (d + d' - xi^2 - 2 lambda xi) in the contact."""
        s = self._scaled(time)
        moment, number = self.motion.at(s), self.drive.at(s)[1]
        xi = np.asarray(x, dtype=float) / self.units.half_length
        p = moment.depth + moment.rate - xi * (xi + 2.0 * number)
        inside = (moment.left <= xi) & (xi <= moment.right)  # false in flight, where both are NaN
        return np.where(inside, np.maximum(p, 0.0), 0.0) * self.units.pressure

    def surface(self, x: ArrayLike, time: float) -> Array:
        """Return the compression u in m of the foundation at the positions `x` (m)."""
        xi = np.asarray(x, dtype=float) / self.units.half_length
        return height(self.motion, xi, self._scaled(time)) * self.units.depth

    def energy(self, time: ArrayLike) -> Ledger:
        """Return the energy ledger in J/m at the times (s)."""
        return ledger(self.motion, self._scaled(time)).scaled(self.units.energy)

    def _scaled(self, time: Any) -> Any:
        """Return times in units of tau; those after the end by no more than rounding are the end."""
        s, end = np.asarray(time, dtype=float) / self.units.time, self.motion.end
        if not np.all((s >= 0.0) & (s <= end * (1.0 + AFTER_END))):
            raise ValueError(f"`time` must lie in [0, {end * self.units.time!r}] s, got {time!r}")
        return np.minimum(s, end)[()]


def transient(
    scene: Scene,
    times: ArrayLike | None,
    rtol: float,
    progress: Callable[[float], Any] | None = None,
) -> Transient:
    """Solve a scene; `kvtheory.transient` documents it."""
    solution, time, errors = certified(scene, times, rtol, progress)
    motion = solution.motion
    found = zip(force_maxima(motion), FORCE_MAXIMA, strict=True)
    events = sorted([*motion.events, *found], key=itemgetter(0))
    return Transient(
        **solution.series(time),
        events=tuple(Event(s * solution.units.time, kind) for s, kind in events),
        steps=motion.steps,
        evaluations=motion.evaluations,
        compiled=motion.compiled,
        model="continuum",
        certificate=errors,
        solution=solution,
    )


def certified(
    scene: Scene,
    times: ArrayLike | None,
    rtol: float,
    progress: Callable[[float], Any] | None = None,
) -> tuple[SolvedScene, Array, Certificate]:
    """Solve a scene, and with a looser tolerance again; return the times (s) that are judged, too.

    Without `times`, these are the natural ones.
    """
    units = StaticState.of(scene)
    drive = scaled_drive(scene, units)
    rtol = min(rtol, LOOSEST)

    def solved(part: int, tolerance: float, control: StepControl) -> SolvedScene:
        def report(s: float) -> None:
            if progress is not None:
                progress((part + s / drive.end) / (1 + len(COMPARISONS)))

        return _solution(scene, units, drive, tolerance, control, report)

    fine = solved(0, rtol, StepControl())
    time = fine.natural_times if times is None else np.asarray(times, dtype=float).reshape(-1)
    others = []
    for part, control in enumerate(COMPARISONS, 1):
        with suppress(TransientError):  # a looser solution may fail where this one did not
            alike = control._replace(stages=stages_for(rtol))
            others.append(solved(part, COARSER * rtol, alike).states(time))
    return fine, time, certificate(fine.states(time), others, rtol)


def _solution(
    scene: Scene,
    units: StaticState,
    drive: BaseMotion,
    rtol: float,
    control: StepControl,
    progress: Callable[[float], Any],
) -> SolvedScene:
    numbers = units.inertia_number, units.support_number
    try:
        motion = solve(drive, *numbers, drive.end, rtol, control=control, progress=progress)
    except TransientError as error:
        reason = f"{error.reason}, in a run of {drive.end:.4g} retardation times,"
        raise TransientError(reason, error.s * units.time, "t", " s") from None
    return SolvedScene(motion, drive, units)


def _forward(numbers: Array) -> NDArray[np.bool_]:
    """Whether the left edge leads; at rest, as it did before."""
    moving = np.where(numbers == 0.0, np.nan, numbers)
    known = np.maximum.accumulate(np.where(np.isnan(moving), 0, np.arange(numbers.size)))
    return ~(numbers[known] < 0.0)
