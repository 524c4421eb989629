r"""Unilateral contact on a grid of cells: pressure p >= 0, gap >= 0, and one of them zero in each cell.

The displacement is the convolution of the pressure with the influence of a cell, along x in sliding not
symmetric. Across, a ball is symmetric: only cells at y > 0 are unknown, each with its mirror image.
Newton's method on the set of cells in contact (semi-smooth, or primal-dual active set): the equations of
the cells in contact are solved, cells with p < 0 leave, cells with a negative gap enter, until the set
stays. On Kelvin-Voigt, where a cell that enters by itself has a large pressure, all leave before any
enters.

The depth is either given or one more unknown, with the balance of forces

    sum p = load + spring (relaxed_depth - depth)

as its equation; both are linear in p and the depth, so that no root is sought. Up to `DIRECT` cells the
equations are solved directly, beyond by GMRES, with convolutions by Fourier transforms that are padded
along x and are of cosines across: nothing is periodic.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, idct, irfft, next_fast_len, rfft
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import LinearOperator, gmres

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

DIRECT, LARGEST = 500, 3500
"""Cells in contact up to which a direct solution is faster, and up to which it is tried where GMRES fails."""
STEPS = 40
"""Steps of GMRES between restarts; 10 to 40 in all are usual."""
LEAST = 0.1
"""Least compliance of a wave in the preconditioner, half that of the shortest: where a half-space ends, there
are some below 0."""
TIGHT = 1e-10
"""Relative residual of GMRES: friction at low velocity is a small difference of pressures."""
MOST_SETS = 500
CHANCES = 10
"""Steps in a row that need not reduce the number of wrong cells; after them one cell changes at a time."""


class Balance(NamedTuple):
    """The balance of a support: share * sum of pressures + spring * depth = due.

    A given depth is the balance of a support without a load: (0, 1, depth).
    """

    share: float
    spring: float
    due: float

    def sum(self, cells: Array, depth: float) -> float:
        """Return its left side."""
        return self.share * float(np.sum(cells)) + self.spring * depth

    def closed(self, cells: Array, due: float, uniform: Array) -> tuple[Array, float]:
        """Return pressure and depth, from the pressure at no depth and that under a depth of 1."""
        depth = (due - self.sum(cells, 0.0)) / self.sum(uniform, 1.0)
        return cells + depth * uniform, depth


class Contact(NamedTuple):
    """Pressure of the cells, times S and their length, in m, and depth."""

    pressure: Array
    depth: float

    @property
    def active(self) -> Flags:
        """The cells in contact."""
        return self.pressure > 0.0


class Influence:
    """Displacement of n x m cells: influence at the distances -(n - 1) .. n - 1 along x, 0 .. 2 m across.

    A line has one cell across (m = 1) and no mirror image: its influence has one column. So has the loss,
    the slope of the influence by memory.

    GMRES starts from a nearly inverse operator: that of the influence over all cells, or, with `memory`, the
    signed decay from cell to cell of an average over what was met, that of the elastic influence, after each
    cell but the first of a row in contact has been freed from the average.
    """

    def __init__(
        self, influence: Array, loss: Array, n: int, m: int, elastic: Array, memory: float = 0.0
    ) -> None:
        middle = len(influence) // 2
        self.shape, self.folded = (n, m), influence.shape[1] > 1
        self.length = next_fast_len(2 * n - 1, real=True)
        near = slice(middle - n + 1, middle + n)
        self.whole, self.loss = influence[near], loss[near]
        padded = self._padded(self.whole)
        self.transformed = rfft(padded, axis=0)
        self.memory = memory
        if memory:
            middle, self.fading = len(elastic) // 2, np.ones((n, 1))
            padded = self._padded(elastic[middle - n + 1 : middle + n])
            self.inverse = 1.0 / np.maximum(rfft(padded, axis=0).real, LEAST)
        else:
            self.fading = np.exp(-np.arange(n) / n)[:, None]
            padded[:n] *= self.fading
            padded[self.length - n + 1 :] /= self.fading[:0:-1]
            self.inverse = 1.0 / rfft(padded, axis=0)

    def _padded(self, whole: Array) -> Array:
        n, m = self.shape
        padded = np.zeros((self.length, whole.shape[1]))
        padded[:n], padded[self.length - n + 1 :] = whole[n - 1 :], whole[: n - 1]
        return dct(padded[:, : 2 * m + 1], type=1)[:, :-1] if self.folded else padded

    def lost(self, pressure: Array) -> float:
        """Return the sum of pressure times slope of the surface, in cells: what is lost in a cell of sliding.

        The elastic part of the slope does no work, and is left out: nothing cancels at low velocity.
        """
        slope = self._convolved(pressure, rfft(self._padded(self.loss), axis=0))
        return float(np.sum(pressure * slope))

    def displacement(self, pressure: Array) -> Array:
        """Return the displacement of all cells under a pressure on all cells."""
        return self._convolved(pressure, self.transformed)

    def _convolved(self, cells: Array, transformed: Any) -> Array:
        n, m = self.shape
        p = dct(cells, type=2, n=2 * m) if self.folded else cells
        w = irfft(rfft(p, self.length, axis=0) * transformed, self.length, axis=0)[:n]
        return idct(w, type=2)[:, :m] if self.folded else w

    def matrix(self, active: Flags) -> Array:
        """Return the matrix from the pressure to the displacement of the cells in contact."""
        i, j = np.nonzero(active)
        along = self.shape[0] - 1 + np.subtract.outer(i, i)
        found = self.whole[along, np.abs(np.subtract.outer(j, j))]
        return found + self.whole[along, np.add.outer(j, j) + 1] if self.folded else found

    def solve(
        self, active: Flags, surface: Array, balance: "Balance", start: "Contact"
    ) -> "Contact":
        """Return the pressure that presses the cells in contact to the surface, and the depth."""
        size = np.count_nonzero(active)
        if size > DIRECT:
            found = self._iterated(active, surface, balance, start)
            if found is not None:
                return found
        if size > LARGEST:
            raise ArithmeticError(f"the pressure of {size} cells in contact was not found")
        factors = lu_factor(self.matrix(active), overwrite_a=True, check_finite=False)

        def pressed(cells: Array) -> Array:
            return lu_solve(factors, cells, check_finite=False)

        uniform = pressed(np.ones(size))
        return self._spread(
            active, *balance.closed(pressed(-surface[active]), balance.due, uniform)
        )

    def _iterated(
        self, active: Flags, surface: Array, balance: "Balance", start: "Contact"
    ) -> "Contact | None":
        """Return the same by GMRES, or None where it does not converge."""
        size, spread = np.count_nonzero(active), np.zeros(self.shape)

        def pressed(cells: Array) -> Array:
            spread[active] = cells
            freed = np.where(active, self._freed(spread), 0.0)
            return (self._convolved(freed * self.fading, self.inverse) / self.fading)[active]

        uniform = pressed(np.ones(size))
        scale = balance.sum(uniform, 1.0)

        def equations(unknown: Array) -> Array:
            spread[active], depth = unknown[:-1], unknown[-1]
            gap = self._convolved(spread, self.transformed)[active] - depth
            return np.append(gap, balance.sum(unknown[:-1], depth) / scale)

        def nearly_solved(right: Array) -> Array:
            return np.append(*balance.closed(pressed(right[:-1]), right[-1] * scale, uniform))

        operator, inverse = (
            LinearOperator((size + 1, size + 1), each, dtype=float)
            for each in (equations, nearly_solved)
        )
        right = np.append(-surface[active], balance.due / scale)
        begin = np.append(start.pressure[active], start.depth)
        found, failed = gmres(
            operator, right, begin, M=inverse, rtol=TIGHT, atol=0.0, restart=STEPS, maxiter=3
        )
        return None if failed else self._spread(active, found[:-1], found[-1])

    def _freed(self, cells: Array) -> Array:
        """Return what the memory averages to these values along each row of cells in contact."""
        if not self.memory:
            return cells
        before, decay = np.zeros_like(cells), abs(self.memory)
        if self.memory > 0.0:
            before[1:] = cells[:-1]
        else:
            before[:-1] = cells[1:]
        return (cells - decay * before) / (1.0 - decay)

    def _spread(self, active: Flags, cells: Array, depth: float) -> "Contact":
        pressure = np.zeros(self.shape)
        pressure[active] = cells
        return Contact(pressure, float(depth))


def unilateral(influence: Influence, height: Array, balance: Balance, start: Contact) -> Contact:
    """Return the contact of a rigid surface, `height` above its lowest point, from a start nearby.

    The height is infinite where there is no surface. Raises ArithmeticError if no set of cells is found.
    """
    surface = np.where(np.isfinite(height), height, 0.0)
    active, found = start.active, start
    fewest, chances = active.size + 1, CHANCES
    for _ in range(MOST_SETS):
        if not active.any():
            active = height == height.min()
        found = influence.solve(active, surface, balance, found)
        gap = influence.displacement(found.pressure) - found.depth + height
        pulled, below = active & (found.pressure < 0.0), ~active & (gap < 0.0)
        wrong = pulled | below
        count = int(np.count_nonzero(wrong))
        if count == 0:
            return found
        chances = CHANCES if count < fewest else chances - 1
        fewest = min(fewest, count)
        if influence.memory and pulled.any():
            wrong = pulled
        if chances < 0:
            wrong.flat[np.flatnonzero(wrong)[:-1]] = False
        active = active ^ wrong
    raise ArithmeticError("no set of cells in contact was found")
