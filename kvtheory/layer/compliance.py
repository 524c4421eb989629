r"""The elastic compliance of a bonded layer or a half-space, and the influence of a cell of pressure.

A pressure of wave number k compresses the surface of a layer of thickness H, bonded to a rigid base and
without friction on its surface, by (fact F30)

    w/p = S T(kappa)/k,   S = 2 (1 - nu^2)/E,   kappa = k H,
    T = [(3 - 4 nu) sinh 2 kappa - 2 kappa]/[(3 - 4 nu) cosh 2 kappa + 2 kappa^2 + 5 - 12 nu + 8 nu^2],

and T = 1 for a half-space. T is split into what has a closed form in x and y and a smooth rest,

    T = (1 - e^(-2 kappa)) + (T - 1 + e^(-2 kappa)):

1/k is the logarithm of a line, the 1/r of a point; e^(-2 kappa)/k is the same at the depth 2 H below, an
image that takes away the far field of the first. Both are integrated over a cell in closed form. The rest
vanishes as kappa at small wave numbers and as kappa^2 e^(-2 kappa) at large ones; it is integrated by
Gauss's rule.

Cells are 1 long, along x, and `width` wide; lengths are in cells, displacements in S times a length.
"""

import math
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.special import j0, xlogy

Array = NDArray[np.float64]

NODES, WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(24))
NODES = 0.5 + NODES
KAPPA = (np.arange(24)[:, None] + NODES).ravel()
"""Nodes over 0 < kappa < 24, where the rest has fallen to 1e-17."""
PER_KAPPA = np.tile(WEIGHTS, 24)
REACH = 30.0
"""Thicknesses beyond which a layer does not feel a cell: the influence has fallen to 1e-17."""
KNOTS = 3001
"""Knots of the spline of the rest under a point: 1e-10 of its largest value."""
TINY = 1e-150
"""Instead of zero where zero times a logarithm of it is zero."""
HALF_SPACE = 1e3
"""Kappa beyond which T is 1."""
SERIES = 1.0
"""Below it sinh y - y is summed: its difference would lose digits."""


def transform(kappa: Any, poisson_ratio: float) -> Any:
    """Return T(kappa) of a bonded layer (F30), for numbers or arrays above 0; at infinity 1.

    Without loss of digits at small kappa and Poisson's ratio 1/2, where T falls as kappa^3.

    >>> print(f"{transform(1e-3, 0.5):.6g} {transform(1e-3, 0.3) / 1e-3:.6g} {transform(40.0, 0.2):.6g}")
    6.66665e-10 0.408163 1
    """
    nu, kappa = poisson_ratio, np.minimum(kappa, HALF_SPACE)
    y, e = 2.0 * kappa, np.exp(-2.0 * kappa)
    small = np.minimum(y, SERIES)
    series = sum(small ** (2 * n + 1) / math.factorial(2 * n + 1) for n in range(1, 9))
    excess = np.where(y < SERIES, series * e, 0.5 * (1.0 - e * e) - y * e)
    top = (2.0 - 4.0 * nu) * 0.5 * -np.expm1(-2.0 * y) + excess
    bottom = (3.0 - 4.0 * nu) * 0.5 * (1.0 + e * e)
    return top / (bottom + (2.0 * kappa**2 + 5.0 - 12.0 * nu + 8.0 * nu**2) * e)


def stiffness(
    along: Array, across: Array, H: float, poisson_ratio: float, width: float | None
) -> Array:
    """Return pressure over displacement of waves, k/T(k H), from their numbers per cell along x and across.

    A half-space yields without bound to a uniform pressure, which counts as half the lowest number.
    """
    k = np.maximum(np.hypot(along, across / (width or 1.0)), 0.5 * along[1])
    return np.asarray(k / transform(k * H, poisson_ratio))


@lru_cache(maxsize=16)
def _spline(poisson_ratio: float, line: bool) -> CubicSpline:
    """Return the rest at r thicknesses from a line or a point load: int (T - 1 + e^(-2 kappa)) f d kappa.

    f = cos(kappa r)/(pi kappa) of a line, J_0(kappa r)/(2 pi) of a point.
    """
    r = np.linspace(0.0, REACH, KNOTS)
    wave, share = (np.cos, 1.0 / (math.pi * KAPPA)) if line else (j0, 0.5 / math.pi)
    rest = (transform(KAPPA, poisson_ratio) + np.expm1(-2.0 * KAPPA)) * share * PER_KAPPA
    values = [wave(np.outer(part, KAPPA)) @ rest for part in np.array_split(r, 16)]
    return CubicSpline(r, np.concatenate(values))


def _closed_of_point(r: Array) -> Array:
    """Return the displacement at r thicknesses from a point load and its image."""
    return (1.0 / r - 1.0 / np.hypot(r, 2.0)) / (2.0 * math.pi)


def _rest_of_point(r: Array, poisson_ratio: float) -> Array:
    """Return the rest at r thicknesses from a point load; far away it takes away the closed part."""
    near = _spline(poisson_ratio, line=False)(np.minimum(r, REACH))
    return np.where(r < REACH, near, -_closed_of_point(np.maximum(r, REACH)))


def _line(x: Array, H: float, poisson_ratio: float, cell: float) -> Array:
    """Return the displacement at distances x from a strip of one cell (`cell` = 1), or a line load (0)."""
    near = np.abs(x) < REACH * H
    found, at = np.zeros(x.shape), x[near]
    spline = _spline(poisson_ratio, line=True)
    if cell:
        closed = sum(sign * (_log_integral(at + 0.5, b) - _log_integral(at - 0.5, b))
                     for sign, b in ((1.0, 2.0 * H), (-1.0, 0.0)))  # fmt: skip
        points = zip(*_points(1.0, H), strict=True)
        rest = sum(weight * spline(np.abs(at + u) / H) for u, weight in points)
    else:
        closed, rest = np.log1p((2.0 * H / at) ** 2), spline(np.abs(at) / H)
    found[near] = closed / (2.0 * math.pi) + rest
    return found


def _points(length: float, H: float) -> Any:
    """Return Gauss points and weights of a mean over a cell, of what varies over a thickness."""
    points, weights = np.polynomial.legendre.leggauss(3 + int(3.0 * length / H))
    return 0.5 * length * points, 0.5 * weights


def _log_integral(x: Array, b: float) -> Array:
    """Return int log(x^2 + b^2) dx."""
    return xlogy(x, x * x + b * b) - 2.0 * x + 2.0 * b * np.arctan2(x, b)


def _box_integral(x: Array, y: Array, b: float) -> Array:
    """Return a double integral of 1/sqrt(x^2 + y^2 + b^2) over x and y, odd in both (Love 1929)."""
    across, along = (np.arcsinh(v / np.maximum(np.hypot(u, b), TINY)) for u, v in ((x, y), (y, x)))
    return x * across + y * along - b * np.arctan2(x * y, b * np.sqrt(x * x + y * y + b * b))


def _cell(x: Array, sides: Array, b: float) -> Array:
    """Return the displacement at the depth b below at x, (n, 1), from the cells between `sides` across."""
    before, after = (_box_integral(x + side, sides, b) for side in (-0.5, 0.5))
    return np.diff(after - before, axis=1) / (2.0 * math.pi)


@lru_cache(maxsize=12)
def of_cell(
    n: int, m: int, per_cell: int, shift: float, H: float, poisson_ratio: float, width: float | None
) -> Array:
    """Return the displacement from a cell, or a strip (`width` None), at distances along x and across.

    Along x they are -n + shift .. n + shift, in steps of 1/per_cell; across 0 .. m - 1 cells, of a strip 0
    only. H of a strip is finite: the logarithm of the half-plane has no depth.
    """
    distances = np.arange(-n * per_cell, n * per_cell + 1) / per_cell + shift
    x, where = np.unique(abs(distances), return_inverse=True)
    if width is None:
        return _line(x, H, poisson_ratio, 1.0)[where, None]
    x, y, sides = x[:, None], width * np.arange(float(m)), width * np.arange(-0.5, m)
    found = _cell(x, sides, 0.0)
    if math.inf == H:
        return found[where]
    found -= _cell(x, sides, 2.0 * H)
    near = np.hypot(x, y) < REACH * H
    rows, columns = near.any(axis=1), int(np.count_nonzero(near.any(axis=0)))
    for u, along in zip(*_points(1.0, H), strict=True):
        for v, across in zip(*_points(width, H), strict=True):
            r = np.hypot(x[rows] + u, y[:columns] + v) / H
            found[rows, :columns] += along * across * width / H * _rest_of_point(r, poisson_ratio)
    return np.where(near, found, 0.0)[where]


def far_away(x: Array, y: Array, H: float, poisson_ratio: float, width: float | None) -> Array:
    """Return the displacement far from a cell or a strip (`width` None): that of a point or line load."""
    if width is None:
        return _line(x.ravel(), H, poisson_ratio, 0.0).reshape(x.shape)
    r = np.hypot(x, y)
    if math.inf == H:
        return width / (2.0 * math.pi) / r
    r = r / H
    closed = _closed_of_point(r)
    return width / H * (closed + _rest_of_point(r, poisson_ratio))
