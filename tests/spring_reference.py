"""Reference solutions of the transient on a spring, by two methods that share no code with the package.

`python -m tests.spring_reference` writes the table by `tests.transient_history`, with the change from a
coarser to a finer solution as the error of each value, and the places of the elements beside it; it takes a
few minutes.
"""

import json
from pathlib import Path

import numpy as np

from tests.transient_history import Scene, history, jump
from tests.transient_reference import entry, extrapolated

TABLE = Path(__file__).parent / "data" / "spring_reference.json"
TOLERANCES = (1e-10, 1e-11)
LONGEST = 0.02
ELEMENTS = "damped", "stop", "fixed, stop", "stick-slip", "hop", "two hops"
"""Scenes in which elements confirm the history, memory and flights among them."""
SPACINGS = 0.004, 0.002, 0.001


def sprung(number, epsilon, spring, end=2.0, kappa=0.0):
    """Return a scene that is looked at eight times; a number is a start from rest."""
    drive = [(0.0, number)] if isinstance(number, float) else number
    times = tuple(np.linspace(0.0, end, 9)[1:].round(9).tolist())
    return Scene(drive, epsilon, times, kappa, *spring)


SCENES = {
    "table 1, 91 mm/s": sprung(3.7, 0.00306, (0.204, 0.0, 2.04), 8.0),
    "soft": sprung(4.0, 0.02, (0.5, 0.0, 0.1), 6.0),
    "stiff": sprung(2.0, 0.05, (0.2, 0.0, 60.0)),
    "damped": sprung(2.0, 0.05, (0.2, 0.4, 3.0), 3.0),
    "overdamped": sprung(1.0, 0.1, (0.05, 3.0, 1.0), 3.0),
    "slow": sprung(0.2, 0.03, (0.3, 0.0, 1.0), 4.0),
    "fast": sprung(20.0, 0.01, (0.3, 0.1, 4.0)),
    "heavy along x": sprung(3.0, 0.02, (10.0, 0.0, 1.0), 4.0),
    "light along x": sprung(3.0, 0.05, (0.01, 0.0, 2.0)),
    "heavy": sprung(2.0, 3.0, (1.0, 0.0, 3.0), 4.0),
    "suspended": sprung(3.0, 0.02, (0.3, 0.05, 2.0), 4.0, kappa=4.0),
    "fixed": sprung(2.0, None, (0.1, 0.0, 3.0), 3.0),
    "fixed, soft": sprung(6.0, None, (0.5, 0.0, 0.2), 4.0),
    "fixed, stop": sprung(jump(0.5, 4.0, 0.0), None, (0.05, 0.0, 5.0)),
    "backwards": sprung(-3.0, 0.02, (0.3, 0.0, 1.0), 4.0),
    "stop": sprung(jump(0.7, 5.0, 0.0), 0.02, (0.1, 0.0, 4.0)),
    "stop, soft": sprung(jump(1.0, 3.0, 0.0), 0.1, (0.5, 0.0, 1.0), 4.0),
    "reversal": sprung(jump(0.6, 3.0, -3.0), 0.05, (0.2, 0.1, 2.0)),
    "ramp": sprung([(0.0, 0.0), (1.0, 5.0)], 0.03, (0.2, 0.0, 3.0), 3.0),
    "to and fro": sprung(
        [(0.0, 0.0), (0.5, 2.0), (1.5, -2.0), (2.0, 0.0)], 0.05, (0.1, 0.0, 2.0), 3.0
    ),
    "stick-slip": sprung(1.5, 0.3, (0.05, 0.0, 0.3), 6.0),
    "hop": sprung(jump(0.3, 6.0, -6.0), 0.3, (0.3, 0.0, 8.0)),
    "oscillation": sprung(
        {"mean": 1.0, "amplitude": 2.0, "frequency": 6.0}, 0.05, (0.1, 0.05, 1.0)
    ),
    "two hops": sprung(jump(0.5, 10.0, 0.0), 0.5, (0.02, 0.0, 2.0)),
}


if __name__ == "__main__":
    table = {}
    for name, scene in SCENES.items():
        coarse, fine = (history(scene, tolerance, LONGEST) for tolerance in TOLERANCES)
        table[name] = entry(scene, "history", coarse, fine)
        if name in ELEMENTS:
            values, errors = extrapolated(scene, SPACINGS, ("d", "x"))
            table[name]["elements"] = {"values": values.tolist(), "errors": errors.tolist()}
    TABLE.write_text(json.dumps(table, indent=1) + "\n")
