"""Scenes of the table of reference transients, in scaled form: drives, numbers and times."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
