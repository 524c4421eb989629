"""Output files of commands: checked by one rule before anything is computed.

An output is never a file that the command reads. An existing file is replaced if it holds what this
command writes, and left unchanged if it holds anything else, unless ``--overwrite`` is given.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import click

from kvtheory.cli.console import print_json, progress_bar
from kvtheory.export import PICTURES, SERIES_SUFFIXES, check_path, replace_files

__all__ = ["PICTURES", "check_output"]

BEGINNINGS = {
    ".csv": (b"time [s],velocity [m/s],",),
    ".nc": (b"CDF\x01", b"CDF\x02"),
    ".png": (b"\x89PNG",),
    ".svg": (b"<?xml", b"<svg"),
    ".pdf": (b"%PDF",),
    ".html": (b"<!DOCTYPE html", b"<!doctype html"),
    ".json": (b'{\n "environment"', b'[\n {\n  "label": '),
    ".tex": (b"\\documentclass[11pt,a4paper]{article}\n\\usepackage[margin=25mm]{geometry}",),
    ".md": (b"# Sliding friction on ", b"# Steady sliding of an indenter of the shape"),
    ".ipynb": (b'{\n "cells": ',),
    ".bib": (b"@article{NakanoKono2020,",),
}
"""How the files that commands write begin; a sweep recognises its own files."""
STEADY_HEADER = b"depth [m],half_length [m],"
"""In the first line of a CSV of steady sliding, after the keys of what varies."""
BYTES = 2**14
"""How much of a file is read to recognise it: more than the longest header."""
OVERWRITE = "kvtheory.overwrite"


def overwrite_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `--overwrite`, which `overwriting` reads."""

    def keep(context: click.Context, _: click.Parameter, value: bool) -> None:
        context.meta[OVERWRITE] = value

    return click.option(
        "--overwrite", is_flag=True, expose_value=False, callback=keep,
        help="Overwrite files of another kind than this command writes.",
    )(command)  # fmt: skip


def overwriting() -> bool:
    """Whether the running command was given `--overwrite`."""
    context = click.get_current_context(silent=True)
    return bool(context and context.meta.get(OVERWRITE))


def series_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `--at` for the times of a series, `-o` for its file and `--plot`."""
    return click.option(
        "--at", metavar='"0 ms,1 ms,..."', help="Times to report, or START:STOP:COUNT."
    )(result_options(command))


def result_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Give a command `-o` for the file of its result, and `--plot` for its picture."""
    plot = path_option("--plot", help="Draw the result to FILE.png, .svg or .pdf.")
    output = path_option("-o", "--output", help="Write the result to FILE.csv or FILE.nc.")
    return output(plot(overwrite_option(command)))


def path_option(*names: str, **how: Any) -> Callable[..., Any]:
    """Return an option that takes the name of a file to write."""
    return click.option(*names, type=click.Path(path_type=Path), **how)


def check_results(output: Path | None, plot: Path | None) -> None:
    """Raise unless the files of `result_options` can be written: before a run that may be long."""
    check_output("-o", output, SERIES_SUFFIXES)
    check_output("--plot", plot, PICTURES)


def deliver(
    result: Any, output: Path | None, plot: Path | None, *,
    as_json: bool, more: Mapping[Path, Callable[[Path], Any]] | None = None,
) -> bool:  # fmt: skip
    """Write a result to the files of `result_options` and `more`, or as JSON; return whether that is all.

    All files are made before any is put in place.
    """
    writers: dict[Path, Callable[[Path], Any]] = {}
    with progress_bar("writing"):
        if output:
            writers[output] = result.save
        if plot:
            from kvtheory.plots import save_plot

            writers[plot] = partial(save_plot, result)
        replace_files(writers | dict(more or {}))
    if as_json:
        print_json(result.as_dict())
    return as_json


def check_output(option: str, path: Path | None, suffixes: Sequence[str]) -> None:
    """Raise unless a file of this name can be written, judging by its name, its directory and the rule.

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
    """Raise `ValueError` if the running command reads this file, also as the drive of its scene."""
    context = click.get_current_context(silent=True)
    if context is None or not path.exists():
        return
    read = [
        context.params.get(parameter.name or "")
        for parameter in context.command.params
        if isinstance(parameter.type, click.Path) and parameter.type.exists
    ]
    if "overrides" in context.params:
        from kvtheory.scene.files import drive_file

        read.append(drive_file(context.params.get("scene"), context.params["overrides"]))
    if any(given and Path(given).exists() and path.samefile(given) for given in read):
        raise ValueError(
            f'{option} "{path}" is what this command reads; choose another name for what it writes'
        )


def _is_ours(path: Path) -> bool:
    """Whether a file begins like those that commands write; an empty file may be overwritten."""
    with path.open("rb") as file:
        start = file.read(BYTES)
    if path.suffix.lower() == ".csv" and STEADY_HEADER in start.partition(b"\n")[0]:
        return True
    return not start or start.startswith(BEGINNINGS.get(path.suffix.lower(), (b"",)))
