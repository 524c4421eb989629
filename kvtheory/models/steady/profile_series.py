"""A convex shape given by Python functions, as a series in cells, for the convolution.

The series is that of `cells`, resolved to the rounding of the shape, so that thousands of slopes need no call
of a Python function. A shape that is not convex where it is below the depth may touch in several places; the
memory of the surface between them is not modelled here, and the shape is refused.
"""

import math
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import brentq

from kvtheory.models.steady.cells import (
    DENSE,
    NODES,
    RESOLVED,
    SERIES,
    TAIL,
    TAIL_MARGIN,
    VALUES,
    Cells,
    Surface,
)
from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Profile

HOLLOW = 1e-9
"""Decrease of the slope, over its greatest value, that rounding may cause."""
NARROW = 2.0**-5
"""Width of a cell, over that of the contact, left only by the jump of a higher derivative."""
FLAT = 1e-15
"""Last coefficients of a slope, over the slope, that are rounding."""
ROOT, TINY = 8.9e-16, 1e-300
"""Tolerances of the edges at rest."""


class ConvexProfile:
    """A profile in the direction of sliding: mirrored for a drive in the negative direction."""

    def __init__(self, profile: Profile, side: float) -> None:
        self.surface = Surface(profile, side)
        self.reach = profile.reach
        self.declared = [side * kink for kink in profile.kinks]
        self.kinks: tuple[float, ...] = ()
        """Those of the profile, and where a higher derivative jumps: the convolution is cut there."""
        self.bent = False
        """Whether there are any of the latter; they are not known to the last digit."""
        self._depth, self._cells = math.nan, Cells(*(np.empty(0),) * 6)

    def sides(self, depth: float) -> tuple[float, float]:
        """Return the extent of the contact at rest, ahead and behind, after checking the shape."""
        surface, cells = self.surface, self.surface.cells(depth)
        within = (cells.height @ VALUES).min(axis=1) < depth
        slopes = cells.slope @ VALUES
        rounding = HOLLOW * np.abs(slopes[within]).max(initial=0.0)
        rounding = rounding + TAIL_MARGIN * cells.slope_tail[within]
        hollow = np.any(np.diff(slopes[within], axis=1) < -rounding[:, None])
        hollow |= np.any(np.diff(slopes[within].mean(axis=1)) < -rounding[1:])
        whole = np.all(np.diff(np.flatnonzero(within)) == 1) and np.all(
            cells.start[within][1:] == cells.end[within][:-1]
        )
        if not whole or hollow:
            raise QuadratureError(
                f"the shape is not convex down to {depth:.6g} m: it may touch in several places, for "
                'which quadrature needs foundation.kind = "kelvin-voigt"'
            )
        if surface.jumps:
            raise QuadratureError("the slope jumps where `kinks` does not say so")
        ends = self._end(depth, -1.0), self._end(depth, 1.0)
        self._depth, known = depth, cells is self._cells
        self._cells = cells
        if not known:
            bends = _bends(surface, cells, NARROW * sum(ends))
            tip = [0.0] if self._bent_at_zero() else []
            self.kinks, self.bent = tuple(sorted({*self.declared, *bends, *tip})), bool(bends)
        return ends

    def _bent_at_zero(self) -> bool:
        """Return whether one series does not hold on both sides of the lowest point."""
        cells = self._cells
        i = int(np.searchsorted(cells.start, 0.0))
        beside = slice(i - 1, i + 1)
        half = 0.5 * (cells.end - cells.start)[beside].min()
        series = SERIES @ self.slope(half * NODES)
        rounding = RESOLVED * np.abs(series).sum() + TAIL_MARGIN * cells.slope_tail[beside].sum()
        return bool(np.abs(series[TAIL:]).sum() > rounding)

    def _end(self, depth: float, side: float) -> float:
        """Return the distance at which the shape has risen to the depth."""

        def excess(x: float) -> float:
            return self.surface.height(side * x) - depth

        far = self.surface.first(lambda x, _: excess(x) >= 0.0)
        if excess(far) < 0.0:
            raise QuadratureError("the contact lies beyond the indenter's reach")
        return float(brentq(excess, 0.0, far, xtol=TINY, rtol=ROOT, maxiter=2000))

    @property
    def noise(self) -> float:
        """Relative error of the series, by its last coefficients, over the depth."""
        cells = self._cells
        low = (cells.height @ VALUES).min(axis=1) < self._depth
        tails = cells.height_tail + cells.slope_tail * (cells.end - cells.start)
        return float(TAIL_MARGIN * tails[low].max() / self._depth)

    def height(self, x: Any) -> Any:
        """Return h(x) by the series of the last depth; of the function itself where there is none."""
        return (
            self._sum(self._cells.height, x)
            if isinstance(x, np.ndarray)
            else self.surface.height(x)
        )

    def slope(self, x: Any) -> Any:
        """Return h'(x) likewise."""
        return (
            self._sum(self._cells.slope, x) if isinstance(x, np.ndarray) else self.surface.slope(x)
        )

    def _sum(self, series: Any, x: Any) -> Any:
        cells = self._cells
        row = np.clip(np.searchsorted(cells.start, x, side="right") - 1, 0, cells.start.size - 1)
        start, end = cells.start[row], cells.end[row]
        place = np.clip((2.0 * x - start - end) / (end - start), DENSE[0], DENSE[-1])
        return legendre.legval(place, np.moveaxis(series[row], -1, 0), tensor=False)


def _bends(surface: Surface, cells: Cells, narrow: float) -> list[float]:
    """Return where the narrowest of narrow cells close in on a bend that no kink explains."""
    width, found = cells.end - cells.start, list[float]()
    runs = np.split(np.arange(width.size), np.flatnonzero(np.diff(width)) + 1)
    for run in runs:
        start, end, size = cells.start[run[0]], cells.end[run[-1]], width[run[0]]
        beside = width[[max(run[0] - 1, 0), min(run[-1] + 1, width.size - 1)]]
        known = any(start - size <= kink <= end + size for kink in surface.kinks)
        if size < narrow and size <= beside.min() and not known:
            found.append(_bend(surface, start, end))
    return found


def _bend(surface: Surface, start: float, end: float) -> float:
    """Return the bend of the slope in an interval: halved until no half is worse resolved than rounding."""
    while True:
        middle = 0.5 * (start + end)
        halves = np.array([[start, middle], [middle, end]])
        slope = surface.slope_series(halves)
        tails = np.abs(slope[:, TAIL:]).sum(axis=1)
        if tails.max() <= FLAT * np.abs(slope).max() or middle in (start, end):
            return float(middle)
        start, end = halves[np.argmax(tails)].tolist()
