"""The quantities of results, and the schemes of simulators: the only tables of their names and properties."""

import math
from collections.abc import Mapping
from typing import NamedTuple

from kvtheory.scene.indenters import Indenter
from kvtheory.scene.static_state import StaticState
from kvtheory.scene.units import WHOLE


class Row(NamedTuple):
    """A quantity: name, symbol (TeX), SI unit, description, and its scale, a value of the `StaticState`."""

    name: str
    symbol: str
    unit: str
    words: str
    scale: str


_ROWS = (
    Row("time", "t", "s", "time", "time"),
    Row("velocity", "V", "m/s", "drive velocity", "velocity"),
    Row("sliding_velocity", r"v", "m/s", "sliding velocity", "velocity"),
    Row("depth", r"\delta", "m", "depth", "depth"),
    Row("depth_rate", r"\dot\delta", "m/s", "rate of the depth", "depth_rate"),
    Row("half_length", "a", "m", "half length of the stationary contact", "half_length"),
    Row("retardation_length", r"l_\mathrm{r}", "m", "retardation length", "half_length"),
    Row("normal_force", "F_z", "N/m", "normal force", "load"),
    Row("load", "W", "N/m", "load", "load"),
    Row("friction_force", "F", "N/m", "friction force", "friction_force"),
    Row("spring_force", r"F_\mathrm{s}", "N/m", "force of the drive's spring", "friction_force"),
    Row("friction_coefficient", r"\mu", "1", "friction coefficient", ""),
    Row("leading_edge", r"x_\mathrm{LE}", "m", "leading edge", "half_length"),
    Row("trailing_edge", r"x_\mathrm{TE}", "m", "trailing edge", "half_length"),
    Row("peak_pressure", r"p_\mathrm{max}", "Pa", "peak pressure", "pressure"),
    Row("dissipated_in_contact", "", "1", "share dissipated in the contact", ""),
    Row("critical_stiffness", r"k_\mathrm{c}", "N/m^2", "critical stiffness of the spring", ""),
    Row("lower_critical_stiffness", "", "N/m^2", "lower critical stiffness of the spring", ""),
    Row("frequency", "", "Hz", "frequency at the onset of instability", ""),
    Row("critical_velocity", "", "m/s", "velocity at the onset of instability", ""),
    Row("growth_rate", "", "1/s", "fastest growth of small motions", ""),
    Row("growth_frequency", "", "Hz", "frequency of the fastest growth", ""),
)
QUANTITIES = {row.name: row for row in _ROWS}


def _units(names: str) -> dict[str, str]:
    return {name: QUANTITIES[name].unit for name in names.split()}


STEADY_UNITS = _units(
    "depth half_length retardation_length leading_edge trailing_edge load"
    " friction_force friction_coefficient peak_pressure dissipated_in_contact"
)
"""The quantities of steady sliding and their units, in the order in which they are shown."""
TRANSIENT_UNITS = _units(
    "time velocity depth depth_rate normal_force friction_force leading_edge trailing_edge peak_pressure"
)
"""The quantities of a time series and their units, `time` first."""
STABILITY_UNITS = _units(
    "critical_stiffness lower_critical_stiffness frequency critical_velocity growth_rate growth_frequency"
)
"""The quantities of the stability of steady sliding and their units, beside its rates."""
SPRING_UNITS = _units("sliding_velocity spring_force")
"""The additional quantities of a time series if the drive has a spring."""
SERIES_UNITS = TRANSIENT_UNITS | SPRING_UNITS
LANDMARKS = {
    "restitution": "1", "contact_time": "s", "stopping_time": "s", "stopping_distance": "m",
}  # fmt: skip
"""Single values of a drop, and of an indenter that coasts, and their units."""

SHOWN_UNITS = {
    "1": ("", 1.0),
    "s": ("ms", 1e3),
    "m": ("mm", 1e3),
    "m/s": ("mm/s", 1e3),
    "m/s^2": ("m/s^2", 1.0),
    "N": ("N", 1.0),
    "N/m": ("N/mm", 1e-3),
    "N/m^2": ("MN/m^2", 1e-6),
    "N/m^3": ("N/mm^3", 1e-9),
    "Pa": ("MPa", 1e-6),
    "kg": ("kg", 1.0),
    "kg/m": ("kg/mm", 1e-3),
    "Hz": ("Hz", 1.0),
    "1/s": ("1/s", 1.0),
}
"""The unit in which tables show each SI unit, as in the paper, and the factor to it."""


def units_for(indenter: Indenter, units: Mapping[str, str]) -> Mapping[str, str]:
    """Return the units of quantities of a result: per unit width for a line contact, total for a ball."""
    if indenter.per_width:
        return units
    return {name: WHOLE.get(unit, unit) for name, unit in units.items()}


def series_units(*, rigid_drive: bool) -> Mapping[str, str]:
    """Return the quantities of a time series and their units, `time` first."""
    return TRANSIENT_UNITS if rigid_drive else SERIES_UNITS


def scales(at_rest: StaticState) -> dict[str, float]:
    """Return the scale of each quantity of a series, from the static state."""
    names = series_units(rigid_drive=at_rest.rigid_drive)
    return {name: getattr(at_rest, QUANTITIES[name].scale) for name in names}


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

_SCHEMES = (
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
SCHEME_ROWS = {row.name: row for row in _SCHEMES}
"""The rows by name."""
SIMULATED = tuple(name for name in SCHEME_ROWS if name != "rk4")
"""Those that `elements` runs; the other one occurs in series of other simulators."""
