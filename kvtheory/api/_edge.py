"""What the public functions share: checks of their arguments, and of the range of floats."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np

from kvtheory.api._model_error import largest, layer_numbers, notes_of
from kvtheory.scene.capabilities import lacks_one_scene, require
from kvtheory.scene.foundations import beyond, extrapolates
from kvtheory.scene.mistakes import mistake
from kvtheory.scene.model import Scene
from kvtheory.scene.static_state import out_of_range

TABLE1 = Scene()


def scene_of(scene: Scene | None) -> Scene:
    """Return the scene, or that of Table 1."""
    return TABLE1 if scene is None else scene


def one_scene(scene: Scene | None, what: str) -> Scene:
    """Return the scene, or that of Table 1; arrays are refused, as `what` is for one scene."""
    scene = scene_of(scene)
    require(lacks_one_scene, scene, what)
    return scene


def varied(scene: Scene, units: Mapping[str, str]) -> dict[str, Any]:
    """Return what varies over the scenes of an answer, and the units of it and of the quantities."""
    specs, arrays = scene.replaceable, scene.arrays()
    over = {key: np.broadcast_to(array, scene.shape) for key, array in arrays.items()}
    return {"over": over, "units": {**units, **{key: specs[key].unit for key in arrays}}}


def times_of(scene: Scene, at: list[float] | None) -> Any:
    """Return the times in s, or None; those after the end of the run raise one SceneError."""
    late = [time for time in at or () if time > scene.run.duration]
    if late:
        message = f"is after the end of the run, run.duration = {scene.run.duration} s"
        message += f"; so are {len(late) - 1} more" * (len(late) > 1)
        raise mistake("`at`", f"{late[0]} s", message)
    return at


def noted(scene: Scene, series: Any) -> Any:
    """Return a time series with notes: on its layer, and if V/c or T leave the measured range."""
    length = np.abs(series.trailing_edge - series.leading_edge)
    length = np.where(length > 0.0, length, np.nan)
    if np.isnan(length).all():
        return series
    there = scene.at(np.asarray(series.velocity))
    farther = np.maximum(np.abs(series.leading_edge), np.abs(series.trailing_edge))
    numbers = largest(layer_numbers(there, series.depth, np.where(length > 0.0, farther, np.nan)))
    notes = [*series.notes, *notes_of(numbers, there), beyond(scene.foundation)]
    if scene.foundation.lowest_frequency is not None:
        passing = np.nan_to_num(np.abs(series.velocity) / length)
        notes.append(extrapolates(scene.foundation, passing.max(), 1.0))
    return replace(series, notes=tuple(filter(None, notes))) if any(notes) else series


@contextmanager
def double_precision(scene: Scene) -> Iterator[None]:
    """Turn an overflow anywhere in a calculation into an error about the values of the scene."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            yield
    except (FloatingPointError, OverflowError, ZeroDivisionError) as error:
        raise ValueError(out_of_range(scene, str(error))) from None
