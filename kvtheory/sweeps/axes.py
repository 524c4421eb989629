"""What is swept: grids, lists, ranges and zipped points, read and checked, as axes."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.results.sweep import Axis
from kvtheory.scene.broadcasting import replaceable
from kvtheory.scene.lists import array_of, item_values, items
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Quantity, SceneError, nearest, problem, quantities

Array = NDArray[np.float64]

EXAMPLE = '{"drive.velocity": "1 mm/s:10 m/s:200:log"}'


def sweepable(scene: Scene) -> dict[str, Quantity]:
    """Return the keys of a scene that can be swept, each with its unit and range.

    >>> from kvtheory.scene import Drive, Sine
    >>> wave = Drive(waveform=Sine(amplitude=0.1, frequency=5.0))
    >>> [key for key in sweepable(Scene(drive=wave)) if key.startswith("drive.")]
    ['drive.velocity', 'drive.stiffness', 'drive.amplitude', 'drive.frequency', 'drive.mean']
    """
    run = {f"run.{name}": spec for name, spec in quantities(scene.run).items()}
    return replaceable(scene) | waveform_keys(scene) | run


def waveform_keys(scene: Scene) -> dict[str, Quantity]:
    """Return the keys of the waveform of a scene, if it has one."""
    waveform = scene.drive.waveform
    specs = {} if waveform is None else quantities(waveform)
    return {f"drive.{name}": spec for name, spec in specs.items()}


def axes_of(scene: Scene, over: Mapping[Any, Any]) -> tuple[Axis, ...]:
    """Return the axes of a sweep, in the order given.

    Parameters
    ----------
    scene
        The scene whose values are replaced.
    over
        Maps a dotted key to a list, an array in SI, or a text such as ``"1 mm/s:10 m/s:200:log"`` or
        ``"10 ms,1 s"``; or a tuple of keys to a tuple of these, of equal lengths: values that vary
        together.

    Raises
    ------
    SceneError
        Listing every unknown key and every wrong value.

    Examples
    --------
    >>> axes = axes_of(Scene(), {"drive.velocity": "1 mm/s:100 mm/s:3:log"})
    >>> axes[0].values["drive.velocity"].round(6).tolist()
    [0.001, 0.01, 0.1]
    >>> pairs = {("drive.velocity", "foundation.retardation_time"): ([0.1, 1.0], ["1 s", "10 ms"])}
    >>> axes_of(Scene(), pairs)[0].size
    2
    """
    specs, problems, found = sweepable(scene), [], []
    seen: set[str] = set()
    if not isinstance(over, Mapping) or not over:
        raise SceneError([f"`over` is empty: expected a key and its values, such as {EXAMPLE}"])
    for given, values in over.items():
        keys, lists = (given, values) if isinstance(given, tuple) else ((given,), (values,))
        if len(keys) != len(lists):
            problems.append(problem(f"`over` {given}", values, "expected a list for each key"))
            continue
        arrays: dict[str, Array] = {}
        for key, value in zip(keys, lists, strict=True):
            try:
                arrays[key] = _known(key, value, specs, seen)
            except SceneError as error:
                problems += error.problems
        lengths = {key: array.size for key, array in arrays.items()}
        if len(set(lengths.values())) > 1:
            told = ", ".join(f"{key} {length}" for key, length in lengths.items())
            problems.append(f"`over`: values that vary together must be equally many, got {told}")
        found.append(arrays)
    if problems:
        raise SceneError(problems)
    own = seen & waveform_keys(scene).keys()
    if "drive.velocity" in seen - own and own:
        told = f"it replaces the waveform, of which {', '.join(sorted(own))} is swept"
        raise SceneError([f"`over` drive.velocity: {told}"])
    zipped = [arrays for arrays in found if len(arrays) > 1]
    names = ["point"] if len(zipped) == 1 else [f"point_{i + 1}" for i in range(len(zipped))]
    named = iter(names)
    return tuple(
        Axis(next(named) if len(arrays) > 1 else next(iter(arrays)), arrays) for arrays in found
    )


def size(axes: Sequence[Axis]) -> int:
    """Return the number of points."""
    return math.prod(axis.size for axis in axes)


def values_at(axes: Sequence[Axis], start: int, stop: int) -> dict[str, Array]:
    """Return the swept values of the points `start` to `stop`, in C order, each array contiguous.

    >>> axes = axes_of(Scene(), {"drive.velocity": [1.0, 2.0], "support.mass": [10.0, 20.0]})
    >>> {key: array.tolist() for key, array in values_at(axes, 1, 3).items()}
    {'drive.velocity': [1.0, 2.0], 'support.mass': [20.0, 10.0]}
    """
    shape = tuple(axis.size for axis in axes)
    places = np.unravel_index(np.arange(start, stop), shape)
    return {
        key: array[place]
        for axis, place in zip(axes, places, strict=True)
        for key, array in axis.values.items()
    }


def narrowed(axes: Sequence[Axis], start: int, stop: int) -> tuple[tuple[Axis, ...], int]:
    """Cut the axes down to what the points `start` to `stop` need; return how far indices move.

    What is sent to a worker so stays small, however many values an axis has.
    """
    kept, moved = list(axes), 0
    for number, axis in enumerate(axes):
        inner = size(axes[number + 1 :])
        first, last = (start - moved) // inner, (stop - 1 - moved) // inner
        part = {key: array[first : last + 1] for key, array in axis.values.items()}
        kept[number] = Axis(axis.name, part)
        moved += first * inner
        if first != last:
            break
    return tuple(kept), moved


def _known(key: Any, value: Any, specs: Mapping[str, Quantity], seen: set[str]) -> Array:
    """Return the values of one key in SI, or raise `SceneError` with all that is wrong."""
    if key not in specs:
        told = f"unknown key for this scene; {nearest(str(key), specs)}"
        raise SceneError([problem(f"`over` {key}", value, told)])
    if key in seen:
        raise SceneError([f"`over` {key} is swept twice"])
    seen.add(key)
    try:
        return _values(value, specs[key])
    except ValueError as error:
        raise SceneError([problem(f"`over` {key}", value, str(error))]) from None


def _values(value: Any, spec: Quantity) -> Array:
    if isinstance(value, str) and items(value):
        return np.concatenate([item_values(item, spec) for item in items(value)])
    array = np.atleast_1d(array_of(value, spec))
    if array.ndim > 1:
        raise ValueError("expected one list; give pairs as a tuple of keys with a list for each")
    if array.size == 0:
        raise ValueError("is empty; expected at least one value")
    return array
