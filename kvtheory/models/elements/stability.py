"""Largest stable time steps: the stability polynomial of a scheme at the rates of the contact.

Near any state, with a contact of length L that does not change within the step, the depth obeys
M σ^2 + C L σ + K L + k_s = 0 (F12 with the contact held). A step is stable if |R(σ h)| <= 1 for both
rates σ; for the fast rate, about -C L/M, this is fact F15, h C L/M <= 2.785 or 2.
"""

import math

import numpy as np

from kvtheory.models.elements.model import SAMPLES, Model, root, span
from kvtheory.models.elements.schemes import Scheme
from kvtheory.scene.base_motion import BaseMotion

STEADY_RTOL = 1e-6


def lengths(model: Model, path: BaseMotion) -> tuple[float, float]:
    """Return the contact lengths (m) that bound the step: in steady sliding, and at the static depth.

    Each is the longest over the velocities of the drive; between those the velocity is linear, and
    the length falls with |V|. A drive that passes through rest has the contact at rest among them. A
    step that is too long for the latter only, at a start, is unstable at first and may recover.
    """
    velocities = path.velocities
    if velocities[0] < 0.0 < velocities[-1]:
        velocities = [0.0, *velocities]
    # The slowest motion in each direction has the longest contact.
    chosen = {min((V for V in velocities if V >= 0.0), default=velocities[-1]),
              max((V for V in velocities if V <= 0.0), default=velocities[0])}  # fmt: skip
    steady = max(_length(model, _steady_depth(model, V), V)[0] for V in chosen)
    return steady, max(_length(model, model.depth, V)[0] for V in chosen)


def limit_at(scheme: Scheme, model: Model, length: float) -> float:
    """Return the largest stable step for a contact of this length, in s."""
    R = scheme.stability_polynomial
    if not R or math.isinf(model.mass):
        return math.inf
    law = model.law
    rates = np.roots([model.mass, law.damping * length, law.stiffness * length + model.spring])
    return min(_reach(R, complex(rate)) for rate in rates)


def _reach(R: tuple[float, ...], rate: complex) -> float:
    """Return the first h > 0 with |R(rate h)| = 1, by the roots of a polynomial in h."""
    along = np.array([c * (rate / abs(rate)) ** k for k, c in enumerate(R)])
    square = np.polynomial.polynomial.polymul(along, along.conj()).real
    square[0] -= 1.0
    roots = np.polynomial.polynomial.polyroots(square[1:])  # without the root h = 0
    positive = roots.real[(abs(roots.imag) < 1e-9 * abs(roots)) & (roots.real > 0.0)]
    first = float(positive.min()) if positive.size else math.inf
    growing = np.polynomial.polynomial.polyval(0.5 * min(first, 1.0), square) > 0.0
    return 0.0 if growing else first / abs(rate)


def _length(model: Model, depth: float, V: float) -> tuple[float, float]:
    """Return the length of a contact at a depth, and its normal force, both at a steady velocity."""
    x = np.linspace(*span(model.indenter, depth), SAMPLES)
    p = model.law.pressure(depth - model.height(x), -V * model.slope(x))
    pressed, step = p > 0.0, x[1] - x[0]
    return step * np.count_nonzero(pressed), step * float(p[pressed].sum())


def _steady_depth(model: Model, V: float) -> float:
    """Return the depth at which steady sliding carries the load."""
    if math.isinf(model.mass):
        return model.depth

    def surplus(depth: float) -> float:
        force = _length(model, depth, V)[1] + model.spring * (depth - model.depth)
        return force / model.weight - 1.0

    low = model.depth
    while surplus(low) > 0.0:
        low *= 0.5
    return low if low == model.depth else root(surplus, low, 2.0 * low, STEADY_RTOL)
