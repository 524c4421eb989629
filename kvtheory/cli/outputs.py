"""Time series that a command is to report and write; its files are checked before it computes anything."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

PICTURES = (".png", ".svg", ".pdf")


def series_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `--at` for the times of a series, and `-o` for its file."""
    command = click.option(
        "-o", "--output", type=click.Path(path_type=Path), default=None,
        help="Write the series to FILE.csv or FILE.nc.",
    )(command)  # fmt: skip
    return click.option("--at", default=None, metavar='"0 ms,1 ms,..."', help="Times to report.")(
        command
    )


def check_output(option: str, path: Path | None, suffixes: Sequence[str]) -> None:
    """Raise `ValueError` unless a file of this name can be written, as far as names and places tell.

    Examples
    --------
    >>> check_output("--plot", Path("a.pdf"), [".png", ".pdf"])
    >>> check_output("--plot", Path("a.txt"), [".png", ".pdf"])
    Traceback (most recent call last):
    ValueError: --plot "a.txt": expected a name that ends in .png or .pdf
    """
    if path is None:
        return
    if path.suffix not in suffixes:
        expected = " or ".join(filter(None, (", ".join(suffixes[:-1]), suffixes[-1])))
        raise ValueError(f'{option} "{path}": expected a name that ends in {expected}')
    if not path.parent.is_dir():
        raise ValueError(f'{option} "{path}": there is no directory "{path.parent}"')
    if path.is_dir():
        raise ValueError(f'{option} "{path}": is a directory; expected the name of a file')
