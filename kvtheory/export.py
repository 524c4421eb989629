"""Results as files that others open: CSV with units in the header, NetCDF."""

import csv
import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.results import TRANSIENT_UNITS, Simulation, Solution, Transient

Series = Transient | Simulation | Solution
SERIES_SUFFIXES = (".csv", ".nc")
"""Of files that hold a time series."""
PICTURES = (".png", ".svg", ".pdf")
"""Of files that hold a drawing."""


def save_transient(result: Series, path: Path) -> None:
    """Write a time series as ``.csv`` (RFC 4180, empty where a value does not exist) or ``.nc``.

    Raises
    ------
    ValueError
        If the suffix is neither, or xarray, which writes NetCDF, is missing.
    OSError
        If the file cannot be written.
    """
    check_path(path, SERIES_SUFFIXES)
    writers: Mapping[str, Callable[[Series, Path], None]] = {".csv": _csv, ".nc": _netcdf}
    replace_file(path, lambda part: writers[path.suffix.lower()](result, part))


def check_path(path: Path, suffixes: Sequence[str]) -> None:
    """Raise unless a file of this name can be written, as far as names and places tell.

    Raises
    ------
    ValueError
        If the name does not end in one of the `suffixes`, in capitals or not.
    OSError
        If there is no such directory, or the name is that of a directory.

    Examples
    --------
    >>> check_path(Path("a.PDF"), [".png", ".pdf"])
    >>> check_path(Path("a.txt"), [".png", ".svg", ".pdf"])
    Traceback (most recent call last):
    ValueError: "a.txt": expected a name that ends in .png, .svg or .pdf
    """
    if path.suffix.lower() not in suffixes:
        expected = " or ".join(filter(None, (", ".join(suffixes[:-1]), suffixes[-1])))
        raise ValueError(f'"{path}": expected a name that ends in {expected}')
    if not path.parent.is_dir():
        raise OSError(f'"{path}": there is no directory "{path.parent}"')
    if path.is_dir():
        raise OSError(f'"{path}" is a directory; expected the name of a file')


def replace_file(path: Path, write: Callable[[Path], Any]) -> None:
    """Write to a temporary name beside `path` and rename, so that no half file is ever seen.

    Raises
    ------
    OSError
        If the file cannot be written; the message names it.
    """
    part = path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
    try:
        write(part)
        os.replace(part, path)
    except OSError as error:
        raise OSError(f'"{path}" cannot be written: {error.strerror or error}') from error
    finally:
        part.unlink(missing_ok=True)


def _csv(result: Series, path: Path) -> None:
    columns = [np.asarray(getattr(result, name)).tolist() for name in TRANSIENT_UNITS]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(f"{name} [{unit}]" for name, unit in TRANSIENT_UNITS.items())
        for row in zip(*columns, strict=True):
            writer.writerow("" if value != value else value for value in row)  # noqa: PLR0124


def _netcdf(result: Series, path: Path) -> None:
    try:
        import xarray
    except ModuleNotFoundError:
        raise ValueError('NetCDF needs xarray: pip install "kvtheory[data]"') from None
    columns = {
        name: ("time", np.asarray(getattr(result, name)), {"units": unit})
        for name, unit in TRANSIENT_UNITS.items()
    }
    time = columns.pop("time")
    attributes = {
        "model": result.model,
        "certificate": result.certificate.statement,
    }
    if isinstance(result, Transient):
        attributes["events"] = json.dumps([event._asdict() for event in result.events])
    data = xarray.Dataset(columns, coords={"time": time}, attrs=attributes)
    data.to_netcdf(path, engine="scipy")
