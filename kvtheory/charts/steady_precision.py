"""The work-precision chart of steady sliding under a dead weight."""

import math
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal, localcontext
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

from kvtheory.api import elements, steady
from kvtheory.charts.methods import DENSITIES, Clock
from kvtheory.charts.work_precision import FULL, Chart, Effort, Point, Series, attempt, repeat
from kvtheory.models.elements.schemes import DEFAULT
from kvtheory.progress import Progress, silent
from kvtheory.scene.capabilities import lacks_paper_model
from kvtheory.scene.model import Run, Scene

DIGITS = 40
"""Correct digits of the reference solutions; they are computed with three times as many decimals."""
MANY = 10_000
"""Scenes solved at once, where a method takes arrays."""
TIME_CONSTANTS = 16.0
"""Time constants after which a transient counts as steady: e^-16 = 1e-7."""
TOLERANCES = tuple(10.0**-k for k in range(2, 14, 2))
LOOKS = 50
"""At the clock, during a transient."""
NAMES = "depth", "friction coefficient"
VELOCITIES = {"table-1": 0.1, "low-velocity": 1e-3, "high-velocity": 10.0}
"""Of the standard scenes, which are Table 1 but for the velocity (m/s)."""


Solve = Callable[[float, Clock], tuple[float, float, int]]
"""Gives depth, friction coefficient and evaluations."""


def suits(scene: Scene) -> bool:
    """Return whether a scene has this chart: a parabola, a dead weight, a constant velocity above 0."""
    return (
        not lacks_paper_model(scene)
        and scene.support.spring == 0.0
        and scene.drive.velocity is not None
        and scene.drive.velocity > 0.0
    )


class Numbers(NamedTuple):
    """R, K, l_r = V tau and W of a scene, in SI."""

    R: float
    K: float
    l_r: float
    W: float

    @classmethod
    def of(cls, scene: Scene) -> "Numbers":
        """Return the numbers of a suitable scene."""
        K, tau = scene.foundation.stiffness, scene.foundation.retardation_time
        return cls(scene.indenter.radius, K, scene.drive.final_velocity * tau, scene.support.weight)  # type: ignore[union-attr]


def by_simpson(numbers: Numbers) -> tuple[Decimal, Decimal]:
    """Return depth and friction coefficient with 40 digits, from the pressure itself.

    Its integrals are those of polynomials of degree two and three, for which Simpson's rule is exact.
    """
    R, K, l_r, W = map(Decimal, numbers)

    def forces(delta: Decimal) -> tuple[Decimal, Decimal]:
        a = (2 * R * delta).sqrt()
        end = (a * a + l_r * l_r).sqrt() - l_r
        points = -a, (end - a) / 2, end
        p = [K * (delta - x * x / (2 * R) - l_r * x / R) for x in points]
        both = (p, [-x / R * q for x, q in zip(points, p, strict=True)])
        found = [(end + a) / 6 * (v[0] + 4 * v[1] + v[2]) for v in both]
        return found[0], found[1]

    with localcontext() as context:
        context.prec = 3 * DIGITS
        high = Decimal(1)
        while forces(high)[0] < W:
            high *= 2
        depth = _by_halves(lambda delta: forces(delta)[0] < W, high)
        return depth, forces(depth)[1] / W


def by_ratio(numbers: Numbers) -> tuple[Decimal, Decimal]:
    """Return depth and friction coefficient with 40 digits, from the root q of theorem F2."""
    R, K, l_r, W = map(Decimal, numbers)
    with localcontext() as context:
        context.prec = 3 * DIGITS
        cube = l_r**3 * K / (R * W)
        q = _by_halves(  # the right-hand side of F2 falls from infinity to 0
            lambda q: 3 * (1 - q) ** 3 * (1 + q) > 2 * cube * q * q * (q * q - 2 * q + 3),
            Decimal(1),
        )
        a = 2 * q * l_r / (1 - q * q)
        m = (1 - q) * (q * q - q + 4) / (2 * (q * q - 2 * q + 3))
        return a * a / (2 * R), a / R * m


def _by_halves(below: Callable[[Decimal], bool], high: Decimal) -> Decimal:
    """Return the position between 0 and `high` where `below` ends."""
    low = Decimal(0)
    for _ in range(4 * DIGITS + 80):
        middle = (low + high) / 2
        low, high = (middle, high) if below(middle) else (low, middle)
    return low


def brentq_over_quad(numbers: Numbers, tolerance: float) -> tuple[float, float, int]:
    """Return depth and friction coefficient as a user would compute them, and the evaluations."""
    R, K, l_r, W = numbers
    count = 0

    def force(lever: Callable[[float], float], delta: float) -> float:
        nonlocal count
        a = math.sqrt(2 * R * delta)
        end = a * a / (math.sqrt(a * a + l_r * l_r) + l_r)

        def integrand(x: float) -> float:
            nonlocal count
            count += 1
            return lever(x) * K * (delta - x * x / (2 * R) - l_r * x / R)

        return float(quad(integrand, -a, end, epsabs=0, epsrel=tolerance)[0])

    highest = (1.5 * R * W / K) ** (2 / 3) / (2 * R)
    delta = brentq(
        lambda d: force(lambda _: 1.0, d) - W, 1e-9 * highest, 1.01 * highest,
        xtol=1e-300, rtol=max(tolerance, 1e-15),
    )  # fmt: skip
    return delta, force(lambda x: -x / R, delta) / W, count


def _state(state: Any, index: Any = ()) -> tuple[float, float, int]:
    depth, mu = (np.asarray(getattr(state, name)) for name in ("depth", "friction_coefficient"))
    return float(depth[index]), float(mu[index]), 0


def _by_elements(scene: Scene, density: float, clock: Clock) -> tuple[float, float, int]:
    """Run a transient until it is steady (F12), with so many elements in the static half length."""
    state = steady(scene)
    tau = scene.foundation.retardation_time
    A = math.hypot(state.half_length, state.retardation_length) + state.half_length
    slow = tau * (state.trailing_edge + state.half_length) / A
    fast = 2.0 * scene.support.mass / (scene.foundation.damping * 2.0 * state.half_length)
    run = replace(scene, run=Run(TIME_CONSTANTS * (slow + fast)))
    rest = steady(replace(scene, drive=replace(scene.drive, velocity=0.0)))
    found = elements(
        run, per_length=density / rest.half_length, certify=False,
        at=run.run.duration * np.arange(1, LOOKS + 1) / LOOKS,
        progress=clock.check,
    )  # fmt: skip
    if found.normal_force[-1] == 0.0:
        raise ArithmeticError("no element is in contact")
    return (
        float(found.depth[-1]),
        float(found.friction_force[-1] / found.normal_force[-1]),
        found.element_updates,
    )


def steady_chart(
    scene: Scene, name: str, *, effort: Effort = FULL,
    progress: Progress = silent,
) -> Chart:  # fmt: skip
    """Measure every method of steady sliding on a scene that `suits`.

    Examples
    --------
    >>> from kvtheory.charts.work_precision import QUICK
    >>> chart = steady_chart(Scene(), "table-1", effort=QUICK)
    >>> exact = next(series for series in chart.series if series.method == "exact")
    >>> exact.points[0].errors["depth"] < 1e-14
    True
    """
    numbers = Numbers.of(scene)
    right, other = by_simpson(numbers), by_ratio(numbers)
    floor = {key: float(abs(x - y) / x) for key, x, y in zip(NAMES, right, other, strict=True)}
    many = {"drive.velocity": np.full(MANY, scene.drive.final_velocity)}
    solvers: list[tuple[Series, Solve, float]] = [
        (_series("asymptote", "model"), lambda *_: _state(steady(scene, method="asymptote")), 1),
        (_series("exact"), lambda *_: _state(steady(scene)), 1),
        (_series("exact, 10 000 at once"), lambda *_: _state(steady(scene, over=many), 0), MANY),
        (_series("quadrature"), lambda *_: _state(steady(scene, method="quadrature")), 1),
        (_series("brentq over quad", knob="tolerance", values=TOLERANCES[:: effort.every]),
         lambda tolerance, _: brentq_over_quad(numbers, tolerance), 1),
        (_series(f"elements, {DEFAULT}", knob="elements per a_0", values=DENSITIES[:: effort.every]),
         partial(_by_elements, scene), 1),
    ]  # fmt: skip
    jobs: list[tuple[Point, Callable[[], Any]]] = []
    for done, (series, solve, _) in enumerate(solvers, 1):
        series.first = attempt(series.points, partial(_solve, solve, right), effort)
        good = [point for point in series.points if point.errors]
        jobs += [(point, partial(solve, point.knob, Clock())) for point in good]
        progress(done / (len(solvers) + 1), series.method)
    repeat(jobs, effort)
    for series, _, count in solvers:
        for point in series.points:
            point.times, point.first = [t / count for t in point.times], point.first / count
    return Chart(
        name, [s for s, _, _ in solvers], floor, ("Simpson's rule, 40 digits", "F2, 40 digits")
    )


def _solve(solve: Solve, right: tuple[Decimal, Decimal], point: Point, clock: Clock) -> None:
    """Solve with one setting, and compare."""
    depth, mu, point.work = solve(point.knob, clock)
    for key, value, truth in zip(NAMES, (depth, mu), right, strict=True):
        point.errors[key] = float(abs(Decimal(value) - truth) / truth)


def _series(
    name: str, kind: str = "numerical", knob: str = "-", values: tuple[float, ...] = (0.0,)
) -> Series:
    return Series(name, kind, knob, "evaluations", [Point(value) for value in values])
