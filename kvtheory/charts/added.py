"""One's own simulator in the chart of transients: the times and errors of its runs, from a file."""

from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path

import numpy as np

from kvtheory.charts.work_precision import Chart, Point, Series
from kvtheory.scene.columns import Reader
from kvtheory.scene.mistakes import Problems, shown

LEAST, GREATEST, MOST_RUNS = 1e-30, 1e30, 1000
"""Range of times (s) and errors, and number of runs, beyond which a chart cannot be drawn."""
READER = Reader(
    {"method": "method", "seconds": "seconds, time", "error": "error"},
    {"method", "seconds", "error"}.issubset,
    'a first line "method,seconds,error", and below it a row for each run',
    words=("method",),
)
Runs = dict[str, list[tuple[float, float]]]
"""Time (s) and achieved error of each run, by method."""


def read_runs(
    path: Path, taken: Collection[str], most: int, drawable: Callable[[str], bool]
) -> Runs:
    """Read a table with the columns method, seconds and error, a row for each run.

    There may be `most` methods, and none with one of the names that are `taken`, or that is not
    `drawable`. Anything else raises `ValueError` with every line that has a mistake.
    """
    table, problems = READER.read(path), Problems()
    methods, seconds = (table.columns[name].values for name in ("method", "seconds"))
    if table.columns["seconds"].unit:
        seconds = table.si("seconds", "s")[0]
    error, known = table.number("error"), np.isin(methods, ["", *taken])
    letters = np.isin(methods, [name for name in set(methods) if drawable(name)])
    number = f"is not a number from {LEAST:g} to {GREATEST:g}"
    for name, good, message in (
        ("method", ~known, "is empty, or a method of the chart; choose another name"),
        ("method", letters, "has letters that the font of the chart lacks"),
        ("seconds", (seconds >= LEAST) & (seconds <= GREATEST), number),
        ("error", (error == 0.0) | (error >= LEAST) & (error <= GREATEST), f"{number}, or 0"),
    ):
        for row in np.flatnonzero(~good).tolist():
            text = f'"{shown(str(table.columns[name].values[row]))}" {message}'
            problems.append(str(table.error(name, text, row)))
    if (found := np.unique(methods)).size > most:
        problems.append(f"{path}: has {found.size} methods; expected at most {most}")
    if seconds.size > MOST_RUNS:
        problems.append(f"{path}: has {seconds.size} runs; expected at most {MOST_RUNS}")
    problems.report()
    runs: Runs = {}
    for method, *run in zip(*(each.tolist() for each in (methods, seconds, error)), strict=True):
        runs.setdefault(method, []).append(tuple(run))
    return runs


def with_runs(chart: Chart, runs: Runs, error: str) -> Chart:
    """Return a chart with further methods, whose errors are those of the name `error`."""
    added = [
        Series(
            method, "numerical", "-", "element updates",
            [Point(0.0, errors={error: achieved}, times=[s]) for s, achieved in sorted(pairs)],
        )
        for method, pairs in runs.items()
    ]  # fmt: skip
    return replace(chart, series=[*chart.series, *added])
