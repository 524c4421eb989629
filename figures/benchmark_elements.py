"""Speed of the discrete simulator, measured side by side in one run: `make benchmark`.

Ratios to a plain C loop over the same elements by the paper's scheme (`paper_scheme.c`), compiled on the spot
where there is a compiler, with as many elements and at the same error; and of balls, arms and springs to a
row of Kelvin-Voigt elements on a rigid drive. Times are those of the processor, the least of several in
random order, in one process, after one call each.
"""

import math
import os
import random
import sys
import time
from collections.abc import Callable
from functools import partial
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import kvtheory as kv
from figures.paper_scheme import compiled_loop
from kvtheory import compilation
from kvtheory.models.elements import row

REPEATS = 5
END = 0.2
"""Of Table 1, in s."""
DENSITIES = (200, 800)
COARSE = (5, 10, 20, 40, 80)
"""Elements per mm."""
BALL = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
FIVE: Any = [(3e10, 10.0**-k) for k in range(5)]
ARMS = kv.Scene(foundation=kv.GeneralizedMaxwell(1e10, arms=FIVE))
SPRING = kv.Scene(drive=kv.Drive(velocity=0.1, stiffness=1e6))


def least(calls: dict[str, Callable[[], object]]) -> dict[str, float]:
    """Return the least time of each call in s, taken in random order after one call each."""
    for call in calls.values():
        call()
    order = [name for name in calls for _ in range(REPEATS)]
    random.Random(0).shuffle(order)
    found = dict.fromkeys(calls, np.inf)
    for name in order:
        start = time.process_time()
        calls[name]()
        found[name] = min(found[name], time.process_time() - start)
    return found


def main() -> None:
    """Measure, and print one line for each ratio."""
    if "--interpreted" in sys.argv:
        row.KERNEL.seconds = compilation.LOADING = math.inf
    else:
        row.KERNEL.spent = math.inf
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
    loop = compiled_loop()
    if loop is not None:
        calls |= {f"C loop, {n} per mm": partial(loop, kv.Scene(), 1e3 * n, END) for n in DENSITIES}
        calls |= {f"Table 1, {n} per mm": partial(table, per_length=1e3 * n) for n in COARSE}
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
    times = np.linspace(0.0, END, 201)
    truth = kv.transient(at=times, rtol=1e-10).depth

    def error(n: int) -> float:
        """Return the largest relative error of the depth."""
        return float(np.abs(table(per_length=1e3 * n, at=times).depth / truth - 1.0).max())

    for n in DENSITIES:
        instants, depths, *_ = loop(kv.Scene(), 1e3 * n, END)
        theirs = float(np.abs(np.interp(times, instants, depths) / truth - 1.0).max())
        seconds_in_c = seconds[f"C loop, {n} per mm"]
        fewest = next((k for k in COARSE if error(k) <= theirs), n)
        print(f"Table 1, {n} per mm: {seconds[f'Table 1, {n} per mm'] / seconds_in_c:.2f} times the C loop; "
              f"errors of the depth {error(n):.1e} and {theirs:.1e} (C). {fewest} per mm are as good as it: "
              f"{seconds[f'Table 1, {fewest} per mm'] / seconds_in_c:.3f} times the C loop")  # fmt: skip
    ratio = seconds["ball, 200 per mm, certified"] / seconds["C loop, 200 per mm"]
    print(f"{'ball, 200 per mm, certified':32}{ratio:10.1f} times the C loop of a line contact")


if __name__ == "__main__":
    main()
