r"""Unilateral contact on a grid of cells: pressure p >= 0, gap >= 0, and one of them zero in each cell.

The displacement is the convolution of the pressure with the influence of a cell, along x in sliding not
symmetric. Across, a ball is symmetric: only cells at y > 0 are unknown, each with its mirror image.
Newton's method on the set of cells in contact (semi-smooth, or primal-dual active set): the equations of
the cells in contact are solved, cells with p < 0 leave, then cells with a negative gap enter, until the set
stays. All leave before any enters, as on a damper a cell that enters by itself has a large pressure.

The depth is either given or one more unknown, with the balance of forces

    sum p = load + spring (relaxed_depth - depth)

as its equation; both are linear in p and the depth, so that no root is sought. The equations are solved by
GMRES, with convolutions by Fourier transforms that are padded along x and are of cosines across: nothing is
periodic.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, idct, irfft, next_fast_len, rfft, rfftfreq
from scipy.signal import lfilter, unit_impulse
from scipy.sparse.linalg import LinearOperator, gmres

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Stiffness = Callable[[Array, Array], Array]

STEPS, RESTARTS = 40, 10
"""Steps of GMRES between restarts, and restarts; 5 to 30 steps in all are usual."""
LOOSE, TIGHT = 1e-4, 1e-10
"""Relative residuals of GMRES, until the set stays and then: friction is a small difference of pressures."""
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


class Contact(NamedTuple):
    """Pressure of the cells, times S and their length, in m, and depth."""

    pressure: Array
    depth: float

    @property
    def active(self) -> Flags:
        """The cells in contact."""
        return self.pressure > 0.0

    def rise(self) -> float:
        """Return the sum over both edges of all rows of d(p^2)/dx, x in cells, behind the first cell."""
        rows = (np.pad(row[row > 0.0] ** 2, 3) for row in self.pressure.T)
        return 0.5 * float(sum(np.maximum(row[[5, -6]] - row[[3, -4]], 0.0).sum() for row in rows))


class Influence:
    """Displacement of n x m cells: influence at the distances -(n - 1) .. n - 1 along x, 0 .. 2 m across.

    A line has one cell across (m = 1) and no mirror image: its influence has one column. So has the loss,
    the slope of the influence by memory.

    GMRES starts from a nearly inverse operator. `memory` is what the material remembers after 0, 1, .. cells
    of sliding, of 1 met in the first. From what is remembered follows what was met, in each row of cells in
    contact, and from that the pressure, by the elastic `stiffness` of waves over all cells, whose numbers
    per cell along x and across are its arguments.
    """

    def __init__(
        self, influence: Array, loss: Array, m: int, memory: Array, stiffness: Stiffness
    ) -> None:
        n = len(memory)
        self.shape, self.folded = (n, m), influence.shape[1] > 1
        self.length = next_fast_len(2 * n - 1, real=True)
        self.transformed, self.loss = self._transformed(influence), loss
        across = np.pi * np.arange(2 * m if self.folded else 1) / (2 * m)
        self.inverse = stiffness(2.0 * np.pi * rfftfreq(self.length)[:, None], across)
        self.met = rfft(lfilter([1.0], memory, unit_impulse(n)), self.length)[:, None]

    def _transformed(self, influence: Array) -> Array:
        (n, m), middle = self.shape, len(influence) // 2
        padded = np.zeros((self.length, influence.shape[1]))
        padded[:n] = influence[middle : middle + n]
        padded[self.length - n + 1 :] = influence[middle - n + 1 : middle]
        padded = dct(padded[:, : 2 * m + 1], type=1)[:, :-1] if self.folded else padded
        return rfft(padded, axis=0)

    def lost(self, pressure: Array) -> float:
        """Return the sum of pressure times slope of the surface, in cells: what is lost in a cell of sliding.

        The elastic part of the slope does no work, and is left out: nothing cancels at low velocity.
        """
        return float(np.sum(pressure * self._convolved(pressure, self._transformed(self.loss))))

    def displacement(self, pressure: Array) -> Array:
        """Return the displacement of all cells under a pressure on all cells."""
        return self._convolved(pressure, self.transformed)

    def _convolved(self, cells: Array, transformed: Any) -> Array:
        n, m = self.shape
        p = dct(cells, type=2, n=2 * m) if self.folded else cells
        w = irfft(rfft(p, self.length, axis=0) * transformed, self.length, axis=0)[:n]
        return idct(w, type=2)[:, :m] if self.folded else w

    def solve(
        self, active: Flags, surface: Array, balance: Balance, start: Contact, rtol: float
    ) -> Contact:
        """Return the pressure that presses the cells in contact to the surface, and the depth."""
        size, spread = np.count_nonzero(active) + 1, np.zeros(self.shape)

        def pressed(cells: Array) -> Array:
            spread[active] = cells
            met = irfft(rfft(spread, self.length, axis=0) * self.met, self.length, axis=0)
            return self._convolved(np.where(active, met[: len(active)], 0.0), self.inverse)[active]

        uniform = pressed(np.ones(size - 1))
        scale = balance.sum(uniform, 1.0)

        def equations(unknown: Array) -> Array:
            spread[active], depth = unknown[:-1], unknown[-1]
            gap = self.displacement(spread)[active] - depth
            return np.append(gap, balance.sum(unknown[:-1], depth) / scale)

        def nearly_solved(right: Array) -> Array:
            cells = pressed(right[:-1])
            depth = (right[-1] * scale - balance.sum(cells, 0.0)) / scale
            return np.append(cells + depth * uniform, depth)

        operator, inverse = (
            LinearOperator((size, size), each, dtype=float) for each in (equations, nearly_solved)
        )
        right = np.append(-surface[active], balance.due / scale)
        begin = np.append(start.pressure[active], start.depth)
        found, failed = gmres(
            operator, right, begin, M=inverse, rtol=rtol, atol=0.0, restart=STEPS, maxiter=RESTARTS
        )
        if failed:
            raise ArithmeticError(f"the pressure of {size - 1} cells in contact was not found")
        pressure = np.zeros(self.shape)
        pressure[active] = found[:-1]
        return Contact(pressure, float(found[-1]))


def unilateral(influence: Influence, height: Array, balance: Balance, start: Contact) -> Contact:
    """Return the contact of a rigid surface, `height` above its lowest point, from a start nearby.

    The height is infinite where there is no surface. Raises ArithmeticError if no set of cells is found.
    """
    surface = np.where(np.isfinite(height), height, 0.0)
    active, found = start.active, start
    fewest, chances, rtol = active.size + 1, CHANCES, LOOSE
    for _ in range(MOST_SETS):
        if not active.any():
            active = height == height.min()
        found = influence.solve(active, surface, balance, found, rtol)
        gap = influence.displacement(found.pressure) - found.depth + height
        pulled, below = active & (found.pressure < 0.0), ~active & (gap < 0.0)
        count = int(np.count_nonzero(pulled | below))
        if count == 0:
            if rtol == TIGHT:
                return found
            rtol = TIGHT
            continue
        chances = CHANCES if count < fewest else chances - 1
        fewest = min(fewest, count)
        wrong = pulled if pulled.any() else below
        if chances < 0:
            wrong.flat[np.flatnonzero(wrong)[:-1]] = False
        active = active ^ wrong
    raise ArithmeticError("no set of cells in contact was found")
