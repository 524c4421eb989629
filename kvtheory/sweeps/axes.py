"""What varies in a sweep: lists, ranges, and values that vary together, read and checked as axes."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results.sweep import Axis
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import (
    Quantity,
    SceneError,
    array_of,
    collecting,
    item_values,
    items,
    nearest,
    problem,
    quantities,
)

Array = NDArray[np.float64]

EXAMPLE = '{"drive.velocity": "1 mm/s:10 m/s:200:log"}'


def axes_of(scene: Scene, over: Mapping[Any, Any]) -> tuple[Axis, ...]:
    """Return the axes of a sweep, in the order given; `kvtheory.sweep` describes `over`.

    Raises
    ------
    SceneError
        Listing every unknown key and every wrong value.
    """
    if not isinstance(over, Mapping) or not over:
        raise SceneError([f"`over` is empty: expected a key and its values, such as {EXAMPLE}"])
    specs, problems = scene.replaceable, []
    swept: dict[str, Array] = {}
    axes: list[dict[str, Array]] = []
    for given, values in over.items():
        keys, lists = (given, values) if isinstance(given, tuple) else ((given,), (values,))
        if not isinstance(lists, (tuple, list, np.ndarray)) or len(keys) != len(lists):
            problems.append(problem(f"`over` {given}", values, "expected a list for each key"))
            continue
        arrays: dict[str, Array] = {}
        for key, value in zip(keys, lists, strict=True):
            with collecting(problems, f"`over` {key}", value):
                if key in swept:
                    raise SceneError([f"`over` {key} is swept twice"])
                swept[key] = arrays[key] = _values(key, value, specs)
        if len({array.size for array in arrays.values()}) > 1:
            sizes = ", ".join(f"{key} {array.size}" for key, array in arrays.items())
            problems.append(f"`over`: values that vary together must be equally many, got {sizes}")
        axes.append(arrays)
    if problems:
        raise SceneError(problems)
    waveform = scene.drive.waveform
    own = {f"drive.{name}" for name in (quantities(waveform) if waveform else ())} & swept.keys()
    if own and "drive.velocity" in swept.keys() - own:
        why = f"it replaces the waveform, of which {', '.join(sorted(own))} is swept"
        raise SceneError([f"`over` drive.velocity: {why}"])
    zipped = sum(len(arrays) > 1 for arrays in axes)
    names = iter(["point"] if zipped == 1 else [f"point_{i + 1}" for i in range(zipped)])
    return tuple(
        Axis(next(names) if len(arrays) > 1 else next(iter(arrays)), arrays) for arrays in axes
    )


def values_at(axes: Sequence[Axis], start: int, stop: int) -> dict[str, Array]:
    """Return the swept values of the points `start` to `stop`, in C order, each array contiguous.

    >>> axes = axes_of(Scene(), {"drive.velocity": [1.0, 2.0], "support.mass": [10.0, 20.0]})
    >>> {key: array.tolist() for key, array in values_at(axes, 1, 3).items()}
    {'drive.velocity': [1.0, 2.0], 'support.mass': [20.0, 10.0]}
    """
    places = np.unravel_index(np.arange(start, stop), tuple(axis.size for axis in axes))
    return {
        key: array[place]
        for axis, place in zip(axes, places, strict=True)
        for key, array in axis.values.items()
    }


def _values(key: str, value: Any, specs: Mapping[str, Quantity]) -> Array:
    """Return the values of a key in SI."""
    if key not in specs:
        raise ValueError(f"unknown key for this scene; {nearest(str(key), specs)}")
    if isinstance(value, str) and items(value):
        return np.concatenate([item_values(item, specs[key]) for item in items(value)])
    array = np.atleast_1d(array_of(value, specs[key]))
    if array.ndim > 1:
        raise ValueError("expected one list; give pairs as a tuple of keys with a list for each")
    if array.size == 0:
        raise ValueError("is empty; expected at least one value")
    return array
