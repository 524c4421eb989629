r"""Unilateral contact on a grid of cells: pressure p >= 0, gap >= 0, and one of them zero in each cell.

The displacement is the convolution of the pressure with the influence of a cell, along x in sliding not symmetric.
Across, a ball is symmetric: only cells at y > 0 are unknown, each with its mirror image. Newton's method on
the set of cells in contact (semi-smooth, or primal-dual active set): the equations of the cells in contact are
solved, cells with p < 0 leave, cells with a negative gap enter, until the set stays.

The depth is either given or one more unknown, with the balance of forces

    sum p = load + spring (relaxed_depth - depth)

as its equation; both are linear in p and the depth, so that no root is sought. Up to `DIRECT` cells the equations
are solved directly, beyond by GMRES, with convolutions by Fourier transforms that are padded along x and are of
cosines across: nothing is periodic.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct, idct, irfft, next_fast_len, rfft
from scipy.linalg import lu_factor, lu_solve
from scipy.sparse.linalg import LinearOperator, gmres

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

DIRECT = 900
"""Most cells in contact for which a direct solution is faster."""
TIGHT = 1e-10
"""Relative residual of GMRES: friction at low velocity is a small difference of pressures."""
MOST_SETS = 500
CHANCES = 10
"""Steps in a row that need not reduce the number of wrong cells; after them one cell changes at a time."""


class Support(NamedTuple):
    """A support: a given depth, or a load and a spring that is relaxed at a depth, per unit of pressure."""

    depth: float | None = None
    load: float = 0.0
    spring: float = 0.0
    relaxed_depth: float = 0.0


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

    A line has one cell across (m = 1) and no mirror image: its influence has one column.
    """

    def __init__(self, influence: Array, n: int, m: int) -> None:
        middle = len(influence) // 2
        self.shape = n, m
        self.whole = influence[middle - n + 1 : middle + n]
        self.folded = influence.shape[1] > 1
        self.length = next_fast_len(2 * n - 1, real=True)
        padded = np.zeros((self.length, self.whole.shape[1]))
        padded[:n], padded[self.length - n + 1 :] = self.whole[n - 1 :], self.whole[: n - 1]
        if self.folded:
            padded = dct(padded[:, : 2 * m + 1], type=1)[:, :-1]
        self.transformed = rfft(padded, axis=0)

    def displacement(self, pressure: Array) -> Array:
        """Return the displacement of all cells under a pressure on all cells."""
        n, m = self.shape
        p = dct(pressure, type=2, n=2 * m) if self.folded else pressure
        w = irfft(rfft(p, self.length, axis=0) * self.transformed, self.length, axis=0)[:n]
        return idct(w, type=2)[:, :m] if self.folded else w

    def matrix(self, active: Flags) -> Array:
        """Return the matrix from the pressure to the displacement of the cells in contact."""
        i, j = np.nonzero(active)
        along = self.shape[0] - 1 + np.subtract.outer(i, i)
        found = self.whole[along, np.abs(np.subtract.outer(j, j))]
        return found + self.whole[along, np.add.outer(j, j) + 1] if self.folded else found

    def solve(self, active: Flags, right: Array, start: Array) -> Array:
        """Return pressures, (k, n, m), whose displacements in contact are those of `right`, (k, n, m)."""
        found = np.zeros_like(right)
        if np.count_nonzero(active) <= DIRECT:
            factors = lu_factor(self.matrix(active), overwrite_a=True, check_finite=False)
            found[:, active] = lu_solve(factors, right[:, active].T, check_finite=False).T
            return found

        def product(p: Array) -> Array:
            spread = np.zeros(self.shape)
            spread[active] = p
            return self.displacement(spread)[active]

        size = np.count_nonzero(active)
        operator = LinearOperator((size, size), product, dtype=float)
        for k, each in enumerate(right):
            found[k, active], failed = gmres(
                operator, each[active], start[k, active], rtol=TIGHT, atol=0.0, restart=60, maxiter=20
            )
            if failed:
                raise ArithmeticError("the pressure of the cells in contact was not found by GMRES")
        return found


def unilateral(influence: Influence, height: Array, support: Support, start: Contact) -> Contact:
    """Return the contact of a rigid surface, `height` above its lowest point, from a start nearby.

    The height is infinite where there is no surface. Raises ArithmeticError if no set of cells is found.
    """
    surface = np.where(np.isfinite(height), height, 0.0)
    active, depth, pressure = start.active, start.depth, start.pressure
    both = np.stack([np.zeros_like(surface)] * 2) if support.depth is None else None
    fewest, chances = active.size + 1, CHANCES
    for _ in range(MOST_SETS):
        if not active.any():
            active = height == height.min()
        if both is None:
            depth = float(support.depth or 0.0)
            pressure = influence.solve(active, (depth - surface)[None], pressure[None])[0]
        else:
            both = influence.solve(active, np.stack([np.ones_like(surface), surface]), both)
            total, lost = (float(np.sum(each)) for each in both)
            carried = support.load + support.spring * support.relaxed_depth
            depth = (carried + lost) / (total + support.spring)
            pressure = depth * both[0] - both[1]
        gap = influence.displacement(pressure) - depth + height
        wrong = np.where(active, pressure, gap) < 0.0
        count = np.count_nonzero(wrong)
        if count == 0:
            return Contact(pressure, depth)
        chances = CHANCES if count < fewest else chances - 1
        fewest = min(fewest, count)
        if chances < 0:
            wrong.flat[np.flatnonzero(wrong)[:-1]] = False
        active = active ^ wrong
    raise ArithmeticError("no set of cells in contact was found")
