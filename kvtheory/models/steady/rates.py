"""The rates at which small disturbances of steady sliding grow or decay: roots of real polynomials.

Quadratic for a rigid drive (theorem F12), quartic with a spring in it (theorem F22).
"""

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady.stability import ROUNDING, Numbers

Array = NDArray[np.float64]

POLISHES = 3
"""Newton steps after the eigenvalues of the companion matrix, which lose digits of the slow rates."""


def rates(
    given: Numbers, tau: Array, stiffness: Array | None = None
) -> tuple[NDArray[np.complex128], Array]:
    """Return the rates in 1/s along a new last axis, fastest growth first, and their relative errors.

    Without a stiffness of the spring, in N/m^2, the drive is rigid.
    """
    T_z, T_x, S_z, _, _, h, e, unit = given
    of_e = S_z + given.g * given.S_c  # what e is the small difference of
    terms: tuple[Array, ...]
    sizes: tuple[Array, ...]
    if stiffness is None:
        terms = sizes = (S_z, np.ones_like(T_z), T_z)
    else:
        S_x = stiffness / unit
        terms = (S_z * S_x, S_x + e, T_z * S_x + h + S_z * T_x, T_z + T_x, T_z * T_x)
        sizes = (terms[0], S_x + of_e, *terms[2:])
    if np.all(np.isinf(S_z)):  # held at its depth
        terms = sizes = () if stiffness is None else (S_x, np.ones_like(T_x), T_x)
    if not terms:
        return np.empty((*T_x.shape, 0), complex), np.empty((*T_x.shape, 0))
    found, error = roots(
        *(np.stack(np.broadcast_arrays(*each), axis=-1) for each in (terms, sizes))
    )
    return found / tau[..., np.newaxis], error


def roots(coefficients: Array, sizes: Array) -> tuple[NDArray[np.complex128], Array]:
    """Return the roots of polynomials, from the constant coefficient on, and their relative errors.

    `sizes` are those of the terms of which each coefficient is a sum. A polynomial of degree n has a
    root within n |P/P'| of any number; the rounding of P is added to |P|.
    """
    degree = coefficients.shape[-1] - 1
    unit = (coefficients[..., :1] / coefficients[..., -1:]) ** (1.0 / degree)  # of the mean root
    powers = unit ** np.arange(degree + 1)
    scaled, bounds = (each * powers for each in (coefficients, sizes))
    largest = np.max(bounds, axis=-1, keepdims=True)
    scaled, bounds = scaled / largest, bounds / largest
    companion = np.zeros((*scaled.shape[:-1], degree, degree))
    companion[..., range(1, degree), range(degree - 1)] = 1.0
    companion[..., -1] = -scaled[..., :-1] / scaled[..., -1:]
    found = np.linalg.eigvals(companion).astype(complex)
    for _ in range(POLISHES):
        value, slope = _horner(scaled, found)
        step = np.divide(value, slope, out=np.zeros_like(found), where=slope != 0.0)
        better = np.abs(_horner(scaled, found - step)[0]) < np.abs(value)
        found = np.where(better, found - step, found)
    value, slope = map(np.abs, _horner(scaled, found))
    value = value + ROUNDING * np.abs(_horner(bounds, np.abs(found))[0])
    with np.errstate(divide="ignore", over="ignore"):  # of a double root nothing is known
        error = degree * value / (slope * np.abs(found))
    order = np.lexsort((found.imag, -found.real))
    found, error = (np.take_along_axis(each, order, axis=-1) for each in (found, error))
    return found * unit, error


def _horner(coefficients: Array, places: NDArray) -> tuple[NDArray, NDArray]:
    """Return the values and derivatives of polynomials at given points, along the last axis."""
    value = np.zeros_like(places)
    slope = np.zeros_like(places)
    for each in np.moveaxis(coefficients, -1, 0)[::-1]:
        slope = slope * places + value
        value = value * places + each[..., np.newaxis]
    return value, slope
