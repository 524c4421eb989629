"""A shape given by functions as a series in cells: where it may touch, and the error of the series.

The shape is divided into cells, until it lies above the depth in a cell or is resolved there: the last
coefficients of the Legendre series of h and h' are rounding. Details narrower than the spacing of the nodes
of the first cells, 1/100 of their distance from the lowest point, may be missed.
"""

import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre
from scipy.optimize import brentq

from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import Profile, beside

DEGREE, INSET = 15, 1e-6
"""Degree of the series in a cell, and the distance of its last nodes from the ends, over half its width."""
NODES = np.array([-1.0, *legendre.Legendre.basis(DEGREE).deriv().roots(), 1.0]) * (1.0 - INSET)
"""Nodes of Lobatto's rule, so that no jump of the curvature is missed near an end, which may be a kink."""
SERIES = np.linalg.inv(legendre.legvander(NODES, DEGREE))
"""Matrix from values at the nodes to coefficients."""
DENSE = np.linspace(-1.0, 1.0, 33)
"""Points at which the series is examined; a resolved cell holds hardly more than half a wave."""
VALUES = legendre.legvander(DENSE, DEGREE).T
TAIL, TAIL_MARGIN = 13, 4.0
"""First of the last coefficients; bound of the truncation error over their sum, in an unresolved cell."""
RESOLVED, NOISE = 1e-13, 1e-9
"""Last coefficients, over the depth, of a resolved cell, and of one limited by the rounding of the shape."""
HELPS = 0.25
"""Halving a cell of a smooth shape leaves at most this share of the last coefficients."""
WIDE, FAR_ABOVE = 1e3, 1e9
"""Height over the depth above which a cell limited by rounding is divided, and any cell is omitted."""
JUMP, NARROW = 1e-3, 1e-9
"""Last coefficients over the slope, and width over the contact: only a jump keeps them so large."""
PARTS, OCTAVES = 8, 20
"""Cells of each octave of x at first, and octaves examined beyond the contact if there is no reach."""
MOST_CELLS = 2**14
"""Most cells; a shape that needs more is not smooth."""
NEAREST, FARTHEST = 2.0**-200, 2.0**200
"""Limits of the search for the width of the contact, in m."""
AHEAD = 4.0
"""Cells are made for a depth larger by this factor, and are used down to that depth over `AHEAD`."""
CHECK_RTOL = 1e-11
"""Discrepancy between h and h', and h(0) beside 0, that a check allows, relative to the depth."""

HOLLOW, FLAT, BEND = 1e-9, 1e-15, 2.0**-5
"""Decrease of h' of a convex shape, and its last coefficients, over h', that count as rounding; and width of
a cell, over that of the contact, below which a higher derivative must jump there."""


class Cells(NamedTuple):
    """Intervals of x in which h may be low, the series of h and h' in each, and the truncation errors."""

    start: Any
    end: Any
    height: Any
    slope: Any
    height_tail: Any
    slope_tail: Any

    def only(self, rows: Any) -> "Cells":
        """Return some of the rows, or all of them in another order."""
        return Cells(*(part[rows] for part in self))

    def lowest(self) -> Any:
        """Return the lowest h in each cell."""
        return (self.height @ VALUES).min(axis=1)

    def values(self, series: Any, rows: Any, x: Any) -> Any:
        """Return h or h', the one whose series is given, at the points x in some of the cells."""
        start, end = self.start[rows], self.end[rows]
        place = np.clip((2.0 * x - start - end) / (end - start), DENSE[0], DENSE[-1])
        return legendre.legval(place, np.moveaxis(series[rows], -1, 0), tensor=False)


class Surface:
    """The surface of an indenter, mirrored (`side` = -1) for a drive in the negative direction."""

    def __init__(self, indenter: Any, side: float, least: float = NEAREST) -> None:
        self.indenter, self.side, self.least = indenter, side, least
        self.end = math.nextafter(indenter.reach, 0.0)
        self.kinks = sorted({0.0, *(side * kink for kink in indenter.kinks)})
        self.jumps: list[float] = []
        self._cells: tuple[float, Cells] | None = None
        self._length = 0.0

    def height(self, x: float) -> float:
        """Return h, or raise where it is not a number."""
        return self._value(self.indenter.height, x)

    def slope(self, x: float) -> float:
        """Return h', or raise where it is not a number."""
        return self.side * self._value(self.indenter.slope, x)

    def _value(self, function: Callable[[float], Any], x: float) -> float:
        x = self.side * x
        try:
            value = float(function(x))
        except OverflowError:
            return math.inf
        except (ArithmeticError, ValueError) as error:
            raise QuadratureError(
                f"the indenter's shape failed at x = {x:.6g} m ({error}); "
                "`reach` says up to where it is defined"
            ) from error
        if math.isnan(value):
            raise QuadratureError(f"the indenter's shape is nan at x = {x:.6g} m")
        return value

    def _at_nodes(self, function: Callable[[Any], Any], cells: Any) -> Any:
        """Return h or h' at the nodes of each cell."""
        x = cells.mean(axis=1)[:, None] + 0.5 * np.diff(cells) * NODES
        try:
            values = np.asarray(function(self.side * x), dtype=float)
        except (ArithmeticError, ValueError):
            values = np.full(1, math.nan)
        if np.isnan(values).any():  # one by one, for the message
            values = np.array([self._value(function, point) for point in x.flat]).reshape(x.shape)
        return values

    def slope_series(self, cells: Any) -> Any:
        """Return the coefficients of h' in each cell."""
        return self.side * self._at_nodes(self.indenter.slope, cells) @ SERIES.T

    def beside(self, x: float, to: float) -> float:
        """Return x, or where it is a kink the next number towards `to`."""
        return beside(x, to) if x in self.kinks else x

    def first(self, enough: Callable[[float, float], bool]) -> float:
        """Return the first of doubled x at which the higher of both sides is `enough`, or the reach."""
        x, last = self.least, min(self.end, FARTHEST)
        while x < last and not enough(x, max(self.height(-x), self.height(x))):
            x *= 2.0
        return x if x < last else self.end

    def shallow(self, load: float, width: Callable[[float], float]) -> float:
        """Return an approximate depth at a load: depth times `width` of the half length is the load."""
        x = self.first(lambda x, height: height * width(x) >= load)
        near, far = (max(self.height(-y), self.height(y)) * width(y) for y in (0.5 * x, x))
        if 0.0 < near < load <= far < math.inf:
            x *= (load / far) ** (1.0 / math.log2(far / near))  # exact for a power
        return min(self.height(-x), self.height(x)) or load / x

    def cells(self, depth: float) -> Cells:
        """Return the cells in which h may be below a depth; they are reused for depths near it."""
        if self._cells is None or not self._cells[0] / AHEAD**2 <= depth <= self._cells[0]:
            if abs(self.height(0.0)) > CHECK_RTOL * depth:
                raise QuadratureError(
                    f"h(0) = {self.height(0.0):.6g} m: expected 0, the lowest point"
                )
            self._cells = AHEAD * depth, self._resolved(AHEAD * depth)
        return self._cells[1]

    @property
    def examined(self) -> float:
        """Where the last cell ends."""
        return float(self._cells[1].end.max()) if self._cells else self.end

    def _grid(self, depth: float) -> Any:
        """Return intervals out to the reach, narrow where the contact is, cut at the kinks."""
        self._length = self.first(lambda _, height: height >= depth)
        if self._length == math.nextafter(math.inf, 0.0):
            raise QuadratureError(f"the indenter does not rise to {depth:.6g} m anywhere")
        octaves = itertools.pairwise([0.0, *(self._length * 2.0 ** np.arange(OCTAVES + 1))])
        side = np.concatenate([np.linspace(*ends, PARTS + 1) for ends in octaves])
        side = np.append(side[side < self.end], min(self.end, side[-1]))
        kinks = [kink for kink in self.kinks if abs(kink) < side[-1]]
        cuts = np.unique(np.concatenate((-side, side, kinks)))
        return np.column_stack((cuts[:-1], cuts[1:]))

    def _resolved(self, depth: float) -> Cells:
        """Cut the cells in which h may be below the depth until h and h' are resolved in each."""
        todo, tails, done = self._grid(depth / AHEAD), np.array(math.inf), []
        count = len(todo)
        while todo.size:
            values = self._at_nodes(self.indenter.height, todo)
            height = values @ SERIES.T
            tail = np.abs(height[:, TAIL:]).sum(axis=1)
            low = (height @ VALUES).min(axis=1) - TAIL_MARGIN * tail
            near = ~((low > depth) | (values.min(axis=1) > FAR_ABOVE * depth))
            todo, height, tail = todo[near], height[near], tail[near]
            slope = self.slope_series(todo)
            start, end = todo.T
            width, slope_tail = end - start, np.abs(slope[:, TAIL:]).sum(axis=1)
            size, worst = np.abs(slope).sum(axis=1), np.maximum(tail, slope_tail * width)
            # Where a cut does not help, the coefficients are the rounding of the shape.
            noisy = worst > HELPS * np.broadcast_to(tails, near.shape)[near]
            noisy &= (slope_tail < NOISE * size) & (values[near].max(axis=1) < WIDE * depth)
            fine = (worst < RESOLVED * depth) | (noisy & (worst < NOISE * depth))
            jumps = todo[(slope_tail > JUMP * size) & (width < NARROW * self._length)].tolist()
            self.jumps += [x for y, x in jumps if x < self.end and not self._kink_in(y, x)]
            done.append(Cells(start, end, height, slope, tail, slope_tail).only(fine))
            start, end, middle = start[~fine], end[~fine], todo[~fine].mean(axis=1)
            count += middle.size
            if count > MOST_CELLS or np.any((middle == start) | (middle == end)):
                raise QuadratureError(
                    f"near x = {self.side * middle[0]:.6g} m the shape is not smooth, or the search "
                    "interval is too large; `reach` says where it ends"
                )
            todo = np.column_stack((start, middle, middle, end)).reshape(-1, 2)
            tails = np.repeat(worst[~fine], 2)
        cells = Cells(*(np.concatenate(parts) for parts in zip(*done, strict=True)))
        cells = cells.only(np.argsort(cells.start))
        width = cells.end - cells.start
        allowed = CHECK_RTOL * depth + TAIL_MARGIN * (cells.height_tail + cells.slope_tail * width)
        rise = 2.0 * cells.height[:, 1::2].sum(axis=1)
        if np.any(np.abs(cells.slope[:, 0] * width - rise) > allowed):
            raise QuadratureError(
                "the slope function is not the derivative of the height function, "
                "or jumps where `kinks` does not say so"
            )
        if np.any(cells.lowest() < -allowed):
            raise QuadratureError("h is negative somewhere: expected h(0) = 0, the lowest point")
        return cells

    def _kink_in(self, start: float, end: float) -> bool:
        return any(start <= kink <= end for kink in self.kinks)

    def bends(self, cells: Cells, narrow: float) -> list[float]:
        """Return where cells narrow towards a jump of a derivative that is not at a known kink."""
        width, found = cells.end - cells.start, list[float]()
        for run in np.split(np.arange(width.size), np.flatnonzero(np.diff(width)) + 1):
            start, end, size = cells.start[run[0]], cells.end[run[-1]], width[run[0]]
            neighbours = width[[max(run[0] - 1, 0), min(run[-1] + 1, width.size - 1)]]
            lone = size < narrow and size <= neighbours.min()
            if lone and not self._kink_in(start - size, end + size):
                found.append(self._bend(start, end))
        return found

    def _bend(self, start: float, end: float) -> float:
        """Return where the jump is in an interval, which is bisected until both halves are resolved."""
        while True:
            middle = 0.5 * (start + end)
            halves = np.array([[start, middle], [middle, end]])
            slope = self.slope_series(halves)
            tails = np.abs(slope[:, TAIL:]).sum(axis=1)
            if tails.max() <= FLAT * np.abs(slope).max() or middle in (start, end):
                return float(middle)
            start, end = halves[np.argmax(tails)].tolist()


class ConvexProfile:
    """A convex profile along x as a series, for the convolution; shapes that may touch twice are refused."""

    def __init__(self, profile: Profile, side: float) -> None:
        self.surface, self.reach = Surface(profile, side), profile.reach
        self.shallow = self.surface.shallow
        self.declared = [side * kink for kink in profile.kinks]
        self.kinks: tuple[float, ...] = ()
        """Those of the profile, and where a higher derivative jumps: the convolution is cut there."""
        self.bent = False
        """Whether there are any of the latter; they are not known to the last digit."""
        self.noise = 0.0
        """Relative error of the series, by its last coefficients, over the depth."""
        self._cells: Any = None

    def sides(self, depth: float) -> tuple[float, float]:
        """Return the extent of the contact at rest, ahead and behind, after checking the shape."""
        surface, cells = self.surface, self.surface.cells(depth)
        low = cells.only(cells.lowest() < depth)
        slopes = low.slope @ VALUES
        rounding = HOLLOW * np.abs(slopes).max(initial=0.0) + TAIL_MARGIN * low.slope_tail
        hollow = np.any(np.diff(slopes, axis=1) < -rounding[:, None])
        hollow |= np.any(np.diff(slopes.mean(axis=1)) < -rounding[1:])
        if hollow or np.any(low.start[1:] != low.end[:-1]):
            raise QuadratureError(
                f"the shape is not convex down to {depth:.6g} m: it may touch in several places, for "
                'which quadrature needs foundation.kind = "kelvin-voigt"'
            )
        if surface.jumps:
            raise QuadratureError("the slope jumps where `kinks` does not say so")
        tails = low.height_tail + low.slope_tail * (low.end - low.start)
        self.noise = float(TAIL_MARGIN * tails.max() / depth)
        ends = self._end(depth, -1.0), self._end(depth, 1.0)
        if cells is not self._cells:
            self._cells = cells
            bends = surface.bends(cells, BEND * sum(ends))
            borders = self._bent_borders([*self.declared, *bends])
            self.kinks = tuple(sorted({*self.declared, *bends, *borders}))
            self.bent = bool({*bends, *borders} - {0.0})
        return ends

    def _bent_borders(self, known: list[float]) -> list[float]:
        """Return borders of cells across which one series does not hold, away from the known kinks."""
        cells, border = self._cells, self._cells.start[1:]
        width = cells.end - cells.start
        half = 0.5 * np.minimum(width[1:], width[:-1])
        series = self.slope(border[:, None] + half[:, None] * NODES) @ SERIES.T
        rounding = RESOLVED * np.abs(series).sum(axis=1)
        rounding += TAIL_MARGIN * (cells.slope_tail[1:] + cells.slope_tail[:-1])
        bent = (np.abs(series[:, TAIL:]).sum(axis=1) > rounding) & (border == cells.end[:-1])
        for kink in known:
            bent &= np.abs(border - kink) >= half
        return border[bent].tolist()

    def _end(self, depth: float, side: float) -> float:
        """Return the distance at which the shape has risen to the depth."""

        def excess(x: float) -> float:
            return self.surface.height(side * x) - depth

        far = self.surface.first(lambda x, _: excess(x) >= 0.0)
        if excess(far) < 0.0:
            raise QuadratureError("the contact lies beyond the indenter's reach")
        return float(brentq(excess, 0.0, far, xtol=1e-300, rtol=8.9e-16, maxiter=2000))

    def height(self, x: Any) -> Any:
        """Return h(x), of an array by the series of the last depth, of a float by the function itself."""
        return self._sum(self._cells.height, x) if np.ndim(x) else self.surface.height(x)

    def slope(self, x: Any) -> Any:
        """Return h'(x) likewise."""
        return self._sum(self._cells.slope, x) if np.ndim(x) else self.surface.slope(x)

    def _sum(self, series: Any, x: Any) -> Any:
        start = self._cells.start
        rows = np.clip(np.searchsorted(start, x, side="right") - 1, 0, start.size - 1)
        return self._cells.values(series, rows, x)
