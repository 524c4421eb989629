"""Sweeps as files: CSV in long form, written block by block, and NetCDF, written by xarray.

CSV (RFC 4180) has a row for each point, or each point and time, below lines of ``#`` that describe it; NetCDF
a dimension for each axis, and the checksums of its library.
"""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np
import orjson

from kvtheory.export import check_path, replace_file
from kvtheory.results.errors import Certificate
from kvtheory.results.sweep import Failure, Sweep
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import EVENTS, OF_LAYER, Plan, Table, is_csv

FAILURES_LISTED = 100
"""Failures that a result lists when it stays in a file; the file itself has them all."""
WAYS_OUT = "remove it, choose another name, or overwrite it (`overwrite`)"

END = "\r\n"
TITLE = "kvtheory sweep"
"""The first line of a CSV, and the title of NetCDF."""
ROWS = 4096
"""Rows printed at a time, so that their text stays in the cache of the processor."""


def check(path: Path) -> None:
    """Raise `ValueError` or `OSError` unless a sweep can be written to `path`."""
    check_path(path, (".csv", ".nc"))
    if not is_csv(path) and find_spec("netCDF4") is None:
        raise ValueError('NetCDF needs netCDF4: pip install ".[data]" in the checkout')


def write(plan: Plan, done: Sequence[Block], blocks: Iterable[Block], path: Path) -> None:
    """Write blocks to a temporary file, and rename it; the tables of those in `done` are not needed."""
    write_as = _write_csv if is_csv(path) else _write_netcdf
    replace_file(path, partial(write_as, plan, _summary(plan, done), blocks))


def finished(path: Path, plan: Plan) -> bool:
    """Whether `path` holds the whole of this sweep; raise if it holds anything else, or lost rows."""
    if not path.exists():
        return False
    try:
        record, summary = _header(path)
        whole = not is_csv(path) or _rows_in(path) == summary["rows"]
    except (ValueError, KeyError, TypeError, OSError):  # whatever other files hold
        whole = False
    if not whole:
        why = "is not a sweep as it was written: it is another file, or was changed or cut"
        raise ValueError(f'"{path}" exists and {why}; {WAYS_OUT}')
    if differing := plan.differences(record):
        why = f"it differs in {', '.join(differing)}"
        raise ValueError(f'"{path}" holds another sweep: {why}; {WAYS_OUT}')
    return bool(summary["done"] == summary["points"])


def _rows_in(path: Path) -> int:
    """Return the number of rows of a CSV below its head."""
    with path.open("rb") as file:
        return sum(line[:1] != b"#" and line.endswith(END.encode()) for line in file) - 1


def from_file(path: Path, plan: Plan, computed: int = 0) -> Sweep:
    """Return the sweep that a finished file holds; its arrays stay there until they are used."""
    return _sweep(plan, _header(path)[1], partial(_values, path, plan), computed, path)


def from_memory(plan: Plan, blocks: Sequence[Block]) -> Sweep:
    """Return the blocks as arrays over the axes."""
    return _sweep(plan, _summary(plan, blocks), _whole(plan, blocks).copy, plan.points)


def save_sweep(result: Sweep, path: Path) -> None:
    """Write the sweep of a result; `Sweep.save` documents it."""
    check(path)
    plan: Plan = result.plan
    axes = len(plan.axes)
    table = {name: v.reshape(-1, *v.shape[axes:]) for name, v in result.values.items()}
    failures = [(failure.index, failure.reason) for failure in result.failures]
    errors = dict(result.certificate.relative_error)
    errors |= {f"{name}{OF_LAYER}": error for name, error in result.layer.items()}
    whole = [Block(0, plan.points, table, failures, [result.certificate.statement], errors)]
    write(plan, whole, whole, path)


def _whole(plan: Plan, blocks: Iterable[Block]) -> Table:
    """Return the columns over the axes; what was not computed is missing."""
    table, grid = plan.blank(plan.points), [axis.size for axis in plan.axes]
    for block in blocks:
        for name, array in table.items():
            array[block.start : block.stop] = block.table[name]
    return {name: array.reshape(*grid, *array.shape[1:]) for name, array in table.items()}


def _sweep(plan: Plan, summary: Any, read: Any, computed: int, path: Path | None = None) -> Sweep:
    """Return the result that a summary describes."""
    failures = []
    for index, reason in summary["failures"]:
        point = plan.values_at(index, index + 1).items()
        failures.append(Failure(index, {key: float(a[0]) for key, a in point}, reason))
    errors = summary["relative_error"]
    own = {name: error for name, error in errors.items() if not name.endswith(OF_LAYER)}
    on_layer = {name[: -len(OF_LAYER)]: errors[name] for name in errors.keys() - own.keys()}
    return Sweep(
        scene=plan.scene, axes=plan.axes, time=np.array(plan.times) if plan.series else None,
        units=plan.units, points=plan.points, computed=computed, failed=summary["failed"],
        failures=tuple(failures), version=version("kvtheory"), path=path, plan=plan, read=read,
        certificate=Certificate("estimated", summary["certificate"], own),
        layer=on_layer,
    )  # fmt: skip


def _summary(plan: Plan, blocks: Sequence[Block]) -> dict[str, Any]:
    """Return how much was computed, which scenes failed and why, and the largest errors."""
    done, errors = sum(block.stop - block.start for block in blocks), dict[str, float]()
    failures = [failure for block in blocks for failure in block.failures]
    for name, error in (item for block in blocks for item in block.errors.items()):
        errors[name] = max(errors.get(name, 0.0), error)
    return {
        "points": plan.points, "done": done, "rows": done * (len(plan.times or ()) if plan.series else 1),
        "failed": len(failures), "failures": failures, "relative_error": errors,
        "certificate": "; ".join(sorted({each for block in blocks for each in block.statements})),
    }  # fmt: skip


def _described(plan: Plan, summary: Mapping[str, Any]) -> dict[str, str]:
    """Return what a file states about itself, as JSON; `_header` reads it."""
    summary = {**summary, "failures": summary["failures"][:FAILURES_LISTED]}
    return {"record": json.dumps(plan.record), "summary": json.dumps(summary)}


def _comments(path: Path) -> list[str]:
    """Return the lines above the table of a CSV."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(takewhile(lambda line: line.startswith("#"), file))


def _header(path: Path) -> tuple[str, dict[str, Any]]:
    """Return the record of the sweep in a file, as JSON, and its summary."""
    if is_csv(path):
        pairs = (line[1:].strip().partition(": ") for line in _comments(path))
        found: Any = {key: text for key, _, text in pairs}
    else:
        with import_module("xarray").open_dataset(path, engine="netcdf4") as data:
            found = data.attrs
    return found["record"], json.loads(found["summary"])


def _values(path: Path, plan: Plan) -> dict[str, Any]:
    """Return the arrays of a file."""
    if not is_csv(path):
        try:
            with import_module("xarray").open_dataset(path, engine="netcdf4") as data:
                return {
                    c.name: data[c.name].values.astype(c.kind, copy=False) for c in plan.columns
                }
        except (RuntimeError, ValueError, KeyError) as error:  # of a checksum that is wrong, say
            raise OSError(f'"{path}" is damaged: {error}; {WAYS_OUT}') from None
    places = dict(enumerate(plan.columns, len(plan.units) - len(plan.columns) + plan.series))
    rows = np.loadtxt(
        path, [(column.name, column.kind) for column in plan.columns], delimiter=",", quotechar='"',
        skiprows=len(_comments(path)) + 1, usecols=[*places], ndmin=1, encoding="utf-8",
        converters={i: _number if column.unit else str for i, column in places.items()},
    ).reshape(*(axis.size for axis in plan.axes), -1)  # fmt: skip
    series = {column.name: column.measure == "series" for column in plan.columns}
    return {name: np.array(rows[name] if series[name] else rows[name][..., 0]) for name in series}


def _number(cell: str) -> float:
    return float(cell or "nan")


def _write_csv(plan: Plan, summary: Any, blocks: Iterable[Block], path: Path) -> None:
    """Write header and rows; those of points that were not computed are left out."""
    record = plan.record
    swept = " x ".join(f"{axis.size} {' & '.join(axis.values)}" for axis in plan.axes)
    done = f"{summary['done']} of {plan.points} points; the command resumes it"
    lines = [
        f"# {TITLE}",
        "# to read the table: pandas.read_csv(FILE, comment='#')",
        f"# version: {record['kvtheory']}",
        f"# over: {swept}",
        *[f"# unfinished: {done}"] * (summary["done"] < plan.points),
        *(f"#   {line}".rstrip() for line in record["scene"].splitlines()),
        *(f"# {key}: {text}" for key, text in _described(plan, summary).items()),
    ]
    for index, reason in summary["failures"]:
        lines.append(f"# failed: point {index}, {json.dumps(reason, ensure_ascii=False)}")
    heads = [_head(key, plan.units[key]) for axis in plan.axes for key in axis.values]
    heads += ["time [s]"] * plan.series
    heads += [_head(column.name, column.unit) for column in plan.columns]
    with path.open("wb") as file:
        file.write(END.join([*lines, ",".join(heads), ""]).encode())
        for block in blocks:
            file.writelines(_rows(plan, block))


def _head(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _rows(plan: Plan, block: Block) -> Iterator[bytes]:
    """Yield the rows of a block; orjson prints the shortest decimals that read back the same."""
    times = len(plan.times or ()) if plan.series else 1
    for start in range(block.start, block.stop, max(1, ROWS // times)):
        stop = min(block.stop, start + max(1, ROWS // times))
        shape, part = (stop - start, times), slice(start - block.start, stop - block.start)
        columns = [np.repeat(swept, times) for swept in plan.values_at(start, stop).values()]
        columns += [np.tile(plan.times or (), shape[0])] * plan.series
        for column in plan.numeric:
            values = block.table[column.name][part].reshape(shape[0], -1)
            columns.append(np.broadcast_to(values, shape).reshape(-1))
        table = np.column_stack(columns)
        text = orjson.dumps(table, option=orjson.OPT_SERIALIZE_NUMPY)[2:-2]
        if not np.isfinite(table).all():
            text = text.replace(b"null", b"")
        lines = text.split(b"],[")
        if plan.texts:
            cells = ['"' + text.replace('"', '""') + '"' for text in block.table[EVENTS][part]]
            pairs = zip(lines, np.repeat(cells, times), strict=True)
            lines = [b"%s,%s" % (line, cell.encode()) for line, cell in pairs]
        yield END.encode().join([*lines, b""])


def _write_netcdf(plan: Plan, summary: Any, blocks: Iterable[Block], path: Path) -> None:
    """Write all points; those that were not computed are missing values."""
    data = _sweep(plan, summary, _whole(plan, blocks).copy, 0).to_xarray()
    data = data.assign_attrs(title=TITLE, **_described(plan, summary))
    indices, reasons = [*zip(*summary["failures"], strict=True)] or [(), ()]
    data["failure_index"] = "failure", np.array(indices, dtype=np.int64)
    data["failure_reason"] = "failure", np.array(reasons, dtype=str)
    numbers = (name for name in data.variables if data[name].dtype.kind in "fi" and data[name].size)
    data.to_netcdf(
        path, engine="netcdf4", encoding={name: {"fletcher32": True} for name in numbers}
    )
