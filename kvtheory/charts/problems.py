"""The scenes of the work-precision charts, and their reference solutions by two independent methods.

Scenes for testing other simulations are in `kvtheory.reference_problems`.
"""

import json
import math
from dataclasses import dataclass, replace
from functools import cached_property, partial
from importlib.resources import files
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from kvtheory.api import elements
from kvtheory.charts import naive
from kvtheory.charts.naive import Array, Piece, scaled_scene
from kvtheory.charts.work_precision import MISSED, NO_LIMIT, WRONG, Clock, Reference
from kvtheory.models.continuum import solver
from kvtheory.models.continuum.prony import trajectory
from kvtheory.models.continuum.run import Beginning
from kvtheory.models.continuum.solved_scene import beginning, scaled_drive
from kvtheory.scene.base_motion import BaseMotion
from kvtheory.scene.foundations import Arm, GeneralizedMaxwell
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

UNIFORM_TIMES = 41
"""Instants over the run at which errors are measured."""
AFTER_JUMP = np.geomspace(1e-4, 5e-2, 9)
"""Further instants soon after each jump, as shares of the run."""
LEAST_SPACING = 1e-6
"""Smallest spacing of instants, as a share of the run."""
REFERENCE_RTOL = 1e-12
NO_MEMORY = 1e-7
"""Difference of the two states from the continuum below which the memory has no effect."""
DENSITIES = {False: 160.0, True: 60.0}
"""Elements per static half length of the finer reference by elements, by `Problem.quick`."""
TABLE = "work_precision_reference.json"
"""Independent solutions of the standard scenes; its generator is among the tests."""
LARGE_ERROR = 1e-3
"""Error of a curve above which a run that reported success is wrong, if it also far exceeds the tolerance."""
FAR_BEYOND = 100.0
"""Multiple of the tolerance above which an error far exceeds it."""
JUDGED = "depth, maximum", "friction, maximum"
"""Errors by which a run is called wrong."""

LAMBDA, EPSILON = 4.0812765306, 0.0030609574
"""Of Table 1."""
STANDARD: dict[str, tuple[list[Piece], float]] = {
    "table-1": ([(0.0, 2.0, LAMBDA)], EPSILON),
    "low-velocity": ([(0.0, 2.0, 0.04)], EPSILON),
    "high-velocity": ([(0.0, 0.25, 40.0)], EPSILON),
    "small-inertia": ([(0.0, 2.0, LAMBDA)], 1e-5),
    "stop-and-go": ([(0.0, 0.5, LAMBDA), (0.5, 0.7, 0.0), (0.7, 1.5, LAMBDA)], EPSILON),
    "reversal": ([(0.0, 0.5, LAMBDA), (0.5, 1.5, -LAMBDA)], EPSILON),
    "hop": ([(0.0, 4.0, 4.0)], 0.3),
    "rubber": ([(0.0, 1.5, 4.0)], EPSILON),
}
"""Drive (pieces of s, lambda) and inertia number of the standard scenes."""
ARMS = {"rubber": (Arm(4.0, 0.03), Arm(2.0, 0.3), Arm(1.0, 3.0))}
"""Stiffness and relaxation time of the arms that stand for the damper, in the scaled scene."""


class Curves(NamedTuple):
    """Depth and friction force in scaled form at the instants of a problem."""

    depth: Array
    friction: Array


@dataclass(frozen=True)
class Problem:
    """A scene as every method takes it: in SI for the elements, scaled for the others."""

    name: str
    scene: Scene
    quick: bool = False

    @cached_property
    def units(self) -> StaticState:
        """The static state: scales of all quantities, and the dimensionless numbers."""
        return StaticState.of(self.scene)

    @cached_property
    def arms(self) -> list[tuple[float, float]]:
        """K_i/K and tau_i in the unit of time of a Prony series, or an empty list."""
        foundation = self.scene.foundation
        return [
            (arm.stiffness / foundation.stiffness, arm.relaxation_time / self.units.time)
            for arm in foundation.arms
        ]

    @cached_property
    def drive(self) -> BaseMotion:
        """lambda(s)."""
        return scaled_drive(self.scene, self.units)

    @cached_property
    def start(self) -> Beginning:
        """The scaled state just after s = 0."""
        return beginning(self.scene, self.units, self.drive)

    @property
    def two_states(self) -> bool:
        """Whether the indenter moves, on Kelvin-Voigt, from a contact; else they are none or too few."""
        return not self.scene.held and not self.arms and self.start.depth > 0.0

    @cached_property
    def times(self) -> Array:
        """Instants (s) at which errors are measured; where the drive jumps, just after the jump."""
        end, jumps = self.scene.run.duration, self._jumps
        soon = [t + x for t in jumps for x in AFTER_JUMP * end if t + x < end]
        evenly = np.linspace(0.0, end, UNIFORM_TIMES).tolist()
        least = LEAST_SPACING * end
        others = [t for t in (*evenly, *soon) if min(abs(t - x) for x in jumps) > least]
        found = np.array(sorted({*others, *jumps}))
        return found[np.diff(found, prepend=-1.0) > least]

    @cached_property
    def pieces(self) -> list[Piece]:
        """The drive between jumps, in units of tau."""
        ends, found = np.array([*self._jumps, self.scene.run.duration]) / self.units.time, []
        for a, b in pairwise(ends.tolist()):
            inside = [piece for piece in self.drive.pieces if piece[0] < b and piece[1] > a]
            powers = inside[0][3:]
            constant = len(inside) == 1 and not any(powers[1:])
            last = math.nextafter(b, a)  # just before a jump at b
            rate = partial(lambda last, s: self.drive.velocity(min(s, last)), last)
            found.append((a, b, powers[0] if constant else rate))
        return found

    @property
    def _jumps(self) -> list[float]:
        """Times (s) at which the drive may have a kink or jump, 0 first."""
        return [t for t in self.scene.changes if t < self.scene.run.duration]

    def reference(self) -> Reference:
        """Return the solution by the continuum at a tight tolerance, compared with an independent one."""
        first = by_continuum(self, REFERENCE_RTOL)[0]
        other, name = self._independent(first)
        return Reference(first, errors(other, first), ("continuum, rtol 1e-12", name))

    def _independent(self, first: Curves) -> tuple[Curves, str]:
        known = json.loads(files("kvtheory.charts").joinpath(TABLE).read_text()).get(self.name)
        if known and np.array_equal(known["times"], self.times):
            curves = Curves(np.array(known["depth"]), np.array(known["friction"]))
            return curves, "stored solution, see the tests"
        if self.two_states and not np.any(_flying(first)):  # they know nothing of a landing
            try:
                curves = by_two_states(self, REFERENCE_RTOL, method="LSODA")[0]
            except ArithmeticError:
                curves = Curves(np.full_like(first.depth, math.inf), first.friction)
            if errors(curves, first)["depth, maximum"] < NO_MEMORY:
                return curves, "two states by SciPy's LSODA, rtol 1e-12"
        fine = DENSITIES[self.quick]
        pair = (by_elements(self, n, scheme="edge-corrected") for n in (0.5 * fine, fine))
        (coarse, _), (better, _) = pair
        # Of second order: the error of the finer run is a third of the difference.
        curves = Curves(*(b + (b - a) / 3.0 for a, b in zip(coarse, better, strict=True)))
        return curves, f"elements, {0.5 * fine:g} and {fine:g} in a half length, extrapolated"

    def assess(
        self, found: Curves, right: Reference, tolerance: float | None
    ) -> tuple[dict[str, float], str]:
        """Return the errors, and why a run that reported success is wrong, or an empty text."""
        measured = errors(found, right.solution)
        worst = max(measured[name] for name in JUDGED)
        if tolerance is None or worst < max(LARGE_ERROR, FAR_BEYOND * tolerance):
            return measured, ""
        if not np.isfinite(worst):
            return measured, "not converged"
        flying = _flying(right.solution)
        return measured, MISSED if np.any(found.friction[flying] != 0.0) else WRONG


def _flying(curves: Curves) -> Any:
    return (curves.friction == 0.0) & (curves.depth != 1.0)


def standard_scene(name: str) -> Scene:
    """Return a standard scene, in which R = 1/2, K = tau = delta_0 = 1 and so a_0 = 1."""
    scene = scaled_scene(*STANDARD[name])
    return replace(scene, foundation=GeneralizedMaxwell(1.0, ARMS[name])) if name in ARMS else scene


def errors(found: Curves, right: Curves) -> dict[str, float]:
    """Return errors of depth and friction by name, relative to the static depth and the largest friction."""
    peaks = [float(np.abs(curves.friction).max()) for curves in (found, right)]
    largest = peaks[1] or 1.0
    result = {}
    for name, one, other, unit in zip(Curves._fields, found, right, (1.0, largest), strict=True):
        difference = np.abs(one - other) / unit
        result[f"{name}, final"] = float(difference[-1])
        result[f"{name}, maximum"] = float(difference.max())
        result[f"{name}, L2"] = float(np.sqrt(np.mean(difference**2)))
    return {**result, "peak friction": abs(peaks[0] - peaks[1]) / largest}


def by_continuum(
    problem: Problem, rtol: float, clock: Clock = NO_LIMIT, *, fast: bool | None = None
) -> tuple[Curves, int]:
    """Return the curves by the package's transient, and its evaluations of the equation of motion."""
    units, drive = problem.units, problem.drive
    numbers = units.inertia_number, units.support_number
    s = np.minimum(problem.times / units.time, drive.end)
    how: Any = {"fast": fast, "progress": clock.check, "start": problem.start}
    if problem.arms:
        foundation = problem.scene.foundation
        how["damper"] = foundation.damping / (foundation.stiffness * units.time)
        run: Any = trajectory.solve(drive, problem.arms, numbers, drive.end, rtol, **how)
        found = run.states(s, peaks=False)
        return Curves(found["depth"], found["friction_force"]), run.counts.evaluations
    motion = solver.solve(drive, *numbers, drive.end, rtol, **how)
    found = motion.states(s)
    return Curves(found["depth"], found["friction_force"]), motion.counts.evaluations


def by_two_states(
    problem: Problem, rtol: float, clock: Clock = NO_LIMIT, **how: Any
) -> tuple[Curves, int]:
    """Return the curves by the two states with closed-form edges, and the evaluations."""
    units = problem.units

    def law_of(number: Any) -> naive.Law:
        law = naive.two_states(number, units.inertia_number, units.support_number)

        def watched(s: float, y: Any) -> tuple[float, ...]:
            clock.check()
            return law(s, y)

        return watched

    s = problem.times / units.time
    how = {"start": problem.start[:2], **how}
    (d, _, f_x), count = naive.without_memory(problem.pieces, s, law_of, rtol=rtol, **how)
    return Curves(d, f_x), count


def by_elements(
    problem: Problem, per_half_length: float, clock: Clock = NO_LIMIT, *, scheme: str
) -> tuple[Curves, int]:
    """Return the curves by elements at this number per static half length, and the count of updates."""
    units, density = problem.units, per_half_length / problem.units.half_length
    how: Any = {"scheme": scheme, "at": problem.times, "progress": clock.check}
    run = elements(problem.scene, per_length=density, certify=False, **how)
    scaled = Curves(run.depth / units.depth, run.friction_force / units.friction_force)
    return scaled, run.element_updates
