"""Sweeps as files, written block by block and read again: CSV in long form, and NetCDF.

CSV (RFC 4180) has one row for each point, or for each point and time; lines that begin with ``#`` above the
table describe it. NetCDF has a dimension for each axis. Either file holds the SHA-256 of all its other bytes,
so that one in which anything was changed is not taken for this sweep: in CSV it stands in the second line, in
NetCDF behind what its readers reach. A file that another program saved again has lost it.
"""

import csv
import hashlib
import json
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from itertools import pairwise, takewhile
from pathlib import Path
from typing import Any

import numpy as np
import orjson

from kvtheory.export import check_path, replace_file
from kvtheory.results.certificate import Certificate
from kvtheory.results.sweep import Failure, Sweep
from kvtheory.sweeps.axes import values_at
from kvtheory.sweeps.blocks import Account, Block
from kvtheory.sweeps.plan import Plan
from kvtheory.sweeps.store import Memory, Store, filled

FAILURES_LISTED = 100
"""Failures that a result lists when it stays in a file; the file itself has them all."""
WAYS_OUT = "remove it, choose another name, or overwrite it (`overwrite`)"

END = "\r\n"
MARK = "# kvtheory sweep"
"""The first line of a CSV."""
DIGEST = f"{MARK}{END}# sha256 of the rest of this file: "
DIGITS = 64
"""Of a SHA-256."""
PART = 2**20
"""Bytes read at a time."""
READ = "# to read the table: pandas.read_csv(FILE, comment='#')"
SLAB = 65536
"""Most points that are written into NetCDF at once."""


def check(path: Path) -> None:
    """Raise `ValueError` or `OSError` unless a sweep can be written to `path`."""
    check_path(path, (".csv", ".nc"))
    if not _is_csv(path):
        _netcdf4()


def write(plan: Plan, store: Store, path: Path) -> None:
    """Write what a store holds to `path`, by a temporary name."""

    def write(part: Path) -> None:
        (_write_csv if _is_csv(path) else _write_netcdf)(plan, store, part)
        with part.open("r+b") as file:
            digest = _digest(part)
            file.seek(_place(part))
            file.write(digest)

    replace_file(path, write)


def finished(path: Path, plan: Plan) -> bool:
    """Whether `path` holds the whole of this sweep, as it was written.

    Raises
    ------
    ValueError
        If it holds anything else but this sweep as it was written.
    """
    if not path.exists():
        return False
    with path.open("rb") as file:
        file.seek(_place(path))
        intact = file.read(DIGITS) == _digest(path)
    if not intact:
        raise ValueError(
            f'"{path}" exists and is not a sweep as it was written: it is another file, or was changed, cut, '
            f"or saved anew by another program; {WAYS_OUT}"
        )
    header = _header(path)
    if differing := plan.differences(header["record"]):
        raise ValueError(
            f'"{path}" holds another sweep: it differs in {", ".join(differing)}; {WAYS_OUT}'
        )
    summary = json.loads(header["summary"])
    return bool(summary["done"] == summary["points"])


def from_file(path: Path, plan: Plan, computed: int = 0) -> Sweep:
    """Return the sweep that a finished file holds; its arrays stay there until they are wanted."""
    summary = json.loads(_header(path)["summary"])
    return _sweep(
        plan, Stored(path, plan), path=path, computed=computed, failed=summary["failed"],
        failures=tuple(Failure(**failure) for failure in summary["failures"]),
        certificate=Certificate("estimated", summary["certificate"], summary["relative_error"]),
    )  # fmt: skip


def from_memory(plan: Plan, store: Memory) -> Sweep:
    """Return a sweep as arrays."""
    account = Account.of(store.blocks())
    (flat,) = filled(plan, store, [(0, plan.points)])
    values = {name: array.reshape(*plan.grid, *array.shape[1:]) for name, array in flat.items()}
    return _sweep(
        plan, values, computed=account.points, failed=account.failed,
        failures=account.listed(plan), certificate=account.certificate,
    )  # fmt: skip


def _sweep(plan: Plan, values: Mapping[str, Any], **found: Any) -> Sweep:
    return Sweep(
        scene=plan.scene, axes=plan.axes, time=np.array(plan.times) if plan.series else None,
        values=values, units=plan.units, points=plan.points, version=plan.record["kvtheory"],
        plan=plan, **found,
    )  # fmt: skip


def save_sweep(result: Sweep, path: Path) -> None:
    """Write the sweep of a result; `Sweep.save` documents it."""
    check(path)
    plan: Plan = result.plan
    values = {
        column.name: np.asarray(result.values[column.name]).reshape(-1, *plan.shape(column))
        for column in plan.columns
    }
    failures = {failure.index: failure.reason for failure in result.failures}
    errors = dict(result.certificate.relative_error)
    account = Account(plan.points, result.failed, failures, {result.certificate.statement}, errors)
    write(plan, Memory(Block(0, plan.points, values, account)), path)


class Stored(Mapping[str, Any]):
    """Arrays of a sweep that are read from its file when they are asked for."""

    def __init__(self, path: Path, plan: Plan) -> None:
        self._path, self._plan = path, plan
        self._read: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._read:
            if name not in list(self):
                raise KeyError(name)
            if _is_csv(self._path):  # has to be read as a whole
                self._read = _csv_values(self._path, self._plan)
            else:
                with _netcdf4().Dataset(self._path) as data:
                    data.set_auto_mask(False)
                    self._read[name] = data[name][...]
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        return iter([column.name for column in self._plan.columns])

    def __len__(self) -> int:
        return len(self._plan.columns)


def _is_csv(path: Path) -> bool:
    return path.suffix.lower() == ".csv"


def _netcdf4() -> Any:
    try:
        import netCDF4
    except ModuleNotFoundError:
        raise ValueError('NetCDF needs netCDF4: pip install ".[data]" in the checkout') from None
    return netCDF4


def _place(path: Path) -> int:
    """Return where the digest of a file begins."""
    return len(DIGEST) if _is_csv(path) else max(0, path.stat().st_size - DIGITS)


def _digest(path: Path) -> bytes:
    """Return the digest of all bytes of a file but those of the digest itself."""
    place, digest = _place(path), hashlib.sha256()
    with path.open("rb") as file:
        for start, stop in ((place + DIGITS, path.stat().st_size), (0, place)):
            file.seek(start)
            while part := file.read(max(0, min(PART, stop - file.tell()))):
                digest.update(part)
    return digest.hexdigest().encode()


def _header(path: Path) -> Mapping[str, str]:
    """Return what a file says about itself."""
    if not _is_csv(path):
        with _netcdf4().Dataset(path) as data:
            return {key: data.getncattr(key) for key in ("record", "summary")}
    with path.open(encoding="utf-8", newline="") as file:
        comments = takewhile(lambda line: line.startswith("#"), file)
        pairs = [line[1:].strip().partition(": ") for line in comments]
    return {key: text for key, _, text in pairs}


def _described(plan: Plan, store: Store) -> tuple[Account, dict[str, str]]:
    """Return the account of a store, and what a file says about itself, as JSON."""
    account = Account.of(store.blocks(numbers=False), FAILURES_LISTED)
    summary = {
        "points": plan.points,
        "done": account.points,
        "failed": account.failed,
        "failures": [asdict(failure) for failure in account.listed(plan)],
        "certificate": account.certificate.statement,
        "relative_error": account.errors,
    }
    return account, {"record": json.dumps(plan.record), "summary": json.dumps(summary)}


def _write_csv(plan: Plan, store: Store, path: Path) -> None:
    """Write header and rows; those of points that were not computed are left out."""
    account, header = _described(plan, store)
    swept = " x ".join(f"{axis.size} {' & '.join(axis.values)}" for axis in plan.axes)
    lines = [
        f"{DIGEST}{'0' * DIGITS}", READ, f"# version: {plan.record['kvtheory']}", f"# over: {swept}"
    ]  # fmt: skip
    if account.points < plan.points:
        lines.append(
            f"# unfinished: {account.points} of {plan.points} points; the command resumes it"
        )
    lines += [f"#   {line}".rstrip() for line in plan.record["scene"].splitlines()]
    lines += [f"# {key}: {text}" for key, text in header.items()]
    lines += [
        f"# failed: point {index}, {json.dumps(reason, ensure_ascii=False)}"
        for block in store.blocks(numbers=False)
        for index, reason in block.account.failures.items()
    ]
    units = plan.units
    heads = [key for axis in plan.axes for key in axis.values]
    heads = [_head(key, units[key]) for key in heads] + ["time [s]"] * plan.series
    heads += [_head(column.name, column.unit) for column in (*plan.numeric, *plan.textual)]
    with path.open("wb") as file:
        file.write(END.join([*lines, ",".join(heads), ""]).encode())
        for block in store.blocks():
            file.write(_rows(plan, block))


def _head(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _rows(plan: Plan, block: Block) -> bytes:
    """Return the rows of a block; orjson prints the shortest decimals that read back the same."""
    shape = block.stop - block.start, len(plan.times or ()) if plan.series else 1
    columns = [*values_at(plan.axes, block.start, block.stop).values()]
    columns = [np.repeat(column, shape[1]) for column in columns]
    columns += [np.tile(plan.times or (), shape[0])] * plan.series
    for column in plan.numeric:
        values = block.values[column.name].reshape(shape[0], -1)
        columns.append(np.broadcast_to(values, shape).reshape(-1))
    table = np.column_stack(columns)
    text = orjson.dumps(np.ascontiguousarray(table), option=orjson.OPT_SERIALIZE_NUMPY)[2:-2]
    if not np.isfinite(table).all():
        text = text.replace(b"null", b"")
    if not plan.textual:
        return text.replace(b"],[", END.encode()) + END.encode()
    cells = ['"' + told.replace('"', '""') + '"' for told in block.values[plan.textual[0].name]]
    lines = zip(text.split(b"],["), np.repeat(cells, shape[1]), strict=True)
    return b"".join(b"%s,%s%s" % (line, cell.encode(), END.encode()) for line, cell in lines)


def _csv_values(path: Path, plan: Plan) -> dict[str, Any]:
    """Return every column of a CSV."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        table = dict(zip(next(rows), zip(*rows, strict=True), strict=True))
    found = {}
    for column in plan.columns:
        cells = table[_head(column.name, column.unit)]
        array = np.array(cells if column.text else [float(cell or "nan") for cell in cells])
        array = array.astype(object if column.text else float)
        array = array.reshape(*plan.grid, -1)
        found[column.name] = array if column.measure == "series" else array[..., 0]
    return found


def _write_netcdf(plan: Plan, store: Store, path: Path) -> None:
    """Write labels and values; those of points that were not computed are missing values."""
    account, header = _described(plan, store)
    with _netcdf4().Dataset(path, "w") as data:
        data.title = "kvtheory sweep"
        data.kvtheory_version = plan.record["kvtheory"]
        data.scene = plan.record["scene"]
        data.certificate = account.certificate.statement
        data.setncatts(header)
        labels = {key: (axis.name, a) for axis in plan.axes for key, a in axis.values.items()}
        labels |= {"time": ("time", np.array(plan.times))} if plan.series else {}
        for dimension, array in labels.values():
            if dimension not in data.dimensions:
                data.createDimension(dimension, array.size)
        for key, (dimension, array) in labels.items():
            variable = data.createVariable(key, "f8", (dimension,), contiguous=True)
            variable.units = "s" if key == "time" else plan.units[key]
            variable[:] = array
        together = sorted(key for axis in plan.axes if len(axis.values) > 1 for key in axis.values)
        for column in plan.columns:
            dims = [axis.name for axis in plan.axes] + ["time"] * (column.measure == "series")
            if column.text:
                data.createVariable(column.name, str, dims)
                continue
            variable = data.createVariable(
                column.name, "f8", dims, fill_value=np.nan, contiguous=True
            )
            variable.units = column.unit
            if together:
                variable.coordinates = " ".join(together)
        _list_failures(data, store, account.failed)
        places = list(_places(plan.grid, max(1, SLAB // len(plan.times or (0,)))))
        ends = np.cumsum([0, *(math.prod(shape) for _, shape in places)]).tolist()
        for (place, shape), values in zip(
            places, filled(plan, store, pairwise(ends)), strict=True
        ):
            for name, array in values.items():
                data[name][place] = array.reshape(*shape, *array.shape[1:])
    with path.open("ab") as file:
        file.write(b"0" * DIGITS)


def _list_failures(data: Any, store: Store, failed: int) -> None:
    """Write the table of scenes that failed: their indices in C order, and the reasons."""
    data.createDimension("failure", failed)
    index = data.createVariable("failure_index", "i8", ("failure",))
    reason = data.createVariable("failure_reason", str, ("failure",))
    at = 0
    for block in store.blocks(numbers=False):
        if failures := block.account.failures:
            part = slice(at, at := at + len(failures))
            index[part] = np.array(list(failures))
            reason[part] = np.array(list(failures.values()), dtype=object)


def _places(grid: Sequence[int], most: int) -> Iterator[tuple[tuple[Any, ...], tuple[int, ...]]]:
    """Cut a grid in C order into boxes of at most `most` points; yield their places and shapes.

    >>> list(_places((2, 3, 2), 4))[1]
    ((0, slice(2, 3, None), Ellipsis), (1, 2))
    """
    axis = next(i for i in range(len(grid)) if math.prod(grid[i + 1 :]) <= most)
    inner = tuple(grid[axis + 1 :])
    step = most // math.prod(inner)
    for outer in np.ndindex(*grid[:axis]):
        for first in range(0, grid[axis], step):
            stop = min(first + step, grid[axis])
            yield (*outer, slice(first, stop), ...), (stop - first, *inner)
