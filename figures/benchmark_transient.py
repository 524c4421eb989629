"""Speed of the transient of Table 1 at equal achieved error, side by side with LSODA: `make benchmark`.

Every method sweeps its own tolerance. The error is the largest one of the depth at 400 times of the run,
in units of the static depth, against a solution at a tolerance of 1e-12 by SciPy's Radau, which shares no
code with the package. A time is the least of several runs in random order; at a target error it is that of
the fastest run which is at least as accurate. The peer is `solve_ivp(method="LSODA")` on the two-state
form, with closed-form edges, as a user would write it; with dense output, since the package gives one too.
"""

import math
import os
import random
import time
from collections.abc import Callable
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from scipy.integrate import solve_ivp

from kvtheory.compilation import available
from kvtheory.models.continuum.solved_scene import scaled_drive
from kvtheory.models.continuum.solver import solve
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import StaticState

REPEATS = 15
TOLERANCES = tuple(10.0**-k for k in range(2, 13))
TARGETS = tuple(10.0**-k for k in range(4, 10))

SCENE = Scene()
DRIVE = scaled_drive(SCENE, StaticState.of(SCENE))
EPS, END, NUMBER = StaticState.of(SCENE).inertia_number, DRIVE.end, DRIVE.at(0.0)[1]
TIMES = np.linspace(0.0, END, 401)


def two_states(_: float, y: Any) -> tuple[float, float]:
    """Return d' and d'' with the leading edge on undisturbed ground and a peeling trailing edge."""
    d, v = y
    l, r = -math.sqrt(max(d, 0.0)), math.sqrt(max(d + v + NUMBER * NUMBER, 0.0)) - NUMBER
    f_z = 0.75 * ((d + v) * (r - l) - (r**3 - l**3) / 3.0 - NUMBER * (r * r - l * l))
    return v, (1.0 - f_z) / EPS


def peer(method: str, dense: bool, rtol: float) -> Any:
    """Solve by SciPy."""
    return solve_ivp(
        two_states, (0.0, END), (1.0, 0.0), method=method, rtol=max(rtol, 1e-13), atol=0.1 * rtol,
        dense_output=dense,
    )  # fmt: skip


def continuum(fast: bool, rtol: float) -> Any:
    """Solve by the package."""
    return solve(DRIVE, EPS, 0.0, END, rtol, fast=fast)


METHODS: dict[str, tuple[Callable[[float], Any], Callable[[Any], Any]]] = {
    "LSODA": (lambda rtol: peer("LSODA", True, rtol), lambda found: (TIMES, found.sol(TIMES)[0])),
    "LSODA without dense output": (
        lambda rtol: peer("LSODA", False, rtol),
        lambda found: (found.t, found.y[0]),
    ),
    "continuum, interpreted": (
        lambda rtol: continuum(False, rtol),
        lambda found: (TIMES, found.states(TIMES)["depth"]),
    ),
    "continuum, compiled": (
        lambda rtol: continuum(True, rtol),
        lambda found: (TIMES, found.states(TIMES)["depth"]),
    ),
}
"""How each is run, and the times and depths that are compared: at its own steps without dense output."""


def measured() -> dict[str, list[tuple[float, float]]]:
    """Return, for each method, the error and the least time at each tolerance."""
    truth = peer("Radau", True, 1e-12).sol
    names = [name for name in METHODS if "compiled" not in name or available()]
    jobs = [(name, rtol) for name in names for rtol in TOLERANCES]
    errors, seconds = {}, dict.fromkeys(jobs, math.inf)
    for name, rtol in jobs:  # not timed: the first calls import and compile
        times, depths = METHODS[name][1](METHODS[name][0](rtol))
        errors[name, rtol] = float(np.max(np.abs(depths - truth(times)[0])))
    for _ in range(REPEATS):
        random.Random(0).shuffle(jobs)
        for name, rtol in jobs:
            start = time.perf_counter()
            METHODS[name][0](rtol)
            seconds[name, rtol] = min(seconds[name, rtol], time.perf_counter() - start)
    return {
        name: [(errors[name, rtol], seconds[name, rtol]) for rtol in TOLERANCES] for name in names
    }


def main() -> None:
    """Measure, and print the time of each method for each target, and the ratio of LSODA's time to it."""
    found = measured()
    print("\nTransient of Table 1: microseconds for an error of the depth (times slower: LSODA)\n")
    print(f"{'method':30}" + "".join(f"{target:>16.0e}" for target in TARGETS))
    best = {
        name: [min((t for e, t in runs if e <= target), default=math.nan) for target in TARGETS]
        for name, runs in found.items()
    }
    for name, times in best.items():
        cells = (
            f"{t * 1e6:.0f} ({peer_t / t:.1f})"
            for t, peer_t in zip(times, best["LSODA"], strict=True)
        )
        print(f"{name:30}" + "".join(f"{cell:>16}" for cell in cells))


if __name__ == "__main__":
    main()
