"""The schemes by name: how each moves the indenter and then its elements by one step in time.

The indenter obeys M δ'' = W - k_s (δ - δ_0) - F_z (Eq. 17; a prime is d/dt), and on a spring in the drive
M_x x'' = F_x - c_x x' - k_x x, while the base moves at V - x' under it. The schemes differ in how F_z is
summed over the elements and over the step; what is known of each is in `results.table`.

Explicit schemes are Runge-Kutta methods on F_z = dx Σ (K g + C g'), with the paper's rules of contact. They
are stable up to dt C L/M = 2.785 (the paper's) or 2 (Euler), L the length of the contact; on arms, up to
where the matrix of a step (`stability.amplification`) begins to grow.

Implicit schemes use the exact memory of an element (F8) and need no rules of contact. The force, averaged
over the step, is k Σ dx max(g - r, 0), r being where the mean pressure of an element would vanish; for
Kelvin-Voigt, with the weight e^(t/τ), F_z = K/(1 - e^(-h/τ)) Σ dx max(g - u e^(-h/τ), 0). It is never
negative, independent of detached elements, and convex in the depth at the end of the step, which therefore
is the one root of a monotone function. The depth advances with the mean velocity (1-θ) v_0 + θ v_1: θ = 1
has the damping of the backward Euler method; the exponential fit θ = 1/(1 - e^(-z)) - 1/z, z = h C L/M,
lets the velocity fall by e^(-z), and the order is two. Both are stable at any step, since θ >= 1/2
(derivation `element-stability`).

On a spring the place along x is found likewise, with the force of an element times its slope halfway
through the step. The work of these forces is what elements of a parabola store and lose, so that no step
gains energy. On arms, an element in contact is a true element under a surface that moves along a straight
line, and so is one that is met in the step, from where it is free; the same holds. C is here the damper
which, beside a spring, does to a ramp as the arms do in a step, h Σ K_i (2 φ_2 - φ_1): K_i τ_i of fast
arms, h² K_i/(6 τ_i) of slow ones; so θ - 1/2 is of the third order in h, and the scheme of the second
(derivation `element-arms`).

Sums over whole elements carry the sawtooth of theorem F15-sawtooth: on Table 1 at the paper's density 2e-3
of the force at the start, 1e-3 in steady sliding, halved with the spacing. With the kinks of the surface at
edges between two elements (`parts` of the model), it is 1e-4 and 1e-6, and quartered; the depth is within
1e-5 of theory. Only at the very instant of a jump of the drive, where pressure is left on an edge, is the
order one.
"""

import math
from typing import NamedTuple

import numpy as np

from kvtheory.results.table import SCHEME_ROWS, SchemeRow
from kvtheory.theory.laws import Array

DEFAULT = "edge-corrected"

Tableau = tuple[tuple[float, ...], ...]
"""(c, a_1, a_2, …) for each stage, and then the weights."""
RK4: Tableau = (
    (0.0,),
    (0.5, 0.5),
    (0.5, 0.0, 0.5),
    (1.0, 0.0, 0.0, 1.0),
    (1 / 6, 1 / 3, 1 / 3, 1 / 6),
)


class Scheme(NamedTuple):
    """A scheme: what is known of it, the tableau of an explicit one, and whether θ is fitted or 1."""

    row: SchemeRow
    tableau: Tableau = ()
    fitted: bool = False

    @property
    def stability_polynomial(self) -> tuple[float, ...]:
        """R(z) of an explicit scheme, constant first; empty for one that is stable at any step."""
        return tuple(1.0 / math.factorial(k) for k in range(len(self.tableau)))

    @property
    def table(self) -> Array:
        """The tableau as an array, whose last row has c = 1."""
        stages = [*self.tableau[:-1], (1.0, *self.tableau[-1])] if self.tableau else [(1.0,)]
        table = np.zeros((len(stages), len(stages)))
        for row, stage in zip(table, stages, strict=True):
            row[: len(stage)] = stage
        return table


SCHEMES = {
    "paper": Scheme(SCHEME_ROWS["paper"], RK4),
    "explicit-euler": Scheme(SCHEME_ROWS["explicit-euler"], ((0.0,), (1.0,))),
    "semi-implicit": Scheme(SCHEME_ROWS["semi-implicit"]),
    "exponential": Scheme(SCHEME_ROWS["exponential"], fitted=True),
    "edge-corrected": Scheme(SCHEME_ROWS["edge-corrected"], fitted=True),
}
"""The schemes by name."""
