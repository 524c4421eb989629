"""Prony series of measured moduli, held against pyvisco on its own sample data: `make benchmark`.

Both fit as many arms to the same master curves. pyvisco minimises absolute residuals, over the glassy
modulus; `kv.fit_foundation` relative ones. The misfit is the root mean square by either measure; by
pyvisco's measure the same method is given its scale. Times are processor seconds, the least of three calls;
ours without the bound on the misfit of any series, which pyvisco does not know.
"""

import contextlib
import io
import os
import time
import warnings
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from kvtheory.fitting import moduli
from kvtheory.fitting.spectrum import (
    BEYOND,
    PER_DECADE,
    Moduli,
    Series,
    arms_of,
    clustered,
    grid,
    solved,
)

DATA = Path(__file__).parents[1] / "docs" / "data" / "dma"
FILES = {"freq_user_master.csv": "freq", "time_user_master.csv": "time"}
ARMS = 5, 8, 12, 16, 20


def by_pyvisco(path: Path, domain: str, arms: int) -> tuple[Series, float]:
    """Return the series that pyvisco fits, with optimised times, and the seconds it takes."""
    from pyvisco import load, master, prony  # type: ignore[import-not-found]

    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        frame, _ = load.user_master(load.file(str(path)), domain, 0, "E")
        frame = master.smooth(frame, 1)
        found, seconds = timed(
            lambda: prony.fit(prony.discretize(frame, "min", arms), frame, opt=True)[0]
        )
    terms = found["df_terms"].sort_values("tau_i")
    glassy = 1e6 * found["E_0"]  # from MPa
    E = glassy * terms["alpha_i"].to_numpy()
    return Series(float(glassy - E.sum()), E, terms["tau_i"].to_numpy()), seconds


def by_us(data: Moduli, arms: int) -> tuple[Series, float]:
    """Return our series in the scale of the data, and the seconds it takes."""

    def fitted() -> Series:
        fresh = Moduli(data.x, data.values)
        vars(fresh)["scale"] = data.scale
        start = solved(fresh, grid(fresh, BEYOND, PER_DECADE))
        return arms_of(fresh, clustered(fresh, start), arms, 0.0)

    return timed(fitted)


def timed(run: Callable[[], Any]) -> tuple[Any, float]:
    """Return a result, and the least of the processor times of three runs in seconds."""
    seconds = []
    for _ in range(3):
        start = time.process_time()
        found = run()
        seconds.append(time.process_time() - start)
    return found, min(seconds)


def main() -> None:
    """Print a row for each number of arms."""
    if not find_spec("pyvisco"):
        print('This needs pyvisco: pip install ".[peers]" in the checkout')
        return
    print(f"{'':22}{'arms':>5}{'relative misfit':>24}{'absolute misfit':>24}{'seconds':>16}")
    print(f"{'':27}{'pyvisco':>14}{'kvtheory':>10}{'pyvisco':>14}{'kvtheory':>10}{'':>8}{'':>8}")
    for name, domain in FILES.items():
        relative = moduli.read(DATA / name).sweeps[0].moduli
        absolute = Moduli(relative.x, relative.values)
        vars(absolute)["scale"] = np.full_like(relative.values, relative.values.max())
        for arms in ARMS:
            theirs, their_time = by_pyvisco(DATA / name, domain, arms)
            close, own_time = by_us(relative, arms)
            even, _ = by_us(absolute, arms)
            tried = (relative, theirs), (relative, close), (absolute, theirs), (absolute, even)
            misfits = [series.misfit(data) for data, series in tried]
            pairs = f"{misfits[0]:14.4f}{misfits[1]:10.4f}{misfits[2]:14.5f}{misfits[3]:10.5f}"
            print(f"{name:22}{arms:5}{pairs}{their_time:8.2f}{own_time:8.2f}")


if __name__ == "__main__":
    main()
