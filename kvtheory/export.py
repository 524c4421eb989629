"""Results as files that others open: CSV with units in the header, NetCDF."""

import csv
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.results import Comparison, Transient

SERIES_SUFFIXES = (".csv", ".nc")
"""Suffixes of files that hold a time series."""
PICTURES = (".png", ".svg", ".pdf")
"""Suffixes of files that hold a picture."""


def save_result(result: Any, path: Path) -> None:
    """Write a time series or steady sliding as ``.csv`` or ``.nc``, by the suffix of `path`.

    A CSV follows RFC 4180; a value that does not exist is empty.

    Raises
    ------
    ValueError
        If the suffix is neither, or xarray, which writes NetCDF, is missing.
    OSError
        If the file cannot be written.
    """
    check_path(path, SERIES_SUFFIXES)
    if path.suffix.lower() == ".csv":
        save_csv(result, path)
        return
    data = dataset(result)
    replace_file(path, lambda part: data.to_netcdf(part, engine="scipy"))


def save_csv(result: Any, path: Path) -> None:
    """Write one row for each time, or for each state after what varies, with units in the header."""
    over = getattr(result, "over", {})
    columns = {f"{key} [{result.units[key]}]": values for key, values in over.items()}
    for name, unit in _units(result).items():
        columns[f"{name} [{unit}]"] = getattr(result, name)
    _write_columns(path, columns)


def save_compared(comparison: Comparison, path: Path) -> None:
    """Write data, theory and the allowed difference, with units in the header."""
    curves = {f"{name}, {kind} [{unit}]": curve for name, kind, unit, curve in _curves(comparison)}
    _write_columns(path, {"time [s]": comparison.series["time"], **curves})


def compared(comparison: Comparison) -> Any:
    """Return a comparison as an `xarray.Dataset` with units."""
    data = {
        f"{name}, {kind}": (("time",), curve, {"units": unit})
        for name, kind, unit, curve in _curves(comparison)
    }
    attributes = {"verdict": comparison.verdict, "diagnosis": comparison.diagnosis}
    return _xarray().Dataset(data, {"time": comparison.series["time"]}, attributes)


def _curves(comparison: Comparison) -> Iterator[tuple[str, str, str, Any]]:
    """Yield name, kind, unit and values of all that a comparison holds."""
    held = {"data": "series", "theory": "theory", "allowed": "allowed"}
    for name in comparison.allowed:
        for kind, attribute in held.items():
            yield name, kind, comparison.units[name], getattr(comparison, attribute)[name]


def _write_columns(path: Path, columns: Mapping[str, Any]) -> None:
    def write(part: Path) -> None:
        with part.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            for row in zip(*(np.ravel(c).tolist() for c in columns.values()), strict=True):
                writer.writerow("" if value != value else value for value in row)  # noqa: PLR0124

    replace_file(path, write)


def _xarray() -> Any:
    try:
        import xarray
    except ModuleNotFoundError:
        raise ValueError('this needs xarray: pip install ".[data]" in the checkout') from None
    return xarray


def dataset(result: Any) -> Any:
    """Return a result as an `xarray.Dataset` with units, model, certificate and events."""
    units = _units(result)
    over = "time" in units
    shape = np.shape(next(getattr(result, name) for name in units))
    dims = ("time",) if over else tuple(f"dim_{i}" for i in range(len(shape)))
    columns = {
        name: (dims, np.asarray(getattr(result, name)), {"units": unit})
        for name, unit in units.items()
    }
    coordinates = {"time": columns.pop("time")} if over else {}
    attributes = {"model": result.model, "certificate": result.certificate.statement}
    if isinstance(result, Transient):
        attributes["events"] = json.dumps([event._asdict() for event in result.events])
    return _xarray().Dataset(columns, coordinates, attributes)


def _units(result: Any) -> Mapping[str, str]:
    return {name: unit for name, unit in result.units.items() if hasattr(result, name)}


def check_path(path: Path, suffixes: Sequence[str]) -> None:
    """Raise unless a file of this name can be written, judging by its name and directory.

    Raises
    ------
    ValueError
        If the name does not end in one of the `suffixes`, in upper or lower case, or xarray is missing.
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
    if path.suffix.lower() == ".nc":
        _xarray()
    if not path.parent.is_dir():
        raise OSError(f'"{path}": there is no directory "{path.parent}"')
    if path.is_dir():
        raise OSError(f'"{path}" is a directory; expected the name of a file')


def replace_file(path: Path, write: Callable[[Path], Any]) -> None:
    """Write to a temporary file beside `path` and rename it, so that no incomplete file is ever visible.

    Raises
    ------
    OSError
        If the file cannot be written; the message names it.
    """
    replace_files({path: write})


def replace_files(writers: Mapping[Path, Callable[[Path], Any]]) -> None:
    """Write several files as `replace_file` does: all of them or, if one cannot be made, none."""
    parts = {
        path: path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}") for path in writers
    }
    path = Path()
    try:
        for path, write in writers.items():
            write(parts[path])
        for path, part in parts.items():
            os.replace(part, path)
    except OSError as error:
        cause = error.__cause__ or error  # of a writer that replaces its file itself
        told = getattr(cause, "strerror", None) or cause
        raise OSError(f'"{path}" cannot be written: {told}') from error
    finally:
        for part in parts.values():
            part.unlink(missing_ok=True)
