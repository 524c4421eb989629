"""Files that others open: CSV and NetCDF with units, each written completely or not at all."""

import csv
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any
from uuid import uuid4

Columns = Mapping[str, tuple[Any, str]]
"""Values and SI unit of each column by name; `time` first in a time series."""
SERIES_SUFFIXES = (".csv", ".nc")
PICTURES = (".png", ".svg", ".pdf")


def above(module: str) -> Any:
    """Return a module such as ``plots``, which imports that of a method, for the method that needs it."""
    return import_module(f"kvtheory.{module}")


def save_csv(path: Path, columns: Columns) -> None:
    """Write columns as CSV (RFC 4180) with units in the header; a value that does not exist is empty."""
    import numpy as np  # after the command has chosen its threads

    def write(part: Path) -> None:
        with part.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(f"{name} [{unit}]" for name, (_, unit) in columns.items())
            lists = (np.ravel(values).tolist() for values, _ in columns.values())
            for row in zip(*lists, strict=True):
                writer.writerow("" if value != value else value for value in row)  # noqa: PLR0124

    replace_file(path, write)


def dataset(columns: Columns, attributes: Mapping[str, str]) -> Any:
    """Return columns as an `xarray.Dataset` with units: over time, or over dimensions without a name."""
    import numpy as np

    data = {}
    for name, (values, unit) in columns.items():
        dims = ["time"] if "time" in columns else [f"dim_{i}" for i in range(np.ndim(values))]
        data[name] = dims, np.asarray(values), {"units": unit}
    return xarray().Dataset(data, attrs=attributes)


def xarray() -> Any:
    """Return the library, or raise `ValueError` saying how to install it."""
    try:
        return import_module("xarray")
    except ModuleNotFoundError:
        raise ValueError('this needs xarray: pip install ".[data]" in the checkout') from None


def check_path(path: Path, suffixes: Sequence[str]) -> None:
    """Raise unless a file of this name can be written, judging by its name and directory.

    `ValueError` if the suffix is none of these, in upper or lower case, or xarray is missing; `OSError` if
    there is no such directory, if it is read-only, or if the name is that of a directory.
    """
    if path.suffix.lower() not in suffixes:
        expected = " or ".join(filter(None, (", ".join(suffixes[:-1]), suffixes[-1])))
        raise ValueError(f'"{path}": expected a name that ends in {expected}')
    if path.suffix.lower() == ".nc":
        xarray()
    if not path.parent.is_dir():
        raise OSError(f'"{path}": there is no directory "{path.parent}"')
    if not os.access(path.parent, os.W_OK):
        raise OSError(f'"{path}" cannot be written: the directory "{path.parent}" is read-only')
    if path.is_dir():
        raise OSError(f'"{path}" is a directory; expected the name of a file')


@contextmanager
def named(path: Path) -> Iterator[None]:
    """Name the file in an error of the system."""
    try:
        yield
    except OSError as error:
        cause = error.__cause__ or error  # of a writer that replaces its file itself
        reason = getattr(cause, "strerror", None) or cause
        raise OSError(f'"{path}" cannot be written: {reason}') from error


def replace_file(path: Path, write: Callable[[Path], Any]) -> None:
    """Write to a temporary file beside `path` and rename it; raise `OSError` that names it if that fails."""
    replace_files({path: write})


def replace_files(writers: Mapping[Path, Callable[[Path], Any]]) -> None:
    """Write several files as `replace_file` does: all of them or, if one cannot be written, none."""
    call = uuid4().hex[:12]  # threads of a process may write the same file
    parts = {path: path.with_name(f".{path.stem}.{call}.part{path.suffix}") for path in writers}
    try:
        for path, write in writers.items():
            with named(path):
                write(parts[path])
        for path, part in parts.items():
            with named(path):
                os.replace(part, path)
    finally:
        for part in parts.values():
            part.unlink(missing_ok=True)
