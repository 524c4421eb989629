"""The size of a sweep: what cannot fit into memory or onto the disk is refused before it begins."""

import math
import os
import shutil
from pathlib import Path

from kvtheory.progress import duration
from kvtheory.sweeps.files import is_csv
from kvtheory.sweeps.plan import Plan

ON_ARRAYS, BY_QUADRATURE, IN_MOTION = 1e6, 1e5, 1e3
"""Scenes that a core solves in a second, within a factor of three: as measured for Table 1."""
DIGITS = 21
"""Bytes of the decimals of a number with a comma or an end of line."""
ANNOUNCED = 10.0
"""Seconds from which a sweep is announced."""


def announcement(plan: Plan, path: Path, jobs: int = 1) -> str:
    """Say how large a sweep into a file is, if it takes a while."""
    return (
        f"{plan.points:,} points: {_needs(plan, path, jobs)}"
        if _seconds(plan, jobs) > ANNOUNCED
        else ""
    )


def refuse_what_cannot_fit(plan: Plan, path: Path | None, jobs: int = 1) -> None:
    """Raise `ValueError` if a sweep needs more than the memory or the disk holds."""
    limits = []
    if path is None or not is_csv(path):
        try:
            memory = float(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
        except (AttributeError, OSError, ValueError):  # not every system tells
            memory = math.inf
        limits.append((memory, "of memory; choose fewer points, or write to a CSV file (`output`)"))
    if path is not None and path.parent.is_dir():
        free = shutil.disk_usage(path.parent).free
        limits.append((free, f'free beside "{path}"; choose fewer points'))
    for limit, where in limits:
        if _bytes(plan, path) > limit:
            needs = _needs(plan, path, jobs)
            raise ValueError(
                f"{plan.points:,} points need {needs}; there are {_text(limit)} {where}"
            )


def _seconds(plan: Plan, jobs: int) -> float:
    slow = IN_MOTION if plan.transient else BY_QUADRATURE
    return plan.points / ((ON_ARRAYS if plan.vectorised else slow) * jobs)


def _bytes(plan: Plan, path: Path | None) -> float:
    """Return about how many bytes a sweep needs: its blocks, and its arrays or its file."""
    needed = plan.points * plan.blank(0).itemsize
    if path is None or not is_csv(path):
        return 2.0 * needed
    rows = plan.points * (len(plan.times or ()) if plan.series else 1)
    keys = sum(len(axis.values) for axis in plan.axes) + plan.series
    return needed + rows * (len(plan.columns) + keys) * DIGITS


def _needs(plan: Plan, path: Path | None, jobs: int) -> str:
    return f"about {_text(_bytes(plan, path))} and {duration(_seconds(plan, jobs))}"


def _text(number: float) -> str:
    for unit in ("bytes", "kB", "MB", "GB", "TB", "PB"):
        if number < 1000.0:
            return f"{number:.3g} {unit}"
        number /= 1000.0
    return f"{number:,.3g} EB"
