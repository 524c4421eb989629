"""The load of the elastic contact at rest, from a table, for arrays of depths, thicknesses and ratios.

With a = sqrt(2 R depth), S = 2 (1 - nu^2)/E_0 and h = H/a, a parabola carries W = (depth/S) f(h, nu) on a
layer, and a ball W = (depth a/S) g(h, nu). The logarithms of f and g, without
how they depend on nu on a thin layer, are splines over ln h and over

    share = (1 - 2 nu)(1 + c)/(1 - 2 nu + c),   c = h^2/(1 + h^2),

which is 1 at nu = 0 and 0 at nu = 1/2, and resolves how a thin layer becomes incompressible. The table is
written by `tests/layer_rest_table.py`, by boundary elements.
"""

import json
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline

Array = NDArray[np.float64]

RELATIVE_ERROR = 2e-3
"""Of a load from the table: more than twice the largest found between its entries, near H = 0.15 a."""


@cache
def _splines() -> dict[str, Any]:
    table = json.loads((Path(__file__).parent / "rest.json").read_text())
    axes = np.array(table["log_thickness"]), np.array(table["share"])
    ratios = poisson_ratio(np.exp(axes[0])[:, None], axes[1])
    splines: dict[str, Any] = {
        name: RectBivariateSpline(*axes, table[name] + _log_thin(np.exp(axes[0])[:, None], ratios))
        for name in ("line", "ball")
    }
    return splines | {"range": axes[0][[0, -1]]}


def _log_thin(thickness: Any, poisson_ratio: Any) -> Any:
    """Return log[(1 - 2 nu + c)/(1 - nu)^2], which takes most of nu out of the load of a thin layer."""
    c = thickness**2 / (1.0 + thickness**2)
    return np.log((1.0 - 2.0 * poisson_ratio + c) / (1.0 - poisson_ratio) ** 2)


def _share(thickness: Any, poisson_ratio: Any) -> Any:
    """Return the share of a layer of h = H/a."""
    c, free = thickness**2 / (1.0 + thickness**2), 1.0 - 2.0 * poisson_ratio
    return free * (1.0 + c) / (free + c)


def poisson_ratio(thickness: Any, share: Any) -> Any:
    """Return Poisson's ratio of a layer of h = H/a and a share."""
    c = thickness**2 / (1.0 + thickness**2)
    return np.clip(0.5 * (1.0 - share * c / (1.0 + c - share)), 0.0, 0.5)


def load_at_rest(
    depth: Any, radius: Any, modulus: Any, thickness: Any, poisson_ratio: Any, *, per_width: bool
) -> Array:
    """Return the load of a parabola (`per_width`, N/m) or a ball (N) at rest at a depth, in SI.

    The relative error is below `RELATIVE_ERROR`. Raises ValueError where H/a is outside the table, from 0.1
    to 100; that of a ball on a half-space, `thickness` inf, is Hertz's.

    >>> load_at_rest(1e-4, 0.01, 1e6, np.array([1e-3, np.inf]), 0.3, per_width=False).round(4)
    array([0.4278, 0.1465])
    """
    splines = _splines()
    a = np.sqrt(2.0 * radius * depth)
    h, nu = np.broadcast_arrays(np.asarray(thickness, dtype=float) / a, poisson_ratio)
    low, high = np.exp(splines["range"])
    space = np.isinf(h) & (not per_width)
    if np.any(~space & ((h < low * (1 - 1e-9)) | (h > high * (1 + 1e-9)))):
        raise ValueError(f"thickness over half length: expected from {low:.3g} to {high:.3g}")
    finite = np.where(space, 1.0, h)
    spline = splines["line" if per_width else "ball"]
    found = np.exp(spline.ev(np.log(finite), _share(finite, nu)) - _log_thin(finite, nu))
    found = np.where(space, 4.0 * math.sqrt(2.0) / 3.0, found)
    return found * depth * (1.0 if per_width else a) * modulus / (2.0 * (1.0 - nu**2))
