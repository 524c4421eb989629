"""The stiffness of a foundation that is given by a layer: of its contact at rest, or as if it were thin."""

import math
from typing import Any

import numpy as np

from kvtheory.scene.mistakes import Problems, mistake
from kvtheory.theory.contact_at_rest import depth_at_rest, load_at_rest

REST, THIN_WAY = WAYS = "rest", "thin"
"""Where the stiffness of a layer is taken from."""
SHAPES = "parabola", "circle", "sphere"
"""Shapes whose contact at rest is in the table; a circle is taken as its parabola."""
THIN = 0.1
"""Largest `layer_number` of a thin layer. Up to it K predicts the load at a depth to 5 % for a parabola and
11 % for a ball, and the length of the contact to 15 % (by the exact compliance, nu from 0 to nearly 1/2)."""
LARGE_STRAIN, LARGE_SLOPE = 0.2, 0.3
"""Depth over thickness, and slope at the edge of a contact, up to which linear theory is within about 10 %.

Rubber in compression is stiffer than its linear law by about the strain (a neo-Hookean one by 12 % at 0.1),
and the mean over a contact is half of depth/H under a ball, two thirds under a parabola. A parabola differs
from its circle by the order of the slope squared, 9 % at 0.3."""


def layer_stiffness(modulus: Any, thickness: Any, poisson_ratio: Any) -> Any:
    """Return K = E (1 - nu) / ((1 + nu) (1 - 2 nu) h) of a thin layer bonded to a rigid base, in N/m^3.

    The modulus is E (Pa), the thickness h (m), numbers or arrays. A layer that is thin for its contact (see
    `layer_number`) is compressed without lateral strain: K is its confined modulus over its thickness
    (Johnson, Contact Mechanics, 1985, section 5.8).

    >>> round(layer_stiffness(5e6, 2e-3, 0.45) / 1e9, 4)
    9.4828
    """
    nu = poisson_ratio
    return modulus * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / thickness


def rest_stiffness(foundation: Any, indenter: Any, support: Any) -> Any:
    """Return the K (N/m^3) on which an indenter at rest has the depth and load of the elastic layer.

    The load is that of the support, or that of the layer at the given depth. Raises SceneError for a layer
    that is too thick for a line contact, which has no depth on a half-plane.
    """
    R, line = indenter.radius, indenter.per_width
    layer = R, foundation.modulus, foundation.thickness, foundation.poisson_ratio
    with np.errstate(all="ignore"):  # what leaves double precision is reported by the key
        try:
            if support.depth is None:
                load = support.weight
                depth = depth_at_rest(load, *layer, per_width=line)
            else:
                depth = support.depth
                load = load_at_rest(depth, *layer, per_width=line)
        except ValueError as error:
            raise mistake("foundation.thickness", foundation.thickness, str(error)) from None
        unit = 4 / 3 * np.sqrt(2.0 * R * depth) if line else math.pi * R * depth
        return (load / unit / depth)[()]


def unfit(foundation: Any, indenter: Any) -> Problems:
    """Report a half-plane, on which a line contact has no depth."""
    found = Problems()
    own = getattr(foundation, "modulus", None) is not None and foundation.stiffness_from == REST
    if own and indenter.per_width and np.any(np.isinf(foundation.thickness)):
        message = (
            f"a line contact has no depth on a half-plane; expected a length, or a ball beside inf "
            f'(indenter.shape = "{indenter.shape}" is a line contact)'
        )
        found.add("foundation.thickness", foundation.thickness, message)
    return found


def not_at_rest(indenter: Any) -> str:
    """Return why the contact at rest of an indenter on a layer is not known, or an empty text."""
    round_ball = np.all(getattr(indenter, "stretch", 1.0) == 1.0)
    if indenter.shape in SHAPES and round_ball:
        return ""
    own = f'indenter.shape = "{indenter.shape}"' if round_ball else "indenter.radius_across"
    return f"is known for a parabola, a circle and a ball of one radius, not for {own}"


def layer_number(thickness: Any, half_length: Any, poisson_ratio: Any) -> Any:
    """Return (h/a)^2/(1 - 2 nu): a layer is thin for a contact of half length a if it is below `THIN`.

    Under a pressure of wave number k a bonded layer without friction on its surface is compressed by
    u = (p/K) [1 + c (k h)^2 + ...], c = nu (4 nu - 1)/(3 (1 - nu)(1 - 2 nu)). The first term is the
    foundation; the second is (k h)^2/(3 (1 - 2 nu)) near nu = 1/2, where the layer flows sideways instead of
    being compressed. With L^2 = c h^2 a parabola at a given depth carries (1 - L^2/a^2)^(3/2) + L^3/a^3 of
    the load that K predicts. Chandler and Vella (2020), Proc. R. Soc. A 476, arXiv:2010.11133, find the same
    parameter.
    """
    return (thickness / half_length) ** 2 / (1 - 2 * poisson_ratio)


def thick_layer(number: Any, several: bool = False) -> str:
    """Return a note if a layer is not thin for its contact by its `layer_number`, or an empty text.

    It is a number or an array of several scenes; or, of `several`, the largest.
    """
    if not (found := _above(number, THIN, several)):
        return ""
    where, value = found
    return (
        f"The layer is not thin for its contact{where}: (thickness/half_length)^2/(1 - 2 poisson_ratio) "
        f"{value}, so that it does not act as independent elements of the stiffness of a "
        "thin layer. Leave out foundation.stiffness_from, which takes K from the contact at rest, or solve "
        "the body itself, by the method `layer` of `steady`."
    )


def deformation(indenter: Any, thickness: Any, depth: Any, half_length: Any) -> dict[str, Any]:
    """Return the `strain` depth/thickness of a layer, and the `slope` of the indenter at the edge."""
    narrow = np.minimum(1.0, getattr(indenter, "stretch", 1.0))
    with np.errstate(all="ignore"):  # a circle is not wider than its diameter
        slope = np.maximum(*(abs(indenter.slope(side * half_length)) for side in (-1.0, 1.0)))
    return {"strain": depth / thickness, "slope": np.nan_to_num(slope / narrow, nan=math.inf)}


def large_deformation(strain: Any, slope: Any, several: bool = False) -> str:
    """Return a note if a contact is beyond linear theory, or an empty text; arguments as in `thick_layer`."""
    if found := _above(strain, 1.0, several):
        where, value = found
        return (
            f"There is no such contact{where}: depth/thickness {value}, so that the indenter would reach the "
            "base of the layer. Check load, depth, modulus and thickness."
        )
    given = (
        ("depth/thickness", strain, LARGE_STRAIN),
        ("the slope of the indenter at the edge of the contact", slope, LARGE_SLOPE),
    )
    told = [
        f"{name} {found[1]}{found[0]}"
        for name, values, limit in given
        if (found := _above(values, limit, several))
    ]
    if not told:
        return ""
    return (
        f"Strains are large: {', and '.join(told)}. Foundation and layer follow linear theory, which is then "
        "wrong by about 10 % or more."
    )


def _above(values: Any, limit: float, several: bool) -> tuple[str, str] | None:
    """Return in which scenes values are above a limit, in words, and the largest; None if there is none."""
    values = np.asarray(values)
    if not (count := np.count_nonzero(values > limit)):
        return None
    many = several or values.ndim > 0
    where = " in some scenes" if several else f" in {count} of {values.size} scenes" if many else ""
    return where, f"{'is up to' if many else '='} {values.max():.3g}, above {limit:g}"
