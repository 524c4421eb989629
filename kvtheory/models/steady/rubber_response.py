r"""What a contact that slides on a Prony series answers to small motions e^(st).

A depth delta_1 e^(st) and a displacement X_1 e^(st) along x change the forces by

    F_z1 = A delta_1 + B X_1,    F_x1 = C delta_1 + D X_1.

With the length c of the contact, its half length at rest (1/2 + eta) c, sigma = s c/V, z = c/(V tau_i),
m = z + sigma and phi_n(-m) = int_0^1 e^(-m v) (1 - v)^(n-1)/(n-1)! dv, each arm adds

    A:   K_i c [phi_1 + sigma phi_2],
    B:   K_i (c^2/R) z [Delta_3 - (1/2 + eta) Delta_2],
    C:  -K_i (c^2/R) [(1/2 - eta) (phi_1 + sigma phi_2) - phi_2 - sigma phi_3],
    D:  -K_i (c^3/R^2) z [Delta_3 - Delta_4 - (1/4 - eta^2) Delta_2],

all phi at -m, Delta_n = phi_n(-z) - phi_n(-m), to K c in A and K eta c^2/R in C. Nothing cancels for
stiff, fast arms; a small sigma is taken out of Delta_n as a factor. A ball is the sum of its strips.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import ball_viscoelastic, viscoelastic
from kvtheory.scene.model import Scene

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

NEAR = 2.0
"""Arguments of phi below which the recurrence upwards loses digits; Gauss's rule takes them."""
NODES, WEIGHTS = (0.5 * each for each in np.polynomial.legendre.leggauss(14))
NODES = 0.5 + NODES
SHARES = [WEIGHTS * (1.0 - NODES) ** n / math.factorial(n) for n in range(4)]
STRIPS = 24
"""Of the half of a ball, in the angle whose cosine is the half length of a strip over the largest."""
AT_REST = 1e-9
"""V tau_i/c, of the slowest arm, of slow sliding that stands for rest."""


class Contact(NamedTuple):
    """Flat scenes in steady sliding, as small motions see them: all of one row each, strips ahead."""

    V: Array
    R: Array
    K: Array
    arms: Array
    """K_i, along the first axis."""
    relaxed: Array
    """1/tau_i, along the first axis."""
    c: Array
    eta: Array
    width: Array
    """Of the strips; 1 for a line."""
    mass: Array
    spring: Array
    mass_along: Array
    damping: Array
    held: bool

    def rows(self, index: Any) -> "Contact":
        """Return some of the scenes."""
        parts: list[Any] = [each[..., index] for each in self[:-1]]
        return Contact(*[*parts, self.held])

    def forces(self, s: Complex) -> tuple[Complex, ...]:
        """Return A, B, C, D, for one s of each scene."""
        slope, sigma = self.c / self.R, s * (self.c / self.V)
        A, C = self.K * np.ones_like(sigma), self.K * self.eta * np.ones_like(sigma)
        B, D = np.zeros_like(sigma), np.zeros_like(sigma)
        for stiffness, relaxed in zip(self.arms, self.relaxed, strict=True):
            z = self.c * (relaxed / self.V)
            one, two, three, _ = phi(z + sigma)
            second, third, fourth = differences(z, sigma)
            whole = one + sigma * two
            A += stiffness * whole
            C -= stiffness * ((0.5 - self.eta) * whole - two - sigma * three)
            B += stiffness * z * (third - (0.5 + self.eta) * second)
            D -= stiffness * z * (third - fourth - (0.5 - self.eta) * (0.5 + self.eta) * second)
        share = self.c * self.width
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


def contact(scene: Scene, strips: int = STRIPS) -> Contact:
    """Return what small motions of flat scenes see: a parabola or a ball on a Prony series."""
    shape, support = scene.shape, scene.support
    row = viscoelastic.law(scene)
    if scene.indenter.per_width:
        c = viscoelastic.contact_length(scene, row)[np.newaxis]
        width = np.ones_like(c)
    else:
        middle = ball_viscoelastic.contact_length(scene, row)
        half = middle * viscoelastic.growth(row.moments(middle))[0]
        angles, weights = (0.25 * np.pi * x for x in np.polynomial.legendre.leggauss(strips))
        cosines = np.cos(0.25 * np.pi + angles)
        c = np.stack([viscoelastic.length_at_half(row, half * cosine) for cosine in cosines])
        width = 2.0 * scene.indenter.stretch * half * (cosines * weights)[:, np.newaxis]
    M = [row.moments(each) for each in c]
    eta = np.stack([0.5 * (each.P - each.Q) / (each.P + each.Q) for each in M])

    def full(value: Any) -> Array:
        return np.broadcast_to(value, shape).astype(float)

    relaxed = np.stack([full(1.0 / arm.relaxation_time) for arm in scene.foundation.arms])
    V = np.maximum(
        np.abs(scene.drive.final_velocity), AT_REST * c.max(axis=0) * relaxed.min(axis=0)
    )
    return Contact(
        full(V), full(scene.indenter.radius), full(scene.foundation.stiffness),
        np.stack([full(arm.stiffness) for arm in scene.foundation.arms]), relaxed,
        c, eta, width,
        full(support.mass), full(support.spring), full(scene.drive_mass), full(scene.drive.damping),
        held=scene.held,
    )  # fmt: skip


def phi(m: Complex) -> list[Complex]:
    """Return phi_1 to phi_4 at -m."""
    near = np.abs(m) < NEAR
    far = np.where(near, NEAR, m)
    found: list[Complex] = [np.asarray(-np.expm1(-far) / far, complex)]
    for n in range(1, 4):
        found.append((1.0 / math.factorial(n) - found[-1]) / far)
    if near.any():
        fall = np.exp(-m[near][:, np.newaxis] * NODES)
        for each, share in zip(found, SHARES, strict=True):
            each[near] = fall @ share
    return found


def differences(z: Array, sigma: Complex) -> tuple[Complex, ...]:
    """Return phi_n(-z) - phi_n(-z - sigma) for n = 2, 3, 4, relative to their own size."""
    z = np.broadcast_to(z, sigma.shape)
    m = z + sigma
    fast = z >= np.abs(m)
    pivot = np.where(fast, z, m)
    near = np.abs(pivot) < NEAR
    pivot = np.where(near, NEAR, pivot)
    others = phi(np.where(fast, m, z).astype(complex))
    small = np.abs(sigma) < 1.0
    part = -np.expm1(-np.where(sigma == 0.0, 1.0, sigma)) / np.where(sigma == 0.0, 1.0, sigma)
    slow = np.exp(-z) * np.where(sigma == 0.0, 1.0, np.where(small, part, 0.0))
    apart = (np.exp(-z) - np.exp(-m)) / np.where(small, 1.0, sigma)
    found = [np.where(small, slow, apart)]
    for n in range(4):
        found.append((others[n] - found[-1]) / pivot)
    if near.any():
        here, turn = z[near][:, np.newaxis] * NODES, sigma[near][:, np.newaxis] * NODES
        zero = turn == 0.0
        ratio = np.where(zero, 1.0, -np.expm1(-turn) / np.where(zero, 1.0, turn))
        fall = NODES * np.exp(-here) * ratio
        for n in (2, 3, 4):
            found[n][near] = fall @ SHARES[n - 1]
    return tuple(sigma * each for each in found[2:])
