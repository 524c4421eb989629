"""Sweeps as files: CSV in long form and NetCDF, written block by block, and read again.

A file holds the SHA-256 of all its other bytes, so that one in which anything was changed is not taken for
this sweep: numbers, axes, units, texts, or their order. In CSV it stands in the second line, in NetCDF
behind what its readers reach. A file that another program saved anew has lost it.
"""

import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from kvtheory.export import check_path, replace_file
from kvtheory.results.certificate import Certificate
from kvtheory.results.sweep import Failure, Sweep
from kvtheory.sweeps import csv_file, netcdf_file
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.outcome import Outcome, outcome
from kvtheory.sweeps.plan import Plan, differences

FORMATS: Mapping[str, Any] = {".csv": csv_file, ".nc": netcdf_file}
"""Modules with `check`, `write`, `header` and `values`, by the suffix that they serve; `SEAL` is the place of
the digest, counted from the end if it is negative."""

WAYS_OUT = "remove it, choose another name, or overwrite it (`overwrite`)"


DIGITS = 64
"""Of a SHA-256."""
PART = 2**20
"""Bytes read at a time."""


def format_of(path: Path) -> Any:
    """Return the module that serves a file of this name."""
    return FORMATS[path.suffix.lower()]


def check(path: Path) -> None:
    """Raise `ValueError` or `OSError` unless a sweep can be written to `path`."""
    check_path(path, tuple(FORMATS))
    format_of(path).check()


def write(result: Outcome, path: Path) -> None:
    """Write a result to `path` by a temporary name."""
    form = format_of(path)

    def sealed(part: Path) -> None:
        form.write(result, part)
        with part.open("r+b") as file:
            digest = _digest(file, form.SEAL)
            file.seek(-DIGITS, os.SEEK_CUR)
            file.write(digest)

    replace_file(path, sealed)


def _digest(file: BinaryIO, place: int) -> bytes:
    """Return the digest of all bytes of a file but those of the digest itself, and stand behind these."""
    size, digest = file.seek(0, os.SEEK_END), hashlib.sha256()
    place = max(0, place if place >= 0 else size + place)
    for start, stop in ((place + DIGITS, size), (0, place)):
        file.seek(start)
        while part := file.read(max(0, min(PART, stop - file.tell()))):
            digest.update(part)
    file.seek(place + DIGITS)
    return digest.hexdigest().encode()


def _whole(path: Path) -> bool:
    """Whether every byte of a file is as it was written."""
    with path.open("rb") as file:
        digest = _digest(file, format_of(path).SEAL)
        file.seek(-DIGITS, os.SEEK_CUR)
        return digest == file.read(DIGITS)


def finished(path: Path, plan: Plan) -> bool:
    """Whether `path` holds the whole of this sweep, as it was written.

    Raises
    ------
    ValueError
        If it holds anything else but this sweep as it was written.
    """
    if not path.exists():
        return False
    if not _whole(path):
        raise ValueError(
            f'"{path}" exists and is not a sweep as it was written: it is another file, or was changed, cut, '
            f"or saved anew by another program; {WAYS_OUT}"
        )
    header = format_of(path).header(path)
    if differing := differences(header["record"], plan):
        raise ValueError(
            f'"{path}" holds another sweep: it differs in {", ".join(differing)}; {WAYS_OUT}'
        )
    summary = json.loads(header["summary"])
    return bool(summary["done"] == summary["points"])


class Stored(Mapping[str, Any]):
    """Arrays of a sweep that are read from its file when they are asked for."""

    def __init__(self, path: Path, plan: Plan) -> None:
        self._path, self._plan = path, plan
        self._read: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._read:
            if name not in list(self):
                raise KeyError(name)
            self._read |= format_of(self._path).values(self._path, self._plan, name)
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        return iter([column.name for column in self._plan.columns])

    def __len__(self) -> int:
        return len(self._plan.columns)


def from_file(path: Path, plan: Plan, computed: int = 0) -> Sweep:
    """Return the sweep that a finished file holds; its arrays stay there until they are wanted."""
    summary = json.loads(format_of(path).header(path)["summary"])
    failures = tuple(Failure(**failure) for failure in summary["failures"])
    certificate = Certificate("estimated", summary["certificate"], summary["relative_error"])
    told = computed, summary["failed"], failures, certificate
    return _sweep(plan, Stored(path, plan), told, path)


def from_memory(result: Outcome) -> Sweep:
    """Return a sweep as arrays."""
    (block,) = result.blocks()
    shape = tuple(axis.size for axis in result.plan.axes)
    arrays = {
        column.name: block.values[column.name].reshape(*shape, *result.plan.shape(column))
        for column in result.plan.columns
    }
    told = result.done, result.failed, result.failures, result.certificate
    return _sweep(result.plan, arrays, told, None)


def _sweep(
    plan: Plan,
    values: Mapping[str, Any],
    told: tuple[int, int, tuple[Failure, ...], Certificate],
    path: Path | None,
) -> Sweep:
    computed, failed, failures, certificate = told
    return Sweep(
        scene=plan.scene, axes=plan.axes, values=values, units=plan.units,
        time=np.array(plan.times) if plan.series else None, points=plan.points,
        computed=computed, failed=failed, failures=failures, certificate=certificate,
        version=version("kvtheory"), path=path, plan=plan,
    )  # fmt: skip


def save_sweep(result: Sweep, path: Path) -> None:
    """Write a sweep that is in memory; `Sweep.save` documents it."""
    check(path)
    plan: Plan = result.plan
    points = plan.points
    values = {
        column.name: np.asarray(result.values[column.name]).reshape(points, *plan.shape(column))
        for column in plan.columns
    }
    failures = [(failure.index, failure.reason) for failure in result.failures]
    errors = [result.certificate.statement], result.certificate.relative_error
    block = Block(0, points, values, failures, errors)
    write(outcome(plan, lambda **_: iter([block])), path)
