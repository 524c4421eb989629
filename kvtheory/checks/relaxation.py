r"""Time constants of a curve that settles: delta = delta_oo + c exp(-t/T), fitted to the end of it.

Near steady sliding the depth settles with the slow time constant of F12 alone, and what is left of the
force balance right after a jump decays with the fast one. The same fit is made to theory at the same
times, so that what the fit itself gets wrong cancels.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from kvtheory.checks.noise import SURE

Array = NDArray[np.float64]

FEWEST = 6
"""Samples for three unknowns."""
LOG_PRECISE = 1e-6
"""Of the logarithm of a time constant: far closer than any data fix it."""
RANGE = 5.0
"""Factor up and down from the expected time constant in which to look."""


def fit(time: Array, values: Array, expected: float) -> float:
    """Return T of the best c_0 + c_1 exp(-t/T), for T within a factor of five of the expected one.

    Examples
    --------
    >>> t = np.linspace(0.0, 3.0, 50)
    >>> round(fit(t, 2.0 - 0.5 * np.exp(-t / 0.7), 1.0), 6)
    0.7
    """
    start = time[0]

    def left(log_T: float) -> float:
        basis = np.stack([np.ones_like(time), np.exp((start - time) / np.exp(log_T))], axis=1)
        found = np.linalg.lstsq(basis, values, rcond=None)[0]
        rest = values - basis @ found
        return float(rest @ rest)

    middle = np.log(expected)
    spread = np.log(RANGE)
    found = minimize_scalar(
        left,
        bounds=(middle - spread, middle + spread),
        method="bounded",
        options={"xatol": LOG_PRECISE},
    )
    return float(np.exp(found.x))


def uncertainty(
    time: Array, values: Array, T: float, offset: Array, digits: Array, sigma: Array
) -> float:
    """Return by how much T may be off, relative to T.

    `offset` bounds a smooth error of the values, `digits` one of any sign at each of them, and `sigma` are
    the standard deviations of a random one; all go through the linear least squares about the fit.
    """
    age = time - time[0]
    decay = np.exp(-age / T)
    basis = np.stack([np.ones_like(time), decay], axis=1)
    amplitude = np.linalg.lstsq(basis, values, rcond=None)[0][1]
    to_parameter = np.linalg.pinv(np.column_stack([basis, amplitude * decay * age / T]))[2]
    smooth = abs(to_parameter @ offset) + abs(to_parameter @ (offset * age / age[-1]))
    rough = np.abs(to_parameter) @ digits + SURE * np.linalg.norm(sigma * to_parameter)
    return float(smooth + rough)
