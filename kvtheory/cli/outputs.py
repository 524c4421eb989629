"""Files that commands write: named and checked before anything is computed, by one rule.

An output is never a file that the command reads. An existing file is replaced where it holds what this
command writes, and left alone where it holds anything else, unless ``--overwrite`` is given.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import click

from kvtheory.export import PICTURES, check_path

__all__ = [
    "PICTURES",
    "check_output",
    "overwrite_option",
    "overwriting",
    "result_options",
    "series_options",
]

BEGINNINGS = {
    ".csv": (b"time [s],velocity [m/s],", b"depth [m],half_length [m],"),
    ".nc": (b"CDF\x01", b"CDF\x02"),
    ".png": (b"\x89PNG",),
    ".svg": (b"<?xml", b"<svg"),
    ".pdf": (b"%PDF",),
    ".html": (b"<!DOCTYPE html", b"<!doctype html"),
    ".json": (b'{\n "environment"',),
}
"""How files begin that commands write; those of sweeps are told apart by the sweep itself."""
OVERWRITE = "kvtheory.overwrite"


def overwrite_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `--overwrite`, which `check_output` and `overwriting` ask for."""

    def keep(context: click.Context, _: click.Parameter, value: bool) -> None:
        context.meta[OVERWRITE] = value

    return click.option(
        "--overwrite", is_flag=True, expose_value=False, callback=keep,
        help="Write over files that hold something else than this command writes.",
    )(command)  # fmt: skip


def overwriting() -> bool:
    """Whether the running command was told to write over what it finds."""
    context = click.get_current_context(silent=True)
    return bool(context and context.meta.get(OVERWRITE))


def series_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `--at` for the times of a series, `-o` for its file and `--plot`."""
    command = result_options(command)
    return click.option(
        "--at",
        default=None,
        metavar='"0 ms,1 ms,..."',
        help="Times to report, or START:STOP:COUNT.",
    )(command)


def result_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `-o` for the file of its result, and `--plot` for its picture."""
    command = click.option(
        "--plot", type=click.Path(path_type=Path), default=None,
        help="Draw the result to FILE.png, .svg or .pdf.",
    )(overwrite_option(command))  # fmt: skip
    return click.option(
        "-o", "--output", type=click.Path(path_type=Path), default=None,
        help="Write the result to FILE.csv or FILE.nc.",
    )(command)  # fmt: skip


def check_output(option: str, path: Path | None, suffixes: Sequence[str]) -> None:
    """Raise unless a file of this name can be written, as far as names, places and the rule tell.

    Examples
    --------
    >>> check_output("--plot", Path("a.pdf"), [".png", ".pdf"])
    >>> check_output("--plot", Path("a.txt"), [".png", ".pdf"])
    Traceback (most recent call last):
    ValueError: --plot "a.txt": expected a name that ends in .png or .pdf
    """
    if path is None:
        return
    try:
        check_path(path, suffixes)
    except (ValueError, OSError) as error:
        raise type(error)(f"{option} {error}") from None
    check_not_an_input(option, path)
    if path.exists() and not (overwriting() or _is_ours(path)):
        raise ValueError(
            f'{option} "{path}" exists and is not what this command writes: remove it, choose another '
            "name, or give --overwrite"
        )


def check_not_an_input(option: str, path: Path) -> None:
    """Raise `ValueError` if the running command reads this file, or writes it under another option."""
    context = click.get_current_context(silent=True)
    if context is None or not path.exists():
        return
    for parameter in context.command.params:
        given = context.params.get(parameter.name or "")
        read = isinstance(parameter.type, click.Path) and parameter.type.exists
        if read and given and path.samefile(str(given)):
            raise ValueError(
                f'{option} "{path}" is what this command reads; choose another name for what it writes'
            )


def _is_ours(path: Path) -> bool:
    """Whether a file begins as those do that commands write; an empty one holds nothing to lose."""
    with path.open("rb") as file:
        start = file.read(64)
    return not start or start.startswith(BEGINNINGS.get(path.suffix.lower(), (b"",)))
