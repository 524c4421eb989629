"""Writes `kvtheory/theory/contact_at_rest.json`: python -m tests.layer_rest_table, a few minutes.

The entries from 0.1 to 100 half lengths are elastic contacts at rest by boundary elements, extrapolated from
two grids. Those beyond are limits: of a thin layer p - L^2 div grad p = K w, the first two terms of its
compliance, with what is left of the order h^2; of a thick one a half-plane or half-space, with a correction
that falls as 1/h or does not change. Both corrections are those at the last entry.
"""

import json
import math

import mpmath as mp
import numpy as np
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import brentq

from kvtheory.layer.body import Body, Support
from kvtheory.layer.sliding import levels
from kvtheory.scene.indenters import Parabola, Sphere
from kvtheory.theory.contact_at_rest import HOME, log_thin, poisson_ratio

THICKNESS = np.exp(np.linspace(np.log(0.1), np.log(100.0), 25))
THIN = np.exp(np.linspace(np.log(0.001), np.log(0.1), 17))[:-1]
THICK = np.exp(np.linspace(np.log(100.0), np.log(1e6), 17))[1:]
SHARES = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, 12))
CELLS = {"line": 120, "ball": 50}
SHAPES = {"line": Parabola(radius=0.5), "ball": Sphere(radius=0.5)}
HERTZ = 4.0 * math.sqrt(2.0) / 3.0
NEARLY = 1e-12
"""What is left of 1 - 2 nu where it is taken as zero."""


def entry(name, thickness, share):
    """Load for S = 1, R = 1/2 and a = depth = 1; of second order in the cells."""
    shape, nu = SHAPES[name], float(poisson_ratio(thickness, share))
    body = Body.of_series(2.0 * (1.0 - nu**2), float(thickness), nu, [(1.0, 1.0)])
    loads = []
    for found in levels(shape, body, 0.0, Support(depth=1.0)):
        loads.append(found.values(shape, body, 0.0)["load"])
        cells = np.count_nonzero(found.contact.active.any(axis=1))
        if cells > CELLS[name] * (1.0 + 0.2 / thickness):
            return (4.0 * loads[-1] - loads[-2]) / 3.0
    raise AssertionError("no grid is fine enough")


def thin(name, thickness, share):
    """The same in the limit of a thin layer: p and its slope vanish at the edge b."""
    h, ball = thickness, name == "ball"
    c = h**2 / (1.0 + h**2)
    free = max(share * c / (1.0 + c - share), NEARLY)
    nu = 0.5 - 0.5 * free
    K = 2.0 * (1.0 - nu) ** 2 / (free * h)
    square = nu * (4.0 * nu - 1.0) / (3.0 * (1.0 - nu)) * h**2 / free  # L^2
    if square <= 0.0:
        return K * (math.pi / 2 * (1.0 - 4.0 * square) if ball else 4 / 3 * (1.0 - 1.5 * square))
    with mp.workdps(40):
        L = mp.sqrt(square)

        def excess(b):
            x = b / L
            decay = mp.besseli(0, x) / mp.besseli(1, x) if ball else mp.coth(x)
            return b * b / 2 - L * b * decay - mp.mpf(1) / 2 + (2 if ball else 1) * square

        b = mp.findroot(excess, (1, 4), solver="anderson", tol=1e-30)
        return float(K * (mp.pi / 2 * b**2 * (2 - b**2) if ball else 2 * (b - b**3 / 3)))


def thick(name, thickness, last):
    """The same of a thick layer, from the load at the last entry."""
    if name == "ball":
        return HERTZ * (1.0 + (last / HERTZ - 1.0) * THICKNESS[-1] / thickness)

    def shift(load, h):  # in 1 = load/(2 pi) (2 ln h - ln(load/pi) + shift)
        return 2.0 * math.pi / load - 2.0 * math.log(h) + math.log(load / math.pi)

    return brentq(lambda load: shift(load, thickness) - shift(last, THICKNESS[-1]), 1e-3, 10.0)


def table(loads):
    """Return knots and coefficients of the splines from the loads of the entries, by name."""
    axis, found = np.concatenate([THIN, THICKNESS, THICK]), {}
    without = log_thin(axis[:, None], poisson_ratio(axis[:, None], SHARES))
    for name, own in loads.items():
        h = THICKNESS[0]
        left = own[0] / [thin(name, h, y) for y in SHARES] - 1.0
        first = [
            [thin(name, H, y) * (1.0 + e * (H / h) ** 2) for y, e in zip(SHARES, left, strict=True)]
            for H in THIN
        ]
        last = [[thick(name, H, load) for load in own[-1]] for H in THICK]
        values = np.log(np.vstack([first, own, last])) + without
        *knots, c = RectBivariateSpline(np.log(axis), SHARES, values).tck
        found |= {"log_thickness": knots[0].tolist(), "share": knots[1].tolist()}
        found[name] = c.reshape(len(axis), -1).round(8).tolist()
    return found


if __name__ == "__main__":
    computed = {
        name: np.array([[entry(name, H, y) for y in SHARES] for H in THICKNESS]) for name in SHAPES
    }
    HOME.write_text(json.dumps(table(computed)) + "\n")
