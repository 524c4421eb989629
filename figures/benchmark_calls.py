"""Overhead of public calls, measured side by side in one run: `make benchmark`.

Each row is the time of a call over that of its core: the bare kernels, the formula that was
chosen, NumPy's own import. Times are the least of several in random order, in one process; commands
are whole processes on a warm disk.
"""

import math
import os
import random
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import kvtheory as kv
from kvtheory.models.continuum import compiled, solver
from kvtheory.models.continuum.solved_scene import scaled_drive
from kvtheory.models.steady import asymptote_bounds
from kvtheory.results import STEADY_UNITS
from kvtheory.scene.static_state import StaticState

REPEATS = 15
SWEPT = 4_000
"""Transients of the sweep that is timed."""
COMMANDS = {
    "import numpy": ["-c", "import numpy"],
    "import kvtheory": ["-c", "import kvtheory"],
    "kvtheory steady": ["-m", "kvtheory", "steady"],
    "kvtheory transient": ["-m", "kvtheory", "transient"],
    "kvtheory elements": ["-m", "kvtheory", "elements"],
}


def least(calls: dict[str, Callable[[], Any]], repeats: int = REPEATS) -> dict[str, float]:
    """Return the least time of each call in s, taken in random order after one call each."""
    order = [name for name in calls for _ in range(repeats)]
    random.Random(0).shuffle(order)
    for call in calls.values():
        call()
    found = dict.fromkeys(calls, np.inf)
    for name in order:
        start = time.perf_counter()
        calls[name]()
        found[name] = min(found[name], time.perf_counter() - start)
    return found


def transient() -> None:
    """Compare a certified transient, compiled, with its kernel runs."""
    scene, at_rest = kv.Scene(), StaticState.of(kv.Scene())
    drive = scaled_drive(scene, at_rest)
    numbers = at_rest.inertia_number, at_rest.support_number

    def kernel() -> None:
        solver.solve(drive, *numbers, drive.end, 1e-6, fast=True)

    compiled.KERNEL.spent = math.inf
    found = least({
        "kernel run": kernel,
        "kv.transient, certified": lambda: kv.transient(scene),
        "kv.transient, certify=False": lambda: kv.transient(scene, certify=False),
    })  # fmt: skip
    print("\nTransient of Table 1, compiled; a certified one needs a second, tighter kernel run")
    for name, seconds in found.items():
        ratio = seconds / found["kernel run"]
        print(f"{name:34}{1e6 * seconds:10.0f} us{ratio:8.2f} kernel runs")
    over = {"support.mass": np.geomspace(100.0, 10_000.0, SWEPT)}
    asked = ["settling_time", "peak_to_steady_friction", "hops", "depth.end"]
    kv.sweep(over={"support.mass": [500.0, 1000.0]}, quantities=asked)
    start = time.perf_counter()
    kv.sweep(over=over, quantities=asked)
    each = (time.perf_counter() - start) / SWEPT
    name, runs_each = f"each of a sweep of {SWEPT}", each / found["kernel run"]
    print(f"{name:34}{1e6 * each:10.0f} us{runs_each:8.2f} kernel runs")


def chooser() -> None:
    """Compare the time to choose an asymptote with that of its formula."""
    slowly = kv.Scene(drive=kv.Drive(velocity=1e-3))
    print("\nTime of `solve` over that of the formula that it chooses (asymptote)")
    for names in (("friction_coefficient",), tuple(STEADY_UNITS)):
        found = least({
            "choice": partial(_choice, slowly, names),
            "formula": partial(asymptote_bounds.values, slowly, "low", names),
        }, 400)  # fmt: skip
        print(f"{len(names):3d} quantities{found['choice'] / found['formula']:22.2f}")


def _choice(scene: kv.Scene, names: tuple[str, ...]) -> Any:
    return asymptote_bounds.choose(asymptote_bounds.enclosure_of(scene), names, 0.1)


def compare() -> None:
    """Time a comparison that agrees, and one with a wrong stiffness."""
    right = kv.transient(at=[i * 5e-4 for i in range(400)])
    stiff = kv.Scene(foundation=kv.Foundation(stiffness=10.8e9, retardation_time=0.1))
    wrong = kv.transient(stiff, at=[i * 5e-4 for i in range(400)])
    found = least({
        "our own simulation, agrees": kv.compare,
        "data that agree": lambda: kv.compare(data=right),
        "data with K 8 % off": lambda: kv.compare(data=wrong),
    }, 3)  # fmt: skip
    print("\n`compare` on Table 1")
    for name, seconds in found.items():
        print(f"{name:34}{seconds:10.2f} s")


def commands() -> None:
    """Time whole processes, imports included."""
    found = least({name: partial(_process, words) for name, words in COMMANDS.items()}, 5)
    print("\nWhole processes, warm disk")
    for name, seconds in found.items():
        print(f"{name:34}{seconds:10.2f} s{seconds / found['import numpy']:8.1f} x import numpy")


def _process(words: Sequence[str]) -> None:
    root = Path(__file__).parents[1]
    subprocess.run([sys.executable, *words], check=True, capture_output=True, cwd=root)


PARTS: Sequence[Callable[[], None]] = (transient, chooser, compare, commands)

if __name__ == "__main__":
    for part in PARTS:
        part()
