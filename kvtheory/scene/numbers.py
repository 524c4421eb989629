"""What a scene says in numbers: its quantities by name, and its dimensionless groups."""

import math

from kvtheory.scene.indenters import Parabola
from kvtheory.scene.model import Fixed, Scene, Suspended


def quantities_by_name(scene: Scene) -> dict[str, float]:
    """Return the quantities of a scene in SI by plain names, the spring as `support_stiffness`.

    >>> quantities_by_name(Scene.table1("suspended"))["support_stiffness"]
    30000000.0
    """
    values = {key: value for key, value in scene.values().items() if key != "support.stiffness"}
    named = {key.split(".")[1]: value for key, value in values.items()}
    if isinstance(scene.support, Suspended):
        named["support_stiffness"] = scene.support.stiffness
    return {**named, "damping": scene.foundation.damping}


def dimensionless_numbers(scene: Scene) -> dict[str, float]:
    """Return the static state of a scene and the numbers that govern its motion.

    With the static depth delta_0, half length a_0 = sqrt(2 R delta_0) and load W_0 = (4/3) K a_0
    delta_0: the drive number lambda = V tau/a_0, the inertia number epsilon = M delta_0/(W_0 tau^2)
    and the support number kappa = k_s delta_0/W_0. A fixed indenter has the first one only, and a drive
    that is a function has not that one.

    Raises
    ------
    ValueError
        If the indenter is not a parabola, for which alone these numbers suffice.

    Examples
    --------
    >>> numbers = dimensionless_numbers(Scene())
    >>> {name: round(value, 5) for name, value in numbers.items() if name.endswith("number")}
    {'drive_number': 4.08128, 'inertia_number': 0.00306, 'support_number': 0.0}
    """
    if not isinstance(scene.indenter, Parabola):
        raise ValueError(
            f'only a parabola has these numbers, not indenter.shape = "{scene.indenter.shape}"'
        )
    try:
        numbers = _numbers(scene)
    except ArithmeticError:
        numbers = {"": math.inf}
    if not all(map(math.isfinite, numbers.values())) or numbers["static_half_length"] == 0.0:
        raise ValueError("the scene leaves the range of double precision: check its values")
    return numbers


def _numbers(scene: Scene) -> dict[str, float]:
    R, K, tau = scene.indenter.radius, scene.foundation.stiffness, scene.foundation.retardation_time  # type: ignore[union-attr]
    support = scene.support
    if isinstance(support, Fixed):
        a_0 = math.sqrt(2 * R * support.depth)
        load = 4 / 3 * K * a_0 * support.depth
        inertial = {}
    else:
        load = support.weight
        a_0 = (1.5 * R * load / K) ** (1 / 3)
        depth = a_0**2 / (2 * R)
        spring = support.stiffness if isinstance(support, Suspended) else 0.0
        inertial = {
            "inertia_number": support.mass * depth / (load * tau**2),
            "support_number": spring * depth / load,
        }
    drive = scene.drive
    driven = {"drive_number": drive.final_velocity * tau / a_0} if drive.function is None else {}
    return {
        "static_depth": a_0**2 / (2 * R),
        "static_half_length": a_0,
        "static_load": load,
        **driven,
        **inertial,
    }
