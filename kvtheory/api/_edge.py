"""What the public functions share: checks of their arguments, and of the range of floats."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from kvtheory.scene.drives import TIME
from kvtheory.scene.lists import array_of, item_values, items
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import SceneError, collecting
from kvtheory.scene.static_state import out_of_range


def scene_of(scene: Scene | None) -> Scene:
    """Return the scene, or that of Table 1."""
    return _table1() if scene is None else scene


@cache
def _table1() -> Scene:
    """Return the default scene, made once: it is frozen, and making it is slow."""
    return Scene()


def times_of(scene: Scene, at: Any, problems: list[str] | None = None) -> Any:
    """Return the times in s, checked against the duration of the run; None stays None.

    Mistakes are appended to `problems`, if given; else they are raised.
    """
    if at is None:
        return None
    found: list[str] = []
    times: list[float] = []
    for one in at if isinstance(at, (list, tuple)) else [at]:
        for value in items(one) if isinstance(one, str) else [one]:
            with collecting(found, "`at`", value):
                read = item_values if isinstance(value, str) else array_of
                several = np.atleast_1d(read(value, TIME))
                if several.ndim > 1:
                    raise ValueError("expected one list of times")
                if np.any(several > scene.run.duration):
                    late = f"is after the end of the run, run.duration = {scene.run.duration} s"
                    raise ValueError(late)
                times += several.tolist()
    if not times and not found:
        found.append('`at` is empty: expected times such as "0 ms,1 ms"')
    if problems is not None:
        problems += found
    elif found:
        raise SceneError(found)
    return times


@contextmanager
def double_precision(scene: Scene, over: Mapping[str, Any] | None = None) -> Iterator[None]:
    """Turn an overflow anywhere in a calculation into an error about the values of the scene."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (FloatingPointError, OverflowError, ZeroDivisionError) as error:
        raise ValueError(out_of_range(scene, over or (), str(error))) from None
