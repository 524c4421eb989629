"""What the figure scripts share: the command line, and saving a picture with its data."""

import argparse
import csv
import math
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from kvtheory.export import replace_file
from kvtheory.plots import STYLE

Columns = Mapping[str, Any]
FORMATS = {
    "svg": {"metadata": {"Date": None}},
    "pdf": {"metadata": {"CreationDate": None}},
    "png": {},
}
OUTPUT = Path("paper/figures")


def figure(width: float, height: float) -> Figure:
    """Return an empty figure; sizes in inches of the printed page."""
    drawn = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(drawn)
    return drawn


def produce(
    name: str, compute: Callable[[], Any], draw: Callable[[Any], Figure], directory: Path
) -> list[Path]:
    """Compute, draw and save one figure: SVG, PDF and PNG, and the data as CSV."""
    with mpl.rc_context({**STYLE}):
        data = compute()
        drawn = draw(data)
        if layout := drawn.get_layout_engine():
            layout.execute(drawn)
        drawn.set_layout_engine(None)  # laid out once, or each format would draw everything twice
        directory.mkdir(parents=True, exist_ok=True)
        paths = [directory / f"{name}.{suffix}" for suffix in FORMATS]
        for path, options in zip(paths, FORMATS.values(), strict=True):
            settings: dict[str, Any] = {"format": path.suffix[1:], **options}
            replace_file(path, partial(drawn.savefig, **settings))
    table = directory / f"{name}.csv"
    replace_file(table, lambda part: _write_csv(part, data.columns))
    return [*paths, table]


def run(name: str, compute: Callable[[], Any], draw: Callable[[Any], Figure]) -> None:
    """Run one script from the command line."""
    parser = argparse.ArgumentParser(description=f"Draw {name} with its data as CSV.")
    parser.add_argument(
        "-o", "--output", type=Path, default=OUTPUT, help="directory (default: %(default)s)"
    )
    for path in produce(name, compute, draw, parser.parse_args().output):
        print(path)


def _write_csv(path: Path, columns: Columns) -> None:
    arrays = [np.asarray(column) for column in columns.values()]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        rows = zip(*(array.tolist() for array in arrays), strict=True)
        writer.writerows([_written(cell) for cell in row] for row in rows)


def _written(cell: Any) -> Any:
    """Return a cell, empty if its value is missing."""
    return "" if isinstance(cell, float) and math.isnan(cell) else cell
