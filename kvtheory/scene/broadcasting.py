"""A scene with arrays in the place of some of its values."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.drives import VELOCITY
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Quantity, SceneError, convert, nearest, problem, quantities

Array = NDArray[np.float64]


def values(scene: Scene, over: Mapping[str, Any] | None = None) -> dict[str, Array]:
    """Return every quantity of the scene by its dotted key, broadcast, with those of `over` put in.

    Raises
    ------
    SceneError
        Listing every unknown key and every value that is out of range; or if the drive is a function
        and `over` gives no velocity.
    ValueError
        If the arrays do not broadcast.

    Examples
    --------
    >>> values(Scene(), {"drive.velocity": ["1 mm/s", "1 m/s"]})["drive.velocity"].tolist()
    [0.001, 1.0]
    """
    specs = {
        f"{section}.{name}": spec
        for section in ("indenter", "foundation", "support")
        for name, spec in quantities(getattr(scene, section)).items()
    }
    specs["drive.velocity"] = VELOCITY
    given: dict[str, Any] = dict(scene.values())
    problems = []
    for key, value in (over or {}).items():
        if key not in specs:
            problems.append(f"`over` {key}: unknown key for this scene; {nearest(key, specs)}")
            continue
        try:
            given[key] = _array(value, specs[key])
        except ValueError as error:
            problems.append(problem(f"`over` {key}", value, str(error)))
    if "drive.velocity" not in given and not problems:
        given["drive.velocity"] = scene.drive.final_velocity
    if problems:
        raise SceneError(problems)
    try:
        arrays = np.broadcast_arrays(*given.values())
    except ValueError:
        shapes = ", ".join(
            f"{key} {np.shape(value)}" for key, value in given.items() if np.ndim(value)
        )
        raise ValueError(f"the arrays of `over` do not broadcast: {shapes}") from None
    return dict(zip(given, (np.asarray(array, dtype=float) for array in arrays), strict=True))


def _array(value: Any, spec: Quantity) -> Array:
    """Return `value` in SI, checked element by element."""
    if np.ndim(getattr(value, "magnitude", value)) == 0:
        return np.asarray(convert(value, spec))
    if isinstance(value, np.ndarray) and value.dtype.kind in "fiu":
        array = value.astype(float)
        if not spec.admits(array):
            raise ValueError(f"is out of range; expected {spec.range} in {spec.unit} throughout")
        return array
    bare = getattr(value, "magnitude", value)
    items = list(np.asarray(bare, dtype=object).reshape(-1))
    if bare is not value:
        items = [item * value.units for item in items]
    return np.array([convert(item, spec) for item in items]).reshape(np.shape(bare))
