"""Speed of the discrete simulator, measured side by side in one run: `make benchmark`.

Ratios to a plain C loop over the same elements by the paper's scheme (`paper_scheme.c`), compiled on the spot
where there is a compiler; and of balls, arms and springs to a row of Kelvin-Voigt elements on a rigid drive.
Times are the least of several in random order, in one process, after one call each.
"""

import ctypes
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import kvtheory as kv
from kvtheory.models.elements import row

REPEATS = 5
END = 0.2
"""Of Table 1, in s."""
DENSITIES = (200, 800)
"""Elements per mm."""
BALL = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
FIVE: Any = [(3e10, 10.0**-k) for k in range(5)]
ARMS = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=FIVE))
SPRING = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e6))


def c_loop() -> Callable[[int], float] | None:
    """Return the C loop over Table 1, which returns the depth at its end; None without a compiler."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        return None
    source = Path(__file__).with_name("paper_scheme.c")
    with tempfile.TemporaryDirectory() as folder:
        library = f"{folder}/paper_scheme.so"
        command = [compiler, "-O3", "-shared", "-fPIC", str(source), "-o", library, "-lm"]
        subprocess.run(command, check=True)
        run = ctypes.CDLL(library).run
    run.restype, run.argtypes = ctypes.c_double, [ctypes.c_double] * 8 + [ctypes.c_long]
    scene: Any = kv.Scene()
    R, K, tau = scene.indenter.radius, scene.foundation.stiffness, scene.foundation.retardation_time
    M, W, V = scene.support.mass, scene.support.weight, scene.drive.velocity
    depth = float(kv.transient(at=0.0).depth[0])

    def loop(density: int) -> float:
        steps = round(END * V * density * 1e3 / 2.0)
        return float(run(R, K, tau, M, W, V, 1e-3 / density, depth, steps))

    return loop


def least(calls: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Return the least time of each call in s, taken in random order after one call each."""
    for call in calls.values():
        call()
    order = [name for name in calls for _ in range(REPEATS)]
    random.Random(0).shuffle(order)
    found = dict.fromkeys(calls, np.inf)
    for name in order:
        start = time.perf_counter()
        calls[name]()
        found[name] = min(found[name], time.perf_counter() - start)
    return found


def main() -> None:
    """Measure, and print one line for each ratio."""
    if "--interpreted" in sys.argv:
        row.WORTHWHILE = sys.maxsize
    else:
        row.Tally.steps = row.WORTHWHILE
    start = time.process_time()
    kv.elements(certify=False, at=END)
    print(f"first call, with compiling and loading: {time.process_time() - start:.1f} s of CPU\n")
    table = partial(kv.elements, certify=False)
    calls: dict[str, Callable[[], object]] = {
        **{f"Table 1, {n} per mm": partial(table, per_length=1e3 * n) for n in DENSITIES},
        "Table 1, 200 per mm, paper": partial(table, scheme="paper"),
        "ball, 200 per mm, certified": partial(kv.elements, BALL),
        "five arms, 200 per mm": partial(table, ARMS),
        "spring, 200 per mm": partial(table, SPRING),
    }
    loop = c_loop()
    if loop is not None:
        calls |= {f"C loop, {n} per mm": partial(loop, n) for n in DENSITIES}
    seconds = least(calls)
    for name, each in seconds.items():
        print(f"{name:32}{each * 1e3:10.1f} ms")
    one = seconds["Table 1, 200 per mm"]
    steps = {name: float(getattr(calls[name](), "steps", np.nan)) for name in seconds}
    print()
    for name in ("five arms, 200 per mm", "spring, 200 per mm"):
        ratio = seconds[name] / one
        each = ratio * steps["Table 1, 200 per mm"] / steps[name]
        print(f"{name:32}{ratio:10.2f} times one row on a rigid drive, {each:.2f} for each step")
    if loop is None:
        print("no C compiler: no ratio to a C loop")
        return
    truth = float(kv.transient(at=END, rtol=1e-10).depth[0])
    for n in DENSITIES:
        ratio = seconds[f"Table 1, {n} per mm"] / seconds[f"C loop, {n} per mm"]
        ours = float(table(per_length=1e3 * n, at=END).depth[0])
        errors = [abs(depth / truth - 1.0) for depth in (loop(n), ours)]
        print(f"Table 1, {n} per mm{ratio:22.2f} times the C loop; "
              f"errors of the depth {errors[0]:.1e} (C), {errors[1]:.1e} (ours)")  # fmt: skip
    ratio = seconds["ball, 200 per mm, certified"] / seconds["C loop, 200 per mm"]
    print(f"{'ball, 200 per mm, certified':32}{ratio:10.1f} times the C loop of a line contact")


if __name__ == "__main__":
    main()
