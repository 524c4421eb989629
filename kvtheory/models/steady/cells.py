"""A shape of any kind as a series in cells: where it may touch, and the error of the series.

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

from kvtheory.results.errors import QuadratureError
from kvtheory.scene.indenters import beside

DEGREE = 15
"""Degree of the series in a cell, with 16 nodes."""
NODES, WEIGHTS = legendre.leggauss(DEGREE + 1)
SERIES = legendre.legvander(NODES, DEGREE).T * WEIGHTS * (np.arange(DEGREE + 1)[:, None] + 0.5)
"""Matrix from values at the nodes to coefficients."""
DENSE = np.linspace(-1.0, 1.0, 33)
"""Points at which the series is examined; a resolved cell holds hardly more than half a wave."""
VALUES = legendre.legvander(DENSE, DEGREE).T
TAIL = 13
"""First of the coefficients that tell how well a cell is resolved."""
RESOLVED = 1e-13
"""A cell is resolved if its last coefficients, over the depth, are below this."""
NOISE = 1e-9
"""The same for a shape whose own rounding is more than that; the certificate says so."""
HELPS = 0.25
"""Largest share of the last coefficients of a smooth shape that remains after a cut."""
WIDE = 1e3
"""Height over the depth above which cells limited by rounding are divided, not accepted."""
JUMP, NARROW = 1e-3, 1e-9
"""Last coefficients of a slope, over the slope, that only a jump keeps in so narrow a cell."""
TAIL_MARGIN = 4.0
"""Truncation error of a series, over its last coefficients, in a cell that is not resolved."""
FAR_ABOVE = 1e9
"""Height over the depth from which a cell is not examined further."""
PARTS = 8
"""Cells of each octave of x at first: with their nodes, dips of 1/100 of their distance are seen."""
OCTAVES = 20
"""How far a shape without a reach is examined beyond the contact: a million times its length."""
MOST_CELLS = 2**14
"""Most cells; a shape that needs more is not smooth."""
NEAREST, FARTHEST = 2.0**-200, 2.0**200
"""Where the search for the width of the contact begins and ends, in m."""
AHEAD = 4.0
"""Cells are made for a depth larger by this factor, and are used down to that depth over `AHEAD`."""
CHECK_RTOL = 1e-11
"""Discrepancy between h and h' that a check allows, relative to the depth."""
SQUARED = 1.0 / (2.0 * np.arange(DEGREE + 1) + 1.0)
"""The mean of the square of each Legendre polynomial."""


class Cells(NamedTuple):
    """Intervals of x in which h may be low, with the series of h and h' in each; one row for each."""

    start: Any
    end: Any
    height: Any
    slope: Any
    height_tail: Any
    slope_tail: Any

    def only(self, rows: Any) -> "Cells":
        """Return some of the rows, or all of them in another order."""
        return Cells(*(part[rows] for part in self))


class Surface:
    """The surface of an indenter, mirrored (`side` = -1) for a drive in the negative direction."""

    def __init__(self, indenter: Any, side: float, least: float = NEAREST) -> None:
        self.indenter, self.side, self.least = indenter, side, least
        self.end = math.nextafter(indenter.reach, 0.0)
        self.kinks = sorted({0.0, *(side * kink for kink in indenter.kinks)})
        self.jumps: list[float] = []
        self._cells: tuple[float, Cells] | None = None
        self._length = 0.0
        if self.height(0.0) != 0.0:
            raise QuadratureError(f"h(0) = {self.height(0.0):.6g} m: expected 0, the lowest point")

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

    def _values(self, function: Callable[[Any], Any], x: Any, sign: float = 1.0) -> Any:
        """Return the values of h or h' at an array of points."""
        try:
            values = sign * np.asarray(function(self.side * x), dtype=float)
        except (ArithmeticError, ValueError):
            values = np.full(1, math.nan)
        if np.isnan(values).any():  # one by one, for the message
            flat = [sign * self._value(function, point) for point in x.ravel().tolist()]
            values = np.array(flat).reshape(x.shape)
        return values

    def beside(self, x: float, to: float) -> float:
        """Return x, or where it is a kink the next number towards `to`."""
        return beside(x, to) if x in self.kinks else x

    def first(self, enough: Callable[[float, float], bool]) -> float:
        """Return the first power of two at which the higher of both sides is enough, or the reach."""
        x, last = self.least, min(self.end, FARTHEST)
        while x < last and not enough(x, max(self.height(-x), self.height(x))):
            x *= 2.0
        return x if x < last else self.end

    def shallow(self, load: float, width: Callable[[float], float]) -> float:
        """Return a depth that, times a width which depends on the half length, is about the load."""
        x = self.first(lambda x, height: height * width(x) >= load)
        near, far = (max(self.height(-y), self.height(y)) * width(y) for y in (0.5 * x, x))
        if 0.0 < near < load <= far < math.inf:
            x *= (load / far) ** (1.0 / math.log2(far / near))  # exact for a power
        return min(self.height(-x), self.height(x)) or load / x

    def cells(self, depth: float) -> Cells:
        """Return the cells in which h may be below a depth; they serve for others near it."""
        if self._cells is None or not self._cells[0] / AHEAD**2 <= depth <= self._cells[0]:
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
        octaves = [0.0, *(self._length * 2.0 ** np.arange(OCTAVES + 1))]
        side = np.concatenate(
            [np.linspace(*ends, PARTS + 1) for ends in itertools.pairwise(octaves)]
        )
        side = np.append(side[side < self.end], min(self.end, octaves[-1]))
        kinks = [kink for kink in self.kinks if abs(kink) < side[-1]]
        cuts = np.unique(np.concatenate((-side, side, kinks)))
        return np.column_stack((cuts[:-1], cuts[1:]))

    def _nodes(self, cells: Any) -> Any:
        """Return the nodes of each cell."""
        return cells.mean(axis=1)[:, None] + 0.5 * np.diff(cells) * NODES

    def slope_series(self, cells: Any) -> Any:
        """Return the coefficients of h' in each cell."""
        return self._values(self.indenter.slope, self._nodes(cells), self.side) @ SERIES.T

    def _resolved(self, depth: float) -> Cells:
        """Cut the cells in which h may be below the depth until h and h' are resolved in each."""
        todo, tails, done = self._grid(depth / AHEAD), np.array(math.inf), []
        count = len(todo)
        while todo.size:
            values = self._values(self.indenter.height, self._nodes(todo))
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
            self._note_jumps(todo[(slope_tail > JUMP * size) & (width < NARROW * self._length)])
            done.append(Cells(start, end, height, slope, tail, slope_tail).only(fine))
            start, end, middle = start[~fine], end[~fine], todo[~fine].mean(axis=1)
            count += middle.size
            if count > MOST_CELLS or np.any((middle == start) | (middle == end)):
                raise QuadratureError(
                    f"near x = {self.side * middle[0]:.6g} m the shape is not smooth, or there are too "
                    "many places to look at; `reach` says where it ends"
                )
            todo = np.column_stack((start, middle, middle, end)).reshape(-1, 2)
            tails = np.repeat(worst[~fine], 2)
        rows = [np.concatenate(parts) for parts in zip(*done, strict=True)]
        cells = Cells(*rows).only(np.argsort(rows[0]))
        self._check_slope(cells, depth)
        return cells

    def _note_jumps(self, cells: Any) -> None:
        """Record where the slope jumps in a cell without a declared kink."""
        for start, end in cells.tolist():
            if end < self.end and not any(start <= kink <= end for kink in self.kinks):
                self.jumps.append(end)

    def _check_slope(self, cells: Cells, depth: float) -> None:
        """Raise unless h' is the derivative of h, and h is nowhere negative."""
        width = cells.end - cells.start
        allowed = CHECK_RTOL * depth + TAIL_MARGIN * (cells.height_tail + cells.slope_tail * width)
        rise = 2.0 * cells.height[:, 1::2].sum(axis=1)
        if np.any(np.abs(cells.slope[:, 0] * width - rise) > allowed):
            raise QuadratureError(
                "the slope function is not the derivative of the height function, "
                "or jumps where `kinks` does not say so"
            )
        if np.any((cells.height @ VALUES).min(axis=1) < -allowed):
            raise QuadratureError("h is negative somewhere: expected h(0) = 0, the lowest point")
