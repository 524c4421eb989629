"""Double-exponential rules, for floats and for columns of scenes.

A float is one scene; a column, of shape (n, 1), is n of them, and broadcasts with nodes along a row.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from kvtheory.results.errors import QuadratureError

Value = Any
"""A float, or a column of them."""
Quantities = tuple[dict[str, Value], dict[str, Value], dict[str, Value]]
"""Quantities over the stiffness, their relative errors at a depth, and d ln/d ln delta of each."""
OF_LINE = ("half_length", "leading_edge", "trailing_edge", "load", "friction_force",
           "peak_pressure", "dissipated_in_contact")  # fmt: skip
"""The quantities of a line contact."""
SUMS = "load", "friction_force", "friction_coefficient", "dissipated_in_contact"
"""Those that follow from sums over strips."""

SMALLEST = float(np.finfo(float).tiny)
ROUNDING = 5e-15
"""Relative rounding of an edge or of a formula, the shape function included."""

COARSEST, LEVELS, LAST = 0.125, 5, 3.3
"""Step of the first rule, number of rules (each halves the step), and t at which the weights vanish."""
SMOOTH = 10
"""Nodes of Gauss's rule for smooth functions, which then are series of Legendre polynomials."""
RTOL, LIMIT = 1e-14, 1e-6
"""Estimate above which the next rule is taken, and above which the last one is refused."""


def _rule(step: float) -> tuple[Any, Any]:
    """Return nodes from 0 to 1, weights for this step and twice it (doi:10.2977/prims/1195192451)."""
    count = 2 * int(0.5 * LAST / step)
    t = step * np.arange(-count, count + 1)
    decay = np.exp(-np.pi * np.sinh(t))
    nodes = 1.0 / (1.0 + decay)
    fine = step * np.pi * np.cosh(t) * nodes * decay / (1.0 + decay)
    return nodes, np.array((fine, np.where(np.arange(t.size) % 2 == 0, 2.0 * fine, 0.0)))


def _gauss() -> tuple[Any, Any]:
    """Return Gauss's rule likewise, and the same without the last two terms of the Legendre series."""
    nodes, weights = legendre.leggauss(SMOOTH)
    order = np.arange(SMOOTH - 2, SMOOTH)
    last = legendre.legvander(nodes, SMOOTH - 1)[:, -2:] @ (2.0 * order + 1.0)
    return 0.5 + 0.5 * nodes, 0.5 * weights * np.array((np.ones(SMOOTH), 1.0 - last))


RULES = (_gauss(), *(_rule(COARSEST / 2**level) for level in range(LEVELS)))
_SIDES = tuple((*np.kron(np.eye(2), nodes), weights) for nodes, weights in RULES)
"""Nodes of the left interval, padded with zeros; those of the right one; and weights."""


def integral(
    function: Callable[[Any], Any],
    ends: tuple[Value, Value],
    widths: tuple[Value, Value],
    smooth: bool = False,
) -> tuple[Value, Value]:
    """Return the sum of the means of a positive function from 0 to either end, times the widths.

    If it is smooth, analytic at both ends of each interval, Gauss's rule is tried first. Return also an
    estimate of the relative error: halving the step squares that of the trapezoidal rule for an analytic
    integrand (Trefethen and Weideman 2014, doi:10.1137/130932132); the power 3/2 leaves a margin.

    >>> value, error = integral(lambda x: x**0.5, (4.0, 1.0), (4.0, 1.0))
    >>> print(f"{value:.14g}", error < 1e-14)
    6 True
    """
    one, two = widths
    result, accuracy, active = 0.0, 0.0, one >= 0.0
    for to_left, to_right, weights in _SIDES if smooth else _SIDES[1:]:
        values = function(ends[0] * to_left + ends[1] * to_right)
        if values.ndim == 1:
            pairs = (values.reshape(2, -1) @ weights.T).tolist()
        else:  # unlike a product of matrices, this sums in one order for any number of rows
            rows = values.reshape(len(values), 2, -1)
            pairs = np.einsum("...j,kj->k...", rows, weights).transpose(2, 0, 1)[..., None]
        (left, left_coarse), (right, right_coarse) = pairs
        total = one * left + two * right
        apart = one * abs(left - left_coarse) + two * abs(right - right_coarse)
        error = (apart / total) ** 1.5
        result, accuracy = pick(active, total, result), pick(active, error, accuracy)
        active = active & (accuracy > RTOL)
        if not some(active):
            break
    if not largest(accuracy) < LIMIT:
        raise QuadratureError("quadrature of the shape fails: the indenter's reach is too close")
    return result, accuracy


def largest(values: Value) -> float:
    """Return the largest of a column, or the float; NaN if there is one."""
    return values if isinstance(values, float) else float(np.max(values))


def least(left: Value, right: Value) -> Value:
    """Return the lesser, element by element."""
    if isinstance(left, np.ndarray):
        return np.minimum(left, right)
    return left if left < right else right


def some(condition: Any) -> bool:
    """Return whether any element is true."""
    return bool(condition.any()) if isinstance(condition, np.ndarray) else condition


def pick(condition: Any, chosen: Value, other: Value) -> Value:
    """Return one of two values, element by element, so that no result depends on the other scenes."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, chosen, other)
    return chosen if condition else other


def share_lost(friction: Value, lost: Value) -> Value:
    """Return the share of the friction that is lost in the contact, 1 where there is no friction."""
    none = (friction == 0.0) * 1.0
    return (lost + none) / (friction + none)


def power_bounds(contact: Any) -> dict[str, float]:
    """Return d ln W/d ln delta, and upper bounds of other powers; mu changes no faster than the depth."""
    load = contact.depth * contact.load_slope / contact.load
    bounds = load, load + 1.0, 1.0, 1.0
    return dict(zip(SUMS, bounds, strict=True))
