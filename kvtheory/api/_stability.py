"""Whether steady sliding is stable: `stability`."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

from kvtheory.api._edge import double_precision, scene_of, varied
from kvtheory.results import Stability, units_for
from kvtheory.scene.arguments import a_scene, checked, names, replacements
from kvtheory.scene.capabilities import lacks_stability, require
from kvtheory.scene.mistakes import SceneError, nearest, problem
from kvtheory.scene.model import Scene

QUANTITIES = [field.name for field in fields(Stability)][:7]


@checked(scene=a_scene, over=replacements, quantity=names)
def stability(
    scene: Scene | None = None,
    *,
    over: Mapping[str, Any] | None = None,
    quantity: str | Sequence[str] | None = None,
) -> Stability:
    """Return whether steady sliding is stable, and the critical stiffness of the spring in the drive.

    The spring is `drive.stiffness`, with `drive.damping` and `drive.mass`; the rates are the roots of the
    quartic of theorem F22. With a rigid drive steady sliding is stable: the rates are the two of the vertical
    motion (theorem F12), and the critical stiffness is that of a spring, without damper and with the mass of
    the support, in place of the rigid drive. On a Prony series the equation for the rates is transcendental:
    the least stable ones are returned, as many as on Kelvin-Voigt, a fixed indenter may be unstable too, and
    between the lower and the upper critical stiffness there may be stable ranges.

    Stable means stable against small disturbances. After a large one, such as a sudden start, the motion may
    end in stick-slip all the same (hard excitation): `transient` and `sweep` compute it.

    Parameters
    ----------
    scene, over
        As in `steady`; the indenter must be a parabola or a ball, on Kelvin-Voigt or a Prony series. `over`
        may give ``"drive.stiffness"`` also where the drive of the scene is rigid.
    quantity
        Name of a quantity, or several; without it, all. The critical stiffness alone takes less than a
        microsecond for each scene of an array; the critical velocity and the rates take longer. On a Prony
        series a scene takes some 30 ms, the critical velocity and the rates about a second each, those of a
        ball a few.

    Returns
    -------
    Stability
        Values in SI, or arrays of the broadcast shape, with a certificate. `plot` draws the fastest growth
        and its frequency over what varies, or all rates of one scene; `save` writes a row for each scene.

    Raises
    ------
    SceneError
        As in `steady`, if the mass of a fixed indenter on a spring is not known, or if a quantity is wrong.
    ValueError
        If the indenter is neither a parabola nor a ball, or the foundation a springpot.

    Examples
    --------
    >>> import kvtheory as kv
    >>> spring = kv.Drive(velocity="91 mm/s", stiffness="1 MN/m^2")
    >>> found = kv.stability(kv.Scene(drive=spring))
    >>> bool(found.stable), f"{found.critical_stiffness:.4g} N/m^2, {found.critical_velocity:.4g} m/s"
    (False, '6.879e+06 N/m^2, 0.05363 m/s')
    >>> speeds = {"drive.velocity": ["20 mm/s", "39 mm/s"]}
    >>> kv.stability(over=speeds, quantity="critical_stiffness").critical_stiffness.round()
    array([    nan, 172166.])

    References
    ----------
    Facts F22 and, on a Prony series, F24 of the derivations.
    """
    scene = scene_of(scene).replace(over or {})
    require(lacks_stability, scene, "the stability of steady sliding")
    wanted = frozenset(QUANTITIES if quantity is None else quantity)
    if wrong := sorted(wanted - set(QUANTITIES)):
        raise SceneError([problem("`quantity`", name, nearest(name, QUANTITIES)) for name in wrong])
    if scene.drive.coasts:
        message = (
            "stability is that of a spring: with drive.stiffness = 0 the indenter coasts to rest"
        )
        raise ValueError(f"{message}; give a stiffness above 0, or none, for a rigid drive")
    from kvtheory.models.steady import stable_sliding

    with double_precision(scene):
        found = stable_sliding.solve(scene, wanted)
    return replace(found, **varied(scene, units_for(scene.indenter, found.units)))
