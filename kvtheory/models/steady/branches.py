"""The memory of the branches of a foundation, besides its spring, for the convolution.

A branch with the part g of G - K answers a steady rate of compression over the distance X with
m(X) = int_0^X g; the share v of this is due to delays up to s(v).
"""

from typing import Any, Protocol

import numpy as np
from scipy.special import gamma

Array = Any
"""Of floats."""


class Contact(Protocol):
    """The quadrature over the contact that a branch needs: nodes, weights and integrals."""

    ahead: Array
    weights: Array
    rate: Array

    def total(self, values: Array) -> tuple[float, float]:
        """Return the integral over the contact, and the difference of both rules."""


class Memory(Protocol):
    """The memory of the branches of a foundation, one row each."""

    def amount(self, X: Array) -> Array:
        """Return m = int_0^X g."""

    def delay(self, v: Array, X: Array) -> Array:
        """Return s at which a share v of m is reached."""

    def share(self, s: Array, X: Array) -> Array:
        """Return the share of m that is reached at s."""

    def works(self, sliding: Contact, memory: Array, left: Array) -> tuple[float, float]:
        """Return the work of the branches over the contact, and the part that is lost in it.

        `memory` are their pressures at the nodes, `left` those at the trailing edge.
        """


class Arms:
    """K_i e^(-X/l_i)."""

    def __init__(self, stiffness: Array, length: Array) -> None:
        self.stiffness, self.length = (np.asarray(row)[:, None] for row in (stiffness, length))

    def amount(self, X: Array) -> Array:
        """Return K_i l_i (1 - e^(-X/l_i))."""
        return -self.stiffness * self.length * np.expm1(-X / self.length)

    def delay(self, v: Array, X: Array) -> Array:
        """Return -l_i ln(1 - v (1 - e^(-X/l_i)))."""
        l = self.length[..., None]
        return -l * np.log1p(v * np.expm1(-X[..., None] / l))

    def share(self, s: Array, X: Array) -> Array:
        """Return (1 - e^(-s/l_i))/(1 - e^(-X/l_i))."""
        return np.expm1(-s / self.length) / np.expm1(-X / self.length)

    def works(self, sliding: Contact, memory: Array, left: Array) -> tuple[float, float]:
        """Return the work of the arms, and the part of it that is lost in the contact: sums of squares."""
        lost, _ = sliding.total((memory**2 / (self.stiffness * self.length)).sum(axis=0))
        return float((left**2 / (2.0 * self.stiffness)).sum()) + lost, lost


class Springpot:
    """K (X/l)^(-alpha)/Gamma(1 - alpha)."""

    def __init__(self, stiffness: float, length: float, order: float) -> None:
        self.scale = stiffness * length**order / gamma(2.0 - order)
        self.rest = 1.0 - order

    def amount(self, X: Array) -> Array:
        """Return K l^alpha X^(1 - alpha)/Gamma(2 - alpha)."""
        return self.scale * X[None, :] ** self.rest

    def delay(self, v: Array, X: Array) -> Array:
        """Return X v^(1/(1 - alpha)): for alpha = 1 nothing is remembered."""
        if self.rest == 0.0:
            return 0.0 * v * X[..., None]
        return X[..., None] * v ** (1.0 / self.rest)

    def share(self, s: Array, X: Array) -> Array:
        """Return (s/X)^(1 - alpha)."""
        return (s / X) ** self.rest if self.rest > 0.0 else np.ones_like(X)

    def works(self, sliding: Contact, memory: Array, left: Array) -> tuple[float, float]:
        """Return the work of the springpot, and the part of it that is lost in the contact.

        What it holds where the contact ends is that of its arms, 1/2 int int G(s + s') u' u' ds ds'.
        """
        work, _ = sliding.total(sliding.rate * memory.sum(axis=0))
        if self.rest == 0.0:
            return work, work
        s = sliding.ahead
        kernel = (s[:, None] + s[None, :]) ** (self.rest - 1.0) / gamma(self.rest)
        scale = self.scale * gamma(1.0 + self.rest)
        weighed = sliding.weights[0] * sliding.rate
        return work, work - 0.5 * scale * float(weighed @ kernel @ weighed)
