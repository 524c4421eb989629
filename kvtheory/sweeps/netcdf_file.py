"""Sweeps as NetCDF: a dimension for each axis, units, and the scene inside."""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.sweeps.blocks import Block
from kvtheory.sweeps.columns import Column
from kvtheory.sweeps.outcome import Outcome
from kvtheory.sweeps.plan import Plan

TITLE = "kvtheory sweep"
SEAL = -64
"""Behind what HDF5 reads."""


def check() -> None:
    """Raise `ValueError` if netCDF4, which writes blocks as they come, is missing."""
    _library()


def _library() -> Any:
    try:
        import netCDF4
    except ModuleNotFoundError:
        raise ValueError('NetCDF needs netCDF4: pip install ".[data]" in the checkout') from None
    return netCDF4


def write(result: Outcome, path: Path) -> None:
    """Write labels and blocks; numbers of points that were not computed yet are NaN."""
    plan, record = result.plan, result.plan.record()
    with _library().Dataset(path, "w") as data:
        data.setncatts(
            {
                "title": TITLE,
                "kvtheory_version": record["kvtheory"],
                "scene": record["scene"],
                "certificate": result.certificate.statement,
                **result.header(),
            }
        )
        _labels(data, plan)
        variables = [_variable(data, plan, column) for column in plan.columns]
        by_name = dict(zip((column.name for column in plan.columns), variables, strict=True))
        _failures(data, result)
        shape = tuple(axis.size for axis in plan.axes)
        for block in result.blocks():
            for place, part in rectangles(block.start, block.stop, shape):
                _fill(by_name, block, place, part)
    with path.open("ab") as file:
        file.write(b"0" * -SEAL)


def header(path: Path) -> Mapping[str, str]:
    """Return what a file says about itself."""
    with _library().Dataset(path) as data:
        return {key: data.getncattr(key) for key in ("record", "summary")}


def values(path: Path, plan: Plan, name: str) -> dict[str, Any]:
    """Return one quantity."""
    with _library().Dataset(path) as data:
        data.set_auto_mask(False)
        return {name: data[name][...]}


def rectangles(
    start: int, stop: int, shape: Sequence[int]
) -> Iterator[tuple[tuple[slice, ...], slice]]:
    """Cut points in C order into boxes: the place of each in the grid, and in the flat range.

    >>> [(place, part) for place, part in rectangles(1, 6, (3, 2))][1]
    ((slice(1, 3, None), slice(0, 2, None)), slice(1, 5, None))
    """
    inner = math.prod(shape[1:])
    at = start
    while at < stop:
        row, within = divmod(at, inner)
        if within or stop - at < inner:  # part of one row: a box of the dimensions inside
            end = min(stop, (row + 1) * inner)
            boxes = rectangles(within, within + end - at, shape[1:])
            for place, part in boxes:
                moved = slice(part.start + at - start, part.stop + at - start)
                yield (slice(row, row + 1), *place), moved
        else:
            end = stop // inner * inner
            whole = tuple(slice(0, length) for length in shape[1:])
            yield (slice(row, stop // inner), *whole), slice(at - start, end - start)
        at = end


def _labels(data: Any, plan: Plan) -> None:
    times = {"time": len(plan.times or ())} if plan.series else {}
    for name, length in [*((axis.name, axis.size) for axis in plan.axes), *times.items()]:
        data.createDimension(name, length)
    labels = [(key, axis.name, a) for axis in plan.axes for key, a in axis.values.items()]
    labels += [("time", "time", np.array(plan.times))] if plan.series else []
    units = {**plan.units, "time": "s"}
    for key, dimension, array in labels:
        variable = data.createVariable(key, "f8", (dimension,), contiguous=True)
        variable.units = units[key]
        variable[:] = array


def _variable(data: Any, plan: Plan, column: Column) -> Any:
    dims = [axis.name for axis in plan.axes] + ["time"] * (column.measure == "series")
    if column.text:
        return data.createVariable(column.name, str, dims)
    variable = data.createVariable(column.name, "f8", dims, fill_value=np.nan, contiguous=True)
    variable.units = column.unit
    labels = {key for axis in plan.axes if len(axis.values) > 1 for key in axis.values}
    if labels:
        variable.coordinates = " ".join(sorted(labels))
    return variable


def _fill(
    variables: Mapping[str, Any], block: Block, place: tuple[slice, ...], part: slice
) -> None:
    shape = tuple(side.stop - side.start for side in place)
    for name, variable in variables.items():
        array = block.values[name][part]
        variable[(*place, ...)] = array.reshape(*shape, *array.shape[1:])


def _failures(data: Any, result: Outcome) -> None:
    """Write the table of scenes that failed: their indices in C order, and the reasons."""
    data.createDimension("failure", result.failed)
    index = data.createVariable("failure_index", "i8", ("failure",))
    reason = data.createVariable("failure_reason", str, ("failure",))
    at = 0
    for block in result.blocks(numbers=False):
        if block.failures:
            numbers, reasons = zip(*block.failures, strict=True)
            index[at : at + len(numbers)] = np.array(numbers)
            reason[at : at + len(numbers)] = np.array(reasons, dtype=object)
            at += len(numbers)
