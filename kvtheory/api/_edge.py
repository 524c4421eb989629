"""What the public functions share: checks of their arguments, and of the range of floats."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from kvtheory.scene.drives import TIME
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import SceneError, convert, item_values, items, problem
from kvtheory.scene.requirements import lacks_one_scene, require
from kvtheory.scene.static_state import out_of_range


def scene_of(scene: Scene | None) -> Scene:
    """Return the scene, or that of Table 1."""
    if scene is not None and not isinstance(scene, Scene):
        raise TypeError(
            f"expected a Scene, got {scene!r}; kvtheory.load_scene reads one from a file"
        )
    return _table1() if scene is None else scene


def one_scene(scene: Scene | None, what: str) -> Scene:
    """Return the scene, or that of Table 1; arrays are refused, as `what` is for one scene."""
    scene = scene_of(scene)
    require(lacks_one_scene, scene, what)
    return scene


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
    given = [at] if isinstance(at, str) or np.ndim(at) == 0 else at
    for value in (
        part for one in given for part in (items(one) if isinstance(one, str) else [one])
    ):
        try:
            text = isinstance(value, str)
            several = item_values(value, TIME).tolist() if text else [convert(value, TIME)]
            if max(several) > scene.run.duration:
                raise ValueError(
                    f"is after the end of the run, run.duration = {scene.run.duration} s"
                )
            times += several
        except ValueError as error:
            found.append(problem("`at`", value, str(error)))
    if not times and not found:
        found.append('`at` is empty: expected times such as "0 ms,1 ms"')
    if problems is not None:
        problems += found
    elif found:
        raise SceneError(found)
    return times


@contextmanager
def double_precision(scene: Scene) -> Iterator[None]:
    """Turn an overflow anywhere in a calculation into an error about the values of the scene."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (FloatingPointError, OverflowError, ZeroDivisionError) as error:
        raise ValueError(out_of_range(scene, str(error))) from None
