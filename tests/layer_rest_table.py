"""Writes `kvtheory/layer/rest.json`: python -m tests.layer_rest_table, a few minutes.

Every entry is the elastic contact at rest by boundary elements, extrapolated from two grids.
"""

import json
from pathlib import Path

import numpy as np

from kvtheory.layer import Body, Support
from kvtheory.layer.rest import poisson_ratio
from kvtheory.layer.sliding import levels
from kvtheory.scene.indenters import Parabola, Sphere

THICKNESS = np.exp(np.linspace(np.log(0.1), np.log(100.0), 25))
SHARES = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, 12))
CELLS = {True: 120, False: 50}


def entry(shape, thickness, share):
    """Load for S = 1, R = 1/2 and a = depth = 1; of second order in the cells."""
    nu = float(poisson_ratio(thickness, share))
    body = Body.of_series(2.0 * (1.0 - nu**2), float(thickness), nu, [(1.0, 1.0)])
    loads = []
    for found in levels(shape, body, 0.0, Support(depth=1.0)):
        loads.append(found.values(shape, body, 0.0)["load"])
        if np.count_nonzero(found.contact.active.any(axis=1)) > CELLS[shape.per_width] * (
            1.0 + 0.2 / thickness
        ):
            return (4.0 * loads[-1] - loads[-2]) / 3.0
    raise AssertionError("no grid is fine enough")


def table():
    found = {"log_thickness": np.log(THICKNESS).tolist(), "share": SHARES.tolist()}
    for name, shape in (("line", Parabola(radius=0.5)), ("ball", Sphere(radius=0.5))):
        loads = [[entry(shape, H, y) for y in SHARES] for H in THICKNESS]
        found[name] = np.log(loads).round(6).tolist()
    return found


if __name__ == "__main__":
    home = Path(__file__).parent.parent / "kvtheory" / "layer" / "rest.json"
    home.write_text(json.dumps(table()) + "\n")
