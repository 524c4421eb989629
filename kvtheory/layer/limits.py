"""Both limits of friction on the body itself, and where they cross: one elastic contact, two numbers.

At low velocity the surface keeps its shape at rest, and mu -> V tau_bar <h_xx>, for a parabola and a ball
V tau_bar/R, on every body (F28). At high velocity it keeps that of the glassy contact, and
mu -> (r/V) 2 U_g/W, r = -E'(0)/E_g, with the elastic energy U_g = int W_g d(depth) (F29).
"""

import math
from typing import Any

import numpy as np

from kvtheory.results import BodyLimits
from kvtheory.scene.capabilities import lacks_body, lacks_quadratic
from kvtheory.scene.layer import not_at_rest
from kvtheory.scene.model import Scene
from kvtheory.theory.contact_at_rest import depth_at_rest, energy_at_rest, load_at_rest


def limits(scene: Scene) -> BodyLimits | None:
    """Return the limits of a scene whose foundation is a layer under a parabola or a ball, or None.

    They are floats, or arrays of the shape of the scene. On a damper alone, which has no glassy modulus, only
    that at low velocity is known.
    """
    foundation, support = scene.foundation, scene.support
    indenter: Any = scene.indenter
    lacking = lacks_body(scene) or lacks_quadratic(scene) or not_at_rest(indenter)
    if foundation.modulus is None or lacking:
        return None
    R, line, none = indenter.radius, indenter.per_width, np.zeros(scene.shape)
    low = foundation.retardation_time / R + none
    if not foundation.arms:
        return BodyLimits(low[()], (none + math.nan)[()], (none + math.nan)[()])
    K = foundation.stiffness
    glassy = 1.0 + sum(arm.stiffness / K for arm in foundation.arms)  # E_g/E_0
    rate = sum(arm.stiffness / K / arm.relaxation_time for arm in foundation.arms) / glassy
    own = foundation.thickness, foundation.poisson_ratio
    relaxed, stiff = (R, foundation.modulus, *own), (R, foundation.modulus * glassy, *own)
    if support.depth is not None:
        depth = support.depth
    else:
        lift = support.weight
        if np.any(support.spring):  # relaxed at the static depth
            lift = lift + support.spring * depth_at_rest(lift, *relaxed, per_width=line)
        depth = depth_at_rest(lift, *stiff, spring=support.spring, per_width=line)
    load = load_at_rest(depth, *stiff, per_width=line)
    high = rate * 2.0 * energy_at_rest(depth, *stiff, per_width=line) / load + none
    return BodyLimits(low[()], high[()], np.sqrt(high / low)[()])
