"""The footprint of a ball: `footprint`."""

from collections.abc import Mapping
from typing import Any

from kvtheory.api._edge import one_scene, scene_of
from kvtheory.api._steady import steady
from kvtheory.models.steady.footprint import Footprint
from kvtheory.scene.arguments import a_scene, checked, replacements
from kvtheory.scene.capabilities import lacks_ball, require
from kvtheory.scene.model import Scene


@checked(scene=a_scene, over=replacements)
def footprint(scene: Scene | None = None, *, over: Mapping[str, Any] | None = None) -> Footprint:
    """Return the contact area of a ball in steady sliding, and the pressure in it.

    Parameters
    ----------
    scene, over
        As in `steady`, without arrays; the indenter must be a ball on a Kelvin-Voigt foundation.

    Returns
    -------
    Footprint
        With `edges(y)`, the leading and trailing edge of the strip at y, and `pressure` at any point, in SI.

    Raises
    ------
    SceneError, ValueError
        As in `steady`, or if the indenter is not a ball.

    Examples
    --------
    >>> import kvtheory as kv
    >>> ball = kv.Scene(indenter=kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
    >>> found = kv.footprint(ball)
    >>> [f"{float(edge) * 1e3:.4f} mm" for edge in found.edges(0.5 * found.half_width)]
    ['-0.9636 mm', '0.0463 mm']

    References
    ----------
    Theorem F20 of the derivations.
    """
    scene = one_scene(scene_of(scene).replace(over or {}), "the footprint")
    require(lacks_ball, scene, "the footprint")
    state = steady(scene)
    backwards = scene.drive.final_velocity < 0.0
    return Footprint(
        radius=scene.indenter.radius,
        stiffness=scene.foundation.stiffness,
        half_length=state.half_length,
        half_width=state.half_length * scene.indenter.stretch,
        retardation_length=state.retardation_length * (-1.0 if backwards else 1.0),
    )
