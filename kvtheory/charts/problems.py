"""The scenes of the work-precision charts, and their reference solutions by two independent methods.

Scenes for testing other simulations are in `kvtheory.reference_problems`.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from kvtheory.api import elements
from kvtheory.charts.naive import Law, closed_forms, two_states
from kvtheory.models.continuum import evaluation, solver
from kvtheory.models.continuum.solved_scene import scaled_drive
from kvtheory.scene.base_motion import BaseMotion, evaluate
from kvtheory.scene.drives import Drive
from kvtheory.scene.indenters import Parabola
from kvtheory.scene.model import DeadWeight, Foundation, Run, Scene
from kvtheory.scene.static_state import StaticState

Array = NDArray[np.float64]

EVENLY, AFTER_JUMP = 41, 9
"""Instants at which errors are measured: this many over the run, and this many soon after each jump."""
SOON = np.geomspace(1e-4, 5e-2, AFTER_JUMP)
"""Shares of the run after a jump."""
APART = 1e-6
"""Smallest distance of instants, as a share of the run."""
REFERENCE_RTOL, INDEPENDENT_RTOL = 1e-12, 1e-10
NO_MEMORY = 1e-7
"""If Radau on the two states agrees this well with the continuum, no memory was needed."""
DENSITIES = {False: 160.0, True: 60.0}
"""Elements per half length at rest of the finer reference by elements; for the quick form, fewer."""
TABLE = "work_precision_reference.json"
"""Independent solutions of the standard scenes; its generator is among the tests."""

LAMBDA, EPSILON = 4.0812765306, 0.0030609574
"""Of Table 1."""
STANDARD: dict[str, tuple[list[tuple[float, float]], float, float]] = {
    "table-1": ([(0.0, LAMBDA)], EPSILON, 2.0),
    "low-velocity": ([(0.0, 0.04)], EPSILON, 2.0),
    "high-velocity": ([(0.0, 40.0)], EPSILON, 0.25),
    "small-inertia": ([(0.0, LAMBDA)], 1e-5, 2.0),
    "stop-and-go": (
        [(0.0, LAMBDA), (0.5, LAMBDA), (0.5, 0.0), (0.7, 0.0), (0.7, LAMBDA)], EPSILON, 1.5,
    ),
    "reversal": ([(0.0, LAMBDA), (0.5, LAMBDA), (0.5, -LAMBDA)], EPSILON, 1.5),
    "hop": ([(0.0, 4.0)], 0.3, 4.0),
}  # fmt: skip
"""Drive points (s, lambda), inertia number and end of the standard scenes."""


class Curves(NamedTuple):
    """Depth and friction force in scaled form at the instants of a problem."""

    depth: Array
    friction: Array


@dataclass(frozen=True)
class Reference:
    """The reference solution; the difference of two independent methods in each error; and their names."""

    curves: Curves
    agreement: dict[str, float]
    methods: tuple[str, str]


@dataclass(frozen=True)
class Problem:
    """A scene as every method takes it: in SI for the elements, scaled for the others."""

    name: str
    scene: Scene
    quick: bool = False

    @cached_property
    def units(self) -> StaticState:
        """The scene at rest, the scale of all quantities."""
        return StaticState.of(self.scene)

    @cached_property
    def drive(self) -> BaseMotion:
        """lambda(s)."""
        return scaled_drive(self.scene, self.units)

    @cached_property
    def epsilon(self) -> float:
        """Inertia number."""
        return self.units.inertia_number

    @cached_property
    def kappa(self) -> float:
        """Support number."""
        return self.units.support_number

    @cached_property
    def jumps(self) -> list[float]:
        """Times (s) at which the drive may have a kink or jump, 0 first."""
        return [t for t in self.scene.drive.changes if t < self.scene.run.duration]

    @cached_property
    def times(self) -> Array:
        """Instants (s) at which errors are measured; where the drive jumps, just after the jump."""
        end = self.scene.run.duration
        soon = [t + x for t in self.jumps for x in SOON * end if t + x < end]
        evenly = np.linspace(0.0, end, EVENLY).tolist()
        apart = [t for t in (*evenly, *soon) if min(abs(t - x) for x in self.jumps) > APART * end]
        found = np.array(sorted({*apart, *self.jumps}))
        return found[np.diff(found, prepend=-1.0) > APART * end]

    @cached_property
    def pieces(self) -> list[tuple[float, float, Any]]:
        """Start and end in units of tau between jumps, and lambda there: a number, or a function of s."""
        ends = [*self.jumps, self.scene.run.duration]
        tau, found = self.units.time, []
        for a, b in pairwise(ends):
            inside = [p for p in self.drive.pieces if p[0] < b / tau and p[1] > a / tau]
            powers = inside[0][3:]
            constant = len(inside) == 1 and not any(powers[1:])
            found.append((a / tau, b / tau, powers[0] if constant else _rate(inside)))
        return found


def _rate(pieces: list[tuple[float, ...]]) -> Any:
    starts = [piece[0] for piece in pieces]

    def number(s: float) -> float:
        k = max(int(np.searchsorted(starts, s, "right")) - 1, 0)
        return evaluate(pieces[k], s)[1]

    return number


def standard_scene(name: str) -> Scene:
    """Return a standard scene, in which R = 1/2, K = tau = delta_0 = 1 and so a_0 = 1.

    Examples
    --------
    >>> Problem("hop", standard_scene("hop")).epsilon
    0.3
    """
    points, epsilon, end = STANDARD[name]
    support = DeadWeight(4.0 / 3.0 * epsilon, 1.0 / epsilon)
    return Scene(Parabola(0.5), Foundation(1.0, 1.0), support, Drive(history=points), Run(end))


def errors(found: Curves, right: Curves) -> dict[str, float]:
    """Return the errors of depth, friction force and its largest value, by their names.

    Depths are relative to the static depth, forces to the largest friction force of the run; L2 is the
    root of the mean square over the instants.

    Examples
    --------
    >>> right = Curves(np.array([1.0, 0.5]), np.array([2.0, 1.0]))
    >>> errors(Curves(np.array([1.0, 0.4]), np.array([2.2, 1.0])), right)["peak friction"].__round__(6)
    0.1
    """
    peaks = [float(np.abs(curves.friction).max()) for curves in (found, right)]
    largest = peaks[1] or 1.0
    result = {}
    for name, one, other, unit in zip(Curves._fields, found, right, (1.0, largest), strict=True):
        difference = np.abs(one - other) / unit
        result[f"{name}, final"] = float(difference[-1])
        result[f"{name}, maximum"] = float(difference.max())
        result[f"{name}, L2"] = float(np.sqrt(np.mean(difference**2)))
    return {**result, "peak friction": abs(peaks[0] - peaks[1]) / largest}


def by_continuum(problem: Problem, rtol: float, **options: Any) -> tuple[Curves, int]:
    """Return the curves by the package's transient, and its evaluations of the equation of motion."""
    motion = solver.solve(
        problem.drive, problem.epsilon, problem.kappa, problem.drive.end, rtol, **options
    )
    s = np.minimum(problem.times / problem.units.time, motion.end)
    found = motion.states(s).T
    return Curves(
        found[evaluation.DEPTH], found[evaluation.FRICTION_FORCE]
    ), motion.counts.evaluations


def piece_by_scipy(
    law: Law, ends: tuple[float, float], y: Array, s: Array, method: str, rtol: float
) -> tuple[Array, int]:
    """Return the two states at the instants and at the end of a piece by `solve_ivp`, and its evaluations.

    Raises
    ------
    ArithmeticError
        If it does not succeed.
    """
    tolerances = {"rtol": max(rtol, 3e-14), "atol": 0.01 * rtol}
    with np.errstate(all="ignore"):
        try:
            run = solve_ivp(law, ends, y, method, dense_output=True, **tolerances)
        except (ValueError, OverflowError) as error:  # of numbers that are not finite
            raise ArithmeticError(str(error)) from None
    if not run.success:
        raise ArithmeticError(run.message)
    return np.column_stack([run.sol(s), run.y[:, -1]]), run.nfev


def by_two_states(
    problem: Problem, method: str, rtol: float, law_of: Callable[..., Law] = two_states,
    piece: Callable[..., tuple[Array, int]] = piece_by_scipy,
) -> tuple[Curves, int]:  # fmt: skip
    """Return the curves by the two states, restarted at each jump, and the evaluations."""
    times, y, rows, count = problem.times / problem.units.time, np.array([1.0, 0.0]), [], 0
    for a, b, number in problem.pieces:
        law, s = law_of(number, problem.epsilon, problem.kappa), times[(times >= a) & (times < b)]
        values, more = piece(law, (a, b), y, s, method, rtol)
        y, count = values[:, -1], count + more
        if b == problem.pieces[-1][1]:
            s = times[times >= a]
        for x, d, v in zip(s, *values[:, : s.size], strict=True):
            rate = number(float(x)) if callable(number) else number
            rows.append((d, closed_forms(float(d), float(v), rate)[1]))
    return Curves(*np.array(rows).T), count


def by_elements(
    problem: Problem, per_half_length: float, scheme: str, **options: Any
) -> tuple[Curves, int]:
    """Return the curves by elements, so many in a static half length, and how often they were updated."""
    units = problem.units
    run = elements(
        problem.scene, per_length=per_half_length / units.half_length, scheme=scheme,
        at=problem.times, certify=False, **options,
    )  # fmt: skip
    scaled = Curves(run.depth / units.depth, run.friction_force / units.friction_force)
    return scaled, run.element_updates


def reference(problem: Problem) -> Reference:
    """Return the solution by the continuum at a tight tolerance, compared with an independent one."""
    first = by_continuum(problem, REFERENCE_RTOL)[0]
    other, name = _independent(problem, first)
    return Reference(first, errors(other, first), ("continuum, rtol 1e-12", name))


def _independent(problem: Problem, first: Curves) -> tuple[Curves, str]:
    stored = json.loads(files("kvtheory.charts").joinpath(TABLE).read_text())
    if problem.name in stored:
        known = stored[problem.name]
        if np.array_equal(known["times"], problem.times):
            curves = Curves(np.array(known["depth"]), np.array(known["friction"]))
            return curves, "stored solution, see the tests"
    if not problem.scene.held:  # else there is no equation of motion
        try:
            curves = by_two_states(problem, "Radau", INDEPENDENT_RTOL)[0]
        except ArithmeticError:
            curves = Curves(np.full_like(first.depth, math.inf), first.friction)
        if errors(curves, first)["depth, maximum"] < NO_MEMORY:
            return curves, "two states by SciPy's Radau, rtol 1e-10"
    fine = DENSITIES[problem.quick]
    coarse, better = (by_elements(problem, n, "edge-corrected")[0] for n in (0.5 * fine, fine))
    # Of second order: the error of the finer run is a third of the difference.
    curves = Curves(*(b + (b - a) / 3.0 for a, b in zip(coarse, better, strict=True)))
    return curves, f"elements, {0.5 * fine:g} and {fine:g} in a half length, extrapolated"
