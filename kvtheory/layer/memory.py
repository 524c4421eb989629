r"""The memory of the body in steady sliding, as a filter along x.

With Poisson's ratio constant in time, the surface is displaced by the elastic influence, with the relaxed
modulus E_0, of the pressure filtered in time by E_0 J(t), J the creep compliance. In sliding at V, time is
distance along x. The creep compliance of a Prony series, E(s) = E_0 + sum E_i tau_i s/(1 + tau_i s), is

    E_0/E(s) = E_0/E_g + sum c_k/(1 + theta_k s),   E_0/E_g + sum c_k = 1:

the retardation times theta_k, one longer than each relaxation time, and their shares c_k > 0 follow from
the singular values and left vectors of the matrix of square roots of tau_i above a row of the roots of E_i
tau_i/E_0,

    theta_k = sigma_k^2,   c_k = (last entry of u_k)^2,

without a root that could be missed. Kelvin-Voigt has theta = tau, c = 1.

Each retardation time averages what the material has met, e(x) = int_0^oo e^(-s/l) C(x - s) ds/l, l = V
theta. From cell to cell the average decays by e^(-1/l) and takes up the integral over one cell, in which C
is a cubic with the slopes of central differences at its ends; where the cells begin, it is a quadrature over
all that lies ahead. Slopes without jumps keep friction at low velocity: it is the part of e - C that is even
in x, -l^2 C'', beside which each jump of the slope is -l/2 times the jump. So e - C is filtered, not e.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.special import factorial, gammainc

from kvtheory.layer import compliance

Array = NDArray[np.float64]

NODES, WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(20))
INTERPOLATION = 0.5 * np.array([[0, 0, -1, 1], [0, 1, 4, -3], [2, 0, -5, 3], [0, -1, 2, -1]])
"""Powers 0 to 3 of the distance back, in a cubic over the middle of three cells, of values at their ends."""
SLOWEST_DECAY = 1e-12
"""Decay in a cell below which the preconditioner takes no less."""
FORGOTTEN = 40.0
"""Decay after which nothing is remembered."""
PANELS = 2.0 ** np.arange(60) - 0.5


class Creep(NamedTuple):
    """Retardation times theta_k, in s, their shares c_k of the relaxed compliance, and E_0/E_g."""

    times: Array
    shares: Array
    glassy: float

    @classmethod
    def of_series(cls, modulus: float, moduli: Array, times: Array) -> "Creep":
        """Return the creep of a Prony series: relaxed modulus, and modulus and time of each arm.

        >>> creep = Creep.of_series(1.0, np.array([4.0]), np.array([0.02]))
        >>> [round(float(np.sum(each)), 12) for each in creep]
        [0.1, 0.8, 0.2]
        """
        rows = np.vstack([np.diag(np.sqrt(times)), np.sqrt(moduli * times / modulus)])
        left, sigma, _ = np.linalg.svd(rows, full_matrices=False)
        shares = left[-1] ** 2
        return cls(sigma**2, shares, modulus / (modulus + float(np.sum(moduli))))

    @classmethod
    def kelvin_voigt(cls, time: float) -> "Creep":
        """Return the creep of a spring beside a damper, which cannot be compressed at once."""
        return cls(np.array([time]), np.ones(1), 0.0)

    def modulus(self, rate: Any) -> Any:
        """Return E(s)/E_0 at rates s, in 1/s."""
        return 1.0 / (
            self.glassy + np.sum(self.shares / (1.0 + np.multiply.outer(rate, self.times)), axis=-1)
        )

    def remembered(self, travelled: Array, n: int) -> Array:
        """Return what is remembered after 0 .. n - 1 cells, of 1 met in the first, (n,).

        `travelled` is V theta_k in cells.
        """
        z = np.maximum(1.0 / travelled, SLOWEST_DECAY)
        found = np.exp(-np.outer(np.arange(n), z)) @ (self.shares * -np.expm1(-z))
        found[0] += self.glassy
        return np.asarray(found)


def moments(z: float) -> Array:
    """Return int_0^1 z e^(-z t) t^n dt for n = 0 .. 3: incomplete gamma functions."""
    n, z = np.arange(4), min(max(z, 1e-100), 1e100)
    return np.asarray(factorial(n) / z**n * gammainc(n + 1, z))


def filtered(influence: Array, ahead: Array, z: float) -> Array:
    """Return e - C of an influence over cells along x, without the first two and the last.

    `ahead` is e at the second cell, and z = 1/l the decay in a cell.
    """
    decay = math.exp(-z)
    weights = INTERPOLATION @ (moments(z) - [1.0, 0.0, 0.0, 0.0]) + [0.0, decay, 0.0, 0.0]
    taken = sliding_window_view(influence, 4, axis=0) @ weights
    begin = decay * (ahead - influence[1])
    return lfilter([1.0], [1.0, -decay], taken, axis=0, zi=begin[None])[0]


def average_ahead(n: float, y: Array, z: float, H: float, nu: float, width: float | None) -> Array:
    """Return e at the distance n ahead of a cell, for each distance y across."""
    edges = min(1.0 / z, n) * np.concatenate([[0.0], PANELS])
    edges = edges[: 1 + np.searchsorted(edges * z, FORGOTTEN)]
    s = (edges[:-1, None] + np.diff(edges)[:, None] * (0.5 + NODES)).ravel()
    weights = np.outer(np.diff(edges), WEIGHTS).ravel() * z * np.exp(-z * s)
    return weights @ compliance.far_away(n + s[:, None], y, H, nu, width)


def influence(
    elastic: Array,
    creep: Creep,
    travelled: Array,
    per_cell: int,
    shift: float,
    H: float,
    nu: float,
    width: float | None,
) -> tuple[Array, Array]:
    """Return the influence of a cell in sliding, and its loss, at distances of whole cells.

    The first two and the last two are left out. `elastic` is the influence at the distances
    -n + shift .. n + shift, `travelled` is V theta_k in cells. The loss is the slope of the influence
    without that of its elastic part, sum c_k (C - e_k)/l_k.
    """
    rows, m = elastic.shape
    whole = elastic[2 * per_cell : -2 * per_cell : per_cell]
    found, loss = whole.copy(), np.zeros_like(whole)
    y = (width or 1.0) * np.arange(float(m))
    n = (rows - 1) // 2 / per_cell
    for length, share in zip(travelled, creep.shares, strict=True):
        ahead = average_ahead(n - 1.0 / per_cell - shift, y, 1.0 / length, H, nu, width)
        behind = filtered(elastic, ahead, 1.0 / (length * per_cell))
        behind = behind[2 * (per_cell - 1) : rows - 2 * per_cell - 2 : per_cell]
        found += share * behind
        loss -= share / length * behind
    return found, loss
