"""Least squares in a few unknowns: the minimum, its covariance, and what the data leave open.

Residuals are a function of unknowns in rows, which it may take many of at once. An unknown that may span
decades is best given as its logarithm.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

Array = NDArray[np.float64]
Residuals = Callable[[Array], Array]
"""Returns the residuals, in rows, of unknowns in rows."""

STEP = 1e-5
"""Change of an unknown for slopes by differences; the error of central ones is about 1e-10."""
SETTLED, FIRST_DAMPING, MOST_DAMPING, LONGEST = 1e-10, 1e-2, 1e8, 2.0
"""Relative gain that ends a descent, its first and last damping, and the longest step of an unknown."""
SINGULAR = 1e-9
"""Smallest singular value, over the largest, that is distinguished from zero."""
PRECISE = 1e-8
"""Precision of slopes: scatter below it cannot be told from none."""
OPEN = math.log(2.0)
"""Standard error of a combination of unknowns (logarithms) from which the data do not tell it."""
SHARE = 0.2
"""Part of an unknown in an open direction, over the largest, from which it belongs to it."""
CONFIDENCE = 0.95
"""Probability with which an interval holds the true value."""


def sloped(
    residuals: Residuals, points: Array, *, step: float = STEP, central: bool = False
) -> tuple[Array, Array]:
    """Return the residuals at points in rows, and their derivatives by the unknowns, along the last axis."""
    count, size = points.shape
    moves = step * np.concatenate([np.zeros((1, size)), np.eye(size), -np.eye(size) * central])
    moved = residuals((points[:, None] + moves[: size * (1 + central) + 1]).reshape(-1, size))
    r, ahead, behind = np.split(moved.reshape(count, -1, moved.shape[1]), [1, size + 1], axis=1)
    rise = (ahead - (behind if central else r)) / ((2.0 if central else 1.0) * step)
    return r[:, 0], rise.swapaxes(1, 2)


def updated(slopes: Array, change: Array, move: Array) -> Array:
    """Return slopes that give the change of the residuals along a move of the unknowns (Broyden)."""
    left = change - np.einsum("sni,si->sn", slopes, move)
    length = np.maximum(np.einsum("si,si->s", move, move), np.finfo(float).tiny)
    return np.asarray(slopes + left[..., None] * (move / length[:, None])[:, None])


def descend(
    residuals: Residuals, points: Array, low: Any, high: Any, steps: int, *, step: float = STEP,
    costly: bool = False, robust: bool = False, precision: float = 0.0, promising: float = 0.0,
) -> tuple[Array, Array]:  # fmt: skip
    """Return points after the method of Levenberg and Marquardt, and their sums of squares, all at once.

    `costly` residuals are not evaluated for slopes after the first ones, which Broyden's formula updates.
    `robust` minimizes 2 sum(sqrt(1 + r^2) - 1), in which large residuals count less. A descent ends where a
    step is below `precision`, or where its first step promises a relative gain below `promising`.
    """

    def loss(r: Array) -> Array:
        return np.asarray((2.0 * (np.hypot(1.0, r) - 1.0) if robust else r * r).sum(axis=-1))

    points, (r, J) = points.copy(), sloped(residuals, points, step=step)
    cost, damping = loss(r), np.full(len(points), FIRST_DAMPING)
    active = cost > 0.0
    for count in range(steps):
        if not active.any():
            break
        at = np.flatnonzero(active)
        weight = 1.0 / np.hypot(1.0, r[at]) if robust else np.ones_like(r[at])
        curve = np.einsum("sni,sn,snj->sij", J[at], weight, J[at])
        slope = np.einsum("sni,sn->si", J[at], weight * r[at])
        size = np.einsum("sii->si", curve)
        size = np.maximum(size, SINGULAR * size.max(axis=1, keepdims=True) + np.finfo(float).tiny)
        damped = curve + damping[at, None, None] * size[:, :, None] * np.eye(points.shape[1])
        move = np.linalg.solve(damped, -slope[..., None])[..., 0]
        tried = np.clip(points[at] + np.clip(move, -LONGEST, LONGEST), low, high)
        move = tried - points[at]
        hopeful = np.abs(move).max(axis=1) > precision
        if not count:
            hopeful &= -np.einsum("si,si->s", slope, move) > promising * cost[at]
        active[at] = hopeful
        at, tried, move = at[hopeful], tried[hopeful], move[hopeful]
        if not at.size:
            break
        if costly:
            new = residuals(tried)
            J[at] = ahead = updated(J[at], new - r[at], move)
        else:
            new, ahead = sloped(residuals, tried, step=step)
        total = loss(new)
        better = total < cost[at]
        gain = np.where(better, 1.0 - total / cost[at], 1.0)
        won = at[better]
        points[won], r[won], J[won] = tried[better], new[better], ahead[better]
        cost[won] = total[better]
        damping[at] *= np.where(better, 0.2, 5.0)
        active[at] = (gain > SETTLED) & (damping[at] < MOST_DAMPING)
    return points, cost


def student(freedom: float) -> float:
    """Return Student's t within which 95 % of the values are, at so many degrees of freedom, at least 1."""
    return float(stdtrit(max(freedom, 1.0), 0.5 + 0.5 * CONFIDENCE))


def covariance(slopes: Array) -> Array:
    """Return (J^T J)^-1, huge in directions of the unknowns that have no effect."""
    _, s, V = np.linalg.svd(slopes, full_matrices=False)
    return np.asarray(np.einsum("ki,k,kj->ij", V, np.maximum(s, SINGULAR * s[0]) ** -2.0, V))


class Fit(NamedTuple):
    """The best unknowns, the residuals there, their slopes, and the effective number of residuals.

    `minima` are the unknowns of all minima that were found, in rows, the best one first.
    """

    point: Array
    residuals: Array
    slopes: Array
    effective: float
    minima: Array

    @property
    def freedom(self) -> float:
        """The degrees of freedom, at least 1."""
        return max(self.effective - self.point.size, 1.0)

    @property
    def variance(self) -> float:
        """The variance of a residual, by the degrees of freedom."""
        return float(self.residuals @ self.residuals) / self.freedom

    @property
    def covariance(self) -> Array:
        """The covariance of the unknowns; huge in directions that the data leave open.

        Where they leave none open it allows for scatter that varies (HC3: MacKinnon and White, 1985), with
        standard errors no smaller than for equal scatter: in small samples HC3 varies too much (Angrist and
        Pischke, 2009, section 8.1).
        """
        inverse = covariance(self.slopes)
        equal = inverse * self.variance
        if self.open(range(self.point.size)):
            return equal
        gain = np.einsum("ni,ij->nj", self.slopes, inverse)
        left = np.maximum(1.0 - np.einsum("ni,ni->n", gain, self.slopes), 1.0 / self.residuals.size)
        varying = np.einsum("ni,n,nj->ij", gain, (self.residuals / left) ** 2, gain)
        least = np.finfo(float).tiny
        widen = np.sqrt(np.maximum(np.diag(equal) / np.maximum(np.diag(varying), least), 1.0))
        return np.asarray(varying * np.outer(widen, widen))

    def open(self, keys: Sequence[Any]) -> list[list[Any]]:
        """Return the keys of each combination of unknowns that the data leave open."""
        _, s, V = np.linalg.svd(self.slopes, full_matrices=False)
        deviation = max(math.sqrt(self.variance), PRECISE)
        directions = np.abs(V[deviation >= OPEN * np.maximum(s, SINGULAR * s[0])])
        return [
            [key for key, part in zip(keys, row, strict=True) if part > SHARE * row.max()]
            for row in directions
        ]
