"""Sweeps as CSV (RFC 4180) in long form: one row for each point, or each point and time.

What the file is stands above the table in lines that begin with ``#``; the first of them say how to
read it, and by which digest a change is noticed.
"""

import csv
import json
from collections.abc import Mapping
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from kvtheory.sweeps.axes import values_at
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.outcome import Outcome
from kvtheory.sweeps.plan import Plan

END = "\r\n"
MARK = "# kvtheory sweep"
"""The first line of every such file."""
DIGEST = f"{MARK}{END}# sha256 of the rest of this file: "
SEAL = len(DIGEST)
READ = "# to read the table: pandas.read_csv(FILE, comment='#')"


def check() -> None:
    """Nothing is needed but what the package comes with."""


def write(result: Outcome, path: Path) -> None:
    """Write header and rows; rows of points that were not computed yet are left out."""
    with path.open("wb") as file:
        lines = [f"{DIGEST}{'0' * 64}", *_comments(result), ",".join(_heads(result.plan)), ""]
        file.write(END.join(lines).encode())
        for block in result.blocks():
            file.write(_rows(result.plan, block))


def header(path: Path) -> Mapping[str, str]:
    """Return what a file says about itself."""
    with path.open(encoding="utf-8", newline="") as file:
        comments = takewhile(lambda line: line.startswith("#"), file)
        pairs = [line[1:].strip().partition(": ") for line in comments]
    return {key: text for key, _, text in pairs}


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


def _comments(result: Outcome) -> list[str]:
    plan, own = result.plan, result.header()
    record = plan.record()
    swept = " x ".join(f"{axis.size} {' & '.join(axis.values)}" for axis in plan.axes)
    lines = [READ, f"# version: {record['kvtheory']}", f"# over: {swept}"]
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
        [*(np.repeat(key, times) for key in keys), *time, *_long(plan, block, times)]
    )
    printed = orjson.dumps(np.ascontiguousarray(table), option=orjson.OPT_SERIALIZE_NUMPY)
    text = printed[2:-2]
    if not np.isfinite(table).all():
        text = text.replace(b"null", b"")
    texts = [block.values[column.name] for column in plan.textual]
    if not texts:
        return text.replace(b"],[", END.encode()) + END.encode()
    quoted = [_quoted(texts, i // times) for i in range(table.shape[0])]
    lines = text.split(b"],[")
    return b"".join(
        b"%s,%s%s" % (line, more.encode(), END.encode())
        for line, more in zip(lines, quoted, strict=True)
    )


def _long(plan: Plan, block: Block, times: int) -> list[NDArray[np.float64]]:
    """Return each column of numbers with a value for each point and time."""
    arrays = [block.values[column.name] for column in plan.numeric]
    return [a.reshape(-1) if a.ndim > 1 else np.repeat(a, times) for a in arrays]


def _quoted(texts: list[NDArray[Any]], index: int) -> str:
    return ",".join('"' + column[index].replace('"', '""') + '"' for column in texts)
