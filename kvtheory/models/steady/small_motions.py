"""The forces of a sliding contact in small motions e^(st) about steady sliding (theorem F24).

The response of a parabola is that of the law of its foundation (`kvtheory.theory.laws`); a ball is the sum of
its strips, by Gauss's rule in the angle whose cosine is the half length of a strip over the largest.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import ball_viscoelastic, viscoelastic
from kvtheory.scene.model import Scene
from kvtheory.theory.laws import Law

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

AT_REST = 1e-9
"""V tau_i/c, of the slowest arm, of slow sliding that stands for rest."""


class Contact(NamedTuple):
    """Flat scenes in steady sliding, as small motions see them: all of one row each, strips ahead."""

    V: Array
    R: Array
    c: Array
    eta: Array
    width: Array
    """Of the strips; 1 for a line."""
    mass: Array
    spring: Array
    mass_along: Array
    damping: Array
    law: Law
    """Over the distance travelled."""
    held: bool

    def rows(self, index: Any) -> "Contact":
        """Return some of the scenes."""
        parts: list[Any] = [each[..., index] for each in self[:-2]]
        parts += [self.law.at(index), self.held]
        return Contact(*parts)

    def forces(self, s: Complex) -> tuple[Complex, ...]:
        """Return A, B, C, D, for one s of each scene."""
        slope, share = self.c / self.R, self.c * self.width
        A, B, C, D = self.law.response(self.c, self.eta, s * (self.c / self.V))
        each = A, slope * B, slope * C, slope * slope * D
        return tuple((share * term).sum(axis=0) for term in each)

    def stiffness(self, s: Complex) -> tuple[Complex, Complex, Array]:
        """Return the k_x for which s is a rate, what resists vertical motion, and the size of its terms."""
        A, B, C, D = self.forces(s)
        along = D - s * (self.mass_along * s + self.damping)
        if self.held:
            return along, np.ones_like(s), np.abs(D)
        across = s * s * self.mass + self.spring + A
        coupled = B * C / across
        size = np.abs(s * s) * self.mass + self.spring + np.abs(A)
        return along - coupled, across, np.abs(D) + np.abs(coupled) * (1.0 + size / np.abs(across))


def contact(scene: Scene, strips: int = 1) -> Contact:
    """Return what small motions of flat scenes see: a parabola, or a ball in strips."""
    shape, support, foundation = scene.shape, scene.support, scene.foundation
    law = viscoelastic.law(scene)
    if scene.indenter.per_width:
        c = viscoelastic.contact_length(scene, law)[np.newaxis]
        width = np.ones_like(c)
    else:
        middle = ball_viscoelastic.contact_length(scene, law)
        half = middle * viscoelastic.growth(law.moments(middle))[0]
        angles, weights = (0.25 * np.pi * x for x in np.polynomial.legendre.leggauss(strips))
        cosines = np.cos(0.25 * np.pi + angles)
        c = np.stack([viscoelastic.length_at_half(law, half * cosine) for cosine in cosines])
        width = 2.0 * scene.indenter.stretch * half * (cosines * weights)[:, np.newaxis]
    eta = np.stack([law.moments(each).eta for each in c])

    def full(value: Any) -> Array:
        return np.broadcast_to(value, shape).astype(float)

    times = [full(arm.relaxation_time) for arm in foundation.arms]
    slowest = np.maximum.reduce(times or [full(foundation.retardation_time)])
    V = np.maximum(np.abs(scene.drive.final_velocity), AT_REST * c.max(axis=0) / slowest)
    return Contact(
        full(V), full(scene.indenter.radius), c, eta, width,
        full(support.mass), full(support.spring), full(scene.drive_mass), full(scene.drive.damping),
        viscoelastic.law(scene.at(V)), held=scene.held,
    )  # fmt: skip
