"""What the public functions share: checks of their arguments, and of the range of floats."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np

from kvtheory.scene.capabilities import lacks_one_scene, require
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import SceneError, problem
from kvtheory.scene.static_state import out_of_range


def scene_of(scene: Scene | None) -> Scene:
    """Return the scene, or that of Table 1."""
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


def times_of(scene: Scene, at: list[float] | None, problems: list[str] | None = None) -> Any:
    """Return the times in s, checked against the duration of the run; None stays None.

    Mistakes are appended to `problems`, if given; else they are raised.
    """
    late = f"is after the end of the run, run.duration = {scene.run.duration} s"
    found = [problem("`at`", time, late) for time in at or () if time > scene.run.duration]
    if problems is not None:
        problems += found
    elif found:
        raise SceneError(found)
    return at


@contextmanager
def double_precision(scene: Scene) -> Iterator[None]:
    """Turn an overflow anywhere in a calculation into an error about the values of the scene."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (FloatingPointError, OverflowError, ZeroDivisionError) as error:
        raise ValueError(out_of_range(scene, str(error))) from None
