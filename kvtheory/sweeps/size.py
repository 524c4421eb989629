"""The size of a sweep, announced before it begins; what cannot fit is refused."""

import math
import os
import shutil
from pathlib import Path

from kvtheory.progress import duration
from kvtheory.sweeps.plan import Plan

ON_ARRAYS, BY_QUADRATURE, IN_MOTION = 1e6, 1e5, 1e3
"""Scenes that a core solves in a second, within a factor of three: as measured for Table 1."""
DIGITS = 21
"""Bytes of the decimals of a number with a comma or an end of line."""
ANNOUNCED = 10.0
"""Seconds from which a sweep is announced."""


def seconds(plan: Plan, jobs: int = 1) -> float:
    """Return about how long a sweep takes."""
    slow = IN_MOTION if plan.transient else BY_QUADRATURE
    return plan.points / ((ON_ARRAYS if plan.vectorised else slow) * jobs)


def size(plan: Plan, path: Path | None) -> int:
    """Return about how many bytes a sweep needs: in memory, or in a file and its work file."""
    needed = plan.points * plan.blank(0).itemsize
    if path is None or path.suffix.lower() != ".csv":
        return 2 * needed
    rows = plan.points * (len(plan.times or ()) if plan.series else 1)
    keys = sum(len(axis.values) for axis in plan.axes) + plan.series
    return needed + rows * (len(plan.columns) + keys) * DIGITS


def announcement(plan: Plan, path: Path | None, jobs: int = 1) -> str:
    """Say how large a sweep is, if it takes a while."""
    if seconds(plan, jobs) < ANNOUNCED:
        return ""
    return f"{plan.points:,} points: {_about(size(plan, path), seconds(plan, jobs))}"


def refuse_what_cannot_fit(plan: Plan, path: Path | None, jobs: int = 1) -> None:
    """Raise `ValueError` if a sweep needs more than the memory or the disk holds."""
    needed = size(plan, path)
    if path is None:
        try:
            free = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
        except (AttributeError, OSError, ValueError):  # not every system tells
            free = math.inf
        where = "of memory; choose fewer points, or write to a file (`output`)"
    else:
        free = shutil.disk_usage(path.parent).free if path.parent.is_dir() else math.inf
        where = f'free beside "{path}"; choose fewer points'
    if needed > free:
        about = _about(needed, seconds(plan, jobs))
        raise ValueError(f"{plan.points:,} points need {about}; there are {_bytes(free)} {where}")


def _about(needed: float, time: float) -> str:
    return f"about {_bytes(needed)} and {duration(time)}"


def _bytes(number: float) -> str:
    for unit in ("bytes", "kB", "MB", "GB", "TB", "PB"):
        if number < 1000.0:
            return f"{number:.3g} {unit}"
        number /= 1000.0
    return f"{number:,.3g} EB"
