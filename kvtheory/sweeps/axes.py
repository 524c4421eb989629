"""What is swept: grids, lists, ranges and zipped points, read and checked, as axes."""

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.drives import VELOCITY
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Quantity, SceneError, convert, nearest, problem, quantities
from kvtheory.sweeps.result import Axis

Array = NDArray[np.float64]

RANGE = "START:STOP:COUNT or START:STOP:COUNT:log"
EXAMPLE = '"drive.velocity=1 mm/s:10 m/s:200:log" or "foundation.retardation_time=10 ms,1 s"'

MOST_ON_AN_AXIS = 10**8
"""Values on one axis, which are held in memory; more than this is a slip of the finger."""


def sweepable(scene: Scene) -> dict[str, Quantity]:
    """Return the keys of a scene that can be swept, each with its unit and range."""
    sections = {name: getattr(scene, name) for name in ("indenter", "foundation", "support", "run")}
    found = {
        f"{section}.{name}": spec
        for section, part in sections.items()
        for name, spec in quantities(part).items()
    }
    return {**found, "drive.velocity": VELOCITY}


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
    zipped = [arrays for arrays in found if len(arrays) > 1]
    names = ["point"] if len(zipped) == 1 else [f"point_{i + 1}" for i in range(len(zipped))]
    named = iter(names)
    return tuple(
        Axis(next(named) if len(arrays) > 1 else next(iter(arrays)), arrays) for arrays in found
    )


def read_over(texts: Iterable[str]) -> dict[Any, Any]:
    """Turn ``KEY=VALUES`` texts into `over`; ``KEY=VALUES & KEY=VALUES`` in one text are zipped.

    >>> read_over(["drive.velocity=1 mm/s,2 mm/s & support.mass=1 kg/m:2 kg/m:2"])
    {('drive.velocity', 'support.mass'): ('1 mm/s,2 mm/s', '1 kg/m:2 kg/m:2')}
    """
    over: dict[Any, Any] = {}
    problems = []
    for text in texts:
        pairs = [part.partition("=") for part in text.split("&")]
        if not all(key.strip() and sign and value.strip() for key, sign, value in pairs):
            problems.append(f'--over "{text}": expected KEY=VALUES, such as {EXAMPLE}')
            continue
        keys = tuple(key.strip() for key, _, _ in pairs)
        values = tuple(value.strip() for _, _, value in pairs)
        if keys in over or keys[0] in over:
            problems.append(f'--over "{text}": {keys[0]} is swept already')
            continue
        over |= {keys: values} if len(keys) > 1 else {keys[0]: values[0]}
    if problems:
        raise SceneError(problems)
    return over


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
        raise SceneError([f"`over` {key}: unknown key for this scene; {nearest(str(key), specs)}"])
    if key in seen:
        raise SceneError([f"`over` {key} is swept twice"])
    seen.add(key)
    try:
        return _values(value, specs[key])
    except ValueError as error:
        raise SceneError([problem(f"`over` {key}", value, str(error))]) from None


def _values(value: Any, spec: Quantity) -> Array:
    if isinstance(value, str) and ":" in value:
        return _range(value, spec)
    if isinstance(value, str):
        value = [item.strip() for item in value.split(",")]
    magnitude = getattr(value, "magnitude", value)
    if np.ndim(magnitude) > 1:
        raise ValueError("expected one list; give pairs as a tuple of keys with a list for each")
    if isinstance(magnitude, np.ndarray) and magnitude.dtype.kind in "fiu" and magnitude is value:
        array = np.atleast_1d(magnitude).astype(float)
        if not spec.admits(array):
            raise ValueError(f"is out of range; expected {spec.range} in {spec.unit} throughout")
    elif magnitude is not value:
        bare = np.atleast_1d(magnitude)
        array = np.array([convert(item * value.units, spec) for item in bare])
    else:
        items = [value] if np.ndim(value) == 0 else list(value)
        array = np.array([convert(item, spec) for item in items])
    if array.size == 0:
        raise ValueError("is empty; expected at least one value")
    return array


def _range(text: str, spec: Quantity) -> Array:
    parts = [part.strip() for part in text.split(":")]
    if len(parts) not in (3, 4) or (len(parts) == 4 and parts[3] != "log"):
        raise ValueError(f"expected {RANGE}, such as {EXAMPLE}")
    start, stop = (convert(part, spec) for part in parts[:2])
    if not parts[2].isdecimal() or not 1 <= int(parts[2]) <= MOST_ON_AN_AXIS:
        raise ValueError(
            f"COUNT must be a whole number from 1 to {MOST_ON_AN_AXIS}; got {parts[2]}"
        )
    count = int(parts[2])
    if len(parts) == 4 and min(start, stop) <= 0.0 <= max(start, stop):
        raise ValueError("a logarithmic range needs START and STOP of one sign, neither zero")
    with np.errstate(over="ignore", invalid="ignore"):
        array = (np.linspace if len(parts) == 3 else np.geomspace)(start, stop, count)
    if not spec.admits(array):
        raise ValueError("the range leaves that of double precision")
    return array
