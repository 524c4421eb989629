"""One's own simulator in the chart of transients: the times and errors of its runs, from a file."""

import csv
import math
from collections.abc import Callable, Collection
from dataclasses import replace
from pathlib import Path

from kvtheory.charts.work_precision import Chart, Point, Series
from kvtheory.scene.tables import read_text

COLUMNS = "method", "seconds", "error"
LEAST, GREATEST, MOST_RUNS = 1e-30, 1e30, 1000
"""Range of times (s) and errors, and number of runs, beyond which a chart cannot be drawn."""
Runs = dict[str, list[tuple[float, float]]]
"""Time (s) and achieved error of each run, by method."""


def read_runs(
    path: Path, taken: Collection[str], most: int, drawable: Callable[[str], bool]
) -> Runs:
    """Read a CSV with the columns method, seconds and error, a row for each run.

    There may be `most` methods, and none with one of the names that are `taken`, or that is not
    `drawable`. Anything else raises `ValueError` with the line.
    """
    where = f'`add` "{path}"'
    try:
        lines = list(csv.reader(read_text(path).splitlines(), skipinitialspace=True))
    except (UnicodeDecodeError, csv.Error):
        raise ValueError(f"{where}: expected a text file, CSV") from None
    head = [cell.strip() for cell in lines[0]] if lines else []
    if missing := [name for name in COLUMNS if name not in head]:
        raise ValueError(
            f"{where}: the first line has no column {missing[0]}; expected "
            f'"{",".join(COLUMNS)}" with commas between, and below it a row for each run'
        )
    if len(set(head)) < len(head):
        raise ValueError(f"{where}: the first line has a column twice")
    found: Runs = {}
    for number, cells in enumerate(lines[1:], start=2):
        row = dict(zip(head, map(str.strip, cells), strict=False))
        if any(row.values()):
            here = f"{where}, line {number}"
            if len(cells) != len(head):
                raise ValueError(
                    f"{here}: {len(cells)} cells below {len(head)} names; quote a name with commas"
                )
            if row["method"] in ("", *taken):
                raise ValueError(
                    f'{here}: method "{row["method"]}": expected a name that no method of the chart has'
                )
            if row["method"] not in found and not drawable(row["method"]):
                raise ValueError(
                    f'{here}: method "{row["method"]}": has letters that the font of the chart lacks'
                )
            values = [_number(f"{here}: {name}", row[name], name) for name in COLUMNS[1:]]
            found.setdefault(row["method"], []).append((values[0], values[1]))
    if not 1 <= len(found) <= most:
        raise ValueError(f"{where}: has {len(found)} methods; expected 1 to {most}")
    if (runs := sum(map(len, found.values()))) > MOST_RUNS:
        raise ValueError(f"{where}: has {runs} runs; expected at most {MOST_RUNS}")
    return found


def _number(where: str, text: str, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if LEAST <= value <= GREATEST or (value == 0.0 and name == "error"):
        return value
    least = "of at least" if name == "error" else "above"
    raise ValueError(
        f'{where} "{text}": expected a number {least} 0 ({LEAST:g} to {GREATEST:g}), with a decimal point'
    )


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
