"""How far the base has moved: V(t) in cubic pieces, and its integral Y(t)."""

import math
from bisect import bisect_right
from itertools import pairwise

import numpy as np

from kvtheory.scene.drives import Drive

ROUNDING = 4.0
"""Times that differ by so many units in the last place are one time: a jump."""
FIRST_KNOTS, MOST_KNOTS = 64, 65536
"""Knots between two breaks of a drive that is a function; doubled until the spline fits."""
SPLINE_TOLERANCE = 1e-9
"""Of that spline, relative to the largest velocity: less than what the elements ever resolve."""

Piece = tuple[float, float, tuple[float, ...]]
"""Start, Y there, and the coefficients of V in the time since, constant first."""


class Path:
    """The velocity V(t) of a drive in m/s and the displacement Y(t) of its base in m, to time `end`.

    >>> path = Path(Drive(history=[(0.0, 0.0), (1.0, 2.0), (1.0, -1.0)]), 3.0)
    >>> path.velocity(1.0), path.velocity(1.0, before=True), path.displacement(3.0)
    (-1.0, 2.0, -1.0)
    >>> path.extremes(0.0, 3.0)
    (-1.0, 1.0)

    Raises
    ------
    ValueError
        If the drive is a function that is not smooth between its breaks.
    """

    def __init__(self, drive: Drive, end: float) -> None:
        self.end = end
        found = _of_function(drive, end) if drive.function else _of_points(drive)
        self.breaks = sorted({0.0, *(drive.breaks if drive.function else (a for a, _ in found))})
        self._pieces: list[Piece] = []
        Y = 0.0
        for k, (a, c) in enumerate(found):
            self._pieces.append((a, Y, c))
            if k + 1 < len(found):
                Y += _integral(c, found[k + 1][0] - a)
        self._starts = [a for a, _, _ in self._pieces]
        turns = [a - c[0] / c[1] for a, _, c in self._pieces if c[1]]
        # The zero of another piece's line is no turning point, but as a sample it is harmless.
        self._samples = np.array(sorted({t for t in (*self._starts, *turns) if 0.0 <= t <= end}))
        self._places = np.array([self.displacement(float(t)) for t in self._samples])
        before = [self.velocity(b, before=True) for b in self._starts[1:]]
        self.velocities = sorted({*before, *(c[0] for _, _, c in self._pieces)})
        self.fastest = max(abs(V) for V in self.velocities)

    def velocity(self, t: float, *, before: bool = False) -> float:
        """Return V; at a jump just after it, or just before it."""
        a, _, c = self._piece(t - ROUNDING * math.ulp(t) if before else t)
        return _value(c, t - a)

    def displacement(self, t: float) -> float:
        """Return Y."""
        a, Y, c = self._piece(t)
        return Y + _integral(c, t - a)

    def extremes(self, start: float, end: float) -> tuple[float, float]:
        """Return the smallest and the largest Y between two times."""
        first, last = np.searchsorted(self._samples, [start, end])
        places = [self.displacement(start), self.displacement(end), *self._places[first:last]]
        return float(min(places)), float(max(places))

    def forward(self, t: float) -> bool:
        """Whether the base moves, or moved last, with V >= 0."""
        last = bisect_right(self._starts, t)
        for a, _, c in reversed(self._pieces[:last]):
            V = _value(c, t - a) or c[0]
            if V:
                return V > 0.0
            t = a
        return True

    def _piece(self, t: float) -> Piece:
        return self._pieces[max(bisect_right(self._starts, t) - 1, 0)]


def _value(c: tuple[float, ...], t: float) -> float:
    return c[0] + t * (c[1] + t * (c[2] + t * c[3]))


def _integral(c: tuple[float, ...], t: float) -> float:
    return t * (c[0] + t * (c[1] / 2.0 + t * (c[2] / 3.0 + t * c[3] / 4.0)))


def _of_points(drive: Drive) -> list[tuple[float, tuple[float, ...]]]:
    """Return the pieces of a drive that is linear between its points."""
    found = [
        (a, (left, (right - left) / (b - a), 0.0, 0.0))
        for (a, left), (b, right) in pairwise(drive.points)
        if b - a > ROUNDING * math.ulp(b)
    ]
    time, velocity = drive.points[-1]
    return [*found, (time, (velocity, 0.0, 0.0, 0.0))]


def _of_function(drive: Drive, end: float) -> list[tuple[float, tuple[float, ...]]]:
    """Return the pieces of a drive that is a function: splines between its breaks."""
    from scipy.interpolate import CubicSpline

    found: list[tuple[float, tuple[float, ...]]] = []
    for a, b in pairwise(sorted({0.0, end, *(t for t in drive.breaks if t < end)})):
        inside = ROUNDING * math.ulp(b)
        knots = FIRST_KNOTS
        while True:
            t = np.linspace(a, b, 2 * knots + 1)
            V = np.array([drive.called(float(min(max(x, a + inside), b - inside))) for x in t])
            spline = CubicSpline(t[::2], V[::2])
            if abs(spline(t) - V).max() <= SPLINE_TOLERANCE * abs(V).max():
                break
            knots *= 2
            if knots > MOST_KNOTS:
                raise ValueError(
                    f"drive.function is not smooth between t = {a:.6g} and {b:.6g} s: give the times at "
                    "which it jumps or has a kink as `breaks`"
                )
        found += [
            (float(x), tuple(c[::-1].tolist())) for x, c in zip(spline.x, spline.c.T, strict=False)
        ]
    final = drive.called(end)
    return [*found, (end, (final, 0.0, 0.0, 0.0))]
