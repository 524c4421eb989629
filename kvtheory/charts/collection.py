"""The work-precision chart of steady sliding under a dead weight, and the choice of the charts to make."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, localcontext
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from kvtheory.api import elements, steady
from kvtheory.charts.methods import DENSITIES, transient_methods
from kvtheory.charts.problems import STANDARD, Problem, standard_scene
from kvtheory.charts.work_precision import FULL, QUICK, Chart, Clock, Measurement, Method, Reference
from kvtheory.models.elements.schemes import DEFAULT
from kvtheory.progress import Progress, silent
from kvtheory.scene import Drive
from kvtheory.scene.capabilities import (
    lacks_one_scene,
    lacks_paper_model,
    lacks_rigid_continuum,
    require,
)
from kvtheory.scene.mistakes import nearest
from kvtheory.scene.model import Run, Scene
from kvtheory.scene.start import REST

DIGITS = 40
"""Correct digits of the reference solutions; they are computed with three times as many decimals."""
MANY = 10_000
"""Scenes solved at once, where a method takes arrays."""
TIME_CONSTANTS = 16.0
"""Time constants after which a transient counts as steady: e^-16 = 1e-7."""
TOLERANCES = tuple(10.0**-k for k in range(2, 14, 2))
CHECKS = 50
"""Instants of a transient at which the clock is read."""
NAMES = "depth", "friction coefficient"


def suits(scene: Scene) -> bool:
    """Return whether a scene suits this chart: a parabola, a dead weight, a constant velocity above 0."""
    forward = (scene.drive.velocity or 0.0) > 0.0
    return not lacks_paper_model(scene) and scene.support.spring == 0.0 and forward


@dataclass(frozen=True)
class SteadyProblem:
    """Steady sliding of a scene that `suits`; a solution is depth and friction coefficient."""

    name: str
    scene: Scene

    @property
    def numbers(self) -> tuple[float, float, float, float]:
        """R, K, l_r = V tau and W, in SI."""
        foundation, R = self.scene.foundation, self.scene.indenter.radius  # type: ignore[union-attr]
        l_r = self.scene.drive.final_velocity * foundation.retardation_time
        return R, foundation.stiffness, l_r, self.scene.support.weight

    def by_simpson(self) -> tuple[Decimal, Decimal]:
        """Return 40 digits of the solution, from the pressure: Simpson's rule is exact for its integrals."""
        R, K, l_r, W = map(Decimal, self.numbers)

        def forces(delta: Decimal) -> list[Decimal]:
            a = (2 * R * delta).sqrt()
            end = (a * a + l_r * l_r).sqrt() - l_r
            points = -a, (end - a) / 2, end
            p = [K * (delta - x * x / (2 * R) - l_r * x / R) for x in points]
            both = (p, [-x / R * q for x, q in zip(points, p, strict=True)])
            return [(end + a) / 6 * (v[0] + 4 * v[1] + v[2]) for v in both]

        with localcontext(prec=3 * DIGITS):
            high = Decimal(1)
            while forces(high)[0] < W:
                high *= 2
            depth = _bisect(lambda delta: forces(delta)[0] < W, high)
            return depth, forces(depth)[1] / W

    def by_ratio(self) -> tuple[Decimal, Decimal]:
        """Return the solution with 40 digits, from the root q of theorem F2."""
        R, K, l_r, W = map(Decimal, self.numbers)
        with localcontext(prec=3 * DIGITS):
            cube = l_r**3 * K / (R * W)
            q = _bisect(  # the right-hand side of F2 falls from infinity to 0
                lambda q: 3 * (1 - q) ** 3 * (1 + q) > 2 * cube * q * q * (q * q - 2 * q + 3),
                Decimal(1),
            )
            a = 2 * q * l_r / (1 - q * q)
            m = (1 - q) * (q * q - q + 4) / (2 * (q * q - 2 * q + 3))
            return a * a / (2 * R), a / R * m

    def reference(self) -> Reference:
        """Return the solution by Simpson's rule, compared with that from the ratio q."""
        right, other = self.by_simpson(), self.by_ratio()
        names = "Simpson's rule, 40 digits", "F2, 40 digits"
        return Reference(right, _errors(other, right), names)

    def assess(self, found: Any, right: Reference, _: float | None) -> tuple[dict[str, float], str]:
        """Return the errors, without a verdict: the allowed error of a method is not known."""
        return _errors([Decimal(value) for value in found], right.solution), ""


def _errors(found: Any, right: Any) -> dict[str, float]:
    pairs = zip(NAMES, found, right, strict=True)
    return {name: float(abs(value - truth) / truth) for name, value, truth in pairs}


def _bisect(below: Callable[[Decimal], bool], high: Decimal) -> Decimal:
    """Return the position between 0 and `high` at which `below` becomes false."""
    low = Decimal(0)
    for _ in range(4 * DIGITS + 80):
        middle = (low + high) / 2
        low, high = (middle, high) if below(middle) else (low, middle)
    return low


def steady_methods() -> list[Method]:
    """Return the methods of steady sliding."""
    return [
        _package("asymptote", "asymptote", kind="model"),
        _package("exact", None),
        _package("exact, 10 000 at once", None, scenes=MANY),
        _package("quadrature", "quadrature"),
        Method("brentq over quad", "tolerance", TOLERANCES, "evaluations", brentq_over_quad),
        Method(
            f"elements, {DEFAULT}",
            "elements per a_0",
            DENSITIES,
            "element updates",
            _elements,
            growth=0.5,
        ),
    ]


def _package(name: str, method: str | None, scenes: int = 1, **kind: Any) -> Method:
    def solve(problem: SteadyProblem, _: float, __: Clock) -> tuple[list[float], int]:
        many = {"drive.velocity": np.full(scenes, problem.scene.drive.final_velocity)}
        state: Any = steady(problem.scene, method=method, over=many if scenes > 1 else None)
        return [float(np.ravel(x)[0]) for x in (state.depth, state.friction_coefficient)], 0

    return Method(name, "-", (0.0,), "evaluations", solve, scenes=scenes, **kind)


def brentq_over_quad(
    problem: SteadyProblem, tolerance: float, clock: Clock
) -> tuple[tuple[float, float], int]:
    """Return depth and friction coefficient as a user would compute them, and the evaluations."""
    R, K, l_r, W = problem.numbers
    count = 0

    def force(lever: Callable[[float], float], delta: float) -> float:
        a = math.sqrt(2 * R * delta)
        end = a * a / (math.sqrt(a * a + l_r * l_r) + l_r)

        def integrand(x: float) -> float:
            nonlocal count
            count += 1
            return lever(x) * K * (delta - x * x / (2 * R) - l_r * x / R)

        return float(quad(integrand, -a, end, epsabs=0, epsrel=tolerance)[0])

    clock.check()
    highest = (1.5 * R * W / K) ** (2 / 3) / (2 * R)
    delta = brentq(
        lambda d: force(lambda _: 1.0, d) - W, 1e-9 * highest, 1.01 * highest,
        xtol=1e-300, rtol=max(tolerance, 1e-15),
    )  # fmt: skip
    return (delta, force(lambda x: -x / R, delta) / W), count


def _elements(problem: SteadyProblem, density: float, clock: Clock) -> tuple[Any, int]:
    """Run a transient until it is steady (F12), with this number of elements per static half length."""
    scene = problem.scene
    state = steady(scene)
    A = math.hypot(state.half_length, state.retardation_length) + state.half_length
    slow = scene.foundation.retardation_time * (state.trailing_edge + state.half_length) / A
    fast = scene.support.mass / (scene.foundation.damping * state.half_length)
    end = TIME_CONSTANTS * (slow + fast)
    rest = steady(replace(scene, drive=replace(scene.drive, velocity=0.0)))
    found = elements(
        replace(scene, run=Run(end), start=REST), per_length=density / rest.half_length, certify=False,
        at=end * np.arange(1, CHECKS + 1) / CHECKS, progress=clock.check,
    )  # fmt: skip
    if found.normal_force[-1] == 0.0:
        raise ArithmeticError("no element is in contact")
    mu = found.friction_force[-1] / found.normal_force[-1]
    return (found.depth[-1], mu), found.element_updates


Job = tuple[Any, Iterable[Method]]
"""A problem, and the methods of its chart."""
ALL = "all"
VELOCITIES = {"table-1": 0.1, "low-velocity": 1e-3, "high-velocity": 10.0}
"""Velocity (m/s) in steady sliding of the standard scenes that otherwise equal Table 1."""


def chosen(scene: Scene, standard: Sequence[str], *, quick: bool) -> list[Job]:
    """Return a job for each chart, steady sliding first: for standard scenes, or for the scene."""
    for name in standard:
        if name not in (*STANDARD, ALL):
            raise ValueError(f'`standard` "{name}": {nearest(name, (*STANDARD, ALL))}')
    require(lacks_one_scene, scene, "the chart")
    require(lacks_rigid_continuum, scene, "the chart of transients")
    jobs: list[Job] = []
    for name in STANDARD if ALL in standard else standard or ("this scene",):
        sliding = scene if suits(scene) and not standard else None
        if name in VELOCITIES:
            sliding = Scene(drive=Drive(velocity=VELOCITIES[name]))
        if sliding:
            steady = SteadyProblem(f"{name}, steady", sliding)
            jobs.append((steady, steady_methods()))
        transient = Problem(name, standard_scene(name) if standard else scene, quick)
        jobs.append((transient, transient_methods().values()))
    return jobs


def measure(
    jobs: Sequence[Job], *, quick: bool, progress: Progress = silent,
    announce: Callable[[str, float], object] = lambda words, seconds: None,
) -> list[Chart]:  # fmt: skip
    """Make the charts one after the other, so that nothing disturbs the timings.

    `announce` is given words and the time (s) of all, and of what is left after the cheapest settings.
    """
    effort = QUICK if quick else FULL
    measured = [Measurement(problem, methods, effort) for problem, methods in jobs]
    announce("measuring takes about", sum(each.first_forecast() for each in measured))
    for done, each in enumerate(measured):
        each.begin(_part(progress, 0.3 * done / len(jobs), 0.3 / len(jobs)))
    times = [each.forecast() for each in measured]
    announce("the cheapest settings are done; the others take about", sum(times))
    charts, before, whole = [], 0.3, sum(times) or 1.0  # nothing is left where all timed out
    for each, seconds in zip(measured, times, strict=True):
        share = 0.7 * seconds / whole
        charts.append(each.finish(_part(progress, before, share)))
        before += share
    return charts


def _part(progress: Progress, start: float, whole: float) -> Progress:
    """Return the progress function of a part of the work."""
    return lambda share, words: progress(start + whole * share, words)
