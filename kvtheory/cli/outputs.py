"""Output files of commands: checked by one rule before anything is computed.

An output is never a file that the command reads. An existing file is replaced if it holds what this
command writes, and left unchanged if it holds anything else, unless ``--overwrite`` is given.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import click

from kvtheory.export import PICTURES, SERIES_SUFFIXES, check_path

__all__ = ["PICTURES", "SERIES_SUFFIXES", "OutputFile", "check_output", "check_outputs"]

BEGINNINGS = {
    ".csv": (
        b"time [s],velocity [m/s],",
        b"support,time [s],",
        b'time [s],"leading_edge, fixed [m]"',
        b"support,method,retardation_time [s]",
        b"V tau (R delta)^(-1/2) or ",
        b"quantity,fixed,dead-weight",
    ),
    ".nc": (b"CDF\x01", b"CDF\x02"),
    ".png": (b"\x89PNG",),
    ".svg": (b"<?xml", b"<svg"),
    ".pdf": (b"%PDF",),
    ".html": (b"<!DOCTYPE html", b"<!doctype html"),
    ".json": (b'{\n "environment"', b'[\n {\n  "label": '),
    ".tex": (b"\\documentclass[11pt,a4paper]{article}\n\\usepackage[margin=25mm]{geometry}",),
    ".md": (b"# Sliding friction on ", b"# Steady sliding of an indenter of the shape"),
    ".ipynb": (b'{\n "cells": ',),
    ".toml": (b"# A scene whose foundation was fitted", b"# A scene whose quantities were fitted"),
    ".inp": (b"** Prony series fitted to ",),
    ".mac": (b"! Prony series fitted to ",),
    ".bib": (b"@article{NakanoKono2020,",),
}
"""First bytes of the files that commands write; a sweep recognises its own files."""
STEADY_HEADERS = b"depth [m],half_length [m],", b"growth_rate [1/s],growth_frequency [Hz],"
"""Parts of the first line of a CSV of steady sliding, or of its stability, after the varied keys."""
BYTES = 2**14
"""Bytes of a file that are read to recognise it: more than the longest header."""
OVERWRITE = "kvtheory.overwrite"
"""Whether `--overwrite` was given, in the meta of a context."""


class OutputFile(click.Path):
    """The name of a file to write, with one of the `suffixes`; without any, the command checks the name.

    A chart has its data `beside` it, with this suffix. In a directory the file has the name `inside`.
    """

    def __init__(self, *suffixes: str, beside: str = "", inside: str = "") -> None:
        super().__init__(path_type=Path)
        self.suffixes, self.beside, self.inside = suffixes, beside, inside

    def convert(self, value: Any, param: Any, ctx: Any) -> Any:
        """Return the name as a path."""
        path: Any = super().convert(value, param, ctx)
        return path / self.inside if self.inside and path.is_dir() else path


def check_outputs(context: click.Context) -> None:
    """Raise unless all files that a command was told to write can be written."""
    context.meta[OVERWRITE] = context.params.pop("overwrite", False)
    for parameter in context.command.params:
        option, kind = parameter.opts[0], parameter.type
        if not isinstance(kind, OutputFile):
            continue
        for path in _given(context, parameter):
            if not kind.suffixes:
                _check_not_an_input(option, path)
                continue
            check_output(option, path, kind.suffixes)
            if kind.beside:
                check_output(option, path.with_suffix(kind.beside), [kind.beside])


def _given(context: click.Context, parameter: click.Parameter) -> Sequence[Any]:
    """Return the values of a parameter: none, one, or those of an option that is repeated."""
    value = context.params.get(parameter.name or "")
    return value if isinstance(value, tuple) else () if value is None else (value,)


def check_output(option: str, path: Path, suffixes: Sequence[str]) -> None:
    """Raise unless a file of this name can be written, judging by its name, its directory and the rule."""
    try:
        check_path(path, suffixes)
    except (ValueError, OSError) as error:
        raise type(error)(f"{option} {error}") from None
    _check_not_an_input(option, path)
    context = click.get_current_context(silent=True)
    if path.exists() and not (context and context.meta[OVERWRITE]) and not _is_ours(path):
        raise ValueError(
            f'{option} "{path}" exists and is not what this command writes: remove it, choose another '
            "name, or give --overwrite"
        )


def _check_not_an_input(option: str, path: Path) -> None:
    """Raise `ValueError` if the running command reads this file, also as the drive of its scene."""
    context = click.get_current_context(silent=True)
    if context is None or not path.exists():
        return
    read = [
        each
        for parameter in context.command.params
        if isinstance(parameter.type, click.Path) and parameter.type.exists
        for each in _given(context, parameter)
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
    first = start.partition(b"\n")[0]
    if path.suffix.lower() == ".csv" and any(header in first for header in STEADY_HEADERS):
        return True
    return not start or start.startswith(BEGINNINGS.get(path.suffix.lower(), (b"",)))
