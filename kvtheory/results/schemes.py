"""The schemes of discrete simulators, one row each: name, order and stability limit.

Both the simulator and the checks of such a run read them here.
"""

import math
from typing import NamedTuple


class SchemeRow(NamedTuple):
    """The properties of a scheme.

    `order_in_time` is the order of the motion of the indenter while no element enters or leaves the contact;
    `order` is that of the depth when spacing and step are refined together; forces summed over whole
    elements are of order one. `stability_limit` is the largest stable h C L/M, L the length of the contact:
    where |R(-z)| = 1, R the stability polynomial (F15); infinite if every step is stable.
    `parts_of_elements` says whether fractions of elements at the edges are counted. `papers_step` says
    whether h = 2 dx/V, as in the paper. All this is for Kelvin-Voigt; on a Prony series the explicit schemes
    have other limits, and the paper's scheme is of order two in time.
    """

    name: str
    summary: str
    order_in_time: int
    order: int
    stability_limit: float
    parts_of_elements: bool = False
    papers_step: bool = False


RK4_LIMIT = 2.785293563405282
"""The root of 1 - z + z^2/2 - z^3/6 + z^4/24 = 1."""

_ROWS = (
    SchemeRow("paper", "Runge-Kutta of order 4, dt = 2 dx/V, contact rules 20-25, as in the paper",
              4, 1, RK4_LIMIT, papers_step=True),
    SchemeRow("rk4", "the paper's scheme with any time step", 4, 1, RK4_LIMIT),
    SchemeRow("explicit-euler", "Euler's method with the paper's contact rules", 1, 1, 2.0),
    SchemeRow("semi-implicit", "exact memory (F8), implicit damping, order 1", 1, 1, math.inf),
    SchemeRow("exponential", "exact memory (F8), exponentially fitted damping, order 2 in time",
              2, 2, math.inf),
    SchemeRow("edge-corrected", "the exponential scheme with part of an element at each edge, order 2",
              2, 2, math.inf, parts_of_elements=True),
)  # fmt: skip
SCHEME_ROWS = {row.name: row for row in _ROWS}
"""The rows by name."""
SIMULATED = tuple(name for name in SCHEME_ROWS if name != "rk4")
"""Those that `elements` runs; the other one occurs in series of other simulators."""
