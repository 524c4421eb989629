"""Scenes of reference transients, and their solution with the contact found from the whole past.

The scaled form is explained in `tests.transient_reference`.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853
from scipy.optimize import minimize_scalar

Array = NDArray[np.float64]
Rate = Callable[[float], float]
Solution = dict[str, Array]

QUANTITIES = ("d", "v", "f_z", "f_x", "left", "right")


def _line(a: float, y: float, b: float, z: float) -> Rate:
    """Return the line from (a, y) to (b, z)."""
    slope = (z - y) / (b - a)
    return lambda s: y + slope * (s - a)


@dataclass(frozen=True)
class Scene:
    """A drive, the inertia number (None: fixed), the support number, and the times of interest.

    With an inertia along x the drive has a spring: x' = w, inertia w' = f_x - damping w - stiffness x, so
    that the base slides at lambda - w below the indenter; x = w = 0 at s = 0.

    `drive` is a list of points (s, lambda), linear between them, with a jump where a time is
    repeated, and constant after the last; or {"mean", "amplitude", "frequency"}, which stands for
    lambda = mean + amplitude cos(frequency s).
    """

    drive: Any
    epsilon: float | None
    times: Sequence[float]
    kappa: float = 0.0
    inertia: float | None = None
    damping: float = 0.0
    stiffness: float = 0.0

    def pieces(self) -> list[tuple[float, float, Rate]]:
        """Return the intervals between jumps, times of interest and the end, with lambda(s)."""
        if isinstance(self.drive, dict):
            mean, amplitude, frequency = self.drive.values()
            rates = [(0.0, lambda s: mean + amplitude * math.cos(frequency * s))]
        else:
            points = [*self.drive, (math.inf, self.drive[-1][1])]
            rates = [(a, _line(a, y, b, z)) for (a, y), (b, z) in pairwise(points) if b > a]
        end = self.times[-1]
        stops = sorted({0.0, end, *self.times, *(a for a, _ in rates if a < end)})
        return [
            (start, stop, next(rate for a, rate in reversed(rates) if a <= start))
            for start, stop in zip(stops, [*stops[1:], end], strict=True)
        ]


def at_times(scene: Scene, rows: Iterable[Any], names: Sequence[str]) -> Solution:
    """Pick the rows at the times of the scene; their first entry is the instant."""
    found = {row[0]: row[1:] for row in rows}
    return dict(zip(names, np.array([found[s] for s in scene.times]).T, strict=True))


def jump(time: float, first: float, second: float) -> list[tuple[float, float]]:
    return [(0.0, first), (time, first), (time, second)]


LAMBDA, EPSILON = 4.0812765306, 0.00306095740
"""Of Table 1."""
EARLY = (0.0, 1e-3, 1e-2, 0.1, 0.5, 1.0, 2.0)
LATER = (0.1, 0.5, 0.501, 0.51, 0.6, 0.8, 1.0, 1.5)
LONG = (0.0, 0.1, 1.0, 2.0, 5.0, 10.0, 20.0)
SHORT = (0.0, 1e-3, 1e-2, 0.05, 0.1, 0.2)

TAYLOR = {
    "start": Scene([(0.0, LAMBDA)], EPSILON, EARLY),
    "start-heavy": Scene([(0.0, 1.0)], 1.0, EARLY),
    "start-heavier": Scene([(0.0, 0.1)], 100.0, LONG),
}
TWO_STATES = {
    f"start-epsilon-{epsilon:g}-lambda-{rate:g}": Scene(
        [(0.0, rate)], epsilon, LONG if epsilon > 0.5 else EARLY
    )
    for epsilon in (1e-6, 1e-4, 1e-3, 1e-2, 1.0, 100.0)
    for rate in (1e-2, 1.0)
} | {"start-suspended": Scene([(0.0, LAMBDA)], EPSILON, EARLY, 1.0)}
HISTORY = {
    "stop": Scene(jump(0.5, LAMBDA, 0.0), EPSILON, LATER),
    "slow-down": Scene(jump(0.5, LAMBDA, 0.2 * LAMBDA), EPSILON, LATER),
    "stop-and-go": Scene(
        [*jump(0.5, LAMBDA, 0.0), (0.7, 0.0), (0.7, LAMBDA)],
        EPSILON,
        (0.5, 0.6, 0.7, 0.701, 0.71, 0.8, 1.0, 1.5),
    ),
    "reversal": Scene(jump(0.5, LAMBDA, -LAMBDA), EPSILON, LATER),
    "ramp": Scene(
        [(0.0, 0.0), (0.2, LAMBDA), (0.5, 1.0), (0.7, 1.0), (1.0, 0.0)],
        EPSILON,
        (0.0, 0.1, 0.2, 0.5, 0.7, 1.0, 1.5),
    ),
    "oscillation-slow": Scene(
        {"mean": 0.0, "amplitude": 2.0, "frequency": 6.0}, EPSILON, (0.0, 0.1, 0.5, 0.8, 1.0, 1.5)
    ),
    "oscillation-fast": Scene(
        {"mean": 2.0, "amplitude": 4.0, "frequency": 20.0}, EPSILON, (0.0, 0.1, 0.3, 0.5, 1.0)
    ),
    "suspended-stop": Scene(jump(0.5, LAMBDA, 0.0), EPSILON, LATER, 1.0),
    "suspended-reversal": Scene(jump(0.5, LAMBDA, -LAMBDA), EPSILON, LATER, 1.0),
    "fixed-stop": Scene(jump(0.5, LAMBDA, 0.0), None, LATER),
    "fixed-reversal": Scene(jump(0.5, LAMBDA, -LAMBDA), None, LATER),
    "hop": Scene([(0.0, 4.0)], 0.3, (0.0, 0.1, 0.5, 1.0, 1.4, 2.0, 3.0, 4.0)),
    "hops": Scene([(0.0, 10.0)], 0.3, (0.0, 0.1, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0)),
    "drop": Scene(jump(0.5, 30.0, 0.0), 0.01, (0.0, 0.01, 0.1, 0.5, 0.6, 0.8, 1.0, 2.0)),
    "bounce": Scene(jump(1.0, 2.0, 0.05), 100.0, (0.5, 1.0, 1.01, 2.0, 5.0, 10.0, 15.0, 20.0)),
    "start-lambda-100": Scene([(0.0, 100.0)], 0.01, SHORT),
    "start-lambda-100-heavy": Scene([(0.0, 100.0)], 1.0, SHORT),
}


PER_STEP = 4
"""Past instants kept for each step; the most forbidding one between them is found by a search."""
RECENT = 1e-9
"""Instants closer than this are left to the limit s' -> s: their differences would be rounding."""
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(3)


@dataclass
class Past:
    """The motion so far: sampled instants, and the steps that interpolate between them."""

    s: Array = field(default_factory=lambda: np.zeros(1))
    d: Array = field(default_factory=lambda: np.ones(1))
    Y: Array = field(default_factory=lambda: np.zeros(1))
    steps: list[Any] = field(default_factory=list)

    def add(self, step: Any) -> None:
        s = np.linspace(step.t_old, step.t, PER_STEP + 1)[1:]
        d, _, Y = step(s)[:3]
        self.s, self.d, self.Y = (
            np.append(old, new) for old, new in ((self.s, s), (self.d, d), (self.Y, Y))
        )
        self.steps.append(step)

    def at(self, s: float) -> tuple[float, float]:
        """Return d and Y at a past instant."""
        if s <= 0.0:
            return 1.0, 0.0
        d, _, Y = self.steps[(int(np.searchsorted(self.s, s)) - 1) // PER_STEP](s)[:3]
        return d, Y


def ends(b: Any, c: Any) -> Array:
    """Return both roots of xi^2 + 2 b xi - c without cancellation; NaN if there are none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        far = -b - np.copysign(np.sqrt(b * b + c), b)
        return np.sort([far, -c / far], axis=0)


def allowed(delay: Any, d: float, m: Any, d_past: Any) -> Array:
    """Return where g(xi, s) >= e^-delay g(xi - m, s - delay): an interval, or NaN."""
    decay, lost = np.exp(-delay), -np.expm1(-delay)
    return ends(decay * m / lost, d + decay * (d - d_past + m * m) / lost)


def contact(s: float, y: Array, rates: Sequence[float], past: Past) -> Array:
    """Return the ends of the contact: what no past instant forbids; NaN in flight.

    The instant s' forbids every xi where e^s' g was above e^s g; their difference is concave in
    xi, so that each leaves an interval. Two limits belong to the past: s' -> -oo, undisturbed
    ground, where g >= 0, and s' -> s, where p >= 0. `rates` holds lambda, and at a jump also the
    lambda before it. No xi is in contact if one interval is empty or they do not overlap.
    """
    d, v, Y = y
    n = int(np.searchsorted(past.s, s - RECENT))
    samples = allowed(s - past.s[:n], d, Y - past.Y[:n], past.d[:n])
    limits = ends(np.array([0.0, *rates]), np.array([d, *(d + v for _ in rates)]))

    def interval(instant: float) -> Array:
        d_past, Y_past = past.at(instant)
        return allowed(s - instant, d, Y - Y_past, d_past)

    left = -_least(-limits[0], -samples[0], past.s[:n], lambda t: -interval(t)[0])
    right = _least(limits[1], samples[1], past.s[:n], lambda t: interval(t)[1])
    return np.array([left, right] if left < right else [math.nan, math.nan])


def _least(limits: Array, samples: Array, instants: Array, end: Rate) -> float:
    """Return the least of the limits, and of `end` over all instants; NaN if one is NaN."""
    bound = float(np.min(limits))
    if samples.size == 0:
        return bound
    k = int(np.argmin(samples))
    near = slice(max(k - 1, 0), k + 2)
    # A smooth curve dips between its samples by less than it changes from one to the next.
    if 2.0 * samples[k] - samples[near].max() > bound:
        return bound
    bracket = instants[near][[0, -1]]
    found = minimize_scalar(end, bounds=bracket, method="bounded", options={"xatol": 1e-9})
    return float(np.min([bound, samples[k], found.fun]))


def forces(d: float, v: float, rate: float, edges: Array) -> tuple[float, float]:
    """Return (3/4) int p dxi and -(3/2) int xi p dxi over the contact; nothing in flight."""
    if np.isnan(edges).any():
        return 0.0, 0.0
    half = 0.5 * (edges[1] - edges[0])
    xi = edges.mean() + half * POINTS
    p = half * WEIGHTS * (d + v - xi * (xi + 2.0 * rate))
    return 0.75 * float(p.sum()), -1.5 * float(xi @ p)


def history(scene: Any, tolerance: float, longest_step: float) -> Solution:
    """Return the quantities at the times of the scene, just after a jump; on a spring x and w, too."""
    sprung, moves = scene.inertia is not None, scene.epsilon is not None
    past, y, before = Past(), np.array([1.0, 0.0, 0.0, *((0.0, 0.0) if sprung else ())]), 0.0
    rows = []

    def law(s: float, y: Array, start: float, rate: Rate) -> list[float]:
        d, v, _, *along = y
        x, w = along or (0.0, 0.0)
        now = rate(s) - w
        if not (moves or sprung):
            return [0.0, 0.0, now]
        rates = (now, before) if s == start else (now,)
        f_z, f_x = forces(d, v, now, contact(s, y[:3], rates, past))
        dv = (1.0 - f_z - scene.kappa * (d - 1.0)) / scene.epsilon if moves else 0.0
        found = [v if moves else 0.0, dv, now]
        if sprung:
            found += [w, (f_x - scene.damping * w - scene.stiffness * x) / scene.inertia]
        return found

    for start, stop, rate in scene.pieces():
        now = rate(start) - (y[4] if sprung else 0.0)
        edges = contact(start, y[:3], (now, before), past)
        rows.append((start, *y[:2], *y[3:], *forces(y[0], y[1], now, edges), *edges))
        if stop == start:
            break
        solver = DOP853(
            lambda s, y, start=start, rate=rate: law(s, y, start, rate),
            start, y, stop, longest_step, tolerance, 0.01 * tolerance,
        )  # fmt: skip
        while solver.status == "running":
            message = solver.step()
            if solver.status == "failed":
                raise ArithmeticError(f"the integration failed at s = {solver.t}: {message}")
            past.add(solver.dense_output())
        y = solver.y
        before = rate(stop) - (y[4] if sprung else 0.0)
    names = (*QUANTITIES[:2], *(("x", "w") if sprung else ()), *QUANTITIES[2:])
    return at_times(scene, rows, names)
