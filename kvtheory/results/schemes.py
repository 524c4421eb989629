"""The schemes of discrete simulators, one row each: name, order and stability limit.

Both the simulator and the checks of such a run read them here.
"""

import math
from typing import NamedTuple


class SchemeRow(NamedTuple):
    """A scheme on Kelvin-Voigt; on a Prony series limits are other, and the paper's order in time is two."""

    name: str
    summary: str
    order_in_time: int  # of the motion while no element enters or leaves the contact
    order: int  # of the depth when spacing and step are refined together; of forces it is one
    stability_limit: float  # largest stable h C L/M, L the length of the contact: |R(-z)| = 1 (F15)
    parts_of_elements: bool = False  # whether fractions of elements at the edges are counted
    papers_step: bool = False  # whether h = 2 dx/V, as in the paper


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
