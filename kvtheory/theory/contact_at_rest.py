"""The elastic contact at rest on a layer of any thickness, from a table: load, depth and energy, for arrays.

With a = sqrt(2 R depth), S = 2 (1 - nu^2)/E_0 and h = H/a, a parabola carries W = (depth/S) f(h, nu) on a
layer, and a ball W = (depth a/S) g(h, nu). The logarithms of f and g, without
how they depend on nu on a thin layer, are splines over ln h and over

    share = (1 - 2 nu)(1 + c)/(1 - 2 nu + c),   c = h^2/(1 + h^2),

which is 1 at nu = 0 and 0 at nu = 1/2, and resolves how a thin layer becomes incompressible. The table is
written by `tests/layer_rest_table.py`, by boundary elements from h = 0.1 to 100, and by the next terms of the
limits from 0.001 to 10^6. Below, the thin limit holds to 1e-5; a ball above is on a half-space to 1e-6.
"""

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

HOME = Path(__file__).with_suffix(".json")
RELATIVE_ERROR = 2e-3
"""Of a load from the table: more than twice the largest found between its entries, near H = 0.15 a."""
HERTZ = 4.0 * math.sqrt(2.0) / 3.0
"""g on a half-space."""
FIRST_STEP, LAST_STEP, MOST_STEPS = 1e-3, 1e-9, 40
"""First and last relative step of a depth, and how many there are at most; six are usual."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)
"""For the energy, over the root of the depth, from 0 to 1: to 1e-5 of it."""


@cache
def splines() -> dict[str, Any]:
    """Return the knots over ln h and over the share, and the coefficients of cubic B-splines, by name."""
    return {name: np.array(values) for name, values in json.loads(HOME.read_text()).items()}


def _spline(name: str, x: Array, y: Array) -> Any:
    """Return the spline over ln h and the share."""
    held = splines()
    (i, row), (j, column) = _basis(held["log_thickness"], x), _basis(held["share"], y)
    c = held[name]
    return sum(
        p * sum(q * c[i + k, j + m] for m, q in enumerate(column)) for k, p in enumerate(row)
    )


def _basis(knots: Array, x: Array) -> tuple[Any, list[Any]]:
    """Return the place among the knots, and the four B-splines that are not zero there (de Boor, 1972)."""
    i = np.clip(np.searchsorted(knots, x, side="right") - 1, 3, len(knots) - 5)
    found: list[Any] = [1.0]
    for degree in range(1, 4):
        kept: Any = 0.0
        for r in range(degree):
            right, left = knots[i + r + 1] - x, x - knots[i + r + 1 - degree]
            part = found[r] / (right + left)
            found[r], kept = kept + right * part, left * part
        found.append(kept)
    return i - 3, found


def log_thin(thickness: Any, poisson_ratio: Any) -> Any:
    """Return log[(1 - 2 nu + c)/(1 - nu)^2], which takes most of nu out of the load of a thin layer."""
    c = _c(thickness)
    return np.log((1.0 - 2.0 * poisson_ratio + c) / (1.0 - poisson_ratio) ** 2)


def _c(thickness: Any) -> Any:
    return 1.0 / (1.0 + 1.0 / thickness**2)


def _share(thickness: Any, poisson_ratio: Any) -> Any:
    """Return the share of a layer of h = H/a."""
    c, free = _c(thickness), 1.0 - 2.0 * poisson_ratio
    return free * (1.0 + c) / (free + c)


def poisson_ratio(thickness: Any, share: Any) -> Any:
    """Return Poisson's ratio of a layer of h = H/a and a share."""
    c = _c(thickness)
    return np.clip(0.5 * (1.0 - share * c / (1.0 + c - share)), 0.0, 0.5)


def load_at_rest(
    depth: Any, radius: Any, modulus: Any, thickness: Any, poisson_ratio: Any, *, per_width: bool
) -> Array:
    """Return the load of a parabola (`per_width`, N/m) or a ball (N) at rest at a depth, in SI.

    The relative error is below `RELATIVE_ERROR`. A `thickness` of inf is a half-space, on which the load of a
    ball is Hertz's; a half-plane has no depth. Raises ValueError for a line contact above 10^6 half lengths.

    >>> load_at_rest(1e-4, 0.01, 1e6, np.array([1e-3, np.inf]), 0.3, per_width=False).round(4)
    array([0.4278, 0.1465])
    """
    _require_depth(depth, radius, thickness, per_width=per_width)
    a = np.sqrt(2.0 * radius * np.asarray(depth, dtype=float))
    h, nu = np.broadcast_arrays(thickness / a, poisson_ratio)
    return _loads(depth, a, modulus, h, nu, per_width=per_width)


def _require_depth(depth: Any, radius: Any, thickness: Any, *, per_width: bool) -> None:
    """Raise ValueError for a line contact on so thick a layer that its depth is not known."""
    a = np.sqrt(2.0 * radius * np.asarray(depth, dtype=float))
    most = math.exp(splines()["log_thickness"][-1])
    if per_width and np.any(thickness / a > most):
        raise ValueError(f"expected at most {most:.3g} half lengths, {most * np.min(a):.3g} m")


def _loads(
    depth: Any, a: Any, modulus: Any, h: Array, poisson_ratio: Array, *, per_width: bool
) -> Array:
    """Return the load; beyond the table f and g go on as its last entries do."""
    y, nu = np.log(h), poisson_ratio
    within = np.clip(y, *splines()["log_thickness"][[0, -1]])
    thinner = np.minimum(y - within, 0.0)  # of a thin layer the load is as 1/h
    h = np.exp(within + thinner)
    found = _spline("line" if per_width else "ball", within, _share(h, nu))
    found = found - thinner - log_thin(h, nu)
    return np.exp(found) * depth * (1.0 if per_width else a) * modulus / (2.0 * (1.0 - nu**2))


def depth_at_rest(
    load: Any, radius: Any, modulus: Any, thickness: Any, poisson_ratio: Any, *, per_width: bool,
    spring: Any = 0.0,
) -> Array:  # fmt: skip
    """Return the depth (m) at which a parabola or a ball at rest carries a load; see `load_at_rest`.

    A `spring` carries its stiffness times the depth of it.

    >>> round(float(depth_at_rest(0.4278, 0.01, 1e6, 1e-3, 0.3, per_width=False)), 7)
    0.0001
    """
    load, H, nu, R, E = np.broadcast_arrays(load, thickness, poisson_ratio, radius, modulus)

    def excess(x: Any) -> Any:
        depth = np.exp(x)
        a = np.sqrt(2.0 * R * depth)
        carried = _loads(depth, a, E, H / a, nu, per_width=per_width) + spring * depth
        return np.log(carried / load)

    S = 2.0 * (1.0 - nu**2) / E
    x = np.log(load * S if per_width else (load * S / HERTZ) ** (2.0 / 3.0) / np.cbrt(2.0 * R))
    off = excess(x)
    slope, active = (excess(x + FIRST_STEP) - off) / FIRST_STEP, np.isfinite(off)
    for _ in range(MOST_STEPS):  # by secants, each depth final after a short enough step
        step = np.where(active, off / slope, 0.0)
        x, last, active = x - step, off, active & (np.abs(step) > LAST_STEP)
        if not np.any(active):
            break
        off = excess(x)
        slope = np.where(active, (last - off) / np.where(active, step, 1.0), slope)
    depth = np.exp(x)
    _require_depth(depth, R, H, per_width=per_width)
    return depth


def energy_at_rest(depth: Any, *layer: Any, per_width: bool) -> Array:
    """Return the elastic energy, int W d(depth), in J/m or J, of a contact at rest; see `load_at_rest`.

    >>> W = load_at_rest(1e-4, 0.01, 1e6, np.inf, 0.3, per_width=False)
    >>> round(float(energy_at_rest(1e-4, 0.01, 1e6, np.inf, 0.3, per_width=False) / W / 1e-4), 6)
    0.4
    """
    root = 0.5 * (1.0 + NODES)  # depth = root^2 of the whole
    rows = np.broadcast_arrays(depth, *layer)
    most, R, E, H, nu = (np.asarray(each, dtype=float)[..., None] for each in rows)
    _require_depth(most, R, H, per_width=per_width)
    shallow = most * root * root
    a = np.sqrt(2.0 * R * shallow)
    loads = _loads(shallow, a, E, H / a, nu, per_width=per_width)
    return np.einsum("...i,i->...", loads, WEIGHTS * root) * np.asarray(depth)
