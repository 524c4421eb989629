"""What the figure scripts share: the command line, and saving a picture with its data."""

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from kvtheory.plots.files import data_csv, save_picture
from kvtheory.plots.style import Picture

Columns = Mapping[str, Any]
FORMATS = ("svg", "pdf", "png")
OUTPUT = Path("paper/figures")
figure = Picture


def produce(
    name: str, compute: Callable[[], Any], draw: Callable[[Any], Figure], directory: Path
) -> list[Path]:
    """Compute, draw and save one figure in all formats, and its data as CSV; return the files."""
    data = compute()
    directory.mkdir(parents=True, exist_ok=True)
    paths = [directory / f"{name}.{suffix}" for suffix in FORMATS]
    beside = data_csv(directory / f"{name}.csv", data.columns)
    save_picture(lambda: draw(data), *paths, beside=beside)
    return [*paths, *beside]


def run(name: str, compute: Callable[[], Any], draw: Callable[[Any], Figure]) -> None:
    """Run one script from the command line."""
    parser = argparse.ArgumentParser(description=f"Draw {name} with its data as CSV.")
    parser.add_argument(
        "-o", "--output", type=Path, default=OUTPUT, help="directory (default: %(default)s)"
    )
    for path in produce(name, compute, draw, parser.parse_args().output):
        print(path)
