"""Sweeps as files: CSV in long form and NetCDF, written block by block, and read again."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.export import replace_file
from kvtheory.results.certificate import Certificate
from kvtheory.sweeps import csv_file, netcdf_file
from kvtheory.sweeps.axes import values_at
from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.plan import Plan, differences
from kvtheory.sweeps.result import Failure, Sweep

FORMATS: Mapping[str, Any] = {".csv": csv_file, ".nc": netcdf_file}
"""Modules with `check`, `write`, `header` and `values`, by the suffix that they serve."""

FAILURES_LISTED = 100
"""Failures that a result lists when it stays in a file; the file itself has them all."""


@dataclass(frozen=True)
class Outcome:
    """What was computed, ready to be written: `blocks` gives it anew each time (see `Store.blocks`)."""

    plan: Plan
    done: int
    failed: int
    failures: tuple[Failure, ...]
    certificate: Certificate
    blocks: Callable[..., Iterator[Block]]

    def header(self) -> dict[str, str]:
        """Return what a file says about itself, as JSON texts."""
        summary = {
            "points": self.plan.points,
            "done": self.done,
            "failed": self.failed,
            "failures": [asdict(failure) for failure in self.failures[:FAILURES_LISTED]],
            "certificate": self.certificate.statement,
            "relative_error": self.certificate.relative_error,
        }
        return {"record": json.dumps(self.plan.record()), "summary": json.dumps(summary)}


def outcome(plan: Plan, blocks: Callable[..., Iterator[Block]], most: int | None = None) -> Outcome:
    """Sum up blocks; at most `most` failures are listed."""
    done = failed = 0
    failures: list[Failure] = []
    statements: set[str] = set()
    errors: dict[str, float] = {}
    for block in blocks(numbers=False):
        done += block.stop - block.start
        failed += len(block.failures)
        listed = block.failures[: None if most is None else most - len(failures)]
        failures += [failure(plan, index, reason) for index, reason in listed]
        statements |= set(block.errors[0])
        for name, error in block.errors[1].items():
            errors[name] = max(errors.get(name, 0.0), error)
    certificate = Certificate("estimated", "; ".join(sorted(statements)), errors)
    return Outcome(plan, done, failed, tuple(failures), certificate, blocks)


def failure(plan: Plan, index: int, reason: str) -> Failure:
    """Return a failure with the values that were swept at its point."""
    point = {key: float(a[0]) for key, a in values_at(plan.axes, index, index + 1).items()}
    return Failure(index, point, reason)


def check(path: Path) -> None:
    """Raise `ValueError` or `OSError` unless a sweep can be written to `path`."""
    if path.suffix not in FORMATS:
        raise ValueError(f'-o "{path}": expected a name that ends in {" or ".join(FORMATS)}')
    if not path.parent.is_dir():
        raise OSError(f'-o "{path}": there is no directory "{path.parent}"')
    FORMATS[path.suffix].check()


def write(result: Outcome, path: Path) -> None:
    """Write a result to `path` by a temporary name."""
    replace_file(path, lambda part: FORMATS[path.suffix].write(result, part))


def finished(path: Path, plan: Plan) -> bool:
    """Whether `path` holds the whole of this sweep.

    Raises
    ------
    ValueError
        If it holds anything else but this sweep.
    """
    if not path.exists():
        return False
    header = FORMATS[path.suffix].header(path)
    if header is None:
        raise ValueError(f'"{path}" exists and is not a sweep: remove it or choose another name')
    if differing := differences(header["record"], plan):
        raise ValueError(
            f'"{path}" holds another sweep: it differs in {", ".join(differing)}; '
            "remove it or choose another name"
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
            self._read |= FORMATS[self._path.suffix].values(self._path, self._plan, name)
        return self._read[name]

    def __iter__(self) -> Iterator[str]:
        return iter([column.name for column in self._plan.columns])

    def __len__(self) -> int:
        return len(self._plan.columns)


def from_file(path: Path, plan: Plan) -> Sweep:
    """Return the sweep that a finished file holds; its arrays stay there until they are wanted."""
    summary = json.loads(FORMATS[path.suffix].header(path)["summary"])
    failures = tuple(Failure(**failure) for failure in summary["failures"])
    certificate = Certificate("estimated", summary["certificate"], summary["relative_error"])
    return _sweep(plan, Stored(path, plan), summary["failed"], failures, certificate, path)


def from_memory(result: Outcome) -> Sweep:
    """Return a sweep as arrays."""
    (block,) = result.blocks()
    arrays = arranged(result.plan, block, tuple(axis.size for axis in result.plan.axes))
    return _sweep(result.plan, arrays, result.failed, result.failures, result.certificate, None)


def _sweep(
    plan: Plan,
    values: Mapping[str, Any],
    failed: int,
    failures: tuple[Failure, ...],
    certificate: Certificate,
    path: Path | None,
) -> Sweep:
    return Sweep(
        scene=plan.scene, axes=plan.axes, values=values, units=plan.units,
        time=np.array(plan.times) if plan.series else None,
        points=plan.points, failed=failed, failures=failures, certificate=certificate,
        version=version("kvtheory"), path=path, plan=plan,
    )  # fmt: skip


def arranged(plan: Plan, block: Block, shape: tuple[int, ...]) -> dict[str, Any]:
    """Return each column of a block as an array of `shape`, with time last for a series."""
    texts: Iterable[Any] = (np.array(text, dtype=object).reshape(shape) for text in block.texts)
    found: dict[str, Any] = dict(zip((c.name for c in plan.textual), texts, strict=True))
    row = 0
    for column in plan.numeric:
        rows = block.numbers[row : row + plan.rows(column)]
        row += plan.rows(column)
        found[column.name] = (
            rows.T.reshape(*shape, -1) if column.measure == "series" else rows[0].reshape(shape)
        )
    return {column.name: found[column.name] for column in plan.columns}


def save_sweep(result: Sweep, path: Path) -> None:
    """Write a sweep that is in memory; `Sweep.save` documents it."""
    check(path)
    plan: Plan = result.plan
    points = plan.points
    rows = [
        np.asarray(result.values[column.name], dtype=float).reshape(points, -1).T
        for column in plan.numeric
    ]
    numbers = np.concatenate([*rows, np.empty((0, points))])
    texts = [result.values[column.name].reshape(-1).tolist() for column in plan.textual]
    failures = [(failure.index, failure.reason) for failure in result.failures]
    errors = [result.certificate.statement], result.certificate.relative_error
    block = Block(0, points, numbers, texts, failures, errors)
    whole = Outcome(
        plan, points, result.failed, result.failures, result.certificate, lambda **_: iter([block])
    )
    write(whole, path)
