"""A scene with arrays in the place of some of its values."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kvtheory.scene.drives import SPRING, VELOCITY, Drive
from kvtheory.scene.foundations import LAYER, layer_stiffness
from kvtheory.scene.lists import array_of
from kvtheory.scene.model import Scene, lacks_mass
from kvtheory.scene.quantities import (
    Quantity,
    SceneError,
    collecting,
    free,
    given,
    nearest,
    problem,
    quantities,
)

Array = NDArray[np.float64]


def replaceable(scene: Scene) -> dict[str, Quantity]:
    """Return the keys of a scene whose values can be replaced."""
    found = {
        f"{section}.{name}": spec.fitting(scene.indenter.per_width)
        for section, part in scene.parts().items()
        for name, spec in free(part).items()
    }
    specs = quantities(scene.drive)
    springs = SPRING[:1] if scene.drive.rigid else SPRING  # damper and mass need a stiffness
    spring = {f"drive.{name}": specs[name] for name in springs}
    return {**found, "drive.velocity": VELOCITY, **spring}


def values(scene: Scene, over: Mapping[str, Any] | None = None) -> dict[str, Array]:
    """Return every quantity of the scene by its dotted key, broadcast, with those of `over` inserted.

    Derived quantities are included: ``"support.weight"``, the stiffness of a layer, the mass of a load,
    and the mass that moves along x with a spring in the drive.

    Raises
    ------
    SceneError
        Listing every unknown key and every value that is out of range; or if the drive is a function
        and `over` gives no velocity, or if a spring has no mass to move.
    ValueError
        If the arrays do not broadcast.

    Examples
    --------
    >>> values(Scene(), {"drive.velocity": ["1 mm/s", "1 m/s"]})["drive.velocity"].tolist()
    [0.001, 1.0]
    """
    specs = replaceable(scene)
    flat: dict[str, Any] = dict(scene.values())
    problems: list[str] = []
    for key, value in (over or {}).items():
        if key not in specs:
            told = f"unknown key for this scene; {nearest(key, specs)}"
            problems.append(problem(f"`over` {key}", value, told))
            continue
        with collecting(problems, f"`over` {key}", value):
            flat[key] = array_of(value, specs[key])
    if "drive.velocity" not in flat and not problems:
        flat["drive.velocity"] = scene.drive.final_velocity
    if problems:
        raise SceneError(problems)
    try:
        arrays: Iterable[Any] = flat.values()
        if any(getattr(value, "ndim", 0) for value in arrays):  # else there is nothing to do
            arrays = np.broadcast_arrays(*arrays)
    except ValueError:
        shapes = ", ".join(
            f"{key} {np.shape(value)}" for key, value in flat.items() if np.ndim(value)
        )
        raise ValueError(f"the arrays of `over` do not broadcast: {shapes}") from None
    found = dict(zip(flat, (np.asarray(array, dtype=float) for array in arrays), strict=True))
    found |= _following(scene, found, over or {})
    return found


def _following(scene: Scene, found: dict[str, Array], over: Mapping[str, Any]) -> dict[str, Array]:
    """Return the quantities derived from others, as in the parts of a scene, unless they are replaced."""
    follows: dict[str, Array] = {}
    if scene.foundation.modulus is not None and "foundation.stiffness" not in over:
        layer = (found[f"foundation.{name}"] for name in LAYER)
        follows["foundation.stiffness"] = layer_stiffness(*layer)
    if "support.load" in found:
        follows["support.weight"] = found["support.load"]
        if "mass" not in given(scene.support) and "support.mass" not in over:
            follows["support.mass"] = found["support.load"] / found["support.gravity"]
    elif "support.mass" in found:
        follows["support.weight"] = found["support.mass"] * found["support.gravity"]
    if "drive.stiffness" in found and scene.drive.mass is None and "drive.mass" not in over:
        if scene.held:
            spring = Drive(velocity=0.0, stiffness=1.0)
            raise SceneError(lacks_mass(scene.support, spring, scene.indenter.per_width))
        follows["drive.mass"] = {**found, **follows}["support.mass"]
    return follows
