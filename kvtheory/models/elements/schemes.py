"""The schemes by name: how each moves the indenter and then its elements by one step in time.

The indenter obeys M δ'' = W - k_s (δ - δ_0) - F_z (Eq. 17; a prime is d/dt). The schemes differ in how
F_z is summed over the elements and over the step; what is known of each is in `results.schemes`.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from kvtheory.models.elements.exact_memory import backward, exponential_fit, implicit_step
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


def _explicit(name: str, *tableau: tuple[float, ...]) -> Scheme:
    step = partial(explicit_step, tableau=tableau)
    return Scheme(SCHEME_ROWS[name], step, tableau)


def _implicit(name: str, theta: Callable[[float], float]) -> Scheme:
    return Scheme(SCHEME_ROWS[name], partial(implicit_step, theta=theta))


_ALL = (
    _explicit("paper", (0.0,), (0.5, 0.5), (0.5, 0.0, 0.5), (1.0, 0.0, 0.0, 1.0),
              (1 / 6, 1 / 3, 1 / 3, 1 / 6)),
    _explicit("explicit-euler", (0.0,), (1.0,)),
    _implicit("semi-implicit", backward),
    _implicit("exponential", exponential_fit),
    _implicit("edge-corrected", exponential_fit),
)  # fmt: skip
SCHEMES = {scheme.row.name: scheme for scheme in _ALL}
"""The schemes by name."""
