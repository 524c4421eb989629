"""The footprint of a ball: `footprint`."""

from collections.abc import Mapping
from typing import Any

from kvtheory.api._edge import scene_of
from kvtheory.api._steady import steady
from kvtheory.models.steady.footprint import Footprint
from kvtheory.models.steady.spots import stretch_of
from kvtheory.scene.arguments import a_scene, checked, replacements
from kvtheory.scene.broadcasting import values
from kvtheory.scene.model import Scene
from kvtheory.scene.requirements import lacks_ball, require


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
    scene = scene_of(scene)
    require(lacks_ball, scene, "the footprint")
    given, state = values(scene, over), steady(scene, over=over)
    if given["drive.velocity"].ndim:
        raise ValueError("`over` holds arrays: a footprint is that of one scene")
    a, stretch = float(state.half_length), float(stretch_of(given))
    backwards = given["drive.velocity"] < 0.0
    l_r = float(state.retardation_length) * (-1.0 if backwards else 1.0)
    return Footprint(
        radius=float(given["indenter.radius"]),
        stiffness=float(given["foundation.stiffness"]),
        half_length=a,
        half_width=a * stretch,
        retardation_length=l_r,
    )
