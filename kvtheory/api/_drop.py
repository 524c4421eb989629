"""Drops on a Kelvin-Voigt foundation, and foundations for a drop: `restitution`, `foundation_of_drop`, ..."""

import math
from typing import Any

from kvtheory.api._edge import double_precision, one_scene
from kvtheory.results.impact import Impact
from kvtheory.scene.arguments import a_scene, checked, measured, number
from kvtheory.scene.capabilities import lacks_drop, lacks_dropped, require
from kvtheory.scene.foundations import Foundation
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Quantity
from kvtheory.scene.static_state import StaticState, ball_stiffness

SPEED = Quantity("m/s", "v, speed at which the indenter lands", 0.0, True)
TIME = Quantity("s", "time in contact", 0.0, True)
FREQUENCY = Quantity("1/s", "omega, angular frequency of the undamped motion", 0.0, True)


@checked(scene=a_scene, speed=measured(SPEED))
def restitution(scene: Scene | None = None, *, speed: Any = None) -> Impact:
    """Return a drop on a Kelvin-Voigt foundation, without gravity and sliding while the contact lasts.

    Restitution is a function of one number, eta = tau v/D, with D from K sqrt(2 R) D^(5/2) = M v^2, of a
    ball pi K sqrt(R R_across) D^3 = M v^2 (fact F32); 1 - 1.941 eta + ... of a line, 1 - 1.937 eta + ... of a
    ball. Weight and sliding are negligible while M v is large beside the load times the contact time:
    `transient` and `elements` have both, and every law.

    Parameters
    ----------
    scene
        The indenter, a parabola or a ball, its mass and the foundation.
    speed
        Speed in m/s at which it lands; without it, that of a fall from the start of the scene.

    Raises
    ------
    SceneError
        If the speed is out of range.
    ValueError
        If the scene is of another kind, or neither a speed nor a start above the ground is given.

    Examples
    --------
    >>> import kvtheory as kv
    >>> ball = kv.Scene(kv.Sphere("10 mm"), kv.Foundation("10 GN/m^3", "20 us"), kv.DeadWeight(mass="30 g"))
    >>> found = kv.restitution(ball, speed="1 m/s")
    >>> round(found.restitution, 4), f"{found.contact_time:.4g} s", f"{found.peak_force:.4g} N"
    (0.9212, '0.001468 s', '81.58 N')

    References
    ----------
    Fact F32 of the derivations.
    """
    from kvtheory.theory.drop import drop

    scene = one_scene(scene, "a drop")
    require(lacks_drop, scene, "a drop in closed form")
    v = _landing_speed(scene) if speed is None else speed
    with double_precision(scene):
        M, tau = scene.support.mass, scene.foundation.retardation_time
        stiff, power = _contact(scene, scene.foundation.stiffness)
        D = (M * v * v / stiff) ** (1.0 / power)
        eta = tau * v / D
        found = drop(eta, line=scene.indenter.per_width)
        return Impact(
            number=eta, restitution=found.restitution, contact_time=found.contact_time * D / v,
            peak_force=found.peak_force * M * v * v / D, peak_depth=found.peak_depth * D,
        )  # fmt: skip


@checked(scene=a_scene, speed=measured(SPEED), restitution=number(0.0), contact_time=measured(TIME))
def foundation_of_drop(
    scene: Scene | None = None, *, speed: Any, restitution: float, contact_time: Any
) -> Foundation:
    """Return the Kelvin-Voigt foundation on which a drop has this restitution and contact time.

    eta follows from the restitution, D from the contact time, then K and tau = eta D/v (`restitution`).

    Parameters
    ----------
    scene
        The indenter, a parabola or a ball, and its mass; its foundation does not matter.
    speed
        Speed in m/s at which it lands.
    restitution
        Speed up over speed down, above 0 and below 1.
    contact_time
        Time in s from the landing to the take-off.

    Raises
    ------
    SceneError
        If a quantity is out of range.
    ValueError
        If the restitution is out of range, or the scene is of another kind.

    Examples
    --------
    >>> import kvtheory as kv
    >>> ball = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="30 g"))
    >>> rubber = kv.foundation_of_drop(ball, speed="1 m/s", restitution=0.6, contact_time="2 ms")
    >>> f"{rubber.stiffness:.4g} {rubber.retardation_time:.4g}"
    '4.017e+09 0.0002007'
    """
    from kvtheory.theory.drop import drop, number_of

    scene = one_scene(scene, "a drop")
    require(lacks_dropped, scene, "a drop in closed form")
    with double_precision(scene):
        line = scene.indenter.per_width
        eta = number_of(restitution, line=line)
        D = speed * contact_time / drop(eta, line=line).contact_time
        unit, power = _contact(scene, 1.0)
        K = scene.support.mass * speed * speed / (unit * D**power)
        return Foundation(stiffness=K, retardation_time=eta * D / speed)


@checked(scene=a_scene, frequency=measured(FREQUENCY), damping_ratio=number(0.0))
def foundation_of_mode(
    scene: Scene | None = None, *, frequency: Any, damping_ratio: float
) -> Foundation:
    """Return the Kelvin-Voigt foundation on which small motions about rest have this mode.

    M d'' + 2 zeta omega M d' + omega^2 M d = 0 about the static depth under the load W, so that m W/delta_0 =
    omega^2 M, with m = 3/2 of a line and 2 of a ball, and tau = 2 zeta/omega.

    Parameters
    ----------
    scene
        The indenter, a parabola or a ball, its mass and load; its foundation does not matter.
    frequency
        The angular frequency omega without damping, in 1/s.
    damping_ratio
        The damping ratio zeta, above 0; from 1 on there is no oscillation.

    Raises
    ------
    SceneError
        If a quantity is out of range.
    ValueError
        If the scene is of another kind.

    Examples
    --------
    >>> import kvtheory as kv
    >>> ball = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="30 g"))
    >>> rubber = kv.foundation_of_mode(ball, frequency="1000 1/s", damping_ratio=0.5)
    >>> f"{rubber.stiffness:.4g} {rubber.retardation_time:.4g}"
    '2.434e+10 0.001'
    """
    scene = one_scene(scene, "a mode")
    require(lacks_dropped, scene, "a mode in closed form")
    with double_precision(scene):
        W, stiffness = scene.support.weight, scene.support.mass * frequency * frequency
        unit, power = _contact(scene, 1.0)
        power -= 1.0  # of the force over the depth
        depth = power * W / stiffness
        force = (4.0 / 3.0 if scene.indenter.per_width else 1.0) * unit
        K, tau = W / (force * depth**power), 2.0 * damping_ratio / frequency
        return Foundation(stiffness=K, retardation_time=tau)


def _contact(scene: Scene, stiffness: float) -> tuple[float, float]:
    """Return what times D to a power is M v^2, and this power."""
    indenter: Any = scene.indenter
    if indenter.per_width:
        return stiffness * math.sqrt(2.0 * indenter.radius), 2.5
    return float(ball_stiffness(stiffness, indenter.radius, indenter.stretch)), 3.0


def _landing_speed(scene: Scene) -> float:
    """Return the speed at which the indenter lands after its start."""
    if scene.start.gap is None:
        raise ValueError("a drop needs a `speed`, or a scene with start.gap")
    return scene.start.landing_speed(scene.support, StaticState.of(scene).depth)
