"""The schemes by name: how each moves the indenter and then its elements by one step in time.

The indenter obeys M δ'' = W - k_s (δ - δ_0) - F_z (Eq. 17; a prime is d/dt), and on a spring in the drive
M_x x'' = F_x - c_x x' - k_x x, while the base moves at V - x' under it. The schemes differ in how
F_z is summed over the elements and over the step; what is known of each is in `results.schemes`.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from kvtheory.models.elements.exact_memory import exponential_fit, implicit_step
from kvtheory.models.elements.explicit import Tableau, explicit_step
from kvtheory.models.elements.row import ElementRow, IndenterState
from kvtheory.results.schemes import SCHEME_ROWS, SchemeRow

DEFAULT = "edge-corrected"


class Scheme(NamedTuple):
    """A way to advance by one step: what is known of it, and the function that takes the step.

    `tableau` is that of an explicit scheme.
    """

    row: SchemeRow
    step: Callable[[ElementRow, IndenterState, float], IndenterState]
    tableau: Tableau = ()

    @property
    def stability_polynomial(self) -> tuple[float, ...]:
        """R(z) of an explicit scheme, constant first; empty for one that is stable at any step."""
        return tuple(1.0 / math.factorial(k) for k in range(len(self.tableau)))


_TABLEAUX: dict[str, Tableau] = {
    "paper": ((0.0,), (0.5, 0.5), (0.5, 0.0, 0.5), (1.0, 0.0, 0.0, 1.0), (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
    "explicit-euler": ((0.0,), (1.0,)),
}  # fmt: skip
_THETAS: dict[str, Callable[[float], float]] = {
    "semi-implicit": lambda _: 1.0,  # that of the backward Euler method
    "exponential": exponential_fit,
    "edge-corrected": exponential_fit,
}
SCHEMES = {
    **{name: Scheme(SCHEME_ROWS[name], partial(explicit_step, tableau=tableau), tableau)
       for name, tableau in _TABLEAUX.items()},
    **{name: Scheme(SCHEME_ROWS[name], partial(implicit_step, theta=theta))
       for name, theta in _THETAS.items()},
}  # fmt: skip
"""The schemes by name."""
