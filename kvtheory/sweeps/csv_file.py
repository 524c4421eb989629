"""Sweeps as CSV (RFC 4180) in long form: one row for each point, or each point and time."""

import csv
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import orjson
from numpy.typing import NDArray

from kvtheory.sweeps.axes import values_at
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import Plan

if TYPE_CHECKING:
    from kvtheory.sweeps.files import Outcome

END = "\r\n"
MARK = "# kvtheory sweep"
"""The first line of every such file."""


def check() -> None:
    """Nothing is needed but what the package comes with."""


def write(result: "Outcome", path: Path) -> None:
    """Write header and rows; rows of points that were not computed yet are left out."""
    with path.open("wb") as file:
        for line in _comments(result):
            file.write(f"{line}{END}".encode())
        file.write((",".join(_heads(result.plan)) + END).encode())
        for block in result.blocks():
            file.write(_rows(result.plan, block))


def header(path: Path) -> Mapping[str, str] | None:
    """Return what a file says about itself, or None if it is not such a file."""
    found = {}
    with path.open(encoding="utf-8", errors="replace", newline="") as file:
        if file.readline().rstrip() != MARK:
            return None
        for line in file:
            if not line.startswith("#"):
                break
            key, _, text = line[1:].strip().partition(": ")
            if key in ("record", "summary"):
                found[key] = text
    return found if len(found) == 2 else None


def values(path: Path, plan: Plan, name: str) -> dict[str, Any]:
    """Return every column of a finished file; it has to be read as a whole anyhow."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        heads = next(rows)
        table = list(zip(*rows, strict=True))
    shape = tuple(axis.size for axis in plan.axes)
    series = [len(plan.times or ())] if plan.series else []
    found = {}
    for column in plan.columns:
        cells = table[heads.index(_head(column.name, column.unit))]
        array = (
            np.array(cells, dtype=object) if column.text
            else np.array([float(cell) if cell else np.nan for cell in cells])
        ).reshape(*shape, *series)  # fmt: skip
        found[column.name] = array[..., 0] if series and column.measure != "series" else array
    return found


def _comments(result: "Outcome") -> list[str]:
    plan, own = result.plan, result.header()
    record = plan.record()
    swept = " x ".join(f"{axis.size} {' & '.join(axis.values)}" for axis in plan.axes)
    lines = [MARK, f"# version: {record['kvtheory']}", f"# over: {swept}"]
    if result.done < plan.points:
        lines.append(f"# unfinished: {result.done} of {plan.points} points; the command resumes it")
    lines += [f"#   {line}".rstrip() for line in record["scene"].splitlines()]
    lines += [f"# {key}: {text}" for key, text in own.items()]
    lines += [
        f"# failed: point {index}, {json.dumps(reason, ensure_ascii=False)}"
        for block in result.blocks(numbers=False)
        for index, reason in block.failures
    ]
    return lines


def _head(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def _heads(plan: Plan) -> list[str]:
    swept = [key for axis in plan.axes for key in axis.values]
    asked = [*plan.numeric, *plan.textual]
    heads = [_head(key, plan.units[key]) for key in swept]
    return heads + ["time [s]"] * plan.series + [_head(c.name, c.unit) for c in asked]


def _rows(plan: Plan, block: Block) -> bytes:
    """Return the rows of a block; orjson prints the shortest decimals that read back the same."""
    keys = list(values_at(plan.axes, block.start, block.stop).values())
    times = len(plan.times or ()) if plan.series else 1
    time = [np.tile(plan.times or (), block.stop - block.start)] if plan.series else []
    table = np.column_stack(
        [*(np.repeat(key, times) for key in keys), *time, *_long(plan, block.numbers, times)]
    )
    printed = orjson.dumps(np.ascontiguousarray(table), option=orjson.OPT_SERIALIZE_NUMPY)
    text = printed[2:-2]
    if not np.isfinite(table).all():
        text = text.replace(b"null", b"")
    if not block.texts:
        return text.replace(b"],[", END.encode()) + END.encode()
    quoted = [_quoted(block.texts, i // times) for i in range(table.shape[0])]
    lines = text.split(b"],[")
    return b"".join(
        b"%s,%s%s" % (line, more.encode(), END.encode())
        for line, more in zip(lines, quoted, strict=True)
    )


def _long(plan: Plan, numbers: NDArray[np.float64], times: int) -> list[NDArray[np.float64]]:
    """Return each column with a value for each point and time."""
    found, row = [], 0
    for column in plan.numeric:
        rows = plan.rows(column)
        part = numbers[row : row + rows]
        found.append(
            part.T.reshape(-1) if column.measure == "series" else np.repeat(part[0], times)
        )
        row += rows
    return found


def _quoted(texts: Sequence[Sequence[str]], index: int) -> str:
    return ",".join('"' + column[index].replace('"', '""') + '"' for column in texts)
